//! CityGML 2 and 3 relief: the triangles of `TINRelief`, the lines of `BreaklineRelief`, in one pass. Triangles come as
//! rings of four points without indices; equal places become one vertex.
//!
//! Based on: Open Geospatial Consortium, "City Geography Markup Language (CityGML) encoding standard 2.0", 2012, chapter
//! 10.3; Ministry of Land, Infrastructure, Transport and Tourism (Japan), "Project PLATEAU, standard data product
//! specification for 3D city models", for relief in EPSG:6697.

use super::notes::Notes;
use super::srs_name::Srs;
use super::weld::Weld;
use super::xml::{Node, Tag, Xml};
use super::{ReadTin, TinReadOptions, check, metric};
use crate::IoError;
use glam::DVec3;
use std::io::BufRead;
use yamanami_core::{Breakline, BreaklineKind, Tin, TriangleMesh};

/// Most names of other surfaces kept.
const MAX_OTHERS: usize = 1000;

/// A city model's relief so far, in the coordinates of the file, x first.
#[derive(Default)]
struct Relief {
    srs: Option<Srs>,
    weld: Weld,
    triangles: Vec<[u32; 3]>,
    lines: Vec<Breakline>,
    name: String,
    /// Level of detail of the triangles.
    lod: u32,
    other_surfaces: Vec<String>,
    notes: Notes,
    /// Where in the file we are.
    inside: Inside,
    /// Numbers of the ring or line that is being read.
    numbers: Vec<f64>,
    /// The corners of a ring.
    corners: Vec<DVec3>,
}

/// The elements around the one that is read.
#[derive(Default)]
struct Inside {
    /// `TINRelief` or `BreaklineRelief`; names and levels in it are its own.
    relief: bool,
    /// `tin`: rings elsewhere are extents.
    tin: bool,
    /// `breaklines`, `ridgeOrValleyLines` or the `breakLines` and `stopLines` of a `Tin`.
    lines: bool,
    /// A ring that is a hole.
    interior: bool,
    /// Whether the relief is left out.
    skip: bool,
    name: String,
    lod: u32,
    /// Numbers of a point.
    dimension: usize,
}

/// Reads the relief of a city model; the root element was read already.
pub(super) fn read<R: BufRead>(mut xml: Xml<'_, R>, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let mut relief = Relief { srs: options.epsg.map(Srs::of_epsg), ..Relief::default() };
    loop {
        match xml.next()? {
            Node::Start(tag, line) => relief.begin(&tag, line, options),
            Node::End(name, text, line) => {
                if !relief.end(name, text, line) {
                    return Err(IoError::too_large(xml.name(), "vertices", 1 << 31, (1 << 31) - 1));
                }
            }
            Node::Eof => break,
        }
    }
    relief.finish(&xml, options)
}

impl Relief {
    fn begin(&mut self, tag: &Tag<'_>, line: u64, options: &TinReadOptions) {
        let name = tag.local_name();
        match name {
            "TINRelief" | "BreaklineRelief" => self.inside = Inside { relief: true, ..Inside::default() },
            "MassPointRelief" => self.notes.count("reliefs of mass points not read", format_args!("line {line}")),
            "RasterRelief" => self.notes.count("reliefs of rasters not read", format_args!("line {line}")),
            "tin" => {
                self.inside.tin = true;
                self.choose(line, options);
            }
            "breaklines" | "ridgeOrValleyLines" | "breakLines" | "stopLines" => self.inside.lines = true,
            "interior" => self.inside.interior = true,
            "LinearRing" | "LineString" | "LineStringSegment" => self.numbers.clear(),
            "pos" | "posList" | "coordinates" => {
                let stated = tag.attribute("srsDimension").and_then(|n| n.trim().parse().ok());
                self.inside.dimension = stated.unwrap_or(3);
            }
            _ => {}
        }
        if options.epsg.is_none()
            && matches!(name, "Envelope" | "TriangulatedSurface" | "Tin" | "MultiCurve" | "LineString" | "posList")
            && let Some(srs) = tag.attribute("srsName").and_then(|name| Srs::parse(&name))
            && self.srs.as_ref() != Some(&srs)
        {
            if self.srs.is_none() || self.triangles.is_empty() && self.lines.is_empty() {
                self.srs = Some(srs);
            } else {
                self.notes.count("changes of the CRS within the file passed over", format_args!("line {line}"));
            }
        }
    }

