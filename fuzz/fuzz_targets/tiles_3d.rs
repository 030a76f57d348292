//! Tilesets and subtrees of 3D Tiles from any bytes; the first chooses how a subtree is divided.
#![no_main]

use std::path::Path;
use yamanami_io::tiles::subtree::Subtree;
use yamanami_io::tiles::tileset::{Subdivision, Tileset};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let [kind, data @ ..] = bytes else { return };
    // either what can be written again, or an error: never a panic
    if let Ok(tileset) = Tileset::read(Path::new("fuzz"), data) {
        assert!(Tileset::read(Path::new("fuzz"), &tileset.to_json()).is_ok());
    }
    let subdivision = if kind & 1 == 0 { Subdivision::Quadtree } else { Subdivision::Octree };
    let levels = u32::from(kind >> 1) % 6;
    if let Ok(subtree) = Subtree::decode(Path::new("fuzz"), data, subdivision, levels) {
        let again = Subtree::decode(Path::new("fuzz"), &subtree.encode(), subdivision, levels);
        // what is not a number is not equal to itself
        assert!(again.is_ok_and(|a| a.tiles == subtree.tiles && a.facts.len() == subtree.facts.len()));
    }
});
