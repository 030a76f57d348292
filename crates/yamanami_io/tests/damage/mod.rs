//! Files with things wrong in them, and how much memory reading them takes.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

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

/// What a function gives, and the largest piece of memory that it asked for on this thread.
pub(crate) fn largest_piece<T>(run: impl FnOnce() -> T) -> (T, usize) {
    LARGEST.with(|largest| largest.set(0));
    let result = run();
    (result, LARGEST.with(Cell::get))
}

/// A sequence of numbers that look like chance.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % limit.max(1)
    }

    /// A copy of a sample with one to three things wrong: bits, cuts, words that numbers go wrong at, parts of others.
    pub(crate) fn damaged(&mut self, which: usize, samples: &[(&'static str, Vec<u8>)]) -> Vec<u8> {
        let mut bytes = samples[which].1.clone();
        for _ in 0..1 + self.below(3) {
            let length = bytes.len();
            // headers are short and matter most
            let at = if self.below(2) == 0 { self.below(length.min(1500)) } else { self.below(length) };
            match self.below(6) {
                0 if length > 0 => bytes[at] ^= 1 << self.below(8),
                1 if length > 0 => bytes[at] = self.below(256) as u8,
                2 => bytes.truncate(at),
                3 => {
                    let end = (at + self.below(40)).min(length);
                    bytes.drain(at..end);
                }
                4 => {
                    let word = WORDS[self.below(WORDS.len())];
                    let end = (at + word.len() * self.below(2)).min(length);
                    bytes.splice(at..end, word.iter().copied());
                }
                _ => {
                    let (_, other) = &samples[self.below(samples.len())];
                    let from = self.below(other.len());
                    let part = &other[from..(from + self.below(200)).min(other.len())];
                    bytes.splice(at..at, part.iter().copied());
                }
            }
        }
        bytes
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
