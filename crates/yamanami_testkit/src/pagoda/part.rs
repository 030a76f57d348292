//! The carpenter's tools: boxes with worn edges, round bars, turned and bent pieces, each put in its place on one of the
//! tower's sides.
//!
//! Based on: Shirley, Chiu, "A low distortion map between disk and square", 1997.

use super::paint::Material;
use super::tessellate::{Form, Sheet};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_4, TAU};

/// Where a piece's own frame (x along the side, y outward, z up) lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose {
    /// Direction of the frame's x axis in plan.
    turn: DVec2,
    at: DVec3,
}

impl Pose {
    /// The tower's own frame: x east, y north.
    pub(super) const TOWER: Self = Self { turn: DVec2::X, at: DVec3::ZERO };

    /// A frame whose y axis looks outward, so many eighths of a turn from south by east: even ones are the sides south, east,
    /// north, west, odd ones the corners from the south-east on.
    pub(super) fn outward(eighth: usize) -> Self {
        let turn = match eighth % 8 {
            0 => DVec2::NEG_X,
            2 => DVec2::NEG_Y,
            4 => DVec2::X,
            6 => DVec2::Y,
            // exact halves keep the four corners alike
            odd => {
                let a = std::f64::consts::FRAC_1_SQRT_2;
                [DVec2::new(-a, -a), DVec2::new(a, -a), DVec2::new(a, a), DVec2::new(-a, a)][odd / 2]
            }
        };
        Self { turn, at: DVec3::ZERO }
    }

    /// A frame turned by any angle about the tower's axis.
    pub(super) fn turned(angle_rad: f64) -> Self {
        Self { turn: DVec2::from_angle(angle_rad), at: DVec3::ZERO }
    }

    /// The same frame with its origin at a place of this one.
    pub(super) fn moved(self, x: f64, y: f64, z: f64) -> Self {
        Self { at: self.place(DVec3::new(x, y, z)), ..self }
    }

    /// The same directions at another frame's origin.
    pub(super) fn raised_to(self, other: Self) -> Self {
        Self { at: other.at, ..self }
    }

    pub(super) fn place(&self, p: DVec3) -> DVec3 {
        self.turn.rotate(p.truncate()).extend(p.z) + self.at
    }
}

/// One piece, still without triangles.
pub(super) struct Part {
    pub(super) form: Form,
    pub(super) place: Box<dyn Fn(DVec3) -> DVec3 + Send + Sync>,
    pub(super) material: Material,
    /// What a scanner must resolve to see it.
    pub(super) thickness_m: f64,
}

/// The pieces of a building.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) list: Vec<Part>,
}

/// The square -1…1 onto the unit disc; its border becomes the circle, evenly.
pub(super) fn disc(a: f64, b: f64) -> DVec2 {
    if a == 0.0 && b == 0.0 {
        DVec2::ZERO
    } else if a.abs() >= b.abs() {
        DVec2::from_angle(FRAC_PI_4 * b / a) * a
    } else {
        DVec2::from_angle(FRAC_PI_4 * a / b).perp() * b * DVec2::new(-1.0, 1.0)
    }
}

/// A point of the unit cube's surface on a box around the origin, its edges worn to a radius.
pub(super) fn worn_box(unit: DVec3, size: DVec3, radius_m: f64) -> DVec3 {
    let p = (unit - 0.5) * size;
    let inner = (0.5 * size - radius_m).max(DVec3::ZERO);
    let core = p.clamp(-inner, inner);
    core + (p - core).normalize_or_zero() * radius_m
}

impl Parts {
    /// Any cube bent by `bend` into the frame of `pose`.
    pub(super) fn bent(
        &mut self,
        pose: Pose,
        size_m: [f64; 3],
        material: Material,
        bend: impl Fn(DVec3) -> DVec3 + Send + Sync + 'static,
    ) {
        self.bent_from(pose, size_m, [1; 3], material, bend);
    }

    /// The same with at least so many cells along each axis.
    pub(super) fn bent_from(
        &mut self,
        pose: Pose,
        size_m: [f64; 3],
        least: [usize; 3],
        material: Material,
        bend: impl Fn(DVec3) -> DVec3 + Send + Sync + 'static,
    ) {
        let thickness_m = size_m.into_iter().fold(f64::INFINITY, f64::min);
        self.push(Form::Cube { size_m, least }, thickness_m, material, move |p| pose.place(bend(p)));
    }

    fn push(
        &mut self,
        form: Form,
        thickness_m: f64,
        material: Material,
        place: impl Fn(DVec3) -> DVec3 + Send + Sync + 'static,
    ) {
        self.list.push(Part { form, place: Box::new(place), material, thickness_m });
    }

