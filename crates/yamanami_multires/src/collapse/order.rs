//! Vertices in the order of a space-filling curve, equal places together: neighbours in space become neighbours in memory.
//!
//! Based on: Morton, "A computer oriented geodetic data base and a new technique in file sequencing", 1966.

use super::prepare::BOX;
use glam::DVec3;
use rayon::prelude::*;

/// Bits of each coordinate.
const BITS: u32 = 21;

/// The numbers of the vertices that `is_used`, along the curve; equal places stand beside each other, the least number first.
/// Places lie within half a [`BOX`] of zero.
pub(super) fn along_curve(positions: &[DVec3], is_used: &[bool]) -> Vec<u32> {
    let mut keyed: Vec<(u64, u32)> =
        positions.par_iter().enumerate().filter(|&(i, _)| is_used[i]).map(|(i, &p)| (morton(p), i as u32)).collect();
    keyed.par_sort_unstable_by(|a, b| {
        a.0.cmp(&b.0).then_with(|| {
            let [p, q] = [a, b].map(|v| positions[v.1 as usize].to_array());
            let by = |k: usize| p[k].total_cmp(&q[k]);
            by(0).then_with(|| by(1)).then_with(|| by(2)).then(a.1.cmp(&b.1))
        })
    });
    keyed.into_iter().map(|(_, v)| v).collect()
}

fn morton(p: DVec3) -> u64 {
    let cells = f64::from(1u32 << BITS);
    let code = |v: f64| spread(((v / BOX + 0.5) * cells).clamp(0.0, cells - 1.0) as u64);
    code(p.x) | code(p.y) << 1 | code(p.z) << 2
}

/// Two zero bits between any two bits.
fn spread(v: u64) -> u64 {
    let mut v = v & 0x1F_FFFF;
    v = (v | v << 32) & 0x001F_0000_0000_FFFF;
    v = (v | v << 16) & 0x001F_0000_FF00_00FF;
    v = (v | v << 8) & 0x100F_00F0_0F00_F00F;
    v = (v | v << 4) & 0x10C3_0C30_C30C_30C3;
    (v | v << 2) & 0x1249_2492_4924_9249
}
