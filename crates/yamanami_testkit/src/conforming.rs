//! Whether a mesh has no crack, no T-vertex, no flipped triangle, and the border it should have.

use crate::laws::Kind;
use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::TriangleMesh;

/// Lengths off a line, relative to the line's own, below which a point lies on it.
const ON_LINE: f64 = 1e-9;

/// Twice the area over the longest side squared, below which a triangle has no area.
const SLIVER: f64 = 1e-12;

/// Says what is wrong with `mesh`, as the closure law has it: every edge belongs to two triangles that run along it in
/// opposite directions, or lies on the border; no vertex lies inside an edge; no triangle is degenerate or, for terrain,
/// clockwise in plan. Without holes the border is that of `base`, in plan.
pub fn check_conforming(mesh: &TriangleMesh, base: &TriangleMesh, kind: Kind) -> Result<(), String> {
    check_vertices(mesh, kind)?;
    check_triangles(mesh, kind)?;
    let border = border_edges(mesh)?;
    check_t_vertices(mesh, &border, kind)?;
    if kind == Kind::TerrainWithHoles {
        return Ok(());
    }
    let base_border = border_edges(base)?;
    check_border(mesh, &border, base, &base_border, kind)?;
    if kind == Kind::Terrain {
        let (area_m2, base_area_m2) = (plan_area_m2(mesh), plan_area_m2(base));
        if (area_m2 - base_area_m2).abs() > 1e-9 * base_area_m2 {
            return Err(format!("covers {area_m2} m² in plan, the base mesh {base_area_m2} m²"));
        }
    }
    Ok(())
}

fn check_vertices(mesh: &TriangleMesh, kind: Kind) -> Result<(), String> {
    if !mesh.normals.is_empty() && mesh.normals.len() != mesh.positions.len() {
        return Err(format!("{} normals for {} positions", mesh.normals.len(), mesh.positions.len()));
    }
    let mut seen = HashMap::new();
    for (i, &p) in mesh.positions.iter().enumerate() {
        if !p.is_finite() {
            return Err(format!("vertex {i} is at {p}"));
        }
        let place = place_of(p, kind);
        if let Some(other) = seen.insert(place.to_array().map(bits), i) {
            return Err(format!("vertices {other} and {i} are both at {place}: a seam"));
        }
    }
    Ok(())
}

/// Where a vertex lies as far as borders and seams are concerned: terrain is looked at from above.
fn place_of(p: DVec3, kind: Kind) -> DVec3 {
    if kind == Kind::Solid { p } else { p.truncate().extend(0.0) }
}

/// Bits that are equal for equal numbers.
pub(crate) fn bits(x: f64) -> u64 {
    (x + 0.0).to_bits()
}

fn check_triangles(mesh: &TriangleMesh, kind: Kind) -> Result<(), String> {
    for (t, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&i) = corners.iter().find(|&&i| i as usize >= mesh.positions.len()) {
            return Err(format!("triangle {t} uses vertex {i} of {}", mesh.positions.len()));
        }
        let [a, b, c] = mesh.corners(t);
        let cross = (b - a).cross(c - a);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        let area = if kind == Kind::Solid { cross.length() } else { cross.z };
        if area < 0.0 {
            return Err(format!("triangle {t} {corners:?} is clockwise in plan: {a} {b} {c}"));
        }
        if area <= SLIVER * longest {
            return Err(format!("triangle {t} {corners:?} has no area: {a} {b} {c}"));
        }
    }
    Ok(())
}

/// Directed edges without a partner, in order; an error when two triangles run along an edge the same way.
fn border_edges(mesh: &TriangleMesh) -> Result<Vec<[u32; 2]>, String> {
    let mut edges: Vec<[u32; 3]> = Vec::with_capacity(3 * mesh.triangles.len());
    for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        edges.extend([[a, b, t as u32], [b, c, t as u32], [c, a, t as u32]]);
    }
    edges.sort_unstable();
    for pair in edges.windows(2) {
        if pair[0][..2] == pair[1][..2] {
            let [from, to, _] = pair[0];
            return Err(format!("triangles {} and {} both run from vertex {from} to {to}", pair[0][2], pair[1][2]));
        }
    }
    let has = |from: u32, to: u32| {
        let next = edges.partition_point(|e| e[..2] < [from, to][..]);
        edges.get(next).is_some_and(|e| e[..2] == [from, to])
    };
    Ok(edges.iter().filter(|e| !has(e[1], e[0])).map(|e| [e[0], e[1]]).collect())
}

