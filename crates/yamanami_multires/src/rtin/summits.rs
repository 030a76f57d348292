//! Summits of a grid and their prominence: how far one must go down to get to higher ground.
//!
//! Based on: Kirmse, de Ferranti, "Calculating the prominence and isolation of every mountain in the world", 2017 (what
//! prominence is, key saddles). Where we differ: no divide tree; the samples are flooded from high to low with a union of
//! sets, as in Edelsbrunner, Letscher, Zomorodian, "Topological persistence and simplification", 2002.

use rayon::prelude::*;
use yamanami_core::FieldLevel;

/// A summit of a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summit {
    /// Column of its sample.
    pub column: usize,
    /// Row of its sample.
    pub row: usize,
    /// Its height, metres.
    pub height_m: f32,
    /// Height above its key saddle, the highest ground by which one gets to higher ground, metres; of the highest summit,
    /// above the lowest sample.
    pub prominence_m: f64,
    /// Column and row of the key saddle; none for the highest summit.
    pub saddle: Option<[usize; 2]>,
}

/// Not flooded yet.
const DRY: u32 = u32::MAX;

/// All summits of at least this prominence (and more than none), the most prominent first. What lies off the grid counts as
/// lower than anything: near the border prominence is never too small, but may be too large.
pub fn summits(field: &FieldLevel, min_prominence_m: f64) -> Vec<Summit> {
    let (z, width) = (field.heights_m(), field.width());
    let mut order: Vec<u64> = (0u64..).zip(z).map(|(i, &z)| u64::from(!ordered(z)) << 32 | i).collect();
    order.par_sort_unstable();
    // sets of flooded samples; the first of a set, which is its root, is its summit
    let mut parents = vec![DRY; z.len()];
    let mut found = Vec::new();
    let mut keep = |summit: usize, prominence_m: f64, saddle: Option<usize>| {
        if prominence_m > 0.0 && prominence_m >= min_prominence_m {
            let at = |i: usize| [i % width, i / width];
            let [column, row] = at(summit);
            found.push(Summit { column, row, height_m: z[summit], prominence_m, saddle: saddle.map(at) });
        }
    };
    let above = |a: u32, b: u32| z[a as usize].total_cmp(&z[b as usize]).then(b.cmp(&a)).is_gt();
    for &key in &order {
        let i = key as u32;
        let mut own = i;
        for neighbour in neighbours(i as usize, width) {
            if parents[neighbour] == DRY {
                continue;
            }
            let other = root(&mut parents, neighbour as u32);
            if other == own {
                continue;
            }
            if own == i {
                own = other;
                continue;
            }
            // two sets meet: the lower summit's ends here
            let (higher, lower) = if above(own, other) { (own, other) } else { (other, own) };
            let prominence_m = f64::from(z[lower as usize]) - f64::from(z[i as usize]);
            keep(lower as usize, prominence_m, Some(i as usize));
            parents[lower as usize] = higher;
            own = higher;
        }
        parents[i as usize] = own;
    }
    if let [highest, .., lowest] = order[..] {
        let [highest, lowest] = [highest, lowest].map(|key| (key as u32) as usize);
        keep(highest, f64::from(z[highest]) - f64::from(z[lowest]), None);
    }
    found.sort_by(|a, b| b.prominence_m.total_cmp(&a.prominence_m).then((a.row, a.column).cmp(&(b.row, b.column))));
    found
}

/// Bits in the order of the numbers; both zeros are one.
fn ordered(z: f32) -> u32 {
    let bits = (z + 0.0).to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

/// The samples beside a sample and across its corners, on a square grid.
fn neighbours(i: usize, width: usize) -> impl Iterator<Item = usize> {
    let (column, row) = (i % width, i / width);
    let around = move |k: usize| k.saturating_sub(1)..=(k + 1).min(width - 1);
    around(row).flat_map(move |r| around(column).map(move |c| r * width + c)).filter(move |&n| n != i)
}

/// The root of a sample's set; shortens the way there.
fn root(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        let up = parents[parents[i as usize] as usize];
        parents[i as usize] = up;
        i = up;
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_testkit::Rng;

    fn grid(rows: [[i32; 5]; 5]) -> FieldLevel {
        FieldLevel::new(10.0, 2, rows.concat().into_iter().map(|z| z as f32).collect())
    }

    #[test]
    fn prominence_is_the_way_down_to_higher_ground() {
        let field = grid([[0, 0, 0, 0, 0], [0, 5, 3, 0, 0], [0, 0, 0, 4, 9], [0, 7, 7, 0, 2], [-1, 0, 0, 0, 0]]);
        let found = summits(&field, 0.0);
        let short: Vec<_> = found.iter().map(|s| (s.height_m, s.prominence_m, s.saddle)).collect();
        // the plateau of 7 is one summit; across corners it reaches the 4 that leads to the 9
        assert_eq!(short, [(9.0, 10.0, None), (7.0, 3.0, Some([3, 2])), (5.0, 2.0, Some([2, 1]))]);
        assert_eq!((found[0].column, found[0].row), (4, 2));
        assert_eq!(summits(&field, 2.5).len(), 2);
        assert!(summits(&grid([[3; 5]; 5]), 0.0).is_empty(), "level ground has no summit");
    }

    /// The definition itself: the best way to higher ground, by flooding from each summit.
    #[test]
    fn it_agrees_with_the_definition() {
        let mut rng = Rng::new(4);
        let field = FieldLevel::new(1.0, 8, (0..17 * 17).map(|_| rng.below(40) as f32).collect());
        let z = field.heights_m();
        for s in summits(&field, 0.0).into_iter().filter(|s| s.saddle.is_some()) {
            let saddle_m = s.height_m - s.prominence_m as f32;
            let reaches_higher = |floor_m: f32| {
                let mut open = vec![s.row * 17 + s.column];
                let mut seen = vec![false; z.len()];
                let mut highest = f32::MIN;
                while let Some(i) = open.pop() {
                    if !std::mem::replace(&mut seen[i], true) {
                        highest = highest.max(z[i]);
                        open.extend(neighbours(i, 17).filter(|&n| z[n] >= floor_m));
                    }
                }
                highest
            };
            assert!(reaches_higher(saddle_m) >= s.height_m, "{s:?}");
            assert!(reaches_higher(saddle_m + 1.0) <= s.height_m, "{s:?}");
            let [column, row] = s.saddle.unwrap();
            assert_eq!(z[row * 17 + column], saddle_m);
        }
    }
}
