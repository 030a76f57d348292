//! A graphics device, found here or brought along.

use crate::GpuError;

/// A device and its queue. Cloning is cheap and shares them.
#[derive(Debug, Clone)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

impl Gpu {
    /// Finds a device for drawing without a window. `WGPU_BACKEND` (`vulkan`, `gl`, `metal`, `dx12`) restricts the search.
    pub fn headless() -> Result<Self, GpuError> {
        pollster::block_on(Self::request())
    }

    /// As [`Self::headless`], for callers that must not block.
    pub async fn request() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let wanted = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter = instance
            .request_adapter(&wanted)
            .await
            .map_err(|error| GpuError::NoAdapter { reason: one_line(&error) })?;
        let offered = adapter.limits();
        let usual = wgpu::Limits::default().or_worse_values_from(&offered);
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("yamanami"),
            required_limits: wgpu::Limits {
                max_buffer_size: offered.max_buffer_size,
                max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
                max_texture_dimension_2d: offered.max_texture_dimension_2d,
                ..usual
            },
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|error| GpuError::NoDevice { adapter: adapter.get_info().name, reason: one_line(&error) })?;
        Ok(Self { device, queue })
    }

    /// Uses a device that a window already has.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        Self { device, queue }
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// What draws, in words: adapter, driver interface and kind of device.
    pub fn description(&self) -> String {
        let info = self.device.adapter_info();
        format!("{} ({}, {:?})", info.name, info.backend, info.device_type)
    }

    /// Whether the device is the processor itself, pretending. [`crate::software`] is then the faster way to a picture.
    pub fn is_processor(&self) -> bool {
        self.device.adapter_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Whether vertex shaders may read buffers, as the wireframe needs.
    pub(crate) fn reads_buffers(&self) -> bool {
        self.device.limits().max_storage_buffers_per_shader_stage >= 2
    }

    /// Waits for the GPU and copies the first `size` bytes of a buffer that can be mapped.
    pub(crate) fn read(&self, buffer: &wgpu::Buffer, size: u64) -> Result<Vec<u8>, GpuError> {
        let failed = |error: &dyn std::error::Error| GpuError::ReadBack { reason: one_line(error) };
        let (sender, receiver) = std::sync::mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, ..size, move |result| {
            // The receiver waits below for as long as the sender lives.
            let _ = sender.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
        receiver.recv().map_err(|error| failed(&error))?.map_err(|error| failed(&error))?;
        let bytes = buffer.get_mapped_range(..size).map_err(|error| failed(&error))?.to_vec();
        buffer.unmap();
        Ok(bytes)
    }
}

/// An error's message without line breaks.
fn one_line(error: &dyn std::error::Error) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
