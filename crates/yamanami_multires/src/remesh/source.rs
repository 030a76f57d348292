//! The surface that is remeshed: its triangles with their neighbours, its normals, and places on it.

use super::density;
use crate::MultiresError;
use crate::semi_regular::{not_a_surface, renumbered};
use glam::DVec3;
use yamanami_core::{Aabb, BaseFault, BaseMesh, TriangleMesh};

/// Across a border.
pub(super) const NONE: u32 = u32::MAX;

/// A point of the source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Its triangle.
    pub(super) triangle: u32,
    /// Barycentric coordinates in it: none negative, their sum 1.
    pub(super) shares: [f64; 3],
}

impl Place {
    /// A corner of a triangle.
    pub(super) fn corner(triangle: u32, corner: usize) -> Self {
        Self { triangle, shares: std::array::from_fn(|k| f64::from(u8::from(k == corner))) }
    }
}

/// A sound surface.
#[derive(Debug)]
pub(super) struct Source {
    /// About the middle of their box, in diagonals of it.
    pub(super) positions: Vec<DVec3>,
    centre: DVec3,
    diagonal_m: f64,
    pub(super) surface: BaseMesh,
    /// Across side k of each triangle the other triangle and its side, as `triangle << 2 | side`.
    across: Vec<[u32; 3]>,
    /// Unit vertex normals.
    pub(super) normals: Vec<DVec3>,
    /// How dense the net should be at the vertices, beside other places.
    densities: Vec<f64>,
    /// Colours, or empty.
    pub(super) colours: Vec<[u8; 4]>,
}

impl Source {
    /// Takes what triangles use of a mesh; triangles with a repeated corner are passed over.
    pub(super) fn new(mesh: &TriangleMesh) -> Result<Self, MultiresError> {
        let vertices = mesh.positions.len();
        let mut number = vec![NONE; vertices];
        let mut kept = Vec::new();
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        for (triangle, &corners) in mesh.triangles.iter().enumerate() {
            for v in corners {
                if mesh.positions.get(v as usize).is_none_or(|p| !p.is_finite()) {
                    return Err(MultiresError::BadCorner { triangle, vertex: v, vertices });
                }
            }
            let [a, b, c] = corners;
            if a == b || b == c || c == a {
                continue;
            }
            triangles.push(corners.map(|v| {
                let number = &mut number[v as usize];
                if *number == NONE {
                    *number = kept.len() as u32;
                    kept.push(v);
                }
                *number
            }));
        }
        if triangles.is_empty() {
            return Err(MultiresError::NoTriangles { triangles: mesh.triangles.len() });
        }
        if triangles.len() >= 1 << 30 {
            return Err(MultiresError::TooLargeToRemesh { triangles: triangles.len() });
        }
        let mut bounds = Aabb::EMPTY;
        kept.iter().for_each(|&v| bounds.include(mesh.positions[v as usize]));
        let (centre, diagonal_m) = (bounds.min * 0.5 + bounds.max * 0.5, bounds.diagonal());
        if !(diagonal_m > 0.0 && diagonal_m.is_finite() && (1.0 / diagonal_m).is_finite()) {
            return Err(MultiresError::NoTriangles { triangles: mesh.triangles.len() });
        }
        let unit = |&v: &u32| (mesh.positions[v as usize] - centre) / diagonal_m;
        let positions: Vec<DVec3> = kept.iter().map(unit).collect();
        let surface = BaseMesh::new(positions.len() as u32, triangles)
            .map_err(|fault| not_a_surface(renumbered(fault, |v| kept[v as usize]), mesh))?;
        let colours = if mesh.colours.is_empty() {
            Vec::new()
        } else {
            kept.iter().map(|&v| mesh.colours.get(v as usize).copied().unwrap_or([0, 0, 0, 255])).collect()
        };
        Ok(Self { centre, diagonal_m, colours, ..Self::of(positions, surface) })
    }

