//! The triangles of a glTF's scene with the nodes' transforms, turned from y up to z up, and what is wrong with them.
//!
//! Based on: Khronos Group, "glTF 2.0 Specification", 2021.

use super::Faults;
use super::accessor::{Accessors, Numbers, whole};
use glam::{DMat3, DMat4, DQuat, DVec3};
use serde_json::Value;

/// Most vertices and corners of all instances.
const MOST_ITEMS: usize = 1 << 27;

/// A normal of single precision or ten bits is this close to unit length.
const UNIT: f64 = 0.02;

/// Triangles of a scene.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct GlbMesh {
    /// Vertices, z up, in the tile's own frame.
    pub positions: Vec<DVec3>,
    /// Corners, all in range.
    pub triangles: Vec<[u32; 3]>,
}

/// The triangles, and whether all that the scene shows are there.
pub(super) fn geometry(document: &Value, binary: &[u8], faults: &mut Faults) -> (GlbMesh, bool) {
    let mut scene =
        Scene { document, accessors: Accessors { document, binary }, faults, mesh: GlbMesh::default(), is_whole: true };
    let number = whole(&document["scene"]).unwrap_or(0);
    let nodes = document["nodes"].as_array().map_or(&[][..], Vec::as_slice);
    let roots: Vec<usize> =
        document["scenes"][number]["nodes"].as_array().into_iter().flatten().filter_map(whole).collect();
    let mut seen = vec![false; nodes.len()];
    let mut stack: Vec<(usize, DMat4)> = roots.into_iter().rev().map(|n| (n, DMat4::IDENTITY)).collect();
    while let Some((number, world_from_parent)) = stack.pop() {
        let place = format!("node {number}");
        let Some(node) = nodes.get(number) else {
            scene.faults.add("GL02", place, format!("a node below {}", nodes.len()), number.to_string());
            continue;
        };
        if std::mem::replace(&mut seen[number], true) {
            scene.faults.add("GL02", place, "one parent", "several, or itself");
            continue;
        }
        let world_from_node = world_from_parent * parent_from_node(node);
        if !world_from_node.is_finite() {
            scene.faults.add("GL09", place, "a finite transform", format!("{world_from_node:?}"));
            continue;
        }
        if let Some(mesh) = whole(&node["mesh"]) {
            scene.instance(mesh, world_from_node);
        }
        let children = node["children"].as_array().into_iter().flatten().filter_map(whole);
        stack.extend(children.map(|child| (child, world_from_node)));
    }
    let (mut mesh, is_whole) = (scene.mesh, scene.is_whole);
    mesh.positions.iter_mut().for_each(|p| *p = DVec3::new(p.x, -p.z, p.y));
    (mesh, is_whole)
}

fn parent_from_node(node: &Value) -> DMat4 {
    let numbers = |key: &str, usual: &[f64]| -> Vec<f64> {
        let given = node[key].as_array();
        usual.iter().enumerate().map(|(k, &v)| given.and_then(|g| g.get(k)?.as_f64()).unwrap_or(v)).collect()
    };
    if node["matrix"].is_array() {
        let m = numbers("matrix", &DMat4::IDENTITY.to_cols_array());
        return DMat4::from_cols_array(&std::array::from_fn(|k| m[k]));
    }
    let (s, r, t) =
        (numbers("scale", &[1.0; 3]), numbers("rotation", &[0.0, 0.0, 0.0, 1.0]), numbers("translation", &[0.0; 3]));
    DMat4::from_scale_rotation_translation(
        DVec3::new(s[0], s[1], s[2]),
        DQuat::from_xyzw(r[0], r[1], r[2], r[3]),
        DVec3::new(t[0], t[1], t[2]),
    )
}

struct Scene<'s> {
    document: &'s Value,
    accessors: Accessors<'s>,
    faults: &'s mut Faults,
    mesh: GlbMesh,
    is_whole: bool,
}

