//! Decoding of buffer views packed with `EXT_meshopt_compression` and `KHR_meshopt_compression`: attribute, triangle and
//! index streams. Every read is checked: a damaged stream gives an error, never a wrong index or a panic.
//!
//! Based on: Kapoulkine and others, "KHR_meshopt_compression", appendix A, Khronos Group (which contains the EXT one).

use super::meshopt_filter;

/// How a view is packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshoptMode {
    /// Elements of any kind, predicted from the one before.
    Attributes,
    /// Corners of triangles, predicted from the edges before.
    Triangles,
    /// Any indices.
    Indices,
}

/// What is done to attributes after decoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshoptFilter {
    /// Nothing.
    None,
    /// Unit vectors from octahedral coordinates.
    Octahedral,
    /// Unit quaternions from their three lesser components.
    Quaternion,
    /// Floats from an exponent and a mantissa.
    Exponential,
    /// Colours from luma and chroma.
    Colour,
}

/// Elements of a group, which share their number of bits.
const GROUP: usize = 16;
const ATTRIBUTES: u8 = 0xa0;
const TRIANGLES: u8 = 0xe1;
const INDICES: u8 = 0xd1;

/// The `count` elements of `stride` bytes of a packed view, or what is wrong with it.
///
/// Never allocates more than about a thousand times the length of `data`.
pub fn decode_meshopt(
    mode: MeshoptMode,
    filter: MeshoptFilter,
    count: usize,
    stride: usize,
    data: &[u8],
) -> Result<Vec<u8>, &'static str> {
    match mode {
        MeshoptMode::Attributes => {
            let mut decoded = attributes(count, stride, data)?;
            meshopt_filter::apply(filter, stride, &mut decoded)?;
            Ok(decoded)
        }
        _ if filter != MeshoptFilter::None => Err("a filter on indices"),
        _ if stride != 2 && stride != 4 => Err("indices that are not of 2 or 4 bytes"),
        MeshoptMode::Triangles => triangles(count, stride, data),
        MeshoptMode::Indices => indices(count, stride, data),
    }
}

/// Bytes that are read from the front.
struct Input<'a>(&'a [u8]);

const SHORT: &str = "a stream that ends too early";

impl<'a> Input<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], &'static str> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(SHORT)?;
        self.0 = rest;
        Ok(taken)
    }

    fn byte(&mut self) -> Result<u8, &'static str> {
        Ok(self.take(1)?[0])
    }

    /// Seven bits a byte, the least first.
    fn varint(&mut self) -> Result<u32, &'static str> {
        let mut value = 0;
        for k in 0..5 {
            let byte = self.byte()?;
            value |= u32::from(byte & 127).wrapping_shl(7 * k);
            if byte < 128 {
                return Ok(value);
            }
        }
        Err("a number of more than five bytes")
    }

    fn finish(self) -> Result<(), &'static str> {
        if self.0.is_empty() { Ok(()) } else { Err("bytes left over") }
    }
}

fn attributes(count: usize, stride: usize, data: &[u8]) -> Result<Vec<u8>, &'static str> {
    if !(4..=256).contains(&stride) || !stride.is_multiple_of(4) {
        return Err("elements that are not of 4 to 256 bytes, in fours");
    }
    let version = match data.first() {
        Some(&head) if head & 0xf0 == ATTRIBUTES && head & 15 < 2 => head & 15,
        _ => return Err("not an attribute stream of version 0 or 1"),
    };
    let channels = if version == 0 { 0 } else { stride / 4 };
    let tail = (stride + channels).max(if version == 0 { 32 } else { 24 });
    let body = data.len().checked_sub(1 + tail).ok_or(SHORT)?;
    let mut input = Input(&data[1..1 + body]);
    let tail = &data[data.len() - stride - channels..];
    let mut last = tail[..stride].to_vec();
    let channels = &tail[stride..];
    let block = ((8192 / stride) & !(GROUP - 1)).min(256);
    let mut decoded = Vec::new();
    let mut columns = [[0u8; 256]; 4];
    while decoded.len() / stride < count {
        let elements = block.min(count - decoded.len() / stride);
        let controls = if version == 0 { &[] } else { input.take(stride / 4)? };
        let first = decoded.len();
        decoded.resize(first + elements * stride, 0);
        let out = &mut decoded[first..];
        for channel in 0..stride / 4 {
            for (k, column) in columns.iter_mut().enumerate() {
                let bits = match controls.get(channel).map(|c| c >> (2 * k) & 3) {
                    None => [0, 2, 4, 8],
                    Some(0) => [0, 1, 2, 4],
                    Some(1) => [1, 2, 4, 8],
                    Some(2) => {
                        column.fill(0);
                        continue;
                    }
                    Some(_) => {
                        column[..elements].copy_from_slice(input.take(elements)?);
                        continue;
                    }
                };
                column_of_groups(&mut input, bits, &mut column[..elements.next_multiple_of(GROUP)])?;
            }
            let at = 4 * channel;
            let mode = channels.get(channel).copied().unwrap_or(0);
            undo_deltas(
                mode,
                &columns,
                &mut last[at..at + 4],
                out.chunks_exact_mut(stride).map(|e| &mut e[at..at + 4]),
            )?;
        }
    }
    input.finish()?;
    Ok(decoded)
}

