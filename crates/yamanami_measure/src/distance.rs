//! Two-sided distance between two surfaces, by samples.
//!
//! Based on: Cignoni, Rocchini, Scopigno, "Metro: measuring error on simplified surfaces", 1998. Samples are spread
//! evenly by area; where each falls depends on its number and the seed only, so equal input gives equal output on any
//! number of threads. Vertices count for the Hausdorff distance beside the samples.

use crate::SurfaceIndex;
use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// Distance from points of one surface to another surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct OneWayDistance {
    /// Root of the mean squared distance of the samples in metres.
    pub rms_m: f64,
    /// Mean distance of the samples in metres.
    pub mean_m: f64,
    /// Largest distance of any sample or vertex in metres.
    pub max_m: f64,
    /// The point that is farthest.
    pub worst: DVec3,
}

/// Distances between two surfaces, both ways.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct SurfaceDistance {
    /// From points of the first to the second.
    pub a_to_b: OneWayDistance,
    /// From points of the second to the first.
    pub b_to_a: OneWayDistance,
    /// Root of the mean squared distance of all samples of both sides, in metres.
    pub rms_m: f64,
    /// The larger of both greatest distances in metres: the Hausdorff distance, from below.
    pub hausdorff_m: f64,
}

/// Samples handled by one task; also the grouping of sums, so part of the result's last bits.
const SAMPLE_CHUNK: usize = 4096;

/// Measures `a` and `b` against each other with `samples` points on each. Infinite where only one of them has
/// triangles; zero where neither has.
///
/// # Panics
/// When a triangle names a vertex that its mesh does not have.
pub fn surface_distance(a: &TriangleMesh, b: &TriangleMesh, samples: usize, seed: u64) -> SurfaceDistance {
    let (index_a, index_b) = rayon::join(|| SurfaceIndex::new(a), || SurfaceIndex::new(b));
    let a_to_b = one_way(a, &index_b, samples, seed);
    let b_to_a = one_way(b, &index_a, samples, seed.wrapping_add(1));
    SurfaceDistance {
        a_to_b,
        b_to_a,
        rms_m: ((a_to_b.rms_m.powi(2) + b_to_a.rms_m.powi(2)) / 2.0).sqrt(),
        hausdorff_m: a_to_b.max_m.max(b_to_a.max_m),
    }
}

/// Sums over a run of points.
#[derive(Clone, Copy)]
struct Sums {
    sum: f64,
    sum_squares: f64,
    max: f64,
    worst: DVec3,
}

impl Sums {
    const NONE: Self = Self { sum: 0.0, sum_squares: 0.0, max: -1.0, worst: DVec3::ZERO };

    fn add(mut self, point: DVec3, to: &SurfaceIndex) -> Self {
        let distance = to.closest(point).map_or(f64::INFINITY, |c| c.distance_m);
        self.sum += distance;
        self.sum_squares += distance * distance;
        if distance > self.max {
            (self.max, self.worst) = (distance, point);
        }
        self
    }

    fn join(self, other: Self) -> Self {
        let worse = if other.max > self.max { other } else { self };
        Self {
            sum: self.sum + other.sum,
            sum_squares: self.sum_squares + other.sum_squares,
            max: worse.max,
            worst: worse.worst,
        }
    }
}

