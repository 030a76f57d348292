//! Tiles of ground on a plane: a quadtree of three levels with a bump in each cell of the finest, written out and implicit.

use super::{assert_finds, assert_sound, edit, replace};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::Path;
use yamanami::ValidateOptions;
use yamanami::io::mesh_file::{MeshMeta, write_mesh};
use yamanami::io::tiles::subtree::{Subtree, tile_number};
use yamanami::io::tiles::tileset::Subdivision;
use yamanami_core::TriangleMesh;

const DEEPEST: u32 = 2;
const SIDE_M: f64 = 64.0;

/// Origin and side of a tile.
fn square(level: u32, [x, y]: [u32; 2]) -> ([f64; 2], f64) {
    let side = SIDE_M / f64::from(1u32 << level);
    ([f64::from(x) * side, f64::from(y) * side], side)
}

fn mesh(level: u32, place: [u32; 2], lift_m: f64) -> TriangleMesh {
    let ([west, south], side) = square(level, place);
    let n = if level == DEEPEST { 2u32 } else { 1 << (DEEPEST - level) };
    let step = side / f64::from(n);
    let mut mesh = TriangleMesh::default();
    for k in 0..(n + 1) * (n + 1) {
        let (column, row) = (k % (n + 1), k / (n + 1));
        let (x, y) = (west + f64::from(column) * step, south + f64::from(row) * step);
        let bump = if level == DEEPEST && column == 1 && row == 1 { 1.5 } else { 0.0 };
        mesh.positions.push(DVec3::new(x, y, 0.25 * x + bump + lift_m));
        mesh.normals.push([0.0, 0.0, 1.0]);
    }
    for cell in 0..n * n {
        let a = cell / n * (n + 1) + cell % n;
        let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
        // the diagonals of the finest meet in the bump
        let rising = level != DEEPEST || cell == 0 || cell == 3;
        mesh.triangles.extend(if rising { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
    }
    mesh
}

/// The file of a tile, moved up.
pub(super) fn glb(level: u32, place: [u32; 2], lift_m: f64) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    write_mesh(&path, &mesh(level, place, lift_m), &MeshMeta::default()).unwrap();
    std::fs::read(path).unwrap()
}

fn box_of(level: u32, place: [u32; 2]) -> Value {
    let ([west, south], side) = square(level, place);
    let half = side / 2.0;
    json!({"box": [west + half, south + half, 9.0, half, 0, 0, 0, half, 0, 0, 0, 9.0]})
}

fn places() -> impl Iterator<Item = (u32, [u32; 2])> {
    (0..=DEEPEST)
        .flat_map(|level| (0..1u32 << level).flat_map(move |x| (0..1u32 << level).map(move |y| (level, [x, y]))))
}

fn write_contents(folder: &Path) {
    for (level, [x, y]) in places() {
        let path = folder.join(format!("{level}/{x}/{y}.glb"));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, glb(level, [x, y], 0.0)).unwrap();
    }
}

fn explicit(folder: &Path) {
    fn tile(level: u32, [x, y]: [u32; 2]) -> Value {
        let children: Vec<Value> = [[0, 0], [1, 0], [0, 1], [1, 1]]
            .iter()
            .filter(|_| level < DEEPEST)
            .map(|[dx, dy]| tile(level + 1, [2 * x + dx, 2 * y + dy]))
            .collect();
        let error_m = [4.0, 2.0, 0.0][level as usize];
        json!({
            "boundingVolume": box_of(level, [x, y]),
            "geometricError": error_m,
            "refine": "REPLACE",
            "content": {"uri": format!("{level}/{x}/{y}.glb")},
            "children": children,
        })
    }
    write_contents(folder);
    let tileset = json!({"asset": {"version": "1.1"}, "geometricError": 64.0, "root": tile(0, [0, 0])});
    std::fs::write(folder.join("tileset.json"), tileset.to_string()).unwrap();
}

