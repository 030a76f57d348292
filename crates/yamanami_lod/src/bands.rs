//! The paper's own rule for deformed maps: one size of triangle for each band of distance, whatever the ground.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map" (equations (4), (5), table
//! 1). A hypotenuse a that is not split hides, typically, a height h = (a/2)·σ(a), with σ the deviation of slopes
//! measured on real terrain. It is split where h moves the picture by 1.5 pixels or more:
//! e = P·|ρ(r; z = h) − ρ(r; z = 0)|, or as [`MiddleReading`] has it. The paper prints the table for one map; here it
//! follows from map, picture and σ.
//!
//! The radius of the plain map (D_R) is the projection's; the *coarse centre*, where the paper draws large triangles
//! since height does not show there, is the table's. They are different numbers (10 km and 3.2 km), and kept apart.

use yamanami_core::DeformedMap;

/// The paper's blocks, metres: each has triangles of one size.
pub const PAPER_BLOCK_M: f64 = 6_400.0;

/// Pixels from which the paper splits.
pub const PAPER_SPLIT_PX: f64 = 1.5;

/// How finely distances are looked through for the end of a band, metres.
const STEP_M: f64 = 50.0;

/// Triangles of one size between two distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Where it begins, metres from the centre.
    pub near_m: f64,
    /// Where it ends, metres from the centre.
    pub far_m: f64,
    /// Longest side of its triangles, metres.
    pub hypotenuse_m: f64,
    /// L: a block is halved so often, and holds 2^(L+1) triangles.
    pub level: u32,
}

/// Bands from the centre outwards, without gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct BandTable {
    /// The bands, the nearest first.
    pub bands: Vec<Band>,
    /// Side of a block, metres: a triangle of level 1 spans it.
    pub block_m: f64,
}

/// σ(a): the deviation of slopes that a hypotenuse hides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlopeDeviation {
    /// a, metres.
    pub hypotenuse_m: f64,
    /// σ, metres per metre.
    pub sigma: f64,
}

/// What the height at a hypotenuse's middle is held against: the paper says only "the error at the middle".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MiddleReading {
    /// The picture of the same place without the height: what height alone does.
    #[default]
    Ground,
    /// The middle of the hypotenuse as it is drawn, laid along the radius, whether the height is above or below it: what
    /// the bend of the projection does as well. On gentle ground that is the greater part, near the ring above all.
    Hypotenuse,
}

/// What a table is measured for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandRule {
    /// What the error is.
    pub reading: MiddleReading,
    /// P: radius of the plain map in pixels.
    pub ring_px: f64,
    /// How far ground is drawn, metres from the centre.
    pub rim_m: f64,
    /// Pixels from which a triangle is split.
    pub split_px: f64,
    /// Side of a block, metres.
    pub block_m: f64,
    /// Radius of the coarse centre, metres; 0 for none.
    pub coarse_m: f64,
    /// Level of the coarse centre.
    pub coarse_level: u32,
}

impl BandRule {
    /// The paper's numbers for a picture with this radius of the plain map: 160 km, 1.5 px, blocks of 6.4 km.
    pub fn paper(ring_px: f64) -> Self {
        Self {
            reading: MiddleReading::Ground,
            ring_px,
            rim_m: 160_000.0,
            split_px: PAPER_SPLIT_PX,
            block_m: PAPER_BLOCK_M,
            coarse_m: 0.5 * PAPER_BLOCK_M,
            coarse_level: 4,
        }
    }
}

