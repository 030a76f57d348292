//! Who stands beside whom: the neighbours of a vertex among those that come with its level, and the tree of vertices.
//!
//! A new vertex is the midpoint of an edge; its children are the midpoints of that edge's halves and of the two edges parallel to it,
//! one in each triangle beside it.
//!
//! Idea: Khodakovsky, Schröder, Sweldens, "Progressive geometry compression", 2000.

use yamanami_core::SemiRegular;

/// Of the vertices that come with a level.
#[derive(Debug)]
pub(super) struct Links {
    /// The first of them.
    pub(super) first: u32,
    /// Neighbours of the same level, two in each triangle; `none` where the border is.
    pub(super) beside: Vec<[u32; 4]>,
    /// The vertex above in the tree; `none` on level 1.
    pub(super) parent: Vec<u32>,
    /// Children; `none` where there are fewer.
    pub(super) children: Vec<[u32; 4]>,
    /// What stands for no vertex.
    pub(super) none: u32,
}

impl Links {
    /// Links of a level from 1 on, given those of the level `above`; children only where there is a level below.
    pub(super) fn new(mesh: &SemiRegular, level: u32, above: Option<&Self>) -> Self {
        let range = mesh.new_vertices(level);
        let none = mesh.vertex_count(mesh.levels());
        let has_children = level < mesh.levels();
        let mut parent = vec![none; range.len()];
        for (v, children) in above.iter().flat_map(|above| (above.first..).zip(&above.children)) {
            for &child in children.iter().filter(|&&child| child != none) {
                parent[(child - range.start) as usize] = v;
            }
        }
        let mut links = Self {
            first: range.start,
            parent,
            beside: vec![[none; 4]; range.len()],
            children: if has_children { vec![[none; 4]; range.len()] } else { Vec::new() },
            none,
        };
        let size = 1u32 << (level - 1);
        for face in 0..mesh.base().triangles().len() as u32 {
            for j in 0..size {
                for i in 0..size - j {
                    let [x, y] = [2 * i, 2 * j];
                    let up = [[x + 1, y], [x + 1, y + 1], [x, y + 1]];
                    let numbers = links.triangle(mesh, level, face, up);
                    if has_children {
                        for (at, v, step) in
                            [(up[0], numbers[0], [1, 0]), (up[1], numbers[1], [-1, 1]), (up[2], numbers[2], [0, 1])]
                        {
                            let halves = [1, -1].map(|side: i32| {
                                let place = std::array::from_fn(|k| (2 * at[k]).wrapping_add_signed(side * step[k]));
                                mesh.vertex(level + 1, face, place)
                            });
                            links.children[(v - range.start) as usize][..2].copy_from_slice(&halves);
                        }
                    }
                    if i + j + 1 < size {
                        links.triangle(mesh, level, face, [[x + 1, y + 1], [x + 2, y + 1], [x + 1, y + 2]]);
                    }
                }
            }
        }
        links
    }

    /// Notes what the midpoints of a triangle's three edges have in it; gives their numbers.
    fn triangle(&mut self, mesh: &SemiRegular, level: u32, face: u32, at: [[u32; 2]; 3]) -> [u32; 3] {
        let numbers = at.map(|at| mesh.vertex(level, face, at));
        for k in 0..3 {
            let (p, q) = ((k + 1) % 3, (k + 2) % 3);
            let own = (numbers[k] - self.first) as usize;
            let half = if self.beside[own][0] == self.none { 0 } else { 2 };
            self.beside[own][half] = numbers[p];
            self.beside[own][half + 1] = numbers[q];
            if let Some(children) = self.children.get_mut(own) {
                let middle = std::array::from_fn(|i| at[p][i] + at[q][i]);
                children[2 + half / 2] = mesh.vertex(level + 1, face, middle);
            }
        }
        numbers
    }
}
