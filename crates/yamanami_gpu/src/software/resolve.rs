//! From triangles that show to colours: the fragment shaders' twin and the mean over a pixel's samples.

use super::place::{PlacedVertex, SUBPIXELS};
use super::raster::{Band, NOTHING, Sample};
use crate::frame::{COLOUR_ASPECT, COLOUR_DRAPE, COLOUR_LEVEL, COLOUR_PLAIN, COLOUR_SLOPE, COLOUR_VERTEX, Frame};
use crate::palette::{SrgbEncoder, srgb_to_linear};
use crate::shade::{aspect_colour, ramp_colour, rgb, sky_colour, surface_colour, water_colour, wire_share};
use crate::{Drape, GpuVertex, ResidentBuffers};
use glam::{DMat3, DVec2, DVec3, Vec2, Vec3, Vec4};
use image::RgbaImage;

/// Colours the pixels of one picture.
pub(super) struct Resolver<'a> {
    buffers: &'a ResidentBuffers,
    frame: &'a Frame,
    vertices: &'a [PlacedVertex],
    drape: Option<&'a Drape>,
    encoder: SrgbEncoder,
    decode: Vec<f32>,
}

/// Barycentric coordinates of a triangle over the picture, perspective-correct and valid behind the eye too.
struct Shares {
    /// Rows: shares over depth as a linear function of picture coordinates (x, y, 1).
    over_depth: DMat3,
}

impl<'a> Resolver<'a> {
    pub(super) fn new(
        buffers: &'a ResidentBuffers,
        frame: &'a Frame,
        vertices: &'a [PlacedVertex],
        drape: Option<&'a Drape>,
        encoder: SrgbEncoder,
    ) -> Self {
        let decode = (0..=255u8).map(|v| srgb_to_linear(f32::from(v) / 255.0)).collect();
        Self { buffers, frame, vertices, drape, encoder, decode }
    }

    /// Writes the RGBA bytes of a band's rows.
    pub(super) fn colour_band<const N: usize>(&self, band: &Band<N>, samples: &[Sample; N], rows: &mut [u8]) {
        for (i, (slots, out)) in band.slots().iter().zip(rows.chunks_exact_mut(4)).enumerate() {
            let pixel = DVec2::new((i % band.width()) as f64, (band.first_row() + i / band.width()) as f64);
            let mut colour = Vec3::ZERO;
            for s in 0..N {
                if slots[..s].contains(&slots[s]) {
                    continue;
                }
                let mut centroid = DVec2::ZERO;
                let mut count = 0.0;
                for (sample, _) in samples.iter().zip(slots).filter(|&(_, &slot)| slot == slots[s]) {
                    centroid += DVec2::new(sample[0] as f64, sample[1] as f64) / SUBPIXELS as f64;
                    count += 1.0;
                }
                let at = pixel + centroid / count;
                let shown = match slots[s] {
                    NOTHING => self.sky(at),
                    slot => self.surface(slot, at),
                };
                // Clamped as a target clamps each sample before it takes the mean.
                colour += shown.clamp(Vec3::ZERO, Vec3::ONE) * (count as f32 / N as f32);
            }
            out.copy_from_slice(&[
                self.encoder.byte(colour.x),
                self.encoder.byte(colour.y),
                self.encoder.byte(colour.z),
                255,
            ]);
        }
    }

    /// Picture coordinates from -1 to 1, y up.
    fn ndc(&self, pixel: DVec2) -> DVec2 {
        let size = DVec2::new(f64::from(self.frame.size_px[0]), f64::from(self.frame.size_px[1]));
        DVec2::new(2.0 * pixel.x / size.x - 1.0, 1.0 - 2.0 * pixel.y / size.y)
    }

    fn sky(&self, pixel: DVec2) -> Vec3 {
        let at = self.ndc(pixel).as_vec2();
        let ray = rgb(self.frame.ray_forward) + rgb(self.frame.ray_right) * at.x + rgb(self.frame.ray_up) * at.y;
        sky_colour(self.frame, ray.normalize())
    }

    fn surface(&self, slot: u32, pixel: DVec2) -> Vec3 {
        let corners = self.buffers.triangles()[slot as usize].map(|corner| corner as usize);
        let placed = corners.map(|corner| &self.vertices[corner]);
        let stored = corners.map(|corner| &self.buffers.vertices()[corner]);
        let Some(shares) = Shares::new(placed.map(|v| v.clip)) else { return rgb(self.frame.horizon) };
        // on the grid of sub-pixels a small triangle may hold a sample that its true corners do not
        let b = shares.at(self.ndc(pixel)).as_vec3().max(Vec3::ZERO);
        let b = b / b.element_sum();
        let from_eye = mix(b, placed.map(|v| v.from_eye));
        let underside = shares.over_depth.determinant() < 0.0;
        let normal = if self.frame.flat != 0 {
            flat_normal(placed.map(|v| v.from_eye))
        } else {
            mix(b, stored.map(|v| v.normal())).try_normalize().unwrap_or(Vec3::Z)
        };
        let footprint = || {
            let across = mix(shares.at(self.ndc(pixel + DVec2::X)).as_vec3(), placed.map(|v| v.from_eye));
            let down = mix(shares.at(self.ndc(pixel + DVec2::Y)).as_vec3(), placed.map(|v| v.from_eye));
            [across - from_eye, down - from_eye]
        };
        let local = from_eye + rgb(self.frame.eye);
        let albedo = water_colour(self.frame, self.albedo(b, stored, local, normal, footprint), local.z);
        let colour = surface_colour(self.frame, albedo, from_eye, normal, underside);
        if self.frame.wire[3] <= 0.0 {
            return colour;
        }
        let [across, down] = [DVec2::X, DVec2::Y].map(|step| {
            let ahead = shares.at(self.ndc(pixel + 0.5 * step));
            (ahead - shares.at(self.ndc(pixel - 0.5 * step))).as_vec3()
        });
        let slope = Vec3::from_array([0, 1, 2].map(|i| Vec2::new(across[i], down[i]).length()));
        let share = wire_share(b, slope, self.frame.wire_width_px, self.frame.wire[3]);
        colour.lerp(rgb(self.frame.wire), share)
    }

