//! What the page sees of the engine. Objects travel as JSON, so that the page needs no glue of its own.

use crate::session::{Content, Session, Start, with_stage};
use crate::settings::Mode;
use crate::surface::{Backend, CanvasSurface};
use glam::{DVec2, DVec3};
use serde_json::json;
use std::sync::{Arc, OnceLock};
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;
use yamanami::Subject;
use yamanami::core::View;
use yamanami::gpu::wgpu;
use yamanami::io::pack::layout::PackKind;
use yamanami::steer::{Drive, Ground, Mode as RigMode};

/// A viewer on a canvas.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Viewer {
    surface: CanvasSurface,
    session: Option<Session>,
    /// Why the device is gone, once it is.
    lost: Arc<OnceLock<String>>,
}

fn error(message: impl AsRef<str>) -> JsError {
    JsError::new(message.as_ref())
}

#[wasm_bindgen]
impl Viewer {
    /// Sets up drawing on a canvas, by `auto`, `webgpu` or `webgl2`.
    pub async fn create(canvas: HtmlCanvasElement, backend: String) -> Result<Viewer, JsError> {
        console_error_panic_hook::set_once();
        let backend = Backend::parse(&backend).map_err(error)?;
        let surface = CanvasSurface::new(canvas, backend).await.map_err(error)?;
        let lost = Arc::new(OnceLock::new());
        let noted = Arc::clone(&lost);
        surface.gpu.device().set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                // the first reason is as good as any
                let _ = noted.set(message);
            }
        });
        Ok(Self { surface, session: None, lost })
    }

    /// What draws, in words.
    pub fn device(&self) -> String {
        self.surface.name().to_owned()
    }

    /// Opens a packed surface from its first bytes: facts about it, or how many bytes are needed.
    pub fn open(&mut self, start: Vec<u8>) -> Result<String, JsError> {
        let gpu = self.surface.gpu.clone();
        match Session::open(start, self.surface.size_px(), Some(gpu)).map_err(error)? {
            Start::Needs(bytes) => Ok(json!({ "need": bytes }).to_string()),
            Start::Opened(session) => {
                let facts = facts(&session);
                self.session = Some(*session);
                Ok(facts)
            }
        }
    }

    /// Ranges to fetch now: `[id, offset, length]` one after the other, so that at most `most` are in flight.
    pub fn requests(&mut self, most: usize) -> Result<Vec<f64>, JsError> {
        let Some(session) = &mut self.session else { return Ok(Vec::new()) };
        let requests = session.requests(most).map_err(error)?;
        Ok(requests.iter().flat_map(|r| [f64::from(r.id), r.offset as f64, r.length as f64]).collect())
    }

    /// Takes the bytes of a range; damaged ones are an error, and left out.
    pub fn receive(&mut self, id: u32, bytes: Vec<u8>) -> Result<(), JsError> {
        self.session.as_mut().map_or(Ok(()), |session| session.receive(id, &bytes)).map_err(error)
    }

    /// A range could not be had.
    pub fn failed(&mut self, id: u32) {
        if let Some(session) = &mut self.session {
            session.stream.failed(id);
        }
    }

    /// How loading goes on.
    pub fn progress(&self) -> String {
        let Some(session) = &self.session else { return "{}".to_owned() };
        json!({
            "received_bytes": session.stream.received_bytes(),
            "wanted_bytes": session.stream.wanted_bytes(),
            "resident_bytes": session.resident_bytes(),
            "in_flight": session.stream.in_flight(),
            "is_complete": session.is_complete(),
        })
        .to_string()
    }

    /// Keeps at most so many bytes of pages in memory.
    pub fn set_memory(&mut self, bytes: f64) {
        if let Some(session) = &mut self.session {
            session.set_memory(bytes.clamp(1e6, 4e9) as usize);
        }
    }

    /// The canvas has another size in device pixels.
    pub fn resize(&mut self, width_px: u32, height_px: u32) {
        let size_px = self.surface.resize([width_px, height_px]);
        if let Some(session) = &mut self.session {
            session.resize(size_px);
        }
    }

    /// Changes the settings that are given, and gives all.
    pub fn settings(&mut self, json: &str) -> Result<String, JsError> {
        let session = self.session.as_mut().ok_or_else(|| error("nothing is open"))?;
        session.change(json).map_err(error)?;
        serde_json::to_string(&session.settings).map_err(|e| error(e.to_string()))
    }

    /// Updates the front and draws, where anything changed; whether to call again soon.
    pub fn frame(&mut self, dt_s: f64) -> Result<bool, JsError> {
        if let Some(message) = self.lost.get() {
            return Err(error(format!("device lost: {message}")));
        }
        let Some(session) = &mut self.session else { return Ok(false) };
        let changed = session.update(dt_s.clamp(0.0, 60.0)).map_err(|e| error(e.to_string()))?;
        if changed {
            let started = web_time::Instant::now();
            let Some(texture) = self.surface.next().map_err(error)? else { return Ok(true) };
            let view = texture.texture.create_view(&wgpu::TextureViewDescriptor::default());
            session.draw_on(&view, self.surface.format()).map_err(|e| error(e.to_string()))?;
            self.surface.present(texture);
            session.set_draw_ms(started.elapsed().as_secs_f64() * 1e3);
        }
        Ok(session.is_moving())
    }

    /// What the last update did.
    pub fn stats(&self) -> String {
        let numbers = self.session.as_ref().map(Session::numbers).unwrap_or_default();
        serde_json::to_string(&numbers).unwrap_or_default()
    }

    /// Where the camera stands, or how the map lies.
    pub fn view(&self) -> String {
        self.session.as_ref().map_or_else(|| "{}".to_owned(), |session| session.pose().to_string())
    }

    /// Puts the camera, or the map, where [`Self::view`] once said.
    pub fn set_view(&mut self, json: &str) -> Result<(), JsError> {
        self.session.as_mut().map_or(Ok(()), |session| session.set_pose(json)).map_err(error)
    }

    /// Turns by a drag.
    pub fn turn(&mut self, dx_px: f64, dy_px: f64) {
        let Some(session) = &mut self.session else { return };
        if let Some(map) = session.maps.stage.as_mut().filter(|_| session.settings.mode == Mode::Map) {
            map.pose.turn_by(0.0045 * (dx_px - dy_px));
            session.settings.map.up_deg = map.pose.up_azimuth_rad.to_degrees();
            return;
        }
        with_stage!(&mut session.content, stage => stage.rig.turn([dx_px, dy_px]), else ());
    }

    /// Moves what lies under one pixel to another.
    pub fn pan(&mut self, x0_px: f64, y0_px: f64, x1_px: f64, y1_px: f64) {
        let Some(session) = &mut self.session else { return };
        let (from, to) = (DVec2::new(x0_px, y0_px), DVec2::new(x1_px, y1_px));
        let size_px = session.size_px;
        if let Some(map) = session.maps.stage.as_mut().filter(|_| session.settings.mode == Mode::Map) {
            let view = map.view(&session.settings, size_px);
            map.pose.drag(&view, to - from);
            return;
        }
        with_stage!(&mut session.content, stage => {
            let view = stage.rig.view(size_px);
            let grabbed = stage.hit(&view, from);
            let ground = Ground::of(&stage.subject);
            stage.rig.pan((to - from).to_array(), grabbed, size_px, &ground);
        }, else ());
    }

    /// Comes nearer by a factor below 1, or goes away, about a pixel.
    pub fn zoom(&mut self, factor: f64, x_px: f64, y_px: f64) {
        let Some(session) = &mut self.session else { return };
        let (px, size_px) = (DVec2::new(x_px, y_px), session.size_px);
        if !(factor.is_finite() && factor > 0.0) {
            return;
        }
        if let Some(map) = session.maps.stage.as_mut().filter(|_| session.settings.mode == Mode::Map) {
            let view = map.view(&session.settings, size_px);
            map.pose.zoom(&view, 1.0 / factor, px);
            return;
        }
        with_stage!(&mut session.content, stage => {
            let view = stage.rig.view(size_px);
            let about = stage.hit(&view, px);
            let ground = Ground::of(&stage.subject);
            stage.rig.zoom(factor, about, &ground);
        }, else ());
    }

    /// Moves by keys, each from -1 to 1.
    pub fn drive(&mut self, ahead: f64, aside: f64, up: f64, fast: bool, dt_s: f64) {
        let Some(session) = &mut self.session else { return };
        let drive = Drive { along: [ahead, aside, up].map(|v| v.clamp(-1.0, 1.0)), fast };
        with_stage!(&mut session.content, stage => {
            let ground = Ground::of(&stage.subject);
            stage.rig.drive(drive, dt_s.clamp(0.0, 0.2), &ground);
        }, else ());
    }

    /// Flies back to where it started.
    pub fn home(&mut self) {
        let Some(session) = &mut self.session else { return };
        if let Some(map) = session.maps.stage.as_mut().filter(|_| session.settings.mode == Mode::Map) {
            map.pose = yamanami::steer::Pose::new(0.0);
            session.settings.map.up_deg = 0.0;
            return;
        }
        with_stage!(&mut session.content, stage => stage.rig.reset(), else ());
    }

    /// Turns about the eye, or about the land.
    pub fn set_fly(&mut self, on: bool) {
        let Some(session) = &mut self.session else { return };
        let size_px = session.size_px;
        with_stage!(&mut session.content, stage => {
            let view = stage.rig.view(size_px);
            let [x, y] = size_px.map(|n| 0.5 * f64::from(n));
            let ahead = stage.hit(&view, DVec2::new(x, y));
            stage.rig.set_mode(if on { RigMode::Fly } else { RigMode::Orbit }, ahead);
        }, else ());
    }

    /// Whether it turns about the eye.
    pub fn is_fly(&self) -> bool {
        let Some(session) = &self.session else { return false };
        with_stage!(&session.content, stage => stage.rig.mode() == RigMode::Fly, else false)
    }

    /// What lies under a pixel, if anything.
    pub fn pick(&self, x_px: f64, y_px: f64) -> Option<String> {
        let picked = self.session.as_ref()?.pick(DVec2::new(x_px, y_px))?;
        serde_json::to_string(&picked).ok()
    }

    /// Heights along a line of x, y in the local frame; finer pages are asked for from now on.
    pub fn profile(&mut self, local_xy: &[f64], samples: usize) -> String {
        let line: Vec<DVec2> = local_xy.as_chunks::<2>().0.iter().map(|&p| p.into()).collect();
        let profile = self.session.as_mut().map(|session| session.profile(&line, samples)).unwrap_or_default();
        serde_json::to_string(&profile).unwrap_or_default()
    }

    /// Lets the pages of the profile go.
    pub fn clear_profile(&mut self) {
        if let Some(session) = &mut self.session {
            session.clear_profile();
        }
    }

    /// Pixels of places x, y, z of the local frame: x, y and 1 where it is seen, else 0.
    pub fn to_screen(&self, local_xyz: &[f64]) -> Vec<f64> {
        let places: Vec<DVec3> = local_xyz.as_chunks::<3>().0.iter().map(|&p| p.into()).collect();
        let Some(session) = &self.session else { return Vec::new() };
        session.to_screen(&places).into_iter().flat_map(|(px, seen)| [px.x, px.y, f64::from(u8::from(seen))]).collect()
    }

    /// Places x, y, z of the land of longitudes and latitudes; NaN where there is none.
    pub fn local_from_lon_lat(&self, lon_lat: &[f64]) -> Vec<f64> {
        let place = |&p: &[f64; 2]| self.session.as_ref().and_then(|s| s.land_from_lon_lat(p)).unwrap_or(DVec3::NAN);
        lon_lat.as_chunks::<2>().0.iter().flat_map(|p| place(p).to_array()).collect()
    }

    /// Longitudes and latitudes of places x, y of the local frame; NaN where they are not known.
    pub fn lon_lat_from_local(&self, local_xy: &[f64]) -> Vec<f64> {
        let place =
            |&p: &[f64; 2]| self.session.as_ref().and_then(|s| s.lon_lat_from_local(p.into())).unwrap_or([f64::NAN; 2]);
        local_xy.as_chunks::<2>().0.iter().flat_map(place).collect()
    }
}