fn one_way(from: &TriangleMesh, to: &SurfaceIndex, samples: usize, seed: u64) -> OneWayDistance {
    let mut area_up_to = Vec::with_capacity(from.triangles.len());
    let mut area = 0.0;
    for t in 0..from.triangles.len() {
        let [a, b, c] = from.corners(t);
        let of_this = 0.5 * (b - a).cross(c - a).length();
        area += if of_this.is_finite() { of_this } else { 0.0 };
        area_up_to.push(area);
    }
    if from.triangles.is_empty() {
        let max_m = if to.closest(DVec3::ZERO).is_some() { f64::INFINITY } else { 0.0 };
        return OneWayDistance { rms_m: max_m, mean_m: max_m, max_m, worst: DVec3::ZERO };
    }
    let samples = if area > 0.0 { samples } else { 0 };
    let sampled = in_order(
        samples,
        |k| {
            let random = |salt: u64| unit(seed, 3 * k as u64 + salt);
            let at = (k as f64 + random(0)) / samples as f64 * area;
            let t = area_up_to.partition_point(|&up_to| up_to <= at).min(area_up_to.len() - 1);
            let [a, b, c] = from.corners(t);
            let (mut u, mut v) = (random(1), random(2));
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            Some(a + (b - a) * u + (c - a) * v)
        },
        to,
    );
    let mut used = vec![false; from.positions.len()];
    from.triangles.iter().flatten().for_each(|&i| used[i as usize] = true);
    let vertices = in_order(from.positions.len(), |i| Some(from.positions[i]).filter(|p| used[i] && p.is_finite()), to);
    let count = samples.max(1) as f64;
    let worst = sampled.join(vertices);
    OneWayDistance {
        rms_m: (sampled.sum_squares / count).sqrt(),
        mean_m: sampled.sum / count,
        max_m: worst.max.max(0.0),
        worst: worst.worst,
    }
}

/// Sums over points given by number, in parallel but added in order.
fn in_order(count: usize, point: impl Fn(usize) -> Option<DVec3> + Sync, to: &SurfaceIndex) -> Sums {
    let chunks: Vec<Sums> = (0..count.div_ceil(SAMPLE_CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let end = count.min((chunk + 1) * SAMPLE_CHUNK);
            (chunk * SAMPLE_CHUNK..end).filter_map(&point).fold(Sums::NONE, |sums, p| sums.add(p, to))
        })
        .collect();
    chunks.into_iter().fold(Sums::NONE, Sums::join)
}

/// A number in 0..1 from a seed and a counter (SplitMix64: Steele, Lea, Flood, 2014).
fn unit(seed: u64, counter: u64) -> f64 {
    let mut z = seed.wrapping_add(counter.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64, side: f64) -> TriangleMesh {
        TriangleMesh {
            positions: [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(|[x, y]| DVec3::new(x, y, z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn parallel_squares_are_their_gap_apart() {
        let d = surface_distance(&square(0.0, 10.0), &square(2.5, 10.0), 1000, 7);
        assert_eq!((d.hausdorff_m, d.a_to_b.mean_m), (2.5, 2.5));
        assert!((d.rms_m - 2.5).abs() < 1e-12);
    }

    #[test]
    fn the_two_ways_differ_where_one_surface_is_larger() {
        let d = surface_distance(&square(0.0, 10.0), &square(0.0, 20.0), 20_000, 7);
        assert!(d.a_to_b.max_m < 1e-12, "the small square lies in the large one");
        assert!((d.b_to_a.max_m - 200f64.sqrt()).abs() < 1e-9, "its far corner");
        assert_eq!(d.b_to_a.worst, DVec3::new(20.0, 20.0, 0.0));
        // mean square distance to [0,10]² over [0,20]²: 2 · (10²/3)/2 by symmetry
        assert!((d.b_to_a.rms_m - (100.0f64 / 3.0).sqrt()).abs() < 0.05, "{}", d.b_to_a.rms_m);
    }

    #[test]
    fn equal_input_gives_equal_output_on_any_number_of_threads() {
        let (a, b) = (square(0.0, 10.0), square(1.0, 13.0));
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| surface_distance(&a, &b, 10_000, 3))
        };
        assert_eq!(with(1), with(4));
        assert_ne!(with(1), surface_distance(&a, &b, 10_000, 4));
    }

    #[test]
    fn nothing_is_infinitely_far_from_something() {
        let nothing = TriangleMesh::default();
        assert_eq!(surface_distance(&nothing, &square(0.0, 1.0), 10, 1).hausdorff_m, f64::INFINITY);
        assert_eq!(surface_distance(&nothing, &nothing, 10, 1).hausdorff_m, 0.0);
    }
}
