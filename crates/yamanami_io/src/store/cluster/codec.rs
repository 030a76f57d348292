//! One page of clusters to bytes and back.

use super::exact::Exact;
use super::ids;
use super::meta::ClusterMeta;
use super::triangles;
use super::vertices::{self, OTHERS, Packed, RANK, REMOVED};
use crate::IoError;
use crate::store::bits::{BitReader, BitWriter, put_varint, take, take_varint};
use crate::store::family::{FAMILY, Member};
use crate::store::model::CONTEXTS;
use crate::store::rans::{Decoder, Encoder};
use crate::store::residuals::{Coded, USUAL_SHAPE, join_row, read_members};
use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::{ClusterPage, ClusterVertex, GroupId, VertexId};

/// Turns pages of a model into bytes and back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusterCodec {
    origin_m: [f64; 3],
    quantum_m: f64,
    has_colours: bool,
    /// How a TIN's coordinates come back bit for bit.
    exact: Option<Exact>,
}

/// What is known of a page before it is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageShape {
    /// Whose page it is.
    pub group: GroupId,
    /// Number of its first vertex.
    pub first_vertex: VertexId,
    /// Vertices that it brings.
    pub vertices: u32,
    /// Triangles of all its clusters.
    pub triangles: u64,
    /// Triangles of the clusters that it takes away.
    pub replaced_triangles: u64,
}

/// Most triangles of a page: what 65,536 clusters of the base mesh of 128 triangles each are.
const MOST_TRIANGLES: u64 = 1 << 23;
/// A triangle takes at least three bits of probabilities that reach 0.995 at most.
const MOST_TRIANGLES_A_BYTE: usize = 512;

impl ClusterCodec {
    /// The codec of a model's pages.
    pub fn new(meta: &ClusterMeta) -> Self {
        let origin_m = meta.bounds.min.to_array();
        let exact = meta.tin.as_ref().map(|tin| Exact::new(tin.snap, origin_m));
        Self { origin_m, quantum_m: meta.quantum_m, has_colours: meta.has_colours, exact }
    }

    /// A vertex as whole numbers.
    pub(super) fn pack(&self, vertex: &ClusterVertex) -> Result<Packed, IoError> {
        let place = match &self.exact {
            Some(exact) => exact.steps(vertex.position_m),
            None => self.steps(vertex.position_m),
        };
        let place = place.ok_or_else(|| bad("a vertex near the model", format!("one at {:?}", vertex.position_m)))?;
        Ok(Packed::of(vertex, place))
    }

    /// The quanta of a place; `None` when it is too far out or no number.
    fn steps(&self, position_m: [f64; 3]) -> Option<[i32; 3]> {
        let mut place = [0; 3];
        for axis in 0..3 {
            let steps = ((position_m[axis] - self.origin_m[axis]) / self.quantum_m).round();
            if steps.is_nan() || steps.abs() >= f64::from(1 << 30) {
                return None;
            }
            place[axis] = steps as i32;
        }
        Some(place)
    }

    /// The vertex of whole numbers.
    pub(super) fn unpack(&self, packed: &Packed) -> Result<ClusterVertex, IoError> {
        let vertex = packed.vertex(self.position(packed.place).to_array());
        let mut vertex = vertex.ok_or_else(|| bad("a vertex near the model", format!("{:?}", packed.place)))?;
        if !self.has_colours {
            vertex.colour = [255; 3];
        }
        Ok(vertex)
    }

    /// Where a place lies, metres.
    pub(super) fn position(&self, place: [i32; 3]) -> DVec3 {
        if let Some(exact) = &self.exact {
            return DVec3::from_array(exact.position(place));
        }
        DVec3::from_array(self.origin_m) + DVec3::from_array(place.map(f64::from)) * self.quantum_m
    }

