//! A made coastal plain with hills, of the extent and the heights of hiraoka's ground.

use yamanami::core::HeightField;
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain};

/// 3,120 by 2,080 m at 5 m.
const SIZE: [usize; 2] = [625, 417];
const SPACING_M: f64 = 5.0;
/// The paper's lowest, mean and highest point, metres.
const HEIGHTS_M: [f64; 3] = [-4.553, 10.618, 65.603];
/// Shares of the form: what rises from the sea in the south-east, crests between valleys, and relief at all scales.
const RISE: f64 = 0.3;
const CRESTS: f64 = 0.5;
const RELIEF: f64 = 0.2;

/// The ground: crests that rise from the coast, the lower part pressed flat until the mean is the paper's.
pub(crate) fn coast() -> HeightField {
    let fractal = |seed: u64, roughness: f32| {
        let shape = Shape::Fractal { relief_m: 1.0, roughness, seed };
        SyntheticTerrain::new(SIZE[0], SIZE[1], shape, Spacing::Metres(SPACING_M)).to_field()
    };
    let field = fractal(11, 0.5);
    let bends = from_zero_to_one(field.heights_m().iter().map(|&z| f64::from(z)));
    let relief = from_zero_to_one(fractal(12, 0.6).heights_m().iter().map(|&z| f64::from(z)));
    let form = from_zero_to_one((0..bends.len()).map(|i| {
        let (column, row) = ((i % SIZE[0]) as f64, (i / SIZE[0]) as f64);
        let rise = 1.0 - 0.5 * (column / SIZE[0] as f64 + row / SIZE[1] as f64);
        // a crest runs where the bends are half high
        let crest = 1.0 - (2.0 * bends[i] - 1.0).abs();
        RISE * rise + CRESTS * crest * crest + RELIEF * relief[i]
    }));
    let [lowest, mean, highest] = HEIGHTS_M;
    let wanted = (mean - lowest) / (highest - lowest);
    // the mean falls as the power grows
    let (mut least, mut most) = (0.1, 20.0);
    for _ in 0..60 {
        let middle = 0.5 * (least + most);
        let found = form.iter().map(|v| v.powf(middle)).sum::<f64>() / form.len() as f64;
        if found > wanted { least = middle } else { most = middle }
    }
    let heights_m = form.iter().map(|v| (lowest + (highest - lowest) * v.powf(least)) as f32).collect();
    HeightField::new(SIZE[0], SIZE[1], heights_m, field.geo().clone())
}

fn from_zero_to_one(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let values: Vec<f64> = values.collect();
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), &v| (low.min(v), high.max(v)));
    values.into_iter().map(|v| (v - low) / (high - low)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coast_has_the_papers_heights() {
        let field = coast();
        let [low, high] = field.range_m().unwrap();
        assert!((f64::from(low) - HEIGHTS_M[0]).abs() < 1e-3 && (f64::from(high) - HEIGHTS_M[2]).abs() < 1e-3);
        let mean = field.heights_m().iter().map(|&z| f64::from(z)).sum::<f64>() / field.heights_m().len() as f64;
        assert!((mean - HEIGHTS_M[1]).abs() < 1e-2, "{mean}");
    }
}
