//! Lenient readers for judging tiles: what others wrote is read as far as it goes, and what breaks its format's rules is
//! listed instead of refused. They share no code with the writers of tiles, so that no mistake hides itself.
//!
//! All are bounded by the bytes given, and none panics, whatever these are.

mod accessor;
mod b3dm;
mod container;
mod glb;
mod glb_geometry;
mod pmtiles;
mod quantized_mesh;
mod subtree;
mod three_tz;

pub use accessor::MESHOPT_EXTENSIONS;
pub use b3dm::{Wrapped, unwrapped};
pub use container::{Container, LIMIT_BYTES};
pub use glb::{Glb, glb};
pub use glb_geometry::GlbMesh;
pub use pmtiles::{PmTile, PmTiles};
pub use quantized_mesh::{QuantizedMesh, SIDE_NAMES, quantized_mesh};
pub use subtree::{Availability, Subtree, morton, subtree};
pub use three_tz::{ThreeTz, three_tz};

use std::borrow::Cow;
use std::io::Read;

/// A rule that some bytes break.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Fault {
    /// The rule's code, like `QM07`.
    pub code: &'static str,
    /// Where in the file; of several breaches the first.
    pub place: String,
    /// What should be there.
    pub expected: String,
    /// What is there.
    pub found: String,
    /// How often the rule is broken.
    pub count: u64,
}

/// The rules that a file breaks, each once, with how often.
#[derive(Debug, Clone, Default)]
pub struct Faults(Vec<Fault>);

impl Faults {
    /// Notes a breach. Of several of one rule the first is kept and all are counted.
    pub fn add(
        &mut self,
        code: &'static str,
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) {
        match self.0.iter_mut().find(|f| f.code == code) {
            Some(fault) => fault.count += 1,
            None => self.0.push(Fault {
                code,
                place: place.into(),
                expected: expected.into(),
                found: shortened(found.into()),
                count: 1,
            }),
        }
    }

    /// Those of one code are there.
    pub fn has(&self, code: &str) -> bool {
        self.0.iter().any(|f| f.code == code)
    }

    /// All of them, in the order in which they were met.
    pub fn into_vec(self) -> Vec<Fault> {
        self.0
    }
}

/// Files may hold anything; a message is one line.
fn shortened(text: String) -> String {
    const MOST: usize = 120;
    let line: String = text.chars().take(MOST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > MOST { line + "…" } else { line }
}

/// The bytes without the gzip around them, if there is one; `None` where it is damaged.
pub fn without_gzip<'b>(bytes: &'b [u8], code: &'static str, faults: &mut Faults) -> Option<Cow<'b, [u8]>> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Some(Cow::Borrowed(bytes));
    }
    let mut plain = Vec::new();
    let read = flate2::read::MultiGzDecoder::new(bytes).take(LIMIT_BYTES + 1).read_to_end(&mut plain);
    match read {
        Ok(length) if length as u64 > LIMIT_BYTES => {
            faults.add(code, "gzip", format!("at most {LIMIT_BYTES} bytes"), "more");
            None
        }
        Ok(_) => Some(Cow::Owned(plain)),
        Err(cause) => {
            faults.add(code, "gzip", "a whole gzip stream", cause.to_string());
            None
        }
    }
}

/// Reads on through bytes, little endian.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bytes<'b> {
    all: &'b [u8],
    pub(crate) at: usize,
}

impl<'b> Bytes<'b> {
    pub(crate) fn new(all: &'b [u8]) -> Self {
        Self { all, at: 0 }
    }

    pub(crate) fn left(&self) -> usize {
        self.all.len() - self.at
    }

    pub(crate) fn take(&mut self, count: usize) -> Option<&'b [u8]> {
        let end = self.at.checked_add(count)?;
        let taken = self.all.get(self.at..end)?;
        self.at = end;
        Some(taken)
    }

    pub(crate) fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.array::<1>().map(|[b]| b)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(crate) fn f32(&mut self) -> Option<f32> {
        self.array().map(f32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }
}
