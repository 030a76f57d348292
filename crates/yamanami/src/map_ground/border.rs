//! How far a grid's samples lie from others, for blending.
//!
//! Based on: G. Borgefors, "Distance transformations in digital images", 1986 (the chamfer distance: two passes, at most
//! 8 % off).

/// Distance of every sample of a square grid to the nearest one of `from`, in samples; beyond the grid there is none.
pub(super) fn distance_from(from: &[bool], width: usize) -> Vec<f32> {
    const FAR: f32 = 1e9;
    let mut distance: Vec<f32> = from.iter().map(|&f| if f { 0.0 } else { FAR }).collect();
    let height = from.len() / width;
    let mut pass = |rows: &mut dyn Iterator<Item = usize>, back: isize| {
        for row in rows {
            let behind = row.checked_add_signed(back).filter(|&r| r < height);
            if let Some(behind) = behind {
                for column in 0..width {
                    let mut d = distance[behind * width + column] + 1.0;
                    if column > 0 {
                        d = d.min(distance[behind * width + column - 1] + std::f32::consts::SQRT_2);
                    }
                    if column + 1 < width {
                        d = d.min(distance[behind * width + column + 1] + std::f32::consts::SQRT_2);
                    }
                    let to = &mut distance[row * width + column];
                    *to = to.min(d);
                }
            }
            let line = &mut distance[row * width..][..width];
            for column in 1..width {
                line[column] = line[column].min(line[column - 1] + 1.0);
            }
            for column in (1..width).rev() {
                line[column - 1] = line[column - 1].min(line[column] + 1.0);
            }
        }
    };
    pass(&mut (0..height), -1);
    pass(&mut (0..height).rev(), 1);
    distance
}

/// 0 at the border to 1 `width` away from it, smoothly.
#[inline]
pub(super) fn ramp(distance: f32, width: f32) -> f32 {
    let t = (distance / width).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_near_the_true_ones() {
        let width = 41;
        let mut from = vec![false; width * width];
        from[17 * width + 9] = true;
        for (k, d) in distance_from(&from, width).into_iter().enumerate() {
            let exact = ((k % width) as f32 - 9.0).hypot((k / width) as f32 - 17.0);
            assert!((d - exact).abs() <= 0.09 * exact, "{d} {exact}");
        }
        assert!(distance_from(&[false; 9], 3).iter().all(|&d| d > 1e6));
    }
}
