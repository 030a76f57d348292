//! Bad TIN files: one clear line each, no panic, and never much more memory than the file deserves.

mod tin_samples;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::Path;
use tin_samples::samples;
use yamanami_io::tin_file::{TinReadOptions, read_tin_from_bytes};

/// The system's allocator, which remembers the largest piece that a thread asked for.
struct Watched;

thread_local! {
    static LARGEST: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is passed on to the system's allocator as it came; what is remembered is a plain number.
unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = LARGEST.try_with(|largest| largest.set(largest.get().max(layout.size())));
        // SAFETY: the caller's promises are those that the system's allocator asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static WATCHED: Watched = Watched;

/// Most bytes at once for files of a few kilobytes.
const MOST: usize = 4 << 20;

fn read(name: &Path, bytes: &[u8]) -> Result<(), String> {
    LARGEST.with(|largest| largest.set(0));
    let read = read_tin_from_bytes(name, bytes, &TinReadOptions::default());
    let largest = LARGEST.with(Cell::get);
    assert!(largest < MOST, "{}: {largest} bytes at once", name.display());
    match read {
        Ok(read) => {
            let tin = read.tin;
            let vertices = tin.mesh.positions.len();
            assert!(tin.mesh.positions.iter().all(|p| p.is_finite()));
            assert!(tin.mesh.triangles.iter().chain(&tin.hidden).flatten().all(|&i| (i as usize) < vertices));
            assert!(tin.breaklines.iter().all(|l| l.points.len() > 1 && l.points.iter().all(|p| p.is_finite())));
            assert!(read.notes.iter().all(|note| !note.contains('\n')));
            Ok(())
        }
        Err(e) => {
            let line = e.to_string();
            assert!(!line.contains('\n') && line.starts_with(&*name.to_string_lossy()), "{line}");
            Err(line)
        }
    }
}

#[test]
fn every_sample_is_read() {
    for (name, bytes) in samples() {
        assert_eq!(read(name, &bytes), Ok(()), "{}", name.display());
    }
}

/// A sequence of numbers that look like chance.
struct Noise(u64);

impl Noise {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % limit.max(1)
    }
}

/// What numbers in files go wrong at.
const WORDS: [&[u8]; 12] = [
    b"-1",
    b"0",
    b"4294967295",
    b"1099511627776",
    b"nan",
    b"1e999",
    b"\0\0\0\0",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\n",
    b" ",
    b"",
];

#[test]
fn bytes_flipped_cut_and_spliced_never_panic() {
    let samples = samples();
    let mut noise = Noise(0x5eed_5eed_5eed_5eed);
    let mut read_on = 0;
    for case in 0..12_000 {
        let (name, original) = &samples[case % samples.len()];
        let mut bytes = original.clone();
        for _ in 0..1 + noise.below(3) {
            let length = bytes.len();
            let at = noise.below(length);
            match noise.below(6) {
                0 if length > 0 => bytes[at] ^= 1 << noise.below(8),
                1 if length > 0 => bytes[at] = noise.below(256) as u8,
                2 => bytes.truncate(at),
                3 => {
                    let end = (at + noise.below(40)).min(length);
                    bytes.drain(at..end);
                }
                4 => {
                    let word = WORDS[noise.below(WORDS.len())];
                    let end = (at + word.len() * noise.below(2)).min(length);
                    bytes.splice(at..end, word.iter().copied());
                }
                _ => {
                    let (_, other) = &samples[noise.below(samples.len())];
                    let from = noise.below(other.len());
                    let part = &other[from..(from + noise.below(200)).min(other.len())];
                    bytes.splice(at..at, part.iter().copied());
                }
            }
        }
        read_on += usize::from(read(name, &bytes).is_ok());
    }
    assert!(read_on > 1000, "{read_on} still read");
}

#[test]
fn counts_that_lie() {
    let tile = tin_samples::grid_tile(5, false);
    let with = |at: usize, number: u32| {
        let mut tile = tile.clone();
        tile[at..at + 4].copy_from_slice(&number.to_le_bytes());
        read(Path::new("a.terrain"), &tile).unwrap_err()
    };
    let vertices = 25;
    let triangles_at = 92 + vertices * 6;
    assert_eq!(
        with(88, u32::MAX),
        format!("a.terrain: byte 92: expected vertices of 25769803770 bytes, found {} bytes", tile.len() - 92)
    );
    assert!(with(88, 0).contains("expected vertices, found none"));
    assert!(with(triangles_at, u32::MAX).contains("expected corners of 25769803770 bytes"));
    assert!(with(triangles_at + 4, 5).contains("expected corners of triangle 0 below 25, found 65531"));
    assert!(with(triangles_at + 4 + 32 * 6, u32::MAX).contains("expected vertices on a side of 8589934590 bytes"));
    let mesh = "0\nSECTION\n2\nENTITIES\n0\nMESH\n92\n4294967295\n93\n4294967295\n90\n4294967295\n0\nEOF\n";
    let error = read(Path::new("a.dxf"), mesh.as_bytes()).unwrap_err();
    assert!(error.contains("no face that is shown"), "{error}");
    let endless = [b"0\nSECTION\n2\n".as_slice(), &vec![b'x'; 2 << 20]].concat();
    let error = read(Path::new("a.dxf"), &endless).unwrap_err();
    assert_eq!(error, "a.dxf: line 4: expected a short line, found 1048576 bytes or more");
}
