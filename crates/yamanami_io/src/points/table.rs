//! Tables of text: what parts the fields, and which fields are the coordinates.

use super::ColumnOrder;

/// What parts the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Delimiter {
    Byte(u8),
    /// Any number of spaces and tabs.
    Space,
}

impl Delimiter {
    /// The one that a line has.
    pub(super) fn of(line: &[u8]) -> Self {
        match [b';', b',', b'\t'].into_iter().find(|d| line.contains(d)) {
            Some(b'\t') | None => Self::Space,
            Some(d) => Self::Byte(d),
        }
    }

    /// The fields of a line, without spaces and quotes around them.
    pub(super) fn split(self, line: &[u8]) -> Vec<&[u8]> {
        match self {
            Self::Byte(d) => line.split(|&b| b == d).map(bare).collect(),
            Self::Space => line.split(u8::is_ascii_whitespace).filter(|f| !f.is_empty()).map(bare).collect(),
        }
    }
}

fn bare(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    field.strip_prefix(b"\"").and_then(|f| f.strip_suffix(b"\"")).unwrap_or(field)
}

/// A field that is a finite number.
pub(super) fn number(field: &[u8]) -> Option<f64> {
    let value: f64 = std::str::from_utf8(field).ok()?.parse().ok()?;
    value.is_finite().then_some(value)
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    X,
    Y,
    East,
    North,
    Height,
    Name,
    Degrees,
}

/// Names of columns. The X座標 (x coordinate) of Japanese surveys is north.
const NAMES: &[(Role, &[&str])] = &[
    (Role::X, &["x", "x(m)", "x[m]"]),
    (Role::Y, &["y", "y(m)", "y[m]"]),
    (Role::East, &["e", "east", "easting", "東", "東距", "東座標", "y座標", "ｙ座標"]),
    (Role::North, &["n", "north", "northing", "北", "北距", "北座標", "x座標", "ｘ座標"]),
    (
        Role::Height,
        &[
            "z",
            "h",
            "elev",
            "elevation",
            "height",
            "alt",
            "altitude",
            "標高",
            "高さ",
            "z座標",
            "ｚ座標",
            "z(m)",
            "z[m]",
        ],
    ),
    (Role::Name, &["line", "line id", "line_id", "name", "線", "線名"]),
    (Role::Degrees, &["lat", "lon", "lng", "latitude", "longitude", "緯度", "経度"]),
];

/// How the same names start in Shift_JIS, as Japanese survey programs write them.
const SHIFT_JIS: &[(Role, &[u8])] = &[
    (Role::Height, b"\x95\x57\x8d\x82"),
    (Role::Height, b"\x8d\x82\x82\xb3"),
    (Role::East, b"\x93\x8c"),
    (Role::North, b"\x96\x6b"),
    (Role::North, b"X\x8d\xc0\x95\x57"),
    (Role::East, b"Y\x8d\xc0\x95\x57"),
    (Role::Height, b"Z\x8d\xc0\x95\x57"),
];

fn role(field: &[u8]) -> Option<Role> {
    let Ok(name) = std::str::from_utf8(field) else {
        return SHIFT_JIS.iter().find(|(_, name)| field.starts_with(name)).map(|&(role, _)| role);
    };
    let name = name.to_lowercase();
    NAMES.iter().find(|(_, names)| names.contains(&name.as_str())).map(|&(role, _)| role)
}

/// Which fields are what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Columns {
    pub(super) east: usize,
    pub(super) north: usize,
    pub(super) height: usize,
    /// Name of the line.
    pub(super) name: Option<usize>,
}

/// What a header says.
pub(super) enum Header {
    Columns(Columns),
    /// Longitudes and latitudes.
    Degrees,
    /// It is none.
    No,
}

impl Columns {
    /// By the names in a header.
    pub(super) fn of_header(fields: &[&[u8]], order: ColumnOrder) -> Header {
        let roles: Vec<Option<Role>> = fields.iter().map(|f| role(f)).collect();
        let find = |role: Role| roles.iter().position(|&r| r == Some(role));
        let name = find(Role::Name);
        let (named, plain) = ((find(Role::East), find(Role::North)), (find(Role::X), find(Role::Y)));
        match (named, plain, find(Role::Height)) {
            ((Some(east), Some(north)), _, Some(height)) => Header::Columns(Self { east, north, height, name }),
            (_, (Some(x), Some(y)), Some(height)) => Header::Columns(Self::ordered(x, y, height, name, order)),
            _ if roles.contains(&Some(Role::Degrees)) => Header::Degrees,
            _ => Header::No,
        }
    }

    /// By place, from the first line of numbers: three coordinates, after a number or name of the point if there is one.
    /// A first number counts as the point's if it is whole while those after it are not.
    pub(super) fn of_numbers(fields: &[&[u8]], order: ColumnOrder) -> Option<Self> {
        let are_numbers =
            |from: usize| fields.get(from..from + 3).is_some_and(|f| f.iter().all(|f| number(f).is_some()));
        let is_whole = |field: &[u8]| !field.contains(&b'.');
        let with_point = are_numbers(1)
            && (number(fields[0]).is_none() || is_whole(fields[0]) && !is_whole(fields[1]) && !is_whole(fields[2]));
        match () {
            () if with_point => Some(Self::ordered(1, 2, 3, None, order)),
            () if are_numbers(0) => Some(Self::ordered(0, 1, 2, None, order)),
            () => None,
        }
    }

    /// Columns with what is first as the order says.
    pub(super) fn ordered(first: usize, second: usize, height: usize, name: Option<usize>, order: ColumnOrder) -> Self {
        let (east, north) = match order {
            ColumnOrder::EastNorth => (first, second),
            ColumnOrder::NorthEast => (second, first),
        };
        Self { east, north, height, name }
    }
}
