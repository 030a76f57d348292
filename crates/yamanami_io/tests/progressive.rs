//! Progressive files of any bytes: an error or a model, never a panic.

use glam::DVec3;
use proptest::prelude::*;
use std::path::Path;
use yamanami_core::{BaseMesh, DetailScheme, Predictor, SemiRegular};
use yamanami_io::IoError;
use yamanami_io::progressive::{ProgressiveLimits, ProgressiveMeta, ProgressiveModel, decode, encode, renumber};

fn meta() -> ProgressiveMeta {
    let scheme = DetailScheme {
        predictor: Predictor::Butterfly,
        update: 0.0,
        origin_m: DVec3::new(1.0, 2.0, 3.0),
        base_step_m: 0.01,
        step_m: 0.02,
        level_ratio: 2.0,
        tangent_ratio: 4.0,
    };
    let (title, source) = ("t".into(), "s".into());
    ProgressiveMeta { title, source, scheme, half_size_m: [1.0, 2.0, 3.0], max_error_m: 0.5 }
}

fn mesh(levels: u32) -> SemiRegular {
    let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5]];
    renumber(&SemiRegular::new(BaseMesh::new(6, faces).unwrap(), levels).unwrap()).mesh
}

/// Integers that are smaller on finer levels, and mostly zero.
fn coefficients(mesh: &SemiRegular, seed: u32) -> Vec<[i32; 3]> {
    let mut state = seed;
    (0..mesh.vertex_count(mesh.levels()))
        .map(|v| {
            std::array::from_fn(|c| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let most = 3000 >> (2 * mesh.level_of(v)) >> (2 * c);
                if state >> 28 < 9 { 0 } else { (state >> 8) as i32 % (most + 1) - most / 2 }
            })
        })
        .collect()
}

fn read(bytes: &[u8]) -> Result<ProgressiveModel, IoError> {
    decode(Path::new("m.yamap"), bytes, ProgressiveLimits { vertices: 1 << 16 })
}

fn whole() -> (Vec<[i32; 3]>, Vec<u8>) {
    let mesh = mesh(4);
    let coefficients = coefficients(&mesh, 7);
    let bytes = encode(&mesh, &coefficients, &meta()).unwrap();
    (coefficients, bytes)
}

/// Puts the right checksum behind a head.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let length = usize::from(bytes[8] & 0x7F) | usize::from(bytes[9]) << 7;
    let crc = crc32fast::hash(&bytes[10..10 + length]);
    bytes[10 + length..14 + length].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[test]
fn integers_come_back() {
    for levels in 0..5 {
        let mesh = mesh(levels);
        let told = coefficients(&mesh, levels);
        let bytes = encode(&mesh, &told, &meta()).unwrap();
        let read = read(&bytes).unwrap();
        assert_eq!(read.mesh, mesh);
        assert_eq!(read.meta, meta());
        let back: Vec<[i32; 3]> = read.coefficients.iter().map(|c| c.map(|x| x as i32)).collect();
        assert_eq!(back, told);
    }
}

#[test]
fn all_zero_and_huge_integers_come_back() {
    let mesh = mesh(2);
    for value in [0, 1, (1 << 28) - 1, -(1 << 28) + 1] {
        let told = vec![[value; 3]; mesh.vertex_count(2) as usize];
        let back = read(&encode(&mesh, &told, &meta()).unwrap()).unwrap();
        assert!(back.coefficients.as_flattened().iter().all(|&x| x == f64::from(value)));
    }
    let told = vec![[1 << 28; 3]; mesh.vertex_count(2) as usize];
    assert!(encode(&mesh, &told, &meta()).unwrap_err().to_string().contains("28 bits"));
    assert!(encode(&mesh, &told[1..], &meta()).unwrap_err().to_string().contains("each vertex"));
}

#[test]
fn a_cut_head_is_an_error_and_a_cut_rest_is_not() {
    let (_, bytes) = whole();
    let first = (0..bytes.len()).find(|&n| read(&bytes[..n]).is_ok()).unwrap();
    assert!(first < 250, "{first}");
    for n in 0..first {
        let message = read(&bytes[..n]).unwrap_err().to_string();
        assert!(message.starts_with("m.yamap: byte ") && !message.contains('\n'), "{message}");
    }
    let mut planes = 0;
    for n in first..=bytes.len() {
        let report = read(&bytes[..n]).unwrap().report;
        assert_eq!((report.bytes, report.bytes_of), (n as u64, bytes.len() as u64));
        assert!(report.planes >= planes);
        planes = report.planes;
    }
    assert_eq!(planes, read(&bytes).unwrap().report.planes_of);
    assert!(read(&[bytes.as_slice(), b"more"].concat()).is_ok(), "what comes after the file is not looked at");
}

#[test]
fn models_beyond_the_limit_are_refused() {
    let (_, bytes) = whole();
    let few = ProgressiveLimits { vertices: 100 };
    assert!(matches!(decode(Path::new("m"), &bytes, few), Err(IoError::TooLarge { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn flipped_bits_are_found_or_harmless(at in any::<prop::sample::Index>(), bit in 0u32..8, keep in any::<prop::sample::Index>()) {
        let (_, mut bytes) = whole();
        let at = at.index(bytes.len());
        bytes[at] ^= 1u8 << bit;
        prop_assert!(read(&bytes).is_err());
        // without the end nobody can tell; what comes out is some model
        bytes.truncate(keep.index(bytes.len()));
        if let Ok(model) = read(&bytes) {
            prop_assert!(model.coefficients.as_flattened().iter().all(|x| x.is_finite()));
        }
    }

    #[test]
    fn heads_of_any_content_do_no_harm(changes in proptest::collection::vec((10usize..140, any::<u8>()), 1..4), cut in any::<bool>()) {
        let (_, mut bytes) = whole();
        for (at, value) in changes {
            bytes[at] = value;
        }
        let mut bytes = sealed(bytes);
        if cut {
            bytes.pop();
        }
        if let Ok(model) = read(&bytes) {
            prop_assert_eq!(model.coefficients.len(), model.mesh.vertex_count(model.mesh.levels()) as usize);
        }
    }

    #[test]
    fn any_bytes_do_no_harm(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(read(&bytes).is_err());
        let _ = read(&[b"YAMAPRG1".as_slice(), &bytes].concat());
    }
}
