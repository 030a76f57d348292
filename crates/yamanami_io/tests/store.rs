//! The surface database: pages of any surface go in and come back, and no bytes make it panic.

use proptest::prelude::*;
use std::path::Path;
use yamanami_core::{ErrorCode, GeoReference, Lattice, PAGE_CELLS, PageId, TerrainPage};
use yamanami_io::IoError;
use yamanami_io::store::{PageCodec, Quantum, QuantumFinder, TerrainMeta, TerrainStore, TerrainWriter};

/// A surface as a builder would hand it over: heights, an error code for every new point, and holes.
struct Surface {
    lattice: Lattice,
    heights_m: Vec<f32>,
    hidden: Option<fn(u32, u32) -> bool>,
}

impl Surface {
    fn new(width: usize, height: usize, height_m: impl Fn(usize, usize) -> f32) -> Self {
        let heights_m = (0..width * height).map(|i| height_m(i % width, i / width)).collect();
        Self { lattice: Lattice::new(width, height), heights_m, hidden: None }
    }

    fn z(&self, level: u32, x: u32, y: u32) -> f32 {
        let [column, row] = self.lattice.sample(level, x, y);
        self.heights_m[row as usize * self.lattice.width() as usize + column as usize]
    }

    /// The detail of a new point, and on coarser levels as much as the greatest below it: rises with the level.
    fn error(&self, level: u32, x: u32, y: u32) -> ErrorCode {
        if (x | y) & 1 == 0 {
            return ErrorCode(0);
        }
        let [nx, ny] = self.lattice.points(level);
        let at = |x: u32, y: u32| self.z(level, x.min(nx - 1), y.min(ny - 1));
        let (dx, dy) = (x & 1, y & 1);
        let (z, a, b) = (at(x, y), at(x - dx, y - dy), at(x + dx, y + dy));
        let own_m = (0.5 * ((z - a) + (z - b))).abs();
        ErrorCode::ceil(own_m * (1 << level) as f32 + if level > 0 { 0.3 } else { 0.0 })
    }

    fn page(&self, id: PageId) -> TerrainPage {
        let [nx, ny] = self.lattice.squares(id.level);
        let [x0, y0] = [id.x * PAGE_CELLS, id.y * PAGE_CELLS];
        let (width, height) = ((nx - x0).min(PAGE_CELLS) + 1, (ny - y0).min(PAGE_CELLS) + 1);
        let points = || (0..height).flat_map(|y| (0..width).map(move |x| (x0 + x, y0 + y)));
        let base = id.level == self.lattice.levels();
        let shown = |hidden: fn(u32, u32) -> bool| {
            let squares = (0..height - 1).flat_map(|y| (0..width - 1).map(move |x| (x0 + x, y0 + y)));
            let half = |x: u32, y: u32| u8::from(!hidden(x << id.level, y << id.level));
            squares.map(|(x, y)| half(x, y) | half(x + 1, y) << 1).collect()
        };
        TerrainPage {
            id,
            width,
            height,
            heights_m: points().map(|(x, y)| self.z(id.level, x, y)).collect(),
            errors: points().map(|(x, y)| if base { ErrorCode(0) } else { self.error(id.level, x, y) }).collect(),
            shown: self.hidden.map_or_else(Vec::new, shown),
        }
    }

    fn meta(&self, quantum: Quantum) -> TerrainMeta {
        let range = |r: [f32; 2], z: &f32| [r[0].min(*z), r[1].max(*z)];
        TerrainMeta {
            geo: GeoReference::local([30.0, 25.0], self.lattice.height() as usize),
            size: [self.lattice.width(), self.lattice.height()],
            height_range_m: self.heights_m.iter().fold([f32::INFINITY, f32::NEG_INFINITY], range),
            bound_radius_m: (0..self.lattice.levels()).map(|l| 70.5 * f64::from(1u32 << l)).collect(),
            has_holes: self.hidden.is_some(),
            max_error_m: 0.0,
            quantum,
            error_steps_per_octave: 4,
            level0_slack_m: 0.0,
            title: "hills".into(),
            source: "made for a test".into(),
        }
    }

