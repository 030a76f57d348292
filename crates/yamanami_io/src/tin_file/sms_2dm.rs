//! SMS 2DM: the meshes of hydraulic models. Nodes, triangles and quadrilaterals of numbered nodes, strings of nodes.
//!
//! Based on: Aquaveo, "SMS: 2D mesh files *.2dm", XMS Wiki, 2009.

use super::lines::Lines;
use super::upward::{cut_quad, upward};
use super::{Notes, ReadTin, TinReadOptions, check, metric};
use crate::IoError;
use glam::DVec3;
use std::collections::HashMap;
use std::io::{BufRead, Write};
use std::path::Path;
use yamanami_core::{Breakline, BreaklineKind, Tin};

/// Most nodes.
const MAX_NODES: u64 = 1 << 31;

/// Nodes of a string on a line.
const NODES_A_LINE: usize = 10;

/// A triangle or quadrilateral, and where it is.
struct Element {
    line: u64,
    /// Of a triangle, the last one twice.
    nodes: [u32; 4],
}

/// A string of nodes.
#[derive(Default)]
struct NodeString {
    line: u64,
    nodes: Vec<u32>,
    name: String,
}

/// A file's cards.
#[derive(Default)]
struct Cards {
    name: String,
    ids: Vec<u32>,
    places: Vec<DVec3>,
    elements: Vec<Element>,
    /// Elements with nodes amid their sides: six or eight nodes.
    quadratics: Vec<(u64, Vec<u32>)>,
    strings: Vec<NodeString>,
}

/// Reads a mesh. The format knows no unit: metres, unless the options say otherwise.
pub(super) fn read(name: &Path, mut content: impl BufRead, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let mut notes = Notes::default();
    let crs = check::crs(options);
    if options.unit_m.is_none() && !crs.geographic {
        notes.say("no unit is stated: metres assumed");
    }
    // degrees are left as they are
    let unit_m = options.unit_m.filter(|_| !crs.geographic).unwrap_or(1.0);
    let cards = Cards::read(name, &mut Lines::new(name, &mut content), unit_m, &mut notes)?;
    let mut tin = Tin { name: cards.name, unit_m, crs, ..Tin::default() };
    let numbers = Numbers::new(&cards.ids, &mut notes);
    let places = cards.places;
    let mut corners = Vec::new();
    let elements = cards.elements.iter().map(|e| (e.line, &e.nodes[..]));
    for (line, nodes) in elements.chain(cards.quadratics.iter().map(|(line, nodes)| (*line, &nodes[..]))) {
        let at = format_args!("line {line}");
        if !numbers.of_all(nodes, &mut corners) {
            notes.count("elements with a node that is not there dropped", at);
            continue;
        }
        let place = |number: u32| places[number as usize];
        let mut push = |corners| tin.mesh.triangles.extend(upward(corners, place, &mut notes, at));
        match *element_corners(&mut corners, place) {
            [a, b, c] => push([a, b, c]),
            [a, b, c, d] if c == d => push([a, b, c]),
            [a, b, c, d] => {
                let quad = [a, b, c, d];
                cut_quad(quad.map(place)).into_iter().for_each(|cut| push(cut.map(|k| quad[k])));
            }
            _ => {}
        }
    }
    let mut of_lines = vec![false; places.len()];
    for NodeString { line, nodes, name } in cards.strings {
        if !numbers.of_all(&nodes, &mut corners) || corners.len() < 2 {
            notes.count(
                "strings of fewer than two nodes or with one that is not there dropped",
                format_args!("line {line}"),
            );
            continue;
        }
        corners.iter().for_each(|&number| of_lines[number as usize] = true);
        let points = corners.iter().map(|&number| places[number as usize]).collect();
        tin.breaklines.push(Breakline { name, kind: BreaklineKind::Hard, points });
    }
    tin.mesh.positions = places;
    if !tin.breaklines.is_empty() {
        leave_out_line_vertices(&mut tin, of_lines);
    }
    metric::to_metres(&mut tin, &mut notes);
    Ok(check::readable(tin, notes))
}

