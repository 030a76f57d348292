//! The letters of a map: the fonts that ship with the project, one of the user's before them, what they lack, how wide
//! a text is.
//!
//! M PLUS 1p (The M+ Project Authors, 2016, SIL Open Font License 1.1) in two weights; `fonts/OFL.txt` is its licence.

use crate::MapError;
use resvg::usvg::fontdb;
use std::sync::Arc;

const REGULAR: &[u8] = include_bytes!("../fonts/MPLUS1p-Regular.ttf");
const MEDIUM: &[u8] = include_bytes!("../fonts/MPLUS1p-Medium.ttf");

/// How heavy letters are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weight {
    /// Book weight, for small type.
    #[default]
    Regular,
    /// A little heavier, for names and titles.
    Medium,
}

impl Weight {
    /// As CSS and fonts count it.
    pub fn number(self) -> u16 {
        match self {
            Self::Regular => 400,
            Self::Medium => 500,
        }
    }
}

/// The fonts a map is lettered with.
#[derive(Debug, Clone)]
pub struct Fonts {
    /// The user's, if any: the one font for every weight.
    own: Option<Arc<Vec<u8>>>,
    families: Vec<String>,
    database: Arc<fontdb::Database>,
}

impl Default for Fonts {
    /// Those that ship with the project.
    fn default() -> Self {
        let mut database = fontdb::Database::new();
        database.load_font_data(REGULAR.to_vec());
        database.load_font_data(MEDIUM.to_vec());
        Self { own: None, families: families(&database), database: Arc::new(database) }
    }
}

impl Fonts {
    /// A font file (TrueType or OpenType) before those that ship; what it lacks is taken from them.
    pub fn with(font_file: Vec<u8>) -> Result<Self, MapError> {
        let fault = |cause: &str| MapError::Font(cause.to_owned());
        ttf_parser::Face::parse(&font_file, 0).map_err(|cause| fault(&cause.to_string()))?;
        let own = Arc::new(font_file);
        let mut database = fontdb::Database::new();
        database.load_font_source(fontdb::Source::Binary(own.clone()));
        if database.is_empty() {
            return Err(fault("no face with a name in it"));
        }
        database.load_font_data(REGULAR.to_vec());
        database.load_font_data(MEDIUM.to_vec());
        Ok(Self { own: Some(own), families: families(&database), database: Arc::new(database) })
    }

    /// Names of the families, first choice first, as SVG's `font-family` takes them.
    pub(crate) fn families(&self) -> String {
        let quoted: Vec<String> = self.families.iter().map(|f| format!("'{}'", f.replace('\'', ""))).collect();
        format!("{}, sans-serif", quoted.join(", "))
    }

    pub(crate) fn database(&self) -> Arc<fontdb::Database> {
        self.database.clone()
    }

    /// Width of a text in one line, in units of its size.
    pub fn width_em(&self, text: &str, weight: Weight) -> f64 {
        let faces = self.faces(weight);
        text.chars().map(|c| faces.iter().find_map(|face| advance_em(face, c)).unwrap_or(1.0)).sum()
    }

    /// Characters of a text that no font has, each once.
    pub fn missing(&self, text: &str) -> Vec<char> {
        let faces = self.faces(Weight::Regular);
        let mut missing: Vec<char> = text
            .chars()
            .filter(|&c| !c.is_control() && !faces.iter().any(|face| face.glyph_index(c).is_some()))
            .collect();
        missing.sort_unstable();
        missing.dedup();
        missing
    }

    fn faces(&self, weight: Weight) -> Vec<ttf_parser::Face<'_>> {
        let shipped = match weight {
            Weight::Regular => REGULAR,
            Weight::Medium => MEDIUM,
        };
        let own = self.own.iter().map(|data| data.as_slice());
        own.chain([shipped]).filter_map(|data| ttf_parser::Face::parse(data, 0).ok()).collect()
    }
}

fn advance_em(face: &ttf_parser::Face<'_>, c: char) -> Option<f64> {
    let advance = face.glyph_hor_advance(face.glyph_index(c)?)?;
    Some(f64::from(advance) / f64::from(face.units_per_em().max(1)))
}

fn families(database: &fontdb::Database) -> Vec<String> {
    let mut families = Vec::new();
    for face in database.faces() {
        let name = face.families.first().map(|(name, _)| name.clone()).unwrap_or_default();
        if !name.is_empty() && !families.contains(&name) {
            families.push(name);
        }
    }
    families
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_fonts_have_the_letters_of_japanese_maps() {
        let fonts = Fonts::default();
        assert_eq!(fonts.families(), "'M PLUS 1p', sans-serif");
        assert!(fonts.missing("槍ヶ岳 穂高岳 甲斐駒ヶ岳 ニセコアンヌプリ 3776 m · 10 km ° ′ α × Ōyama").is_empty());
        assert_eq!(fonts.missing("山\u{1F5FB}山\u{1F5FB}"), ['\u{1F5FB}']);
        assert_eq!(fonts.width_em("富士山", Weight::Medium), 3.0);
        assert!((0.3..0.8).contains(&fonts.width_em("n", Weight::Regular)));
    }

    #[test]
    fn a_font_of_the_users_comes_first_and_nonsense_is_refused() {
        assert!(Fonts::with(vec![0; 100]).is_err());
        let fonts = Fonts::with(REGULAR.to_vec()).unwrap();
        assert_eq!(fonts.width_em("山", Weight::Medium), 1.0);
    }
}