/// e: how far, in pixels, the picture is off at a distance when the height a hypotenuse typically hides is left out.
pub fn band_error_px(
    map: &DeformedMap,
    ring_px: f64,
    deviation: SlopeDeviation,
    r_m: f64,
    reading: MiddleReading,
) -> f64 {
    let half_m = 0.5 * deviation.hypotenuse_m;
    let h_m = half_m * deviation.sigma;
    let rho = |r_m: f64, z_m: f64| map.rho(r_m.abs(), z_m).copysign(r_m);
    let error = match reading {
        MiddleReading::Ground => (rho(r_m, h_m) - rho(r_m, 0.0)).abs(),
        MiddleReading::Hypotenuse => {
            let drawn = 0.5 * (rho(r_m - half_m, 0.0) + rho(r_m + half_m, 0.0));
            (rho(r_m, h_m) - drawn).abs().max((rho(r_m, -h_m) - drawn).abs())
        }
    };
    ring_px * error
}

impl BandTable {
    /// Table 1 as the paper prints it.
    pub fn paper() -> Self {
        let rows = [
            (0.0, 3.2, 2.263, 4),
            (3.2, 35.0, 0.800, 7),
            (35.0, 56.0, 1.131, 6),
            (56.0, 76.0, 1.600, 5),
            (76.0, 100.0, 2.263, 4),
            (100.0, 123.0, 3.200, 3),
            (123.0, 145.0, 4.525, 2),
            (145.0, 160.0, 6.400, 1),
        ];
        let band = |(near_km, far_km, hypotenuse_km, level): (f64, f64, f64, u32)| Band {
            near_m: 1e3 * near_km,
            far_m: 1e3 * far_km,
            hypotenuse_m: 1e3 * hypotenuse_km,
            level,
        };
        Self { bands: rows.map(band).into(), block_m: PAPER_BLOCK_M }
    }

    /// The table that the paper's rule gives for a map, a picture and the σ of the ground at hand: at every distance the
    /// largest triangle that need not be split there nor further out. Without a hypotenuse that is small enough the
    /// halves of the smallest are taken.
    ///
    /// Only lengths that halve a block 1, 2, 3, … times count; without any, the table is level 1 throughout.
    pub fn measured(map: &DeformedMap, rule: &BandRule, sigma: &[SlopeDeviation]) -> Self {
        let mut known: Vec<(u32, SlopeDeviation)> =
            sigma.iter().filter_map(|&s| Some((level_of(rule.block_m, s.hypotenuse_m)?, s))).collect();
        known.sort_by_key(|&(level, _)| level);
        let finest = known.last().map_or(1, |&(level, _)| level + 1);
        let mut ends = Vec::new();
        let mut from_m = rule.rim_m;
        for &(level, deviation) in &known {
            let end = split_within_m(map, rule, deviation).min(from_m);
            ends.push((level, end, from_m));
            from_m = end;
        }
        ends.push((finest, 0.0, from_m));
        let coarse_m = rule.coarse_m.clamp(0.0, rule.rim_m);
        let centre = (rule.coarse_level, 0.0, coarse_m);
        let around = ends.into_iter().rev().map(|(level, near, far)| (level, near.max(coarse_m), far));
        let band =
            |(level, near_m, far_m)| Band { near_m, far_m, hypotenuse_m: hypotenuse_m(rule.block_m, level), level };
        let bands = [centre].into_iter().chain(around).filter(|&(_, near, far)| near < far).map(band).collect();
        Self { bands, block_m: rule.block_m }
    }

    /// The level at a distance from the centre; that of the last band beyond it.
    pub fn level_at(&self, r_m: f64) -> u32 {
        let band = self.bands.iter().find(|band| r_m < band.far_m).or(self.bands.last());
        band.map_or(1, |band| band.level)
    }

    /// Where the last band ends, metres from the centre.
    pub fn rim_m(&self) -> f64 {
        self.bands.last().map_or(0.0, |band| band.far_m)
    }

    /// Triangles of each band by its area, and their sum.
    pub fn triangles_by_area(&self) -> f64 {
        self.bands.iter().map(Band::triangles).sum()
    }

