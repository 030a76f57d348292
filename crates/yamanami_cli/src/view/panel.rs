//! The side panel: what the terrain is, what the frames cost, and every control.

use super::plots::{History, Label, short};
use super::settings::{Colour, Control, Settings};
use super::stage::{Numbers, Stage};
use eframe::egui::{self, Slider, SliderClamping, Ui};
use std::ops::RangeInclusive;
use yamanami::Subject;
use yamanami::steer::{Mode, Rig};

/// What a button or a key asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    Reset,
    ChangeMode,
    Freeze,
    Record,
    Replay,
    SavePath,
    Orbit,
    ValleyRun,
    Picture,
    Help,
    Panel,
}

/// The running numbers.
#[derive(Debug, Clone, Default)]
pub(super) struct Plots {
    triangles: History,
    error: History,
    update_ms: History,
    bytes: History,
    frame_ms: History,
}

/// What the panel tells of.
pub(super) struct Shown<'a, S> {
    pub(super) stage: &'a Stage<S>,
    pub(super) plots: &'a Plots,
    pub(super) last: Option<Numbers>,
    /// What is known of the water.
    pub(super) water: String,
    /// Views taken down so far, while recording.
    pub(super) recording: Option<usize>,
    /// Share behind, while replaying.
    pub(super) replaying: Option<f32>,
    pub(super) has_path: bool,
}

impl Plots {
    /// Adds a frame; the time since the last one counts where frames follow each other.
    pub(super) fn push(&mut self, numbers: &Numbers, frame_s: Option<f64>) {
        self.triangles.push(numbers.triangles as f64);
        self.error.push(f64::from(numbers.error_left));
        self.update_ms.push(numbers.update_ms);
        self.bytes.push(numbers.upload.bytes as f64);
        self.frame_ms.push(frame_s.map_or(f64::NAN, |s| s * 1e3));
    }

    fn show(&self, ui: &mut Ui, settings: &Settings) {
        let budget = settings.budget_on.then_some(f64::from(settings.budget_triangles));
        let exact = settings.control == Control::Exact;
        let label = |name, unit, hint| Label { name, unit, hint };
        self.triangles.show(ui, label("triangles", "", "Triangles shown; the line is the budget"), budget);
        let hint = "Largest error left out. Exact: on the screen; staircase: its highest threshold";
        let limit = exact.then_some(f64::from(settings.tolerance_px));
        self.error.show(ui, label("error left", if exact { " px" } else { " m" }, hint), limit);
        let hint = "Finding the front, changing the mesh, and writing the change";
        self.update_ms.show(ui, label("update", " ms", hint), None);
        self.bytes.show(ui, label("written", " B", "Bytes written to the graphics device a frame"), None);
        let name = match self.frame_ms.mean(30) {
            Some(ms) if ms > 0.0 => format!("frame ({:.0} a second)", 1e3 / ms),
            _ => "frame".to_owned(),
        };
        self.frame_ms.show(ui, Label { name: &name, unit: " ms", hint: "From one picture to the next" }, None);
    }
}

/// Shows the panel and gives what was asked for.
pub(super) fn show(
    ui: &mut Ui,
    shown: &Shown<'_, impl Subject>,
    settings: &mut Settings,
    rig: &mut Rig,
) -> Option<Action> {
    let mut action = None;
    egui::ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        ui.spacing_mut().slider_width = 108.0;
        header(ui, shown);
        section(ui, "Frames", |ui| shown.plots.show(ui, settings));
        section(ui, "How fine", |ui| fineness(ui, shown, settings));
        section(ui, "Front", |ui| front(ui, shown, settings, &mut action));
        section(ui, "Looks", |ui| looks(ui, shown.stage, settings));
        section(ui, "Water", |ui| water(ui, shown, settings));
        section(ui, "Camera and paths", |ui| camera(ui, shown, rig, &mut action));
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            button(ui, true, "Picture (P)", Action::Picture, &mut action);
            button(ui, true, "Help (H)", Action::Help, &mut action);
        });
    });
    action
}

fn section(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(egui::RichText::new(title).strong()).default_open(true).show_unindented(ui, content);
}

fn header(ui: &mut Ui, shown: &Shown<'_, impl Subject>) {
    let subject = &shown.stage.subject;
    ui.heading(subject.title());
    ui.label(what_it_is(subject));
    if let Some(last) = &shown.last {
        let bound = format!("{} triangles, bound by {}", short(last.triangles as f64), last.limited_by);
        ui.label(bound).on_hover_text(format!(
            "{} nodes changed, {} writes, {:.2} ms to hand the picture over",
            last.changed, last.upload.writes, last.draw_ms
        ));
    }
    ui.small(shown.stage.device());
}

