//! Work for the processor, apart from the threads that talk: so many at once, and so many waiting.

use crate::fault::Fault;
use std::sync::Arc;
use tokio::sync::Semaphore;

/// Where work is done.
#[derive(Debug, Clone)]
pub(crate) struct Work {
    running: Arc<Semaphore>,
    waiting: Arc<Semaphore>,
}

impl Work {
    /// `at_once` jobs run, `waiting` more may wait for their turn.
    pub(crate) fn new(at_once: usize, waiting: usize) -> Self {
        Self { running: Arc::new(Semaphore::new(at_once)), waiting: Arc::new(Semaphore::new(at_once + waiting)) }
    }

    /// Does a job; refuses where too many wait already. One that panics is a fault and nothing more.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        job: impl FnOnce() -> Result<T, Fault> + Send + 'static,
    ) -> Result<T, Fault> {
        let place = self.waiting.clone().try_acquire_owned().map_err(|_| Fault::busy())?;
        let turn = self.running.clone().acquire_owned().await.map_err(|_| Fault::internal())?;
        let done = tokio::task::spawn_blocking(move || {
            // kept to the end of the job, even when nobody waits for it any more
            let _held = (place, turn);
            job()
        });
        done.await.unwrap_or_else(|_| Err(Fault::internal()))
    }

    /// The same for the next piece of an answer that has begun: it waits as long as it takes.
    pub(crate) async fn go_on<T: Send + 'static>(
        &self,
        job: impl FnOnce() -> Result<T, Fault> + Send + 'static,
    ) -> Result<T, Fault> {
        let turn = self.running.clone().acquire_owned().await.map_err(|_| Fault::internal())?;
        let done = tokio::task::spawn_blocking(move || {
            let _held = turn;
            job()
        });
        done.await.unwrap_or_else(|_| Err(Fault::internal()))
    }
}
