//! Parsers of option values; each says what it expects.

use yamanami::core::Crs;
use yamanami::io::crs;
use yamanami::io::dem::TileEncoding;
use yamanami::multires::kdisk::{MOST_RINGS, Wavelet};

/// Lengths, tolerances: a finite number that is not negative.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| if v >= 0.0 { Ok(v) } else { Err("expected a number that is not negative".to_owned()) })
}

/// Steps, rates: a finite number above zero.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| if v > 0.0 { Ok(v) } else { Err("expected a number above 0".to_owned()) })
}

/// A tolerance as the controllers take it.
pub(crate) fn tolerance(text: &str) -> Result<f32, String> {
    let v = not_negative(text)?;
    if v <= 1e6 { Ok(v as f32) } else { Err("expected at most 1000000".to_owned()) }
}

/// A share from 0 to 1.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    number(text).and_then(
        |v| {
            if (0.0..=1.0).contains(&v) { Ok(v) } else { Err("expected a share from 0 to 1".to_owned()) }
        },
    )
}

/// A triangle budget: a mesh of fewer than two triangles is none.
pub(crate) fn budget(text: &str) -> Result<u32, String> {
    match text.replace(['_', ','], "").parse::<u32>() {
        Ok(n) if n >= 2 => Ok(n),
        _ => Err(format!("expected a whole number from 2 to {}", u32::MAX)),
    }
}

/// A field of view in degrees, given back in radians.
pub(crate) fn fov_rad(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| {
        if (1.0..=170.0).contains(&v) { Ok(v.to_radians()) } else { Err("expected 1 to 170 degrees".to_owned()) }
    })
}

/// `X,Y,Z`.
pub(crate) fn place(text: &str) -> Result<[f64; 3], String> {
    let expected = || "expected three numbers X,Y,Z: x and y in the source's CRS, z in metres".to_owned();
    let numbers: Result<Vec<f64>, String> = text.split(',').map(number).collect();
    numbers.ok().and_then(|v| v.try_into().ok()).ok_or_else(expected)
}

/// `X,Y`.
pub(crate) fn plan_place(text: &str) -> Result<[f64; 2], String> {
    let numbers: Result<Vec<f64>, String> = text.split(',').map(number).collect();
    numbers
        .ok()
        .and_then(|v| v.try_into().ok())
        .ok_or_else(|| "expected two numbers X,Y in the source's CRS".to_owned())
}

/// `LAT,LON`: a place on Earth, degrees.
pub(crate) fn lat_lon(text: &str) -> Result<[f64; 2], String> {
    let numbers: Result<Vec<f64>, String> = text.split(',').map(number).collect();
    numbers
        .ok()
        .and_then(|v| <[f64; 2]>::try_from(v).ok())
        .filter(|[lat, lon]| lat.abs() <= 90.0 && (-180.0..=360.0).contains(lon))
        .ok_or_else(|| "expected LAT,LON in degrees: -90 to 90, -180 to 360".to_owned())
}

/// `X,Y X,Y …`: the corners of a line.
pub(crate) fn line(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let places: Result<Vec<_>, _> = text.split([' ', ';']).filter(|t| !t.is_empty()).map(plan_place).collect();
    places
        .ok()
        .filter(|p| p.len() >= 2)
        .ok_or_else(|| "expected two or more places, as \"X,Y X,Y\" in quotes, in the source's CRS".to_owned())
}

/// `WIDTHxHEIGHT` in pixels.
pub(crate) fn picture_size(text: &str) -> Result<[u32; 2], String> {
    two(text)
        .filter(|size| size.iter().all(|s| (16..=16_384).contains(s)))
        .map(|size| size.map(|s| s as u32))
        .ok_or_else(|| "expected WIDTHxHEIGHT with 16 to 16384 pixels a side, as 1920x1080".to_owned())
}

/// `COLUMNSxROWS` of a grid to make.
pub(crate) fn grid_size(text: &str) -> Result<[usize; 2], String> {
    const MOST_SAMPLES: usize = 1 << 29;
    two(text)
        .filter(|&[w, h]| w >= 2 && h >= 2 && w.checked_mul(h).is_some_and(|n| n <= MOST_SAMPLES))
        .ok_or_else(|| format!("expected COLUMNSxROWS, at least 2x2 and at most {MOST_SAMPLES} samples, as 1025x1025"))
}

