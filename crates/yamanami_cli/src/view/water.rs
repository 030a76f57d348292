//! Area and volume of the water, measured on all triangles beside the window's own work.

use eframe::egui;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use yamanami::io::tin_file::TinReadOptions;
use yamanami::measure::tin::{PlanIndex, Water, water_below};
use yamanami::{FullSurface, OpenOptions};

/// Most triangles of a surface that is read once more to be measured.
const MOST_TRIANGLES: u64 = 8_000_000;

/// Measures on a thread of its own, which reads the surface when it is first asked.
pub(super) struct WaterGauge {
    sources: Vec<PathBuf>,
    reading: OpenOptions,
    worker: Option<Worker>,
    /// The level asked for last.
    asked_m: Option<f64>,
    /// The answer to it.
    answer: Option<Result<Water, String>>,
}

struct Worker {
    ask: Sender<f64>,
    answers: Receiver<(f64, Result<Water, String>)>,
}

impl WaterGauge {
    /// A gauge of the surface in these files.
    pub(super) fn new(sources: Vec<PathBuf>, reading: OpenOptions) -> Self {
        Self { sources, reading, worker: None, asked_m: None, answer: None }
    }

    /// Follows the level, unless it is just being moved; `triangles` are those of the whole surface.
    pub(super) fn follow(&mut self, level_m: Option<f64>, moving: bool, triangles: u64, context: &egui::Context) {
        if let Some(worker) = &self.worker {
            while let Ok((level_m, answer)) = worker.answers.try_recv() {
                if self.asked_m == Some(level_m) {
                    self.answer = Some(answer);
                }
            }
        }
        if moving || level_m == self.asked_m {
            return;
        }
        (self.asked_m, self.answer) = (level_m, None);
        let Some(level_m) = level_m else { return };
        if triangles > MOST_TRIANGLES {
            let millions = MOST_TRIANGLES / 1_000_000;
            self.answer = Some(Err(format!("measured up to {millions} million triangles; use yamanami volume")));
            return;
        }
        let worker = self.worker.get_or_insert_with(|| start(&self.sources, &self.reading, context));
        if worker.ask.send(level_m).is_err() {
            self.answer = Some(Err("the water could not be measured".to_owned()));
        }
    }

    /// What is known of the water at the level asked for last.
    pub(super) fn words(&self) -> String {
        match (&self.asked_m, &self.answer) {
            (None, _) => String::new(),
            (Some(_), None) => "measuring …".to_owned(),
            (Some(_), Some(Err(line))) => line.clone(),
            (Some(_), Some(Ok(water))) => {
                let area = match water.area_m2 {
                    a if a >= 1e5 => format!("{} km²", crate::text::number(a / 1e6)),
                    a => format!("{} m²", crate::text::number(a)),
                };
                let volume = match water.volume_m3 {
                    v if v >= 1e7 => format!("{} million m³", crate::text::number(v / 1e6)),
                    v => format!("{} m³", crate::text::number(v)),
                };
                let [mean, most] = [water.mean_depth_m(), water.greatest_depth_m].map(crate::text::number);
                format!("{area} flooded, {volume}\nmean depth {mean} m, at most {most} m")
            }
        }
    }
}

fn start(sources: &[PathBuf], reading: &OpenOptions, context: &egui::Context) -> Worker {
    let ((ask, asked), (tell, answers)) = (channel::<f64>(), channel());
    let (sources, reading, context) = (sources.to_owned(), reading.clone(), context.clone());
    std::thread::spawn(move || {
        let surface = surface(&sources, &reading);
        while let Ok(first_m) = asked.recv() {
            // only the latest counts
            let level_m = asked.try_iter().last().unwrap_or(first_m);
            let water = surface.as_ref().map(|full| water_below(&full.mesh, level_m)).map_err(Clone::clone);
            if tell.send((level_m, water)).is_err() {
                return;
            }
            context.request_repaint();
        }
    });
    Worker { ask, answers }
}

fn surface(sources: &[PathBuf], reading: &OpenOptions) -> Result<FullSurface, String> {
    let full = FullSurface::open(sources, reading, &TinReadOptions::default(), &|_| ()).map_err(|e| e.to_string())?;
    if PlanIndex::new(&full.mesh).is_terrain() { Ok(full) } else { Err("not measured: this is no terrain".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use std::time::{Duration, Instant};

    #[test]
    fn the_gauge_answers_for_the_last_level_and_not_while_it_moves() {
        let dem = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/mt_washington_50m.tif");
        let mut gauge = WaterGauge::new(vec![dem], OpenOptions::default());
        let context = egui::Context::default();
        gauge.follow(Some(600.0), true, 1000, &context);
        assert_eq!(gauge.words(), "");
        gauge.follow(Some(600.0), false, 1000, &context);
        gauge.follow(Some(620.0), false, 1000, &context);
        let started = Instant::now();
        while gauge.answer.is_none() && started.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(5));
            gauge.follow(Some(620.0), false, 1000, &context);
        }
        assert_eq!(gauge.words(), "12.91 km² flooded, 957.7 million m³\nmean depth 74.19 m, at most 198.1 m");
        gauge.follow(None, false, 1000, &context);
        assert_eq!(gauge.words(), "");
        gauge.follow(Some(1.0), false, u64::MAX, &context);
        assert!(gauge.words().contains("yamanami volume"));
    }
}
