//! A surface in perspective: its camera, its front and what is wanted of its pages.

use crate::feed::Feed;
use crate::settings::{Control, Settings};
use crate::stream::{Arrived, Item};
use glam::{DVec2, DVec3};
use yamanami::core::{ActiveSet, NodeId, View};
use yamanami::gpu::RenderOptions;
use yamanami::steer::{Ground, Rig, ray_through};
use yamanami::{Canvas, Error, LimitedBy, Scene, Subject, overview};

/// Frames without a change after which the staircase's feedback counts as settled.
const QUIET_FRAMES: u32 = 8;

/// What an update did.
#[derive(Debug, Clone, Default, serde::Serialize)]
pub(crate) struct Numbers {
    pub(crate) triangles: usize,
    pub(crate) refined: usize,
    pub(crate) coarsened: usize,
    pub(crate) error_left: f32,
    pub(crate) unit: &'static str,
    pub(crate) limited_by: &'static str,
    pub(crate) update_ms: f64,
    pub(crate) draw_ms: f64,
    pub(crate) upload_bytes: u64,
    pub(crate) pages: usize,
    pub(crate) thresholds_m: Vec<f32>,
    /// What the deformed map cannot be, if so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fault: Option<String>,
}

/// The stage.
#[derive(Debug)]
pub(crate) struct Stage<F: Feed> {
    pub(crate) subject: F::Subject,
    pub(crate) feed: F,
    scene: Scene,
    pub(crate) rig: Rig,
    wanted: Vec<NodeId>,
    /// What the front was last fitted to.
    fitted: Option<(View, Settings)>,
    quiet_frames: u32,
    threshold_px: Option<f32>,
    pub(crate) numbers: Numbers,
}

impl<F: Feed> Stage<F> {
    /// Shows the base mesh.
    pub(crate) fn new(subject: F::Subject, feed: F, canvas: Canvas, settings: &Settings, size_px: [u32; 2]) -> Self {
        let rig = Rig::new(overview(&subject, size_px));
        let mut scene = Scene::new(&subject, canvas);
        scene.restart(&subject, &settings.lod(diagonal_m(&subject)));
        let (wanted, fitted, quiet_frames, threshold_px, numbers) = Default::default();
        Self { subject, feed, scene, rig, wanted, fitted, quiet_frames, threshold_px, numbers }
    }

    /// Takes rows that came; what was wrong with one of them.
    pub(crate) fn take(&mut self, arrived: Vec<Arrived>) -> Option<String> {
        let taken = self.feed.take(&mut self.subject, arrived);
        if taken.pages > 0 {
            self.fitted = None;
            self.numbers.pages += taken.pages;
        }
        taken.damage
    }

    /// Rows that the front waits for.
    pub(crate) fn rows(&self) -> Vec<Item> {
        self.feed.rows(&self.subject, &self.wanted)
    }

    /// Goes back to the base mesh under another control.
    pub(crate) fn restart(&mut self, settings: &Settings) {
        self.scene.restart(&self.subject, &settings.lod(diagonal_m(&self.subject)));
        self.fitted = None;
    }

    /// Moves the camera on and the front to where it looks; whether anything changed.
    pub(crate) fn update(&mut self, settings: &Settings, size_px: [u32; 2], dt_s: f64) -> Result<bool, Error> {
        self.rig.step(dt_s, &Ground::of(&self.subject));
        let view = self.rig.view(size_px);
        let now = (view, settings.clone());
        let same = self.fitted.as_ref() == Some(&now);
        let feeds_back = settings.control == Control::Paper && settings.budget.is_some();
        if same && self.quiet_frames >= if feeds_back { QUIET_FRAMES } else { 1 } {
            return Ok(false);
        }
        let criteria = settings.criteria(view);
        let update = if settings.rebuild {
            self.scene.rebuild(&self.subject, &criteria)?
        } else {
            self.scene.update(&mut self.subject, &criteria)?
        };
        let front = self.scene.front();
        let memory_bytes = self.scene.memory_bytes;
        self.subject.shrink(memory_bytes, |node| front.is_active(node));
        let report = update.report;
        let is_quiet = report.refined + report.coarsened == 0;
        self.quiet_frames = if is_quiet && same { self.quiet_frames.saturating_add(1) } else { 0 };
        self.threshold_px = (settings.control == Control::Exact).then_some(report.threshold);
        self.numbers = Numbers {
            triangles: report.triangles,
            refined: report.refined,
            coarsened: report.coarsened,
            error_left: report.error_left,
            unit: if settings.control == Control::Exact { "px" } else { "m" },
            limited_by: match report.limited_by {
                LimitedBy::Tolerance => "tolerance",
                LimitedBy::Budget => "budget",
                LimitedBy::Residency => "residency",
                LimitedBy::Steps => "steps",
            },
            update_ms: update.update_time.as_secs_f64() * 1e3,
            draw_ms: 0.0,
            upload_bytes: update.upload.bytes,
            pages: self.numbers.pages,
            thresholds_m: self.scene.staircase().map_or_else(Vec::new, |s| s.thresholds_m.clone()),
            fault: None,
        };
        self.wanted = report.wanted;
        self.fitted = Some(now);
        Ok(true)
    }

    /// Whether the next frame changes something by itself.
    pub(crate) fn is_moving(&self) -> bool {
        self.rig.is_moving() || self.fitted.is_none() || self.quiet_frames == 0
    }

    /// Most bytes of pages kept.
    pub(crate) fn set_memory(&mut self, bytes: usize) {
        self.scene.memory_bytes = bytes;
    }

    /// What is drawn, to draw it.
    pub(crate) fn scene_mut(&mut self) -> &mut Scene {
        &mut self.scene
    }

    /// What is drawn.
    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// How it is drawn.
    pub(crate) fn style(&self, settings: &Settings) -> RenderOptions {
        settings.style(&self.subject, self.threshold_px)
    }

    /// The first place of the surface behind a pixel.
    pub(crate) fn hit(&self, view: &View, px: DVec2) -> Option<DVec3> {
        let direction = ray_through(view, px.to_array());
        if self.subject.as_terrain().is_some() {
            let ground = Ground::of(&self.subject);
            return ground.hit(view.eye, direction).filter(|p| ground.holds(p.truncate()));
        }
        crate::pick::hit_mesh(self.scene.canvas().buffers(), view.eye, direction).map(|hit| hit.place)
    }
}

/// The diagonal in plan.
fn diagonal_m(subject: &impl Subject) -> f64 {
    let bounds = subject.bounds();
    (bounds.max - bounds.min).truncate().length()
}
