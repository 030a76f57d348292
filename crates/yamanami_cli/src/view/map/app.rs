//! One frame after another: input moves the map, the map the front, and the front the picture.

use super::super::screenshot::Screenshot;
use super::super::{Failure, overlay as common};
use super::ground::{Ground, Loader, MOVED_SHARE, Reader};
use super::names::Names;
use super::overlay::{self, LETTERS, Screen};
use super::panel::{self, Action, Plots, Shown};
use super::pick::Picked;
use super::settings::Settings;
use super::stage::{Numbers, Stage};
use super::{Options, keys};
use eframe::egui::{self, FontData, FontDefinitions, FontFamily, PointerButton, Rect, Response, Sense, pos2, vec2};
use eframe::wgpu;
use glam::DVec2;
use std::sync::Arc;
use yamanami::Error;
use yamanami::core::{MapFault, MapView};
use yamanami::map::Fonts;
use yamanami::steer::Pose;

/// Longest frame that counts, seconds: after a stall nothing leaps.
const LONGEST_FRAME_S: f64 = 0.1;
/// How long a message stays, seconds.
const MESSAGE_S: f64 = 6.0;
/// Wheel of so many points makes the picture e times larger.
const WHEEL_POINTS: f64 = 260.0;
/// Gliding to another centre takes so long, seconds.
const GLIDE_S: f64 = 0.5;
/// Keys turn the picture so fast, radians a second.
const TURN_PER_S: f64 = 1.0;
/// α goes up to this and down again by itself, in so many seconds.
const SWEEP: (f64, f64) = (0.3, 12.0);
/// A named summit so near to the cursor is told, points.
const REACH: f32 = 9.0;

/// The window's state.
pub(super) struct MapViewer {
    stage: Stage,
    loader: Loader,
    settings: Settings,
    pose: Pose,
    /// Metres to the rim.
    rim_m: f64,
    home: [f64; 2],
    names: Names,
    plots: Plots,
    last: Option<Numbers>,
    /// The picture shown last: of a map that the ground can be shown by.
    view: Option<MapView>,
    /// Why it is not that asked for.
    fault: Option<MapFault>,
    /// On the way to another centre: from, to, seconds behind.
    glide: Option<(DVec2, DVec2, f64)>,
    sweep_s: f64,
    /// Around this longitude and latitude ground could not be read; it is asked for again from elsewhere.
    refused: Option<[f64; 2]>,
    pinned: Option<Picked>,
    message: Option<(String, f64)>,
    help: bool,
    panel: bool,
    /// Whether the frame before asked for this one.
    live: bool,
    screenshot: Option<Screenshot>,
    failure: Failure,
}

impl MapViewer {
    /// Sets the window up.
    pub(super) fn new(
        context: &eframe::CreationContext<'_>,
        reader: Reader,
        ground: Ground,
        options: Options,
        failure: Failure,
    ) -> Result<Self, String> {
        let render = context.wgpu_render_state.clone().ok_or("no window: it has no graphics device")?;
        context.egui_ctx.set_theme(egui::Theme::Dark);
        context.egui_ctx.set_fonts(fonts(&options.fonts));
        // four samples a pixel are dear where the processor draws
        let antialias = render.adapter.get_info().device_type != wgpu::DeviceType::Cpu;
        let settings = Settings::new(&options, antialias);
        let stage = Stage::new(render, ground);
        stage.check(&options.map).map_err(|fault| fault.to_string())?;
        let ui = context.egui_ctx.clone();
        Ok(Self {
            stage,
            loader: Loader::new(reader, move || ui.request_repaint()),
            settings,
            pose: Pose::new(options.up_azimuth_rad),
            rim_m: options.ground.radius_m,
            home: options.ground.centre_lon_lat,
            names: Names::default(),
            plots: Plots::default(),
            last: None,
            view: None,
            fault: None,
            glide: None,
            sweep_s: 0.0,
            refused: None,
            pinned: None,
            message: None,
            help: false,
            panel: true,
            live: false,
            screenshot: options.screenshot.map(Screenshot::new),
            failure,
        })
    }

    fn tell(&mut self, ui: &egui::Ui, line: impl Into<String>) {
        self.message = Some((line.into(), ui.input(|i| i.time)));
    }

    fn act(&mut self, action: Action) {
        match action {
            Action::Fit => {
                if let Some(view) = &self.view {
                    self.pose.fit(true, view);
                }
            }
            Action::NorthUp => self.pose.up_azimuth_rad = 0.0,
            Action::Home => {
                let [lon, lat] = self.home;
                self.glide = Some((self.pose.centre, self.stage.plane.to_plane(lon, lat), 0.0));
            }
            Action::Help => self.help = !self.help,
            Action::Panel => self.panel = !self.panel,
        }
    }

