//! A scanned model or a TIN in the surface database: its nodes in memory-ready blocks, its clusters page by page.
//!
//! [`ClusterWriter`] writes a file, [`ClusterStore`] reads one, [`ClusterCodec`] turns single pages into bytes and back,
//! [`Rounding`] moves vertices to where a file can have them, and [`put_in_order`] makes pages that take fewer bytes.

#[cfg(feature = "files")]
mod annex;
mod codec;
#[cfg(feature = "files")]
pub(crate) mod connectivity;
mod exact;
mod ids;
mod meta;
mod nodes;
mod order;
#[cfg(feature = "files")]
mod reader;
mod rounding;
mod table;
mod triangles;
mod vertices;
#[cfg(feature = "files")]
mod writer;

#[cfg(feature = "files")]
pub use annex::TinAnnex;
pub use codec::{ClusterCodec, PageShape};
pub use meta::{ClusterMeta, TinMeta};
pub(crate) use nodes::BLOCK_NODES;
pub use order::put_in_order;
#[cfg(feature = "files")]
pub use reader::ClusterStore;
pub use rounding::Rounding;
pub(crate) use table::{ANNEX_ROW, BASE_ROW};
pub use table::{ClusterTable, group_row};
#[cfg(feature = "files")]
pub use writer::ClusterWriter;
