//! Text of any encoding as UTF-8, piece by piece: what a byte order mark or an XML declaration states, else UTF-8. Bytes
//! that are wrong in it become replacement characters: a name that is spoilt is no reason to refuse the numbers.

use encoding_rs::{Decoder, Encoding, SHIFT_JIS, UTF_8, UTF_16BE, UTF_16LE};
use std::io::{BufRead, Cursor, Read};

/// How much of a file is looked at for its encoding.
const HEAD_BYTES: usize = 1024;
/// Most bytes decoded at once.
const PIECE_BYTES: usize = 1 << 16;
/// Most bytes of one tag or one text between tags.
const MAX_TOKEN_BYTES: u64 = 64 << 20;

/// A file's text, with the line that is being read.
pub(super) struct Text<R> {
    bytes: std::io::Chain<Cursor<Vec<u8>>, R>,
    decoder: Option<Decoder>,
    /// Decoded text; what lies between `start` and `end` was not read yet.
    piece: Vec<u8>,
    start: usize,
    end: usize,
    line: u64,
    token_bytes: u64,
}

impl<R: BufRead> Text<R> {
    /// Looks at the beginning of the file.
    pub(super) fn new(mut bytes: R) -> std::io::Result<Self> {
        let mut head = Vec::new();
        bytes.by_ref().take(HEAD_BYTES as u64).read_to_end(&mut head)?;
        let decoder = Some(encoding_of(&head).new_decoder_with_bom_removal());
        let bytes = Cursor::new(head).chain(bytes);
        Ok(Self { bytes, decoder, piece: Vec::new(), start: 0, end: 0, line: 1, token_bytes: 0 })
    }

    /// The line that is being read, from 1.
    pub(super) fn line(&self) -> u64 {
        self.line
    }

    /// Begins a new token: its length is counted from here.
    pub(super) fn begin_token(&mut self) {
        self.token_bytes = 0;
    }
}

fn encoding_of(head: &[u8]) -> &'static Encoding {
    if let Some((encoding, _)) = Encoding::for_bom(head) {
        return encoding;
    }
    match head {
        [b'<', 0, ..] => return UTF_16LE,
        [0, b'<', ..] => return UTF_16BE,
        _ => {}
    }
    let head = String::from_utf8_lossy(head);
    let declaration = head.trim_start().strip_prefix("<?xml").and_then(|rest| rest.split("?>").next());
    let stated = declaration.and_then(|text| text.split_once("encoding")).map(|(_, rest)| rest);
    let label = stated.and_then(|rest| rest.trim_start_matches(['=', ' ', '"', '\'']).split(['"', '\'']).next());
    match label.unwrap_or_default().to_ascii_lowercase().as_str() {
        "cp932" | "ms-kanji" => SHIFT_JIS,
        // a declaration that can be read byte by byte is not in UTF-16
        label => Encoding::for_label(label.as_bytes()).filter(|e| e.is_ascii_compatible()).unwrap_or(UTF_8),
    }
}

impl<R: BufRead> BufRead for Text<R> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        if self.token_bytes > MAX_TOKEN_BYTES {
            let why = format!("a tag or a text of more than {MAX_TOKEN_BYTES} bytes");
            return Err(std::io::Error::new(std::io::ErrorKind::InvalidData, why));
        }
        while self.start == self.end {
            let Some(decoder) = &mut self.decoder else { break };
            let source = self.bytes.fill_buf()?;
            let source = &source[..source.len().min(PIECE_BYTES)];
            let last = source.is_empty();
            // room for a character and a replacement of each byte
            self.piece.resize(self.piece.len().max(4 * source.len() + 64), 0);
            let (_, read, written, _) = decoder.decode_to_utf8(source, &mut self.piece, last);
            (self.start, self.end) = (0, written);
            self.bytes.consume(read);
            if last {
                self.decoder = None;
            }
        }
        Ok(&self.piece[self.start..self.end])
    }

    fn consume(&mut self, count: usize) {
        let taken = &self.piece[self.start..self.start + count];
        self.line += taken.iter().filter(|&&b| b == b'\n').count() as u64;
        self.start += count;
        self.token_bytes += count as u64;
    }
}

impl<R: BufRead> Read for Text<R> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let count = self.fill_buf()?.read(out)?;
        self.consume(count);
        Ok(count)
    }
}
