//! Models under k-disk wavelets.

mod date;
mod date_page;
mod model;
mod plots;
mod shown;
mod study;

pub use date::{DateModel, date};
pub use model::SemiRegularModel;
pub use plots::write_wavelet_plots;
pub use shown::WaveletModel;
pub use study::{
    Approximation, Fullness, KEPT_SHARES, WaveletRow, WaveletStudy, paper_fullness, usual_thresholds_m, wavelet_study,
};
