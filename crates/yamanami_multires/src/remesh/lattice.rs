//! Where the vertices of a semi-regular mesh lie in its base triangles, and from there on the source.

use super::decimate::Decimated;
use super::source::{Place, Source};
use yamanami_core::{BaseFault, BaseMesh, Place as LatticePlace, SemiRegular};

/// The base mesh of what is left: base vertex by base vertex the source vertex, and the mesh.
pub(super) fn base_mesh(decimated: &Decimated, vertices: usize) -> Result<(Vec<u32>, BaseMesh), BaseFault> {
    let mut number = vec![u32::MAX; vertices];
    let mut kept = Vec::new();
    let mut base = Vec::new();
    for (_, corners) in decimated.left() {
        base.push(corners.map(|v| {
            let number = &mut number[v as usize];
            if *number == u32::MAX {
                *number = kept.len() as u32;
                kept.push(v);
            }
            *number
        }));
    }
    let mesh = BaseMesh::new(kept.len() as u32, base)?;
    Ok((kept, mesh))
}

/// The places on the source of all vertices up to a level.
pub(super) fn places(
    source: &Source,
    decimated: &Decimated,
    kept: &[u32],
    topology: &SemiRegular,
    level: u32,
) -> Vec<Place> {
    let numbers: Vec<u32> = decimated.left().map(|(number, _)| number).collect();
    let mut places: Vec<Place> = (kept.len() as u32..topology.vertex_count(level))
        .map(|v| {
            let size = f64::from(1u32 << topology.level_of(v));
            match topology.place(v) {
                LatticePlace::Face { face, at: [a, b] } => {
                    let [v, w] = [a, b].map(|steps| f64::from(steps) / size);
                    Place { triangle: numbers[face as usize], shares: [1.0 - v - w, v, w] }
                }
                LatticePlace::Edge { edge, at } => {
                    let (face, side) = topology.base().edges()[edge as usize].left;
                    let share = f64::from(at) / size;
                    let mut shares = [0.0; 3];
                    shares[usize::from(side)] = 1.0 - share;
                    shares[(usize::from(side) + 1) % 3] = share;
                    Place { triangle: numbers[face as usize], shares }
                }
                LatticePlace::Base => Place::corner(numbers[0], 0),
            }
        })
        .collect();
    decimated.history.carry_back(source.triangles().len(), &mut places);
    let corner = |&v: &u32| {
        let (triangle, corner) = source.surface.fan(v)[0];
        Place::corner(triangle, usize::from(corner))
    };
    kept.iter().map(corner).chain(places).collect()
}
