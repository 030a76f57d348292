//! Sums of products along rows: where the time goes.

/// Products are summed for so many numbers at a time.
pub(super) const ABREAST: usize = 32;

/// Adds `sign` times the sum of share × what lies `offset` further in `from`, to each number of `to`. At most [`ABREAST`] numbers are
/// read beyond what is needed.
#[inline(always)]
fn add_sums_body(to: &mut [f64], from: &[f64], taps: &[(usize, f64)], sign: f64) {
    let mut rest = to;
    let mut at = 0;
    while !rest.is_empty() {
        let (now, after) = rest.split_at_mut(rest.len().min(ABREAST));
        let from = &from[at..];
        match now.len() {
            0..=8 => add::<8>(now, from, taps, sign),
            9..=16 => add::<16>(now, from, taps, sign),
            _ => add::<ABREAST>(now, from, taps, sign),
        }
        at += now.len();
        rest = after;
    }
}

#[inline(always)]
fn add<const N: usize>(to: &mut [f64], from: &[f64], taps: &[(usize, f64)], sign: f64) {
    let mut sums = [0.0; N];
    for &(offset, share) in taps {
        let from = &from[offset..][..N];
        for k in 0..N {
            sums[k] += share * from[k];
        }
    }
    for (to, sum) in to.iter_mut().zip(sums) {
        *to += sign * sum;
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn add_sums_avx512(to: &mut [f64], from: &[f64], taps: &[(usize, f64)], sign: f64) {
    add_sums_body(to, from, taps, sign);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_sums_avx2(to: &mut [f64], from: &[f64], taps: &[(usize, f64)], sign: f64) {
    add_sums_body(to, from, taps, sign);
}

/// Adds to each number `sign` times the sum of its shares: of what lies as many numbers further in `from` as the taps say. `from` goes
/// on for [`ABREAST`] numbers more. The same bits whichever instructions the processor has.
pub(super) fn add_sums(to: &mut [f64], from: &[f64], taps: &[(usize, f64)], sign: f64) {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor has AVX-512, as just asked.
            return unsafe { add_sums_avx512(to, from, taps, sign) };
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2, as just asked.
            return unsafe { add_sums_avx2(to, from, taps, sign) };
        }
    }
    add_sums_body(to, from, taps, sign);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_and_pieces_change_no_bit() {
        let from: Vec<f64> = (0..400).map(|k| f64::from(k * k).sin()).collect();
        let taps: Vec<(usize, f64)> = (0..40).map(|k| ((k * 37) % 190, (k as f64).cos())).collect();
        for length in 0..150 {
            let start: Vec<f64> = (0..length).map(f64::from).collect();
            let mut plain = start.clone();
            for (k, to) in plain.iter_mut().enumerate() {
                let mut sum = 0.0;
                for &(offset, share) in &taps {
                    sum += share * from[k + offset];
                }
                *to += -0.5 * sum;
            }
            let (mut body, mut fast) = (start.clone(), start);
            add_sums_body(&mut body, &from, &taps, -0.5);
            add_sums(&mut fast, &from, &taps, -0.5);
            assert!(body == plain && fast == plain, "{length}");
        }
    }
}