    fn lossless(&self) -> Quantum {
        let mut finder = QuantumFinder::default();
        finder.add(&self.heights_m);
        finder.lossless()
    }

    fn page_ids(&self) -> Vec<PageId> {
        let codec = codec(&self.meta(Quantum::Bits));
        let levels = (0..=self.lattice.levels()).rev();
        let ids = levels.flat_map(|level| {
            let [nx, ny] = codec.pages(level);
            (0..ny).flat_map(move |y| (0..nx).map(move |x| PageId { level, x, y }))
        });
        ids.collect()
    }

    fn write(&self, path: &Path, quantum: Quantum) -> Result<(), IoError> {
        let mut writer = TerrainWriter::create(path, self.meta(quantum))?;
        for id in self.page_ids() {
            writer.write_page(&self.page(id))?;
        }
        writer.finish()
    }
}

fn codec(meta: &TerrainMeta) -> PageCodec {
    PageCodec::new(meta.size, meta.quantum, meta.has_holes, meta.error_steps_per_octave, meta.level0_slack_m).unwrap()
}

fn hash(i: usize, seed: u32) -> u32 {
    (i as u32).wrapping_mul(2_654_435_761).wrapping_add(seed).wrapping_mul(2_246_822_519) >> 8
}

/// Hills with noise, in steps of 1/`per_metre`.
fn hills(width: usize, height: usize, seed: u32, noise: f32, per_metre: f32) -> Surface {
    Surface::new(width, height, |x, y| {
        let (u, v) = (x as f32 * 0.05, y as f32 * 0.07);
        let smooth = 400.0 * (u.sin() + (v + 0.3 * u).cos()) + 900.0;
        let rough = (hash(y * width + x, seed) % 1000) as f32 * 0.001 * noise;
        ((smooth + rough) * per_metre).round() / per_metre
    })
}

