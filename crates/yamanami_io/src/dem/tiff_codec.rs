//! From the stored bytes of a TIFF strip or tile to its samples: decompression and predictors.
//!
//! Formats: Adobe, "TIFF Revision 6.0", 1992 (PackBits, LZW, horizontal predictor); Adobe, "TIFF Technical Note 3", 2005
//! (floating-point predictor).

use super::SampleType;
use super::tiff_tags::ByteOrder;
use std::io::Read;

/// How chunks are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Compression {
    None,
    Lzw,
    Deflate,
    PackBits,
    Zstd,
}

/// What is added up along a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Predictor {
    None,
    /// Samples.
    Horizontal,
    /// The bytes of the floats, the high bytes of a row first.
    FloatingPoint,
}

impl Compression {
    pub(super) fn from_code(code: u16) -> Option<Self> {
        match code {
            1 => Some(Self::None),
            5 => Some(Self::Lzw),
            8 | 32946 => Some(Self::Deflate),
            32773 => Some(Self::PackBits),
            50000 => Some(Self::Zstd),
            _ => None,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Lzw => "LZW",
            Self::Deflate => "deflate",
            Self::PackBits => "PackBits",
            Self::Zstd => "zstd",
        }
    }

    /// Unpacks the first `length` bytes; says what is wrong otherwise.
    pub(super) fn unpack(self, packed: Vec<u8>, length: usize) -> Result<Vec<u8>, String> {
        let exactly = |reader: &mut dyn Read| {
            let mut out = vec![0; length];
            reader.read_exact(&mut out).map(|()| out).map_err(|e| e.to_string())
        };
        match self {
            Self::None => {
                let mut out = packed;
                if out.len() < length {
                    return Err(format!("{} bytes", out.len()));
                }
                out.truncate(length);
                Ok(out)
            }
            Self::Lzw => unpack_lzw(&packed, length),
            Self::Deflate => exactly(&mut flate2::read::ZlibDecoder::new(&packed[..])),
            Self::PackBits => unpack_bits(&packed, length),
            Self::Zstd => exactly(&mut zstd::stream::read::Decoder::new(&packed[..]).map_err(|e| e.to_string())?),
        }
    }
}

fn unpack_lzw(packed: &[u8], length: usize) -> Result<Vec<u8>, String> {
    let mut decoder = weezl::decode::Decoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8);
    let mut out = vec![0; length];
    let (mut read, mut written) = (0, 0);
    while written < length {
        let result = decoder.decode_bytes(&packed[read..], &mut out[written..]);
        read += result.consumed_in;
        written += result.consumed_out;
        let status = result.status.map_err(|e| e.to_string())?;
        let stalls = result.consumed_in == 0 && result.consumed_out == 0;
        if written < length && (stalls || !matches!(status, weezl::LzwStatus::Ok)) {
            return Err(format!("the end of the LZW data after {written} bytes"));
        }
    }
    Ok(out)
}

fn unpack_bits(packed: &[u8], length: usize) -> Result<Vec<u8>, String> {
    let mut out = Vec::with_capacity(length);
    let mut rest = packed;
    while out.len() < length {
        let end = || format!("the end of the PackBits data after {} bytes", out.len());
        let (&head, tail) = rest.split_first().ok_or_else(end)?;
        rest = match head as i8 {
            -128 => tail,
            head if head >= 0 => {
                let (literal, tail) = tail.split_at_checked(head as usize + 1).ok_or_else(end)?;
                out.extend_from_slice(literal);
                tail
            }
            head => {
                let (&value, tail) = tail.split_first().ok_or_else(end)?;
                out.resize(out.len() + 1 + usize::from(head.unsigned_abs()), value);
                tail
            }
        };
    }
    out.truncate(length);
    Ok(out)
}

/// Turns rows of stored samples into rows of little-endian samples.
pub(super) fn undo_predictor(
    rows: &mut [u8],
    row_bytes: usize,
    sample_bytes: usize,
    predictor: Predictor,
    order: ByteOrder,
) {
    if predictor == Predictor::FloatingPoint {
        let mut planes = vec![0; row_bytes];
        for row in rows.chunks_exact_mut(row_bytes) {
            let mut sum = 0u8;
            for (plane, byte) in planes.iter_mut().zip(&*row) {
                sum = sum.wrapping_add(*byte);
                *plane = sum;
            }
            let samples = row_bytes / sample_bytes;
            for (i, sample) in row.chunks_exact_mut(sample_bytes).enumerate() {
                for (k, byte) in sample.iter_mut().rev().enumerate() {
                    *byte = planes[k * samples + i];
                }
            }
        }
        return;
    }
    if order == ByteOrder::BigEndian && sample_bytes > 1 {
        rows.chunks_exact_mut(sample_bytes).for_each(<[u8]>::reverse);
    }
    if predictor == Predictor::Horizontal {
        for row in rows.chunks_exact_mut(row_bytes) {
            match sample_bytes {
                1 => add_up(row, u8::from_le_bytes, u8::wrapping_add, u8::to_le_bytes),
                2 => add_up(row, u16::from_le_bytes, u16::wrapping_add, u16::to_le_bytes),
                4 => add_up(row, u32::from_le_bytes, u32::wrapping_add, u32::to_le_bytes),
                _ => add_up(row, u64::from_le_bytes, u64::wrapping_add, u64::to_le_bytes),
            }
        }
    }
}

