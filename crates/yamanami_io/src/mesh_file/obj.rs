//! Wavefront OBJ: vertices, vertex normals and faces of any number of corners; all else is passed over.

use super::MeshMeta;
use crate::IoError;
use glam::DVec3;
use std::io::Write;
use std::path::Path;
use yamanami_core::TriangleMesh;

pub(super) fn write(out: &mut impl Write, mesh: &TriangleMesh, meta: &MeshMeta) -> std::io::Result<()> {
    writeln!(out, "# written by yamanami, metres, z up")?;
    for line in meta.lines() {
        writeln!(out, "# {line}")?;
    }
    // the shortest decimals that read back as the same numbers
    for p in &mesh.positions {
        writeln!(out, "v {} {} {}", p.x, p.y, p.z)?;
    }
    for [x, y, z] in &mesh.normals {
        writeln!(out, "vn {x} {y} {z}")?;
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| u64::from(i) + 1);
        if mesh.normals.is_empty() {
            writeln!(out, "f {a} {b} {c}")?;
        } else {
            writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
        }
    }
    Ok(())
}

pub(super) fn read(name: &Path, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let mut reader =
        Reader { name, line: 0, mesh: TriangleMesh::default(), normals: Vec::new(), normal_of: Vec::new() };
    let mut joined = Vec::new();
    for line in bytes.split(|&b| b == b'\n') {
        reader.line += 1;
        let line = line.trim_ascii();
        // a backslash carries a statement on to the next line
        if let Some(start) = line.strip_suffix(b"\\") {
            joined.extend_from_slice(start);
            joined.push(b' ');
        } else if joined.is_empty() {
            reader.statement(line)?;
        } else {
            joined.extend_from_slice(line);
            reader.statement(&joined)?;
            joined.clear();
        }
    }
    reader.statement(&joined)?;
    Ok(reader.finish())
}

/// No normal named yet, and more than one.
const NONE: u32 = u32::MAX;
const SEVERAL: u32 = u32::MAX - 1;

struct Reader<'a> {
    name: &'a Path,
    line: usize,
    mesh: TriangleMesh,
    normals: Vec<[f32; 3]>,
    /// For each vertex the normal that faces name beside it.
    normal_of: Vec<u32>,
}

impl Reader<'_> {
    fn bad(&self, expected: &str, found: &[u8]) -> IoError {
        let found: String = String::from_utf8_lossy(found).chars().take(60).collect();
        IoError::malformed(self.name, format!("line {}", self.line), expected, format!("'{found}'"))
    }

    fn statement(&mut self, line: &[u8]) -> Result<(), IoError> {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
        match words.next() {
            Some(b"v") => {
                let position = self.three_numbers(words, line)?;
                self.mesh.positions.push(position);
                self.normal_of.push(NONE);
                if self.mesh.positions.len() >= SEVERAL as usize {
                    let given = self.mesh.positions.len() as u64;
                    return Err(IoError::too_large(self.name, "vertices", given, u64::from(SEVERAL) - 1));
                }
            }
            Some(b"vn") => {
                let normal = self.three_numbers(words, line)?.as_vec3().to_array();
                self.normals.push(normal);
            }
            Some(b"f") => self.face(words, line)?,
            _ => {}
        }
        Ok(())
    }

    fn three_numbers<'w>(&self, mut words: impl Iterator<Item = &'w [u8]>, line: &[u8]) -> Result<DVec3, IoError> {
        let mut next = || std::str::from_utf8(words.next()?).ok()?.parse::<f64>().ok();
        match (next(), next(), next()) {
            (Some(x), Some(y), Some(z)) => Ok(DVec3::new(x, y, z)),
            _ => Err(self.bad("three numbers", line)),
        }
    }

    /// A face's corners, `vertex`, `vertex/texture`, `vertex//normal` or `vertex/texture/normal`, counted from 1, or
    /// backwards from the last one with a minus.
    fn face<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>, line: &[u8]) -> Result<(), IoError> {
        let (mut first, mut last, mut count) = (0, 0, 0);
        for word in words {
            if word.starts_with(b"#") {
                break;
            }
            let mut parts = word.split(|&b| b == b'/');
            let vertex = self.index(parts.next(), self.mesh.positions.len()).ok_or_else(|| {
                self.bad(&format!("corners among the {} vertices so far", self.mesh.positions.len()), line)
            })?;
            if let Some(normal) = parts.nth(1) {
                let normal = self
                    .index(Some(normal), self.normals.len())
                    .ok_or_else(|| self.bad(&format!("normals among the {} so far", self.normals.len()), line))?;
                let known = &mut self.normal_of[vertex as usize];
                *known = if *known == NONE || *known == normal { normal } else { SEVERAL };
            }
            count += 1;
            match count {
                1 => first = vertex,
                2 => {}
                _ => self.mesh.triangles.push([first, last, vertex]),
            }
            last = vertex;
        }
        if count < 3 {
            return Err(self.bad("a face of at least 3 corners", line));
        }
        Ok(())
    }

    fn index(&self, word: Option<&[u8]>, count: usize) -> Option<u32> {
        let given: i64 = std::str::from_utf8(word?).ok()?.parse().ok()?;
        let index = if given < 0 { given.checked_add(count as i64)? } else { given - 1 };
        (0..count as i64).contains(&index).then_some(index as u32)
    }

    /// Keeps normals where every vertex has exactly one.
    fn finish(mut self) -> TriangleMesh {
        let one_each = self.normal_of.iter().all(|&n| (n as usize) < self.normals.len());
        if one_each {
            self.mesh.normals = self.normal_of.iter().map(|&n| self.normals[n as usize]).collect();
        }
        self.mesh
    }
}
