//! One block after the other, two at a time: read, reduced with its seams held, written as a piece.
//!
//! A block knows every face of its vertices, those between it and its neighbours too, and holds the vertices of these. So
//! what a collapse tests about a vertex that may go (the link, folds, borders) is what it would be in the whole mesh, and no two
//! blocks touch the same edge: joined, the pieces are a mesh if the source was one.

use super::numbering::Numbering;
use super::partition::Partition;
use super::pieces::Pieces;
use super::plan::AT_ONCE;
use super::{LargeOptions, collapse_options};
use crate::Error;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use yamanami_core::TriangleMesh;
use yamanami_io::IoError;
use yamanami_multires::collapse::{CollapseOptions, collapse};

/// Bytes read at a time.
const BUFFER: usize = 1 << 18;

/// What a worker keeps from block to block.
struct Desk {
    numbering: Numbering,
    buffer: Vec<u8>,
}

/// A block in memory.
struct Block {
    /// Its own vertices, in the order of the source, then those of other blocks that faces between need.
    mesh: TriangleMesh,
    /// How many are its own.
    own: usize,
    /// Own vertices on seams: number here and on the seams.
    seam: Vec<[u32; 2]>,
    locked: Vec<bool>,
    /// Faces that a collapse cannot take: those between it and others, and own ones with an edge on a seam.
    fixed: usize,
}

/// Reduces all blocks to about `goal` faces in sum, not counting what seams hold, and joins them.
pub(super) fn reduce_all(
    parts: &Partition,
    goal: u64,
    options: &LargeOptions,
    folder: &Path,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Pieces, Error> {
    let blocks = parts.blocks();
    let mut pieces = Pieces::create(folder, blocks, parts.has_colours())?;
    let own_faces: u64 = parts.own_faces.iter().sum();
    let share = goal as f64 / own_faces.max(1) as f64;
    let (next, done, has_failed) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
    let seams: Vec<Mutex<Result<Vec<[u32; 2]>, IoError>>> = (0..blocks).map(|_| Mutex::new(Ok(Vec::new()))).collect();
    let work = || {
        let mut desk = Desk { numbering: Numbering::new(parts.vertices), buffer: vec![0; BUFFER] };
        loop {
            let block = next.fetch_add(1, Ordering::Relaxed);
            if block >= blocks || has_failed.load(Ordering::Relaxed) {
                return;
            }
            let target = (parts.own_faces[block] as f64 * share).ceil() as usize;
            let result = reduce_one(parts, block, target, options, &pieces, &mut desk);
            has_failed.fetch_or(result.is_err(), Ordering::Relaxed);
            *seams[block].lock().unwrap_or_else(std::sync::PoisonError::into_inner) = result;
            progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / blocks as f32);
        }
    };
    // threads of their own, not tasks of the pool: a pool's thread that waits inside a collapse would start another block
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(work);
        }
    });
    let mut joints = Vec::with_capacity(blocks);
    for seam in seams {
        joints.push(seam.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)?);
    }
    join(parts, &mut pieces, &joints)?;
    Ok(pieces.finish())
}

/// Puts the faces between blocks between their pieces.
fn join(parts: &Partition, pieces: &mut Pieces, joints: &[Vec<[u32; 2]>]) -> Result<(), IoError> {
    let mut number = vec![0u32; parts.seam_positions.len()];
    for (joint, &first) in joints.iter().zip(pieces.number()) {
        for &[here, on_seam] in joint {
            number[on_seam as usize] = first + here;
        }
    }
    let mut triangles = Vec::with_capacity(BUFFER / 12);
    let mut buffer = vec![0; BUFFER];
    parts.each_triangle(parts.blocks(), &mut buffer, |t| {
        // a corner of a face between blocks is on a seam
        triangles.push(t.map(|v| parts.seam.rank(v).map_or(0, |rank| number[rank as usize])));
        if triangles.len() == triangles.capacity() {
            pieces.put_triangles(parts.blocks(), &triangles)?;
            triangles.clear();
        }
        Ok(())
    })?;
    pieces.put_triangles(parts.blocks(), &triangles)
}

