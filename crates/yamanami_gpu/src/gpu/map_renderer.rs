//! Draws deformed maps of resident meshes, off-screen or on any texture view.
//!
//! The vertex shader projects, the depth buffer keeps what is nearest to the centre; see [`crate::software::map`] for the
//! twin and for whose ideas these are.

use super::map_frame::MapFrame;
use super::map_textures::{upload_horizon, upload_pictures};
use super::passes::{Pipeline, buffer, entry, shader_module, storage_group, storage_layout};
use super::renderer::SAMPLES;
use super::textures::{Attachments, PICTURE_FORMAT, Picture};
use super::{Gpu, ResidentMesh};
use crate::frame::check_size;
use crate::map::premultiplied;
use crate::palette::{linear_to_srgb, srgb_to_linear};
use crate::vertex::VERTEX_BYTES;
use crate::{GpuError, HorizonTable, MapOptions, MapTextures};
use image::RgbaImage;
use std::collections::HashMap;
use std::sync::Arc;
use yamanami_core::MapView;

/// Pipelines, textures and uniforms for drawing maps; keep one for as long as there is something to draw.
#[derive(Debug)]
pub struct MapRenderer {
    gpu: Gpu,
    shader: wgpu::ShaderModule,
    wire_shader: Option<wgpu::ShaderModule>,
    layout: wgpu::BindGroupLayout,
    storage: Option<wgpu::BindGroupLayout>,
    pipelines: HashMap<(wgpu::TextureFormat, u32), Pipelines>,
    uniforms: wgpu::Buffer,
    attachments: Option<Attachments>,
    picture: Option<Picture>,
    sources: Option<Sources>,
}

/// The pipelines for one target format and number of samples.
#[derive(Debug)]
struct Pipelines {
    map: wgpu::RenderPipeline,
    wire: Option<wgpu::RenderPipeline>,
}

/// What is uploaded now, and its bindings.
#[derive(Debug)]
struct Sources {
    textures: Arc<MapTextures>,
    pictures: wgpu::TextureView,
    horizon: Option<Arc<HorizonTable>>,
    group: wgpu::BindGroup,
}