    /// At the beginning of a relief's triangles: whether they are wanted.
    fn choose(&mut self, line: u64, options: &TinReadOptions) {
        let (name, lod) = (std::mem::take(&mut self.inside.name), self.inside.lod);
        if options.surface.as_ref().is_some_and(|wanted| *wanted != name) {
            self.inside.skip = true;
            if self.other_surfaces.len() < MAX_OTHERS {
                self.other_surfaces.push(name);
            }
            return;
        }
        if !self.triangles.is_empty() && lod != self.lod {
            self.notes.count("reliefs of other than the finest level of detail left out", format_args!("line {line}"));
            if lod < self.lod {
                self.inside.skip = true;
                return;
            }
            (self.weld, self.triangles) = Default::default();
        }
        self.lod = lod;
        if self.name.is_empty() {
            self.name = name;
        }
    }

    /// False when there are too many vertices.
    fn end(&mut self, name: &str, text: &str, line: u64) -> bool {
        match name {
            "TINRelief" | "BreaklineRelief" => self.inside = Inside::default(),
            "tin" => self.inside.tin = false,
            "breaklines" | "ridgeOrValleyLines" | "breakLines" | "stopLines" => self.inside.lines = false,
            "interior" => self.inside.interior = false,
            "name" if self.inside.relief && !self.inside.tin => self.inside.name = text.trim().to_owned(),
            "lod" if self.inside.relief && !self.inside.tin => self.inside.lod = text.trim().parse().unwrap_or(0),
            "pos" | "posList" | "coordinates" if self.inside.tin || self.inside.lines => self.take_numbers(text, line),
            "LinearRing" if self.inside.tin && !self.inside.skip => return self.ring(line),
            "LineString" | "LineStringSegment" if self.inside.lines && !self.inside.skip => self.line(line),
            _ => {}
        }
        true
    }

    fn take_numbers(&mut self, text: &str, line: u64) {
        if self.inside.dimension == 2 {
            self.notes.count("lists of points without heights", format_args!("line {line}"));
        }
        let words = text.split(|c: char| c.is_ascii_whitespace() || c == ',').filter(|word| !word.is_empty());
        // what is no number makes its ring wrong
        self.numbers.extend(words.map(|word| word.parse().unwrap_or(f64::NAN)));
    }

    /// The points of the numbers, x first; none when one is wrong.
    fn take_points(&mut self) -> &mut Vec<DVec3> {
        let swap = self.srs.as_ref().is_some_and(|srs| srs.northing_first);
        self.corners.clear();
        if self.numbers.len().is_multiple_of(3)
            && self.inside.dimension != 2
            && self.numbers.iter().all(|n| n.is_finite())
        {
            let point = |n: &[f64]| if swap { DVec3::new(n[1], n[0], n[2]) } else { DVec3::new(n[0], n[1], n[2]) };
            self.corners.extend(self.numbers.chunks_exact(3).map(point));
        }
        self.numbers.clear();
        &mut self.corners
    }

    fn line(&mut self, line: u64) {
        let points = std::mem::take(self.take_points());
        if points.len() < 2 {
            return self.notes.count("lines that are not two points or more dropped", format_args!("line {line}"));
        }
        self.lines.push(Breakline { name: String::new(), kind: BreaklineKind::Hard, points });
    }

