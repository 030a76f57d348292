//! What `collapse` promises, over made models: the target is met, a surface stays one, scale and place do not matter, what is
//! locked or carried is kept, and no input breaks it.

use glam::DVec3;
use proptest::prelude::*;
use yamanami_core::{Material, TriangleMesh};
use yamanami_multires::collapse::{AttributeWeights, CollapseOptions, Collapsed, Method, StoppedBy, collapse};
use yamanami_testkit::models::{EdgeCount, edges, shake, sheet, sphere, torus};

fn to(mesh: &TriangleMesh, target_faces: usize) -> Collapsed {
    collapse(mesh, &CollapseOptions { target_faces, ..CollapseOptions::default() })
}

/// Volume inside a closed mesh.
fn volume(mesh: &TriangleMesh) -> f64 {
    (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn noisy_torus() -> TriangleMesh {
    let mut mesh = torus(120, 60, 0.05);
    shake(&mut mesh, 0.002, 1);
    mesh
}

#[test]
fn the_target_is_met_and_a_closed_surface_stays_closed() {
    // the first looks after the volume at each step
    for (method, volume_share) in [(Method::Memoryless, 0.03), (Method::Garland97, 0.06)] {
        let mesh = noisy_torus();
        for target in [7200, 1441, 200] {
            let options = CollapseOptions { target_faces: target, method, ..CollapseOptions::default() };
            let done = collapse(&mesh, &options);
            assert_eq!(done.stopped_by, StoppedBy::Target);
            let faces = done.mesh.triangles.len();
            assert!(faces <= target && faces + 2 > target, "{faces} of {target}");
            assert_eq!(edges(&done.mesh), EdgeCount { inner: faces * 3 / 2, ..EdgeCount::default() });
            // a torus: V - E + F = 0
            assert_eq!(done.mesh.positions.len() * 2, faces);
            let share = volume(&done.mesh) / volume(&mesh) - 1.0;
            assert!(share.abs() < volume_share, "{method:?} to {target}: volume changed by {share}");
        }
    }
}

#[test]
fn a_sphere_shrinks_to_few_faces_but_never_to_nothing() {
    let done = to(&sphere(4), 0);
    assert_eq!(done.stopped_by, StoppedBy::Topology);
    assert_eq!(edges(&done.mesh), EdgeCount { inner: 6, ..EdgeCount::default() }, "a tetrahedron");
}

#[test]
fn scale_and_place_do_not_matter() {
    let mesh = noisy_torus();
    let reference = to(&mesh, 1000).mesh;
    for scale in [1024.0, (1u64 << 20) as f64, 1.0 / 4096.0] {
        let mut scaled = mesh.clone();
        scaled.positions.iter_mut().for_each(|p| *p *= scale);
        let mut got = to(&scaled, 1000).mesh;
        got.positions.iter_mut().for_each(|p| *p /= scale);
        assert_eq!(got, reference, "scaled by {scale}");
    }
    let mut far = mesh.clone();
    far.positions.iter_mut().for_each(|p| *p = *p * 1000.0 + DVec3::new(1e6, -2e6, 3e5));
    let got = to(&far, 1000).mesh;
    assert_eq!(got.triangles.len(), reference.triangles.len());
    assert!((volume_about(&got) / (1e9 * volume_about(&reference)) - 1.0).abs() < 1e-3);
}

/// [`volume`], rounding less for a mesh far from zero.
fn volume_about(mesh: &TriangleMesh) -> f64 {
    let centre = mesh.bounds().centre();
    volume(&TriangleMesh::new(mesh.positions.iter().map(|&p| p - centre).collect(), mesh.triangles.clone()))
}

#[test]
fn equal_input_gives_equal_output_on_any_number_of_threads() {
    // large enough to be cut into patches
    let mesh = torus(800, 250, 0.05);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| to(&mesh, 20_000).mesh)
    };
    let one = with(1);
    assert_eq!(one, with(3));
    assert_eq!(edges(&one), EdgeCount { inner: 30_000, ..EdgeCount::default() });
}

#[test]
fn locked_vertices_stay_as_they_are() {
    let mesh = noisy_torus();
    let locked: Vec<bool> = (0..mesh.positions.len()).map(|v| v % 120 < 3).collect();
    let options = CollapseOptions { target_faces: 500, locked: Some(&locked), ..CollapseOptions::default() };
    let done = collapse(&mesh, &options);
    let mut kept: Vec<u32> =
        done.source_vertex.iter().copied().filter(|&v| v != u32::MAX && locked[v as usize]).collect();
    kept.sort_unstable();
    let expected: Vec<u32> = (0..mesh.positions.len() as u32).filter(|&v| locked[v as usize]).collect();
    assert_eq!(kept, expected, "every locked vertex is in the result");
    for (place, &v) in done.mesh.positions.iter().zip(&done.source_vertex) {
        assert!(v == u32::MAX || *place == mesh.positions[v as usize]);
    }
    assert_eq!(edges(&done.mesh).inner, done.mesh.triangles.len() * 3 / 2);
}

