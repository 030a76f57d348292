//! Geometries as well-known text.
//!
//! Format: Open Geospatial Consortium 06-103r4, "Simple feature access", 1.2.1, clause 7, and the `SRID=n;` that PostGIS puts
//! before it.

use super::feature::{Line, Shape};
use glam::DVec3;

/// Collections in collections.
const MOST_DEPTH: usize = 16;

/// The shape of a text; `None` when it is no geometry.
pub(super) fn parse(text: &str) -> Option<Shape> {
    let text = text.trim();
    let rest = match text.split_once(';') {
        Some((srid, rest)) if srid.to_ascii_uppercase().starts_with("SRID=") => rest,
        _ => text,
    };
    let mut text = Text { rest };
    let mut shape = Shape::default();
    text.geometry(&mut shape, 0)?;
    text.rest.trim_start().is_empty().then_some(shape)
}

struct Text<'a> {
    rest: &'a str,
}

impl<'a> Text<'a> {
    fn word(&mut self) -> String {
        self.rest = self.rest.trim_start();
        let end = self.rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word.to_ascii_uppercase()
    }

    fn take(&mut self, sign: char) -> Option<()> {
        self.rest = self.rest.trim_start().strip_prefix(sign)?;
        Some(())
    }

    /// Whether the next is so, and takes it.
    fn has(&mut self, sign: char) -> bool {
        self.take(sign).is_some()
    }

    fn geometry(&mut self, shape: &mut Shape, depth: usize) -> Option<()> {
        // `POINT Z (…)`, `POINTZ(…)`, `POINT EMPTY`
        let word = self.word();
        let kind = word.trim_end_matches(['Z', 'M']);
        let (mut dimensions, mut next) = (word[kind.len()..].to_owned(), self.word());
        if matches!(next.as_str(), "Z" | "M" | "ZM") {
            (dimensions, next) = (next, self.word());
        }
        match next.as_str() {
            "EMPTY" => return Some(()),
            "" => {}
            _ => return None,
        }
        let with_z = dimensions != "M";
        match kind {
            "POINT" => shape.points.extend(self.places(with_z)?),
            "LINESTRING" => shape.lines.push(Line { points: self.places(with_z)?, is_area: false }),
            "MULTIPOINT" => self.multipoint(shape, with_z)?,
            "MULTILINESTRING" => self.lines(shape, false, with_z)?,
            "POLYGON" => self.lines(shape, true, with_z)?,
            "MULTIPOLYGON" => self.list(&mut |text| text.lines(shape, true, with_z))?,
            "GEOMETRYCOLLECTION" if depth < MOST_DEPTH => self.list(&mut |text| text.geometry(shape, depth + 1))?,
            _ => return None,
        }
        Some(())
    }

    fn list(&mut self, item: &mut dyn FnMut(&mut Self) -> Option<()>) -> Option<()> {
        self.take('(')?;
        loop {
            item(self)?;
            if !self.has(',') {
                return self.take(')');
            }
        }
    }

    fn lines(&mut self, shape: &mut Shape, is_area: bool, with_z: bool) -> Option<()> {
        self.list(&mut |text| {
            let points = text.places(with_z)?;
            shape.lines.push(Line { points, is_area });
            Some(())
        })
    }

    fn places(&mut self, with_z: bool) -> Option<Vec<DVec3>> {
        let mut points = Vec::new();
        self.list(&mut |text| {
            points.push(text.place(with_z)?);
            Some(())
        })?;
        Some(points)
    }

    fn multipoint(&mut self, shape: &mut Shape, with_z: bool) -> Option<()> {
        self.list(&mut |text| {
            let in_brackets = text.has('(');
            shape.points.push(text.place(with_z)?);
            if in_brackets { text.take(')') } else { Some(()) }
        })
    }

    fn place(&mut self, with_z: bool) -> Option<DVec3> {
        self.rest = self.rest.trim_start();
        let end = self.rest.find([',', ')'])?;
        let (place, rest) = self.rest.split_at(end);
        self.rest = rest;
        let mut numbers = place.split_ascii_whitespace().map(|n| n.parse::<f64>().ok().filter(|n| n.is_finite()));
        let (x, y) = (numbers.next()??, numbers.next()??);
        let z = numbers.next().map_or(Some(f64::NAN), |z| z)?;
        Some(DVec3::new(x, y, if with_z { z } else { f64::NAN }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(text: &str) -> Option<(usize, usize, usize)> {
        let shape = parse(text)?;
        let points = shape.lines.iter().map(|line| line.points.len()).sum();
        Some((shape.points.len(), shape.lines.len(), points))
    }

    #[test]
    fn texts_of_every_kind() {
        for (text, expected) in [
            ("POINT (138.7 35.4)", (1, 0, 0)),
            ("SRID=4326;POINT Z(138.7 35.4 3776)", (1, 0, 0)),
            ("LINESTRING (139.9 36.5,139.8 36.4 , 1e2 -3)", (0, 1, 3)),
            ("MULTILINESTRING((0 0,1 1),(2 2,3 3,4 4))", (0, 2, 5)),
            ("polygon((0 0,1 0,0 1,0 0),(0.1 0.1,0.2 0.1,0.1 0.2,0.1 0.1))", (0, 2, 8)),
            ("MULTIPOLYGON Z (((0 0 1,1 0 1,0 1 1,0 0 1)))", (0, 1, 4)),
            ("MULTIPOINT ((1 2),(3 4))", (2, 0, 0)),
            ("MULTIPOINT (1 2,3 4)", (2, 0, 0)),
            ("GEOMETRYCOLLECTION(POINT(1 2),LINESTRING M (1 2 9,3 4 9))", (1, 1, 2)),
            ("POINT EMPTY", (0, 0, 0)),
            ("LINESTRING Z EMPTY", (0, 0, 0)),
        ] {
            assert_eq!(counts(text), Some(expected), "{text}");
        }
        for text in [
            "",
            "POINT",
            "POINT(1)",
            "POINT(1 nan)",
            "LINESTRING(1 2,3 4",
            "POINT(1 2) x",
            "CIRCLE(1 2)",
            "標高(1 2)",
        ] {
            assert_eq!(counts(text), None, "{text}");
        }
        assert_eq!(counts(&"GEOMETRYCOLLECTION(".repeat(100_000)), None);
    }
}
