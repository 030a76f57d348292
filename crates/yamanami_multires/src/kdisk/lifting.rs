//! Analysis and synthesis in place, level by level.

use super::cells::Cells;
use super::orthogonal::Projection;
use super::predict::predict;
use super::update::Update;
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

/// A wavelet prepared for a mesh. Time is linear in the vertices for a fixed disk, both ways.
#[derive(Debug)]
pub struct Lifting {
    wavelet: Wavelet,
    mesh: SemiRegular,
    update: Update,
    /// For [`Wavelet::Orthogonal`], by level.
    projections: Vec<Projection>,
}

/// The cells of a level, and room for those of the next one.
struct Work<const D: usize> {
    cells: Vec<[f64; D]>,
    spare: Vec<[f64; D]>,
}

impl Lifting {
    /// Prepares a wavelet. Disks are at most [`MOST_RINGS`] wide.
    pub fn new(mesh: &SemiRegular, wavelet: Wavelet) -> Self {
        let update = match wavelet {
            Wavelet::KDisk(k) => Update::new(mesh, k.min(MOST_RINGS)),
            _ => Update::default(),
        };
        let levels = if wavelet == Wavelet::Orthogonal { mesh.levels() } else { 0 };
        let projections = (0..levels).map(|level| Projection::new(mesh, level)).collect();
        Self { wavelet, mesh: mesh.clone(), update, projections }
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
        self.analyse_vectors::<1>(values.as_chunks_mut().0);
    }

    /// Base mesh and details back to one coordinate of all vertices, in place: the inverse of [`Self::analyse`].
    ///
    /// # Panics
    /// When there is not one value a vertex.
    pub fn synthesise(&self, values: &mut [f64]) {
        self.synthesise_vectors::<1>(values.as_chunks_mut().0);
    }

    /// [`Self::analyse`] for all coordinates at once, which is faster than one after the other and gives the same.
    ///
    /// # Panics
    /// When there is not one vector a vertex.
    pub fn analyse_vectors<const D: usize>(&self, values: &mut [[f64; D]]) {
        self.check(values);
        rayon::scope(|_| {
            let mut work = self.gather(values);
            for level in (0..self.mesh.levels()).rev() {
                let at = self.cells(level);
                let details = &mut values[self.details(level)];
                predict(at, &work.cells, details, -1.0);
                self.lift(level, &mut work.cells, details, 1.0);
                if level > 0 {
                    self.part(level - 1, &mut work, values);
                }
            }
            values[..work.cells.len()].copy_from_slice(&work.cells);
        });
    }

    /// The inverse of [`Self::analyse_vectors`].
    ///
    /// # Panics
    /// When there is not one vector a vertex.
    pub fn synthesise_vectors<const D: usize>(&self, values: &mut [[f64; D]]) {
        self.check(values);
        rayon::scope(|_| {
            let mut work = self.base_cells(values);
            for level in 0..self.mesh.levels() {
                let at = self.cells(level);
                let details = &mut values[self.details(level)];
                self.lift(level, &mut work.cells, details, -1.0);
                predict(at, &work.cells, details, 1.0);
                if level + 1 < self.mesh.levels() {
                    self.join(level, &mut work, values);
                }
            }
            for level in (0..self.mesh.levels().saturating_sub(1)).rev() {
                self.part(level, &mut work, values);
            }
            values[..work.cells.len()].copy_from_slice(&work.cells);
        });
    }

    /// L2 norm of each vertex's wavelet on a surface of unit area with equal triangles; for vertices of the base mesh that of their hat
    /// function. A detail times its norm is what leaving it out costs.
    pub fn norms(&self, mesh: &SemiRegular) -> Vec<f64> {
        let unit = |level: u32| 1.0 / (48.0 * f64::from(mesh.triangle_count(level)));
        let base = mesh.base();
        let hat = |v: u32| (8.0 * base.fan(v).len() as f64 * unit(0)).sqrt();
        let mut norms: Vec<f64> = (0..base.vertex_count()).map(hat).collect();
        let own;
        let update = if self.wavelet == Wavelet::Orthogonal {
            own = Update::new(mesh, RINGS_FOR_NORMS);
            &own
        } else {
            &self.update
        };
        for level in 0..mesh.levels() {
            let squares = if self.wavelet == Wavelet::Lazy {
                lazy_square_norms(mesh, level)
            } else {
                update.square_norms(mesh, level)
            };
            norms.extend(squares.into_iter().map(|square| (square * unit(level)).sqrt()));
        }
        norms
    }

