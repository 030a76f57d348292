//! Places as the page asks for them: under a pixel, along a line, on the screen, on the globe.

use crate::pick::{along, land, mesh_height_m};
use crate::session::{Content, Session, with_stage};
use crate::settings::Mode;
use glam::{DVec2, DVec3};
use serde::Serialize;
use yamanami::core::{PAGE_CELLS, PageId, Perspective, Projection};
use yamanami::io::crs;
use yamanami::{Subject, Terrain};

/// Pages that a profile may ask for.
const PROFILE_PAGES: usize = 64;
/// Ground this much nearer than a place hides it, relatively.
const HIDDEN_SHARE: f64 = 0.02;

/// What lies under a pixel.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Picked {
    local: [f64; 3],
    source: [f64; 2],
    lon_lat: Option<[f64; 2]>,
    height_m: f64,
    slope_deg: f64,
    /// Direction of fall, clockwise from north.
    aspect_deg: f64,
    distance_m: f64,
    spacing_m: Option<f64>,
    exact: bool,
}

/// Heights along a line.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct Profile {
    pub(crate) distance_m: Vec<f64>,
    /// `null` where there is no ground.
    pub(crate) height_m: Vec<Option<f64>>,
    pub(crate) spacing_m: Option<f64>,
    pub(crate) exact: bool,
}

impl Session {
    /// What lies under a pixel, if anything.
    pub(crate) fn pick(&self, px: DVec2) -> Option<Picked> {
        if let Some(map) = self.maps.stage.as_ref().filter(|_| self.settings.mode == Mode::Map) {
            let (place, normal) = map.pick(&self.settings, self.size_px, px)?;
            let lon_lat = map.plane.to_lon_lat(place.truncate());
            let local = self.local_from_lon_lat(lon_lat).unwrap_or(DVec2::NAN);
            let exact = self.terrain().and_then(|terrain| land(terrain, local));
            let distance_m = (place.truncate() - map.pose.centre).length();
            let (height_m, normal) = exact.map_or((place.z, normal), |land| (land.height_m, land.normal));
            let place = local.extend(height_m);
            return Some(self.picked(
                place,
                normal,
                distance_m,
                exact.map(|l| l.spacing_m),
                exact.is_some_and(|l| l.is_exact),
            ));
        }
        match &self.content {
            Content::Terrain(stage) => {
                let view = stage.rig.view(self.size_px);
                let place = stage.hit(&view, px)?;
                let land = land(&stage.subject, place.truncate())?;
                let place = place.truncate().extend(land.height_m);
                Some(self.picked(place, land.normal, view.eye.distance(place), Some(land.spacing_m), land.is_exact))
            }
            Content::Model(stage) => {
                let view = stage.rig.view(self.size_px);
                let direction = yamanami::steer::ray_through(&view, px.to_array());
                let hit = crate::pick::hit_mesh(stage.scene().canvas().buffers(), view.eye, direction)?;
                Some(self.picked(hit.place, hit.normal, view.eye.distance(hit.place), None, false))
            }
            _ => None,
        }
    }

    fn picked(&self, local: DVec3, normal: DVec3, distance_m: f64, spacing_m: Option<f64>, exact: bool) -> Picked {
        let source = with_stage!(&self.content, stage => stage.subject.source_from_local(local), else local);
        let aspect_deg = normal.x.atan2(normal.y).to_degrees().rem_euclid(360.0);
        Picked {
            local: local.to_array(),
            source: [source.x, source.y],
            lon_lat: self.lon_lat_from_local(local.truncate()),
            height_m: local.z,
            slope_deg: normal.z.abs().clamp(0.0, 1.0).acos().to_degrees(),
            aspect_deg,
            distance_m,
            spacing_m,
            exact,
        }
    }

    /// Heights along a line of the local frame; finer data are wanted from now on where there are any.
    pub(crate) fn profile(&mut self, line: &[DVec2], samples: usize) -> Profile {
        let places = along(line, samples);
        let distance_m = places.iter().map(|&(distance_m, _)| distance_m).collect();
        match &mut self.content {
            Content::Terrain(stage) => {
                let pages = profile_pages(&stage.subject, &places);
                stage.feed.pin(pages.iter().copied());
                self.profile_pages = pages;
                let lands: Vec<_> = places.iter().map(|&(_, place)| land(&stage.subject, place)).collect();
                let spacing_m = lands.iter().flatten().map(|l| l.spacing_m).reduce(f64::max);
                Profile {
                    distance_m,
                    height_m: lands.iter().map(|land| land.map(|l| l.height_m)).collect(),
                    spacing_m,
                    exact: lands.iter().flatten().all(|l| l.is_exact),
                }
            }
            Content::Model(stage) => {
                let mesh = stage.scene().canvas().buffers();
                let height =
                    |&(_, place): &(f64, DVec2)| mesh_height_m(&stage.subject, mesh, place).map(|hit| hit.place.z);
                Profile { distance_m, height_m: places.iter().map(height).collect(), spacing_m: None, exact: false }
            }
            _ => Profile::default(),
        }
    }

