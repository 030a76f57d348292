//! Oriented boxes and what of a sheet is taken: no name lies over another.
//!
//! Two convex shapes are apart if and only if an axis along one of their sides keeps them apart (separating axes; see
//! Gottschalk, Lin, Manocha, "OBBTree", 1996).

use glam::DVec2;

/// A rectangle, turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrientedBox {
    /// Its centre, pixels.
    pub centre: DVec2,
    /// Half its length and half its height, pixels.
    pub half: DVec2,
    /// Turned clockwise on the picture, radians.
    pub angle_rad: f64,
}

impl OrientedBox {
    /// An upright box by its upper left corner and size.
    pub(crate) fn upright(corner: DVec2, size: DVec2) -> Self {
        Self { centre: corner + 0.5 * size, half: 0.5 * size, angle_rad: 0.0 }
    }

    /// A straight line of some width.
    pub(crate) fn along(from: DVec2, to: DVec2, width: f64) -> Self {
        let d = to - from;
        Self { centre: 0.5 * (from + to), half: DVec2::new(0.5 * d.length(), 0.5 * width), angle_rad: d.y.atan2(d.x) }
    }

    /// The same with this much more on all sides.
    pub(crate) fn grown(self, by: f64) -> Self {
        Self { half: self.half + DVec2::splat(by), ..self }
    }

    /// Its corners in order.
    pub fn corners(&self) -> [DVec2; 4] {
        let along = DVec2::from_angle(self.angle_rad);
        let (x, y) = (along * self.half.x, along.perp() * self.half.y);
        [-x - y, x - y, x + y, y - x].map(|corner| self.centre + corner)
    }

    /// Whether the two have a point in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        let apart = other.centre - self.centre;
        if apart.length_squared() > (self.half.length() + other.half.length()).powi(2) {
            return false;
        }
        let (a, b) = (DVec2::from_angle(self.angle_rad), DVec2::from_angle(other.angle_rad));
        let reach = |of: &Self, along: DVec2, axis: DVec2| {
            of.half.x * along.dot(axis).abs() + of.half.y * along.perp().dot(axis).abs()
        };
        [a, a.perp(), b, b.perp()]
            .into_iter()
            .all(|axis| apart.dot(axis).abs() < reach(self, a, axis) + reach(other, b, axis))
    }
}

/// The boxes that are taken, within a picture.
#[derive(Debug, Clone)]
pub(crate) struct Taken {
    size_px: DVec2,
    margin_px: f64,
    boxes: Vec<OrientedBox>,
}

impl Taken {
    /// Nothing taken yet; nothing may come nearer to the picture's edge than the margin.
    pub(crate) fn of_picture(size_px: [u32; 2], margin_px: f64) -> Self {
        Self { size_px: DVec2::new(f64::from(size_px[0]), f64::from(size_px[1])), margin_px, boxes: Vec::new() }
    }

    pub(crate) fn is_inside(&self, wanted: &OrientedBox) -> bool {
        let (low, high) = (DVec2::splat(self.margin_px), self.size_px - self.margin_px);
        wanted.corners().iter().all(|c| c.cmpge(low).all() && c.cmple(high).all())
    }

    /// Whether a box lies inside the picture and over no other.
    pub(crate) fn is_free(&self, wanted: &OrientedBox) -> bool {
        self.is_inside(wanted) && !self.boxes.iter().any(|b| b.overlaps(wanted))
    }

    pub(crate) fn take(&mut self, taken: OrientedBox) {
        self.boxes.push(taken);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_overlap_when_they_do() {
        let flat = OrientedBox::upright(DVec2::ZERO, DVec2::new(10.0, 2.0));
        let turned = |x: f64| OrientedBox { centre: DVec2::new(x, 1.0), half: DVec2::new(3.0, 1.0), angle_rad: 0.8 };
        assert!(flat.overlaps(&flat) && flat.overlaps(&turned(10.5)) && !flat.overlaps(&turned(13.5)));
        // neither's own sides tell these apart, the other's do
        let diamond = OrientedBox { centre: DVec2::new(11.2, 3.2), half: DVec2::ONE, angle_rad: 0.785 };
        assert!(!flat.overlaps(&diamond));
        let inside = Taken::of_picture([20, 20], 1.0);
        assert!(
            inside.is_free(&OrientedBox { centre: DVec2::splat(9.0), ..turned(0.0) }) && !inside.is_free(&turned(9.0))
        );
    }
}
