//! Angles as people write them: decimal degrees, or degrees, minutes and seconds with any signs between them.

use super::words::half_width;

/// Degrees of a latitude or longitude: `35.3606`, `N35°21'38"`, `35 21 38.2 S`, `北緯35度21分38秒`, `138-43-39`.
pub(super) fn parse(text: &str) -> Option<f64> {
    let text = half_width(text.trim());
    let text = text.trim();
    let is_negative = text.contains(['S', 's', 'W', 'w', '南', '西']) || text.starts_with(['-', '−']);
    let digits = |c: char| c.is_ascii_digit() || c == '.';
    let rest = text.trim_matches(|c: char| c.is_whitespace() || "NSEWnsew北南東西緯経+-−".contains(c));
    // what is no sign of an angle makes it no angle
    if !rest.chars().all(|c| digits(c) || c.is_whitespace() || "-°º˚'’′\"”″度分秒:".contains(c)) {
        return None;
    }
    let parts: Vec<f64> =
        rest.split(|c| !digits(c)).filter(|part| !part.is_empty()).map(|p| p.parse().ok()).collect::<Option<_>>()?;
    let (minutes, seconds) = (parts.get(1).copied().unwrap_or(0.0), parts.get(2).copied().unwrap_or(0.0));
    if parts.is_empty() || parts.len() > 3 || minutes >= 60.0 || seconds >= 60.0 {
        return None;
    }
    let degrees = parts[0] + minutes / 60.0 + seconds / 3600.0;
    (degrees <= 360.0).then_some(if is_negative { -degrees } else { degrees })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_in_many_hands() {
        let fuji = 35.0 + 21.0 / 60.0 + 38.0 / 3600.0;
        for text in ["35°21'38\"", "北緯35度21分38秒", "35 21 38N", "N35-21-38", "35:21:38", "３５°21′38″"]
        {
            assert!((parse(text).unwrap() - fuji).abs() < 1e-12, "{text}");
        }
        assert_eq!([parse("-33.92"), parse("33.92S"), parse("+7")], [Some(-33.92), Some(-33.92), Some(7.0)]);
        for text in ["", "-", "35.1.2", "35°61'", "400", "1 2 3 4", "abc", "1e5", "unknown 3"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
