//! What is wrong with a scan: holes, edges of more than two faces, faces twice or without area, loose parts. Everything
//! is counted by sorting, in parts of bounded size, so that twenty million faces take seconds and little more memory than
//! the mesh itself.

use crate::conformity::connected_runs;
use crate::places::places;
use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// A triangle whose height is below this part of its longest side has no area.
const FLAT_RELATIVE: f64 = 1e-12;
/// Edges or faces that are sorted at once.
const AT_ONCE: usize = 1 << 25;
/// Finest parts that a pass may start and end at.
const BUCKETS: usize = 1 << 12;

/// The defects of a mesh. Vertices at one position are one place, and topology is that of the places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct MeshDefects {
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Vertices of the mesh.
    pub vertices: usize,
    /// Different positions that triangles use.
    pub places: usize,
    /// Parts that share no place with each other.
    pub components: usize,
    /// Edges with one triangle: borders, and the rims of holes.
    pub open_edges: usize,
    /// Connected runs of open edges; 0 for a closed mesh.
    pub border_loops: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles run along them in the same direction: one of them faces the other way.
    pub inconsistent_edges: usize,
    /// Triangles on the same three places as one before them, whichever way they face.
    pub duplicate_faces: usize,
    /// Triangles with two corners at one place.
    pub repeated_corner_faces: usize,
    /// Triangles on three places in a line.
    pub zero_area_faces: usize,
    /// Vertices that no triangle uses.
    pub isolated_vertices: usize,
    /// Places with several used vertices: seams, or faces that do not share their vertices.
    pub unwelded_places: usize,
    /// Triangles that are counter-clockwise seen from above: all of them in a terrain.
    pub faces_up: usize,
}

/// Counts the defects of a mesh.
///
/// # Panics
/// When a triangle names a vertex that the mesh does not have.
pub fn mesh_defects(mesh: &TriangleMesh) -> MeshDefects {
    defects_in_parts(mesh, AT_ONCE)
}

fn defects_in_parts(mesh: &TriangleMesh, at_once: usize) -> MeshDefects {
    let place = places(mesh);
    let mut found =
        MeshDefects { triangles: mesh.triangles.len(), vertices: mesh.positions.len(), ..MeshDefects::default() };
    count_vertices(mesh, &place, &mut found);
    count_components(mesh, &place, &mut found);
    count_shapes(mesh, &place, &mut found);
    count_edges(mesh, &place, at_once, &mut found);
    found.duplicate_faces = duplicates(mesh, &place, at_once);
    found
}

fn count_vertices(mesh: &TriangleMesh, place: &[u32], found: &mut MeshDefects) {
    let mut used = vec![false; place.len()];
    for &i in mesh.triangles.iter().flatten() {
        used[i as usize] = true;
    }
    // how many of a place's vertices are used, as far as it matters
    let mut at = vec![0u8; place.len()];
    for (i, _) in used.iter().enumerate().filter(|&(_, &u)| u) {
        let at = &mut at[place[i] as usize];
        *at = at.saturating_add(1);
    }
    found.isolated_vertices = used.iter().filter(|&&u| !u).count();
    found.places = at.iter().filter(|&&n| n > 0).count();
    found.unwelded_places = at.iter().filter(|&&n| n > 1).count();
}

fn count_components(mesh: &TriangleMesh, place: &[u32], found: &mut MeshDefects) {
    let mut parent: Vec<u32> = (0..place.len() as u32).collect();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    found.components = found.places;
    for &[a, b, c] in &mesh.triangles {
        let first = place[a as usize];
        for other in [place[b as usize], place[c as usize]] {
            let (p, q) = (root(&mut parent, first), root(&mut parent, other));
            if p != q {
                parent[p.max(q) as usize] = p.min(q);
                found.components -= 1;
            }
        }
    }
}

