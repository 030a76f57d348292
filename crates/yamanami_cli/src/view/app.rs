//! One frame after another: input moves the camera, the camera the front, and the front the picture.

use super::panel::{self, Action, Plots, Shown};
use super::recorder::{Player, Recorder, VIEWS_PER_S};
use super::screenshot::{Screenshot, free_name};
use super::settings::{Colour, Settings};
use super::stage::{Numbers, Stage};
use super::water::WaterGauge;
use super::{Failure, Options, keys, overlay};
use eframe::egui::{self, Align2, PointerButton, Rect, Response, Sense, pos2, vec2};
use eframe::wgpu;
use glam::DVec3;
use std::path::{Path, PathBuf};
use yamanami::core::View;
use yamanami::steer::{Ground, ray_through};
use yamanami::steer::{Mode, Rig};
use yamanami::{CameraPath, Error, Subject};

/// Longest frame that counts, seconds: after a stall the camera does not leap.
const LONGEST_FRAME_S: f64 = 0.1;
/// How long a message stays, seconds.
const MESSAGE_S: f64 = 6.0;
/// Wheel of so many points comes e times nearer.
const WHEEL_POINTS: f64 = 260.0;
/// A double click comes so much nearer.
const DOUBLE_CLICK: f64 = 0.4;
/// Height of the water when it is first switched on, as a share of the range of heights.
const WATER_SHARE: f64 = 0.1;
/// Views of the built-in flights.
const FLIGHT_VIEWS: usize = 20 * VIEWS_PER_S as usize;

/// The window's state.
pub(super) struct Viewer<S> {
    stage: Stage<S>,
    settings: Settings,
    rig: Rig,
    /// The start is over all of it: to be fitted to the picture once its size is known.
    fit_start: bool,
    plots: Plots,
    gauge: WaterGauge,
    last: Option<Numbers>,
    recorder: Option<Recorder>,
    player: Option<Player>,
    /// The path last recorded or given.
    path: Option<CameraPath>,
    /// A line to tell, and when it was told.
    message: Option<(String, f64)>,
    help: bool,
    panel: bool,
    /// The point of the land that a drag holds.
    grabbed: Option<DVec3>,
    /// Whether the frame before asked for this one.
    live: bool,
    screenshot: Option<Screenshot>,
    failure: Failure,
}

impl<S: Subject> Viewer<S> {
    /// Sets the window up.
    pub(super) fn new(
        context: &eframe::CreationContext<'_>,
        subject: S,
        options: Options,
        failure: Failure,
    ) -> Result<Self, String> {
        let render = context.wgpu_render_state.clone().ok_or("no window: it has no graphics device")?;
        context.egui_ctx.set_theme(egui::Theme::Dark);
        let home = options.view.unwrap_or_else(|| yamanami::overview(&subject, options.size));
        let mut settings = Settings::new(&options);
        if !subject.is_ground() && options.colour.is_none() {
            settings.colour = Colour::Own;
        }
        if options.water_m.is_none() {
            let bounds = subject.bounds();
            settings.water_m = bounds.min.z + WATER_SHARE * (bounds.max.z - bounds.min.z);
        }
        // four samples a pixel are dear where the processor draws
        settings.antialias = render.adapter.get_info().device_type != wgpu::DeviceType::Cpu;
        let mut stage = Stage::new(render, subject, &settings);
        if let Some(image) = &options.image {
            stage.lay_image(image)?;
        }
        Ok(Self {
            stage,
            settings,
            rig: Rig::new(home),
            fit_start: options.view.is_none(),
            plots: Plots::default(),
            gauge: WaterGauge::new(options.sources, options.reading),
            last: None,
            recorder: None,
            player: options.path.clone().and_then(Player::new),
            path: options.path,
            message: None,
            help: false,
            panel: true,
            grabbed: None,
            live: false,
            screenshot: options.screenshot.map(Screenshot::new),
            failure,
        })
    }