/// One byte of all elements of a block: two header bits a group, then the groups.
fn column_of_groups(input: &mut Input<'_>, bits: [usize; 4], column: &mut [u8]) -> Result<(), &'static str> {
    let groups = column.len() / GROUP;
    let header = input.take(groups.div_ceil(4))?;
    for (g, group) in column.chunks_exact_mut(GROUP).enumerate() {
        let bits = bits[usize::from(header[g / 4] >> (2 * (g % 4)) & 3)];
        match bits {
            0 => group.fill(0),
            8 => group.copy_from_slice(input.take(GROUP)?),
            _ => {
                let packed = input.take(2 * bits)?;
                let sentinel = (1u8 << bits) - 1;
                let a_byte = 8 / bits;
                for (k, value) in group.iter_mut().enumerate() {
                    // single bits come from the least on, wider ones from the most significant
                    let place = if bits == 1 { k % 8 } else { bits * (a_byte - 1 - k % a_byte) };
                    let short = packed[k / a_byte] >> place & sentinel;
                    *value = if short == sentinel { input.byte()? } else { short };
                }
            }
        }
    }
    Ok(())
}

/// Turns four columns of differences into the four bytes of each element.
fn undo_deltas<'e>(
    mode: u8,
    columns: &[[u8; 256]; 4],
    last: &mut [u8],
    elements: impl Iterator<Item = &'e mut [u8]>,
) -> Result<(), &'static str> {
    let rotation = u32::from(mode >> 4);
    if mode & 15 > 2 || (mode & 15 != 2 && rotation != 0) {
        return Err("an unknown channel mode");
    }
    let unzigzag = |v: u16| (v >> 1) ^ 0u16.wrapping_sub(v & 1);
    let mut value = [last[0], last[1], last[2], last[3]];
    for (i, element) in elements.enumerate() {
        let delta = [columns[0][i], columns[1][i], columns[2][i], columns[3][i]];
        value = match mode & 15 {
            0 => std::array::from_fn(|k| value[k].wrapping_add(unzigzag(delta[k].into()) as u8)),
            1 => {
                let half = |k: usize| {
                    let (v, d) = (u16::from_le_bytes([value[k], value[k + 1]]), [delta[k], delta[k + 1]]);
                    v.wrapping_add(unzigzag(u16::from_le_bytes(d))).to_le_bytes()
                };
                let ([a, b], [c, d]) = (half(0), half(2));
                [a, b, c, d]
            }
            _ => (u32::from_le_bytes(value) ^ u32::from_le_bytes(delta).rotate_right(rotation)).to_le_bytes(),
        };
        element.copy_from_slice(&value);
    }
    last.copy_from_slice(&value);
    Ok(())
}

/// The sixteen latest of something; the latest is number 0.
struct Fifo<T> {
    entries: [T; 16],
    pushed: usize,
}

impl<T: Copy + Default> Fifo<T> {
    fn new() -> Self {
        Self { entries: [T::default(); 16], pushed: 0 }
    }

    fn push(&mut self, entry: T) {
        self.entries[self.pushed % 16] = entry;
        self.pushed += 1;
    }

