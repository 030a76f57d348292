//! A scene as SVG with live text.

use super::{Anchor, Colour, Fill, Outline, PackedBase, Run, Scene, Shape, Stroke, Text};
use crate::Fonts;
use std::fmt::Write;

/// How the picture of the ground stands in the file.
pub(super) enum Ground<'a> {
    /// Left out: only what lies over it.
    None,
    /// By a name that the reader resolves.
    Named(&'a str),
    /// In the file itself.
    Inside(&'a PackedBase),
}

impl Scene {
    /// The sheet as one SVG file: text stays text, in the fonts' family or what the viewer has. `dpi` gives its size in
    /// millimetres.
    pub fn to_svg(&self, base: Option<&PackedBase>, dpi: f64, fonts: &Fonts) -> String {
        self.written(base.map_or(Ground::None, Ground::Inside), Some(dpi), fonts)
    }

    pub(super) fn written(&self, ground: Ground<'_>, dpi: Option<f64>, fonts: &Fonts) -> String {
        let [width, height] = self.size_px;
        let mm = |px: u32| dpi.map_or(format!("{px}"), |dpi| format!("{:.3}mm", f64::from(px) * 25.4 / dpi));
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"{}\" font-weight=\"500\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n",
            mm(width),
            mm(height),
            escaped(&fonts.families())
        );
        if let (Some(paper), false) = (self.paper, matches!(ground, Ground::None)) {
            let _ = writeln!(out, "<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", hex(paper));
        }
        let image = |out: &mut String, href: &dyn std::fmt::Display| {
            let _ = writeln!(
                out,
                "<image width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" href=\"{href}\"/>"
            );
        };
        match ground {
            Ground::None => {}
            Ground::Named(name) => image(&mut out, &name),
            Ground::Inside(base) => image(&mut out, &base.data_url()),
        }
        for shape in &self.shapes {
            match shape {
                Shape::Outlines { outlines, fill, stroke } => write_outlines(&mut out, outlines, *fill, *stroke),
                Shape::Circle { centre, radius_px, fill, stroke } => {
                    let _ = write!(out, "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{radius_px:.2}\"", centre.x, centre.y);
                    write_paint(&mut out, *fill, *stroke);
                }
                Shape::Text(text) => write_text(&mut out, text),
            }
        }
        out.push_str("</svg>\n");
        out
    }
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // XML has no way to say other control characters
            c if c.is_control() => out.push(' '),
            '\u{FFFE}' | '\u{FFFF}' => {}
            c => out.push(c),
        }
    }
    out
}

fn write_outlines(out: &mut String, outlines: &[Outline], fill: Option<Fill>, stroke: Option<Stroke>) {
    out.push_str("<path d=\"");
    for outline in outlines {
        for (i, p) in outline.points.iter().enumerate() {
            let _ = write!(out, "{}{:.2} {:.2}", if i == 0 { "M" } else { "L" }, p.x, p.y);
        }
        if outline.is_closed {
            out.push('Z');
        }
    }
    out.push('"');
    write_paint(out, fill, stroke);
}

fn write_paint(out: &mut String, fill: Option<Fill>, stroke: Option<Stroke>) {
    match fill {
        Some(fill) => {
            let _ = write!(out, " fill=\"{}\"", hex(fill.colour));
            write_opacity(out, "fill-opacity", fill.opacity);
        }
        None => out.push_str(" fill=\"none\""),
    }
    if let Some(stroke) = stroke {
        write_stroke(out, stroke);
    }
    out.push_str("/>\n");
}

fn write_stroke(out: &mut String, stroke: Stroke) {
    let _ = write!(out, " stroke=\"{}\" stroke-width=\"{:.2}\"", hex(stroke.colour), stroke.width_px);
    write_opacity(out, "stroke-opacity", stroke.opacity);
    if let Some([dash, gap]) = stroke.dash_px {
        let _ = write!(out, " stroke-dasharray=\"{dash:.2} {gap:.2}\" stroke-linecap=\"butt\"");
    }
}

fn write_opacity(out: &mut String, name: &str, opacity: f64) {
    if opacity < 1.0 {
        let _ = write!(out, " {name}=\"{opacity:.2}\"");
    }
}

fn write_text(out: &mut String, text: &Text) {
    let Some(first) = text.runs.first() else { return };
    let _ = write!(out, "<text x=\"{:.2}\" y=\"{:.2}\"", text.at.x, text.at.y);
    if text.angle_rad != 0.0 {
        let _ =
            write!(out, " transform=\"rotate({:.3} {:.2} {:.2})\"", text.angle_rad.to_degrees(), text.at.x, text.at.y);
    }
    match text.anchor {
        Anchor::Start => {}
        Anchor::Middle => out.push_str(" text-anchor=\"middle\""),
        Anchor::End => out.push_str(" text-anchor=\"end\""),
    }
    write_run_style(out, first);
    if let Some(halo) = text.halo {
        out.push_str(" paint-order=\"stroke\"");
        write_stroke(out, halo);
    }
    let _ = write!(out, " xml:space=\"preserve\">{}", escaped(&first.text));
    for run in &text.runs[1..] {
        out.push_str("<tspan");
        write_run_style(out, run);
        let _ = write!(out, ">{}</tspan>", escaped(&run.text));
    }
    out.push_str("</text>\n");
}

fn write_run_style(out: &mut String, run: &Run) {
    let _ = write!(out, " font-size=\"{:.2}\" fill=\"{}\"", run.size_px, hex(run.colour));
}
