//! Places in plan from files: tables of points, and lines as tables or GeoJSON.

use crate::failure::Failure;
use serde_json::Value;
use std::path::Path;
use yamanami::io::IoError;

/// Longest file read.
const MOST_BYTES: u64 = 1 << 30;

/// A table whose rows begin with places, as it was read.
#[derive(Debug)]
pub(crate) struct Table {
    /// The line above the first place, if it holds names.
    pub(crate) header: Option<String>,
    /// The rows, untouched.
    pub(crate) rows: Vec<String>,
    /// The place of each row.
    pub(crate) places: Vec<[f64; 2]>,
    /// What parts the columns.
    pub(crate) separator: char,
}

/// Names of the columns of a place, x before y.
const NAMES: [[&str; 2]; 6] = [
    ["x", "y"],
    ["lon", "lat"],
    ["longitude", "latitude"],
    ["easting", "northing"],
    ["east", "north"],
    ["e", "n"],
];

/// Reads a table of places: columns parted by commas, semicolons, tabs or blanks; x and y are the columns of that name, else
/// the first two. Empty lines and those that begin with # are passed over.
pub(crate) fn table(file: &Path) -> Result<Table, Failure> {
    let text = text(file)?;
    let lines: Vec<(usize, &str)> = (1..)
        .zip(text.lines())
        .map(|(number, line)| (number, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .collect();
    let first = lines.first().map_or("", |(_, line)| line);
    let separator = [',', ';', '\t'].into_iter().find(|&s| first.contains(s)).unwrap_or(' ');
    let fields = |line: &str| -> Vec<String> {
        let trimmed = |f: &str| f.trim().trim_matches('"').to_owned();
        match separator {
            ' ' => line.split_whitespace().map(trimmed).collect(),
            s => line.split(s).map(trimmed).collect(),
        }
    };
    let number = |field: Option<&String>| field.and_then(|f| f.parse::<f64>().ok()).filter(|v| v.is_finite());
    let names: Vec<String> = fields(first).iter().map(|f| f.to_lowercase()).collect();
    let named = NAMES.iter().find_map(|pair| {
        let column = |name: &str| names.iter().position(|n| n == name || n.strip_suffix("_m") == Some(name));
        Some([column(pair[0])?, column(pair[1])?])
    });
    let is_header = named.is_some() || number(names.first()).is_none() || number(names.get(1)).is_none();
    let [x, y] = named.unwrap_or([0, 1]);
    let mut table = Table { header: None, rows: Vec::new(), places: Vec::new(), separator };
    for (k, (line_number, line)) in lines.into_iter().enumerate() {
        if k == 0 && is_header {
            table.header = Some(line.to_owned());
            continue;
        }
        let fields = fields(line);
        let (Some(x), Some(y)) = (number(fields.get(x)), number(fields.get(y))) else {
            return Err(Failure::failed(format!(
                "{}: line {line_number}: expected numbers for x and y, found '{line}'",
                file.display()
            )));
        };
        table.rows.push(line.to_owned());
        table.places.push([x, y]);
    }
    if table.places.is_empty() {
        return Err(Failure::failed(format!("{}: has no places", file.display())));
    }
    Ok(table)
}

/// Reads a line: the first LineString of a GeoJSON file, or the rows of a table.
pub(crate) fn line(file: &Path) -> Result<Vec<[f64; 2]>, Failure> {
    let is_json = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("geojson") || e.eq_ignore_ascii_case("json"));
    let places = if is_json {
        let expected = || Failure::failed(format!("{}: expected GeoJSON with a LineString", file.display()));
        let value: Value = serde_json::from_str(&text(file)?).map_err(|_| expected())?;
        line_string(&value).ok_or_else(expected)?
    } else {
        table(file)?.places
    };
    if places.len() < 2 {
        return Err(Failure::failed(format!("{}: a line needs two places or more", file.display())));
    }
    Ok(places)
}

/// The first LineString in a GeoJSON object.
fn line_string(value: &Value) -> Option<Vec<[f64; 2]>> {
    match value["type"].as_str()? {
        "LineString" => {
            let place = |p: &Value| Some([p[0].as_f64()?, p[1].as_f64()?]);
            value["coordinates"].as_array()?.iter().map(place).collect()
        }
        "Feature" => line_string(&value["geometry"]),
        "FeatureCollection" => value["features"].as_array()?.iter().find_map(line_string),
        "GeometryCollection" => value["geometries"].as_array()?.iter().find_map(line_string),
        _ => None,
    }
}

fn text(file: &Path) -> Result<String, Failure> {
    if crate::inputs::file_bytes(file)? > MOST_BYTES {
        return Err(Failure::failed(format!("{}: larger than 1 GiB", file.display())));
    }
    let bytes = std::fs::read(file).map_err(|e| IoError::io(file, e))?;
    // names may be in any encoding; numbers are in all of them the same
    Ok(String::from_utf8_lossy(&bytes).trim_start_matches('\u{feff}').to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(folder: &Path, name: &str, text: &str) -> std::path::PathBuf {
        let file = folder.join(name);
        std::fs::write(&file, text).unwrap();
        file
    }

    #[test]
    fn columns_are_found_by_name_or_by_order() {
        let folder = tempfile::tempdir().unwrap();
        let read = |text: &str| table(&file(folder.path(), "t.csv", text));
        let named = read("\u{feff}id,Y,X\n\na,2,1\n# no\nb,4.5,3\n").unwrap();
        assert_eq!((named.header.as_deref(), named.places), (Some("id,Y,X"), vec![[1.0, 2.0], [3.0, 4.5]]));
        assert_eq!(read("1 2 7\n3\t4").unwrap().places, [[1.0, 2.0], [3.0, 4.0]]);
        assert_eq!(read("a;b\n-1;2").unwrap().places, [[-1.0, 2.0]]);
        let Err(Failure::Failed(line)) = read("x,y\n1,2\n3,\n") else { panic!("taken") };
        assert!(line.ends_with("line 3: expected numbers for x and y, found '3,'"), "{line}");
        assert!(read("x,y\n").is_err() && read("").is_err());
    }

    #[test]
    fn lines_come_as_geojson_too() {
        let folder = tempfile::tempdir().unwrap();
        let read = |text: &str| line(&file(folder.path(), "l.geojson", text));
        let string = r#"{"type": "LineString", "coordinates": [[1, 2, 9], [3, 4]]}"#;
        let feature = format!(r#"{{"type": "Feature", "geometry": {string}}}"#);
        for text in [string, &feature, &format!(r#"{{"type": "FeatureCollection", "features": [{feature}]}}"#)] {
            assert_eq!(read(text).unwrap(), [[1.0, 2.0], [3.0, 4.0]]);
        }
        assert!(read(r#"{"type": "Point"}"#).is_err() && read("x").is_err());
        assert!(read(r#"{"type": "LineString", "coordinates": [[1, 2]]}"#).is_err());
    }
}
