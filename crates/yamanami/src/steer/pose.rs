//! How a deformed map lies in the picture: which place is its centre, how large it is, what points up.

use glam::DVec2;
use yamanami_core::{DeformedMap, MapView};

/// Room around a map that is fitted to the picture, pixels of a picture 1000 pixels high.
const MARGIN_PX: f64 = 28.0;
/// The plain map is never smaller than this, and never wider than so many pictures.
const LEAST_RING_PX: f64 = 4.0;
const WIDEST_RING: f64 = 40.0;

/// The pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The map's centre in the plane of the ground, metres.
    pub centre: DVec2,
    /// Azimuth that points up, radians clockwise from north.
    pub up_azimuth_rad: f64,
    /// Size and place set by hand; else the map is fitted to the picture.
    held: Option<Held>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Held {
    /// Radius of the plain map, pixels.
    ring_px: f64,
    /// From the picture's middle to the map's centre, pixels.
    offset_px: DVec2,
}

impl Pose {
    /// Around the plane's origin, fitted to the picture.
    pub fn new(up_azimuth_rad: f64) -> Self {
        Self { centre: DVec2::ZERO, up_azimuth_rad, held: None }
    }

    /// Whether the map is fitted to the picture.
    pub fn is_fitted(&self) -> bool {
        self.held.is_none()
    }

    /// Fits the map to the picture, or keeps it as large as it is.
    pub fn fit(&mut self, is_fitted: bool, view: &MapView) {
        self.held = (!is_fitted).then(|| Held::of(view));
    }

    /// Size and place set by hand, in shares of the shorter side of a picture: the plain map's radius, and from the picture's
    /// middle to the map's centre. `None` when it is fitted.
    pub fn held(&self, size_px: [u32; 2]) -> Option<[f64; 3]> {
        let side_px = f64::from(size_px[0].min(size_px[1]));
        self.held.map(|held| [held.ring_px, held.offset_px.x, held.offset_px.y].map(|px| px / side_px))
    }

    /// Sets size and place as [`Self::held`] once told them; nonsense is held back.
    pub fn hold(&mut self, shares: [f64; 3], size_px: [u32; 2]) {
        let side_px = f64::from(size_px[0].min(size_px[1]));
        let [ring, x, y] = shares;
        if ring.is_finite() && x.abs() < WIDEST_RING && y.abs() < WIDEST_RING {
            let ring_px = (ring * side_px).clamp(LEAST_RING_PX, WIDEST_RING * side_px);
            self.held = Some(Held { ring_px, offset_px: DVec2::new(x, y) * side_px });
        }
    }

    /// What a picture of this size shows of a map, all of it to the rim and up to `top_m` where it is fitted.
    pub fn view(&self, map: DeformedMap, size_px: [u32; 2], rim_m: f64, top_m: f64) -> MapView {
        let margin_px = MARGIN_PX * f64::from(size_px[0].min(size_px[1])) / 1000.0;
        let mut view = MapView::fitted(map, size_px, rim_m, top_m, margin_px);
        view.up_azimuth_rad = self.up_azimuth_rad;
        if let Some(held) = self.held {
            view.ring_px = held.ring_px;
            view.centre_px += held.offset_px;
        }
        view
    }

    /// Drags the plain map along by so many pixels.
    pub fn drag(&mut self, view: &MapView, by_px: DVec2) {
        let moved = view.image_from_px(view.centre_px + by_px);
        self.centre -= view.map.ring_m * moved;
    }

    /// Makes the picture larger by a factor, and keeps what lies at a place of it.
    pub fn zoom(&mut self, view: &MapView, factor: f64, at_px: DVec2) {
        let widest_px = WIDEST_RING * f64::from(view.size_px[0].max(view.size_px[1]));
        let ring_px = (view.ring_px * factor).clamp(LEAST_RING_PX, widest_px);
        let mut held = Held::of(view);
        held.offset_px += (view.centre_px - at_px) * (ring_px / view.ring_px - 1.0);
        held.ring_px = ring_px;
        self.held = Some(held);
    }

    /// Turns the picture about its centre with a cursor that moved from one place to another.
    pub fn turn(&mut self, view: &MapView, from_px: DVec2, to_px: DVec2) {
        let (from, to) = (from_px - view.centre_px, to_px - view.centre_px);
        if from.length() > 1.0 && to.length() > 1.0 {
            self.turn_by(-from.angle_to(to));
        }
    }

    /// Turns the picture counterclockwise.
    pub fn turn_by(&mut self, angle_rad: f64) {
        self.up_azimuth_rad = (self.up_azimuth_rad + angle_rad).rem_euclid(std::f64::consts::TAU);
    }
}

impl Held {
    fn of(view: &MapView) -> Self {
        let [width, height] = view.size_px.map(f64::from);
        Self { ring_px: view.ring_px, offset_px: view.centre_px - 0.5 * DVec2::new(width, height) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(pose: &Pose) -> MapView {
        let map = DeformedMap { centre: pose.centre, ..DeformedMap::default() };
        pose.view(map, [800, 600], 100e3, 3000.0)
    }

    #[test]
    fn the_ground_of_the_plain_map_goes_with_the_cursor() {
        let mut pose = Pose::new(0.7);
        let before = view(&pose);
        let grabbed = DVec2::new(3000.0, -2000.0);
        let at_px = before.px_from_plane(grabbed.extend(0.0));
        let by_px = DVec2::new(25.0, -14.0);
        pose.drag(&before, by_px);
        assert!((view(&pose).px_from_plane(grabbed.extend(0.0)) - at_px - by_px).length() < 1e-6);
    }

    #[test]
    fn zoom_keeps_what_is_under_the_cursor_and_turning_what_it_holds() {
        let mut pose = Pose::new(0.0);
        let place = glam::DVec3::new(-40e3, 25e3, 1500.0);
        let at_px = view(&pose).px_from_plane(place);
        pose.zoom(&view(&pose), 1.7, at_px);
        pose.zoom(&view(&pose), 1.7, at_px);
        let near = view(&pose);
        assert!((near.px_from_plane(place) - at_px).length() < 1e-6 && !pose.is_fitted());
        let to_px = near.centre_px + DVec2::from_angle(0.4).rotate(at_px - near.centre_px);
        pose.turn(&near, at_px, to_px);
        assert!((view(&pose).px_from_plane(place) - to_px).length() < 1e-6);
        let mut other = Pose::new(pose.up_azimuth_rad);
        other.centre = pose.centre;
        other.hold(pose.held([800, 600]).unwrap(), [800, 600]);
        assert!((view(&other).ring_px - view(&pose).ring_px).abs() < 1e-9);
        pose.fit(true, &near);
        assert!(view(&pose).ring_px < near.ring_px);
    }
}
