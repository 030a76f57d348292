//! The tower's measures, in metres: five storeys about a tenth of a real pagoda's size, 4.4 metres to the jewel.

use glam::DVec3;

/// Top of the stone platform.
pub(super) const BASE_TOP_Z: f64 = 0.17;
/// Half the platform's side.
pub(super) const BASE_HALF_M: f64 = 0.72;
/// From the mid line of a storey's wall to its pillars, as a share of the half side: three bays.
pub(super) const PILLAR_SHARE: f64 = 0.36;
/// How far each of the three bracket steps goes out, and up.
pub(super) const STEP_OUT_M: f64 = 0.052;
pub(super) const STEP_UP_M: f64 = 0.036;
/// From the pillar's head to the first arms.
pub(super) const BLOCK_M: f64 = 0.032;
/// Height of the beam that the brackets carry.
pub(super) const PURLIN_M: f64 = 0.024;
/// Rafters: side and spacing.
pub(super) const RAFTER_M: f64 = 0.016;
pub(super) const RAFTER_SPACING_M: f64 = 0.034;
/// How far a balcony stands out from the wall.
pub(super) const BALCONY_M: f64 = 0.115;
/// Height of the skirt with its blocks below a balcony.
pub(super) const SKIRT_M: f64 = 0.062;

/// One storey, from its floor to its roof.
#[derive(Debug, Clone)]
pub(super) struct Storey {
    pub(super) floor_z: f64,
    /// Half the side of the square on which the pillars stand.
    pub(super) half_m: f64,
    /// Where the walls end and the brackets begin.
    pub(super) head_z: f64,
    pub(super) roof: Roof,
    /// Above the lowest storey there is a balcony.
    pub(super) has_balcony: bool,
}

/// One roof: four slopes alike.
#[derive(Debug, Clone, Copy)]
pub(super) struct Roof {
    /// From the axis to the eaves, and to where the slopes end below the next storey.
    pub(super) eave_m: f64,
    pub(super) inner_m: f64,
    /// Where the boards over the rafters end, inside the wall.
    pub(super) under_m: f64,
    /// Where the second row of rafters begins to carry.
    pub(super) mid_m: f64,
    /// Top of the pan tiles at the middle of the eaves, and how far the slope rises from there.
    pub(super) eave_z: f64,
    pub(super) rise_m: f64,
    /// How far the corners turn up.
    pub(super) lift_m: f64,
}

/// From the boards to the pan tiles at the eaves.
pub(super) const EAVE_THICKNESS_M: f64 = 0.026;
/// How steeply the boards rise from the eaves to the wall.
const UNDER_SLOPE: f64 = 0.27;
/// Of the slope's rise, the share that a straight line has; the rest curves.
const STRAIGHT: f64 = 0.62;

impl Roof {
    /// How far the eaves are turned up at a distance from the middle of the side.
    pub(super) fn lift(&self, x: f64) -> f64 {
        let t = (x / self.eave_m).abs();
        self.lift_m * t * t * t * (0.25 + 0.75 * t)
    }

    /// Height of the pan tiles, `x` along the side and `y` from the axis.
    pub(super) fn top_z(&self, x: f64, y: f64) -> f64 {
        let t = (self.eave_m - y) / (self.eave_m - self.inner_m);
        self.eave_z + self.rise_m * t * (STRAIGHT + (1.0 - STRAIGHT) * t) + self.lift(x)
    }

    /// How much the slope rises a metre outward: negative.
    pub(super) fn slope(&self, y: f64) -> f64 {
        let run_m = self.eave_m - self.inner_m;
        let t = (self.eave_m - y) / run_m;
        -self.rise_m / run_m * (STRAIGHT + 2.0 * (1.0 - STRAIGHT) * t)
    }

    /// Height of the boards over the rafters.
    pub(super) fn under_z(&self, x: f64, y: f64) -> f64 {
        self.eave_z - EAVE_THICKNESS_M + UNDER_SLOPE * (self.eave_m - y) + self.lift(x)
    }
}

impl Storey {
    /// Where the beam at the brackets' ends runs.
    pub(super) fn purlin_m(&self) -> f64 {
        self.half_m + 3.0 * STEP_OUT_M
    }

    /// Bottom of the arms of a bracket's step, 0 to 2.
    pub(super) fn step_z(&self, step: usize) -> f64 {
        self.head_z + BLOCK_M + STEP_UP_M * step as f64
    }

    /// Bottom of the beam at the brackets' ends.
    pub(super) fn purlin_z(&self) -> f64 {
        self.step_z(3)
    }
}

/// All five storeys, from below.
pub(super) fn storeys() -> [Storey; 5] {
    let mut floor_z = BASE_TOP_Z;
    std::array::from_fn(|k| {
        let up = k as f64;
        let half_m = 0.40 - 0.04 * up;
        let wall_m = [0.30, 0.175, 0.165, 0.155, 0.145][k];
        let head_z = floor_z + wall_m;
        let eave_m = half_m + 0.43 - 0.008 * up;
        let purlin_m = half_m + 3.0 * STEP_OUT_M;
        let purlin_top_z = head_z + BLOCK_M + 3.0 * STEP_UP_M + PURLIN_M;
        // the rafters lie on the beam
        let under_at_purlin_z = purlin_top_z + RAFTER_M + 0.012;
        let eave_z = under_at_purlin_z - UNDER_SLOPE * (eave_m - purlin_m) + EAVE_THICKNESS_M;
        let is_top = k == 4;
        let inner_m = if is_top { 0.045 } else { half_m - 0.04 + 0.02 };
        let rise_m = (eave_m - inner_m) * if is_top { 0.66 } else { 0.56 };
        let roof = Roof {
            eave_m,
            inner_m,
            under_m: half_m - 0.03,
            mid_m: half_m + 0.27,
            eave_z,
            rise_m,
            lift_m: 0.085 - 0.004 * up,
        };
        let storey = Storey { floor_z, half_m, head_z, roof, has_balcony: k > 0 };
        floor_z = eave_z + rise_m + SKIRT_M - 0.012;
        storey
    })
}

/// Where the finial stands.
pub(super) fn finial_z() -> f64 {
    let [.., top] = storeys();
    top.roof.eave_z + top.roof.rise_m
}

/// Height of the whole above the ground.
pub(super) fn height_m() -> f64 {
    finial_z() + super::finial::HEIGHT_M
}

/// A place named by its storey and its offsets to the east, north and up from the middle of that storey's eaves.
pub(super) fn at_eave(storey: usize, east_m: f64, north_m: f64, up_m: f64) -> DVec3 {
    let roof = storeys()[storey].roof;
    DVec3::new(east_m * roof.eave_m, north_m * roof.eave_m, roof.eave_z + up_m)
}
