//! A pyramid of quantized-mesh tiles over the globe, three zooms: even ground with a bump in each cell of the finest.

use super::{assert_finds, assert_sound, edit, replace};
use std::path::{Path, PathBuf};
use yamanami::ValidateOptions;
use yamanami_core::{Crs, GeoReference, HeightField};
use yamanami_measure::tiles::earth::{SEMI_MAJOR_M, SEMI_MINOR_M, ecef_m, horizon_excess};

use glam::DVec3;

const DEEPEST: u32 = 2;
const GRID: f64 = 32767.0;
/// All tiles' heights lie between these, so that all quantise alike.
const HEIGHTS_M: [f32; 2] = [-50.0, 400.0];

/// Even ground, the same where the globe closes: any triangulation of it is exact.
fn ground_m(lon: f64, lat: f64) -> f64 {
    150.0 + 0.3 * lon.abs() + 0.3 * lat
}

/// A bump at the middle of each quarter of a finest tile, other at each.
fn bump_m(column: usize, row: usize) -> f64 {
    6.0 + ((column * 37 + row * 61) % 11) as f64
}

/// A tile that can be spoilt before it is encoded.
pub(super) struct Tile {
    pub(super) vertices: Vec<[u16; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) heights_m: [f32; 2],
    pub(super) radius_share: f64,
    pub(super) horizon_lift: f64,
    pub(super) sides: [Vec<u32>; 4],
    /// Up, or down.
    pub(super) normals_up: f64,
    positions: Vec<DVec3>,
    centre: DVec3,
}

