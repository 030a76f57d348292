//! Which byte ranges of a packed surface to ask for next, and what came of them.
//!
//! Pure: it neither fetches nor decodes. Each frame says anew what is wanted, the most urgent first; what is in flight stays
//! so. Entries whose place is not known yet are led to by the part of their section's index that tells it. Ranges that lie
//! near each other travel together.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::path::Path;
use yamanami::io::IoError;
use yamanami::io::pack::layout::{ENTRY_BYTES, PackEntry, PackHead, PackSection};

/// Entries of an index that are asked for at once: 4 KiB.
const INDEX_BLOCK: u64 = 256;
/// So many bytes between two ranges cost less than another request.
const GAP_BYTES: u64 = 4 << 10;
/// A request is no longer, but for an entry that is.
const MOST_BYTES: u64 = 512 << 10;
/// Bytes at the file's start that are kept: head, coarse indexes and pages come with the first request.
const KEPT_BYTES: u64 = 1 << 20;

/// A row of the surface: which section of the head, which of its entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Item {
    pub(crate) section: usize,
    pub(crate) entry: u64,
}

/// A range to be fetched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Request {
    pub(crate) id: u32,
    pub(crate) offset: u64,
    pub(crate) length: u64,
}

/// The bytes of a row, whole or not: their checksum is not looked at here.
#[derive(Debug, PartialEq)]
pub(crate) struct Arrived {
    pub(crate) item: Item,
    pub(crate) place: PackEntry,
    pub(crate) bytes: Vec<u8>,
}

/// What a range in flight brings.
#[derive(Debug)]
struct Flight {
    range: Range<u64>,
    parts: Vec<Part>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Part {
    /// A block of a section's index.
    Index {
        section: usize,
        block: u64,
    },
    Row(Item),
}

/// The way through one packed surface.
#[derive(Debug)]
pub(crate) struct PackStream {
    head: PackHead,
    index: HashMap<(usize, u64), Vec<PackEntry>>,
    wanted: Vec<Item>,
    flights: BTreeMap<u32, Flight>,
    next_id: u32,
    /// The file's first bytes.
    start: Vec<u8>,
    received_bytes: u64,
}

impl PackStream {
    /// Begins with the head and the first bytes of the file, which may go on after it.
    pub(crate) fn new(head: PackHead, start: Vec<u8>) -> Self {
        let received_bytes = start.len() as u64;
        Self {
            head,
            index: HashMap::new(),
            wanted: Vec::new(),
            flights: BTreeMap::new(),
            next_id: 0,
            start,
            received_bytes,
        }
    }

    /// What the surface says of itself.
    pub(crate) fn head(&self) -> &PackHead {
        &self.head
    }

    /// Bytes that have come.
    pub(crate) fn received_bytes(&self) -> u64 {
        self.received_bytes
    }

    /// Bytes that are wanted and have not come, as far as their places are known.
    pub(crate) fn wanted_bytes(&self) -> u64 {
        let waiting = self.wanted.iter().filter_map(|&item| self.place(item)).map(|place| u64::from(place.length));
        let flying = self.flights.values().map(|flight| flight.range.end - flight.range.start);
        waiting.sum::<u64>() + flying.sum::<u64>()
    }

    /// Ranges on their way.
    pub(crate) fn in_flight(&self) -> usize {
        self.flights.len()
    }

    /// Says what is wanted from now on, the most urgent first, and gives what is at hand already.
    pub(crate) fn want(&mut self, items: impl IntoIterator<Item = Item>) -> Vec<Arrived> {
        self.wanted.clear();
        let mut at_hand = Vec::new();
        for item in items {
            if item.entry >= self.head.sections.get(item.section).map_or(0, |s| s.entries) {
                continue;
            }
            self.index_from_start(item);
            match self.place(item) {
                Some(place) if self.start_holds(place.offset, place.length.into()) => {
                    let bytes = self.start[place.offset as usize..][..place.length as usize].to_vec();
                    at_hand.push(Arrived { item, place, bytes });
                }
                _ if self.flies(Part::Row(item)) => {}
                _ => self.wanted.push(item),
            }
        }
        // what has been handed out once is not asked for here again: pages stay in memory as long as they are wanted
        at_hand
    }

