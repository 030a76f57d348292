//! The camera: orbit and flight, smooth at any frame rate, never under the land.
//!
//! Input moves a goal; the camera follows it exponentially in time, so that the way it takes does not depend on how many
//! frames it is cut into.

use super::Ground;
use glam::DVec3;
use yamanami_core::View;

/// Share of the way to the goal taken in a second: 1 - e^-RATE.
const RATE_PER_S: f64 = 14.0;
/// Turn for a pixel of dragging, radians.
const TURN_RAD_PER_PX: f64 = 0.0045;
/// Steepest look up or down; straight down the heading would be lost.
const STEEPEST_RAD: f64 = 1.55;
/// In flight the point turned about lies this far ahead: it is the eye itself, but for a direction.
const FLIGHT_REACH_M: f64 = 1.0;
/// Pace of flight: metres a second for each metre above the land.
const PACE_PER_S: f64 = 1.3;
/// What shift does to the pace.
const FAST: f64 = 4.0;

/// Around what the camera turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Around a point of the land.
    Orbit,
    /// Around itself.
    Fly,
}

/// A camera position as it is steered.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pose {
    /// What it turns about.
    pivot: DVec3,
    /// Clockwise from north.
    heading_rad: f64,
    /// Up from level.
    pitch_rad: f64,
    /// From eye to pivot.
    reach_m: f64,
}

/// What the keys ask for: each from -1 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Drive {
    /// Forward, to the right, up.
    pub along: [f64; 3],
    /// Faster.
    pub fast: bool,
}

/// A camera on its way to where it was steered.
#[derive(Debug, Clone)]
pub struct Rig {
    home: View,
    now: Pose,
    goal: Pose,
    mode: Mode,
    /// Vertical field of view.
    pub fov_y_rad: f64,
    /// Factor on the pace of flight, by the wheel.
    pub pace: f64,
}

impl Pose {
    fn of(view: &View) -> Self {
        let forward = view.forward();
        Self {
            pivot: view.target,
            heading_rad: forward.x.atan2(forward.y),
            pitch_rad: forward.z.clamp(-1.0, 1.0).asin().clamp(-STEEPEST_RAD, STEEPEST_RAD),
            reach_m: (view.target - view.eye).length().max(1e-9),
        }
    }

    fn forward(&self) -> DVec3 {
        let (sin_h, cos_h) = self.heading_rad.sin_cos();
        let (sin_p, cos_p) = self.pitch_rad.sin_cos();
        DVec3::new(sin_h * cos_p, cos_h * cos_p, sin_p)
    }

    fn level_forward(&self) -> DVec3 {
        DVec3::new(self.heading_rad.sin(), self.heading_rad.cos(), 0.0)
    }

    fn right(&self) -> DVec3 {
        DVec3::new(self.heading_rad.cos(), -self.heading_rad.sin(), 0.0)
    }

    fn eye(&self) -> DVec3 {
        self.pivot - self.forward() * self.reach_m
    }

    /// The same eye and direction, turning about a point this far ahead.
    fn with_reach(&self, reach_m: f64) -> Self {
        Self { pivot: self.eye() + self.forward() * reach_m, reach_m, ..*self }
    }
}

impl Rig {
    /// A camera at rest, orbiting.
    pub fn new(home: View) -> Self {
        let pose = Pose::of(&home);
        Self { home, now: pose, goal: pose, mode: Mode::Orbit, fov_y_rad: home.fov_y_rad, pace: 1.0 }
    }

    /// What it turns about.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Whether the camera has not come to rest.
    pub fn is_moving(&self) -> bool {
        self.now != self.goal
    }

    /// Flies back to where it started.
    pub fn reset(&mut self) {
        self.set_mode(Mode::Orbit, None);
        let mut goal = Pose::of(&self.home);
        goal.heading_rad = nearest_turn(goal.heading_rad, self.now.heading_rad);
        self.goal = goal;
        self.fov_y_rad = self.home.fov_y_rad;
        self.pace = 1.0;
    }

    /// Places the camera at a view, at once.
    pub fn jump_to(&mut self, view: &View) {
        let mut pose = Pose::of(view);
        if self.mode == Mode::Fly {
            pose = pose.with_reach(FLIGHT_REACH_M);
        }
        (self.now, self.goal, self.fov_y_rad) = (pose, pose, view.fov_y_rad);
    }

    /// Changes between orbit and flight without moving the eye; an orbit turns about `ahead`, the land in the middle of the
    /// picture.
    pub fn set_mode(&mut self, mode: Mode, ahead: Option<DVec3>) {
        if self.mode == mode {
            return;
        }
        self.mode = mode;
        let reach_m = match mode {
            Mode::Fly => FLIGHT_REACH_M,
            Mode::Orbit => ahead.map_or(self.home.eye.distance(self.home.target), |p| (p - self.now.eye()).length()),
        };
        self.goal = self.goal.with_reach(reach_m);
        self.now = self.now.with_reach(reach_m);
    }

