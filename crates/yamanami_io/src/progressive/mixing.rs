//! How likely a bit is, from several contexts at once: each context learns a probability, a small online logistic regression
//! weighs them. Only sums and products in a fixed order, so that encoder and decoder agree on every machine.
//!
//! Based on: Mahoney, "Adaptive weighing of context models for lossless data compression", 2005.

use super::coder::Bits;
use std::sync::LazyLock;

/// Contexts of a bit.
pub(super) const INPUTS: usize = 6;
/// Those, and one that is always there.
const LANES: usize = 8;
/// Logits lie within ±12 and are told apart by 1/256.
const MOST_LOGIT: f32 = 12.0;
const LOGITS: usize = 2 * 3072;
/// A context's probability is the mean of its bits at first; later, it forgets at this rate.
const SLOWEST: u32 = 255;
const LEARNING_RATE: f32 = 0.02;
const FIRST_WEIGHT: f32 = 0.3;

struct Tables {
    /// Probability of 65536 by logit.
    squash: [u16; LOGITS],
    /// Logit by the 12 highest bits of a probability.
    stretch: [f32; 4096],
    /// 65536 / (n + 1.6)
    reciprocal: [u32; SLOWEST as usize + 1],
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    // products of doubles are the same everywhere, which library functions need not be
    let step = 1.003_913_889_338_347_6; // e^(1/256)
    let mut power = 1.0f64;
    let mut squash = [1u16; LOGITS];
    for x in 0..LOGITS / 2 {
        let p = 65536.0 * power / (power + 1.0);
        squash[LOGITS / 2 + x] = p.min(65535.0) as u16;
        squash[LOGITS / 2 - x] = (65536.0 - p).max(1.0) as u16;
        power *= step;
    }
    let stretch = std::array::from_fn(|p| {
        let at = squash.partition_point(|&s| u32::from(s) < p as u32 * 16 + 8);
        (at as f32 - LOGITS as f32 / 2.0) / 256.0
    });
    let reciprocal = std::array::from_fn(|n| (65536.0 / (n as f64 + 1.6)) as u32);
    Tables { squash, stretch, reciprocal }
});

/// What was learnt so far, and the bits.
pub(super) struct Mixing<B> {
    pub(super) bits: B,
    /// By context: probability of a 1 in the 22 highest bits, how often it was used in the lowest ten.
    slots: Vec<u32>,
    weights: Vec<[f32; LANES]>,
    tables: &'static Tables,
}

impl<B: Bits> Mixing<B> {
    pub(super) fn new(bits: B, slots: usize, weight_sets: usize) -> Self {
        let mut first = [FIRST_WEIGHT; LANES];
        first[INPUTS..].fill(0.0);
        Self { bits, slots: vec![1 << 31; slots], weights: vec![first; weight_sets], tables: &TABLES }
    }

    /// Codes a bit in its contexts, with a set of weights.
    #[inline]
    pub(super) fn code(&mut self, contexts: [usize; INPUTS], weight_set: usize, bit: bool) -> Option<bool> {
        let Tables { squash, stretch, reciprocal } = self.tables;
        let mut logits = [0f32; LANES];
        for i in 0..INPUTS {
            logits[i] = stretch[(self.slots[contexts[i]] >> 20) as usize];
        }
        logits[INPUTS] = 0.3;
        let weights = &mut self.weights[weight_set];
        let each: [f32; LANES] = std::array::from_fn(|i| logits[i] * weights[i]);
        let half: [f32; 4] = std::array::from_fn(|i| each[i] + each[i + 4]);
        let logit = (half[0] + half[1]) + (half[2] + half[3]);
        let at = (logit.clamp(-MOST_LOGIT, MOST_LOGIT) * 256.0) as i32 + LOGITS as i32 / 2;
        let one = u32::from(squash[(at as usize).clamp(1, LOGITS - 1)]);
        let bit = self.bits.code(one, bit)?;
        let error = (((i32::from(bit) << 16) - one as i32) as f32) * (LEARNING_RATE / 65536.0);
        for i in 0..LANES {
            weights[i] += logits[i] * error;
        }
        for c in contexts {
            let slot = &mut self.slots[c];
            let (p, n) = (*slot >> 10, *slot & 1023);
            let rate = i64::from(reciprocal[n as usize & 255]);
            let target = if bit { (1 << 22) - 1 } else { 0i64 };
            let moved = i64::from(p) + (((target - i64::from(p)) * rate) >> 16);
            *slot = (moved as u32) << 10 | (n + 1).min(SLOWEST);
        }
        Some(bit)
    }
}
