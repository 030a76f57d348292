//! Hierarchies of TINs: the laws, a million fronts without a crack, breaklines that stay where they are, errors that hold.

use glam::{DVec2, DVec3};
use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};
use yamanami_core::{
    Breakline, BreaklineKind, Hierarchy, NodeId, Sink, Snap, Surface, SurfaceVertex, Tin, TriangleKey, TriangleMesh,
    VertexId,
};
use yamanami_multires::cluster::{ClusterOptions, ClusterSurface, build_tile, build_tin, join_tiles};
use yamanami_multires::tin::line_edges;
use yamanami_testkit::laws::hierarchy_law;
use yamanami_testkit::{RandomFront, Rng, Step};

const SNAP: Snap = Snap { unit_m: 1.0, per_unit: 1024.0 };

/// A shaken grid of hills with random diagonals, on the lattice of [`SNAP`], far from zero.
fn hills(columns: usize, rows: usize, seed: u64) -> Tin {
    let mut rng = Rng::new(seed);
    let mut positions = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            let (mut x, mut y) = (i as f64, j as f64);
            let shake = [rng.unit(), rng.unit()].map(|u| 0.5 * u - 0.25);
            if i > 0 && i < columns && j > 0 && j < rows {
                (x, y) = (x + shake[0], y + shake[1]);
            }
            let z = 4.0 * (0.3 * x).sin() * (0.21 * y).cos() + 0.2 * rng.unit();
            positions.push(SNAP.place(DVec3::new(5e5 + 3.0 * x, 4e6 + 3.0 * y, z)));
        }
    }
    let at = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let mut triangles = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend(if rng.chance(0.5) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    Tin::of_mesh("hills", TriangleMesh::new(positions, triangles))
}

/// The same with breaklines along its edges.
fn with_lines(columns: usize, rows: usize, seed: u64) -> Tin {
    let mut tin = hills(columns, rows, seed);
    let at = |i: usize, j: usize| tin.mesh.positions[j * (columns + 1) + i];
    let line = |points: Vec<DVec3>| Breakline { name: String::new(), kind: BreaklineKind::Hard, points };
    let lines = vec![
        line((0..=rows).map(|j| at(columns / 3, j)).collect()),
        line((0..=columns).map(|i| at(i, rows / 2)).collect()),
        line((columns / 2..columns - 2).map(|i| at(i, rows / 4)).collect()),
    ];
    tin.breaklines = lines;
    tin
}

/// The same with triangles missing: a ragged border, holes, islands.
fn ragged(columns: usize, rows: usize, seed: u64) -> Tin {
    let mut tin = hills(columns, rows, seed);
    let middle = |t: &[u32; 3]| t.iter().map(|&v| tin.mesh.positions[v as usize]).sum::<DVec3>() / 3.0;
    let keep: Vec<bool> = tin
        .mesh
        .triangles
        .iter()
        .map(|t| {
            let p = middle(t) - DVec3::new(5e5, 4e6, 0.0);
            (0.17 * p.x).sin() + (0.13 * p.y + 0.05 * p.x).cos() < 1.1
        })
        .collect();
    let mut keep = keep.iter();
    tin.mesh.triangles.retain(|_| *keep.next().unwrap());
    tin
}

fn surface(tin: &Tin) -> ClusterSurface {
    let options = ClusterOptions { cluster_triangles: 20, group_clusters: 5, ..ClusterOptions::default() };
    build_tin(tin, Some(SNAP), &options).unwrap().into_surface().unwrap()
}

fn area2([a, b, c]: [DVec3; 3]) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Mixes numbers for hash tables that nobody attacks, faster than the usual way.
#[derive(Default)]
struct Mix(u64);

impl Hasher for Mix {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        for word in bytes.chunks(8) {
            self.write_u64(word.iter().fold(0, |sum, &byte| sum << 8 | u64::from(byte)));
        }
    }
    fn write_u64(&mut self, word: u64) {
        let mixed = (self.0 ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = mixed ^ mixed >> 32;
    }
}

