//! The terrain or model, its scene on the window's graphics device, and the texture that the picture is drawn on.

use super::settings::{Colour, Control, Settings};
use super::target::{FORMAT, Target};
use eframe::{egui, egui_wgpu};
use image::RgbaImage;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use yamanami::core::View;
use yamanami::gpu::{Drape, Gpu};
use yamanami::{Canvas, Error, GroundImage, LimitedBy, Scene, Subject, Upload};

/// Most pages read from a database between two frames in rebuild mode.
const PAGES_PER_FRAME: usize = 64;
/// Frames without a change after which the staircase's feedback counts as settled: its thresholds move slowly at the end.
const QUIET_FRAMES: u32 = 8;
/// Longest side and most memory of an image laid over the terrain.
const IMAGE_SIDE_PX: u32 = 1 << 16;
const IMAGE_BYTES: u64 = 1 << 30;

/// What a frame did.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers {
    pub(super) triangles: usize,
    pub(super) changed: usize,
    /// Largest error left out: pixels, metres with the paper's staircase.
    pub(super) error_left: f32,
    pub(super) update_ms: f64,
    pub(super) upload: Upload,
    pub(super) limited_by: &'static str,
    /// Time to give the picture to the device, milliseconds.
    pub(super) draw_ms: f64,
}

/// What was drawn last, to tell whether it must be drawn again.
#[derive(Debug, PartialEq)]
struct Drawn {
    view: View,
    frozen: bool,
    settings: Settings,
    image: u32,
}

/// The scene with its terrain or model and its picture.
pub(super) struct Stage<S> {
    pub(super) subject: S,
    scene: Scene,
    render: egui_wgpu::RenderState,
    target: Target,
    drape: Option<Arc<Drape>>,
    /// Images laid over the terrain so far.
    images: u32,
    drawn: Option<Drawn>,
    /// The view that the front was last fitted to, once it is held.
    frozen: Option<View>,
    threshold_px: Option<f32>,
    /// Frames since the front last changed.
    quiet_frames: u32,
    settled: bool,
}

impl<S: Subject> Stage<S> {
    /// Sets the scene up on the window's device.
    pub(super) fn new(render: egui_wgpu::RenderState, subject: S, settings: &Settings) -> Self {
        let gpu = Gpu::from_device(render.device.clone(), render.queue.clone());
        let mut scene = Scene::new(&subject, Canvas::on_gpu(&gpu, subject.bounds().centre()));
        scene.restart(&subject, &settings.lod(diagonal_m(&subject)));
        Self {
            subject,
            scene,
            render,
            target: Target::default(),
            drape: None,
            images: 0,
            drawn: None,
            frozen: None,
            threshold_px: None,
            quiet_frames: 0,
            settled: false,
        }
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

    /// The thresholds of the paper's staircase as its feedback has moved them.
    pub(super) fn thresholds_m(&self) -> &[f32] {
        self.scene.staircase().map_or(&[], |s| &s.thresholds_m)
    }

    /// The view that the front is held at.
    pub(super) fn frozen(&self) -> Option<&View> {
        self.frozen.as_ref()
    }

    /// Holds the front as it is for `view`, or lets it follow the camera again.
    pub(super) fn freeze(&mut self, view: Option<View>) {
        self.frozen = view;
    }

    /// What may colour the surface, in the order of the panel; an image only where there is one.
    pub(super) fn colours(&self) -> [Colour; 6] {
        if self.subject.is_ground() { Colour::OF_TERRAIN } else { Colour::OF_MODEL }
    }

    /// Whether an image lies over the terrain.
    pub(super) fn has_image(&self) -> bool {
        self.drape.is_some()
    }

    /// Lays an image file over the surface, by its world file or else over the whole of it, north up.
    pub(super) fn lay_image(&mut self, file: &Path) -> Result<(), String> {
        let mut limits = image::Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(IMAGE_SIDE_PX), Some(IMAGE_SIDE_PX));
        limits.max_alloc = Some(IMAGE_BYTES);
        if !self.subject.is_ground() {
            return Err("an image is laid over terrain and TINs; this is a scan".to_owned());
        }
        let image = GroundImage::read(file, Some(limits)).map_err(|error| error.to_string())?;
        if !image.lies_over(&self.subject) {
            return Err(format!("{}: lies nowhere over the surface, by its world file", file.display()));
        }
        self.drape = Some(Arc::new(image.drape(&self.subject)));
        self.images += 1;
        Ok(())
    }

