//! The browser viewer's files: part of the program where they were built before it (`cargo xtask web`), or from a folder.
//!
//! Only names that were there at the start are known, so no name leads out of them.

use crate::error::ServeError;
use crate::fault::Fault;
use crate::reply::{self, ASK_AGAIN, Content, Reply};
use axum::http::header::{self, HeaderMap};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What to do where the viewer is not there.
pub(crate) const MISSING: &str = "the browser viewer is not part of this program: run `cargo xtask web` and build the program again, or give the \
     folder of a built viewer with --web DIR";

/// Most files of a folder; another folder than a viewer's is most likely a slip.
const MOST_FILES: usize = 10_000;

/// A file as the build embedded it.
#[derive(Debug)]
#[allow(dead_code, reason = "what is embedded depends on what was built")]
enum Embedded {
    Plain(&'static [u8]),
    Packed { br: &'static [u8], gz: &'static [u8] },
}

const EMBEDDED: &[(&str, Embedded)] = include!(concat!(env!("OUT_DIR"), "/viewer.rs"));

#[derive(Debug)]
enum File {
    Embedded(&'static Embedded),
    OnDisk(PathBuf),
}

/// The viewer's files by name.
#[derive(Debug, Default)]
pub struct Viewer {
    files: BTreeMap<String, File>,
}

impl Viewer {
    /// What the program was built with; empty where that was nothing.
    pub fn built_in() -> Self {
        Self { files: EMBEDDED.iter().map(|(name, file)| ((*name).to_owned(), File::Embedded(file))).collect() }
    }

    /// The files of a folder, which must have an `index.html`.
    pub fn from_folder(folder: &Path) -> Result<Self, ServeError> {
        let failed = |path: &Path, source| ServeError::File { path: path.to_owned(), source };
        let mut files = BTreeMap::new();
        let mut folders = vec![(folder.to_owned(), String::new())];
        while let Some((folder, prefix)) = folders.pop() {
            for entry in std::fs::read_dir(&folder).map_err(|e| failed(&folder, e))? {
                let entry = entry.map_err(|e| failed(&folder, e))?;
                let name = entry.file_name().to_string_lossy().into_owned();
                let kind = entry.file_type().map_err(|e| failed(&entry.path(), e))?;
                if name.starts_with('.') {
                    continue;
                }
                if kind.is_dir() {
                    folders.push((entry.path(), format!("{prefix}{name}/")));
                } else if kind.is_file() {
                    files.insert(format!("{prefix}{name}"), File::OnDisk(entry.path()));
                }
                if files.len() + folders.len() > MOST_FILES {
                    return Err(failed(&folder, std::io::Error::other("too many files for a viewer")));
                }
            }
        }
        if !files.contains_key("index.html") {
            return Err(failed(&folder.join("index.html"), std::io::ErrorKind::NotFound.into()));
        }
        Ok(Self { files })
    }

    /// Whether there is no viewer.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Names of all files.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// A file's bytes.
    pub(crate) fn bytes(&self, name: &str) -> Option<std::io::Result<Cow<'static, [u8]>>> {
        Some(match self.files.get(name)? {
            File::Embedded(Embedded::Plain(bytes)) => Ok(Cow::Borrowed(*bytes)),
            File::Embedded(Embedded::Packed { gz, .. }) => {
                let mut bytes = Vec::new();
                flate2::read::GzDecoder::new(*gz).read_to_end(&mut bytes).map(|_| Cow::Owned(bytes))
            }
            File::OnDisk(path) => std::fs::read(path).map(Cow::Owned),
        })
    }

    /// The answer to a request for a file.
    pub(crate) fn reply(&self, name: &str, asked: &HeaderMap) -> Result<Reply, Fault> {
        let kind = kind_of(name);
        let packed = match self.files.get(name) {
            None => return Err(Fault::not_found("the viewer has no such file")),
            Some(File::Embedded(Embedded::Packed { br, gz })) => {
                let accepted = reply::text(asked, header::ACCEPT_ENCODING).unwrap_or_default();
                [("br", *br), ("gzip", *gz)].into_iter().find(|(coding, _)| accepts(accepted, coding))
            }
            Some(_) => None,
        };
        let mut reply = match packed {
            Some((coding, bytes)) => {
                let mut content = Content::new(kind, bytes, ASK_AGAIN);
                content.tag = format!("\"{}-{coding}\"", content.tag.trim_matches('"'));
                let mut reply = content.reply(asked);
                reply::put(&mut reply, header::CONTENT_ENCODING, coding);
                reply
            }
            None => {
                let bytes = self.bytes(name).and_then(Result::ok).ok_or_else(Fault::internal)?;
                Content::new(kind, bytes.into_owned(), ASK_AGAIN).reply(asked)
            }
        };
        reply::put(&mut reply, header::VARY, "accept-encoding");
        Ok(reply)
    }
}

/// Whether an `Accept-Encoding` names a coding and does not refuse it.
pub(crate) fn accepts(header: &str, coding: &str) -> bool {
    header.split(',').any(|item| {
        let mut parts = item.split(';').map(str::trim);
        let is_named = parts.next().is_some_and(|name| name.eq_ignore_ascii_case(coding));
        let weight = parts.find_map(|p| p.strip_prefix("q=")).map_or(1.0, |q| q.parse().unwrap_or(0.0));
        is_named && weight > 0.0
    })
}

/// Media type by the end of a name.
pub(crate) fn kind_of(name: &str) -> &'static str {
    match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "wasm" => "application/wasm",
        "json" | "map" => "application/json",
        "webmanifest" => "application/manifest+json",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "svg" => "image/svg+xml",
        "ico" => "image/x-icon",
        "woff2" => "font/woff2",
        "txt" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codings_are_negotiated() {
        assert!(accepts("gzip, deflate, br", "br") && accepts("BR;q=0.1", "br") && accepts("gzip;q=1.0", "gzip"));
        assert!(!accepts("gzip", "br") && !accepts("br;q=0", "br") && !accepts("", "br"));
    }

    #[test]
    fn a_folder_without_a_page_is_no_viewer() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.js"), "1").unwrap();
        assert!(Viewer::from_folder(folder.path()).unwrap_err().to_string().contains("index.html"));
        std::fs::create_dir(folder.path().join("b")).unwrap();
        std::fs::write(folder.path().join("index.html"), "<p>").unwrap();
        std::fs::write(folder.path().join("b/c.wasm"), "x").unwrap();
        let viewer = Viewer::from_folder(folder.path()).unwrap();
        assert_eq!(viewer.names().collect::<Vec<_>>(), ["a.js", "b/c.wasm", "index.html"]);
        assert_eq!(&*viewer.bytes("b/c.wasm").unwrap().unwrap(), b"x");
        let reply = viewer.reply("b/c.wasm", &HeaderMap::new()).unwrap();
        assert_eq!(reply.headers()[header::CONTENT_TYPE], "application/wasm");
        assert!(viewer.reply("../index.html", &HeaderMap::new()).is_err());
    }
}
