//! The texture that a picture is drawn on, as large as its place in the window.

use eframe::{egui, egui_wgpu, wgpu};

/// egui shows textures of this format; the shaders encode sRGB themselves.
pub(super) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A texture that egui knows.
#[derive(Debug, Default)]
pub(super) struct Target {
    texture: Option<(wgpu::TextureView, [u32; 2])>,
    id: Option<egui::TextureId>,
}

impl Target {
    /// The picture for egui, once there is one.
    pub(super) fn id(&self) -> Option<egui::TextureId> {
        self.id
    }

    /// The texture to draw on, of this size.
    pub(super) fn fit(&mut self, render: &egui_wgpu::RenderState, size_px: [u32; 2]) -> wgpu::TextureView {
        if let Some((view, _)) = self.texture.as_ref().filter(|(_, size)| *size == size_px) {
            return view.clone();
        }
        let device = &render.device;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("yamanami view"),
            size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut egui = render.renderer.write();
        let filter = wgpu::FilterMode::Linear;
        match self.id {
            Some(id) => egui.update_egui_texture_from_wgpu_texture(device, &view, filter, id),
            None => self.id = Some(egui.register_native_texture(device, &view, filter)),
        }
        self.texture = Some((view.clone(), size_px));
        view
    }
}
