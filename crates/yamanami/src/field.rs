//! The grid of heights behind an opened terrain, for measuring against.

use crate::{Data, Error, Terrain};
use yamanami_core::{HeightField, PAGE_CELLS, PageId};
use yamanami_multires::wavelet::TerrainData;

impl Terrain {
    /// The whole grid of heights; no-data where no triangle of the finest mesh touches a sample. From a database this
    /// reads its finest level.
    pub fn field(&self) -> Result<HeightField, Error> {
        let [width, height] = self.size();
        let mut heights_m = self.full_heights_m()?.to_vec();
        if self.surface().data().has_holes() {
            let touched = self.touched_samples()?;
            for (z, touched) in heights_m.iter_mut().zip(touched) {
                if !touched {
                    *z = f32::NAN;
                }
            }
        }
        Ok(HeightField::new(width, height, heights_m, self.geo().clone()))
    }

    /// Which samples are corners of a shown triangle of the finest mesh.
    fn touched_samples(&self) -> Result<Vec<bool>, Error> {
        let [width, height] = self.size();
        let mut touched = vec![false; width * height];
        let mut touch = |x: u32, y: u32, halves: u8| {
            let nw = y as usize * width + x as usize;
            if halves & 1 != 0 {
                [nw, nw + 1, nw + width + 1].into_iter().for_each(|i| touched[i] = true);
            }
            if halves & 2 != 0 {
                [nw, nw + width, nw + width + 1].into_iter().for_each(|i| touched[i] = true);
            }
        };
        match (self.surface().data(), self.store()) {
            (Data::Paged(_), Some(store)) => {
                let [pages_x, pages_y] = store.pages_at(0);
                for (py, px) in (0..pages_y).flat_map(|y| (0..pages_x).map(move |x| (y, x))) {
                    let page = store.page(PageId { level: 0, x: px, y: py })?;
                    let columns = page.width as usize - 1;
                    for (i, &halves) in page.shown.iter().enumerate() {
                        touch(px * PAGE_CELLS + (i % columns) as u32, py * PAGE_CELLS + (i / columns) as u32, halves);
                    }
                }
            }
            (data, _) => {
                for (y, x) in (0..height as u32 - 1).flat_map(|y| (0..width as u32 - 1).map(move |x| (y, x))) {
                    let half = |half| u8::from(data.shown(0, x, y, half)) << half;
                    touch(x, y, half(0) | half(1));
                }
            }
        }
        Ok(touched)
    }
}