impl Tile {
    /// The sound tile of a zoom, column and row from the south.
    pub(super) fn made([z, x, y]: [u32; 3]) -> Self {
        let side = 180.0 / f64::from(1u32 << z);
        let (west, south) = (f64::from(x) * side - 180.0, f64::from(y) * side - 90.0);
        // the finest have a vertex at each bump, all others only even ground
        let n = if z == DEEPEST { 4 } else { 2 };
        let mut tile = Self {
            vertices: Vec::new(),
            triangles: Vec::new(),
            heights_m: HEIGHTS_M,
            radius_share: 1.0,
            horizon_lift: 0.0,
            sides: Default::default(),
            normals_up: 1.0,
            positions: Vec::new(),
            centre: DVec3::ZERO,
        };
        let step = |k: usize| if k == n { GRID as u16 } else { (k * 32768 / n) as u16 };
        for row in 0..=n {
            for column in 0..=n {
                let (u, v) = (step(column), step(row));
                let (lon, lat) = (west + f64::from(u) / GRID * side, south + f64::from(v) / GRID * side);
                let is_bump = n == 4 && column % 2 == 1 && row % 2 == 1;
                let bump = bump_m(x as usize * 4 + column, y as usize * 4 + row);
                let height_m = ground_m(lon, lat) + if is_bump { bump } else { 0.0 };
                let [low, high] = HEIGHTS_M.map(f64::from);
                tile.vertices.push([u, v, ((height_m - low) / (high - low) * GRID).round() as u16]);
                tile.positions.push(ecef_m([lon, lat, height_m]));
            }
        }
        let w = n as u32 + 1;
        for cell in 0..(n * n) as u32 {
            let a = cell / n as u32 * w + cell % n as u32;
            // diagonals run from bump to bump, or from corner to corner without one
            let is_rising = n == 2 || (cell / n as u32 + cell % n as u32).is_multiple_of(2);
            let [b, c, d] = [a + 1, a + 1 + w, a + w];
            tile.triangles.extend(if is_rising { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
        tile.in_order();
        let on = |axis: usize, value: u16| {
            (0u32..).zip(&tile.vertices).filter(|(_, v)| v[axis] == value).map(|(k, _)| k).collect::<Vec<_>>()
        };
        tile.sides = [on(0, 0), on(1, 0), on(0, GRID as u16), on(1, GRID as u16)];
        tile.centre = ecef_m([west + side / 2.0, south + side / 2.0, 175.0]);
        tile
    }

    /// Vertices in the order in which triangles need them first.
    fn in_order(&mut self) {
        let mut new_of = vec![u32::MAX; self.vertices.len()];
        let mut order = Vec::new();
        for corner in self.triangles.iter_mut().flatten() {
            if new_of[*corner as usize] == u32::MAX {
                new_of[*corner as usize] = order.len() as u32;
                order.push(*corner as usize);
            }
            *corner = new_of[*corner as usize];
        }
        self.vertices = order.iter().map(|&k| self.vertices[k]).collect();
        self.positions = order.iter().map(|&k| self.positions[k]).collect();
    }

    fn horizon(&self) -> DVec3 {
        let radii = DVec3::new(SEMI_MAJOR_M, SEMI_MAJOR_M, SEMI_MINOR_M);
        let towards = (self.centre / radii).normalize();
        let excess = horizon_excess(towards.to_array(), &self.positions);
        towards * (1.0 + if excess.is_finite() { 1.0001 * excess + 1e-7 } else { 100.0 } + self.horizon_lift)
    }

    pub(super) fn encode(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let doubles = |bytes: &mut Vec<u8>, v: &[f64]| v.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        let middle = self.positions.iter().sum::<DVec3>() / self.positions.len() as f64;
        let radius = self.positions.iter().map(|p| p.distance(middle)).fold(0.0, f64::max) + 1.0;
        doubles(&mut bytes, &self.centre.to_array());
        self.heights_m.iter().for_each(|h| bytes.extend(h.to_le_bytes()));
        doubles(&mut bytes, &middle.to_array());
        doubles(&mut bytes, &[radius * self.radius_share]);
        doubles(&mut bytes, &self.horizon().to_array());
        bytes.extend((self.vertices.len() as u32).to_le_bytes());
        for axis in 0..3 {
            let mut last = 0i32;
            for vertex in &self.vertices {
                let d = i32::from(vertex[axis]) - last;
                bytes.extend((((d << 1) ^ (d >> 31)) as u16).to_le_bytes());
                last = i32::from(vertex[axis]);
            }
        }
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        let mut mark = 0u32;
        for &corner in self.triangles.iter().flatten() {
            bytes.extend((mark.wrapping_sub(corner) as u16).to_le_bytes());
            mark += u32::from(corner == mark);
        }
        for side in &self.sides {
            bytes.extend((side.len() as u32).to_le_bytes());
            side.iter().for_each(|&k| bytes.extend((k as u16).to_le_bytes()));
        }
        bytes.push(1);
        bytes.extend((2 * self.vertices.len() as u32).to_le_bytes());
        for position in &self.positions {
            let up = (*position / DVec3::new(1.0, 1.0, (SEMI_MINOR_M / SEMI_MAJOR_M).powi(2))).normalize();
            bytes.extend(octahedral(up * self.normals_up));
        }
        bytes
    }
}

fn octahedral(n: DVec3) -> [u8; 2] {
    let n = n / (n.x.abs() + n.y.abs() + n.z.abs());
    let folded = [(1.0 - n.y.abs()) * n.x.signum(), (1.0 - n.x.abs()) * n.y.signum()];
    let [x, y] = if n.z < 0.0 { folded } else { [n.x, n.y] };
    [x, y].map(|c| ((c * 0.5 + 0.5) * 255.0).round() as u8)
}

fn path_of(folder: &Path, [z, x, y]: [u32; 3]) -> PathBuf {
    folder.join(format!("{z}/{x}/{y}.terrain"))
}

/// A whole pyramid, with a tile spoilt.
fn pyramid(folder: &Path, spoil: impl Fn([u32; 3], &mut Tile)) {
    for z in 0..=DEEPEST {
        for (x, y) in (0..2 << z).flat_map(|x| (0..1 << z).map(move |y| (x, y))) {
            let mut tile = Tile::made([z, x, y]);
            spoil([z, x, y], &mut tile);
            let path = path_of(folder, [z, x, y]);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, tile.encode()).unwrap();
        }
    }
    let available: Vec<_> = (0..=DEEPEST)
        .map(|z| serde_json::json!([{"startX": 0, "startY": 0, "endX": (2 << z) - 1, "endY": (1 << z) - 1}]))
        .collect();
    let layer = serde_json::json!({
        "tilejson": "2.1.0", "format": "quantized-mesh-1.0", "version": "1.0.0", "scheme": "tms",
        "tiles": ["{z}/{x}/{y}.terrain?v={version}"], "projection": "EPSG:4326", "bounds": [-180, -90, 180, 90],
        "minzoom": 0, "maxzoom": DEEPEST, "available": available,
    });
    std::fs::write(folder.join("layer.json"), layer.to_string()).unwrap();
}

/// The samples that the finest tiles were made of.
fn source(path: &Path) {
    let (width, height) = (33, 17);
    let crs = Crs { epsg: Some(4326), geographic: true, ..Crs::default() };
    let geo = GeoReference::new(crs, [-180.0, 90.0], [11.25, -11.25], [width, height]);
    let heights = (0..width * height).map(|k| {
        let (column, row) = (k % width, 16 - k / width);
        let ground = ground_m(column as f64 * 11.25 - 180.0, row as f64 * 11.25 - 90.0);
        (ground + if column % 2 == 1 && row % 2 == 1 { bump_m(column, row) } else { 0.0 }) as f32
    });
    let field = HeightField::new(width, height, heights.collect(), geo);
    yamanami::io::dem::write_geotiff(path, &field).unwrap();
}

fn options() -> ValidateOptions {
    let mut options = ValidateOptions::default();
    options.declared_m = Some(15.0);
    options
}

#[test]
fn a_sound_pyramid_has_no_finding() {
    let folder = tempfile::tempdir().unwrap();
    pyramid(folder.path(), |_, _| ());
    let dem = tempfile::tempdir().unwrap();
    let mut options = options();
    options.source = vec![dem.path().join("dem.tif")];
    source(&options.source[0]);
    let report = assert_sound(folder.path(), &options);
    assert_eq!((report.tiles, report.cracks.len()), ([42, 42], 6));
    assert!(report.cracks.iter().all(|row| row.max_m < 0.1 && row.pairs > 0), "{:?}", report.cracks);
    let [root, _, finest] = report.errors.as_slice() else { panic!("three zooms") };
    assert!((root.measured_m - 16.0).abs() < 0.1 && root.declared_m == 60.0, "{root:?}");
    assert!(finest.source_m[0] < 0.1 && finest.samples[0] >= 33 * 17, "{finest:?}");
    // some tiles at random: no fewer rules
    options.tiles = Some(7);
    assert_eq!(assert_sound(folder.path(), &options).tiles, [42, 7]);
}

#[test]
fn faults_of_a_tile_are_found() {
    type Spoil = fn(&mut Tile);
    let faults: [(&str, Spoil); 15] = [
        ("QM03", |t| t.heights_m[1] = f32::NAN),
        ("QM04", |t| t.heights_m = [400.0, -50.0]),
        ("QM07", |t| t.sides[2][1] = 999),
        ("QM06", |t| t.triangles[3][1] = 60000),
        ("QM08", |t| t.triangles.swap(0, 20)),
        ("QM10", |t| t.triangles[2].swap(0, 1)),
        ("QM11", |t| t.sides[0][2] = t.sides[2][1]),
        ("QM12", |t| t.sides[1].truncate(3)),
        ("QM13", |t| t.radius_share = 0.7),
        ("QM15", |t| t.horizon_lift = -0.02),
        ("QM18", |t| t.normals_up = -1.0),
        ("QM19", |t| t.triangles.truncate(16)),
        ("QM24", |t| t.triangles.retain(|corners| !corners.contains(&20))),
        ("QM25", |t| t.triangles[9] = t.triangles[8]),
        ("CR01", |t| {
            // half a metre up, at a vertex of the western side
            let k = t.sides[0][2] as usize;
            t.vertices[k][2] += 37;
        }),
    ];
    for (code, spoil) in faults {
        let folder = tempfile::tempdir().unwrap();
        pyramid(folder.path(), |id, tile| {
            if id == [2, 4, 2] {
                spoil(tile);
            }
        });
        let report = assert_finds(folder.path(), &options(), code);
        let named = report.findings.iter().find(|f| f.code == code).map(|f| f.tile.clone());
        assert_eq!(named.as_deref(), Some("2/4/2.terrain"), "{code}");
    }
}

#[test]
fn a_crack_between_levels_is_found() {
    let folder = tempfile::tempdir().unwrap();
    pyramid(folder.path(), |id, tile| {
        if id == [1, 1, 1] {
            let k = tile.sides[2][1] as usize;
            tile.vertices[k][2] += 37;
        }
    });
    let report = assert_finds(folder.path(), &options(), "CR02");
    let row = report.cracks.iter().find(|r| (r.coarse, r.fine) == (1, 2)).unwrap();
    assert!((row.max_m - 0.51).abs() < 0.05 && row.over == 2, "{row:?}");
    assert!((row.worst[0] + 0.0).abs() < 1e-9 && (row.worst[1] - 45.0).abs() < 0.01, "{row:?}");
}

#[test]
fn faults_of_bytes_and_files_are_found() {
    type Spoil = fn(&Path);
    let faults: [(&str, Spoil); 14] = [
        ("QM02", |f| edit(&path_of(f, [2, 3, 1]), |b| b.truncate(200))),
        ("QM01", |f| edit(&path_of(f, [2, 3, 1]), |b| b.splice(0..2, [0x1f, 0x8b]).for_each(drop))),
        ("QM05", |f| edit(&path_of(f, [2, 3, 1]), |b| b[93] = 0xff)),
        ("QM17", |f| edit(&path_of(f, [2, 3, 1]), |b| b.truncate(b.len() - 1))),
        ("QM21", |f| {
            // rows from the north
            let (a, b) = (path_of(f, [2, 3, 0]), path_of(f, [2, 3, 3]));
            std::fs::rename(&a, f.join("x")).unwrap();
            std::fs::rename(&b, &a).unwrap();
            std::fs::rename(f.join("x"), &b).unwrap();
        }),
        ("LJ01", |f| std::fs::write(f.join("layer.json"), "{").unwrap()),
        ("LJ02", |f| replace(&f.join("layer.json"), "quantized-mesh-1.0", "heightmap-1.0")),
        ("LJ03", |f| replace(&f.join("layer.json"), "{z}/{x}/{y}", "{z}/{x}/{q}")),
        ("LJ04", |f| replace(&f.join("layer.json"), "\"tms\"", "\"xyz\"")),
        ("LJ05", |f| replace(&f.join("layer.json"), "-180,-90", "180,-90")),
        ("LJ06", |f| std::fs::remove_file(path_of(f, [2, 3, 1])).unwrap()),
        ("LJ07", |f| replace(&f.join("layer.json"), "\"endX\":7", "\"endX\":5")),
        ("PY01", |f| std::fs::remove_file(path_of(f, [1, 1, 0])).unwrap()),
        ("PY02", |f| std::fs::remove_file(path_of(f, [0, 1, 0])).unwrap()),
    ];
    for (code, spoil) in faults {
        let folder = tempfile::tempdir().unwrap();
        pyramid(folder.path(), |_, _| ());
        spoil(folder.path());
        assert_finds(folder.path(), &options(), code);
    }
}

#[test]
fn broken_promises_are_found() {
    let folder = tempfile::tempdir().unwrap();
    pyramid(folder.path(), |_, _| ());
    let mut options = options();
    options.declared_m = Some(5.0);
    assert_finds(folder.path(), &options, "ER01");
    let dem = tempfile::tempdir().unwrap();
    options.declared_m = Some(15.0);
    options.source = vec![dem.path().join("dem.tif")];
    source(&options.source[0]);
    options.source_offset_m = 20.0;
    assert_finds(folder.path(), &options, "ER03");
    options.source_offset_m = 0.0;
    pyramid(folder.path(), |id, tile| {
        if id == [2, 4, 2] {
            tile.triangles.truncate(16);
        }
    });
    assert_finds(folder.path(), &options, "ER04");
    pyramid(folder.path(), |id, tile| {
        if id == [1, 1, 1] {
            tile.triangles.truncate(4);
        }
    });
    assert_finds(folder.path(), &options, "ER07");
    // the ground half a sample further east than it should be
    pyramid(folder.path(), |[z, x, _], tile| {
        let by = (0.5 * 11.25 * 0.3 / 450.0 * GRID) as u16;
        for vertex in &mut tile.vertices {
            vertex[2] = if x < 1 << z { vertex[2] + by } else { vertex[2] - by };
        }
    });
    let report = assert_finds(folder.path(), &options, "ER05");
    let shift = report.errors.last().unwrap().shift.unwrap();
    assert!(shift[0] > 0.1, "{shift:?}");
}
