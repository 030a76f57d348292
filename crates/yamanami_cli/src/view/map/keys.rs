//! The keyboard of the window of maps.

use super::super::keys::is_pressed;
use super::panel::Action;
use super::settings::Settings;
use eframe::egui::{self, Key};

/// Keys and what they ask for.
const ACTIONS: [(Key, Action); 6] = [
    (Key::R, Action::Fit),
    (Key::N, Action::NorthUp),
    (Key::Home, Action::Home),
    (Key::H, Action::Help),
    (Key::F1, Action::Help),
    (Key::M, Action::Panel),
];

/// Keys and mouse, for the help.
pub(super) const HELP: [(&str, &str); 12] = [
    ("drag left", "move the map's centre over the ground"),
    ("drag right, Q E", "turn the picture"),
    ("wheel, pinch", "larger and smaller about the cursor"),
    ("double click", "make that place the centre"),
    ("click", "pin a place"),
    ("R", "fit the map to the window"),
    ("N", "north up"),
    ("Home", "back to the first centre"),
    ("L", "edges of the triangles"),
    ("space", "alpha goes up and down by itself"),
    ("M", "side panel"),
    ("H or F1", "this help"),
];
/// And the line under them.
pub(super) const HELP_LINE: &str = "Ground further away is read beside the work when the centre has moved.";

/// What keys pressed in this frame ask for; those for the looks turn the settings at once.
pub(super) fn pressed(ui: &egui::Ui, settings: &mut Settings) -> Option<Action> {
    if ui.text_edit_focused() {
        return None;
    }
    let pressed = |key: Key| is_pressed(ui, key);
    settings.wireframe ^= pressed(Key::L);
    settings.sweep ^= pressed(Key::Space);
    ACTIONS.into_iter().find_map(|(key, action)| pressed(key).then_some(action))
}

/// How keys held down turn the picture: -1, 0 or 1 counterclockwise.
pub(super) fn turn(ui: &egui::Ui) -> f64 {
    if ui.text_edit_focused() {
        return 0.0;
    }
    ui.input(|i| f64::from(i8::from(i.key_down(Key::E)) - i8::from(i.key_down(Key::Q))))
}
