//! DXF: the faces and lines of drawings of any release in text, in; a drawing that any CAD program reads, out.

mod drawing;
mod groups;
mod layers;
mod polyline;
mod read;
mod units;
mod write;

pub(super) use read::read;
pub(super) use write::write;

/// The application under whose name lines keep their names in extended data.
const APPLICATION: &str = "YAMANAMI";

/// Begins the comment that names the surface.
const TITLE: &str = "yamanami surface ";
