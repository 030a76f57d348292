//! Cameras: where the eye is, what it sees, and how large an error looks.

use crate::{Aabb, Sphere};
use glam::{DMat4, DVec3, DVec4};

/// A camera over the local metric frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Eye position, metres.
    pub eye: DVec3,
    /// Point looked at, metres.
    pub target: DVec3,
    /// Vertical field of view in radians.
    pub fov_y_rad: f64,
    /// Picture size in pixels.
    pub viewport_px: [u32; 2],
}

/// Maps world points to clip space. Perspective is one; the deformed map is the other.
pub trait Projection {
    /// Clip-space position (z in 0..w, reversed depth is the renderer's business).
    fn clip_from_world(&self, world: DVec3) -> DVec4;

    /// An upper bound, in pixels, of how far a displacement of `error_m` metres anywhere inside `bound` can move on
    /// the screen; infinite when the eye is inside the bound.
    fn error_px(&self, error_m: f64, bound: Sphere) -> f64;
}

/// The usual pinhole camera, right-handed, z up, depth 0..1.
#[derive(Debug, Clone, Copy)]
pub struct Perspective {
    /// The camera.
    pub view: View,
    /// Distance of the near plane, metres.
    pub near_m: f64,
    /// Distance of the far plane, metres.
    pub far_m: f64,
}

/// The five side planes of what a perspective view sees (no far plane), normals inward.
#[derive(Debug, Clone, Copy)]
pub struct Frustum {
    planes: [DVec4; 5],
}

/// How something lies to what a view sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sight {
    /// Nothing of it is seen.
    Outside,
    /// Some of it may be seen.
    Crosses,
    /// All of it is seen.
    Inside,
}

impl View {
    /// Unit vector from the eye towards the target; north when they coincide.
    pub fn forward(&self) -> DVec3 {
        (self.target - self.eye).try_normalize().unwrap_or(DVec3::Y)
    }

    /// Up vector: z, unless the view is along z.
    pub fn up(&self) -> DVec3 {
        if self.forward().z.abs() > 0.9999 { DVec3::Y } else { DVec3::Z }
    }

    /// Pixels that one radian covers at the middle of the picture.
    pub fn pixels_per_radian(&self) -> f64 {
        f64::from(self.viewport_px[1]) * 0.5 / (self.fov_y_rad * 0.5).tan()
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.viewport_px[0]) / f64::from(self.viewport_px[1].max(1))
    }

    /// What the view sees, as planes through the eye plus the near side.
    pub fn frustum(&self) -> Frustum {
        let f = self.forward();
        let right = f.cross(self.up()).normalize();
        let up = right.cross(f);
        let ty = (self.fov_y_rad * 0.5).tan();
        let tx = ty * self.aspect();
        let plane = |n: DVec3| {
            let n = n.normalize();
            n.extend(-n.dot(self.eye))
        };
        Frustum {
            planes: [
                plane(f),
                plane(f * tx + right),
                plane(f * tx - right),
                plane(f * ty + up),
                plane(f * ty - up),
            ],
        }
    }
}

impl Frustum {
    /// Signed distance of a sphere to the frustum's side it is furthest outside of: above 0, the sphere (partly) shows;
    /// the value is how far eye and planes must move before that changes.
    pub fn margin_m(&self, sphere: Sphere) -> f64 {
        let p = sphere.centre.extend(1.0);
        self.planes.iter().map(|n| n.dot(p)).fold(f64::INFINITY, f64::min) + sphere.radius_m
    }

    /// Whether a point is seen; the border counts.
    pub fn sees_point(&self, p: DVec3) -> bool {
        self.planes.iter().all(|n| n.dot(p.extend(1.0)) >= 0.0)
    }

    /// How a box lies to it. Only what lies wholly outside one of the planes is called outside.
    pub fn sight_of(&self, b: &Aabb) -> Sight {
        let mut sight = Sight::Inside;
        for n in &self.planes {
            // the corners furthest along the normal, and against it
            let is_up = n.truncate().cmpge(DVec3::ZERO);
            let (far, near) = (DVec3::select(is_up, b.max, b.min), DVec3::select(is_up, b.min, b.max));
            if n.dot(far.extend(1.0)) < 0.0 {
                return Sight::Outside;
            }
            if n.dot(near.extend(1.0)) < 0.0 {
                sight = Sight::Crosses;
            }
        }
        sight
    }

    /// Whether all corners of a triangle lie outside one plane, so that nothing of it is seen.
    pub fn misses(&self, corners: [DVec3; 3]) -> bool {
        self.planes.iter().any(|n| corners.iter().all(|p| n.dot(p.extend(1.0)) < 0.0))
    }

    /// What of a triangle is seen, corner by corner; empty where nothing is.
    pub fn seen_part(&self, corners: [DVec3; 3]) -> Vec<DVec3> {
        let mut part = corners.to_vec();
        for n in &self.planes {
            let off = |p: DVec3| n.dot(p.extend(1.0));
            let whole = std::mem::take(&mut part);
            for (i, &p) in whole.iter().enumerate() {
                let q = whole[(i + 1) % whole.len()];
                let (at_p, at_q) = (off(p), off(q));
                if at_p >= 0.0 {
                    part.push(p);
                }
                if (at_p < 0.0) != (at_q < 0.0) {
                    part.push(p + at_p / (at_p - at_q) * (q - p));
                }
            }
        }
        part
    }