    /// Ranges to fetch now, so that at most `most` are in flight.
    pub(crate) fn requests(&mut self, most: usize) -> Vec<Request> {
        let mut parts: Vec<(Part, Range<u64>)> = Vec::new();
        let mut left = Vec::new();
        for item in std::mem::take(&mut self.wanted) {
            let block = Part::Index { section: item.section, block: item.entry / INDEX_BLOCK };
            match self.place(item) {
                Some(place) => parts.push((Part::Row(item), place.offset..place.offset + u64::from(place.length))),
                None => {
                    // the row itself is asked for when its place is known
                    left.push(item);
                    if !self.flies(block) && !parts.iter().any(|(part, _)| *part == block) {
                        let first = item.entry / INDEX_BLOCK * INDEX_BLOCK;
                        let range = self.head.sections[item.section].index_range(first, first + INDEX_BLOCK);
                        parts.push((block, range));
                    }
                }
            }
        }
        let mut requests = Vec::new();
        let mut taken = vec![false; parts.len()];
        for first in 0..parts.len() {
            if taken[first] {
                continue;
            }
            if self.flights.len() >= most {
                break;
            }
            // with the most urgent part goes what lies near it, on whichever side
            let mut range = parts[first].1.clone();
            let mut together = vec![first];
            taken[first] = true;
            loop {
                let near = (0..parts.len()).find(|&i| {
                    let other = &parts[i].1;
                    let joined = range.start.min(other.start)..range.end.max(other.end);
                    let gap =
                        joined.end - joined.start <= (range.end - range.start) + (other.end - other.start) + GAP_BYTES;
                    !taken[i] && gap && joined.end - joined.start <= MOST_BYTES
                });
                let Some(i) = near else { break };
                range = range.start.min(parts[i].1.start)..range.end.max(parts[i].1.end);
                taken[i] = true;
                together.push(i);
            }
            let id = self.next_id;
            self.next_id = self.next_id.wrapping_add(1);
            requests.push(Request { id, offset: range.start, length: range.end - range.start });
            let parts = together.into_iter().map(|i| parts[i].0).collect();
            self.flights.insert(id, Flight { range, parts });
        }
        let waiting = parts.iter().zip(taken).filter(|&(_, taken)| !taken);
        self.wanted = left;
        self.wanted.extend(waiting.filter_map(|((part, _), _)| match part {
            Part::Row(item) => Some(*item),
            Part::Index { .. } => None,
        }));
        requests
    }

    /// Takes the bytes of a request and gives the rows among them. An index that is none is an error: nothing of it is kept.
    pub(crate) fn receive(&mut self, id: u32, bytes: &[u8]) -> Result<Vec<Arrived>, IoError> {
        let Some(flight) = self.flights.remove(&id) else { return Ok(Vec::new()) };
        self.received_bytes += bytes.len() as u64;
        let part_bytes = |range: Range<u64>| {
            let at = (range.start - flight.range.start) as usize;
            bytes.get(at..at + (range.end - range.start) as usize)
        };
        let cut_short = |what: String| {
            let expected = format!("{} bytes", flight.range.end - flight.range.start);
            IoError::malformed(Path::new(&self.head.title), what, expected, bytes.len().to_string())
        };
        let mut arrived = Vec::new();
        let mut indexes = Vec::new();
        for part in flight.parts {
            match part {
                Part::Index { section, block } => {
                    let first = block * INDEX_BLOCK;
                    let described = &self.head.sections[section];
                    let range = described.index_range(first, first + INDEX_BLOCK);
                    let bytes = part_bytes(range).ok_or_else(|| cut_short("an index".to_owned()))?;
                    let entries = described.parse_entries(Path::new(&self.head.title), first, bytes)?;
                    indexes.push(((section, block), entries));
                }
                Part::Row(item) => {
                    let Some(place) = self.place(item) else { continue };
                    let range = place.offset..place.offset + u64::from(place.length);
                    let bytes = part_bytes(range).ok_or_else(|| cut_short("a page".to_owned()))?;
                    arrived.push(Arrived { item, place, bytes: bytes.to_vec() });
                }
            }
        }
        self.index.extend(indexes);
        Ok(arrived)
    }

    /// A request came to nothing; what it was to bring may be wanted again.
    pub(crate) fn failed(&mut self, id: u32) {
        self.flights.remove(&id);
    }

    fn section(&self, item: Item) -> Option<&PackSection> {
        self.head.sections.get(item.section)
    }

    fn place(&self, item: Item) -> Option<PackEntry> {
        let block = self.index.get(&(item.section, item.entry / INDEX_BLOCK))?;
        block.get((item.entry % INDEX_BLOCK) as usize).copied()
    }

    fn flies(&self, part: Part) -> bool {
        self.flights.values().any(|flight| flight.parts.contains(&part))
    }

    fn start_holds(&self, offset: u64, length: u64) -> bool {
        offset.saturating_add(length) <= self.start.len() as u64
    }

    /// Reads the part of an index that tells where an item is, when it came with the first bytes.
    fn index_from_start(&mut self, item: Item) {
        let key = (item.section, item.entry / INDEX_BLOCK);
        let Some(section) = self.section(item) else { return };
        let range = section.index_range(key.1 * INDEX_BLOCK, (key.1 + 1) * INDEX_BLOCK);
        if self.index.contains_key(&key) || !self.start_holds(range.start, range.end - range.start) {
            return;
        }
        let bytes = &self.start[range.start as usize..range.end as usize];
        if let Ok(entries) = section.parse_entries(Path::new(&self.head.title), key.1 * INDEX_BLOCK, bytes) {
            self.index.insert(key, entries);
        }
    }
}

/// How many of the first bytes are worth keeping.
pub(crate) fn kept_start(mut start: Vec<u8>) -> Vec<u8> {
    start.truncate(KEPT_BYTES as usize);
    start
}

const _: () = assert!(INDEX_BLOCK as usize * ENTRY_BYTES == 4096);
