//! All that the page's controls turn, as JSON, and what it means for the front and for its picture.

use serde::{Deserialize, Serialize};
use yamanami::core::{Curvature, DeformedMap, DropFrom, View};
use yamanami::gpu::{ColourBy, Haze, Light, Morph, RenderOptions, Wireframe};
use yamanami::{Criteria, Lod, Staircase, Subject, ViewCriterion};

/// Colour where the surface is to be plain, sRGB.
const PLAIN: [u8; 3] = [206, 200, 188];
/// Geomorphing: a detail is whole once its error is this much above the threshold, relatively.
const MORPH_WIDTH: f32 = 0.5;
/// Triangles that a small device draws with ease.
const USUAL_BUDGET: u32 = 120_000;

/// What moves the front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Control {
    /// The exact controller.
    Exact,
    /// The paper's staircase.
    Paper,
}

/// What colours the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Colour {
    Own,
    Height,
    Slope,
    Aspect,
    Level,
    Plain,
}

/// How the ground is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Mode {
    /// In perspective.
    Relief,
    /// As a deformed map.
    Map,
}

/// From where the Earth curves down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Curve {
    None,
    Ring,
    Centre,
}

/// The numbers of a deformed map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct MapSettings {
    pub(crate) alpha: f64,
    pub(crate) alpha_fall: f64,
    pub(crate) ring_km: f64,
    pub(crate) eye_m: f64,
    pub(crate) exaggeration: f64,
    pub(crate) curvature: Curve,
    pub(crate) radius_km: f64,
    pub(crate) veil: bool,
    pub(crate) up_deg: f64,
}

/// The settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Settings {
    pub(crate) tolerance_m: f32,
    pub(crate) tolerance_px: f32,
    pub(crate) budget: Option<u32>,
    pub(crate) hysteresis: f32,
    pub(crate) control: Control,
    pub(crate) intervals: usize,
    pub(crate) gain: f32,
    pub(crate) rebuild: bool,
    pub(crate) morph: bool,
    pub(crate) wireframe: bool,
    pub(crate) colour: Colour,
    pub(crate) haze: bool,
    pub(crate) antialias: bool,
    pub(crate) water_m: Option<f64>,
    pub(crate) sun_azimuth_deg: f32,
    pub(crate) sun_altitude_deg: f32,
    pub(crate) mode: Mode,
    pub(crate) map: MapSettings,
}

impl Default for MapSettings {
    fn default() -> Self {
        Self {
            alpha: 0.0,
            alpha_fall: 0.0,
            ring_km: 10.0,
            eye_m: 5000.0,
            exaggeration: 1.0,
            curvature: Curve::None,
            radius_km: 160.0,
            veil: false,
            up_deg: 0.0,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance_m: 0.0,
            tolerance_px: 1.0,
            budget: Some(USUAL_BUDGET),
            hysteresis: 0.0,
            control: Control::Exact,
            intervals: 5,
            gain: 0.5,
            rebuild: false,
            morph: true,
            wireframe: false,
            colour: Colour::Height,
            haze: true,
            antialias: true,
            water_m: None,
            sun_azimuth_deg: 315.0,
            sun_altitude_deg: 45.0,
            mode: Mode::Relief,
            map: MapSettings::default(),
        }
    }
}

impl Settings {
    /// What a surface begins with.
    pub(crate) fn of(subject: &impl Subject) -> Self {
        let usual = subject.usual_style();
        let colour = if usual.colour == ColourBy::Height { Colour::Height } else { Colour::Own };
        let bounds = subject.bounds();
        let radius_km = (0.5e-3 * (bounds.max - bounds.min).truncate().length()).clamp(0.05, 160.0);
        let ring_km = (radius_km / 6.0).min(10.0);
        let eye_m = (500.0 * ring_km).max(1.3 * bounds.max.z.max(0.0) + 0.05 * (bounds.max.z - bounds.min.z));
        // a model's detail is all it has; terrain far below a metre is not
        let tolerance_m = if subject.is_ground() { 0.5 } else { 0.0 };
        Self {
            colour,
            tolerance_m,
            map: MapSettings { radius_km, ring_km, eye_m, ..MapSettings::default() },
            ..Self::default()
        }
    }

    /// These settings with some keys changed; what is wrong with them in one line.
    pub(crate) fn changed(&self, json: &str) -> Result<Self, String> {
        let in_words = |e: serde_json::Error| format!("settings: {e}");
        let mut all = serde_json::to_value(self).map_err(in_words)?;
        let change: serde_json::Value = serde_json::from_str(json).map_err(in_words)?;
        merge(&mut all, change).map_err(|key| format!("settings: there is no `{key}`"))?;
        let changed: Self = serde_json::from_value(all).map_err(in_words)?;
        changed.check().map(|()| changed)
    }

