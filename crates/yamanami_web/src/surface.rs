//! A canvas of the page as something to draw on: by WebGPU where the browser has it, else by WebGL2.

use web_sys::HtmlCanvasElement;
use yamanami::gpu::Gpu;
use yamanami::gpu::wgpu;

/// A canvas with its graphics device.
#[derive(Debug)]
pub(crate) struct CanvasSurface {
    pub(crate) gpu: Gpu,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    name: String,
}

/// Which interfaces may be tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Backend {
    Auto,
    WebGpu,
    WebGl2,
}

impl Backend {
    pub(crate) fn parse(name: &str) -> Result<Self, String> {
        match name {
            "auto" => Ok(Self::Auto),
            "webgpu" => Ok(Self::WebGpu),
            "webgl2" => Ok(Self::WebGl2),
            other => Err(format!("backend: expected auto, webgpu or webgl2, got {other}")),
        }
    }
}

impl CanvasSurface {
    /// Finds a device that can draw on the canvas; what is missing in one line.
    pub(crate) async fn new(canvas: HtmlCanvasElement, backend: Backend) -> Result<Self, String> {
        // a canvas that has given a context of one kind gives none of another: WebGPU is asked for without it first
        if backend != Backend::WebGl2 {
            match Self::with(canvas.clone(), wgpu::Backends::BROWSER_WEBGPU).await {
                Ok(surface) => return Ok(surface),
                Err(error) if backend == Backend::WebGpu => return Err(error),
                Err(_) => {}
            }
        }
        Self::with(canvas, wgpu::Backends::GL).await
    }

    async fn with(canvas: HtmlCanvasElement, backends: wgpu::Backends) -> Result<Self, String> {
        let is_gl = backends == wgpu::Backends::GL;
        let interface = if is_gl { "WebGL2" } else { "WebGPU" };
        let fault = |error: &dyn std::fmt::Display| {
            let reason = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
            format!("{interface}: {reason}")
        };
        let size = [canvas.width().max(1), canvas.height().max(1)];
        let descriptor =
            wgpu::InstanceDescriptor { backends, ..wgpu::InstanceDescriptor::new_without_display_handle() };
        let instance = wgpu::Instance::new(descriptor);
        if !is_gl {
            // fails before the canvas is touched
            let any = wgpu::RequestAdapterOptions::default();
            instance.request_adapter(&any).await.map_err(|e| fault(&e))?;
        }
        let surface = instance.create_surface(wgpu::SurfaceTarget::Canvas(canvas)).map_err(|e| fault(&e))?;
        let wanted = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: Some(&surface),
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter = instance.request_adapter(&wanted).await.map_err(|e| fault(&e))?;
        let offered = adapter.limits();
        let base = if is_gl { wgpu::Limits::downlevel_webgl2_defaults() } else { wgpu::Limits::default() };
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("yamanami"),
            required_limits: wgpu::Limits {
                max_buffer_size: offered.max_buffer_size,
                ..base.using_resolution(offered.clone()).or_worse_values_from(&offered)
            },
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = adapter.request_device(&descriptor).await.map_err(|e| fault(&e))?;
        let capabilities = surface.get_capabilities(&adapter);
        let format = capabilities.formats.first().copied().ok_or_else(|| fault(&"it cannot draw on this canvas"))?;
        let mut config = surface
            .get_default_config(&adapter, size[0], size[1])
            .ok_or_else(|| fault(&"it cannot draw on this canvas"))?;
        config.format = format;
        surface.configure(&device, &config);
        let info = adapter.get_info();
        let adapter_name = if info.name.is_empty() { info.driver } else { info.name };
        let name = if adapter_name.is_empty() { interface.to_owned() } else { format!("{interface}: {adapter_name}") };
        Ok(Self { gpu: Gpu::from_device(device, queue), surface, config, name })
    }

    /// Interface and adapter in words.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Format of the canvas.
    pub(crate) fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Size of the canvas, pixels.
    pub(crate) fn size_px(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// The canvas has another size; given back as far as the device can.
    pub(crate) fn resize(&mut self, size_px: [u32; 2]) -> [u32; 2] {
        let most = self.gpu.device().limits().max_texture_dimension_2d;
        let [width, height] = size_px.map(|n| n.clamp(1, most));
        if [width, height] != self.size_px() {
            (self.config.width, self.config.height) = (width, height);
            self.surface.configure(self.gpu.device(), &self.config);
        }
        [width, height]
    }

    /// The picture to be drawn next; `None` when the browser has none just now.
    pub(crate) fn next(&mut self) -> Result<Option<wgpu::SurfaceTexture>, String> {
        use wgpu::CurrentSurfaceTexture as Current;
        match self.surface.get_current_texture() {
            Current::Success(texture) | Current::Suboptimal(texture) => Ok(Some(texture)),
            Current::Timeout | Current::Occluded => Ok(None),
            Current::Outdated => {
                self.surface.configure(self.gpu.device(), &self.config);
                Ok(None)
            }
            Current::Lost | Current::Validation => Err("device lost: the browser took the canvas away".to_owned()),
        }
    }

    /// Shows a drawn picture.
    pub(crate) fn present(&self, texture: wgpu::SurfaceTexture) {
        self.gpu.queue().present(texture);
    }
}
