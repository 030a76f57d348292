//! The resident mesh equals the reference mirror after any changes, and uploads little for little.

mod common;

use common::Walk;
use glam::DVec3;
use proptest::prelude::*;
use yamanami_core::{MeshMirror, Sink};
use yamanami_gpu::{MeshContents, ResidentBuffers, TRIANGLE_BYTES, VERTEX_BYTES};

const ORIGIN: DVec3 = DVec3::new(10.0, -20.0, 5.0);

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn buffers_equal_the_mirror_and_stay_packed(
        batches in proptest::collection::vec(proptest::collection::vec(0u32..4000, 1..60), 1..8), gap_bytes in 0u64..300
    ) {
        let (mut buffers, mut mirror) = (ResidentBuffers::new(ORIGIN), MeshMirror::default());
        let (mut walk, mut twin) = (Walk::default(), Walk::default());
        // A copy that only ever sees the dirty ranges, as the GPU does.
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for batch in batches {
            for code in batch {
                walk.step(code, &mut buffers);
                twin.step(code, &mut mirror);
            }
            prop_assert_eq!(buffers.contents(), MeshContents::of_mirror(&mirror, ORIGIN));
            let dirty = buffers.take_dirty(gap_bytes);
            vertices.resize(buffers.vertices().len(), Default::default());
            triangles.resize(buffers.triangles().len(), [u32::MAX; 3]);
            for range in &dirty.vertices {
                let range = range.start as usize..range.end as usize;
                vertices[range.clone()].copy_from_slice(&buffers.vertices()[range]);
            }
            for range in &dirty.triangles {
                let range = range.start as usize..range.end as usize;
                triangles[range.clone()].copy_from_slice(&buffers.triangles()[range]);
            }
            prop_assert_eq!(buffers.triangles().len(), mirror.triangles.len(), "no hole is left");
            prop_assert_eq!(&triangles[..], buffers.triangles());
            prop_assert_eq!(&vertices[..], buffers.vertices());
        }
    }
}

#[test]
fn a_small_change_of_a_large_mesh_is_a_small_upload() {
    let mut buffers = ResidentBuffers::from_mesh(&common::hills(200, 1000.0));
    let whole = buffers.take_dirty(0);
    assert_eq!(whole.vertex_bytes(), 201 * 201 * VERTEX_BYTES);
    assert_eq!(whole.index_bytes(), 80_000 * TRIANGLE_BYTES);
    for i in 0..50u32 {
        let key = u64::from(i) * 1301;
        buffers.remove_triangle(key);
        let id = 1_000_000 + i;
        buffers.add_vertex(id, common::vertex(id, 0));
        buffers.add_triangle(key, [i, i + 1, id]);
        buffers.add_triangle(key + 1_000_000_000, [i, id, i + 2]);
    }
    let change = buffers.take_dirty(0);
    assert_eq!(change.vertex_bytes(), 50 * VERTEX_BYTES);
    assert_eq!(change.index_bytes(), 100 * TRIANGLE_BYTES, "replaced in place, added at the end");
    let nothing = buffers.take_dirty(0);
    assert_eq!(nothing.vertex_bytes() + nothing.index_bytes(), 0);
}

#[test]
fn a_change_and_its_inverse_upload_nothing_new_but_the_same_mesh() {
    let mut buffers = ResidentBuffers::from_mesh(&common::hills(20, 1000.0));
    buffers.take_dirty(0);
    let before = buffers.contents();
    buffers.remove_triangle(7);
    buffers.remove_triangle(790);
    buffers.add_triangle(790, before.triangles[&790]);
    buffers.add_triangle(7, before.triangles[&7]);
    assert_eq!(buffers.contents(), before);
    assert!(buffers.take_dirty(0).index_bytes() <= 2 * TRIANGLE_BYTES);
}

#[test]
fn a_cleared_mesh_is_empty_and_usable() {
    let mut buffers = ResidentBuffers::from_mesh(&common::hills(4, 100.0));
    buffers.clear();
    assert_eq!(buffers.contents(), MeshContents::default());
    assert_eq!(buffers.take_dirty(0), Default::default());
    buffers.add_vertex(5, common::vertex(5, 1));
    assert_eq!(buffers.take_dirty(0).vertex_bytes(), VERTEX_BYTES);
}
