//! The entities of a drawing as faces and lines of a TIN: `3DFACE`, `POLYLINE` with its vertices, `LWPOLYLINE`, `LINE`,
//! `MESH`.
//!
//! Based on: Autodesk, "DXF reference", 2018.

use super::groups::Groups;
use super::layers::{FACES, Layers};
use super::polyline::Polyline;
use super::read::Header;
use crate::IoError;
use crate::tin_file::upward::{cut_quad, upward};
use crate::tin_file::weld::Weld;
use crate::tin_file::{Notes, ReadTin, TinReadOptions, check, metric};
use glam::DVec3;
use std::path::Path;
use yamanami_core::{Breakline, Tin};

/// What an entity is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Kind {
    Face,
    Polyline,
    Vertex,
    LightPolyline,
    Line,
    Mesh,
    #[default]
    Other,
}

/// The entity being read.
#[derive(Debug, Default)]
pub(super) struct Entity {
    kind: Kind,
    pub(super) line: u64,
    pub(super) layer: usize,
    on_paper: bool,
    pub(super) invisible: bool,
    /// Groups 10 to 33: x, y and z of up to four corners.
    pub(super) corners: [DVec3; 4],
    /// Which of the x (bits 0 to 3) and y (bits 4 to 7) were given.
    given: u8,
    /// Group 38.
    elevation: f64,
    /// Group 70.
    pub(super) flags: i64,
    /// Groups 71 to 74.
    pub(super) counts: [i64; 4],
    /// Whether its plane is not level.
    pub(super) tilted: bool,
    /// Whether it bends between vertices.
    pub(super) bulged: bool,
    points: Vec<DVec3>,
    /// Corners of a mesh's faces: their number, then theirs.
    list: Vec<i64>,
    /// How many more numbers belong to that list.
    list_left: i64,
    /// Group 91.
    level: i64,
    /// Whether the extended data now read are our own.
    own_data: bool,
    pub(super) name: String,
}

impl Entity {
    /// No entity, that goes on with the buffers of an old one.
    fn after(old: Self) -> Self {
        let Self { mut points, mut list, .. } = old;
        points.clear();
        list.clear();
        Self { points, list, ..Self::default() }
    }

    fn has_corners(&self, count: usize) -> bool {
        let wanted = (1u8 << count) - 1;
        self.given & wanted == wanted && self.given >> 4 & wanted == wanted
    }
}

/// A drawing of which a part was read.
pub(super) struct Drawing<'a> {
    path: &'a Path,
    unit_m: f64,
    /// The only layer whose faces are wanted.
    surface: Option<&'a str>,
    tin: Tin,
    weld: Weld,
    pub(super) notes: Notes,
    layers: Layers,
    entity: Entity,
    polyline: Option<Polyline>,
    blocks: u64,
}

impl<'a> Drawing<'a> {
    pub(super) fn new(path: &'a Path, unit_m: f64, options: &'a TinReadOptions) -> Self {
        Self {
            path,
            unit_m,
            surface: options.surface.as_deref(),
            tin: Tin::default(),
            weld: Weld::default(),
            notes: Notes::default(),
            layers: Layers::default(),
            entity: Entity::default(),
            polyline: None,
            blocks: 0,
        }
    }

    /// Begins an entity, with its type at hand.
    pub(super) fn begin_entity(&mut self, groups: &Groups<'_>) -> Result<(), IoError> {
        let kind = match groups.value() {
            b"3DFACE" => Kind::Face,
            b"POLYLINE" => Kind::Polyline,
            b"VERTEX" => Kind::Vertex,
            b"LWPOLYLINE" => Kind::LightPolyline,
            b"LINE" => Kind::Line,
            b"MESH" => Kind::Mesh,
            b"INSERT" => {
                self.blocks += 1;
                Kind::Other
            }
            _ => Kind::Other,
        };
        if kind != Kind::Vertex {
            self.end_polyline()?;
        }
        self.entity.kind = kind;
        self.entity.line = groups.line();
        Ok(())
    }

