//! From vertices to triangles on the screen: the vertex shader's twin, clipping, and snapping to the sub-pixel grid.

use super::raster::Sample;
use crate::frame::Frame;
use crate::morph::{Morph, morph_weight, morphed_height_m};
use crate::{GpuVertex, shade};
use glam::{Mat4, Vec2, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Sub-pixel steps of a pixel.
pub(super) const SUBPIXELS: i64 = 256;

/// Triangles are clipped this many half-pictures from the middle, so that edge functions fit 64-bit integers.
const GUARD: f32 = 8.0;

/// A vertex where this picture draws it.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedVertex {
    /// Metres relative to the eye.
    pub(super) from_eye: Vec3,
    /// Homogeneous picture coordinates: x right and y up from the middle, and depth.
    pub(super) clip: Vec3,
}

/// A triangle with corners on the sub-pixel grid, turned so that its inside is on the positive side of its edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScreenTriangle {
    /// Corners in sub-pixels, y down.
    pub(super) corners: [[i64; 2]; 3],
    /// 1 / depth at the corners.
    pub(super) inverse_depth: [f32; 3],
    /// Slot of the mesh's triangle.
    pub(super) slot: u32,
}

impl PlacedVertex {
    pub(super) fn new(frame: &Frame, vertex: &GpuVertex) -> Self {
        let mut from_eye = vertex.local() - shade::rgb(frame.eye);
        let morph = Morph { tau_px: frame.tau_px, width: frame.morph_width };
        let weight = morph_weight(vertex.error_m, vertex.bound_radius_m, from_eye.length(), frame.eye[3], morph);
        from_eye.z = morphed_height_m(from_eye.z, vertex.detail_m, weight);
        let clip = Mat4::from_cols_array_2d(&frame.clip_from_eye) * from_eye.extend(1.0);
        Self { from_eye, clip: Vec3::new(clip.x, clip.y, clip.w) }
    }
}

impl ScreenTriangle {
    /// Columns and rows of the picture that the triangle may touch.
    pub(super) fn pixel_box(&self, size_px: [u32; 2]) -> [Range<usize>; 2] {
        [0, 1].map(|axis| {
            let coordinates = self.corners.map(|corner| corner[axis]);
            let least = coordinates.into_iter().fold(i64::MAX, i64::min).div_euclid(SUBPIXELS);
            let greatest = coordinates.into_iter().fold(i64::MIN, i64::max).div_euclid(SUBPIXELS);
            let side = i64::from(size_px[axis]);
            least.clamp(0, side) as usize..(greatest + 1).clamp(0, side) as usize
        })
    }

    /// Whether any sample of any pixel lies in the triangle's box: most triangles of a fine scan lie between samples.
    pub(super) fn may_show(&self, samples: &[Sample]) -> bool {
        let reach = [0, 1].map(|axis| {
            let coordinates = self.corners.map(|corner| corner[axis]);
            [
                coordinates.into_iter().fold(i64::MAX, i64::min),
                coordinates.into_iter().fold(i64::MIN, i64::max),
            ]
        });
        samples.iter().any(|sample| {
            (0..2).all(|axis| {
                let [least, greatest] = reach[axis].map(|v| v - sample[axis]);
                greatest.div_euclid(SUBPIXELS) >= (least + SUBPIXELS - 1).div_euclid(SUBPIXELS)
            })
        })
    }

    /// Snaps a convex corner triple, given in clip space; `None` when nothing is left of it.
    fn new(corners: [Vec3; 3], size_px: Vec2, slot: u32) -> Option<Self> {
        let mut screen = corners.map(|c| {
            let x = (c.x / c.z * 0.5 + 0.5) * size_px.x;
            let y = (0.5 - c.y / c.z * 0.5) * size_px.y;
            [x, y].map(|v| (f64::from(v) * SUBPIXELS as f64).round() as i64)
        });
        let mut inverse_depth = corners.map(|c| 1.0 / c.z);
        let [a, b, c] = screen;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area < 0 {
            screen.swap(1, 2);
            inverse_depth.swap(1, 2);
        }
        (area != 0).then_some(Self { corners: screen, inverse_depth, slot })
    }
}

/// All triangles that may show at these samples of a pixel, in slot order.
pub(super) fn screen_triangles(
    frame: &Frame,
    vertices: &[PlacedVertex],
    triangles: &[[u32; 3]],
    samples: &[Sample],
) -> Vec<ScreenTriangle> {
    const CHUNK: usize = 4096;
    let place_chunk = |(chunk, triangles): (usize, &[[u32; 3]])| {
        let mut placed = Vec::with_capacity(triangles.len());
        for (slot, corners) in ((chunk * CHUNK) as u32..).zip(triangles) {
            if corners[0] != corners[1] {
                place_triangle(frame, corners.map(|c| vertices[c as usize].clip), slot, samples, &mut placed);
            }
        }
        placed
    };
    let chunks: Vec<Vec<ScreenTriangle>> = triangles.par_chunks(CHUNK).enumerate().map(place_chunk).collect();
    chunks.concat()
}

fn place_triangle(frame: &Frame, corners: [Vec3; 3], slot: u32, samples: &[Sample], out: &mut Vec<ScreenTriangle>) {
    let snapped =
        |corners, size_px| ScreenTriangle::new(corners, size_px, slot).filter(|triangle| triangle.may_show(samples));
    let near_m = frame.ray_forward[3];
    let size_px = Vec2::from_array(frame.size_px);
    let sides = |limit: f32| {
        move |c: Vec3| [c.z - near_m, limit * c.z - c.x, limit * c.z + c.x, limit * c.z - c.y, limit * c.z + c.y]
    };
    let view = corners.map(sides(1.0));
    if (0..5).any(|side| view.iter().all(|c| c[side] < 0.0)) || corners.iter().any(|c| !c.is_finite()) {
        return;
    }
    let guard = sides(GUARD);
    if corners.iter().all(|&c| guard(c).iter().all(|&distance| distance >= 0.0)) {
        out.extend(snapped(corners, size_px));
        return;
    }
    let mut polygon = corners.to_vec();
    for side in 0..5 {
        polygon = clip(&polygon, |c| guard(c)[side]);
    }
    for i in 2..polygon.len() {
        out.extend(snapped([polygon[0], polygon[i - 1], polygon[i]], size_px));
    }
}

/// The part of a convex polygon on the positive side. A cut is always worked out from the inner to the outer corner, so
/// that two triangles cut their shared edge at the very same point. Based on: Ivan Sutherland, Gary Hodgman, "Reentrant
/// Polygon Clipping", 1974.
fn clip(polygon: &[Vec3], distance: impl Fn(Vec3) -> f32) -> Vec<Vec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &from) in polygon.iter().enumerate() {
        let to = polygon[(i + 1) % polygon.len()];
        let (d_from, d_to) = (distance(from), distance(to));
        if d_from >= 0.0 {
            kept.push(from);
        }
        if (d_from >= 0.0) != (d_to >= 0.0) {
            let (inner, outer, d_inner, d_outer) =
                if d_from >= 0.0 { (from, to, d_from, d_to) } else { (to, from, d_to, d_from) };
            kept.push(inner.lerp(outer, d_inner / (d_inner - d_outer)));
        }
    }
    kept
}
