//! Right-triangulated networks: triangles halved at the middle of their longest side.

pub mod band_mesh;
