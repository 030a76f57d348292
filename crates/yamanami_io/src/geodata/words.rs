//! The properties of a feature that a map can use, under whatever names they come.
//!
//! Names: OpenStreetMap's tags, Natural Earth's and GSHHG's columns, and what tables of Japanese summits have.

use std::borrow::Cow;

/// What a property says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Word {
    Name,
    Reading,
    Latin,
    Height,
    Rank,
    Latitude,
    Longitude,
    X,
    Y,
    /// A geometry as well-known text.
    Geometry,
    /// What it is, in a word.
    Kind,
    Gshhg,
    Natural,
    Water,
    Waterway,
    Highway,
    Railway,
    Boundary,
    Place,
    MountainPass,
}

const NAMES: &[(Word, &[&str])] = &[
    (
        Word::Name,
        &[
            "name",
            "名称",
            "名前",
            "山名",
            "地名",
            "駅名",
            "峠名",
            "山岳名",
            "名",
            "title",
            "label",
            "name:ja",
            "name_ja",
        ],
    ),
    (
        Word::Reading,
        &[
            "kana",
            "かな",
            "カナ",
            "よみ",
            "ヨミ",
            "読み",
            "よみがな",
            "読み仮名",
            "ふりがな",
            "フリガナ",
            "reading",
            "yomi",
            "name:ja-hira",
            "name:ja_kana",
            "name_kana",
            "namekana",
        ],
    ),
    (
        Word::Latin,
        &[
            "latin",
            "romaji",
            "roman",
            "ローマ字",
            "英語名",
            "english",
            "name:en",
            "name_en",
            "name:ja_rm",
            "name:ja-latn",
        ],
    ),
    (
        Word::Height,
        &[
            "elevation",
            "標高",
            "高さ",
            "ele",
            "elev",
            "height",
            "alt",
            "altitude",
            "height_m",
            "elevation_m",
            "標高値",
            "z",
        ],
    ),
    (Word::Rank, &["prominence", "プロミネンス", "population", "人口", "rank", "importance"]),
    (Word::Latitude, &["lat", "latitude", "緯度", "北緯"]),
    (Word::Longitude, &["lon", "lng", "long", "longitude", "経度", "東経"]),
    (Word::X, &["x", "easting", "east"]),
    (Word::Y, &["y", "northing", "north"]),
    (Word::Geometry, &["wkt", "geometry", "geom", "the_geom", "wkt_geom"]),
    (Word::Kind, &["kind", "type", "class", "fclass", "featurecla", "feature", "種別", "種類", "分類", "sym"]),
    (Word::Gshhg, &["gshhg"]),
    (Word::Natural, &["natural"]),
    (Word::Water, &["water"]),
    (Word::Waterway, &["waterway"]),
    (Word::Highway, &["highway"]),
    (Word::Railway, &["railway"]),
    (Word::Boundary, &["boundary", "admin_level"]),
    (Word::Place, &["place"]),
    (Word::MountainPass, &["mountain_pass"]),
];

/// What a column or key is, by its name: in any case, without a unit in brackets behind it.
pub(super) fn word_of(key: &str) -> Option<Word> {
    let bare = key.split(['(', '（', '[', '［']).next().unwrap_or_default().trim().to_lowercase();
    NAMES.iter().find(|(_, names)| names.contains(&bare.as_str())).map(|&(word, _)| word)
}

/// The usable properties of a feature.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Words(Vec<(Word, String)>);

impl Words {
    /// Notes a property; the first of two that say the same stands, and what is empty says nothing.
    pub(super) fn add(&mut self, word: Word, value: &str) {
        let value = value.trim();
        if !value.is_empty() && self.get(word).is_none() {
            self.0.push((word, value.to_owned()));
        }
    }

    pub(super) fn get(&self, word: Word) -> Option<&str> {
        self.0.iter().find(|(w, _)| *w == word).map(|(_, value)| value.as_str())
    }
}

/// A number that may have full-width digits, commas between thousands and a unit behind it.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = half_width(text);
    let text = text.trim().trim_end_matches(|c: char| c.is_alphabetic()).trim_end().replace(',', "");
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Full-width digits and signs, as Japanese keyboards give them, as plain ones.
pub(super) fn half_width(text: &str) -> Cow<'_, str> {
    if !text.contains(|c| ('\u{ff01}'..='\u{ff5e}').contains(&c)) {
        return Cow::Borrowed(text);
    }
    let half = |c: char| {
        let plain = (c as u32).checked_sub(0xfee0).and_then(char::from_u32);
        if ('\u{ff01}'..='\u{ff5e}').contains(&c) { plain.unwrap_or(c) } else { c }
    };
    Cow::Owned(text.chars().map(half).collect())
}

/// Text of a file that does not say its encoding: UTF-8 with or without its mark, UTF-16 with it, else Shift_JIS.
pub(super) fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    if let Some((encoding, _)) = encoding_rs::Encoding::for_bom(bytes) {
        return encoding.decode(bytes).0;
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => encoding_rs::SHIFT_JIS.decode(bytes).0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_columns_in_two_languages() {
        for (key, word) in [
            ("山名", Word::Name),
            ("Name", Word::Name),
            ("標高(m)", Word::Height),
            (" 緯度（10進）", Word::Latitude),
            ("LNG", Word::Longitude),
            ("name:ja-Hira", Word::Reading),
        ] {
            assert_eq!(word_of(key), Some(word), "{key}");
        }
        assert_eq!(word_of("県"), None);
    }

    #[test]
    fn numbers_as_people_write_them() {
        assert_eq!(
            [number("3,776 m"), number("３７７６"), number("-1.5e2")],
            [Some(3776.0), Some(3776.0), Some(-150.0)]
        );
        assert_eq!([number(""), number("高い"), number("NaN")], [None; 3]);
    }
}
