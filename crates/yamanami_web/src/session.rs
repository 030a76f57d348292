//! One packed surface being shown: what is asked for, what came, what it is shown as. Knows no browser; tested without one.

use crate::feed::{ModelFeed, ModelOpening, ROWS_AT_ONCE, TerrainFeed};
use crate::map::{MapReading, MapStage, Read};
use crate::settings::{Mode, Settings};
use crate::stage::{Numbers, Stage};
use crate::stream::{Arrived, Item, PackStream, Request, kept_start};
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::path::Path;
use yamanami::core::{GeoReference, PageId};
use yamanami::gpu::Gpu;
use yamanami::gpu::wgpu;
use yamanami::io::crs;
use yamanami::io::pack::layout::{PackHead, PackKind};
use yamanami::{Canvas, DrawWith, Error, Model, Subject, Terrain};

/// What is shown, or on its way to be.
#[derive(Debug)]
pub(crate) enum Content {
    OpeningTerrain(Box<(TerrainFeed, Terrain)>),
    OpeningModel(Box<ModelOpening>),
    Terrain(Box<Stage<TerrainFeed>>),
    Model(Box<Stage<ModelFeed>>),
    /// It cannot be shown.
    Lost,
}

/// Does the same with either kind of stage.
macro_rules! with_stage {
    ($content:expr, $stage:ident => $call:expr, else $other:expr) => {
        match $content {
            Content::Terrain($stage) => $call,
            Content::Model($stage) => $call,
            _ => $other,
        }
    };
}
pub(crate) use with_stage;

/// The deformed map beside the perspective.
#[derive(Debug, Default)]
pub(crate) struct Maps {
    reading: Option<MapReading>,
    pub(crate) stage: Option<Box<MapStage>>,
    /// What the ground was read for: centre and radius.
    asked: Option<([f64; 2], f64)>,
    /// Where the map is to be, by a link.
    wish: Option<[f64; 2]>,
    /// How it is to be held in the picture, by a link.
    wish_held: Option<[f64; 3]>,
    fault: Option<String>,
}

/// The session.
#[derive(Debug)]
pub(crate) struct Session {
    pub(crate) stream: PackStream,
    pub(crate) content: Content,
    pub(crate) settings: Settings,
    pub(crate) maps: Maps,
    pub(crate) size_px: [u32; 2],
    gpu: Option<Gpu>,
    memory_bytes: usize,
    /// Pages along a profile.
    pub(crate) profile_pages: Vec<PageId>,
    /// Damage that has not been told.
    damage: Option<String>,
    must_draw: bool,
}

/// Bytes of pages kept unless told otherwise.
const USUAL_MEMORY_BYTES: usize = 256 << 20;

/// What the first bytes of a packed surface are.
pub(crate) enum Start {
    /// The head is longer: so many bytes are needed.
    Needs(usize),
    /// It can be opened.
    Opened(Box<Session>),
}

impl Session {
    /// Opens a packed surface from its first bytes; without a GPU it is drawn in software.
    pub(crate) fn open(start: Vec<u8>, size_px: [u32; 2], gpu: Option<Gpu>) -> Result<Start, String> {
        let name = Path::new("surface");
        let needed = PackHead::length(name, &start).map_err(|e| e.to_string())?;
        if start.len() < needed {
            return Ok(Start::Needs(needed));
        }
        let head = PackHead::parse(name, &start).map_err(|e| e.to_string())?;
        let content = match head.kind {
            PackKind::Terrain => Content::OpeningTerrain(Box::new(TerrainFeed::open(&head)?)),
            PackKind::Model | PackKind::Tin => Content::OpeningModel(Box::new(ModelOpening::new(&head)?)),
        };
        let settings = match &content {
            Content::OpeningTerrain(opening) => Settings::of(&opening.1),
            _ => Settings::default(),
        };
        Ok(Start::Opened(Box::new(Self {
            stream: PackStream::new(head, kept_start(start)),
            content,
            settings,
            maps: Maps::default(),
            size_px,
            gpu,
            memory_bytes: USUAL_MEMORY_BYTES,
            profile_pages: Vec::new(),
            damage: None,
            must_draw: true,
        })))
    }

