//! Times of drawing, and of following a map that changes.

use super::super::{HoriDraw, HoriFlight, HoriFound};
use super::texts;
use crate::Error;
use crate::page::{Page, count, write_csv};
use std::path::Path;

pub(super) fn write(found: &HoriFound, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(3, "Times of drawing");
    page.text(
        "Drawn by the processor without a graphics driver, colours from a picture of the ground, one sample a pixel; the median \
         of 5 runs. The paper: 6.4 s in full, 0.4 s reduced, 1/16. Its two times lie on a line of 0.28 s and 1.5 µs a polygon, so \
         that most of its 0.4 s was no polygon's.",
    );
    let slowest = found.draws.first().map_or(0.0, |draw| draw.draw_ms);
    let cells = |draw: &HoriDraw| {
        vec![
            draw.name.to_owned(),
            count(draw.triangles),
            format!("{:.0}", draw.draw_ms),
            format!("1/{:.1}", slowest / draw.draw_ms.max(1e-9)),
        ]
    };
    page.table(texts(["mesh", "triangles", "time (ms)", "ratio"]), found.draws.iter().map(cells).collect());
    let csv: Vec<_> = found
        .draws
        .iter()
        .map(|draw| vec![format!("\"{}\"", draw.name), draw.triangles.to_string(), format!("{:.3}", draw.draw_ms)])
        .collect();
    write_csv(&out.join("draw_times.csv"), "mesh,triangles,draw_ms", &csv)?;
    page.heading(3, "Times of updates by differences");
    page.text(
        "The paper makes its mesh anew for each map. The engine goes from one front to the next: α from 0 to 0.3 in 60 frames \
         while the eye moves 2.7 km. An update finds the new front and changes the mesh in memory.",
    );
    let flight = |flight: &HoriFlight| {
        let [mean_ms, worst_ms] = flight.update_ms;
        let [mean_bytes, most_bytes] = flight.bytes;
        let [fewest, most] = flight.triangles;
        vec![
            flight.name.to_owned(),
            format!("{} to {}", count(fewest as u64), count(most as u64)),
            format!("{mean_ms:.1}"),
            format!("{worst_ms:.1}"),
            count(flight.refined.round() as u64),
            count(flight.coarsened.round() as u64),
            format!("{:.0} / {:.0}", mean_bytes / 1e3, most_bytes / 1e3),
            format!("{:.2}", flight.bound_px),
        ]
    };
    page.table(
        texts([
            "asked for",
            "triangles",
            "update, mean (ms)",
            "worst (ms)",
            "refined a frame",
            "coarsened a frame",
            "bytes, mean / most (kB)",
            "promised (px)",
        ]),
        found.flights.iter().map(flight).collect(),
    );
    Ok(())
}
