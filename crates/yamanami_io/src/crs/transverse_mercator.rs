//! Transverse Mercator on the ellipsoid, to a few nanometres within a zone.
//!
//! Based on: L. Krüger, "Konforme Abbildung des Erdellipsoids in der Ebene", 1912, in the sixth-order form of
//! C. F. F. Karney, "Transverse Mercator with an accuracy of a few nanometers", J. Geodesy, 2011.

/// Size and shape of an ellipsoid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ellipsoid {
    pub(super) semi_major_m: f64,
    pub(super) inverse_flattening: f64,
}

pub(super) const GRS80: Ellipsoid = Ellipsoid { semi_major_m: 6_378_137.0, inverse_flattening: 298.257_222_101 };
pub(super) const WGS84: Ellipsoid = Ellipsoid { semi_major_m: 6_378_137.0, inverse_flattening: 298.257_223_563 };
pub(super) const WGS72: Ellipsoid = Ellipsoid { semi_major_m: 6_378_135.0, inverse_flattening: 298.26 };
pub(super) const BESSEL: Ellipsoid = Ellipsoid { semi_major_m: 6_377_397.155, inverse_flattening: 299.152_812_8 };
pub(super) const CLARKE_1866: Ellipsoid =
    Ellipsoid { semi_major_m: 6_378_206.4, inverse_flattening: 294.978_698_213_898 };

/// What defines a zone.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given {
    pub(super) ellipsoid: Ellipsoid,
    /// Latitude and longitude of the natural origin.
    pub(super) origin_deg: [f64; 2],
    pub(super) scale: f64,
    /// Easting and northing of the natural origin.
    pub(super) false_origin_m: [f64; 2],
}

/// One zone.
#[derive(Debug, Clone, Copy)]
pub(super) struct TransverseMercator {
    pub(super) given: Given,
    eccentricity: f64,
    central_meridian_deg: f64,
    /// Scale times rectifying radius.
    radius_m: f64,
    false_origin_m: [f64; 2],
    /// From the conformal to the rectifying sphere.
    alpha: [f64; 6],
    /// And back.
    beta: [f64; 6],
}

/// Beyond this distance from the central meridian the series are no longer good.
const MAX_LONGITUDE_DISTANCE_DEG: f64 = 60.0;

impl TransverseMercator {
    /// `origin` is latitude and longitude of the natural origin in degrees, `false_origin_m` the easting and northing
    /// given to it.
    pub(super) fn new(ellipsoid: Ellipsoid, origin: [f64; 2], scale: f64, false_origin_m: [f64; 2]) -> Self {
        let f = 1.0 / ellipsoid.inverse_flattening;
        let n = f / (2.0 - f);
        let (n2, n3) = (n * n, n * n * n);
        let (n4, n5, n6) = (n2 * n2, n2 * n3, n3 * n3);
        let rectifying_m = ellipsoid.semi_major_m / (1.0 + n) * (1.0 + n2 / 4.0 + n4 / 64.0 + n6 / 256.0);
        let alpha = [
            n / 2.0 - n2 * 2.0 / 3.0 + n3 * 5.0 / 16.0 + n4 * 41.0 / 180.0 - n5 * 127.0 / 288.0 + n6 * 7891.0 / 37800.0,
            n2 * 13.0 / 48.0 - n3 * 3.0 / 5.0 + n4 * 557.0 / 1440.0 + n5 * 281.0 / 630.0
                - n6 * 1_983_433.0 / 1_935_360.0,
            n3 * 61.0 / 240.0 - n4 * 103.0 / 140.0 + n5 * 15061.0 / 26880.0 + n6 * 167_603.0 / 181_440.0,
            n4 * 49561.0 / 161_280.0 - n5 * 179.0 / 168.0 + n6 * 6_601_661.0 / 7_257_600.0,
            n5 * 34729.0 / 80640.0 - n6 * 3_418_889.0 / 1_995_840.0,
            n6 * 212_378_941.0 / 319_334_400.0,
        ];
        let beta = [
            n / 2.0 - n2 * 2.0 / 3.0 + n3 * 37.0 / 96.0 - n4 / 360.0 - n5 * 81.0 / 512.0 + n6 * 96199.0 / 604_800.0,
            n2 / 48.0 + n3 / 15.0 - n4 * 437.0 / 1440.0 + n5 * 46.0 / 105.0 - n6 * 1_118_711.0 / 3_870_720.0,
            n3 * 17.0 / 480.0 - n4 * 37.0 / 840.0 - n5 * 209.0 / 4480.0 + n6 * 5569.0 / 90720.0,
            n4 * 4397.0 / 161_280.0 - n5 * 11.0 / 504.0 - n6 * 830_251.0 / 7_257_600.0,
            n5 * 4583.0 / 161_280.0 - n6 * 108_847.0 / 3_991_680.0,
            n6 * 20_648_693.0 / 638_668_800.0,
        ];
        let mut zone = Self {
            given: Given { ellipsoid, origin_deg: origin, scale, false_origin_m },
            eccentricity: (f * (2.0 - f)).sqrt(),
            central_meridian_deg: origin[1],
            radius_m: scale * rectifying_m,
            false_origin_m,
            alpha,
            beta,
        };
        let [xi, _] = zone.series_from_lon_lat(0.0, origin[0]);
        zone.false_origin_m[1] -= zone.radius_m * xi;
        zone
    }

