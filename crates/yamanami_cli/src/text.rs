//! Numbers and places as people read them.

use yamanami::core::{Crs, GeoReference};

/// `1,234,567`.
pub(crate) fn count(n: impl TryInto<u64>) -> String {
    let digits = n.try_into().unwrap_or(u64::MAX).to_string();
    let mut text = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(c);
    }
    text
}

/// `1.8 MiB`.
pub(crate) fn bytes(n: u64) -> String {
    let mut value = n as f64;
    for unit in ["bytes", "KiB", "MiB", "GiB"] {
        if value < 1024.0 {
            return if unit == "bytes" { format!("{n} bytes") } else { format!("{value:.1} {unit}") };
        }
        value /= 1024.0;
    }
    format!("{value:.1} TiB")
}

/// Three significant digits or so, without a long tail: `0.0123`, `1.23`, `123.4`, `12345`.
pub(crate) fn number(v: f64) -> String {
    if !v.is_finite() {
        return if v.is_nan() { "unknown".to_owned() } else { "unbounded".to_owned() };
    }
    let digits = match v.abs() {
        a if a == 0.0 || a >= 1000.0 => 0,
        a if a >= 100.0 => 1,
        a if a >= 1.0 => 2,
        a => (2.0 - a.log10()).ceil().min(9.0) as usize,
    };
    let text = format!("{v:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// `850 m` or `35.9 km`.
pub(crate) fn length_m(m: f64) -> String {
    if m.abs() >= 10_000.0 { format!("{} km", number(m / 1000.0)) } else { format!("{} m", number(m)) }
}

/// A coordinate with the digits that its CRS deserves.
pub(crate) fn coordinate(v: f64, crs: &Crs) -> String {
    if crs.geographic { format!("{v:.6}") } else { format!("{v:.2}") }
}

/// `EPSG:32611 WGS 84 / UTM zone 11N`.
pub(crate) fn crs(crs: &Crs) -> String {
    match (crs.epsg, crs.name.as_str()) {
        (None, "") => "none: plain metres".to_owned(),
        (None, name) => name.to_owned(),
        (Some(code), "") => format!("EPSG:{code}"),
        (Some(code), name) => format!("EPSG:{code} {name}"),
    }
}

/// West, south, east and north of a grid's samples in the source CRS.
pub(crate) fn bounds(geo: &GeoReference, size: [usize; 2]) -> [f64; 4] {
    let [x0, y0] = geo.source_from_grid(0.0, 0.0);
    let [x1, y1] = geo.source_from_grid((size[0] - 1) as f64, (size[1] - 1) as f64);
    [x0.min(x1), y0.min(y1), x0.max(x1), y0.max(y1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_true() {
        assert_eq!(count(1_234_567_u64), "1,234,567");
        assert_eq!(count(12_usize), "12");
        assert_eq!(bytes(512), "512 bytes");
        assert_eq!(bytes(1_967_049), "1.9 MiB");
        assert_eq!(number(0.0), "0");
        assert_eq!(number(0.012_345), "0.0123");
        assert_eq!(number(1.5), "1.5");
        assert_eq!(number(30.0), "30");
        assert_eq!(number(12_345.6), "12346");
        assert_eq!(number(1200.0), "1200");
        assert_eq!(number(f64::INFINITY), "unbounded");
    }
}
