//! No-data as holes with the outline that the grid gives them.
//!
//! All four samples of each cell that has both data and no-data become vertices. Then the cell's sides are edges of any
//! Delaunay triangulation (no sample lies in or on the circle over a side), so no triangle reaches from data across them
//! into no-data: those with data at their three corners are exactly the surface, and insertion never comes near a hole
//! again. A cell with data at three samples shows that half. Samples of no-data are vertices of hidden triangles only.

use super::net::{Net, Place};
use yamanami_core::HeightField;

pub(super) fn outline(net: &mut Net, field: &HeightField) {
    let is_void = |[column, row]: Place| field.at(column as usize, row as usize).is_nan();
    let mut outline = outline_samples(field);
    // coarse ones first, so that triangles stay fat and flips few; then row by row, so that walks are short
    outline.sort_by_key(|&[column, row]| (std::cmp::Reverse((column | row).trailing_zeros()), row, column));
    let mut last = 0;
    for p in outline {
        last = net.locate(last, p);
        net.insert(last, p);
    }
    for t in 0..net.triangle_count() {
        net.turn_diagonal(t, is_void);
    }
    net.changed.clear();
}

/// Samples of cells with data and no-data.
fn outline_samples(field: &HeightField) -> Vec<Place> {
    let (width, height) = (field.width(), field.height());
    let is_mixed = |column: usize, row: usize| {
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| field.at(column + dx, row + dy).is_nan());
        corners.contains(&true) && corners.contains(&false)
    };
    let mut is_outline = vec![false; width * height];
    for row in 0..height - 1 {
        for column in 0..width - 1 {
            if is_mixed(column, row) {
                let at = row * width + column;
                for sample in [at, at + 1, at + width, at + width + 1] {
                    is_outline[sample] = true;
                }
            }
        }
    }
    let places = (0..width * height).filter(|&i| is_outline[i]);
    places.map(|i| [(i % width) as i32, (i / width) as i32]).collect()
}
