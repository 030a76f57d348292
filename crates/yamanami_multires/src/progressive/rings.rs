//! The rings of all vertices of a level's mesh, side by side.

use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::SemiRegular;

/// The ends of the edges whose midpoints are the vertices that come with a level from 1 on, in their order.
pub(super) fn ends(mesh: &SemiRegular, level: u32) -> Vec<[u32; 2]> {
    let (edges, faces) = (mesh.base().edges().len(), mesh.base().triangles().len());
    let half = 1u32 << (level - 1);
    let run = (half * (half - 1) / 2) as usize;
    let mut all = vec![[0; 2]; edges * half as usize + faces * 3 * run];
    let (on_edges, inside) = all.split_at_mut(edges * half as usize);
    on_edges.par_chunks_mut(half as usize).enumerate().for_each(|(edge, own)| {
        for (i, ends) in (0..).zip(own) {
            *ends = [2 * i, 2 * i + 2].map(|at| mesh.edge_vertex(level, edge as u32, at));
        }
    });
    if run > 0 {
        inside.par_chunks_mut(3 * run).enumerate().for_each(|(face, own)| {
            let mut own = own.iter_mut();
            let mut put = |ends: [[u32; 2]; 2]| {
                if let Some(next) = own.next() {
                    *next = ends.map(|at| mesh.vertex(level, face as u32, at));
                }
            };
            let rows = || (0..half - 1).flat_map(|row| (0..half - 1 - row).map(move |column| [2 * column, 2 * row]));
            rows().for_each(|[a, b]| put([[a, b + 2], [a + 2, b + 2]]));
            rows().for_each(|[a, b]| put([[a + 2, b], [a, b + 2]]));
            rows().for_each(|[a, b]| put([[a + 2, b + 2], [a + 2, b]]));
        });
    }
    all
}

/// Vertices whose rings are found at a time.
const RUN: usize = 4096;

/// Sizes of rings, whether they are closed, and their vertices.
type Part = (Vec<(u32, bool)>, Vec<u32>);

/// Rings, counter-clockwise.
#[derive(Debug)]
pub(super) struct Rings {
    /// Where each vertex's ring begins, twice, plus whether it is closed.
    begins: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Rings {
    pub(super) fn new(mesh: &SemiRegular, level: u32) -> Self {
        let count = mesh.vertex_count(level) as usize;
        let parts: Vec<Part> = (0..count.div_ceil(RUN))
            .into_par_iter()
            .map(|run| {
                let (mut sizes, mut neighbours, mut ring) =
                    (Vec::with_capacity(RUN), Vec::with_capacity(6 * RUN), Vec::new());
                for v in run * RUN..count.min((run + 1) * RUN) {
                    let is_closed = mesh.ring(level, v as u32, &mut ring);
                    sizes.push((ring.len() as u32, is_closed));
                    neighbours.extend_from_slice(&ring);
                }
                (sizes, neighbours)
            })
            .collect();
        let mut begins = Vec::with_capacity(count + 1);
        let mut neighbours = Vec::with_capacity(6 * count);
        let mut begin = 0;
        for (sizes, part) in parts {
            for (size, is_closed) in sizes {
                begins.push(2 * begin + u32::from(is_closed));
                begin += size;
            }
            neighbours.extend(part);
        }
        begins.push(2 * begin);
        Self { begins, neighbours }
    }

    /// A vertex's neighbours, and whether they go all around.
    #[inline]
    pub(super) fn of(&self, vertex: u32) -> (&[u32], bool) {
        let [from, to] = [vertex as usize, vertex as usize + 1].map(|v| self.begins[v]);
        (&self.neighbours[(from / 2) as usize..(to / 2) as usize], from % 2 == 1)
    }

    /// The normals of the vertices, as long as the areas around them.
    pub(super) fn normals(&self, positions: &[DVec3]) -> Vec<DVec3> {
        let normal = |v: usize| {
            let (ring, is_closed) = self.of(v as u32);
            let at = |k: usize| positions[ring[k] as usize] - positions[v];
            let mut sum = DVec3::ZERO;
            let mut last = at(0);
            let first = last;
            for k in 1..ring.len() {
                let next = at(k);
                sum += last.cross(next);
                last = next;
            }
            if is_closed { sum + last.cross(first) } else { sum }
        };
        (0..self.begins.len() - 1).into_par_iter().with_min_len(RUN).map(normal).collect()
    }
}
