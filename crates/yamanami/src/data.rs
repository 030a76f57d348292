//! Heights and errors of an opened terrain: all in memory, or by pages of a database.

use yamanami_core::{ErrorCode, LatticeNode};
use yamanami_multires::wavelet::{GridData, PagedData, TerrainData};

/// Either kind of data behind one surface type.
#[derive(Debug, Clone)]
pub enum Data {
    /// All in memory.
    Grid(GridData),
    /// Some pages in memory.
    Paged(PagedData),
}

macro_rules! either {
    ($self:ident, $data:ident => $call:expr) => {
        match $self {
            Data::Grid($data) => $call,
            Data::Paged($data) => $call,
        }
    };
}

impl TerrainData for Data {
    #[inline]
    fn height_m(&self, node: LatticeNode) -> f32 {
        either!(self, d => d.height_m(node))
    }

    fn sample_height_m(&self, column: u32, row: u32) -> f32 {
        either!(self, d => d.sample_height_m(column, row))
    }

    fn gradient(&self, node: LatticeNode) -> [f64; 2] {
        either!(self, d => d.gradient(node))
    }

    #[inline]
    fn error(&self, node: LatticeNode) -> ErrorCode {
        either!(self, d => d.error(node))
    }

    #[inline]
    fn shown(&self, level: u32, x: u32, y: u32, half: u32) -> bool {
        either!(self, d => d.shown(level, x, y, half))
    }

    fn has_holes(&self) -> bool {
        either!(self, d => d.has_holes())
    }

    #[inline]
    fn is_resident(&self, node: LatticeNode) -> bool {
        either!(self, d => d.is_resident(node))
    }
}
