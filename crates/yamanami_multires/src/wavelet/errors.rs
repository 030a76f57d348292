//! Errors that bound the true vertical distance of every front.
//!
//! For a triangle with the midpoints h, p, q let E(c) be the greatest vertical distance between the samples under it and
//! the template of configuration c. A front that lacks some midpoint of the triangle draws one of these templates (or
//! lacks something coarser), so it suffices that for every c short of all, *some* missing midpoint has an error of at
//! least E(c). We take an order of the midpoints, charge each E(c) to the first missing one, and keep the order that
//! charges least; so a single rough edge does not force its whole triangle. Errors are then made monotone: a midpoint's
//! error is at least that of its children.
//!
//! All templates are the plane through the corners plus hat functions that are minima of barycentric coordinates, so one
//! pass over a triangle's samples yields all seven E(c).

use super::template::TEMPLATES;
use super::triangle::{Triangle, doubled_area};
use yamanami_core::{ErrorCode, Lattice};

/// E(c) in metres of the seven configurations short of all midpoints.
pub(crate) type ConfigErrors = [f32; 7];

/// Orders of the midpoints (0 = h, 1 = p, 2 = q).
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// What each midpoint must at least answer for, given E(c); `exists` tells which midpoints are on the lattice.
pub(crate) fn charge(errors: &ConfigErrors, exists: [bool; 3]) -> [f32; 3] {
    let (mut best, mut least) = ([0.0; 3], f32::INFINITY);
    for order in ORDERS {
        let mut charged = [0f32; 3];
        for (config, &error) in errors.iter().enumerate() {
            let missing = |i: usize| config & (1 << i) == 0;
            if (0..3).any(|i| !missing(i) && !exists[i]) {
                continue;
            }
            if let Some(&first) = order.iter().find(|&&i| exists[i] && missing(i)) {
                charged[first] = charged[first].max(error);
            }
        }
        let sum: f32 = charged.iter().sum();
        if sum < least {
            (best, least) = (charged, sum);
        }
    }
    best
}

/// The same for a triangle whose three midpoints exist, without branches: configurations 1 = h, 2 = p, 4 = q.
#[inline]
pub(crate) fn charge_three(e: &ConfigErrors) -> [f32; 3] {
    let (mut best, mut least) = ([0.0; 3], f32::INFINITY);
    for [a, b, c] in ORDERS {
        let bit = |i: usize| 1usize << i;
        let first = e[0].max(e[bit(b)]).max(e[bit(c)]).max(e[bit(b) | bit(c)]);
        let second = e[bit(a)].max(e[bit(a) | bit(c)]);
        let third = e[bit(a) | bit(b)];
        let sum = first + second + third;
        if sum < least {
            least = sum;
            best[a] = first;
            best[b] = second;
            best[c] = third;
        }
    }
    best
}

/// Triangles, or samples, that are weighed at once.
pub(crate) const LANES: usize = 8;

