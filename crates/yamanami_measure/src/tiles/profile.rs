//! The height along a side of a tile, and how far two of them gape.
//!
//! Both are linear between their vertices, so that the greatest distance lies at a vertex of either: it is found exactly,
//! T-vertices included.

/// Heights along a line, by place.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    /// Places along the line, rising, and heights in metres.
    points: Vec<[f64; 2]>,
}

/// How two sides of one line lie to each other.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Gap {
    /// Greatest vertical distance in metres where both are.
    pub max_m: f64,
    /// Where it is along the line.
    pub at: f64,
    /// Share of what was to be covered where only one is.
    pub uncovered: f64,
}

impl Profile {
    /// Of places and heights in any order. Of several vertices at one place the outermost stand.
    pub fn new(mut points: Vec<[f64; 2]>) -> Self {
        points.retain(|p| p.iter().all(|v| v.is_finite()));
        points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        points.dedup();
        Self { points }
    }

    /// The same heights at places that are scaled and then moved; the scale is positive.
    pub fn moved(&self, scale: f64, by: f64) -> Self {
        Self { points: self.points.iter().map(|&[place, height]| [place * scale + by, height]).collect() }
    }

    /// From the first place to the last; `None` where there is nothing.
    pub fn range(&self) -> Option<[f64; 2]> {
        Some([self.points.first()?[0], self.points.last()?[0]])
    }

    /// Bytes it takes, about.
    pub fn size_bytes(&self) -> usize {
        16 * self.points.len()
    }

    /// Least and greatest height at a place; the same but where vertices stand above each other.
    fn at(&self, place: f64) -> Option<[f64; 2]> {
        let after = self.points.partition_point(|p| p[0] < place);
        let same = self.points[after..].iter().take_while(|p| p[0] == place);
        let here = same.fold(None, |found: Option<[f64; 2]>, p| {
            Some(found.map_or([p[1]; 2], |[low, high]| [low.min(p[1]), high.max(p[1])]))
        });
        here.or_else(|| {
            let (a, b) = (self.points.get(after.checked_sub(1)?)?, self.points.get(after)?);
            Some([a[1] + (b[1] - a[1]) * (place - a[0]) / (b[0] - a[0]); 2])
        })
    }

    /// Holds two sides against each other from `start` to `end`, which both should cover.
    pub fn gap(&self, other: &Self, [start, end]: [f64; 2]) -> Gap {
        let mut gap = Gap::default();
        let within = |p: &&[f64; 2]| p[0] >= start && p[0] <= end;
        let places = self.points.iter().filter(within).chain(other.points.iter().filter(within)).map(|p| p[0]);
        for place in places.chain([start, end]) {
            if let (Some(a), Some(b)) = (self.at(place), other.at(place)) {
                let apart = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
                if apart > gap.max_m {
                    (gap.max_m, gap.at) = (apart, place);
                }
            }
        }
        let common = |p: &Self| p.range().map_or([start, start], |[a, b]| [a.clamp(start, end), b.clamp(start, end)]);
        let (a, b) = (common(self), common(other));
        let both = (a[1].min(b[1]) - a[0].max(b[0])).max(0.0);
        gap.uncovered = if end > start { 1.0 - both / (end - start) } else { 0.0 };
        gap
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_t_vertex_gapes() {
        let coarse = Profile::new(vec![[0.0, 10.0], [4.0, 30.0]]);
        let fine = Profile::new(vec![[2.0, 21.5], [0.0, 10.0], [4.0, 30.0]]);
        let gap = coarse.gap(&fine, [0.0, 4.0]);
        assert_eq!((gap.max_m, gap.at, gap.uncovered), (1.5, 2.0, 0.0));
        assert_eq!(fine.gap(&coarse, [0.0, 4.0]), gap);
        assert_eq!(coarse.gap(&coarse, [1.0, 2.0]), Gap::default());
    }

    #[test]
    fn what_only_one_has_is_uncovered() {
        let half = Profile::new(vec![[0.0, 1.0], [2.0, 1.0]]);
        let all = Profile::new(vec![[0.0, 1.0], [4.0, 1.0]]);
        assert_eq!(half.gap(&all, [0.0, 4.0]).uncovered, 0.5);
        assert_eq!(Profile::default().gap(&all, [0.0, 4.0]).uncovered, 1.0);
    }
}
