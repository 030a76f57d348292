//! A server: bound to its address first, so that it can be told, then run until it is to stop.

use crate::cache::Cache;
use crate::connections;
use crate::error::ServeError;
use crate::limits::Limits;
use crate::routes::{App, router};
use crate::surface::Surfaces;
use crate::viewer::Viewer;
use crate::work::Work;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

/// What runs on after the last answer, such as a picture that nobody waits for, is left alone after so long.
const LAST_WAIT: Duration = Duration::from_millis(200);
/// Threads that talk: they only pass bytes on.
const TALKERS: usize = 2;

/// How to serve.
#[derive(Debug, Clone)]
pub struct ServeOptions {
    /// Where; port 0 is any that is free.
    pub listen: SocketAddr,
    /// Whether pages of other sites may read what is served.
    pub cors: bool,
    /// How much is allowed.
    pub limits: Limits,
}

impl Default for ServeOptions {
    fn default() -> Self {
        Self { listen: (Ipv4Addr::LOCALHOST, 8080).into(), cors: false, limits: Limits::default() }
    }
}

/// A server that listens and does not answer yet.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    app: App,
}

impl Server {
    /// Takes the address.
    pub fn bind(surfaces: Surfaces, viewer: Viewer, options: &ServeOptions) -> Result<Self, ServeError> {
        let failed = |source| ServeError::Listen { address: options.listen, source };
        let listener = TcpListener::bind(options.listen).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let limits = options.limits.clone();
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        let app = App {
            surfaces,
            viewer,
            work: Work::new(processors, limits.jobs_waiting),
            cors: options.cors,
            host: address.to_string(),
            tiles: Cache::new(limits.tile_bytes),
            limits,
        };
        Ok(Self { listener, address, app })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Answers until Ctrl-C or SIGTERM.
    pub fn run(self) -> Result<(), ServeError> {
        self.run_until(stop_signal())
    }

    /// Answers until `stop`; what is being answered then finishes within a limit.
    pub fn run_until(self, stop: impl Future<Output = ()>) -> Result<(), ServeError> {
        let Self { listener, app, .. } = self;
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(TALKERS).enable_all().build()?;
        let limits = app.limits.clone();
        let served = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            connections::run(listener, router(Arc::new(app)), limits, stop).await;
            Ok(())
        });
        runtime.shutdown_timeout(LAST_WAIT);
        served
    }
}

/// Ends when the program is told to stop.
async fn stop_signal() {
    let interrupt = tokio::signal::ctrl_c();
    #[cfg(unix)]
    if let Ok(mut terminate) = tokio::signal::unix::signal(tokio::signal::unix::SignalKind::terminate()) {
        tokio::select! {
            _ = interrupt => {}
            _ = terminate.recv() => {}
        }
        return;
    }
    // where signals cannot be had there is nothing to wait for
    let _ = interrupt.await;
}

/// Shows an address in the user's browser; says why where that cannot be.
pub fn open_browser(address: &str) -> Result<(), String> {
    let has_screen = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    if cfg!(all(unix, not(target_os = "macos"))) && !has_screen {
        return Err("there is no screen to open a browser on".to_owned());
    }
    open::that_detached(address).map_err(|e| format!("no browser could be opened: {e}"))
}
