//! Fractal relief of any size, a row at a time.
//!
//! Octaves of value noise on halving lattices, each worth a fixed share of the one above, so the spectrum falls with
//! frequency as real relief's does. Lattice values are hashes of their place, so any window can be made alone, in any order,
//! without holding the rest.
//!
//! Based on: Mandelbrot, Van Ness, "Fractional Brownian motions, fractional noises and applications", 1968;
//! Perlin, "An image synthesizer", 1985.

use crate::rng::{scramble, unit_from_bits};

/// Longest lattice step in samples, as a power of two: larger grids repeat no pattern but have no longer waves.
const LONGEST_WAVE_LOG2: u32 = 12;

#[derive(Debug, Clone)]
pub(crate) struct Fractal {
    seed: u64,
    octaves: Vec<Octave>,
}

#[derive(Debug, Clone)]
struct Octave {
    /// Lattice step is `2^log2` samples.
    log2: u32,
    amplitude_m: f32,
    /// Blend weight of the next lattice value, for each sample of a lattice step.
    fade: Vec<f32>,
}

impl Fractal {
    /// Relief of roughly `relief_m` from valley to peak; an octave has `roughness` (0…1) times the amplitude of the one
    /// of twice its wavelength.
    pub(crate) fn new(longer_side: usize, relief_m: f32, roughness: f32, seed: u64) -> Self {
        let longest = (longer_side.max(4) / 2).next_power_of_two().trailing_zeros().clamp(1, LONGEST_WAVE_LOG2);
        let mut octaves = Vec::new();
        let mut amplitude = 1.0f32;
        for log2 in (0..=longest).rev() {
            octaves.push(Octave { log2, amplitude_m: amplitude, fade: fade_weights(log2) });
            amplitude *= roughness;
        }
        let total: f32 = octaves.iter().map(|o| o.amplitude_m).sum();
        for octave in &mut octaves {
            octave.amplitude_m *= relief_m / total;
        }
        Self { seed, octaves }
    }

    /// Adds the relief of `row`, from `column` on, to `out`.
    pub(crate) fn add_row(&self, row: usize, column: usize, out: &mut [f32]) {
        for octave in &self.octaves {
            octave.add_row(self.seed, row, column, out);
        }
    }
}

impl Octave {
    fn add_row(&self, seed: u64, row: usize, column: usize, out: &mut [f32]) {
        let step = 1usize << self.log2;
        let (lattice_row, blend) = (row >> self.log2, self.fade[row & (step - 1)]);
        let value = |x: usize| {
            let north = lattice_value(seed, self.log2, x, lattice_row);
            // on a lattice row the southern value has no weight: spare half the hashes of the finest octave
            let south = if blend == 0.0 { north } else { lattice_value(seed, self.log2, x, lattice_row + 1) };
            self.amplitude_m * (north + (south - north) * blend)
        };
        let mut x = column >> self.log2;
        let mut phase = column & (step - 1);
        let mut west = value(x);
        let mut rest = out;
        while !rest.is_empty() {
            let east = value(x + 1);
            let (run, after) = rest.split_at_mut((step - phase).min(rest.len()));
            for (z, fade) in run.iter_mut().zip(&self.fade[phase..]) {
                *z += west + (east - west) * fade;
            }
            (rest, west, phase) = (after, east, 0);
            x += 1;
        }
    }
}

/// Perlin's quintic fade, sampled over one lattice step.
fn fade_weights(log2: u32) -> Vec<f32> {
    let step = 1u32 << log2;
    let fade = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    (0..step).map(|i| fade(f64::from(i) / f64::from(step)) as f32).collect()
}

/// A value in 0…1 for a place on a lattice.
#[inline]
fn lattice_value(seed: u64, log2: u32, x: usize, y: usize) -> f32 {
    let place = (x as u64) << 32 | (y as u64 & 0xFFFF_FFFF);
    unit_from_bits(scramble(scramble(seed ^ u64::from(log2) << 56) ^ place.wrapping_mul(0x9E37_79B9_7F4A_7C15))) as f32
}
