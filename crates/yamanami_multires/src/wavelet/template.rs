//! Red–green templates: how a triangle is drawn for each subset of its midpoints.
//!
//! Based on: Bank, Sherman, Weiser, "Refinement algorithms and data structures for regular local mesh refinement",
//! 1983. Where two midpoints are active the hypotenuse is bisected first, which is what right-triangle bisection does.

/// The set of active midpoints as bits: 1 = h, 2 = p, 4 = q.
pub(crate) type Config = usize;

/// All three midpoints: the triangle is replaced by its children.
pub(crate) const ALL: Config = 7;

/// Corner roles (R, P, Q, h, p, q = 0..6) of each template's triangles, counter-clockwise; by configuration.
pub(crate) const TEMPLATES: [&[[usize; 3]]; 7] = [
    &[[0, 1, 2]],
    &[[0, 1, 3], [0, 3, 2]],
    &[[0, 4, 2], [4, 1, 2]],
    &[[0, 4, 3], [4, 1, 3], [0, 3, 2]],
    &[[0, 1, 5], [5, 1, 2]],
    &[[0, 1, 3], [0, 3, 5], [5, 3, 2]],
    &[[0, 4, 5], [4, 1, 5], [5, 1, 2]],
];
