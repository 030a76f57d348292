//! What a surface says of itself, by name, as a database or the head of a packed surface has it.

use super::cluster::{ClusterMeta, TinMeta};
use super::meta::TerrainMeta;
use super::quantum::Quantum;
use glam::DVec3;
use std::collections::BTreeMap;
use yamanami_core::{Aabb, Crs, GeoReference, Snap};

/// A fact.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Fact {
    Null,
    Integer(i64),
    Real(f64),
    Text(String),
}

/// What a file says of itself, by name.
#[derive(Debug, Default)]
pub(crate) struct Facts(BTreeMap<String, Fact>);

/// Facts that are no surface's: what is missing or wrong.
#[derive(Debug, thiserror::Error)]
#[error("the facts: {0}")]
pub struct FactsError(String);

impl TerrainMeta {
    /// The facts of a terrain by the names that they have in a database, with the radii of its levels, finest first.
    pub fn from_json(
        facts: &serde_json::Map<String, serde_json::Value>,
        bound_radius_m: Vec<f64>,
    ) -> Result<Self, FactsError> {
        let meta = Facts::from_json(facts).and_then(|facts| facts.terrain()).map_err(FactsError)?;
        let meta = Self { bound_radius_m, ..meta };
        meta.check().map_err(FactsError)?;
        Ok(meta)
    }
}

impl ClusterMeta {
    /// The facts of a model by the names that they have in a database.
    pub fn from_json(facts: &serde_json::Map<String, serde_json::Value>) -> Result<Self, FactsError> {
        let meta = Facts::from_json(facts).and_then(|facts| facts.clusters()).map_err(FactsError)?;
        meta.check().map_err(FactsError)?;
        Ok(meta)
    }
}

impl Facts {
    fn from_json(facts: &serde_json::Map<String, serde_json::Value>) -> Result<Self, String> {
        use serde_json::Value;
        let fact = |(key, value): (&String, &Value)| {
            let fact = match value {
                Value::Null => Fact::Null,
                Value::Number(n) if n.is_i64() => Fact::Integer(n.as_i64().unwrap_or_default()),
                Value::Number(n) if n.is_f64() => Fact::Real(n.as_f64().unwrap_or_default()),
                Value::String(text) => Fact::Text(text.clone()),
                other => return Err(format!("`{key}` = {other}")),
            };
            Ok((key.clone(), fact))
        };
        facts.iter().map(fact).collect::<Result<_, _>>().map(Self)
    }

    /// The facts by name; numbers keep their kind, so that they come back as they were.
    #[cfg(feature = "files")]
    pub(crate) fn to_json(&self) -> serde_json::Map<String, serde_json::Value> {
        let value = |fact: &Fact| match fact {
            Fact::Null => serde_json::Value::Null,
            Fact::Integer(number) => (*number).into(),
            Fact::Real(number) => (*number).into(),
            Fact::Text(text) => text.as_str().into(),
        };
        self.0.iter().map(|(key, fact)| (key.clone(), value(fact))).collect()
    }

    /// Adds one.
    #[cfg(feature = "files")]
    pub(crate) fn insert(&mut self, key: String, fact: Fact) {
        self.0.insert(key, fact);
    }

    fn wrong(&self, key: &str) -> String {
        match self.0.get(key) {
            None => format!("no `{key}`"),
            Some(value) => format!("`{key}` = {value:?}"),
        }
    }

    fn integer<T: TryFrom<i64>>(&self, key: &str) -> Result<T, String> {
        let value = if let Some(Fact::Integer(v)) = self.0.get(key) { T::try_from(*v).ok() } else { None };
        value.ok_or_else(|| self.wrong(key))
    }

    fn real(&self, key: &str) -> Result<f64, String> {
        match self.0.get(key) {
            Some(Fact::Real(v)) => Ok(*v),
            _ => Err(self.wrong(key)),
        }
    }

    fn text(&self, key: &str) -> Result<String, String> {
        match self.0.get(key) {
            Some(Fact::Text(text)) => Ok(text.clone()),
            _ => Err(self.wrong(key)),
        }
    }

    fn flag(&self, key: &str) -> Result<bool, String> {
        match self.0.get(key) {
            Some(Fact::Integer(v @ 0..=1)) => Ok(*v == 1),
            _ => Err(self.wrong(key)),
        }
    }

    /// A model; says what is missing or wrong.
    pub(crate) fn clusters(&self) -> Result<ClusterMeta, String> {
        let tin = match self.text("kind")?.as_str() {
            "clusters" => None,
            "tin" => Some(self.tin()?),
            _ => return Err(self.wrong("kind")),
        };
        let corner = |end: &str| -> Result<DVec3, String> {
            let at = |axis: &str| self.real(&format!("{axis}_{end}_m"));
            Ok(DVec3::new(at("x")?, at("y")?, at("z")?))
        };
        Ok(ClusterMeta {
            title: self.text("title")?,
            source: self.text("source")?,
            source_faces: self.integer("source_faces")?,
            source_vertices: self.integer("source_vertices")?,
            bounds: Aabb { min: corner("min")?, max: corner("max")? },
            quantum_m: self.real("quantum_m")?,
            max_error_m: self.real("max_error_m")?,
            has_colours: self.flag("has_colours")?,
            nodes: self.integer("nodes")?,
            triangles: self.integer("triangles")?,
            vertices: self.integer("vertices")?,
            tin,
        })
    }

    fn tin(&self) -> Result<TinMeta, String> {
        let epsg = self.epsg()?;
        let crs = Crs { epsg, name: self.text("crs_name")?, ..Crs::default() };
        let snap = Snap { unit_m: self.real("snap_unit_m")?, per_unit: self.real("snap_per_unit")? };
        Ok(TinMeta { crs, unit_m: self.real("unit_m")?, snap })
    }

    fn epsg(&self) -> Result<Option<u32>, String> {
        match self.0.get("crs_epsg") {
            Some(Fact::Null) => Ok(None),
            _ => Ok(Some(self.integer("crs_epsg")?)),
        }
    }

    /// A terrain, all but its bound radii; says what is missing or wrong.
    pub(crate) fn terrain(&self) -> Result<TerrainMeta, String> {
        if self.text("kind")? != "terrain" {
            return Err(self.wrong("kind"));
        }
        let crs = Crs {
            epsg: self.epsg()?,
            geographic: self.flag("crs_geographic")?,
            web_mercator: self.flag("crs_web_mercator")?,
            name: self.text("crs_name")?,
        };
        let geo = GeoReference {
            crs,
            origin: [self.real("origin_x")?, self.real("origin_y")?],
            step: [self.real("step_x")?, self.real("step_y")?],
            step_m: [self.real("step_x_m")?, self.real("step_y_m")?],
        };
        let quantum = match self.text("quantum")?.as_str() {
            "per_metre" => Quantum::PerMetre(self.integer("quantum_value")?),
            "step_m" => Quantum::Step(self.real("quantum_value")?),
            "bits" => Quantum::Bits,
            _ => return Err(self.wrong("quantum")),
        };
        Ok(TerrainMeta {
            geo,
            size: [self.integer("columns")?, self.integer("rows")?],
            height_range_m: [self.real("height_min_m")? as f32, self.real("height_max_m")? as f32],
            bound_radius_m: Vec::new(),
            has_holes: self.flag("has_holes")?,
            max_error_m: self.real("max_error_m")?,
            quantum,
            error_steps_per_octave: self.integer("error_steps_per_octave")?,
            level0_slack_m: self.real("level0_slack_m")? as f32,
            title: self.text("title")?,
            source: self.text("source")?,
        })
    }
}
