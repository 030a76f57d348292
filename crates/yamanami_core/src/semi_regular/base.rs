//! The base mesh of a semi-regular mesh: triangles, their edges, and the fans around its vertices.

/// What keeps triangles from being a base mesh: it must be a surface, with or without border, that faces one way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseFault {
    /// A triangle names a vertex that is not there, or one twice.
    BadTriangle {
        /// The triangle.
        triangle: u32,
    },
    /// More than two triangles meet at an edge, or two that face different ways.
    BadEdge {
        /// The edge's ends.
        ends: [u32; 2],
    },
    /// Parts of the surface touch at this vertex alone.
    PinchedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// No triangle names this vertex.
    UnusedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// More vertices or triangles than 32 bits can number.
    TooLarge,
}

/// A triangle's side as a part of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Side {
    /// The edge.
    pub edge: u32,
    /// Whether the triangle, walked counter-clockwise, runs along the edge from its second end to its first.
    pub is_reversed: bool,
}

/// An edge of the base mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BaseEdge {
    /// Its ends, as its first triangle walks along it.
    pub ends: [u32; 2],
    /// Triangle and side (0 to 2) on its left.
    pub left: (u32, u8),
    /// The same on its right; none at a border.
    pub right: Option<(u32, u8)>,
}

/// A triangle mesh that is a surface: at most two triangles at an edge, one fan at a vertex, all facing one way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BaseMesh {
    triangles: Vec<[u32; 3]>,
    sides: Vec<[Side; 3]>,
    edges: Vec<BaseEdge>,
    /// Where each vertex's fan begins in `fans`.
    first_of_fan: Vec<u32>,
    /// Triangle and corner around each vertex, counter-clockwise, from the border on if there is one.
    fans: Vec<(u32, u8)>,
}

impl BaseMesh {
    /// Finds edges and fans. Edges are numbered as the triangles first name them.
    pub fn new(vertices: u32, triangles: Vec<[u32; 3]>) -> Result<Self, BaseFault> {
        if triangles.len() > (u32::MAX / 3) as usize {
            return Err(BaseFault::TooLarge);
        }
        for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
            if a.max(b).max(c) >= vertices || a == b || b == c || c == a {
                return Err(BaseFault::BadTriangle { triangle: triangle as u32 });
            }
        }
        let (edges, sides) = edges_of(vertices, &triangles)?;
        let mut base = Self { triangles, sides, edges, first_of_fan: Vec::new(), fans: Vec::new() };
        base.find_fans(vertices)?;
        Ok(base)
    }

    /// Vertices.
    pub fn vertex_count(&self) -> u32 {
        (self.first_of_fan.len() - 1) as u32
    }

    /// Triangles, counter-clockwise.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Sides of each triangle: side k runs from corner k to corner k + 1.
    pub fn sides(&self) -> &[[Side; 3]] {
        &self.sides
    }

    /// Edges.
    pub fn edges(&self) -> &[BaseEdge] {
        &self.edges
    }

    /// Triangle and corner around a vertex, counter-clockwise; at a border from one border edge to the other.
    pub fn fan(&self, vertex: u32) -> &[(u32, u8)] {
        let [from, to] = [vertex, vertex + 1].map(|v| self.first_of_fan[v as usize] as usize);
        &self.fans[from..to]
    }

    /// The triangle and side beyond a side.
    pub fn beyond(&self, triangle: u32, side: u8) -> Option<(u32, u8)> {
        let Side { edge, is_reversed } = self.sides[triangle as usize][usize::from(side)];
        let edge = &self.edges[edge as usize];
        if is_reversed { Some(edge.left) } else { edge.right }
    }

    /// Whether the border runs through a vertex.
    pub fn is_on_border(&self, vertex: u32) -> bool {
        self.fan(vertex).first().is_none_or(|&(triangle, corner)| self.beyond(triangle, corner).is_none())
    }

    fn find_fans(&mut self, vertices: u32) -> Result<(), BaseFault> {
        let mut count = vec![0u32; vertices as usize + 1];
        let mut some = vec![None; vertices as usize];
        for (t, corners) in self.triangles.iter().enumerate() {
            for (k, &v) in corners.iter().enumerate() {
                count[v as usize + 1] += 1;
                let corner = (t as u32, k as u8);
                // where the border leaves the vertex, its fan begins
                if some[v as usize].is_none() || self.beyond(corner.0, corner.1).is_none() {
                    some[v as usize] = Some(corner);
                }
            }
        }
        for v in 0..vertices as usize {
            count[v + 1] += count[v];
        }
        self.fans.reserve(3 * self.triangles.len());
        for vertex in 0..vertices {
            let begin = some[vertex as usize].ok_or(BaseFault::UnusedVertex { vertex })?;
            let mut corner = begin;
            loop {
                self.fans.push(corner);
                // the side that comes into the corner is the way on, counter-clockwise
                match self.beyond(corner.0, (corner.1 + 2) % 3) {
                    Some(next) if next != begin => corner = next,
                    _ => break,
                }
            }
            if self.fans.len() != count[vertex as usize + 1] as usize {
                return Err(BaseFault::PinchedVertex { vertex });
            }
        }
        self.first_of_fan = count;
        Ok(())
    }
}