    /// What may colour the surface now.
    fn colours(&self) -> Vec<Colour> {
        let has_image = self.stage.has_image();
        self.stage.colours().into_iter().filter(|&c| c != Colour::Image || has_image).collect()
    }

    fn tell(&mut self, ui: &egui::Ui, line: impl Into<String>) {
        self.message = Some((line.into(), ui.input(|i| i.time)));
    }

    fn act(&mut self, ui: &egui::Ui, action: Action, view: &View) -> Result<(), Error> {
        match action {
            Action::Reset => {
                self.player = None;
                self.rig.reset();
            }
            Action::ChangeMode => {
                let mode = if self.rig.mode() == Mode::Orbit { Mode::Fly } else { Mode::Orbit };
                let ahead = Ground::of(&self.stage.subject).hit(view.eye, view.forward());
                self.rig.set_mode(mode, ahead);
                self.tell(ui, if mode == Mode::Fly { "Flight: W A S D, Q E, drag to look" } else { "Orbit" });
            }
            Action::Freeze => self.stage.freeze(if self.stage.frozen().is_some() { None } else { Some(*view) }),
            Action::Record => match self.recorder.take() {
                None => self.recorder = Some(Recorder::new(*view)),
                Some(recorder) => {
                    self.tell(ui, format!("{} views recorded; Y replays them", recorder.len()));
                    self.path = Some(recorder.finish());
                }
            },
            Action::Replay => {
                self.player = match self.player.take() {
                    Some(_) => None,
                    None => self.path.clone().and_then(Player::new),
                }
            }
            Action::SavePath => {
                if let Some(path) = &self.path {
                    let file = free_name("yamanami-path", "json");
                    yamanami::write_path(&self.stage.subject, path, &file)?;
                    self.tell(ui, format!("Saved {}", file.display()));
                }
            }
            Action::Orbit => {
                let path = yamanami::orbit(&self.stage.subject, FLIGHT_VIEWS, view.viewport_px);
                self.player = Player::new(path);
            }
            Action::ValleyRun => {
                let Some(terrain) = self.stage.subject.as_terrain() else {
                    self.tell(ui, "A model has no valleys");
                    return Ok(());
                };
                let path = yamanami::valley_run(terrain, FLIGHT_VIEWS, view.viewport_px)?;
                self.player = Player::new(path);
            }
            Action::Picture => {
                let file = free_name("yamanami-view", "png");
                let picture = self.stage.picture(view, &self.settings)?;
                picture.save(&file).map_err(|source| Error::Picture { path: file.clone(), source })?;
                self.tell(ui, format!("Saved {}", file.display()));
            }
            Action::Help => self.help = !self.help,
            Action::Panel => self.panel = !self.panel,
        }
        Ok(())
    }

    /// Files dropped on the window: images are laid over the land, paths are flown.
    fn drops(&mut self, ui: &egui::Ui, viewport_px: [u32; 2]) {
        let files: Vec<PathBuf> = ui.input(|i| i.raw.dropped_files.iter().map(|f| f.path().to_owned()).collect());
        for file in files {
            let is_path = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
            let done = if is_path { self.open_path(&file, viewport_px) } else { self.open_image(&file) };
            let line = done.err().unwrap_or_else(|| format!("Opened {}", file.display()));
            self.tell(ui, line);
        }
    }

    fn open_path(&mut self, file: &Path, viewport_px: [u32; 2]) -> Result<(), String> {
        let path = yamanami::read_path(&self.stage.subject, file, viewport_px).map_err(|error| error.to_string())?;
        self.player = Player::new(path.clone());
        self.path = Some(path);
        Ok(())
    }

    fn open_image(&mut self, file: &Path) -> Result<(), String> {
        self.stage.lay_image(file)?;
        self.settings.colour = Colour::Image;
        Ok(())
    }

