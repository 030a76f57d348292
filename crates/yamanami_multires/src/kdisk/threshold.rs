//! Which details stay.

use yamanami_core::SemiRegular;

/// The vertices with the largest sizes: flags by vertex, true for all of the base mesh and for the `count` largest of the rest; of equal ones
/// those of lower number.
pub fn keep_largest(mesh: &SemiRegular, sizes: &[f64], count: usize) -> Vec<bool> {
    let base = mesh.vertex_count(0);
    let mut order: Vec<u32> = (base..sizes.len() as u32).collect();
    order.sort_by(|&a, &b| sizes[b as usize].total_cmp(&sizes[a as usize]));
    let mut kept = vec![false; sizes.len()];
    kept[..base as usize].fill(true);
    for &v in order.iter().take(count) {
        kept[v as usize] = true;
    }
    kept
}