fn count_shapes(mesh: &TriangleMesh, place: &[u32], found: &mut MeshDefects) {
    let shape = |t: &[u32; 3]| -> [usize; 3] {
        let [a, b, c] = t.map(|i| place[i as usize]);
        let [p, q, r] = t.map(|i| mesh.positions[i as usize]);
        let normal = (q - p).cross(r - p);
        let longest = (q - p).length_squared().max((r - q).length_squared()).max((p - r).length_squared());
        let repeated = a == b || b == c || c == a;
        let flat = !repeated && normal.length() <= FLAT_RELATIVE * longest;
        [repeated, flat, normal.z > FLAT_RELATIVE * plan_longest([p, q, r])].map(usize::from)
    };
    let add = |a: [usize; 3], b: [usize; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let counts = mesh.triangles.par_iter().map(shape).reduce(|| [0; 3], add);
    [found.repeated_corner_faces, found.zero_area_faces, found.faces_up] = counts;
}

/// Square of the longest side seen from above.
fn plan_longest([p, q, r]: [DVec3; 3]) -> f64 {
    let square = |a: DVec3, b: DVec3| (a - b).truncate().length_squared();
    square(p, q).max(square(q, r)).max(square(r, p))
}

fn count_edges(mesh: &TriangleMesh, place: &[u32], at_once: usize, found: &mut MeshDefects) {
    let edges = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| place[i as usize]);
        // a face with a repeated corner has no sides
        let whole = a != b && b != c && c != a;
        [[a, b], [b, c], [c, a]].into_iter().filter(move |_| whole)
    };
    let mut open = Vec::new();
    for (from, to) in parts(place.len(), 3 * mesh.triangles.len(), at_once, || {
        mesh.triangles.iter().flat_map(edges).map(|[p, q]| p.min(q))
    }) {
        // lower end, higher end, and in the last bit the direction
        let mut keys: Vec<u64> = mesh
            .triangles
            .par_iter()
            .flat_map_iter(edges)
            .filter(|[p, q]| (from..to).contains(p.min(q)))
            .map(|[p, q]| u64::from(p.min(q) - from) << 33 | u64::from(p.max(q)) << 1 | u64::from(p < q))
            .collect();
        keys.par_sort_unstable();
        for same in keys.chunk_by(|a, b| a >> 1 == b >> 1) {
            match same {
                [edge] => open.push([(edge >> 33) as u32 + from, (edge >> 1) as u32]),
                [first, second] => found.inconsistent_edges += usize::from(first == second),
                _ => found.non_manifold_edges += 1,
            }
        }
    }
    found.open_edges = open.len();
    found.border_loops = connected_runs(&open);
}

fn duplicates(mesh: &TriangleMesh, place: &[u32], at_once: usize) -> usize {
    let sorted = |t: &[u32; 3]| {
        let mut places = t.map(|i| place[i as usize]);
        places.sort_unstable();
        places
    };
    let mut count = 0;
    for (from, to) in parts(place.len(), mesh.triangles.len(), at_once, || mesh.triangles.iter().map(|t| sorted(t)[0]))
    {
        let mut faces: Vec<[u32; 3]> =
            mesh.triangles.par_iter().map(sorted).filter(|t| (from..to).contains(&t[0])).collect();
        faces.par_sort_unstable();
        count += faces.windows(2).filter(|pair| pair[0] == pair[1]).count();
    }
    count
}