    /// Moves the camera by mouse, keys or a replayed path, and gives what it sees.
    fn move_camera(&mut self, ui: &egui::Ui, response: &Response, viewport_px: [u32; 2], dt_s: f64) -> View {
        let ground = Ground::of(&self.stage.subject);
        let view = self.rig.view(viewport_px);
        let scale = [
            f64::from(viewport_px[0]) / f64::from(response.rect.width().max(1.0)),
            f64::from(viewport_px[1]) / f64::from(response.rect.height().max(1.0)),
        ];
        let under = |at: egui::Pos2| {
            let offset = at - response.rect.min;
            let pixel = [f64::from(offset.x) * scale[0], f64::from(offset.y) * scale[1]];
            ground.hit(view.eye, ray_through(&view, pixel))
        };
        let cursor = response.hover_pos().or(response.interact_pointer_pos());
        if response.drag_started() {
            self.grabbed = cursor.and_then(under);
        }
        let drag = response.drag_delta();
        let drag = [f64::from(drag.x), f64::from(drag.y)];
        let moved = drag != [0.0; 2];
        let (wheel, pinch) = ui.input(|i| (f64::from(i.smooth_scroll_delta().y), f64::from(i.zoom_delta())));
        let nearer = if response.hovered() { (-wheel / WHEEL_POINTS).exp() / pinch } else { 1.0 };
        let drive = keys::drive(ui);
        let steered = moved || nearer != 1.0 || drive.along != [0.0; 3];
        if let Some(player) = self.player.as_mut().filter(|_| !steered) {
            let (seen, last) = player.step(dt_s);
            self.rig.jump_to(&seen);
            if last {
                self.player = None;
            }
            return self.rig.view(viewport_px);
        }
        if steered {
            self.player = None;
        }
        if moved && response.dragged_by(PointerButton::Primary) {
            self.rig.turn(drag);
        } else if moved {
            self.rig.pan([drag[0] * scale[0], drag[1] * scale[1]], self.grabbed, viewport_px, &ground);
        }
        if nearer != 1.0 {
            self.rig.zoom(nearer, cursor.and_then(under), &ground);
        }
        if response.double_clicked() {
            self.rig.zoom(DOUBLE_CLICK, cursor.and_then(under), &ground);
        }
        self.rig.drive(drive, dt_s, &ground);
        self.rig.step(dt_s, &ground);
        self.rig.view(viewport_px)
    }

