//! The part that needs a graphics driver.

mod device;
mod map_frame;
mod map_renderer;
mod map_textures;
mod passes;
mod renderer;
mod resident_mesh;
mod scatter;
mod textures;

pub use device::Gpu;
pub use map_renderer::MapRenderer;
pub use renderer::Renderer;
pub use resident_mesh::{ResidentMesh, UploadStats};
