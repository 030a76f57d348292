//! The lazy wavelet transform of a grid, in place: analysis turns heights into detail coefficients, synthesis back.
//!
//! Based on: Hashida, Kanai, Kishinami, equations (1) and (2); Sweldens, "The lifting scheme", 1996. From fine to coarse,
//! an odd sample becomes its height less the mean of the two ends of the edge it bisects (horizontal, vertical or
//! diagonal); even samples keep theirs. On a grid that is not 2^k + 1 wide, a sample whose right or lower end lies past
//! the border is predicted from the end it has.

/// Replaces the heights of a `width` × `height` grid by detail coefficients on every level.
pub fn analyse(heights_m: &mut [f32], width: usize, height: usize) {
    let mut s = 1;
    while s < width.max(height) {
        lift_level(heights_m, width, height, s, |z, prediction| z - prediction);
        s *= 2;
    }
}

/// Replaces detail coefficients by heights: the inverse of [`analyse`], up to rounding in the last bit.
pub fn synthesise(details_m: &mut [f32], width: usize, height: usize) {
    let mut s = width.max(height).next_power_of_two();
    while s >= 1 {
        lift_level(details_m, width, height, s, |w, prediction| w + prediction);
        s /= 2;
    }
}

/// One level: every odd sample of the lattice of spacing `s` becomes `lift(itself, prediction)`.
fn lift_level(grid: &mut [f32], width: usize, height: usize, s: usize, lift: impl Fn(f32, f32) -> f32 + Copy) {
    for row in (0..height).step_by(2 * s) {
        lift_along(&mut grid[row * width..(row + 1) * width], s, lift);
    }
    for row in (s..height).step_by(2 * s) {
        let (above, rest) = grid.split_at_mut(row * width);
        let above = &above[(row - s) * width..][..width];
        let (odd, rest) = rest.split_at_mut(width);
        let below = if row + s < height { &rest[(s - 1) * width..][..width] } else { above };
        lift_between(odd, above, below, s, lift);
    }
}

/// An even row: its odd samples bisect horizontal edges.
fn lift_along(row: &mut [f32], s: usize, lift: impl Fn(f32, f32) -> f32) {
    if s == 1 {
        // a window of three keeps the loop free of bounds checks
        let mut i = 0;
        while let Some([a, z, b]) = row.get_mut(i..i + 3) {
            *z = lift(*z, 0.5 * (*a + *b));
            i += 2;
        }
    } else {
        for x in (s..row.len().saturating_sub(s)).step_by(2 * s) {
            row[x] = lift(row[x], 0.5 * (row[x - s] + row[x + s]));
        }
    }
    let last = row.len() - 1;
    let odd = last / s * s;
    if (odd / s) % 2 == 1 {
        row[odd] = lift(row[odd], row[odd - s]);
    }
}

/// An odd row: its even samples bisect vertical edges, its odd ones diagonals from upper left to lower right.
fn lift_between(odd: &mut [f32], above: &[f32], below: &[f32], s: usize, lift: impl Fn(f32, f32) -> f32) {
    let width = odd.len();
    if s == 1 {
        let pairs = odd
            .chunks_exact_mut(2)
            .zip(above.chunks_exact(2))
            .zip(below.chunks_exact(2).zip(below[2.min(width)..].iter().step_by(2)));
        for ((z, a), (b, &b_right)) in pairs {
            z[0] = lift(z[0], 0.5 * (a[0] + b[0]));
            z[1] = lift(z[1], 0.5 * (a[0] + b_right));
        }
        let done = (width - 1) / 2 * 2;
        for x in done..width {
            let (left, right) = (x - x % 2, if x % 2 == 0 { x } else { x - 1 });
            odd[x] = lift(odd[x], 0.5 * (above[left] + below[right]));
        }
        return;
    }
    for x in (0..width).step_by(2 * s) {
        odd[x] = lift(odd[x], 0.5 * (above[x] + below[x]));
    }
    for x in (s..width).step_by(2 * s) {
        let right = if x + s < width { x + s } else { x - s };
        odd[x] = lift(odd[x], 0.5 * (above[x - s] + below[right]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn synthesis_inverts_analysis(width in 2usize..70, height in 2usize..70, seed in any::<u32>()) {
            let grid: Vec<f32> = (0..width * height)
                .map(|i| ((i as u32).wrapping_mul(2_654_435_761).wrapping_add(seed) >> 20) as f32)
                .collect();
            let mut work = grid.clone();
            analyse(&mut work, width, height);
            synthesise(&mut work, width, height);
            // integers below 2^12 and halves are exact in f32
            prop_assert_eq!(work, grid);
        }
    }

    #[test]
    fn a_plane_has_no_detail() {
        let (w, h) = (33, 33);
        let mut grid: Vec<f32> = (0..w * h).map(|i| (i % w) as f32 * 3.0 - (i / w) as f32 * 2.0).collect();
        analyse(&mut grid, w, h);
        let details =
            grid.iter().enumerate().filter(|(i, z)| ![0, w - 1, w * (h - 1), w * h - 1].contains(i) && **z != 0.0);
        assert_eq!(details.count(), 0);
    }
}
