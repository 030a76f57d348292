//! Real scans, remeshed, coded and read again, where the shared data are at hand.

use std::path::Path;
use yamanami::io::mesh_file::read_mesh;
use yamanami::io::progressive::ProgressiveLimits;
use yamanami::measure::surface_distance;
use yamanami::multires::clean::{CleanOptions, clean};
use yamanami::multires::remesh::RemeshOptions;
use yamanami::{ProgressiveOptions, SemiRegularModel, decode_progressive, encode_progressive};
use yamanami_core::TriangleMesh;

#[test]
fn a_bust_with_a_border_goes_to_bytes_and_back() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/mesh/demosthenes_bust_16719f.obj");
    if !file.exists() {
        return;
    }
    let mut scan = read_mesh(&file).unwrap();
    clean(&mut scan, &CleanOptions { weld_across_seams: true, orient: true, ..CleanOptions::safe() });
    let diagonal_m = scan.bounds().diagonal();
    let (model, report) = SemiRegularModel::remeshed(&scan, "bust".to_owned(), &RemeshOptions::default()).unwrap();
    assert_eq!(report.source_kind, report.result_kind, "parts, borders and handles");
    assert!(report.rms_m() < 1e-3 * diagonal_m, "{report:?}");
    // its levels are found again in the plain mesh
    let again = SemiRegularModel::recognised(&model.to_mesh(), "bust".to_owned()).unwrap().unwrap();
    assert!(again.mesh.levels() >= model.mesh.levels());

    let file = encode_progressive(&model.mesh, &model.positions, &ProgressiveOptions::default()).unwrap();
    let mut last = f64::INFINITY;
    for share in [16, 4, 1] {
        let bytes = &file.bytes[..file.bytes.len() / share];
        let read = decode_progressive(Path::new("bust"), bytes, ProgressiveLimits::default()).unwrap();
        let mesh = TriangleMesh::new(read.positions_m, read.mesh.triangles(read.mesh.levels()));
        let rms_m = surface_distance(&scan, &mesh, 20_000, 1).rms_m;
        assert!(rms_m < last * 1.02, "1/{share}: {rms_m} after {last}");
        last = rms_m;
    }
    assert!(last < report.rms_m() + file.max_error_m, "{last} {report:?}");
}
