//! The window opens, draws and closes again. It is shown on a display of its own (Xvfb); where there is none, or no driver
//! to draw with, the test says so and passes.
#![cfg(all(feature = "viewer", target_os = "linux"))]

use image::RgbImage;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// A display that ends with the test.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// `None` where Xvfb is absent or will not start.
    fn open() -> Option<Self> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .ok()?;
        let mut number = String::new();
        BufReader::new(server.stdout.take()?).read_line(&mut number).ok()?;
        Some(Self { server, name: format!(":{}", number.trim()) }).filter(|display| display.name.len() > 1)
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // it may have ended by itself
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Opens a window on bundled data.
fn view(display: Option<&str>, data: &str, arguments: &[&str], runtime: &Path) -> Output {
    let terrain = bundled(data);
    let mut command = Command::new(env!("CARGO_BIN_EXE_yamanami"));
    command.arg("view").arg(terrain).args(arguments).env("XDG_RUNTIME_DIR", runtime);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    command.envs(display.map(|name| ("DISPLAY", name)));
    command.output().expect("the program starts")
}

fn bundled(data: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(data)
}

/// A picture of a window of 640 by 480 on bundled data; `None`, and a line that says so, where none can be opened.
fn picture_of(data: &str, arguments: &[&str]) -> Option<RgbImage> {
    let Some(display) = Display::open() else {
        eprintln!("skipped: no Xvfb");
        return None;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("window.png");
    let screenshot = ["--size", "640x480", "--screenshot", &file.to_string_lossy()];
    let output = view(Some(&display.name), data, &[arguments, &screenshot].concat(), folder.path());
    let told = String::from_utf8_lossy(&output.stderr);
    if told.contains("no graphics adapter") {
        eprintln!("skipped: no driver that draws on a window");
        return None;
    }
    assert!(output.status.success(), "{told}");
    let window = image::open(&file).expect("a picture").into_rgb8();
    assert_eq!(window.dimensions(), (640, 480));
    Some(window)
}

#[test]
fn the_window_draws_the_relief_and_closes() {
    let Some(window) = picture_of("mt_washington_50m.tif", &["--budget", "3000"]) else { return };
    // the terrain lies left of the panel: many shades, and more green than blue where the land is
    let land = image::imageops::crop_imm(&window, 60, 180, 200, 160).to_image();
    let shades: std::collections::HashSet<_> = land.pixels().collect();
    assert!(shades.len() > 200, "{} shades", shades.len());
    let green = land.pixels().filter(|p| p[1] > p[2]).count();
    assert!(green > 10_000, "{green} of {} pixels are land", land.pixels().len());
}

#[test]
fn the_window_of_maps_draws_ground_and_names() {
    let names = bundled("japan_mountains.csv");
    let place = [
        "--map",
        "--at",
        "35.66,138.57",
        "--radius",
        "60",
        "--spacing",
        "500",
        "--ring",
        "20",
        "--eye",
        "5000",
    ];
    let names = ["--budget", "3000", "--places", &names.to_string_lossy()];
    let Some(window) = picture_of("central_japan_srtm30.tif", &[&place[..], &names].concat()) else { return };
    // the plain map in the middle, left of the panel; beside the map nothing
    let [middle, corner] = [[140, 200], [4, 4]].map(|[x, y]| {
        let part = image::imageops::crop_imm(&window, x, y, 60, 60).to_image();
        part.pixels().collect::<std::collections::HashSet<_>>().len()
    });
    assert!(middle > 100 && corner < 8, "{middle} and {corner} shades");
    // letters are darker than any ground
    let map = image::imageops::crop_imm(&window, 0, 0, 340, 440).to_image();
    let dark = map.pixels().filter(|p| p.0.iter().all(|&v| v < 60)).count();
    assert!(dark > 1500, "{dark} dark pixels");
}

#[test]
fn a_map_whose_eye_is_too_low_is_told_in_a_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["--map", "--at", "35.66,138.57", "--radius", "60", "--spacing", "500", "--eye", "0"];
    let output = view(None, "central_japan_srtm30.tif", &arguments, folder.path());
    assert_eq!(output.status.code(), Some(2));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("error: eye height: expected above 0 m"), "{told}");
}

#[test]
fn without_a_display_there_is_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = view(None, "mt_washington_50m.tif", &[], folder.path());
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(told.contains("error: no window: no display"), "{told}");
    assert_eq!(told.trim().lines().filter(|line| line.contains("error")).count(), 1, "{told}");
}
