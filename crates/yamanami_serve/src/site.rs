//! What the viewer's page is told to show, and the same as static files for any web host: page, program, data.

use crate::error::ServeError;
use crate::surface::{Served, Surfaces};
use crate::viewer::Viewer;
use serde_json::{Value, json};
use std::path::Path;
use yamanami::io::pack::write_pack;
use yamanami::io::tiles::{TileFolder, TileOutput};

/// The file that the viewer's page asks for first.
pub(crate) const SITE: &str = "site.json";

/// A surface as the page needs it: addresses are relative to the page. A server can do a few things more than files.
pub(crate) fn entry(served: &Served, pack: &str, with_server: bool) -> Value {
    let mut entry = json!({
        "name": served.name,
        "title": served.title,
        "kind": served.kind,
        "pack": pack,
        "bytes": served.source.bytes(),
    });
    if with_server {
        entry["info"] = format!("../s/{}/info.json", served.name).into();
    }
    entry
}

/// What a site takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SiteReport {
    /// Files.
    pub files: u64,
    /// Their bytes.
    pub bytes: u64,
}

/// Writes the viewer and surfaces as static files; `output` appears when all is there. `progress` hears of the share done,
/// 0 to 1.
pub fn write_site(
    surfaces: &Surfaces,
    viewer: &Viewer,
    output: &Path,
    progress: &dyn Fn(f32),
) -> Result<SiteReport, ServeError> {
    if viewer.is_empty() {
        return Err(ServeError::NoViewer);
    }
    // all of it is written anew: a page and a program of two versions would not fit
    let folder = TileFolder::create(output, &format!("site {:?}", std::time::SystemTime::now()))?;
    let mut report = SiteReport { files: 0, bytes: 0 };
    let mut put = |name: &str, bytes: &[u8]| {
        report.files += 1;
        report.bytes += bytes.len() as u64;
        folder.put(name, bytes)
    };
    for name in viewer.names().filter(|name| *name != SITE) {
        let failed = |source| ServeError::File { path: name.into(), source };
        if let Some(bytes) = viewer.bytes(name) {
            put(name, &bytes.map_err(failed)?)?;
        }
    }
    let file = |served: &Served| format!("{}.pack", served.name);
    let entries: Vec<Value> = surfaces.all.iter().map(|served| entry(served, &file(served), false)).collect();
    put(SITE, serde_json::json!({ "surfaces": entries }).to_string().as_bytes())?;
    let total: u64 = surfaces.all.iter().map(|served| served.source.bytes()).sum();
    let mut done = 0;
    for served in &surfaces.all {
        let length = served.source.bytes();
        let share = |share: f32| progress((done as f32 + share * length as f32) / total as f32);
        write_pack(&served.source, folder.part().join(file(served)), &share)?;
        done += length;
        report.files += 1;
        report.bytes += length;
    }
    folder.finish()?;
    Ok(report)
}
