//! Indexed triangle meshes and boxes.

use glam::DVec3;
use std::sync::Arc;

/// An indexed triangle mesh in metres, z up, counter-clockwise seen from outside (from above for terrain).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertex positions in metres.
    pub positions: Vec<DVec3>,
    /// Corner indices.
    pub triangles: Vec<[u32; 3]>,
    /// Unit vertex normals, one a position, or empty.
    pub normals: Vec<[f32; 3]>,
    /// Vertex colours (sRGB and alpha as stored in files), one a position, or empty.
    pub colours: Vec<[u8; 4]>,
    /// Texture coordinates (u right, v down from the top left, as glTF has them), one a position, or empty. A seam is two
    /// vertices at one place.
    pub texcoords: Vec<[f32; 2]>,
    /// Materials of the triangles, or empty.
    pub materials: Vec<Material>,
    /// Each triangle's number in `materials`, or empty: then all have the first, if any.
    pub material_of: Vec<u16>,
}

/// How a part of a mesh is painted.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in its file. May be empty.
    pub name: String,
    /// Colour and alpha that multiply texture and vertex colour, linear, 0 to 1.
    pub base_colour: [f32; 4],
    /// Picture on the texture coordinates.
    pub texture: Option<Texture>,
}

impl Default for Material {
    fn default() -> Self {
        Self { name: String::new(), base_colour: [1.0; 4], texture: None }
    }
}

/// A picture file, undecoded: it travels from source to result as it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// File name without folders, e.g. `skin.png`.
    pub name: String,
    /// The file's bytes (PNG or JPEG).
    pub bytes: Arc<[u8]>,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: DVec3,
    /// Greatest corner.
    pub max: DVec3,
}

impl Aabb {
    /// The empty box: grows from nothing.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// Grows to hold a point.
    pub fn include(&mut self, p: DVec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    /// Middle.
    pub fn centre(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Its eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|k| {
            let side = |axis: usize| if k >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(side(0), side(1), side(2))
        })
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        (self.max - self.min).length()
    }
}

impl TriangleMesh {
    /// A mesh of places and triangles alone.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, ..Self::default() }
    }

    /// A triangle's number in `materials`.
    pub fn material(&self, triangle: usize) -> usize {
        self.material_of.get(triangle).map_or(0, |&m| usize::from(m))
    }

    /// The box around all positions.
    pub fn bounds(&self) -> Aabb {
        let mut b = Aabb::EMPTY;
        for &p in &self.positions {
            b.include(p);
        }
        b
    }

    /// Corner positions of a triangle.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }
}
