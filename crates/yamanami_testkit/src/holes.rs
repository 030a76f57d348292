//! Where a synthetic terrain has no data.

use crate::rng::{Rng, scramble, unit_from_bits};

/// A pattern of no-data, the same for equal sizes and seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Holes {
    /// Data everywhere.
    None,
    /// Discs of radius 1 sample up to an eighth of the shorter side, at random places.
    Discs {
        /// How many.
        count: usize,
        /// Where.
        seed: u64,
    },
    /// A frame of no-data all round, so many samples wide.
    Border {
        /// Width of the frame in samples.
        samples: usize,
    },
    /// Single samples at random.
    Speckle {
        /// Share of samples lost, 0…1.
        share: f64,
        /// Which.
        seed: u64,
    },
    /// Nothing but one sample.
    AllBut {
        /// Column of the sample with data.
        column: usize,
        /// Row of the sample with data.
        row: usize,
    },
    /// No data at all.
    All,
    /// Everything south-east of the line between the other two corners, so that the edge runs through squares.
    BeyondDiagonal,
}

/// A pattern laid out for one grid.
#[derive(Debug, Clone)]
pub(crate) struct HoleMap {
    holes: Holes,
    size: [usize; 2],
    /// Column, row and squared radius of each disc.
    discs: Vec<[f64; 3]>,
}

impl HoleMap {
    pub(crate) fn new(holes: Holes, size: [usize; 2]) -> Self {
        let mut discs = Vec::new();
        if let Holes::Discs { count, seed } = holes {
            let mut rng = Rng::new(seed);
            let largest = (size[0].min(size[1]) as f64 / 8.0).max(1.5);
            for _ in 0..count {
                let radius = 1.0 + rng.unit() * (largest - 1.0);
                discs.push([rng.unit() * size[0] as f64, rng.unit() * size[1] as f64, radius * radius]);
            }
        }
        Self { holes, size, discs }
    }

    pub(crate) fn punch_row(&self, row: usize, column: usize, out: &mut [f32]) {
        if self.holes == Holes::None {
            return;
        }
        for (column, z) in (column..).zip(out) {
            if self.is_hole(column, row) {
                *z = f32::NAN;
            }
        }
    }

    fn is_hole(&self, column: usize, row: usize) -> bool {
        let [width, height] = self.size;
        match self.holes {
            Holes::None => false,
            Holes::All => true,
            Holes::AllBut { column: c, row: r } => (column, row) != (c, r),
            Holes::Border { samples } => {
                column.min(width - 1 - column) < samples || row.min(height - 1 - row) < samples
            }
            Holes::BeyondDiagonal => column * height + row * width >= width * height,
            Holes::Speckle { share, seed } => {
                unit_from_bits(scramble(seed ^ scramble((row * width + column) as u64 + 1))) < share
            }
            Holes::Discs { .. } => self.discs.iter().any(|&[x, y, r2]| {
                let (dx, dy) = (column as f64 - x, row as f64 - y);
                dx * dx + dy * dy <= r2
            }),
        }
    }
}