    /// Takes ground that has been read, and asks for other ground where the map has moved away from it.
    fn follow_ground(&mut self, ui: &egui::Ui) {
        match self.loader.take() {
            Some((_, Ok(ground))) => {
                // what lies in the old plane goes over into the new
                let (old, new) = (self.stage.plane, ground.plane);
                let moved = |p: DVec2| {
                    let [lon, lat] = old.to_lon_lat(p);
                    new.to_plane(lon, lat)
                };
                self.pose.centre = moved(self.pose.centre);
                self.glide = self.glide.map(|(from, to, s)| (moved(from), moved(to), s));
                if let Some(view) = &mut self.view {
                    view.map.centre = moved(view.map.centre);
                }
                self.refused = None;
                self.stage.set_ground(ground);
            }
            Some((place, Err(line))) => {
                self.refused = Some(place);
                self.tell(ui, line);
            }
            None => {}
        }
        let wanted = self.glide.map_or(self.pose.centre, |(_, to, _)| to);
        let limit_m = MOVED_SHARE * self.rim_m;
        let away_m = |[lon, lat]: [f64; 2]| (self.stage.plane.to_plane(lon, lat) - wanted).length();
        let is_refused = self.refused.is_some_and(|place| away_m(place) < limit_m);
        if wanted.length() > limit_m && !is_refused {
            self.loader.ask(self.stage.plane.to_lon_lat(wanted));
        }
    }

    /// Moves the map by mouse and keys.
    fn steer(&mut self, ui: &egui::Ui, response: &Response, screen: Screen, dt_s: f64) {
        let Some(view) = self.view else { return };
        let drag_px = screen.px_of(response.drag_delta());
        if drag_px != DVec2::ZERO && response.dragged_by(PointerButton::Primary) {
            self.glide = None;
            self.pose.drag(&view, drag_px);
        } else if let Some(to) = response.interact_pointer_pos().filter(|_| drag_px != DVec2::ZERO) {
            let to_px = screen.px(to);
            self.pose.turn(&view, to_px - drag_px, to_px);
        }
        if response.drag_stopped() && self.fault.is_some() {
            self.pose.centre = view.map.centre;
        }
        let (wheel, pinch) = ui.input(|i| (f64::from(i.smooth_scroll_delta().y), f64::from(i.zoom_delta())));
        let larger = (wheel / WHEEL_POINTS).exp() * pinch;
        if let Some(at) = response.hover_pos().filter(|_| larger != 1.0) {
            self.pose.zoom(&view, larger, screen.px(at));
        }
        self.pose.turn_by(keys::turn(ui) * TURN_PER_S * dt_s);
        if let Some((from, to, behind_s)) = self.glide {
            let behind_s = behind_s + dt_s;
            let t = (behind_s / GLIDE_S).min(1.0);
            self.pose.centre = from.lerp(to, t * t * (3.0 - 2.0 * t));
            self.glide = (t < 1.0).then_some((from, to, behind_s));
        }
        if self.settings.sweep {
            self.sweep_s += dt_s;
            let (most, period_s) = SWEEP;
            self.settings.alpha = most * 0.5 * (1.0 - (self.sweep_s * std::f64::consts::TAU / period_s).cos());
        }
    }

    /// The picture of the map that is asked for, or of the last that the ground could be shown by.
    fn aim(&mut self, size_px: [u32; 2]) -> MapView {
        let asked = self.settings.map(self.pose.centre);
        let map = match (self.stage.check(&asked), &self.view) {
            (Ok(()), _) => {
                self.fault = None;
                asked
            }
            (Err(fault), Some(view)) => {
                self.fault = Some(fault);
                view.map
            }
            // the first was checked before the window opened
            (Err(_), None) => asked,
        };
        let view = self.pose.view(map, size_px, self.rim_m, self.stage.top_m);
        self.view = Some(view);
        view
    }