/// Leaves out vertices of lines that no triangle uses: lines have places of their own.
fn leave_out_line_vertices(tin: &mut Tin, mut of_lines: Vec<bool>) {
    for &i in tin.mesh.triangles.iter().flatten() {
        of_lines[i as usize] = false;
    }
    let mut kept = 0;
    let number_of: Vec<u32> = of_lines
        .iter()
        .map(|left_out| {
            kept += u32::from(!left_out);
            kept.saturating_sub(1)
        })
        .collect();
    let mut left_out = of_lines.iter();
    tin.mesh.positions.retain(|_| left_out.next() == Some(&false));
    for i in tin.mesh.triangles.iter_mut().flatten() {
        *i = number_of[*i as usize];
    }
}

impl Cards {
    fn read(name: &Path, lines: &mut Lines<'_>, unit_m: f64, notes: &mut Notes) -> Result<Self, IoError> {
        let mut cards = Self::default();
        let mut open = NodeString::default();
        let mut begun = false;
        while lines.next()? {
            let line = lines.number();
            let text = String::from_utf8_lossy(lines.bytes());
            let (card, rest) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((&text, ""));
            match card {
                "MESH2D" => begun = true,
                "" => {}
                _ if card.starts_with('#') => {}
                _ if !begun => return Err(lines.bad("'MESH2D'")),
                "MESHNAME" => cards.name = unquoted(rest),
                "ND" => {
                    let mut words = rest.split_ascii_whitespace();
                    let id = words.next().and_then(|word| word.parse().ok());
                    let mut number = || words.next()?.parse::<f64>().ok();
                    let (Some(id), Some(x), Some(y), Some(z)) = (id, number(), number(), number()) else {
                        return Err(lines.bad("a node's number and three coordinates"));
                    };
                    if cards.ids.len() as u64 == MAX_NODES {
                        return Err(IoError::too_large(name, "nodes", MAX_NODES + 1, MAX_NODES));
                    }
                    cards.ids.push(id);
                    cards.places.push(DVec3::new(x, y, z) * unit_m);
                }
                "E3T" => {
                    let [a, b, c] = nodes(lines, rest)?;
                    cards.elements.push(Element { line, nodes: [a, b, c, c] });
                }
                "E4Q" => cards.elements.push(Element { line, nodes: nodes(lines, rest)? }),
                "E6T" => cards.quadratics.push((line, nodes::<6>(lines, rest)?.to_vec())),
                "E8Q" | "E9Q" => cards.quadratics.push((line, nodes::<8>(lines, rest)?.to_vec())),
                "E2L" | "E3L" => notes.count("elements that are lines left out", format_args!("line {line}")),
                "NS" => {
                    if open.nodes.is_empty() {
                        open.line = line;
                    }
                    if open.extend(rest).ok_or_else(|| lines.bad("numbers of nodes"))? {
                        cards.strings.push(std::mem::take(&mut open));
                    }
                }
                _ => {}
            }
        }
        if !begun {
            return Err(IoError::malformed(name, lines.place(), "'MESH2D'", "the end of the file"));
        }
        if let Some((line, _)) = cards.quadratics.first() {
            let (count, first) = (cards.quadratics.len(), line);
            notes.say(format!(
                "{count} elements with nodes amid their sides read by their corners, first at line {first}"
            ));
        }
        if !open.nodes.is_empty() {
            notes.count("strings of nodes without an end left out", format_args!("line {}", open.line));
        }
        Ok(cards)
    }
}

/// The node numbers of an element of `COUNT` nodes: what follows its own number.
fn nodes<const COUNT: usize>(lines: &Lines<'_>, rest: &str) -> Result<[u32; COUNT], IoError> {
    let mut nodes = [0; COUNT];
    let mut words = rest.split_ascii_whitespace().skip(1);
    for node in &mut nodes {
        let parsed = words.next().and_then(|word| word.parse().ok());
        *node = parsed.ok_or_else(|| lines.bad(&format!("an element's number and those of its {COUNT} nodes")))?;
    }
    Ok(nodes)
}

/// The corners of an element, in their order. Where nodes lie amid sides, files have them behind each corner or behind
/// all corners: the corners are those that enclose more.
fn element_corners(nodes: &mut Vec<u32>, place: impl Fn(u32) -> DVec3) -> &[u32] {
    let sides = nodes.len() / 2;
    if sides < 3 {
        return nodes;
    }
    let alternating: Vec<u32> = nodes.iter().copied().step_by(2).collect();
    let area = |corners: &[u32]| {
        let from = |k: usize| place(corners[k % corners.len()]).truncate() - place(corners[0]).truncate();
        (0..corners.len()).map(|k| from(k).perp_dot(from(k + 1))).sum::<f64>().abs()
    };
    if area(&nodes[..sides]) <= area(&alternating) {
        nodes.splice(..sides, alternating);
    }
    &nodes[..sides]
}

