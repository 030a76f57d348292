//! What can be shown, flown around, extracted: a terrain or a model. One way for both.

use crate::{Error, Terrain};
use glam::DVec3;
use yamanami_core::{Aabb, Crs, NodeId, Surface};
use yamanami_gpu::RenderOptions;

/// A surface with its data: all in memory, or read by pages from a database.
pub trait Subject {
    /// The multiresolution surface.
    type Surface: Surface;

    /// The multiresolution surface.
    fn surface(&self) -> &Self::Surface;

    /// Name for pictures and files.
    fn title(&self) -> &str;

    /// The box of the whole, in the local frame, metres.
    fn bounds(&self) -> Aabb;

    /// Triangles of the source.
    fn full_triangles(&self) -> u64;

    /// Level of the finest vertices.
    fn deepest_level(&self) -> u32;

    /// How it is drawn unless other colours are asked for; they keep still from picture to picture.
    fn usual_style(&self) -> RenderOptions;

    /// Whether not all pages need be in memory: they come from a database as they are wanted, or are brought.
    fn is_paged(&self) -> bool {
        true
    }

    /// Brings the pages of absent nodes into memory, at most `max_pages`; gives how many were read. Where they are brought by
    /// the subject's user, who finds the wanted nodes in the update's report, none is.
    fn load(&mut self, _wanted: &[NodeId], _max_pages: usize) -> Result<usize, Error> {
        Ok(0)
    }

    /// Drops pages that no node of `in_use` needs until at most `max_bytes` stay; pages of coarse levels stay longest.
    fn shrink(&mut self, max_bytes: usize, in_use: impl Fn(NodeId) -> bool);

    /// A place in the source's coordinates, in the local frame.
    fn local_from_source(&self, place: DVec3) -> DVec3 {
        place
    }

    /// A place of the local frame in the source's coordinates.
    fn source_from_local(&self, place: DVec3) -> DVec3 {
        place
    }

    /// Whether it is a surface over the plan, a terrain or a TIN, and shown as one.
    fn is_ground(&self) -> bool {
        self.as_terrain().is_some()
    }

    /// The CRS of the source's coordinates, and metres in their unit; unknown and 1 in the local frame of a terrain.
    fn crs_and_unit(&self, in_source: bool) -> (Crs, f64) {
        let crs = self.as_terrain().filter(|_| in_source).map_or_else(Crs::default, |t| t.geo().crs.clone());
        (crs, 1.0)
    }

    /// The terrain, if it is one.
    fn as_terrain(&self) -> Option<&Terrain> {
        None
    }
}