/// E(c) of a triangle that is not clamped: side `side` samples, its square's first sample at `origin`.
#[inline(always)]
fn config_errors_body(heights_m: &[f32], width: usize, origin: usize, side: usize, half: u32) -> ConfigErrors {
    let z = |i: usize, k: usize| heights_m[origin + k * width + i];
    let (m, inv) = (side / 2, 1.0 / side as f32);
    let [zr, zp, zq, zh, zmp, zmq] = if half == 0 {
        [z(side, 0), z(0, 0), z(side, side), z(m, m), z(m, 0), z(side, m)]
    } else {
        [z(0, side), z(side, side), z(0, 0), z(m, m), z(m, side), z(0, m)]
    };
    // all heights relative to R: differences of near heights are (nearly) exact
    let (dp, dq) = (zp - zr, zq - zr);
    let wh = (zh - zr) - 0.5 * (dp + dq);
    let wp = (zmp - zr) - 0.5 * dp;
    let wq = (zmq - zr) - 0.5 * dq;
    let mut worst = [Lanes::ZERO; 7];
    for k in 0..=side {
        let (first, last) = if half == 0 { (k, side) } else { (0, k) };
        let row = &heights_m[origin + k * width + first..=origin + k * width + last];
        let kf = k as f32;
        let mut i = Lanes::RAMP.plus(first as f32);
        let block = |z: Lanes, i: Lanes| {
            let (lp, lr, lq) = if half == 0 {
                (i.times(-inv).plus(1.0), i.plus(-kf).times(inv), Lanes::splat(kf * inv))
            } else {
                (i.times(inv), i.times(-1.0).plus(kf).times(inv), Lanes::splat(1.0 - kf * inv))
            };
            let r = z.plus(-zr).sub(lp.times(dp).add(lq.times(dq)));
            let [wh, wp, wq] = [wh, wp, wq].map(Lanes::splat);
            let e = residuals(r, [lp, lr, lq], [wh, wp, wq]);
            e.map(Lanes::abs)
        };
        let mut chunks = row.chunks_exact(LANES);
        for chunk in &mut chunks {
            let e = block(Lanes::load(chunk), i);
            for c in 0..7 {
                worst[c] = worst[c].max(e[c]);
            }
            i = i.plus(LANES as f32);
        }
        let rest = chunks.remainder();
        if !rest.is_empty() {
            let e = block(Lanes::load(rest), i);
            for c in 0..7 {
                worst[c] = worst[c].max(e[c].first(rest.len()));
            }
        }
    }
    worst.map(|lanes| lanes.0.into_iter().fold(0.0, max))
}

/// Eight numbers at once; the compiler turns the loops into vector instructions.
#[derive(Clone, Copy)]
struct Lanes([f32; LANES]);

impl Lanes {
    const ZERO: Self = Self([0.0; LANES]);
    const RAMP: Self = Self([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);

    #[inline(always)]
    fn splat(v: f32) -> Self {
        Self([v; LANES])
    }

    /// Up to eight numbers, the rest zero.
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let mut out = [0.0; LANES];
        if let Ok(full) = from.try_into() {
            out = full;
        } else {
            out[..from.len()].copy_from_slice(from);
        }
        Self(out)
    }

    /// Zero from lane `count` on.
    #[inline(always)]
    fn first(self, count: usize) -> Self {
        let mut out = self.0;
        for (lane, v) in out.iter_mut().enumerate() {
            if lane >= count {
                *v = 0.0;
            }
        }
        Self(out)
    }

    #[inline(always)]
    fn zip(self, o: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut out = [0.0; LANES];
        for lane in 0..LANES {
            out[lane] = f(self.0[lane], o.0[lane]);
        }
        Self(out)
    }

    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip(o, |a, b| a * b)
    }

    #[inline(always)]
    fn min(self, o: Self) -> Self {
        self.zip(o, min)
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        self.zip(o, max)
    }

    #[inline(always)]
    fn plus(self, v: f32) -> Self {
        self.zip(Self::splat(v), |a, b| a + b)
    }

    #[inline(always)]
    fn times(self, v: f32) -> Self {
        self.zip(Self::splat(v), |a, b| a * b)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }
}

/// What is left of the residuals `r` to the corners' plane in each configuration, at points with the barycentric
/// coordinates of P, R, Q, where the midpoints h, p, q stand this far above their edges.
#[inline(always)]
fn residuals(r: Lanes, [lp, lr, lq]: [Lanes; 3], details: [Lanes; 3]) -> [Lanes; 7] {
    let [h2, p2, q2] = details.map(|w| w.add(w));
    let rh = r.sub(lp.min(lq).mul(h2));
    let rq = r.sub(lq.min(lr).mul(q2));
    [
        r,
        rh,
        r.sub(lp.min(lr).mul(p2)),
        rh.sub(lp.sub(lq).min(lr).max(Lanes::ZERO).mul(p2)),
        rq,
        rh.sub(lq.sub(lp).min(lr).max(Lanes::ZERO).mul(q2)),
        rq.sub(lr.sub(lq).min(lp).max(Lanes::ZERO).mul(p2)),
    ]
}

