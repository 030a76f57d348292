//! The semi-regular mesh laid over the source: first over the base mesh, then over ever finer ones on the way back to the source,
//! evened out on each. What stands out is evened out while it still is a few triangles, so that it gets its share of vertices.
//!
//! Based on: Lee, Sweldens, Schröder, Cowsar, Dobkin, "MAPS: Multiresolution Adaptive Parameterization of Surfaces", 1998. Evening
//! out on the way back is ours.

use super::decimate::Decimated;
use super::net::Net;
use super::source::{Place, Source};
use super::{even, pin, refine, relax};
use yamanami_core::{BaseFault, BaseMesh, Place as LatticePlace, SemiRegular};

/// How many times finer each mesh on the way back is than the one before.
const FINER: usize = 4;

/// Levels that the net is finer than the mesh that it lies on, where it may: it must not cut through what stands out.
const AHEAD: u32 = 2;

/// Tips are looked for on meshes of up to so many times the base mesh's faces: on finer ones they are roughness.
const PINNED: usize = 64;

/// Coarse levels that are evened out on each mesh, from the net's own down.
const EVEN_LEVELS: u32 = 4;

/// Rounds of evening out at each of them, from coarse to fine.
const EVEN_ROUNDS: usize = 4;

/// Rounds of unfolding after each of these.
const UNFOLD_ROUNDS: usize = 2;

/// Rounds vertex by vertex after that.
const RELAX_ROUNDS: usize = 6;

/// The base mesh of what is left.
pub(super) fn base_mesh(source: &Source, decimated: &Decimated) -> Result<BaseMesh, BaseFault> {
    Ok(source.coarser(&decimated.triangles)?.0.surface)
}

/// The places on the source of all vertices up to a level. `progress` hears of the share done.
pub(super) fn places(
    source: &Source,
    decimated: &Decimated,
    topology: &SemiRegular,
    level: u32,
    progress: &dyn Fn(f32),
) -> Result<Vec<Place>, BaseFault> {
    let Decimated { triangles, history } = decimated;
    let mut triangles = triangles.clone();
    let mut end = history.len();
    let mut faces = topology.base().triangles().len();
    let mut at_level = AHEAD.min(level);
    let mut places = on_base(topology, at_level);
    let mut is_pinned = Vec::new();
    loop {
        let (surface, numbers) = source.coarser(&triangles)?;
        let mut number_of = vec![0; triangles.len()];
        numbers.iter().zip(0..).for_each(|(&n, k)| number_of[n as usize] = k);
        if faces != topology.base().triangles().len() {
            places.iter_mut().for_each(|place| place.triangle = number_of[place.triangle as usize]);
        }
        let mut net = Net::new(&surface, topology, at_level, places);
        net.is_pinned.iter_mut().zip(&is_pinned).for_each(|(now, &before)| *now = before);
        if faces <= PINNED * topology.base().triangles().len() {
            pin::pin(&mut net);
        }
        lay_out(&mut net);
        progress(faces as f32 / source.triangles().len() as f32);
        let is_last = end == 0;
        while net.level < level && (net.level < at_level + 1 || is_last) {
            refine::halve(&mut net);
            relax::unfold(&mut net, UNFOLD_ROUNDS);
            if is_last {
                lay_out(&mut net);
            }
        }
        (at_level, places, is_pinned) = (net.level, net.places, net.is_pinned);
        if is_last {
            return Ok(places);
        }
        places.iter_mut().for_each(|place| place.triangle = numbers[place.triangle as usize]);
        let begin = history.before(end, faces, faces * FINER);
        history.carry_back(begin..end, triangles.len(), &mut places);
        history.undo(begin..end, &mut triangles);
        faces = triangles.iter().filter(|t| t[0] != super::source::NONE).count();
        end = begin;
    }
}

/// Evens the net out on the mesh that it lies on.
fn lay_out(net: &mut Net<'_>) {
    for level in net.level.saturating_sub(EVEN_LEVELS)..=net.level {
        for _ in 0..EVEN_ROUNDS {
            even::even(net, level);
            relax::unfold(net, UNFOLD_ROUNDS);
        }
    }
    relax::relax(net, RELAX_ROUNDS, |_| true);
}

/// The places of all vertices up to a level on the base mesh itself.
fn on_base(topology: &SemiRegular, level: u32) -> Vec<Place> {
    let place = |v: u32| {
        let size = f64::from(1u32 << topology.level_of(v));
        match topology.place(v) {
            LatticePlace::Base => {
                let (face, corner) = topology.base().fan(v)[0];
                Place::corner(face, usize::from(corner))
            }
            LatticePlace::Face { face, at: [a, b] } => {
                let [v, w] = [a, b].map(|steps| f64::from(steps) / size);
                Place { triangle: face, shares: [1.0 - v - w, v, w] }
            }
            LatticePlace::Edge { edge, at } => {
                let (face, side) = topology.base().edges()[edge as usize].left;
                let share = f64::from(at) / size;
                let mut shares = [0.0; 3];
                shares[usize::from(side)] = 1.0 - share;
                shares[(usize::from(side) + 1) % 3] = share;
                Place { triangle: face, shares }
            }
        }
    };
    (0..topology.vertex_count(level)).map(place).collect()
}