fn facts(session: &Session) -> String {
    let head = session.stream.head();
    let mut facts = json!({
        "kind": match head.kind { PackKind::Terrain => "terrain", PackKind::Model => "model", PackKind::Tin => "tin" },
        "title": head.title,
        "bytes": head.bytes,
        "can_map": session.can_map(),
        "size": null, "step_m": null, "epsg": null, "centre_lon_lat": null,
    });
    match &session.content {
        Content::OpeningTerrain(opening) => {
            let (feed, terrain) = &**opening;
            let geo = &feed.meta.geo;
            let bounds = terrain.bounds();
            facts["bounds"] = json!({ "min": bounds.min.to_array(), "max": bounds.max.to_array() });
            facts["triangles"] = json!(terrain.full_triangles());
            facts["size"] = json!(feed.meta.size);
            facts["step_m"] = json!((geo.step_m[0] * geo.step_m[1]).sqrt());
            facts["crs"] = json!(geo.crs.name);
            facts["epsg"] = json!(geo.crs.epsg);
            facts["geographic"] = json!(geo.crs.geographic);
            facts["has_colours"] = json!(false);
            facts["colours"] = json!(["height", "slope", "aspect", "level", "plain"]);
            facts["centre_lon_lat"] = json!(session.lon_lat_from_local(bounds.centre().truncate()));
            facts["max_error_m"] = json!(feed.meta.max_error_m);
            facts["credit"] = json!(feed.meta.source);
        }
        _ => {
            if let Ok(meta) = head.clusters() {
                let crs = meta.tin.as_ref().map(|tin| &tin.crs);
                facts["bounds"] = json!({ "min": meta.bounds.min.to_array(), "max": meta.bounds.max.to_array() });
                facts["triangles"] = json!(meta.source_faces);
                facts["crs"] = json!(crs.map_or("", |crs| crs.name.as_str()));
                facts["epsg"] = json!(crs.and_then(|crs| crs.epsg));
                facts["geographic"] = json!(false);
                facts["has_colours"] = json!(meta.has_colours);
                facts["colours"] = json!(["own", "height", "slope", "aspect", "level", "plain"]);
                facts["max_error_m"] = json!(meta.max_error_m);
                facts["credit"] = json!(meta.source);
            }
        }
    }
    facts.to_string()
}

