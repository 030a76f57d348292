//! What the tests of deformed maps share: mountains to the rim, pictures of them, and their horizon.

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use std::sync::Arc;
use yamanami_core::{DeformedMap, MapView, TriangleMesh};
use yamanami_gpu::{HorizonTable, MapTexture, MapTextures};
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain};

/// How far the maps of the tests reach.
pub const RIM_M: f64 = 60e3;
/// Spacing of the heights.
pub const SPACING_M: f64 = 800.0;

/// Fractal mountains, folded so that there are many ridges, in a square that holds the rim's disc.
pub struct Mountains {
    heights_m: Vec<f64>,
    side: usize,
}

impl Mountains {
    pub fn new() -> Self {
        let side = (2.0 * (RIM_M + 4.0 * SPACING_M) / SPACING_M) as usize + 1;
        let shape = Shape::Fractal { relief_m: 3000.0, roughness: 0.5, seed: 11 };
        let field = SyntheticTerrain::new(side, side, shape, Spacing::Metres(SPACING_M)).to_field();
        let fold = |&z: &f32| {
            let folds = f64::from(z) / 250.0;
            1800.0 * (1.0 - 2.0 * (folds - folds.round()).abs())
        };
        Self { heights_m: field.heights_m().iter().map(fold).collect(), side }
    }

    /// The height of the mesh below a place of the plane.
    pub fn at(&self, p: DVec2) -> f64 {
        let middle = (self.side - 1) as f64 / 2.0;
        let at = (p / SPACING_M + middle).clamp(DVec2::ZERO, DVec2::splat(2.0 * middle - 1e-9));
        let (column, row) = (at.x as usize, at.y as usize);
        let part = at - at.floor();
        let z = |dx: usize, dy: usize| self.heights_m[(row + dy) * self.side + column + dx];
        // the diagonal runs from (0, 0) to (1, 1)
        if part.x >= part.y {
            z(0, 0) + (z(1, 0) - z(0, 0)) * part.x + (z(1, 1) - z(1, 0)) * part.y
        } else {
            z(0, 0) + (z(0, 1) - z(0, 0)) * part.y + (z(1, 1) - z(0, 1)) * part.x
        }
    }

    /// Two triangles a cell, row by row from the south-west.
    pub fn mesh(&self) -> TriangleMesh {
        let middle = (self.side - 1) as f64 / 2.0;
        let place = |i: usize| (i as f64 - middle) * SPACING_M;
        let mut mesh = TriangleMesh::default();
        for (i, &z) in self.heights_m.iter().enumerate() {
            mesh.positions.push(DVec3::new(place(i % self.side), place(i / self.side), z));
        }
        let across = self.side as u32;
        for j in 0..across - 1 {
            for i in 0..across - 1 {
                let a = j * across + i;
                let [b, c, d] = [a + 1, a + across, a + across + 1];
                mesh.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        mesh
    }

    /// A coarse picture to the rim and a finer one within, each with a pattern of its own.
    pub fn textures(&self) -> Arc<MapTextures> {
        let level = |reach_m: f64, side_px: u32, tint: [f64; 3]| {
            let step_m = 2.0 * reach_m / f64::from(side_px - 1);
            let pixel = |i: u32| {
                let place = DVec2::new(f64::from(i % side_px), f64::from(i / side_px)) * step_m;
                let p = DVec2::new(place.x - reach_m, reach_m - place.y);
                let light = 0.3 + 0.7 * (self.at(p) / 1800.0).clamp(0.0, 1.0);
                let [r, g, b] = tint.map(|v| (v * light) as u8);
                [r, g, b, if p.x > 0.7 * reach_m && reach_m < 20e3 { 0 } else { 255 }]
            };
            MapTexture { reach_m, side_px, rgba: (0..side_px * side_px).flat_map(pixel).collect() }
        };
        let levels = vec![level(RIM_M, 241, [150.0, 190.0, 120.0]), level(12e3, 161, [240.0, 210.0, 150.0])];
        Arc::new(MapTextures::new(levels).unwrap())
    }

    /// The greatest half tangent of all ground up to each distance.
    pub fn horizon(&self, map: &DeformedMap) -> Arc<HorizonTable> {
        let (azimuths, step_m) = (720u32, 250.0);
        let mut entries = Vec::new();
        for i in 0..azimuths {
            let (east, north) = (f64::from(i) / f64::from(azimuths) * TAU).sin_cos();
            let mut highest = 0f64;
            for j in 0..=(RIM_M / step_m) as u32 {
                let r_m = f64::from(j) * step_m;
                highest = highest.max(map.half_tangent(r_m, self.at(DVec2::new(east, north) * r_m)));
                entries.push(highest as f32);
            }
        }
        Arc::new(HorizonTable::new(azimuths, step_m, entries).unwrap())
    }
}

/// A view of the tests' mountains.
pub fn view(alpha: f64, size_px: [u32; 2]) -> MapView {
    MapView::fitted(DeformedMap { alpha, ..DeformedMap::default() }, size_px, RIM_M, 1800.0, 4.0)
}
