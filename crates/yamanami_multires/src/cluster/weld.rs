//! The source as the hierarchy sees it: one vertex a place, no triangle twice, a normal and a colour for every vertex.
//!
//! Scans come with their vertices split (a corner list of an STL, the seams of textures). A split vertex is a crack to
//! whoever walks over edges, so vertices at one place become one; their colours are averaged.

use crate::MultiresError;
use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// No vertex.
const NONE: u32 = u32::MAX;

/// Most vertices of a source, so that those its hierarchy makes can still be numbered.
const MOST_VERTICES: usize = 1 << 30;

/// All vertices of a hierarchy while it is built: the source's, and behind them those that collapses make.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) colours: Vec<[u8; 3]>,
    /// Whether the source has colours.
    pub(super) has_colours: bool,
}

/// A place as numbers that are equal for equal places.
fn place_of(p: DVec3) -> [u64; 3] {
    // adding zero turns -0 into 0
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Spreads a place over 64 bits.
fn hash_of(p: DVec3) -> u64 {
    place_of(p).into_iter().fold(0x9E37_79B9_7F4A_7C15, |hash, word| {
        let mixed = (hash ^ word).wrapping_mul(0xD6E8_FEB8_6659_FD93);
        mixed ^ mixed >> 32
    })
}

/// Each vertex's first twin: the vertex of least number at the same place.
fn first_twins(positions: &[DVec3]) -> Vec<u32> {
    let size = (2 * positions.len()).next_power_of_two();
    // by hash, the first at each place; the next slot where another place has it
    let mut slots = vec![NONE; size];
    let find = |(i, &p): (usize, &DVec3)| {
        let place = place_of(p);
        let mut slot = (hash_of(p) >> 16) as usize & (size - 1);
        loop {
            match slots[slot] {
                NONE => {
                    slots[slot] = i as u32;
                    return i as u32;
                }
                twin if place_of(positions[twin as usize]) == place => return twin,
                _ => slot = (slot + 1) & (size - 1),
            }
        }
    };
    positions.iter().enumerate().map(find).collect()
}

/// Turns a triangle so that its least corner comes first.
fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Takes out what occurs twice with the same side up; the first stays.
fn drop_twins(triangles: &mut Vec<[u32; 3]>, vertices: usize) {
    let mut start = vec![0u32; vertices + 1];
    for &t in triangles.iter() {
        start[turned(t)[0] as usize + 1] += 1;
    }
    for v in 0..vertices {
        start[v + 1] += start[v];
    }
    let mut rest = vec![[0u32; 2]; triangles.len()];
    let mut filled = start.clone();
    triangles.retain(|&t| {
        let [a, b, c] = turned(t);
        let (from, to) = (start[a as usize] as usize, filled[a as usize] as usize);
        let is_new = !rest[from..to].contains(&[b, c]);
        if is_new {
            rest[to] = [b, c];
            filled[a as usize] += 1;
        }
        is_new
    });
}

/// Cleans a mesh. Its triangles' corners are then numbered without gaps in the order of the source's vertices.
pub(super) fn weld(mesh: &TriangleMesh) -> Result<(Vertices, Vec<[u32; 3]>), MultiresError> {
    let vertices = mesh.positions.len();
    if vertices.max(mesh.triangles.len() / 2) > MOST_VERTICES {
        let (count, most) = (vertices.max(mesh.triangles.len() / 2) as u64, MOST_VERTICES as u64);
        return Err(MultiresError::TooManyClusters { what: "vertices", count, most });
    }
    let is_bad = |&v: &u32| mesh.positions.get(v as usize).is_none_or(|p| !p.is_finite());
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|v| is_bad(v)) {
            return Err(MultiresError::BadCorner { triangle, vertex, vertices });
        }
    }
    let first = first_twins(&mesh.positions);
    let mut triangles: Vec<[u32; 3]> = (mesh.triangles.iter())
        .map(|t| t.map(|v| first[v as usize]))
        .filter(|&[a, b, c]| a != b && b != c && c != a)
        .collect();
    if triangles.is_empty() {
        return Err(MultiresError::NoTriangles { triangles: mesh.triangles.len() });
    }
    drop_twins(&mut triangles, vertices);

    let mut number = vec![NONE; vertices];
    for &v in triangles.as_flattened() {
        number[v as usize] = 0;
    }
    let mut out = Vertices { has_colours: mesh.colours.len() == vertices, ..Vertices::default() };
    for v in 0..vertices {
        if number[v] != NONE {
            number[v] = out.positions.len() as u32;
            out.positions.push(mesh.positions[v] + DVec3::ZERO);
        }
    }
    for corner in triangles.as_flattened_mut() {
        *corner = number[*corner as usize];
    }
    out.colours = vec![[255; 3]; out.positions.len()];
    if out.has_colours {
        let mut sums = vec![[0u32; 4]; out.positions.len()];
        for (v, &[r, g, b, _]) in mesh.colours.iter().enumerate() {
            let place = number[first[v] as usize];
            if place != NONE {
                let sum = &mut sums[place as usize];
                *sum = [sum[0] + u32::from(r), sum[1] + u32::from(g), sum[2] + u32::from(b), sum[3] + 1];
            }
        }
        for (colour, [r, g, b, n]) in out.colours.iter_mut().zip(sums) {
            *colour = [r, g, b].map(|sum| ((sum + n / 2) / n.max(1)) as u8);
        }
    }
    out.normals = normals_of(&out.positions, &triangles);
    Ok((out, triangles))
}

