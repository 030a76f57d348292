//! Running numbers: the last frames of a value as a small curve.

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Sense, Stroke, pos2, vec2};
use std::collections::VecDeque;

/// Frames kept.
const FRAMES: usize = 240;
/// Height of a plot in points.
const HEIGHT: f32 = 40.0;

/// The last values of one number.
#[derive(Debug, Clone, Default)]
pub(super) struct History {
    values: VecDeque<f64>,
}

/// How a number is shown.
#[derive(Debug, Clone, Copy)]
pub(super) struct Label<'a> {
    /// What it is.
    pub(super) name: &'a str,
    /// Its unit, with a leading blank where one belongs.
    pub(super) unit: &'a str,
    /// Explanation under the pointer.
    pub(super) hint: &'a str,
}

impl History {
    /// Adds the value of a frame; what is no number leaves a gap.
    pub(super) fn push(&mut self, value: f64) {
        if self.values.len() == FRAMES {
            self.values.pop_front();
        }
        self.values.push_back(value);
    }

    /// The last value that is a number.
    pub(super) fn last(&self) -> Option<f64> {
        self.values.iter().rev().copied().find(|v| v.is_finite())
    }

    /// Mean of the last `frames` values.
    pub(super) fn mean(&self, frames: usize) -> Option<f64> {
        let last: Vec<f64> = self.values.iter().rev().take(frames).copied().filter(|v| v.is_finite()).collect();
        (!last.is_empty()).then(|| last.iter().sum::<f64>() / last.len() as f64)
    }

    /// Draws the curve with its last value; `limit` is a line to compare with.
    pub(super) fn show(&self, ui: &mut egui::Ui, label: Label<'_>, limit: Option<f64>) {
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
        response.on_hover_text(label.hint);
        let visuals = ui.visuals();
        let (text, curve, line) = (visuals.text_color(), Color32::from_rgb(96, 168, 224), visuals.weak_text_color());
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 3.0, visuals.extreme_bg_color);
        let finite = self.values.iter().copied().filter(|v| v.is_finite());
        let top = finite.chain(limit).fold(f64::MIN_POSITIVE, f64::max) * 1.08;
        let y = |value: f64| rect.bottom() - 1.0 - (value / top) as f32 * (rect.height() - 2.0);
        let x =
            |frame: usize| rect.right() - (self.values.len() - 1 - frame) as f32 * rect.width() / (FRAMES - 1) as f32;
        let mut run: Vec<Pos2> = Vec::new();
        for (frame, &value) in self.values.iter().enumerate() {
            if value.is_finite() {
                run.push(pos2(x(frame), y(value)));
            }
            if !value.is_finite() || frame + 1 == self.values.len() {
                painter.line(std::mem::take(&mut run), Stroke::new(1.3, curve));
            }
        }
        if let Some(limit) = limit {
            painter.hline(rect.x_range(), y(limit), Stroke::new(1.0, Color32::from_rgb(226, 150, 70)));
        }
        let small = FontId::proportional(11.0);
        let at = |anchor: Align2| anchor.pos_in_rect(&rect.shrink2(vec2(4.0, 1.0)));
        painter.text(at(Align2::LEFT_TOP), Align2::LEFT_TOP, label.name, small.clone(), line);
        let value = self.last().map_or("-".to_owned(), |v| format!("{}{}", short(v), label.unit));
        painter.text(at(Align2::RIGHT_TOP), Align2::RIGHT_TOP, value, FontId::proportional(12.5), text);
    }
}

/// A number in few figures.
pub(super) fn short(value: f64) -> String {
    match value.abs() {
        v if v >= 1e6 => format!("{:.2} M", value / 1e6),
        v if v >= 1e4 => format!("{:.1} k", value / 1e3),
        v if v >= 100.0 || v == 0.0 => format!("{value:.0}"),
        v if v >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_frames_stay_and_gaps_are_skipped() {
        let mut history = History::default();
        (0..1000).for_each(|i| history.push(f64::from(i)));
        history.push(f64::NAN);
        assert_eq!(history.values.len(), FRAMES);
        assert_eq!(history.last(), Some(999.0));
        assert_eq!(history.mean(3), Some(998.5));
        assert_eq!(History::default().mean(3), None);
    }

    #[test]
    fn numbers_are_short() {
        let shown = [0.0, 0.12345, 3.21987, 512.4, 12_345.0, 3_456_789.0].map(short);
        assert_eq!(shown, ["0", "0.123", "3.22", "512", "12.3 k", "3.46 M"]);
    }
}