    /// Says what is wanted now, takes what is at hand, and gives the ranges to fetch so that at most `most` are in flight.
    pub(crate) fn requests(&mut self, most: usize) -> Result<Vec<Request>, String> {
        // what is at hand may open the way to more
        for _ in 0..64 {
            let rows = self.rows();
            let at_hand = self.stream.want(rows);
            if at_hand.is_empty() {
                break;
            }
            self.take(at_hand)?;
        }
        Ok(self.stream.requests(most))
    }

    /// Takes the bytes of a request.
    pub(crate) fn receive(&mut self, id: u32, bytes: &[u8]) -> Result<(), String> {
        let arrived = self.stream.receive(id, bytes).map_err(|e| e.to_string())?;
        self.take(arrived)?;
        self.damage.take().map_or(Ok(()), Err)
    }

    /// All rows that are wanted, the most urgent first.
    fn rows(&mut self) -> Vec<Item> {
        let is_map = self.settings.mode == Mode::Map;
        let mut rows = match &mut self.content {
            Content::OpeningTerrain(opening) => opening.0.first_rows(&opening.1),
            Content::OpeningModel(opening) => opening.rows(),
            Content::Terrain(stage) => {
                let pinned = stage.feed.pinned_rows(&stage.subject);
                let front = stage.rows();
                if is_map { [pinned, front].concat() } else { [front, pinned].concat() }
            }
            Content::Model(stage) => stage.rows(),
            Content::Lost => Vec::new(),
        };
        rows.truncate(2 * ROWS_AT_ONCE);
        rows
    }

    fn take(&mut self, arrived: Vec<Arrived>) -> Result<(), String> {
        if arrived.is_empty() {
            return Ok(());
        }
        let damage = match &mut self.content {
            Content::OpeningTerrain(opening) => {
                let (feed, terrain) = &mut **opening;
                let taken = crate::feed::Feed::take(feed, terrain, arrived);
                if feed.is_lost() {
                    let found = taken.damage.unwrap_or_default();
                    self.content = Content::Lost;
                    return Err(found);
                }
                taken.damage
            }
            Content::OpeningModel(opening) => match opening.take(arrived) {
                Ok(Some((feed, model))) => return self.show_model(feed, model),
                Ok(None) => None,
                Err(found) => {
                    self.content = Content::Lost;
                    return Err(found);
                }
            },
            Content::Terrain(stage) => stage.take(arrived),
            Content::Model(stage) => stage.take(arrived),
            Content::Lost => None,
        };
        self.damage = damage.or(self.damage.take());
        self.show_terrain()
    }

    fn show_model(&mut self, feed: ModelFeed, model: Model) -> Result<(), String> {
        let canvas = self.canvas(&model)?;
        self.settings = Settings { mode: Mode::Relief, ..Settings::of(&model) };
        let mut stage = Stage::new(model, feed, canvas, &self.settings, self.size_px);
        stage.set_memory(self.memory_bytes);
        self.content = Content::Model(Box::new(stage));
        Ok(())
    }

    /// Shows the terrain once all that must be there is.
    fn show_terrain(&mut self) -> Result<(), String> {
        match &self.content {
            Content::OpeningTerrain(opening) if opening.0.first_rows(&opening.1).is_empty() => {}
            _ => return Ok(()),
        }
        let Content::OpeningTerrain(opening) = std::mem::replace(&mut self.content, Content::Lost) else {
            return Ok(());
        };
        let (feed, terrain) = *opening;
        let canvas = self.canvas(&terrain)?;
        let mut stage = Stage::new(terrain, feed, canvas, &self.settings, self.size_px);
        stage.set_memory(self.memory_bytes);
        self.content = Content::Terrain(Box::new(stage));
        Ok(())
    }

    fn canvas(&self, subject: &impl Subject) -> Result<Canvas, String> {
        let origin = subject.bounds().centre();
        match &self.gpu {
            Some(gpu) => Ok(Canvas::on_gpu(gpu, origin)),
            None => Canvas::new(origin, DrawWith::Software).map_err(|e| e.to_string()),
        }
    }

    /// Keeps at most so many bytes of pages.
    pub(crate) fn set_memory(&mut self, bytes: usize) {
        self.memory_bytes = bytes;
        with_stage!(&mut self.content, stage => stage.set_memory(bytes), else ());
    }