    /// A ring becomes a triangle; false when there are too many vertices.
    fn ring(&mut self, line: u64) -> bool {
        let place = format_args!("line {line}");
        if self.inside.interior {
            self.notes.count("holes in triangles passed over", place);
            return true;
        }
        self.take_points();
        let closes = self.corners.len() > 1 && self.corners.first() == self.corners.last();
        if closes {
            self.corners.pop();
        }
        if self.corners.len() < 3 {
            self.notes.count("rings that are not three points or more dropped", place);
            return true;
        }
        if !closes {
            self.notes.count("rings that are not closed, closed", place);
        }
        if self.corners.len() > 3 {
            if !is_convex(&self.corners) {
                self.notes.count("rings of more than three corners that are not convex dropped", place);
                return true;
            }
            self.notes.count("rings of more than three corners cut into triangles", place);
        }
        let mut numbers = self.corners.iter().map(|&corner| self.weld.vertex(corner));
        let (Some(Some(first)), Some(Some(mut previous))) = (numbers.next(), numbers.next()) else { return false };
        for number in numbers {
            let Some(number) = number else { return false };
            let triangle = [first, previous, number];
            previous = number;
            if triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0] {
                self.notes.count("triangles with a point twice dropped", format_args!("line {line}"));
            } else {
                self.triangles.push(triangle);
            }
        }
        true
    }

    fn finish<R: BufRead>(mut self, xml: &Xml<'_, R>, options: &TinReadOptions) -> Result<ReadTin, IoError> {
        let name = xml.name();
        let lack = self.triangles.is_empty().then(|| {
            let (expected, found) = match &options.surface {
                Some(wanted) => (format!("triangles in '{wanted}'"), format!("'{}'", self.other_surfaces.join("', '"))),
                None => ("triangles".to_owned(), format!("none, and {} lines", self.lines.len())),
            };
            ["TINRelief".to_owned(), expected, found]
        });
        let mut mesh = TriangleMesh::new(self.weld.into_positions(), self.triangles);
        let bounds = metric::bounds(&mesh, &self.lines);
        let srs = self.srs.unwrap_or_default();
        let looks_like_degrees = bounds.min.is_finite()
            && bounds.min.truncate().min_element() > -360.0
            && bounds.max.truncate().max_element() < 360.0;
        if !srs.crs.geographic && looks_like_degrees && !srs.is_known {
            let what =
                format!("coordinates that look like degrees of '{}', which is not known by formula", srs.crs.name);
            return Err(IoError::unsupported(name, what, "state the EPSG code"));
        }
        let swapped = srs.crs.geographic && bounds.max.y > 90.0 && bounds.max.x <= 90.0;
        if swapped {
            self.notes.say("longitudes come before latitudes, against the CRS's own order");
            let lines = self.lines.iter_mut().flat_map(|line| &mut line.points);
            mesh.positions.iter_mut().chain(lines).for_each(|p| (p.x, p.y) = (p.y, p.x));
        }
        let unit_m = options.unit_m.unwrap_or(1.0);
        let mut tin = Tin { name: self.name, mesh, breaklines: self.lines, crs: srs.crs, unit_m, ..Tin::default() };
        if tin.crs.geographic {
            metric::to_metres(&mut tin, &mut self.notes);
            tin.unit_m = 1.0;
        } else if unit_m != 1.0 {
            let lines = tin.breaklines.iter_mut().flat_map(|line| &mut line.points);
            tin.mesh.positions.iter_mut().chain(lines).for_each(|p| *p *= unit_m);
        }
        let read = check::readable(tin, self.notes);
        Ok(ReadTin { other_surfaces: self.other_surfaces, lack: lack.or(read.lack), ..read })
    }
}

/// Whether a polygon turns one way only, seen from above.
fn is_convex(corners: &[DVec3]) -> bool {
    let count = corners.len();
    let turn = |k: usize| {
        let [a, b, c] = [k, k + 1, k + 2].map(|i| corners[i % count].truncate());
        (b - a).perp_dot(c - b)
    };
    (0..count).all(|k| turn(k) >= 0.0) || (0..count).all(|k| turn(k) <= 0.0)
}
