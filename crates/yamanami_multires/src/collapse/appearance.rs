//! What a mesh carries beside its shape, while it is collapsed: values that are blended, seams where they jump, materials.
//!
//! A vertex may look different from its sides (a texture's seam, a hard edge): each corner of a triangle names a *wedge*,
//! and a wedge has the values. After: Hoppe, "New Quadric Metric for Simplifying Meshes with Appearance Attributes", 1999.

use super::appearance_sum::{Scales, VALUES};
use super::stars::Corner;
use super::work::{GONE, third};
use std::ops::Range;
use yamanami_core::TriangleMesh;

/// Floats of each kind of value.
const COLOUR: usize = 4;
const TEXCOORD: usize = 2;
const NORMAL: usize = 3;

/// Values of wedges, wedges of corners, materials of triangles.
#[derive(Debug, Default)]
pub(super) struct Appearance {
    kinds: Kinds,
    /// Values of each wedge. Wedges are numbered as the vertices of the source.
    values: Vec<f32>,
    /// The wedge at each corner; empty where nothing is carried and no vertex looks different from its sides.
    wedges: Vec<[u32; 3]>,
    /// The material of each triangle, or empty.
    material_of: Vec<u16>,
}

/// Where the wedges of a part belong.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// Each wedge's number in the whole.
    names: Vec<u32>,
}

#[derive(Debug, Default, Clone, Copy)]
struct Kinds {
    colours: bool,
    texcoords: bool,
    normals: bool,
}

impl Kinds {
    fn stride(self) -> usize {
        COLOUR * usize::from(self.colours) + TEXCOORD * usize::from(self.texcoords) + NORMAL * usize::from(self.normals)
    }
}

impl Appearance {
    /// What `mesh` carries; `triangles` are those kept, by their number in it, and `wedge_of` gives each vertex's wedge.
    pub(super) fn new(mesh: &TriangleMesh, triangles: &[u32], wedge_of: impl Fn(u32) -> u32) -> Self {
        let n = mesh.positions.len();
        let kinds = Kinds {
            colours: mesh.colours.len() == n,
            texcoords: mesh.texcoords.len() == n,
            normals: mesh.normals.len() == n,
        };
        let mut values = Vec::with_capacity(n * kinds.stride());
        if kinds.stride() > 0 {
            for v in 0..n {
                if kinds.colours {
                    values.extend(mesh.colours[v].map(|c| f32::from(c) / 255.0));
                }
                if kinds.texcoords {
                    values.extend(mesh.texcoords[v]);
                }
                if kinds.normals {
                    values.extend(mesh.normals[v]);
                }
            }
        }
        let wedges = if kinds.stride() > 0 {
            triangles.iter().map(|&t| mesh.triangles[t as usize].map(&wedge_of)).collect()
        } else {
            Vec::new()
        };
        let material_of = if mesh.material_of.len() == mesh.triangles.len() {
            triangles.iter().map(|&t| mesh.material_of[t as usize]).collect()
        } else {
            Vec::new()
        };
        Self { kinds, values, wedges, material_of }
    }

    /// Whether two vertices of a mesh at one place look the same. Normals do not count: they follow the shape.
    pub(super) fn look_alike(mesh: &TriangleMesh, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        mesh.colours.get(a) == mesh.colours.get(b) && mesh.texcoords.get(a) == mesh.texcoords.get(b)
    }

    /// How much each value counts, in units of the work, when a unit of each kind is to count as so many of those; `None` when
    /// nothing that is carried counts.
    pub(super) fn scales(&self, normal: f64, colour: f64, texcoord: f64) -> Option<Scales> {
        let on = |has: bool, weight: f64| if has { weight as f32 } else { 0.0 };
        let [c, t, n] = [
            on(self.kinds.colours, colour),
            on(self.kinds.texcoords, texcoord),
            on(self.kinds.normals, normal),
        ];
        let scales = [c, c, c, t, t, n, n, n];
        scales.iter().any(|&s| s > 0.0).then_some(scales)
    }