    /// Turns by a drag in pixels.
    pub fn turn(&mut self, drag_px: [f64; 2]) {
        self.goal.heading_rad += drag_px[0] * TURN_RAD_PER_PX;
        let pitch_rad = self.goal.pitch_rad - drag_px[1] * TURN_RAD_PER_PX;
        self.goal.pitch_rad = pitch_rad.clamp(-STEEPEST_RAD, STEEPEST_RAD);
    }

    /// Moves along the land by a drag in pixels, as if `grabbed`, a point of the land, were held.
    pub fn pan(&mut self, drag_px: [f64; 2], grabbed: Option<DVec3>, viewport_px: [u32; 2], ground: &Ground<'_>) {
        let distance_m = match (grabbed, self.mode) {
            (Some(p), _) => (p - self.now.eye()).length(),
            (None, Mode::Orbit) => self.goal.reach_m,
            (None, Mode::Fly) => self.height_above_m(ground) * 3.0,
        };
        let metres_per_px = distance_m / self.view(viewport_px).pixels_per_radian();
        // a pixel upwards is further away over the land the flatter the look
        let steepness = self.goal.pitch_rad.sin().abs().max(0.25);
        let moved = self.goal.level_forward() * (drag_px[1] / steepness) - self.goal.right() * drag_px[0];
        self.move_goal(moved * metres_per_px, ground);
    }

    /// Comes nearer by a factor below 1, or goes away, about a point of the land; in flight the pace changes instead.
    pub fn zoom(&mut self, factor: f64, about: Option<DVec3>, ground: &Ground<'_>) {
        if self.mode == Mode::Fly {
            self.pace = (self.pace / factor).clamp(0.05, 50.0);
            return;
        }
        let reach_m = (self.goal.reach_m * factor).clamp(2.0 * ground.clearance_m, 4.0 * ground.diagonal_m());
        let factor = reach_m / self.goal.reach_m;
        self.goal.reach_m = reach_m;
        if let Some(p) = about {
            self.goal.pivot = p + (self.goal.pivot - p) * factor;
        }
    }

    /// Moves by the keys for `dt_s` seconds.
    pub fn drive(&mut self, drive: Drive, dt_s: f64, ground: &Ground<'_>) {
        let [ahead, aside, up] = drive.along;
        let fast = if drive.fast { FAST } else { 1.0 };
        match self.mode {
            Mode::Fly => {
                let pace_m_per_s = self.height_above_m(ground).max(2.0 * ground.clearance_m) * PACE_PER_S * self.pace;
                let direction = self.goal.forward() * ahead + self.goal.right() * aside + DVec3::Z * up;
                self.move_goal(direction.clamp_length_max(1.0) * pace_m_per_s * fast * dt_s, ground);
            }
            Mode::Orbit => {
                let direction = self.goal.level_forward() * ahead + self.goal.right() * aside;
                self.move_goal(direction.clamp_length_max(1.0) * 0.7 * self.goal.reach_m * fast * dt_s, ground);
                self.goal.heading_rad += up * 0.8 * fast * dt_s;
            }
        }
    }

    /// Goes `dt_s` seconds on towards the goal, over the land.
    pub fn step(&mut self, dt_s: f64, ground: &Ground<'_>) {
        let rest = (-RATE_PER_S * dt_s.max(0.0)).exp();
        let (now, goal) = (self.now, self.goal);
        let mix = |now: f64, goal: f64| goal + (now - goal) * rest;
        self.now = Pose {
            pivot: goal.pivot + (now.pivot - goal.pivot) * rest,
            heading_rad: mix(now.heading_rad, goal.heading_rad),
            pitch_rad: mix(now.pitch_rad, goal.pitch_rad),
            reach_m: mix(now.reach_m, goal.reach_m),
        };
        if near(&self.now, &goal) {
            self.now = goal;
        }
        if self.mode == Mode::Fly {
            lift(&mut self.goal, ground);
            lift(&mut self.now, ground);
        } else {
            lift_by_pitch(&mut self.goal, ground);
            lift_by_pitch(&mut self.now, ground);
        }
    }

    /// What the camera sees now.
    pub fn view(&self, viewport_px: [u32; 2]) -> View {
        View { eye: self.now.eye(), target: self.now.pivot, fov_y_rad: self.fov_y_rad, viewport_px }
    }

    /// Height of the eye above the land, metres.
    pub fn height_above_m(&self, ground: &Ground<'_>) -> f64 {
        ground.height_above_m(self.now.eye())
    }

    /// Moves the goal, at most a diagonal beyond the terrain's border.
    fn move_goal(&mut self, by: DVec3, ground: &Ground<'_>) {
        let room_m = ground.diagonal_m();
        let min = ground.bounds.min - DVec3::splat(room_m);
        let max = ground.bounds.max + DVec3::new(room_m, room_m, 2.0 * room_m);
        self.goal.pivot = (self.goal.pivot + by).clamp(min, max);
    }
}