    fn get(&self, number: u8) -> Result<T, &'static str> {
        let number = usize::from(number & 15);
        if number >= self.pushed {
            return Err("a reference to nothing");
        }
        Ok(self.entries[(self.pushed - 1 - number) % 16])
    }
}

/// Half of the bits of a delta with its sign in the lowest.
fn signed(v: u32) -> u32 {
    (v >> 1) ^ 0u32.wrapping_sub(v & 1)
}

/// State of the triangle decoder.
struct Triangles<'a> {
    data: Input<'a>,
    next: u32,
    last: u32,
    edges: Fifo<[u32; 2]>,
    vertices: Fifo<u32>,
}

impl Triangles<'_> {
    fn fresh(&mut self) -> u32 {
        let index = self.next;
        self.next = index.wrapping_add(1);
        index
    }

    fn explicit(&mut self) -> Result<u32, &'static str> {
        self.last = self.last.wrapping_add(signed(self.data.varint()?));
        Ok(self.last)
    }

    /// A corner by half a byte; whether it is new to the vertices.
    fn corner(&mut self, half: u8) -> Result<(u32, bool), &'static str> {
        Ok(match half {
            0 => (self.fresh(), true),
            15 => (self.explicit()?, true),
            _ => (self.vertices.get(half - 1)?, false),
        })
    }

    fn one(&mut self, code: u8, table: &[u8]) -> Result<[u32; 3], &'static str> {
        let (high, low) = (code >> 4, code & 15);
        if high < 15 {
            let [a, b] = self.edges.get(high)?;
            let (c, is_new) = match low {
                0 => (self.fresh(), true),
                13 | 14 => {
                    self.last = if low == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                    (self.last, true)
                }
                15 => (self.explicit()?, true),
                _ => (self.vertices.get(low)?, false),
            };
            self.edges.push([c, b]);
            self.edges.push([a, c]);
            if is_new {
                self.vertices.push(c);
            }
            return Ok([a, b, c]);
        }
        let halves = if low < 14 { table[usize::from(low)] } else { self.data.byte()? };
        if low >= 14 && halves == 0 {
            self.next = 0;
        }
        let a = if low == 15 { self.explicit()? } else { self.fresh() };
        let (b, b_is_new) = self.corner(halves >> 4)?;
        let (c, c_is_new) = self.corner(halves & 15)?;
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        self.vertices.push(a);
        if b_is_new {
            self.vertices.push(b);
        }
        if c_is_new {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }
}

fn triangles(count: usize, stride: usize, data: &[u8]) -> Result<Vec<u8>, &'static str> {
    if !count.is_multiple_of(3) {
        return Err("corners that are not in threes");
    }
    if data.first() != Some(&TRIANGLES) {
        return Err("not a triangle stream of version 1");
    }
    let rest = data[1..].len().checked_sub(16).ok_or(SHORT)?;
    let (body, table) = data[1..].split_at(rest);
    if table[14..] != [0; 2] || table.iter().any(|&t| t >> 4 == 15 || t & 15 == 15) {
        return Err("a wrong table of codes");
    }
    let (codes, extra) = body.split_at_checked(count / 3).ok_or(SHORT)?;
    let mut state = Triangles { data: Input(extra), next: 0, last: 0, edges: Fifo::new(), vertices: Fifo::new() };
    let mut decoded = Vec::with_capacity(count * stride);
    for &code in codes {
        for index in state.one(code, table)? {
            decoded.extend_from_slice(&index.to_le_bytes()[..stride]);
        }
    }
    state.data.finish()?;
    Ok(decoded)
}