    /// The values of a wedge that can be weighed; 0 for what is not carried.
    #[inline]
    pub(super) fn weighable(&self, wedge: u32) -> [f32; VALUES] {
        let mut out = [0.0; VALUES];
        let stride = self.kinds.stride();
        let mut values = &self.values[wedge as usize * stride..(wedge as usize + 1) * stride];
        // lengths that the compiler knows: this is asked for at every weighing
        if self.kinds.colours {
            out[..3].copy_from_slice(&values[..3]);
            values = &values[COLOUR..];
        }
        if self.kinds.texcoords {
            out[3..3 + TEXCOORD].copy_from_slice(&values[..TEXCOORD]);
            values = &values[TEXCOORD..];
        }
        if self.kinds.normals {
            out[5..5 + NORMAL].copy_from_slice(&values[..NORMAL]);
        }
        out
    }

    /// Gives a wedge the values that count.
    pub(super) fn set_weighable(&mut self, wedge: u32, values: &[f32; VALUES]) {
        let stride = self.kinds.stride();
        let mut own = &mut self.values[wedge as usize * stride..(wedge as usize + 1) * stride];
        if self.kinds.colours {
            own[..3].copy_from_slice(&values[..3]);
            own = &mut own[COLOUR..];
        }
        if self.kinds.texcoords {
            own[..TEXCOORD].copy_from_slice(&values[3..3 + TEXCOORD]);
            own = &mut own[TEXCOORD..];
        }
        if self.kinds.normals {
            own[..NORMAL].copy_from_slice(&values[5..5 + NORMAL]);
        }
    }

    /// The wedges of a triangle's corners in its turning order, the given one first.
    pub(super) fn turned_wedges(&self, corner: Corner) -> [u32; 3] {
        corner.turned(&self.wedges)
    }

    /// Whether parts can look different at all.
    pub(super) fn has_creases(&self) -> bool {
        !self.wedges.is_empty() || !self.material_of.is_empty()
    }

    /// Whether two neighbouring triangles differ in material, or in what they carry at `a` or `b`, their common vertices.
    pub(super) fn differ(&self, triangles: &[[u32; 3]], s: usize, t: usize, a: u32, b: u32) -> bool {
        if !self.material_of.is_empty() && self.material_of[s] != self.material_of[t] {
            return true;
        }
        !self.wedges.is_empty()
            && [a, b].into_iter().any(|v| self.wedge_at(triangles, s, v) != self.wedge_at(triangles, t, v))
    }

    fn wedge_at(&self, triangles: &[[u32; 3]], t: usize, vertex: u32) -> u32 {
        let place = triangles[t].iter().position(|&v| v == vertex).unwrap_or(0);
        self.wedges[t][place]
    }

    /// Blends the wedges of `goes` into those of `stays` across the triangles that have both, and gives the other corners
    /// of `goes` the wedge that theirs became. Called while the triangles still are as before.
    pub(super) fn merge(&mut self, star: &[Corner], triangles: &[[u32; 3]], goes: u32, stays: u32, share: f32) {
        if self.wedges.is_empty() {
            return;
        }
        let mut pairs = [(GONE, GONE); 2];
        let mut found = 0;
        for corner in star {
            let t = corner.triangle();
            if third(triangles[t], goes, stays).is_some() {
                let pair = (self.wedge_at(triangles, t, goes), self.wedge_at(triangles, t, stays));
                if found < 2 && !pairs[..found].contains(&pair) {
                    pairs[found] = pair;
                    found += 1;
                }
            }
        }
        let stride = self.kinds.stride();
        for (k, &(from, to)) in pairs[..found].iter().enumerate() {
            if share != 0.0 && from != to && pairs[..k].iter().all(|p| p.1 != to) {
                for i in 0..stride {
                    let goal = self.values[from as usize * stride + i];
                    let value = &mut self.values[to as usize * stride + i];
                    *value += share * (goal - *value);
                }
            }
        }
        for corner in star {
            let t = corner.triangle();
            let place = triangles[t].iter().position(|&v| v == goes).unwrap_or(0);
            if let Some(&(_, to)) = pairs[..found].iter().find(|p| p.0 == self.wedges[t][place]) {
                self.wedges[t][place] = to;
            }
        }
    }

