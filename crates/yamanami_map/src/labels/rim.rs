//! Names like rays outside the horizon.
//!
//! From its summit a leader runs outwards along its azimuth past all mountains, then slants to the name's own azimuth.
//! Names keep the order of their summits, so no leader crosses another; names are pushed apart along the ring as
//! little as possible (least squares by pooling neighbours that would overlap: the pool-adjacent-violators algorithm,
//! Ayer et al., 1955). One boundary at a time is Bekos, Kaufmann, Symvonis, Wolff, "Boundary labeling", 2007; the rings
//! behind each other are ours: a name of an outer ring only needs room for its leader on the inner ones.

use super::{Candidate, Placed};
use crate::boxes::{OrientedBox, Taken};
use crate::scene::{Anchor, Outline, Scene, Stroke};
use crate::sheet::{HALO, INK, Sheet, SheetOptions, Style};
use glam::DVec2;
use std::f64::consts::{PI, TAU};
use yamanami_core::PlaceKind;

/// Height of a line of letters and the room around it, points.
const LINE_PT: f64 = 10.6;
/// Nearest two leaders run beside each other on their way out, points.
const LEADERS_APART_PT: f64 = 1.6;

/// The rings of names.
struct Frame {
    centre: DVec2,
    /// Where leaders turn towards their names.
    elbow_px: f64,
    /// Where names begin, ring by ring.
    inner_px: Vec<f64>,
    /// Where they must end.
    outer_px: f64,
    /// Room for a line of letters along the ring.
    line_px: f64,
    apart_px: f64,
}

/// A name that has a place for now.
#[derive(Debug, Clone, Copy)]
struct Seat {
    candidate: usize,
    ring: usize,
    form: usize,
    /// Azimuth of the summit from where the circle was cut, radians clockwise.
    wanted: f64,
    /// That of the name.
    given: f64,
}

/// Finds places for the candidates in order of importance; the positions are the final ones for all of them.
pub(super) fn place(style: &Style<'_>, sheet: &Sheet<'_>, far: &[Candidate], taken: &mut Taken) -> Vec<Placed> {
    let candidates: Vec<&Candidate> =
        far.iter().filter(|c| matches!(c.kind, PlaceKind::Summit | PlaceKind::Pass)).collect();
    let Some(frame) = Frame::around(style, sheet, &candidates) else { return Vec::new() };
    let azimuths: Vec<f64> = candidates.iter().map(|c| frame.azimuth(c.px)).collect();
    let cut = widest_gap(&azimuths);
    let mut seats: Vec<Seat> = Vec::new();
    for (i, candidate) in candidates.iter().enumerate() {
        let wanted = (azimuths[i] - cut).rem_euclid(TAU);
        let at = seats.partition_point(|s| s.wanted < wanted);
        // of the rings that have room, the one that pushes names least: crowds spread over the rings of themselves
        let found = (0..candidate.lettering.forms()).find_map(|form| {
            let length = candidate.lettering.width_px(form);
            let rings = (0..frame.inner_px.len()).filter(|&ring| length <= frame.depth_px(ring));
            let trials = rings.filter_map(|ring| {
                let mut trial = seats.clone();
                trial.insert(at, Seat { candidate: i, ring, form, wanted, given: wanted });
                let is_settled = frame.settle(&mut trial) && frame.is_free(&candidates, &trial, cut, taken);
                is_settled.then_some(trial)
            });
            trials.min_by(|a, b| pushed(a).total_cmp(&pushed(b)))
        });
        if let Some(trial) = found {
            seats = trial;
        }
    }
    let placed: Vec<Placed> =
        seats.iter().map(|seat| frame.placed(style, candidates[seat.candidate], seat, cut)).collect();
    for p in &placed {
        taken.take(p.outline);
        for pair in p.leader.windows(2) {
            taken.take(OrientedBox::along(pair[0], pair[1], style.pt(1.0)));
        }
    }
    placed
}

/// How far names are pushed from their summits' azimuths, all together.
fn pushed(seats: &[Seat]) -> f64 {
    seats.iter().map(|seat| (seat.given - seat.wanted).powi(2)).sum()
}

/// The azimuth in the middle of the widest gap.
fn widest_gap(azimuths: &[f64]) -> f64 {
    let mut sorted = azimuths.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some((&first, &last)) = sorted.first().zip(sorted.last()) else { return 0.0 };
    let around = (last, first + TAU - last);
    let (from, gap) = sorted.windows(2).map(|w| (w[0], w[1] - w[0])).fold(around, |a, b| if b.1 > a.1 { b } else { a });
    from + 0.5 * gap
}

impl Frame {
    fn around(style: &Style<'_>, sheet: &Sheet<'_>, candidates: &[&Candidate]) -> Option<Self> {
        let centre = sheet.view.centre_px;
        let horizon_px = candidates.iter().map(|c| (c.px - centre).length()).fold(sheet.rim_px(), f64::max);
        let elbow_px = horizon_px + style.pt(5.0);
        let first_px = horizon_px + style.pt(SheetOptions::LEADER_PT - 2.0);
        let outer_px = sheet.outer_px(style) - style.pt(3.0);
        let rings = sheet.options.name_rings.clamp(1, 3);
        let step = (outer_px - first_px) / f64::from(rings);
        (step > style.pt(12.0)).then(|| Self {
            centre,
            elbow_px,
            inner_px: (0..rings).map(|ring| first_px + f64::from(ring) * step).collect(),
            outer_px,
            line_px: style.pt(LINE_PT),
            apart_px: style.pt(LEADERS_APART_PT),
        })
    }

