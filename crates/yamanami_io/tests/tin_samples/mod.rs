//! Small TIN files of every format that is read here, and quantized-mesh tiles of any vertices and triangles.

/// A drawing with all that makes faces and lines.
pub(crate) const DRAWING: &str = include_str!("../fixtures/tin/kinds.dxf");

/// A hydraulic mesh with all kinds of cards.
pub(crate) const HYDRAULIC_MESH: &str = "MESH2D\nMESHNAME \"river bed\"\nNUM_MATERIALS_PER_ELEM 1\n# a comment\n\
    E4Q 1 10 20 30 40 1\nE3T 2 20 50 30 2\nE6T 3 10 11 20 21 22 12 1\nE8Q 4 10 20 30 40 11 21 31 41 1\n\
    E2L 5 10 20 1\nE3T 6 10 20 99 1\n\
    ND 10 0 0 1.5\nND 20 2.0e+000 0 1\nND 30 2 2 1\nND 40 0 3 1\nND 50 4 1 2\n\
    ND 11 1 0 0\nND 21 1.5 .5 0\nND 22 1 1 0\nND 12 .5 .5 0\nND 31 1 3 0\nND 41 0 1 0\nND 60 7 7 7\n\
    NS 10 20 50\nNS 60 -30 \"left bank\"\nNS 10 -20 1\nNS 10 -99\nGM \"something else\"\n";

/// A quantized-mesh tile: 8/376/144 if its name does not say otherwise. Vertices are put in the order of their use.
pub(crate) fn tile(vertices: &[[u16; 3]], triangles: &[[u32; 3]], wide: bool) -> Vec<u8> {
    let mut order = Vec::new();
    let mut place = vec![None; vertices.len()];
    for &i in triangles.iter().flatten() {
        place[i as usize].get_or_insert_with(|| {
            order.push(vertices[i as usize]);
            order.len() as u32 - 1
        });
    }
    let mut bytes = Vec::new();
    // the middle of 84.375° to 85.078125° east, 11.25° to 11.953125° north, on the ellipsoid
    let (lon, lat) = (84.726_562_5_f64.to_radians(), 11.601_562_5_f64.to_radians());
    let normal_m = 6_378_137.0 / (1.0 - 0.006_694_379_990_141_317 * lat.sin().powi(2)).sqrt();
    let centre = [
        normal_m * lat.cos() * lon.cos(),
        normal_m * lat.cos() * lon.sin(),
        normal_m * 0.993_305_620_009_858_7 * lat.sin(),
    ];
    centre.iter().for_each(|c| bytes.extend(c.to_le_bytes()));
    bytes.extend(100f32.to_le_bytes());
    bytes.extend(900f32.to_le_bytes());
    [centre[0], centre[1], centre[2], 55_000.0, 0.0, 0.0, 1.0].iter().for_each(|d: &f64| bytes.extend(d.to_le_bytes()));
    bytes.extend((order.len() as u32).to_le_bytes());
    for axis in 0..3 {
        let mut last = 0i32;
        for vertex in &order {
            let step = i32::from(vertex[axis]) - last;
            last = i32::from(vertex[axis]);
            bytes.extend((((step << 1) ^ (step >> 31)) as u16).to_le_bytes());
        }
    }
    let put = |bytes: &mut Vec<u8>, number: u32| {
        if wide { bytes.extend(number.to_le_bytes()) } else { bytes.extend((number as u16).to_le_bytes()) }
    };
    while bytes.len() % if wide { 4 } else { 2 } > 0 {
        bytes.push(0);
    }
    bytes.extend((triangles.len() as u32).to_le_bytes());
    let mut mark = 0;
    for &i in triangles.iter().flatten() {
        let corner = place[i as usize].unwrap_or_default();
        put(&mut bytes, mark - corner);
        mark += u32::from(corner == mark);
    }
    for (axis, value) in [(0, 0), (1, 0), (0, 32767), (1, 32767)] {
        let on_side: Vec<usize> = (0..order.len()).filter(|&i| order[i][axis] == value).collect();
        bytes.extend((on_side.len() as u32).to_le_bytes());
        on_side.iter().for_each(|&i| put(&mut bytes, i as u32));
    }
    for (kind, content) in [(1u8, vec![7; 2 * order.len()]), (2, vec![0]), (9, b"whatever".to_vec())] {
        bytes.push(kind);
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(content);
    }
    bytes
}

/// A tile of `size` by `size` vertices.
pub(crate) fn grid_tile(size: u32, wide: bool) -> Vec<u8> {
    let at = |k: u32| (f64::from(k % size) / f64::from(size - 1) * 32767.0).round() as u16;
    let vertices: Vec<[u16; 3]> = (0..size * size).map(|k| [at(k), at(k / size), (k * 7919 % 32768) as u16]).collect();
    let corners = (0..size * size).filter(|k| k % size + 1 < size && k / size + 1 < size);
    let triangles: Vec<[u32; 3]> =
        corners.flat_map(|k| [[k, k + 1, k + size + 1], [k, k + size + 1, k + size]]).collect();
    tile(&vertices, &triangles, wide)
}

/// Names and bytes.
#[allow(dead_code, reason = "not every test takes all of them")]
pub(crate) fn samples() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.dxf", DRAWING.into()),
        ("a.2dm", HYDRAULIC_MESH.into()),
        ("a.terrain", grid_tile(5, false)),
        ("a_z8_x376_y144.terrain", grid_tile(4, true)),
    ]
}
