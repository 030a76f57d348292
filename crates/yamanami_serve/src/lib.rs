//! Surfaces over HTTP: a list with pictures, the browser viewer, packed surfaces by range, and standard tiles; and the same
//! viewer and data as static files ([`write_site`]).
//!
//! Read-only: what can be reached is what was named at the start, by names that are no paths. `docs/serve.md` lists the routes
//! and the limits. Work that takes a processor's time is done apart from the threads that talk, so many at once.
#![forbid(unsafe_code)]

mod cache;
mod connections;
mod error;
mod fault;
mod heights;
mod limits;
mod pack;
mod pages;
mod picture;
mod range;
mod reply;
mod routes;
mod server;
mod site;
mod stall;
mod surface;
mod tiles;
mod viewer;
mod work;

pub use error::ServeError;
pub use limits::Limits;
pub use server::{ServeOptions, Server, open_browser};
pub use site::{SiteReport, write_site};
pub use surface::Surfaces;
pub use viewer::Viewer;
