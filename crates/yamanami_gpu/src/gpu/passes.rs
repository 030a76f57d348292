//! Shader module, bind group layouts and the three pipelines: sky, surface, surface with edges.

use super::{Gpu, ResidentMesh};
use crate::frame::Frame;
use crate::vertex::VERTEX_BYTES;

/// Depth format; depth is reversed, so that floats are finest far away where they are needed.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What all pipelines share.
#[derive(Debug)]
pub(super) struct Layouts {
    shader: wgpu::ShaderModule,
    wire_shader: Option<wgpu::ShaderModule>,
    /// Uniform block, image, sampler.
    pub(super) frame: wgpu::BindGroupLayout,
    /// Vertex and index buffer as the wireframe reads them.
    pub(super) storage: Option<wgpu::BindGroupLayout>,
}

/// The pipelines for one target format and number of samples.
#[derive(Debug)]
pub(super) struct Passes {
    pub(super) sky: wgpu::RenderPipeline,
    pub(super) surface: wgpu::RenderPipeline,
    pub(super) wire: Option<wgpu::RenderPipeline>,
}

impl Layouts {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let device = gpu.device();
        let module = |source| shader_module(gpu, source);
        let image = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let frame = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("yamanami frame"),
            entries: &[
                entry(0, stages, buffer(wgpu::BufferBindingType::Uniform, size_of::<Frame>() as u64)),
                entry(1, wgpu::ShaderStages::FRAGMENT, image),
                entry(2, wgpu::ShaderStages::FRAGMENT, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ],
        });
        let storage = storage_layout(gpu);
        Self {
            shader: module(concat!(
                include_str!("../shaders/colour.wgsl"),
                include_str!("../shaders/frame.wgsl"),
                include_str!("../shaders/sky.wgsl"),
                include_str!("../shaders/terrain.wgsl")
            )),
            wire_shader: storage.is_some().then(|| {
                module(concat!(
                    include_str!("../shaders/colour.wgsl"),
                    include_str!("../shaders/frame.wgsl"),
                    include_str!("../shaders/terrain.wgsl"),
                    include_str!("../shaders/stored.wgsl"),
                    include_str!("../shaders/wire.wgsl")
                ))
            }),
            frame,
            storage,
        }
    }

    pub(super) fn passes(&self, gpu: &Gpu, format: wgpu::TextureFormat, samples: u32) -> Passes {
        let pipeline = Pipeline { gpu, format, samples };
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32x2];
        let vertex = wgpu::VertexBufferLayout {
            array_stride: VERTEX_BYTES,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        };
        let groups = [Some(&self.frame)];
        Passes {
            sky: pipeline.create(&self.shader, "sky", &groups, &[], false),
            surface: pipeline.create(&self.shader, "terrain", &groups, &[Some(vertex)], true),
            wire: self.storage.as_ref().zip(self.wire_shader.as_ref()).map(|(storage, shader)| {
                pipeline.create(shader, "wire", &[Some(&self.frame), Some(storage)], &[], true)
            }),
        }
    }
}

/// A shader module from WGSL.
pub(super) fn shader_module(gpu: &Gpu, source: &'static str) -> wgpu::ShaderModule {
    gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("yamanami"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

/// The mesh's buffers as `shaders/stored.wgsl` reads them; `None` where the device cannot.
pub(super) fn storage_layout(gpu: &Gpu) -> Option<wgpu::BindGroupLayout> {
    let read = wgpu::BufferBindingType::Storage { read_only: true };
    gpu.reads_buffers().then(|| {
        gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("yamanami storage"),
            entries: &[
                entry(0, wgpu::ShaderStages::VERTEX, buffer(read, VERTEX_BYTES)),
                entry(1, wgpu::ShaderStages::VERTEX, buffer(read, 4)),
            ],
        })
    })
}

/// The mesh's buffers for [`storage_layout`]; `None` where the device cannot read them so, and no edges are drawn.
pub(super) fn storage_group(
    gpu: &Gpu,
    layout: Option<&wgpu::BindGroupLayout>,
    mesh: &ResidentMesh,
) -> Option<wgpu::BindGroup> {
    let limit = gpu.device().limits().max_storage_buffer_binding_size;
    let buffers = [mesh.vertex_buffer(), mesh.index_buffer()];
    if buffers.iter().any(|buffer| buffer.size() > limit) {
        return None;
    }
    Some(gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("yamanami storage"),
        layout: layout?,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: buffers[0].as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: buffers[1].as_entire_binding() },
        ],
    }))
}

/// An entry of a layout.
pub(super) fn entry(binding: u32, visibility: wgpu::ShaderStages, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

/// A whole buffer of at least so many bytes.
pub(super) fn buffer(ty: wgpu::BufferBindingType, min_size: u64) -> wgpu::BindingType {
    let min_binding_size = std::num::NonZeroU64::new(min_size);
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size }
}

/// What the pipelines of one target have in common.
pub(super) struct Pipeline<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) format: wgpu::TextureFormat,
    pub(super) samples: u32,
}

impl Pipeline<'_> {
    /// A pipeline from the entry points `<name>_vertex` and `<name>_fragment`.
    pub(super) fn create(
        &self,
        module: &wgpu::ShaderModule,
        name: &str,
        groups: &[Option<&wgpu::BindGroupLayout>],
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        writes_depth: bool,
    ) -> wgpu::RenderPipeline {
        let device = self.gpu.device();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: groups,
            ..wgpu::PipelineLayoutDescriptor::default()
        });
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(&format!("{name}_vertex")),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers,
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(writes_depth),
                depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState { count: self.samples, ..wgpu::MultisampleState::default() },
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(&format!("{name}_fragment")),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(self.format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
