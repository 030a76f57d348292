//! A terrain or a model on a canvas: the front follows the view, and the mesh follows the front.

use crate::{Canvas, Controller, Criteria, Error, FrameReport, PaperController, Staircase, Step, Subject, Upload};
use image::RgbaImage;
use std::time::Duration;
use web_time::Instant;
use yamanami_core::{ActiveSet, Surface, View};
use yamanami_gpu::{Morph, RenderOptions, wgpu};
use yamanami_lod::Front;

/// Most pages read from a database between two frames.
const PAGES_PER_FRAME: usize = 64;

/// Which control moves the front.
#[derive(Debug, Clone, PartialEq)]
pub enum Lod {
    /// The exact controller: largest error first, budget met in the same frame.
    Exact,
    /// The paper's staircase with proportional feedback.
    Paper(Staircase),
}

/// The control itself.
#[derive(Debug, Clone)]
enum Control {
    Exact(Box<Controller>),
    Paper(Box<PaperController>),
}

/// What an update of a scene cost.
#[derive(Debug, Clone)]
pub struct Update {
    /// What the controller did.
    pub report: FrameReport,
    /// Time to find the new front and bring the mesh in memory to it.
    pub update_time: Duration,
    /// Time to write the change to the GPU.
    pub upload_time: Duration,
    /// What was written.
    pub upload: Upload,
    /// Pages read from the database.
    pub pages: usize,
}

/// A terrain or a model being shown.
#[derive(Debug)]
pub struct Scene {
    control: Control,
    canvas: Canvas,
    /// Most bytes of pages kept in memory.
    pub memory_bytes: usize,
}

impl Scene {
    /// Shows the base mesh; the exact controller moves the front.
    pub fn new(subject: &impl Subject, canvas: Canvas) -> Self {
        let control = Control::Exact(Box::new(Controller::new(subject.surface())));
        Self::start(subject, canvas, control)
    }

    /// Shows the base mesh; the paper's staircase moves the front.
    pub fn with_staircase(subject: &impl Subject, canvas: Canvas, staircase: Staircase) -> Self {
        let control = Control::Paper(Box::new(PaperController::new(subject.surface(), staircase)));
        Self::start(subject, canvas, control)
    }

    fn start(subject: &impl Subject, mut canvas: Canvas, control: Control) -> Self {
        canvas.clear();
        subject.surface().emit_base(canvas.sink());
        Self { control, canvas, memory_bytes: 512 << 20 }
    }

    /// Goes back to the base mesh and goes on with this control, on the same canvas.
    pub fn restart(&mut self, subject: &impl Subject, lod: &Lod) {
        self.control = match lod {
            Lod::Exact => Control::Exact(Box::new(Controller::new(subject.surface()))),
            Lod::Paper(staircase) => {
                Control::Paper(Box::new(PaperController::new(subject.surface(), staircase.clone())))
            }
        };
        self.canvas.clear();
        subject.surface().emit_base(self.canvas.sink());
    }

    /// The paper's staircase as its feedback has moved it; `None` with the exact controller.
    pub fn staircase(&self) -> Option<&Staircase> {
        match &self.control {
            Control::Exact(_) => None,
            Control::Paper(c) => Some(c.staircase()),
        }
    }

    /// What is shown.
    pub fn front(&self) -> &Front {
        match &self.control {
            Control::Exact(c) => c.front(),
            Control::Paper(c) => c.front(),
        }
    }

    /// Where it is drawn.
    pub fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    /// Moves the front to the criteria and the mesh with it, by differences. Absent pages are read, up to a number a frame,
    /// and the front goes on with them in the same update.
    pub fn update(&mut self, subject: &mut impl Subject, criteria: &Criteria) -> Result<Update, Error> {
        let started = Instant::now();
        let mut report = self.step(subject, criteria);
        let mut pages = 0;
        // a page's nodes open the way to finer pages
        while pages < PAGES_PER_FRAME {
            let read = subject.load(&report.wanted, PAGES_PER_FRAME - pages)?;
            if read == 0 {
                break;
            }
            pages += read;
            let next = self.step(subject, criteria);
            report = FrameReport {
                refined: report.refined + next.refined,
                coarsened: report.coarsened + next.coarsened,
                weighed: report.weighed + next.weighed,
                ..next
            };
        }
        if pages > 0 {
            let front = match &self.control {
                Control::Exact(c) => c.front(),
                Control::Paper(c) => c.front(),
            };
            subject.shrink(self.memory_bytes, |node| front.is_active(node));
        }
        let update_time = started.elapsed();
        let started = Instant::now();
        let upload = self.canvas.flush()?;
        Ok(Update { report, update_time, upload_time: started.elapsed(), upload, pages })
    }

    fn step(&mut self, subject: &impl Subject, criteria: &Criteria) -> FrameReport {
        let surface = subject.surface();
        let sink = self.canvas.sink();
        let apply = |step: Step, front: &Front| match step {
            Step::Refine(node) => surface.refine(node, front, sink),
            Step::Coarsen(node) => surface.coarsen(node, front, sink),
        };
        match &mut self.control {
            Control::Exact(c) => c.update(surface, criteria, apply),
            Control::Paper(c) => c.update(surface, criteria, apply),
        }
    }

    /// The same front as [`Self::update`], meshed and uploaded from nothing, as a program without differences would. Only
    /// that is timed: finding the front is not, which favours the rebuild in comparisons.
    pub fn rebuild(&mut self, subject: &impl Subject, criteria: &Criteria) -> Result<Update, Error> {
        let surface = subject.surface();
        let report = match &mut self.control {
            Control::Exact(c) => c.update(surface, criteria, |_, _| ()),
            Control::Paper(c) => c.update(surface, criteria, |_, _| ()),
        };
        let started = Instant::now();
        self.canvas.clear();
        let front = match &self.control {
            Control::Exact(c) => c.front(),
            Control::Paper(c) => c.front(),
        };
        surface.emit_front(front, self.canvas.sink());
        let update_time = started.elapsed();
        let started = Instant::now();
        let upload = self.canvas.upload_all()?;
        Ok(Update { report, update_time, upload_time: started.elapsed(), upload, pages: 0 })
    }

    /// Draws what is shown.
    pub fn draw(&mut self, view: &View, options: &RenderOptions) -> Result<RgbaImage, Error> {
        self.canvas.draw(view, options)
    }

    /// Draws what is shown on a texture view of the view's size; see [`Canvas::draw_on`].
    pub fn draw_on(
        &mut self,
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        view: &View,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        self.canvas.draw_on(target, format, view, options)
    }
}

/// Geomorphing that suits an update: details fade in between the threshold in force and half as much again.
pub fn morph_of(report: &FrameReport) -> Morph {
    Morph { tau_px: report.threshold, width: 0.5 }
}