#[test]
fn a_border_keeps_its_line() {
    let mesh =
        sheet([60, 40], [false, false], |u, v| DVec3::new(3.0 * u, 2.0 * v, 0.1 * (9.0 * u).sin() * (7.0 * v).cos()));
    let done = to(&mesh, 300);
    assert_eq!(done.stopped_by, StoppedBy::Target);
    let bounds = done.mesh.bounds();
    assert!((bounds.max - bounds.min - DVec3::new(3.0, 2.0, 0.0)).truncate().length() < 0.02, "{bounds:?}");
    let plan: f64 = (0..done.mesh.triangles.len())
        .map(|t| done.mesh.corners(t))
        .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).z)
        .inspect(|area| assert!(*area > 0.0, "a face turned over"))
        .sum();
    assert!((plan - 6.0).abs() < 0.03, "{plan}");
}

#[test]
fn a_flat_model_keeps_its_outline() {
    let mesh = sheet([40, 40], [false, false], |u, v| DVec3::new(u, v, 0.0));
    let done = to(&mesh, 2);
    assert_eq!(done.mesh.triangles.len(), 2);
    assert!(done.estimate_m < 1e-3, "{}", done.estimate_m);
    let (got, expected) = (done.mesh.bounds(), mesh.bounds());
    assert!((got.min - expected.min).length() + (got.max - expected.max).length() < 1e-5, "{got:?}");
}

/// A torus whose texture is cut along one column and one row, with colours that follow the places.
fn painted_torus() -> TriangleMesh {
    let mut mesh = sheet([120, 60], [false, false], |u, v| {
        let turn = std::f64::consts::TAU;
        let (ring, tube) = (turn * (u % 1.0), turn * (v % 1.0));
        let out = 1.0 + 0.4 * tube.cos();
        DVec3::new(out * ring.cos(), out * ring.sin(), 0.4 * tube.sin())
    });
    mesh.texcoords = (0..61).flat_map(|j| (0..121).map(move |i| [i as f32 / 120.0, j as f32 / 60.0])).collect();
    mesh.colours =
        mesh.positions.iter().map(|p| [(127.0 + 80.0 * p.x) as u8, (127.0 + 80.0 * p.y) as u8, 90, 255]).collect();
    mesh
}

#[test]
fn seams_stay_shut_and_texture_and_colour_stay_in_place() {
    let mesh = painted_torus();
    // the method of 1997 does not look at texture
    for (method, texture_off) in [(Method::Memoryless, 0.06), (Method::Garland97, 0.3)] {
        let done = collapse(&mesh, &CollapseOptions { target_faces: 1500, method, ..CollapseOptions::default() });
        assert_eq!(done.stopped_by, StoppedBy::Target);
        let m = &done.mesh;
        assert_eq!(edges(m), EdgeCount { inner: 1500 * 3 / 2, ..EdgeCount::default() }, "{method:?}");
        assert_eq!((m.texcoords.len(), m.colours.len()), (m.positions.len(), m.positions.len()));
        for ((p, [u, v]), colour) in m.positions.iter().zip(&m.texcoords).zip(&m.colours) {
            let turn = std::f64::consts::TAU;
            let (ring, tube) = (turn * f64::from(*u), turn * f64::from(*v));
            let out = 1.0 + 0.4 * tube.cos();
            let painted = DVec3::new(out * ring.cos(), out * ring.sin(), 0.4 * tube.sin());
            assert!((painted - *p).length() < texture_off, "{method:?}: texture off by {}", (painted - *p).length());
            let red = 127.0 + 80.0 * p.x;
            assert!((f64::from(colour[0]) - red).abs() < 8.0, "{method:?}: red is {}, not {red}", colour[0]);
        }
    }
}

#[test]
fn an_edge_of_colour_on_a_flat_sheet_is_kept_only_when_colour_counts() {
    let mut mesh = sheet([60, 60], [false, false], |u, v| DVec3::new(u, v, 0.0));
    let is_red = |p: &DVec3| (p.x - 0.5).hypot(p.y - 0.5) < 0.3;
    mesh.colours = mesh.positions.iter().map(|p| if is_red(p) { [255, 0, 0, 255] } else { [0, 0, 0, 255] }).collect();
    let red_share = |weights: AttributeWeights| {
        let done = collapse(&mesh, &CollapseOptions { target_faces: 150, weights, ..CollapseOptions::default() });
        let m = &done.mesh;
        let red = |t: &[u32; 3]| t.iter().map(|&v| f64::from(m.colours[v as usize][0]) / 255.0).sum::<f64>() / 3.0;
        let area = |t: usize| {
            let [a, b, c] = m.corners(t);
            0.5 * (b - a).cross(c - a).z
        };
        (0..m.triangles.len()).map(|t| red(&m.triangles[t]) * area(t)).sum::<f64>()
    };
    let disc = std::f64::consts::PI * 0.09;
    let kept = red_share(AttributeWeights::default());
    assert!((kept / disc - 1.0).abs() < 0.06, "{kept} of {disc}");
}

