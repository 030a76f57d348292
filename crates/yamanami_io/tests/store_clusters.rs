//! The surface database of models: clusters of any kind go in and come back, and no bytes make it panic.

use glam::DVec3;
use proptest::prelude::*;
use std::path::Path;
use yamanami_core::{Aabb, BASE_CLUSTERS, ClusterNode, ClusterPage, ClusterVertex, Crs, Snap, Sphere};
use yamanami_io::IoError;
use yamanami_io::store::{
    ClusterCodec, ClusterMeta, ClusterStore, ClusterWriter, PageShape, Rounding, TerrainStore, TinMeta, put_in_order,
};

/// A hierarchy as a builder would hand it over: a wavy square, and nodes that make a part of it finer.
#[derive(Debug, Clone)]
struct Model {
    nodes: Vec<ClusterNode>,
    base_clusters: Vec<u16>,
    base: ClusterPage,
    pages: Vec<ClusterPage>,
}

fn vertex(x: f64, y: f64) -> ClusterVertex {
    let z = 0.3 * (3.0 * x).sin() * (2.0 * y).cos();
    let normal = DVec3::new(-0.9 * (3.0 * x).cos(), 0.6 * (2.0 * y).sin(), 1.0).normalize().to_array();
    let colour = [(40.0 * x) as u8, (30.0 * y) as u8, (20.0 * (x + y)) as u8];
    ClusterVertex { position_m: [x, y, z], normal: normal.map(|n| n as f32), colour }
}

/// A grid of `side` × `side` squares from (x0, y0) on; its vertices and triangles by place.
fn grid(side: u32, x0: f64, y0: f64, step: f64) -> (Vec<ClusterVertex>, Vec<[u32; 3]>) {
    let at = |x: u32, y: u32| y * (side + 1) + x;
    let places = (0..=side).flat_map(|y| (0..=side).map(move |x| (f64::from(x), f64::from(y))));
    let squares = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    let halves = squares
        .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]]);
    (places.map(|(x, y)| vertex(x0 + step * x, y0 + step * y)).collect(), halves.collect())
}

fn model(count: u32) -> Model {
    let (vertices, triangles) = grid(8, 0.0, 0.0, 1.0);
    let base_clusters = vec![100, 28];
    let base = ClusterPage { group: BASE_CLUSTERS, vertices, removed: Vec::new(), triangles };
    let (mut nodes, mut pages) = (Vec::new(), Vec::new());
    let mut next_vertex = base.vertices.len() as u32;
    for group in 0..count {
        let (vertices, triangles) = grid(10, f64::from(group) * 0.1, 1.0, 0.05);
        // every third corner is one that an ancestor brought
        let id = |v: u32| if v.is_multiple_of(3) { v % 60 } else { next_vertex + v };
        nodes.push(ClusterNode {
            error_m: 1.0 / f64::from(group + 1) as f32,
            bound: Sphere { centre: DVec3::new(1.0, 2.0, f64::from(group)), radius_m: 3.3 },
            level: group,
            replaced: vec![if group == 0 { (BASE_CLUSTERS, 1) } else { (group - 1, 0) }],
            cluster_triangles: vec![120, 80],
            first_vertex: next_vertex,
            vertex_count: vertices.len() as u32,
        });
        pages.push(ClusterPage {
            group,
            removed: vec![60 + group % 7, 70, 75 + group % 3],
            triangles: triangles.iter().map(|t| t.map(id)).collect(),
            vertices,
        });
        next_vertex += 121;
    }
    Model { nodes, base_clusters, base, pages }
}

impl Model {
    fn meta(&self) -> ClusterMeta {
        let bounds = Aabb { min: DVec3::new(0.0, 0.0, -0.3), max: DVec3::new(8.0, 8.0, 0.3) };
        let all = || std::iter::once(&self.base).chain(&self.pages);
        ClusterMeta {
            title: "wave".into(),
            source: "wave.ply".into(),
            source_faces: 9000,
            source_vertices: 4500,
            quantum_m: ClusterMeta::usual_quantum_m(&bounds, 0.05),
            max_error_m: ClusterMeta::usual_quantum_m(&bounds, 0.05) * 3f64.sqrt() / 2.0,
            bounds,
            has_colours: true,
            nodes: self.nodes.len() as u32,
            triangles: all().map(|p| p.triangles.len() as u64).sum(),
            vertices: all().map(|p| p.vertices.len() as u64).sum(),
            tin: None,
        }
    }

