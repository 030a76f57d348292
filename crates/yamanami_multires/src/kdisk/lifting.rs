//! Analysis and synthesis in place, level by level.

use super::disk::DiskFinder;
use super::orthogonal::Projection;
use super::stencil::Stencils;
use yamanami_core::SemiRegular;

/// Most rings of a disk. Beyond a few they change nothing, and their number grows as the square.
pub const MOST_RINGS: u32 = 8;

/// Rings of the disk whose wavelet norms stand for those of the orthogonal one; they differ by less than 10⁻⁶ of themselves.
const RINGS_FOR_NORMS: u32 = 5;

/// Which wavelet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wavelet {
    /// Details are subtracted middles, coarse vertices stay where they are.
    Lazy,
    /// Orthogonal to the hat functions of the coarse vertices within so many edges, 0 to [`MOST_RINGS`].
    KDisk(u32),
    /// Orthogonal to all coarse hat functions: each level is the least-squares approximation of the one above it.
    Orthogonal,
}

impl std::fmt::Display for Wavelet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Lazy => f.write_str("lazy"),
            Self::KDisk(k) => write!(f, "kdisk:{k}"),
            Self::Orthogonal => f.write_str("orthogonal"),
        }
    }
}

/// A wavelet prepared for a mesh: linear in the vertices for a fixed disk.
#[derive(Debug)]
pub struct Lifting {
    wavelet: Wavelet,
    levels: Vec<Step>,
    stencils: Stencils,
}

/// What leads from a level to the next finer one.
#[derive(Debug)]
struct Step {
    coarse: u32,
    /// For each new vertex where its disk begins.
    begins: Vec<u32>,
    /// Vertices of the disks, the parents first.
    disks: Vec<u32>,
    /// For each new vertex its stencil.
    stencil: Vec<u32>,
    projection: Option<Projection>,
}

impl Lifting {
    /// Prepares a wavelet. Disks are at most [`MOST_RINGS`] wide.
    pub fn new(mesh: &SemiRegular, wavelet: Wavelet) -> Self {
        let rings = match wavelet {
            Wavelet::Lazy => 0,
            Wavelet::KDisk(k) => k.min(MOST_RINGS),
            Wavelet::Orthogonal => RINGS_FOR_NORMS,
        };
        let mut stencils = Stencils::default();
        let mut step = |level: u32| {
            let mut finder = DiskFinder::new(mesh, level, rings);
            let (mut begins, mut disks, mut stencil) = (vec![0], Vec::new(), Vec::new());
            for vertex in mesh.new_vertices(level + 1) {
                let Some(parents) = mesh.parents(vertex) else { continue };
                let disk = finder.find(parents);
                stencil.push(stencils.of(&disk));
                // where all vertices have shares, the disk only tells the norm
                let kept = if wavelet == Wavelet::Orthogonal { 2 } else { disk.vertices.len() };
                disks.extend_from_slice(&disk.vertices[..kept]);
                begins.push(disks.len() as u32);
            }
            let projection = (wavelet == Wavelet::Orthogonal).then(|| Projection::new(mesh, level));
            Step { coarse: mesh.vertex_count(level), begins, disks, stencil, projection }
        };
        let levels = (0..mesh.levels()).map(&mut step).collect();
        Self { wavelet, levels, stencils }
    }

    /// Which wavelet it is.
    pub fn wavelet(&self) -> Wavelet {
        self.wavelet
    }

    /// One coordinate of all vertices to the base mesh's, followed by the details of each level, in place.
    ///
    /// # Panics
    /// When there is not one value a vertex.
    pub fn analyse(&self, values: &mut [f64]) {
        for step in self.levels.iter().rev() {
            step.predict(values, -1.0);
            self.update(step, values, 1.0);
        }
    }

    /// Base mesh and details back to one coordinate of all vertices, in place: the inverse of [`Self::analyse`].
    ///
    /// # Panics
    /// When there is not one value a vertex.
    pub fn synthesise(&self, values: &mut [f64]) {
        for step in &self.levels {
            self.update(step, values, -1.0);
            step.predict(values, 1.0);
        }
    }

    /// L2 norm of each vertex's wavelet on a surface of unit area with equal triangles; for vertices of the base mesh that of their hat
    /// function. A detail times its norm is what leaving it out costs.
    pub fn norms(&self, mesh: &SemiRegular) -> Vec<f64> {
        let unit = |level: u32| 1.0 / (48.0 * f64::from(mesh.triangle_count(level)));
        let base = mesh.base();
        let hat = |v: u32| (8.0 * base.fan(v).len() as f64 * unit(0)).sqrt();
        let mut norms: Vec<f64> = (0..base.vertex_count()).map(hat).collect();
        for (level, step) in (0u32..).zip(&self.levels) {
            let norm = |&s: &u32| {
                let square = match self.wavelet {
                    // the hat function itself
                    Wavelet::Lazy => self.stencils.lazy_square_norm(s),
                    _ => self.stencils.square_norm(s),
                };
                (square * unit(level)).sqrt()
            };
            norms.extend(step.stencil.iter().map(norm));
        }
        norms
    }

    /// How many different stencils there are, over all levels.
    pub fn stencil_count(&self) -> usize {
        self.stencils.len()
    }

    /// The shares of a new vertex's detail: coarse vertices and what each takes. Empty for [`Wavelet::Lazy`]; for
    /// [`Wavelet::Orthogonal`], of which all coarse vertices have one, see [`super::filters`].
    pub(super) fn shares(&self, level: u32, nth: usize) -> impl Iterator<Item = (u32, f64)> {
        let step = &self.levels[level as usize];
        let [from, to] = [nth, nth + 1].map(|n| step.begins[n] as usize);
        let shares = match self.wavelet {
            Wavelet::KDisk(_) => self.stencils.shares(step.stencil[nth]),
            _ => &[],
        };
        step.disks[from..to].iter().copied().zip(shares.iter().copied())
    }

    fn update(&self, step: &Step, values: &mut [f64], sign: f64) {
        match (self.wavelet, &step.projection) {
            (Wavelet::Lazy, _) => (),
            (_, Some(projection)) => projection.add(values, sign),
            _ => {
                let (even, odd) = values.split_at_mut(step.coarse as usize);
                for (nth, &stencil) in step.stencil.iter().enumerate() {
                    let disk = &step.disks[step.begins[nth] as usize..step.begins[nth + 1] as usize];
                    let detail = sign * odd[nth];
                    for (&v, share) in disk.iter().zip(self.stencils.shares(stencil)) {
                        even[v as usize] += share * detail;
                    }
                }
            }
        }
    }
}

impl Step {
    fn predict(&self, values: &mut [f64], sign: f64) {
        let (even, odd) = values.split_at_mut(self.coarse as usize);
        for (nth, odd) in odd[..self.stencil.len()].iter_mut().enumerate() {
            let begin = self.begins[nth] as usize;
            let [p, q] = [self.disks[begin], self.disks[begin + 1]].map(|v| even[v as usize]);
            *odd += sign * 0.5 * (p + q);
        }
    }
}
