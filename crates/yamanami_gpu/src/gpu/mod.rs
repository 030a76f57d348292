//! The part that needs a graphics driver.

mod device;
mod passes;
mod renderer;
mod resident_mesh;
mod scatter;
mod textures;

pub use device::Gpu;
pub use renderer::Renderer;
pub use resident_mesh::{ResidentMesh, UploadStats};
