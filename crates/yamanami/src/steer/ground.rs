//! Where the land is, for the camera: heights from what is in memory, and the point under the cursor. A model has no land.

use crate::{Subject, Terrain};
use glam::{DVec2, DVec3};
use yamanami_core::{Aabb, LatticeNode, View};
use yamanami_multires::wavelet::TerrainData;

/// Steps of a ray through the terrain's box before the crossing is narrowed down.
const RAY_STEPS: usize = 384;
/// Halvings of the step in which a ray meets the land.
const HALVINGS: usize = 24;

/// The land as a height over the plane; around a model it is infinitely far down.
pub struct Ground<'a> {
    height_m: Box<dyn Fn(DVec2) -> f64 + 'a>,
    /// The box of the whole, metres.
    pub bounds: Aabb,
    /// The eye keeps this far above the land, metres.
    pub clearance_m: f64,
}

impl std::fmt::Debug for Ground<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ground").field("bounds", &self.bounds).field("clearance_m", &self.clearance_m).finish()
    }
}

impl<'a> Ground<'a> {
    /// The land of a terrain, as fine as its data are in memory at each place; or none.
    pub fn of(subject: &'a impl Subject) -> Self {
        let bounds = subject.bounds();
        let Some(terrain) = subject.as_terrain() else {
            let clearance_m = 1e-3 * bounds.diagonal();
            return Self { height_m: Box::new(|_| f64::NEG_INFINITY), bounds, clearance_m };
        };
        let step_m = terrain.geo().step_m;
        Self {
            height_m: Box::new(|place| finest_height_m(terrain, place)),
            bounds,
            clearance_m: (0.2 * step_m[0].min(step_m[1])).clamp(1.5, 30.0),
        }
    }

    /// Height of a place above the land; where there is none, the distance from the middle of the model.
    pub fn height_above_m(&self, place: DVec3) -> f64 {
        let land_m = self.height_m(place.truncate());
        if land_m.is_finite() { (place.z - land_m).max(0.0) } else { place.distance(self.bounds.centre()) }
    }

    /// Height of the land at a place, metres; beyond the border that of the border.
    pub fn height_m(&self, place: DVec2) -> f64 {
        (self.height_m)(place)
    }

    /// Length of the diagonal of the terrain's box, metres.
    pub fn diagonal_m(&self) -> f64 {
        self.bounds.diagonal()
    }

    /// Whether a place lies over the land.
    pub fn holds(&self, place: DVec2) -> bool {
        let (min, max) = (self.bounds.min.truncate(), self.bounds.max.truncate());
        place.cmpge(min).all() && place.cmple(max).all() && self.height_m(place).is_finite()
    }

    /// The first point of the land on a ray, if it meets any.
    pub fn hit(&self, eye: DVec3, direction: DVec3) -> Option<DVec3> {
        let (min, max) = (self.bounds.min - DVec3::Z, self.bounds.max + DVec3::Z);
        let (mut near, mut far) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let (t0, t1) = ((min[axis] - eye[axis]) / direction[axis], (max[axis] - eye[axis]) / direction[axis]);
            if direction[axis] == 0.0 {
                if !(min[axis]..=max[axis]).contains(&eye[axis]) {
                    return None;
                }
                continue;
            }
            near = near.max(t0.min(t1));
            far = far.min(t0.max(t1));
        }
        if near >= far || !far.is_finite() {
            return None;
        }
        let above = |t: f64| {
            let p = eye + direction * t;
            p.z - self.height_m(p.truncate())
        };
        let mut last = near;
        for step in 1..=RAY_STEPS {
            let t = near + (far - near) * step as f64 / RAY_STEPS as f64;
            if above(t) <= 0.0 {
                let (mut over, mut under) = (last, t);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (over + under);
                    if above(middle) > 0.0 { over = middle } else { under = middle }
                }
                return Some(eye + direction * under);
            }
            last = t;
        }
        None
    }
}

