//! One page of a scan's or TIN's database from any bytes: an error or a page of the right shape, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use yamanami_core::{Aabb, Crs, Snap};
use yamanami_io::store::{ClusterCodec, ClusterMeta, PageShape, TinMeta};

fuzz_target!(|data: &[u8]| {
    let [vertices, triangles, flags, bytes @ ..] = data else { return };
    let is_tin = flags & 2 == 2;
    let snap = Snap { unit_m: 1.0, per_unit: 1000.0 };
    let meta = ClusterMeta {
        title: String::new(),
        source: String::new(),
        source_faces: 1,
        source_vertices: 3,
        bounds: Aabb { min: [0.0; 3].into(), max: [1.0; 3].into() },
        quantum_m: 0.001,
        max_error_m: 0.001,
        has_colours: flags & 1 == 1,
        nodes: 1,
        triangles: 1,
        vertices: 3,
        tin: is_tin.then(|| TinMeta { crs: Crs::default(), unit_m: 1.0, snap }),
    };
    let codec = ClusterCodec::new(&meta);
    let shape = PageShape {
        group: 0,
        first_vertex: u32::from(flags >> 2),
        vertices: u32::from(*vertices),
        triangles: u64::from(*triangles),
        replaced_triangles: 64,
    };
    if let Ok(page) = codec.decode(shape, bytes) {
        assert_eq!((page.vertices.len(), page.triangles.len()), (usize::from(*vertices), usize::from(*triangles)));
        // what was read can be written, and says the same
        let again = codec.encode(&page, shape.first_vertex).expect("a page that was read can be written");
        assert_eq!(codec.decode(shape, &again).expect("and read again"), page);
    }
});