/// Size, extent, range and CRS of a terrain; faces and size of a model.
fn what_it_is(subject: &impl Subject) -> String {
    let Some(terrain) = subject.as_terrain() else {
        let size = (subject.bounds().max - subject.bounds().min).to_array().map(crate::text::number);
        return format!("{} faces\n{}", crate::text::count(subject.full_triangles()), size.join(" x "));
    };
    let [columns, rows] = terrain.size();
    let [east_m, north_m] = terrain.extent_m();
    let [low_m, high_m] = terrain.range_m();
    let length = |m: f64| if m >= 10_000.0 { format!("{:.1} km", m / 1e3) } else { format!("{m:.0} m") };
    let crs = &terrain.geo().crs;
    let crs = match (crs.epsg, crs.name.is_empty()) {
        (Some(epsg), false) => format!("{} (EPSG:{epsg})", crs.name),
        (Some(epsg), true) => format!("EPSG:{epsg}"),
        (None, false) => crs.name.clone(),
        (None, true) => "no CRS".to_owned(),
    };
    format!("{columns} x {rows} samples, {} x {}\n{low_m:.0} to {high_m:.0} m\n{crs}", length(east_m), length(north_m))
}

/// A logarithmic slider that reaches down to 0.
fn log_slider<'a>(value: &'a mut f32, range: RangeInclusive<f32>, least: f64, suffix: &'a str) -> Slider<'a> {
    Slider::new(value, range).logarithmic(true).smallest_positive(least).suffix(suffix).clamping(SliderClamping::Edits)
}

fn fineness(ui: &mut Ui, shown: &Shown<'_, impl Subject>, settings: &mut Settings) {
    ui.horizontal(|ui| {
        ui.radio_value(&mut settings.control, Control::Exact, "exact")
            .on_hover_text("Largest error first; the budget is met in the same frame");
        ui.radio_value(&mut settings.control, Control::Paper, "paper's staircase")
            .on_hover_text("Thresholds by distance, steered towards the budget from frame to frame");
    });
    let exact = settings.control == Control::Exact;
    ui.add(log_slider(&mut settings.tolerance_m, 0.0..=500.0, 0.01, " m").text("tolerance"));
    if exact {
        ui.add(log_slider(&mut settings.tolerance_px, 0.0..=50.0, 0.05, " px").text("on screen"));
    } else {
        ui.add(Slider::new(&mut settings.intervals, 1..=16).clamping(SliderClamping::Edits).text("intervals"));
        ui.add(Slider::new(&mut settings.gain, 0.05..=1.5).clamping(SliderClamping::Edits).text("gain"));
        let thresholds = shown.stage.thresholds_m().iter().map(|&f| short(f64::from(f))).collect::<Vec<_>>();
        ui.small(format!("f(l): {} m", thresholds.join(" | ")));
    }
    ui.horizontal(|ui| {
        ui.checkbox(&mut settings.budget_on, "");
        ui.add_enabled(
            settings.budget_on,
            Slider::new(&mut settings.budget_triangles, 100..=20_000_000)
                .logarithmic(true)
                .clamping(SliderClamping::Edits)
                .text("budget"),
        );
    });
    if exact {
        ui.add(Slider::new(&mut settings.hysteresis, 0.0..=0.5).clamping(SliderClamping::Edits).text("hysteresis"));
        ui.horizontal(|ui| {
            ui.checkbox(&mut settings.steps_on, "");
            ui.add_enabled(
                settings.steps_on,
                Slider::new(&mut settings.max_steps, 10..=100_000)
                    .logarithmic(true)
                    .clamping(SliderClamping::Edits)
                    .text("steps a frame"),
            );
        });
    }
}

fn front(ui: &mut Ui, shown: &Shown<'_, impl Subject>, settings: &mut Settings, action: &mut Option<Action>) {
    ui.horizontal(|ui| {
        ui.radio_value(&mut settings.rebuild, false, "differences")
            .on_hover_text("Only what changed is written to the graphics device");
        ui.radio_value(&mut settings.rebuild, true, "rebuild")
            .on_hover_text("Everything is meshed and written anew each frame, for comparison");
    });
    ui.horizontal(|ui| {
        ui.checkbox(&mut settings.cull, "culling").on_hover_text("What lies outside the view stays coarse");
        let exact = settings.control == Control::Exact;
        ui.add_enabled(exact, egui::Checkbox::new(&mut settings.morph, "geomorph"))
            .on_hover_text("Details fade in, so that nothing pops");
    });
    let mut held = shown.stage.frozen().is_some();
    if ui
        .checkbox(&mut held, "hold the front (Z)")
        .on_hover_text("The camera goes on; the front stays as it is for the view drawn in yellow")
        .clicked()
    {
        *action = Some(Action::Freeze);
    }
}