    /// Has the last piece seen only where pieces of this thickness are: those that it hangs on.
    pub(super) fn seen_with(&mut self, thickness_m: f64) {
        if let Some(part) = self.list.last_mut() {
            part.thickness_m = part.thickness_m.min(thickness_m);
        }
    }

    /// A box between two corners.
    pub(super) fn bar(&mut self, pose: Pose, from: [f64; 3], to: [f64; 3], material: Material) {
        let (from, to) = (DVec3::from_array(from), DVec3::from_array(to));
        let (size, middle) = ((to - from).abs(), 0.5 * (from + to));
        let radius_m = (0.12 * size.min_element()).min(0.004);
        self.bent(pose, size.to_array(), material, move |p| middle + worn_box(p, size, radius_m));
    }

    /// A round bar along x, from `from_m` to `to_m`, whose axis runs at (y, z) = `axis(x)`.
    pub(super) fn round_bar(
        &mut self,
        pose: Pose,
        [from_m, to_m]: [f64; 2],
        radius_m: f64,
        material: Material,
        axis: impl Fn(f64) -> [f64; 2] + Send + Sync + 'static,
    ) {
        let side_m = FRAC_PI_4 * 2.0 * radius_m;
        let size_m = [to_m - from_m, side_m, side_m];
        self.push(Form::Cube { size_m, least: [1, 2, 2] }, 2.0 * radius_m, material, move |p| {
            let x = from_m + p.x * (to_m - from_m);
            let section = disc(2.0 * p.y - 1.0, 2.0 * p.z - 1.0) * radius_m;
            let [y, z] = axis(x);
            pose.place(DVec3::new(x, y + section.x, z + section.y))
        });
    }

    /// Something turned on a lathe about the frame's z axis: `profile(t)` is radius and height from the bottom (0) to the
    /// top (1), `face(t, r)` how far the bottom (0) and the top (1) bulge upward at a share of the radius.
    pub(super) fn turned(
        &mut self,
        pose: Pose,
        [radius_m, height_m]: [f64; 2],
        material: Material,
        profile: impl Fn(f64) -> [f64; 2] + Send + Sync + 'static,
        face: impl Fn(f64, f64) -> f64 + Send + Sync + 'static,
    ) {
        // a quarter of the circumference a side
        let side_m = 0.5 * std::f64::consts::PI * radius_m;
        let form = Form::Cube { size_m: [side_m, side_m, height_m], least: [2, 2, 1] };
        self.push(form, height_m.min(2.0 * radius_m), material, move |p| {
            let [r, z] = profile(p.z);
            let at = disc(2.0 * p.x - 1.0, 2.0 * p.y - 1.0);
            let bulge = if p.z == 0.0 || p.z == 1.0 { face(p.z, at.length()) } else { 0.0 };
            pose.place((at * r).extend(z + bulge))
        });
    }

    /// A ball whose radius depends on the direction.
    pub(super) fn ball(
        &mut self,
        pose: Pose,
        radius_m: f64,
        material: Material,
        shape: impl Fn(DVec3) -> DVec3 + Send + Sync + 'static,
    ) {
        let side_m = 0.5 * std::f64::consts::PI * radius_m;
        self.push(Form::Cube { size_m: [side_m; 3], least: [2; 3] }, 2.0 * radius_m, material, move |p| {
            // equal angles rather than equal lengths on the cube's faces
            let on_cube = ((2.0 * p - 1.0) * FRAC_PI_4).to_array().map(f64::tan);
            pose.place(shape(DVec3::from_array(on_cube).normalize()) * radius_m)
        });
    }

    /// A ring about the frame's z axis with an elliptic tube.
    pub(super) fn ring(&mut self, pose: Pose, radius_m: f64, tube_m: [f64; 2], material: Material) {
        let form = Form::Torus { round_m: TAU * radius_m, tube_m: std::f64::consts::PI * (tube_m[0] + tube_m[1]) };
        self.push(form, 2.0 * tube_m[0].min(tube_m[1]), material, move |p| {
            let (round, tube) = (DVec2::from_angle(TAU * p.x), DVec2::from_angle(TAU * p.y));
            pose.place((round * (radius_m + tube_m[0] * tube.x)).extend(tube_m[1] * tube.y))
        });
    }

    /// A surface with a border.
    pub(super) fn sheet(
        &mut self,
        pose: Pose,
        sheet: Sheet,
        thickness_m: f64,
        material: Material,
        place: impl Fn(DVec3) -> DVec3 + Send + Sync + 'static,
    ) {
        self.push(Form::Sheet(sheet), thickness_m, material, move |p| pose.place(place(p)));
    }
}