impl Session {
    /// The camera as source coordinates of eye and target, or the map's pose.
    fn pose(&self) -> serde_json::Value {
        let round = |v: f64, digits: i32| (v * 10f64.powi(digits)).round() / 10f64.powi(digits);
        let place = |p: DVec3| [round(p.x, 2), round(p.y, 2), round(p.z, 2)];
        let mut pose = with_stage!(&self.content, stage => {
            let view = stage.rig.view(self.size_px);
            json!({ "eye": place(view.eye), "target": place(view.target), "fov_deg": round(view.fov_y_rad.to_degrees(), 2),
                "fly": stage.rig.mode() == RigMode::Fly })
        }, else json!({}));
        if let Some(map) = &self.maps.stage {
            let [lon, lat] = map.plane.to_lon_lat(map.pose.centre);
            let held = map.pose.held(self.size_px).map(|shares| shares.map(|v| round(v, 4)));
            pose["map"] = json!({ "lon": round(lon, 6), "lat": round(lat, 6), "held": held,
                "up_deg": round(map.pose.up_azimuth_rad.to_degrees(), 2) });
        }
        pose
    }

    fn set_pose(&mut self, json: &str) -> Result<(), String> {
        #[derive(serde::Deserialize)]
        struct Eye {
            eye: Option<[f64; 3]>,
            target: Option<[f64; 3]>,
            fov_deg: Option<f64>,
            fly: Option<bool>,
            map: Option<MapPlace>,
        }
        #[derive(serde::Deserialize)]
        struct MapPlace {
            lon: f64,
            lat: f64,
            held: Option<[f64; 3]>,
        }
        let given: Eye = serde_json::from_str(json).map_err(|e| format!("view: {e}"))?;
        if let (Some(eye), Some(target)) = (given.eye, given.target) {
            let (eye, target) = (DVec3::from_array(eye), DVec3::from_array(target));
            let far = |p: DVec3| !(p.is_finite() && p.abs().max_element() < 1e9);
            if far(eye) || far(target) || eye.distance(target) < 1e-6 {
                return Err("view: expected eye and target as two places".to_owned());
            }
            let fov_y_rad = given.fov_deg.filter(|d| (1.0..=120.0).contains(d)).map(f64::to_radians);
            let size_px = self.size_px;
            with_stage!(&mut self.content, stage => {
                let fov_y_rad = fov_y_rad.unwrap_or(stage.rig.fov_y_rad);
                if let Some(fly) = given.fly {
                    stage.rig.set_mode(if fly { RigMode::Fly } else { RigMode::Orbit }, None);
                }
                stage.rig.jump_to(&View { eye, target, fov_y_rad, viewport_px: size_px });
            }, else ());
        }
        if let Some(place) = given.map {
            self.centre_map([place.lon, place.lat], place.held)?;
        }
        Ok(())
    }
}
