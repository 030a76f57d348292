//! Models under k-disk wavelets.

mod model;
mod plots;
mod study;

pub use model::SemiRegularModel;
pub use plots::write_wavelet_plots;
pub use study::{
    Approximation, Fullness, KEPT_SHARES, WaveletRow, WaveletStudy, paper_fullness, usual_thresholds_m, wavelet_study,
};
