//! Geometries as well-known binary, and the header of a GeoPackage before it.
//!
//! Format: Open Geospatial Consortium 06-103r4, "Simple feature access", 1.2.1, clause 8; "GeoPackage encoding standard",
//! 1.4, clause 2.1.3. Types with z and m by thousands or, as in EWKB, by the highest bits.

use super::feature::{Line, Shape};
use glam::DVec3;

/// Collections in collections.
const MOST_DEPTH: usize = 16;

/// The shape of a GeoPackage's blob; `None` when it is none.
pub(super) fn parse_gpkg(blob: &[u8]) -> Option<Shape> {
    let rest = blob.strip_prefix(b"GP")?;
    let flags = *rest.get(1)?;
    let box_bytes = match flags >> 1 & 7 {
        0 => 0,
        1 => 32,
        2 | 3 => 48,
        4 => 64,
        _ => return None,
    };
    // a version, flags, and the number of the CRS come before the box
    parse(rest.get(6 + box_bytes..)?)
}

/// The shape of a blob; `None` when it is none.
pub(super) fn parse(blob: &[u8]) -> Option<Shape> {
    let mut shape = Shape::default();
    let mut bytes = Bytes { rest: blob, little: true };
    bytes.geometry(&mut shape, 0)?;
    Some(shape)
}

struct Bytes<'a> {
    rest: &'a [u8],
    little: bool,
}

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.rest.split_first_chunk()?;
        self.rest = rest;
        Some(*bytes)
    }

    fn number(&mut self) -> Option<u32> {
        let bytes = self.take()?;
        Some(if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    fn double(&mut self) -> Option<f64> {
        let bytes = self.take()?;
        Some(if self.little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) })
    }

    fn geometry(&mut self, shape: &mut Shape, depth: usize) -> Option<()> {
        if depth > MOST_DEPTH {
            return None;
        }
        let [order] = self.take()?;
        self.little = order == 1;
        let code = self.number()?;
        if code & 0x2000_0000 != 0 {
            self.number()?;
        }
        let (kind, dimensions) = (code & 0x0fff_ffff, code >> 30);
        let (with_z, with_m) = match kind / 1000 {
            0 => (dimensions & 2 != 0, dimensions & 1 != 0),
            1 => (true, false),
            2 => (false, true),
            3 => (true, true),
            _ => return None,
        };
        match kind % 1000 {
            1 => {
                let point = self.place(with_z, with_m)?;
                // the empty point is one of NaN
                shape.points.extend(Some(point).filter(|p| !p.x.is_nan()));
            }
            2 => self.line(shape, false, with_z, with_m)?,
            3 => {
                for _ in 0..self.number()? {
                    self.line(shape, true, with_z, with_m)?;
                }
            }
            4..=7 => {
                for _ in 0..self.number()? {
                    self.geometry(shape, depth + 1)?;
                }
            }
            _ => return None,
        }
        Some(())
    }

    fn line(&mut self, shape: &mut Shape, is_area: bool, with_z: bool, with_m: bool) -> Option<()> {
        let count = self.number()? as usize;
        let place_bytes = 16 + 8 * (usize::from(with_z) + usize::from(with_m));
        if count > self.rest.len() / place_bytes {
            return None;
        }
        let points = (0..count).map(|_| self.place(with_z, with_m)).collect::<Option<_>>()?;
        shape.lines.push(Line { points, is_area });
        Some(())
    }

    fn place(&mut self, with_z: bool, with_m: bool) -> Option<DVec3> {
        let (x, y) = (self.double()?, self.double()?);
        let z = if with_z { self.double()? } else { f64::NAN };
        if with_m {
            self.double()?;
        }
        Some(DVec3::new(x, y, z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn line(big: bool, code: u32, places: &[&[f64]]) -> Vec<u8> {
        let mut blob = vec![u8::from(!big)];
        let number = |n: u32| if big { n.to_be_bytes() } else { n.to_le_bytes() };
        blob.extend(number(code));
        blob.extend(number(places.len() as u32));
        for v in places.iter().copied().flatten() {
            blob.extend(if big { v.to_be_bytes() } else { v.to_le_bytes() });
        }
        blob
    }

    #[test]
    fn both_orders_and_all_dimensions() {
        for (big, code, places) in [
            (false, 2, [&[1.0, 2.0][..], &[3.0, 4.0]]),
            (true, 1002, [&[1.0, 2.0, 9.0], &[3.0, 4.0, 9.0]]),
            (false, 0x8000_0002, [&[1.0, 2.0, 9.0], &[3.0, 4.0, 9.0]]),
            (true, 3002, [&[1.0, 2.0, 9.0, 7.0], &[3.0, 4.0, 9.0, 7.0]]),
        ] {
            let shape = parse(&line(big, code, &places)).unwrap();
            assert_eq!(shape.lines[0].points[1].truncate().to_array(), [3.0, 4.0]);
        }
        let mut multi = vec![1, 5, 0, 0, 0, 1, 0, 0, 0];
        multi.extend(line(false, 2, &[&[1.0, 2.0], &[3.0, 4.0]]));
        assert_eq!(parse(&multi).unwrap().lines.len(), 1);
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_shape_or_none(bytes in prop::collection::vec(any::<u8>(), 0..80), code in 0u32..8) {
            let mut blob = vec![1];
            blob.extend(code.to_le_bytes());
            blob.extend(&bytes);
            let _ = (parse(&blob), parse(&bytes), parse_gpkg(&bytes));
        }
    }
}
