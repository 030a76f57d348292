//! Neighbouring faces that face the same way, turning as few as possible. A one-sided patch, where that cannot be, stays as
//! it is.

use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// No neighbour.
const NONE: u32 = u32::MAX;

/// Turns faces and gives how many, and how many edges stay at odds. Only edges of exactly two faces join them: at others
/// nothing says which faces belong together.
pub(super) fn orient(mesh: &mut TriangleMesh, place: &[u32]) -> (usize, usize) {
    let neighbours = neighbours(mesh, place);
    let mut turned: Vec<Option<bool>> = vec![None; mesh.triangles.len()];
    let (mut patch, mut waiting) = (Vec::new(), Vec::new());
    let mut odd = 0;
    for start in 0..turned.len() {
        if turned[start].is_some() {
            continue;
        }
        patch.clear();
        let odd_before = odd;
        turned[start] = Some(false);
        waiting.push(start as u32);
        while let Some(face) = waiting.pop() {
            patch.push(face);
            let is_turned = turned[face as usize] == Some(true);
            for &(other, against) in &neighbours[face as usize] {
                if other == NONE {
                    continue;
                }
                let wanted = is_turned != against;
                match turned[other as usize] {
                    None => {
                        turned[other as usize] = Some(wanted);
                        waiting.push(other);
                    }
                    Some(is) => odd += usize::from(is != wanted),
                }
            }
        }
        // the lesser half turns; of a one-sided patch none: from another start others would
        let count = patch.iter().filter(|&&face| turned[face as usize] == Some(true)).count();
        let (is_one_sided, turn_others) = (odd > odd_before, 2 * count > patch.len());
        for &face in &patch {
            let turned = &mut turned[face as usize];
            *turned = turned.map(|t| !is_one_sided && t != turn_others);
        }
    }
    let mut count = 0;
    for (t, _) in mesh.triangles.iter_mut().zip(&turned).filter(|(_, turned)| **turned == Some(true)) {
        t.swap(1, 2);
        count += 1;
    }
    // each edge at odds was met from both its faces
    (count, odd / 2)
}

/// For each side of each face the face beyond it, and whether that runs along the side in the same direction.
fn neighbours(mesh: &TriangleMesh, place: &[u32]) -> Vec<[(u32, bool); 3]> {
    let mut sides: Vec<(u64, u64)> = mesh
        .triangles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(number, t)| {
            let [a, b, c] = t.map(|i| place[i as usize]);
            [(a, b), (b, c), (c, a)].into_iter().enumerate().filter(|(_, (p, q))| p != q).map(move |(k, (p, q))| {
                let edge = u64::from(p.min(q)) << 32 | u64::from(p.max(q));
                (edge, 8 * number as u64 + 2 * k as u64 + u64::from(p < q))
            })
        })
        .collect();
    sides.par_sort_unstable();
    let mut neighbours = vec![[(NONE, false); 3]; mesh.triangles.len()];
    for same in sides.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, first), (_, second)] = *same {
            let (one, other) = ((first / 8) as usize, (second / 8) as usize);
            let against = first % 2 == second % 2;
            neighbours[one][(first / 2 % 4) as usize] = (other as u32, against);
            neighbours[other][(second / 2 % 4) as usize] = (one as u32, against);
        }
    }
    neighbours
}
