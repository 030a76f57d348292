//! Units of length by their number in `$INSUNITS`.
//!
//! Based on: Autodesk, "DXF reference", 2018.

use yamanami_core::{FOOT_M, US_SURVEY_FOOT_M};

/// The number of the metre.
pub(super) const METRE: i64 = 6;

/// Number and metres. The metre and what surveys use come first.
const UNITS: [(i64, f64); 19] = [
    (METRE, 1.0),
    (2, FOOT_M),
    (21, US_SURVEY_FOOT_M),
    (4, 0.001),
    (5, 0.01),
    (7, 1000.0),
    (1, 0.0254),
    (3, 1609.344),
    (8, 0.0254e-6),
    (9, 0.0254e-3),
    (10, 0.9144),
    (13, 1e-6),
    (14, 0.1),
    (15, 10.0),
    (16, 100.0),
    (17, 1e9),
    (22, US_SURVEY_FOOT_M / 12.0),
    (23, US_SURVEY_FOOT_M * 3.0),
    (24, US_SURVEY_FOOT_M * 5280.0),
];

/// Metres in a unit; `None` for unitless drawings and units that no terrain comes in.
pub(super) fn metres(number: i64) -> Option<f64> {
    UNITS.iter().find(|(n, _)| *n == number).map(|(_, unit_m)| *unit_m)
}

/// The number of a unit, if it has one.
pub(super) fn number(unit_m: f64) -> Option<i64> {
    UNITS.iter().find(|(_, m)| *m == unit_m).map(|(n, _)| *n)
}
