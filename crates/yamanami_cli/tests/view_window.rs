//! The window opens, draws and closes again. It is shown on a display of its own (Xvfb); where there is none, or no driver
//! to draw with, the test says so and passes.
#![cfg(all(feature = "viewer", target_os = "linux"))]

use std::io::{BufRead, BufReader};
use std::path::Path;
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

fn view(display: Option<&str>, arguments: &[&str], runtime: &Path) -> Output {
    let terrain = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/mt_washington_50m.tif");
    let mut command = Command::new(env!("CARGO_BIN_EXE_yamanami"));
    command.arg("view").arg(terrain).args(arguments).env("XDG_RUNTIME_DIR", runtime);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    command.envs(display.map(|name| ("DISPLAY", name)));
    command.output().expect("the program starts")
}

#[test]
fn the_window_draws_the_relief_and_closes() {
    let Some(display) = Display::open() else {
        eprintln!("skipped: no Xvfb");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("window.png");
    let arguments = ["--size", "640x480", "--budget", "3000", "--screenshot", &file.to_string_lossy()];
    let output = view(Some(&display.name), &arguments, folder.path());
    let told = String::from_utf8_lossy(&output.stderr);
    if told.contains("no graphics adapter") {
        eprintln!("skipped: no driver that draws on a window");
        return;
    }
    assert!(output.status.success(), "{told}");
    let window = image::open(&file).expect("a picture").into_rgb8();
    assert_eq!(window.dimensions(), (640, 480));
    // the terrain lies left of the panel: many shades, and more green than blue where the land is
    let land = image::imageops::crop_imm(&window, 60, 180, 200, 160).to_image();
    let shades: std::collections::HashSet<_> = land.pixels().collect();
    assert!(shades.len() > 200, "{} shades", shades.len());
    let green = land.pixels().filter(|p| p[1] > p[2]).count();
    assert!(green > 10_000, "{green} of {} pixels are land", land.pixels().len());
}

#[test]
fn without_a_display_there_is_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = view(None, &[], folder.path());
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(told.contains("error: no window: no display"), "{told}");
    assert_eq!(told.trim().lines().filter(|line| line.contains("error")).count(), 1, "{told}");
}
