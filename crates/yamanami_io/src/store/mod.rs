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
#[cfg(feature = "files")]
mod cache;
mod cluster;
#[cfg(feature = "files")]
mod database;
mod error_steps;
mod errors;
mod facts;
mod family;
mod frame;
mod heights;
mod meta;
mod model;
mod page;
mod quantum;
mod rans;
#[cfg(feature = "files")]
mod raw;
#[cfg(feature = "files")]
mod reader;
mod residuals;
mod rows;
#[cfg(feature = "files")]
mod schema;
mod shown;
#[cfg(feature = "files")]
mod writer;

#[cfg(feature = "files")]
pub(crate) use bits::{put_varint, take, take_varint};
#[cfg(feature = "files")]
pub(crate) use cluster::connectivity;
pub(crate) use cluster::{ANNEX_ROW, BASE_ROW, BLOCK_NODES};
pub use cluster::{ClusterCodec, ClusterMeta, ClusterTable, PageShape, Rounding, TinMeta, group_row, put_in_order};
#[cfg(feature = "files")]
pub use cluster::{ClusterStore, ClusterWriter, TinAnnex};
#[cfg(feature = "files")]
pub(crate) use database::write_error;
pub use facts::FactsError;
pub use meta::TerrainMeta;
pub use page::{EncodedPage, PageCodec};
pub use quantum::{Quantum, QuantumFinder};
#[cfg(feature = "files")]
pub(crate) use raw::{RawRow, RawStore};
#[cfg(feature = "files")]
pub use reader::TerrainStore;
pub use rows::{page_id, row_crc32, row_id};
#[cfg(feature = "files")]
pub(crate) use schema::Content;
#[cfg(feature = "files")]
pub use writer::TerrainWriter;

/// Whether the loops may be run as compiled for processors of about 2013 and later: same results, sooner.
#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("bmi2")
}