    /// Whether any part of the sphere may show.
    pub fn sees(&self, sphere: Sphere) -> bool {
        self.margin_m(sphere) >= 0.0
    }
}

impl Perspective {
    /// A perspective projection of `view`, its near and far planes given in metres.
    pub fn new(view: View, near_m: f64, far_m: f64) -> Self {
        Self { view, near_m, far_m }
    }

    /// View-projection matrix for points relative to `origin`: right-handed, depth 0 (near) to 1 (far).
    pub fn clip_from_local(&self, origin: DVec3) -> DMat4 {
        let eye = self.view.eye - origin;
        let forward = self.view.forward();
        let right = forward.cross(self.view.up()).normalize();
        let up = right.cross(forward);
        let view_from_local = DMat4::from_cols(
            DVec4::new(right.x, up.x, -forward.x, 0.0),
            DVec4::new(right.y, up.y, -forward.y, 0.0),
            DVec4::new(right.z, up.z, -forward.z, 0.0),
            DVec4::new(-right.dot(eye), -up.dot(eye), forward.dot(eye), 1.0),
        );
        let focal = 1.0 / (self.view.fov_y_rad * 0.5).tan();
        let depth = self.far_m / (self.near_m - self.far_m);
        let clip_from_view = DMat4::from_cols(
            DVec4::new(focal / self.view.aspect(), 0.0, 0.0, 0.0),
            DVec4::new(0.0, focal, 0.0, 0.0),
            DVec4::new(0.0, 0.0, depth, -1.0),
            DVec4::new(0.0, 0.0, depth * self.near_m, 0.0),
        );
        clip_from_view * view_from_local
    }
}

impl Projection for Perspective {
    fn clip_from_world(&self, world: DVec3) -> DVec4 {
        self.clip_from_local(DVec3::ZERO) * world.extend(1.0)
    }

    fn error_px(&self, error_m: f64, bound: Sphere) -> f64 {
        let distance_m = (bound.centre - self.view.eye).length() - bound.radius_m;
        if distance_m <= 0.0 {
            return if error_m > 0.0 { f64::INFINITY } else { 0.0 };
        }
        error_m * self.view.pixels_per_radian() / distance_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_target_is_the_middle_of_the_picture_and_up_is_up() {
        let view = View {
            eye: DVec3::new(10.0, -20.0, 30.0),
            target: DVec3::new(100.0, 50.0, 0.0),
            fov_y_rad: 1.0,
            viewport_px: [800, 600],
        };
        let projection = Perspective::new(view, 1.0, 1e5);
        let clip = projection.clip_from_world(view.target);
        assert!((clip.x / clip.w).abs() < 1e-12 && (clip.y / clip.w).abs() < 1e-12);
        assert!(clip.z > 0.0 && clip.z < clip.w);
        assert!(projection.clip_from_world(view.target + DVec3::Z).y > clip.y);
        assert!(view.frustum().sees(Sphere { centre: view.target, radius_m: 0.0 }));
        let behind = view.eye - 10.0 * view.forward();
        assert!(!view.frustum().sees(Sphere { centre: behind, radius_m: 1.0 }));
    }
    #[test]
    fn boxes_and_triangles_are_seen_where_points_of_them_are() {
        let view = View {
            eye: DVec3::ZERO,
            target: DVec3::Y,
            fov_y_rad: std::f64::consts::FRAC_PI_2,
            viewport_px: [100, 100],
        };
        let frustum = view.frustum();
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let sight = |min, max| frustum.sight_of(&Aabb { min, max });
        assert_eq!(sight(at(-1.0, 9.0, -1.0), at(1.0, 10.0, 1.0)), Sight::Inside);
        assert_eq!(sight(at(5.0, 2.0, -1.0), at(6.0, 3.0, 1.0)), Sight::Outside);
        assert_eq!(sight(at(-9.0, -9.0, -9.0), at(9.0, 9.0, -1.0)), Sight::Crosses);
        assert!(frustum.sees_point(at(1.0, 2.0, 1.0)) && !frustum.sees_point(at(1.0, -2.0, 1.0)));
        // a triangle across the view with all corners outside
        let across = [at(-50.0, 5.0, 0.0), at(50.0, 5.0, 0.0), at(0.0, 5.0, 90.0)];
        assert!(!frustum.misses(across) && !across.iter().any(|&p| frustum.sees_point(p)));
        assert!(frustum.seen_part(across).len() >= 3);
        assert!(frustum.seen_part(across).iter().all(|p| p.x.abs() <= 5.0 + 1e-9 && p.y == 5.0));
        // outside no single plane, and yet not seen
        let beside = [at(-3.0, 1.0, 0.0), at(0.0, -1.9, 0.0), at(-1.0, 0.5, 9.0)];
        assert!(frustum.seen_part(beside).is_empty());
    }
}
