//! Integrals of a linear function over a triangle, whole and where it is positive.
//!
//! Own derivation: a linear function vanishes on a line, which cuts off one corner; what it cuts off is a triangle again.

/// Integral of a function with values `d` at the corners of a triangle of area `area`.
pub(super) fn integral(area: f64, d: [f64; 3]) -> f64 {
    area * (d[0] + d[1] + d[2]) / 3.0
}

/// Integral of its square.
pub(super) fn square_integral(area: f64, [a, b, c]: [f64; 3]) -> f64 {
    area * (a * a + b * b + c * c + a * b + b * c + c * a) / 6.0
}

/// Area on which the function is positive, and its integral there.
pub(super) fn positive_part(area: f64, d: [f64; 3]) -> [f64; 2] {
    let positive = d.iter().filter(|&&v| v > 0.0).count();
    match positive {
        0 => [0.0; 2],
        3 => [area, integral(area, d)],
        1 => corner(area, d, |v| v > 0.0),
        _ if d.iter().all(|&v| v >= 0.0) => [area, integral(area, d)],
        _ => {
            let [less_area, less] = corner(area, d, |v| v <= 0.0);
            [area - less_area, integral(area, d) - less]
        }
    }
}

/// Area and integral of the part around the only corner that `is_alone`.
fn corner(area: f64, d: [f64; 3], is_alone: impl Fn(f64) -> bool) -> [f64; 2] {
    let k = d.iter().position(|&v| is_alone(v)).unwrap_or(0);
    let (a, b, c) = (d[k], d[(k + 1) % 3], d[(k + 2) % 3]);
    let part = area * (a / (a - b)) * (a / (a - c));
    [part, part * a / 3.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn integrals_agree_with_dense_sums(d in prop::array::uniform3(-5.0..5.0f64), area in 0.1..9.0f64) {
            const N: usize = 120;
            let (mut all, mut squares, mut wet, mut above, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for i in 0..N {
                for j in 0..N - i {
                    let mut add = |u: f64, v: f64| {
                        let value = d[0] + (d[1] - d[0]) * u / N as f64 + (d[2] - d[0]) * v / N as f64;
                        (all, squares, count) = (all + value, squares + value * value, count + 1.0);
                        if value > 0.0 {
                            (wet, above) = (wet + 1.0, above + value);
                        }
                    };
                    add(i as f64 + 1.0 / 3.0, j as f64 + 1.0 / 3.0);
                    if i + j + 1 < N {
                        add(i as f64 + 2.0 / 3.0, j as f64 + 2.0 / 3.0);
                    }
                }
            }
            let near = |a: f64, b: f64, within: f64| (a - b * area / count).abs() < within * area;
            prop_assert!(near(integral(area, d), all, 1e-9));
            prop_assert!(near(square_integral(area, d), squares, 1e-2));
            let [wet_area, volume] = positive_part(area, d);
            prop_assert!(near(wet_area, wet, 2e-2) && near(volume, above, 1e-2));
        }
    }

    #[test]
    fn corners_at_zero_belong_to_either_side() {
        assert_eq!(positive_part(2.0, [0.0, 0.0, 0.0]), [0.0; 2]);
        assert_eq!(positive_part(2.0, [0.0, 3.0, 3.0]), [2.0, 4.0]);
        assert_eq!(positive_part(2.0, [0.0, 0.0, 3.0]), [2.0, 2.0]);
        assert_eq!(positive_part(2.0, [0.0, -1.0, -3.0]), [0.0; 2]);
        assert_eq!(positive_part(2.0, [0.0, -3.0, 3.0]), [1.0, 1.0]);
    }
}