    /// Triangles by whole blocks: those whose centre lies within `reach_m` of the eye, which stands over a block's centre,
    /// each at the level of its centre. Gives blocks and triangles, without what joins them.
    pub fn triangles_by_blocks(&self, reach_m: f64) -> (u64, u64) {
        let n = (reach_m / self.block_m).floor().clamp(0.0, 30_000.0) as i64;
        let (mut blocks, mut triangles) = (0, 0);
        for (i, j) in (-n..=n).flat_map(|i| (-n..=n).map(move |j| (i, j))) {
            let r_m = self.block_m * (i as f64).hypot(j as f64);
            if r_m <= reach_m {
                blocks += 1;
                triangles += 2u64 << self.level_at(r_m).min(40);
            }
        }
        (blocks, triangles)
    }
}

impl Band {
    /// Triangles of the band by its area: a right isosceles triangle covers a²/4.
    pub fn triangles(&self) -> f64 {
        let area = std::f64::consts::PI * (self.far_m * self.far_m - self.near_m * self.near_m);
        4.0 * area / (self.hypotenuse_m * self.hypotenuse_m)
    }
}

/// Longest side of the triangles of a block that was halved so often, metres.
pub fn hypotenuse_m(block_m: f64, level: u32) -> f64 {
    block_m * 0.5f64.powf(0.5 * (f64::from(level) - 1.0))
}

/// The level whose hypotenuse this is, from 1 on.
fn level_of(block_m: f64, hypotenuse_m: f64) -> Option<u32> {
    let level = 1.0 + 2.0 * (block_m / hypotenuse_m).log2();
    // a thousandth, so that lengths as printed are known
    ((level - level.round()).abs() < 1e-2 && (1.0..=40.0).contains(&level.round())).then(|| level.round() as u32)
}

