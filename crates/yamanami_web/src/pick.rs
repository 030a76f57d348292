//! What lies under a cursor and along a line: heights, slopes, and from how fine data they are.

use glam::{DVec2, DVec3};
use yamanami::core::LatticeNode;
use yamanami::gpu::ResidentBuffers;
use yamanami::multires::wavelet::TerrainData;
use yamanami::steer::Ground;
use yamanami::{Subject, Terrain};

/// Where a ray meets a mesh.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeshHit {
    pub(crate) place: DVec3,
    /// Unit normal of the triangle.
    pub(crate) normal: DVec3,
}

/// The first triangle of a mesh that a ray meets (Möller, Trumbore, "Fast, minimum storage ray/triangle intersection", 1997).
pub(crate) fn hit_mesh(mesh: &ResidentBuffers, eye: DVec3, direction: DVec3) -> Option<MeshHit> {
    let (vertices, from) = (mesh.vertices(), eye - mesh.origin());
    let mut nearest = f64::INFINITY;
    let mut found = None;
    for &[a, b, c] in mesh.triangles() {
        let corner = |v: u32| vertices.get(v as usize).map(|v| v.local().as_dvec3());
        let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) else { continue };
        let (ab, ac) = (b - a, c - a);
        let p = direction.cross(ac);
        let det = ab.dot(p);
        if det == 0.0 {
            continue;
        }
        let s = from - a;
        let u = s.dot(p) / det;
        if !(0.0..=1.0).contains(&u) {
            continue;
        }
        let q = s.cross(ab);
        let v = direction.dot(q) / det;
        let t = ac.dot(q) / det;
        if v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < nearest {
            nearest = t;
            found = Some(MeshHit { place: eye + direction * t, normal: ab.cross(ac).normalize_or(DVec3::Z) });
        }
    }
    found
}

/// The land at a place of a terrain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Land {
    pub(crate) height_m: f64,
    /// Upward unit normal.
    pub(crate) normal: DVec3,
    /// Spacing of the data it is from, metres.
    pub(crate) spacing_m: f64,
    /// Whether that is the source's own.
    pub(crate) is_exact: bool,
}

/// The land at a place, from the finest data in memory; `None` beyond the border.
pub(crate) fn land(terrain: &Terrain, place: DVec2) -> Option<Land> {
    let ground = Ground::of(terrain);
    if !ground.holds(place) {
        return None;
    }
    let level = finest_level(terrain, place)?;
    let step_m = terrain.geo().step_m.map(|m| m * f64::from(1u32 << level));
    let at = |dx: f64, dy: f64| ground.height_m(place + DVec2::new(dx * step_m[0], dy * step_m[1]));
    let normal =
        DVec3::new((at(-0.5, 0.0) - at(0.5, 0.0)) / step_m[0], (at(0.0, -0.5) - at(0.0, 0.5)) / step_m[1], 1.0);
    Some(Land {
        height_m: ground.height_m(place),
        normal: normal.normalize(),
        spacing_m: (step_m[0] * step_m[1]).sqrt(),
        is_exact: level == 0,
    })
}

/// The finest level whose four points around a place are in memory.
fn finest_level(terrain: &Terrain, place: DVec2) -> Option<u32> {
    let surface = terrain.surface();
    let (data, lattice) = (surface.data(), surface.numbers().lattice());
    let [column, row] = terrain.geo().grid_from_local(place.x, place.y);
    let inside = |at: f64, size: u32| at.clamp(0.0, f64::from(size - 1)) as u64;
    let (column, row) = (inside(column, lattice.width()), inside(row, lattice.height()));
    (0..=lattice.levels()).find(|&level| {
        let [nx, ny] = lattice.squares(level);
        let (x, y) = (((column >> level) as u32).min(nx - 1), ((row >> level) as u32).min(ny - 1));
        [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]]
            .iter()
            .all(|&[x, y]| data.is_resident(LatticeNode { level, x, y }))
    })
}

/// Places along a line, the same distance apart, with their distances from its start.
pub(crate) fn along(line: &[DVec2], samples: usize) -> Vec<(f64, DVec2)> {
    let lengths: Vec<f64> = line.windows(2).map(|w| w[0].distance(w[1])).collect();
    let total: f64 = lengths.iter().sum();
    let samples = samples.clamp(2, 4096);
    let (mut leg, mut before) = (0, 0.0);
    let place = |i: usize| {
        let distance = total * i as f64 / (samples - 1) as f64;
        while leg + 1 < lengths.len() && distance > before + lengths[leg] {
            before += lengths[leg];
            leg += 1;
        }
        let share = if lengths[leg] > 0.0 { ((distance - before) / lengths[leg]).clamp(0.0, 1.0) } else { 0.0 };
        (distance, line[leg].lerp(line[leg + 1], share))
    };
    if lengths.is_empty() { Vec::new() } else { (0..samples).map(place).collect() }
}

/// Heights of a mesh straight below places: the highest.
pub(crate) fn mesh_height_m(subject: &impl Subject, mesh: &ResidentBuffers, place: DVec2) -> Option<MeshHit> {
    let top_m = subject.bounds().max.z + 1.0;
    hit_mesh(mesh, place.extend(top_m), -DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami::core::TriangleMesh;

    #[test]
    fn a_line_is_walked_at_an_even_pace() {
        let line = [DVec2::ZERO, DVec2::new(3.0, 0.0), DVec2::new(3.0, 0.0), DVec2::new(3.0, 1.0)];
        let places = along(&line, 5);
        assert_eq!(places.iter().map(|p| p.0).collect::<Vec<_>>(), [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(places[4].1, DVec2::new(3.0, 1.0));
        assert!(along(&line[..1], 5).is_empty());
    }

    #[test]
    fn the_nearest_triangle_is_hit() {
        let at = |z: f64| [DVec3::new(0.0, 0.0, z), DVec3::new(4.0, 0.0, z), DVec3::new(0.0, 4.0, z)];
        let mesh = TriangleMesh::new([at(1.0), at(2.0)].concat(), vec![[0, 1, 2], [3, 4, 5]]);
        let buffers = ResidentBuffers::from_mesh(&mesh);
        let hit = hit_mesh(&buffers, DVec3::new(1.0, 1.0, 9.0), -DVec3::Z).unwrap();
        assert!((hit.place - DVec3::new(1.0, 1.0, 2.0)).length() < 1e-6 && hit.normal.z > 0.99);
        assert!(hit_mesh(&buffers, DVec3::new(3.0, 3.0, 9.0), -DVec3::Z).is_none());
    }
}
