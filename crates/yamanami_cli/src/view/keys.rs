//! The keyboard: keys that do something once, and keys held down to move.

use super::panel::Action;
use super::settings::{Colour, Settings};
use eframe::egui::{self, Event, Key};
use yamanami::steer::Drive;

/// Keys and what they ask for.
const ACTIONS: [(Key, Action); 9] = [
    (Key::R, Action::Reset),
    (Key::F, Action::ChangeMode),
    (Key::Z, Action::Freeze),
    (Key::T, Action::Record),
    (Key::Y, Action::Replay),
    (Key::P, Action::Picture),
    (Key::H, Action::Help),
    (Key::F1, Action::Help),
    (Key::M, Action::Panel),
];

/// What keys pressed in this frame ask for; those for the looks turn the settings at once.
pub(super) fn pressed(ui: &egui::Ui, settings: &mut Settings, colours: &[Colour]) -> Option<Action> {
    if ui.text_edit_focused() {
        return None;
    }
    let pressed = |key: Key| is_pressed(ui, key);
    if pressed(Key::C) {
        let next = colours.iter().position(|&c| c == settings.colour).map_or(0, |i| (i + 1) % colours.len());
        settings.colour = colours[next];
    }
    settings.wireframe ^= pressed(Key::L);
    settings.morph ^= pressed(Key::G);
    ACTIONS.into_iter().find_map(|(key, action)| pressed(key).then_some(action))
}

/// Whether a key has been pressed in this frame, alone.
pub(super) fn is_pressed(ui: &egui::Ui, key: Key) -> bool {
    ui.input(|i| {
        i.events.iter().any(|event| {
            matches!(event, Event::Key { key: k, pressed: true, repeat: false, modifiers, .. }
                if *k == key && !modifiers.command && !modifiers.alt)
        })
    })
}

/// What keys held down ask of the camera.
pub(super) fn drive(ui: &egui::Ui) -> Drive {
    if ui.text_edit_focused() {
        return Drive::default();
    }
    ui.input(|i| {
        let axis = |plus: Key, minus: Key| f64::from(i8::from(i.key_down(plus)) - i8::from(i.key_down(minus)));
        let along = [axis(Key::W, Key::S), axis(Key::D, Key::A), axis(Key::E, Key::Q)];
        let free = !i.modifiers.command && !i.modifiers.alt;
        Drive { along: if free { along } else { [0.0; 3] }, fast: i.modifiers.shift }
    })
}
