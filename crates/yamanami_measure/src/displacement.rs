//! How far an approximation with the same triangles has moved from its source: the measures E_MS and E_MA.
//!
//! Based on: Date, Kanai, Kishinami, equations (10) and (11).

use glam::DVec3;

/// Means over a mesh, metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Displacement {
    /// E_MS, equation (10): mean signed distance of the vertices along the source's normals. Hollows and bumps cancel.
    pub signed_mean_m: f64,
    /// The same without signs.
    pub normal_mean_m: f64,
    /// E_MA, equation (11): mean displacement of all vertices and triangle centroids.
    pub mean_m: f64,
    /// Root of the mean squared displacement of the vertices.
    pub rms_m: f64,
    /// Largest displacement of a vertex.
    pub max_m: f64,
}

/// Measures the places `approximation` against the places `source` of the same vertices.
///
/// # Panics
/// When both do not have the same length, or a triangle names another vertex.
pub fn displacement(triangles: &[[u32; 3]], source: &[DVec3], approximation: &[DVec3]) -> Displacement {
    assert_eq!(source.len(), approximation.len(), "places of the same vertices");
    let mut normals = vec![DVec3::ZERO; source.len()];
    let mut centroids = 0.0;
    for corners in triangles {
        let [a, b, c] = corners.map(|v| source[v as usize]);
        let area = (b - a).cross(c - a);
        corners.iter().for_each(|&v| normals[v as usize] += area);
        let moved = corners.map(|v| approximation[v as usize] - source[v as usize]);
        centroids += ((moved[0] + moved[1] + moved[2]) / 3.0).length();
    }
    let mut found = Displacement::default();
    let mut squares = 0.0;
    for ((&from, &to), normal) in source.iter().zip(approximation).zip(normals) {
        let moved = to - from;
        let along = moved.dot(normal.normalize_or_zero());
        found.signed_mean_m += along;
        found.normal_mean_m += along.abs();
        found.mean_m += moved.length();
        found.max_m = found.max_m.max(moved.length());
        squares += moved.length_squared();
    }
    let vertices = source.len().max(1) as f64;
    found.signed_mean_m /= vertices;
    found.normal_mean_m /= vertices;
    found.mean_m = (found.mean_m + centroids) / (source.len() + triangles.len()).max(1) as f64;
    found.rms_m = (squares / vertices).sqrt();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lifted_square_is_its_lift_off() {
        let source = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let lifted = source.map(|p| p + DVec3::new(0.0, 0.3, -0.4));
        let d = displacement(&triangles, &source, &lifted);
        assert!((d.signed_mean_m + 0.4).abs() < 1e-15 && (d.normal_mean_m - 0.4).abs() < 1e-15);
        assert!((d.mean_m - 0.5).abs() < 1e-15 && (d.rms_m - 0.5).abs() < 1e-15 && (d.max_m - 0.5).abs() < 1e-15);
        // one vertex of four, and the centroid that it shares in: 0.6 and twice 0.2 over six
        let mut one = source;
        one[0].z = 0.6;
        let d = displacement(&triangles, &source, &one);
        assert!((d.mean_m - 1.0 / 6.0).abs() < 1e-15 && (d.signed_mean_m - 0.15).abs() < 1e-15);
    }

    #[test]
    fn nothing_has_not_moved() {
        assert_eq!(displacement(&[], &[], &[]), Displacement::default());
    }
}