/// Reduces a block and keeps the piece; gives its seam vertices: number in the piece and on the seams.
fn reduce_one(
    parts: &Partition,
    block: usize,
    target: usize,
    options: &LargeOptions,
    pieces: &Pieces,
    desk: &mut Desk,
) -> Result<Vec<[u32; 2]>, IoError> {
    let Block { mesh, own, seam, locked, fixed } = read(parts, block, desk)?;
    let quiet = |_: f32| ();
    let collapsed = collapse(
        &mesh,
        &CollapseOptions { locked: Some(&locked), ..collapse_options(options, (target + fixed) as u64, &quiet) },
    );
    let mut on_seam = vec![u32::MAX; own];
    for &[here, there] in &seam {
        on_seam[here as usize] = there;
    }
    // vertices of other blocks go again, with the faces that needed them
    let mut number = vec![u32::MAX; collapsed.mesh.positions.len()];
    let mut piece = TriangleMesh::default();
    let mut joints = Vec::with_capacity(seam.len());
    for (k, &source) in collapsed.source_vertex.iter().enumerate() {
        if source != u32::MAX && source as usize >= own {
            continue;
        }
        number[k] = piece.positions.len() as u32;
        if let Some(on_seam) = on_seam.get_mut(source as usize).filter(|s| **s != u32::MAX) {
            joints.push([number[k], *on_seam]);
            *on_seam = u32::MAX;
        }
        piece.positions.push(collapsed.mesh.positions[k]);
        piece.colours.extend(collapsed.mesh.colours.get(k));
    }
    let kept = |t: &[u32; 3]| {
        let corners = t.map(|v| number[v as usize]);
        (!corners.contains(&u32::MAX)).then_some(corners)
    };
    piece.triangles.extend(collapsed.mesh.triangles.iter().filter_map(kept));
    // seam vertices that lost all faces of this block still have those between
    for &[here, there] in &seam {
        if on_seam[here as usize] != u32::MAX {
            joints.push([piece.positions.len() as u32, there]);
            piece.positions.push(mesh.positions[here as usize]);
            piece.colours.extend(mesh.colours.get(here as usize));
        }
    }
    drop((mesh, collapsed));
    pieces.put(block, &piece)?;
    Ok(joints)
}

/// Reads a block.
fn read(parts: &Partition, block: usize, desk: &mut Desk) -> Result<Block, IoError> {
    let Desk { numbering, buffer } = desk;
    let own = parts.block_vertices(block);
    let mut mesh = TriangleMesh::default();
    let (mut locked, mut seam) = (Vec::with_capacity(own), Vec::new());
    mesh.positions.reserve_exact(own);
    mesh.triangles.reserve_exact(parts.block_faces(block));
    numbering.clear();
    parts.each_vertex(block, buffer, |vertex, p, colour| {
        numbering.insert(vertex);
        let rank = parts.seam.rank(vertex);
        locked.push(rank.is_some());
        seam.extend(rank.map(|rank| [mesh.positions.len() as u32, rank]));
        mesh.positions.push(p);
        if parts.has_colours() {
            mesh.colours.push(colour);
        }
    })?;
    numbering.count();
    let mut others: HashMap<u32, u32> = HashMap::new();
    let mut fixed = 0;
    parts.each_triangle(block, buffer, |t| {
        let corners = t.map(|vertex| {
            numbering.rank(vertex).unwrap_or_else(|| {
                *others.entry(vertex).or_insert_with(|| {
                    let rank = parts.seam.rank(vertex).unwrap_or_default() as usize;
                    mesh.positions.push(parts.seam_positions[rank]);
                    mesh.colours.extend(parts.seam_colours.get(rank));
                    locked.push(true);
                    mesh.positions.len() as u32 - 1
                })
            })
        });
        fixed += usize::from(corners.iter().filter(|&&v| locked[v as usize]).count() >= 2);
        mesh.triangles.push(corners);
        Ok(())
    })?;
    Ok(Block { mesh, own, seam, locked, fixed })
}