    /// Changes settings; what is wrong with them.
    pub(crate) fn change(&mut self, json: &str) -> Result<(), String> {
        let changed = self.settings.changed(json)?;
        if changed.mode == Mode::Map && !self.can_map() {
            return Err("mode: a deformed map is made of terrains whose coordinate system is known".to_owned());
        }
        let restarts = changed.restarts(&self.settings);
        self.settings = changed;
        if let Some(map) = &mut self.maps.stage {
            map.pose.up_azimuth_rad = self.settings.map.up_deg.to_radians();
        }
        if restarts {
            let settings = &self.settings;
            with_stage!(&mut self.content, stage => stage.restart(settings), else ());
        }
        self.must_draw = true;
        Ok(())
    }

    /// Centres the deformed map at a longitude and latitude, held in the picture so, or fitted to it.
    pub(crate) fn centre_map(&mut self, [lon, lat]: [f64; 2], held: Option<[f64; 3]>) -> Result<(), String> {
        if !(lon.abs() <= 360.0 && lat.abs() <= 90.0) {
            return Err(format!("view: expected a longitude and latitude, got {lon}, {lat}"));
        }
        (self.maps.wish, self.maps.wish_held) = (Some([lon, lat]), held);
        Ok(())
    }

    /// Notes how long the picture took.
    pub(crate) fn set_draw_ms(&mut self, draw_ms: f64) {
        match &mut self.maps.stage {
            Some(map) if self.settings.mode == Mode::Map => map.numbers.draw_ms = draw_ms,
            _ => with_stage!(&mut self.content, stage => stage.numbers.draw_ms = draw_ms, else ()),
        }
    }

    /// The picture has another size.
    pub(crate) fn resize(&mut self, size_px: [u32; 2]) {
        self.size_px = size_px.map(|n| n.clamp(1, 16384));
        self.must_draw = true;
    }

    /// Whether a deformed map can be made of the surface.
    pub(crate) fn can_map(&self) -> bool {
        self.geo().is_some_and(|geo| crs::is_known(&geo.crs))
    }

    /// Where a terrain's grid lies.
    pub(crate) fn geo(&self) -> Option<&GeoReference> {
        match &self.content {
            Content::OpeningTerrain(opening) => Some(&opening.0.meta.geo),
            Content::Terrain(stage) => Some(&stage.feed.meta.geo),
            _ => None,
        }
    }

    /// Moves everything on; whether there is something new to draw.
    pub(crate) fn update(&mut self, dt_s: f64) -> Result<bool, Error> {
        let size_px = self.size_px;
        let settings = &self.settings;
        let mut changed = std::mem::take(&mut self.must_draw);
        let is_map = settings.mode == Mode::Map;
        if is_map {
            self.update_map()?;
        }
        match &mut self.maps.stage {
            Some(stage) if is_map => changed |= stage.update(&self.settings, size_px)?,
            // the perspective is seen until the map is there
            _ => {
                let settings = &self.settings;
                changed |= with_stage!(&mut self.content, stage => stage.update(settings, size_px, dt_s)?, else false);
            }
        }
        Ok(changed)
    }

    /// Whether the next frame changes something by itself.
    pub(crate) fn is_moving(&self) -> bool {
        if self.settings.mode == Mode::Map {
            return self.maps.reading.is_some() || self.maps.stage.as_ref().is_none_or(|stage| stage.is_moving());
        }
        with_stage!(&self.content, stage => stage.is_moving(), else false)
    }

    /// Whether nothing that could be shown finer is on its way, or must be asked for.
    pub(crate) fn is_complete(&self) -> bool {
        let has_all = match &self.content {
            Content::OpeningTerrain(_) | Content::OpeningModel(_) => false,
            Content::Terrain(stage) => stage.rows().is_empty() && stage.feed.has_pinned(&stage.subject),
            Content::Model(stage) => stage.rows().is_empty(),
            Content::Lost => true,
        };
        has_all && self.stream.in_flight() == 0 && !self.is_moving()
    }

