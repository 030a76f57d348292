//! Layers by name: which of them holds hidden faces, and how strictly the lines on one hold.

use std::collections::HashMap;
use yamanami_core::BreaklineKind;

/// Shown faces.
pub(super) const FACES: &str = "TIN";
/// Hidden faces.
pub(super) const HIDDEN: &str = "TIN_HIDDEN";
/// Lines, by kind.
pub(super) const LINES: [(BreaklineKind, &str); 3] = [
    (BreaklineKind::Hard, "BREAKLINE_HARD"),
    (BreaklineKind::Soft, "BREAKLINE_SOFT"),
    (BreaklineKind::Boundary, "BREAKLINE_BOUNDARY"),
];

/// A layer.
#[derive(Debug)]
pub(super) struct Layer {
    pub(super) name: String,
    pub(super) hidden: bool,
    pub(super) kind: BreaklineKind,
    /// Triangles on it.
    pub(super) faces: u64,
}

impl Layer {
    fn new(name: String) -> Self {
        let lower = name.to_lowercase();
        let has = |words: &[&str]| words.iter().any(|word| lower.contains(word));
        let kind = match () {
            () if has(&["bound", "border", "外周", "境界"]) => BreaklineKind::Boundary,
            () if has(&["soft"]) => BreaklineKind::Soft,
            () => BreaklineKind::Hard,
        };
        Self { hidden: has(&["hidden", "invisible", "非表示"]), name, kind, faces: 0 }
    }

    /// The name of a line on this layer that has none of its own: the layer's, unless that says only the kind.
    pub(super) fn line_name(&self) -> &str {
        if LINES.iter().any(|(_, layer)| *layer == self.name) { "" } else { &self.name }
    }
}

/// The layers met so far, numbered. An entity that names none is on the first.
#[derive(Debug)]
pub(super) struct Layers {
    all: Vec<Layer>,
    number_of: HashMap<Vec<u8>, usize>,
    last: (Vec<u8>, usize),
}

impl Default for Layers {
    fn default() -> Self {
        let name = b"0".to_vec();
        Self { all: vec![Layer::new("0".into())], number_of: HashMap::from([(name.clone(), 0)]), last: (name, 0) }
    }
}

impl Layers {
    /// The number of the layer whose name has these bytes.
    pub(super) fn number(&mut self, name: &[u8], decode: impl FnOnce(&[u8]) -> String) -> usize {
        if self.last.0 == name {
            return self.last.1;
        }
        let number = *self.number_of.entry(name.to_vec()).or_insert_with(|| {
            self.all.push(Layer::new(decode(name)));
            self.all.len() - 1
        });
        self.last = (name.to_vec(), number);
        number
    }

    /// A layer by its number.
    pub(super) fn get(&mut self, number: usize) -> &mut Layer {
        &mut self.all[number]
    }

    /// Those with faces.
    pub(super) fn with_faces(&self) -> impl Iterator<Item = &Layer> {
        self.all.iter().filter(|layer| layer.faces > 0)
    }
}
