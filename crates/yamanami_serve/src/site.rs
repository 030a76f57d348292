//! What the viewer's page is told to show, and the same as static files for any web host: page, program, data.

use crate::error::ServeError;
use crate::picture;
use crate::surface::{Served, Surfaces};
use crate::viewer::Viewer;
use serde_json::{Value, json};
use std::path::Path;
use yamanami::io::pack::write_pack;
use yamanami::io::tiles::{TileFolder, TileOutput};

/// The file that the viewer's page asks for first.
pub(crate) const SITE: &str = "site.json";

/// A surface as the page needs it: addresses are relative to the page.
pub(crate) fn entry(served: &Served, pack: &str, picture: &str) -> Value {
    json!({
        "name": served.name,
        "title": served.title,
        "kind": served.kind,
        "pack": pack,
        "picture": picture,
        "credit": served.info["facts"]["source"],
        "bytes": served.source.bytes(),
    })
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
    let [file, image] = ["pack", "png"].map(|ending| move |served: &Served| format!("{}.{ending}", served.name));
    let mut entries = Vec::new();
    for served in &surfaces.all {
        let drawn = picture::draw(served).map_err(|fault| ServeError::System(std::io::Error::other(fault.line)))?;
        put(&image(served), &drawn.bytes)?;
        entries.push(entry(served, &file(served), &image(served)));
    }
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