    /// Reads the ground of the map where it must be, as far as its pages have come.
    fn update_map(&mut self) -> Result<(), Error> {
        let Content::Terrain(stage) = &mut self.content else { return Ok(()) };
        let radius_km = self.settings.map.radius_km;
        let moved = self.maps.stage.as_ref().and_then(|map| map.outgrown(&self.settings));
        let asked = self.maps.wish.take().or(moved).or(self.maps.asked.map(|(centre, _)| centre));
        let centre = asked.or_else(|| middle(&stage.feed.meta.geo, stage));
        let Some(centre) = centre else { return Ok(()) };
        if self.maps.asked != Some((centre, radius_km)) {
            let step_m = stage.feed.meta.geo.step_m;
            self.maps.reading = Some(MapReading::new(centre, radius_km, step_m[0].min(step_m[1])));
            self.maps.asked = Some((centre, radius_km));
            self.maps.fault = None;
        }
        let Some(reading) = &self.maps.reading else { return Ok(()) };
        if !stage.feed.has_pinned(&stage.subject) {
            return Ok(());
        }
        let pinned = stage.feed.pinned_ids();
        let have: HashMap<PageId, _> =
            pinned.iter().filter_map(|&id| Some((id, stage.feed.pinned_page(id, &stage.subject)?))).collect();
        match reading.read(&stage.feed.meta, have, |id| stage.feed.is_damaged(id), self.gpu.as_ref()) {
            Ok(Read::Missing(missing)) => {
                let profile = self.profile_pages.iter().copied();
                stage.feed.pin(pinned.into_iter().chain(missing).chain(profile).collect::<Vec<_>>());
            }
            Ok(Read::Ready(mut map)) => {
                if let Some(before) = &self.maps.stage {
                    // size and place in the picture stay; the centre is the plane's origin now
                    map.pose = before.pose;
                    map.pose.centre = DVec2::ZERO;
                }
                map.pose.up_azimuth_rad = self.settings.map.up_deg.to_radians();
                if let Some(held) = self.maps.wish_held.take() {
                    map.pose.hold(held, self.size_px);
                }
                (self.maps.stage, self.maps.reading) = (Some(map), None);
                stage.feed.pin(self.profile_pages.iter().copied());
            }
            Err(error) => {
                (self.maps.reading, self.maps.fault) = (None, Some(error.to_string()));
            }
        }
        Ok(())
    }

    /// Draws on a texture of the session's size.
    pub(crate) fn draw_on(&mut self, target: &wgpu::TextureView, format: wgpu::TextureFormat) -> Result<(), Error> {
        let (settings, size_px) = (&self.settings, self.size_px);
        if let Some(map) = self.maps.stage.as_mut().filter(|_| settings.mode == Mode::Map) {
            return map.draw_on(target, format, settings, size_px);
        }
        with_stage!(&mut self.content, stage => {
            let (view, style) = (stage.rig.view(size_px), stage.style(settings));
            stage.scene_mut().draw_on(target, format, &view, &style)
        }, else Ok(()))
    }

    /// What the last update did.
    pub(crate) fn numbers(&self) -> Numbers {
        let mut numbers = match &self.maps.stage {
            Some(map) if self.settings.mode == Mode::Map => map.numbers.clone(),
            _ => with_stage!(&self.content, stage => stage.numbers.clone(), else Numbers::default()),
        };
        numbers.fault = numbers.fault.or_else(|| self.maps.fault.clone());
        numbers
    }

    /// Bytes of pages in memory.
    pub(crate) fn resident_bytes(&self) -> usize {
        match &self.content {
            Content::Terrain(stage) => match stage.subject.surface().data() {
                yamanami::Data::Paged(data) => data.resident_bytes(),
                yamanami::Data::Grid(_) => 0,
            },
            Content::Model(stage) => stage.subject.surface().resident_bytes(),
            _ => 0,
        }
    }
}

/// Longitude and latitude of the land in the middle of the picture, or of the terrain.
fn middle(geo: &GeoReference, stage: &Stage<TerrainFeed>) -> Option<[f64; 2]> {
    let centre: DVec3 = stage.subject.bounds().centre();
    let [x, y] = geo.source_from_local(centre.x, centre.y);
    crs::to_lon_lat(&geo.crs, x, y)
}
