//! The side panel: what the map shows, what the frames cost, and every control.

use super::super::plots::{History, Label, short};
use super::settings::Settings;
use super::stage::{Numbers, Stage};
use eframe::egui::{self, Slider, SliderClamping, Ui};
use yamanami::core::{DropFrom, MapFault, MapView};
use yamanami::steer::Pose;

/// Colour of what is wrong.
const WARNING: egui::Color32 = egui::Color32::from_rgb(238, 150, 84);

/// What a button or a key asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    Fit,
    NorthUp,
    Home,
    Help,
    Panel,
}

/// The running numbers.
#[derive(Debug, Clone, Default)]
pub(super) struct Plots {
    triangles: History,
    error_px: History,
    update_ms: History,
    bytes: History,
    draw_ms: History,
    frame_ms: History,
}

/// What the panel tells of.
pub(super) struct Shown<'a> {
    pub(super) stage: &'a Stage,
    pub(super) plots: &'a Plots,
    pub(super) last: Option<Numbers>,
    pub(super) view: Option<&'a MapView>,
    /// Why the map is not the one asked for.
    pub(super) fault: Option<&'a MapFault>,
    pub(super) is_reading: bool,
}

impl Plots {
    /// Adds a frame; the time since the last one counts where frames follow each other.
    pub(super) fn push(&mut self, numbers: &Numbers, frame_s: Option<f64>) {
        self.triangles.push(numbers.triangles as f64);
        self.error_px.push(f64::from(numbers.error_left_px));
        self.update_ms.push(numbers.update_ms);
        self.bytes.push(numbers.upload.bytes as f64);
        self.draw_ms.push(numbers.draw_ms);
        self.frame_ms.push(frame_s.map_or(f64::NAN, |s| s * 1e3));
    }

    fn show(&self, ui: &mut Ui, settings: &Settings) {
        let label = |name, unit, hint| Label { name, unit, hint };
        let budget = settings.budget().map(f64::from);
        let rate = match self.frame_ms.mean(30) {
            Some(ms) if ms > 0.0 => format!("frame ({:.0}/s)", 1e3 / ms),
            _ => "frame".to_owned(),
        };
        let tolerance = Some(f64::from(settings.tolerance_px));
        ui.columns(2, |columns| {
            let [left, right] = columns else { return };
            let hint = "Triangles shown; the line is the budget";
            self.triangles.show(left, label("triangles", "", hint), budget);
            let hint = "No ground is drawn further from its place than this; the line is the tolerance";
            self.error_px.show(right, label("error left", " px", hint), tolerance);
            self.update_ms.show(left, label("update", " ms", "Finding the front and changing the mesh"), None);
            self.bytes.show(right, label("written", " B", "Bytes written to the graphics device a frame"), None);
            self.draw_ms.show(left, label("draw", " ms", "Giving the picture to the graphics device"), None);
            self.frame_ms.show(right, label(&rate, " ms", "From one picture to the next"), None);
        });
    }
}

/// Shows the panel and gives what was asked for.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, settings: &mut Settings, pose: &mut Pose) -> Option<Action> {
    let mut action = None;
    egui::ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        ui.spacing_mut().slider_width = 108.0;
        header(ui, shown);
        section(ui, "Projection", |ui| projection(ui, shown.fault, settings));
        section(ui, "How fine", |ui| fineness(ui, settings));
        section(ui, "Shown", |ui| what_is_shown(ui, shown, settings));
        section(ui, "Picture", |ui| picture(ui, shown, pose, &mut action));
        section(ui, "Frames", |ui| shown.plots.show(ui, settings));
    });
    action
}

fn section(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(egui::RichText::new(title).strong()).default_open(true).show_unindented(ui, content);
}

fn header(ui: &mut Ui, shown: &Shown<'_>) {
    let stage = shown.stage;
    let centre = shown.view.map_or(glam::DVec2::ZERO, |view| view.map.centre);
    let [lon, lat] = stage.plane.to_lon_lat(centre);
    ui.heading(format!("{lat:.4}, {lon:.4}"));
    if let Some(view) = shown.view {
        ui.label(format!("{:.0} km around, heights to {:.0} m", view.rim_m / 1e3, stage.top_m));
    }
    if let Some(last) = &shown.last {
        let line = format!("{} triangles, bound by {}", short(last.triangles as f64), last.limited_by);
        ui.label(line).on_hover_text(format!(
            "{} refined, {} coarsened, {} writes",
            last.refined, last.coarsened, last.upload.writes
        ));
    }
    for source in stage.sources.iter().take(4) {
        let name = source.path.file_name().unwrap_or_default().to_string_lossy();
        let label = ui.small(format!("{name}: {:.0} %", 100.0 * source.share));
        label.on_hover_text(format!("{}\n{:.0} m between samples", source.path.display(), source.spacing_m));
    }
    ui.small(stage.device());
    let state = if shown.is_reading { "Reading the ground around here…" } else { "" };
    ui.small(state);
}

/// A slider over all that makes sense, that takes more by typing.
fn slider<'a>(value: &'a mut f64, range: std::ops::RangeInclusive<f64>, text: &'a str) -> Slider<'a> {
    Slider::new(value, range).clamping(SliderClamping::Edits).text(text)
}