/// Every page, decoded from its bytes alone and its coarser page, is the page that went in.
fn assert_round_trip(surface: &Surface, quantum: Quantum) -> usize {
    let codec = codec(&surface.meta(quantum));
    let mut decoded = std::collections::HashMap::new();
    let mut bytes = 0;
    for id in surface.page_ids() {
        let page = surface.page(id);
        let encoded = codec.encode_page(&page).unwrap();
        bytes += encoded.bytes().len();
        let parent = codec.parent(id).map(|p| &decoded[&p]);
        let back = codec.decode_page(id, encoded.bytes(), parent).unwrap();
        assert_eq!([back.width, back.height], [page.width, page.height]);
        assert_eq!(back.heights_m, page.heights_m, "{id:?}");
        assert_eq!(back.shown, page.shown);
        for (i, (stored, given)) in back.errors.iter().zip(&page.errors).enumerate() {
            assert_eq!(*stored, codec.stored_code(id.level, *given), "{id:?} {i} {given:?}");
            assert!(*stored >= *given);
        }
        decoded.insert(id, back);
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_size_comes_back(
        width in 2usize..300, height in 2usize..120, turned in any::<bool>(), seed in any::<u32>(), noise in 0f32..30.0,
        per_metre in prop::sample::select(vec![1.0f32, 2.0, 4.0, 10.0, 64.0, 100.0]),
    ) {
        let (width, height) = if turned { (height, width) } else { (width, height) };
        let surface = hills(width, height, seed, noise, per_metre);
        let quantum = surface.lossless();
        prop_assert!(matches!(quantum, Quantum::PerMetre(n) if n <= per_metre as u32));
        assert_round_trip(&surface, quantum);
        assert_round_trip(&surface, Quantum::Bits);
    }

    #[test]
    fn arbitrary_floats_come_back(width in 2usize..40, height in 2usize..40, bits in proptest::collection::vec(any::<u32>(), 1600)) {
        let surface = Surface::new(width, height, |x, y| {
            let z = f32::from_bits(bits[y * width + x]);
            if z.is_finite() && z.abs() < 1e30 { z } else { 0.25 }
        });
        assert_round_trip(&surface, Quantum::Bits);
    }

    #[test]
    fn holes_come_back(width in 2usize..90, height in 2usize..90, seed in any::<u32>()) {
        let mut surface = hills(width, height, seed, 3.0, 1.0);
        surface.hidden = Some(|x, y| x.abs_diff(30).pow(2) + y.abs_diff(25).pow(2) < 400 || x == y);
        assert_round_trip(&surface, Quantum::PerMetre(1));
    }

    #[test]
    fn any_errors_come_back(width in 2usize..90, height in 2usize..90, codes in proptest::collection::vec(any::<u16>(), 64)) {
        let surface = hills(width, height, 9, 3.0, 1.0);
        let codec = codec(&surface.meta(Quantum::PerMetre(1)));
        for id in surface.page_ids() {
            let mut page = surface.page(id);
            let new = |i: u32| ((i % page.width) | (i / page.width)) & 1 == 1 && id.level < surface.lattice.levels();
            for (i, error) in (0..).zip(&mut page.errors) {
                if new(i) {
                    *error = ErrorCode(codes[i as usize % 64]);
                }
            }
            let bytes = codec.encode_page(&page).unwrap();
            let parent = codec.parent(id).map(|p| surface.page(p));
            let back = codec.decode_page(id, bytes.bytes(), parent.as_ref()).unwrap();
            for (stored, given) in back.errors.iter().zip(&page.errors) {
                prop_assert_eq!(*stored, codec.stored_code(id.level, *given));
            }
        }
    }

    #[test]
    fn damaged_pages_are_told(at in any::<prop::sample::Index>(), flip in 1u8..=255, level in 0u32..3, cut in any::<bool>()) {
        let surface = hills(70, 45, 3, 9.0, 1.0);
        let codec = codec(&surface.meta(Quantum::PerMetre(1)));
        let id = PageId { level, x: 0, y: 0 };
        let parent = surface.page(codec.parent(id).unwrap());
        let mut bytes = codec.encode_page(&surface.page(id)).unwrap().bytes().to_vec();
        let i = at.index(bytes.len());
        if cut {
            bytes.truncate(i);
        } else {
            bytes[i] ^= flip;
        }
        // never a panic, and never a page of another shape
        if let Ok(page) = codec.decode_page(id, &bytes, Some(&parent)) {
            prop_assert!(!cut);
            prop_assert_eq!(page.heights_m.len(), parent_points(&codec, id));
        }
    }

    #[test]
    fn any_bytes_are_safe(bytes in proptest::collection::vec(any::<u8>(), 0..300), level in 0u32..8, quantum in 0usize..3) {
        let surface = hills(70, 45, 3, 9.0, 1.0);
        let quantum = [Quantum::PerMetre(1), Quantum::Step(0.37), Quantum::Bits][quantum];
        let mut quantised = surface;
        quantum.quantise(&mut quantised.heights_m);
        let codec = codec(&quantised.meta(quantum));
        let id = PageId { level, x: 0, y: 0 };
        let parent = codec.parent(id).map(|p| quantised.page(p));
        let _ = codec.decode_page(id, &bytes, parent.as_ref());
    }
}

fn parent_points(codec: &PageCodec, id: PageId) -> usize {
    codec.page_points(id).map_or(0, |[w, h]| (w * h) as usize)
}

#[test]
fn a_file_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hills.yama");
    let surface = hills(1100, 530, 11, 5.0, 1.0);
    surface.write(&path, surface.lossless()).unwrap();
    assert!(!folder.path().join("hills.yama.part").exists());
    let store = TerrainStore::open(&path).unwrap();
    assert_eq!(store.meta(), &surface.meta(Quantum::PerMetre(1)));
    store.verify().unwrap();
    store.set_cache_bytes(1 << 20);
    for id in surface.page_ids() {
        assert_eq!(store.page(id).unwrap().heights_m, surface.page(id).heights_m);
        let b = store.page_bounds(id).unwrap();
        let z = surface.page(id).heights_m;
        assert!(z.iter().all(|&z| (b.min.z..=b.max.z).contains(&f64::from(z))));
        assert!(store.pages_in(id.level, [b.min.x, b.min.y], [b.max.x, b.max.y]).unwrap().contains(&id));
    }
    assert!(store.cached_bytes() <= 1 << 20);
    assert_eq!(store.pages_in(0, [-10.0, -10.0], [-5.0, 50.0]).unwrap(), []);
    assert_eq!(store.pages_in(0, [0.0, -1e9], [1e9, 1e9]).unwrap().len(), 5 * 3);
    // blocks on every level, across pages, to the last point
    for level in 0..=store.lattice().levels() {
        let [nx, ny] = store.lattice().points(level);
        let (x0, y0) = (nx / 3, ny / 4);
        let block = store.read_height_block(level, x0, y0, nx - x0, ny - y0).unwrap();
        let expected: Vec<f32> =
            (y0..ny).flat_map(|y| (x0..nx).map(move |x| (x, y))).map(|(x, y)| surface.z(level, x, y)).collect();
        assert_eq!(block, expected);
        assert!(store.read_height_block(level, x0, y0, nx, ny).is_err());
    }
    assert!(store.page(PageId { level: 0, x: 5, y: 0 }).is_err());
    assert!(store.page(PageId { level: 40, x: 0, y: 0 }).is_err());
    // far smaller than the heights alone
    let bytes = std::fs::metadata(&path).unwrap().len();
    assert!(bytes < 1100 * 530, "{bytes} bytes");
}