type Mixed = BuildHasherDefault<Mix>;

/// Receives a front and knows at any time whether it is watertight.
#[derive(Default)]
struct Watertight {
    /// Places of the border of the ground.
    border: HashSet<[u64; 3]>,
    places: Vec<Option<DVec3>>,
    at_border: Vec<bool>,
    at_place: HashSet<[u64; 3], Mixed>,
    triangles: HashMap<TriangleKey, [VertexId; 3], Mixed>,
    /// For each vertex the ends of the edges that leave it.
    out: Vec<Vec<VertexId>>,
    /// Edges, not of the border, without one the other way.
    cracks: usize,
    /// Edges that are there twice the same way.
    doubled: usize,
}

impl Watertight {
    fn place(&self, v: VertexId) -> DVec3 {
        self.places[v as usize].expect("a triangle uses a vertex that is there")
    }

    /// Counts what changes when an edge that is not in `out` comes or goes.
    fn count(&mut self, from: VertexId, to: VertexId, comes: bool) {
        let change = |count: &mut usize, comes: bool| if comes { *count += 1 } else { *count -= 1 };
        if self.out[from as usize].contains(&to) {
            // while patches change hands two triangles may have the same edge
            change(&mut self.doubled, comes);
        } else if !(self.at_border[from as usize] && self.at_border[to as usize]) {
            // it closes the one the other way, or is open itself
            let closes = self.out[to as usize].contains(&from);
            change(&mut self.cracks, comes != closes);
        }
    }

    /// Where a crack is.
    fn find_crack(&self) -> Option<DVec3> {
        let mut edges = self.triangles.values().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        let is_border = |v: VertexId| self.at_border[v as usize];
        let crack = edges.find(|&(a, b)| !(self.out[b as usize].contains(&a) || is_border(a) && is_border(b)));
        crack.map(|(a, _)| self.place(a))
    }
}

impl Sink for Watertight {
    fn add_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        let n = self.places.len().max(id as usize + 1);
        self.places.resize(n, None);
        self.at_border.resize(n, false);
        self.out.resize(n, Vec::new());
        assert!(self.places[id as usize].replace(vertex.position).is_none());
        let bits = vertex.position.to_array().map(f64::to_bits);
        self.at_border[id as usize] = self.border.contains(&bits);
        assert!(self.at_place.insert(bits), "two vertices at {}", vertex.position);
    }
    fn update_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        assert_eq!(self.places[id as usize], Some(vertex.position));
    }
    fn remove_vertex(&mut self, id: VertexId) {
        assert!(self.out[id as usize].is_empty(), "a vertex leaves before its triangles");
        let place = self.places[id as usize].take().expect("it is there");
        self.at_place.remove(&place.to_array().map(f64::to_bits));
    }
    fn add_triangle(&mut self, key: TriangleKey, corners: [VertexId; 3]) {
        assert!(area2(corners.map(|v| self.place(v))) > 0.0, "a triangle is flat or turned over in plan");
        assert!(self.triangles.insert(key, corners).is_none());
        let [a, b, c] = corners;
        for (from, to) in [(a, b), (b, c), (c, a)] {
            self.count(from, to, true);
            self.out[from as usize].push(to);
        }
    }
    fn remove_triangle(&mut self, key: TriangleKey) {
        let [a, b, c] = self.triangles.remove(&key).expect("it is there");
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let out = &mut self.out[from as usize];
            let place = out.iter().position(|&v| v == to).expect("the edge is there");
            out.swap_remove(place);
            self.count(from, to, false);
        }
    }
}

/// The places of the border of a TIN.
fn border(tin: &Tin) -> HashSet<[u64; 3]> {
    let edges: HashSet<(u32, u32)> =
        tin.mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    let open = edges.iter().filter(|&&(a, b)| !edges.contains(&(b, a)));
    open.flat_map(|&(a, b)| [a, b]).map(|v| tin.mesh.positions[v as usize].to_array().map(f64::to_bits)).collect()
}

