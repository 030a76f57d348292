//! A mesh that stays on the GPU while it changes.
//!
//! Changed slots travel as one list and a compute pass puts them in their places; long ranges are written directly, and
//! so are all where the device has no compute shaders. Buffers grow by doubling, their content copied on the GPU.

use super::Gpu;
use super::scatter::Scatter;
use crate::vertex::{TRIANGLE_BYTES, VERTEX_BYTES};
use crate::{GpuError, MeshContents, ResidentBuffers};
use glam::DVec3;
use std::ops::Range;
use yamanami_core::{Sink, SurfaceVertex, TriangleKey, VertexId};

/// Ranges of at least this many bytes are written directly.
const DIRECT_BYTES: usize = 1 << 14;
/// Without compute shaders, ranges nearer than this many bytes are written as one.
const GAP_BYTES: u64 = 2048;
/// Slots of new buffers.
const FIRST_SLOTS: u64 = 1024;

/// What an upload cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct UploadStats {
    /// Bytes written to change vertices.
    pub vertex_bytes: u64,
    /// Bytes written to change indices.
    pub index_bytes: u64,
    /// Separate writes.
    pub writes: u64,
    /// Bytes copied on the GPU because a buffer had to grow.
    pub grown_bytes: u64,
}

/// A sink whose front can be drawn by [`crate::Renderer`]. Changes show after the next [`Self::flush`].
#[derive(Debug)]
pub struct ResidentMesh {
    gpu: Gpu,
    buffers: ResidentBuffers,
    vertex_buffer: wgpu::Buffer,
    index_buffer: wgpu::Buffer,
    scatter: Option<Scatter>,
    uploaded_triangles: u32,
}

/// One of the two buffers of the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Vertices,
    Indices,
}

impl UploadStats {
    /// Bytes written from memory to the GPU.
    pub fn total_bytes(&self) -> u64 {
        self.vertex_bytes + self.index_bytes
    }
}

impl ResidentMesh {
    /// An empty mesh with positions relative to `origin` (metres, in the local metric frame).
    pub fn new(gpu: &Gpu, origin: DVec3) -> Self {
        Self::with_buffers(gpu, ResidentBuffers::new(origin))
    }

    /// Takes over a mesh that was kept without a GPU; the next flush uploads all of it.
    pub fn with_buffers(gpu: &Gpu, mut buffers: ResidentBuffers) -> Self {
        buffers.mark_all();
        Self {
            gpu: gpu.clone(),
            vertex_buffer: Part::Vertices.create(gpu, FIRST_SLOTS * VERTEX_BYTES),
            index_buffer: Part::Indices.create(gpu, FIRST_SLOTS * TRIANGLE_BYTES),
            scatter: Scatter::new(gpu),
            uploaded_triangles: 0,
            buffers,
        }
    }

    /// The copy in memory, for drawing in software and for statistics.
    pub fn buffers(&self) -> &ResidentBuffers {
        &self.buffers
    }

    /// Removes everything but keeps the memory.
    pub fn clear(&mut self) {
        self.buffers.clear();
    }

    /// Uploads what changed since the last upload; its bytes are proportional to the change.
    pub fn flush(&mut self) -> Result<UploadStats, GpuError> {
        self.upload(true)
    }

    /// Uploads everything, changed or not: the rebuild that differences are compared with.
    pub fn upload_all(&mut self) -> Result<UploadStats, GpuError> {
        self.buffers.mark_all();
        self.upload(false)
    }

    /// What the GPU holds, by content. Meant for tests: it waits for the GPU. After a flush it equals what the mirror
    /// of the same changes holds ([`MeshContents::of_mirror`]).
    pub fn read_back(&self) -> Result<MeshContents, GpuError> {
        let vertices = self.read_buffer(&self.vertex_buffer, self.buffers.vertices().len() as u64 * VERTEX_BYTES)?;
        let indices = self.read_buffer(&self.index_buffer, u64::from(self.uploaded_triangles) * TRIANGLE_BYTES)?;
        Ok(self.buffers.contents_of(&bytemuck::pod_collect_to_vec(&vertices), &bytemuck::pod_collect_to_vec(&indices)))
    }

    pub(crate) fn vertex_buffer(&self) -> &wgpu::Buffer {
        &self.vertex_buffer
    }

    pub(crate) fn index_buffer(&self) -> &wgpu::Buffer {
        &self.index_buffer
    }

    /// Indices to draw: three for each triangle of the last upload.
    pub(crate) fn index_count(&self) -> u32 {
        self.uploaded_triangles * 3
    }

    fn upload(&mut self, may_scatter: bool) -> Result<UploadStats, GpuError> {
        self.buffers.compact();
        let vertex_size = self.buffers.vertices().len() as u64 * VERTEX_BYTES;
        let index_size = self.buffers.triangles().len() as u64 * TRIANGLE_BYTES;
        let grown_bytes = self.grow(Part::Vertices, vertex_size)? + self.grow(Part::Indices, index_size)?;
        let mut stats = UploadStats { grown_bytes, ..UploadStats::default() };
        let scatters = [&self.vertex_buffer, &self.index_buffer].map(|buffer| {
            may_scatter && self.scatter.as_ref().is_some_and(|scatter| scatter.reaches(&self.gpu, buffer))
        });
        let dirty = self.buffers.take_dirty(if scatters == [true; 2] { 0 } else { GAP_BYTES });
        stats.vertex_bytes = self.write(Part::Vertices, &dirty.vertices, scatters[0], &mut stats.writes);
        stats.index_bytes = self.write(Part::Indices, &dirty.triangles, scatters[1], &mut stats.writes);
        self.uploaded_triangles = self.buffers.triangles().len() as u32;
        Ok(stats)
    }

