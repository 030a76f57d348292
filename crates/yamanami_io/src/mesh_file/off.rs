//! OFF: text, with normals, colours and texture coordinates of vertices as its keyword says, polygons.
//!
//! Based on: Phillips and others, "Geomview manual", The Geometry Center, 1996.

use super::MeshMeta;
use super::origin::Origin;
use super::ply_vertices::real_colours;
use super::polygon::Polygons;
use crate::IoError;
use glam::DVec3;
use std::io::Write;
use yamanami_core::TriangleMesh;

pub(super) fn write(out: &mut dyn Write, mesh: &TriangleMesh, meta: &MeshMeta) -> std::io::Result<()> {
    let letters = |is: bool, letters: &'static str| if is { letters } else { "" };
    let keyword = [
        letters(!mesh.texcoords.is_empty(), "ST"),
        letters(!mesh.colours.is_empty(), "C"),
        letters(!mesh.normals.is_empty(), "N"),
        "OFF",
    ];
    writeln!(out, "{}\n# written by yamanami, metres, z up", keyword.concat())?;
    for line in meta.lines() {
        writeln!(out, "# {line}")?;
    }
    writeln!(out, "{} {} 0", mesh.positions.len(), mesh.triangles.len())?;
    for (i, p) in mesh.positions.iter().enumerate() {
        write!(out, "{} {} {}", p.x, p.y, p.z)?;
        if let Some([x, y, z]) = mesh.normals.get(i) {
            write!(out, " {x} {y} {z}")?;
        }
        if let Some([r, g, b, a]) = mesh.colours.get(i) {
            write!(out, " {r} {g} {b} {a}")?;
        }
        if let Some(&[u, v]) = mesh.texcoords.get(i) {
            // v is up here; in double precision the turn loses nothing
            write!(out, " {u} {}", 1.0 - f64::from(v))?;
        }
        writeln!(out)?;
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}

/// What the keyword says that vertices have.
struct Kind {
    normals: bool,
    colours: bool,
    texcoords: bool,
}

impl Kind {
    /// `None` for what is no keyword, an error text for one that is not read.
    fn of(word: &str) -> Option<Result<Self, &'static str>> {
        let start = word.strip_suffix("OFF")?;
        let (texcoords, start) = start.strip_prefix("ST").map_or((false, start), |rest| (true, rest));
        let (colours, start) = start.strip_prefix('C').map_or((false, start), |rest| (true, rest));
        let (normals, start) = start.strip_prefix('N').map_or((false, start), |rest| (true, rest));
        match start {
            "" => Some(Ok(Self { normals, colours, texcoords })),
            "4" | "n" | "4n" => Some(Err("vertices in other than three dimensions")),
            _ => None,
        }
    }
}

pub(super) fn read(origin: &mut Origin<'_>, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let mut lines = Lines { rest: bytes, number: 0 };
    let mut first = lines.next().unwrap_or_default();
    let word = first.split_ascii_whitespace().next().unwrap_or_default();
    let kind = match Kind::of(word) {
        Some(Ok(kind)) => {
            first = first.trim_start()[word.len()..].trim().to_owned();
            kind
        }
        Some(Err(what)) => return Err(IoError::unsupported(origin.name, what, "export it with x, y and z")),
        // the keyword may be missing
        None if word.parse::<u64>().is_ok() => Kind { normals: false, colours: false, texcoords: false },
        None => return Err(origin.bad("line 1", "'OFF'", format!("'{}'", word.chars().take(20).collect::<String>()))),
    };
    if first == "BINARY" {
        return Err(IoError::unsupported(origin.name, "binary OFF", "export it as text"));
    }
    if first.is_empty() {
        first = lines.next().unwrap_or_default();
    }
    let counts: Vec<u64> = first.split_ascii_whitespace().map_while(|n| n.parse().ok()).collect();
    let [vertices, faces, ..] = counts[..] else {
        return Err(lines.bad(origin, "the numbers of vertices and faces", &first));
    };
    // a vertex is at least '0 0 0' and a line break, a face '3 0 0 0'
    let needed = vertices.saturating_mul(6).saturating_add(faces.saturating_mul(8)).saturating_sub(1);
    if needed > lines.rest.len() as u64 {
        let expected = format!("at least {needed} bytes for {vertices} vertices and {faces} faces");
        return Err(origin.bad(format!("line {}", lines.number), expected, lines.rest.len().to_string()));
    }
    if vertices >= u64::from(u32::MAX) {
        return Err(IoError::too_large(origin.name, "vertices", vertices, u64::from(u32::MAX) - 1));
    }
    let mut mesh = TriangleMesh::default();
    read_vertices(origin, &mut lines, &kind, vertices, &mut mesh)?;
    let mut polygons = Polygons::default();
    let mut corners = Vec::new();
    for face in 0..faces {
        let Some(line) = lines.next() else {
            return Err(origin.bad(format!("face {face}"), "a line", "end of file"));
        };
        let mut words = line.split_ascii_whitespace();
        let count = words.next().and_then(|n| n.parse::<usize>().ok()).filter(|&n| n >= 3);
        let Some(count) = count else {
            return Err(lines.bad(origin, "a face of at least 3 corners", &line));
        };
        corners.clear();
        corners.extend(
            words.by_ref().take(count).map_while(|w| w.parse::<u32>().ok()).filter(|&i| u64::from(i) < vertices),
        );
        if corners.len() < count {
            return Err(lines.bad(origin, &format!("{count} corners below {vertices}"), &line));
        }
        if words.next().is_some() {
            origin.note("colours of faces are not read, only those of vertices");
        }
        polygons.push(&corners, &mut mesh.triangles);
    }
    polygons.cut(&mesh.positions, &mut mesh.triangles);
    Ok(mesh)
}

