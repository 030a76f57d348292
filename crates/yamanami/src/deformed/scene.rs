//! Ground being shown in a deformed map: the front follows place, projection and picture, and the mesh the front.

use crate::{Canvas, Controller, Criteria, DrawWith, Error, FrameReport, Front, MapCriterion, Step, Upload};
use glam::{DVec2, DVec3};
use std::time::Duration;
use web_time::Instant;
use yamanami_core::{ActiveSet, DeformedMap, MapFault, MapView, NestedField, Sink, Surface, TriangleMesh};
use yamanami_gpu::ResidentBuffers;
use yamanami_gpu::software::map::MapScene;
use yamanami_multires::rtin::{BuildOptions, Rtin};

/// The ground around a place with its hierarchy and what is shown of it.
#[derive(Debug)]
pub struct DeformedScene {
    surface: Rtin,
    controller: Controller,
    canvas: Canvas,
}

/// What an update did and cost.
#[derive(Debug, Clone)]
pub struct MapUpdate {
    /// What the controller did; errors are pixels.
    pub report: FrameReport,
    /// Time to find the new front and bring the mesh in memory to it.
    pub update_time: Duration,
    /// What was written to where it is drawn.
    pub upload: Upload,
}

impl DeformedScene {
    /// Builds the hierarchy of a field; the base mesh is shown.
    pub fn new(field: NestedField, build: &BuildOptions, with: DrawWith) -> Result<Self, Error> {
        Ok(Self::on_canvas(Rtin::build(field, build)?, Canvas::new(DVec3::ZERO, with)?))
    }

    /// The same on a canvas that is there already.
    pub fn on_canvas(surface: Rtin, mut canvas: Canvas) -> Self {
        canvas.clear();
        surface.emit_base(canvas.sink());
        let controller = Controller::new(&surface);
        Self { surface, controller, canvas }
    }

    /// The hierarchy.
    pub fn surface(&self) -> &Rtin {
        &self.surface
    }

    /// The heights.
    pub fn field(&self) -> &NestedField {
        self.surface.field()
    }

    /// What is shown.
    pub fn front(&self) -> &Front {
        self.controller.front()
    }

    /// Where it is drawn.
    pub fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    /// Where it is drawn, to draw it.
    pub fn canvas_mut(&mut self) -> &mut Canvas {
        &mut self.canvas
    }

    /// Refuses a map whose eye does not stand above all ground near its ring.
    pub fn check(&self, map: &DeformedMap) -> Result<(), MapFault> {
        map.check()?;
        // most ground lies lower than the eye anyway
        let may_reach = |z: f32| f64::from(z) * map.exaggeration >= map.eye_m;
        let ground = self.field().levels().iter().flat_map(|level| {
            let width = level.width();
            let heights = level.heights_m().iter().enumerate().filter(move |&(_, &z)| may_reach(z));
            heights.map(move |(k, &z)| level.plane_from_grid(k % width, k / width).extend(f64::from(z)))
        });
        map.check_ground(ground)
    }

    /// Moves the front to what the map asks for, and the mesh with it, by differences.
    pub fn update(&mut self, view: &MapView, tolerance_px: f32, budget: Option<u32>) -> Result<MapUpdate, Error> {
        let criteria = Criteria {
            map: Some(MapCriterion { view: *view, tolerance_px }),
            budget_triangles: budget,
            ..Criteria::default()
        };
        let started = Instant::now();
        let (surface, sink) = (&self.surface, self.canvas.sink());
        let report = self.controller.update(surface, &criteria, |step, front| match step {
            Step::Refine(node) => surface.refine(node, front, sink),
            Step::Coarsen(node) => surface.coarsen(node, front, sink),
        });
        let update_time = started.elapsed();
        Ok(MapUpdate { report, update_time, upload: self.canvas.flush()? })
    }

    /// The mesh of every sample, for comparisons.
    pub fn full_mesh(&self) -> ResidentBuffers {
        let mut buffers = ResidentBuffers::new(DVec3::ZERO);
        self.surface.emit_front(&|_| true, &mut buffers as &mut dyn Sink);
        buffers
    }

    /// Ground seen at a place of the picture (pixels from the left and the top): where it lies in the plane and how high.
    pub fn pick(&self, view: &MapView, px: DVec2) -> Result<Option<DVec3>, Error> {
        let [width, height] = view.size_px;
        if !(px.cmpge(DVec2::ZERO).all() && px.x < f64::from(width) && px.y < f64::from(height)) {
            return Ok(None);
        }
        // the row alone is drawn
        let scene = MapScene::new(self.canvas.buffers(), view)?;
        let (column, row) = (px.x as u32, px.y as u32);
        let seen = scene.ground(row..row + 1).at(column, row);
        Ok(seen.map(|p| {
            let place = DVec2::new(f64::from(p.x_m), f64::from(p.y_m));
            place.extend(self.field().height_m(place))
        }))
    }

    /// How far, in pixels, the picture of a place of this height lies from where the front shows the ground there.
    pub fn error_px_at(&self, view: &MapView, p: DVec3) -> f64 {
        let shown = self.surface.front_at(self.front(), p.truncate());
        let drawn: DVec2 = (0..3).map(|i| shown.weights[i] * view.map.image_from_plane(shown.corners[i])).sum();
        view.ring_px * (view.map.image_from_plane(p) - drawn).length()
    }

    /// The front as a mesh.
    pub fn mesh(&self) -> TriangleMesh {
        self.surface.mesh_of(self.front() as &dyn ActiveSet)
    }
}
