//! Vertices to where a file can have them, no two of them at one place that were not.

use super::codec::ClusterCodec;
use super::vertices::Packed;
use crate::IoError;
use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::ClusterPage;

/// Rounds the vertices of a model, page by page. Scans have slivers shorter than any quantum worth storing: a vertex whose
/// place is taken by another goes to the nearest one beside it that is free, so that no edge is lost.
#[derive(Debug)]
pub struct Rounding {
    codec: ClusterCodec,
    /// Who is at a place: where that vertex was before, bit by bit.
    taken: HashMap<[i32; 3], [u64; 3]>,
    max_error_m: f64,
}

impl Rounding {
    /// Rounding to the places of a codec.
    pub fn new(codec: ClusterCodec) -> Self {
        Self { codec, taken: HashMap::new(), max_error_m: 0.0 }
    }

    /// No vertex so far went further than this, metres.
    pub fn max_error_m(&self) -> f64 {
        self.max_error_m
    }

    /// Moves a page's vertices to where the file will have them.
    pub fn round(&mut self, page: &mut ClusterPage) -> Result<(), IoError> {
        for vertex in &mut page.vertices {
            let was = DVec3::from_array(vertex.position_m);
            let mut packed = self.codec.pack(vertex)?;
            packed.place = self.free_place(packed, was);
            self.taken.insert(packed.place, was.to_array().map(f64::to_bits));
            *vertex = self.codec.unpack(&packed)?;
            self.max_error_m = self.max_error_m.max(was.distance(DVec3::from_array(vertex.position_m)));
        }
        Ok(())
    }

    /// The place of a vertex, or the nearest free one beside it; its own if none is.
    fn free_place(&self, packed: Packed, was: DVec3) -> [i32; 3] {
        let bits = was.to_array().map(f64::to_bits);
        let is_free = |place: &[i32; 3]| self.taken.get(place).is_none_or(|other| *other == bits);
        if is_free(&packed.place) {
            return packed.place;
        }
        let beside = (0..27).map(|k| {
            let [x, y, z] = packed.place;
            [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]
        });
        let far = |place: &[i32; 3]| self.codec.position(*place).distance_squared(was);
        beside.filter(is_free).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(packed.place)
    }
}