/// The same built in tiles of so many metres that are joined.
fn glued(tin: &Tin, tile_m: f64) -> ClusterSurface {
    let options = ClusterOptions { cluster_triangles: 20, group_clusters: 5, ..ClusterOptions::default() };
    let tile_of = |p: DVec3| [(p.x / tile_m).floor() as i64, (p.y / tile_m).floor() as i64];
    let mut tiles: std::collections::BTreeMap<[i64; 2], Vec<[u32; 3]>> = std::collections::BTreeMap::new();
    let mut user: HashMap<u32, [i64; 2]> = HashMap::new();
    let mut shared = HashSet::new();
    for t in &tin.mesh.triangles {
        let tile = tile_of(t.iter().map(|&v| tin.mesh.positions[v as usize]).sum::<DVec3>() / 3.0);
        tiles.entry(tile).or_default().push(*t);
        for &v in t {
            if *user.entry(v).or_insert(tile) != tile {
                shared.insert(tin.mesh.positions[v as usize].to_array().map(f64::to_bits));
            }
        }
    }
    assert!(tiles.len() > 3);
    let is_shared = |p: DVec3| shared.contains(&p.to_array().map(f64::to_bits));
    let mut built: Vec<_> = tiles
        .into_values()
        .map(|triangles| {
            let mesh = TriangleMesh::new(tin.mesh.positions.clone(), triangles);
            let part = Tin { mesh, ..tin.clone() };
            build_tile(&part, &is_shared, Some(SNAP), &options).unwrap()
        })
        .collect();
    let tops: Vec<_> = built.iter_mut().map(|tile| tile.take_top()).collect();
    let above = join_tiles(&tops, Some(SNAP), &options).unwrap();
    let mut whole = above.build;
    for (seam, mut tile) in above.seams.iter().zip(built) {
        seam.place_nodes(&mut tile.build.nodes);
        tile.build.pages.iter_mut().for_each(|page| seam.place_page(page));
        whole.nodes.extend(tile.build.nodes);
        whole.pages.extend(tile.build.pages);
    }
    whole.into_surface().unwrap()
}

/// Walks over random legal fronts, and looks at each: no crack, no T-vertex, nothing turned over.
fn walk(tin: &Tin, fronts: usize) {
    walk_on(&surface(tin), tin, fronts);
}

fn walk_on(surface: &ClusterSurface, tin: &Tin, fronts: usize) {
    let mut sink = Watertight { border: border(tin), ..Watertight::default() };
    surface.emit_base(&mut sink);
    let mut front = RandomFront::new(surface, 5);
    for n in 0..fronts {
        // tides, so that coarse, fine and mixed fronts all come
        let refine = if n / 400 % 2 == 0 { 0.62 } else { 0.38 };
        let step = front.pick(refine).expect("there are nodes");
        match step {
            Step::Refine(node) => {
                surface.refine(node, &front, &mut sink);
                front.take(step);
            }
            Step::Coarsen(node) => {
                surface.coarsen(node, &front, &mut sink);
                front.take(step);
            }
        }
        assert_eq!(sink.cracks, 0, "front {n}: a crack at {:?}", sink.find_crack());
        assert_eq!(sink.doubled, 0, "front {n}: an edge is there twice");
    }
}

/// A million fronts, all three together.
const FRONTS: usize = 333_334;

#[test]
fn a_third_of_a_million_fronts_of_hills_have_no_crack() {
    walk(&hills(24, 17, 1), FRONTS);
}

#[test]
fn a_third_of_a_million_fronts_with_breaklines_have_no_crack() {
    walk(&with_lines(21, 20, 2), FRONTS);
}

#[test]
fn a_third_of_a_million_fronts_with_holes_and_islands_have_no_crack() {
    walk(&ragged(26, 22, 3), FRONTS);
}

