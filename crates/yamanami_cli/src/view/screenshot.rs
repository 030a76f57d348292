//! Pictures on their way to files.

use eframe::egui;
use image::RgbaImage;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// The picture waits for this many frames, so that the window has its size, and for the front to settle.
const LEAST_FRAMES: u32 = 12;
/// It waits no longer than this.
const MOST_FRAMES: u32 = 120;

/// A picture of the whole window, asked for when the program was started.
#[derive(Debug)]
pub(super) struct Screenshot {
    file: PathBuf,
    frames: u32,
    asked: bool,
    done: Arc<Mutex<Option<Result<(), String>>>>,
}

impl Screenshot {
    /// To be saved in this file.
    pub(super) fn new(file: PathBuf) -> Self {
        Self { file, frames: 0, asked: false, done: Arc::default() }
    }

    /// Goes on by a frame; tells, once, how saving went.
    pub(super) fn step(&mut self, ui: &egui::Ui, settled: bool) -> Option<Result<(), String>> {
        ui.request_repaint();
        self.frames = self.frames.saturating_add(1);
        if !self.asked && (settled && self.frames >= LEAST_FRAMES || self.frames >= MOST_FRAMES) {
            self.asked = true;
            let (file, done) = (self.file.clone(), Arc::clone(&self.done));
            let save = egui::ScreenshotCallback::new(move |image| {
                let saved = save_window(&image, &file);
                if let Ok(mut done) = done.lock() {
                    *done = Some(saved);
                }
            });
            ui.send_viewport_cmd(egui::ViewportCommand::Screenshot(save));
        }
        self.done.lock().ok().and_then(|mut done| done.take())
    }
}

/// The first of `name-001.ending`, `name-002.ending`, … in the current folder that is no file yet.
pub(super) fn free_name(name: &str, ending: &str) -> PathBuf {
    let numbered = |number: u32| PathBuf::from(format!("{name}-{number:03}.{ending}"));
    (1..u32::MAX).map(numbered).find(|file| !file.exists()).unwrap_or_else(|| numbered(0))
}

/// Saves a picture of the window.
fn save_window(image: &egui::ColorImage, file: &Path) -> Result<(), String> {
    let [width, height] = image.size.map(|side| side as u32);
    let pixels = image.pixels.iter().flat_map(|p| [p.r(), p.g(), p.b(), 255]).collect();
    let picture = RgbaImage::from_raw(width, height, pixels).unwrap_or_default();
    picture.save(file).map_err(|error| format!("{}: {error}", file.display()))
}
