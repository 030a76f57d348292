//! The deformed map of a terrain around a place of it: heights read from pages as they come, then shown by a front.

use crate::settings::Settings;
use crate::stage::Numbers;
use glam::{DVec2, DVec3};
use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex, PoisonError};
use yamanami::core::{DeformedMap, MapView, PageId, TerrainPage};
use yamanami::gpu::{Gpu, Hidden, HorizonTable as DrawnHorizon, MapOptions, MapRenderer, MapTextures, Veil, Wireframe};
use yamanami::io::crs::AzimuthalPlane;
use yamanami::io::store::TerrainMeta;
use yamanami::map::{HorizonTable, ReliefStyle, paint};
use yamanami::multires::rtin::{BuildOptions, Rtin};
use yamanami::steer::Pose;
use yamanami::{BaseOptions, Canvas, DeformedScene, Error, LimitedBy, MapGroundOptions, MapSources, NoData};

/// Samples of the widest grid from the centre to the rim.
const SAMPLES: f64 = 448.0;
/// More ground than the map shows is read, so that it can be moved some way.
const REACH: f64 = 1.2;
/// The ground is read again once the centre has moved by this share of the map's radius.
const MOVED_SHARE: f64 = 0.15;
/// What lies beside the map, sRGB.
const BACKGROUND: [u8; 4] = [238, 243, 247, 255];
/// Azimuths of the horizon, and steps of its distances.
const HORIZON: (usize, f64) = (720, 400.0);
/// Hidden ground is drawn this much paler, where it lies so many pixels below its horizon.
const VEIL: (Hidden, f32) = (Hidden::Veiled([226, 230, 234], 0.55), 3.0);

/// Ground around a place, to be read.
#[derive(Debug)]
pub(crate) struct MapReading {
    options: MapGroundOptions,
}

/// What reading came to.
pub(crate) enum Read {
    /// These pages must come first.
    Missing(BTreeSet<PageId>),
    /// The map.
    Ready(Box<MapStage>),
}

type Pages = HashMap<PageId, Arc<TerrainPage>>;

impl MapReading {
    /// Around a longitude and latitude.
    pub(crate) fn new(centre_lon_lat: [f64; 2], radius_km: f64, finest_m: f64) -> Self {
        let radius_m = REACH * 1e3 * radius_km;
        let spacing_m = radius_m / SAMPLES;
        let options = MapGroundOptions {
            centre_lon_lat,
            radius_m,
            spacing_m,
            // no finer than a sixteenth: near the centre a pixel shows no more
            finest_spacing_m: finest_m.max(spacing_m / 16.0).min(spacing_m),
            no_data: NoData::Hole,
        };
        Self { options }
    }

    /// Reads what is at hand; `page` gives a page that has come, and `is_lost` those that never will.
    pub(crate) fn read(
        &self,
        meta: &TerrainMeta,
        pages: Pages,
        is_lost: impl Fn(PageId) -> bool,
        gpu: Option<&Gpu>,
    ) -> Result<Read, Error> {
        let missing = Arc::new(Mutex::new(BTreeSet::new()));
        let noted = Arc::clone(&missing);
        let at_hand = move |id: PageId| {
            let page = pages.get(&id).cloned();
            if page.is_none() {
                noted.lock().unwrap_or_else(PoisonError::into_inner).insert(id);
            }
            page
        };
        let read = MapSources::of_pages(meta, Arc::new(at_hand)).read(&self.options);
        let missing: BTreeSet<PageId> =
            missing.lock().unwrap_or_else(PoisonError::into_inner).iter().copied().filter(|&id| !is_lost(id)).collect();
        if !missing.is_empty() {
            return Ok(Read::Missing(missing));
        }
        let ground = read?;
        let top_m = ground.field.range_m()[1];
        let relief = ReliefStyle::default().stretched_to(top_m);
        let textures = BaseOptions::painted(paint(&ground.field, &relief, DVec2::ZERO))?.textures;
        let surface = Rtin::build(ground.field, &BuildOptions::default())?;
        let canvas = match gpu {
            Some(gpu) => Canvas::on_gpu(gpu, DVec3::ZERO),
            None => Canvas::new(DVec3::ZERO, yamanami::DrawWith::Software)?,
        };
        Ok(Read::Ready(Box::new(MapStage {
            scene: DeformedScene::on_canvas(surface, canvas),
            renderer: gpu.map(MapRenderer::new),
            textures,
            plane: ground.plane,
            pose: Pose::new(0.0),
            top_m: f64::from(top_m),
            veil: None,
            fitted: None,
            is_settled: false,
            numbers: Numbers::default(),
        })))
    }
}

/// A deformed map being shown.
pub(crate) struct MapStage {
    scene: DeformedScene,
    renderer: Option<MapRenderer>,
    textures: Arc<MapTextures>,
    pub(crate) plane: AzimuthalPlane,
    pub(crate) pose: Pose,
    top_m: f64,
    veil: Option<(DeformedMap, Veil)>,
    fitted: Option<(MapView, Settings)>,
    is_settled: bool,
    pub(crate) numbers: Numbers,
}

