//! A page of text, tables and pictures, written as Markdown and as HTML.

use crate::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A page being written.
#[derive(Debug, Clone, Default)]
pub(crate) struct Page {
    blocks: Vec<Block>,
}

#[derive(Debug, Clone)]
enum Block {
    Heading(usize, String),
    Text(String),
    Table(Vec<String>, Vec<Vec<String>>),
    /// File beside the page, and what it shows.
    Picture(String, String),
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:1250px;margin:2em auto;padding:0 1em;color:#222}\
img{max-width:100%}table{border-collapse:collapse;margin:1em 0;font-size:14px}\
td,th{border:1px solid #ccc;padding:.25em .6em;text-align:right}td:first-child,th:first-child{text-align:left}\
figure{margin:1em 0}figcaption{color:#555;font-size:14px}";

impl Page {
    pub(crate) fn heading(&mut self, level: usize, text: impl Into<String>) {
        self.blocks.push(Block::Heading(level, text.into()));
    }

    pub(crate) fn text(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Text(text.into()));
    }

    pub(crate) fn table(&mut self, head: Vec<String>, rows: Vec<Vec<String>>) {
        self.blocks.push(Block::Table(head, rows));
    }

    pub(crate) fn picture(&mut self, file: impl Into<String>, shows: impl Into<String>) {
        self.blocks.push(Block::Picture(file.into(), shows.into()));
    }

    /// Writes the page into a folder as Markdown, under this name, and as `index.html`, whose path it gives.
    pub(crate) fn write(&self, out: &Path, markdown_name: &str, title: &str) -> Result<PathBuf, Error> {
        let write = |name: &str, text: String| {
            let path = out.join(name);
            std::fs::write(&path, text).map_err(|source| Error::File { path: path.clone(), source })?;
            Ok::<_, Error>(path)
        };
        write(markdown_name, self.markdown())?;
        write("index.html", self.html(title))
    }

    pub(crate) fn markdown(&self) -> String {
        let mut out = String::new();
        let row = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        for block in &self.blocks {
            // writing to a string cannot fail
            let _ = match block {
                Block::Heading(level, text) => writeln!(out, "{} {text}\n", "#".repeat(*level)),
                Block::Text(text) => writeln!(out, "{text}\n"),
                Block::Picture(file, shows) => writeln!(out, "![{shows}]({file})\n"),
                Block::Table(head, rows) => {
                    let rule = vec!["---".to_owned(); head.len()];
                    let body: String = rows.iter().map(|cells| row(cells)).collect();
                    writeln!(out, "{}{}{body}", row(head), row(&rule))
                }
            };
        }
        out
    }

    pub(crate) fn html(&self, title: &str) -> String {
        let mut out = format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title><style>{STYLE}</style></head><body>\n",
            escaped(title)
        );
        let row = |tag: &str, cells: &[String]| {
            let cells: String = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
            format!("<tr>{cells}</tr>\n")
        };
        for block in &self.blocks {
            let _ = match block {
                Block::Heading(level, text) => writeln!(out, "<h{level}>{}</h{level}>", escaped(text)),
                Block::Text(text) => writeln!(out, "<p>{}</p>", escaped(text)),
                Block::Picture(file, shows) => writeln!(
                    out,
                    "<figure><img src=\"{0}\" alt=\"{1}\"><figcaption>{1}</figcaption></figure>",
                    escaped(file),
                    escaped(shows)
                ),
                Block::Table(head, rows) => {
                    let body: String = rows.iter().map(|cells| row("td", cells)).collect();
                    writeln!(out, "<table>\n{}{body}</table>", row("th", head))
                }
            };
        }
        out.push_str("</body></html>\n");
        out
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// `1,234,567`.
pub(crate) fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(c);
    }
    text
}

/// Writes a table beside the page: a line of names, then rows.
pub(crate) fn write_csv(path: &Path, head: &str, rows: &[Vec<String>]) -> Result<(), Error> {
    let mut text = format!("{head}\n");
    for row in rows {
        let _ = writeln!(text, "{}", row.join(","));
    }
    std::fs::write(path, text).map_err(|source| Error::File { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_hold_the_same() {
        let mut page = Page::default();
        page.heading(1, "A & B");
        page.text("so < so");
        page.table(vec!["k".into(), "faces".into()], vec![vec!["1".into(), count(1_234_567)]]);
        page.picture("a.png", "a plot");
        assert_eq!(
            page.markdown(),
            "# A & B\n\nso < so\n\n| k | faces |\n| --- | --- |\n| 1 | 1,234,567 |\n\n![a plot](a.png)\n\n"
        );
        let html = page.html("A & B");
        for part in ["<h1>A &amp; B</h1>", "<td>1,234,567</td>", "<img src=\"a.png\"", "so &lt; so", "</html>"] {
            assert!(html.contains(part), "{part}");
        }
    }
}