    fn write(&self, path: &Path) -> Result<(), IoError> {
        let base_vertices = self.base.vertices.len() as u32;
        let mut writer = ClusterWriter::create(path, self.meta(), &self.nodes, base_vertices, &self.base_clusters)?;
        let codec = writer.codec();
        writer.insert(BASE_CLUSTERS, &codec.encode(&self.base, 0)?)?;
        for (node, page) in self.nodes.iter().zip(&self.pages) {
            writer.insert(page.group, &codec.encode(page, node.first_vertex)?)?;
        }
        writer.finish()
    }
}

fn shape(page: &ClusterPage, first_vertex: u32) -> PageShape {
    PageShape {
        group: page.group,
        first_vertex,
        vertices: page.vertices.len() as u32,
        triangles: page.triangles.len() as u64,
        replaced_triangles: page.removed.len() as u64,
    }
}

/// The same page, its vertices near enough.
fn assert_alike(back: &ClusterPage, page: &ClusterPage, max_error_m: f64) {
    assert_eq!(back.triangles, page.triangles);
    assert_eq!(back.removed, page.removed);
    assert_eq!(back.vertices.len(), page.vertices.len());
    for (a, b) in back.vertices.iter().zip(&page.vertices) {
        let [p, q] = [a, b].map(|v| DVec3::from_array(v.position_m));
        assert!(p.distance(q) <= max_error_m * 1.000_001, "{p} {q}");
        let cos: f32 = a.normal.iter().zip(b.normal).map(|(a, b)| a * b).sum();
        assert!(cos > 0.9998, "{:?} {:?}", a.normal, b.normal);
        assert_eq!(a.colour, b.colour);
    }
}

#[test]
fn a_file_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wave.yama");
    let mut model = model(2500);
    put_in_order(&model.nodes, &model.base_clusters, &mut model.base, &mut model.pages);
    model.write(&path).unwrap();
    assert!(!folder.path().join("wave.yama.part").exists());
    let store = ClusterStore::open(&path).unwrap();
    store.verify().unwrap();
    assert_eq!(store.meta(), &model.meta());
    assert_eq!(store.base_clusters(), model.base_clusters);
    let max_error_m = store.meta().max_error_m;
    for (stored, node) in store.nodes().iter().zip(&model.nodes) {
        let mut widened = node.clone();
        widened.error_m = stored.error_m;
        widened.bound.radius_m = stored.bound.radius_m;
        assert_eq!(stored, &widened);
        for (wide, narrow) in [
            (f64::from(stored.error_m), f64::from(node.error_m)),
            (stored.bound.radius_m, node.bound.radius_m),
        ] {
            assert!(wide >= narrow + max_error_m && wide < narrow + 1.1 * max_error_m + 1e-6);
        }
    }
    assert_alike(&store.page(BASE_CLUSTERS).unwrap(), &model.base, max_error_m);
    for page in &model.pages {
        assert_alike(&store.page(page.group).unwrap(), page, max_error_m);
    }
    let error = store.page(2500).unwrap_err().to_string();
    assert!(error.contains("no such node"), "{error}");
    assert!(ClusterStore::is_model(&path).unwrap());
}