#[test]
fn threads_share_a_store() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hills.yama");
    let surface = hills(700, 700, 5, 5.0, 1.0);
    surface.write(&path, Quantum::PerMetre(1)).unwrap();
    let store = TerrainStore::open(&path).unwrap();
    store.set_cache_bytes(600_000);
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let (store, surface) = (&store, &surface);
            scope.spawn(move || {
                for mut id in surface.page_ids() {
                    if thread % 2 == 1 {
                        (id.x, id.y) = (id.y, id.x);
                    }
                    assert_eq!(store.page(id).unwrap().heights_m, surface.page(id).heights_m);
                }
            });
        }
    });
}

#[test]
fn a_stated_error_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hills.yama");
    let source = hills(300, 200, 5, 5.0, 1000.0);
    let mut finder = QuantumFinder::default();
    finder.add(&source.heights_m);
    let quantum = finder.within(0.5);
    let mut surface = Surface { heights_m: source.heights_m.clone(), ..hills(300, 200, 5, 5.0, 1.0) };
    quantum.quantise(&mut surface.heights_m);
    surface.write(&path, quantum).unwrap();
    let store = TerrainStore::open(&path).unwrap();
    let block = store.read_height_block(0, 0, 0, 300, 200).unwrap();
    assert_eq!(block, surface.heights_m);
    assert!(block.iter().zip(&source.heights_m).all(|(a, b)| (a - b).abs() <= 0.5));
}

#[test]
fn what_is_not_whole_is_not_opened() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hills.yama");
    let surface = hills(300, 280, 5, 5.0, 1.0);
    surface.write(&path, Quantum::PerMetre(1)).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let open_error = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        let message = TerrainStore::open(&path).unwrap_err().to_string();
        assert!(message.contains("hills.yama") && !message.contains('\n'), "{message}");
        message
    };
    assert!(open_error(&[]).contains("100 bytes"));
    assert!(open_error(&[b'x'; 5000]).contains("SQLite"));
    assert!(open_error(&whole[..whole.len() - 100]).contains("cut short"));
    let mut bytes = whole.clone();
    bytes[63] = 9;
    assert!(open_error(&bytes).contains("version 9"));
    bytes[63] = 0;
    assert!(open_error(&bytes).contains("broke off"));
    bytes = whole.clone();
    bytes[70] ^= 1;
    assert!(open_error(&bytes).contains("another program's"));
    std::fs::remove_file(&path).unwrap();
    assert!(matches!(TerrainStore::open(&path), Err(IoError::Io { .. })));
    assert!(TerrainStore::open(folder.path()).is_err());
}

