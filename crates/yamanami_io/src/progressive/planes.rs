//! Coefficients plane by plane: the highest bits of all of them first, so that any prefix of the stream is the whole surface,
//! less exactly.
//!
//! In a plane, level by level, each vertex that has been reached tells which of its coefficients begin there, with their signs, and
//! whether any vertex below it in the tree has one that does: only then are its children reached. After that the
//! coefficients that had begun before get their next bit. Encoder and decoder run the same walk.
//!
//! Based on: Shapiro, "Embedded image coding using zerotrees of wavelet coefficients", 1993; Said, Pearlman, "A new, fast, and efficient
//! image codec based on set partitioning in hierarchical trees", 1996; Khodakovsky, Schröder, Sweldens, "Progressive geometry
//! compression", 2000. Where we differ: every decision is coded in contexts that are mixed.

use super::coder::Bits;
use super::contexts::{ANY, NORMAL_OF_SOME, Place, SLOTS, TANGENT, WEIGHT_SETS};
use super::links::Links;
use super::mixing::Mixing;
use yamanami_core::SemiRegular;

/// Most bits of a coefficient.
pub(super) const MOST_PLANES: u32 = 30;

/// Not one of the coefficient's bits is known.
const UNBEGUN: u8 = u8::MAX;

/// The walk over planes and levels, and what is known of the coefficients.
pub(super) struct Walk<'a, B> {
    mesh: &'a SemiRegular,
    mixing: Mixing<B>,
    links: Vec<Links>,
    /// By vertex, and one more that stays zero for those that are not there.
    known: Vec<[i32; 3]>,
    /// By vertex: the lowest plane whose bit is known, of each coefficient.
    lowest: Vec<[u8; 3]>,
    /// By vertex, and one more: whether its children are reached.
    is_open: Vec<bool>,
    /// By level from 1 on: the vertices reached.
    reached: Vec<Vec<u32>>,
    /// Coefficients that have begun: 3 · vertex + component; first those of earlier planes, then those of this.
    begun: Vec<u32>,
}

/// What an encoder knows.
struct Target<'a> {
    coefficients: &'a [[i32; 3]],
    /// Bits of the greatest coefficient below each vertex in the tree.
    deepest: Vec<u8>,
}

/// How far a stream went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Reach {
    /// Planes that are complete.
    pub(super) planes: u32,
    /// Levels that are complete in the plane after them.
    pub(super) levels: u32,
}

/// What a decoder knows at the end.
pub(super) struct Known {
    pub(super) coefficients: Vec<[f64; 3]>,
    pub(super) reach: Reach,
}

/// Bits that a coefficient needs.
fn bits(q: i32) -> u32 {
    u32::BITS - q.unsigned_abs().leading_zeros()
}

/// Planes that coefficients need.
pub(super) fn planes_of(coefficients: &[[i32; 3]]) -> u32 {
    coefficients.as_flattened().iter().map(|&q| bits(q)).max().unwrap_or(0)
}

/// Puts all coefficients, as integers, in `planes` planes.
pub(super) fn put<B: Bits>(mesh: &SemiRegular, coefficients: &[[i32; 3]], planes: u32, bits: B) -> B {
    let mut walk = Walk::new(mesh, bits);
    let mut target = Target { coefficients, deepest: vec![0; coefficients.len()] };
    for level in (1..mesh.levels()).rev() {
        let links = walk.links(level);
        for (v, children) in mesh.new_vertices(level).zip(&links.children) {
            for &child in children.iter().filter(|&&c| c != links.none) {
                let own = coefficients[child as usize].iter().map(|&q| self::bits(q) as u8).max().unwrap_or(0);
                let below = own.max(target.deepest[child as usize]);
                target.deepest[v as usize] = target.deepest[v as usize].max(below);
            }
        }
    }
    walk.run(planes, Some(&target));
    walk.mixing.bits
}