impl std::fmt::Debug for MapStage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MapStage").field("pose", &self.pose).field("numbers", &self.numbers).finish_non_exhaustive()
    }
}

impl MapStage {
    /// The picture that the settings ask for.
    pub(crate) fn view(&self, settings: &Settings, size_px: [u32; 2]) -> MapView {
        let map = DeformedMap { centre: self.pose.centre, ..settings.deformed() };
        self.pose.view(map, size_px, 1e3 * settings.map.radius_km, self.top_m)
    }

    /// Where ground must be read again, the map having been moved so far.
    pub(crate) fn outgrown(&self, settings: &Settings) -> Option<[f64; 2]> {
        let far_m = MOVED_SHARE * 1e3 * settings.map.radius_km;
        (self.pose.centre.length() > far_m).then(|| self.plane.to_lon_lat(self.pose.centre))
    }

    /// Moves the front to where the map is; whether anything changed.
    pub(crate) fn update(&mut self, settings: &Settings, size_px: [u32; 2]) -> Result<bool, Error> {
        let view = self.view(settings, size_px);
        let now = (view, settings.clone());
        if self.is_settled && self.fitted.as_ref() == Some(&now) {
            return Ok(false);
        }
        self.fitted = Some(now);
        if let Err(fault) = self.scene.check(&view.map) {
            // what was shown stays, with the reason
            (self.is_settled, self.numbers.fault) = (true, Some(fault.to_string()));
            return Ok(false);
        }
        let update = self.scene.update(&view, settings.tolerance_px, settings.budget)?;
        let report = update.report;
        self.is_settled = report.refined + report.coarsened == 0;
        self.numbers = Numbers {
            triangles: report.triangles,
            refined: report.refined,
            coarsened: report.coarsened,
            error_left: report.error_left,
            unit: "px",
            limited_by: if report.limited_by == LimitedBy::Budget { "budget" } else { "tolerance" },
            update_ms: update.update_time.as_secs_f64() * 1e3,
            upload_bytes: update.upload.bytes,
            ..Numbers::default()
        };
        Ok(true)
    }

    /// Whether the next frame changes something by itself.
    pub(crate) fn is_moving(&self) -> bool {
        !self.is_settled
    }

    /// Draws the map on a texture.
    pub(crate) fn draw_on(
        &mut self,
        target: &yamanami::gpu::wgpu::TextureView,
        format: yamanami::gpu::wgpu::TextureFormat,
        settings: &Settings,
        size_px: [u32; 2],
    ) -> Result<(), Error> {
        let view = self.view(settings, size_px);
        let options = self.style(settings, &view)?;
        if let (Some(renderer), Canvas::Gpu { mesh, .. }) = (&mut self.renderer, self.scene.canvas()) {
            renderer.draw(target, format, mesh, &view, &options)?;
        }
        Ok(())
    }

    fn style(&mut self, settings: &Settings, view: &MapView) -> Result<MapOptions, Error> {
        let veil = if settings.map.veil && view.map.alpha > 0.0 { Some(self.veil(view)?) } else { None };
        Ok(MapOptions {
            textures: Arc::clone(&self.textures),
            wireframe: settings.wireframe.then(Wireframe::default),
            veil,
            background: BACKGROUND,
            antialias: settings.antialias,
            ..MapOptions::default()
        })
    }

    /// What hides what, kept while only α and the scale change.
    fn veil(&mut self, view: &MapView) -> Result<Veil, Error> {
        let sight = DeformedMap { alpha: 0.0, alpha_fall: 0.0, scale: 1.0, ..view.map };
        if let Some((_, veil)) = self.veil.as_ref().filter(|(same, _)| *same == sight) {
            return Ok(veil.clone());
        }
        let (azimuths, step_m) = HORIZON;
        let table = HorizonTable::new(self.scene.field(), &sight, view.rim_m, azimuths, step_m);
        let drawn = DrawnHorizon::new(table.azimuth_count as u32, table.step_m, table.half_tangents)?;
        let veil = Veil { horizon: Arc::new(drawn), hidden: VEIL.0, slack_px: VEIL.1 };
        self.veil = Some((sight, veil.clone()));
        Ok(veil)
    }

    /// The ground at a pixel: place in the plane, height and upward normal.
    pub(crate) fn pick(&self, settings: &Settings, size_px: [u32; 2], px: DVec2) -> Option<(DVec3, DVec3)> {
        let place = self.scene.pick(&self.view(settings, size_px), px).ok().flatten()?;
        let spacing_m = self.scene.field().level_at(place.truncate()).spacing_m();
        let at = |dx: f64, dy: f64| self.scene.field().height_m(place.truncate() + DVec2::new(dx, dy) * spacing_m);
        let normal = DVec3::new(at(-0.5, 0.0) - at(0.5, 0.0), at(0.0, -0.5) - at(0.0, 0.5), spacing_m).normalize();
        Some((place, normal))
    }

    /// Height of the ground of the map, metres.
    pub(crate) fn height_m(&self, place: DVec2) -> f64 {
        self.scene.field().height_m(place)
    }
}
