//! Which triangles of a page hold data, to bytes and back: two bits a square, each coded from its neighbours.

use super::binary::{BinaryDecoder, BinaryEncoder, Probability};

const CONTEXTS: usize = 1 << 10;

/// What the squares around say of the two bits of square (x, y).
fn context(shown: &[u8], columns: usize, x: usize, y: usize) -> usize {
    let at = |dx: isize, dy: isize| -> usize {
        let (x, y) = (x as isize + dx, y as isize + dy);
        if x < 0 || y < 0 || x >= columns as isize { 3 } else { usize::from(shown[y as usize * columns + x as usize]) }
    };
    at(-1, 0) | at(0, -1) << 2 | at(-1, -1) << 4 | at(1, -1) << 6
}

/// A context with the bit of the square that is already known: `half` 0 first, then 1.
fn bit_context(context: usize, half: usize, first_bit: usize) -> usize {
    context | half << 8 | (half & first_bit) << 9
}

/// Codes two bits a square.
pub(super) fn encode(shown: &[u8], columns: usize) -> Vec<u8> {
    let mut probabilities = [Probability::EVEN; CONTEXTS];
    let mut encoder = BinaryEncoder::new();
    for (i, &square) in shown.iter().enumerate() {
        let around = context(shown, columns, i % columns, i / columns);
        for half in 0..2 {
            let p = &mut probabilities[bit_context(around, half, usize::from(square & 1))];
            encoder.put(square >> half & 1 == 1, p);
        }
    }
    encoder.finish()
}

/// Undoes [`encode`] for `count` squares; `None` when the bytes do not end where the squares do.
pub(super) fn decode(bytes: &[u8], columns: usize, count: usize) -> Option<Vec<u8>> {
    let mut probabilities = [Probability::EVEN; CONTEXTS];
    let mut decoder = BinaryDecoder::new(bytes)?;
    let mut shown = vec![0u8; count];
    for i in 0..count {
        let around = context(&shown, columns, i % columns, i / columns);
        let mut square = 0;
        for half in 0..2 {
            let p = &mut probabilities[bit_context(around, half, usize::from(square & 1))];
            square |= u8::from(decoder.get(p)) << half;
        }
        shown[i] = square;
    }
    decoder.is_exhausted().then_some(shown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn squares_come_back(columns in 1usize..40, rows in 1usize..40, seed in any::<u32>(), rough in 1u32..30) {
            let shown: Vec<u8> = (0..columns * rows)
                .map(|i| {
                    let (x, y) = ((i % columns) as u32, (i / columns) as u32);
                    ((x / rough * 31 + y / rough * 17).wrapping_mul(2_654_435_761).wrapping_add(seed) >> 28 & 3) as u8
                })
                .collect();
            let bytes = encode(&shown, columns);
            prop_assert_eq!(decode(&bytes, columns, shown.len()), Some(shown));
        }

        #[test]
        fn any_bytes_are_safe(bytes in proptest::collection::vec(any::<u8>(), 0..60), columns in 1usize..9, rows in 1usize..9) {
            let _ = decode(&bytes, columns, columns * rows);
        }
    }

    #[test]
    fn a_round_lake_is_small() {
        let shown: Vec<u8> =
            (0..65536i32).map(|i| if (i % 256 - 128).pow(2) + (i / 256 - 99).pow(2) < 4000 { 0 } else { 3 }).collect();
        let bytes = encode(&shown, 256);
        assert!(bytes.len() < 250, "{}", bytes.len());
        assert_eq!(decode(&bytes, 256, shown.len()), Some(shown));
    }
}
