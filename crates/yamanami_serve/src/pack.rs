//! A packed surface by range, straight from its database.

use crate::fault::Fault;
use crate::range::Wanted;
use crate::reply::{self, ASK_AGAIN, Reply};
use crate::surface::Served;
use crate::work::Work;
use axum::body::Body;
use axum::http::HeaderMap;
use bytes::Bytes;
use futures_util::stream;
use std::ops::Range;
use std::sync::Arc;

/// Bytes read at once, about.
const PIECE_BYTES: u64 = 256 << 10;
const KIND: &str = "application/vnd.yamanami.pack";

/// Answers a request for the packed surface or a part of it.
pub(crate) async fn reply(work: &Work, served: &Arc<Served>, head: bool, asked: &HeaderMap) -> Result<Reply, Fault> {
    let (length, tag) = (served.source.bytes(), served.tag());
    if reply::is_known(asked, &tag) {
        return Ok(reply::not_modified(&tag, ASK_AGAIN));
    }
    let part = match reply::range_of(asked, &tag, length) {
        Wanted::Whole => None,
        Wanted::Part(range) => Some(range),
        Wanted::Nothing => return Ok(reply::no_such_range(length)),
    };
    let range = part.clone().unwrap_or(0..length);
    let body = if head { Body::empty() } else { body(work, served, range).await? };
    Ok(reply::ranged(body, KIND, &tag, part, length))
}

/// The first piece is read before the answer begins, so that what cannot be read is a fault; if a later one cannot be, the
/// connection breaks off, which whoever reads will notice.
async fn body(work: &Work, served: &Arc<Served>, range: Range<u64>) -> Result<Body, Fault> {
    let end = range.end;
    let first = piece(served, range.clone());
    let first = work.run(first).await?;
    let at = range.start + first.len() as u64;
    if at >= end {
        return Ok(Body::from(first));
    }
    let (work, served) = (work.clone(), served.clone());
    let rest = stream::try_unfold((Some(first), at), move |(ready, at)| {
        let (work, served) = (work.clone(), served.clone());
        async move {
            match ready {
                Some(bytes) => Ok(Some((bytes, (None, at)))),
                None if at >= end => Ok(None),
                None => {
                    let bytes = work.go_on(piece(&served, at..end)).await.map_err(|f| std::io::Error::other(f.line))?;
                    let next = at + bytes.len() as u64;
                    Ok::<_, std::io::Error>(Some((bytes, (None, next))))
                }
            }
        }
    });
    Ok(Body::from_stream(rest))
}

/// A job that reads the beginning of a range.
fn piece(served: &Arc<Served>, range: Range<u64>) -> impl FnOnce() -> Result<Bytes, Fault> + Send + 'static {
    let served = served.clone();
    move || {
        let bytes = served.source.read_piece(range, PIECE_BYTES).map_err(|e| served.unreadable(e))?;
        served.check()?;
        if bytes.is_empty() { Err(Fault::internal()) } else { Ok(Bytes::from(bytes)) }
    }
}
