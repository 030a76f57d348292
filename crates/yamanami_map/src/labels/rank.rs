//! Which names matter most: the prominent and the near.
//!
//! The rank a place comes with counts (prominence of summits). Where none does, how far a place stands from the next
//! higher one stands in for it: the isolation of mountain lists, which needs no ground.

use super::{Label, Outcome};
use yamanami_core::{NamedPlace, PlaceKind};

/// Isolation in metres that is worth a metre of prominence.
const ISOLATION_PER_PROMINENCE: f64 = 20.0;

/// Beyond this many places isolation is not worked out, but height taken for it.
const MOST_COMPARED: usize = 20_000;

/// One score a place, the greater the more important. Falls with the root of distance: a mountain of twice the
/// prominence keeps its name up to four times as far.
pub(super) fn scores(places: &[NamedPlace], labels: &[Label], ring_m: f64) -> Vec<f64> {
    let has_ranks = places.iter().any(|p| p.rank.is_some_and(f64::is_finite));
    let ranks: Vec<f64> = if has_ranks {
        places.iter().map(|p| p.rank.filter(|r| r.is_finite()).unwrap_or(0.0)).collect()
    } else {
        stand_in_prominences(labels)
    };
    ranks.iter().zip(labels).map(|(rank, label)| rank / (label.distance_m + ring_m).sqrt()).collect()
}

/// Height of each place, or less where a higher one is near.
fn stand_in_prominences(labels: &[Label]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..labels.len())
        .filter(|&i| labels[i].kind == PlaceKind::Summit && labels[i].outcome != Outcome::NoCoordinates)
        .collect();
    order.sort_by(|&a, &b| labels[b].at.z.total_cmp(&labels[a].at.z).then(a.cmp(&b)));
    let mut out: Vec<f64> = labels.iter().map(|l| if l.at.is_finite() { 0.1 * l.at.z.max(0.0) } else { 0.0 }).collect();
    for (k, &i) in order.iter().enumerate() {
        let place = labels[i].at;
        let compared = if order.len() > MOST_COMPARED { &[][..] } else { &order[..k] };
        let isolation_m = compared
            .iter()
            .map(|&higher| (labels[higher].at.truncate() - place.truncate()).length())
            .fold(f64::INFINITY, f64::min);
        out[i] = place.z.max(0.0).min(isolation_m / ISOLATION_PER_PROMINENCE);
    }
    out
}
