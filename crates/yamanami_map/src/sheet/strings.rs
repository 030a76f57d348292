//! What a sheet says, in the languages it speaks.

use super::Language;
use glam::DVec2;
use yamanami_core::{DeformedMap, LineKind, PlaceKind};

/// The words of one language.
#[derive(Debug)]
pub(crate) struct Strings {
    /// North, east, south, west.
    pub(crate) cardinals: [&'static str; 4],
    pub(crate) heights: &'static str,
    pub(crate) plain_map: &'static str,
    language: Language,
}

static JA: Strings = Strings {
    cardinals: ["北", "東", "南", "西"],
    heights: "標高 m",
    plain_map: "縮尺は中央の円の中だけ",
    language: Language::Ja,
};

static EN: Strings = Strings {
    cardinals: ["N", "E", "S", "W"],
    heights: "Height, m",
    plain_map: "true in the inner circle only",
    language: Language::En,
};

impl Strings {
    pub(crate) fn of(language: Language) -> &'static Self {
        match language {
            Language::Ja => &JA,
            Language::En => &EN,
        }
    }

    fn pick(&self, ja: &'static str, en: &'static str) -> &'static str {
        match self.language {
            Language::Ja => ja,
            Language::En => en,
        }
    }

    pub(crate) fn line_kind(&self, kind: LineKind) -> &'static str {
        match kind {
            LineKind::Coast => self.pick("海岸線", "Coast"),
            LineKind::River => self.pick("川", "River"),
            LineKind::Lake => self.pick("湖沼", "Lake"),
            LineKind::Road => self.pick("道路", "Road"),
            LineKind::Railway => self.pick("鉄道", "Railway"),
            LineKind::Track => self.pick("軌跡", "Track"),
            LineKind::Border => self.pick("境界", "Border"),
            _ => self.pick("線", "Line"),
        }
    }

    pub(crate) fn place_kind(&self, kind: PlaceKind) -> &'static str {
        match kind {
            PlaceKind::Summit => self.pick("山頂", "Summit"),
            PlaceKind::Pass => self.pick("峠", "Pass"),
            PlaceKind::Settlement => self.pick("町・村", "Settlement"),
            _ => self.pick("地点", "Place"),
        }
    }

    /// Longitude and latitude given in degrees.
    pub(crate) fn lon_lat(&self, lon_lat: DVec2) -> String {
        let (north, east) = (lon_lat.y >= 0.0, lon_lat.x >= 0.0);
        match self.language {
            Language::Ja => {
                let parts = |degrees: f64| {
                    let seconds = (degrees.abs() * 3600.0).round() as i64;
                    format!("{}度{:02}分{:02}秒", seconds / 3600, seconds / 60 % 60, seconds % 60)
                };
                let (ns, ew) = (if north { "北緯" } else { "南緯" }, if east { "東経" } else { "西経" });
                format!("{ns}{} {ew}{}", parts(lon_lat.y), parts(lon_lat.x))
            }
            Language::En => {
                let (ns, ew) = (if north { "N" } else { "S" }, if east { "E" } else { "W" });
                format!("{:.4}° {ns} {:.4}° {ew}", lon_lat.y.abs(), lon_lat.x.abs())
            }
        }
    }

    /// The numbers of the projection, a line each.
    pub(crate) fn projection(&self, map: &DeformedMap, rim_m: f64) -> Vec<String> {
        let (ring, rim, eye) = (km(map.ring_m), km(rim_m), grouped(map.eye_m));
        let mut shape = match self.language {
            Language::Ja => format!("視点の高さ {eye} m · アルファ {}", short(map.alpha)),
            Language::En => format!("Eye at {eye} m · alpha {}", short(map.alpha)),
        };
        if map.exaggeration != 1.0 {
            shape += &format!(" · {} ×{}", self.pick("高さ", "heights"), short(map.exaggeration));
        }
        let reach = match self.language {
            Language::Ja => format!("平面図 半径 {ring} km · 展望 {rim} km まで"),
            Language::En => format!("Plain map to {ring} km, panorama to {rim} km"),
        };
        let mut lines = vec![reach, shape];
        if let Some(curvature) = map.curvature {
            let k = short(curvature.refraction);
            lines.push(match self.language {
                Language::Ja => format!("地球の丸みと大気差 k = {k}"),
                Language::En => format!("Earth's curvature, refraction k = {k}"),
            });
        }
        lines
    }
}

/// Metres as kilometres, no more digits than needed.
pub(crate) fn km(metres: f64) -> String {
    short(metres / 1000.0)
}

/// A number with up to two decimals.
pub(crate) fn short(number: f64) -> String {
    let text = format!("{number:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A whole number with a space between thousands from five digits on.
pub(crate) fn grouped(number: f64) -> String {
    let digits = format!("{:.0}", number.abs());
    let mut out = String::from(if number <= -0.5 { "−" } else { "" });
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) && digits.len() > 4 {
            out.push(' ');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_on_maps() {
        assert_eq!([0.0, 3776.4, 12_345.0, -12.0].map(grouped), ["0", "3776", "12 345", "−12"]);
        assert_eq!([0.3, 10.0, 2.5].map(short), ["0.3", "10", "2.5"]);
        let fuji = DVec2::new(138.7274, 35.3606);
        assert_eq!(EN.lon_lat(fuji), "35.3606° N 138.7274° E");
        assert_eq!(JA.lon_lat(-fuji), "南緯35度21分38秒 西経138度43分39秒");
    }
}
