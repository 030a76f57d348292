//! What a name says: in which letters, with which numbers, and what the fonts lack.

use super::{Label, romaji};
use crate::Weight;
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

/// What a name says, as letters of its sizes.
#[derive(Debug, Clone)]
pub(crate) struct Lettering {
    /// The name.
    pub(crate) name: Vec<Run>,
    /// Reading, height and distance, small; may be left out.
    pub(crate) detail: Vec<Run>,
    /// Widths of the name alone and of both, pixels.
    widths_px: [f64; 2],
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
        let (name, lack) = written_name(style, options.names, place);
        let is_summit = place.kind == PlaceKind::Summit;
        let colour = if is_hidden { GREY } else { INK };
        let small = if is_hidden { GREY } else { SOFT_INK };
        let size = if is_summit { 8.8 } else { 7.6 };
        let mut detail = String::new();
        if options.names == NameForm::Both
            && let Some(reading) = latin(place).or_else(|| place.reading.clone())
            && reading != name
            && style.fonts.missing(&reading).is_empty()
        {
            detail += &format!(" {reading}");
        }
        if options.has_numbers && (is_summit || place.kind == PlaceKind::Pass) && place.height_m.is_some() {
            detail += &format!(" {:.0}", label.at.z);
            if !is_near {
                detail += " m";
            }
        }
        if options.has_numbers && !is_near {
            detail += &format!(" · {:.0} km", label.distance_m / 1000.0);
        }
        let runs = |text: String, points, weight, colour| match text.is_empty() {
            true => Vec::new(),
            false => vec![style.run(text, points, weight, colour)],
        };
        let (name, detail) = (runs(name, size, Weight::Medium, colour), runs(detail, 6.3, Weight::Regular, small));
        let name_px = style.width_px(&name);
        let widths_px = [name_px, name_px + style.width_px(&detail)];
        (Self { name, detail, widths_px }, lack)
    }

    /// Width of both, or of the name alone, pixels.
    pub(super) fn width_px(&self, has_detail: bool) -> f64 {
        self.widths_px[usize::from(has_detail)]
    }

    /// Both, or the name alone.
    pub(super) fn runs(&self, has_detail: bool) -> Vec<Run> {
        let detail: &[Run] = if has_detail { &self.detail } else { &[] };
        self.name.iter().chain(detail).cloned().collect()
    }
}

/// The name in Latin letters, given or made from the kana.
fn latin(place: &NamedPlace) -> Option<String> {
    let given = place.latin.clone().filter(|latin| !latin.trim().is_empty());
    given.or_else(|| place.reading.as_deref().and_then(romaji::from_kana))
}

/// The name in the form asked for, in letters the fonts have where there is any such form.
fn written_name(style: &Style<'_>, form: NameForm, place: &NamedPlace) -> (String, Option<MissingGlyphs>) {
    let wanted = match form {
        NameForm::Latin => latin(place).unwrap_or_else(|| place.name.clone()),
        NameForm::Local | NameForm::Both => place.name.clone(),
    };
    let characters = style.fonts.missing(&wanted);
    if characters.is_empty() {
        return (wanted, None);
    }
    let others = [Some(place.name.clone()), place.reading.clone(), latin(place)];
    let written = others.into_iter().flatten().find(|text| !text.is_empty() && style.fonts.missing(text).is_empty());
    let said = written.clone().unwrap_or(wanted);
    (said, Some(MissingGlyphs { name: place.name.clone(), characters, written }))
}