impl MapRenderer {
    /// Sets up drawing on this device.
    pub fn new(gpu: &Gpu) -> Self {
        let uniforms = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("yamanami map"),
            size: size_of::<MapFrame>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let image = |view_dimension| wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension,
            multisampled: false,
        };
        let layout = gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("yamanami map"),
            entries: &[
                entry(0, stages, buffer(wgpu::BufferBindingType::Uniform, size_of::<MapFrame>() as u64)),
                entry(1, wgpu::ShaderStages::FRAGMENT, image(wgpu::TextureViewDimension::D2Array)),
                entry(2, wgpu::ShaderStages::FRAGMENT, image(wgpu::TextureViewDimension::D2)),
            ],
        });
        let storage = storage_layout(gpu);
        Self {
            gpu: gpu.clone(),
            shader: shader_module(
                gpu,
                concat!(include_str!("../shaders/colour.wgsl"), include_str!("../shaders/map.wgsl")),
            ),
            wire_shader: storage.is_some().then(|| {
                shader_module(
                    gpu,
                    concat!(
                        include_str!("../shaders/colour.wgsl"),
                        include_str!("../shaders/map.wgsl"),
                        include_str!("../shaders/stored.wgsl"),
                        include_str!("../shaders/map_wire.wgsl")
                    ),
                )
            }),
            layout,
            storage,
            pipelines: HashMap::new(),
            uniforms,
            attachments: None,
            picture: None,
            sources: None,
        }
    }

    /// Draws a map of the mesh as last flushed, alpha straight. The background is transparent unless the options say
    /// otherwise.
    pub fn render_to_image(
        &mut self,
        mesh: &ResidentMesh,
        view: &MapView,
        options: &MapOptions,
    ) -> Result<RgbaImage, GpuError> {
        check_size(view.size_px, self.gpu.device().limits().max_texture_dimension_2d)?;
        let picture = match self.picture.take().filter(|picture| picture.size_px() == view.size_px) {
            Some(picture) => picture,
            None => Picture::new(&self.gpu, view.size_px)?,
        };
        self.draw(&picture.view, PICTURE_FORMAT, mesh, view, options)?;
        let image = picture.read(&self.gpu);
        self.picture = Some(picture);
        image.map(straight)
    }

    /// Draws a map of the mesh as last flushed on a texture view of the map view's size and of this format, and submits
    /// the work. Colours come out times alpha; where the format does not encode sRGB itself, the shaders do.
    pub fn draw(
        &mut self,
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        mesh: &ResidentMesh,
        view: &MapView,
        options: &MapOptions,
    ) -> Result<(), GpuError> {
        check_size(view.size_px, self.gpu.device().limits().max_texture_dimension_2d)?;
        let sources = self.sources(options)?;
        let samples = if options.antialias { SAMPLES } else { 1 };
        let frame = MapFrame::new(mesh.buffers().origin(), view, options, format.is_srgb());
        self.gpu.queue().write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&frame));
        if !self.pipelines.contains_key(&(format, samples)) {
            self.pipelines.insert((format, samples), self.pipelines_for(format, samples));
        }
        let pipelines = &self.pipelines[&(format, samples)];
        let attachments = match self.attachments.take().filter(|old| old.fit(view.size_px, format, samples)) {
            Some(attachments) => attachments,
            None => Attachments::new(&self.gpu, view.size_px, format, samples),
        };
        let mut encoder = self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = attachments.begin(&mut encoder, target, clear_colour(options.background, format));
            pass.set_bind_group(0, &sources.group, &[]);
            let wire = options.wireframe.and(pipelines.wire.as_ref());
            if let Some((wire, storage)) = wire.zip(storage_group(&self.gpu, self.storage.as_ref(), mesh)) {
                pass.set_pipeline(wire);
                pass.set_bind_group(1, &storage, &[]);
                pass.draw(0..mesh.index_count(), 0..1);
            } else {
                pass.set_pipeline(&pipelines.map);
                pass.set_vertex_buffer(0, mesh.vertex_buffer().slice(..));
                pass.set_index_buffer(mesh.index_buffer().slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..mesh.index_count(), 0, 0..1);
            }
        }
        self.gpu.queue().submit([encoder.finish()]);
        self.attachments = Some(attachments);
        self.sources = Some(sources);
        Ok(())
    }

    /// The options' pictures and horizon, uploaded unless they are those already there.
    fn sources(&mut self, options: &MapOptions) -> Result<Sources, GpuError> {
        let horizon = options.veil.as_ref().map(|veil| &veil.horizon);
        let old = self.sources.take();
        let is_same_horizon = |old: &Sources| match (&old.horizon, horizon) {
            (Some(old), Some(new)) => Arc::ptr_eq(old, new),
            (None, None) => true,
            _ => false,
        };
        let pictures = match old {
            Some(old) if Arc::ptr_eq(&old.textures, &options.textures) => {
                if is_same_horizon(&old) {
                    return Ok(old);
                }
                old.pictures
            }
            _ => upload_pictures(&self.gpu, &options.textures)?,
        };
        let level = HorizonTable::new(1, 1.0, vec![0.0])?;
        let table = upload_horizon(&self.gpu, horizon.map_or(&level, |horizon| horizon))?;
        let group = self.gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("yamanami map"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.uniforms.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&pictures) },
                wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&table) },
            ],
        });
        Ok(Sources { textures: Arc::clone(&options.textures), pictures, horizon: horizon.cloned(), group })
    }

    fn pipelines_for(&self, format: wgpu::TextureFormat, samples: u32) -> Pipelines {
        let pipeline = Pipeline { gpu: &self.gpu, format, samples };
        let attributes = wgpu::vertex_attr_array![0 => Float32x3];
        let vertex = wgpu::VertexBufferLayout {
            array_stride: VERTEX_BYTES,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        };
        let wire = self.storage.as_ref().zip(self.wire_shader.as_ref()).map(|(storage, shader)| {
            pipeline.create(shader, "map_wire", &[Some(&self.layout), Some(storage)], &[], true)
        });
        Pipelines { map: pipeline.create(&self.shader, "map", &[Some(&self.layout)], &[Some(vertex)], true), wire }
    }
}

/// The background as a target of this format takes it.
fn clear_colour(background: [u8; 4], format: wgpu::TextureFormat) -> wgpu::Color {
    let [r, g, b, a] = if format.is_srgb() {
        let [r, g, b, a] = background.map(|v| f32::from(v) / 255.0);
        [srgb_to_linear(r) * a, srgb_to_linear(g) * a, srgb_to_linear(b) * a, a]
    } else {
        premultiplied(background)
    };
    let [r, g, b, a] = [r, g, b, a].map(f64::from);
    wgpu::Color { r, g, b, a }
}

/// Takes alpha out of the colours of an sRGB target's picture.
fn straight(mut picture: RgbaImage) -> RgbaImage {
    for pixel in picture.pixels_mut().filter(|pixel| (1..255).contains(&pixel.0[3])) {
        let [r, g, b, a] = pixel.0;
        let colour = |v: u8| linear_to_srgb((srgb_to_linear(f32::from(v) / 255.0) * 255.0 / f32::from(a)).min(1.0));
        let [r, g, b] = [r, g, b].map(|v| (colour(v) * 255.0 + 0.5) as u8);
        pixel.0 = [r, g, b, a];
    }
    picture
}

#[cfg(test)]
mod tests;