    /// Everything in the middle of the window.
    fn picture(&mut self, ui: &mut egui::Ui, dt_s: f64) -> Result<(), Error> {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let longest_px = self.stage.longest_side_px();
        let size_px = [rect.width(), rect.height()].map(|side| {
            let side_px = side * ui.pixels_per_point();
            (side_px.round().max(1.0) as u32).min(longest_px)
        });
        let screen = Screen::new(rect, size_px);
        self.follow_ground(ui);
        self.steer(ui, &response, screen, dt_s);
        let view = self.aim(size_px);
        if let Some(numbers) = self.stage.show(&view, &self.settings)? {
            self.plots.push(&numbers, self.live.then_some(ui.input(|i| f64::from(i.unstable_dt))));
            self.last = Some(numbers);
        }
        if let Some(texture) = self.stage.texture() {
            let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture, rect, uv, egui::Color32::WHITE);
        }
        self.over(ui, screen, &view);
        self.point(ui, &response, screen, &view)?;
        self.tell_on(ui, rect);
        let moves = self.glide.is_some() || self.settings.sweep || keys::turn(ui) != 0.0;
        self.live = moves || !self.stage.is_settled() || response.dragged();
        if self.live {
            ui.request_repaint();
        }
        Ok(())
    }

    /// Lines, rings and names over the picture.
    fn over(&mut self, ui: &egui::Ui, screen: Screen, view: &MapView) {
        let painter = ui.painter_at(screen.rect);
        if self.settings.lines && !self.stage.lines.is_empty() {
            let horizon = self.stage.horizon(view);
            overlay::lines(&painter, screen, view, &self.stage.lines, self.stage.field(), &horizon);
        }
        let mut taken = Vec::new();
        if self.settings.rings {
            taken.extend(overlay::rings(&painter, screen, view));
        }
        if self.settings.compass {
            taken.extend(overlay::bearings(&painter, screen, view, self.stage.top_m));
            taken.push(common::compass(&painter, screen.rect, view.up_azimuth_rad as f32));
        }
        if self.settings.names {
            self.names.draw(&painter, screen, &self.stage, view, &self.settings, taken);
        }
        if let Some(pinned) = &self.pinned {
            let px = view.px_from_plane(pinned.place(&self.stage.plane));
            overlay::pin(&painter, screen.pos(px));
        }
    }

    /// Tells of the place under the cursor, pins it, goes there.
    fn point(&mut self, ui: &egui::Ui, response: &Response, screen: Screen, view: &MapView) -> Result<(), Error> {
        let mut lines: Vec<String> = self.pinned.iter().map(|pinned| pinned.in_words(&self.stage, view)).collect();
        let hovered = response.hover_pos().filter(|_| !response.dragged());
        let place = hovered.map(|at| self.stage.pick(view, screen.px(at))).transpose()?.flatten();
        if let (Some(at), Some(place)) = (hovered, place) {
            let name = self.names.nearest(screen, &self.stage, view, &self.settings, at, REACH);
            let picked = Picked::new(&self.stage, place, name);
            lines.push(picked.in_words(&self.stage, view));
            if response.double_clicked() {
                self.pinned = None;
                self.glide = Some((self.pose.centre, place.truncate(), 0.0));
            } else if response.clicked() {
                self.pinned = Some(picked);
            }
        } else if response.clicked() {
            self.pinned = None;
        }
        let painter = ui.painter_at(screen.rect);
        for (k, line) in lines.iter().rev().enumerate() {
            let room = vec2(0.0, 24.0 * k as f32);
            overlay::readout(&painter, screen.rect.translate(-room), line);
        }
        Ok(())
    }

    /// A message at the top, while it lasts.
    fn tell_on(&mut self, ui: &egui::Ui, rect: Rect) {
        let time = ui.input(|i| i.time);
        self.message = self.message.take().filter(|(_, told)| time - told < MESSAGE_S);
        if let Some((line, told)) = &self.message {
            ui.request_repaint_after_secs((MESSAGE_S - (time - told)) as f32 + 0.05);
            let at = rect.center_top() + vec2(0.0, 8.0);
            common::line(&ui.painter_at(rect), at, egui::Align2::CENTER_TOP, line);
        }
    }

    /// Closes the window with a reason.
    fn fail(&self, ui: &egui::Ui, line: String) {
        if let Ok(mut failure) = self.failure.lock() {
            failure.get_or_insert(line);
        }
        ui.send_viewport_cmd(egui::ViewportCommand::Close);
    }
}

impl eframe::App for MapViewer {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let dt_s = ui.input(|i| f64::from(i.stable_dt)).min(LONGEST_FRAME_S);
        let mut action = keys::pressed(ui, &mut self.settings);
        if self.panel {
            let shown = Shown {
                stage: &self.stage,
                plots: &self.plots,
                last: self.last,
                view: self.view.as_ref(),
                fault: self.fault.as_ref(),
                is_reading: self.loader.is_busy(),
            };
            let (settings, pose) = (&mut self.settings, &mut self.pose);
            let panel = egui::Panel::right("controls").default_size(286.0).min_size(240.0);
            action = panel.show(ui, |ui| panel::show(ui, &shown, settings, pose)).inner.or(action);
        }
        if let Some(action) = action {
            self.act(action);
            ui.request_repaint();
        }
        let drawn = egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, dt_s)).inner;
        common::help(ui, &mut self.help, &keys::HELP, keys::HELP_LINE);
        if let Err(error) = drawn {
            self.fail(ui, error.to_string());
        }
        let settled = !self.live && !self.loader.is_busy();
        match self.screenshot.as_mut().and_then(|shot| shot.step(ui, settled)) {
            Some(Ok(())) => ui.send_viewport_cmd(egui::ViewportCommand::Close),
            Some(Err(line)) => self.fail(ui, line),
            None => {}
        }
    }
}

/// The window's fonts: names in the map's, everything else in these too where its own lacks a letter.
fn fonts(letters: &Fonts) -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    for (k, file) in letters.files().into_iter().enumerate() {
        let name = format!("{LETTERS} {k}");
        fonts.font_data.insert(name.clone(), Arc::new(FontData::from_owned(file.to_vec())));
        for family in [FontFamily::Name(LETTERS.into()), FontFamily::Proportional] {
            fonts.families.entry(family).or_default().push(name.clone());
        }
    }
    fonts
}