    fn grow(&mut self, part: Part, needed: u64) -> Result<u64, GpuError> {
        let old = match part {
            Part::Vertices => &mut self.vertex_buffer,
            Part::Indices => &mut self.index_buffer,
        };
        if needed <= old.size() {
            return Ok(0);
        }
        let limit_bytes = part.limit_bytes(&self.gpu);
        if needed > limit_bytes {
            return Err(GpuError::MeshTooLarge { what: part.name(), bytes: needed, limit_bytes });
        }
        let wanted = (old.size() * 2).max(needed).next_multiple_of(part.slot_bytes() * FIRST_SLOTS);
        let new = part.create(&self.gpu, wanted.min(limit_bytes));
        let mut encoder = self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(old, 0, &new, 0, old.size());
        self.gpu.queue().submit([encoder.finish()]);
        let copied = old.size();
        *old = new;
        Ok(copied)
    }

    /// Writes ranges of slots, those that are short by the scatter pass where that is allowed. Returns the bytes written.
    fn write(&mut self, part: Part, ranges: &[Range<u32>], scatters: bool, writes: &mut u64) -> u64 {
        let (buffer, content): (_, &[u32]) = match part {
            Part::Vertices => (&self.vertex_buffer, bytemuck::cast_slice(self.buffers.vertices())),
            Part::Indices => (&self.index_buffer, bytemuck::cast_slice(self.buffers.triangles())),
        };
        let slot_words = part.slot_bytes() as usize / size_of::<u32>();
        let words_of =
            |range: &Range<u32>| &content[range.start as usize * slot_words..range.end as usize * slot_words];
        let mut bytes = 0;
        let mut scatter = self.scatter.as_mut().filter(|_| scatters);
        for range in ranges {
            let words = words_of(range);
            match &mut scatter {
                Some(scatter) if size_of_val(words) < DIRECT_BYTES => {
                    for (slot, words) in range.clone().zip(words.chunks_exact(slot_words)) {
                        if !scatter.stage(slot, words) {
                            bytes += scatter.send(&self.gpu, buffer);
                            *writes += 1;
                            scatter.stage(slot, words);
                        }
                    }
                }
                _ => {
                    self.gpu.queue().write_buffer(
                        buffer,
                        u64::from(range.start) * part.slot_bytes(),
                        bytemuck::cast_slice(words),
                    );
                    bytes += size_of_val(words) as u64;
                    *writes += 1;
                }
            }
        }
        let rest = scatter.map_or(0, |scatter| scatter.send(&self.gpu, buffer));
        *writes += u64::from(rest > 0);
        bytes + rest
    }

    fn read_buffer(&self, buffer: &wgpu::Buffer, size: u64) -> Result<Vec<u8>, GpuError> {
        if size == 0 {
            return Ok(Vec::new());
        }
        let copy = self.gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("yamanami read-back"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, size.min(buffer.size()));
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.read(&copy, size)
    }
}

impl Part {
    fn name(self) -> &'static str {
        match self {
            Self::Vertices => "vertex",
            Self::Indices => "index",
        }
    }

    fn slot_bytes(self) -> u64 {
        match self {
            Self::Vertices => VERTEX_BYTES,
            Self::Indices => TRIANGLE_BYTES,
        }
    }

    /// Most bytes of such a buffer, in whole slots; indices must also be counted by 32 bits.
    fn limit_bytes(self, gpu: &Gpu) -> u64 {
        let countable = match self {
            Self::Vertices => u64::from(u32::MAX) * VERTEX_BYTES,
            Self::Indices => u64::from(u32::MAX / 3) * TRIANGLE_BYTES,
        };
        let limit = gpu.device().limits().max_buffer_size.min(countable);
        limit - limit % self.slot_bytes()
    }

    fn create(self, gpu: &Gpu, size: u64) -> wgpu::Buffer {
        use wgpu::BufferUsages as Usage;
        let role = match self {
            Self::Vertices => Usage::VERTEX,
            Self::Indices => Usage::INDEX,
        };
        let storage = if gpu.reads_buffers() { Usage::STORAGE } else { Usage::empty() };
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(self.name()),
            size,
            usage: role | storage | Usage::COPY_DST | Usage::COPY_SRC,
            mapped_at_creation: false,
        })
    }
}

impl Sink for ResidentMesh {
    fn add_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        self.buffers.add_vertex(id, vertex);
    }

    fn update_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        self.buffers.update_vertex(id, vertex);
    }

    fn remove_vertex(&mut self, id: VertexId) {
        self.buffers.remove_vertex(id);
    }

    fn add_triangle(&mut self, key: TriangleKey, corners: [VertexId; 3]) {
        self.buffers.add_triangle(key, corners);
    }

    fn remove_triangle(&mut self, key: TriangleKey) {
        self.buffers.remove_triangle(key);
    }
}
