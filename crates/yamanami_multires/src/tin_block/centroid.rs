//! The paper's decimation of a TIN: surroundings of triangles are fanned from their centroids, those of least slope first.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS" (三次元GISのためのTINの高速描画法),
//! APA, 2005, section 3.1. A triangle that "touches" the picked one shares a vertex with it: with edges only, a step would
//! add triangles. Nothing bounds the error: the engine's own levels come from `collapse`.

use super::net::Net;
use super::picks::Picks;
use crate::MultiresError;
use yamanami_core::TriangleMesh;

/// How the paper's choice of the next triangle is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CostReading {
    /// The least mean slope of the triangles that would go.
    #[default]
    Plain,
    /// The least sum of their slopes: the paper says both.
    Sum,
    /// The mean; triangles made in a pass are not picked again in it. A pass ends with a level, or where nothing is left to
    /// pick.
    OncePerPass,
    /// Not the paper's, but what it sets out to do, "thin out where the slope changes little": the least root mean square
    /// distance of the vertices in and around the hole from the plane that fits them best.
    PlaneDeviation,
}

impl CostReading {
    /// All readings.
    pub const ALL: [Self; 4] = [Self::Plain, Self::Sum, Self::OncePerPass, Self::PlaneDeviation];

    /// In a few words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "mean slope",
            Self::Sum => "sum of slopes",
            Self::OncePerPass => "mean slope, once a pass",
            Self::PlaneDeviation => "deviation from a plane",
        }
    }
}

/// Levels of a TIN by the paper's decimation: the source, a half, a quarter, … of its triangles, `levels` in all with the
/// source. Only places and triangles are kept. The outer border and those of holes stay as they are, no triangle overlaps another or turns over
/// in plan. A level that has more than its share has nothing left that can be taken out.
pub fn centroid_chain(
    source: &TriangleMesh,
    levels: usize,
    reading: CostReading,
) -> Result<Vec<TriangleMesh>, MultiresError> {
    check(source)?;
    let mut chain = vec![TriangleMesh::new(source.positions.clone(), source.triangles.clone())];
    let mut work = Work::new(Net::new(source), reading);
    for level in 1..levels {
        work.reduce_to(source.triangles.len() >> level.min(63));
        chain.push(work.net.to_mesh());
    }
    Ok(chain)
}

/// Corners in range, different, and somewhere.
fn check(mesh: &TriangleMesh) -> Result<(), MultiresError> {
    let vertices = mesh.positions.len();
    if mesh.triangles.is_empty() {
        return Err(MultiresError::NoTriangles { triangles: 0 });
    }
    if mesh.triangles.len() > MOST_TRIANGLES {
        return Err(MultiresError::TooManyBlocks {
            what: "triangles",
            count: mesh.triangles.len() as u64,
            most: MOST_TRIANGLES as u64,
        });
    }
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        let is_bad = |&&v: &&u32| mesh.positions.get(v as usize).is_none_or(|p| !p.is_finite());
        if let Some(&vertex) = corners.iter().find(is_bad) {
            return Err(MultiresError::BadCorner { triangle, vertex, vertices });
        }
        let [a, b, c] = *corners;
        if a == b || b == c || c == a {
            let place_m = mesh.positions[a as usize].to_array();
            return Err(MultiresError::NotASurface {
                what: format!("triangle {triangle} has a corner twice"),
                place_m,
            });
        }
    }
    Ok(())
}

/// The numbers of corners have 32 bits, two of them for the place in the triangle.
const MOST_TRIANGLES: usize = 1 << 30;

/// A decimation under way.
struct Work {
    net: Net,
    reading: CostReading,
    picks: Picks,
    /// Triangles made in this pass, where it matters.
    is_new: Vec<bool>,
    /// The step that last changed what a triangle costs.
    rated_in: Vec<u32>,
    steps: u32,
    ring: Vec<u32>,
}

impl Work {
    fn new(net: Net, reading: CostReading) -> Self {
        let slots = net.len();
        let mut work = Self {
            net,
            reading,
            picks: Picks::default(),
            is_new: vec![false; slots],
            rated_in: vec![0; slots],
            steps: 0,
            ring: Vec::new(),
        };
        work.begin_pass();
        work
    }

    fn reduce_to(&mut self, target: usize) {
        if self.reading == CostReading::OncePerPass {
            self.begin_pass();
        }
        let mut before = usize::MAX;
        while self.net.len() > target {
            match self.picks.least() {
                Some(triangle) => self.step(triangle),
                // a pass without a step will be followed by others
                None if self.reading != CostReading::OncePerPass || self.net.len() == before => return,
                None => {
                    before = self.net.len();
                    self.begin_pass();
                }
            }
        }
    }

    fn begin_pass(&mut self) {
        self.is_new.fill(false);
        let mut costs = vec![f64::INFINITY; self.is_new.len()];
        let all: Vec<u32> = self.net.triangles().collect();
        for t in all {
            costs[t as usize] = self.cost(t);
        }
        self.picks = Picks::new(costs);
    }

    /// What it costs to pick a triangle; infinite where it must not be.
    fn cost(&mut self, t: u32) -> f64 {
        if self.is_new[t as usize] || !self.net.is_free(t) {
            return f64::INFINITY;
        }
        let cost = match self.reading {
            CostReading::Plain | CostReading::OncePerPass => {
                let (sum, count) = self.net.slope_sum(t);
                sum / count as f64
            }
            CostReading::Sum => self.net.slope_sum(t).0,
            CostReading::PlaneDeviation => {
                self.net.surroundings(t, &mut self.ring);
                self.net.plane_deviation_m(t, &self.ring)
            }
        };
        if cost.is_finite() { cost } else { f64::INFINITY }
    }

    /// Takes out a triangle and what touches it; where the hole cannot be fanned, passes it over until something near changes.
    fn step(&mut self, triangle: u32) {
        self.net.surroundings(triangle, &mut self.ring);
        let Some(hole) = self.net.hole(triangle, &self.ring) else {
            self.picks.set(triangle, f64::INFINITY);
            return;
        };
        for &t in &self.ring {
            self.picks.set(t, f64::INFINITY);
        }
        let made = self.net.fan(triangle, &self.ring, &hole);
        if self.reading == CostReading::OncePerPass {
            made.iter().for_each(|&t| self.is_new[t as usize] = true);
        }
        self.steps += 1;
        for v in hole {
            let around: Vec<u32> = self.net.triangles_at(v).collect();
            for t in around {
                if std::mem::replace(&mut self.rated_in[t as usize], self.steps) != self.steps {
                    let cost = self.cost(t);
                    self.picks.set(t, cost);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