fn read_vertices(
    origin: &mut Origin<'_>,
    lines: &mut Lines<'_>,
    kind: &Kind,
    count: u64,
    mesh: &mut TriangleMesh,
) -> Result<(), IoError> {
    let mut colours: Vec<[f32; 4]> = Vec::new();
    let mut real = false;
    let mut numbers: Vec<f64> = Vec::new();
    let before = if kind.normals { 6 } else { 3 };
    let after = if kind.texcoords { 2 } else { 0 };
    for vertex in 0..count {
        let Some(line) = lines.next() else {
            return Err(origin.bad(format!("vertex {vertex}"), "a line", "end of file"));
        };
        numbers.clear();
        numbers.extend(line.split_ascii_whitespace().map_while(|w| w.parse::<f64>().ok()));
        // colours come with or without an alpha
        let colour = if kind.colours { 3..=4 } else { 0..=0 };
        let given = numbers.len().checked_sub(before + after);
        if !given.is_some_and(|n| colour.contains(&n) || (!kind.colours && !kind.texcoords)) {
            let expected = format!("{} numbers of a vertex", before + colour.start() + after);
            return Err(lines.bad(origin, &expected, &line));
        }
        mesh.positions.push(DVec3::new(numbers[0], numbers[1], numbers[2]));
        if kind.normals {
            mesh.normals.push([numbers[3] as f32, numbers[4] as f32, numbers[5] as f32]);
        }
        if kind.colours {
            let colour = &numbers[before..numbers.len() - after];
            real |= line.contains('.')
                && line.split_ascii_whitespace().skip(before).take(colour.len()).any(|w| w.contains('.'));
            let alpha = colour.get(3).map_or(f32::INFINITY, |&a| a as f32);
            colours.push([colour[0] as f32, colour[1] as f32, colour[2] as f32, alpha]);
        }
        if kind.texcoords {
            let [u, v] = [numbers[numbers.len() - 2], numbers[numbers.len() - 1]];
            mesh.texcoords.push([u as f32, (1.0 - v) as f32]);
        }
    }
    if real {
        mesh.colours = real_colours(&colours).collect();
    } else {
        // an alpha that is missing is infinite, and so full
        mesh.colours = colours.iter().map(|c| c.map(|c| c as u8)).collect();
    }
    Ok(())
}

/// Lines that say something, without their comments.
struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl Lines<'_> {
    fn next(&mut self) -> Option<String> {
        while !self.rest.is_empty() {
            self.number += 1;
            let end = self.rest.iter().position(|&b| b == b'\n').unwrap_or(self.rest.len());
            let (line, rest) = self.rest.split_at(end);
            self.rest = rest.get(1..).unwrap_or_default();
            let line = line.split(|&b| b == b'#').next().unwrap_or_default().trim_ascii();
            if !line.is_empty() {
                return Some(String::from_utf8_lossy(line).into_owned());
            }
        }
        None
    }

    fn bad(&self, origin: &Origin<'_>, expected: &str, line: &str) -> IoError {
        let found: String = line.chars().take(60).collect();
        origin.bad(format!("line {}", self.number), expected, format!("'{found}'"))
    }
}
