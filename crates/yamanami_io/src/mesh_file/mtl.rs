//! Material libraries (MTL) of OBJ files: diffuse colour, opacity and picture; all else is passed over.

use super::origin::Origin;
use std::collections::{HashMap, HashSet};
use yamanami_core::Material;

/// The materials of the libraries that a file names.
#[derive(Default)]
pub(super) struct Library {
    materials: HashMap<String, Entry>,
    /// Lines that were followed already.
    named: HashSet<String>,
}

#[derive(Clone)]
struct Entry {
    base_colour: [f32; 4],
    picture: Option<String>,
}

impl Library {
    /// Reads what an `mtllib` line names: one file, or several.
    pub(super) fn add(&mut self, origin: &mut Origin<'_>, named: &str) {
        if !self.named.insert(named.to_owned()) {
            return;
        }
        let read = |name: &str| origin.read_beside(&name.replace('\\', "/"));
        let first = read(named);
        let found: Vec<_> = match first {
            Ok(bytes) => vec![Ok(bytes)],
            Err(why) if named.split_ascii_whitespace().nth(1).is_none() => vec![Err(why)],
            Err(_) => named.split_ascii_whitespace().map(read).collect(),
        };
        for library in found {
            match library {
                Ok(bytes) => self.parse(&bytes),
                Err(why) => origin.note(format!("material library '{named}' not read: {why}")),
            }
        }
    }

    fn parse(&mut self, bytes: &[u8]) {
        let mut open: Option<&mut Entry> = None;
        for line in bytes.split(|&b| b == b'\n') {
            let line = String::from_utf8_lossy(line);
            let line = line.trim();
            let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let rest = rest.trim();
            if word == "newmtl" {
                let entry = Entry { base_colour: [1.0; 4], picture: None };
                open = Some(self.materials.entry(rest.to_owned()).insert_entry(entry).into_mut());
                continue;
            }
            let Some(entry) = open.as_deref_mut() else { continue };
            let mut numbers = rest.split_ascii_whitespace().map_while(|n| n.parse::<f32>().ok()).map(unit);
            match word {
                "Kd" => {
                    if let Some(red) = numbers.next() {
                        let green = numbers.next().unwrap_or(red);
                        let blue = numbers.next().unwrap_or(red);
                        entry.base_colour[..3].copy_from_slice(&[red, green, blue]);
                    }
                }
                "d" => entry.base_colour[3] = numbers.next().unwrap_or(1.0),
                "Tr" => entry.base_colour[3] = 1.0 - numbers.next().unwrap_or(0.0),
                "map_Kd" => entry.picture = picture_name(rest),
                _ => {}
            }
        }
    }

    /// The material of a name; one that no library has is plain.
    pub(super) fn material(&self, origin: &mut Origin<'_>, name: &str) -> Material {
        let Some(entry) = self.materials.get(name) else {
            return Material { name: name.to_owned(), ..Material::default() };
        };
        let texture = entry.picture.as_deref().and_then(|named| origin.picture(named));
        let mut base_colour = entry.base_colour;
        if texture.is_some() && base_colour[..3] == [0.0; 3] {
            // programs that leave the colour to the picture write black
            base_colour[..3].fill(1.0);
        }
        Material { name: name.to_owned(), base_colour, texture }
    }
}

/// A share between 0 and 1.
fn unit(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
}

/// The file of a `map_` line, after its options.
fn picture_name(line: &str) -> Option<String> {
    let mut rest = line;
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        let arguments = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            _ => 1,
        };
        rest = after.trim_start();
        for _ in 0..arguments {
            let (argument, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            // the second and third of offsets and scales may be missing
            if arguments == 3 && argument.parse::<f32>().is_err() {
                break;
            }
            rest = after.trim_start();
        }
    }
    (!rest.is_empty()).then(|| rest.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_before_a_picture_are_passed_over() {
        for (line, name) in [
            ("a b.png", "a b.png"),
            ("-s 1 1 1 -o 0 a.png", "a.png"),
            ("-bm 0.5 -clamp on tex\\a.png", "tex\\a.png"),
        ] {
            assert_eq!(picture_name(line).as_deref(), Some(name));
        }
        assert_eq!(picture_name("-s"), None);
    }
}