/// Direction from the eye through a point of the picture, given in pixels from its upper left corner.
pub fn ray_through(view: &View, pixel: [f64; 2]) -> DVec3 {
    let forward = view.forward();
    let right = forward.cross(view.up()).normalize();
    let up = right.cross(forward);
    let [width, height] = view.viewport_px.map(f64::from);
    let focal_px = view.pixels_per_radian();
    let (x, y) = (pixel[0] - 0.5 * width, 0.5 * height - pixel[1]);
    (forward + right * (x / focal_px) + up * (y / focal_px)).normalize()
}

/// Bilinear height on the finest level whose four points around a place are in memory.
fn finest_height_m(terrain: &Terrain, place: DVec2) -> f64 {
    let surface = terrain.surface();
    let (data, lattice) = (surface.data(), surface.numbers().lattice());
    let [column, row] = terrain.geo().grid_from_local(place.x, place.y);
    let column = column.clamp(0.0, f64::from(lattice.width() - 1));
    let row = row.clamp(0.0, f64::from(lattice.height() - 1));
    for level in 0..=lattice.levels() {
        let [nx, ny] = lattice.squares(level);
        let square = |at: f64, squares: u32| ((at as u64 >> level) as u32).min(squares - 1);
        let (x, y) = (square(column, nx), square(row, ny));
        let corners = [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].map(|[x, y]| LatticeNode { level, x, y });
        if !corners.iter().all(|&node| data.is_resident(node)) {
            continue;
        }
        let [west, north] = lattice.sample(level, x, y).map(f64::from);
        let [east, south] = lattice.sample(level, x + 1, y + 1).map(f64::from);
        let (u, v) = ((column - west) / (east - west).max(1.0), (row - north) / (south - north).max(1.0));
        let z = corners.map(|node| f64::from(data.height_m(node)));
        return (z[0] * (1.0 - u) + z[1] * u) * (1.0 - v) + (z[2] * (1.0 - u) + z[3] * u) * v;
    }
    f64::from(terrain.range_m()[0])
}

#[cfg(all(test, feature = "files"))]
pub(super) mod tests {
    use super::*;

    /// A slope of 1 in 10 rising northwards, 2 km by 1 km.
    pub(in crate::steer) fn slope() -> Ground<'static> {
        Ground {
            height_m: Box::new(|p| 100.0 + 0.1 * (p.y.clamp(-1000.0, 0.0) + 1000.0)),
            bounds: Aabb { min: DVec3::new(0.0, -1000.0, 100.0), max: DVec3::new(2000.0, 0.0, 200.0) },
            clearance_m: 2.0,
        }
    }

    #[test]
    fn a_ray_meets_the_land_where_it_should() {
        let ground = slope();
        let down = ground.hit(DVec3::new(700.0, -400.0, 900.0), -DVec3::Z).unwrap();
        assert!((down - DVec3::new(700.0, -400.0, 160.0)).length() < 1e-3, "{down}");
        assert!(ground.hit(DVec3::new(700.0, -400.0, 900.0), DVec3::Z).is_none());
        assert!(ground.hit(DVec3::new(-700.0, -400.0, 900.0), -DVec3::Z).is_none());
    }

    #[test]
    fn around_a_model_there_is_no_land() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 0.01).to_vec();
        let sides = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mesh = yamanami_core::TriangleMesh::new(corners, sides);
        let build = crate::ModelBuild::of_mesh(&mesh, String::new(), &|_| ()).unwrap();
        let model = build.into_model().unwrap();
        let ground = Ground::of(&model);
        let eye = DVec3::new(0.002, 0.002, 0.05);
        assert!(ground.hit(eye, -DVec3::Z).is_none() && !ground.holds(eye.truncate()));
        assert!(ground.height_above_m(eye) > 0.04 && ground.height_above_m(eye) < 0.06);
        assert!(ground.clearance_m < 1e-4 && ground.diagonal_m() > 0.01);
    }

    #[test]
    fn the_middle_pixel_looks_at_the_target() {
        let view = View {
            eye: DVec3::new(3.0, 4.0, 50.0),
            target: DVec3::new(90.0, 10.0, 0.0),
            fov_y_rad: 0.7,
            viewport_px: [640, 480],
        };
        assert!((ray_through(&view, [320.0, 240.0]) - view.forward()).length() < 1e-12);
        assert!(ray_through(&view, [320.0, 0.0]).z > view.forward().z);
    }
}
