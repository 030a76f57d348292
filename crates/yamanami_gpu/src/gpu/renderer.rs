//! Draws resident meshes, off-screen or on any texture view.

use super::passes::{Layouts, Passes, storage_group};
use super::textures::{Attachments, PICTURE_FORMAT, Picture, upload_drape};
use super::{Gpu, ResidentMesh};
use crate::frame::{Frame, check_size};
use crate::{Drape, GpuError, RenderOptions};
use image::{Rgba, RgbaImage};
use std::collections::HashMap;
use std::sync::Arc;
use yamanami_core::View;

/// Samples a pixel when a picture is antialiased.
pub(super) const SAMPLES: u32 = 4;

/// Pipelines, textures and uniforms for drawing; keep one for as long as there is something to draw.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    layouts: Layouts,
    passes: HashMap<(wgpu::TextureFormat, u32), Passes>,
    uniforms: wgpu::Buffer,
    sampler: wgpu::Sampler,
    attachments: Option<Attachments>,
    picture: Option<Picture>,
    /// The image now laid over the surface, and the bindings with it.
    drape: Arc<Drape>,
    frame_group: wgpu::BindGroup,
}

impl Renderer {
    /// Sets up drawing on this device.
    pub fn new(gpu: &Gpu) -> Self {
        let layouts = Layouts::new(gpu);
        let uniforms = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("yamanami frame"),
            size: size_of::<Frame>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let sampler = gpu.device().create_sampler(&wgpu::SamplerDescriptor {
            label: Some("yamanami drape"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: 8,
            ..wgpu::SamplerDescriptor::default()
        });
        let drape = Arc::new(Drape::over_box(RgbaImage::from_pixel(1, 1, Rgba([0; 4])), [0.0; 2], [1.0; 2]));
        let frame_group = frame_group(gpu, &layouts, &uniforms, &sampler, &drape);
        Self {
            gpu: gpu.clone(),
            layouts,
            passes: HashMap::new(),
            uniforms,
            sampler,
            attachments: None,
            picture: None,
            drape,
            frame_group,
        }
    }

    /// Draws the mesh as last flushed into a picture of the view's size.
    pub fn render_to_image(
        &mut self,
        mesh: &ResidentMesh,
        view: &View,
        options: &RenderOptions,
    ) -> Result<RgbaImage, GpuError> {
        check_size(view.viewport_px, self.gpu.device().limits().max_texture_dimension_2d)?;
        let picture = match self.picture.take().filter(|picture| picture.size_px() == view.viewport_px) {
            Some(picture) => picture,
            None => Picture::new(&self.gpu, view.viewport_px)?,
        };
        self.draw(&picture.view, PICTURE_FORMAT, mesh, view, options)?;
        let image = picture.read(&self.gpu);
        self.picture = Some(picture);
        image
    }

    /// Draws the mesh as last flushed on a texture view of the view's size and of this format, and submits the work.
    /// Where the format does not encode sRGB itself, the shaders do.
    pub fn draw(
        &mut self,
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        mesh: &ResidentMesh,
        view: &View,
        options: &RenderOptions,
    ) -> Result<(), GpuError> {
        let device = self.gpu.device();
        check_size(view.viewport_px, device.limits().max_texture_dimension_2d)?;
        let samples = if options.antialias { SAMPLES } else { 1 };
        let mut frame = Frame::new(mesh.buffers().origin(), mesh.buffers().bounds(), view, options);
        frame.encode_srgb = u32::from(!format.is_srgb());
        self.gpu.queue().write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&frame));
        self.use_drape(options);
        let passes =
            self.passes.entry((format, samples)).or_insert_with(|| self.layouts.passes(&self.gpu, format, samples));
        let attachments = match self.attachments.take().filter(|old| old.fit(view.viewport_px, format, samples)) {
            Some(attachments) => attachments,
            None => Attachments::new(&self.gpu, view.viewport_px, format, samples),
        };
        let mut encoder = self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = attachments.begin(&mut encoder, target, wgpu::Color::BLACK);
            pass.set_bind_group(0, &self.frame_group, &[]);
            let wire = options.wireframe.and(passes.wire.as_ref());
            if let Some((wire, storage)) = wire.zip(storage_group(&self.gpu, self.layouts.storage.as_ref(), mesh)) {
                pass.set_pipeline(wire);
                pass.set_bind_group(1, &storage, &[]);
                pass.draw(0..mesh.index_count(), 0..1);
            } else {
                pass.set_pipeline(&passes.surface);
                pass.set_vertex_buffer(0, mesh.vertex_buffer().slice(..));
                pass.set_index_buffer(mesh.index_buffer().slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..mesh.index_count(), 0, 0..1);
            }
            pass.set_pipeline(&passes.sky);
            pass.draw(0..3, 0..1);
        }
        self.gpu.queue().submit([encoder.finish()]);
        self.attachments = Some(attachments);
        Ok(())
    }

    /// Uploads the options' image unless it is the one already there.
    fn use_drape(&mut self, options: &RenderOptions) {
        if let Some(drape) = options.drape.as_ref().filter(|drape| !Arc::ptr_eq(drape, &self.drape)) {
            self.frame_group = frame_group(&self.gpu, &self.layouts, &self.uniforms, &self.sampler, drape);
            self.drape = Arc::clone(drape);
        }
    }
}

fn frame_group(
    gpu: &Gpu,
    layouts: &Layouts,
    uniforms: &wgpu::Buffer,
    sampler: &wgpu::Sampler,
    drape: &Drape,
) -> wgpu::BindGroup {
    let image = upload_drape(gpu, drape);
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("yamanami frame"),
        layout: &layouts.frame,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&image) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(sampler) },
        ],
    })
}