#[test]
fn tiles_that_were_joined_have_no_crack() {
    walk_on(&glued(&with_lines(30, 26, 4), 31.0), &with_lines(30, 26, 4), 20_000);
    walk_on(&glued(&ragged(30, 30, 6), 27.0), &ragged(30, 30, 6), 20_000);
}

#[test]
fn the_laws_hold_and_the_full_front_is_the_source() {
    let grounds = [hills(40, 30, 7), with_lines(33, 25, 8), ragged(40, 40, 9)];
    let alone = grounds.iter().map(|tin| (tin, surface(tin)));
    for (tin, surface) in alone.chain(grounds.iter().map(|tin| (tin, glued(tin, 40.0)))) {
        hierarchy_law(&surface);
        let full = surface.mesh_of(&|n: NodeId| surface.exists(n));
        let faces = |mesh: &TriangleMesh| {
            let mut faces: Vec<[[u64; 3]; 3]> = (0..mesh.triangles.len())
                .map(|t| {
                    // the hierarchy knows no -0
                    let mut corners = mesh.corners(t).map(|p| (p + DVec3::ZERO).to_array().map(f64::to_bits));
                    let least = (0..3).min_by_key(|&k| corners[k]).unwrap();
                    corners.rotate_left(least);
                    corners
                })
                .collect();
            faces.sort_unstable();
            faces
        };
        assert!(faces(&full) == faces(&tin.mesh), "the full front is another mesh");
    }
}

/// Height of a mesh at a place, by looking at every triangle.
fn height(mesh: &TriangleMesh, p: DVec2) -> Option<f64> {
    (0..mesh.triangles.len()).find_map(|t| {
        let [a, b, c] = mesh.corners(t).map(|q| q - p.extend(0.0));
        let w = [b.x * c.y - b.y * c.x, c.x * a.y - c.y * a.x, a.x * b.y - a.y * b.x];
        let sum: f64 = w.iter().sum();
        (w.iter().all(|w| *w >= 0.0) && sum > 0.0).then(|| (w[0] * a.z + w[1] * b.z + w[2] * c.z) / sum)
    })
}

#[test]
fn no_place_is_further_off_than_the_error_says_and_breaklines_stay() {
    for (tin, seed) in [(hills(30, 24, 11), 1), (with_lines(28, 26, 12), 2), (with_lines(28, 26, 13), 3)] {
        let surface = if seed == 3 { glued(&tin, 30.0) } else { surface(&tin) };
        let mut rng = Rng::new(seed);
        for tolerance_m in [0.05f32, 0.3, 1.0, 3.0] {
            let mesh = surface.mesh_of(&|n: NodeId| surface.error_m(n) > tolerance_m);
            let bounds = tin.mesh.bounds();
            for _ in 0..300 {
                let share = DVec2::new(rng.unit(), rng.unit());
                let p = bounds.min.truncate() + share * (bounds.max - bounds.min).truncate();
                let (Some(a), Some(b)) = (height(&tin.mesh, p), height(&mesh, p)) else { continue };
                assert!((a - b).abs() <= f64::from(tolerance_m) + 1e-6, "{} of {tolerance_m} m at {p}", (a - b).abs());
            }
            // every point of the old lines is near the new surface's edges, in space
            let edges: Vec<[DVec3; 2]> = mesh
                .triangles
                .iter()
                .flat_map(|&[a, b, c]| {
                    [(a, b), (b, c), (c, a)].map(|(v, w)| [mesh.positions[v as usize], mesh.positions[w as usize]])
                })
                .collect();
            for &p in tin.breaklines.iter().flat_map(|l| &l.points) {
                let off = edges.iter().map(|&[a, b]| {
                    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                    p.distance(a + t * (b - a))
                });
                let off_m = off.fold(f64::INFINITY, f64::min);
                assert!(off_m <= f64::from(tolerance_m) + 1e-6, "a breakline is {off_m} m off at {tolerance_m} m");
            }
        }
        assert_eq!(line_edges(&tin).missing, 0);
    }
}