impl Scene<'_> {
    fn instance(&mut self, number: usize, world_from_node: DMat4) {
        let document = self.document;
        let Some(mesh) = document["meshes"].get(number) else {
            self.faults.add("GL02", "nodes", "a mesh that is there", number.to_string());
            return;
        };
        for (p, primitive) in mesh["primitives"].as_array().into_iter().flatten().enumerate() {
            let place = format!("mesh {number}, primitive {p}");
            if self.primitive(&place, primitive, world_from_node).is_none() {
                self.is_whole = false;
            }
        }
    }

    fn primitive(&mut self, place: &str, primitive: &Value, world_from_node: DMat4) -> Option<()> {
        let mode = primitive["mode"].as_u64().unwrap_or(4);
        if !(4..=6).contains(&mode) {
            return Some(());
        }
        let Some(number) = whole(&primitive["attributes"]["POSITION"]) else {
            self.faults.add("GL02", place, "POSITION", "none");
            return None;
        };
        let accessor = &self.document["accessors"][number];
        if !(accessor["min"].is_array() && accessor["max"].is_array()) {
            self.faults.add("GL05", place, "min and max of POSITION", "none");
        }
        let positions = self.accessors.read(number, self.faults)?;
        if positions.width != 3 {
            self.faults.add("GL03", place, "POSITION as VEC3", positions.width.to_string());
            return None;
        }
        let points: Vec<DVec3> = positions.values.chunks_exact(3).map(DVec3::from_slice).collect();
        let bad = points.iter().filter(|p| !p.is_finite()).count();
        if bad > 0 {
            self.faults.add("GL09", place, "finite positions", format!("{bad} that are not"));
            return None;
        }
        let corners = self.corners(place, primitive, points.len())?;
        if self.mesh.positions.len() + points.len() + self.mesh.triangles.len() + corners.len() > MOST_ITEMS {
            self.faults.add("GL12", place, format!("at most {MOST_ITEMS} vertices and triangles"), "more");
            return None;
        }
        let mut triangles = triangles(&corners, mode);
        let empty = triangles.iter().filter(|t| is_degenerate(t.map(|c| points[c as usize]))).count();
        if empty > 0 {
            self.faults.add("GL08", place, "triangles with an area", format!("{empty} without"));
        }
        if let Some(normals) = whole(&primitive["attributes"]["NORMAL"]) {
            let normals = self.accessors.read(normals, self.faults)?;
            self.check_normals(place, &normals, &points, &triangles);
        }
        if DMat3::from_mat4(world_from_node).determinant() < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(points.iter().map(|&p| world_from_node.transform_point3(p)));
        self.mesh.triangles.extend(triangles.iter().map(|t| t.map(|c| first + c)));
        Some(())
    }

    fn corners(&mut self, place: &str, primitive: &Value, vertices: usize) -> Option<Vec<u32>> {
        let Some(number) = whole(&primitive["indices"]) else { return Some((0..vertices as u32).collect()) };
        let indices = self.accessors.read(number, self.faults)?;
        if let Some(k) = indices.raw.iter().position(|&i| !(i >= 0.0 && i < vertices as f64)) {
            let found = indices.raw[k].to_string();
            self.faults.add("GL04", format!("{place}, index {k}"), format!("indices below {vertices}"), found);
            return None;
        }
        Some(indices.raw.iter().map(|&i| i as u32).collect())
    }

    /// Normals have unit length and stand on the side from which the triangles are seen counter-clockwise.
    fn check_normals(&mut self, place: &str, normals: &Numbers, points: &[DVec3], triangles: &[[u32; 3]]) {
        let normals: Vec<DVec3> = normals.values.chunks_exact(3).map(DVec3::from_slice).collect();
        if normals.len() != points.len() {
            self.faults.add("GL06", place, format!("{} normals", points.len()), normals.len().to_string());
            return;
        }
        let off = normals.iter().filter(|n| !((n.length() - 1.0).abs() <= UNIT)).count();
        if off > 0 {
            self.faults.add("GL06", place, "normals of unit length", format!("{off} of {} of others", points.len()));
        }
        let against = triangles.iter().filter(|t| {
            let [a, b, c] = t.map(|k| points[k as usize]);
            let normal = t.iter().map(|&k| normals[k as usize]).sum::<DVec3>();
            let area = (b - a).cross(c - a);
            // where surfaces fold, the mean of the corners may lean over
            area.dot(normal) < -0.2 * area.length() * normal.length()
        });
        let against = against.count();
        if against > 0 {
            let found = format!("{against} of {} from behind", triangles.len());
            self.faults.add("GL10", place, "triangles that turn about their normals", found);
        }
    }
}

fn triangles(corners: &[u32], mode: u64) -> Vec<[u32; 3]> {
    match mode {
        4 => corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        5 => {
            let turned = |(k, t): (usize, &[u32])| if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
            corners.windows(3).enumerate().map(turned).collect()
        }
        _ => corners.windows(2).skip(1).map(|t| [corners[0], t[0], t[1]]).collect(),
    }
}

/// Without an area that single precision could tell from nothing.
fn is_degenerate([a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    (b - a).cross(c - a).length() <= 1e-9 * longest * longest
}