/// Gets as many coefficients, each with as many bits, as the stream tells; what is not told is taken to be in the middle,
/// nearer to zero.
pub(super) fn get<B: Bits>(mesh: &SemiRegular, planes: u32, bits: B) -> Known {
    let mut walk = Walk::new(mesh, bits);
    let reach = walk.run(planes, None);
    walk.known.pop();
    let coefficients = std::iter::zip(&walk.known, &walk.lowest)
        .map(|(known, lowest)| std::array::from_fn(|c| restored(known[c], lowest[c])))
        .collect();
    Known { coefficients, reach }
}

/// The value of a coefficient of which the bits below a plane are not known.
fn restored(known: i32, lowest: u8) -> f64 {
    if lowest == UNBEGUN || lowest == 0 {
        return f64::from(known);
    }
    let rest = (1u32 << lowest) - 1;
    f64::from(known) + 0.4 * f64::from(rest) * f64::from(known.signum())
}

impl<'a, B: Bits> Walk<'a, B> {
    fn new(mesh: &'a SemiRegular, bits: B) -> Self {
        let count = mesh.vertex_count(mesh.levels()) as usize;
        let mut reached = vec![Vec::new(); mesh.levels() as usize + 1];
        if mesh.levels() > 0 {
            reached[1] = mesh.new_vertices(1).collect();
        }
        Self {
            mesh,
            mixing: Mixing::new(bits, SLOTS, WEIGHT_SETS),
            links: Vec::new(),
            known: vec![[0; 3]; count + 1],
            lowest: vec![[UNBEGUN; 3]; count],
            is_open: vec![false; count + 1],
            reached,
            begun: Vec::new(),
        }
    }

    fn links(&mut self, level: u32) -> &Links {
        while self.links.len() < level as usize {
            self.links.push(Links::new(self.mesh, self.links.len() as u32 + 1, self.links.last()));
        }
        &self.links[level as usize - 1]
    }

    fn run(&mut self, planes: u32, target: Option<&Target<'_>>) -> Reach {
        for plane in (0..planes).rev() {
            let done = planes - 1 - plane;
            let mut levels = 0;
            if self.plane(plane, target, &mut levels).is_none() {
                return Reach { planes: done, levels };
            }
        }
        Reach { planes, levels: 0 }
    }

    fn plane(&mut self, plane: u32, target: Option<&Target<'_>>, levels: &mut u32) -> Option<()> {
        let earlier = self.begun.len();
        for v in self.mesh.new_vertices(0) {
            let place = Place::base(v, self.known.len() as u32 - 1);
            self.begin(plane, &place, target)?;
        }
        for level in 1..=self.mesh.levels() {
            *levels = level;
            if self.reached[level as usize].is_empty() {
                break;
            }
            self.links(level);
            let reached = std::mem::take(&mut self.reached[level as usize]);
            let done = self.level(level, plane, &reached, target);
            self.reached[level as usize] = reached;
            done?;
        }
        for i in 0..earlier {
            let (v, c) = (self.begun[i] / 3, (self.begun[i] % 3) as usize);
            self.refine(plane, v, c, target)?;
        }
        Some(())
    }

    fn level(&mut self, level: u32, plane: u32, reached: &[u32], target: Option<&Target<'_>>) -> Option<()> {
        let has_children = level < self.mesh.levels();
        for &v in reached {
            let place = self.place(level, v);
            self.begin(plane, &place, target)?;
            if has_children && !self.is_open[v as usize] {
                let want = target.is_some_and(|t| u32::from(t.deepest[v as usize]) > plane);
                let (contexts, weights) = place.of_open(plane, &self.known, &self.is_open);
                if self.mixing.code(contexts, weights, want)? {
                    self.is_open[v as usize] = true;
                    let links = &self.links[level as usize - 1];
                    let children = links.children[(v - links.first) as usize];
                    self.reached[level as usize + 1].extend(children.iter().filter(|&&child| child != links.none));
                }
            }
        }
        Some(())
    }

