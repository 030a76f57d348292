//! Points as text: tables of coordinates, and the A01 records of SIMA.
//!
//! Format: "SIMA common format" of the Japan surveying instruments manufacturers' association: a record a line, its fields
//! parted by commas; A01 is a point: number, name, x (north), y (east), z.

use super::source::{Source, Text, has_ending};
use super::table::{Columns, Delimiter, Header, number};
use super::{ColumnOrder, PointReadOptions, ReadPoints};
use crate::IoError;
use glam::DVec3;

/// Lines before the first with numbers.
const MOST_HEADER_LINES: usize = 100;

pub(super) fn read(source: Source<'_>, options: &PointReadOptions) -> Result<ReadPoints, IoError> {
    let is_sima = has_ending(source.label(), &["sim"]);
    let mut text = source.into_text()?;
    let unit_m = options.unit_m.unwrap_or(1.0);
    let mut read = ReadPoints { unit_m, ..ReadPoints::default() };
    let mut skipped = Skipped::default();
    if is_sima {
        read_sima(&mut text, &mut read, &mut skipped)?;
    } else {
        read_table(&mut text, options.order, &mut read, &mut skipped)?;
    }
    skipped.note("lines without three numbers", &mut read.notes);
    Ok(read)
}

/// Lines that were skipped.
#[derive(Default)]
pub(super) struct Skipped {
    count: usize,
    first: Option<(usize, String)>,
}

impl Skipped {
    pub(super) fn add(&mut self, number: usize, line: &[u8]) {
        self.count += 1;
        self.first.get_or_insert_with(|| (number, excerpt(line)));
    }

    pub(super) fn note(self, what: &str, notes: &mut Vec<String>) {
        if let Some((line, excerpt)) = self.first {
            notes.push(format!("{} {what} skipped, the first line {line}: {excerpt}", self.count));
        }
    }
}

pub(super) fn excerpt(line: &[u8]) -> String {
    let text = String::from_utf8_lossy(&line[..line.len().min(120)]);
    format!("'{}'", text.chars().take(40).map(|c| if c.is_control() { ' ' } else { c }).collect::<String>())
}

fn push(read: &mut ReadPoints, [east, north, height]: [f64; 3]) {
    let p = DVec3::new(east, north, height) * read.unit_m;
    if p.is_finite() {
        read.points_m.push(p);
    }
}

/// The layout of a table, and its first line of numbers, if that is where the layout came from.
pub(super) struct Layout {
    pub(super) delimiter: Delimiter,
    pub(super) columns: Columns,
    pub(super) first: Option<(usize, Vec<u8>)>,
}

impl Layout {
    /// Reads up to the header, or to the first line that `by_place` finds its columns in.
    pub(super) fn read(
        text: &mut Text<'_>,
        order: ColumnOrder,
        notes: &mut Vec<String>,
        by_place: impl Fn(&[&[u8]]) -> Option<Columns>,
    ) -> Result<Self, IoError> {
        let mut seen = None;
        for _ in 0..MOST_HEADER_LINES {
            let label = text.label.clone();
            let Some((number, line)) = text.next_line()? else { break };
            let bare = strip_comment(line);
            let delimiter = Delimiter::of(bare.unwrap_or(line));
            let fields = delimiter.split(bare.unwrap_or(line));
            match Columns::of_header(&fields, order) {
                Header::Columns(columns) => return Ok(Self { delimiter, columns, first: None }),
                Header::Degrees => {
                    let hint = "project them to a metric CRS first";
                    return Err(IoError::unsupported(label, "points in longitude and latitude", hint));
                }
                Header::No if bare.is_some() => continue,
                Header::No => {}
            }
            if let Some(columns) = by_place(&fields) {
                let ordinals = [columns.east, columns.north, columns.height].map(|c| c + 1);
                let [east, north, height] = ordinals;
                notes.push(format!("no header: columns {east}, {north}, {height} taken as east, north, height"));
                let first = Some((number, line.to_vec()));
                return Ok(Self { delimiter, columns, first });
            }
            seen.get_or_insert_with(|| (number, excerpt(line)));
        }
        let (line, found) = seen.unwrap_or((1, "nothing".to_owned()));
        let expected = "a header with x, y, z (or easting, northing, elevation), or three numbers";
        Err(IoError::malformed(&text.label, format!("line {line}"), expected, found))
    }

    /// The coordinates of a line: east, north, height.
    pub(super) fn place(&self, fields: &[&[u8]]) -> Option<[f64; 3]> {
        let of = |column: usize| number(fields.get(column)?);
        Some([of(self.columns.east)?, of(self.columns.north)?, of(self.columns.height)?])
    }
}

/// What stands behind the sign of a comment.
pub(super) fn strip_comment(line: &[u8]) -> Option<&[u8]> {
    line.strip_prefix(b"#").or_else(|| line.strip_prefix(b"//")).map(<[u8]>::trim_ascii)
}

fn read_table(
    text: &mut Text<'_>,
    order: ColumnOrder,
    read: &mut ReadPoints,
    skipped: &mut Skipped,
) -> Result<(), IoError> {
    let layout = Layout::read(text, order, &mut read.notes, |fields| Columns::of_numbers(fields, order))?;
    let mut take = |number: usize, line: &[u8]| match layout.place(&layout.delimiter.split(line)) {
        Some(place) => push(read, place),
        None if strip_comment(line).is_some() => {}
        None => skipped.add(number, line),
    };
    if let Some((number, line)) = &layout.first {
        take(*number, line);
    }
    while let Some((number, line)) = text.next_line()? {
        take(number, line);
    }
    Ok(())
}

fn read_sima(text: &mut Text<'_>, read: &mut ReadPoints, skipped: &mut Skipped) -> Result<(), IoError> {
    while let Some((line_number, line)) = text.next_line()? {
        if !line.starts_with(b"A01") {
            continue;
        }
        let fields = Delimiter::Byte(b',').split(line);
        let of = |k: usize| fields.get(k).and_then(|f| number(f));
        match (of(3), of(4), of(5)) {
            (Some(north), Some(east), Some(height)) => push(read, [east, north, height]),
            _ => skipped.add(line_number, line),
        }
    }
    Ok(())
}
