//! The shader's projection against the core's, in f64.

use super::*;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use yamanami_core::{Curvature, DeformedMap, DropFrom};

const POINTS: usize = 500;

/// A small generator.
struct Numbers(u64);

impl Numbers {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// Clip coordinates of points relative to `origin`, by the shader.
fn placed(gpu: &Gpu, pipeline: &wgpu::ComputePipeline, frame: &MapFrame, points: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let bytes = size_of_val(points) as u64;
    let make = |size, usage| {
        gpu.device().create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let uniforms = make(size_of::<MapFrame>() as u64, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST);
    let input = make(bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
    let output = make(bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let copy = make(bytes, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    gpu.queue().write_buffer(&uniforms, 0, bytemuck::bytes_of(frame));
    gpu.queue().write_buffer(&input, 0, bytemuck::cast_slice(points));
    let group = |index, buffers: &[&wgpu::Buffer]| {
        let entries: Vec<_> = (0u32..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let layout = pipeline.get_bind_group_layout(index);
        gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries })
    };
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group(0, &[&uniforms]), &[]);
        pass.set_bind_group(1, &group(1, &[&input, &output]), &[]);
        pass.dispatch_workgroups((points.len() as u32).div_ceil(64), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &copy, 0, bytes);
    gpu.queue().submit([encoder.finish()]);
    bytemuck::pod_collect_to_vec(&gpu.read(&copy, bytes).unwrap())
}

/// 20,000 points in 40 maps: within 1e-4 of the picture's radius, and far within.
#[test]
fn the_shader_projects_like_the_core() {
    let Ok(gpu) = Gpu::headless() else {
        println!("skipped: no adapter");
        return;
    };
    if gpu.device().limits().max_compute_workgroup_size_x < 64 {
        println!("skipped: no compute shaders");
        return;
    }
    let module = shader_module(
        &gpu,
        concat!(
            include_str!("../../shaders/colour.wgsl"),
            include_str!("../../shaders/map.wgsl"),
            include_str!("../../shaders/map_points.wgsl")
        ),
    );
    let pipeline = gpu.device().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("map_points"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let mut n = Numbers(3);
    let mut farthest = 0f64;
    for _ in 0..40 {
        let map = DeformedMap {
            centre: DVec2::new(n.between(-20e3, 20e3), n.between(-20e3, 20e3)),
            ring_m: n.between(1e3, 30e3),
            eye_m: n.between(4.5e3, 12e3),
            alpha: n.between(0.0, 1.0).powi(3),
            alpha_fall: if n.between(0.0, 1.0) < 0.5 { 0.0 } else { n.between(0.0, 3.0) },
            scale: n.between(0.3, 2.5),
            exaggeration: n.between(0.5, 1.1),
            curvature: match n.between(0.0, 3.0) as u32 {
                0 => None,
                1 => Some(Curvature { refraction: 0.13, from: DropFrom::Ring }),
                _ => Some(Curvature { refraction: -0.1, from: DropFrom::Centre }),
            },
        };
        let view = MapView {
            up_azimuth_rad: n.between(0.0, TAU),
            ..MapView::fitted(map, [n.between(100.0, 4000.0) as u32, 1300], 300e3, 3000.0, 5.0)
        };
        let origin = DVec3::new(n.between(-1e5, 1e5), n.between(-1e5, 1e5), n.between(-500.0, 2000.0));
        let points: Vec<DVec3> = (0..POINTS)
            .map(|_| {
                let r_m = 300e3 * n.between(0.0, 1.0).powi(3);
                (map.centre + DVec2::from_angle(n.between(0.0, TAU)) * r_m).extend(n.between(-100.0, 4000.0))
            })
            .collect();
        let local: Vec<[f32; 4]> = points.iter().map(|&p| (p - origin).as_vec3().extend(0.0).to_array()).collect();
        let frame = MapFrame::new(origin, &view, &MapOptions::default(), true);
        let reach = map.rho(300e3, 4000.0);
        for (p, [x, y, nearness, w]) in points.iter().zip(placed(&gpu, &pipeline, &frame, &local)) {
            let px =
                (DVec2::new(f64::from(x), f64::from(-y)) + 1.0) * 0.5 * DVec2::from_array(view.size_px.map(f64::from));
            let off = (px - view.px_from_plane(*p)).length() / view.ring_px / reach;
            assert!(off < 1e-4, "{off} of the picture's radius at {p} in {map:?}");
            farthest = farthest.max(off);
            assert!((f64::from(nearness) - (1.0 - 0.5 * view.depth_key(*p))).abs() < 1e-6 && w == 1.0);
        }
    }
    println!("farthest off: {farthest:.1e} of the picture's radius");
    assert!(farthest < 1e-5, "{farthest}");
}