    fn albedo(
        &self,
        b: Vec3,
        corners: [&GpuVertex; 3],
        local: Vec3,
        normal: Vec3,
        footprint: impl Fn() -> [Vec3; 2],
    ) -> Vec3 {
        let frame = self.frame;
        if frame.colour == COLOUR_PLAIN {
            return rgb(frame.plain);
        }
        if frame.colour == COLOUR_VERTEX {
            return mix(b, corners.map(|v| Vec3::from_array(v.colour().map(|c| self.decode[usize::from(c)]))));
        }
        if frame.colour == COLOUR_LEVEL {
            let level = b.dot(Vec3::from_array(corners.map(|v| v.level() as f32)));
            return ramp_colour(frame, level * frame.ramp_per_level);
        }
        if frame.colour == COLOUR_SLOPE {
            return ramp_colour(frame, (normal.z.abs().min(1.0).acos() - frame.ramp_start) * frame.ramp_scale);
        }
        if frame.colour == COLOUR_ASPECT {
            return aspect_colour(normal);
        }
        let tint = ramp_colour(frame, (local.z - frame.ramp_start) * frame.ramp_scale);
        let (COLOUR_DRAPE, Some(drape)) = (frame.colour, self.drape) else { return tint };
        let [u, v] = [rgb(frame.drape_u), rgb(frame.drape_v)];
        let at = local.truncate().extend(1.0);
        let uv = Vec2::new(u.dot(at), v.dot(at));
        if uv.min_element() < 0.0 || uv.max_element() > 1.0 {
            return tint;
        }
        let full = drape.levels()[0].dimensions();
        let spread = footprint().map(|d| {
            let ground = d.truncate().extend(0.0);
            Vec2::new(u.dot(ground) * full.0 as f32, v.dot(ground) * full.1 as f32).length()
        });
        let image = self.image(drape, uv, spread[0].max(spread[1]).max(1.0).log2());
        tint.lerp(image.truncate(), image.w)
    }

    /// Linear colour and opacity of an image, between two of its halvings.
    fn image(&self, drape: &Drape, uv: Vec2, halvings: f32) -> Vec4 {
        let last = drape.levels().len() - 1;
        let finer = (halvings as usize).min(last);
        let colour = self.bilinear(&drape.levels()[finer], uv);
        colour.lerp(self.bilinear(&drape.levels()[(finer + 1).min(last)], uv), (halvings - finer as f32).min(1.0))
    }

    fn bilinear(&self, image: &RgbaImage, uv: Vec2) -> Vec4 {
        let (width, height) = image.dimensions();
        let at = uv * Vec2::new(width as f32, height as f32) - 0.5;
        let (floor, part) = (at.floor(), at - at.floor());
        let texel = |dx: f32, dy: f32| {
            let x = (floor.x + dx).clamp(0.0, (width - 1) as f32) as u32;
            let y = (floor.y + dy).clamp(0.0, (height - 1) as f32) as u32;
            let [r, g, b, a] = image.get_pixel(x, y).0;
            let [r, g, b] = [r, g, b].map(|v| self.decode[usize::from(v)]);
            Vec4::new(r, g, b, f32::from(a) / 255.0)
        };
        let upper = texel(0.0, 0.0).lerp(texel(1.0, 0.0), part.x);
        upper.lerp(texel(0.0, 1.0).lerp(texel(1.0, 1.0), part.x), part.y)
    }
}

impl Shares {
    fn new(clip: [Vec3; 3]) -> Option<Self> {
        let columns = clip.map(|c| c.as_dvec3());
        let clip_from_shares = DMat3::from_cols(columns[0], columns[1], columns[2]);
        let determinant = clip_from_shares.determinant();
        (determinant != 0.0 && determinant.is_finite()).then(|| Self { over_depth: clip_from_shares.inverse() })
    }

    fn at(&self, ndc: DVec2) -> DVec3 {
        let shares = self.over_depth * ndc.extend(1.0);
        shares / shares.element_sum()
    }
}

/// The normal of a triangle's plane on the side from which its corners run counter-clockwise.
fn flat_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Z)
}

fn mix(b: Vec3, corners: [Vec3; 3]) -> Vec3 {
    corners[0] * b.x + corners[1] * b.y + corners[2] * b.z
}
