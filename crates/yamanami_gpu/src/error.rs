//! What drawing may fail with.

/// Why a picture or an upload could not be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// The machine has no graphics adapter that can be used.
    #[error(
        "no graphics adapter found: install a Vulkan, Metal, DirectX 12 or OpenGL driver, or draw in software ({reason})"
    )]
    NoAdapter {
        /// What the graphics layer said.
        reason: String,
    },
    /// The adapter gave no device.
    #[error("the graphics adapter `{adapter}` gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the graphics layer said.
        reason: String,
    },
    /// The picture is empty or larger than can be drawn.
    #[error("picture size: expected 1 to {limit_px} pixels a side, got {}x{}", size_px[0], size_px[1])]
    PictureSize {
        /// Width and height asked for.
        size_px: [u32; 2],
        /// Longest side possible.
        limit_px: u32,
    },
    /// The mesh outgrew what one buffer of the adapter holds.
    #[error("the mesh needs a {what} buffer of {bytes} bytes, the graphics adapter allows {limit_bytes}")]
    MeshTooLarge {
        /// `vertex` or `index`.
        what: &'static str,
        /// Bytes wanted.
        bytes: u64,
        /// Bytes allowed.
        limit_bytes: u64,
    },
    /// Data could not be copied back from the GPU.
    #[error("reading back from the GPU failed: {reason}")]
    ReadBack {
        /// What the graphics layer said.
        reason: String,
    },
}
