//! A progressive model from any bytes: an error or a model of the size that its head says, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::Path;
use yamanami_io::progressive::{ProgressiveLimits, decode, encode};

fuzz_target!(|bytes: &[u8]| {
    let Ok(model) = decode(Path::new("a.yamap"), bytes, ProgressiveLimits { vertices: 1 << 14 }) else { return };
    assert_eq!(model.coefficients.len(), model.mesh.vertex_count(model.mesh.levels()) as usize);
    assert!(model.coefficients.as_flattened().iter().all(|x| x.is_finite()));
    // what was read can be written, and says the same
    let whole: Vec<[i32; 3]> = model.coefficients.iter().map(|c| c.map(|x| x as i32)).collect();
    let again = encode(&model.mesh, &whole, &model.meta).expect("a model that was read can be written");
    let back = decode(Path::new("a.yamap"), &again, ProgressiveLimits { vertices: 1 << 14 }).expect("and read again");
    let same = std::iter::zip(back.coefficients.as_flattened(), whole.as_flattened()).all(|(&a, &b)| a == f64::from(b));
    assert!(same && back.mesh == model.mesh);
});
