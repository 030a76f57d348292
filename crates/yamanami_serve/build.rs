//! Embeds the browser viewer: every file of `target/web`, packed with Brotli and gzip where that makes it smaller.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Compressed files that save less than this share of their bytes are kept as they are.
const LEAST_SAVING: f64 = 0.1;

fn main() {
    let manifest = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let web = manifest.join("../../target/web");
    // a folder that is not there would count as changed at every build
    let _ = fs::create_dir_all(&web);
    println!("cargo::rerun-if-changed={}", web.display());
    println!("cargo::rerun-if-changed=build.rs");
    let mut files = Vec::new();
    walk(&web, "", &mut files);
    files.sort();
    let mut code = String::from("&[\n");
    for (number, (name, path)) in files.iter().enumerate() {
        println!("cargo::rerun-if-changed={}", path.display());
        let plain = fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let packed = [("br", brotli(&plain)), ("gz", gzip(&plain))];
        let is_smaller = packed.iter().all(|(_, p)| (p.len() as f64) < (1.0 - LEAST_SAVING) * plain.len() as f64);
        let include = |ending: &str, bytes: &[u8]| {
            let file = out.join(format!("{number}.{ending}"));
            fs::write(&file, bytes).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            format!("include_bytes!(concat!(env!(\"OUT_DIR\"), \"/{number}.{ending}\"))")
        };
        let content = if is_smaller {
            let [br, gz] = packed.map(|(ending, bytes)| include(ending, &bytes));
            format!("Embedded::Packed {{ br: {br}, gz: {gz} }}")
        } else {
            format!("Embedded::Plain({})", include("plain", &plain))
        };
        // writing into a text cannot fail
        let _ = writeln!(code, "    ({name:?}, {content}),");
    }
    code.push(']');
    fs::write(out.join("viewer.rs"), code).expect("the output folder can be written");
}

/// Names, parts divided by `/`, and paths of all plain files below a folder; hidden ones are nobody's business.
fn walk(folder: &Path, prefix: &str, found: &mut Vec<(String, PathBuf)>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with('.') {
            continue;
        }
        match entry.file_type() {
            Ok(kind) if kind.is_dir() => walk(&entry.path(), &format!("{prefix}{name}/"), found),
            Ok(kind) if kind.is_file() => found.push((format!("{prefix}{name}"), entry.path())),
            _ => {}
        }
    }
}

fn brotli(bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    let mut writer = brotli::CompressorWriter::new(&mut packed, 1 << 16, 10, 22);
    writer.write_all(bytes).expect("memory can be written");
    drop(writer);
    packed
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    writer.write_all(bytes).and_then(|()| writer.finish()).expect("memory can be written")
}
