//! Heights, places in metres and normals of vertices, read from the nested grids.

use super::diamonds::Place;
use glam::DVec3;
use yamanami_core::{FieldLevel, NestedField};

/// A nested field, read by lattice places.
#[derive(Debug, Clone)]
pub(super) struct Ground {
    field: NestedField,
    /// Half the finest spacing, metres.
    unit_m: f64,
}

impl Ground {
    pub(super) fn new(field: NestedField) -> Self {
        let finest = field.levels()[field.levels().len() - 1].spacing_m();
        Self { field, unit_m: 0.5 * finest }
    }

    pub(super) fn field(&self) -> &NestedField {
        &self.field
    }

    /// Metres in a unit of lattice places.
    #[inline]
    pub(super) fn unit_m(&self) -> f64 {
        self.unit_m
    }

    /// How many grids: their spacings are `2^k` units, k from 1 (the finest) on.
    #[inline]
    pub(super) fn grids(&self) -> u32 {
        self.field.levels().len() as u32
    }

    /// The grid of spacing `2^k` units.
    #[inline]
    pub(super) fn grid(&self, k: u32) -> &FieldLevel {
        &self.field.levels()[(self.grids() - k) as usize]
    }

    /// Height of a vertex in metres: its own lattice's grid has it; beyond the widest grid that of the nearest sample.
    #[inline]
    pub(super) fn height_m(&self, place: Place) -> f32 {
        let k = (place[0] | place[1]).trailing_zeros().clamp(1, self.grids());
        self.sample_m(place, k)
    }

    /// Height of the sample of spacing `2^k` nearest to a place.
    #[inline]
    fn sample_m(&self, place: Place, k: u32) -> f32 {
        let grid = self.grid(k);
        let half = grid.half() as i32;
        let [x, y] = place.map(|v| (v >> k).clamp(-half, half));
        grid.heights_m()[(half - y) as usize * grid.width() + (half + x) as usize]
    }

    /// A vertex in the plane and its height, metres.
    #[inline]
    pub(super) fn point(&self, place: Place) -> DVec3 {
        self.point_at(place, self.height_m(place))
    }

    /// A place with this height, metres.
    #[inline]
    pub(super) fn point_at(&self, [x, y]: Place, height_m: f32) -> DVec3 {
        DVec3::new(f64::from(x) * self.unit_m, f64::from(y) * self.unit_m, f64::from(height_m))
    }

    /// Unit normal at a vertex, from its neighbours in the finest grid that has all of them.
    pub(super) fn normal(&self, [x, y]: Place) -> [f32; 3] {
        let farthest = x.abs().max(y.abs());
        let has_all = |k: &u32| farthest < (self.grid(*k).half() as i32) << k;
        let k = (1..=self.grids()).find(has_all).unwrap_or(self.grids());
        let rise = |dx: i32, dy: i32| {
            let z = |s: i32| f64::from(self.sample_m([x + s * dx, y + s * dy], k));
            (z(1) - z(-1)) / (2.0 * self.grid(k).spacing_m())
        };
        DVec3::new(-rise(1 << k, 0), -rise(0, 1 << k), 1.0).normalize().as_vec3().to_array()
    }
}
