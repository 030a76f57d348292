//! The grid of heights that a file can hold.
//!
//! Survey data are whole metres, decimetres, centimetres or binary fractions far more often than arbitrary floats; such
//! heights are stored as integers, exactly. A stated maximum error makes any heights integers. The rest are stored by
//! their bits.

/// Which heights a file holds and as which integers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Quantum {
    /// Multiples of 1/n metre, as near as `f32` comes: exact for data of that kind.
    PerMetre(u32),
    /// Multiples of a step in metres, chosen for a maximum error.
    Step(f64),
    /// Any finite `f32`, as an integer that keeps the order.
    Bits,
}

/// Denominators tried, each step a multiple of some earlier one.
const DENOMINATORS: [u32; 18] = [1, 2, 4, 5, 8, 10, 16, 20, 32, 50, 64, 100, 128, 200, 256, 500, 1000, 1024];
/// Integers up to this are exact in `f32`.
const EXACT: f32 = 16_777_216.0;

impl Quantum {
    /// The integer of a height; `None` when the height is not on the grid (or not finite).
    #[inline]
    pub fn index(self, height_m: f32) -> Option<i32> {
        let index = self.nearest(height_m)?;
        (self.height_m(index) == height_m).then_some(index)
    }

    /// The integer of the grid's nearest height.
    #[inline]
    fn nearest(self, height_m: f32) -> Option<i32> {
        if !height_m.is_finite() {
            return None;
        }
        match self {
            Self::PerMetre(n) => {
                let index = (f64::from(height_m) * f64::from(n)).round();
                (index.abs() <= f64::from(EXACT)).then_some(index as i32)
            }
            Self::Step(step_m) => {
                let index = (f64::from(height_m) / step_m).round();
                (index.abs() < 2f64.powi(30)).then_some(index as i32)
            }
            Self::Bits => {
                let bits = height_m.to_bits() as i32;
                Some(if bits < 0 { bits ^ i32::MAX } else { bits })
            }
        }
    }

    /// The height of an integer.
    #[inline]
    pub fn height_m(self, index: i32) -> f32 {
        match self {
            Self::PerMetre(n) => index as f32 / n as f32,
            Self::Step(step_m) => (f64::from(index) * step_m) as f32,
            Self::Bits => f32::from_bits(if index < 0 { index ^ i32::MAX } else { index } as u32),
        }
    }

    /// Appends the heights of integers; `None` when one of them is no height's.
    #[inline]
    pub(super) fn extend_heights(self, indices: &[i32], heights_m: &mut Vec<f32>) -> Option<()> {
        let greatest = indices.iter().fold(0, |greatest, i| i.unsigned_abs().max(greatest));
        match self {
            // a power of two divides exactly as its reciprocal multiplies
            Self::PerMetre(n) if n.is_power_of_two() => {
                let step_m = 1.0 / n as f32;
                heights_m.extend(indices.iter().map(|&i| i as f32 * step_m));
            }
            Self::PerMetre(n) => heights_m.extend(indices.iter().map(|&i| i as f32 / n as f32)),
            Self::Step(step_m) => heights_m.extend(indices.iter().map(|&i| (f64::from(i) * step_m) as f32)),
            Self::Bits => {
                let before = heights_m.len();
                heights_m.extend(indices.iter().map(|&i| self.height_m(i)));
                return heights_m[before..].iter().all(|z| z.is_finite()).then_some(());
            }
        }
        (greatest <= self.greatest_index()).then_some(())
    }

    /// Whether every integer's height is a number.
    pub(super) fn is_sound(self) -> bool {
        match self {
            Self::PerMetre(n) => (1..=EXACT as u32).contains(&n),
            Self::Step(step_m) => (1e-9..=1e6).contains(&step_m),
            Self::Bits => true,
        }
    }

    /// Largest magnitude of an integer that is a height's.
    fn greatest_index(self) -> u32 {
        match self {
            Self::PerMetre(_) => EXACT as u32,
            Self::Step(_) => (1 << 30) - 1,
            Self::Bits => u32::MAX,
        }
    }

