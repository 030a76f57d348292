//! Measures of terrain surfaces that are exact on all their triangles: heights, sections, volumes, water, differences.
//!
//! A surface here is any [`yamanami_core::TriangleMesh`] that is 2.5D: seen from above its triangles do not overlap.
//! Triangles that stand upright or have a corner that is not finite have no place in plan and measure nothing.
//! Nothing is sampled: what is linear on a triangle, or on the overlap of two, is integrated as such.
//!
//! The uses are those that Hiraoka, Yamada and Urahama name for TINs in three-dimensional GIS ("Fast drawing of TINs for
//! 3D GIS", 2005).

mod heights;
mod locate;
mod overlay;
mod plane;
mod prism;
mod section;
mod twins;
mod vertical;
mod volume;
mod water;

pub use heights::{Footing, footing};
pub use locate::PlanIndex;
pub use section::{Section, SectionPoint, section};
pub use vertical::{VerticalDifference, vertical_difference};
pub use volume::{VolumeBetween, volume_between};
pub use water::{Water, water_below, water_from};

#[cfg(test)]
mod tests {
    //! Surfaces for the tests of this folder.

    use glam::DVec3;
    use yamanami_core::TriangleMesh;

    /// A surface over the square from 0 to `n` with a vertex each metre.
    pub(super) fn grid(n: u32, height: impl Fn(f64, f64) -> f64) -> TriangleMesh {
        let places = (0..=n).flat_map(|y| (0..=n).map(move |x| (f64::from(x), f64::from(y))));
        let positions = places.map(|(x, y)| DVec3::new(x, y, height(x, y))).collect();
        let cells = (0..n).flat_map(|y| (0..n).map(move |x| y * (n + 1) + x));
        let triangles = cells.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]).collect();
        TriangleMesh::new(positions, triangles)
    }

    /// A plane through the origin.
    pub(super) fn plane_tin(n: u32, gradient: [f64; 2]) -> TriangleMesh {
        grid(n, |x, y| gradient[0] * x + gradient[1] * y)
    }

    /// Irregular ground with random heights and diagonals within 5 m of 0, straight at its border.
    pub(super) fn rough(n: u32, seed: u64) -> TriangleMesh {
        let mut state = seed | 1;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) as f64 / f64::from(1u32 << 31)) - 0.5
        };
        let mut mesh = grid(n, |_, _| 0.0);
        for p in &mut mesh.positions {
            let inner = p.x > 0.0 && p.y > 0.0 && p.x < f64::from(n) && p.y < f64::from(n);
            let by = if inner { 0.4 } else { 0.0 };
            *p += DVec3::new(by * random(), by * random(), 10.0 * random());
        }
        for pair in mesh.triangles.chunks_mut(2) {
            if random() > 0.0 {
                let [a, b, c, d] = [pair[0][0], pair[0][1], pair[0][2], pair[1][2]];
                pair.copy_from_slice(&[[a, b, d], [b, c, d]]);
            }
        }
        mesh
    }

    /// The same surface where plane coordinates are large.
    pub(super) fn shifted(mut mesh: TriangleMesh) -> TriangleMesh {
        mesh.positions.iter_mut().for_each(|p| *p += DVec3::new(6.4e6, 1.5e5, 0.0));
        mesh
    }

    /// A pyramid over the square from 0 to `side_m`.
    pub(super) fn pyramid(side_m: f64, height_m: f64) -> TriangleMesh {
        let corners = [[0.0, 0.0], [side_m, 0.0], [side_m, side_m], [0.0, side_m]];
        let mut positions: Vec<DVec3> = corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect();
        positions.push(DVec3::new(side_m / 2.0, side_m / 2.0, height_m));
        TriangleMesh::new(positions, (0..4).map(|k| [k, (k + 1) % 4, 4]).collect())
    }
}