    /// Takes a group of the entity.
    pub(super) fn group(&mut self, code: i32, groups: &Groups<'_>, header: &Header) -> Result<(), IoError> {
        let entity = &mut self.entity;
        match (entity.kind, code) {
            (Kind::Other, _) => {}
            (_, 8) => entity.layer = self.layers.number(groups.value(), |bytes| header.text(bytes)),
            (Kind::LightPolyline | Kind::Mesh, 10) => entity.points.push(DVec3::new(groups.number()?, 0.0, 0.0)),
            (Kind::LightPolyline | Kind::Mesh, 20 | 30) => {
                let value = groups.number()?;
                if let Some(point) = entity.points.last_mut() {
                    point[code as usize / 10 - 1] = value;
                }
            }
            (_, 10..=13 | 20..=23 | 30..=33) => {
                let (axis, corner) = (code as usize / 10 - 1, code as usize % 10);
                entity.corners[corner][axis] = groups.number()?;
                if axis < 2 {
                    entity.given |= 1 << (axis * 4 + corner);
                }
            }
            (_, 38) => entity.elevation = groups.number()?,
            (_, 42) => entity.bulged |= groups.number()? != 0.0,
            (_, 60) => entity.invisible = groups.integer()? == 1,
            (_, 67) => entity.on_paper = groups.integer()? == 1,
            (_, 70) => entity.flags = groups.integer()?,
            (_, 71..=74) => entity.counts[code as usize - 71] = groups.integer()?,
            (Kind::Mesh, 90) if entity.list_left > 0 => {
                entity.list_left -= 1;
                entity.list.push(groups.integer()?);
            }
            (Kind::Mesh, 91) => entity.level = groups.integer()?,
            (Kind::Mesh, 93) => entity.list_left = groups.integer()?,
            (Kind::Mesh, 94) => entity.list_left = 0,
            (_, 210 | 220) => entity.tilted |= groups.number()? != 0.0,
            (_, 230) => entity.tilted |= groups.number()? <= 0.0,
            (_, 1001) => entity.own_data = groups.value() == super::APPLICATION.as_bytes(),
            (_, 1000) if entity.own_data => entity.name = header.text(groups.value()),
            _ => {}
        }
        Ok(())
    }

    /// Ends the entity: what it draws becomes part of the TIN.
    pub(super) fn end_entity(&mut self) -> Result<(), IoError> {
        let entity = std::mem::take(&mut self.entity);
        if !entity.on_paper {
            match entity.kind {
                Kind::Face => self.face(&entity)?,
                Kind::Polyline => {
                    self.polyline = Some(Polyline::new(entity));
                    return Ok(());
                }
                Kind::Vertex => {
                    if let Some(polyline) = &mut self.polyline {
                        polyline.vertex(&entity);
                    }
                }
                Kind::LightPolyline => self.light_polyline(&entity),
                Kind::Line => self.straight_line(&entity),
                Kind::Mesh => self.mesh(&entity)?,
                Kind::Other => {}
            }
        }
        self.entity = Entity::after(entity);
        Ok(())
    }

    /// Ends the polyline whose vertices were read, if there is one.
    pub(super) fn end_polyline(&mut self) -> Result<(), IoError> {
        match self.polyline.take() {
            Some(polyline) => polyline.finish(self),
            None => Ok(()),
        }
    }

    fn face(&mut self, entity: &Entity) -> Result<(), IoError> {
        if !entity.has_corners(3) {
            self.count("faces of fewer than three corners dropped", entity.line);
            return Ok(());
        }
        let [a, b, c, fourth] = entity.corners;
        let d = if entity.has_corners(4) { fourth } else { c };
        self.polygon(&[a, b, c, d], entity)
    }

    /// Adds a polygon in the drawing's unit. Corners that repeat the one before them do not count.
    pub(super) fn polygon(&mut self, corners: &[DVec3], entity: &Entity) -> Result<(), IoError> {
        let line = entity.line;
        let mut distinct: Vec<DVec3> = corners.iter().map(|&p| p * self.unit_m).collect();
        distinct.dedup();
        if distinct.len() > 1 && distinct.first() == distinct.last() {
            distinct.pop();
        }
        let layer = self.layers.get(entity.layer);
        let hidden = entity.invisible || layer.hidden;
        layer.faces += 1;
        if self.surface.is_some_and(|wanted| wanted != layer.name) {
            return Ok(());
        }
        match distinct[..] {
            [a, b, c] => self.triangle([a, b, c], hidden, line),
            [a, b, c, d] => {
                let quad = [a, b, c, d];
                let cut = cut_quad(quad).map(|corners| corners.map(|k| quad[k]));
                cut.into_iter().try_for_each(|corners| self.triangle(corners, hidden, line))
            }
            [a, ref rest @ ..] if rest.len() > 3 => {
                self.count("faces of more than four corners cut as fans", line);
                rest.windows(2).try_for_each(|pair| self.triangle([a, pair[0], pair[1]], hidden, line))
            }
            _ => {
                self.count("faces that are vertical or without an area dropped", line);
                Ok(())
            }
        }
    }

    fn triangle(&mut self, corners: [DVec3; 3], hidden: bool, line: u64) -> Result<(), IoError> {
        if let Some(corners) = upward(corners, |p| p, &mut self.notes, format_args!("line {line}")) {
            let mut numbers = [0; 3];
            for (number, place) in numbers.iter_mut().zip(corners) {
                let limit = 1 << 31;
                let vertex = self.weld.vertex(place);
                *number = vertex.ok_or_else(|| IoError::too_large(self.path, "vertices", limit + 1, limit))?;
            }
            let triangles = if hidden { &mut self.tin.hidden } else { &mut self.tin.mesh.triangles };
            triangles.push(numbers);
        }
        Ok(())
    }

