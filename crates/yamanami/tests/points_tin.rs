//! Real point clouds become TINs. Skipped where the shared data are absent.

use glam::DVec3;
use std::collections::HashSet;
use std::path::Path;
use yamanami_core::{Breakline, BreaklineKind};
use yamanami_io::points::{PointReadOptions, ReadPoints, read_points};
use yamanami_multires::tin::{DelaunayOptions, Triangulated, mend, triangulate};

fn cloud(name: &str) -> Option<ReadPoints> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/tin").join(name);
    path.exists().then(|| read_points(path, &PointReadOptions::default()).unwrap())
}

fn bits(p: DVec3) -> [u64; 3] {
    p.to_array().map(f64::to_bits)
}

/// Each step of each line is an edge.
fn keeps_its_lines(made: &Triangulated) -> bool {
    let mesh = &made.tin.mesh;
    let edges: HashSet<_> = mesh
        .triangles
        .iter()
        .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]])
        .flat_map(|[a, b]| [[a, b], [b, a]])
        .map(|edge| edge.map(|v| bits(mesh.positions[v as usize])))
        .collect();
    let mut steps = made.tin.breaklines.iter().flat_map(|line| line.points.windows(2));
    steps.all(|step| edges.contains(&[bits(step[0]), bits(step[1])]))
}

#[test]
fn clouds_make_sound_tins() {
    for (name, vertices) in [
        ("autzen_trim_110000pts.laz", 26_107),
        ("autzen_thin_10653pts_full_image_extent.las", 2719),
    ] {
        let Some(read) = cloud(name) else { return };
        let made = triangulate(&read.points_m, &[], &DelaunayOptions::default()).unwrap();
        let twins: HashSet<_> = read.points_m.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
        assert_eq!(made.tin.mesh.positions.len(), twins.len(), "{:?}", made.notes);
        assert!(twins.len() <= vertices && twins.len() + 100 > vertices);
        let given: HashSet<_> = read.points_m.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
        assert!(made.tin.mesh.positions.iter().all(|p| given.contains(&[p.x.to_bits(), p.y.to_bits()])));
        let mended = mend(made.tin.clone());
        assert_eq!(mended.faults, []);
        assert_eq!(mended.tin, made.tin);
    }
}

#[test]
fn a_pond_and_a_road_in_a_cloud_are_kept() {
    let Some(read) = cloud("autzen_trim_110000pts.laz") else { return };
    let (low, high) = read.points_m.iter().fold((DVec3::MAX, DVec3::MIN), |(low, high), &p| (low.min(p), high.max(p)));
    let at = |u: f64, v: f64, z: f64| DVec3::new(low.x + u * (high.x - low.x), low.y + v * (high.y - low.y), z);
    let line = |name: &str, kind, places: &[(f64, f64)], z: f64| Breakline {
        name: name.into(),
        kind,
        points: places.iter().map(|&(u, v)| at(u, v, z)).collect(),
    };
    let lines = [
        line("pond", BreaklineKind::Hard, &[(0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6), (0.4, 0.4)], 125.0),
        line("road", BreaklineKind::Hard, &[(0.1, 0.5), (0.9, 0.52)], 130.0),
        line("site", BreaklineKind::Boundary, &[(0.05, 0.05), (0.95, 0.05), (0.95, 0.95), (0.05, 0.95)], f64::NAN),
    ];
    let made = triangulate(&read.points_m, &lines, &DelaunayOptions::default()).unwrap();
    assert!(keeps_its_lines(&made));
    assert_eq!(made.notes.iter().filter(|n| n.starts_with("line 'pond' and line 'road' cross at")).count(), 2);
    assert_eq!(mend(made.tin.clone()).faults, []);
    assert!(made.tin.mesh.positions.iter().all(|p| p.x >= at(0.05, 0.0, 0.0).x && p.x <= at(0.95, 0.0, 0.0).x));
}