/// A T-vertex lies inside an edge of one triangle and at the corner of others; all of these edges then lack a partner, so
/// only the border need be looked at.
fn check_t_vertices(mesh: &TriangleMesh, border: &[[u32; 2]], kind: Kind) -> Result<(), String> {
    let place = |i: u32| place_of(mesh.positions[i as usize], kind);
    let mut by_x: Vec<u32> = border.iter().map(|e| e[0]).collect();
    by_x.sort_by(|&a, &b| place(a).x.total_cmp(&place(b).x).then(a.cmp(&b)));
    for &[from, to] in border {
        let (p, q) = (place(from), place(to));
        let slack_m = ON_LINE * (q - p).length();
        let first = by_x.partition_point(|&i| place(i).x < p.x.min(q.x) - slack_m);
        for &i in by_x[first..].iter().take_while(|&&i| place(i).x <= p.x.max(q.x) + slack_m) {
            if i != from && i != to && lies_inside(place(i), p, q) {
                return Err(format!("vertex {i} at {} is a T-vertex: it lies inside the edge {p} to {q}", place(i)));
            }
        }
    }
    Ok(())
}

/// Whether `v` is on the open segment from `p` to `q`.
fn lies_inside(v: DVec3, p: DVec3, q: DVec3) -> bool {
    let along = q - p;
    let t = (v - p).dot(along) / along.length_squared();
    t > ON_LINE && t < 1.0 - ON_LINE && (v - (p + along * t)).length() <= ON_LINE * along.length()
}

/// Every border edge lies on a border edge of the base mesh, and together they are as long.
fn check_border(
    mesh: &TriangleMesh,
    border: &[[u32; 2]],
    base: &TriangleMesh,
    base_border: &[[u32; 2]],
    kind: Kind,
) -> Result<(), String> {
    let ends = |m: &TriangleMesh, e: [u32; 2]| e.map(|i| place_of(m.positions[i as usize], kind));
    let base_ends: Vec<[DVec3; 2]> = base_border.iter().map(|&e| ends(base, e)).collect();
    let on = |v: DVec3, [p, q]: [DVec3; 2]| v == p || v == q || lies_inside(v, p, q);
    let length = |[p, q]: [DVec3; 2]| (q - p).length();
    let mut total_m = 0.0;
    for &edge in border {
        let [p, q] = ends(mesh, edge);
        if !base_ends.iter().any(|&b| on(p, b) && on(q, b) && (q - p).dot(b[1] - b[0]) > 0.0) {
            return Err(format!("a crack: the edge {p} to {q} has one triangle and is not on the base mesh's border"));
        }
        total_m += length([p, q]);
    }
    let base_total_m: f64 = base_ends.iter().map(|&b| length(b)).sum();
    if (total_m - base_total_m).abs() > 1e-9 * base_total_m {
        return Err(format!("the border is {total_m} m long, the base mesh's {base_total_m} m"));
    }
    Ok(())
}

fn plan_area_m2(mesh: &TriangleMesh) -> f64 {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            0.5 * (b - a).truncate().perp_dot((c - a).truncate())
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit square of four triangles around its middle.
    fn square() -> TriangleMesh {
        let at = |x: f64, y: f64| DVec3::new(x, y, x * y);
        TriangleMesh {
            positions: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0), at(0.5, 0.5)],
            triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
            ..TriangleMesh::default()
        }
    }

    fn complaint(spoil: impl FnOnce(&mut TriangleMesh)) -> String {
        let mut mesh = square();
        spoil(&mut mesh);
        check_conforming(&mesh, &square(), Kind::Terrain).unwrap_err()
    }

    #[test]
    fn a_good_mesh_passes() {
        check_conforming(&square(), &square(), Kind::Terrain).unwrap();
        let mut holed = square();
        holed.triangles.pop();
        check_conforming(&holed, &square(), Kind::TerrainWithHoles).unwrap();
    }

    #[test]
    fn each_defect_is_named() {
        assert!(complaint(|m| m.triangles[2].swap(0, 1)).contains("clockwise"));
        assert!(complaint(|m| m.triangles.truncate(3)).contains("crack"));
        assert!(complaint(|m| m.positions[4] = DVec3::new(0.5, 0.0, 0.0)).contains("no area"));
        assert!(complaint(|m| m.triangles.push([0, 1, 4])).contains("both run"));
        assert!(complaint(|m| m.triangles[0] = [0, 1, 9]).contains("uses vertex 9 of 5"));
        assert!(complaint(|m| m.positions[0].z = f64::NAN).contains("NaN"));
        assert!(complaint(|m| m.positions[2].y = 2.0).contains("base mesh"));
    }

    #[test]
    fn a_t_vertex_is_found_even_where_holes_allow_any_border() {
        let mut mesh = square();
        // split one inner edge on one side only
        mesh.positions.push(DVec3::new(0.25, 0.25, 0.0));
        mesh.triangles[0] = [0, 1, 5];
        mesh.triangles.push([5, 1, 4]);
        let message = check_conforming(&mesh, &square(), Kind::TerrainWithHoles).unwrap_err();
        assert!(message.contains("T-vertex"), "{message}");
        mesh.positions[5] = DVec3::new(0.5, 0.5, 3.0);
        let message = check_conforming(&mesh, &square(), Kind::TerrainWithHoles).unwrap_err();
        assert!(message.contains("seam"), "{message}");
    }
}