    /// Puts heights on the grid: exactly what will be read back. Heights that cannot be are left alone.
    pub fn quantise(self, heights_m: &mut [f32]) {
        for z in heights_m {
            if let Some(index) = self.nearest(*z) {
                *z = self.height_m(index);
            }
        }
    }

    /// The integers of many heights, in a loop without branches; the first height off the grid as an error.
    pub(super) fn indices(self, heights_m: &[f32]) -> Result<Vec<i32>, f32> {
        let wrong = |i: i32, z: f32| (self.height_m(i) != z) as u8;
        let (mut out, mut off) = (Vec::with_capacity(heights_m.len()), 0u8);
        match self {
            Self::PerMetre(n) => {
                // rounds by truncation, which every processor does four at a time
                let nearest = |v: f32| (v + 0.5f32.copysign(v)) as i32;
                out.extend(heights_m.iter().map(|&z| nearest(z * n as f32)));
                for (&i, &z) in out.iter().zip(heights_m) {
                    off |= wrong(i, z) | u8::from(i.unsigned_abs() > EXACT as u32);
                }
            }
            _ => {
                out.extend(heights_m.iter().map(|&z| self.nearest(z).unwrap_or(0)));
                for (&i, &z) in out.iter().zip(heights_m) {
                    off |= wrong(i, z);
                }
            }
        }
        if off == 0 {
            return Ok(out);
        }
        // products in f32 may miss by one where the slow way does not
        heights_m.iter().map(|&z| self.index(z).ok_or(z)).collect()
    }
}

/// Watches heights go by and tells the coarsest quantum that holds all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuantumFinder {
    denominator: Option<u32>,
    range_m: [f32; 2],
}

impl Default for QuantumFinder {
    fn default() -> Self {
        Self { denominator: Some(1), range_m: [f32::INFINITY, f32::NEG_INFINITY] }
    }
}

impl QuantumFinder {
    /// Takes heights in; NaN (no data) does not count.
    pub fn add(&mut self, heights_m: &[f32]) {
        for &z in heights_m {
            // written so that NaN changes nothing
            if z < self.range_m[0] {
                self.range_m[0] = z;
            }
            if z > self.range_m[1] {
                self.range_m[1] = z;
            }
        }
        let mut rest = heights_m;
        while let Some(n) = self.denominator {
            let fits = |z: f32| z.is_nan() || Quantum::PerMetre(n).index(z).is_some();
            let Some(first) = rest.iter().position(|&z| !fits(z)) else { break };
            rest = &rest[first..];
            self.denominator = DENOMINATORS
                .into_iter()
                .find(|&d| d > n && d.is_multiple_of(n) && Quantum::PerMetre(d).index(rest[0]).is_some());
        }
        self.check_reach();
    }

    /// Takes in what another finder has seen.
    pub fn merge(&mut self, other: &Self) {
        self.range_m = [self.range_m[0].min(other.range_m[0]), self.range_m[1].max(other.range_m[1])];
        self.denominator = match (self.denominator, other.denominator) {
            (Some(a), Some(b)) => DENOMINATORS.into_iter().find(|d| d.is_multiple_of(a) && d.is_multiple_of(b)),
            _ => None,
        };
        self.check_reach();
    }

    /// Integers beyond 2^24 are no longer exact.
    fn check_reach(&mut self) {
        let max_abs_m = self.max_abs_m();
        self.denominator = self.denominator.filter(|&n| max_abs_m * n as f32 <= EXACT);
    }

    fn max_abs_m(&self) -> f32 {
        self.range_m[1].max(-self.range_m[0]).max(0.0)
    }

    /// Lowest and highest height seen; `None` before the first.
    pub fn range_m(&self) -> Option<[f32; 2]> {
        (self.range_m[0] <= self.range_m[1]).then_some(self.range_m)
    }

