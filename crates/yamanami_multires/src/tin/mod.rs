//! TINs: how they are reduced without ceasing to be TINs, and how far apart two of them are.

mod collapse;
mod vertical;

pub use collapse::Snap;
