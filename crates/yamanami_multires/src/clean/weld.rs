//! Vertices that become one: those at equal positions, or within a distance of each other.

use super::keep_vertices;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use yamanami_core::TriangleMesh;

/// For each vertex the first of those at its position.
pub(super) fn places(mesh: &TriangleMesh) -> Vec<u32> {
    first_alike(mesh, |_, _| true)
}

/// Merges vertices and gives how many are gone. Of several the first stays where it is; normals become their mean.
pub(super) fn weld(mesh: &mut TriangleMesh, distance_m: f64, across_seams: bool) -> usize {
    let alike = |a: u32, b: u32| {
        let (a, b) = (a as usize, b as usize);
        across_seams || (mesh.colours.get(a) == mesh.colours.get(b) && mesh.texcoords.get(a) == mesh.texcoords.get(b))
    };
    let first = if distance_m > 0.0 { first_near(mesh, distance_m, alike) } else { first_alike(mesh, alike) };
    for i in mesh.triangles.iter_mut().flatten() {
        *i = first[*i as usize];
    }
    if !mesh.normals.is_empty() {
        let mut sums = mesh.normals.clone();
        for (i, &first) in first.iter().enumerate().filter(|&(i, &first)| first as usize != i) {
            let sum = &mut sums[first as usize];
            *sum = std::array::from_fn(|k| sum[k] + mesh.normals[i][k]);
        }
        for (normal, sum) in mesh.normals.iter_mut().zip(sums) {
            // opposite ones have no mean
            if *normal != sum
                && let Some(mean) = glam::Vec3::from(sum).try_normalize()
            {
                *normal = mean.to_array();
            }
        }
    }
    let keep: Vec<bool> = first.iter().enumerate().map(|(i, &first)| first as usize == i).collect();
    keep_vertices(mesh, &keep);
    keep.iter().filter(|&&k| !k).count()
}

/// For each vertex the first at the same position that is alike.
fn first_alike(mesh: &TriangleMesh, alike: impl Fn(u32, u32) -> bool) -> Vec<u32> {
    let bits = |i: u32| (mesh.positions[i as usize] + DVec3::ZERO).to_array().map(f64::to_bits); // -0 and 0 are equal
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&i| (bits(i), i));
    let mut first_of = vec![0; order.len()];
    let mut firsts: Vec<u32> = Vec::new();
    for run in order.chunk_by(|&a, &b| bits(a) == bits(b)) {
        firsts.clear();
        for &i in run {
            let first = firsts.iter().copied().find(|&first| alike(first, i));
            first_of[i as usize] = first.unwrap_or(i);
            if first.is_none() {
                firsts.push(i);
            }
        }
    }
    first_of
}

/// No vertex.
const NONE: u32 = u32::MAX;

/// For each vertex the first kept one within a distance that is alike; one without stays itself. The kept ones of a cell
/// of that width are few, because they are that far apart.
fn first_near(mesh: &TriangleMesh, distance_m: f64, alike: impl Fn(u32, u32) -> bool) -> Vec<u32> {
    let cell = |p: DVec3| (p / distance_m).floor().to_array().map(|c| c as i64);
    let mut latest: HashMap<[i64; 3], u32> = HashMap::new();
    let mut before = vec![NONE; mesh.positions.len()];
    let mut first_of = Vec::with_capacity(mesh.positions.len());
    for (i, &p) in (0u32..).zip(&mesh.positions) {
        let here = cell(p);
        let mut found = NONE;
        for k in 0..27 {
            let around = [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1];
            let there = [0, 1, 2].map(|axis| here[axis].saturating_add(around[axis]));
            let mut candidate = latest.get(&there).copied().unwrap_or(NONE);
            while candidate != NONE {
                let near = mesh.positions[candidate as usize].distance_squared(p) <= distance_m * distance_m;
                if candidate < found && near && alike(candidate, i) {
                    found = candidate;
                }
                candidate = before[candidate as usize];
            }
        }
        if found == NONE {
            found = i;
            before[i as usize] = latest.insert(here, i).unwrap_or(NONE);
        }
        first_of.push(found);
    }
    first_of
}
