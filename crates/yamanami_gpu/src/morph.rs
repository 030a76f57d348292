//! Geomorphing: a vertex rises from its coarser place as its error grows on the screen, so that nothing pops.
//!
//! The same formula is `morph_weight` in `shaders/frame.wgsl`. A controller that shows a vertex when its node's error
//! exceeds `tau_px` pixels finds it at weight 0 then, and at weight 1 once the error is `1 + width` times that.

/// Nearest distance to a node's bound that counts, metres.
const LEAST_DISTANCE_M: f32 = 1e-3;

/// How vertices fade in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Morph {
    /// Error in pixels at which the controller shows a node: weight 0.
    pub tau_px: f32,
    /// Weight 1 is reached at `(1 + width) * tau_px`. Zero switches morphing off.
    pub width: f32,
}

/// Share of its detail that a vertex shows, 0 to 1: its node's error is seen from `distance_m` metres away (measured
/// to the vertex), less the bound's radius, in a picture with `pixels_per_radian`.
#[inline]
pub fn morph_weight(error_m: f32, bound_radius_m: f32, distance_m: f32, pixels_per_radian: f32, morph: Morph) -> f32 {
    if morph.width <= 0.0 {
        return 1.0;
    }
    let error_px = error_m * pixels_per_radian / (distance_m - bound_radius_m).max(LEAST_DISTANCE_M);
    ((error_px / morph.tau_px - 1.0) / morph.width).clamp(0.0, 1.0)
}

/// Height at which a vertex is drawn: its own, less the detail that is not shown yet.
#[inline]
pub fn morphed_height_m(height_m: f32, detail_m: f32, weight: f32) -> f32 {
    height_m - detail_m * (1.0 - weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::UNBOUNDED_M;
    use proptest::prelude::*;

    const MORPH: Morph = Morph { tau_px: 2.0, width: 0.5 };

    #[test]
    fn a_vertex_comes_in_flat_and_ends_whole() {
        // 1 m at 500 px a radian is 2 px from 250 m, 3 px from 166.7 m.
        let weight = |distance_m| morph_weight(1.0, 10.0, distance_m, 500.0, MORPH);
        assert_eq!(weight(261.0), 0.0);
        assert!((weight(210.0) - 0.5).abs() < 1e-5);
        assert_eq!(weight(176.0), 1.0);
        assert_eq!(weight(5.0), 1.0, "inside the bound");
        assert_eq!(morphed_height_m(7.0, 3.0, 0.0), 4.0);
        assert_eq!(morphed_height_m(7.0, 3.0, 1.0), 7.0);
    }

    #[test]
    fn base_vertices_and_no_morphing_stay_whole() {
        assert_eq!(morph_weight(UNBOUNDED_M, 0.0, 1e6, 500.0, MORPH), 1.0);
        assert_eq!(morph_weight(0.0, 0.0, 1e6, 500.0, Morph { tau_px: 2.0, width: 0.0 }), 1.0);
    }

    proptest! {
        #[test]
        fn nearer_is_never_less(error in 0f32..100.0, radius in 0f32..1e3, near in 0f32..1e5, step in 0f32..1e4) {
            let weight = |d| morph_weight(error, radius, d, 700.0, MORPH);
            prop_assert!(weight(near) >= weight(near + step));
            prop_assert!((0.0..=1.0).contains(&weight(near)));
        }
    }
}
