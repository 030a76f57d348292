//! STL, binary and text. Written in binary; corners at equal positions become one vertex when reading.
//!
//! STL holds single precision only. Where coordinates are large beside the mesh (projected ones are), they are written
//! relative to an origin that the header states, and that reading adds again.

use super::{MeshMeta, one_line};
use crate::IoError;
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::io::Write;
use std::path::Path;
use yamanami_core::TriangleMesh;

const HEADER: usize = 80;
const FACET: usize = 50;
/// How our own header starts; not with `solid`, which would be text.
const MARK: &str = "yamanami STL, metres, origin ";

pub(super) fn write(out: &mut dyn Write, mesh: &TriangleMesh, meta: &MeshMeta) -> std::io::Result<()> {
    let facets = u32::try_from(mesh.triangles.len())
        .map_err(|_| std::io::Error::other("an STL file holds at most 4294967295 facets"))?;
    let origin = origin(mesh);
    let title: String = one_line(&meta.title).chars().filter(char::is_ascii).collect();
    let text = format!("{MARK}{} {} {}; {title}", origin.x, origin.y, origin.z);
    let mut header = [b' '; HEADER];
    let used = text.len().min(HEADER);
    header[..used].copy_from_slice(&text.as_bytes()[..used]);
    out.write_all(&header)?;
    out.write_all(&facets.to_le_bytes())?;
    for t in 0..mesh.triangles.len() {
        let corners = mesh.corners(t).map(|p| (p - origin).as_vec3());
        let [a, b, c] = mesh.corners(t);
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or_default().as_vec3();
        for v in [normal, corners[0], corners[1], corners[2]] {
            for x in v.to_array() {
                out.write_all(&x.to_le_bytes())?;
            }
        }
        out.write_all(&[0; 2])?;
    }
    Ok(())
}

/// Whole metres near the middle of a mesh that lies far from zero, or zero.
fn origin(mesh: &TriangleMesh) -> DVec3 {
    let bounds = mesh.bounds();
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    // beyond 10^15 m, whole metres take more digits than the header has
    if farthest > 2.0 * bounds.diagonal() && farthest < 1e15 { bounds.centre().round() } else { DVec3::ZERO }
}

pub(super) fn read(name: &Path, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let text = bytes.trim_ascii_start().get(..5).is_some_and(|start| start.eq_ignore_ascii_case(b"solid"));
    let stated = bytes.get(HEADER..HEADER + 4).map(|n| u32::from_le_bytes([n[0], n[1], n[2], n[3]]) as usize);
    let length_fits = stated.is_some_and(|n| bytes.len() == HEADER + 4 + n * FACET);
    // some binary files start with 'solid' all the same; then their length gives them away
    if text && !length_fits {
        return read_text(name, bytes);
    }
    let body = bytes.get(HEADER + 4..).unwrap_or_default();
    let Some(facets) = stated.filter(|n| body.len() / FACET >= *n) else {
        let expected = match stated {
            Some(n) => format!("{n} facets of {FACET} bytes"),
            None => format!("a header of {} bytes, or 'solid'", HEADER + 4),
        };
        return Err(IoError::malformed(name, "facets", expected, format!("{} bytes after the header", body.len())));
    };
    let mut welder = Welder::new(stated_origin(&bytes[..HEADER]));
    for facet in body.chunks_exact(FACET).take(facets) {
        let number = |k: usize| f32::from_le_bytes([facet[k], facet[k + 1], facet[k + 2], facet[k + 3]]);
        let corner = |k: usize| Vec3::new(number(k), number(k + 4), number(k + 8));
        welder.facet([corner(12), corner(24), corner(36)]);
    }
    Ok(welder.mesh)
}

/// The origin that [`write`] stated in a header, else zero.
fn stated_origin(header: &[u8]) -> DVec3 {
    let parse = || {
        let text = std::str::from_utf8(header).ok()?.strip_prefix(MARK)?;
        let mut numbers = text.split_once(';')?.0.split(' ').map(str::parse::<f64>);
        Some(DVec3::new(numbers.next()?.ok()?, numbers.next()?.ok()?, numbers.next()?.ok()?))
    };
    parse().filter(|o| o.is_finite()).unwrap_or_default()
}

fn read_text(name: &Path, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let mut welder = Welder::new(DVec3::ZERO);
    let mut corners = Vec::new();
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
        let bad = |expected: &str| {
            let found: String = String::from_utf8_lossy(line).trim().chars().take(60).collect();
            IoError::malformed(name, format!("line {}", number + 1), expected, format!("'{found}'"))
        };
        let Some(word) = words.next() else { continue };
        match word.to_ascii_lowercase().as_slice() {
            b"vertex" => {
                let mut next = || std::str::from_utf8(words.next()?).ok()?.parse::<f32>().ok();
                let (Some(x), Some(y), Some(z)) = (next(), next(), next()) else {
                    return Err(bad("three numbers"));
                };
                corners.push(Vec3::new(x, y, z));
            }
            b"endloop" => {
                let [a, b, c] = corners[..] else {
                    return Err(bad(&format!("the end of 3 corners after {} of them", corners.len())));
                };
                welder.facet([a, b, c]);
                corners.clear();
            }
            b"solid" | b"facet" | b"outer" | b"endfacet" | b"endsolid" => {}
            _ => return Err(bad("a line of a text STL")),
        }
    }
    if !corners.is_empty() {
        return Err(IoError::malformed(name, "end of file", "'endloop'", format!("{} open corners", corners.len())));
    }
    Ok(welder.mesh)
}

/// Gives equal corners one number.
struct Welder {
    origin: DVec3,
    known: HashMap<[u32; 3], u32>,
    mesh: TriangleMesh,
}

impl Welder {
    fn new(origin: DVec3) -> Self {
        Self { origin, known: HashMap::new(), mesh: TriangleMesh::default() }
    }

    fn facet(&mut self, corners: [Vec3; 3]) {
        let triangle = corners.map(|p| {
            // adding zero makes -0 and 0 equal
            *self.known.entry((p + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert_with(|| {
                self.mesh.positions.push(self.origin + p.as_dvec3());
                self.mesh.positions.len() as u32 - 1
            })
        });
        self.mesh.triangles.push(triangle);
    }
}
