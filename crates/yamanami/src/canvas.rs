//! Where a front is drawn: on the GPU, or by the software twin where there is none.

use crate::Error;
use glam::DVec3;
use image::RgbaImage;
use yamanami_core::{Sink, TriangleMesh, View};
use yamanami_gpu::{Gpu, RenderOptions, Renderer, ResidentBuffers, ResidentMesh, software, wgpu};

/// A resident mesh with something to draw it.
#[derive(Debug)]
pub enum Canvas {
    /// Persistent GPU buffers.
    Gpu {
        /// The mesh.
        mesh: Box<ResidentMesh>,
        /// What draws it.
        renderer: Box<Renderer>,
    },
    /// The same buffers in memory, drawn by the processor.
    Software(Box<ResidentBuffers>),
}

/// Who draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DrawWith {
    /// A GPU; where there is none, or only a processor that plays one, the software twin.
    #[default]
    Auto,
    /// Whatever adapter there is; an error where there is none.
    Gpu,
    /// The software twin.
    Software,
}

/// What bringing a change to where it is drawn cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Upload {
    /// Bytes written.
    pub bytes: u64,
    /// Separate ranges written.
    pub writes: u64,
}

impl Canvas {
    /// An empty canvas; positions are kept relative to `origin`, metres.
    pub fn new(origin: DVec3, with: DrawWith) -> Result<Self, Error> {
        Self::holding(ResidentBuffers::new(origin), with)
    }

    /// A canvas with a whole mesh on it, flushed.
    pub fn of_mesh(mesh: &TriangleMesh, with: DrawWith) -> Result<Self, Error> {
        let mut canvas = Self::holding(ResidentBuffers::from_mesh(mesh), with)?;
        canvas.flush()?;
        Ok(canvas)
    }

    fn holding(buffers: ResidentBuffers, with: DrawWith) -> Result<Self, Error> {
        let gpu = match with {
            DrawWith::Auto => Gpu::headless().ok().filter(|gpu| !gpu.is_processor()),
            DrawWith::Gpu => Some(Gpu::headless()?),
            DrawWith::Software => None,
        };
        Ok(match gpu {
            Some(gpu) => Self::Gpu {
                mesh: Box::new(ResidentMesh::with_buffers(&gpu, buffers)),
                renderer: Box::new(Renderer::new(&gpu)),
            },
            None => Self::Software(Box::new(buffers)),
        })
    }

    /// On this GPU.
    pub fn on_gpu(gpu: &Gpu, origin: DVec3) -> Self {
        Self::Gpu { mesh: Box::new(ResidentMesh::new(gpu, origin)), renderer: Box::new(Renderer::new(gpu)) }
    }

    /// What draws: `gpu` or `software`.
    pub fn description(&self) -> &'static str {
        match self {
            Self::Gpu { .. } => "gpu",
            Self::Software(_) => "software",
        }
    }

    /// The sink for deltas.
    pub fn sink(&mut self) -> &mut dyn Sink {
        match self {
            Self::Gpu { mesh, .. } => &mut **mesh,
            Self::Software(buffers) => &mut **buffers,
        }
    }

    /// The buffers as they are in memory.
    pub fn buffers(&self) -> &ResidentBuffers {
        match self {
            Self::Gpu { mesh, .. } => mesh.buffers(),
            Self::Software(buffers) => buffers,
        }
    }

    /// Forgets the mesh.
    pub fn clear(&mut self) {
        match self {
            Self::Gpu { mesh, .. } => mesh.clear(),
            Self::Software(buffers) => buffers.clear(),
        }
    }

    /// Writes what changed; in software nothing need be written, but is counted as if.
    pub fn flush(&mut self) -> Result<Upload, Error> {
        match self {
            Self::Gpu { mesh, .. } => {
                let stats = mesh.flush()?;
                Ok(Upload { bytes: stats.total_bytes(), writes: stats.writes })
            }
            Self::Software(buffers) => {
                let dirty = buffers.take_dirty(0);
                Ok(Upload {
                    bytes: dirty.vertex_bytes() + dirty.index_bytes(),
                    writes: (dirty.vertices.len() + dirty.triangles.len()) as u64,
                })
            }
        }
    }

    /// Writes everything.
    pub fn upload_all(&mut self) -> Result<Upload, Error> {
        match self {
            Self::Gpu { mesh, .. } => {
                let stats = mesh.upload_all()?;
                Ok(Upload { bytes: stats.total_bytes(), writes: stats.writes })
            }
            Self::Software(buffers) => {
                buffers.mark_all();
                self.flush()
            }
        }
    }

    /// Draws the mesh as last flushed.
    pub fn draw(&mut self, view: &View, options: &RenderOptions) -> Result<RgbaImage, Error> {
        match self {
            Self::Gpu { mesh, renderer } => Ok(renderer.render_to_image(mesh, view, options)?),
            Self::Software(buffers) => Ok(software::render_to_image(buffers, view, options)?),
        }
    }

    /// Draws the mesh as last flushed on a texture view of the view's size and of this format, for programs with a window of
    /// their own. The canvas is on the texture's GPU.
    pub fn draw_on(
        &mut self,
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        view: &View,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        match self {
            Self::Gpu { mesh, renderer } => Ok(renderer.draw(target, format, mesh, view, options)?),
            Self::Software(_) => Err(Error::Request("a canvas in memory cannot draw on a texture".to_owned())),
        }
    }
}
