//! Answers: what all have in common, conditions (`If-None-Match`, `If-Range`), ranges, and errors in the asker's form.

use crate::fault::Fault;
use crate::range::{Wanted, wanted};
use axum::body::Body;
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Response, StatusCode};
use std::ops::Range;

/// An answer.
pub(crate) type Reply = Response<Body>;

/// Marks an answer with an error's status that is told as it should be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Finished;

/// What is sent whole: its kind, its bytes, how long it may be kept, and a tag that changes with it.
#[derive(Debug, Clone)]
pub(crate) struct Content {
    pub(crate) kind: &'static str,
    pub(crate) bytes: bytes::Bytes,
    pub(crate) cache: &'static str,
    pub(crate) tag: String,
}

/// To be asked for again each time, which costs little where nothing changed.
pub(crate) const ASK_AGAIN: &str = "no-cache";
/// Tiles and pictures of a surface that may be another at the next start.
pub(crate) const AN_HOUR: &str = "public, max-age=3600";

impl Content {
    /// With a tag of its bytes.
    pub(crate) fn new(kind: &'static str, bytes: impl Into<bytes::Bytes>, cache: &'static str) -> Self {
        let bytes = bytes.into();
        let tag = tag_of(&bytes);
        Self { kind, bytes, cache, tag }
    }

    /// The answer to a request with these headers.
    pub(crate) fn reply(self, asked: &HeaderMap) -> Reply {
        if is_known(asked, &self.tag) {
            return not_modified(&self.tag, self.cache);
        }
        let mut reply = Response::new(Body::from(self.bytes));
        put(&mut reply, header::CONTENT_TYPE, self.kind);
        put(&mut reply, header::CACHE_CONTROL, self.cache);
        put(&mut reply, header::ETAG, &self.tag);
        reply
    }
}

/// A tag of some bytes.
pub(crate) fn tag_of(bytes: &[u8]) -> String {
    use std::hash::{DefaultHasher, Hasher};
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    format!("\"{:016x}-{}\"", hasher.finish(), bytes.len())
}

/// Sets a header; a value that cannot be one is left out.
pub(crate) fn put(reply: &mut Reply, name: HeaderName, value: &str) {
    if let Ok(value) = HeaderValue::from_str(value) {
        reply.headers_mut().insert(name, value);
    }
}

/// A header as text.
pub(crate) fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    headers.get(name).and_then(|value| value.to_str().ok())
}

/// Whether the asker has what bears this tag.
pub(crate) fn is_known(asked: &HeaderMap, tag: &str) -> bool {
    let tags = text(asked, header::IF_NONE_MATCH).unwrap_or_default();
    tags.split(',').map(str::trim).any(|known| known == "*" || known.strip_prefix("W/").unwrap_or(known) == tag)
}

/// That the asker has it already.
pub(crate) fn not_modified(tag: &str, cache: &str) -> Reply {
    let mut reply = Response::new(Body::empty());
    *reply.status_mut() = StatusCode::NOT_MODIFIED;
    put(&mut reply, header::ETAG, tag);
    put(&mut reply, header::CACHE_CONTROL, cache);
    reply
}

/// The range asked for of something of so many bytes that bears a tag; all of it where the asker knows another one.
pub(crate) fn range_of(asked: &HeaderMap, tag: &str, length: u64) -> Wanted {
    if text(asked, header::IF_RANGE).is_some_and(|known| known != tag) {
        return Wanted::Whole;
    }
    wanted(text(asked, header::RANGE), length)
}

/// A head for a range, or for all, of something of so many bytes.
pub(crate) fn ranged(body: Body, kind: &str, tag: &str, part: Option<Range<u64>>, length: u64) -> Reply {
    let mut reply = Response::new(body);
    let sent = part.clone().unwrap_or(0..length);
    if let Some(part) = part {
        *reply.status_mut() = StatusCode::PARTIAL_CONTENT;
        let place = format!("bytes {}-{}/{length}", part.start, part.end - 1);
        put(&mut reply, header::CONTENT_RANGE, &place);
    }
    put(&mut reply, header::CONTENT_TYPE, kind);
    put(&mut reply, header::CONTENT_LENGTH, &(sent.end - sent.start).to_string());
    put(&mut reply, header::ACCEPT_RANGES, "bytes");
    put(&mut reply, header::ETAG, tag);
    put(&mut reply, header::CACHE_CONTROL, ASK_AGAIN);
    reply
}

/// That the range asked for is not there.
pub(crate) fn no_such_range(length: u64) -> Reply {
    let mut reply =
        of_fault(&Fault::new(StatusCode::RANGE_NOT_SATISFIABLE, format!("there are {length} bytes")), false);
    put(&mut reply, header::CONTENT_RANGE, &format!("bytes */{length}"));
    reply
}

/// A fault: JSON for programs, a plain page for people.
pub(crate) fn of_fault(fault: &Fault, as_page: bool) -> Reply {
    let (kind, body) = if as_page {
        ("text/html; charset=utf-8", crate::pages::fault(fault))
    } else {
        ("application/json", serde_json::json!({ "error": fault.line }).to_string())
    };
    let mut reply = Response::new(Body::from(body));
    *reply.status_mut() = fault.status;
    reply.extensions_mut().insert(Finished);
    put(&mut reply, header::CONTENT_TYPE, kind);
    put(&mut reply, header::CACHE_CONTROL, "no-store");
    if fault.status == StatusCode::SERVICE_UNAVAILABLE {
        put(&mut reply, header::RETRY_AFTER, "2");
    }
    reply
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(name: HeaderName, value: &'static str) -> HeaderMap {
        HeaderMap::from_iter([(name, HeaderValue::from_static(value))])
    }

    #[test]
    fn tags_are_compared_as_lists() {
        let known = |value| is_known(&asked(header::IF_NONE_MATCH, value), "\"b\"");
        assert!(known("\"b\"") && known("\"a\", W/\"b\"") && known("*") && !known("\"c\"") && !known("b"));
    }

    #[test]
    fn an_old_tag_gets_the_whole() {
        let mut headers = asked(header::RANGE, "bytes=1-2");
        assert_eq!(range_of(&headers, "\"b\"", 9), Wanted::Part(1..3));
        headers.insert(header::IF_RANGE, HeaderValue::from_static("\"a\""));
        assert_eq!(range_of(&headers, "\"b\"", 9), Wanted::Whole);
        headers.insert(header::IF_RANGE, HeaderValue::from_static("\"b\""));
        assert_eq!(range_of(&headers, "\"b\"", 9), Wanted::Part(1..3));
    }
}
