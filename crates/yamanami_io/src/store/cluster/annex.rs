//! What a TIN's file knew beside its visible triangles: name, breaklines, hidden faces, vertices that no face uses.

use crate::store::bits::{put_varint, take, take_varint};
use crate::store::frame::decompress;
use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::{Breakline, BreaklineKind, Tin, TriangleMesh};

/// Most bytes of an annex, unpacked.
const MOST_BYTES: usize = 1 << 30;

/// What is kept of a TIN beside the triangles that are shown.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TinAnnex {
    /// Name of the surface.
    pub name: String,
    /// Its breaklines.
    pub breaklines: Vec<Breakline>,
    /// Hidden faces and the vertices that no visible face uses.
    pub unseen: TriangleMesh,
}

impl TinAnnex {
    /// The annex of a TIN.
    pub fn of(tin: &Tin) -> Self {
        let positions = &tin.mesh.positions;
        let mut is_seen = vec![false; positions.len()];
        tin.mesh.triangles.as_flattened().iter().for_each(|&v| is_seen[v as usize] = true);
        let mut unseen = TriangleMesh::default();
        let mut number: HashMap<u32, u32> = HashMap::new();
        let mut use_vertex = |v: u32, positions_out: &mut Vec<DVec3>| {
            *number.entry(v).or_insert_with(|| {
                positions_out.push(positions[v as usize]);
                positions_out.len() as u32 - 1
            })
        };
        for face in &tin.hidden {
            let face = face.map(|v| use_vertex(v, &mut unseen.positions));
            unseen.triangles.push(face);
        }
        for v in (0..positions.len() as u32).filter(|&v| !is_seen[v as usize]) {
            use_vertex(v, &mut unseen.positions);
        }
        Self { name: tin.name.clone(), breaklines: tin.breaklines.clone(), unseen }
    }

    /// The whole TIN: `mesh` with what this adds, vertices at one place being one.
    pub fn complete(&self, mesh: TriangleMesh) -> Tin {
        let mut tin = Tin::of_mesh(self.name.clone(), mesh);
        let bits = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
        if !self.unseen.positions.is_empty() {
            let mut at: HashMap<[u64; 3], u32> =
                tin.mesh.positions.iter().zip(0..).map(|(&p, v)| (bits(p), v)).collect();
            let number: Vec<u32> = (self.unseen.positions.iter())
                .map(|&p| {
                    *at.entry(bits(p)).or_insert_with(|| {
                        tin.mesh.positions.push(p);
                        tin.mesh.positions.len() as u32 - 1
                    })
                })
                .collect();
            tin.hidden = self.unseen.triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
        }
        tin.breaklines = self.breaklines.clone();
        tin
    }

    pub(super) fn to_bytes(&self) -> std::io::Result<Vec<u8>> {
        let mut raw = Vec::new();
        put_text(&mut raw, &self.name);
        put_varint(&mut raw, self.breaklines.len() as u64);
        for line in &self.breaklines {
            put_text(&mut raw, &line.name);
            raw.push(line.kind as u8);
            put_points(&mut raw, &line.points);
        }
        put_points(&mut raw, &self.unseen.positions);
        put_varint(&mut raw, self.unseen.triangles.len() as u64);
        raw.extend(self.unseen.triangles.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
        zstd::encode_all(&raw[..], 9)
    }

    pub(super) fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let raw = decompress(bytes, MOST_BYTES)?;
        let mut raw = raw.as_slice();
        let name = take_text(&mut raw)?;
        let lines = take_varint(&mut raw)?;
        let mut breaklines = Vec::new();
        for _ in 0..lines {
            let name = take_text(&mut raw)?;
            let kind = match take(&mut raw, 1)?[0] {
                0 => BreaklineKind::Hard,
                1 => BreaklineKind::Soft,
                2 => BreaklineKind::Boundary,
                _ => return None,
            };
            breaklines.push(Breakline { name, kind, points: take_points(&mut raw)? });
        }
        let positions = take_points(&mut raw)?;
        let count = usize::try_from(take_varint(&mut raw)?).ok()?;
        let corners = take(&mut raw, count.checked_mul(12)?)?;
        let corner = |k: usize| u32::from_le_bytes([corners[k], corners[k + 1], corners[k + 2], corners[k + 3]]);
        let triangles: Vec<[u32; 3]> = (0..count).map(|t| [0, 4, 8].map(|k| corner(12 * t + k))).collect();
        let is_sound = triangles.as_flattened().iter().all(|&v| (v as usize) < positions.len());
        (is_sound && raw.is_empty()).then(|| Self { name, breaklines, unseen: TriangleMesh::new(positions, triangles) })
    }
}

fn put_text(out: &mut Vec<u8>, text: &str) {
    put_varint(out, text.len() as u64);
    out.extend(text.as_bytes());
}

fn take_text(bytes: &mut &[u8]) -> Option<String> {
    let length = usize::try_from(take_varint(bytes)?).ok()?;
    String::from_utf8(take(bytes, length)?.to_vec()).ok()
}

fn put_points(out: &mut Vec<u8>, points: &[DVec3]) {
    put_varint(out, points.len() as u64);
    out.extend(points.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes));
}

fn take_points(bytes: &mut &[u8]) -> Option<Vec<DVec3>> {
    let count = usize::try_from(take_varint(bytes)?).ok()?;
    let raw = take(bytes, count.checked_mul(24)?)?;
    let number = |at: usize| f64::from_le_bytes(std::array::from_fn(|k| raw[at + k]));
    let points: Vec<DVec3> = (0..count).map(|i| DVec3::from_array([0, 8, 16].map(|k| number(24 * i + k)))).collect();
    points.iter().all(|p| p.is_finite()).then_some(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tin() -> Tin {
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.25);
        let mesh = TriangleMesh::new(
            vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0), at(7.0, 7.0)],
            vec![[0, 1, 2]],
        );
        let line =
            Breakline { name: "岸".into(), kind: BreaklineKind::Soft, points: vec![at(0.0, 0.0), at(1.0, 0.0)] };
        Tin { name: "a".into(), mesh, hidden: vec![[1, 3, 2]], breaklines: vec![line], ..Tin::default() }
    }

    #[test]
    fn what_is_unseen_comes_back() {
        let tin = tin();
        let annex = TinAnnex::of(&tin);
        assert_eq!(TinAnnex::from_bytes(&annex.to_bytes().unwrap()), Some(annex.clone()));
        let visible = TriangleMesh::new(tin.mesh.positions[..3].to_vec(), vec![[0, 1, 2]]);
        assert_eq!(annex.complete(visible), tin);
    }

    proptest! {
        #[test]
        fn damaged_annexes_are_refused_quietly(at in 0usize..200, byte in any::<u8>(), raw in proptest::collection::vec(any::<u8>(), 0..60)) {
            let mut bytes = TinAnnex::of(&tin()).to_bytes().unwrap();
            let at = at % bytes.len();
            bytes[at] = byte;
            let _ = TinAnnex::from_bytes(&bytes);
            let _ = TinAnnex::from_bytes(&zstd::encode_all(&raw[..], 1).unwrap());
        }
    }
}
