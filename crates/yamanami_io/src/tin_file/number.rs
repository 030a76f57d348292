//! Metres as a number of the file's unit, such that reading it gives the same metres, bit for bit.
//!
//! Of all numbers that do, the one with the shortest decimal text is taken (shortest in the sense of G. L. Steele and
//! J. L. White, "How to print floating-point numbers accurately", 1990): mostly the digits that the file had.

use std::fmt::Write;

/// How far to search, in neighbouring doubles. The products of this many neighbours with a unit are all different.
const REACH: usize = 4;

/// The number whose product with `unit_m` is `metres` and whose decimal text is shortest; print it with `{}`.
///
/// Not all doubles are the product of a double and a unit; for one that is not, and so was not read from a file in that
/// unit, the nearest quotient comes out, an error of one unit in the last place.
pub(super) fn in_unit(metres: f64, unit_m: f64) -> f64 {
    let quotient = metres / unit_m;
    if unit_m == 1.0 || metres == 0.0 || !quotient.is_finite() {
        return quotient;
    }
    let fits = |number: &f64| number * unit_m == metres;
    let up = std::iter::successors(Some(quotient), |n| Some(n.next_up())).take(REACH);
    let down = std::iter::successors(Some(quotient.next_down()), |n| Some(n.next_down())).take(REACH);
    up.chain(down).filter(fits).min_by_key(|&number| text_length(number)).unwrap_or(quotient)
}

/// Characters of a number's decimal text.
fn text_length(number: f64) -> usize {
    struct Count(usize);
    impl Write for Count {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            self.0 += text.len();
            Ok(())
        }
    }
    let mut count = Count(0);
    // counting cannot fail
    let _ = write!(count, "{number}");
    count.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use yamanami_core::{FOOT_M, US_SURVEY_FOOT_M};

    #[test]
    fn the_digits_of_a_file_come_back() {
        for unit_m in [1.0, FOOT_M, US_SURVEY_FOOT_M, 0.001, 0.0254, 1609.344] {
            for text in ["4355.806943", "-0.02", "1069494.21655", "835771.71105957", "0", "-0", "570.3"] {
                let metres = text.parse::<f64>().unwrap() * unit_m;
                assert_eq!(in_unit(metres, unit_m).to_string(), text, "unit {unit_m}");
            }
        }
    }

    proptest! {
        #[test]
        fn what_was_read_is_read_again(
            bits in any::<u64>(),
            unit_m in prop::sample::select(vec![1.0, FOOT_M, US_SURVEY_FOOT_M, 0.001, 0.01, 0.0254, 1000.0, 1609.344]),
        ) {
            let metres = f64::from_bits(bits) * unit_m;
            prop_assume!(metres.is_finite());
            let text = in_unit(metres, unit_m).to_string();
            let again = text.parse::<f64>().unwrap() * unit_m;
            // below the normal numbers a quotient has fewer digits than the metres
            prop_assert!(again.to_bits() == metres.to_bits() || metres.abs() < 1e-300, "{metres} {text} {again}");
        }

        #[test]
        fn decimals_keep_their_digits(thousandths in -2_000_000_000i64..2_000_000_000, survey in any::<bool>()) {
            let unit_m = if survey { US_SURVEY_FOOT_M } else { FOOT_M };
            let number = thousandths as f64 / 1000.0;
            prop_assert_eq!(in_unit(number * unit_m, unit_m).to_string(), number.to_string());
        }

        #[test]
        fn any_metres_come_back_to_the_last_place(metres in -1e8..1e8f64) {
            let again = in_unit(metres, FOOT_M) * FOOT_M;
            prop_assert!(again == metres || again == metres.next_up() || again == metres.next_down());
        }
    }
}
