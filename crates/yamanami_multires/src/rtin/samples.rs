//! Where a front lies at a place, and all samples against the triangles over them.

use super::build::Rtin;
use super::triangle::Triangle;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use yamanami_core::ActiveSet;

/// What a front shows at a place of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrontPlace {
    /// Height of the front there, metres.
    pub height_m: f64,
    /// Corners of the triangle there, counter-clockwise, metres.
    pub corners: [DVec3; 3],
    /// The place's barycentric coordinates, one a corner.
    pub weights: [f64; 3],
}

/// Triangles of this many splits below the base are measured at once.
const SHARE_DEPTH: u32 = 7;

impl Rtin {
    /// What a front shows at a place; off the base square, at the nearest place on it.
    pub fn front_at(&self, active: &(impl ActiveSet + ?Sized), place_m: DVec2) -> FrontPlace {
        let most = f64::from(self.diamonds.half_side());
        let place = (place_m / self.ground.unit_m()).clamp(DVec2::splat(-most), DVec2::splat(most)).to_array();
        let base = Triangle::base(self.diamonds.half_side());
        // where no base triangle holds a place (it is not a number), any will do
        let mut t = base.into_iter().find(|t| t.holds(place)).unwrap_or(base[0]);
        while self.diamonds.number(t.middle()).is_some_and(|n| active.is_active(n)) {
            t = t.split()[t.half_at(place)];
        }
        let corners = t.corners.map(|p| self.ground.point(p));
        let weights = t.weights(place);
        FrontPlace { height_m: (0..3).map(|i| weights[i] * corners[i].z).sum(), corners, weights }
    }

    /// Goes through the triangles of a front on all cores. `visit` is given a sum of its own, a triangle's corners
    /// (counter-clockwise) and the samples it owns, all in metres: every sample of the field that can be a vertex is owned
    /// by one triangle. The sums are merged in a fixed order, whatever the number of threads.
    pub fn fold_samples<T: Send>(
        &self,
        active: &(impl ActiveSet + Sync + ?Sized),
        start: impl Fn() -> T + Sync,
        visit: impl Fn(&mut T, [DVec3; 3], &[DVec3]) + Sync,
        mut merge: impl FnMut(T, T) -> T,
    ) -> T {
        let mut parts = Triangle::base(self.diamonds.half_side()).to_vec();
        for _ in 0..SHARE_DEPTH {
            let halves = |t: &Triangle| match self.diamonds.number(t.middle()) {
                Some(n) if active.is_active(n) => t.split().to_vec(),
                _ => vec![*t],
            };
            parts = parts.iter().flat_map(halves).collect();
        }
        let sum_of = |part: &Triangle| {
            let (mut sum, mut samples) = (start(), Vec::new());
            self.walk(
                &[*part],
                active,
                |_, _| (),
                |t| {
                    samples.clear();
                    self.samples_of(t, &mut samples);
                    visit(&mut sum, t.corners.map(|p| self.ground.point(p)), &samples);
                },
            );
            sum
        };
        let sums: Vec<T> = parts.par_iter().map(sum_of).collect();
        sums.into_iter().reduce(&mut merge).unwrap_or_else(&start)
    }

    /// Calls `visit` on all cores, in no order, with every sample of the field that can be a vertex, once, and the corners of
    /// the front's triangle it lies in, all in metres.
    pub fn for_each_sample(&self, active: &(impl ActiveSet + Sync + ?Sized), visit: impl Fn(DVec3, [DVec3; 3]) + Sync) {
        let each = |(): &mut (), corners: [DVec3; 3], samples: &[DVec3]| {
            samples.iter().for_each(|&sample| visit(sample, corners));
        };
        self.fold_samples(active, || (), each, |(), ()| ());
    }

    /// Samples that a triangle owns.
    fn samples_of(&self, t: &Triangle, out: &mut Vec<DVec3>) {
        let range = |axis: usize, k: u32| {
            let [low, high] = t.extent(axis);
            let reach = self.diamonds.reach(k);
            // the least step not below the low side
            (-(-low >> k)).max(-reach)..=(high >> k).min(reach)
        };
        for k in 1..=self.ground.grids() {
            for (y, x) in range(1, k).flat_map(|y| range(0, k).map(move |x| (y, x))) {
                // samples of even places are a coarser grid's
                let is_own = k == self.ground.grids() || (x | y) & 1 == 1;
                let place = [x << k, y << k];
                if is_own && t.owns(place) {
                    out.push(self.ground.point(place));
                }
            }
        }
    }
}