    /// Starts another control from the base mesh where the settings ask for it.
    pub(super) fn restart(&mut self, settings: &Settings) {
        self.scene.restart(&self.subject, &settings.lod(diagonal_m(&self.subject)));
        (self.quiet_frames, self.settled) = (0, false);
    }

    /// Moves the front and draws it, where anything changed; `None` where nothing did.
    pub(super) fn show(&mut self, view: View, settings: &Settings) -> Result<Option<Numbers>, Error> {
        let drawn = Drawn { view, frozen: self.frozen.is_some(), settings: settings.clone(), image: self.images };
        let same = self.drawn.as_ref() == Some(&drawn);
        if same && (self.settled || self.frozen.is_some()) && !settings.rebuild {
            return Ok(None);
        }
        let mut numbers = self.scene_numbers(view, settings)?;
        let started = Instant::now();
        let style =
            settings.style(&self.subject, self.drape.as_ref(), self.threshold_px.filter(|_| self.frozen.is_none()));
        let target = self.target.fit(&self.render, view.viewport_px);
        self.scene.draw_on(&target, FORMAT, &view, &style)?;
        numbers.draw_ms = started.elapsed().as_secs_f64() * 1e3;
        self.drawn = Some(drawn);
        Ok(Some(numbers))
    }

    /// Whether the next frame would change nothing by itself.
    pub(super) fn is_settled(&self) -> bool {
        self.settled || self.frozen.is_some()
    }

    /// The picture for egui, once there is one.
    pub(super) fn texture(&self) -> Option<egui::TextureId> {
        self.target.id()
    }

    /// The picture as it is shown, without what lies over it.
    pub(super) fn picture(&mut self, view: &View, settings: &Settings) -> Result<RgbaImage, Error> {
        let style =
            settings.style(&self.subject, self.drape.as_ref(), self.threshold_px.filter(|_| self.frozen.is_none()));
        self.scene.draw(view, &style)
    }

    /// Fits the front to the view, unless it is held.
    fn scene_numbers(&mut self, view: View, settings: &Settings) -> Result<Numbers, Error> {
        if self.frozen.is_some() {
            return Ok(Numbers {
                triangles: self.scene.front().triangle_count(),
                changed: 0,
                error_left: f32::NAN,
                update_ms: 0.0,
                upload: Upload::default(),
                limited_by: "held",
                draw_ms: 0.0,
            });
        }
        let criteria = settings.criteria(view);
        let update = if settings.rebuild {
            let mut update = self.scene.rebuild(&self.subject, &criteria)?;
            update.pages = self.subject.load(&update.report.wanted, PAGES_PER_FRAME)?;
            update
        } else {
            self.scene.update(&mut self.subject, &criteria)?
        };
        let report = &update.report;
        let changed = report.refined + report.coarsened;
        self.quiet_frames = if changed == 0 && update.pages == 0 { self.quiet_frames.saturating_add(1) } else { 0 };
        let feeds_back = settings.control == Control::Paper && settings.budget_on;
        self.settled = self.quiet_frames >= if feeds_back { QUIET_FRAMES } else { 1 };
        self.threshold_px = (settings.control == Control::Exact).then_some(report.threshold);
        Ok(Numbers {
            triangles: report.triangles,
            changed,
            error_left: report.error_left,
            update_ms: (update.update_time + update.upload_time).as_secs_f64() * 1e3,
            upload: update.upload,
            limited_by: match report.limited_by {
                LimitedBy::Tolerance => "tolerance",
                LimitedBy::Budget => "budget",
                LimitedBy::Residency => "data still to be read",
                LimitedBy::Steps => "step limit",
            },
            draw_ms: 0.0,
        })
    }
}

/// The diagonal in plan.
fn diagonal_m(subject: &impl Subject) -> f64 {
    let bounds = subject.bounds();
    (bounds.max - bounds.min).truncate().length()
}
