//! A TIN of survey points and breaklines: their constrained Delaunay triangulation.
//!
//! Based on: Chew, "Constrained Delaunay Triangulations", 1989; the triangulation itself is the `spade` crate's, with exact
//! predicates in the coordinates as they are. So nothing is shifted or scaled, and no vertex moves by a bit, however far
//! from the origin. Lines that cross get a vertex there; how heights that disagree are settled is said in the notes.

mod clip;
mod lines;
mod outliers;
mod vertices;

use crate::MultiresError;
use crate::clean::{CleanOptions, clean};
use glam::DVec3;
use lines::Weaver;
use spade::{ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation};
use vertices::Vertices;
use yamanami_core::{Breakline, Tin, TriangleMesh};

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// How points and lines become a TIN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DelaunayOptions {
    /// Triangles with a longer edge in plan are left out, metres: bays of the survey are not bridged.
    pub longest_edge_m: Option<f64>,
    /// Where two lines meet, heights that differ by no more are meaned; else the line of the higher rank (hard, soft,
    /// boundary) or the first one has it, and a note says so. Metres.
    pub crossing_tolerance_m: f64,
}

impl Default for DelaunayOptions {
    fn default() -> Self {
        Self { longest_edge_m: None, crossing_tolerance_m: 0.1 }
    }
}

/// A TIN, and what was done to its points and lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Triangulated {
    /// The TIN: its vertices are the points and the points of the lines, exactly where they were given, and the crossings
    /// of lines. Each step of its breaklines, which run through those crossings and through points on them, is an edge,
    /// unless it lies outside the boundary.
    pub tin: Tin,
    /// What was dropped, meaned or settled, and where: a line each.
    pub notes: Vec<String>,
}

/// Triangulates points and lines, in metres.
///
/// - Points at one place in plan become one vertex of their mean height; a line's height goes before a point's, an earlier
///   line's before a later one's.
/// - A hard line also gives its height to points that lie exactly on it.
/// - Points of lines without a height (NaN) get that of the triangulated points there.
/// - Boundary lines are closed rings. With any, what lies in an odd number of them is kept: a ring in a ring is a hole.
/// - Points that are nowhere, or absurdly far from all others, are dropped.
///
/// Fails when no triangle comes to be.
pub fn triangulate(
    points: &[DVec3],
    lines: &[Breakline],
    options: &DelaunayOptions,
) -> Result<Triangulated, MultiresError> {
    let mut notes = Vec::new();
    let Vertices { mut positions, paths, mut line_of } = vertices::gather(points, lines, &mut notes)?;
    let with_height = positions.iter().take_while(|p| !p.z.is_nan()).count();
    let heightless = with_height as u32..positions.len() as u32;
    let mut cdt = load(&mut positions, with_height)?;
    let tolerance_m = options.crossing_tolerance_m;
    let mut weaver = Weaver::new(&mut cdt, &mut positions, &mut line_of, lines, heightless, tolerance_m);
    for (line, path) in paths.iter().enumerate() {
        weaver.weave(line as u32, path);
    }
    let woven = weaver.finish(&mut notes);
    let triangles = clip::triangles(&cdt, &positions, &woven.edges, options.longest_edge_m);
    if triangles.is_empty() {
        return Err(MultiresError::NoNetwork { points: positions.len() });
    }
    let breaklines = lines
        .iter()
        .zip(&woven.paths)
        .filter(|(_, path)| path.len() > 1)
        .map(|(line, path)| {
            let points = path.iter().map(|&v| positions[v as usize]).collect();
            Breakline { name: line.name.clone(), kind: line.kind, points }
        })
        .collect();
    let mut mesh = TriangleMesh::new(positions, triangles);
    clean(&mut mesh, &CleanOptions { drop_isolated: true, ..CleanOptions::default() });
    Ok(Triangulated { tin: Tin { breaklines, ..Tin::of_mesh("", mesh) }, notes })
}

/// Triangulates the vertices with heights, then finds those of the others, which come last.
fn load(positions: &mut [DVec3], with_height: usize) -> Result<Cdt, MultiresError> {
    let failed = |_| MultiresError::NoNetwork { points: positions.len() };
    let plan = |p: &DVec3| Point2::new(p.x, p.y);
    let mut cdt =
        Cdt::bulk_load_cdt(positions[..with_height].iter().map(plan).collect(), Vec::new()).map_err(failed)?;
    for vertex in with_height..positions.len() {
        positions[vertex].z = height_at(&cdt, positions, plan(&positions[vertex]));
    }
    for vertex in with_height..positions.len() {
        cdt.insert(plan(&positions[vertex])).map_err(|_| MultiresError::NoNetwork { points: positions.len() })?;
    }
    Ok(cdt)
}

/// Height of the triangulated vertices at a place; outside of them that of the nearest place of the edge it is seen from.
fn height_at(cdt: &Cdt, positions: &[DVec3], place: Point2<f64>) -> f64 {
    let at = |v: spade::handles::FixedVertexHandle| positions[v.index()];
    let place = DVec3::new(place.x, place.y, 0.0);
    match cdt.locate(Point2::new(place.x, place.y)) {
        PositionInTriangulation::OnFace(face) => {
            let [a, b, c] = cdt.face(face).vertices().map(|v| at(v.fix()));
            let (ab, ac, ap) = (b - a, c - a, place - a);
            let area = ab.x * ac.y - ab.y * ac.x;
            let (u, v) = ((ap.x * ac.y - ap.y * ac.x) / area, (ab.x * ap.y - ab.y * ap.x) / area);
            a.z + u * ab.z + v * ac.z
        }
        PositionInTriangulation::OnEdge(edge) | PositionInTriangulation::OutsideOfConvexHull(edge) => {
            let [a, b] = cdt.directed_edge(edge).vertices().map(|v| at(v.fix()));
            lines::height_along(a, b, place)
        }
        PositionInTriangulation::OnVertex(v) => at(v).z,
        PositionInTriangulation::NoTriangulation => cdt.vertices().next().map_or(0.0, |v| at(v.fix()).z),
    }
}

/// A place in a note.
fn place(p: DVec3) -> String {
    format!("{:.3} {:.3}", p.x, p.y)
}

/// A line in a note: its name, or its number from 1.
fn name(lines: &[Breakline], line: u32) -> String {
    match lines.get(line as usize) {
        Some(l) if !l.name.is_empty() => format!("line '{}'", l.name),
        _ => format!("line {}", u64::from(line) + 1),
    }
}
