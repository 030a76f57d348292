//! The letters of a map: the fonts that ship with the project, one of the user's before them, what they lack, how wide
//! a text is.
//!
//! Zen Kaku Gothic New, Medium (The Zen Kaku Gothic Project Authors, 2022): open forms that stay legible when small, and
//! every kanji of the Japanese standard (JIS X 0208). M PLUS 1p, Medium (The M+ Project Authors, 2016) for the rest of
//! Latin, Greek and Cyrillic. Both under the SIL Open Font License 1.1, see `fonts/`. Names and small type are told
//! apart by size and colour, so one weight is enough.

use crate::MapError;
use resvg::usvg::fontdb;
use std::sync::Arc;

/// First choice first.
const SHIPPED: [&[u8]; 2] = [
    include_bytes!("../fonts/ZenKakuGothicNew-Medium.ttf"),
    include_bytes!("../fonts/MPLUS1p-Medium.ttf"),
];

/// The fonts a map is lettered with.
#[derive(Debug, Clone)]
pub struct Fonts {
    /// The user's, if any.
    own: Option<Arc<Vec<u8>>>,
    families: Vec<String>,
    database: Arc<fontdb::Database>,
}

impl Default for Fonts {
    /// Those that ship with the project.
    fn default() -> Self {
        let mut database = fontdb::Database::new();
        SHIPPED.iter().for_each(|font| database.load_font_data(font.to_vec()));
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
        SHIPPED.iter().for_each(|font| database.load_font_data(font.to_vec()));
        Ok(Self { own: Some(own), families: families(&database), database: Arc::new(database) })
    }

    /// The font files, first choice first, for programs that letter windows.
    pub fn files(&self) -> Vec<Arc<[u8]>> {
        let own = self.own.iter().map(|data| data.as_slice());
        own.chain(SHIPPED).map(Arc::from).collect()
    }

    /// Names of the families, first choice first, as SVG's `font-family` takes them.
    pub(crate) fn families(&self) -> String {
        let quoted: Vec<String> = self.families.iter().map(|f| format!("'{}'", f.replace('\'', ""))).collect();
        format!("{}, sans-serif", quoted.join(", "))
    }

    pub(crate) fn database(&self) -> Arc<fontdb::Database> {
        self.database.clone()
    }

    /// Widths of texts set one after the other in one line, each in units of its own size.
    pub(crate) fn widths_em<'t>(&self, texts: impl Iterator<Item = &'t str> + Clone) -> Vec<f64> {
        let faces = self.faces();
        let has = |face: &ttf_parser::Face<'_>, text: &str| text.chars().all(|c| face.glyph_index(c).is_some());
        // a font that has all of a line sets all of it; only where none does are several mixed
        let whole = faces.iter().position(|face| texts.clone().all(|text| has(face, text)));
        let used = whole.map_or(&faces[..], |i| &faces[i..=i]);
        let width_em = |c| used.iter().find_map(|face| advance_em(face, c)).unwrap_or(1.0);
        texts.map(|text| text.chars().map(width_em).sum()).collect()
    }

    /// Characters of a text that no font has, each once.
    pub fn missing(&self, text: &str) -> Vec<char> {
        let faces = self.faces();
        let mut missing: Vec<char> = text
            .chars()
            .filter(|&c| !c.is_control() && !faces.iter().any(|face| face.glyph_index(c).is_some()))
            .collect();
        missing.sort_unstable();
        missing.dedup();
        missing
    }

    fn faces(&self) -> Vec<ttf_parser::Face<'_>> {
        let own = self.own.iter().map(|data| data.as_slice());
        own.chain(SHIPPED).filter_map(|data| ttf_parser::Face::parse(data, 0).ok()).collect()
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
        assert_eq!(fonts.families(), "'Zen Kaku Gothic New', 'M PLUS 1p', sans-serif");
        assert_eq!(
            fonts.missing("槍ヶ岳 穂高岳 笊ヶ岳 将棊頭山 ニセコアンヌプリ 3776 m · 10 km 30° 21′ 38″ α ×1.5 Ōyama é ü"),
            []
        );
        assert_eq!(fonts.missing("山\u{1F5FB}山\u{1F5FB}"), ['\u{1F5FB}']);
        assert_eq!(fonts.widths_em(["富士山", "岳"].into_iter()), [3.0, 1.0]);
        let [plain, mixed] = ["n", "nō"].map(|text| fonts.widths_em(["n", text].into_iter())[0]);
        assert!((0.3..0.8).contains(&plain) && mixed != plain, "one font for all of a line");
    }

    #[test]
    fn a_font_of_the_users_comes_first_and_nonsense_is_refused() {
        assert!(Fonts::with(vec![0; 100]).is_err());
        let fonts = Fonts::with(SHIPPED[0].to_vec()).unwrap();
        assert_eq!(fonts.widths_em(["山"].into_iter()), [1.0]);
    }
}
