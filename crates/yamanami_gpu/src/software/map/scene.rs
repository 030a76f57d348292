//! A mesh as a deformed map shows it, and the ground at its pixels.

use super::{GroundBuffer, GroundPoint};
use crate::frame::check_size;
use crate::software::place::{SUBPIXELS, ScreenTriangle};
use crate::software::raster::{Band, CENTRE, Edge, NOTHING};
use crate::software::{BAND_ROWS, MAX_SIDE_PX};
use crate::{GpuError, GpuVertex, ResidentBuffers};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::ops::Range;
use yamanami_core::MapView;

/// Triangles with a corner farther than this from the picture's corner are left out, so that edge functions fit 64-bit
/// integers. It is a hundred times the largest picture.
const FARTHEST_PX: f64 = (1u64 << 21) as f64;

/// A mesh as a map view shows it, sorted into bands of rows; for as many strips of the picture as are wanted.
#[derive(Debug)]
pub struct MapScene<'a> {
    buffers: &'a ResidentBuffers,
    view: MapView,
    triangles: Vec<MapTriangle>,
    /// Triangles of each band, in drawing order.
    bands: Vec<Vec<u32>>,
}

/// A triangle in the picture and where it comes from.
#[derive(Debug, Clone, Copy)]
struct MapTriangle {
    /// Its slot is the number of this triangle in the scene.
    screen: ScreenTriangle,
    /// Corners in the mesh, in the same order.
    corners: [u32; 3],
    /// Slot in the mesh.
    slot: u32,
}

/// A vertex in the picture.
#[derive(Debug, Clone, Copy)]
struct PlacedPoint {
    /// Sub-pixels right and down.
    at: [i32; 2],
    /// What takes the place of 1 / depth: 1 at the centre, ½ at the rim, 0 at twice the rim. NaN where it cannot be drawn.
    nearness: f32,
}

/// A pixel at which ground is seen.
pub(super) struct Seen<'s> {
    /// Place in the plane and height, metres.
    pub(super) place: Vec3,
    /// Slot of the triangle in the mesh.
    pub(super) triangle: u32,
    /// Shares of the triangle's corners in the pixel's middle.
    pub(super) shares: Vec3,
    /// The triangle in the picture.
    pub(super) run: &'s Run,
}

/// How places run over one triangle.
pub(super) struct Run {
    edges: [Edge; 3],
    per_area: f64,
    from: Vec3,
    to_1: Vec3,
    to_2: Vec3,
}

impl<'a> MapScene<'a> {
    /// Places a mesh in the picture of a map.
    pub fn new(buffers: &'a ResidentBuffers, view: &MapView) -> Result<Self, GpuError> {
        check_size(view.size_px, MAX_SIDE_PX)?;
        Ok(Self::of(buffers, *view))
    }

    /// As [`Self::new`], for pictures of several samples a pixel too.
    pub(super) fn of(buffers: &'a ResidentBuffers, view: MapView) -> Self {
        let origin = buffers.origin();
        let place = |vertex: &GpuVertex| PlacedPoint::new(&view, origin + vertex.local().as_dvec3());
        let placed: Vec<PlacedPoint> = buffers.vertices().par_iter().map(place).collect();
        let triangles = screen_triangles(&placed, buffers.triangles(), view.size_px);
        let mut bands = vec![Vec::new(); (view.size_px[1] as usize).div_ceil(BAND_ROWS)];
        for (number, triangle) in (0u32..).zip(&triangles) {
            let [_, rows] = triangle.screen.pixel_box(view.size_px);
            for band in &mut bands[rows.start / BAND_ROWS..=(rows.end - 1) / BAND_ROWS] {
                band.push(number);
            }
        }
        Self { buffers, view, triangles, bands }
    }

    /// The view.
    pub fn view(&self) -> &MapView {
        &self.view
    }

    /// The ground at the middles of the pixels of some rows; those outside the picture are left out. Equal whatever the
    /// number of threads and however the picture is cut into strips.
    pub fn ground(&self, rows: Range<u32>) -> GroundBuffer {
        let [width, height] = self.view.size_px;
        let end = rows.end.min(height);
        let rows = rows.start.min(end)..end;
        let mut points = vec![GroundPoint::NOTHING; width as usize * rows.len()];
        by_bands(rows.clone(), BAND_ROWS, width as usize, &mut points, |rows, points| {
            self.visit(rows, |pixel, seen| {
                let [x_m, y_m, z_m] = seen.place.to_array();
                points[pixel] = GroundPoint { x_m, y_m, z_m, triangle: seen.triangle };
            });
        });
        GroundBuffer { width, rows, points }
    }

