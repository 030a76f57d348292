//! How likely a bit is, from several contexts at once: each context learns a probability, a small online logistic regression
//! weighs them. Integers only, so that encoder and decoder agree on every machine.
//!
//! Based on: Mahoney, "Adaptive weighing of context models for lossless data compression", 2005.

use super::coder::Bits;
use std::sync::LazyLock;

/// Contexts of a bit.
pub(super) const INPUTS: usize = 6;
/// Logits are in units of 1/256 and lie within ±12.
const MOST_LOGIT: i32 = 12 * 256 - 1;
/// A context's probability is the mean of its bits at first; later, it forgets at this rate.
const SLOWEST: u32 = 255;
const LEARNING_RATE: i32 = 6;

struct Tables {
    /// Probability of 65536 by logit + 3072.
    squash: Vec<u16>,
    /// Logit by the 12 highest bits of a probability.
    stretch: Vec<i16>,
    /// 65536 / (n + 1.6)
    reciprocal: [u32; SLOWEST as usize + 1],
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    // products of doubles are the same everywhere, which library functions need not be
    let step = 1.003_913_889_338_347_6; // e^(1/256)
    let mut power = 1.0f64;
    let mut squash = vec![0u16; 2 * MOST_LOGIT as usize + 2];
    for x in 0..=MOST_LOGIT {
        let p = 65536.0 * power / (power + 1.0);
        squash[(3072 + x) as usize] = p.min(65535.0) as u16;
        squash[(3072 - x) as usize] = (65536.0 - p).max(1.0) as u16;
        power *= step;
    }
    squash[0] = squash[1];
    let stretch = (0..4096u32)
        .map(|p| {
            let at = squash.partition_point(|&s| u32::from(s) < p * 16 + 8) as i32;
            (at - 3072).clamp(-MOST_LOGIT, MOST_LOGIT) as i16
        })
        .collect();
    let reciprocal = std::array::from_fn(|n| (65536.0 / (n as f64 + 1.6)) as u32);
    Tables { squash, stretch, reciprocal }
});

/// What was learnt so far, and the bits.
pub(super) struct Mixing<B> {
    pub(super) bits: B,
    /// By context: probability of a 1 in the 22 highest bits, how often it was used in the lowest ten.
    slots: Vec<u32>,
    weights: Vec<[i32; INPUTS]>,
    tables: &'static Tables,
}

impl<B: Bits> Mixing<B> {
    pub(super) fn new(bits: B, slots: usize, weight_sets: usize) -> Self {
        let weights = vec![[(65536 * 2) / (INPUTS as i32 + 1); INPUTS]; weight_sets];
        Self { bits, slots: vec![1 << 31; slots], weights, tables: &TABLES }
    }

    /// Codes a bit in its contexts, with a set of weights.
    #[inline]
    pub(super) fn code(&mut self, contexts: [usize; INPUTS], weight_set: usize, bit: bool) -> Option<bool> {
        let Tables { squash, stretch, reciprocal } = self.tables;
        let logits = contexts.map(|c| i32::from(stretch[(self.slots[c] >> 20) as usize]));
        let weights = &mut self.weights[weight_set];
        let sum: i64 = (0..INPUTS).map(|i| i64::from(logits[i]) * i64::from(weights[i])).sum();
        let logit = ((sum >> 16) as i32).clamp(-MOST_LOGIT, MOST_LOGIT);
        let one = u32::from(squash[(logit + 3072) as usize]);
        let bit = self.bits.code(one, bit)?;
        let error = ((i32::from(bit) << 16) - one as i32) * LEARNING_RATE;
        for i in 0..INPUTS {
            weights[i] = weights[i].wrapping_add((logits[i] * (error >> 4) + (1 << 11)) >> 12);
        }
        for c in contexts {
            let slot = &mut self.slots[c];
            let (p, n) = (*slot >> 10, *slot & 1023);
            let target = if bit { (1 << 22) - 1 } else { 0i64 };
            let moved = i64::from(p) + (((target - i64::from(p)) * i64::from(reciprocal[n as usize])) >> 16);
            *slot = (moved as u32) << 10 | (n + 1).min(SLOWEST);
        }
        Some(bit)
    }
}
