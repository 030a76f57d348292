//! Accepting connections so that no number of them, and none that is slow, keeps others out.
//!
//! So many are open at once. When there is no room, the one that has been idle longest is closed for the newcomer; only
//! when all are being answered is the newcomer told to come again. What is slow to ask is closed by a timer, as is what
//! is slow to listen.

use crate::limits::Limits;
use crate::stall::Stalling;
use axum::Router;
use axum::body::Body;
use axum::http::Request;
use hyper::body::{Frame, Incoming, SizeHint};
use hyper_util::rt::{TokioIo, TokioTimer};
use std::collections::HashMap;
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Notify;
use tower::ServiceExt;

/// How long a connection that is not being answered may take to close.
const IDLE_CLOSE: Duration = Duration::from_millis(500);
/// Pause when the system can give no more connections.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);

const BUSY: &[u8] = b"HTTP/1.1 503 Service Unavailable\r\ncontent-type: application/json\r\nretry-after: 2\r\n\
    connection: close\r\ncontent-length: 34\r\n\r\n{\"error\":\"too many connections\"}\r\n";

/// One connection as others see it.
#[derive(Debug)]
struct Place {
    /// Answers under way.
    answering: AtomicUsize,
    idle_since: Mutex<Instant>,
    close: Notify,
}

/// All connections.
#[derive(Debug, Default)]
struct Table {
    places: Mutex<Places>,
    emptied: Notify,
}

#[derive(Debug, Default)]
struct Places {
    next: u64,
    open: HashMap<u64, Arc<Place>>,
    /// Asked to close, and not closed yet.
    leaving: usize,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // nothing in here leaves half a change behind
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Table {
    /// A place for one more connection, if need be that of an idle one.
    fn admit(&self, most: usize) -> Option<(u64, Arc<Place>)> {
        let mut places = lock(&self.places);
        if places.open.len() >= most {
            let idle = places.open.iter().filter(|(_, place)| place.answering.load(Ordering::Acquire) == 0);
            let (&oldest, _) = idle.min_by_key(|(_, place)| *lock(&place.idle_since))?;
            if let Some(place) = places.open.remove(&oldest) {
                place.close.notify_one();
                places.leaving += 1;
            }
        }
        let number = places.next;
        places.next += 1;
        let place = Arc::new(Place {
            answering: AtomicUsize::new(0),
            idle_since: Mutex::new(Instant::now()),
            close: Notify::new(),
        });
        places.open.insert(number, place.clone());
        Some((number, place))
    }

    fn leave(&self, number: u64) {
        let mut places = lock(&self.places);
        if places.open.remove(&number).is_none() {
            places.leaving -= 1;
        }
        if places.open.is_empty() && places.leaving == 0 {
            self.emptied.notify_one();
        }
    }

    fn is_empty(&self) -> bool {
        let places = lock(&self.places);
        places.open.is_empty() && places.leaving == 0
    }

    fn close_all(&self) {
        lock(&self.places).open.values().for_each(|place| place.close.notify_one());
    }
}

/// Serves until `stop`, then lets what is being answered finish within a limit.
pub(crate) async fn run(listener: TcpListener, router: Router, limits: Limits, stop: impl Future<Output = ()>) {
    let table = Arc::new(Table::default());
    let mut stop = pin!(stop);
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = &mut stop => break,
        };
        let Ok((stream, _)) = accepted else {
            // out of handles, or the other side is gone again
            tokio::time::sleep(ACCEPT_PAUSE).await;
            continue;
        };
        let Some((number, place)) = table.admit(limits.connections) else {
            let _ = stream.try_write(BUSY);
            continue;
        };
        let (table, router, limits) = (table.clone(), router.clone(), limits.clone());
        tokio::spawn(async move {
            converse(stream, &place, router, &limits).await;
            table.leave(number);
        });
    }
    drop(listener);
    table.close_all();
    let all_left = async {
        while !table.is_empty() {
            table.emptied.notified().await;
        }
    };
    // what does not finish in time is cut off with the runtime
    let _ = tokio::time::timeout(limits.stop_time, all_left).await;
}

/// Answers what comes over one connection.
async fn converse(stream: TcpStream, place: &Arc<Place>, router: Router, limits: &Limits) {
    // answers are written whole or in large pieces
    let _ = stream.set_nodelay(true);
    let service = hyper::service::service_fn(move |request: Request<Incoming>| {
        let answering = Answering::begin(place);
        let router = router.clone();
        async move {
            let reply = router.oneshot(request.map(Body::new)).await;
            reply.map(|reply| reply.map(|body| Body::new(Watched { body, answering })))
        }
    });
    let mut connection = pin!(
        hyper::server::conn::http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(limits.head_time)
            .max_buf_size(limits.head_bytes)
            .serve_connection(TokioIo::new(Stalling::new(stream, limits.stall_time)), service)
    );
    tokio::select! {
        // errors are the other side's: it went away, or spoke no HTTP
        _ = &mut connection => return,
        () = place.close.notified() => {}
    }
    connection.as_mut().graceful_shutdown();
    let is_answering = place.answering.load(Ordering::Acquire) > 0;
    let patience = if is_answering { limits.stop_time } else { IDLE_CLOSE };
    let _ = tokio::time::timeout(patience, connection).await;
}

/// As long as it lives, its connection is being answered.
struct Answering(Arc<Place>);

impl Answering {
    fn begin(place: &Arc<Place>) -> Self {
        place.answering.fetch_add(1, Ordering::AcqRel);
        Self(place.clone())
    }
}

impl Drop for Answering {
    fn drop(&mut self) {
        *lock(&self.0.idle_since) = Instant::now();
        self.0.answering.fetch_sub(1, Ordering::AcqRel);
    }
}

/// A body that keeps its connection from being taken for idle.
struct Watched {
    body: Body,
    #[expect(dead_code, reason = "lives as long as the body")]
    answering: Answering,
}

impl hyper::body::Body for Watched {
    type Data = bytes::Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Self::Data>, Self::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