/// Raises a flying pose over the land.
fn lift(pose: &mut Pose, ground: &Ground<'_>) {
    let eye = pose.eye();
    let missing_m = ground.height_m(eye.truncate()) + ground.clearance_m - eye.z;
    pose.pivot.z += missing_m.max(0.0);
}

/// Raises an orbiting pose over the land by looking down more steeply, and what that cannot mend by moving up.
fn lift_by_pitch(pose: &mut Pose, ground: &Ground<'_>) {
    for _ in 0..24 {
        let eye = pose.eye();
        let missing_m = ground.height_m(eye.truncate()) + ground.clearance_m - eye.z;
        if missing_m <= 0.0 {
            return;
        }
        let turn_rad = (1.05 * missing_m / pose.reach_m).clamp(1e-3, 0.2);
        pose.pitch_rad = (pose.pitch_rad - turn_rad).max(-STEEPEST_RAD);
    }
    lift(pose, ground);
}

/// Whether nobody could see the difference.
fn near(a: &Pose, b: &Pose) -> bool {
    (a.pivot - b.pivot).length() <= 2e-4 * a.reach_m.min(b.reach_m)
        && (a.heading_rad - b.heading_rad).abs() < 2e-4
        && (a.pitch_rad - b.pitch_rad).abs() < 2e-4
        && (a.reach_m / b.reach_m - 1.0).abs() < 2e-4
}

/// The same direction, at most half a turn from `from_rad`.
fn nearest_turn(heading_rad: f64, from_rad: f64) -> f64 {
    heading_rad + ((from_rad - heading_rad) / std::f64::consts::TAU).round() * std::f64::consts::TAU
}

#[cfg(all(test, feature = "files"))]
mod tests {
    use super::super::ground::tests::slope;
    use super::*;

    const SIZE_PX: [u32; 2] = [800, 600];

    fn rig() -> Rig {
        let target = DVec3::new(1000.0, -500.0, 150.0);
        Rig::new(View { eye: target + DVec3::new(-300.0, -600.0, 500.0), target, fov_y_rad: 0.7, viewport_px: SIZE_PX })
    }

    #[test]
    fn a_view_survives_becoming_a_pose() {
        let rig = rig();
        let view = rig.view(SIZE_PX);
        assert!((view.eye - rig.home.eye).length() < 1e-9 && view.target == rig.home.target);
        let mut other = Rig::new(rig.home);
        other.set_mode(Mode::Fly, None);
        other.jump_to(&view);
        assert!((other.view(SIZE_PX).eye - view.eye).length() < 1e-9);
        assert!((other.view(SIZE_PX).forward() - view.forward()).length() < 1e-9);
    }

    #[test]
    fn the_way_does_not_depend_on_the_frame_rate() {
        let ground = slope();
        let after = |frames: usize| {
            let mut rig = rig();
            rig.turn([200.0, -30.0]);
            rig.zoom(0.5, Some(DVec3::new(900.0, -450.0, 155.0)), &ground);
            (0..frames).for_each(|_| rig.step(0.2 / frames as f64, &ground));
            rig.view(SIZE_PX)
        };
        let (coarse, fine) = (after(2), after(60));
        assert!((coarse.eye - fine.eye).length() < 1e-6, "{} {}", coarse.eye, fine.eye);
    }

    #[test]
    fn zooming_keeps_the_point_under_the_cursor() {
        let ground = slope();
        let mut rig = rig();
        let p = DVec3::new(800.0, -300.0, 170.0);
        let direction = |rig: &Rig| (p - rig.view(SIZE_PX).eye).normalize();
        let before = direction(&rig);
        rig.zoom(0.4, Some(p), &ground);
        for _ in 0..7 {
            rig.step(0.03, &ground);
            assert!((direction(&rig) - before).length() < 1e-9);
        }
    }

    #[test]
    fn no_way_leads_under_the_land() {
        let ground = slope();
        for mode in [Mode::Orbit, Mode::Fly] {
            let mut rig = rig();
            rig.set_mode(mode, None);
            for frame in 0..400 {
                rig.turn([9.0, if frame < 200 { -8.0 } else { 3.0 }]);
                rig.drive(Drive { along: [1.0, 0.3, -1.0], fast: frame % 2 == 0 }, 0.03, &ground);
                rig.zoom(0.97, ground.hit(rig.view(SIZE_PX).eye, rig.view(SIZE_PX).forward()), &ground);
                rig.step(0.03, &ground);
                let eye = rig.view(SIZE_PX).eye;
                let above_m = eye.z - ground.height_m(eye.truncate());
                assert!(above_m >= 0.99 * ground.clearance_m, "{mode:?} frame {frame}: {above_m}");
            }
        }
    }

    #[test]
    fn it_comes_to_rest_and_home() {
        let ground = slope();
        let mut rig = rig();
        rig.turn([900.0, 40.0]);
        rig.reset();
        (0..200).for_each(|_| rig.step(0.02, &ground));
        assert!(!rig.is_moving());
        assert!((rig.view(SIZE_PX).eye - rig.home.eye).length() < 1e-6);
    }
}
