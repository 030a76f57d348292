//! What a place or a line is, from the words about it.

use super::words::{Word, Words};
use yamanami_core::{LineKind, PlaceKind};

/// Words of which one in a kind's, table's or file's name tells what lines it holds; those that hold others come later.
const LINE_WORDS: &[(LineKind, &[&str])] = &[
    (LineKind::Coast, &["coast", "shoreline", "海岸"]),
    (LineKind::Railway, &["rail", "鉄道", "tram", "subway"]),
    (LineKind::River, &["river", "stream", "canal", "waterway", "河川", "水路"]),
    (LineKind::Lake, &["lake", "pond", "reservoir", "湖", "water"]),
    (
        LineKind::Road,
        &[
            "road",
            "highway",
            "street",
            "道路",
            "motorway",
            "trunk",
            "primary",
            "secondary",
            "tertiary",
        ],
    ),
    (LineKind::Track, &["track", "trail", "gpx", "登山道"]),
    (LineKind::Border, &["border", "boundar", "admin", "境界", "行政"]),
];

fn line_kind_in(text: &str) -> Option<LineKind> {
    let text = text.to_lowercase();
    LINE_WORDS.iter().find(|(_, words)| words.iter().any(|word| text.contains(word))).map(|&(kind, _)| kind)
}

/// What a line is; `container` is the name of its table or file.
pub(super) fn of_line(words: &Words, container: &str) -> LineKind {
    // shores and rivers of GSHHG and WDBII: shores of level 2 and more are those of lakes, of islands in them, and so on
    if let Some(source) = words.get(Word::Gshhg) {
        let level = source.rsplit("Level").next().and_then(|level| level.trim().parse().ok()).unwrap_or(1);
        match (source.starts_with("River"), source.starts_with("Border"), level) {
            (true, ..) => return LineKind::River,
            (_, true, _) => return LineKind::Border,
            (_, _, 2..=4) => return LineKind::Lake,
            _ => {}
        }
    }
    if let Some(kind) = words.get(Word::Kind).and_then(line_kind_in) {
        return kind;
    }
    let is = |word: Word, value: &str| words.get(word) == Some(value);
    let has = |word: Word| words.get(word).is_some_and(|value| value != "no");
    match () {
        () if is(Word::Natural, "coastline") => LineKind::Coast,
        () if has(Word::Waterway) || is(Word::Water, "river") || is(Word::Water, "canal") => LineKind::River,
        () if is(Word::Natural, "water") || has(Word::Water) => LineKind::Lake,
        () if has(Word::Railway) => LineKind::Railway,
        () if has(Word::Highway) => LineKind::Road,
        () if has(Word::Boundary) => LineKind::Border,
        () => line_kind_in(container).unwrap_or_default(),
    }
}

/// Words of which one in a kind's name tells what a place is.
const PLACE_WORDS: &[(PlaceKind, &[&str])] = &[
    (PlaceKind::Pass, &["pass", "saddle", "峠"]),
    (PlaceKind::Summit, &["summit", "peak", "mountain", "volcano", "山"]),
    (
        PlaceKind::Settlement,
        &["settlement", "city", "town", "village", "hamlet", "suburb", "populated", "市", "町", "村"],
    ),
];

/// What a named place is. With a height it is a summit unless something says otherwise.
pub(super) fn of_place(words: &Words, name: &str) -> PlaceKind {
    let kind_in = |text: &str| {
        let text = text.to_lowercase();
        PLACE_WORDS.iter().find(|(_, words)| words.iter().any(|word| text.contains(word))).map(|&(kind, _)| kind)
    };
    if words.get(Word::MountainPass).is_some_and(|value| value != "no") {
        return PlaceKind::Pass;
    }
    let told = words.get(Word::Natural).or_else(|| words.get(Word::Kind)).or_else(|| words.get(Word::Place));
    match told {
        Some(told) => kind_in(told).unwrap_or(PlaceKind::Other),
        None if name.ends_with('峠') || name.ends_with(" Pass") => PlaceKind::Pass,
        None if words.get(Word::Height).is_some() => PlaceKind::Summit,
        None => PlaceKind::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(pairs: &[(Word, &str)]) -> Words {
        let mut words = Words::default();
        pairs.iter().for_each(|(word, value)| words.add(*word, value));
        words
    }

    #[test]
    fn lines_tell_what_they_are() {
        for (pairs, kind) in [
            (&[(Word::Kind, "coast"), (Word::Gshhg, "Shore Bin # 1, Level 1")][..], LineKind::Coast),
            (&[(Word::Kind, "coast"), (Word::Gshhg, "Shore Bin # 1, Level 2")], LineKind::Lake),
            (&[(Word::Gshhg, "River Bin # 19579, Level 3")], LineKind::River),
            (&[(Word::Kind, "Railroad")], LineKind::Railway),
            (&[(Word::Natural, "coastline")], LineKind::Coast),
            (&[(Word::Natural, "water"), (Word::Water, "lake")], LineKind::Lake),
            (&[(Word::Waterway, "stream")], LineKind::River),
            (&[(Word::Highway, "track")], LineKind::Road),
            (&[(Word::Boundary, "2")], LineKind::Border),
            (&[], LineKind::Other),
        ] {
            assert_eq!(of_line(&words(pairs), "a"), kind, "{pairs:?}");
        }
        assert_eq!(of_line(&words(&[]), "ne_10m_lakes"), LineKind::Lake);
    }

    #[test]
    fn places_tell_what_they_are() {
        assert_eq!(of_place(&words(&[(Word::Height, "1500")]), "大菩薩嶺"), PlaceKind::Summit);
        assert_eq!(of_place(&words(&[(Word::Height, "1500")]), "大菩薩峠"), PlaceKind::Pass);
        assert_eq!(of_place(&words(&[(Word::Place, "town")]), "甲府"), PlaceKind::Settlement);
        assert_eq!(of_place(&words(&[(Word::Natural, "peak"), (Word::Place, "town")]), "a"), PlaceKind::Summit);
        assert_eq!(of_place(&words(&[]), "駅"), PlaceKind::Other);
    }
}