    /// Radians clockwise from up.
    fn azimuth(&self, px: DVec2) -> f64 {
        let d = px - self.centre;
        d.x.atan2(-d.y).rem_euclid(TAU)
    }

    fn at(&self, azimuth: f64, radius_px: f64) -> DVec2 {
        self.centre + DVec2::new(azimuth.sin(), -azimuth.cos()) * radius_px
    }

    fn depth_px(&self, ring: usize) -> f64 {
        self.inner_px.get(ring + 1).map_or(self.outer_px, |next| next - 0.4 * self.line_px) - self.inner_px[ring]
    }

    /// Least angle between two neighbours.
    fn apart(&self, a: &Seat, b: &Seat) -> f64 {
        let inner_px = self.inner_px[a.ring.min(b.ring)];
        if a.ring == b.ring {
            2.0 * (0.5 * self.line_px / inner_px).atan()
        } else {
            (0.62 * self.line_px / inner_px).atan()
        }
    }

    /// Moves the names apart; false where one would come too far from its summit, or leaders too near each other.
    fn settle(&self, seats: &mut [Seat]) -> bool {
        if seats.windows(2).any(|w| (w[1].wanted - w[0].wanted) * self.elbow_px < self.apart_px) {
            return false;
        }
        // with the room between neighbours taken out, order alone is left: pool what would come out of order
        let mut room = vec![0.0; seats.len()];
        for i in 1..seats.len() {
            room[i] = room[i - 1] + self.apart(&seats[i - 1], &seats[i]);
        }
        let mut pools: Vec<(f64, usize)> = Vec::with_capacity(seats.len());
        for (seat, room) in seats.iter().zip(&room) {
            pools.push((seat.wanted - room, 1));
            while let [.., (a, na), (b, nb)] = pools[..]
                && a > b
            {
                pools.truncate(pools.len() - 2);
                pools.push(((a * na as f64 + b * nb as f64) / (na + nb) as f64, na + nb));
            }
        }
        let moved = pools.iter().flat_map(|&(place, count)| std::iter::repeat_n(place, count));
        for ((seat, room), place) in seats.iter_mut().zip(&room).zip(moved) {
            seat.given = place + room;
        }
        let farthest = 1.7 * (self.inner_px[0] - self.elbow_px) / self.inner_px[0];
        let Some((first, last)) = seats.first().zip(seats.last()) else { return true };
        seats.iter().all(|s| (s.given - s.wanted).abs() <= farthest)
            && first.given + TAU - last.given >= self.apart(first, last)
    }

    fn is_free(&self, candidates: &[&Candidate], seats: &[Seat], cut: f64, taken: &Taken) -> bool {
        seats.iter().all(|seat| {
            let length = candidates[seat.candidate].lettering.width_px(seat.form);
            taken.is_free(&self.outline(seat, cut, length))
        })
    }

    fn outline(&self, seat: &Seat, cut: f64, length: f64) -> OrientedBox {
        let azimuth = cut + seat.given;
        OrientedBox {
            centre: self.at(azimuth, self.inner_px[seat.ring] + 0.5 * length),
            half: DVec2::new(0.5 * length, 0.47 * self.line_px),
            angle_rad: turned(azimuth).0,
        }
    }

    fn placed(&self, style: &Style<'_>, candidate: &Candidate, seat: &Seat, cut: f64) -> Placed {
        let runs = candidate.lettering.runs(seat.form).to_vec();
        let outline = self.outline(seat, cut, candidate.lettering.width_px(seat.form));
        let (summit, name) = (cut + seat.wanted, cut + seat.given);
        let (angle_rad, anchor) = turned(name);
        let start_px = self.inner_px[seat.ring];
        let text = style.centred(self.at(name, start_px), angle_rad, anchor, runs);
        let before = style.pt(1.6);
        let mut leader = vec![candidate.px, self.at(summit, self.elbow_px), self.at(name, self.inner_px[0] - before)];
        if seat.ring > 0 {
            leader.push(self.at(name, start_px - before));
        }
        Placed { place: candidate.place, is_hidden: candidate.is_hidden, outline, leader, text }
    }
}

/// Angle of the letters at an azimuth, and which end of them is the inner one: nothing stands upside down.
fn turned(azimuth: f64) -> (f64, Anchor) {
    let azimuth = azimuth.rem_euclid(TAU);
    if azimuth <= PI { (azimuth - 0.5 * PI, Anchor::Start) } else { (azimuth - 1.5 * PI, Anchor::End) }
}

/// Draws the leaders of those that are shown, with a small dot at the summit.
pub(super) fn draw_leaders(scene: &mut Scene, style: &Style<'_>, shown: &[Placed]) {
    let lines = |is_hidden| -> Vec<Outline> {
        let those = shown.iter().filter(|p| p.is_hidden == is_hidden && !p.leader.is_empty());
        those.map(|p| Outline::open(p.leader.clone())).collect()
    };
    let over_ground: Vec<Outline> =
        shown.iter().filter(|p| p.leader.len() > 1).map(|p| Outline::open(p.leader[..2].to_vec())).collect();
    scene.stroke(over_ground, Stroke::new(HALO, style.pt(1.1)).at_opacity(0.6));
    scene.stroke(lines(false), Stroke::new(INK, style.pt(0.35)).at_opacity(0.8));
    scene.stroke(lines(true), Stroke::new(crate::sheet::GREY, style.pt(0.35)).dashed(style.pt(1.5), style.pt(1.0)));
    for summit in shown.iter().filter_map(|p| p.leader.first()) {
        let stroke = Stroke::new(INK, style.pt(0.9));
        scene.circle(*summit, style.pt(0.45), stroke);
    }
}
