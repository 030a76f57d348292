//! Colour ramps and the step between stored (sRGB) and linear light.

use glam::Vec3;

/// Stops of a ramp.
pub(crate) const STOPS: usize = 8;

/// A colour ramp: colours at ascending places from 0 to 1, linear light in between.
pub(crate) type Ramp = [(f32, [u8; 3]); STOPS];

/// Heights: dark green valleys, ochre, brown, grey, white peaks. Lightness only grows, so that the order of heights is
/// told apart with any colour vision (a test holds it to that).
pub(crate) const TINT: Ramp = [
    (0.0, [38, 84, 72]),
    (0.12, [66, 110, 78]),
    (0.28, [124, 142, 84]),
    (0.44, [178, 160, 98]),
    (0.60, [190, 168, 132]),
    (0.74, [196, 184, 168]),
    (0.88, [222, 218, 212]),
    (1.0, [252, 252, 250]),
];

/// Levels: Viridis. Based on: Nathaniel Smith, Stéfan van der Walt, "A better default colormap for Matplotlib", 2015.
pub(crate) const LEVELS: Ramp = [
    (0.0, [68, 1, 84]),
    (0.142_857, [70, 50, 127]),
    (0.285_714, [54, 92, 141]),
    (0.428_571, [39, 127, 142]),
    (0.571_429, [31, 161, 135]),
    (0.714_286, [74, 194, 109]),
    (0.857_143, [159, 218, 58]),
    (1.0, [253, 231, 37]),
];

/// Slopes: cream where level, over ochre and brick to a dark violet. Lightness only falls.
pub(crate) const SLOPES: Ramp = [
    (0.0, [252, 248, 226]),
    (0.083_333, [246, 226, 170]),
    (0.166_667, [238, 198, 118]),
    (0.25, [226, 166, 84]),
    (0.416_667, [196, 112, 72]),
    (0.583_333, [152, 70, 74]),
    (0.75, [102, 42, 76]),
    (1.0, [46, 16, 56]),
];

/// Linear light of an sRGB colour.
pub(crate) fn linear(srgb: [u8; 3]) -> Vec3 {
    Vec3::from_array(srgb.map(|v| srgb_to_linear(f32::from(v) / 255.0)))
}

/// Decodes one sRGB channel, 0 to 1.
pub(crate) fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// Encodes one channel of linear light, 0 to 1.
pub(crate) fn linear_to_srgb(v: f32) -> f32 {
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Encodes linear light to bytes by a table.
#[derive(Debug)]
pub(crate) struct SrgbEncoder {
    table: Vec<u8>,
}

impl SrgbEncoder {
    const STEPS: usize = 1 << 14;

    pub(crate) fn new() -> Self {
        let encode = |i| (linear_to_srgb(i as f32 / Self::STEPS as f32) * 255.0 + 0.5) as u8;
        Self { table: (0..=Self::STEPS).map(encode).collect() }
    }

    /// The sRGB byte of a channel; values outside 0 to 1 are clamped.
    #[inline]
    pub(crate) fn byte(&self, linear: f32) -> u8 {
        self.table[((linear.clamp(0.0, 1.0) * Self::STEPS as f32 + 0.5) as usize).min(Self::STEPS)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Machado, Oliveira, Fernandes, "A Physiologically-based Model for Simulation of Color Vision Deficiency", 2009:
    /// rows of the matrices for full protanopia, deuteranopia and tritanopia, on linear light.
    const DEFICIENCIES: [[[f32; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
    ];

    fn lightness(linear: Vec3) -> f32 {
        116.0 * linear.dot(Vec3::new(0.2126, 0.7152, 0.0722)).max(0.0).cbrt() - 16.0
    }

    #[test]
    fn ramps_grow_lighter_for_every_kind_of_colour_vision() {
        let mut slopes = SLOPES.map(|(place, colour)| (1.0 - place, colour));
        slopes.reverse();
        for ramp in [TINT, LEVELS, slopes] {
            for rows in DEFICIENCIES {
                let seen = |stop: usize| {
                    let colour = linear(ramp[stop].1);
                    lightness(Vec3::from_array(rows.map(|row| Vec3::from_array(row).dot(colour))))
                };
                for stop in 1..STOPS {
                    let rise = seen(stop) - seen(stop - 1);
                    assert!(rise > 2.5, "stop {stop} of {ramp:?} rises by {rise}");
                    assert!(ramp[stop].0 > ramp[stop - 1].0);
                }
            }
        }
    }

    #[test]
    fn every_byte_survives_decoding_and_encoding() {
        let encoder = SrgbEncoder::new();
        for v in 0..=255u8 {
            assert_eq!(encoder.byte(srgb_to_linear(f32::from(v) / 255.0)), v);
        }
        assert_eq!(encoder.byte(f32::NAN), 0);
    }
}
