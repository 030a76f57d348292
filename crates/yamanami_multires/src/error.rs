//! What building may fail with.

/// Reasons a surface cannot be built.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MultiresError {
    /// No triangle of the grid has data at all three corners.
    #[error("nothing to build: of {width}x{height} samples, {no_data} have no data and no triangle is left")]
    NothingToShow {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Samples without data.
        no_data: usize,
    },
    /// The node numbers of a surface must fit in 32 bits.
    #[error("the grid is too large: {width}x{height} samples, at most about 3.2 billion can be numbered")]
    TooLarge {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Heights beyond what an error code can tell apart.
    #[error("height {height_m} m at column {column}, row {row} is out of range: heights must lie within ±500 km")]
    HeightOutOfRange {
        /// The height found.
        height_m: f32,
        /// Its column.
        column: usize,
        /// Its row.
        row: usize,
    },
    /// Nodes, clusters or pages of a cluster hierarchy that do not fit together.
    #[error("{}: {what}: expected {expected}, given {given}", group_name(*group))]
    BadClusters {
        /// The node, or [`yamanami_core::BASE_CLUSTERS`].
        group: u32,
        /// What was counted or named.
        what: &'static str,
        /// The number expected.
        expected: u64,
        /// The number found.
        given: u64,
    },
    /// A mesh without a triangle that has three corners.
    #[error("nothing to build: of {triangles} triangles, none has three different corners")]
    NoTriangles {
        /// Triangles given.
        triangles: usize,
    },
    /// A triangle names a vertex that is not there, or one that is nowhere.
    #[error("triangle {triangle} names vertex {vertex}: expected one of {vertices} with finite coordinates")]
    BadCorner {
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// The numbers of clusters, vertices and triangles must fit in 32 bits, those of the base mesh's clusters in 16.
    #[error("the mesh is too large for a cluster hierarchy: {count} {what}, at most {most} can be numbered")]
    TooManyClusters {
        /// What was counted.
        what: &'static str,
        /// How many.
        count: u64,
        /// How many there may be.
        most: u64,
    },
    /// A mesh that is not a surface with or without border, facing one way.
    #[error("not a surface at ({:.6}, {:.6}, {:.6}): {what}", place_m[0], place_m[1], place_m[2])]
    NotASurface {
        /// What is wrong, with numbers of vertices or triangles.
        what: String,
        /// Where, in metres.
        place_m: [f64; 3],
    },
    /// Vertices and triangles of a semi-regular mesh must have 32-bit numbers.
    #[error("the mesh is too large: {triangles} triangles, at most 1.4 billion can be numbered")]
    TooManyTriangles {
        /// Triangles given.
        triangles: usize,
    },
    /// Places or colours that do not fit the vertices of a semi-regular mesh.
    #[error("a semi-regular mesh of {vertices} vertices: expected as many {what}, given {given}")]
    BadVertices {
        /// What was given.
        what: &'static str,
        /// Vertices of the mesh.
        vertices: usize,
        /// How many were given.
        given: usize,
    },
    /// The numbers of vertices and triangles of what is remeshed, and of the result, must fit in 30 bits.
    #[error(
        "the mesh is too large to be remeshed: {triangles} triangles, source or result, at most 2^30 can be numbered"
    )]
    TooLargeToRemesh {
        /// Triangles given or asked for.
        triangles: usize,
    },
    /// Points that span no triangle in plan.
    #[error("no triangle can be made of {points} points: expected at least three places that are not on one line")]
    NoNetwork {
        /// Usable points, those of lines with them.
        points: usize,
    },
    /// Blocks that are too many, or that make too many triangles or levels.
    #[error("{count} {what}, at most {most} can be numbered")]
    TooManyBlocks {
        /// What was counted.
        what: &'static str,
        /// How many.
        count: u64,
        /// How many there may be.
        most: u64,
    },
    /// Blocks that are no power of two of the grid's samples.
    #[error("blocks of {block_m} m: expected a power of two, 2 to 2^20, of the grid's spacing of {spacing_m} m")]
    BadBlockSize {
        /// Side of a block, metres.
        block_m: f64,
        /// Spacing of the grid, metres.
        spacing_m: f64,
    },
    /// Blocks without a size.
    #[error("block borders must go up from one to the next: given {} m, then {} m", borders_m[0], borders_m[1])]
    BadBlocks {
        /// The borders that do not.
        borders_m: [f64; 2],
    },
}

fn group_name(group: u32) -> String {
    if group == yamanami_core::BASE_CLUSTERS { "the base mesh".into() } else { format!("node {group}") }
}