fn looks(ui: &mut Ui, stage: &Stage<impl Subject>, settings: &mut Settings) {
    for row in stage.colours().chunks(3) {
        ui.horizontal(|ui| {
            for &colour in row {
                ui.add_enabled_ui(colour != Colour::Image || stage.has_image(), |ui| {
                    ui.selectable_value(&mut settings.colour, colour, colour.name())
                        .on_disabled_hover_text("Drop an image file on the window");
                });
            }
        });
    }
    ui.horizontal(|ui| {
        ui.checkbox(&mut settings.wireframe, "edges");
        ui.checkbox(&mut settings.haze, "haze");
        ui.checkbox(&mut settings.antialias, "antialias");
    });
    let light = &mut settings.light;
    let mut azimuth_deg = light.sun_azimuth_rad.to_degrees().round();
    if ui.add(Slider::new(&mut azimuth_deg, 0.0..=360.0).suffix("°").step_by(1.0).text("sun from")).changed() {
        light.sun_azimuth_rad = azimuth_deg.to_radians();
    }
    let mut altitude_deg = light.sun_altitude_rad.to_degrees().round();
    if ui.add(Slider::new(&mut altitude_deg, 5.0..=90.0).suffix("°").step_by(1.0).text("sun height")).changed() {
        light.sun_altitude_rad = altitude_deg.to_radians();
    }
    ui.add(Slider::new(&mut light.strength, 0.0..=4.0).clamping(SliderClamping::Edits).text("shading"));
    ui.checkbox(&mut light.multi_directional, "side lights");
}

fn water(ui: &mut Ui, shown: &Shown<'_, impl Subject>, settings: &mut Settings) {
    let bounds = shown.stage.subject.bounds();
    ui.horizontal(|ui| {
        ui.checkbox(&mut settings.water_on, "");
        ui.add_enabled(
            settings.water_on,
            Slider::new(&mut settings.water_m, bounds.min.z..=bounds.max.z)
                .suffix(" m")
                .max_decimals(2)
                .clamping(SliderClamping::Never)
                .text("water level"),
        )
        .on_hover_text("Area and volume below the level are measured on all triangles when the slider is let go");
    });
    if !shown.water.is_empty() {
        ui.label(&shown.water);
    }
}

fn camera(ui: &mut Ui, shown: &Shown<'_, impl Subject>, rig: &mut Rig, action: &mut Option<Action>) {
    let mut fov_deg = rig.fov_y_rad.to_degrees();
    if ui.add(Slider::new(&mut fov_deg, 10.0..=100.0).suffix("°").fixed_decimals(0).text("field of view")).changed() {
        rig.fov_y_rad = fov_deg.to_radians();
    }
    ui.horizontal(|ui| {
        let change = if rig.mode() == Mode::Orbit { "Fly (F)" } else { "Orbit (F)" };
        button(ui, true, change, Action::ChangeMode, action);
        button(ui, true, "Reset (R)", Action::Reset, action);
    });
    ui.horizontal(|ui| {
        let record = shown.recording.map_or("Record (T)".to_owned(), |views| format!("Stop: {views} views"));
        button(ui, true, &record, Action::Record, action);
        let replay = shown.replaying.map_or("Replay (Y)".to_owned(), |share| format!("Stop: {:.0} %", share * 100.0));
        button(ui, shown.has_path || shown.replaying.is_some(), &replay, Action::Replay, action);
        button(ui, shown.has_path, "Save path", Action::SavePath, action);
    });
    ui.horizontal(|ui| {
        button(ui, true, "Fly around", Action::Orbit, action);
        let is_terrain = shown.stage.subject.as_terrain().is_some();
        button(ui, is_terrain, "Fly the valleys", Action::ValleyRun, action);
    });
}

fn button(ui: &mut Ui, enabled: bool, text: &str, asks: Action, action: &mut Option<Action>) {
    if ui.add_enabled(enabled, egui::Button::new(text)).clicked() {
        *action = Some(asks);
    }
}