    /// The profile's pages may go.
    pub(crate) fn clear_profile(&mut self) {
        self.profile_pages.clear();
        if let Content::Terrain(stage) = &mut self.content {
            stage.feed.pin([]);
        }
    }

    /// Pixels of places of the local frame, and whether they are seen.
    pub(crate) fn to_screen(&self, places: &[DVec3]) -> Vec<(DVec2, bool)> {
        let [width, height] = self.size_px.map(f64::from);
        let inside = |px: DVec2| px.cmpge(DVec2::ZERO).all() && px.x < width && px.y < height;
        if let Some(map) = self.maps.stage.as_ref().filter(|_| self.settings.mode == Mode::Map) {
            let view = map.view(&self.settings, self.size_px);
            let project = |place: &DVec3| {
                let Some(lon_lat) = self.lon_lat_from_local(place.truncate()) else { return (DVec2::NAN, false) };
                let plane = map.plane.to_plane(lon_lat[0], lon_lat[1]);
                let height_m = if place.z.is_finite() { place.z } else { map.height_m(plane) };
                let px = view.px_from_plane(plane.extend(height_m));
                let is_seen = (plane - view.map.centre).length() <= view.rim_m && inside(px);
                (px, is_seen)
            };
            return places.iter().map(project).collect();
        }
        with_stage!(&self.content, stage => {
            let view = stage.rig.view(self.size_px);
            let projection = Perspective::new(view, 1e-3, 1e12);
            let is_ground = stage.subject.as_terrain().is_some();
            let project = |&place: &DVec3| {
                let clip = projection.clip_from_world(place);
                if clip.w <= 0.0 || !place.is_finite() {
                    return (DVec2::NAN, false);
                }
                let px = DVec2::new((clip.x / clip.w + 1.0) * 0.5 * width, (1.0 - clip.y / clip.w) * 0.5 * height);
                let distance_m = view.eye.distance(place);
                let hides = |hit: DVec3| view.eye.distance(hit) < distance_m * (1.0 - HIDDEN_SHARE);
                let is_seen = inside(px) && !(is_ground && stage.hit(&view, px).is_some_and(hides));
                (px, is_seen)
            };
            places.iter().map(project).collect()
        }, else vec![(DVec2::NAN, false); places.len()])
    }

    /// Place of the local frame of a longitude and latitude, on the terrain.
    pub(crate) fn local_from_lon_lat(&self, [lon, lat]: [f64; 2]) -> Option<DVec2> {
        let geo = self.geo()?;
        let [x, y] = crs::from_lon_lat(&geo.crs, lon, lat)?;
        Some(geo.local_from_source(x, y).into())
    }

    /// The same with the land's height, where there is land.
    pub(crate) fn land_from_lon_lat(&self, lon_lat: [f64; 2]) -> Option<DVec3> {
        let place = self.local_from_lon_lat(lon_lat)?;
        Some(place.extend(land(self.terrain()?, place)?.height_m))
    }

    /// Longitude and latitude of a place of the local frame.
    pub(crate) fn lon_lat_from_local(&self, place: DVec2) -> Option<[f64; 2]> {
        if let Content::Model(stage) = &self.content {
            let (crs, unit_m) = stage.subject.crs_and_unit(true);
            return crs::to_lon_lat(&crs, place.x / unit_m, place.y / unit_m);
        }
        let geo = self.geo()?;
        let [x, y] = geo.source_from_local(place.x, place.y);
        crs::to_lon_lat(&geo.crs, x, y)
    }

    fn terrain(&self) -> Option<&Terrain> {
        match &self.content {
            Content::Terrain(stage) => Some(&stage.subject),
            _ => None,
        }
    }
}

/// The pages of the finest level on which a line does not cross too many.
fn profile_pages(terrain: &Terrain, places: &[(f64, DVec2)]) -> Vec<PageId> {
    let lattice = terrain.surface().numbers().lattice();
    for level in 0..=lattice.levels() {
        let [nx, ny] = lattice.squares(level);
        let mut pages: Vec<PageId> = Vec::new();
        for &(_, place) in places {
            let [column, row] = terrain.geo().grid_from_local(place.x, place.y);
            if !(column >= 0.0
                && row >= 0.0
                && column < f64::from(lattice.width())
                && row < f64::from(lattice.height()))
            {
                continue;
            }
            let tile = |at: f64, squares: u32| (((at as u64) >> level) as u32).min(squares - 1) / PAGE_CELLS;
            let id = PageId { level, x: tile(column, nx), y: tile(row, ny) };
            if !pages.contains(&id) {
                pages.push(id);
            }
        }
        if pages.len() <= PROFILE_PAGES {
            return pages;
        }
    }
    Vec::new()
}
