//! Geometries as a GeoPackage's blobs: a header with the box around them, and well-known binary with z.
//!
//! Based on: Open Geospatial Consortium, "OGC GeoPackage encoding standard", 1.4, 2024, clause 2.1.3.

use glam::DVec3;
use yamanami_core::Aabb;

/// Little endian, with a box in x and y.
const FLAGS: u8 = 0b0000_0011;
const LITTLE_ENDIAN: u8 = 1;
const LINE_Z: u32 = 1002;
const POLYGON_Z: u32 = 1003;

/// Makes blobs, one at a time.
#[derive(Debug, Default)]
pub(super) struct Geometry {
    blob: Vec<u8>,
}

impl Geometry {
    /// A triangle as a polygon of one closed ring.
    pub(super) fn triangle(&mut self, srs_id: i32, [a, b, c]: [DVec3; 3]) -> &[u8] {
        self.begin(srs_id, &[a, b, c], POLYGON_Z);
        self.number(1);
        self.points(&[a, b, c, a]);
        &self.blob
    }

    /// A line.
    pub(super) fn line(&mut self, srs_id: i32, points: &[DVec3]) -> &[u8] {
        self.begin(srs_id, points, LINE_Z);
        self.points(points);
        &self.blob
    }

    fn begin(&mut self, srs_id: i32, points: &[DVec3], kind: u32) {
        let mut bounds = Aabb::EMPTY;
        points.iter().for_each(|&p| bounds.include(p));
        let Aabb { min, max } = bounds;
        self.blob.clear();
        self.blob.extend_from_slice(b"GP\0");
        self.blob.push(FLAGS);
        self.blob.extend_from_slice(&srs_id.to_le_bytes());
        self.doubles(&[min.x, max.x, min.y, max.y]);
        self.blob.push(LITTLE_ENDIAN);
        self.number(kind);
    }

    fn points(&mut self, points: &[DVec3]) {
        self.number(points.len() as u32);
        points.iter().for_each(|p| self.doubles(&p.to_array()));
    }

    fn number(&mut self, number: u32) {
        self.blob.extend_from_slice(&number.to_le_bytes());
    }

    fn doubles(&mut self, doubles: &[f64]) {
        doubles.iter().for_each(|d| self.blob.extend_from_slice(&d.to_le_bytes()));
    }
}
