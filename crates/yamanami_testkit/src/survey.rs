//! A made survey: points and breaklines of rolling hills with a road on embankments and in cuttings, and a river.
//!
//! What terrain models of civil engineering consist of, and what Hiraoka, Yamada and Urahama ("Fast drawing of TINs for 3D
//! GIS", 2005) praise TINs for: edges of a road and of its slopes, river banks, on ground that is sampled between them.

use crate::Rng;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use yamanami_core::{Breakline, BreaklineKind};

/// Half the road's width, metres.
const ROAD_M: f64 = 4.0;
/// Half the river bed's width, metres.
const BED_M: f64 = 6.0;
/// Run over rise of embankments, cuttings and banks.
const SLOPE: f64 = 1.5;
/// How deep the river has cut, metres.
const BED_DEPTH_M: f64 = 3.0;
/// Waves that make the hills.
const WAVES: usize = 24;

/// A made survey of a rectangle whose south-west corner is the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Extent east and north, metres.
    pub size_m: [f64; 2],
    /// Metres between points, about.
    pub spacing_m: f64,
    /// Which of all such surveys.
    pub seed: u64,
}

/// A wave of the hills: direction and frequency in one (radians a metre), height, phase.
#[derive(Debug, Clone, Copy)]
struct Wave {
    along: DVec2,
    height_m: f64,
    phase: f64,
}

/// What lies where.
struct Ground {
    waves: Vec<Wave>,
    size_m: DVec2,
}

/// A strip along the ground from west to east, with slopes down or up to it.
#[derive(Debug, Clone, Copy)]
struct Strip {
    name: &'static str,
    half_width_m: f64,
    /// Middle, and swing to both sides, as shares of the north extent.
    middle: f64,
    swing: f64,
    turns: f64,
}

const ROAD: Strip = Strip { name: "road", half_width_m: ROAD_M, middle: 0.7, swing: 0.12, turns: 1.0 };
const RIVER: Strip = Strip { name: "river", half_width_m: BED_M, middle: 0.3, swing: 0.1, turns: 1.5 };

impl Ground {
    fn new(survey: &Survey) -> Self {
        let mut rng = Rng::new(survey.seed);
        let longest_m = survey.size_m[0].min(survey.size_m[1]).max(1.0);
        let waves = (0..WAVES).map(|k| {
            // lengths from the whole extent to an eighth of it; shorter ones are lower
            let length_m = longest_m * 0.125f64.powf(k as f64 / (WAVES - 1) as f64);
            let angle = TAU * rng.unit();
            let along = TAU / length_m * DVec2::new(angle.cos(), angle.sin());
            Wave { along, height_m: 0.008 * length_m, phase: TAU * rng.unit() }
        });
        Self { waves: waves.collect(), size_m: survey.size_m.into() }
    }

    /// Height of the hills alone.
    fn hills_m(&self, p: DVec2) -> f64 {
        self.waves.iter().map(|w| w.height_m * (w.along.dot(p) + w.phase).sin()).sum()
    }

    /// Northing of a strip's middle line.
    fn northing(&self, strip: &Strip, x: f64) -> f64 {
        self.size_m.y * (strip.middle + strip.swing * (TAU * strip.turns * x / self.size_m.x).sin())
    }

    /// Height of a strip: the hills' broad forms, for a river sunk and falling from west to east.
    fn level_m(&self, strip: &Strip, x: f64) -> f64 {
        let y = self.northing(strip, x);
        let reach = 0.06 * self.size_m.x;
        let broad = (-4..=4).map(|k| self.hills_m(DVec2::new(x + f64::from(k) * 0.25 * reach, y))).sum::<f64>() / 9.0;
        if strip.name == RIVER.name { broad - BED_DEPTH_M - 4.0 * x / self.size_m.x } else { broad }
    }

    /// Height with what was built: within reach of a strip its slopes hold.
    fn height_m(&self, p: DVec2) -> f64 {
        let strip = if p.y > 0.5 * self.size_m.y { &ROAD } else { &RIVER };
        let off_m = (p.y - self.northing(strip, p.x)).abs() - strip.half_width_m;
        let (level, hills) = (self.level_m(strip, p.x), self.hills_m(p));
        let slope = off_m.max(0.0) / SLOPE;
        hills.clamp(level - slope, level + slope)
    }

