//! What drawing may fail with.

/// Why a picture or an upload could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
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
    /// A picture of the ground that is no square around a sample, or not as long as it says.
    #[error(
        "map texture: expected an odd number of samples a side, four bytes each, and a reach above 0 m, got {side_px} a \
         side in {bytes} bytes, reach {reach_m} m"
    )]
    MapTexture {
        /// Samples a side.
        side_px: u32,
        /// Metres to each side.
        reach_m: f64,
        /// Bytes given.
        bytes: usize,
    },
    /// More pictures of the ground than one map takes.
    #[error("map textures: expected at most {limit}, got {count}")]
    MapTextureCount {
        /// Pictures given.
        count: usize,
        /// Most that are taken.
        limit: usize,
    },
    /// A picture of the ground or a horizon table is larger than the adapter's textures.
    #[error(
        "{what}: expected at most {limit_px} samples a side, which is what the graphics adapter allows, got {side_px}"
    )]
    TextureTooLarge {
        /// `map texture` or `horizon table`.
        what: &'static str,
        /// Samples of the longer side.
        side_px: u32,
        /// Samples allowed.
        limit_px: u32,
    },
    /// A horizon table whose rows are not of one length.
    #[error(
        "horizon table: expected rows of equal length and a step above 0 m, got {entries} entries for {azimuth_count} \
         azimuths by {step_m} m"
    )]
    HorizonTable {
        /// Rows asked for.
        azimuth_count: u32,
        /// Metres between entries.
        step_m: f64,
        /// Entries given.
        entries: usize,
    },
    /// Data could not be copied back from the GPU.
    #[error("reading back from the GPU failed: {reason}")]
    ReadBack {
        /// What the graphics layer said.
        reason: String,
    },
}