#[test]
fn in_order_pages_are_the_same_surface_and_small() {
    let before = model(40);
    let mut after = before.clone();
    put_in_order(&after.nodes, &after.base_clusters, &mut after.base, &mut after.pages);
    // every cluster has the triangles that it had, turned and in another order
    let places = |model: &Model| {
        let mut all: Vec<ClusterVertex> = model.base.vertices.clone();
        model.pages.iter().for_each(|p| all.extend_from_slice(&p.vertices));
        all
    };
    let (old, new) = (places(&before), places(&after));
    let clusters = |model: &Model, places: &[ClusterVertex]| -> Vec<Vec<[[u64; 3]; 3]>> {
        let pages = std::iter::once((&model.base, &model.base_clusters));
        let pages = pages.chain(model.pages.iter().zip(model.nodes.iter().map(|n| &n.cluster_triangles)));
        let mut all = Vec::new();
        for (page, lengths) in pages {
            let mut rest = page.triangles.as_slice();
            for &length in lengths {
                let (cluster, later) = rest.split_at(usize::from(length));
                rest = later;
                let bits = |v: u32| places[v as usize].position_m.map(f64::to_bits);
                let mut cluster: Vec<_> = cluster
                    .iter()
                    .map(|t| {
                        let [a, b, c] = t.map(bits);
                        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap()
                    })
                    .collect();
                cluster.sort_unstable();
                all.push(cluster);
            }
        }
        all
    };
    assert_eq!(clusters(&before, &old), clusters(&after, &new));
    for (a, b) in before.pages.iter().zip(&after.pages) {
        let set = |page: &ClusterPage, places: &[ClusterVertex]| {
            let mut set: Vec<_> =
                page.removed.iter().map(|&v| places[v as usize].position_m.map(f64::to_bits)).collect();
            set.sort_unstable();
            set
        };
        assert_eq!(set(a, &old), set(b, &new));
        assert!(b.removed.is_sorted());
    }
    let codec = ClusterCodec::new(&before.meta());
    let bytes = |model: &Model| -> usize {
        let pages = model.pages.iter().zip(&model.nodes);
        pages.map(|(page, node)| codec.encode(page, node.first_vertex).unwrap().len()).sum()
    };
    let (plain, ordered) = (bytes(&before), bytes(&after));
    assert!(ordered <= plain, "{ordered} bytes in order, {plain} before");
}

#[test]
fn what_is_not_whole_is_not_opened() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wave.yama");
    model(3).write(&path).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let open_error = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        let message = ClusterStore::open(&path).unwrap_err().to_string();
        assert!(message.contains("wave.yama") && !message.contains('\n'), "{message}");
        message
    };
    assert!(open_error(&whole[..whole.len() - 100]).contains("cut short"));
    let mut bytes = whole.clone();
    bytes[63] = 9;
    assert!(open_error(&bytes).contains("version 9"));
    bytes[63] = 0;
    assert!(open_error(&bytes).contains("broke off"));
    bytes[63] = 1;
    assert!(open_error(&bytes).contains("expected a model, found a terrain"));
    std::fs::write(&path, &whole).unwrap();
    let error = TerrainStore::open(&path).unwrap_err().to_string();
    assert!(error.contains("expected a terrain, found a model"), "{error}");
}

#[test]
fn any_damage_is_an_error_or_harmless() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wave.yama");
    let model = model(4);
    model.write(&path).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let sound = ClusterStore::open(&path).unwrap();
    let expected = sound.page(2).unwrap();
    let hash = |i: u32, seed: u32| i.wrapping_mul(2_654_435_761).wrapping_add(seed).wrapping_mul(2_246_822_519) >> 8;
    for i in 0..600 {
        let mut bytes = whole.clone();
        for k in 0..1 + i % 3 {
            let at = hash(i * 7 + k, 1) as usize % bytes.len();
            bytes[at] ^= (hash(i * 7 + k, 2) % 255 + 1) as u8;
        }
        std::fs::write(&path, &bytes).unwrap();
        let Ok(store) = ClusterStore::open(&path) else { continue };
        let meta = store.meta();
        if meta.quantum_m != sound.meta().quantum_m || meta.bounds != sound.meta().bounds || !meta.has_colours {
            continue;
        }
        if let Ok(page) = store.page(2) {
            assert_eq!(page, expected, "damage {i} went unseen");
        }
        let _ = store.verify();
    }
}

#[test]
fn an_unfinished_build_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wave.yama");
    std::fs::write(&path, b"the old file").unwrap();
    let model = model(3);
    {
        let mut writer = ClusterWriter::create(&path, model.meta(), &model.nodes, 81, &model.base_clusters).unwrap();
        let bytes = writer.codec().encode(&model.base, 0).unwrap();
        writer.insert(BASE_CLUSTERS, &bytes).unwrap();
        assert!(folder.path().join("wave.yama.part").exists());
        let error = writer.finish().unwrap_err().to_string();
        assert!(error.contains("expected 4, given 1"), "{error}");
    }
    assert!(!folder.path().join("wave.yama.part").exists());
    assert_eq!(std::fs::read(&path).unwrap(), b"the old file");
}

