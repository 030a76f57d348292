//! Names laid into the plane: where the true summit stands, and how much it matters.

use glam::DVec2;
use yamanami_core::{NamedPlace, NestedField, PlaceKind};
use yamanami_multires::rtin::Summit;

/// A name belongs to a summit of the ground within this distance, metres, or within two samples of the grid.
const OWN_M: f64 = 700.0;

/// Ranks the summits among `places` (plane metres) that have no rank by the prominence of the ground's summit beside
/// them; where the ground has none there, by a tenth of their height.
pub fn rank_by_prominence(places: &mut [NamedPlace], field: &NestedField, summits: &[Summit]) {
    let grid = field.widest();
    let reach_m = OWN_M.max(2.0 * grid.spacing_m());
    let at: Vec<(DVec2, f64)> =
        summits.iter().map(|s| (grid.plane_from_grid(s.column, s.row), s.prominence_m)).collect();
    // each summit belongs to the nearest name only
    let mut owner = vec![(f64::INFINITY, usize::MAX); at.len()];
    for (n, place) in places.iter().enumerate().filter(|(_, p)| p.kind == PlaceKind::Summit) {
        for (s, &(summit, _)) in at.iter().enumerate() {
            let off_m = (summit - place.position).length();
            if off_m <= reach_m && off_m < owner[s].0 {
                owner[s] = (off_m, n);
            }
        }
    }
    let mut prominence_m = vec![0f64; places.len()];
    for (&(_, n), &(_, prominence)) in owner.iter().zip(&at).filter(|((_, n), _)| *n != usize::MAX) {
        prominence_m[n] = prominence_m[n].max(prominence);
    }
    for (place, prominence_m) in places.iter_mut().zip(prominence_m) {
        if place.rank.is_none() && place.kind == PlaceKind::Summit {
            let least = 0.1 * place.height_m.unwrap_or_else(|| field.height_m(place.position));
            place.rank = Some(prominence_m.max(least));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_core::FieldLevel;

    #[test]
    fn the_nearest_name_gets_the_summit() {
        let field = NestedField::new(vec![FieldLevel::new(200.0, 10, vec![0.0; 441])]);
        let named = |name: &str, x: f64| NamedPlace {
            name: name.to_owned(),
            position: DVec2::new(x, 0.0),
            height_m: Some(1000.0),
            ..NamedPlace::default()
        };
        let mut places = [named("beside", 300.0), named("upon", 50.0), named("far", -1900.0)];
        let summit = Summit { column: 10, row: 10, height_m: 1010.0, prominence_m: 640.0, saddle: None };
        rank_by_prominence(&mut places, &field, &[summit]);
        assert_eq!(places.map(|p| p.rank), [Some(100.0), Some(640.0), Some(100.0)]);
    }
}
