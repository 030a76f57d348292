//! Water at a level on a terrain surface: what it floods, how deep, and how much it is.
//!
//! The part of a triangle below the level is convex, so water passes from triangle to triangle exactly where a shared edge
//! dips below the level.

use super::PlanIndex;
use super::overlay::triangle_area;
use super::prism::positive_part;
use glam::DVec2;
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// Triangles handled by one task; also the grouping of sums, so part of the result's last bits.
const CHUNK: usize = 1 << 14;

/// What lies under water.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Water {
    /// Flooded area in plan, square metres.
    pub area_m2: f64,
    /// Volume of the water, cubic metres.
    pub volume_m3: f64,
    /// Greatest depth in metres.
    pub greatest_depth_m: f64,
    /// Whether the water of [`water_from`] stands at the border of the surface: it would run on beyond what is known.
    pub reaches_border: bool,
}

impl Water {
    /// Volume over area, metres; 0 where nothing is flooded.
    pub fn mean_depth_m(&self) -> f64 {
        if self.area_m2 > 0.0 { self.volume_m3 / self.area_m2 } else { 0.0 }
    }

    fn add(&mut self, other: &Self) {
        self.area_m2 += other.area_m2;
        self.volume_m3 += other.volume_m3;
        self.greatest_depth_m = self.greatest_depth_m.max(other.greatest_depth_m);
    }
}

/// All that lies below a level.
///
/// # Panics
/// When a triangle names a vertex that the mesh does not have.
pub fn water_below(mesh: &TriangleMesh, level_m: f64) -> Water {
    let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    on_triangles(mesh, &all, level_m)
}

/// What water that wells up at `seed` to a level floods: all below the level that is joined with the seed below it.
/// `None` where the seed lies outside the surface; nothing is flooded where it lies above the level. Triangles are
/// neighbours where two corners lie at the same place in plan and height, whatever their numbers.
///
/// # Panics
/// When a triangle names a vertex that the mesh does not have.
pub fn water_from(index: &PlanIndex<'_>, level_m: f64, seed: DVec2) -> Option<Water> {
    let start = super::footing(index, seed)?;
    if start.height_m.partial_cmp(&level_m) != Some(std::cmp::Ordering::Less) {
        return Some(Water::default());
    }
    let mesh = index.mesh();
    let wet = |i: u32| mesh.positions[i as usize].z < level_m;
    let neighbours = neighbours(mesh);
    let mut flooded = vec![false; mesh.triangles.len()];
    flooded[start.triangle as usize] = true;
    let (mut queue, mut reaches_border) = (vec![start.triangle], false);
    while let Some(t) = queue.pop() {
        let corners = mesh.triangles[t as usize];
        for k in 0..3 {
            if !(wet(corners[k]) || wet(corners[(k + 1) % 3])) {
                continue;
            }
            match neighbours[t as usize][k] {
                NOBODY => reaches_border = true,
                next if !flooded[next as usize] => {
                    flooded[next as usize] = true;
                    queue.push(next);
                }
                _ => {}
            }
        }
    }
    let list: Vec<u32> = (0..flooded.len() as u32).filter(|&t| flooded[t as usize]).collect();
    Some(Water { reaches_border, ..on_triangles(mesh, &list, level_m) })
}

fn on_triangles(mesh: &TriangleMesh, triangles: &[u32], level_m: f64) -> Water {
    let chunk = |triangles: &[u32]| {
        let mut sums = Water::default();
        for &t in triangles {
            let corners = mesh.corners(t as usize);
            let depths = corners.map(|p| level_m - p.z);
            let [area_m2, volume_m3] = positive_part(triangle_area(corners), depths);
            if area_m2 > 0.0 {
                let greatest_depth_m = depths.into_iter().fold(0.0, f64::max);
                sums.add(&Water { area_m2, volume_m3, greatest_depth_m, reaches_border: false });
            }
        }
        sums
    };
    let mut total = Water::default();
    triangles.par_chunks(CHUNK).map(chunk).collect::<Vec<_>>().iter().for_each(|c| total.add(c));
    total
}

/// No triangle.
const NOBODY: u32 = u32::MAX;