/// Distance within which triangles of this size must be split: e reaches the threshold there, and nowhere further out.
fn split_within_m(map: &DeformedMap, rule: &BandRule, deviation: SlopeDeviation) -> f64 {
    let too_far_off = |r_m: f64| band_error_px(map, rule.ring_px, deviation, r_m, rule.reading) >= rule.split_px;
    if too_far_off(rule.rim_m) {
        return rule.rim_m;
    }
    let steps = (rule.rim_m / STEP_M).ceil().clamp(1.0, 1e6) as u32;
    let at = |step: u32| rule.rim_m * f64::from(step) / f64::from(steps);
    let Some(last) = (0..steps).rev().find(|&step| too_far_off(at(step))) else { return 0.0 };
    let (mut near, mut far) = (at(last), at(last + 1));
    for _ in 0..40 {
        let middle = 0.5 * (near + far);
        if too_far_off(middle) { near = middle } else { far = middle }
    }
    far
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reach of the paper's blocks: 3,958,784 full triangles are 1,933 blocks of 2,048.
    const PAPER_REACH_M: f64 = 158_720.0;

    /// σ on real low mountains (DEFORMED_MAP's measurement), steepened to the Southern Alps.
    fn sigma() -> Vec<SlopeDeviation> {
        let table = [0.091, 0.100, 0.101, 0.099, 0.091, 0.079, 0.066, 0.053, 0.041, 0.032, 0.027, 0.021];
        let a = |n: usize| 400.0 * 2f64.powf(0.5 * n as f64);
        table.iter().enumerate().map(|(n, &sigma)| SlopeDeviation { hypotenuse_m: a(n), sigma: 3.0 * sigma }).collect()
    }

    #[test]
    fn the_printed_table_gives_the_papers_triangles() {
        let table = BandTable::paper();
        assert_eq!(table.triangles_by_area().round(), 77_291.0);
        assert_eq!(table.triangles_by_blocks(PAPER_REACH_M), (1_933, 77_360));
        let full = Band { near_m: 0.0, far_m: 1e9, hypotenuse_m: 200.0 * 2f64.sqrt(), level: 10 };
        let all = BandTable { bands: vec![full], block_m: PAPER_BLOCK_M };
        assert_eq!(all.triangles_by_blocks(PAPER_REACH_M), (1_933, 3_958_784));
        for band in &table.bands {
            assert!((hypotenuse_m(table.block_m, band.level) - band.hypotenuse_m).abs() < 1.0, "{band:?}");
            assert_eq!(level_of(table.block_m, band.hypotenuse_m), Some(band.level));
        }
    }

    #[test]
    fn a_measured_table_keeps_the_threshold_and_wastes_nothing() {
        for reading in [MiddleReading::Ground, MiddleReading::Hypotenuse] {
            keeps_the_threshold(BandRule { reading, ..BandRule::paper(330.0) });
        }
    }

    fn keeps_the_threshold(rule: BandRule) {
        let map = DeformedMap::default();
        let table = BandTable::measured(&map, &rule, &sigma());
        assert_eq!((table.bands[0].near_m, table.rim_m()), (0.0, rule.rim_m));
        for pair in table.bands.windows(2) {
            assert_eq!(pair[0].far_m, pair[1].near_m);
        }
        let error = |level: u32, r_m: f64| {
            let deviation = sigma().into_iter().find(|s| level_of(rule.block_m, s.hypotenuse_m) == Some(level));
            deviation.map_or(0.0, |s| band_error_px(&map, rule.ring_px, s, r_m, rule.reading))
        };
        for band in &table.bands[1..] {
            for i in 0..=20 {
                let r_m = band.near_m + 1e-3 + (band.far_m - band.near_m - 2e-3) * f64::from(i) / 20.0;
                assert!(error(band.level, r_m) < rule.split_px, "{band:?} at {r_m}");
            }
            if band.level > 1 && band.far_m < rule.rim_m {
                assert!(error(band.level - 1, band.far_m - 1.0) >= rule.split_px, "{band:?} could end sooner");
            }
        }
        assert!(table.bands.len() > 4, "{table:?}");
    }

    #[test]
    fn level_ground_bends_too() {
        let level: Vec<_> = sigma().into_iter().map(|s| SlopeDeviation { sigma: 0.0, ..s }).collect();
        let rule = BandRule { coarse_m: 0.0, ..BandRule::paper(330.0) };
        let of = |reading| BandTable::measured(&DeformedMap::default(), &BandRule { reading, ..rule }, &level);
        assert_eq!(of(MiddleReading::Ground).bands.len(), 1);
        let bent = of(MiddleReading::Hypotenuse);
        assert!(bent.bands.len() > 1 && bent.level_at(15_000.0) > 1 && bent.level_at(150_000.0) == 1, "{bent:?}");
    }

    #[test]
    fn the_ring_and_the_coarse_centre_are_two_numbers() {
        let rule = BandRule { coarse_m: 0.0, ..BandRule::paper(330.0) };
        let map = DeformedMap { ring_m: 20_000.0, eye_m: 10_000.0, ..DeformedMap::default() };
        let none = BandTable::measured(&map, &rule, &sigma());
        let some = BandTable::measured(&map, &BandRule { coarse_m: 3_200.0, ..rule }, &sigma());
        assert_eq!(none.bands.len() + 1, some.bands.len());
        assert_eq!(some.level_at(0.0), 4);
        assert_eq!((some.level_at(3_200.0), none.level_at(0.0)), (none.level_at(3_200.0), none.level_at(3_200.0)));
    }

    #[test]
    fn odd_numbers_make_a_table_all_the_same() {
        let map = DeformedMap::default();
        for rule in [
            BandRule::paper(330.0),
            BandRule { rim_m: 0.0, ..BandRule::paper(330.0) },
            BandRule { coarse_m: 1e9, ..BandRule::paper(1e9) },
        ] {
            let odd = [
                SlopeDeviation { hypotenuse_m: -1.0, sigma: 1.0 },
                SlopeDeviation { hypotenuse_m: 777.0, sigma: 1.0 },
            ];
            let table = BandTable::measured(&map, &rule, &odd);
            assert!((1..=40).contains(&table.level_at(50_000.0)));
            assert!(table.triangles_by_area().is_finite());
        }
    }
}
