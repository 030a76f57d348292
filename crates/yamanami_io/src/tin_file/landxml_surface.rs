//! One surface of a LandXML file while it is read: points by their ids, faces, lines, in the unit of the file.

use super::notes::Notes;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use yamanami_core::{Breakline, BreaklineKind, Crs, Tin, TriangleMesh};

/// Most steps spent on heights for lines that have none.
const NEAREST_STEPS: u64 = 1 << 28;
/// How many times the number of points an id may be and still be looked up in a plain list.
const DENSE_FOLD: u64 = 16;

/// Places of survey points (`CgPoint`) by their name, in the unit of the file.
pub(super) type CgPoints = HashMap<String, DVec3>;

/// A surface.
#[derive(Debug, Default)]
pub(super) struct Surface {
    /// Its name.
    pub(super) name: String,
    /// What was wrong in it.
    pub(super) notes: Notes,
    points: Vec<DVec3>,
    ids: Ids,
    /// Points that are said to be at survey points, which may come later in the file.
    references: Vec<(u32, String)>,
    faces: Vec<[u32; 3]>,
    hidden: Vec<[u32; 3]>,
    lines: Vec<Breakline>,
}

/// Numbers of points by their ids: a list where the ids are dense, as they mostly are.
#[derive(Debug, Default)]
struct Ids {
    dense: Vec<u32>,
    sparse: HashMap<u64, u32>,
}

impl Ids {
    fn get(&self, id: u64) -> Option<u32> {
        match usize::try_from(id).ok().and_then(|id| self.dense.get(id)) {
            Some(&number) if number != u32::MAX => Some(number),
            _ => self.sparse.get(&id).copied(),
        }
    }

    /// False where the id is taken.
    fn insert(&mut self, id: u64, number: u32) -> bool {
        if self.get(id).is_some() {
            return false;
        }
        if id < DENSE_FOLD * (u64::from(number) + 64) {
            let id = id as usize;
            if id >= self.dense.len() {
                self.dense.resize(id + 1, u32::MAX);
            }
            self.dense[id] = number;
        } else {
            self.sparse.insert(id, number);
        }
        true
    }
}

impl Surface {
    /// An empty surface.
    pub(super) fn named(name: String) -> Self {
        Self { name, ..Self::default() }
    }

    /// Its triangles, hidden ones too, and lines: of two surfaces that with more triangles counts, then that with more lines.
    pub(super) fn weight(&self) -> [usize; 2] {
        [self.faces.len() + self.hidden.len(), self.lines.len()]
    }

    /// A point: `northing easting height`, or the name of a survey point.
    pub(super) fn point(&mut self, id: &str, reference: Option<String>, text: &str, line: u64) {
        let Some(id) = id.trim().parse::<u64>().ok().filter(|&id| id > 0) else {
            return self.notes.count("points without an id above zero dropped", format_args!("line {line}"));
        };
        let place = match (triple(text), &reference) {
            (Some(place), _) => place,
            (None, Some(_)) => DVec3::NAN,
            (None, None) => {
                return self.notes.count("points that are not three numbers dropped", format_args!("line {line}"));
            }
        };
        let number = self.points.len() as u32;
        if number == u32::MAX || !self.ids.insert(id, number) {
            return self.notes.count("points with the id of another one dropped", format_args!("line {line}"));
        }
        self.points.push(place);
        if let Some(name) = reference.filter(|_| place.is_nan()) {
            self.references.push((number, name));
        }
    }

    /// A face: ids of three points, or of four that become two triangles.
    pub(super) fn face(&mut self, is_hidden: bool, text: &str, line: u64) {
        let mut ids = [0; 4];
        let mut count = 0;
        for word in text.split_ascii_whitespace() {
            match (word.parse::<u64>(), ids.get_mut(count)) {
                (Ok(id), Some(slot)) => *slot = id,
                _ => count = ids.len(),
            }
            count += 1;
        }
        let place = format_args!("line {line}");
        if count != 3 && count != 4 {
            return self.notes.count("faces that are not three or four ids dropped", place);
        }
        let mut corners = [0; 4];
        for k in 0..count {
            match self.ids.get(ids[k]) {
                Some(number) => corners[k] = number,
                None => return self.notes.count("faces with a point that is not there dropped", place),
            }
        }
        let [a, b, c, d] = corners;
        let triangles = if count == 4 { &[[a, b, c], [a, c, d]][..] } else { &[[a, b, c]] };
        if count == 4 {
            self.notes.count("faces of four points cut in two", place);
        }
        for &[a, b, c] in triangles {
            if a == b || b == c || c == a {
                self.notes.count("faces with a point twice dropped", place);
            } else if is_hidden {
                self.hidden.push([a, b, c]);
            } else {
                self.faces.push([a, b, c]);
            }
        }
    }