/// A number of faces: none is no mesh.
pub(crate) fn faces(text: &str) -> Result<usize, String> {
    match text.replace(['_', ','], "").parse::<usize>() {
        Ok(n) if n >= 1 => Ok(n),
        _ => Err("expected a whole number of faces, at least 1".to_owned()),
    }
}

/// A share above 0 and at most 1, also in percent.
pub(crate) fn ratio(text: &str) -> Result<f64, String> {
    let expected = || "expected a share above 0 and at most 1, as 0.1 or 10%".to_owned();
    let share = match text.trim().strip_suffix('%') {
        Some(percent) => number(percent).map(|v| v / 100.0),
        None => number(text),
    };
    share.ok().filter(|&v| v > 0.0 && v <= 1.0).ok_or_else(expected)
}

/// A size of memory in bytes: `2GB`, `500 MB`, `1.5GiB`.
pub(crate) fn memory(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 8] = [
        ("kib", 1024.0),
        ("mib", 1048576.0),
        ("gib", 1073741824.0),
        ("kb", 1e3),
        ("mb", 1e6),
        ("gb", 1e9),
        ("m", 1e6),
        ("g", 1e9),
    ];
    let lower = text.trim().to_lowercase();
    let unit = UNITS.iter().find_map(|(name, bytes)| Some((lower.strip_suffix(name)?, *bytes)));
    let bytes = unit.and_then(|(count, unit)| Some(number(count.trim()).ok()? * unit));
    bytes
        .filter(|&b| (1.0..1e18).contains(&b))
        .map(|b| b as u64)
        .ok_or_else(|| "expected a size, as 500MB or 2GB".to_owned())
}

/// A number of views around a model.
pub(crate) fn views(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if (1..=64).contains(&n) => Ok(n),
        _ => Err("expected a whole number from 1 to 64".to_owned()),
    }
}

/// A wavelet by name.
pub(crate) fn wavelet(text: &str) -> Result<Wavelet, String> {
    let expected = || format!("expected lazy, kdisk:K with K from 0 to {MOST_RINGS}, or orthogonal");
    match text {
        "lazy" => Ok(Wavelet::Lazy),
        "orthogonal" => Ok(Wavelet::Orthogonal),
        _ => {
            let k = text.strip_prefix("kdisk:").and_then(|k| k.parse().ok()).filter(|&k| k <= MOST_RINGS);
            k.map(Wavelet::KDisk).ok_or_else(expected)
        }
    }
}

/// A number of frames.
pub(crate) fn frames(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if (1..=1_000_000).contains(&n) => Ok(n),
        _ => Err("expected a whole number from 1 to 1000000".to_owned()),
    }
}

/// Intervals of the paper's staircase.
pub(crate) fn intervals(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if (1..=1000).contains(&n) => Ok(n),
        _ => Err("expected a whole number from 1 to 1000".to_owned()),
    }
}

/// An EPSG code, with or without `EPSG:`.
pub(crate) fn epsg(text: &str) -> Result<Crs, String> {
    let digits = text.trim_start_matches(|c: char| c.is_ascii_alphabetic() || c == ':');
    let code: u32 = digits.parse().map_err(|_| "expected an EPSG code, as 32654 or EPSG:32654".to_owned())?;
    crs::from_epsg(code).ok_or_else(|| {
        format!("EPSG:{code} is not known: expected longitude/latitude, UTM, Web Mercator or a Japanese plane rectangular zone")
    })
}

/// How a tile's colours mean heights.
pub(crate) fn tile_encoding(text: &str) -> Result<TileEncoding, String> {
    match text {
        "terrain-rgb" => Ok(TileEncoding::TerrainRgb),
        "terrarium" => Ok(TileEncoding::Terrarium),
        "gsi" => Ok(TileEncoding::Gsi),
        _ => Err("expected terrain-rgb, terrarium or gsi".to_owned()),
    }
}

/// `Z/X/Y` of a tile.
pub(crate) fn tile(text: &str) -> Result<[u32; 3], String> {
    let numbers: Option<Vec<u32>> = text.split('/').map(|t| t.parse().ok()).collect();
    numbers
        .and_then(|v| <[u32; 3]>::try_from(v).ok())
        .filter(|&[z, x, y]| z <= 30 && x >> z == 0 && y >> z == 0)
        .ok_or_else(|| "expected Z/X/Y of a tile, as 10/906/404".to_owned())
}

