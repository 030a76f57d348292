//! `serve`: surfaces in the browser, and as standard tiles over HTTP.

use crate::args::SourceArgs;
use crate::failure::Failure;
use crate::progress::note;
use crate::{databases, out, values};
use clap::Args;
use std::net::SocketAddr;
use std::path::PathBuf;
use yamanami_serve::{Limits, ServeOptions, Server, Surfaces, Viewer, open_browser};

/// Show surfaces in the browser, and give them to other programs over HTTP
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami serve fuji.yama                       opens the browser on a list of what is served
  yamanami serve fuji.yama scan.yama dem.tif     several; what is no database is built first
  yamanami serve fuji.yama --listen 0.0.0.0:8080 --no-open
                                                 for other computers too
Tiles for other programs: /s/NAME/terrain-rgb/tilejson.json. Ctrl-C stops.")]
pub(crate) struct ServeArgs {
    #[command(flatten)]
    source: SourceArgs,
    /// Address and port; port 0 is any that is free
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:8080", value_parser = values::socket, help_heading = "Serving")]
    listen: SocketAddr,
    /// Do not open the browser
    #[arg(long, help_heading = "Serving")]
    no_open: bool,
    /// Let pages of other sites read what is served
    #[arg(long, help_heading = "Serving")]
    cors: bool,
    /// Most connections at once
    #[arg(long, value_name = "N", default_value_t = Limits::default().connections, value_parser = values::connections, help_heading = "Serving")]
    max_connections: usize,
    /// Folder of a built viewer, in place of the one in the program
    #[arg(long, value_name = "DIR", help_heading = "Serving")]
    web: Option<PathBuf>,
}

pub(crate) fn run(args: &ServeArgs) -> Result<(), Failure> {
    let viewer = viewer(args.web.as_deref())?;
    let databases = databases::of(&args.source)?;
    let surfaces = surfaces(&databases)?;
    let limits = Limits { connections: args.max_connections, ..Limits::default() };
    let server = Server::bind(surfaces, viewer, &ServeOptions { listen: args.listen, cors: args.cors, limits })?;
    let address = server.address();
    // where all addresses are listened at, this computer is one of them
    let host =
        if address.ip().is_unspecified() { format!("localhost:{}", address.port()) } else { address.to_string() };
    let url = format!("http://{host}/");
    out::row("serving", &url)?;
    out::flush()?;
    if !args.no_open
        && let Err(why) = open_browser(&url)
    {
        note(&format!("note: {why}; open {url} yourself"));
    }
    server.run()?;
    note("stopped");
    Ok(())
}

/// The viewer of a folder, or that of the program.
pub(super) fn viewer(folder: Option<&std::path::Path>) -> Result<Viewer, Failure> {
    Ok(folder.map_or_else(|| Ok(Viewer::built_in()), Viewer::from_folder)?)
}

/// Databases, opened to be served.
pub(super) fn surfaces(databases: &databases::Databases) -> Result<Surfaces, Failure> {
    let mut surfaces = Surfaces::default();
    databases.paths.iter().try_for_each(|path| surfaces.add(path))?;
    Ok(surfaces)
}
