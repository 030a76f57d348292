//! The planes around a vertex, and what is to be kept beside them: the lines of borders and creases, the rims of folds, and
//! the tips of thin pieces.
//!
//! Planes alone do not see a thin piece get shorter: its two sides stay where they are while its rim draws back, a little in
//! each step, until it is gone. So an edge at which the surface turns back on itself is kept like a border, and a star that
//! faces all ways is held at its place. On a scan with deep folds this takes the largest distance to a fifth, and lowers
//! the mean square besides.

use super::plane_sum::{ABREAST, PlaneSum};
use super::stars::Corner;
use super::work::{Work, hold};
use glam::DVec3;

/// How much the line of a border or crease weighs beside a surface that stands on it.
const LINE_WEIGHT: f32 = 10.0;

/// How much the rim of a surface that turns back wholly weighs; less where it turns back less.
const FOLD_WEIGHT: f32 = 10.0;

/// Below this [`PlaneSum::evenness`] a star is searched for folds.
const EVEN: f32 = 0.6;

/// Below this evenness a star is held at its place, with so much of its planes' weight for each unit below.
const TIP: f32 = 0.4;
const TIP_WEIGHT: f32 = 0.03;

/// The sum for a vertex; and whether its star is closed: then every neighbour is next in one triangle and last in another.
pub(super) fn plane_sum(work: &Work, v: u32) -> (PlaneSum, bool) {
    let at = work.positions[v as usize];
    let star = work.star(v);
    let mut balance = 0u64;
    let mut sum = PlaneSum::default();
    for some in star.chunks(ABREAST) {
        // triangles without area, which add nothing, fill the lanes up
        let mut corners = [[0f32; ABREAST]; 6];
        for (k, corner) in some.iter().enumerate() {
            let [_, b, c] = corner.turned(&work.triangles);
            balance = balance.wrapping_add(mixed(b)).wrapping_sub(mixed(c));
            let (b, c) = (work.positions[b as usize] - at, work.positions[c as usize] - at);
            for (lane, v) in corners.iter_mut().zip([b.x, b.y, b.z, c.x, c.y, c.z]) {
                lane[k] = v as f32;
            }
        }
        sum.add_triangles(&corners);
    }
    let is_closed = balance == 0;
    if sum.evenness() < EVEN {
        add_folds(work, v, &mut sum);
        // rims count here as what they stand for: surfaces
        let evenness = sum.evenness();
        if evenness < TIP {
            sum.add_point(TIP_WEIGHT * (TIP - evenness));
        }
    }
    if !is_closed || work.holds[v as usize] & hold::CREASE != 0 {
        work.for_lines(v, |n| sum.add_line((work.positions[n as usize] - at).as_vec3(), LINE_WEIGHT));
    }
    (sum, is_closed)
}

fn add_folds(work: &Work, v: u32, sum: &mut PlaneSum) {
    let at = work.positions[v as usize];
    let star = work.star(v);
    let normal = |corner: &Corner| -> DVec3 {
        let [_, b, c] = corner.turned(&work.triangles);
        (work.positions[b as usize] - at).cross(work.positions[c as usize] - at).normalize_or_zero()
    };
    for corner in star {
        let b = corner.turned(&work.triangles)[1];
        if let Some(other) = star.iter().find(|o| o.turned(&work.triangles)[2] == b) {
            let back = -normal(corner).dot(normal(other)) as f32;
            if back > 0.0 {
                sum.add_line((work.positions[b as usize] - at).as_vec3(), FOLD_WEIGHT * back);
            }
        }
    }
}

/// Spreads a number over 64 bits so that sums of different numbers differ.
fn mixed(v: u32) -> u64 {
    let x = (u64::from(v) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (x ^ (x >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9)
}
