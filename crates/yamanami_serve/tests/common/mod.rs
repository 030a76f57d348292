//! A server on a free port, and a client that says exactly what it is told to.
#![allow(dead_code, reason = "each test program uses its part")]

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::Duration;
use yamanami::core::{Crs, GeoReference, HeightField};
use yamanami::{StoreOptions, Terrain};
use yamanami_serve::{Limits, ServeOptions, Server, Surfaces, Viewer};

/// An answer.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        let line = self.head.lines().find(|l| l.to_ascii_lowercase().starts_with(&format!("{name}:")))?;
        Some(line[name.len() + 1..].trim())
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.body).unwrap()
    }
}

/// A running server.
#[derive(Debug)]
pub(crate) struct Running {
    pub(crate) address: SocketAddr,
    pub(crate) folder: tempfile::TempDir,
    pub(crate) terrain: PathBuf,
    stop: Option<std::sync::mpsc::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// A hill in degrees near Fuji.
pub(crate) fn hill(path: &Path) {
    let (width, height) = (140, 120);
    let z = |i: usize| {
        let (x, y) = ((i % width) as f32 - 70.0, (i / width) as f32 - 60.0);
        2000.0 - 0.3 * (x * x + y * y) + 40.0 * (0.3 * x).sin() * (0.2 * y).cos()
    };
    let crs = Crs { epsg: Some(4326), geographic: true, name: "WGS 84".into(), ..Crs::default() };
    let geo = GeoReference::new(crs, [138.7, 35.4], [1.0 / 3600.0, -1.0 / 3600.0], [width, height]);
    let field = HeightField::new(width, height, (0..width * height).map(z).collect(), geo);
    let terrain = Terrain::build(field, "<hill> 丘".to_owned(), &|_| ()).unwrap();
    terrain.store_as(path, &StoreOptions::default(), &|_| ()).unwrap();
}

impl Running {
    pub(crate) fn start() -> Self {
        Self::with(Limits::default(), false)
    }

    pub(crate) fn with(limits: Limits, cors: bool) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let terrain = folder.path().join("Hill 1.yama");
        hill(&terrain);
        let web = folder.path().join("web");
        std::fs::create_dir(&web).unwrap();
        std::fs::write(web.join("index.html"), "<!doctype html><p>viewer").unwrap();
        std::fs::write(web.join("a.wasm"), b"\0asm").unwrap();
        std::fs::write(folder.path().join("secret.txt"), "secret").unwrap();
        let mut surfaces = Surfaces::default();
        surfaces.add(&terrain).unwrap();
        let options = ServeOptions { listen: ([127, 0, 0, 1], 0).into(), cors, limits };
        let server = Server::bind(surfaces, Viewer::from_folder(&web).unwrap(), &options).unwrap();
        let address = server.address();
        let (stop, stopped) = std::sync::mpsc::channel::<()>();
        let (told, hears) = tokio::sync::oneshot::channel();
        std::thread::spawn(move || {
            let _ = stopped.recv();
            let _ = told.send(());
        });
        let thread = std::thread::spawn(move || {
            server
                .run_until(async {
                    let _ = hears.await;
                })
                .unwrap();
        });
        Self { address, folder, terrain, stop: Some(stop), thread: Some(thread) }
    }

    /// Tells the server to stop.
    pub(crate) fn stop(&mut self) {
        drop(self.stop.take());
    }

    /// Waits until it has stopped.
    pub(crate) fn join(&mut self) {
        self.stop();
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        stream
    }

    /// Sends bytes and reads until the server closes; nothing at all is status 0.
    pub(crate) fn raw(&self, bytes: &[u8]) -> Answer {
        let mut stream = self.connect();
        // a server that refuses early may close before all is said
        let _ = stream.write_all(bytes);
        read_answer(&mut stream)
    }

    /// Asks, and has the connection closed.
    pub(crate) fn ask(&self, method: &str, target: &str, headers: &[(&str, &str)]) -> Answer {
        let headers: String = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
        self.raw(format!("{method} {target} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n{headers}\r\n").as_bytes())
    }

    pub(crate) fn get(&self, target: &str) -> Answer {
        self.ask("GET", target, &[])
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.join();
    }
}

/// Reads until the other side closes.
pub(crate) fn read_answer(stream: &mut TcpStream) -> Answer {
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    let end = bytes.windows(4).position(|w| w == b"\r\n\r\n").map_or(bytes.len(), |at| at + 4);
    let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
    let status = head.split(' ').nth(1).and_then(|s| s.parse().ok()).unwrap_or(0);
    let mut body = bytes.split_off(end);
    if head.to_ascii_lowercase().contains("transfer-encoding: chunked") {
        body = unchunk(&body);
    }
    Answer { status, head, body }
}

fn unchunk(mut bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    while let Some(at) = bytes.windows(2).position(|w| w == b"\r\n") {
        let length = usize::from_str_radix(std::str::from_utf8(&bytes[..at]).unwrap(), 16).unwrap();
        if length == 0 {
            break;
        }
        out.extend(&bytes[at + 2..at + 2 + length]);
        bytes = &bytes[at + 4 + length..];
    }
    out
}