type EdgesAndSides = (Vec<BaseEdge>, Vec<[Side; 3]>);

fn edges_of(vertices: u32, triangles: &[[u32; 3]]) -> Result<EdgesAndSides, BaseFault> {
    // each side under its lesser end, with its greater end and its number; equal ones come together, first named first
    let ends = |side: u32| {
        let (corners, k) = (triangles[side as usize / 3], side as usize % 3);
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        [a.min(b), a.max(b)]
    };
    let sides = 3 * triangles.len() as u32;
    let mut next = vec![0u32; vertices as usize + 1];
    for side in 0..sides {
        next[ends(side)[0] as usize + 1] += 1;
    }
    for v in 0..vertices as usize {
        next[v + 1] += next[v];
    }
    let mut named = vec![(0, 0); sides as usize];
    for side in 0..sides {
        let [low, high] = ends(side);
        named[next[low as usize] as usize] = (high, side);
        next[low as usize] += 1;
    }
    let mut of_side = vec![[u32::MAX; 3]; triangles.len()];
    let mut pairs = Vec::with_capacity(named.len() / 2 + 1);
    let mut rest = &mut named[..];
    let mut taken = 0;
    for low in 0..vertices {
        let end = next[low as usize];
        let (own, others) = rest.split_at_mut((end - taken) as usize);
        (rest, taken) = (others, end);
        own.sort_unstable();
        for same in own.chunk_by(|p, q| p.0 == q.0) {
            if same.len() > 2 {
                return Err(BaseFault::BadEdge { ends: [low, same[0].0] });
            }
            for &(_, side) in same {
                of_side[side as usize / 3][side as usize % 3] = pairs.len() as u32;
            }
            let place = |&(_, side): &(u32, u32)| (side / 3, (side % 3) as u8);
            pairs.push((place(&same[0]), same.get(1).map(place)));
        }
    }
    let mut number = vec![u32::MAX; pairs.len()];
    let mut edges = Vec::with_capacity(pairs.len());
    let mut sides = Vec::with_capacity(triangles.len());
    for (t, corners) in triangles.iter().enumerate() {
        let mut found = [Side { edge: 0, is_reversed: false }; 3];
        for k in 0..3u8 {
            let pair = of_side[t][usize::from(k)] as usize;
            let walk = [corners[usize::from(k)], corners[usize::from(k + 1) % 3]];
            let is_first = number[pair] == u32::MAX;
            if is_first {
                number[pair] = edges.len() as u32;
                edges.push(BaseEdge { ends: walk, left: pairs[pair].0, right: pairs[pair].1 });
            } else if edges[number[pair] as usize].ends == walk {
                return Err(BaseFault::BadEdge { ends: walk });
            }
            found[usize::from(k)] = Side { edge: number[pair], is_reversed: !is_first };
        }
        sides.push(found);
    }
    Ok((edges, sides))
}
