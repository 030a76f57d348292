//! XML files: LandXML or CityGML, as the root element says; and elements one after the other, of any encoding, with
//! their lines, in memory that does not grow with the file.

use super::text::Text;
use super::{ReadTin, TinReadOptions, citygml, landxml_read};
use crate::IoError;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::fmt::Display;
use std::io::BufRead;
use std::path::Path;

/// Most elements inside each other; terrain files have a dozen.
const MAX_DEPTH: usize = 1000;

/// Elements that files of terrain begin with; elevation grids are read elsewhere.
const ROOTS: &str = "<LandXML>, <CityModel> or, of an elevation grid, <Dataset>";

/// Reads the TIN of an XML file.
pub(super) fn read(name: &Path, content: impl BufRead, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let mut xml = Xml::new(name, content)?;
    match xml.next()? {
        Node::Start(root, line) => match root.local_name() {
            "LandXML" => landxml_read::read(xml, options),
            "CityModel" => citygml::read(xml, options),
            other => {
                let found = format!("<{other}>");
                Err(IoError::malformed(name, format!("line {line}"), ROOTS, found))
            }
        },
        _ => Err(IoError::malformed(name, "line 1", ROOTS, "no element")),
    }
}

/// A file that is read element by element.
pub(crate) struct Xml<'n, R> {
    name: &'n Path,
    reader: Reader<Text<R>>,
    buffer: Vec<u8>,
    /// The last start tag without its brackets, or the name of the last end tag.
    tag: String,
    /// Text since the last tag.
    text: String,
    depth: usize,
}

/// What comes next in a file.
pub(crate) enum Node<'a> {
    /// A start tag and its line.
    Start(Tag<'a>, u64),
    /// An end tag without its prefix, the text before it since the last tag, its line.
    End(&'a str, &'a str, u64),
    /// Nothing.
    Eof,
}

/// A start tag.
pub(crate) struct Tag<'a> {
    content: &'a str,
    name_bytes: usize,
}

impl Tag<'_> {
    /// The element's name without its prefix.
    pub(crate) fn local_name(&self) -> &str {
        without_prefix(&self.content[..self.name_bytes])
    }

    /// An attribute's value, by its name without prefix.
    pub(crate) fn attribute(&self, name: &str) -> Option<String> {
        let start = BytesStart::from_content(self.content, self.name_bytes);
        let mut attributes = start.attributes();
        let attribute = attributes.with_checks(false).flatten().find(|a| a.key.local_name().as_ref() == name)?;
        // a value with an unknown entity stays as it is written
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).unwrap_or_else(|_| attribute.value.clone());
        Some(value.into_owned())
    }
}

fn without_prefix(name: &str) -> &str {
    name.split_once(':').map_or(name, |(_, local)| local)
}

impl<'n, R: BufRead> Xml<'n, R> {
    /// Begins to read a file.
    pub(crate) fn new(name: &'n Path, content: R) -> Result<Self, IoError> {
        let text = Text::new(content).map_err(|e| IoError::malformed(name, "line 1", "text", e.to_string()))?;
        let mut reader = Reader::from_reader(text);
        reader.config_mut().expand_empty_elements = true;
        reader.config_mut().allow_dangling_amp = true;
        Ok(Self { name, reader, buffer: Vec::new(), tag: String::new(), text: String::new(), depth: 0 })
    }

    /// The file.
    pub(super) fn name(&self) -> &'n Path {
        self.name
    }

    /// The next start or end of an element.
    pub(crate) fn next(&mut self) -> Result<Node<'_>, IoError> {
        self.text.clear();
        self.tag.clear();
        loop {
            self.buffer.clear();
            self.reader.get_mut().begin_token();
            let line = self.reader.get_ref().line();
            // text goes on over comments and the like; tags end it
            match self.reader.read_event_into(&mut self.buffer) {
                Ok(Event::Text(part)) => self.text.push_str(&part),
                Ok(Event::CData(part)) => self.text.push_str(&part),
                Ok(Event::GeneralRef(reference)) => match (reference.resolve_char_ref(), &*reference) {
                    (Ok(Some(character)), _) => self.text.push(character),
                    (_, name) => self.text.push_str(resolve_predefined_entity(name).unwrap_or("?")),
                },
                Ok(Event::Start(start)) => {
                    self.tag.push_str(&start);
                    let name_bytes = start.name().as_ref().len();
                    self.depth += 1;
                    if self.depth > MAX_DEPTH {
                        let found = format!("more than {MAX_DEPTH}");
                        return Err(self.bad(line, format!("at most {MAX_DEPTH} elements inside each other"), found));
                    }
                    return Ok(Node::Start(Tag { content: &self.tag, name_bytes }, line));
                }
                Ok(Event::End(end)) => {
                    self.tag.push_str(without_prefix(end.name().as_ref()));
                    self.depth = self.depth.saturating_sub(1);
                    return Ok(Node::End(&self.tag, &self.text, line));
                }
                Ok(Event::Eof) if self.depth == 0 => return Ok(Node::Eof),
                Ok(Event::Eof) => return Err(self.bad(line, "the ends of all elements", "the end of the file")),
                Ok(_) => {}
                Err(e) => return Err(self.bad(line, "well-formed XML", e)),
            }
        }
    }

    /// An error at a line.
    pub(super) fn bad(&self, line: u64, expected: impl Into<String>, found: impl Display) -> IoError {
        IoError::malformed(self.name, format!("line {line}"), expected, found.to_string())
    }
}
