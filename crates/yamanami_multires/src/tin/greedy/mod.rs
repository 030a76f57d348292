//! A TIN of a height field at a greatest error: greedy insertion.
//!
//! Based on: Garland, Heckbert, "Fast Polygonal Approximation of Terrains and Height Fields", 1995: a Delaunay
//! triangulation of a few samples gets the sample that it misses most (to a 64th), over and over; after each, only the triangles that
//! changed are looked at again. Ours differs in that predicates are exact (samples have whole coordinates), samples on
//! edges belong to both sides, and no-data is left out exactly (see `voids.rs`).

mod net;
mod queue;
mod scan;
mod voids;

use crate::MultiresError;
use crate::clean::{CleanOptions, clean};
use glam::DVec3;
use net::Net;
use queue::Queue;
use yamanami_core::{HeightField, Tin, TriangleMesh};

/// When insertion ends: at the first of both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GreedyOptions {
    /// Greatest vertical error wanted at any sample, metres.
    pub max_error_m: f64,
    /// Most triangles wanted. The border of no-data and the grid's four corners are kept even if they take more.
    pub most_triangles: Option<usize>,
}

/// A TIN of a height field.
#[derive(Debug, Clone, PartialEq)]
pub struct GreedyTin {
    /// The TIN, in the field's local metric frame ([`yamanami_core::GeoReference::local_from_grid`]), without a CRS.
    pub tin: Tin,
    /// Greatest vertical distance of a covered sample to it, metres: over `max_error_m` only where triangles ran out.
    pub error_m: f64,
}

/// Triangulates a height field by greedy insertion.
///
/// It covers exactly the cells whose four samples have data, and of those with three the half that has; there every sample
/// is within the error. Fails when no triangle has data at its corners.
pub fn greedy(field: &HeightField, options: &GreedyOptions) -> Result<GreedyTin, MultiresError> {
    let (width, height) = (field.width(), field.height());
    if width.max(height) > net::MOST_SIDE || width as u64 * height as u64 > net::MOST_SAMPLES {
        return Err(MultiresError::TooLarge { width, height });
    }
    let mut work = Work::new(field, options.max_error_m);
    if work.hidden == work.net.triangle_count() {
        return Err(MultiresError::NothingToShow { width, height, no_data: field.no_data_count() });
    }
    work.scan_all(options.max_error_m);
    work.run(options);
    Ok(work.finish())
}

struct Work<'a> {
    field: &'a HeightField,
    net: Net,
    /// Triangles that are not shown: this never changes.
    hidden: usize,
    /// The sample that a triangle misses most, and by how much, metres.
    worst: Vec<scan::Worst>,
    /// How often a triangle was looked at: older entries of the queue are void.
    looks: Vec<u32>,
    queue: Queue,
}

impl<'a> Work<'a> {
    fn new(field: &'a HeightField, max_error_m: f64) -> Self {
        let mut net = Net::of_grid(field.width() as i32, field.height() as i32);
        voids::outline(&mut net, field);
        let hidden = (0..net.triangle_count()).filter(|&t| !is_shown(&net, field, t)).count();
        Self { field, net, hidden, worst: Vec::new(), looks: Vec::new(), queue: Queue::above(max_error_m) }
    }

    fn scan_all(&mut self, max_error_m: f64) {
        for t in 0..self.net.triangle_count() {
            self.look(t as u32, max_error_m);
        }
    }

    fn run(&mut self, options: &GreedyOptions) {
        let most = options.most_triangles.unwrap_or(usize::MAX);
        while let Some((t, look)) = self.queue.pop() {
            if self.looks[t as usize] != look {
                continue;
            }
            // an insertion makes two more at most
            if self.net.triangle_count() - self.hidden + 2 > most {
                return;
            }
            let sample = self.worst[t as usize].sample as usize;
            let place = [(sample % self.field.width()) as i32, (sample / self.field.width()) as i32];
            self.net.insert(t, place);
            let changed = std::mem::take(&mut self.net.changed);
            for &t in &changed {
                self.look(t, options.max_error_m);
            }
            self.net.changed = changed;
        }
    }

    /// Finds what a triangle misses most, and puts it into the queue if that is too much.
    fn look(&mut self, t: u32, max_error_m: f64) {
        let at = t as usize;
        if at >= self.worst.len() {
            self.worst.resize(self.net.triangle_count(), scan::Worst::NONE);
            self.looks.resize(self.net.triangle_count(), 0);
        }
        self.looks[at] += 1;
        self.worst[at] = scan::worst_sample(self.field, self.net.places_of(at));
        let error_m = self.worst[at].error_m;
        if error_m > max_error_m {
            self.queue.push(error_m, (t, self.looks[at]));
        }
    }

    fn finish(self) -> GreedyTin {
        let (net, field) = (&self.net, self.field);
        let positions: Vec<DVec3> = (0..net.vertex_count())
            .map(|v| {
                let [column, row] = net.place(v as u32);
                let [x, y] = field.geo().local_from_grid(f64::from(column), f64::from(row));
                DVec3::new(x, y, f64::from(field.at(column as usize, row as usize)))
            })
            .collect();
        let shown = (0..net.triangle_count()).filter(|&t| is_shown(net, field, t));
        // rows go south
        let triangles = shown.map(|t| net.corners(t)).map(|[a, b, c]| [a, c, b]).collect();
        let error_m = self.worst.iter().fold(0.0, |most: f64, worst| most.max(worst.error_m));
        let mut mesh = TriangleMesh::new(positions, triangles);
        clean(&mut mesh, &CleanOptions { drop_isolated: true, ..CleanOptions::default() });
        GreedyTin { tin: Tin::of_mesh("", mesh), error_m }
    }
}

/// Whether a triangle has data at its corners.
fn is_shown(net: &Net, field: &HeightField, t: usize) -> bool {
    net.places_of(t).iter().all(|&[column, row]| !field.at(column as usize, row as usize).is_nan())
}
