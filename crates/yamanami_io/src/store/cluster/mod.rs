//! A scanned model or a TIN in the surface database: its nodes in memory-ready blocks, its clusters page by page.
//!
//! [`ClusterWriter`] writes a file, [`ClusterStore`] reads one, [`ClusterCodec`] turns single pages into bytes and back,
//! [`Rounding`] moves vertices to where a file can have them, and [`put_in_order`] makes pages that take fewer bytes.

mod annex;
mod codec;
pub(crate) mod connectivity;
mod exact;
mod ids;
mod meta;
mod nodes;
mod order;
mod reader;
mod rounding;
mod triangles;
mod vertices;
mod writer;

pub use annex::TinAnnex;
pub use codec::{ClusterCodec, PageShape};
pub use meta::{ClusterMeta, TinMeta};
pub use order::put_in_order;
pub use reader::ClusterStore;
pub use rounding::Rounding;
pub use writer::ClusterWriter;