    /// A line: triples, or pairs without heights.
    pub(super) fn line(&mut self, name: &str, kind: BreaklineKind, text: &str, has_heights: bool, line: u64) {
        let place = format_args!("line {line}");
        let each = if has_heights { 3 } else { 2 };
        let numbers: Option<Vec<f64>> = text.split_ascii_whitespace().map(finite).collect();
        let Some(numbers) = numbers.filter(|n| n.len() >= 2 * each && n.len().is_multiple_of(each)) else {
            return self.notes.count("breaklines that are not a list of points dropped", place);
        };
        let point = |n: &[f64]| DVec3::new(n[1], n[0], n.get(2).copied().unwrap_or(f64::NAN));
        let points = numbers.chunks_exact(each).map(point).collect();
        self.lines.push(Breakline { name: name.to_owned(), kind, points });
    }

    /// The surface in metres.
    pub(super) fn into_tin(mut self, unit_m: f64, crs: Crs, cg_points: &CgPoints) -> (Tin, Notes) {
        for (number, name) in std::mem::take(&mut self.references) {
            match cg_points.get(&name) {
                Some(&place) => self.points[number as usize] = place,
                None => self.notes.count("points at a survey point that is not there", format_args!("'{name}'")),
            }
        }
        self.lift_lines();
        for place in self.points.iter_mut().chain(self.lines.iter_mut().flat_map(|line| &mut line.points)) {
            *place *= unit_m;
        }
        let mesh = TriangleMesh::new(self.points, self.faces);
        let tin = Tin { name: self.name, mesh, hidden: self.hidden, breaklines: self.lines, crs, unit_m };
        (tin, self.notes)
    }

    /// Gives the points of lines without heights those of the nearest vertices.
    fn lift_lines(&mut self) {
        let flat = self.lines.iter().filter(|line| line.points.iter().any(|p| p.z.is_nan())).count();
        if flat == 0 {
            return;
        }
        let vertices = self.points.len() as u64;
        let mut left = NEAREST_STEPS;
        let mut lifted = 0;
        for line in self.lines.iter_mut().filter(|line| line.points.iter().any(|p| p.z.is_nan())) {
            let steps = vertices.saturating_mul(line.points.len() as u64);
            if steps > left {
                continue;
            }
            left -= steps;
            lifted += 1;
            for place in &mut line.points {
                place.z = height_of_nearest(&self.points, place.truncate());
            }
        }
        self.notes.say(format!("{lifted} lines without heights: those of the nearest points taken"));
        if lifted < flat {
            self.notes.say(format!("{} lines without heights dropped: too many for so large a surface", flat - lifted));
        }
        self.lines.retain(|line| line.points.iter().all(|p| p.is_finite()));
    }
}

fn height_of_nearest(points: &[DVec3], place: DVec2) -> f64 {
    let distance = |p: &&DVec3| p.truncate().distance_squared(place);
    let placed = points.iter().filter(|p| p.is_finite());
    placed.min_by(|a, b| distance(a).total_cmp(&distance(b))).map_or(f64::NAN, |p| p.z)
}

fn finite(word: &str) -> Option<f64> {
    word.parse::<f64>().ok().filter(|n| n.is_finite())
}

/// `northing easting height` as x, y, z.
pub(super) fn triple(text: &str) -> Option<DVec3> {
    let mut words = text.split_ascii_whitespace().map(finite);
    match (words.next()??, words.next()??, words.next()??, words.next()) {
        (northing, easting, height, None) => Some(DVec3::new(easting, northing, height)),
        _ => None,
    }
}
