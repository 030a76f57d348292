//! What disks of different widths do to a model: compression, accuracy and time, by wavelet.
//!
//! Based on: Date, Kanai, Kishinami: data compression rate (9), accuracy (10) and (11), non-zeros (13).

use super::SemiRegularModel;
use crate::Error;
use glam::DVec3;
use std::time::Instant;
use yamanami_core::{SemiRegular, TriangleMesh};
use yamanami_measure::{Displacement, SurfaceDistance, displacement, surface_distance};
use yamanami_multires::kdisk::{Lifting, Wavelet, filters, keep_largest, l2_norm, largest_cosine};
use yamanami_multires::semi_regular::{close, thresholded};

/// Filters are written out, to be counted, on the finest level with at most so many vertices.
const MOST_COUNTED: u32 = 20_000;
/// Times are the best of so many runs.
const RUNS: usize = 5;
/// Most samples of a surface distance, each way.
const SAMPLES: usize = 40_000;
/// Shares of the details that are kept, the largest first.
pub const KEPT_SHARES: [f64; 5] = [0.5, 0.2, 0.1, 0.05, 0.02];

/// What an approximation keeps and loses.
#[derive(Debug, Clone, Copy)]
pub struct Approximation {
    /// Details up to this long were left out, metres; none where they were chosen otherwise.
    pub threshold_m: Option<f64>,
    /// Vertices kept: those of the base mesh, and those whose details were.
    pub vertices: u32,
    /// Vertices of the mesh without cracks: with all that those need.
    pub closed_vertices: u32,
    /// Data compression rate C_r, equation (9), per cent.
    pub compression_percent: f64,
    /// Equations (10) and (11), and more.
    pub moved: Displacement,
    /// Two-sided distance between the mesh without cracks and the source, by samples; not measured at thresholds.
    pub surface: Option<SurfaceDistance>,
    /// The displacement's L2 norm, all triangles taken as equal in area, metres: what the wavelets are made to keep small.
    pub l2_m: f64,
}

/// What is not zero in the synthesis filter Q of a level: a mean, and the most frequent count.
#[derive(Debug, Clone, Copy)]
pub struct Fullness {
    /// The level.
    pub level: u32,
    /// In the rows of coarse vertices, n_I.
    pub coarse: [f64; 2],
    /// In the rows of new vertices, n_N.
    pub new: [f64; 2],
}

/// What is known of one wavelet on a model.
#[derive(Debug, Clone)]
pub struct WaveletRow {
    /// The wavelet.
    pub wavelet: Wavelet,
    /// Time to prepare it for the mesh, seconds.
    pub setup_s: f64,
    /// Time of the analysis of all three coordinates, seconds.
    pub analysis_s: f64,
    /// Time of the synthesis, seconds.
    pub synthesis_s: f64,
    /// Largest error of synthesis after analysis, as a share of the model's diagonal.
    pub reconstruction: f64,
    /// How full the filters are; the orthogonal wavelet's are dense.
    pub fullness: Option<Fullness>,
    /// Largest cosine of a wavelet with a coarse hat function, on the same level and below.
    pub largest_cosine: Option<f64>,
    /// All details above the thresholds, one after the other.
    pub thresholds: Vec<Approximation>,
    /// The largest details by what leaving them out costs: [`KEPT_SHARES`].
    pub shares: Vec<Approximation>,
    /// All details up to level 0, 1, 2, … and none beyond.
    pub levels: Vec<Approximation>,
}

/// A model under all wavelets.
#[derive(Debug, Clone)]
pub struct WaveletStudy {
    /// The model's name.
    pub title: String,
    /// Levels of splits.
    pub split_levels: u32,
    /// Vertices of each level's mesh.
    pub vertices: Vec<u32>,
    /// Triangles of the base mesh.
    pub base_faces: usize,
    /// The model's bounding box diagonal, metres.
    pub diagonal_m: f64,
    /// Thresholds, metres.
    pub thresholds_m: Vec<f64>,
    /// The wavelets.
    pub rows: Vec<WaveletRow>,
}

impl WaveletStudy {
    /// The k-disk wavelets with their widths.
    pub fn disks(&self) -> impl Iterator<Item = (u32, &WaveletRow)> {
        self.rows.iter().filter_map(|row| match row.wavelet {
            Wavelet::KDisk(k) => Some((k, row)),
            _ => None,
        })
    }