    /// Where the slope beside a strip meets the hills: metres north (or south, -1) of the middle line. `None` where that
    /// is too far.
    fn foot(&self, strip: &Strip, x: f64, side: f64) -> Option<DVec2> {
        let (y, level) = (self.northing(strip, x), self.level_m(strip, x));
        let at = |off_m: f64| DVec2::new(x, y + side * (strip.half_width_m + off_m));
        let above = |off_m: f64| (self.hills_m(at(off_m)) - level).abs() - off_m / SLOPE;
        let farthest = 0.1 * self.size_m.y;
        let steps = 200;
        let met = (1..=steps).map(|k| farthest * f64::from(k) / f64::from(steps)).find(|&off_m| above(off_m) <= 0.0)?;
        let (mut low, mut high) = (met - farthest / f64::from(steps), met);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if above(middle) > 0.0 { low = middle } else { high = middle }
        }
        // an edge of the strip that lies on the ground has no slope beside it
        (high > 0.5).then(|| at(high))
    }
}

impl Survey {
    /// The points between the lines: a shaken grid, whole at the border.
    pub fn points(&self) -> Vec<DVec3> {
        let ground = Ground::new(self);
        let mut rng = Rng::new(self.seed ^ 0x5eed);
        let [columns, rows] = self.size_m.map(|m| (m / self.spacing_m).round().max(1.0) as usize);
        let step = DVec2::from(self.size_m) / DVec2::new(columns as f64, rows as f64);
        let mut points = Vec::with_capacity((columns + 1) * (rows + 1));
        for j in 0..=rows {
            for i in 0..=columns {
                let shake = DVec2::new(rng.unit(), rng.unit()) - 0.5;
                let inner = DVec2::new(f64::from(i > 0 && i < columns), f64::from(j > 0 && j < rows));
                let p = (DVec2::new(i as f64, j as f64) + 0.6 * shake * inner) * step;
                points.push(survey_point(p.extend(ground.height_m(p))));
            }
        }
        points
    }

    /// The breaklines: both edges of road and river bed, and the feet of their slopes.
    pub fn breaklines(&self) -> Vec<Breakline> {
        let ground = Ground::new(self);
        let stations = (self.size_m[0] / self.spacing_m).round().max(2.0) as usize;
        let mut lines = Vec::new();
        for strip in [&ROAD, &RIVER] {
            for (side, side_name) in [(1.0, "north"), (-1.0, "south")] {
                let at = |k: usize| self.size_m[0] * k as f64 / stations as f64;
                let edge = (0..=stations).map(|k| {
                    let x = at(k);
                    DVec3::new(x, ground.northing(strip, x) + side * strip.half_width_m, ground.level_m(strip, x))
                });
                lines.push(line(format!("{} {side_name} edge", strip.name), edge.collect()));
                let feet = (0..=stations).map(|k| {
                    let foot = ground.foot(strip, at(k), side)?;
                    Some(foot.extend(ground.height_m(foot)))
                });
                let mut run = Vec::new();
                for foot in feet.chain([None]) {
                    match foot {
                        Some(place) => run.push(place),
                        None if run.len() > 1 => {
                            lines.push(line(format!("{} {side_name} foot", strip.name), std::mem::take(&mut run)));
                        }
                        None => run.clear(),
                    }
                }
            }
        }
        lines
    }
}

/// Surveyors write millimetres.
fn survey_point(p: DVec3) -> DVec3 {
    DVec3::from_array(p.to_array().map(|x| (x * 1000.0).round() / 1000.0 + 0.0))
}

fn line(name: String, points: Vec<DVec3>) -> Breakline {
    Breakline { name, kind: BreaklineKind::Hard, points: points.into_iter().map(survey_point).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_survey_has_hills_a_road_and_a_river() {
        let survey = Survey { size_m: [800.0, 600.0], spacing_m: 20.0, seed: 3 };
        let (points, lines) = (survey.points(), survey.breaklines());
        assert_eq!(points.len(), 41 * 31);
        assert_eq!((points, lines.clone()), (survey.points(), survey.breaklines()), "equal seeds, equal surveys");
        let of = |name: &str| lines.iter().filter(|l| l.name == name).map(|l| l.points.len()).sum::<usize>();
        assert_eq!((of("road north edge"), of("river south edge")), (41, 41));
        assert!(of("road north foot") + of("road south foot") > 20 && of("river north foot") > 10);
        let ground = Ground::new(&survey);
        for line in &lines {
            for p in &line.points {
                // a wall 1 in 1.5 high and a rounded coordinate
                assert!((ground.height_m(p.truncate()) - p.z).abs() < 0.01, "{} at {p}", line.name);
                assert!(p.y > 0.0 && p.y < 600.0);
            }
        }
        let other = Survey { seed: 4, ..survey };
        assert_ne!(survey.points(), other.points());
    }
}
