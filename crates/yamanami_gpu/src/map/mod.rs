//! How pictures of deformed maps are to look, for the GPU and for its software twin alike.

mod horizon;
mod options;
mod textures;

pub use horizon::HorizonTable;
pub(crate) use options::premultiplied;
pub use options::{Hidden, MapOptions, Veil};
pub use textures::{MAX_TEXTURES, MapTexture, MapTextures};