    /// Easting and northing in metres; `None` too far from the zone.
    pub(super) fn position(self, lon_deg: f64, lat_deg: f64) -> Option<[f64; 2]> {
        let distance_deg = (lon_deg - self.central_meridian_deg + 180.0).rem_euclid(360.0) - 180.0;
        if distance_deg.abs() > MAX_LONGITUDE_DISTANCE_DEG {
            return None;
        }
        let [xi, eta] = self.series_from_lon_lat(distance_deg, lat_deg);
        Some([self.false_origin_m[0] + self.radius_m * eta, self.false_origin_m[1] + self.radius_m * xi])
    }

    /// Longitude and latitude in degrees of an easting and northing in metres; NaN far outside.
    pub(super) fn to_lon_lat(self, x_m: f64, y_m: f64) -> [f64; 2] {
        let xi = (y_m - self.false_origin_m[1]) / self.radius_m;
        let eta = (x_m - self.false_origin_m[0]) / self.radius_m;
        let (mut conformal_xi, mut conformal_eta) = (xi, eta);
        for (j, beta) in self.beta.iter().enumerate() {
            let k = 2.0 * (j + 1) as f64;
            conformal_xi -= beta * (k * xi).sin() * (k * eta).cosh();
            conformal_eta -= beta * (k * xi).cos() * (k * eta).sinh();
        }
        let conformal_tan = conformal_xi.sin() / conformal_eta.sinh().hypot(conformal_xi.cos());
        let lon = conformal_eta.sinh().atan2(conformal_xi.cos()).to_degrees() + self.central_meridian_deg;
        let e2 = self.eccentricity * self.eccentricity;
        let mut tan = conformal_tan / (1.0 - e2);
        for _ in 0..4 {
            let at = self.conformal_tan(tan);
            let slope = (1.0 - e2) * at.hypot(1.0) * tan.hypot(1.0) / (1.0 + (1.0 - e2) * tan * tan);
            tan += (conformal_tan - at) / slope;
        }
        let lon = if lon > 180.0 { lon - 360.0 } else { lon };
        [lon, tan.atan().to_degrees()]
    }

    /// Position on the rectifying sphere, in units of its radius.
    fn series_from_lon_lat(&self, distance_deg: f64, lat_deg: f64) -> [f64; 2] {
        let conformal_tan = self.conformal_tan(lat_deg.to_radians().tan());
        let (sin, cos) = distance_deg.to_radians().sin_cos();
        let xi = conformal_tan.atan2(cos);
        let eta = (sin / conformal_tan.hypot(cos)).asinh();
        let (mut out_xi, mut out_eta) = (xi, eta);
        for (j, alpha) in self.alpha.iter().enumerate() {
            let k = 2.0 * (j + 1) as f64;
            out_xi += alpha * (k * xi).sin() * (k * eta).cosh();
            out_eta += alpha * (k * xi).cos() * (k * eta).sinh();
        }
        [out_xi, out_eta]
    }

    /// Tangent of the conformal latitude from the tangent of the latitude.
    fn conformal_tan(&self, tan: f64) -> f64 {
        let secant = tan.hypot(1.0);
        let sigma = (self.eccentricity * (self.eccentricity * tan / secant).atanh()).sinh();
        tan * sigma.hypot(1.0) - sigma * secant
    }
}
