//! What a change costs: sink calls, differential upload and whole upload, over meshes and changes of several sizes.
//! `cargo run --release -p yamanami_gpu --example update_cost`

use glam::DVec3;
use std::error::Error;
use std::time::Instant;
use yamanami_core::{Sink, SurfaceVertex};
use yamanami_gpu::{Gpu, ResidentBuffers, ResidentMesh};

fn vertex(id: u32) -> SurfaceVertex {
    SurfaceVertex {
        position: DVec3::new(f64::from(id % 1000), f64::from(id / 1000), 0.0),
        normal: [0.0, 0.0, 1.0],
        detail_m: 0.5,
        error_m: 1.0,
        bound_radius_m: 10.0,
        level: 3,
        colour: [255; 3],
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let gpu = Gpu::headless()?;
    println!("{}", gpu.description());
    println!("triangles  changed  sink ns/call  flush ms  writes    bytes  upload_all ms      bytes");
    for triangles in [5_000u64, 100_000, 1_000_000] {
        let mut buffers = ResidentBuffers::new(DVec3::ZERO);
        let vertices = triangles as u32 / 2;
        (0..vertices).for_each(|id| buffers.add_vertex(id, vertex(id)));
        let corners = |key: u64| [0, 1, 2].map(|i| ((key / 2 + i) % u64::from(vertices)) as u32);
        (0..triangles).for_each(|key| buffers.add_triangle(key, corners(key)));
        let mut mesh = ResidentMesh::with_buffers(&gpu, buffers);
        mesh.flush()?;
        for changed in [100u64, 1000, 10_000].into_iter().filter(|&n| n * 4 < triangles) {
            let (mut sink_ns, mut flush_ms, mut stats) = (Vec::new(), Vec::new(), Default::default());
            for round in 0..21u64 {
                let key_of = |i: u64| (i * 7_919 + round * 104_729) % triangles;
                let start = Instant::now();
                for i in 0..changed {
                    mesh.remove_triangle(key_of(i));
                }
                for i in 0..changed {
                    mesh.add_triangle(key_of(i), corners(key_of(i) + 1));
                }
                sink_ns.push(start.elapsed().as_secs_f64() * 1e9 / (2 * changed) as f64);
                let start = Instant::now();
                stats = mesh.flush()?;
                flush_ms.push(start.elapsed().as_secs_f64() * 1e3);
            }
            let start = Instant::now();
            let whole = mesh.upload_all()?;
            let whole_ms = start.elapsed().as_secs_f64() * 1e3;
            println!(
                "{triangles:9} {changed:8} {:13.0} {:9.3} {:7} {:8} {whole_ms:14.2} {:10}",
                median(sink_ns),
                median(flush_ms),
                stats.writes,
                stats.total_bytes(),
                whole.total_bytes()
            );
        }
    }
    Ok(())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