#[test]
fn facts_that_cannot_be_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wave.yama");
    let model = model(1);
    let create = |spoil: &dyn Fn(&mut ClusterMeta)| {
        let mut meta = model.meta();
        spoil(&mut meta);
        ClusterWriter::create(&path, meta, &model.nodes, 81, &model.base_clusters).unwrap_err().to_string()
    };
    assert!(create(&|m| m.quantum_m = 0.0).contains("a quantum of 0 m"));
    assert!(create(&|m| m.quantum_m = f64::NAN).contains("a quantum"));
    assert!(create(&|m| m.quantum_m = 1e-12).contains("a quantum"));
    assert!(create(&|m| m.bounds.max.x = -1.0).contains("a box"));
    let mut far = model.base.clone();
    far.vertices[3].position_m[1] = 1e9;
    assert!(ClusterCodec::new(&model.meta()).encode(&far, 0).unwrap_err().to_string().contains("one at"));
    far.vertices[3].position_m[1] = f64::NAN;
    assert!(Rounding::new(ClusterCodec::new(&model.meta())).round(&mut far).is_err());
    // quanta that suit the box, whatever is asked for
    let bounds = model.meta().bounds;
    for wanted_m in [0.0, 1e-30, 1e-6, 0.01, f64::INFINITY] {
        let meta = ClusterMeta { quantum_m: ClusterMeta::quantum_within_m(&bounds, wanted_m), ..model.meta() };
        assert!(wanted_m < 1e-7 || meta.quantum_m * 1.5 * 3f64.sqrt() <= wanted_m, "{wanted_m}");
        ClusterWriter::create(&path, meta, &model.nodes, 81, &model.base_clusters).unwrap();
    }
}