#[test]
fn any_damage_is_an_error_or_harmless() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hills.yama");
    let surface = hills(90, 70, 5, 5.0, 1.0);
    surface.write(&path, Quantum::PerMetre(1)).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let expected = surface.heights_m.clone();
    for i in 0..400 {
        let mut bytes = whole.clone();
        for k in 0..1 + i % 3 {
            let at = hash(i * 7 + k, 1) as usize % bytes.len();
            bytes[at] ^= (hash(i * 7 + k, 2) % 255 + 1) as u8;
        }
        std::fs::write(&path, &bytes).unwrap();
        let Ok(store) = TerrainStore::open(&path) else { continue };
        if store.meta().size != [90, 70] || store.meta().quantum != Quantum::PerMetre(1) {
            continue;
        }
        if let Ok(block) = store.read_height_block(0, 0, 0, 90, 70) {
            assert_eq!(block, expected, "damage {i} went unseen");
        }
        let _ = store.verify();
    }
}

#[test]
fn an_unfinished_build_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hills.yama");
    std::fs::write(&path, b"the old file").unwrap();
    let surface = hills(300, 280, 5, 5.0, 1.0);
    let part = folder.path().join("hills.yama.part");
    {
        let mut writer = TerrainWriter::create(&path, surface.meta(Quantum::PerMetre(1))).unwrap();
        let ids = surface.page_ids();
        for &id in &ids[..3] {
            writer.write_page(&surface.page(id)).unwrap();
        }
        assert!(part.exists());
        let error = writer.finish().unwrap_err().to_string();
        assert!(error.contains("expected") && error.contains("level 0"), "{error}");
    }
    assert!(!part.exists());
    assert_eq!(std::fs::read(&path).unwrap(), b"the old file");
    // what a killed build leaves is no surface, and is no obstacle
    std::fs::write(&part, b"half a file").unwrap();
    surface.write(&path, Quantum::PerMetre(1)).unwrap();
    TerrainStore::open(&path).unwrap().verify().unwrap();
    assert!(!part.exists());
}

/// Found by the fuzz target `yama_page`: a height that cannot be written was read.
#[test]
fn heights_off_the_quantum_are_not_read() {
    let codec = PageCodec::new([2, 2], Quantum::PerMetre(10), true, 128, 0.0).unwrap();
    let bytes = [1, 10, 0, 86, 240, 240, 74, 10, 255, 255, 255, 255, 0, 25, 25, 52, 51, 51, 51, 51, 51, 240];
    assert!(codec.decode_page(PageId { level: 0, x: 0, y: 0 }, &bytes, None).is_err());
    for quantum in [
        Quantum::PerMetre(0),
        Quantum::Step(0.0),
        Quantum::Step(f64::NAN),
        Quantum::Step(f64::INFINITY),
    ] {
        assert!(PageCodec::new([2, 2], quantum, false, 2, 0.0).is_err());
    }
}

#[test]
fn pages_that_do_not_fit_are_refused() {
    let surface = hills(300, 280, 5, 5.0, 1.0);
    let codec = codec(&surface.meta(Quantum::PerMetre(1)));
    let good = surface.page(PageId { level: 0, x: 0, y: 0 });
    assert!(codec.encode_page(&good).is_ok());
    let mut page = good.clone();
    page.heights_m[7] += 0.5;
    assert!(codec.encode_page(&page).unwrap_err().to_string().contains("quantum"));
    page.heights_m[7] = f32::NAN;
    assert!(codec.encode_page(&page).is_err());
    page = good.clone();
    page.width = 256;
    assert!(codec.encode_page(&page).is_err());
    page = good.clone();
    page.id.x = 9;
    assert!(codec.encode_page(&page).is_err());
    page = good;
    page.shown = vec![3; 256 * 256];
    assert!(codec.encode_page(&page).is_err());
    assert!(PageCodec::new([1, 5], Quantum::Bits, false, 4, 0.0).is_err());
    assert!(PageCodec::new([5, 5], Quantum::Bits, false, 3, 0.0).is_err());
}
