//! Pages that wait on the disk, packed lightly.

use yamanami_core::{ClusterPage, ClusterVertex};
use yamanami_io::IoError;
use yamanami_io::scratch::Scratch;

/// Bytes of a vertex: three doubles, three singles, three bytes.
const VERTEX_BYTES: usize = 24 + 12 + 3;

/// Bytes packed at once.
const BLOCK_BYTES: usize = 4 << 20;

/// Appends pages to a stream.
pub(super) fn append(scratch: &Scratch, stream: usize, pages: &[ClusterPage]) -> Result<(), IoError> {
    let mut raw = Vec::with_capacity(BLOCK_BYTES + (1 << 16));
    for page in pages {
        for count in [page.group as usize, page.vertices.len(), page.removed.len(), page.triangles.len()] {
            raw.extend((count as u32).to_le_bytes());
        }
        for vertex in &page.vertices {
            vertex.position_m.iter().for_each(|x| raw.extend(x.to_le_bytes()));
            vertex.normal.iter().for_each(|x| raw.extend(x.to_le_bytes()));
            raw.extend(vertex.colour);
        }
        page.removed.iter().for_each(|v| raw.extend(v.to_le_bytes()));
        page.triangles.as_flattened().iter().for_each(|v| raw.extend(v.to_le_bytes()));
        if raw.len() >= BLOCK_BYTES {
            flush(scratch, stream, &mut raw)?;
        }
    }
    flush(scratch, stream, &mut raw)
}

fn flush(scratch: &Scratch, stream: usize, raw: &mut Vec<u8>) -> Result<(), IoError> {
    scratch.append_packed(stream, raw)?;
    raw.clear();
    Ok(())
}

/// The pages of a stream.
pub(super) fn take(scratch: &Scratch, stream: usize) -> Result<Vec<ClusterPage>, IoError> {
    let raw = scratch.read_packed(stream)?;
    let mut pages = Vec::new();
    let mut rest = raw.as_slice();
    // what was written a moment ago is whole
    while !rest.is_empty() {
        let head = words(&mut rest, 4);
        let (vertices, removed, triangles) = (head[1] as usize, head[2] as usize, head[3] as usize);
        let (packed, more) = rest.split_at(VERTEX_BYTES * vertices);
        rest = more;
        pages.push(ClusterPage {
            group: head[0],
            vertices: packed.chunks_exact(VERTEX_BYTES).map(vertex).collect(),
            removed: words(&mut rest, removed),
            triangles: words(&mut rest, 3 * triangles).chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        });
    }
    Ok(pages)
}

fn words(rest: &mut &[u8], count: usize) -> Vec<u32> {
    let (some, more) = rest.split_at(4 * count);
    *rest = more;
    some.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

fn vertex(bytes: &[u8]) -> ClusterVertex {
    let double = |at: usize| f64::from_le_bytes(std::array::from_fn(|k| bytes[at + k]));
    let single = |at: usize| f32::from_le_bytes(std::array::from_fn(|k| bytes[at + k]));
    ClusterVertex {
        position_m: [0, 8, 16].map(double),
        normal: [24, 28, 32].map(single),
        colour: [36, 37, 38].map(|at| bytes[at]),
    }
}
