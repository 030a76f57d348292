//! Packed surfaces: a `.yama` as one plain file that is read by ranges, by anyone who can ask a web server for some bytes.
//!
//! [`layout`] says how the bytes lie; `PackSource` gives any range of them straight from a `.yama`, without making the file;
//! `write_pack` makes it.

pub mod layout;
#[cfg(feature = "files")]
mod source;

#[cfg(feature = "files")]
pub use source::{PackSource, write_pack};