/// Deepest zoom that tiles are made of: some decimetres.
const MOST_ZOOM: u32 = 24;

/// Coarsest and finest zoom of a tile tree.
pub(crate) fn zooms(text: &str) -> Result<[u32; 2], String> {
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    match [first, last].map(str::parse::<u32>) {
        [Ok(first), Ok(last)] if first <= last && last <= MOST_ZOOM => Ok([first, last]),
        _ => Err(format!("expected zooms as A..B, from 0 to {MOST_ZOOM}")),
    }
}

/// Pixels along a tile's side.
pub(crate) fn tile_px(text: &str) -> Result<u32, String> {
    text.parse().ok().filter(|n| [256, 512].contains(n)).ok_or_else(|| "expected 256 or 512".to_owned())
}

/// An address with a port; `localhost` is this computer.
#[cfg(feature = "serve")]
pub(crate) fn socket(text: &str) -> Result<std::net::SocketAddr, String> {
    let of = text.strip_prefix("localhost:").map_or_else(|| text.to_owned(), |port| format!("127.0.0.1:{port}"));
    of.parse().map_err(|_| "expected an address and a port like 127.0.0.1:8080".to_owned())
}

/// How many connections there may be.
#[cfg(feature = "serve")]
pub(crate) fn connections(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|n| (1..=100_000).contains(n)).ok_or_else(|| "expected 1 to 100000".to_owned())
}

/// A finite number.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    text.trim().parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(|| "expected a finite number".to_owned())
}

fn two(text: &str) -> Option<[usize; 2]> {
    let (a, b) = text.split_once(['x', 'X', '×'])?;
    Some([a.trim().parse().ok()?, b.trim().parse().ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_sizes() {
        assert_eq!(place("-71.3, 44.27,1916"), Ok([-71.3, 44.27, 1916.0]));
        for wrong in ["1,2", "1,2,3,4", "1,2,nan", "a,b,c", ""] {
            assert!(place(wrong).unwrap_err().contains("X,Y,Z"), "{wrong}");
        }
        assert_eq!(plan_place("-71.3,44.27"), Ok([-71.3, 44.27]));
        assert_eq!(line("-1,2; 3,4 5,-6"), Ok(vec![[-1.0, 2.0], [3.0, 4.0], [5.0, -6.0]]));
        assert!(plan_place("1").is_err() && line("1,2").is_err() && line("1,2 3").is_err());
        assert_eq!(picture_size("1920x1080"), Ok([1920, 1080]));
        assert!(picture_size("0x10").is_err() && picture_size("99999x10").is_err() && picture_size("12").is_err());
        assert!(grid_size("1x9").is_err() && grid_size("100000x100000").is_err());
        assert_eq!(grid_size("3x2"), Ok([3, 2]));
    }

    #[test]
    fn numbers_are_checked_at_the_door() {
        assert!(tolerance("nan").is_err() && tolerance("-1").is_err() && tolerance("inf").is_err());
        assert_eq!(tolerance("2.5"), Ok(2.5));
        assert_eq!(budget("1_000"), Ok(1000));
        assert!(budget("1").is_err() && budget("-5").is_err());
        assert!(fov_rad("0").is_err());
        assert_eq!((ratio("10%"), ratio("0.1"), ratio("1")), (Ok(0.1), Ok(0.1), Ok(1.0)));
        assert!(ratio("0").is_err() && ratio("101%").is_err() && ratio("half").is_err());
        assert_eq!((memory("2GB"), memory("1.5 mib")), (Ok(2_000_000_000), Ok(1_572_864)));
        assert!(memory("2").is_err() && memory("0GB").is_err() && memory("-1GB").is_err() && memory("GB").is_err());
        assert_eq!((faces("1_000"), views("8")), (Ok(1000), Ok(8)));
        assert!(faces("0").is_err() && views("0").is_err() && views("65").is_err());
        assert_eq!((wavelet("lazy"), wavelet("kdisk:2")), (Ok(Wavelet::Lazy), Ok(Wavelet::KDisk(2))));
        assert!(wavelet("kdisk:9").is_err() && wavelet("kdisk:-1").is_err() && wavelet("kdisk").is_err());
        assert_eq!(epsg("EPSG:32654").unwrap().epsg, Some(32654));
        assert!(epsg("99999").is_err());
        assert_eq!(tile("10/906/404"), Ok([10, 906, 404]));
        assert!(tile("1/2/0").is_err());
    }
}