    /// What a run of the triangles carries, and how to put it back.
    pub(super) fn part(&self, run: Range<usize>) -> (Self, Part) {
        let material_of = if self.material_of.is_empty() { Vec::new() } else { self.material_of[run.clone()].to_vec() };
        if self.wedges.is_empty() {
            return (Self { material_of, ..Self::default() }, Part::default());
        }
        let run = &self.wedges[run];
        let mut names = run.as_flattened().to_vec();
        names.sort_unstable();
        names.dedup();
        let stride = self.kinds.stride();
        let values = names.iter().flat_map(|&w| &self.values[w as usize * stride..(w as usize + 1) * stride]).copied();
        let values = values.collect();
        let wedges = run.iter().map(|t| t.map(|w| names.binary_search(&w).unwrap_or(0) as u32)).collect();
        (Self { kinds: self.kinds, values, wedges, material_of }, Part { names })
    }

    /// Forgets the triangles, so that parts can be put back.
    pub(super) fn start_joining(&mut self) {
        self.wedges.clear();
        self.material_of.clear();
    }

    /// Puts a part back behind those already there.
    pub(super) fn join(&mut self, other: Self, part: &Part) {
        let stride = self.kinds.stride();
        for (values, &w) in other.values.chunks_exact(stride.max(1)).zip(&part.names) {
            self.values[w as usize * stride..(w as usize + 1) * stride].copy_from_slice(values);
        }
        self.wedges.extend(other.wedges.iter().map(|t| t.map(|w| part.names[w as usize])));
        self.material_of.extend(other.material_of);
    }

    /// Leaves out the triangles that are gone.
    pub(super) fn compact(&mut self, triangles: &[[u32; 3]]) {
        let mut t = 0;
        self.wedges.retain(|_| {
            t += 1;
            triangles[t - 1][0] != GONE
        });
        t = 0;
        self.material_of.retain(|_| {
            t += 1;
            triangles[t - 1][0] != GONE
        });
    }

    /// Writes what is carried into a mesh of these triangles; `sources` are the vertices' numbers in the source. Vertices
    /// with several wedges become several. Gives the source number of each vertex of the result.
    pub(super) fn write(
        self,
        mut mesh: TriangleMesh,
        sources: &[u32],
        source: &TriangleMesh,
    ) -> (TriangleMesh, Vec<u32>) {
        mesh.materials.clone_from(&source.materials);
        mesh.material_of = self.material_of;
        if self.wedges.is_empty() {
            return (mesh, sources.to_vec());
        }
        let mut number = vec![GONE; source.positions.len()];
        let mut wedges = Vec::with_capacity(sources.len());
        let mut positions = Vec::with_capacity(sources.len());
        for (corners, of_corner) in mesh.triangles.iter_mut().zip(&self.wedges) {
            for (v, &w) in corners.iter_mut().zip(of_corner) {
                let number = &mut number[w as usize];
                if *number == GONE {
                    *number = wedges.len() as u32;
                    wedges.push(w);
                    positions.push(mesh.positions[*v as usize]);
                }
                *v = *number;
            }
        }
        mesh.positions = positions;
        let stride = self.kinds.stride();
        for &w in &wedges {
            let mut values = &self.values[w as usize * stride..(w as usize + 1) * stride];
            let mut take = |n| {
                let (head, tail) = values.split_at(n);
                values = tail;
                head
            };
            if self.kinds.colours {
                let c = take(COLOUR);
                mesh.colours.push(std::array::from_fn(|k| (c[k] * 255.0).round().clamp(0.0, 255.0) as u8));
            }
            if self.kinds.texcoords {
                let t = take(TEXCOORD);
                mesh.texcoords.push([t[0], t[1]]);
            }
            if self.kinds.normals {
                let n = glam::Vec3::from_slice(take(NORMAL));
                mesh.normals.push(n.try_normalize().unwrap_or(glam::Vec3::Z).to_array());
            }
        }
        (mesh, wedges)
    }
}
