//! A ball around points and balls, close to the smallest.
//!
//! Based on: Bădoiu and Clarkson, "Smaller core-sets for balls", 2003 (the centre walks towards what is farthest, by ever
//! shorter steps).

use glam::DVec3;
use yamanami_core::Sphere;

/// Steps of the walk.
const STEPS: usize = 24;

/// Points nearer to the first centre than this share of the radius there are left out of the walk.
const OUTER: f64 = 0.7;

/// What the radius is given for rounding, relative.
const ROUNDING: f64 = 1e-12;

/// A ball that holds all points and balls.
pub(super) fn enclose(points: &[DVec3], balls: &[Sphere]) -> Sphere {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let all = || points.iter().map(|&p| Sphere { centre: p, radius_m: 0.0 }).chain(balls.iter().copied());
    for Sphere { centre, radius_m } in all() {
        low = low.min(centre - radius_m);
        high = high.max(centre + radius_m);
    }
    if !low.is_finite() {
        return Sphere { centre: DVec3::ZERO, radius_m: 0.0 };
    }
    let farthest = |points: &[DVec3], from: DVec3| {
        let (mut off2, mut towards) = (0.0, from);
        for &p in points {
            let here2 = p.distance_squared(from);
            if here2 > off2 {
                (off2, towards) = (here2, p);
            }
        }
        balls.iter().fold((off2.sqrt(), towards), |best: (f64, DVec3), &Sphere { centre, radius_m }| {
            let off = centre - from;
            let reach_m = off.length() + radius_m;
            if reach_m > best.0 { (reach_m, centre + off.normalize_or_zero() * radius_m) } else { best }
        })
    };
    let mut centre = 0.5 * (low + high);
    let (mut radius_m, mut towards) = farthest(points, centre);
    // the centre stays about where it is: what is near it will never be farthest
    let outer2 = (OUTER * radius_m).powi(2);
    let outer: Vec<DVec3> = points.iter().copied().filter(|p| p.distance_squared(centre) >= outer2).collect();
    let mut best = Sphere { centre, radius_m };
    for step in 0..STEPS {
        centre += (towards - centre) / (step + 2) as f64 * 0.5;
        (radius_m, towards) = farthest(&outer, centre);
        if radius_m < best.radius_m {
            best = Sphere { centre, radius_m };
        }
    }
    best.radius_m = farthest(points, best.centre).0;
    best.radius_m += ROUNDING * (best.radius_m + best.centre.length());
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_testkit::Rng;

    #[test]
    fn all_is_inside_and_little_room_is_wasted() {
        let mut rng = Rng::new(7);
        for count in [1, 2, 3, 40] {
            let mut place = || DVec3::new(rng.unit(), rng.unit(), rng.unit()) * 5.0 + 1e5;
            let points: Vec<DVec3> = (0..count).map(|_| place()).collect();
            let balls: Vec<Sphere> = (0..count / 2).map(|_| Sphere { centre: place(), radius_m: 1.0 }).collect();
            let ball = enclose(&points, &balls);
            for p in &points {
                assert!((*p - ball.centre).length() <= ball.radius_m);
            }
            for b in &balls {
                assert!((b.centre - ball.centre).length() + b.radius_m <= ball.radius_m);
            }
            assert!(ball.radius_m < 5.6);
        }
        let pair = enclose(&[DVec3::ZERO, DVec3::X * 2.0], &[]);
        assert!(pair.radius_m < 1.001, "{pair:?}");
    }
}
