//! Resident meshes and pictures of them.
//!
//! A front changes by deltas; [`ResidentMesh`] is a [`yamanami_core::Sink`] that keeps it in persistent GPU buffers and
//! uploads only what changed. [`Renderer`] draws it, off-screen or on any texture view; [`software`] draws the same
//! picture with no GPU at all, from the same [`ResidentBuffers`]. Without the `wgpu` feature only the software part is
//! built. Programs that bring their own window use the [`wgpu`] re-exported here.
//!
//! ```
//! use glam::DVec3;
//! use yamanami_core::{TriangleMesh, View};
//! use yamanami_gpu::{RenderOptions, ResidentBuffers, software};
//!
//! let mesh = TriangleMesh {
//!     positions: vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, 1.0, 0.3)],
//!     triangles: vec![[0, 1, 2]],
//!     ..TriangleMesh::default() // normals are worked out from the triangles
//! };
//! let view =
//!     View { eye: DVec3::new(1.0, -2.0, 2.0), target: DVec3::ZERO, fov_y_rad: 0.8, viewport_px: [320, 180] };
//! let picture = software::render_to_image(&ResidentBuffers::from_mesh(&mesh), &view, &RenderOptions::default())?;
//! assert_eq!(picture.dimensions(), (320, 180));
//! # Ok::<(), yamanami_gpu::GpuError>(())
//! ```
#![forbid(unsafe_code)]

mod buffers;
mod dirty;
mod drape;
mod error;
mod frame;
#[cfg(feature = "wgpu")]
mod gpu;
mod map;
mod morph;
mod normals;
mod options;
mod palette;
mod shade;
pub mod software;
mod vertex;

pub use buffers::{DirtyRanges, MeshContents, ResidentBuffers};
pub use drape::Drape;
pub use error::GpuError;
pub use frame::depth_planes_m;
#[cfg(feature = "wgpu")]
pub use gpu::{Gpu, MapRenderer, Renderer, ResidentMesh, UploadStats};
pub use map::{Hidden, HorizonTable, MAX_TEXTURES, MapOptions, MapTexture, MapTextures, Veil};
pub use morph::{Morph, morph_weight, morphed_height_m};
pub use normals::vertex_normals;
pub use options::{Background, ColourBy, Haze, Light, RenderOptions, STEEP_RAD, Shading, Wireframe};
pub use vertex::{GpuVertex, TRIANGLE_BYTES, UNBOUNDED_M, VERTEX_BYTES, pack_normal, unpack_normal};
#[cfg(feature = "wgpu")]
pub use wgpu;