    fn check(&self) -> Result<(), String> {
        let within = |name: &str, value: f64, least: f64, most: f64| {
            let is_right = (least..=most).contains(&value);
            if is_right { Ok(()) } else { Err(format!("{name}: expected {least} to {most}, got {value}")) }
        };
        within("tolerance_m", self.tolerance_m.into(), 0.0, 1e6)?;
        within("tolerance_px", self.tolerance_px.into(), 1e-3, 1e4)?;
        within("budget", self.budget.unwrap_or(1000).into(), 10.0, 1e8)?;
        within("hysteresis", self.hysteresis.into(), 0.0, 1.0)?;
        within("intervals", self.intervals as f64, 1.0, 100.0)?;
        within("gain", self.gain.into(), 0.0, 10.0)?;
        within("water_m", self.water_m.unwrap_or(0.0), -1e5, 1e5)?;
        within("sun_azimuth_deg", self.sun_azimuth_deg.into(), -360.0, 360.0)?;
        within("sun_altitude_deg", self.sun_altitude_deg.into(), 1.0, 90.0)?;
        within("alpha_fall", self.map.alpha_fall, 0.0, 8.0)?;
        within("radius_km", self.map.radius_km, 0.01, 1000.0)?;
        within("up_deg", self.map.up_deg, -360.0, 360.0)?;
        self.deformed().check().map_err(|fault| fault.to_string())
    }

    /// What is asked of the front for a view.
    pub(crate) fn criteria(&self, view: View) -> Criteria {
        Criteria {
            terrain_tolerance_m: self.tolerance_m,
            view: Some(ViewCriterion { view, tolerance_px: self.tolerance_px, cull: true }),
            budget_triangles: self.budget,
            hysteresis: self.hysteresis,
            ..Criteria::default()
        }
    }

    /// The control of the front. The staircase reaches from the eye over the diagonal.
    pub(crate) fn lod(&self, diagonal_m: f64) -> Lod {
        match self.control {
            Control::Exact => Lod::Exact,
            Control::Paper => {
                let staircase = Staircase::new(self.tolerance_m, 0.0, 1.2 * diagonal_m, self.intervals);
                Lod::Paper(Staircase { gain: self.gain, ..staircase })
            }
        }
    }

    /// Whether another control than before must start from the base mesh.
    pub(crate) fn restarts(&self, before: &Self) -> bool {
        let paper = |s: &Self| (s.control == Control::Paper).then_some((s.tolerance_m, s.intervals, s.gain));
        paper(self) != paper(before)
    }

    /// The style of the picture. `threshold_px` is what is in force, where details may fade in.
    pub(crate) fn style(&self, subject: &impl Subject, threshold_px: Option<f32>) -> RenderOptions {
        let usual = subject.usual_style();
        RenderOptions {
            colour: match self.colour {
                Colour::Own => usual.colour,
                Colour::Height => ColourBy::Height,
                Colour::Level => ColourBy::Level,
                Colour::Plain => ColourBy::Plain(PLAIN),
                Colour::Slope => ColourBy::Slope,
                Colour::Aspect => ColourBy::Aspect,
            },
            deepest_level: usual.deepest_level.saturating_sub(1).max(1),
            light: Light {
                sun_azimuth_rad: self.sun_azimuth_deg.to_radians(),
                sun_altitude_rad: self.sun_altitude_deg.to_radians(),
                ..usual.light
            },
            water_level_m: self.water_m,
            morph: threshold_px.filter(|_| self.morph).map(|tau_px| Morph { tau_px, width: MORPH_WIDTH }),
            wireframe: self.wireframe.then(Wireframe::default),
            haze: if self.haze { usual.haze } else { Haze::None },
            antialias: self.antialias,
            ..usual
        }
    }

    /// The projection of the deformed map, unchecked.
    pub(crate) fn deformed(&self) -> DeformedMap {
        let map = &self.map;
        let (ring_m, eye_m) = (1e3 * map.ring_km, map.eye_m);
        let from = match map.curvature {
            Curve::None => None,
            Curve::Ring => Some(DropFrom::Ring),
            Curve::Centre => Some(DropFrom::Centre),
        };
        DeformedMap {
            ring_m,
            eye_m,
            alpha: map.alpha,
            alpha_fall: map.alpha_fall,
            scale: DeformedMap::smooth_scale(ring_m, eye_m),
            exaggeration: map.exaggeration,
            curvature: from.map(|from| Curvature { refraction: 0.13, from }),
            ..DeformedMap::default()
        }
    }
}

/// Lays one object over another; the name of a key that is not there.
fn merge(all: &mut serde_json::Value, change: serde_json::Value) -> Result<(), String> {
    match (all, change) {
        (serde_json::Value::Object(all), serde_json::Value::Object(change)) => {
            for (key, value) in change {
                let Some(old) = all.get_mut(&key) else { return Err(key) };
                if old.is_object() { merge(old, value)? } else { *old = value }
            }
            Ok(())
        }
        _ => Err("settings must be an object".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_keys_change_and_the_others_stay() {
        let settings = Settings::default();
        let changed = settings.changed(r#"{"budget":null,"map":{"alpha":0.5},"colour":"slope"}"#).unwrap();
        assert_eq!((changed.budget, changed.map.alpha, changed.colour), (None, 0.5, Colour::Slope));
        assert_eq!(changed.map.ring_km, settings.map.ring_km);
    }

    #[test]
    fn nonsense_is_told_in_one_line() {
        for nonsense in [
            "",
            "[]",
            "3",
            r#"{"alpha":1}"#,
            r#"{"map":3}"#,
            r#"{"budget":-1}"#,
            r#"{"map":{"alpha":7}}"#,
            r#"{"tolerance_px":0}"#,
            r#"{"colour":"pink"}"#,
            r#"{"map":{"ring_km":null}}"#,
        ] {
            let message = Settings::default().changed(nonsense).unwrap_err();
            assert!(!message.is_empty() && !message.contains('\n'), "{nonsense}: {message}");
        }
    }
}
