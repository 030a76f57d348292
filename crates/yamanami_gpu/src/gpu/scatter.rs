//! Many small changes of a buffer in one write: they travel as a list, and a compute pass puts each in its place.

use super::Gpu;

/// Most words gathered before they must be sent off.
const STAGED_WORDS: usize = 1 << 18;
/// Words before the first change: the number of changes and the words of a slot.
const HEADER_WORDS: usize = 2;
/// Changes that one workgroup of the shader handles.
const WORKGROUP: u32 = 64;

/// Gathers changed slots of a buffer and sends them.
#[derive(Debug)]
pub(super) struct Scatter {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    staging: wgpu::Buffer,
    staged: Vec<u32>,
}

impl Scatter {
    /// `None` where the device has no compute shaders.
    pub(super) fn new(gpu: &Gpu) -> Option<Self> {
        let limits = gpu.device().limits();
        if limits.max_compute_workgroup_size_x < WORKGROUP || !gpu.reads_buffers() {
            return None;
        }
        let entry = |binding, read_only| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let layout = gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("yamanami scatter"),
            entries: &[entry(0, true), entry(1, false)],
        });
        let module = gpu.device().create_shader_module(wgpu::include_wgsl!("../shaders/scatter.wgsl"));
        let pipeline_layout = gpu.device().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("yamanami scatter"),
            bind_group_layouts: &[Some(&layout)],
            ..wgpu::PipelineLayoutDescriptor::default()
        });
        let pipeline = gpu.device().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("yamanami scatter"),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("scatter"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let staging = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("yamanami changes"),
            size: (STAGED_WORDS * size_of::<u32>()) as u64,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        Some(Self { pipeline, layout, staging, staged: Vec::new() })
    }

    /// Whether the shader can reach all of a buffer.
    pub(super) fn reaches(&self, gpu: &Gpu, buffer: &wgpu::Buffer) -> bool {
        buffer.size() <= gpu.device().limits().max_storage_buffer_binding_size
    }

    /// Gathers a slot's new words; false when it must be sent first. All slots gathered together are of one size.
    pub(super) fn stage(&mut self, slot: u32, words: &[u32]) -> bool {
        if self.staged.is_empty() {
            self.staged.extend([0, words.len() as u32]);
        }
        if self.staged.len() + 1 + words.len() > STAGED_WORDS {
            return false;
        }
        self.staged.push(slot);
        self.staged.extend_from_slice(words);
        self.staged[0] += 1;
        true
    }

    /// Sends what was gathered to its places in `buffer`. Returns the bytes written, 0 when there was nothing.
    pub(super) fn send(&mut self, gpu: &Gpu, buffer: &wgpu::Buffer) -> u64 {
        if self.staged.len() <= HEADER_WORDS {
            return 0;
        }
        let changes = self.staged[0];
        let bytes = bytemuck::cast_slice(&self.staged);
        gpu.queue().write_buffer(&self.staging, 0, bytes);
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("yamanami scatter"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.staging.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: buffer.as_entire_binding() },
            ],
        });
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(changes.div_ceil(WORKGROUP), 1, 1);
        }
        gpu.queue().submit([encoder.finish()]);
        let written = bytes.len() as u64;
        self.staged.clear();
        written
    }
}