#[inline]
fn add_up<const N: usize, T: Default + Copy>(
    row: &mut [u8],
    from: impl Fn([u8; N]) -> T,
    add: impl Fn(T, T) -> T,
    to: impl Fn(T) -> [u8; N],
) {
    let (samples, _) = row.as_chunks_mut::<N>();
    let mut sum = T::default();
    for sample in samples {
        sum = add(sum, from(*sample));
        *sample = to(sum);
    }
}

/// Calls `height` with every little-endian sample.
pub(super) fn heights(stored: &[u8], sample_type: SampleType, height: impl Fn(f64) -> f32, out: &mut Vec<f32>) {
    fn each<const N: usize>(stored: &[u8], out: &mut Vec<f32>, one: impl Fn([u8; N]) -> f32) {
        out.extend(stored.as_chunks::<N>().0.iter().map(|sample| one(*sample)));
    }
    match sample_type {
        SampleType::U8 => each(stored, out, |[b]| height(f64::from(b))),
        SampleType::I8 => each(stored, out, |[b]| height(f64::from(b as i8))),
        SampleType::U16 => each(stored, out, |b| height(f64::from(u16::from_le_bytes(b)))),
        SampleType::I16 => each(stored, out, |b| height(f64::from(i16::from_le_bytes(b)))),
        SampleType::F16 => each(stored, out, |b| height(half_to_f64(u16::from_le_bytes(b)))),
        SampleType::U32 => each(stored, out, |b| height(f64::from(u32::from_le_bytes(b)))),
        SampleType::I32 => each(stored, out, |b| height(f64::from(i32::from_le_bytes(b)))),
        SampleType::F32 => each(stored, out, |b| height(f64::from(f32::from_le_bytes(b)))),
        SampleType::U64 => each(stored, out, |b| height(u64::from_le_bytes(b) as f64)),
        SampleType::I64 => each(stored, out, |b| height(i64::from_le_bytes(b) as f64)),
        SampleType::F64 => each(stored, out, |b| height(f64::from_le_bytes(b))),
        SampleType::Rgb | SampleType::Text => {}
    }
}

fn half_to_f64(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    sign * match exponent {
        0 => fraction * 2f64.powi(-24),
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_bits_are_unpacked() {
        // The example of the TIFF 6.0 specification.
        let packed = [0xFE, 0xAA, 0x02, 0x80, 0x00, 0x2A, 0xFD, 0xAA, 0x03, 0x80, 0x00, 0x2A, 0x22, 0xF7, 0xAA];
        let plain = [
            0xAA, 0xAA, 0xAA, 0x80, 0x00, 0x2A, 0xAA, 0xAA, 0xAA, 0xAA, 0x80, 0x00, 0x2A, 0x22, 0xAA, 0xAA, 0xAA, 0xAA,
            0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA,
        ];
        assert_eq!(unpack_bits(&packed, 24).unwrap(), plain);
        assert_eq!(unpack_bits(&packed, 10).unwrap(), plain[..10]);
        assert!(unpack_bits(&packed, 25).unwrap_err().contains("24"));
        assert!(unpack_bits(&[5, 1], 3).is_err());
    }

    #[test]
    fn short_data_are_an_error_in_every_compression() {
        for code in [1, 5, 8, 32773, 50000] {
            let compression = Compression::from_code(code).unwrap();
            for packed in [vec![], vec![0x80], vec![0xFF; 9], vec![0x78, 0x9C, 1, 2, 3]] {
                assert!(compression.unpack(packed, 4000).is_err(), "{compression:?}");
            }
        }
        assert_eq!(Compression::from_code(7), None);
    }

    #[test]
    fn predictors_are_undone() {
        let mut rows = [1u16, 2, 65535, 10, 1, 1].map(u16::to_be_bytes).concat();
        undo_predictor(&mut rows, 6, 2, Predictor::Horizontal, ByteOrder::BigEndian);
        assert_eq!(rows, [1u16, 3, 2, 10, 11, 12].map(u16::to_le_bytes).concat());
        let values = [1.5f32, -300.25];
        let [a, b] = values.map(f32::to_be_bytes);
        let planes = [a[0], b[0], a[1], b[1], a[2], b[2], a[3], b[3]];
        let mut row: Vec<u8> = (0..8).map(|i| planes[i].wrapping_sub(if i == 0 { 0 } else { planes[i - 1] })).collect();
        undo_predictor(&mut row, 8, 4, Predictor::FloatingPoint, ByteOrder::BigEndian);
        assert_eq!(row, values.map(f32::to_le_bytes).concat());
    }

    #[test]
    fn stored_bytes_are_values() {
        let read = |sample_type, bytes: &[u8]| {
            let mut out = Vec::new();
            heights(bytes, sample_type, |z| z as f32, &mut out);
            out[0]
        };
        assert_eq!(read(SampleType::I8, &[0xFB]), -5.0);
        assert_eq!(read(SampleType::I16, &(-5i16).to_le_bytes()), -5.0);
        assert_eq!(read(SampleType::I32, &(-70_000i32).to_le_bytes()), -70_000.0);
        assert_eq!(read(SampleType::F16, &0x3E00u16.to_le_bytes()), 1.5);
        assert_eq!(read(SampleType::F16, &0x8001u16.to_le_bytes()), -(2f32.powi(-24)));
        assert_eq!(read(SampleType::F64, &(-1.5f64).to_le_bytes()), -1.5);
    }
}
