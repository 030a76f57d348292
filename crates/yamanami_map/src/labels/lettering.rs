//! What a name says: in which letters, with which numbers, and what the fonts lack.

use super::{Label, romaji};
use crate::Fonts;
use crate::scene::Run;
use crate::sheet::{GREY, INK, NameForm, SOFT_INK, SheetOptions, Style};
use yamanami_core::{NamedPlace, PlaceKind};

/// A name with characters that no font has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingGlyphs {
    /// The name as given.
    pub name: String,
    /// Those characters.
    pub characters: Vec<char>,
    /// What is written instead; none where the name is written with empty boxes.
    pub written: Option<String>,
}

/// What a name says, as letters of its sizes; from all there is to say to the name alone.
#[derive(Debug, Clone)]
pub(crate) struct Lettering {
    forms: Vec<Vec<Run>>,
    widths_px: Vec<f64>,
}

impl MissingGlyphs {
    /// What of texts that stand as they are no font has.
    pub(crate) fn of_text(fonts: &Fonts, text: &str) -> Option<Self> {
        let characters = fonts.missing(text);
        (!characters.is_empty()).then(|| Self { name: text.to_owned(), characters, written: None })
    }

    /// One line to say; none where nothing is missing.
    pub fn summary(all: &[Self]) -> Option<String> {
        let mut characters: Vec<char> = all.iter().flat_map(|m| m.characters.iter().copied()).collect();
        characters.sort_unstable();
        characters.dedup();
        let listed: Vec<String> =
            characters.iter().take(10).map(|&c| format!("{c} (U+{:04X})", u32::from(c))).collect();
        let more = if characters.len() > listed.len() { ", …" } else { "" };
        let replaced = all.iter().filter(|m| m.written.is_some()).count();
        (!all.is_empty()).then(|| {
            format!(
                "fonts lack {}{more} in {} texts, {replaced} of them written by their reading instead",
                listed.join(", "),
                all.len()
            )
        })
    }
}

impl Lettering {
    pub(super) fn of(
        style: &Style<'_>,
        options: &SheetOptions,
        place: &NamedPlace,
        label: &Label,
        is_near: bool,
        is_hidden: bool,
    ) -> (Self, Option<MissingGlyphs>) {
        let (written, lack) = written_name(style, options.names, place);
        let (name, part) = parted_name(&written);
        let is_summit = place.kind == PlaceKind::Summit;
        let mut more = part.map(|part| format!(" {part}")).unwrap_or_default();
        if options.names == NameForm::Both
            && let Some(reading) = latin_name(place).or_else(|| place.reading.clone())
            && reading != written
            && style.fonts.missing(&reading).is_empty()
        {
            more += &format!(" {}", parted_name(&reading).0);
        }
        let mut numbers = String::new();
        if options.has_numbers && (is_summit || place.kind == PlaceKind::Pass) && place.height_m.is_some() {
            numbers += &format!(" {:.0}{}", label.at.z, if is_near { "" } else { " m" });
        }
        if options.has_numbers && !is_near {
            numbers += &format!(" · {:.0} km", label.distance_m / 1000.0);
        }
        let (colour, small) = if is_hidden { (GREY, GREY) } else { (INK, SOFT_INK) };
        let name = style.run(name, if is_summit { 8.8 } else { 7.6 }, colour);
        let mut details = vec![format!("{more}{numbers}"), numbers, String::new()];
        details.dedup();
        let with = |detail: String| {
            let detail = (!detail.is_empty()).then(|| style.run(detail, 6.0, small));
            [name.clone()].into_iter().chain(detail).collect()
        };
        let forms: Vec<Vec<Run>> = details.into_iter().map(with).collect();
        let widths_px = forms.iter().map(|runs| style.width_px(runs)).collect();
        (Self { forms, widths_px }, lack)
    }

    /// How many forms there are, the longest first.
    pub(super) fn forms(&self) -> usize {
        self.forms.len()
    }

    /// Width of a form, pixels.
    pub(super) fn width_px(&self, form: usize) -> f64 {
        self.widths_px[form]
    }

    /// The letters of a form.
    pub(super) fn runs(&self, form: usize) -> &[Run] {
        &self.forms[form]
    }
}

/// A mountain and, in brackets after it, which of its summits.
pub fn parted_name(name: &str) -> (&str, Option<&str>) {
    let is_opening = |c| matches!(c, '<' | '(' | '（' | '〈' | '＜');
    match name.char_indices().find(|&(at, c)| at > 0 && is_opening(c)) {
        Some((at, c)) => {
            let part = name[at + c.len_utf8()..].trim_end_matches(['>', ')', '）', '〉', '＞']);
            (name[..at].trim_end(), (!part.is_empty()).then_some(part))
        }
        None => (name, None),
    }
}

/// The name in Latin letters, given or made from the kana.
pub fn latin_name(place: &NamedPlace) -> Option<String> {
    let given = place.latin.clone().filter(|latin| !latin.trim().is_empty());
    given.or_else(|| place.reading.as_deref().and_then(romaji::from_kana))
}

/// The name in the form asked for, in letters the fonts have where there is any such form.
fn written_name(style: &Style<'_>, form: NameForm, place: &NamedPlace) -> (String, Option<MissingGlyphs>) {
    let wanted = match form {
        NameForm::Latin => latin_name(place).unwrap_or_else(|| place.name.clone()),
        NameForm::Local | NameForm::Both => place.name.clone(),
    };
    let characters = style.fonts.missing(&wanted);
    if characters.is_empty() {
        return (wanted, None);
    }
    let others = [Some(place.name.clone()), place.reading.clone(), latin_name(place)];
    let written = others.into_iter().flatten().find(|text| !text.is_empty() && style.fonts.missing(text).is_empty());
    let said = written.clone().unwrap_or(wanted);
    (said, Some(MissingGlyphs { name: place.name.clone(), characters, written }))
}