    /// Everything in the middle of the window.
    fn picture(&mut self, ui: &mut egui::Ui, action: Option<Action>, dt_s: f64) -> Result<(), Error> {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let longest_px = self.stage.longest_side_px();
        let viewport_px = [rect.width(), rect.height()].map(|side| {
            let side_px = side * ui.pixels_per_point();
            (side_px.round().max(1.0) as u32).min(longest_px)
        });
        if std::mem::take(&mut self.fit_start) {
            self.rig = Rig::new(yamanami::overview(&self.stage.subject, viewport_px));
        }
        self.drops(ui, viewport_px);
        let view = self.move_camera(ui, &response, viewport_px, dt_s);
        if let Some(recorder) = &mut self.recorder {
            recorder.step(view, dt_s);
        }
        let shown = self.stage.show(view, &self.settings)?;
        if let Some(numbers) = shown {
            self.plots.push(&numbers, self.live.then_some(ui.input(|i| f64::from(i.unstable_dt))));
            self.last = Some(numbers);
        }
        if let Some(texture) = self.stage.texture() {
            let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture, rect, uv, egui::Color32::WHITE);
        }
        self.over(ui, rect, &response, &view);
        if let Some(action) = action {
            self.act(ui, action, &view)?;
            ui.request_repaint();
        }
        let goes_on = self.rig.is_moving() || self.player.is_some() || self.recorder.is_some() || self.settings.rebuild;
        self.live = goes_on || !self.stage.is_settled() || keys::drive(ui).along != [0.0; 3];
        if self.live {
            ui.request_repaint();
        }
        Ok(())
    }

    /// What lies over the picture.
    fn over(&mut self, ui: &egui::Ui, rect: Rect, response: &Response, view: &View) {
        let painter = ui.painter_at(rect);
        let subject = &self.stage.subject;
        let ground = Ground::of(subject);
        if let Some(held) = self.stage.frozen() {
            overlay::held_view(&painter, rect, view, held, &ground);
        }
        let forward = view.forward();
        let _ = overlay::compass(&painter, rect, forward.x.atan2(forward.y) as f32);
        let mode = if self.rig.mode() == Mode::Fly { format!("flight x{:.1}, ", self.rig.pace) } else { String::new() };
        let above_m = view.eye.z - ground.height_m(view.eye.truncate());
        let above = if ground.holds(view.eye.truncate()) { format!(" ({above_m:.0} m up)") } else { String::new() };
        let mut text = format!("{mode}eye {}{above}", overlay::place(subject, view.eye));
        let pointed = response.hover_pos().and_then(|at| {
            let offset = at - rect.min;
            let side = |offset: f32, side: f32, px: u32| f64::from(offset / side.max(1.0)) * f64::from(px);
            let pixel = [
                side(offset.x, rect.width(), view.viewport_px[0]),
                side(offset.y, rect.height(), view.viewport_px[1]),
            ];
            ground.hit(view.eye, ray_through(view, pixel))
        });
        if let Some(point) = pointed {
            text += &format!("   cursor {}", overlay::place(subject, point));
        }
        overlay::line(&painter, rect.left_bottom() + vec2(8.0, -8.0), Align2::LEFT_BOTTOM, &text);
        let time = ui.input(|i| i.time);
        self.message = self.message.take().filter(|(_, told)| time - told < MESSAGE_S);
        let line = match (&self.message, &self.recorder, &self.player) {
            (Some((line, told)), ..) => {
                ui.request_repaint_after_secs((MESSAGE_S - (time - told)) as f32 + 0.05);
                Some(line.clone())
            }
            (None, Some(recorder), _) => Some(format!("Recording: {} views", recorder.len())),
            (None, None, Some(player)) => Some(format!("Replay: {:.0} %", player.share() * 100.0)),
            (None, None, None) => self.stage.frozen().map(|_| "The front is held; Z lets it go".to_owned()),
        };
        if let Some(line) = line {
            overlay::line(&painter, rect.center_top() + vec2(0.0, 8.0), Align2::CENTER_TOP, &line);
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

impl<S: Subject> eframe::App for Viewer<S> {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let dt_s = ui.input(|i| f64::from(i.stable_dt)).min(LONGEST_FRAME_S);
        let before = self.settings.clone();
        let colours = self.colours();
        let mut action = keys::pressed(ui, &mut self.settings, &colours);
        let moving = ui.input(|i| i.pointer.any_down());
        self.gauge.follow(before.water_level_m(), moving, self.stage.subject.full_triangles(), ui);
        if self.panel {
            let shown = Shown {
                stage: &self.stage,
                plots: &self.plots,
                last: self.last,
                water: self.gauge.words(),
                recording: self.recorder.as_ref().map(Recorder::len),
                replaying: self.player.as_ref().map(Player::share),
                has_path: self.path.is_some(),
            };
            let (settings, rig) = (&mut self.settings, &mut self.rig);
            let panel = egui::Panel::right("controls").default_size(286.0).min_size(240.0);
            let asked = panel.show(ui, |ui| panel::show(ui, &shown, settings, rig)).inner;
            action = asked.or(action);
        }
        if self.settings.restarts(&before) {
            self.stage.restart(&self.settings);
        }
        let drawn = egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, action, dt_s)).inner;
        overlay::help(ui, &mut self.help, &overlay::HELP, overlay::HELP_LINE);
        match drawn {
            Ok(()) => {}
            // what only writes a file may fail and the flight goes on
            Err(error @ (Error::File { .. } | Error::Picture { .. })) => self.tell(ui, error.to_string()),
            Err(error) => self.fail(ui, error.to_string()),
        }
        let settled = !self.live;
        match self.screenshot.as_mut().and_then(|shot| shot.step(ui, settled)) {
            Some(Ok(())) => ui.send_viewport_cmd(egui::ViewportCommand::Close),
            Some(Err(line)) => self.fail(ui, line),
            None => {}
        }
    }
}