    /// Adds a line in the drawing's unit.
    pub(super) fn line(&mut self, points: impl IntoIterator<Item = DVec3>, entity: &Entity) {
        let points: Vec<DVec3> = points.into_iter().map(|p| p * self.unit_m).collect();
        if points.len() < 2 || !points.iter().all(|p| p.is_finite()) {
            self.count("lines of fewer than two points or with one that is no finite number dropped", entity.line);
            return;
        }
        let layer = self.layers.get(entity.layer);
        let name = if entity.name.is_empty() { layer.line_name() } else { &entity.name };
        self.tin.breaklines.push(Breakline { name: name.to_owned(), kind: layer.kind, points });
    }

    /// Adds a line that is drawn at one height, unless that height only means that the line has none.
    pub(super) fn level_line(&mut self, points: impl IntoIterator<Item = DVec3>, entity: &Entity, height: f64) {
        if entity.tilted {
            self.count("polylines in planes of their own left out", entity.line);
        } else if height == 0.0 {
            self.count("flat lines at height zero left out", entity.line);
        } else {
            if entity.bulged {
                self.count("polylines whose arcs became straight", entity.line);
            }
            let points = points.into_iter().map(|p| p.truncate().extend(height));
            self.line(points, entity);
        }
    }

    fn light_polyline(&mut self, entity: &Entity) {
        let closing = if entity.flags & 1 != 0 { entity.points.first() } else { None };
        let points = entity.points.iter().chain(closing).copied();
        self.level_line(points, entity, entity.elevation);
    }

    fn straight_line(&mut self, entity: &Entity) {
        let [a, b, ..] = entity.corners;
        if a.z == 0.0 && b.z == 0.0 {
            self.count("flat lines at height zero left out", entity.line);
        } else {
            self.line([a, b], entity);
        }
    }

    fn mesh(&mut self, entity: &Entity) -> Result<(), IoError> {
        if entity.level > 0 {
            self.count("smoothed meshes of which the coarsest level was read", entity.line);
        }
        let mut list = entity.list.as_slice();
        let mut corners = Vec::new();
        while let [count, rest @ ..] = list {
            let count = usize::try_from(*count).ok().filter(|&n| n <= rest.len());
            let Some((face, after)) = count.map(|n| rest.split_at(n)) else {
                self.count("faces of meshes whose list is cut short dropped", entity.line);
                break;
            };
            list = after;
            corners.clear();
            corners.extend(face.iter().filter_map(|&i| entity.points.get(usize::try_from(i).ok()?)).copied());
            if corners.len() < face.len() {
                self.count("faces with a corner that is no vertex dropped", entity.line);
            } else {
                self.polygon(&corners, entity)?;
            }
        }
        Ok(())
    }

    pub(super) fn count(&mut self, what: &'static str, line: u64) {
        self.notes.count(what, format_args!("line {line}"));
    }

    /// What became of the drawing; the other surfaces are layers with faces that were left out.
    pub(super) fn finish(self, header: Header, options: &TinReadOptions) -> Result<ReadTin, IoError> {
        let Self { mut tin, mut notes, .. } = self;
        tin.mesh.positions = self.weld.into_positions();
        let shown: Vec<&str> = self.layers.with_faces().filter(|l| !l.hidden).map(|l| l.name.as_str()).collect();
        if self.blocks > 0 {
            notes.say(format!("{} block references (INSERT) not expanded", self.blocks));
        }
        if let Some(wanted) = self.surface
            && !self.layers.with_faces().any(|layer| layer.name == wanted)
        {
            let found = format!("faces on {}", shown.join(", "));
            return Err(IoError::malformed(self.path, "layers", format!("faces on layer '{wanted}'"), found));
        }
        let lack = tin.mesh.triangles.is_empty().then(|| {
            let (lines, blocks) = (tin.breaklines.len(), self.blocks);
            let found = format!("{lines} lines, {blocks} references to blocks and no face that is shown");
            ["entities".to_owned(), "a 3DFACE, a mesh, or a POLYLINE that is one".to_owned(), found]
        });
        tin.name = match (self.surface, shown.as_slice()) {
            _ if !header.name.is_empty() => header.name,
            (Some(wanted), _) => wanted.to_owned(),
            (None, &[only]) if only != FACES && only != "0" => only.to_owned(),
            _ => String::new(),
        };
        if self.surface.is_none() && shown.len() > 1 {
            notes.say(format!("faces of {} layers joined: {}", shown.len(), shown.join(", ")));
        }
        let others = shown.iter().filter(|&&name| self.surface.is_some_and(|wanted| wanted != name));
        let other_surfaces = others.map(|&name| name.to_owned()).collect();
        tin.unit_m = self.unit_m;
        tin.crs = check::crs(options);
        metric::to_metres(&mut tin, &mut notes);
        let read = check::readable(tin, notes);
        Ok(ReadTin { other_surfaces, lack: lack.or(read.lack), ..read })
    }
}
