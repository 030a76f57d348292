//! LandXML 1.0 to 2.0 and J-LandXML: the TIN of a surface, in one pass.
//!
//! Based on: LandXML.org, "LandXML 1.2 schema", 2008. Points are northing, easting, height; faces name points by ids that
//! need not be a sequence; a face with `i="1"` belongs to the triangulation but is not shown.

use super::landxml_surface::{CgPoints, Surface, triple};
use super::landxml_words;
use super::notes::Notes;
use super::xml::{Node, Tag, Xml};
use super::{ReadTin, TinReadOptions, check, metric};
use crate::IoError;
use std::io::BufRead;
use yamanami_core::{BreaklineKind, Crs};

/// Most names of other surfaces kept.
const MAX_OTHERS: usize = 1000;

/// What is known of a file so far.
#[derive(Default)]
struct File {
    unit_m: Option<f64>,
    crs: Option<Crs>,
    cg_points: CgPoints,
    /// The surface to take, so far.
    best: Option<Surface>,
    other_surfaces: Vec<String>,
    notes: Notes,
}

/// What the start tags of the elements around here said.
#[derive(Default)]
struct Heads {
    /// Of a `P`: its id and the survey point that it is.
    point: (String, Option<String>),
    /// Of an `F`.
    is_hidden: bool,
    /// Of a `Breakline` or `Boundary`.
    line: Option<(String, BreaklineKind)>,
    /// Of a `CgPoint`.
    cg_point: String,
}

/// Reads a surface; the root element was read already.
pub(super) fn read<R: BufRead>(mut xml: Xml<'_, R>, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let mut file = File::default();
    let mut heads = Heads::default();
    let mut surface: Option<Surface> = None;
    loop {
        match xml.next()? {
            Node::Start(tag, line) => match (&surface, tag.local_name()) {
                (None, "Metric" | "Imperial") if file.unit_m.is_none() => {
                    file.unit_m = Some(landxml_words::unit_m(&tag, line, &mut file.notes));
                }
                (None, "CoordinateSystem") if file.crs.is_none() => {
                    file.crs = landxml_words::crs(&tag, line, &mut file.notes);
                }
                (None, "CgPoint") => heads.cg_point = tag.attribute("name").unwrap_or_default(),
                (None, "Surface") => {
                    surface = Some(Surface::named(tag.attribute("name").unwrap_or_default()));
                }
                (Some(_), _) => heads.begin(&tag),
                _ => {}
            },
            Node::End(name, text, line) => match (&mut surface, name) {
                (Some(_), "Surface") => file.take(surface.take(), options),
                (Some(surface), _) => heads.end(surface, name, text, line),
                (None, "CgPoint") => {
                    if let Some(place) = triple(text) {
                        file.cg_points.insert(std::mem::take(&mut heads.cg_point), place);
                    }
                }
                _ => {}
            },
            Node::Eof => break,
        }
    }
    file.finish(&xml, options)
}

impl Heads {
    fn begin(&mut self, tag: &Tag<'_>) {
        match tag.local_name() {
            "P" => self.point = (tag.attribute("id").unwrap_or_default(), tag.attribute("pntRef")),
            "F" => self.is_hidden = tag.attribute("i").is_some_and(|i| matches!(i.trim(), "1" | "true")),
            "Breakline" => {
                let kind = match tag.attribute("brkType").as_deref().map(str::trim) {
                    // these take their heights from the surface
                    Some("proximity" | "nondestructive") => BreaklineKind::Soft,
                    _ => BreaklineKind::Hard,
                };
                self.line = Some((tag.attribute("name").unwrap_or_default(), kind));
            }
            "Boundary" => {
                // a boundary without a name is called what it is: outer, void, island
                let name = tag.attribute("name").or_else(|| tag.attribute("bndType")).unwrap_or_default();
                self.line = Some((name, BreaklineKind::Boundary));
            }
            _ => {}
        }
    }

    fn end(&mut self, surface: &mut Surface, name: &str, text: &str, line: u64) {
        match name {
            "P" => {
                let (id, reference) = std::mem::take(&mut self.point);
                surface.point(&id, reference, text, line);
            }
            "F" => surface.face(self.is_hidden, text, line),
            "PntList3D" | "PntList2D" => {
                if let Some((line_name, kind)) = &self.line {
                    surface.line(line_name, *kind, text, name == "PntList3D", line);
                }
            }
            "Breakline" | "Boundary" => self.line = None,
            "Contour" => surface.notes.count("contours not read", format_args!("line {line}")),
            "DataPoints" => surface.notes.count("lists of source points not read", format_args!("line {line}")),
            _ => {}
        }
    }
}

impl File {
    /// Keeps a surface if it is the one to take.
    fn take(&mut self, surface: Option<Surface>, options: &TinReadOptions) {
        let Some(surface) = surface else { return };
        let is_better = match (&options.surface, &self.best) {
            (Some(name), best) => best.is_none() && surface.name == *name,
            (None, Some(best)) => surface.weight() > best.weight(),
            (None, None) => true,
        };
        let other = if is_better { self.best.replace(surface) } else { Some(surface) };
        if let Some(other) = other
            && self.other_surfaces.len() < MAX_OTHERS
        {
            self.other_surfaces.push(other.name);
        }
    }

    fn finish<R: BufRead>(mut self, xml: &Xml<'_, R>, options: &TinReadOptions) -> Result<ReadTin, IoError> {
        let Some(surface) = self.best else {
            let expected = match &options.surface {
                Some(name) => format!("a surface '{name}'"),
                None => "a surface".to_owned(),
            };
            let found = match &self.other_surfaces[..] {
                [] => "none".to_owned(),
                names => format!("'{}'", names.join("', '")),
            };
            return Err(IoError::malformed(xml.name(), "Surfaces", expected, found));
        };
        let (unit_m, crs) = (self.unit_m, self.crs);
        if unit_m.is_none() && options.unit_m.is_none() {
            self.notes.say("no unit is stated, metres assumed");
        }
        let unit_m = options.unit_m.or(unit_m).unwrap_or(1.0);
        let crs = options.epsg.map(check::crs_of_epsg).or(crs).unwrap_or_default();
        let place = format!("surface '{}'", surface.name);
        let (mut tin, notes) = surface.into_tin(unit_m, crs, &self.cg_points);
        let lack = tin.mesh.triangles.is_empty().then(|| {
            let [points, hidden, lines] = [tin.mesh.positions.len(), tin.hidden.len(), tin.breaklines.len()];
            let found = format!("{points} points, {hidden} hidden faces, {lines} lines");
            [place, "faces that are shown".to_owned(), found]
        });
        self.notes.join(notes);
        if unit_m == 1.0 {
            metric::to_metres(&mut tin, &mut self.notes);
        }
        let read = check::readable(tin, self.notes);
        Ok(ReadTin { other_surfaces: self.other_surfaces, lack: lack.or(read.lack), ..read })
    }
}