    /// The numbers of the thresholds from where something is left out to where nothing is left.
    pub fn telling_thresholds(&self) -> impl Iterator<Item = usize> {
        let percent = |n: usize| self.rows.iter().map(move |row| row.thresholds[n].compression_percent);
        (0..self.thresholds_m.len()).filter(move |&n| percent(n).any(|p| p > 0.5) && percent(n).any(|p| p < 99.5))
    }
}

/// Thresholds that suit a model: four a decade, from a millionth of its diagonal to a tenth.
pub fn usual_thresholds_m(diagonal_m: f64) -> Vec<f64> {
    (0..=20).map(|i| diagonal_m * 10f64.powf(f64::from(i) / 4.0 - 6.0)).collect()
}

/// Measures a model under each wavelet. `progress` hears of the wavelet at work.
pub fn wavelet_study(
    model: &SemiRegularModel,
    wavelets: &[Wavelet],
    thresholds_m: &[f64],
    progress: &dyn Fn(&str),
) -> Result<WaveletStudy, Error> {
    let mesh = &model.mesh;
    let levels = mesh.levels();
    let source = model.to_mesh();
    let diagonal_m = source.bounds().diagonal();
    let rows = wavelets.iter().map(|&wavelet| {
        progress(&wavelet.to_string());
        row(model, wavelet, &source, thresholds_m, diagonal_m)
    });
    Ok(WaveletStudy {
        title: model.title.clone(),
        split_levels: levels,
        vertices: (0..=levels).map(|level| mesh.vertex_count(level)).collect(),
        base_faces: mesh.base().triangles().len(),
        diagonal_m,
        thresholds_m: thresholds_m.to_vec(),
        rows: rows.collect::<Result<_, _>>()?,
    })
}

fn row(
    model: &SemiRegularModel,
    wavelet: Wavelet,
    source: &TriangleMesh,
    thresholds_m: &[f64],
    diagonal_m: f64,
) -> Result<WaveletRow, Error> {
    let mesh = &model.mesh;
    let started = Instant::now();
    let lifting = Lifting::new(mesh, wavelet);
    let setup_s = started.elapsed().as_secs_f64();
    let (mut analysis_s, mut synthesis_s) = (f64::INFINITY, f64::INFINITY);
    let (mut details, mut back) = (model.vectors(), model.vectors());
    for _ in 0..RUNS {
        details = model.vectors();
        let started = Instant::now();
        lifting.analyse_vectors(&mut details);
        analysis_s = analysis_s.min(started.elapsed().as_secs_f64());
        back.clone_from(&details);
        let started = Instant::now();
        lifting.synthesise_vectors(&mut back);
        synthesis_s = synthesis_s.min(started.elapsed().as_secs_f64());
    }
    let off = model.positions.iter().zip(&back).map(|(a, b)| (*a - DVec3::from_array(*b)).abs().max_element());
    let reconstruction = off.fold(0.0, f64::max) / diagonal_m;
    let stage = Stage { model, lifting: &lifting, details: &details, source };
    let lengths: Vec<f64> = details.iter().map(|d| DVec3::from_array(*d).length()).collect();
    let costs: Vec<f64> = lengths.iter().zip(lifting.norms(mesh)).map(|(length, norm)| length * norm).collect();
    let base = mesh.vertex_count(0) as usize;
    let above = |threshold_m: f64| {
        let keep: Vec<bool> = lengths.iter().enumerate().map(|(v, &l)| v < base || l > threshold_m).collect();
        Ok(Approximation { threshold_m: Some(threshold_m), ..stage.approximation(&keep, false)? })
    };
    let share = |share: &f64| {
        let count = (share * (lengths.len() - base) as f64) as usize;
        stage.approximation(&keep_largest(mesh, &costs, count), true)
    };
    let up_to = |level: u32| {
        let count = mesh.vertex_count(level) as usize;
        stage.approximation(&(0..lengths.len()).map(|v| v < count).collect::<Vec<_>>(), false)
    };
    let (fullness, largest_cosine) = of_filters(mesh, &lifting);
    Ok(WaveletRow {
        wavelet,
        setup_s,
        analysis_s,
        synthesis_s,
        reconstruction,
        fullness,
        largest_cosine,
        thresholds: thresholds_m.iter().map(|&t| above(t)).collect::<Result<_, Error>>()?,
        shares: KEPT_SHARES.iter().map(share).collect::<Result<_, _>>()?,
        levels: (0..mesh.levels()).map(up_to).collect::<Result<_, _>>()?,
    })
}

