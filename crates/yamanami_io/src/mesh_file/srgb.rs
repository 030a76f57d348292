//! Colours between the curve that files of scans store (sRGB) and the linear light that glTF wants.
//!
//! Based on: IEC 61966-2-1, 1999.

/// The sRGB byte of a share of full light.
pub(super) fn byte_of_linear(share: f64) -> u8 {
    let c = share.clamp(0.0, 1.0);
    let curved = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (curved * 255.0).round() as u8
}

/// The share of full light of an sRGB byte.
pub(super) fn linear_of_byte(byte: u8) -> f64 {
    let c = f64::from(byte) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// The same in sixteen bits.
pub(crate) fn linear_word_of_byte(byte: u8) -> u16 {
    (linear_of_byte(byte) * 65535.0).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back_through_sixteen_bits() {
        for byte in 0..=255 {
            let word = (linear_of_byte(byte) * 65535.0).round();
            assert_eq!(byte_of_linear(word / 65535.0), byte);
        }
    }
}