fn implicit(folder: &Path) {
    write_contents(folder);
    let mut subtree = Subtree::new(Subdivision::Quadtree, 2);
    let mut below = Subtree::new(Subdivision::Quadtree, 2);
    (below.tiles[0], below.contents[0]) = (true, true);
    for (level, [x, y]) in places() {
        if level < 2 {
            let number = tile_number(Subdivision::Quadtree, level, [x, y, 0]);
            (subtree.tiles[number], subtree.contents[number]) = (true, true);
        } else {
            let path = folder.join(format!("subtrees/2/{x}/{y}.subtree"));
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, below.encode()).unwrap();
        }
    }
    subtree.children.fill(true);
    std::fs::create_dir_all(folder.join("subtrees/0/0")).unwrap();
    std::fs::write(folder.join("subtrees/0/0/0.subtree"), subtree.encode()).unwrap();
    let tileset = json!({
        "asset": {"version": "1.1"}, "geometricError": 64.0,
        "root": {
            "boundingVolume": box_of(0, [0, 0]), "geometricError": 4.0, "refine": "REPLACE",
            "content": {"uri": "{level}/{x}/{y}.glb"},
            "implicitTiling": {
                "subdivisionScheme": "QUADTREE", "subtreeLevels": 2, "availableLevels": 3,
                "subtrees": {"uri": "subtrees/{level}/{x}/{y}.subtree"},
            },
        },
    });
    std::fs::write(folder.join("tileset.json"), tileset.to_string()).unwrap();
}

/// A sound folder of 3D Tiles, for archives.
pub(super) fn sound(folder: &Path) {
    explicit(folder);
}

#[test]
fn sound_tilesets_have_no_finding() {
    for make in [explicit, implicit] {
        let folder = tempfile::tempdir().unwrap();
        make(folder.path());
        let report = assert_sound(folder.path(), &ValidateOptions::default());
        assert_eq!(report.tiles, [21, 21]);
        assert!(report.cracks.len() >= 3 && report.cracks.iter().all(|r| r.max_m < 1e-4), "{:?}", report.cracks);
        let root = report.errors[0];
        assert!((root.measured_m - 1.5).abs() < 1e-4 && (root.ratio - 0.375).abs() < 1e-4, "{root:?}");
    }
}

/// Changes the JSON of a binary glTF, keeping its length.
fn in_json(path: &Path, old: &str, new: &str) {
    edit(path, |bytes| {
        let at =
            bytes.windows(old.len()).position(|w| w == old.as_bytes()).unwrap_or_else(|| panic!("{old} is not there"));
        let new = format!("{new:width$}", width = old.len());
        assert_eq!(new.len(), old.len());
        bytes.splice(at..at + old.len(), new.bytes()).for_each(drop);
    });
}

/// First byte of the binary chunk's content.
fn binary_start(bytes: &[u8]) -> usize {
    20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize + 8
}

