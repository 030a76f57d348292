//! A vertex as the GPU holds it: 32 bytes, relative to the mesh's origin.
//!
//! Normals are folded onto an octahedron and stored in two 16-bit numbers. Based on: Cigolle, Donow, Evangelakos, Mara,
//! McGuire, Meyer, "A Survey of Efficient Representations for Independent Unit Vectors", 2014.

use glam::{DVec3, Vec2, Vec3};
use yamanami_core::SurfaceVertex;

/// Stands for an infinite error or radius on the GPU, where shaders may not meet infinities.
pub const UNBOUNDED_M: f32 = 1e30;

/// A vertex as stored in the vertex buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GpuVertex {
    /// Position in metres relative to the mesh's origin.
    pub position: [f32; 3],
    /// How far the vertex rises above its place in the coarser mesh, metres.
    pub detail_m: f32,
    /// Error of the vertex's node, metres; at most [`UNBOUNDED_M`].
    pub error_m: f32,
    /// Radius of the node's bound, metres; at most [`UNBOUNDED_M`].
    pub bound_radius_m: f32,
    /// Unit normal on the octahedron, two signed 16-bit numbers, the first in the low half.
    pub normal_oct: u32,
    /// Colour (sRGB), red in the lowest byte, and the depth of the vertex's node in the highest, at most 255.
    pub colour_and_level: u32,
}

/// Bytes of a vertex.
pub const VERTEX_BYTES: u64 = size_of::<GpuVertex>() as u64;

/// Bytes of a triangle in the index buffer.
pub const TRIANGLE_BYTES: u64 = size_of::<[u32; 3]>() as u64;

impl GpuVertex {
    /// Packs a vertex of a surface, its position relative to `origin`.
    pub fn pack(vertex: &SurfaceVertex, origin: DVec3) -> Self {
        Self {
            position: (vertex.position - origin).as_vec3().to_array(),
            detail_m: vertex.detail_m,
            error_m: vertex.error_m.min(UNBOUNDED_M),
            bound_radius_m: vertex.bound_radius_m.min(UNBOUNDED_M),
            normal_oct: pack_normal(Vec3::from_array(vertex.normal)),
            colour_and_level: pack_colour_and_level(vertex.colour, vertex.level),
        }
    }

    /// Position relative to the mesh's origin.
    #[inline]
    pub fn local(&self) -> Vec3 {
        Vec3::from_array(self.position)
    }

    /// Colour, sRGB.
    #[inline]
    pub fn colour(&self) -> [u8; 3] {
        let [r, g, b, _] = self.colour_and_level.to_le_bytes();
        [r, g, b]
    }

    /// Depth of the vertex's node, at most 255.
    #[inline]
    pub fn level(&self) -> u32 {
        self.colour_and_level >> 24
    }

    /// Unit normal.
    #[inline]
    pub fn normal(&self) -> Vec3 {
        unpack_normal(self.normal_oct)
    }
}

/// Puts a colour and a level into one number; no level is above 255.
fn pack_colour_and_level([r, g, b]: [u8; 3], level: u32) -> u32 {
    u32::from_le_bytes([r, g, b, level.min(255) as u8])
}

/// Folds a unit vector onto the octahedron; anything that is not a direction becomes straight up.
pub fn pack_normal(normal: Vec3) -> u32 {
    let sum = normal.x.abs() + normal.y.abs() + normal.z.abs();
    if !sum.is_finite() || sum <= 0.0 {
        return 0;
    }
    let n = normal / sum;
    let folded = if n.z >= 0.0 { n.truncate() } else { fold(n.truncate()) };
    let snorm = |v: f32| (v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16;
    u32::from(snorm(folded.x)) | u32::from(snorm(folded.y)) << 16
}

/// The unit vector that [`pack_normal`] stored, as the vertex shader decodes it.
#[inline]
pub fn unpack_normal(packed: u32) -> Vec3 {
    let snorm = |half: u32| (f32::from(half as u16 as i16) / 32767.0).max(-1.0);
    let e = Vec2::new(snorm(packed & 0xFFFF), snorm(packed >> 16));
    let z = 1.0 - e.x.abs() - e.y.abs();
    let xy = if z >= 0.0 { e } else { fold(e) };
    xy.extend(z).normalize()
}

#[inline]
fn fold(v: Vec2) -> Vec2 {
    let sign = |x: f32| if x >= 0.0 { 1.0 } else { -1.0 };
    Vec2::new((1.0 - v.y.abs()) * sign(v.x), (1.0 - v.x.abs()) * sign(v.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn normals_survive_packing(x in -1f32..1.0, y in -1f32..1.0, z in -1f32..1.0) {
            let n = Vec3::new(x, y, z);
            prop_assume!(n.length() > 1e-3);
            let n = n.normalize();
            let back = unpack_normal(pack_normal(n));
            prop_assert!((n - back).length() < 1e-4, "{n} {back}");
        }
    }

    #[test]
    fn colour_and_level_share_a_number() {
        let packed =
            |level| GpuVertex { colour_and_level: pack_colour_and_level([1, 200, 255], level), ..GpuVertex::default() };
        assert_eq!((packed(7).colour(), packed(7).level()), ([1, 200, 255], 7));
        assert_eq!((packed(900).colour(), packed(900).level()), ([1, 200, 255], 255));
    }

    #[test]
    fn what_is_no_direction_points_up() {
        assert_eq!(unpack_normal(pack_normal(Vec3::ZERO)), Vec3::Z);
        assert_eq!(unpack_normal(pack_normal(Vec3::NAN)), Vec3::Z);
    }
}
