//! The viewer in a browser: the same front, budget, differences and deformed map as on the desktop, of a packed surface
//! whose pages are streamed by ranges, coarse first.
//!
//! `viewer::Viewer` is what the page sees. It draws on a canvas, says which byte ranges to fetch and takes them;
//! fetching itself, and everything with letters on it, is the page's (`page/`).
#![forbid(unsafe_code)]
// elsewhere than in a browser only the tests use it
#![cfg_attr(not(target_arch = "wasm32"), allow(dead_code, unused_macros, unused_imports))]

mod feed;
mod map;
mod pick;
mod places;
mod session;
mod settings;
mod stage;
mod stream;
#[cfg(target_arch = "wasm32")]
mod surface;
#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests;
#[cfg(target_arch = "wasm32")]
pub mod viewer;
