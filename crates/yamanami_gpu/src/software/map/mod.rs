//! Pictures of deformed maps without a graphics driver, whole or by strips of rows.
//!
//! Corners are projected in `f64`; inside a triangle places run linearly over the picture. Of what lies at one pixel the
//! nearest to the centre is seen, which along an azimuth is what the eye above the ring sees (α = 0). Based on: Hori,
//! Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map" (drawing near to far; the plane and the
//! panorama in one picture). Where we differ: each pixel knows its ground, so colours come from pictures of the ground at
//! the picture's own fineness, however coarse the mesh.
//!
//! ```
//! use glam::DVec3;
//! use yamanami_core::{DeformedMap, MapView, TriangleMesh};
//! use yamanami_gpu::{MapOptions, ResidentBuffers, software::map};
//!
//! let corners = [(-40e3, -40e3), (40e3, -40e3), (40e3, 40e3), (-40e3, 40e3)];
//! let mesh = TriangleMesh {
//!     positions: corners.map(|(x, y)| DVec3::new(x, y, 0.0)).into(),
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//!     ..TriangleMesh::default()
//! };
//! let buffers = ResidentBuffers::from_mesh(&mesh);
//! let view = MapView::fitted(DeformedMap::default(), [200, 200], 30e3, 0.0, 5.0);
//!
//! let options = MapOptions { ground: [90, 130, 80, 255], ..MapOptions::default() };
//! let picture = map::render_to_image(&buffers, &view, &options)?;
//! assert_eq!(picture.get_pixel(100, 100).0, [90, 130, 80, 255]);
//! assert_eq!(picture.get_pixel(2, 2).0[3], 0, "beyond the rim nothing is drawn");
//!
//! let ground = map::MapScene::new(&buffers, &view)?.ground(90..110);
//! let seen = ground.at(100, 100).unwrap();
//! assert!(seen.x_m.abs() < 400.0 && seen.y_m.abs() < 400.0);
//! # Ok::<(), yamanami_gpu::GpuError>(())
//! ```

mod ground;
mod paint;
mod scene;

pub use ground::{GroundBuffer, GroundPoint};
pub use paint::{MapPainter, render_to_image};
pub use scene::MapScene;
