//! Ascending numbers of vertices that other pages brought, as runs of near neighbours.

use crate::store::bits::{put_varint, take_varint};

/// A number so far from the one before begins a run of its own: a page's numbers come from a few ancestors.
const FAR: u32 = 256;

/// A run: from the end of the one before to its first number, and how many follow the first.
type Run = (u32, u32);

/// Appends the runs of ascending numbers, and the residuals of those that begin none.
pub(super) fn split(numbers: &[u32], runs: &mut Vec<u8>, residuals: &mut Vec<i32>) {
    let mut last = 0;
    for run in numbers.chunk_by(|a, b| b - a < FAR) {
        put_varint(runs, (run[0] - last).into());
        put_varint(runs, run.len() as u64 - 1);
        residuals.extend(run.windows(2).map(|pair| (pair[1] - pair[0]) as i32 - 1));
        last = run[run.len() - 1];
    }
}

/// Takes the runs of `count` numbers off the front.
pub(super) fn take_runs(bytes: &mut &[u8], count: u32) -> Option<Vec<Run>> {
    let mut runs = Vec::new();
    let mut left = count;
    while left > 0 {
        let start = u32::try_from(take_varint(bytes)?).ok()?;
        let more = u32::try_from(take_varint(bytes)?).ok()?;
        left = left.checked_sub(more.checked_add(1)?)?;
        runs.push((start, more));
    }
    Some(runs)
}

/// How many residuals runs have.
pub(super) fn residual_count(runs: &[Run]) -> usize {
    runs.iter().map(|&(_, more)| more as usize).sum()
}

/// Undoes [`split`]; `None` when a number is out of bounds.
pub(super) fn join(runs: &[Run], residuals: &[i32]) -> Option<Vec<u32>> {
    let mut numbers = Vec::with_capacity(runs.len() + residuals.len());
    let mut residuals = residuals.iter();
    let mut last = 0u32;
    for &(start, more) in runs {
        if start == 0 && !numbers.is_empty() {
            return None;
        }
        last = last.checked_add(start)?;
        numbers.push(last);
        for &residual in residuals.by_ref().take(more as usize) {
            last = last.checked_add(u32::try_from(residual).ok()?)?.checked_add(1)?;
            numbers.push(last);
        }
    }
    Some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_come_back(mut numbers in proptest::collection::vec(prop_oneof![any::<u32>(), 0u32..3000], 0..200)) {
            numbers.sort_unstable();
            numbers.dedup();
            let (mut bytes, mut residuals) = (Vec::new(), Vec::new());
            split(&numbers, &mut bytes, &mut residuals);
            let mut rest = bytes.as_slice();
            let runs = take_runs(&mut rest, numbers.len() as u32).unwrap();
            prop_assert!(rest.is_empty());
            prop_assert_eq!(residual_count(&runs), residuals.len());
            prop_assert_eq!(join(&runs, &residuals), Some(numbers));
        }
    }
}
