//! The materials of a glTF document, and its pictures: in the file, beside it or in its text.

use super::gltf_buffers::{Buffers, fetch};
use super::gltf_json::{Document, TextureTransform, TextureUse};
use super::origin::{Origin, file_name};
use crate::IoError;
use std::collections::HashMap;
use std::sync::Arc;
use yamanami_core::{Material, Texture};

/// Most materials of a mesh.
const LIMIT: usize = u16::MAX as usize;

/// The materials that primitives have named so far, in the order in which they did.
#[derive(Default)]
pub(super) struct Materials {
    pub(super) list: Vec<Material>,
    numbers: HashMap<Option<usize>, u16>,
    pictures: HashMap<usize, Option<Texture>>,
}

/// Which texture coordinates a material wants, and what is done to them.
#[derive(Clone, Copy, Default)]
pub(super) struct Mapping {
    pub(super) set: usize,
    pub(super) transform: Option<TextureTransform>,
}

fn picture_use(document: &Document, material: Option<usize>) -> Option<&TextureUse> {
    let entry = document.materials.get(material?)?;
    let specular = entry.extensions.specular.as_ref().and_then(|s| s.diffuse_texture.as_ref());
    entry.pbr_metallic_roughness.base_color_texture.as_ref().or(specular)
}

/// The mapping of a material; of none, the first set as it is.
pub(super) fn mapping(document: &Document, material: Option<usize>) -> Mapping {
    let Some(texture) = picture_use(document, material) else { return Mapping::default() };
    let transform = texture.extensions.transform;
    let set = transform.and_then(|t| t.tex_coord).unwrap_or(texture.tex_coord);
    Mapping { set, transform }
}

impl Materials {
    /// The number of a material; `None` is the format's default.
    pub(super) fn number(
        &mut self,
        origin: &mut Origin<'_>,
        document: &Document,
        buffers: &mut Buffers<'_>,
        material: Option<usize>,
    ) -> Result<u16, IoError> {
        if let Some(&known) = self.numbers.get(&material) {
            return Ok(known);
        }
        let mut read = Material::default();
        if let Some(number) = material {
            let Some(entry) = document.materials.get(number) else {
                let expected = format!("a material below {}", document.materials.len());
                return Err(origin.bad("primitives", expected, number.to_string()));
            };
            read.name = super::one_line(&entry.name);
            let specular = entry.extensions.specular.as_ref().and_then(|s| s.diffuse_factor);
            if let Some(colour) = entry.pbr_metallic_roughness.base_color_factor.or(specular) {
                read.base_colour = colour;
            }
            read.texture = match picture_use(document, material) {
                Some(texture) => self.picture(origin, document, buffers, texture.index),
                None => None,
            };
        }
        let number = self.list.len();
        if number >= LIMIT {
            return Err(IoError::too_large(origin.name, "materials", number as u64 + 1, LIMIT as u64));
        }
        self.list.push(read);
        self.numbers.insert(material, number as u16);
        Ok(number as u16)
    }

    /// A texture's picture; one that cannot be read is missing, and said to be.
    fn picture(
        &mut self,
        origin: &mut Origin<'_>,
        document: &Document,
        buffers: &mut Buffers<'_>,
        texture: usize,
    ) -> Option<Texture> {
        let source = document.textures.get(texture).and_then(|t| t.source);
        let Some(source) = source else {
            origin.note(format!("texture {texture} not read: it has no PNG or JPEG picture"));
            return None;
        };
        if let Some(known) = self.pictures.get(&source) {
            return known.clone();
        }
        let bytes = match document.images.get(source) {
            None => Err(format!("there are {} images", document.images.len())),
            Some(image) => match (&image.uri, image.buffer_view) {
                (Some(uri), _) => fetch(origin, uri),
                (None, Some(view)) => buffers.view(origin, view).map(|v| v.into_owned()).map_err(|e| e.to_string()),
                (None, None) => Err("it is empty".into()),
            },
        };
        let ending = bytes.as_ref().ok().map(|b| picture_kind(b));
        let picture = match (bytes, ending) {
            (Ok(bytes), Some(Some((ending, _)))) => {
                let image = &document.images[source];
                let uri = image.uri.as_deref().filter(|uri| !uri.starts_with("data:")).unwrap_or_default();
                let named = [file_name(uri), file_name(&image.name), format!("texture_{source}")];
                let mut name = named.into_iter().find(|name| !name.is_empty()).unwrap_or_default();
                let lower = name.to_lowercase();
                if ![".png", ".jpg", ".jpeg"].iter().any(|end| lower.ends_with(end)) {
                    name = format!("{name}.{ending}");
                }
                Some(Texture { name: super::one_line(&name), bytes: Arc::from(bytes) })
            }
            (Ok(_), _) => {
                origin.note(format!("image {source} not read: it is neither PNG nor JPEG"));
                None
            }
            (Err(why), _) => {
                origin.note(format!("image {source} not read: {why}"));
                None
            }
        };
        self.pictures.insert(source, picture.clone());
        picture
    }
}

/// The ending and the media type of a picture that glTF knows.
pub(super) fn picture_kind(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some(("png", "image/png")),
        [0xff, 0xd8, 0xff, ..] => Some(("jpg", "image/jpeg")),
        _ => None,
    }
}