/// Ranges of vertices such that about `at_once` of the items fall in each, by an item's vertex.
fn parts<I: Iterator<Item = u32>>(
    vertices: usize,
    items: usize,
    at_once: usize,
    item_vertices: impl Fn() -> I,
) -> Vec<(u32, u32)> {
    let end = vertices as u32;
    if items <= at_once && vertices < 1 << 31 {
        return vec![(0, end)];
    }
    let width = vertices.div_ceil(BUCKETS).max(1);
    let mut counts = [0usize; BUCKETS];
    for vertex in item_vertices() {
        counts[vertex as usize / width] += 1;
    }
    let mut parts = Vec::new();
    let (mut from, mut held) = (0, 0);
    for (bucket, count) in counts.into_iter().enumerate() {
        let start = (bucket * width).min(vertices);
        // a pass numbers its vertices in 31 bits
        if (held + count > at_once && held > 0) || start + width - from >= 1 << 31 {
            parts.push((from as u32, start as u32));
            (from, held) = (start, 0);
        }
        held += count;
    }
    parts.push((from as u32, end));
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::{BTreeMap, BTreeSet};

    fn mesh(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> TriangleMesh {
        TriangleMesh::new(points.iter().map(|&p| p.into()).collect(), triangles.to_vec())
    }

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn a_closed_solid_has_no_defect() {
        let found = mesh_defects(&mesh(&CORNERS, &TETRAHEDRON));
        let expected = MeshDefects { triangles: 4, vertices: 4, places: 4, components: 1, ..found };
        assert_eq!(found, expected);
        assert_eq!(found.open_edges + found.border_loops + found.non_manifold_edges + found.inconsistent_edges, 0);
        assert_eq!(found.duplicate_faces + found.repeated_corner_faces + found.zero_area_faces, 0);
    }

    #[test]
    fn each_defect_is_counted_once() {
        let mut points = CORNERS.to_vec();
        points.extend([[0.0, 0.0, 0.0], [9.0, 9.0, 9.0], [2.0, 0.0, 0.0]]);
        let mut triangles = TETRAHEDRON.to_vec();
        // a face twice, once turned; a face with a corner twice; three corners in a line; a vertex beside another
        triangles.extend([[0, 1, 2], [1, 1, 3], [4, 1, 6]]);
        let found = mesh_defects(&mesh(&points, &triangles));
        assert_eq!((found.places, found.unwelded_places, found.isolated_vertices), (5, 1, 1));
        assert_eq!((found.duplicate_faces, found.repeated_corner_faces, found.zero_area_faces), (1, 1, 1));
        // the doubled face's three sides (one of them also the line's) and the line's two open ones
        assert_eq!((found.non_manifold_edges, found.open_edges, found.border_loops), (3, 2, 1));
        assert_eq!(found.components, 1);
    }

    #[test]
    fn a_fan_of_three_faces_and_a_turned_neighbour_are_told() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
        let found = mesh_defects(&mesh(&points, &[[0, 1, 2], [0, 1, 3], [1, 0, 4]]));
        assert_eq!((found.non_manifold_edges, found.open_edges), (1, 6));
        let found = mesh_defects(&mesh(&points, &[[0, 1, 2], [0, 1, 4]]));
        assert_eq!((found.inconsistent_edges, found.components, found.faces_up), (1, 1, 1));
    }

    #[test]
    fn parts_cover_all_vertices() {
        let vertices = 3 * AT_ONCE / 2;
        let parts = parts(vertices, vertices, AT_ONCE, || 0..vertices as u32);
        assert!(parts.len() > 1 && parts[0].0 == 0 && parts.last().unwrap().1 == vertices as u32);
        assert!(parts.windows(2).all(|pair| pair[0].1 == pair[1].0));
    }

    /// The same counts by maps and searches, as plainly as can be.
    fn slowly(mesh: &TriangleMesh) -> MeshDefects {
        let key = |i: u32| mesh.positions[i as usize].to_array().map(|c| (c + 0.0).to_bits());
        let places: Vec<[[u64; 3]; 3]> = mesh.triangles.iter().map(|t| t.map(key)).collect();
        let mut edges: BTreeMap<[[u64; 3]; 2], Vec<bool>> = BTreeMap::new();
        let mut found = MeshDefects::default();
        let mut faces = BTreeSet::new();
        let mut parts: Vec<BTreeSet<[u64; 3]>> = Vec::new();
        for &[a, b, c] in &places {
            let mut face = [a, b, c];
            face.sort_unstable();
            found.duplicate_faces += usize::from(!faces.insert(face));
            let (joined, apart): (Vec<_>, Vec<_>) =
                parts.into_iter().partition(|part| face.iter().any(|p| part.contains(p)));
            parts = apart;
            parts.push(joined.into_iter().flatten().chain(face).collect());
            if a == b || b == c || c == a {
                found.repeated_corner_faces += 1;
                continue;
            }
            for [p, q] in [[a, b], [b, c], [c, a]] {
                edges.entry([p.min(q), p.max(q)]).or_default().push(p < q);
            }
        }
        found.components = parts.len();
        for sides in edges.values() {
            match sides[..] {
                [_] => found.open_edges += 1,
                [first, second] => found.inconsistent_edges += usize::from(first == second),
                _ => found.non_manifold_edges += 1,
            }
        }
        let used: BTreeSet<u32> = mesh.triangles.iter().flatten().copied().collect();
        found.places = used.iter().map(|&i| key(i)).collect::<BTreeSet<_>>().len();
        found.isolated_vertices = mesh.positions.len() - used.len();
        found
    }

    proptest! {
        #[test]
        fn sorting_in_parts_counts_what_searching_finds(
            points in prop::collection::vec(prop::array::uniform3(-1..2i32), 3..25),
            faces in prop::collection::vec(prop::array::uniform3(0..1000u32), 1..40),
            at_once in 1..50usize,
        ) {
            let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
            let faces: Vec<[u32; 3]> = faces.iter().map(|t| t.map(|i| i % points.len() as u32)).collect();
            let mesh = mesh(&points, &faces);
            let found = mesh_defects(&mesh);
            prop_assert_eq!(defects_in_parts(&mesh, at_once), found);
            let slow = slowly(&mesh);
            let expected = MeshDefects {
                components: slow.components,
                places: slow.places,
                open_edges: slow.open_edges,
                inconsistent_edges: slow.inconsistent_edges,
                non_manifold_edges: slow.non_manifold_edges,
                duplicate_faces: slow.duplicate_faces,
                repeated_corner_faces: slow.repeated_corner_faces,
                isolated_vertices: slow.isolated_vertices,
                ..found
            };
            prop_assert_eq!(found, expected);
        }
    }
}