/// Normals of the source, each triangle counting by its area.
fn normals_of(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for t in triangles {
        let [a, b, c] = t.map(|v| positions[v as usize]);
        let area = (b - a).cross(c - a);
        for v in t {
            sums[*v as usize] += area;
        }
    }
    sums.into_par_iter().map(unit_normal).collect()
}

/// The direction of a sum of areas; upwards where it has none.
pub(super) fn unit_normal(sum: DVec3) -> [f32; 3] {
    // a scan in micrometres must not underflow
    let largest = sum.abs().max_element();
    let n = if largest > 0.0 { (sum / largest).normalize_or(DVec3::Z) } else { DVec3::Z };
    n.as_vec3().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_list_becomes_a_mesh() {
        let corner = |x: f64, y: f64| DVec3::new(x, y, -0.0 * x);
        let mut mesh = TriangleMesh::new(
            vec![
                corner(0.0, 0.0),
                corner(1.0, 0.0),
                corner(1.0, 1.0),
                corner(9.0, 9.0),
                corner(0.0, 0.0),
                corner(1.0, 1.0),
                corner(0.0, 1.0),
            ],
            vec![[0, 1, 2], [4, 5, 6], [1, 2, 4], [0, 4, 2]],
        );
        mesh.colours = vec![[10, 0, 0, 255]; 7];
        mesh.colours[4] = [20, 0, 0, 255];
        let (vertices, triangles) = weld(&mesh).unwrap();
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]], "one twin and one flat triangle are gone");
        assert_eq!(vertices.positions.len(), 4);
        assert_eq!(vertices.colours[0], [15, 0, 0]);
        assert_eq!(vertices.normals, [[0.0, 0.0, 1.0]; 4]);
    }

    #[test]
    fn what_cannot_be_built_is_named() {
        let place = |x: f64| DVec3::new(x, 0.0, 0.0);
        let mut mesh = TriangleMesh::new(vec![place(0.0), place(1.0)], vec![[0, 1, 2]]);
        assert!(weld(&mesh).unwrap_err().to_string().contains("triangle 0 names vertex 2"));
        mesh.positions.push(place(f64::NAN));
        assert!(weld(&mesh).is_err());
        mesh.positions[2] = place(1.0);
        assert!(weld(&mesh).unwrap_err().to_string().contains("nothing to build: of 1 triangles"));
        assert!(weld(&TriangleMesh::default()).is_err());
    }
}
