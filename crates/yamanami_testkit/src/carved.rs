//! Two models of the kind that Date, Kanai, Kishinami try their wavelets on: an octahedron split again and again, within ±10.

use crate::models::sphere;
use glam::DVec3;
use yamanami_core::TriangleMesh;

/// What a carved ball is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relief {
    /// Broad swells.
    Smooth,
    /// A cube with rounded corners, grooves with steep sides and a raised band.
    Sharp,
}

/// A carved ball within ±10, of 8 · 4^`splits` triangles: 2,048 of them, with 1,026 vertices, for four splits.
pub fn carved(splits: u32, relief: Relief) -> TriangleMesh {
    let mut mesh = sphere(splits);
    for p in &mut mesh.positions {
        *p *= match relief {
            Relief::Smooth => smooth(*p),
            Relief::Sharp => sharp(*p),
        };
    }
    mesh
}

fn smooth(p: DVec3) -> f64 {
    7.5 + (2.3 * p.x + 0.4).sin() * (3.1 * p.y).cos()
        + 0.8 * (4.0 * p.z + p.x).sin()
        + 0.5 * (5.0 * p.x * p.y - 2.0 * p.z).cos()
}

fn sharp(p: DVec3) -> f64 {
    let cube = 6.4 / p.abs().max_element();
    let radius = cube.min(8.6);
    let band = if p.z.abs() < 0.22 { 0.6 } else { 0.0 };
    let groove = if (7.0 * p.y.atan2(p.x)).sin() > 0.55 && p.z.abs() > 0.3 { 0.9 } else { 0.0 };
    radius + band - groove
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_have_the_paper_s_size() {
        for relief in [Relief::Smooth, Relief::Sharp] {
            let mesh = carved(4, relief);
            assert_eq!((mesh.positions.len(), mesh.triangles.len()), (1026, 2048));
            let bounds = mesh.bounds();
            assert!(bounds.min.min_element() > -10.0 && bounds.max.max_element() < 10.0);
            assert!(bounds.min.max_element() < -5.0 && bounds.max.min_element() > 5.0);
        }
    }
}
