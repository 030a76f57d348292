//! How much is allowed to whoever asks.

use std::time::Duration;

/// Limits of a server.
#[derive(Debug, Clone)]
pub struct Limits {
    /// Connections open at once.
    pub connections: usize,
    /// Bytes of a request's head.
    pub head_bytes: usize,
    /// Bytes of the path and query.
    pub url_bytes: usize,
    /// A request's head is there after so long, or the connection is closed.
    pub head_time: Duration,
    /// The first bytes of an answer are there after so long.
    pub request_time: Duration,
    /// Of an answer some bytes are taken within so long.
    pub stall_time: Duration,
    /// What is being answered when the server stops may take so long.
    pub stop_time: Duration,
    /// Jobs for the processor that wait for their turn.
    pub jobs_waiting: usize,
    /// Bytes of finished tiles kept.
    pub tile_bytes: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            connections: 512,
            head_bytes: 16 << 10,
            url_bytes: 2048,
            head_time: Duration::from_secs(15),
            request_time: Duration::from_secs(60),
            stall_time: Duration::from_secs(30),
            stop_time: Duration::from_secs(10),
            jobs_waiting: 64,
            tile_bytes: 32 << 20,
        }
    }
}