/// Compares without the NaN rules of `f32::max`, so that it is one instruction.
#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// E(c) of [`LANES`] unclamped triangles side by side: small ones have rows too short for [`config_errors_body`].
#[inline(always)]
fn config_errors_abreast_body(
    heights_m: &[f32],
    width: usize,
    origin: usize,
    side: usize,
    half: u32,
) -> [ConfigErrors; LANES] {
    let z = |i: usize, k: usize| {
        let first = origin + k * width + i;
        let row = &heights_m[first..first + (LANES - 1) * side + 1];
        let mut out = [0.0; LANES];
        for lane in 0..LANES {
            out[lane] = row[lane * side];
        }
        Lanes(out)
    };
    let (m, inv) = (side / 2, 1.0 / side as f32);
    let [zr, zp, zq, zh, zmp, zmq] = if half == 0 {
        [z(side, 0), z(0, 0), z(side, side), z(m, m), z(m, 0), z(side, m)]
    } else {
        [z(0, side), z(side, side), z(0, 0), z(m, m), z(m, side), z(0, m)]
    };
    let (dp, dq) = (zp.sub(zr), zq.sub(zr));
    let details = [
        zh.sub(zr).sub(dp.add(dq).times(0.5)),
        zmp.sub(zr).sub(dp.times(0.5)),
        zmq.sub(zr).sub(dq.times(0.5)),
    ];
    let mut worst = [Lanes::ZERO; 7];
    for k in 0..=side {
        let (first, last) = if half == 0 { (k, side) } else { (0, k) };
        for i in first..=last {
            let (fi, fk) = (i as f32, k as f32);
            let (lp, lr, lq) = if half == 0 {
                (1.0 - fi * inv, (fi - fk) * inv, fk * inv)
            } else {
                (fi * inv, (fk - fi) * inv, 1.0 - fk * inv)
            };
            let r = z(i, k).sub(zr).sub(dp.times(lp).add(dq.times(lq)));
            let e = residuals(r, [lp, lr, lq].map(Lanes::splat), details);
            for c in 0..7 {
                worst[c] = worst[c].max(e[c].abs());
            }
        }
    }
    std::array::from_fn(|lane| worst.map(|of_config| of_config.0[lane]))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn config_errors_abreast_avx2(
    heights_m: &[f32],
    width: usize,
    origin: usize,
    side: usize,
    half: u32,
) -> [ConfigErrors; LANES] {
    config_errors_abreast_body(heights_m, width, origin, side, half)
}

/// E(c) of [`LANES`] unclamped triangles of one half, in squares side by side from `origin` on.
pub(crate) fn config_errors_abreast(
    heights_m: &[f32],
    width: usize,
    origin: usize,
    side: usize,
    half: u32,
) -> [ConfigErrors; LANES] {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2, as just asked.
        return unsafe { config_errors_abreast_avx2(heights_m, width, origin, side, half) };
    }
    config_errors_abreast_body(heights_m, width, origin, side, half)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn config_errors_avx2(heights_m: &[f32], width: usize, origin: usize, side: usize, half: u32) -> ConfigErrors {
    config_errors_body(heights_m, width, origin, side, half)
}

/// E(c) of an unclamped triangle; the same bits whichever instructions the processor has.
pub(crate) fn config_errors(heights_m: &[f32], width: usize, origin: usize, side: usize, half: u32) -> ConfigErrors {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2, as just asked.
        return unsafe { config_errors_avx2(heights_m, width, origin, side, half) };
    }
    config_errors_body(heights_m, width, origin, side, half)
}