    /// Codes a page whose own vertices are numbered from `first_vertex` on. Pure: pages can be coded on any thread.
    pub fn encode(&self, page: &ClusterPage, first_vertex: VertexId) -> Result<Vec<u8>, IoError> {
        let own = u32::try_from(page.vertices.len())
            .map_err(|_| bad("fewer vertices in a page", page.vertices.len().to_string()))?;
        if !page.removed.is_sorted_by(|a, b| a < b) {
            return Err(bad("vertices taken away in ascending order", "others".to_owned()));
        }
        let packed: Vec<Packed> = page.vertices.iter().map(|v| self.pack(v)).collect::<Result<_, _>>()?;
        let mut others = Vec::new();
        let mut places: HashMap<VertexId, u32> = HashMap::new();
        let local: Vec<[u32; 3]> = page
            .triangles
            .iter()
            .map(|corners| {
                corners.map(|id| match id.checked_sub(first_vertex) {
                    Some(place) if place < own => place,
                    _ => *places.entry(id).or_insert_with(|| {
                        others.push(id);
                        own + others.len() as u32 - 1
                    }),
                })
            })
            .collect();
        let (triangle_bytes, placings) = triangles::encode(own, &local);
        let is_flat = vertices::without_own_triangle(packed.len(), &local);
        let mut coded = Coded::new(0, 0);
        let mut sorted = others.clone();
        sorted.sort_unstable();
        let mut runs = Vec::new();
        ids::split(&sorted, &mut runs, &mut coded.residuals);
        coded.contexts.resize(coded.residuals.len(), OTHERS);
        ids::split(&page.removed, &mut runs, &mut coded.residuals);
        coded.contexts.resize(coded.residuals.len(), REMOVED);
        let ranks: Vec<u32> = others.iter().map(|id| sorted.partition_point(|other| other < id) as u32).collect();
        differences(&ranks, &mut coded.residuals);
        coded.contexts.resize(coded.residuals.len(), RANK);
        vertices::contexts(&placings, &is_flat, self.has_colours, &mut coded.contexts);
        vertices::residuals(&packed, &placings, &local, &is_flat, self.has_colours, &mut coded.residuals);
        let mut coded = coded.in_one_row();
        let mut bits = BitWriter::default();
        coded.choose_members(&mut bits);
        coded.put_plain(&mut bits);
        let mut encoder = Encoder::new();
        coded.put_symbols(&mut encoder);
        let plain = bits.finish();
        let mut bytes = Vec::new();
        put_varint(&mut bytes, others.len() as u64);
        put_varint(&mut bytes, page.removed.len() as u64);
        put_varint(&mut bytes, triangle_bytes.len() as u64);
        put_varint(&mut bytes, plain.len() as u64);
        let rests = self.exact.map(|exact| exact.rests(&page.vertices, &packed));
        if let Some(rests) = &rests {
            put_varint(&mut bytes, rests.len() as u64);
        }
        bytes.extend(runs);
        bytes.extend(triangle_bytes);
        bytes.extend(plain);
        bytes.extend(rests.unwrap_or_default());
        bytes.extend(encoder.finish());
        Ok(bytes)
    }

