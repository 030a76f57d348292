//! Camera paths: taken from the camera at a steady rate whatever the frame rate is, and replayed likewise.

use yamanami::CameraPath;
use yamanami::core::View;

/// Views a second of a recorded path.
pub(super) const VIEWS_PER_S: f64 = 30.0;

/// Takes a path down.
#[derive(Debug, Clone)]
pub(super) struct Recorder {
    path: CameraPath,
    last: View,
    /// Seconds since the last view taken down.
    since_s: f64,
}

/// Replays a path.
#[derive(Debug, Clone)]
pub(super) struct Player {
    path: CameraPath,
    at_s: f64,
}

impl Recorder {
    /// Starts at a view.
    pub(super) fn new(view: View) -> Self {
        Self { path: CameraPath { views: vec![view] }, last: view, since_s: 0.0 }
    }

    /// Goes on to the view that `dt_s` seconds have led to.
    pub(super) fn step(&mut self, view: View, dt_s: f64) {
        let step_s = 1.0 / VIEWS_PER_S;
        self.since_s += dt_s;
        while self.since_s >= step_s {
            self.since_s -= step_s;
            let share = 1.0 - (self.since_s / dt_s).clamp(0.0, 1.0);
            self.path.views.push(between(&self.last, &view, share));
        }
        self.last = view;
    }

    /// Views taken down.
    pub(super) fn len(&self) -> usize {
        self.path.views.len()
    }

    /// The path.
    pub(super) fn finish(self) -> CameraPath {
        self.path
    }
}

impl Player {
    /// Starts a path; `None` where it has no view.
    pub(super) fn new(path: CameraPath) -> Option<Self> {
        (!path.views.is_empty()).then_some(Self { path, at_s: 0.0 })
    }

    /// Share of the path behind, 0 to 1.
    pub(super) fn share(&self) -> f32 {
        (self.at_s * VIEWS_PER_S / (self.path.views.len() - 1).max(1) as f64).min(1.0) as f32
    }

    /// The view now, and then goes on by `dt_s` seconds; the flag tells that this was the last view.
    pub(super) fn step(&mut self, dt_s: f64) -> (View, bool) {
        let last = self.path.views.len() - 1;
        let at = self.at_s * VIEWS_PER_S;
        self.at_s += dt_s;
        let from = (at as usize).min(last);
        let to = (from + 1).min(last);
        let share = (at - from as f64).clamp(0.0, 1.0);
        (between(&self.path.views[from], &self.path.views[to], share), at >= last as f64)
    }
}

/// A view between two.
fn between(from: &View, to: &View, share: f64) -> View {
    View {
        eye: from.eye.lerp(to.eye, share),
        target: from.target.lerp(to.target, share),
        fov_y_rad: from.fov_y_rad + (to.fov_y_rad - from.fov_y_rad) * share,
        viewport_px: to.viewport_px,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn view(x: f64) -> View {
        View { eye: DVec3::new(x, 0.0, 10.0), target: DVec3::new(x, 50.0, 0.0), fov_y_rad: 0.8, viewport_px: [4, 4] }
    }

    #[test]
    fn a_steady_flight_is_the_same_at_any_frame_rate() {
        for frames_per_s in [7, 30, 113] {
            let mut recorder = Recorder::new(view(0.0));
            for frame in 1..=frames_per_s * 2 {
                let dt_s = 1.0 / f64::from(frames_per_s);
                recorder.step(view(100.0 * f64::from(frame) * dt_s), dt_s);
            }
            let path = recorder.finish();
            assert!((60..=61).contains(&path.views.len()), "{}", path.views.len());
            for (i, v) in path.views.iter().enumerate() {
                assert!((v.eye.x - 100.0 * i as f64 / VIEWS_PER_S).abs() < 1e-6, "{frames_per_s} {i} {}", v.eye.x);
            }
        }
    }

    #[test]
    fn a_replay_passes_through_the_views_and_ends() {
        let path = CameraPath { views: vec![view(0.0), view(3.0), view(6.0)] };
        let mut player = Player::new(path).unwrap();
        let mut seen = Vec::new();
        loop {
            let (view, done) = player.step(0.5 / VIEWS_PER_S);
            seen.push(view.eye.x);
            if done {
                break;
            }
        }
        assert_eq!(seen, [0.0, 1.5, 3.0, 4.5, 6.0]);
        assert!(Player::new(CameraPath::default()).is_none());
    }
}
