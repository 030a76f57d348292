//! The ground that is shown, the front that follows the map, and the texture that the picture is drawn on.

use super::super::target::{FORMAT, Target};
use super::ground::Ground;
use super::settings::Settings;
use eframe::{egui, egui_wgpu};
use glam::DVec3;
use std::sync::Arc;
use std::time::Instant;
use yamanami::core::{DeformedMap, MapFault, MapLine, MapView, NamedPlace, NestedField};
use yamanami::gpu::{Gpu, Hidden, HorizonTable as DrawnHorizon, MapOptions, MapRenderer, MapTextures, Veil, Wireframe};
use yamanami::io::crs::AzimuthalPlane;
use yamanami::map::HorizonTable;
use yamanami::{Canvas, DeformedScene, Error, LimitedBy, MapSource, Upload};

/// What lies beside the map, sRGB.
const BACKGROUND: [u8; 4] = [238, 243, 247, 255];

/// Azimuths of the horizon, and metres from one of its distances to the next.
const HORIZON: (usize, f64) = (1440, 250.0);
/// Hidden ground is drawn this much paler, where it lies so many pixels below its horizon.
const VEIL: Hidden = Hidden::Veiled([226, 230, 234], 0.55);
const VEIL_SLACK_PX: f32 = 3.0;

/// What a frame did.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers {
    pub(super) triangles: usize,
    pub(super) refined: usize,
    pub(super) coarsened: usize,
    /// Largest error left out, pixels.
    pub(super) error_left_px: f32,
    pub(super) update_ms: f64,
    pub(super) upload: Upload,
    pub(super) limited_by: &'static str,
    /// Time to give the picture to the device, milliseconds.
    pub(super) draw_ms: f64,
}

/// What was drawn last, to tell whether it must be drawn again.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Drawn {
    view: MapView,
    tolerance_px: f32,
    budget: Option<u32>,
    veil: bool,
    wireframe: bool,
    antialias: bool,
}

/// The ground and its picture.
pub(super) struct Stage {
    render: egui_wgpu::RenderState,
    gpu: Gpu,
    renderer: MapRenderer,
    scene: DeformedScene,
    textures: Arc<MapTextures>,
    pub(super) plane: AzimuthalPlane,
    pub(super) names: Vec<NamedPlace>,
    pub(super) lines: Vec<MapLine>,
    pub(super) sources: Vec<MapSource>,
    pub(super) top_m: f64,
    /// Counts the grounds shown.
    pub(super) generation: u32,
    /// What hides what, and for which map.
    horizon: Option<(DeformedMap, Arc<HorizonTable>)>,
    /// The same on the device.
    veil: Option<(Arc<HorizonTable>, Veil)>,
    target: Target,
    drawn: Option<Drawn>,
    settled: bool,
}

impl Stage {
    /// Sets ground up on the window's device.
    pub(super) fn new(render: egui_wgpu::RenderState, ground: Ground) -> Self {
        let gpu = Gpu::from_device(render.device.clone(), render.queue.clone());
        Self {
            renderer: MapRenderer::new(&gpu),
            scene: DeformedScene::on_canvas(ground.surface, Canvas::on_gpu(&gpu, DVec3::ZERO)),
            textures: ground.textures,
            plane: ground.plane,
            names: ground.names,
            lines: ground.lines,
            sources: ground.sources,
            top_m: ground.top_m,
            generation: 0,
            horizon: None,
            veil: None,
            target: Target::default(),
            drawn: None,
            settled: false,
            gpu,
            render,
        }
    }

    /// Shows other ground.
    pub(super) fn set_ground(&mut self, ground: Ground) {
        self.scene = DeformedScene::on_canvas(ground.surface, Canvas::on_gpu(&self.gpu, DVec3::ZERO));
        (self.textures, self.plane) = (ground.textures, ground.plane);
        (self.names, self.lines, self.sources) = (ground.names, ground.lines, ground.sources);
        self.top_m = ground.top_m;
        self.generation += 1;
        self.horizon = None;
        (self.drawn, self.settled) = (None, false);
    }

    /// The heights.
    pub(super) fn field(&self) -> &NestedField {
        self.scene.field()
    }

    /// The device in words.
    pub(super) fn device(&self) -> String {
        let info = self.render.adapter.get_info();
        format!("{} ({})", info.name, info.backend)
    }