/// The triangle beyond each edge, from corner k to the next.
fn neighbours(mesh: &TriangleMesh) -> Vec<[u32; 3]> {
    let places = places(mesh);
    let mut edges: Vec<([u32; 2], u32)> = (0..mesh.triangles.len() as u32)
        .into_par_iter()
        .flat_map_iter(|t| {
            let corners = mesh.triangles[t as usize].map(|i| places[i as usize]);
            (0..3u32).map(move |k| {
                let (p, q) = (corners[k as usize], corners[(k as usize + 1) % 3]);
                ([p.min(q), p.max(q)], t * 3 + k)
            })
        })
        .collect();
    edges.par_sort_unstable();
    let mut neighbours = vec![[NOBODY; 3]; mesh.triangles.len()];
    for pair in edges.windows(2) {
        if pair[0].0 == pair[1].0 {
            let (p, q) = (pair[0].1, pair[1].1);
            neighbours[p as usize / 3][p as usize % 3] = q / 3;
            neighbours[q as usize / 3][q as usize % 3] = p / 3;
        }
    }
    neighbours
}

/// For each vertex the first one at its place.
fn places(mesh: &TriangleMesh) -> Vec<u32> {
    let p = |i: u32| mesh.positions[i as usize];
    let order = |a: u32, b: u32| {
        let (a, b) = (p(a), p(b));
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
    };
    let mut sorted: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    sorted.par_sort_unstable_by(|&a, &b| order(a, b).then(a.cmp(&b)));
    let mut places = vec![0; sorted.len()];
    let mut first = 0;
    for (k, &v) in sorted.iter().enumerate() {
        if k == 0 || order(first, v).is_ne() {
            first = v;
        }
        places[v as usize] = first;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::super::tests::{grid, plane_tin, pyramid, rough, shifted};
    use super::super::volume_between;
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    #[test]
    fn a_pit_fills_like_a_pyramid() {
        let mut pit = pyramid(6.0, 5.0);
        pit.positions.iter_mut().for_each(|p| *p = DVec3::new(p.x + 6.4e6, p.y + 1.5e5, -p.z));
        let seed = DVec2::new(6.4e6 + 3.1, 1.5e5 + 2.9);
        for water in [water_below(&pit, -2.5), water_from(&PlanIndex::new(&pit), -2.5, seed).unwrap()] {
            assert!((water.area_m2 - 9.0).abs() < 1e-7 && (water.volume_m3 - 7.5).abs() < 1e-7, "{water:?}");
            assert!((water.greatest_depth_m - 2.5).abs() < 1e-12 && (water.mean_depth_m() - 2.5 / 3.0).abs() < 1e-7);
            assert!(!water.reaches_border);
        }
        assert!(water_from(&PlanIndex::new(&pit), 1.0, seed).unwrap().reaches_border);
    }

    #[test]
    fn water_stays_in_its_valley_until_the_pass_is_under_it() {
        // two valleys, a pass of 3 m between them; corners are not shared by number
        let welded = grid(8, |x, _| if x == 4.0 { 3.0 } else { (x - 4.0).abs() - 4.0 });
        let positions = welded.triangles.iter().flatten().map(|&i| welded.positions[i as usize]).collect();
        let triangles = (0..welded.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let loose = TriangleMesh::new(positions, triangles);
        let seed = DVec2::new(2.5, 4.0);
        for mesh in [&welded, &loose] {
            let index = PlanIndex::new(mesh);
            let (all, west) = (water_below(mesh, 2.0), water_from(&index, 2.0, seed).unwrap());
            assert!((all.volume_m3 - 2.0 * west.volume_m3).abs() < 1e-9);
            let high = water_from(&index, 3.5, seed).unwrap();
            assert!((high.volume_m3 - water_below(mesh, 3.5).volume_m3).abs() < 1e-9);
            assert_eq!(water_from(&index, -9.0, seed), Some(Water::default()));
            assert_eq!(water_from(&index, 2.0, DVec2::new(-1.0, 0.0)), None);
            assert_eq!(water_from(&index, f64::NAN, seed), Some(Water::default()));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn water_is_the_fill_up_to_a_level_plane(seed in any::<u64>(), level in -4.0..6.0f64) {
            let mesh = rough(7, seed);
            let mut lid = plane_tin(7, [0.0, 0.0]);
            lid.positions.iter_mut().for_each(|p| p.z = level);
            let water = water_below(&shifted(mesh.clone()), level);
            let fill = volume_between(&mesh, &PlanIndex::new(&lid));
            prop_assert!((water.volume_m3 - fill.fill_m3).abs() < 1e-8);
            prop_assert!((water.area_m2 - fill.fill_m2).abs() < 1e-8);
        }
    }
}
