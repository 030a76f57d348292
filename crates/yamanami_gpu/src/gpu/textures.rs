//! Textures: the samples and depth behind a picture, the picture itself, the draped image.

use super::{Gpu, passes::DEPTH_FORMAT};
use crate::{Drape, GpuError};
use image::RgbaImage;

/// Format of off-screen pictures.
pub(super) const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// What is drawn into before it becomes a picture.
#[derive(Debug)]
pub(super) struct Attachments {
    pub(super) size_px: [u32; 2],
    pub(super) format: wgpu::TextureFormat,
    pub(super) samples: u32,
    /// Colour samples, when there is more than one a pixel.
    pub(super) colour: Option<wgpu::TextureView>,
    pub(super) depth: wgpu::TextureView,
}

impl Attachments {
    pub(super) fn new(gpu: &Gpu, size_px: [u32; 2], format: wgpu::TextureFormat, samples: u32) -> Self {
        let view = |format| {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
            texture(gpu, size_px, format, samples, 1, usage).create_view(&wgpu::TextureViewDescriptor::default())
        };
        let colour = (samples > 1).then(|| view(format));
        Self { size_px, format, samples, colour, depth: view(DEPTH_FORMAT) }
    }

    /// Begins a pass that clears the target and resolves into it; depth is reversed.
    pub(super) fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        clear: wgpu::Color,
    ) -> wgpu::RenderPass<'e> {
        let load = wgpu::LoadOp::Clear(clear);
        let (view, resolve_target, store) = match &self.colour {
            Some(samples) => (samples, Some(target), wgpu::StoreOp::Discard),
            None => (target, None, wgpu::StoreOp::Store),
        };
        let ops = wgpu::Operations { load, store };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("yamanami"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops,
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        })
    }

    /// Whether these fit such a target.
    pub(super) fn fit(&self, size_px: [u32; 2], format: wgpu::TextureFormat, samples: u32) -> bool {
        self.size_px == size_px && self.format == format && self.samples == samples
    }
}

/// An off-screen picture that can be read back.
#[derive(Debug)]
pub(super) struct Picture {
    texture: wgpu::Texture,
    pub(super) view: wgpu::TextureView,
    read_back: wgpu::Buffer,
    row_bytes: u32,
}

impl Picture {
    pub(super) fn new(gpu: &Gpu, size_px: [u32; 2]) -> Result<Self, GpuError> {
        let row_bytes = (size_px[0] * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let size = u64::from(row_bytes) * u64::from(size_px[1]);
        let limit = gpu.device().limits().max_buffer_size;
        if size > limit {
            return Err(GpuError::PictureSize { size_px, limit_px: (limit as f64 / 4.0).sqrt() as u32 });
        }
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let texture = texture(gpu, size_px, PICTURE_FORMAT, 1, 1, usage);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let read_back = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("yamanami picture"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Ok(Self { texture, view, read_back, row_bytes })
    }

    pub(super) fn size_px(&self) -> [u32; 2] {
        [self.texture.width(), self.texture.height()]
    }

    pub(super) fn read(&self, gpu: &Gpu) -> Result<RgbaImage, GpuError> {
        let [width, height] = self.size_px();
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            self.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.read_back,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(self.row_bytes),
                    rows_per_image: None,
                },
            },
            self.texture.size(),
        );
        gpu.queue().submit([encoder.finish()]);
        let padded = gpu.read(&self.read_back, self.read_back.size())?;
        let rows = padded.chunks_exact(self.row_bytes as usize);
        let pixels: Vec<u8> = rows.flat_map(|row| &row[..width as usize * 4]).copied().collect();
        // The rows are as many and as long as the image asks, so there always is an image.
        Ok(RgbaImage::from_raw(width, height, pixels).unwrap_or_default())
    }
}

/// Uploads an image with its halvings, leaving out those larger than the device allows.
pub(super) fn upload_drape(gpu: &Gpu, drape: &Drape) -> wgpu::TextureView {
    let limit = gpu.device().limits().max_texture_dimension_2d;
    let fits = |image: &&RgbaImage| image.width().max(image.height()) <= limit;
    let levels: Vec<&RgbaImage> = drape.levels().iter().filter(fits).collect();
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = texture(gpu, levels[0].dimensions().into(), PICTURE_FORMAT, 1, levels.len() as u32, usage);
    for (level, image) in (0u32..).zip(levels) {
        gpu.queue().write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
            image.as_raw(),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(image.width() * 4), rows_per_image: None },
            wgpu::Extent3d { width: image.width(), height: image.height(), depth_or_array_layers: 1 },
        );
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn texture(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    sample_count: u32,
    mip_level_count: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("yamanami"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}