    /// Longest side of a picture, pixels.
    pub(super) fn longest_side_px(&self) -> u32 {
        self.render.device.limits().max_texture_dimension_2d
    }

    /// Refuses a map that this ground cannot be shown by.
    pub(super) fn check(&self, map: &DeformedMap) -> Result<(), MapFault> {
        if map.exaggeration * self.top_m < map.eye_m { map.check() } else { self.scene.check(map) }
    }

    /// Moves the front and draws it, where anything changed; `None` where nothing did.
    pub(super) fn show(&mut self, view: &MapView, settings: &Settings) -> Result<Option<Numbers>, Error> {
        let drawn = Drawn {
            view: *view,
            tolerance_px: settings.tolerance_px,
            budget: settings.budget(),
            veil: settings.veil,
            wireframe: settings.wireframe,
            antialias: settings.antialias,
        };
        if self.settled && self.drawn == Some(drawn) {
            return Ok(None);
        }
        let update = self.scene.update(view, drawn.tolerance_px, drawn.budget)?;
        let report = &update.report;
        self.settled = report.refined + report.coarsened == 0;
        let started = Instant::now();
        let options = MapOptions {
            textures: Arc::clone(&self.textures),
            wireframe: settings.wireframe.then(Wireframe::default),
            veil: if settings.veil && view.map.alpha > 0.0 { Some(self.veil(view)?) } else { None },
            background: BACKGROUND,
            antialias: settings.antialias,
            ..MapOptions::default()
        };
        let target = self.target.fit(&self.render, view.size_px);
        if let Canvas::Gpu { mesh, .. } = self.scene.canvas() {
            self.renderer.draw(&target, FORMAT, mesh, view, &options)?;
        }
        self.drawn = Some(drawn);
        Ok(Some(Numbers {
            triangles: report.triangles,
            refined: report.refined,
            coarsened: report.coarsened,
            error_left_px: report.error_left,
            update_ms: update.update_time.as_secs_f64() * 1e3,
            upload: update.upload,
            limited_by: match report.limited_by {
                LimitedBy::Tolerance => "tolerance",
                LimitedBy::Budget => "budget",
                LimitedBy::Residency | LimitedBy::Steps => "steps",
            },
            draw_ms: started.elapsed().as_secs_f64() * 1e3,
        }))
    }

    /// How high the ground before each place stands.
    pub(super) fn horizon(&mut self, view: &MapView) -> Arc<HorizonTable> {
        let map = sight(&view.map);
        if let Some((_, table)) = self.horizon.as_ref().filter(|(same, _)| *same == map) {
            return Arc::clone(table);
        }
        let (azimuths, step_m) = HORIZON;
        let table = Arc::new(HorizonTable::new(self.field(), &map, view.rim_m, azimuths, step_m));
        self.horizon = Some((map, Arc::clone(&table)));
        table
    }

    /// The same to draw with.
    fn veil(&mut self, view: &MapView) -> Result<Veil, Error> {
        let table = self.horizon(view);
        if let Some((_, veil)) = self.veil.as_ref().filter(|(same, _)| Arc::ptr_eq(same, &table)) {
            return Ok(veil.clone());
        }
        let on_device = DrawnHorizon::new(table.azimuth_count as u32, table.step_m, table.half_tangents.clone())?;
        let veil = Veil { horizon: Arc::new(on_device), hidden: VEIL, slack_px: VEIL_SLACK_PX };
        self.veil = Some((table, veil.clone()));
        Ok(veil)
    }

    /// Whether the next frame would change nothing by itself.
    pub(super) fn is_settled(&self) -> bool {
        self.settled
    }

    /// The picture for egui, once there is one.
    pub(super) fn texture(&self) -> Option<egui::TextureId> {
        self.target.id()
    }

    /// Ground seen at a place of the picture: in the plane, with its height.
    pub(super) fn pick(&self, view: &MapView, px: glam::DVec2) -> Result<Option<DVec3>, Error> {
        self.scene.pick(view, px)
    }
}

/// Of a map, what decides which ground hides which: neither α nor scale.
pub(super) fn sight(map: &DeformedMap) -> DeformedMap {
    DeformedMap { alpha: 0.0, alpha_fall: 0.0, scale: 1.0, ..*map }
}
