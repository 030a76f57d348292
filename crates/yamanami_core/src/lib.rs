//! The words and contracts of yamanami.
//!
//! Everything that two sibling crates must agree on lives here and nothing else: the height field and where it
//! lies on Earth ([`HeightField`], [`GeoReference`]), the dyadic lattice laid over it ([`Lattice`]), triangle meshes,
//! views and projections, the [`Hierarchy`] and [`Surface`] contracts, and the [`Sink`] that receives a front as it
//! changes. This crate knows no file, no thread, no clock and no GPU.
#![forbid(unsafe_code)]

mod cluster_page;
mod deformed;
mod details;
mod geo;
mod geodata;
mod height_field;
mod hierarchy;
mod lattice;
mod mesh;
mod nested_field;
mod semi_regular;
mod sink;
mod source;
mod terrain_page;
mod tin;
mod view;

pub use cluster_page::{BASE_CLUSTERS, ClusterNode, ClusterPage, ClusterVertex, GroupId};
pub use deformed::{Curvature, DeformedMap, DropFrom, EARTH_RADIUS_M, MapFault, MapView, Patch};
pub use details::{DetailScheme, Predictor};
pub use geo::{Crs, GeoReference, PixelConvention};
pub use geodata::{LineKind, MapLine, NamedPlace, PlaceKind};
pub use height_field::HeightField;
pub use hierarchy::{ActiveSet, Hierarchy, NodeId, NodeList, Sphere, Surface};
pub use lattice::{Lattice, LatticeNode};
pub use mesh::{Aabb, Material, Texture, TriangleMesh};
pub use nested_field::{FieldLevel, NestedField};
pub use semi_regular::{BaseEdge, BaseFault, BaseMesh, Place, SemiRegular, Side};
pub use sink::{MeshMirror, Sink, SurfaceVertex, TriangleKey, VertexId};
pub use source::{HeightSource, Window};
pub use terrain_page::{ErrorCode, PAGE_CELLS, PageId, TerrainPage};
pub use tin::{Breakline, BreaklineKind, FOOT_M, Snap, SnapFinder, Tin, US_SURVEY_FOOT_M};
pub use view::{Frustum, Perspective, Projection, Sight, View};
