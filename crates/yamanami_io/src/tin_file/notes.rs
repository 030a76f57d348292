//! What a reader dropped, mended or assumed: one line a kind, however often it happened.

use std::fmt::Display;

/// Most lines about a file; a hostile one could have a million kinds.
const MAX_LINES: usize = 40;

/// Most characters of one.
const MAX_CHARS: usize = 300;

/// What is worth telling about a file.
#[derive(Debug, Default)]
pub(super) struct Notes {
    lines: Vec<String>,
    /// What happened, how often, and where first.
    counted: Vec<(&'static str, usize, String)>,
}

impl Notes {
    /// Keeps a line, once.
    pub(super) fn say(&mut self, line: impl Into<String>) {
        let line = one_line(&line.into());
        if self.lines.len() < MAX_LINES && !self.lines.contains(&line) {
            self.lines.push(line);
        }
    }

    /// Counts something that happened at a place, e.g. `faces with two equal corners dropped` at `line 12`.
    pub(super) fn count(&mut self, what: &'static str, place: impl Display) {
        match self.counted.iter_mut().find(|(known, ..)| *known == what) {
            Some((_, count, _)) => *count += 1,
            None => self.counted.push((what, 1, one_line(&place.to_string()))),
        }
    }

    /// Adds those of a part.
    pub(super) fn join(&mut self, part: Self) {
        self.lines.extend(part.lines);
        self.counted.extend(part.counted);
    }

    /// All of it as lines.
    pub(super) fn into_lines(self) -> Vec<String> {
        let counted = self.counted.into_iter().map(|(what, count, place)| format!("{what}: {count}, first at {place}"));
        self.lines.into_iter().chain(counted).collect()
    }
}

/// What a file contains may be long and of any characters.
fn one_line(text: &str) -> String {
    text.chars().take(MAX_CHARS).map(|c| if c.is_control() { ' ' } else { c }).collect()
}
