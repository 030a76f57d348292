//! A made coastal plain with hills, of the extent and the heights of hiraoka's ground.

use yamanami::core::HeightField;
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain};

/// 3,120 by 2,080 m at 5 m.
const SIZE: [usize; 2] = [625, 417];
const SPACING_M: f64 = 5.0;
/// The paper's lowest, mean and highest point, metres.
const HEIGHTS_M: [f64; 3] = [-4.553, 10.618, 65.603];
/// Share of the form that rises from the sea in the south-east; the rest is relief at all scales.
const RISE: f64 = 0.4;

/// The ground: fractal relief that rises from the coast, its lower part pressed flat until the mean is the paper's.
pub(crate) fn coast() -> HeightField {
    let shape = Shape::Fractal { relief_m: 1.0, roughness: 0.5, seed: 11 };
    let field = SyntheticTerrain::new(SIZE[0], SIZE[1], shape, Spacing::Metres(SPACING_M)).to_field();
    let rise = |i: usize| {
        let (column, row) = ((i % SIZE[0]) as f64, (i / SIZE[0]) as f64);
        1.0 - 0.5 * (column / SIZE[0] as f64 + row / SIZE[1] as f64)
    };
    let mut form: Vec<f64> =
        field.heights_m().iter().enumerate().map(|(i, &z)| (1.0 - RISE) * f64::from(z) + RISE * rise(i)).collect();
    let (low, high) = form.iter().fold((f64::MAX, f64::MIN), |(low, high), &v| (low.min(v), high.max(v)));
    form.iter_mut().for_each(|v| *v = (*v - low) / (high - low));
    let [lowest, mean, highest] = HEIGHTS_M;
    let wanted = (mean - lowest) / (highest - lowest);
    // the mean falls as the power grows
    let (mut least, mut most) = (0.1, 20.0);
    for _ in 0..60 {
        let middle = 0.5 * (least + most);
        let found = form.iter().map(|v: &f64| v.powf(middle)).sum::<f64>() / form.len() as f64;
        if found > wanted { least = middle } else { most = middle }
    }
    let heights_m = form.iter().map(|v| (lowest + (highest - lowest) * v.powf(least)) as f32).collect();
    HeightField::new(SIZE[0], SIZE[1], heights_m, field.geo().clone())
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
