//! What the database stores of a terrain, and how a node's error is written in 16 bits.
//!
//! A page is a tile of one level's lattice: [`PAGE_CELLS`]² squares and the points at their corners, including the
//! shared right and lower border, so that a page can be used without its neighbours.

/// Squares along the side of a page.
pub const PAGE_CELLS: u32 = 256;

/// A page's place: tile (x, y) of a level's lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PageId {
    /// log₂ of the spacing in samples.
    pub level: u32,
    /// Tile column.
    pub x: u32,
    /// Tile row.
    pub y: u32,
}

/// One tile of one level: `width` × `height` lattice points from (`PAGE_CELLS`·x, `PAGE_CELLS`·y) on.
#[derive(Debug, Clone, PartialEq)]
pub struct TerrainPage {
    /// Place.
    pub id: PageId,
    /// Points across, at most `PAGE_CELLS + 1`.
    pub width: u32,
    /// Points down, at most `PAGE_CELLS + 1`.
    pub height: u32,
    /// Heights in metres at all points, row by row. Never NaN: holes carry a filled height and are told by `shown`.
    pub heights_m: Vec<f32>,
    /// Error code at all points, row by row; 0 at points that belong to a coarser level.
    pub errors: Vec<ErrorCode>,
    /// For each square (`width - 1` × `height - 1`, row by row) bit 0 / bit 1: its upper right / lower left triangle
    /// holds data. Empty when the whole surface has no hole.
    pub shown: Vec<u8>,
}

/// An error in metres in 16 bits: a float of 5 exponent and 11 fraction bits, always rounded up, order-preserving.
///
/// Zero stays zero; anything above is at least 2⁻¹² m (0.24 mm) and at most 2²⁰ m; in between the code is at most 0.05 %
/// above the value. Comparing codes compares errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Hash)]
pub struct ErrorCode(pub u16);

impl ErrorCode {
    const FRACTION_BITS: u32 = 11;
    const SHIFT: u32 = 23 - Self::FRACTION_BITS;
    /// Bits of 2⁻¹², less one step so that code 1 is 2⁻¹² itself.
    const BIAS: u32 = ((127 - 12) << Self::FRACTION_BITS) - 1;

    /// The least code not below `error_m` (which is not negative; NaN counts as infinite).
    #[inline]
    pub fn ceil(error_m: f32) -> Self {
        if error_m <= 0.0 {
            return Self(0);
        }
        let up = error_m.to_bits().saturating_add((1 << Self::SHIFT) - 1) >> Self::SHIFT;
        Self(up.saturating_sub(Self::BIAS).clamp(1, 0xFFFF) as u16)
    }

    /// The error in metres that the code stands for.
    #[inline]
    pub fn to_m(self) -> f32 {
        if self.0 == 0 {
            return 0.0;
        }
        f32::from_bits((u32::from(self.0) + Self::BIAS) << Self::SHIFT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_round_up_by_little_and_keep_order() {
        let mut last = ErrorCode(0);
        let mut z = 1e-5f32;
        while z < 9e5 {
            let code = ErrorCode::ceil(z);
            assert!(code >= last);
            assert!(code.to_m() >= z, "{z}");
            assert!(code.to_m() <= z.max(1.0 / 4096.0) * 1.000_5, "{z} {}", code.to_m());
            assert_eq!(ErrorCode::ceil(code.to_m()), code);
            last = code;
            z *= 1.000_37;
        }
        assert_eq!(ErrorCode::ceil(0.0).to_m(), 0.0);
        assert_eq!(ErrorCode::ceil(f32::NAN), ErrorCode(0xFFFF));
        assert_eq!(ErrorCode::ceil(f32::INFINITY), ErrorCode(0xFFFF));
    }
}
