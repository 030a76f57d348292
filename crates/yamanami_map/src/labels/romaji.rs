//! Kana into Latin letters, by Hepburn's way as on Japanese road signs and maps: long vowels are not marked.

/// Sounds of two kana come before those of one.
const SOUNDS: &str = "\
    きゃ kya きゅ kyu きょ kyo しゃ sha しゅ shu しょ sho ちゃ cha ちゅ chu ちょ cho にゃ nya にゅ nyu にょ nyo ひゃ hya \
    ひゅ hyu ひょ hyo みゃ mya みゅ myu みょ myo りゃ rya りゅ ryu りょ ryo ぎゃ gya ぎゅ gyu ぎょ gyo じゃ ja じゅ ju じょ jo \
    びゃ bya びゅ byu びょ byo ぴゃ pya ぴゅ pyu ぴょ pyo とぅ tu てぃ ti でぃ di ふぁ fa ふぃ fi ふぇ fe ふぉ fo しぇ she \
    ちぇ che じぇ je うぇ we うぃ wi あ a い i う u え e お o か ka き ki く ku け ke こ ko さ sa し shi す su せ se そ so \
    た ta ち chi つ tsu て te と to な na に ni ぬ nu ね ne の no は ha ひ hi ふ fu へ he ほ ho ま ma み mi む mu \
    め me も mo や ya ゆ yu よ yo ら ra り ri る ru れ re ろ ro わ wa ゐ i ゑ e を o ん n が ga ぎ gi ぐ gu げ ge ご go \
    ざ za じ ji ず zu ぜ ze ぞ zo だ da ぢ ji づ zu で de ど do ば ba び bi ぶ bu べ be ぼ bo ぱ pa ぴ pi ぷ pu ぺ pe \
    ぽ po ゔ vu ぁ a ぃ i ぅ u ぇ e ぉ o ゃ ya ゅ yu ょ yo";

/// Words that end names of mountains, set off by a hyphen.
const ENDINGS: &[&str] = &["dake", "take", "yama", "san", "zan", "mine", "toge"];

/// A reading in kana, capitalised; none where anything else than kana and brackets is in it.
pub(super) fn from_kana(kana: &str) -> Option<String> {
    let words: Vec<&str> = SOUNDS.split_whitespace().collect();
    let sounds: Vec<(&str, &str)> = words.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
    let hiragana: String = kana.trim().chars().map(to_hiragana).collect();
    let (mut rest, mut out, mut is_doubled) = (hiragana.as_str(), String::new(), false);
    while let Some(c) = rest.chars().next() {
        if let Some((sound, letters)) = sounds.iter().find(|(sound, _)| rest.starts_with(sound)) {
            if is_doubled {
                // sh, ch: the doubled sound is t before ch
                out.push(if letters.starts_with("ch") { 't' } else { letters.chars().next()? });
                is_doubled = false;
            }
            out += letters;
            rest = &rest[sound.len()..];
            continue;
        }
        match c {
            'っ' => is_doubled = true,
            'ー' => {}
            ' ' | '\u{3000}' | '・' => out.push(' '),
            '<' | '(' | '（' | '〈' => out += " (",
            '>' | ')' | '）' | '〉' => out.push(')'),
            _ => return None,
        }
        rest = &rest[c.len_utf8()..];
    }
    let words: Vec<String> = out.split(' ').filter(|w| !w.is_empty()).map(dressed).collect();
    (!words.is_empty()).then(|| words.join(" "))
}

/// Long vowels shortened, the ending set off, a capital at the front.
fn dressed(word: &str) -> String {
    let mut short = word.replace("ou", "o").replace("oo", "o").replace("uu", "u");
    let (letters, closing) = match short.strip_suffix(')') {
        Some(letters) => (letters.to_owned(), ")"),
        None => (std::mem::take(&mut short), ""),
    };
    let ending = ENDINGS.iter().find(|e| letters.ends_with(*e) && letters.trim_start_matches('(').len() > e.len() + 1);
    let parted = match ending {
        Some(ending) => format!("{}-{ending}", &letters[..letters.len() - ending.len()]),
        None => letters,
    };
    let at = usize::from(parted.starts_with('('));
    let (front, back) = parted.split_at(at);
    let mut back = back.chars();
    let capital: String = back.next().map(|c| c.to_uppercase().collect()).unwrap_or_default();
    format!("{front}{capital}{}{closing}", back.as_str())
}

fn to_hiragana(c: char) -> char {
    match c {
        'ァ'..='ヴ' => char::from_u32(c as u32 - 0x60).unwrap_or(c),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_are_those_of_maps() {
        let written = |kana| from_kana(kana).unwrap();
        assert_eq!(written("ふじさん"), "Fuji-san");
        assert_eq!(written("やつがたけ"), "Yatsuga-take");
        assert_eq!(written("おおきっちょうやま"), "Okitcho-yama");
        assert_eq!(written("ニセコアンヌプリ"), "Nisekoannupuri");
        assert_eq!(written("めあかんだけ<あかんふじ>"), "Meakan-dake (Akanfuji)");
        assert_eq!(written("れっぷ"), "Reppu");
        assert_eq!(from_kana("富士"), None);
        assert_eq!(from_kana(""), None);
    }
}