    /// Reads a page from its bytes; says what is wrong when it cannot be that.
    ///
    /// Safe on any bytes: never panics, and allocates in proportion to what the shape and the bytes hold.
    pub fn decode(&self, shape: PageShape, mut bytes: &[u8]) -> Result<ClusterPage, &'static str> {
        let lengths = [(); 4].map(|()| take_varint(&mut bytes));
        let [Some(others), Some(removed), Some(triangle_bytes), Some(plain)] = lengths else {
            return Err("the lengths break off");
        };
        let rests = match self.exact {
            Some(_) => take_varint(&mut bytes).ok_or("the lengths break off")?,
            None => 0,
        };
        // every triangle of a page brings at most three corners of others, every one replaced frees at most three
        if others > 3 * shape.triangles || removed > 3 * shape.replaced_triangles {
            return Err("there are more vertices than triangles have corners");
        }
        if u64::from(shape.vertices) > 3 * shape.triangles || shape.triangles > MOST_TRIANGLES {
            return Err("it has more vertices or triangles than a page may have");
        }
        let (others, removed) = (others as u32, removed as u32);
        let runs = ids::take_runs(&mut bytes, others).zip(ids::take_runs(&mut bytes, removed));
        let (other_runs, removed_runs) = runs.ok_or("the runs break off")?;
        let own = shape.vertices as usize;
        let mut part = |length: u64| usize::try_from(length).ok().and_then(|n| take(&mut bytes, n));
        let triangle_bytes = part(triangle_bytes).ok_or("the triangles break off")?;
        let plain = part(plain).ok_or("the vertices break off")?;
        let rests = part(rests).ok_or("the vertices break off")?;
        let count = shape.triangles as usize;
        if count / MOST_TRIANGLES_A_BYTE > triangle_bytes.len() {
            return Err("the triangles break off");
        }
        let (local, placings) =
            triangles::decode(shape.vertices, others, count, triangle_bytes).ok_or("the triangles are damaged")?;
        let is_flat = vertices::without_own_triangle(own, &local);
        let mut contexts = vec![OTHERS; ids::residual_count(&other_runs)];
        contexts.resize(contexts.len() + ids::residual_count(&removed_runs), REMOVED);
        contexts.resize(contexts.len() + others as usize, RANK);
        vertices::contexts(&placings, &is_flat, self.has_colours, &mut contexts);
        let values = read_residuals(&contexts, plain, bytes).ok_or("the vertices are damaged")?;
        let (other_values, rest) = values.split_at(ids::residual_count(&other_runs));
        let (removed_values, rest) = rest.split_at(ids::residual_count(&removed_runs));
        let (ranks, rest) = rest.split_at(others as usize);
        let sorted = ids::join(&other_runs, other_values).ok_or("a vertex number is out of bounds")?;
        let removed = ids::join(&removed_runs, removed_values).ok_or("a vertex number is out of bounds")?;
        let other_ids: Option<Vec<VertexId>> =
            sums(ranks).into_iter().map(|rank| sorted.get(rank as usize).copied()).collect();
        let other_ids = other_ids.ok_or("a vertex number is out of bounds")?;
        let packed = vertices::restore(own, &placings, &local, &is_flat, self.has_colours, rest);
        let vertices: Option<Vec<_>> = packed.iter().map(|p| p.vertex(self.position(p.place).to_array())).collect();
        let mut vertices = vertices.ok_or("a vertex is out of bounds")?;
        if let Some(exact) = &self.exact {
            exact.add_rests(rests, &mut vertices).ok_or("the vertices are damaged")?;
        }
        let id = |v: u32| {
            if v < shape.vertices { shape.first_vertex + v } else { other_ids[(v - shape.vertices) as usize] }
        };
        Ok(ClusterPage { group: shape.group, vertices, removed, triangles: local.iter().map(|t| t.map(id)).collect() })
    }
}

fn bad(expected: &str, given: String) -> IoError {
    IoError::BadRequest { what: "page of clusters".into(), expected: expected.into(), given }
}

/// Numbers as differences less one, the first from -1, modulo 2^32.
fn differences(numbers: &[u32], out: &mut Vec<i32>) {
    let before = std::iter::once(&u32::MAX).chain(numbers);
    out.extend(numbers.iter().zip(before).map(|(n, last)| n.wrapping_sub(*last).wrapping_sub(1) as i32));
}

/// Undoes [`differences`].
fn sums(differences: &[i32]) -> Vec<u32> {
    let mut last = u32::MAX;
    let mut next = |&d: &i32| {
        last = last.wrapping_add(d as u32).wrapping_add(1);
        last
    };
    differences.iter().map(&mut next).collect()
}

/// The residuals of known contexts.
fn read_residuals(contexts: &[u8], plain: &[u8], bytes: &[u8]) -> Option<Vec<i32>> {
    let mut bits = BitReader::new(plain);
    let mut members = [Member::new(0, USUAL_SHAPE); CONTEXTS];
    read_members(&mut bits, &mut members)?;
    let begins: [u32; 64] = std::array::from_fn(|c| members[c.min(CONTEXTS - 1)].begin());
    let any_plain = members.iter().any(|m| m.plain_bits > 0);
    let mut decoder = Decoder::new(bytes)?;
    let mut symbols = vec![0i8; contexts.len()];
    decoder.row(contexts, &begins, &FAMILY.slots, &mut symbols);
    let mut values = vec![0i32; contexts.len()];
    join_row(&symbols, contexts, &members, any_plain, &mut bits, &mut values);
    (decoder.is_exhausted() && bits.is_exhausted()).then_some(values)
}
