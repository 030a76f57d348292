//! The pictures of the ground and the horizon of a map, as textures.

use super::Gpu;
use crate::{GpuError, HorizonTable, MapTexture, MapTextures};

/// Uploads pictures of the ground, one a layer; those of fewer samples fill their layer's corner.
pub(super) fn upload_pictures(gpu: &Gpu, textures: &MapTextures) -> Result<wgpu::TextureView, GpuError> {
    let levels = textures.levels();
    let side_px = levels.iter().map(|level| level.side_px).max().unwrap_or(1);
    check_side(gpu, "map texture", side_px)?;
    // of one layer it would be no array where drivers guess a view's kind from it
    let size = [side_px, side_px, levels.len().max(2) as u32];
    let texture = texture(gpu, size, wgpu::TextureFormat::Rgba8Unorm);
    for (layer, MapTexture { side_px, rgba, .. }) in (0u32..).zip(levels) {
        write(gpu, &texture, layer, [*side_px, *side_px], rgba);
    }
    Ok(texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..wgpu::TextureViewDescriptor::default()
    }))
}

/// Uploads a horizon: a row an azimuth.
pub(super) fn upload_horizon(gpu: &Gpu, horizon: &HorizonTable) -> Result<wgpu::TextureView, GpuError> {
    let size = [horizon.distance_count(), horizon.azimuth_count()];
    check_side(gpu, "horizon table", size[0].max(size[1]))?;
    let texture = texture(gpu, [size[0], size[1], 1], wgpu::TextureFormat::R32Float);
    write(gpu, &texture, 0, size, bytemuck::cast_slice(horizon.half_tangents()));
    Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
}

fn check_side(gpu: &Gpu, what: &'static str, side_px: u32) -> Result<(), GpuError> {
    let limit_px = gpu.device().limits().max_texture_dimension_2d;
    if side_px <= limit_px { Ok(()) } else { Err(GpuError::TextureTooLarge { what, side_px, limit_px }) }
}

fn texture(gpu: &Gpu, [width, height, layers]: [u32; 3], format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("yamanami map"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// Writes samples of four bytes.
fn write(gpu: &Gpu, texture: &wgpu::Texture, layer: u32, [width, height]: [u32; 2], bytes: &[u8]) {
    gpu.queue().write_texture(
        wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x: 0, y: 0, z: layer }, ..texture.as_image_copy() },
        bytes,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 4), rows_per_image: None },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}
