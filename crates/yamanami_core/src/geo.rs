//! Where a grid lies on Earth, and the local metric frame in which it is built.
//!
//! A regular grid stays a regular grid: a geographic or Web Mercator raster is scaled to metres at its centre
//! (ellipsoidal radii of curvature, GRS 80), never resampled, so that every source sample is kept exactly.

/// Whether a file's coordinates name the middle of a sample or the corner of its cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PixelConvention {
    /// The origin given in the file is the outer corner of the first cell (GeoTIFF `PixelIsArea`).
    #[default]
    Area,
    /// The origin given in the file is the first sample itself (GeoTIFF `PixelIsPoint`, SRTM, DTED).
    Point,
}

/// Coordinate reference system of a source, as far as the engine needs it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Crs {
    /// EPSG code where known.
    pub epsg: Option<u32>,
    /// True for longitude/latitude in degrees.
    pub geographic: bool,
    /// True for spherical Web Mercator, whose metres must be scaled by the cosine of the latitude.
    pub web_mercator: bool,
    /// Readable name, e.g. `JGD2011 / Japan Plane Rectangular CS IX`; empty when unknown.
    pub name: String,
}

/// Places sample (0, 0) and the steps to its right and lower neighbours, in the source CRS, and the size of these
/// steps on the ground in metres.
#[derive(Debug, Clone, PartialEq)]
pub struct GeoReference {
    /// The CRS of [`Self::origin`] and [`Self::step`].
    pub crs: Crs,
    /// Position of sample (column 0, row 0): x or longitude, y or latitude, in CRS units.
    pub origin: [f64; 2],
    /// CRS units from one column to the next and from one row to the next (the second is negative, north up).
    pub step: [f64; 2],
    /// Metres on the ground between columns and between rows, both positive.
    pub step_m: [f64; 2],
}

const SEMI_MAJOR_AXIS_M: f64 = 6_378_137.0;
const ECCENTRICITY_SQUARED: f64 = 0.006_694_380_022_9;

impl GeoReference {
    /// A grid without a CRS: metres, north up, its lower left sample at (0, 0).
    pub fn local(step_m: [f64; 2], rows: usize) -> Self {
        Self {
            crs: Crs::default(),
            origin: [0.0, step_m[1] * rows.saturating_sub(1) as f64],
            step: [step_m[0], -step_m[1]],
            step_m,
        }
    }

    /// Places a grid of `size` (columns, rows) samples; the ground spacing is worked out at its centre.
    pub fn new(crs: Crs, origin: [f64; 2], step: [f64; 2], size: [usize; 2]) -> Self {
        let centre_y = origin[1] + 0.5 * step[1] * size[1].saturating_sub(1) as f64;
        let per_unit = if crs.geographic {
            metres_per_degree(centre_y)
        } else if crs.web_mercator {
            let latitude = (centre_y / SEMI_MAJOR_AXIS_M).sinh().atan();
            [latitude.cos(); 2]
        } else {
            [1.0; 2]
        };
        let step_m = [step[0].abs() * per_unit[0], step[1].abs() * per_unit[1]];
        Self { crs, origin, step, step_m }
    }

    /// Source coordinates of a (fractional) column and row.
    pub fn source_from_grid(&self, column: f64, row: f64) -> [f64; 2] {
        [self.origin[0] + column * self.step[0], self.origin[1] + row * self.step[1]]
    }

    /// Fractional column and row of source coordinates.
    pub fn grid_from_source(&self, x: f64, y: f64) -> [f64; 2] {
        [(x - self.origin[0]) / self.step[0], (y - self.origin[1]) / self.step[1]]
    }

    /// Local metric coordinates (x east, y north, metres from sample (0, 0)) of a column and row.
    pub fn local_from_grid(&self, column: f64, row: f64) -> [f64; 2] {
        [column * self.step_m[0], -row * self.step_m[1]]
    }

    /// Fractional column and row of local metric coordinates.
    pub fn grid_from_local(&self, x_m: f64, y_m: f64) -> [f64; 2] {
        [x_m / self.step_m[0], -y_m / self.step_m[1]]
    }

    /// Local metric coordinates of a point given in the source CRS.
    pub fn local_from_source(&self, x: f64, y: f64) -> [f64; 2] {
        let [column, row] = self.grid_from_source(x, y);
        self.local_from_grid(column, row)
    }

    /// Source coordinates of a point of the local frame.
    pub fn source_from_local(&self, x_m: f64, y_m: f64) -> [f64; 2] {
        let [column, row] = self.grid_from_local(x_m, y_m);
        self.source_from_grid(column, row)
    }
}

/// Ground metres per degree of longitude and of latitude at a latitude in degrees, on the GRS 80 ellipsoid.
fn metres_per_degree(latitude_deg: f64) -> [f64; 2] {
    let (sin, cos) = latitude_deg.to_radians().sin_cos();
    let w2 = 1.0 - ECCENTRICITY_SQUARED * sin * sin;
    let prime_vertical_m = SEMI_MAJOR_AXIS_M / w2.sqrt();
    let meridional_m = SEMI_MAJOR_AXIS_M * (1.0 - ECCENTRICITY_SQUARED) / (w2 * w2.sqrt());
    let degree = 1f64.to_radians();
    [prime_vertical_m * cos * degree, meridional_m * degree]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_degree_is_as_long_as_the_geodesy_books_say() {
        let [lon_m, lat_m] = metres_per_degree(45.0);
        assert!((lon_m - 78_846.8).abs() < 1.0, "{lon_m}");
        assert!((lat_m - 111_131.8).abs() < 1.0, "{lat_m}");
    }

    #[test]
    fn local_and_source_frames_are_inverse() {
        let crs = Crs { geographic: true, ..Crs::default() };
        let geo = GeoReference::new(crs, [138.0, 36.0], [1.0 / 3600.0, -1.0 / 3600.0], [3601, 3601]);
        let [x, y] = geo.local_from_source(138.7, 35.36);
        let [lon, lat] = geo.source_from_local(x, y);
        assert!((lon - 138.7).abs() < 1e-12 && (lat - 35.36).abs() < 1e-12);
        assert!(x > 0.0 && y < 0.0, "east of and south of the first sample");
    }
}
