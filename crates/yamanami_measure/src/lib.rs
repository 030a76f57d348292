//! Errors between surfaces and between pictures.
//!
//! [`vertical_error`] holds a terrain mesh against every sample of its height field, [`projected_error`] holds it against every sample's place in a deformed map,
//! [`conformity`] looks for cracks,
//! T-vertices and flipped triangles, [`mesh_defects`] for what is wrong with a scan, [`surface_distance`] gives the
//! two-sided distance of any two meshes, [`tin`] what is exact on terrain surfaces (heights, sections, volumes), [`slope_sigma`] what slopes a
//! size of triangle hides, [`tiles`] judges tiles and what lies between them, [`ssim`] and [`flip`] compare pictures, and [`plot`] draws what was measured.
#![forbid(unsafe_code)]

mod bvh;
mod conformity;
mod covered;
mod defects;
mod displacement;
mod distance;
mod error;
mod flip;
mod picture;
mod places;
pub mod plot;
mod projected;
mod rows;
mod sigma;
mod ssim;
pub mod tiles;
pub mod tin;
mod vertical;

pub use bvh::{Closest, SurfaceIndex};
pub use conformity::{ConformityReport, conformity};
pub use covered::{ModelDifference, model_difference};
pub use defects::{MeshDefects, mesh_defects};
pub use displacement::{Displacement, displacement};
pub use distance::{OneWayDistance, SurfaceDistance, surface_distance};
pub use error::MeasureError;
pub use flip::{FLIP_PIXELS_PER_DEGREE, FlipReport, flip};
pub use picture::{covered_pixels, mean_abs_difference};
pub use projected::{BIN_M, DistanceBin, LARGE_PX, PixelErrors, ProjectedReport, SPLIT_PX, projected_error};
pub use sigma::{SigmaRow, slope_sigma};
pub use ssim::ssim;
pub use vertical::{VerticalReport, vertical_error};