#[test]
fn materials_keep_their_parts() {
    let mut mesh = sheet([40, 40], [false, false], |u, v| DVec3::new(u, v, 0.2 * (u * u - v)));
    mesh.materials = vec![Material::default(), Material { name: "other".into(), ..Material::default() }];
    mesh.material_of = (0..mesh.triangles.len()).map(|t| u16::from(t % 80 >= 40)).collect();
    let m = to(&mesh, 200).mesh;
    let area = |which: usize| {
        (0..m.triangles.len())
            .filter(|&t| m.material(t) == which)
            .map(|t| {
                let [a, b, c] = m.corners(t);
                0.5 * (b - a).cross(c - a).z
            })
            .sum::<f64>()
    };
    assert_eq!((m.materials.len(), m.material_of.len()), (2, m.triangles.len()));
    assert!((area(0) - 0.5).abs() < 0.01 && (area(1) - 0.5).abs() < 0.01, "{} {}", area(0), area(1));
}

#[test]
fn small_components_go_as_a_whole_where_the_target_asks_for_it() {
    let mut mesh = sphere(5);
    let small = sphere(2);
    for k in 0..50 {
        let (first, at) = (mesh.positions.len() as u32, DVec3::new(3.0 + f64::from(k) * 0.1, 0.0, 0.0));
        mesh.positions.extend(small.positions.iter().map(|&p| at + 0.02 * p));
        mesh.triangles.extend(small.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let done = to(&mesh, 100);
    assert_eq!(done.stopped_by, StoppedBy::Target);
    assert_eq!(edges(&done.mesh).open, 0);
    assert!(volume(&done.mesh) > 3.5, "the large one stays");
}

#[test]
fn an_error_limit_stops_it_and_tightens_with_the_limit() {
    let mesh = noisy_torus();
    let faces = [0.001, 0.004, 0.02].map(|limit| {
        let done = collapse(&mesh, &CollapseOptions { max_error_m: limit, ..CollapseOptions::default() });
        assert_eq!(done.stopped_by, StoppedBy::Error);
        assert!(done.estimate_m <= limit);
        done.mesh.triangles.len()
    });
    assert!(faces[0] > faces[1] && faces[1] > faces[2] && faces[2] > 50, "{faces:?}");
}

#[test]
fn odd_inputs_come_through() {
    let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    assert!(to(&TriangleMesh::default(), 0).mesh.triangles.is_empty());
    let one = TriangleMesh::new(vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.)], vec![[0, 1, 2]]);
    assert_eq!(to(&one, 0).mesh, one, "the last triangle stays");
    assert_eq!(to(&one, 5).mesh, one, "a target above the source changes nothing");
    // repeated corners are no triangle
    let repeated = TriangleMesh::new(one.positions.clone(), vec![[0, 1, 2], [0, 0, 1], [2, 2, 2]]);
    assert_eq!(to(&repeated, 3).mesh.triangles.len(), 1);
    // all at one place
    let point = TriangleMesh::new(vec![p(5., 5., 5.); 3], vec![[0, 1, 2]]);
    assert!(to(&point, 0).mesh.triangles.is_empty());
    // a fan of five triangles on one edge
    let mut fan = TriangleMesh::new(vec![p(0., 0., 0.), p(0., 0., 1.)], Vec::new());
    for k in 0..5 {
        fan.positions.push(p(f64::from(k).cos(), f64::from(k).sin(), 0.5));
        fan.triangles.push([0, 1, 2 + k as u32]);
    }
    let done = to(&fan, 3);
    assert!(done.mesh.triangles.len() >= 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Any triangles over any places: no panic, never more faces, indices in range, edges no worse.
    #[test]
    fn any_soup_comes_through(
        places in prop::collection::vec((0i32..4, 0i32..4, 0i32..3), 3..30),
        corners in prop::collection::vec((0usize..30, 0usize..30, 0usize..30), 1..60),
        target in 0usize..20,
        garland in any::<bool>(),
    ) {
        let n = places.len();
        let mesh = TriangleMesh::new(
            places.iter().map(|&(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z))).collect(),
            corners.iter().map(|&(a, b, c)| [a, b, c].map(|v| (v % n) as u32)).collect(),
        );
        let method = if garland { Method::Garland97 } else { Method::Memoryless };
        let done = collapse(&mesh, &CollapseOptions { target_faces: target, method, ..CollapseOptions::default() });
        let m = &done.mesh;
        prop_assert!(m.triangles.len() <= mesh.triangles.len());
        prop_assert!(m.triangles.iter().flatten().all(|&v| (v as usize) < m.positions.len()));
        prop_assert!(m.positions.iter().all(|p| p.is_finite()));
        prop_assert!(edges(m).crowded <= edges(&mesh).crowded);
        prop_assert_eq!(done.source_vertex.len(), m.positions.len());
    }
}
