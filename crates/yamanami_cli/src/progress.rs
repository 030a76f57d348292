//! Progress and notes on stderr: bars only where stderr is a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::Write;
use std::time::Duration;

/// Steps of a bar that shows shares.
const STEPS: u64 = 1000;

/// A bar for one long job; it goes away when dropped.
#[derive(Debug)]
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// A bar of a share from 0 to 1.
    pub(crate) fn shares(job: impl Into<String>) -> Self {
        Self::new(job, STEPS, "{msg:12} {bar:32} {percent:>3} % {elapsed}")
    }

    /// A bar of so many steps.
    pub(crate) fn steps(job: impl Into<String>, steps: usize) -> Self {
        Self::new(job, steps as u64, "{msg:12} {bar:32} {pos}/{len} {elapsed}")
    }

    /// For a job of unknown length.
    pub(crate) fn spinner(job: impl Into<String>) -> Self {
        let bar = ProgressBar::new_spinner().with_message(job.into());
        bar.enable_steady_tick(Duration::from_millis(120));
        Self(bar)
    }

    fn new(job: impl Into<String>, length: u64, template: &str) -> Self {
        let bar = ProgressBar::new(length).with_message(job.into());
        // the templates above are correct; a bar of the usual look would do as well
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self(bar)
    }

    pub(crate) fn set_share(&self, share: f32) {
        self.0.set_position((share.clamp(0.0, 1.0) * STEPS as f32) as u64);
    }

    pub(crate) fn set_step(&self, step: usize) {
        self.0.set_position(step as u64);
    }

    pub(crate) fn set_job(&self, job: &str) {
        self.0.set_message(job.to_owned());
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// A line on stderr. Where even that cannot be written, there is nobody left to tell.
pub(crate) fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}
