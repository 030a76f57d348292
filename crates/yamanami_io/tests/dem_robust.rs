//! No reader panics, hangs or takes much memory on damaged files: valid ones with bytes changed, cut out or cut off.

mod dem_samples;

use dem_samples::{asc, dted, fixture, full_fg_gml, gzip, hgt, png, terrarium, zip};
use proptest::prelude::*;
use std::sync::LazyLock;
use yamanami_io::dem::{self, OpenOptions};

/// A name and the content of a valid file for every format, small ones many times over SRTM's fixed size.
static SEEDS: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| {
    let mut seeds: Vec<(String, Vec<u8>)> = std::fs::read_dir(fixture(""))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "tif"))
        .map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), std::fs::read(&path).unwrap()))
        .collect();
    let tile = png(16, 16, |x, y| terrarium((x * 3 + y) as f32));
    let text_tile = format!("{}\n", ["1.5"; 256].join(",")).repeat(256);
    let archive = zip(&[
        ("a.dt0", &dted(5, 4)),
        ("b.xml", full_fg_gml().as_bytes()),
        ("c.asc", asc(4, 4).as_bytes()),
    ]);
    seeds.extend([
        ("a.dt0".to_owned(), dted(5, 4)),
        ("a.asc".to_owned(), asc(12, 9).into_bytes()),
        ("a.xml".to_owned(), full_fg_gml().into_bytes()),
        ("4/5/6.png".to_owned(), tile),
        ("4/5/6.txt".to_owned(), text_tile.into_bytes()),
        ("a.dt0.gz".to_owned(), gzip(&dted(5, 4))),
        ("a.xml.zip".to_owned(), zip(&[("a.xml", full_fg_gml().as_bytes())])),
        ("all.zip".to_owned(), archive),
    ]);
    seeds.sort();
    seeds
});

/// One change of a file.
#[derive(Debug, Clone)]
enum Damage {
    Set(prop::sample::Index, u8),
    Number(prop::sample::Index, u32),
    Cut(prop::sample::Index),
    Remove(prop::sample::Index, usize),
    Repeat(prop::sample::Index, usize),
}

fn damage() -> impl Strategy<Value = Damage> {
    let number = prop_oneof![
        Just(0),
        Just(1),
        Just(u32::MAX),
        Just(0x7FFF_FFFF),
        Just(0xFFFF),
        Just(1 << 20),
        any::<u32>()
    ];
    prop_oneof![
        4 => (any::<prop::sample::Index>(), any::<u8>()).prop_map(|(at, value)| Damage::Set(at, value)),
        2 => (any::<prop::sample::Index>(), number).prop_map(|(at, value)| Damage::Number(at, value)),
        1 => any::<prop::sample::Index>().prop_map(Damage::Cut),
        1 => (any::<prop::sample::Index>(), 1usize..40).prop_map(|(at, count)| Damage::Remove(at, count)),
        1 => (any::<prop::sample::Index>(), 1usize..40).prop_map(|(at, count)| Damage::Repeat(at, count)),
    ]
}

fn apply(damage: &Damage, bytes: &mut Vec<u8>, header: bool) {
    if bytes.is_empty() {
        return;
    }
    // Most of what can go wrong is at the start.
    let reach = if header { bytes.len().min(400) } else { bytes.len() };
    match damage {
        Damage::Set(at, value) => bytes[at.index(reach)] = *value,
        Damage::Number(at, value) => {
            let at = at.index(reach);
            for (byte, new) in bytes[at..].iter_mut().zip(value.to_le_bytes()) {
                *byte = new;
            }
        }
        Damage::Cut(at) => bytes.truncate(at.index(bytes.len())),
        Damage::Remove(at, count) => {
            let at = at.index(reach);
            bytes.drain(at..(at + count).min(bytes.len()));
        }
        Damage::Repeat(at, count) => {
            let at = at.index(reach);
            let part = bytes[at..(at + count).min(bytes.len())].to_vec();
            bytes.splice(at..at, part);
        }
    }
}

/// Opens and reads; a failure must be one clear line that names the file.
fn exercise(name: &str, bytes: Vec<u8>) {
    let options = OpenOptions { max_samples: 1 << 18, cache_bytes: 1 << 20, ..OpenOptions::default() };
    if let Err(error) = dem::from_bytes(name, bytes, &options).and_then(|mut dem| dem.read_all()) {
        let message = error.to_string();
        assert!(message.len() < 1000 && !message.contains('\n'), "{message}");
        let archive = name.trim_end_matches(".gz");
        assert!(message.contains(archive), "{message}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_read_or_refused(
        seed in any::<prop::sample::Index>(),
        header in any::<bool>(),
        damages in prop::collection::vec(damage(), 1..6),
    ) {
        let (name, bytes) = &SEEDS[seed.index(SEEDS.len())];
        let mut bytes = bytes.clone();
        for damage in &damages {
            apply(damage, &mut bytes, header);
        }
        exercise(name, bytes);
    }

    #[test]
    fn noise_is_refused(name in "[a-zN0-9]{1,8}\\.(tif|asc|xml|zip|gz|dt1|png|hgt)", bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let options = OpenOptions::default();
        prop_assert!(dem::from_bytes(&name, bytes, &options).and_then(|mut dem| dem.read_all()).is_err());
    }
}

/// Every length of the small files, so that every read meets the end of the file once.
#[test]
fn files_cut_anywhere_are_refused_with_a_place() {
    for (name, bytes) in SEEDS.iter() {
        for length in (0..bytes.len()).step_by(1 + bytes.len() / 300) {
            exercise(name, bytes[..length].to_vec());
        }
    }
}

#[test]
fn srtm_of_a_wrong_length_is_refused() {
    let bytes = hgt(1201);
    for length in [0, 1, 2, 1000, bytes.len() - 1] {
        assert!(dem::from_bytes("N42E001.hgt", bytes[..length].to_vec(), &OpenOptions::default()).is_err());
    }
}
