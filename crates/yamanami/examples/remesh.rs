//! Remeshes a mesh file and prints how well it went: size, distances over the diagonal, shape of the triangles, time.
//!
//! `cargo run --release -p yamanami --example remesh -- MESH [BASE_FACES|- [LEVELS|- [OUTPUT]]]`

use std::time::Instant;
use yamanami::io::mesh_file::{MeshMeta, read_mesh, write_mesh};
use yamanami::measure::surface_distance;
use yamanami::multires::clean::{CleanOptions, clean};
use yamanami::multires::remesh::{RemeshOptions, remesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let name = args.next().ok_or("which mesh?")?;
    let mut number = || args.next().filter(|n| n != "-").map(|n| n.parse::<usize>()).transpose();
    let (base_faces, levels) = (number()?, number()?.map(|l| l as u32));
    let mut mesh = read_mesh(&name)?;
    clean(&mut mesh, &CleanOptions { weld_across_seams: true, orient: true, ..CleanOptions::safe() });
    let start = Instant::now();
    let remeshed = remesh(&mesh, &RemeshOptions { base_faces, levels, ..RemeshOptions::default() })?;
    let seconds = start.elapsed().as_secs_f64();
    let report = &remeshed.report;
    let result = remeshed.mesh();
    println!(
        "{name}: {} faces, {:?} -> base {} x 4^{} = {} faces, {:?}, parametric to level {}, {seconds:.2} s",
        report.source_faces,
        report.source_kind,
        report.base_faces,
        report.levels,
        result.triangles.len(),
        report.result_kind,
        report.parametric_level
    );
    let share = 1.0 / report.diagonal_m;
    println!(
        "rms {:.3e} (source to result {:.3e}, back {:.3e}), greatest {:.3e} of the diagonal",
        report.rms_m() * share,
        report.source_to_result_rms_m * share,
        report.result_to_source_rms_m * share,
        report.greatest_m * share
    );
    let distance = surface_distance(&mesh, &result, 200_000, 1);
    println!(
        "by samples: rms {:.3e} ({:.1} dB), hausdorff {:.3e}",
        distance.rms_m * share,
        -20.0 * (distance.rms_m * share).log10(),
        distance.hausdorff_m * share
    );
    let mut shapes: Vec<f64> = (0..result.triangles.len())
        .map(|t| {
            let [a, b, c] = result.corners(t);
            let sides = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
            2.0 * 3f64.sqrt() * (b - a).cross(c - a).length() / sides
        })
        .collect();
    let mut areas: Vec<f64> = (0..result.triangles.len())
        .map(|t| {
            let [a, b, c] = result.corners(t);
            (b - a).cross(c - a).length()
        })
        .collect();
    shapes.sort_by(f64::total_cmp);
    areas.sort_by(f64::total_cmp);
    let at = |sorted: &[f64], share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
    println!(
        "normal {:.1} %, folded {}; shape 1 % {:.3}, 10 % {:.3}, median {:.3}; areas 99 % / 1 % {:.1}, 90 % / 10 % {:.1}",
        100.0 * report.normal_share,
        report.folded_faces,
        at(&shapes, 0.01),
        at(&shapes, 0.1),
        at(&shapes, 0.5),
        at(&areas, 0.99) / at(&areas, 0.01),
        at(&areas, 0.9) / at(&areas, 0.1)
    );
    if let Some(output) = args.next() {
        write_mesh(&output, &result, &MeshMeta::default())?;
    }
    Ok(())
}