    /// Calls `see` with every pixel of some rows of one band at which there is ground, numbered from the first row's first.
    pub(super) fn visit(&self, rows: Range<usize>, mut see: impl FnMut(usize, Seen<'_>)) {
        let [width, _] = self.view.size_px.map(|side| side as usize);
        let mut band = Band::<1>::new([width, rows.end], rows.clone());
        for &number in &self.bands[rows.start / BAND_ROWS] {
            band.draw(&self.triangles[number as usize].screen, &CENTRE);
        }
        let origin = self.buffers.origin();
        let to_plane = origin.as_vec3();
        let to_centre = (origin.truncate() - self.view.map.centre).as_vec2();
        let rim_m2 = (self.view.rim_m * self.view.rim_m) as f32;
        for (row, slots) in rows.zip(band.slots().chunks_exact(width)) {
            let mut last = NOTHING;
            let mut run = None;
            for (column, &[number]) in slots.iter().enumerate() {
                if number == NOTHING {
                    continue;
                }
                let triangle = &self.triangles[number as usize];
                if number != last || run.is_none() {
                    run = Some(self.run(triangle));
                    last = number;
                }
                let Some(run) = &run else { continue };
                let middle = [column, row].map(|v| v as i64 * SUBPIXELS + SUBPIXELS / 2);
                let shares = run.shares(middle);
                let local = run.from + run.to_1 * shares.y + run.to_2 * shares.z;
                if (local.truncate() + to_centre).length_squared() <= rim_m2 {
                    let pixel = (row * width + column) - self.first_pixel(&band);
                    see(pixel, Seen { place: local + to_plane, triangle: triangle.slot, shares, run });
                }
            }
        }
    }

    fn first_pixel(&self, band: &Band<1>) -> usize {
        band.first_row() * band.width()
    }

    fn run(&self, triangle: &MapTriangle) -> Run {
        let [from, one, two] = triangle.corners.map(|corner| self.buffers.vertices()[corner as usize].local());
        let edges = Edge::around(&triangle.screen);
        let area = edges[0].value_at(triangle.screen.corners[2]);
        Run { edges, per_area: 1.0 / area as f64, from, to_1: one - from, to_2: two - from }
    }
}

impl Run {
    /// Shares of the corners at a place in sub-pixels. Edge functions are exact, so that inside all are 0 to 1.
    #[inline]
    fn shares(&self, at: [i64; 2]) -> Vec3 {
        let share = |edge: usize| (self.edges[edge].value_at(at) as f64 * self.per_area) as f32;
        let (one, two) = (share(2), share(0));
        Vec3::new(1.0 - one - two, one, two)
    }

    /// How far the neighbours to the right and below lie in the plane, metres.
    pub(super) fn steps_m(&self) -> [Vec2; 2] {
        let per_px = self.per_area * SUBPIXELS as f64;
        [|edge: &Edge| edge.dx, |edge: &Edge| edge.dy].map(|growth| {
            let share = |edge: usize| (growth(&self.edges[edge]) as f64 * per_px) as f32;
            self.to_1.truncate() * share(2) + self.to_2.truncate() * share(0)
        })
    }

    /// Length of the gradient of each corner's share, per pixel.
    pub(super) fn slopes_per_px(&self) -> Vec3 {
        let slope = |edge: usize| (self.edges[edge].length() * self.per_area * SUBPIXELS as f64) as f32;
        Vec3::new(slope(1), slope(2), slope(0))
    }
}

impl PlacedPoint {
    fn new(view: &MapView, p: DVec3) -> Self {
        let px = view.px_from_plane(p).to_array();
        let is_near = px.iter().all(|v| v.abs() <= FARTHEST_PX);
        let nearness = if is_near { (1.0 - 0.5 * view.depth_key(p)) as f32 } else { f32::NAN };
        Self { at: px.map(|v| (v * SUBPIXELS as f64).round() as i32), nearness }
    }
}

/// All triangles that hold the middle of a pixel of the picture, in slot order.
fn screen_triangles(placed: &[PlacedPoint], triangles: &[[u32; 3]], size_px: [u32; 2]) -> Vec<MapTriangle> {
    const CHUNK: usize = 4096;
    let place_chunk = |(chunk, triangles): (usize, &[[u32; 3]])| {
        let numbered = ((chunk * CHUNK) as u32..).zip(triangles);
        numbered.filter_map(|(slot, &corners)| place_triangle(placed, corners, slot, size_px)).collect()
    };
    let chunks: Vec<Vec<MapTriangle>> = triangles.par_chunks(CHUNK).enumerate().map(place_chunk).collect();
    let mut triangles = chunks.concat();
    for (number, triangle) in (0u32..).zip(&mut triangles) {
        triangle.screen.slot = number;
    }
    triangles
}

fn place_triangle(placed: &[PlacedPoint], mut corners: [u32; 3], slot: u32, size_px: [u32; 2]) -> Option<MapTriangle> {
    let at = |corner: u32| placed[corner as usize].at.map(i64::from);
    let [a, b, c] = corners.map(at);
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area < 0 {
        corners.swap(1, 2);
    }
    let nearness = corners.map(|corner| placed[corner as usize].nearness);
    let can_be_drawn = area != 0 && nearness.iter().all(|v| !v.is_nan()) && nearness.iter().any(|&v| v > 0.0);
    let screen = ScreenTriangle { corners: corners.map(at), inverse_depth: nearness, slot };
    let shows = || {
        let [columns, rows] = screen.pixel_box(size_px);
        !columns.is_empty() && !rows.is_empty() && screen.may_show(&CENTRE)
    };
    (can_be_drawn && shows()).then_some(MapTriangle { screen, corners, slot })
}

/// Cuts rows of `width` items at multiples of `band` and works on the pieces at once.
pub(super) fn by_bands<T: Send>(
    rows: Range<u32>,
    band: usize,
    width: usize,
    mut items: &mut [T],
    work: impl Fn(Range<usize>, &mut [T]) + Sync,
) {
    let mut pieces = Vec::new();
    let (mut start, end) = (rows.start as usize, rows.end as usize);
    while start < end {
        let next = ((start / band + 1) * band).min(end);
        let (piece, rest) = items.split_at_mut((next - start) * width);
        pieces.push((start..next, piece));
        (items, start) = (rest, next);
    }
    pieces.into_par_iter().for_each(|(rows, piece)| work(rows, piece));
}