/// A model analysed by a wavelet.
struct Stage<'a> {
    model: &'a SemiRegularModel,
    lifting: &'a Lifting,
    details: &'a [[f64; 3]],
    source: &'a TriangleMesh,
}

impl Stage<'_> {
    fn approximation(&self, keep: &[bool], with_surface: bool) -> Result<Approximation, Error> {
        let SemiRegularModel { mesh, positions, .. } = self.model;
        let approximation = kept(self.lifting, self.details, keep);
        let off = |axis: usize| -> Vec<f64> {
            positions.iter().zip(&approximation).map(|(p, q)| q[axis] - p[axis]).collect()
        };
        let l2_m = (0..3).map(|axis| l2_norm(mesh, mesh.levels(), &off(axis)).powi(2)).sum::<f64>().sqrt();
        let vertices = keep.iter().filter(|&&k| k).count() as u32;
        let (closed_vertices, surface) = self.closed(keep, &approximation, with_surface)?;
        Ok(Approximation {
            threshold_m: None,
            vertices,
            closed_vertices,
            surface,
            compression_percent: 100.0 * (1.0 - f64::from(vertices) / positions.len() as f64),
            moved: displacement(&self.source.triangles, positions, &approximation),
            l2_m,
        })
    }

    /// Vertices of the mesh without cracks that has all kept details, and how far its surface is from the source.
    fn closed(
        &self,
        keep: &[bool],
        places_m: &[DVec3],
        with_surface: bool,
    ) -> Result<(u32, Option<SurfaceDistance>), Error> {
        let mesh = &self.model.mesh;
        if with_surface {
            let found = thresholded(mesh, keep, places_m)?;
            let distance = surface_distance(self.source, &found.mesh, SAMPLES.min(10 * places_m.len()), 1);
            return Ok((found.vertices.len() as u32, Some(distance)));
        }
        let mut keep = keep.to_vec();
        close(mesh, &mut keep)?;
        Ok((keep.iter().filter(|&&k| k).count() as u32, None))
    }
}

/// Places from the details that are kept.
pub(crate) fn kept(lifting: &Lifting, details: &[[f64; 3]], keep: &[bool]) -> Vec<DVec3> {
    let mut values: Vec<[f64; 3]> = details.iter().zip(keep).map(|(&d, &k)| if k { d } else { [0.0; 3] }).collect();
    lifting.synthesise_vectors(&mut values);
    values.into_iter().map(DVec3::from_array).collect()
}

fn of_filters(mesh: &SemiRegular, lifting: &Lifting) -> (Option<Fullness>, Option<f64>) {
    let counted = (0..mesh.levels()).rev().find(|&level| mesh.vertex_count(level + 1) <= MOST_COUNTED);
    let Some((level, found)) = counted.and_then(|level| Some((level, filters(mesh, lifting, level)?))) else {
        return (None, None);
    };
    let (coarse, new) = found.q.rows.split_at(mesh.vertex_count(level) as usize);
    let fullness = Fullness { level, coarse: mean_and_mode(coarse), new: mean_and_mode(new) };
    let cosine = |level| filters(mesh, lifting, level).map_or(0.0, |f| largest_cosine(mesh, &f, level));
    (Some(fullness), Some((0..=level).map(cosine).fold(0.0, f64::max)))
}

fn mean_and_mode(rows: &[Vec<(u32, f64)>]) -> [f64; 2] {
    let mut counts = std::collections::BTreeMap::new();
    rows.iter().for_each(|row| *counts.entry(row.len()).or_insert(0usize) += 1);
    let total: usize = counts.iter().map(|(length, times)| length * times).sum();
    let mode = counts.iter().max_by_key(|(_, times)| **times).map_or(0, |(length, _)| *length);
    [total as f64 / rows.len().max(1) as f64, mode as f64]
}

/// Equation (13): what is not zero in a row of Q on regular surroundings, for a coarse and for a new vertex.
pub fn paper_fullness(k: u32) -> [u64; 2] {
    let sum = |first: u64| (1..=u64::from(k)).map(|i| 6 * (first + 3 * i)).sum::<u64>();
    [6 + sum(1), 11 + sum(2)]
}
