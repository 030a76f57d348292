//! Zoom, column and row of a web map tile from its path.

use std::path::Path;

/// `[zoom, column, row]` from `…/z/x/y.ext`, or from a name with `z10_x906_y404`, or with exactly three numbers like
/// `10_906_404`.
pub(crate) fn tile_from_path(path: &Path) -> Option<[u32; 3]> {
    let stem = path.file_stem()?.to_string_lossy().into_owned();
    let lettered = || Some([after_letter(&stem, 'z')?, after_letter(&stem, 'x')?, after_letter(&stem, 'y')?]);
    let folders = || {
        let mut parts = path.parent()?.iter().rev().map(|part| part.to_str()?.parse().ok());
        let y = stem.parse().ok()?;
        let x = parts.next()??;
        let zoom = parts.next()??;
        Some([zoom, x, y])
    };
    let numbers = || {
        let numbers: Vec<u32> = stem.split(['_', '-', '.']).map(|n| n.parse().ok()).collect::<Option<_>>()?;
        <[u32; 3]>::try_from(numbers).ok()
    };
    lettered().or_else(folders).or_else(numbers)
}

/// The number after a letter that begins a word of the name.
fn after_letter(name: &str, letter: char) -> Option<u32> {
    name.split(['_', '-', '.', ' ']).find_map(|word| word.strip_prefix(letter)?.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_in_paths() {
        let tile = |path: &str| tile_from_path(Path::new(path));
        assert_eq!(tile("tiles/10/906/404.png"), Some([10, 906, 404]));
        assert_eq!(tile("fuji_terrainrgb_z10_x906_y404_512px.png"), Some([10, 906, 404]));
        assert_eq!(tile("a/10-906-404.png"), Some([10, 906, 404]));
        assert_eq!(tile("dem_zion.png"), None);
        assert_eq!(tile("906/404.png"), None);
        assert_eq!(tile(""), None);
    }
}
