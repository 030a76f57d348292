//! Bad input and misuse: one clear line, the right exit code, nothing written, nothing lost.

mod common;

use common::{dem, error, json, run, stdout};
use std::path::Path;

fn nothing_at(folder: &Path, name: &str) {
    let left: Vec<_> = std::fs::read_dir(folder).unwrap().flatten().map(|e| e.file_name()).collect();
    assert!(left.iter().all(|n| !n.to_string_lossy().starts_with(name)), "{left:?}");
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).unwrap();
    let whole = std::fs::read(dem()).unwrap();
    write("text.tif", b"this is no picture\n");
    write("short.tif", &whole[..whole.len() / 2]);
    write("empty.tif", b"");
    write("row.asc", b"ncols 1\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\n1\n2\n3\n4\n");
    write(
        "void.asc",
        b"ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nnodata_value -9999\n-9999 -9999\n-9999 -9999\n",
    );
    write("not.yama", b"SQLite format 3\0 but nothing behind it");
    for name in [
        "missing.tif",
        "text.tif",
        "short.tif",
        "empty.tif",
        "row.asc",
        "void.asc",
        "not.yama",
        "missing.yama",
    ] {
        let line = error(folder, &format!("extract %/{name} --tolerance 5 -o %/out.ply"), 1);
        let told = if name == "void.asc" { "no data" } else { name };
        assert!(line.contains(told), "{line}");
        nothing_at(folder, "out");
    }
    for name in ["missing.tif", "text.tif", "short.tif", "row.asc", "not.yama"] {
        error(folder, &format!("info %/{name}"), 1);
    }
    assert_eq!(json(folder, "info %/void.asc")["no_data_share"], 1.0);
    error(folder, "build %/void.asc -o %/void.yama", 1);
    nothing_at(folder, "void.yama");
    assert!(error(folder, "build @ %/void.asc -o %/x.yama", 1).contains("do not fit together"));
}

#[test]
fn damaged_databases_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "build @ -o %/m.yama");
    let whole = std::fs::read(folder.join("m.yama")).unwrap();
    std::fs::write(folder.join("half.yama"), &whole[..whole.len() / 2]).unwrap();
    assert!(error(folder, "extract %/half.yama --tolerance 0 -o %/out.ply", 1).contains("half.yama"));
    let mut spoilt = whole.clone();
    for byte in spoilt.iter_mut().skip(4096).step_by(997) {
        *byte ^= 0x5a;
    }
    std::fs::write(folder.join("spoilt.yama"), &spoilt).unwrap();
    assert!(error(folder, "extract %/spoilt.yama --tolerance 0 -o %/out.ply", 1).contains("spoilt.yama"));
    error(folder, "info %/spoilt.yama --verify", 1);
    nothing_at(folder, "out");
}

#[test]
fn outputs_that_cannot_be_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert!(error(folder, "extract @ --tolerance 5 -o %/m.xyz", 1).contains("m.xyz"));
    assert!(error(folder, "extract @ --tolerance 5 -o %/no/such/m.ply", 1).contains("no/such"));
    assert!(error(folder, "render @ -o %/m.bmp", 1).contains(".png"));
    assert!(error(folder, "build @ -o %/m.db", 1).contains(".yama"));
    std::fs::copy(dem(), folder.join("same.asc")).unwrap();
    stdout(folder, "build @ -o %/m.yama");
    let before = std::fs::read(folder.join("m.yama")).unwrap();
    error(folder, "build %/m.yama -o %/m.yama", 1);
    error(folder, "build %/m.yama -o %/other.yama", 1);
    assert_eq!(std::fs::read(folder.join("m.yama")).unwrap(), before, "the input is as it was");
}

#[test]
fn misuse_is_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert!(error(folder, "extract @ -o %/m.ply", 2).contains("--tolerance"));
    assert!(error(folder, "fly @ --path somewhere --no-draw", 2).contains("valley"));
    for arguments in [
        "",
        "nonsense",
        "extract @ --tolerance nan -o %/m.ply",
        "extract @ --tolerance -3 -o %/m.ply",
        "extract @ --budget 1 -o %/m.ply",
        "render @ --eye 1,2 --target 1,2,3 -o %/m.png",
        "render @ --eye 1,2,3 -o %/m.png",
        "render @ --size 0x0 -o %/m.png",
        "render @ --fov 0 -o %/m.png",
        "generate cone -o %/c.tif --size 1x5",
        "generate cone -o %/c.tif --holes everywhere",
        "generate cone -o %/c.tif --faces 5000",
        "generate pagoda -o %/p.ply --faces 1999",
        "generate pagoda -o %/p.ply --faces 20000001",
        "generate pagoda -o %/p.ply --holes discs:3",
        "generate pagoda -o %/p.ply --relief 20",
    ] {
        let output = run(folder, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(output.stdout.is_empty(), "{arguments}");
    }
    let stderr = run(folder, "render @ --eye 1,2 --target 1,2,3 -o %/m.png").stderr;
    assert!(String::from_utf8_lossy(&stderr).contains("X,Y,Z"), "what is expected is said");
}

#[cfg(not(feature = "viewer"))]
#[test]
fn without_its_window_the_program_says_how_to_get_it() {
    let folder = tempfile::tempdir().unwrap();
    assert!(error(folder.path(), "view @", 1).contains("--features viewer"));
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_failure_and_a_full_disk_is() {
    use std::process::{Command, Stdio};
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let program = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_yamanami"));
        command.arg("info").arg(dem());
        command
    };
    let closed = program().stdout(writer).stderr(Stdio::piped()).output().unwrap();
    assert!(closed.status.success() && closed.stderr.is_empty(), "{:?}", String::from_utf8_lossy(&closed.stderr));
    if let Ok(full) = std::fs::OpenOptions::new().write(true).open("/dev/full") {
        let output = program().stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: standard output"));
    }
}

#[test]
fn only_hori_takes_sources() {
    let folder = tempfile::tempdir().unwrap();
    let line = error(folder.path(), "reproduce mizuno dem.tif -o %/out", 2);
    assert!(line.contains("only hori takes sources"), "{line}");
    nothing_at(folder.path(), "out");
    let line = error(folder.path(), "reproduce hori missing.tif -o %/out", 1);
    assert!(line.contains("missing.tif"), "{line}");
}
