//! The pages for people: the list of surfaces, a page where the viewer would be, and faults. Japanese or English, as the
//! browser asks; nothing is loaded from elsewhere.

use crate::fault::Fault;
use crate::picture::SIZE_PX;
use crate::surface::{Served, Surfaces};
use crate::viewer::MISSING;
use std::fmt::Write;
use yamanami::io::pack::layout::PackKind;

/// Languages of the pages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Language {
    English,
    Japanese,
}

impl Language {
    /// The one that an `Accept-Language` header wants more.
    pub(crate) fn of(header: &str) -> Self {
        let weight = |language: &str| {
            let of = |item: &str| {
                let mut parts = item.split(';').map(str::trim);
                let is_named = parts.next()?.split('-').next()?.eq_ignore_ascii_case(language);
                let q = parts.find_map(|p| p.strip_prefix("q=")).map_or(Some(1.0), |q| q.parse().ok());
                q.filter(|_| is_named)
            };
            header.split(',').filter_map(of).fold(0.0, f64::max)
        };
        if weight("ja") > weight("en") { Self::Japanese } else { Self::English }
    }

    fn code(self) -> &'static str {
        self.pick("en", "ja")
    }

    fn pick(self, english: &'static str, japanese: &'static str) -> &'static str {
        match self {
            Self::English => english,
            Self::Japanese => japanese,
        }
    }
}

const STYLE: &str = include_str!("page.css");

fn page(language: Language, title: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>{}</title>\
         <link rel=\"icon\" href=\"data:,\"><style>{STYLE}</style></head><body>\n{body}</body></html>\n",
        language.code(),
        escape(title)
    )
}

/// The list of surfaces.
pub(crate) fn list(surfaces: &Surfaces, language: Language) -> String {
    let mut body = format!(
        "<header><h1>yamanami <small>山並み</small></h1><p>{}</p></header>\n<main>\n",
        language.pick("Surfaces served from this computer", "このコンピューターで配信中の地形・モデル")
    );
    for served in &surfaces.all {
        card(&mut body, served, language);
    }
    if surfaces.all.is_empty() {
        body.push_str("<p>–</p>");
    }
    body.push_str("</main>\n");
    page(language, "yamanami", &body)
}

fn card(body: &mut String, served: &Served, language: Language) {
    let name = &served.name;
    let title = escape(&served.title);
    let [width, height] = SIZE_PX;
    let kind = match served.kind {
        PackKind::Terrain => language.pick("Terrain", "地形"),
        PackKind::Model => language.pick("Model", "モデル"),
        PackKind::Tin => "TIN",
    };
    let mut links = format!(
        "<a href=\"/s/{name}/info.json\">{}</a><a href=\"/s/{name}/surface.pack\" download=\"{name}.pack\">{}</a>",
        language.pick("Facts", "情報"),
        language.pick("Data", "データ"),
    );
    if let Some(tilejson) = served.info["tilejson"].as_str() {
        // writing into a text cannot fail
        let _ = write!(links, "<a href=\"{tilejson}\">TileJSON</a>");
    }
    let _ = writeln!(
        body,
        "<article><a class=\"picture\" href=\"/view/#s={name}\"><img src=\"/s/{name}/picture.png\" width=\"{width}\" \
         height=\"{height}\" loading=\"lazy\" alt=\"{}\"></a><h2><a href=\"/view/#s={name}\">{title}</a></h2>\
         <p>{kind} · {}</p><nav>{links}</nav></article>",
        match language {
            Language::English => format!("Picture of {title}"),
            Language::Japanese => format!("{title}の画像"),
        },
        facts(served, language),
    );
}

/// Size and place in a line.
fn facts(served: &Served, language: Language) -> String {
    let fact = |key: &str| &served.info["facts"][key];
    let whole = |key: &str| fact(key).as_u64().map_or_else(|| "?".to_owned(), grouped);
    let mut facts = match served.kind {
        PackKind::Terrain => {
            let height = |key: &str| fact(key).as_f64().map_or_else(|| "?".to_owned(), |m| format!("{m:.0}"));
            format!(
                "{} × {} {} · {}–{} m",
                whole("columns"),
                whole("rows"),
                language.pick("samples", "点"),
                height("height_min_m"),
                height("height_max_m")
            )
        }
        _ => format!("{} {}", whole("source_faces"), language.pick("triangles", "三角形")),
    };
    if let Some(crs) = fact("crs_name").as_str().filter(|name| !name.is_empty()) {
        let _ = write!(facts, " · {}", escape(crs));
    }
    let _ = write!(facts, " · {}", bytes(served.source.bytes()));
    facts
}

/// What is at `/view/` without a viewer.
pub(crate) fn no_viewer(language: Language) -> String {
    let body = format!(
        "<main class=\"plain\"><h1>{}</h1><p lang=\"en\">{}</p><p><a href=\"/\">{}</a></p></main>\n",
        language.pick("There is no viewer here yet", "ビューアーが組み込まれていません"),
        escape(MISSING),
        language.pick("Back to the surfaces", "一覧へ戻る"),
    );
    page(language, "yamanami", &body)
}

/// A fault for people.
pub(crate) fn fault(fault: &Fault) -> String {
    let body = format!(
        "<main class=\"plain\"><h1>{}</h1><p>{}</p><p><a href=\"/\">yamanami</a></p></main>\n",
        fault.status.as_u16(),
        escape(&fault.line)
    );
    page(Language::English, fault.status.as_str(), &body)
}

fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            c if c.is_control() => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let first = (digits.len() - 1) % 3 + 1;
    let (head, rest) = digits.split_at(first);
    let groups = rest.as_bytes().chunks(3).map(|group| format!(",{}", String::from_utf8_lossy(group)));
    head.to_owned() + &groups.collect::<String>()
}

fn bytes(n: u64) -> String {
    match n {
        0..1_000 => format!("{n} B"),
        1_000..1_000_000 => format!("{:.0} kB", n as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", n as f64 / 1e6),
        _ => format!("{:.2} GB", n as f64 / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_browser_s_language_is_spoken() {
        assert_eq!(Language::of("ja,en-US;q=0.9,en;q=0.8"), Language::Japanese);
        assert_eq!(Language::of("en-GB,en;q=0.9,ja;q=0.8"), Language::English);
        assert_eq!(Language::of("fr"), Language::English);
        assert_eq!(Language::of("ja-JP;q=x"), Language::English);
    }

    #[test]
    fn texts_cannot_be_markup() {
        assert_eq!(escape("<b a=\"1\">&\n"), "&lt;b a=&quot;1&quot;&gt;&amp; ");
        assert_eq!([grouped(0), grouped(999), grouped(1000), grouped(1234567)], ["0", "999", "1,000", "1,234,567"]);
    }
}
