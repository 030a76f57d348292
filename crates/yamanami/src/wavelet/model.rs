//! A model or terrain as a semi-regular mesh: recognised in its file, remeshed, or laid over a grid.

use crate::Error;
use glam::DVec3;
use yamanami_core::{BaseFault, BaseMesh, HeightField, SemiRegular, TriangleMesh};
use yamanami_multires::remesh::{RemeshOptions, RemeshReport, Remeshed, remesh};
use yamanami_multires::semi_regular::recognise;

/// A semi-regular mesh with the places of its vertices.
#[derive(Debug, Clone)]
pub struct SemiRegularModel {
    /// Name for tables and pictures.
    pub title: String,
    /// The topology.
    pub mesh: SemiRegular,
    /// Places of the vertices in level order, metres.
    pub positions: Vec<DVec3>,
    /// Their colours (sRGB and alpha), or empty.
    pub colours: Vec<[u8; 4]>,
}

impl SemiRegularModel {
    /// A mesh that has the levels already; none where it has not, and must be remeshed first. Fails where it is no
    /// surface.
    pub fn recognised(mesh: &TriangleMesh, title: String) -> Result<Option<Self>, Error> {
        let found = recognise(mesh)?;
        let of_source = &found.source_vertex;
        let positions = of_source.iter().map(|&v| mesh.positions[v as usize]).collect();
        let colours = of_source.iter().filter_map(|&v| mesh.colours.get(v as usize).copied()).collect();
        Ok((found.mesh.levels() > 0).then_some(Self { title, mesh: found.mesh, positions, colours }))
    }

    /// Any surface, remeshed: see [`remesh`].
    pub fn remeshed(
        mesh: &TriangleMesh,
        title: String,
        options: &RemeshOptions<'_>,
    ) -> Result<(Self, RemeshReport), Error> {
        let Remeshed { topology, positions, colours, report, .. } = remesh(mesh, options)?;
        Ok((Self { title, mesh: topology, positions, colours }, report))
    }

    /// A grid of heights: two base triangles a square of `2^levels` steps, as many levels as fit, cut at the right and below to whole
    /// squares.
    pub fn of_heights(field: &HeightField, title: String) -> Result<Self, Error> {
        let steps = [field.width() - 1, field.height() - 1];
        let levels = steps[0].min(steps[1]).max(1).ilog2();
        let [columns, rows] = steps.map(|n| (n >> levels) as u32);
        let at = |x: u32, y: u32| y * (columns + 1) + x;
        let squares = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
        // rows run south: counter-clockwise from above
        let triangles = squares.flat_map(|[x, y]| {
            let [a, b, c, d] = [at(x, y), at(x, y + 1), at(x + 1, y + 1), at(x + 1, y)];
            [[a, b, c], [a, c, d]]
        });
        let base = BaseMesh::new((columns + 1) * (rows + 1), triangles.collect()).map_err(too_large)?;
        let mesh = SemiRegular::new(base, levels).map_err(too_large)?;
        let size = 1i64 << levels;
        let mut positions = vec![DVec3::ZERO; mesh.vertex_count(levels) as usize];
        let grid = |v: u32| [i64::from(v % (columns + 1)), i64::from(v / (columns + 1))];
        for (face, corners) in (0u32..).zip(mesh.base().triangles()) {
            let [p, q, r] = corners.map(grid);
            for b in 0..=size {
                for a in 0..=size - b {
                    let [x, y] = [0, 1].map(|k| p[k] * size + a * (q[k] - p[k]) + b * (r[k] - p[k]));
                    let height_m = field.at(x as usize, y as usize);
                    if height_m.is_nan() {
                        return Err(Error::Request(format!(
                            "{title}: no data at column {x}, row {y}; wavelets need heights everywhere"
                        )));
                    }
                    let [x_m, y_m] = field.geo().local_from_grid(x as f64, y as f64);
                    let vertex = mesh.vertex(levels, face, [a as u32, b as u32]);
                    positions[vertex as usize] = DVec3::new(x_m, y_m, f64::from(height_m));
                }
            }
        }
        Ok(Self { title, mesh, positions, colours: Vec::new() })
    }

    /// Its finest mesh, vertices in level order.
    pub fn to_mesh(&self) -> TriangleMesh {
        let triangles = self.mesh.triangles(self.mesh.levels());
        TriangleMesh { colours: self.colours.clone(), ..TriangleMesh::new(self.positions.clone(), triangles) }
    }

    /// The places as a wavelet takes them.
    pub(crate) fn vectors(&self) -> Vec<[f64; 3]> {
        self.positions.iter().map(|p| p.to_array()).collect()
    }
}

fn too_large(fault: BaseFault) -> Error {
    Error::Request(format!("the grid is too large for a semi-regular mesh ({fault:?})"))
}