    /// A surface with its neighbours and normals.
    fn of(positions: Vec<DVec3>, surface: BaseMesh) -> Self {
        let across = (0..surface.triangles().len() as u32)
            .map(|t| [0, 1, 2].map(|side| surface.beyond(t, side).map_or(NONE, |(o, k)| o << 2 | u32::from(k))))
            .collect();
        let normals = vertex_normals(&positions, surface.triangles());
        let densities = density::densities(&positions, &normals, surface.triangles());
        let colours = Vec::new();
        Self { positions, centre: DVec3::ZERO, diagonal_m: 1.0, surface, across, normals, densities, colours }
    }

    /// A coarser surface on some of the vertices, and the number here of each of its triangles. Triangles whose first corner is
    /// [`NONE`] are left out.
    pub(super) fn coarser(&self, triangles: &[[u32; 3]]) -> Result<(Self, Vec<u32>), BaseFault> {
        let mut number = vec![NONE; self.positions.len()];
        let (mut positions, mut numbers, mut corners) = (Vec::new(), Vec::new(), Vec::new());
        for (t, triangle) in triangles.iter().enumerate().filter(|(_, t)| t[0] != NONE) {
            numbers.push(t as u32);
            corners.push(triangle.map(|v| {
                let number = &mut number[v as usize];
                if *number == NONE {
                    *number = positions.len() as u32;
                    positions.push(self.positions[v as usize]);
                }
                *number
            }));
        }
        let surface = BaseMesh::new(positions.len() as u32, corners)?;
        Ok((Self::of(positions, surface), numbers))
    }

    /// Length of the diagonal of the box around it, metres.
    pub(super) fn diagonal_m(&self) -> f64 {
        self.diagonal_m
    }

    /// A position in metres.
    pub(super) fn metres(&self, position: DVec3) -> DVec3 {
        position * self.diagonal_m + self.centre
    }

    /// Corners of all triangles.
    #[inline]
    pub(super) fn triangles(&self) -> &[[u32; 3]] {
        self.surface.triangles()
    }

    /// The triangle and side across a side.
    #[inline]
    pub(super) fn across(&self, triangle: u32, side: usize) -> Option<(u32, usize)> {
        let other = self.across[triangle as usize][side];
        (other != NONE).then_some((other >> 2, (other & 3) as usize))
    }

    /// Corner positions of a triangle.
    #[inline]
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles()[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// Where a place is.
    pub(super) fn position(&self, place: Place) -> DVec3 {
        blend(self.corners(place.triangle), place.shares)
    }

    /// The unit normal at a place, blended from those of the corners.
    pub(super) fn normal(&self, place: Place) -> DVec3 {
        let normals = self.triangles()[place.triangle as usize].map(|v| self.normals[v as usize]);
        blend(normals, place.shares).normalize_or_zero()
    }

    /// How dense the net should be at a place: lengths that it measures are this times as long.
    pub(super) fn density(&self, place: Place) -> f64 {
        let own = self.triangles()[place.triangle as usize].map(|v| self.densities[v as usize]);
        (0..3).map(|k| own[k] * place.shares[k]).sum()
    }

    /// The colour at a place.
    pub(super) fn colour(&self, place: Place) -> [u8; 4] {
        let colours = self.triangles()[place.triangle as usize].map(|v| self.colours[v as usize]);
        std::array::from_fn(|channel| {
            let sum: f64 = (0..3).map(|k| f64::from(colours[k][channel]) * place.shares[k]).sum();
            sum.round().clamp(0.0, 255.0) as u8
        })
    }
}

/// A sum of three with shares.
#[inline]
pub(super) fn blend([a, b, c]: [DVec3; 3], [u, v, w]: [f64; 3]) -> DVec3 {
    a * u + b * v + c * w
}

/// Unit normals of vertices: those of the triangles around, weighted by their area.
pub(super) fn vertex_normals(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; positions.len()];
    for &t in triangles {
        let [a, b, c] = t.map(|v| positions[v as usize]);
        let twice_area = (b - a).cross(c - a);
        for v in t {
            normals[v as usize] += twice_area;
        }
    }
    normals.iter().map(|n| n.normalize_or_zero()).collect()
}