#[test]
fn vertices_nearer_than_a_quantum_stay_apart_and_what_is_rounded_is_stored_as_it_is() {
    let meta = model(1).meta();
    let codec = ClusterCodec::new(&meta);
    let at =
        |k: u32| vertex(1.0 + f64::from(k % 5) * 0.21 * meta.quantum_m, 2.0 + f64::from(k / 5) * 0.3 * meta.quantum_m);
    let mut page = ClusterPage {
        group: BASE_CLUSTERS,
        // the last one is where the first is, as before
        vertices: (0..20).chain([0]).map(at).collect(),
        removed: Vec::new(),
        triangles: (0..19).map(|k| [k, k + 1, k + 2]).collect(),
    };
    let before = page.clone();
    let mut rounding = Rounding::new(codec);
    rounding.round(&mut page).unwrap();
    let places = |page: &ClusterPage| -> std::collections::HashSet<[u64; 3]> {
        page.vertices.iter().map(|v| v.position_m.map(f64::to_bits)).collect()
    };
    assert_eq!((places(&before).len(), places(&page).len()), (20, 20));
    assert_eq!(page.vertices[0].position_m, page.vertices[20].position_m);
    let moved_m = |i: usize| {
        DVec3::from_array(page.vertices[i].position_m).distance(DVec3::from_array(before.vertices[i].position_m))
    };
    let most_m = (0..21).map(moved_m).fold(0.0, f64::max);
    assert!(most_m == rounding.max_error_m() && most_m <= 1.5 * 3f64.sqrt() * meta.quantum_m, "{most_m}");
    let bytes = codec.encode(&page, 0).unwrap();
    assert_eq!(codec.decode(shape(&page, 0), &bytes).unwrap(), page);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn any_page_comes_back(
        own in 0u32..60, first in 0u32..2000,
        corners in proptest::collection::vec(any::<(u32, u32, u32)>(), 1..150),
        mut removed in proptest::collection::vec(0u32..5000, 0..40),
        seed in any::<u32>(), wild in any::<bool>(),
    ) {
        let own = own.min(3 * corners.len() as u32);
        // near each other, as triangles of a strip, or anywhere
        let id = |v: u32, i: u32| if wild || own == 0 { v % 4000 } else { first + (i / 3 + v % 3) % own };
        let triangles = corners.iter().zip(0u32..).map(|(&(a, b, c), i)| [id(a, i), id(b, i), id(c, i + 1)]).collect();
        let random = |k: u32| f64::from((k ^ seed).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
        let vertices = (0..own).map(|k| vertex(8.0 * random(3 * k), 8.0 * random(3 * k + 1))).collect();
        removed.sort_unstable();
        removed.dedup();
        let page = ClusterPage { group: 5, vertices, removed, triangles };
        let meta = model(1).meta();
        let codec = ClusterCodec::new(&meta);
        let bytes = codec.encode(&page, first).unwrap();
        let back = codec.decode(shape(&page, first), &bytes).unwrap();
        assert_alike(&back, &page, meta.max_error_m);
        // what was read is stored as it is
        prop_assert_eq!(codec.encode(&back, first).unwrap(), bytes);
    }

    #[test]
    fn damaged_pages_are_told(
        at in any::<prop::sample::Index>(), flip in 1u8..=255, cut in any::<bool>(), is_tin in any::<bool>(),
    ) {
        let mut model = model(2);
        let snap = Snap { unit_m: 1.0, per_unit: 1000.0 };
        let tin = is_tin.then(|| TinMeta { crs: Crs::default(), unit_m: 1.0, snap });
        if is_tin {
            // between the steps of the lattice
            model.pages[1].vertices.iter_mut().for_each(|v| v.position_m[0] += 1.23e-5);
        }
        let (page, first) = (&model.pages[1], model.nodes[1].first_vertex);
        let codec = ClusterCodec::new(&ClusterMeta { tin, ..model.meta() });
        let mut bytes = codec.encode(page, first).unwrap();
        let i = at.index(bytes.len());
        if cut {
            bytes.truncate(i);
        } else {
            bytes[i] ^= flip;
        }
        if let Ok(back) = codec.decode(shape(page, first), &bytes) {
            prop_assert!(!cut);
            // what was read can be written, and says the same
            let again = codec.encode(&back, first).unwrap();
            prop_assert_eq!(codec.decode(shape(page, first), &again).unwrap(), back.clone());
            prop_assert_eq!(back.triangles.len(), page.triangles.len());
            prop_assert_eq!(back.vertices.len(), page.vertices.len());
        }
    }

    #[test]
    fn any_bytes_are_safe(
        bytes in proptest::collection::vec(any::<u8>(), 0..300), vertices in 0u32..100, triangles in 0u64..200,
        is_tin in any::<bool>(),
    ) {
        let snap = Snap { unit_m: 1.0, per_unit: 1000.0 };
        let tin = is_tin.then(|| TinMeta { crs: Crs::default(), unit_m: 1.0, snap });
        let codec = ClusterCodec::new(&ClusterMeta { tin, ..model(1).meta() });
        let shape = PageShape { group: 3, first_vertex: 9, vertices, triangles, replaced_triangles: 100 };
        let _ = codec.decode(shape, &bytes);
    }
}

proptest! {
    #[test]
    fn coordinates_of_a_tin_come_back_bit_for_bit(
        xs in proptest::collection::vec(prop_oneof![-1e-3f64..1e-3, -1.4e5f64..1.4e5, (-1_400_000i32..1_400_000).prop_map(|n| f64::from(n) / 1000.0)], 243),
        per_unit in prop_oneof![Just(1.0), Just(100.0), Just(1000.0), Just(1024.0)],
        feet in any::<bool>(),
    ) {
        let model = model(0);
        let unit_m = if feet { 0.3048 } else { 1.0 };
        let snap = Snap { unit_m, per_unit };
        let tin = TinMeta { crs: Crs::default(), unit_m, snap };
        let bounds = Aabb { min: DVec3::splat(-1.4e5), max: DVec3::splat(1.4e5) };
        let codec = ClusterCodec::new(&ClusterMeta { tin: Some(tin), max_error_m: 0.0, bounds, ..model.meta() });
        let mut page = model.base;
        for (vertex, x) in page.vertices.iter_mut().zip(xs.chunks(3)) {
            vertex.position_m = std::array::from_fn(|k| x[k]);
        }
        let bytes = codec.encode(&page, 0).unwrap();
        let back = codec.decode(shape(&page, 0), &bytes).unwrap();
        for (a, b) in back.vertices.iter().zip(&page.vertices) {
            prop_assert_eq!(a.position_m.map(f64::to_bits), b.position_m.map(|x| (x + 0.0).to_bits()));
        }
        for cut in 0..bytes.len() {
            let _ = codec.decode(shape(&page, 0), &bytes[..cut]);
        }
    }
}