#[test]
fn faults_of_a_tileset_are_found() {
    type Spoil = fn(&Path);
    let faults: [(&str, Spoil); 22] = [
        ("TS01", |f| std::fs::write(f.join("tileset.json"), "[1").unwrap()),
        ("TS02", |f| replace(&f.join("tileset.json"), "\"version\"", "\"revision\"")),
        ("TS03", |f| replace(&f.join("tileset.json"), "\"1.1\"", "\"2.0\"")),
        ("TS04", |f| replace(&f.join("tileset.json"), "\"geometricError\":2.0", "\"geometricError\":-2.0")),
        ("TS05", |f| replace(&f.join("tileset.json"), "\"geometricError\":2.0", "\"geometricError\":9.0")),
        ("ER01", |f| replace(&f.join("tileset.json"), "\"geometricError\":2.0", "\"geometricError\":0.2")),
        ("TS07", |f| replace(&f.join("tileset.json"), "[8.0,8.0,9.0,8.0", "[8.0,8.0,9.0,5.0")),
        ("TS06", |f| replace(&f.join("tileset.json"), "[16.0,16.0,9.0,16.0", "[16.0,16.0,9.0,9.0")),
        ("TS08", |f| replace(&f.join("tileset.json"), "\"REPLACE\"", "\"INSTEAD\"")),
        ("TS09", |f| std::fs::remove_file(f.join("2/1/3.glb")).unwrap()),
        ("TS10", |f| edit(&f.join("2/1/3.glb"), |b| b[0] = b'X')),
        ("TS13", |f| replace(&f.join("tileset.json"), "\"geometricError\":64.0", "\"geometricError\":1.0")),
        ("TS14", |f| replace(&f.join("tileset.json"), "[8.0,8.0,9.0,8.0,0", "[8.0,8.0,9.0,0")),
        ("TS11", |f| {
            let sheared = "\"root\":{\"transform\":[1,0,0,0,1,1,0,0,0,0,1,0,0,0,0,1],";
            replace(&f.join("tileset.json"), "\"root\":{", sheared);
        }),
        ("GL01", |f| edit(&f.join("2/1/3.glb"), |b| b.truncate(b.len() - 8))),
        ("GL03", |f| in_json(&f.join("2/1/3.glb"), "\"byteLength\":108", "\"byteLength\":100")),
        ("GL04", |f| {
            edit(&f.join("2/1/3.glb"), |b| {
                let last = b.len() - 4;
                b[last] = 77;
            })
        }),
        ("GL05", |f| in_json(&f.join("2/1/3.glb"), "\"max\":[8.0", "\"max\":[7.0")),
        ("GL06", |f| {
            edit(&f.join("2/1/3.glb"), |b| {
                // the first normal twice as long
                let at = binary_start(b) + 12 * 9;
                b[at + 4..at + 8].copy_from_slice(&2f32.to_le_bytes());
            })
        }),
        ("GL09", |f| {
            edit(&f.join("2/1/3.glb"), |b| {
                let at = binary_start(b);
                b[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
            })
        }),
        ("GL10", |f| {
            edit(&f.join("2/1/3.glb"), |b| {
                // two corners of the last triangle change places
                let n = b.len();
                let (p, q) = (n - 8, n - 4);
                (0..4).for_each(|k| b.swap(p + k, q + k));
            })
        }),
        ("CR01", |f| std::fs::write(f.join("2/1/3.glb"), glb(2, [1, 3], 0.3)).unwrap()),
    ];
    for (code, spoil) in faults {
        let folder = tempfile::tempdir().unwrap();
        explicit(folder.path());
        spoil(folder.path());
        assert_finds(folder.path(), &ValidateOptions::default(), code);
    }
    let folder = tempfile::tempdir().unwrap();
    explicit(folder.path());
    std::fs::write(folder.path().join("1/0/1.glb"), glb(1, [0, 1], 0.3)).unwrap();
    assert_finds(folder.path(), &ValidateOptions::default(), "CR02");
}

#[test]
fn faults_of_implicit_tiling_are_found() {
    type Spoil = fn(&Path);
    let faults: [(&str, Spoil); 8] = [
        ("IM01", |f| replace(&f.join("tileset.json"), "\"subtreeLevels\":2", "\"subtreeLevels\":0")),
        ("IM02", |f| std::fs::remove_file(f.join("subtrees/2/1/1.subtree")).unwrap()),
        ("IM03", |f| edit(&f.join("subtrees/0/0/0.subtree"), |b| b[8] = b[8].wrapping_add(8))),
        ("IM05", |f| replace_in_subtree(f, "\"byteLength\":1,", "\"byteLength\":0,")),
        ("IM06", |f| replace_in_subtree(f, "\"availableCount\":1", "\"availableCount\":3")),
        ("IM07", |f| {
            edit(&f.join("subtrees/2/1/1.subtree"), |b| {
                let at = b.len() - 8;
                b[at] = 0b10;
            })
        }),
        ("IM09", |f| replace(&f.join("tileset.json"), "\"availableLevels\":3", "\"availableLevels\":2")),
        ("IM11", |f| std::fs::write(f.join("2/1/9.glb"), glb(2, [1, 1], 0.0)).unwrap()),
    ];
    for (code, spoil) in faults {
        let folder = tempfile::tempdir().unwrap();
        implicit(folder.path());
        spoil(folder.path());
        assert_finds(folder.path(), &ValidateOptions::default(), code);
    }
    let folder = tempfile::tempdir().unwrap();
    implicit(folder.path());
    std::fs::remove_file(folder.path().join("2/1/3.glb")).unwrap();
    assert_finds(folder.path(), &ValidateOptions::default(), "TS09");
}

fn replace_in_subtree(folder: &Path, old: &str, new: &str) {
    in_json(&folder.join("subtrees/2/1/1.subtree"), old, new);
}