    /// The quantum that loses nothing.
    pub fn lossless(&self) -> Quantum {
        self.denominator.map_or(Quantum::Bits, Quantum::PerMetre)
    }

    /// The coarsest quantum that keeps every height within `max_error_m`; the lossless one where that is coarser, or where
    /// the error asked for is too small to gain anything.
    pub fn within(&self, max_error_m: f64) -> Quantum {
        let lossless = self.lossless();
        // a height is rounded to f32 after it is rounded to the step
        let rounding_m = f64::from(self.max_abs_m()) * 2f64.powi(-24);
        let step_m = 2.0 * (max_error_m - rounding_m);
        let finer = match lossless {
            Quantum::PerMetre(n) => step_m <= 1.0 / f64::from(n),
            _ => false,
        };
        if step_m <= 16.0 * rounding_m || !Quantum::Step(step_m).is_sound() || finer {
            return lossless;
        }
        Quantum::Step(step_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn usual_data_are_recognised() {
        let of = |z: &[f32]| {
            let mut finder = QuantumFinder::default();
            finder.add(z);
            finder.lossless()
        };
        assert_eq!(of(&[0.0, 812.0, -3.0, f32::NAN]), Quantum::PerMetre(1));
        assert_eq!(of(&[1.5, 812.0]), Quantum::PerMetre(2));
        assert_eq!(of(&[1.5, 812.1]), Quantum::PerMetre(10));
        assert_eq!(of(&[1.25, 812.1]), Quantum::PerMetre(20));
        assert_eq!(of(&[1.23, 3776.12]), Quantum::PerMetre(100));
        assert_eq!(of(&[0.123, 3776.124]), Quantum::PerMetre(1000));
        assert_eq!(of(&[0.015_625]), Quantum::PerMetre(64));
        assert_eq!(of(&[std::f32::consts::PI, 1.0]), Quantum::Bits);
        assert_eq!(of(&[0.001, 20_000.0]), Quantum::Bits);
        assert_eq!(of(&[]), Quantum::PerMetre(1));
    }

    proptest! {
        #[test]
        fn bits_hold_every_finite_height_in_order(a in any::<f32>(), b in any::<f32>()) {
            let indices = [a, b].map(|z| Quantum::Bits.index(z));
            if let [Some(i), Some(k)] = indices {
                prop_assert_eq!(Quantum::Bits.height_m(i).to_bits(), a.to_bits());
                prop_assert!(a == b || (a < b) == (i < k));
            } else {
                prop_assert!(!a.is_finite() || !b.is_finite());
            }
        }

        #[test]
        fn a_stated_error_is_kept(heights in proptest::collection::vec(-9000f32..9000.0, 1..50), max_error_m in 1e-4f64..100.0) {
            let mut finder = QuantumFinder::default();
            finder.add(&heights);
            let quantum = finder.within(max_error_m);
            let mut decoded = heights.clone();
            quantum.quantise(&mut decoded);
            for (z, d) in heights.iter().zip(&decoded) {
                prop_assert!((f64::from(*z) - f64::from(*d)).abs() <= max_error_m);
                prop_assert!(quantum.index(*d).is_some(), "{quantum:?} {d}");
            }
        }

        #[test]
        fn decimals_are_exact(values in proptest::collection::vec(-400_000i32..400_000, 1..50), places in 0u32..3) {
            let n = 10u32.pow(places);
            let heights: Vec<f32> = values.iter().map(|&v| (f64::from(v) / f64::from(n)) as f32).collect();
            let mut whole = QuantumFinder::default();
            whole.add(&heights);
            let (mut left, mut right) = (QuantumFinder::default(), QuantumFinder::default());
            let (a, b) = heights.split_at(heights.len() / 2);
            left.add(a);
            right.add(b);
            left.merge(&right);
            for quantum in [whole.lossless(), left.lossless()] {
                prop_assert!(matches!(quantum, Quantum::PerMetre(d) if n.is_multiple_of(d)), "{quantum:?}");
                prop_assert!(quantum.indices(&heights).is_ok());
            }
        }
    }
}
