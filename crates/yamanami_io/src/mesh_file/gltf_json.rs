//! The parts of a glTF 2.0 document that say where triangles are and how they are painted.
//!
//! Based on: Khronos Group, "glTF 2.0 Specification", 2021.

use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::HashMap;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    pub(super) scene: Option<usize>,
    #[serde(default)]
    pub(super) scenes: Vec<Scene>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    pub(super) materials: Vec<MaterialEntry>,
    #[serde(default)]
    pub(super) textures: Vec<TextureEntry>,
    #[serde(default)]
    pub(super) images: Vec<Image>,
    #[serde(default)]
    pub(super) extensions_required: Vec<String>,
    #[serde(default)]
    pub(super) extensions_used: Vec<String>,
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub(super) nodes: Vec<usize>,
}

#[derive(Deserialize)]
pub(super) struct Node {
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<IgnoredAny>,
    #[serde(default)]
    pub(super) children: Vec<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

impl Node {
    pub(super) fn parent_from_node(&self) -> DMat4 {
        match &self.matrix {
            Some(columns) => DMat4::from_cols_array(columns),
            None => DMat4::from_scale_rotation_translation(
                self.scale.map_or(DVec3::ONE, DVec3::from),
                self.rotation.map_or(DQuat::IDENTITY, DQuat::from_array),
                self.translation.map_or(DVec3::ZERO, DVec3::from),
            ),
        }
    }
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    #[serde(default)]
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: HashMap<String, usize>,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    pub(super) mode: Option<u32>,
    pub(super) targets: Option<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) shape: String,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) sparse: Option<Sparse>,
}

/// Items that replace some of an accessor's.
#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
    #[serde(default)]
    pub(super) extensions: ViewExtensions,
}

impl BufferView {
    /// The distance of elements that were packed, which say it where plain ones may leave it out.
    pub(super) fn packed_stride(&self) -> Option<usize> {
        self.extensions.packed().map(|packed| packed.byte_stride)
    }
}

#[derive(Deserialize, Default)]
pub(super) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    ext: Option<Packed>,
    #[serde(rename = "KHR_meshopt_compression")]
    khr: Option<Packed>,
}

impl ViewExtensions {
    pub(super) fn packed(&self) -> Option<&Packed> {
        self.khr.as_ref().or(self.ext.as_ref())
    }
}

/// A view packed by meshopt.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Packed {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: usize,
    pub(super) count: usize,
    pub(super) mode: String,
    pub(super) filter: Option<String>,
}

#[derive(Deserialize)]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct MaterialEntry {
    #[serde(default)]
    pub(super) name: String,
    #[serde(default)]
    pub(super) pbr_metallic_roughness: Metallic,
    #[serde(default)]
    pub(super) extensions: MaterialExtensions,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase")]
pub(super) struct Metallic {
    pub(super) base_color_factor: Option<[f32; 4]>,
    pub(super) base_color_texture: Option<TextureUse>,
}

#[derive(Deserialize, Default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) specular: Option<Specular>,
}

/// How older scans are painted.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Specular {
    pub(super) diffuse_factor: Option<[f32; 4]>,
    pub(super) diffuse_texture: Option<TextureUse>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureUse {
    pub(super) index: usize,
    #[serde(default)]
    pub(super) tex_coord: usize,
    #[serde(default)]
    pub(super) extensions: TextureUseExtensions,
}

#[derive(Deserialize, Default)]
pub(super) struct TextureUseExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<TextureTransform>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureTransform {
    #[serde(default)]
    offset: [f64; 2],
    #[serde(default)]
    rotation: f64,
    scale: Option<[f64; 2]>,
    pub(super) tex_coord: Option<usize>,
}

impl TextureTransform {
    /// The numbers as bits, to tell transforms apart by.
    pub(super) fn bits(&self) -> [u64; 5] {
        let [su, sv] = self.scale.unwrap_or([1.0; 2]);
        [self.offset[0], self.offset[1], self.rotation, su, sv].map(f64::to_bits)
    }

    /// Where the picture is taken from for a texture coordinate.
    pub(super) fn apply(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [su, sv] = self.scale.unwrap_or([1.0; 2]);
        let (sin, cos) = self.rotation.sin_cos();
        let (u, v) = (u * su, v * sv);
        [cos * u + sin * v + self.offset[0], cos * v - sin * u + self.offset[1]]
    }
}

#[derive(Deserialize)]
pub(super) struct TextureEntry {
    pub(super) source: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image {
    #[serde(default)]
    pub(super) name: String,
    pub(super) uri: Option<String>,
    pub(super) buffer_view: Option<usize>,
}