fn indices(count: usize, stride: usize, data: &[u8]) -> Result<Vec<u8>, &'static str> {
    if data.first() != Some(&INDICES) {
        return Err("not an index stream of version 1");
    }
    let rest = data[1..].len().checked_sub(4).filter(|&rest| rest >= count).ok_or(SHORT)?;
    let mut input = Input(&data[1..1 + rest]);
    let mut last = [0u32; 2];
    let mut decoded = Vec::with_capacity(count * stride);
    for _ in 0..count {
        let value = input.varint()?;
        let base = &mut last[(value & 1) as usize];
        *base = base.wrapping_add(signed(value >> 1));
        decoded.extend_from_slice(&base.to_le_bytes()[..stride]);
    }
    input.finish()?;
    Ok(decoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Streams of the reference encoder (meshoptimizer 1.2) with what its decoder makes of them.
    struct Stream {
        name: String,
        mode: MeshoptMode,
        filter: MeshoptFilter,
        count: usize,
        stride: usize,
        packed: Vec<u8>,
        unpacked: Vec<u8>,
    }

    fn streams() -> Vec<Stream> {
        let text = include_str!("../../tests/fixtures/mesh/meshopt_streams.json");
        let list: Vec<serde_json::Value> = serde_json::from_str(text).unwrap();
        let bytes = |v: &serde_json::Value| {
            let digits = v.as_str().unwrap();
            (0..digits.len()).step_by(2).map(|k| u8::from_str_radix(&digits[k..k + 2], 16).unwrap()).collect()
        };
        let number = |v: &serde_json::Value| v.as_u64().unwrap() as usize;
        let stream = |v: serde_json::Value| Stream {
            name: v["name"].to_string(),
            mode: match v["mode"].as_str().unwrap() {
                "ATTRIBUTES" => MeshoptMode::Attributes,
                "TRIANGLES" => MeshoptMode::Triangles,
                _ => MeshoptMode::Indices,
            },
            filter: match v["filter"].as_str().unwrap() {
                "OCTAHEDRAL" => MeshoptFilter::Octahedral,
                "QUATERNION" => MeshoptFilter::Quaternion,
                "EXPONENTIAL" => MeshoptFilter::Exponential,
                "COLOR" => MeshoptFilter::Colour,
                _ => MeshoptFilter::None,
            },
            count: number(&v["count"]),
            stride: number(&v["stride"]),
            packed: bytes(&v["packed"]),
            unpacked: bytes(&v["unpacked"]),
        };
        list.into_iter().map(stream).collect()
    }

    fn decode(s: &Stream, data: &[u8]) -> Result<Vec<u8>, &'static str> {
        decode_meshopt(s.mode, s.filter, s.count, s.stride, data)
    }

    #[test]
    fn streams_of_the_reference_encoder_are_decoded() {
        for s in streams() {
            let decoded = decode(&s, &s.packed).unwrap();
            let exact = matches!(s.filter, MeshoptFilter::None | MeshoptFilter::Exponential);
            if exact {
                assert!(decoded == s.unpacked, "{}", s.name);
                continue;
            }
            // the specification leaves one unit in the last place
            let words = |bytes: &[u8]| -> Vec<i32> {
                let word = |b: &[u8]| if s.stride == 4 { b[0].into() } else { u16::from_le_bytes([b[0], b[1]]).into() };
                bytes.chunks_exact(s.stride / 4).map(word).collect()
            };
            assert_eq!(decoded.len(), s.unpacked.len());
            for (a, b) in words(&decoded).into_iter().zip(words(&s.unpacked)) {
                assert!((a - b).abs() <= 1 || a == 0 && b > 250, "{}: {a} {b}", s.name);
            }
        }
    }

    #[test]
    fn cut_and_lengthened_streams_are_refused() {
        for s in streams() {
            for length in 0..s.packed.len() {
                assert!(decode(&s, &s.packed[..length]).is_err(), "{} cut at {length}", s.name);
            }
            let mut longer = s.packed.clone();
            longer.insert(longer.len() / 2, 0);
            // a byte too much may still be a stream of other values, but mostly it is none
            let _ = decode(&s, &longer);
            longer.extend([0; 300]);
            assert!(decode(&s, &longer).is_err(), "{}", s.name);
            assert!(decode_meshopt(s.mode, s.filter, usize::MAX / 4, s.stride, &s.packed).is_err(), "{}", s.name);
        }
    }

    #[test]
    fn damaged_streams_never_panic() {
        let mut noise = 1u32;
        let mut next = |below: usize| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (noise >> 8) as usize % below
        };
        for s in streams() {
            for _ in 0..400 {
                let mut packed = s.packed.clone();
                for _ in 0..1 + next(4) {
                    let at = next(packed.len());
                    packed[at] = next(256) as u8;
                }
                let _ = decode(&s, &packed);
            }
        }
    }
}