/// E(c) of any triangle, clamped or not, by rasterising every template: slow, short, and the fast one's twin.
pub(crate) fn config_errors_exact(heights_m: &[f32], lattice: &Lattice, triangle: Triangle) -> ConfigErrors {
    let width = lattice.width() as usize;
    let points = triangle.points().map(|n| lattice.sample(n.level, n.x, n.y));
    let mut out = [0f32; 7];
    for (config, template) in TEMPLATES.iter().enumerate() {
        for roles in *template {
            out[config] = out[config].max(distance_to_plane(heights_m, width, roles.map(|r| points[r])));
        }
    }
    out
}

/// Greatest vertical distance between the samples in a triangle (border included) and the plane of its corners.
fn distance_to_plane(heights_m: &[f32], width: usize, corners: [[u32; 2]; 3]) -> f32 {
    let area = doubled_area(corners);
    if area == 0 {
        return 0.0;
    }
    let [a, b, c] = corners.map(|[x, y]| [i64::from(x), i64::from(y)]);
    let z = |p: [i64; 2]| f64::from(heights_m[p[1] as usize * width + p[0] as usize]);
    let range = |axis: usize| {
        let v = [a[axis], b[axis], c[axis]];
        v.into_iter().min().unwrap_or(0)..=v.into_iter().max().unwrap_or(0)
    };
    // rows run south: the edge function's sign is that of the plan seen from above, negated
    let edge = |p: [i64; 2], q: [i64; 2], s: [i64; 2]| -((q[0] - p[0]) * (s[1] - p[1]) - (q[1] - p[1]) * (s[0] - p[0]));
    let mut worst = 0f64;
    for y in range(1) {
        for x in range(0) {
            let s = [x, y];
            let weights = [edge(b, c, s), edge(c, a, s), edge(a, b, s)];
            if weights.iter().all(|&w| w >= 0) {
                let plane =
                    (weights[0] as f64 * z(a) + weights[1] as f64 * z(b) + weights[2] as f64 * z(c)) / area as f64;
                worst = worst.max((z(s) - plane).abs());
            }
        }
    }
    worst as f32
}

/// An error code for a computed bound, raised by what rounding in f32 may hide.
#[inline]
pub(crate) fn code(error_m: f32, rounding_m: f32) -> ErrorCode {
    if error_m > 0.0 { ErrorCode::ceil(error_m + rounding_m) } else { ErrorCode(0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: usize, seed: u32) -> Vec<f32> {
        (0..n)
            .map(|i| {
                ((i as u32).wrapping_mul(2_654_435_761).wrapping_add(seed).wrapping_mul(40_503) >> 16 & 1023) as f32
            })
            .collect()
    }

    #[test]
    fn the_fast_errors_equal_the_exact_ones() {
        let lattice = Lattice::new(65, 65);
        let z = noise(65 * 65, 7);
        for level in 1..=5u32 {
            for half in 0..2 {
                let t = Triangle { level, x: 1, y: 0, half };
                let side = 1usize << level;
                let fast = config_errors(&z, 65, side, side, half);
                let exact = config_errors_exact(&z, &lattice, t);
                for c in 0..7 {
                    assert!(
                        (fast[c] - exact[c]).abs() < 1e-3,
                        "level {level} half {half} config {c}: {fast:?} {exact:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn triangles_abreast_have_the_errors_they_have_alone() {
        let z = noise(129 * 129, 3);
        for side in [4, 8, 16] {
            for half in 0..2 {
                let abreast = config_errors_abreast(&z, 129, 129 * side, side, half);
                for (lane, errors) in abreast.iter().enumerate() {
                    assert_eq!(*errors, config_errors(&z, 129, 129 * side + lane * side, side, half));
                }
            }
        }
    }

    #[test]
    fn every_configuration_is_answered_for() {
        for seed in 0..200 {
            let e: ConfigErrors = noise(7, seed * 97).try_into().unwrap();
            let charged = charge_three(&e);
            assert_eq!(charged, charge(&e, [true; 3]));
            for (config, &error) in e.iter().enumerate() {
                let answer = (0..3).filter(|i| config & (1 << i) == 0).map(|i| charged[i]).fold(0.0, f32::max);
                assert!(answer >= error);
            }
        }
    }
}
