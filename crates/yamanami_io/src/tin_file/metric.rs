//! Longitudes and latitudes of a TIN as metres of the place they are at.

use super::notes::Notes;
use crate::crs;
use glam::DVec3;
use yamanami_core::{Aabb, Breakline, Tin, TriangleMesh};

/// The box around a surface; around its lines where there are they alone.
pub(super) fn bounds(mesh: &TriangleMesh, lines: &[Breakline]) -> Aabb {
    let mut bounds = mesh.bounds();
    if mesh.positions.is_empty() {
        lines.iter().flat_map(|line| &line.points).for_each(|&p| bounds.include(p));
    }
    bounds
}

/// Projects a TIN whose x and y are longitude and latitude in degrees, vertex by vertex, into the metric CRS of its middle
/// on the same datum. A vertex that the projection does not reach loses its place.
pub(super) fn to_metres(tin: &mut Tin, notes: &mut Notes) {
    if !tin.crs.geographic {
        return;
    }
    let middle = bounds(&tin.mesh, &tin.breaklines).centre();
    let metric = crs::metric_crs_at(&tin.crs, middle.x, middle.y);
    let lines = tin.breaklines.iter_mut().flat_map(|line| &mut line.points);
    for place in tin.mesh.positions.iter_mut().chain(lines) {
        *place = match crs::from_lon_lat(&metric, place.x, place.y) {
            Some([x, y]) => DVec3::new(x, y, place.z),
            None => DVec3::NAN,
        };
    }
    notes.say(format!("longitudes and latitudes ({}) projected to {}", tin.crs.name, metric.name));
    tin.crs = metric;
}