    /// How many different stencils there are, over all levels; none but for [`Wavelet::KDisk`].
    pub fn stencil_count(&self) -> usize {
        self.update.stencil_count()
    }

    /// Bytes that are held besides the base mesh.
    pub fn bytes(&self) -> usize {
        self.update.bytes() + self.projections.iter().map(Projection::bytes).sum::<usize>()
    }

    fn check<const D: usize>(&self, values: &[[f64; D]]) {
        let vertices = self.mesh.vertex_count(self.mesh.levels()) as usize;
        assert_eq!(values.len(), vertices, "one value a vertex");
    }

    fn cells(&self, level: u32) -> Cells<'_> {
        Cells::new(self.mesh.base(), level)
    }

    /// The details between a level and the next one, among all vertices.
    fn details(&self, level: u32) -> std::ops::Range<usize> {
        let new = self.mesh.new_vertices(level + 1);
        new.start as usize..new.end as usize
    }

    fn base_cells<const D: usize>(&self, values: &[[f64; D]]) -> Work<D> {
        // even and odd levels take turns with the two
        let last = self.mesh.levels().saturating_sub(1);
        let room = |level: u32| Vec::with_capacity(self.mesh.vertex_count(level) as usize);
        let (mut cells, spare) = (room(last & !1), room((last.saturating_sub(1) | 1).min(last)));
        cells.extend_from_slice(&values[..self.mesh.vertex_count(0) as usize]);
        Work { cells, spare }
    }

    /// The cells of the last level but one, of vertices in their usual order.
    fn gather<const D: usize>(&self, values: &[[f64; D]]) -> Work<D> {
        let mut work = self.base_cells(values);
        for level in 0..self.mesh.levels().saturating_sub(1) {
            self.join(level, &mut work, values);
        }
        work
    }

    fn join<const D: usize>(&self, level: u32, work: &mut Work<D>, values: &[[f64; D]]) {
        work.spare.resize(self.mesh.vertex_count(level + 1) as usize, [0.0; D]);
        self.cells(level).join(&work.cells, &values[self.details(level)], &mut work.spare);
        std::mem::swap(&mut work.cells, &mut work.spare);
    }

    fn part<const D: usize>(&self, level: u32, work: &mut Work<D>, values: &mut [[f64; D]]) {
        work.spare.resize(self.mesh.vertex_count(level) as usize, [0.0; D]);
        self.cells(level).part(&work.cells, &mut work.spare, &mut values[self.details(level)]);
        std::mem::swap(&mut work.cells, &mut work.spare);
    }

    /// Adds the details' shares to the cells, or takes them away.
    fn lift<const D: usize>(&self, level: u32, cells: &mut [[f64; D]], details: &[[f64; D]], sign: f64) {
        match self.wavelet {
            Wavelet::Lazy => (),
            Wavelet::KDisk(_) => self.update.apply(self.cells(level), level, cells, details, sign),
            Wavelet::Orthogonal => self.projections[level as usize].add(cells, details, sign),
        }
    }
}

/// Square norms of the hat functions of the vertices that come with the level after `level`.
fn lazy_square_norms(mesh: &SemiRegular, level: u32) -> Vec<f64> {
    let mut squares = vec![12.0; mesh.new_vertices(level + 1).len()];
    for (edge, squares) in mesh.base().edges().iter().zip(squares.chunks_exact_mut(1 << level)) {
        if edge.right.is_none() {
            squares.fill(6.0);
        }
    }
    squares
}