impl NodeString {
    /// Takes the nodes of a card; whether the string is then complete, `None` where the card holds something else.
    fn extend(&mut self, mut rest: &str) -> Option<bool> {
        loop {
            rest = rest.trim_ascii_start();
            if rest.is_empty() {
                return Some(false);
            }
            let (word, after) = rest.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((rest, ""));
            self.nodes.push(word.trim_start_matches('-').parse().ok()?);
            if word.starts_with('-') {
                // behind the last node may be the string's name or number
                self.name = unquoted(after);
                return Some(true);
            }
            rest = after;
        }
    }
}

/// Text without blanks and quotes around it.
fn unquoted(text: &str) -> String {
    text.trim_ascii().trim_matches('"').to_owned()
}

/// Vertices by their nodes' numbers.
enum Numbers {
    /// The numbers are 1, 2, 3, … up to this one.
    Counted(u32),
    Listed(HashMap<u32, u32>),
}

impl Numbers {
    fn new(ids: &[u32], notes: &mut Notes) -> Self {
        if ids.iter().zip(1..).all(|(id, number): (_, u32)| *id == number) {
            return Self::Counted(ids.len() as u32);
        }
        let mut listed = HashMap::with_capacity(ids.len());
        for (&id, number) in ids.iter().zip(0..) {
            if *listed.entry(id).or_insert(number) != number {
                notes.count("nodes whose number another one has already left unused", format_args!("node {id}"));
            }
        }
        Self::Listed(listed)
    }

    /// Sets `vertices` to those of nodes; whether all are there.
    fn of_all(&self, nodes: &[u32], vertices: &mut Vec<u32>) -> bool {
        vertices.clear();
        vertices.extend(nodes.iter().filter_map(|&id| match self {
            Self::Counted(count) => id.checked_sub(1).filter(|number| number < count),
            Self::Listed(listed) => listed.get(&id).copied(),
        }));
        vertices.len() == nodes.len()
    }
}

/// Writes a mesh in metres. Points of lines that are no vertices become nodes of their own behind them; hidden triangles
/// are left out.
pub(super) fn write(out: &mut dyn Write, tin: &Tin) -> std::io::Result<()> {
    writeln!(out, "MESH2D\nMESHNAME \"{}\"", quotable(&tin.name))?;
    for ([a, b, c], id) in tin.mesh.triangles.iter().zip(1u64..) {
        writeln!(out, "E3T {id} {} {} {} 1", a + 1, b + 1, c + 1)?;
    }
    let bits = |p: &DVec3| p.to_array().map(f64::to_bits);
    let points = tin.breaklines.iter().flat_map(|line| &line.points);
    let mut node_of: HashMap<[u64; 3], u64> = points.clone().map(|p| (bits(p), 0)).collect();
    let mut id = 0;
    for p in tin.mesh.positions.iter().chain(points) {
        let of_line = node_of.get_mut(&bits(p));
        if id >= tin.mesh.positions.len() as u64 && of_line.as_ref().is_none_or(|known| **known > 0) {
            continue;
        }
        id += 1;
        writeln!(out, "ND {id} {} {} {}", p.x, p.y, p.z)?;
        if let Some(known) = of_line.filter(|known| **known == 0) {
            *known = id;
        }
    }
    for line in &tin.breaklines {
        let last = line.points.len().saturating_sub(1);
        for (k, p) in line.points.iter().enumerate() {
            let begin = if k % NODES_A_LINE == 0 { "NS " } else { "" };
            let sign = if k == last { "-" } else { "" };
            let end = if k % NODES_A_LINE == NODES_A_LINE - 1 && k < last { "\n" } else { " " };
            write!(out, "{begin}{sign}{}{end}", node_of.get(&bits(p)).copied().unwrap_or_default())?;
        }
        let name = quotable(&line.name);
        writeln!(out, "{}", if name.is_empty() { name } else { format!("\"{name}\"") })?;
    }
    Ok(())
}

/// Text for between quotes, on one line.
fn quotable(text: &str) -> String {
    text.replace(char::is_control, " ").replace('"', "'").trim().to_owned()
}
