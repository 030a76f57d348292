//! A made scan of a five-storey pagoda: roofs of tiles, brackets, railings, a finial, in triangles of one size as a scanner
//! gives them, with its noise and, if wanted, its holes.
//!
//! Stands for: the scanned small pagoda of Kairyūō-ji in Mizuno, Okumoto, Takata, Joe, "Polygon reduction for effective 3D
//! model rendering on different platforms", 2011. The form is of our own making after the type.

mod body;
mod bracket;
mod defects;
mod eaves;
mod finial;
mod paint;
mod part;
mod plan;
mod railing;
mod roof;
mod scan;
mod tessellate;

use glam::DVec3;
use part::Parts;
use yamanami_core::TriangleMesh;

/// A pagoda 4.4 metres high, z up, its sides facing east, north, west and south: equal orders give equal meshes.
///
/// Every piece of the building is a surface of its own, closed or (the roofs' slopes, the rows of rafters) with a border, and all are cut into
/// triangles of about the same size, which follows from their number. Pieces much thinner than that size are left out, as a scanner
/// misses them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pagoda {
    /// About how many triangles, from [`Pagoda::FEWEST_FACES`] to [`Pagoda::MOST_FACES`]; met within 1 %.
    pub faces: usize,
    /// Which of all such scans.
    pub seed: u64,
    /// How far the scanner's noise moves a vertex along the normal, at most; `None` is 0.15 of a triangle's side.
    pub noise_m: Option<f64>,
    /// Leaves open what a scanner does not see, and adds a few doubled and stray triangles.
    pub holes: bool,
}

/// A part of the building worth a look from near by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// What is seen there.
    pub name: &'static str,
    /// Its middle.
    pub centre_m: DVec3,
    /// Radius of a sphere around it.
    pub radius_m: f64,
}

impl Pagoda {
    /// Fewer than this are no pagoda.
    pub const FEWEST_FACES: usize = 2_000;
    /// More than this are not made.
    pub const MOST_FACES: usize = 20_000_000;

    /// A clean scan of so many triangles with the usual noise.
    pub fn new(faces: usize) -> Self {
        Self { faces, seed: 1, noise_m: None, holes: false }
    }

    /// Makes the mesh, with colours and without normals.
    pub fn to_mesh(&self) -> TriangleMesh {
        scan::scan(self, &building())
    }

    /// What the paper's table 2 cuts out: roof, bracket and railing, each at the front, the south-east corner.
    pub fn regions() -> [Region; 3] {
        let storeys = plan::storeys();
        let [_, second, third, fourth, _] = &storeys;
        let corner = plan::at_eave(1, 0.90, -0.90, second.roof.lift_m);
        let out_m = fourth.half_m + 0.06;
        let bracket = DVec3::new(out_m, -out_m, 0.5 * (fourth.head_z + fourth.purlin_z()));
        let rail_m = railing::rail_m(third);
        let rail = DVec3::new(rail_m, -rail_m, third.floor_z + 0.6 * railing::TOP_RAIL_Z);
        [
            Region { name: "roof", centre_m: corner, radius_m: 0.20 },
            Region { name: "bracket", centre_m: bracket, radius_m: 0.16 },
            Region { name: "railing", centre_m: rail, radius_m: 0.14 },
        ]
    }

    /// Eye and target of the paper's view: from the south-east at the height of a visitor's eyes, so that two sides of the
    /// tower are seen, and the brackets beneath their eaves; 30 degrees from bottom to top hold the whole.
    pub fn view() -> [DVec3; 2] {
        let target = DVec3::new(0.0, 0.0, 0.49 * plan::height_m());
        [target + DVec3::new(6.4, -7.6, -0.5), target]
    }
}

/// All pieces, not yet in triangles.
fn building() -> Parts {
    let mut parts = Parts::default();
    body::base(&mut parts);
    for (k, storey) in plan::storeys().iter().enumerate() {
        body::build(&mut parts, storey);
        bracket::build(&mut parts, storey);
        eaves::build(&mut parts, storey);
        roof::build(&mut parts, &storey.roof, k as u64);
        if storey.has_balcony {
            railing::build(&mut parts, storey);
        }
    }
    finial::build(&mut parts, plan::finial_z());
    parts
}