    fn place(&self, level: u32, vertex: u32) -> Place {
        let links = &self.links[level as usize - 1];
        let nth = (vertex - links.first) as usize;
        let parent = links.parent[nth];
        let beside_parent = match level {
            1 => [links.none; 4],
            _ => {
                let above = &self.links[level as usize - 2];
                above.beside[(parent - above.first) as usize]
            }
        };
        Place { vertex, level, beside: links.beside[nth], parent, beside_parent }
    }

    /// Tells which coefficients of a vertex begin in a plane: first whether any does, then the one along the normal, then
    /// whether any along the surface does.
    fn begin(&mut self, plane: u32, place: &Place, target: Option<&Target<'_>>) -> Option<()> {
        let v = place.vertex as usize;
        let waits = self.lowest[v].map(|lowest| lowest == UNBEGUN);
        if waits == [false; 3] {
            return Some(());
        }
        let want = target.map_or([0; 3], |t| t.coefficients[v]);
        let wanted = want.map(|q| bits(q) == plane + 1);
        let mut some = false;
        if waits == [true; 3] {
            let (contexts, weights) = place.of_beginning(ANY, plane, &self.known);
            some = self.mixing.code(contexts, weights, wanted.contains(&true))?;
            if !some {
                return Some(());
            }
        }
        let mut begins = [false; 3];
        if waits[0] {
            let (contexts, weights) = place.of_beginning(if some { NORMAL_OF_SOME } else { 0 }, plane, &self.known);
            begins[0] = self.mixing.code(contexts, weights, wanted[0])?;
            if begins[0] {
                self.set_out(plane, place, 0, want[0] < 0)?;
            }
        }
        let mut which = [waits[1], waits[2]];
        if which == [true; 2] {
            let must = some && !begins[0];
            let (contexts, weights) = place.of_beginning(TANGENT, plane, &self.known);
            if !must && !self.mixing.code(contexts, weights, wanted[1] || wanted[2])? {
                return Some(());
            }
            let (contexts, weights) = place.of_beginning(1, plane, &self.known);
            begins[1] = self.mixing.code(contexts, weights, wanted[1])?;
            if begins[1] {
                self.set_out(plane, place, 1, want[1] < 0)?;
            } else {
                return self.set_out(plane, place, 2, want[2] < 0);
            }
            which[0] = false;
        }
        for c in [1, 2] {
            if which[c - 1] {
                let (contexts, weights) = place.of_beginning(c, plane, &self.known);
                if self.mixing.code(contexts, weights, wanted[c])? {
                    self.set_out(plane, place, c, want[c] < 0)?;
                }
            }
        }
        Some(())
    }

    /// A coefficient begins in a plane; tells its sign.
    fn set_out(&mut self, plane: u32, place: &Place, c: usize, is_negative: bool) -> Option<()> {
        let v = place.vertex as usize;
        let (contexts, weights) = place.of_sign(c, plane, &self.known);
        let size = if self.mixing.code(contexts, weights, is_negative)? { -1 } else { 1 };
        self.known[v][c] = size << plane;
        self.lowest[v][c] = plane as u8;
        self.begun.push((3 * v + c) as u32);
        Some(())
    }

    /// The next bit of a coefficient that has begun.
    fn refine(&mut self, plane: u32, vertex: u32, c: usize, target: Option<&Target<'_>>) -> Option<()> {
        let v = vertex as usize;
        let level = self.mesh.level_of(vertex);
        let place =
            if level == 0 { Place::base(vertex, self.known.len() as u32 - 1) } else { self.place(level, vertex) };
        let want = target.is_some_and(|t| t.coefficients[v][c].unsigned_abs() >> plane & 1 == 1);
        let (contexts, weights) = place.of_refining(c, plane, &self.known);
        if self.mixing.code(contexts, weights, want)? {
            self.known[v][c] += self.known[v][c].signum() << plane;
        }
        self.lowest[v][c] = plane as u8;
        Some(())
    }
}