fn projection(ui: &mut Ui, fault: Option<&MapFault>, settings: &mut Settings) {
    ui.horizontal(|ui| {
        ui.add(slider(&mut settings.alpha, 0.0..=1.0, "alpha").fixed_decimals(3))
            .on_hover_text("Share of the plane beyond the ring: 0 a panorama, 1 a map");
        ui.toggle_value(&mut settings.sweep, "~").on_hover_text("Alpha goes up and down by itself");
    });
    ui.add(slider(&mut settings.alpha_fall, 0.0..=4.0, "fall"))
        .on_hover_text("How fast alpha falls with distance: as (D_R / r)^p");
    ui.add(slider(&mut settings.ring_km, 1.0..=100.0, "ring").logarithmic(true).suffix(" km"))
        .on_hover_text("Radius of the plain map in the middle, D_R");
    ui.add(slider(&mut settings.eye_m, 500.0..=30_000.0, "eye").logarithmic(true).suffix(" m").fixed_decimals(0))
        .on_hover_text("Height above sea of the eyes that stand over the ring, above all ground near it");
    ui.add(slider(&mut settings.exaggeration, 0.5..=5.0, "heights ×").logarithmic(true).fixed_decimals(2))
        .on_hover_text("Vertical exaggeration");
    ui.horizontal(|ui| {
        ui.checkbox(&mut settings.smooth, "smooth")
            .on_hover_text("The far part begins as the plain map ends; else as large as set here (1 is the paper's)");
        ui.add_enabled(!settings.smooth, slider(&mut settings.scale, 0.1..=4.0, "scale").fixed_decimals(2));
    });
    ui.horizontal(|ui| {
        ui.label("curved");
        let mut choice = |curvature, name, hint| {
            ui.radio_value(&mut settings.curvature, curvature, name).on_hover_text(hint);
        };
        choice(Some(DropFrom::Ring), "ring", "The Earth falls away from the ring on, above which the eyes stand");
        choice(Some(DropFrom::Centre), "centre", "The Earth falls away from the centre, as a viewer there has it");
        choice(None, "flat", "A flat Earth, as in the paper");
    });
    ui.add_enabled(
        settings.curvature.is_some(),
        slider(&mut settings.refraction, 0.0..=0.3, "refraction").fixed_decimals(3),
    )
    .on_hover_text("Bending of light as a share of the Earth's curvature");
    // the line is there always, so that nothing moves when it speaks
    let (line, whole) = fault.map_or((String::new(), String::new()), |fault| (in_short(fault), fault.to_string()));
    let line = egui::Label::new(egui::RichText::new(line).color(WARNING)).truncate();
    let told = ui.add(line);
    if !whole.is_empty() {
        told.on_hover_text(whole);
    }
}

/// What is wrong, in a line of the panel.
fn in_short(fault: &MapFault) -> String {
    match fault {
        MapFault::AboveTheEye { height_m, .. } => format!("Ground of {height_m:.0} m stands above the eye"),
        fault => fault.to_string(),
    }
}

fn fineness(ui: &mut Ui, settings: &mut Settings) {
    let tolerance = Slider::new(&mut settings.tolerance_px, 0.1..=20.0).logarithmic(true).suffix(" px");
    ui.add(tolerance.clamping(SliderClamping::Edits).text("tolerance"))
        .on_hover_text("No ground is drawn further from its place than this");
    ui.horizontal(|ui| {
        ui.checkbox(&mut settings.budget_on, "");
        let budget = Slider::new(&mut settings.budget_triangles, 100..=5_000_000).logarithmic(true);
        ui.add_enabled(settings.budget_on, budget.clamping(SliderClamping::Edits).text("budget"));
    });
}

fn what_is_shown(ui: &mut Ui, shown: &Shown<'_>, settings: &mut Settings) {
    let has_names = !shown.stage.names.is_empty();
    ui.horizontal(|ui| {
        ui.add_enabled(has_names, egui::Checkbox::new(&mut settings.names, "names"))
            .on_disabled_hover_text("No places were given that lie here: --places");
        let is_on = has_names && settings.names;
        ui.add_enabled(is_on, egui::Checkbox::new(&mut settings.hidden, "hidden ones"));
        ui.add_enabled(is_on, egui::Checkbox::new(&mut settings.from_ground, "as seen there"))
            .on_hover_text("Only what somebody standing at the centre sees counts as seen");
    });
    let most = Slider::new(&mut settings.most_names, 0..=400).clamping(SliderClamping::Edits).text("most names");
    ui.add_enabled(has_names && settings.names, most);
    ui.horizontal(|ui| {
        ui.checkbox(&mut settings.rings, "rings");
        ui.checkbox(&mut settings.compass, "compass");
        ui.add_enabled(!shown.stage.lines.is_empty(), egui::Checkbox::new(&mut settings.lines, "lines"))
            .on_disabled_hover_text("No lines were given that lie here: --lines");
    });
    ui.horizontal(|ui| {
        ui.checkbox(&mut settings.veil, "veil").on_hover_text("Hidden ground, which alpha brings forth, is paler");
        ui.checkbox(&mut settings.wireframe, "edges");
        ui.checkbox(&mut settings.antialias, "antialias");
    });
}

fn picture(ui: &mut Ui, shown: &Shown<'_>, pose: &mut Pose, action: &mut Option<Action>) {
    let mut up_deg = pose.up_azimuth_rad.to_degrees();
    let up = Slider::new(&mut up_deg, 0.0..=360.0).suffix("°").fixed_decimals(0).text("points up");
    if ui.add(up).changed() {
        pose.up_azimuth_rad = up_deg.to_radians();
    }
    let mut is_fitted = pose.is_fitted();
    let fit = ui.checkbox(&mut is_fitted, "fitted to the window");
    if let Some(view) = shown.view.filter(|_| fit.changed()) {
        pose.fit(is_fitted, view);
    }
    ui.horizontal(|ui| {
        let mut button = |text: &str, asks| {
            if ui.button(text).clicked() {
                *action = Some(asks);
            }
        };
        button("Fit (R)", Action::Fit);
        button("North up (N)", Action::NorthUp);
        button("Home", Action::Home);
        button("Help (H)", Action::Help);
    });
}
