//! `yamanami view`: a window to fly over a terrain or around a model, with every control of the surface at hand.
//!
//! [`run`] opens it and comes back when it is closed. The parts: [`app`] is one frame after another, [`camera`] moves the
//! eye, [`ground`] tells where the land is, [`stage`] keeps the scene and draws it on a texture, [`settings`] is what the
//! side [`panel`] turns, [`plots`] draws the running numbers, [`water`] measures what is flooded, [`overlay`] what lies over the picture, [`recorder`] takes
//! and replays camera paths, [`keys`] reads the keyboard, [`screenshot`] writes pictures, [`target`] is the texture in
//! the window. [`map`] is the other window, of deformed maps.

mod app;
mod keys;
pub(crate) mod map;
mod overlay;
mod panel;
mod plots;
mod recorder;
mod screenshot;
mod settings;
mod stage;
mod target;
mod water;

use crate::pictures::Colour;
use eframe::{egui, egui_wgpu, wgpu};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use yamanami::core::View;
use yamanami::{CameraPath, Criteria, Lod, OpenOptions, Subject};

/// How the window starts.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    /// The controls as they are set at first; of a view only tolerance and culling count.
    pub(crate) criteria: Criteria,
    /// Which control moves the front.
    pub(crate) lod: Lod,
    /// A path to replay at once.
    pub(crate) path: Option<CameraPath>,
    /// Where the camera starts; `None`: over all of the terrain.
    pub(crate) view: Option<View>,
    /// The files shown, to be read once more where all triangles are measured.
    pub(crate) sources: Vec<PathBuf>,
    /// How they are read.
    pub(crate) reading: OpenOptions,
    /// What colours the surface; `None`: its usual colours.
    pub(crate) colour: Option<Colour>,
    /// Height of a water surface, metres.
    pub(crate) water_m: Option<f64>,
    /// An image to lay over a terrain.
    pub(crate) image: Option<PathBuf>,
    /// Size of the window in points.
    pub(crate) size: [u32; 2],
    /// Saves a picture of the whole window here once the first frames have settled, and closes it.
    pub(crate) screenshot: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            criteria: Criteria::default(),
            lod: Lod::Exact,
            path: None,
            view: None,
            sources: Vec::new(),
            reading: OpenOptions::default(),
            colour: None,
            water_m: None,
            image: None,
            size: [1280, 800],
            screenshot: None,
        }
    }
}

/// Why the window closed, where that was not the user's wish.
type Failure = Arc<Mutex<Option<String>>>;

/// Opens the window and stays until it is closed. The error is one line.
pub(crate) fn run(subject: impl Subject + 'static, options: Options) -> Result<(), String> {
    let title = format!("{} - yamanami", subject.title());
    open(&title, options.size, move |context, failure| app::Viewer::new(context, subject, options, failure))
}

/// Opens a window of this size, points, and stays until it is closed. The error is one line.
fn open<A: eframe::App + 'static>(
    title: &str,
    size: [u32; 2],
    create: impl FnOnce(&eframe::CreationContext<'_>, Failure) -> Result<A, String> + 'static,
) -> Result<(), String> {
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title(title)
            .with_inner_size(size.map(|side| side.clamp(320, 16_384) as f32))
            .with_min_inner_size([320.0, 240.0]),
        wgpu_options: graphics(),
        persist_window: false,
        ..eframe::NativeOptions::default()
    };
    let failure = Failure::default();
    let seen = Arc::clone(&failure);
    let create: eframe::AppCreator<'_> = Box::new(move |context| Ok(Box::new(create(context, failure)?)));
    eframe::run_native("yamanami", native, create).map_err(|error| in_words(&error))?;
    let reason = seen.lock().ok().and_then(|mut reason| reason.take());
    reason.map_or(Ok(()), Err)
}

/// A device with the usual limits, and with buffers and textures as large as it has them.
fn graphics() -> egui_wgpu::WgpuConfiguration {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.device_descriptor = Arc::new(|adapter| {
        let offered = adapter.limits();
        let usual = wgpu::Limits::default().or_worse_values_from(&offered);
        wgpu::DeviceDescriptor {
            label: Some("yamanami view"),
            required_limits: wgpu::Limits {
                max_buffer_size: offered.max_buffer_size,
                max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
                max_texture_dimension_2d: offered.max_texture_dimension_2d,
                ..usual
            },
            ..wgpu::DeviceDescriptor::default()
        }
    });
    egui_wgpu::WgpuConfiguration {
        surface: egui_wgpu::SurfaceConfig::LOW_LATENCY,
        wgpu_setup: setup.into(),
        ..egui_wgpu::WgpuConfiguration::default()
    }
}

/// Why no window opened, in one line.
fn in_words(error: &eframe::Error) -> String {
    let reason = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    match error {
        eframe::Error::AppCreation(inner) => inner.to_string(),
        eframe::Error::Wgpu(_) => {
            format!("no window: no graphics adapter can draw on it; render and fly need none ({reason})")
        }
        eframe::Error::WinitEventLoop(_) | eframe::Error::Winit(_) => {
            // the window system's own words come last, after a place in its source
            let words = reason.rsplit(": ").next().unwrap_or_default().trim_end_matches('.');
            format!("no window: no display can be reached; render and fly need none ({words})")
        }
    }
}
