//! Inner products of piecewise linear functions on a level, all triangles taken as equal in area: the norm that the wavelets are made
//! for, and how near they come to being orthogonal.

use super::filters::Filters;
use yamanami_core::SemiRegular;

/// L2 norm of a function given at the vertices of a level's mesh, on a surface of unit area: the root of its mean square.
pub fn l2_norm(mesh: &SemiRegular, level: u32, values: &[f64]) -> f64 {
    let square: f64 = mesh.triangles(level).into_iter().map(|t| square_on(t.map(|v| values[v as usize]))).sum();
    (square / f64::from(mesh.triangle_count(level))).sqrt()
}

/// Mean square of a linear function over a triangle.
fn square_on([a, b, c]: [f64; 3]) -> f64 {
    (a * a + b * b + c * c + a * b + b * c + c * a) / 6.0
}

/// The largest cosine between a wavelet of a level and a hat function of its coarse vertices: 0 is orthogonal. Takes time and memory
/// for each non-zero of the filters.
pub fn largest_cosine(mesh: &SemiRegular, filters: &Filters, level: u32) -> f64 {
    let fine = level + 1;
    let mut neighbours = vec![Vec::new(); mesh.vertex_count(fine) as usize];
    for corners in mesh.triangles(fine) {
        for k in 0..3 {
            let of = &mut neighbours[corners[k] as usize];
            of.extend(corners.iter().enumerate().map(|(j, &v)| (v, if j == k { 2.0 } else { 1.0 })));
        }
    }
    let (hats, wavelets) =
        (filters.p.columns(mesh.vertex_count(level)), filters.q.columns(mesh.new_vertices(fine).len() as u32));
    let mut dense = vec![0.0; neighbours.len()];
    // a column's inner products with the fine hats, into `dense`; the places that are not zero
    let spread = |column: &[(u32, f64)], dense: &mut [f64]| -> Vec<u32> {
        let mut touched = Vec::new();
        for &(row, value) in column {
            for &(v, weight) in &neighbours[row as usize] {
                dense[v as usize] += weight * value;
                touched.push(v);
            }
        }
        touched
    };
    let mut norm = |column: &[(u32, f64)]| {
        let touched = spread(column, &mut dense);
        let square: f64 = column.iter().map(|&(row, value)| value * dense[row as usize]).sum();
        touched.into_iter().for_each(|v| dense[v as usize] = 0.0);
        square.sqrt()
    };
    let hat_norms: Vec<f64> = hats.iter().map(|column| norm(column)).collect();
    let wavelet_norms: Vec<f64> = wavelets.iter().map(|column| norm(column)).collect();
    let mut largest = 0.0f64;
    for (wavelet, wavelet_norm) in wavelets.iter().zip(wavelet_norms) {
        let touched = spread(wavelet, &mut dense);
        let mut with_hats = std::collections::BTreeMap::new();
        for &row in &touched {
            let product = std::mem::take(&mut dense[row as usize]);
            for &(hat, value) in &filters.p.rows[row as usize] {
                *with_hats.entry(hat).or_insert(0.0) += value * product;
            }
        }
        for (hat, product) in with_hats {
            let product: f64 = product;
            largest = largest.max(product.abs() / (wavelet_norm * hat_norms[hat as usize]));
        }
    }
    largest
}
