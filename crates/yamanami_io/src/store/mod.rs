//! The surface database: one `.yama` file that holds a terrain, or a scanned model, at every level of detail.
//!
//! An SQLite file (documented byte by byte in `docs/format.md`): facts, pages as blobs, and an R*Tree of their boxes. Each
//! height is stored once, on the level where its point first appears, as the small difference from what the coarser
//! level foretells; so any level can be read without the finer ones, and any page with one page a level above it.
//!
//! [`TerrainWriter`] writes a file, [`TerrainStore`] reads one, [`PageCodec`] turns single pages into bytes and back; for
//! models [`ClusterWriter`], [`ClusterStore`] and [`ClusterCodec`] do.

mod binary;
mod bits;
mod cache;
mod cluster;
mod database;
mod error_steps;
mod errors;
mod facts;
mod family;
mod heights;
mod meta;
mod model;
mod page;
mod quantum;
mod rans;
mod raw;
mod reader;
mod residuals;
mod rows;
mod schema;
mod shown;
mod writer;

pub(crate) use bits::{put_varint, take, take_varint};
pub(crate) use cluster::connectivity;
pub use cluster::{
    ClusterCodec, ClusterMeta, ClusterStore, ClusterWriter, PageShape, Rounding, TinAnnex, TinMeta, put_in_order,
};
pub(crate) use database::write_error;
pub use facts::Facts;
pub use meta::TerrainMeta;
pub use page::{EncodedPage, PageCodec};
pub use quantum::{Quantum, QuantumFinder};
pub(crate) use raw::{RawRow, RawStore};
pub use reader::TerrainStore;
pub use rows::{ANNEX_ROW, BASE_ROW, BLOCK_NODES, row_crc32, row_id, row_of};
pub(crate) use schema::Content;
pub use writer::TerrainWriter;

/// Whether the loops may be run as compiled for processors of about 2013 and later: same results, sooner.
#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("bmi2")
}
