//! Small valid files of every format, made by hand.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part of this

use std::io::Write;
use std::path::PathBuf;

/// The height that the fixtures hold at a sample.
pub fn height(column: usize, row: usize) -> f32 {
    ((7 * column + 13 * row) % 97) as f32
}

pub fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/dem").join(name)
}

/// A square of SRTM with no-data in its first sample.
pub fn hgt(side: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(2 * side * side);
    for row in 0..side {
        for column in 0..side {
            bytes.extend((height(column, row) as i16).to_be_bytes());
        }
    }
    bytes[..2].copy_from_slice(&(-32768i16).to_be_bytes());
    bytes
}

/// DTED at 11° E 49° N with 3" steps, no-data in the north-western sample.
pub fn dted(columns: usize, rows: usize) -> Vec<u8> {
    let mut bytes = format!("UHL10110000E0490000N003000300000U  000000000000{columns:04}{rows:04}0").into_bytes();
    bytes.resize(80 + 648 + 2700, b' ');
    for column in 0..columns {
        bytes.push(0xAA);
        bytes.extend([0; 7]);
        for row in (0..rows).rev() {
            let z = height(column, row) as i16 - 40;
            let code = if z < 0 { 0x8000 | z.unsigned_abs() } else { z as u16 };
            let code = if (column, row) == (0, 0) { 0xFFFF } else { code };
            bytes.extend(code.to_be_bytes());
        }
        bytes.extend([0; 4]);
    }
    bytes
}

pub fn asc(columns: usize, rows: usize) -> String {
    let mut text = format!("NROWS {rows}\r\nncols {columns}\r\nyllcorner 100\r\nxllcorner 200\r\ncellsize 2\r\n");
    for row in 0..rows {
        for column in 0..columns {
            text += &format!("{:e} ", height(column, row));
        }
        text += "\r\n";
    }
    text
}

/// An FG-GML mesh whose heights begin at `start` and are `heights`.
pub fn fg_gml(columns: usize, rows: usize, start: [usize; 2], heights: &[f32]) -> String {
    let tuples: String = heights.iter().map(|z| format!("地表面,{z:.2}\n")).collect();
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<Dataset xsi:schemaLocation="http://fgd.gsi.go.jp/spec/2008/FGD_GMLSchema FGD_GMLSchema.xsd" xmlns:gml="http://www.opengis.net/gml/3.2" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns="http://fgd.gsi.go.jp/spec/2008/FGD_GMLSchema" gml:id="Dataset1">
<DEM gml:id="DEM001"><type>10mメッシュ（標高）</type><mesh>523874</mesh><coverage gml:id="DEM001-3">
<gml:boundedBy><gml:Envelope srsName = " fguuid:jgd2011.bl ">
<gml:lowerCorner>35.25 138.5</gml:lowerCorner><gml:upperCorner>35.26 138.52</gml:upperCorner></gml:Envelope></gml:boundedBy>
<gml:gridDomain><gml:Grid dimension="2" gml:id="DEM001-4"><gml:limits><gml:GridEnvelope>
<gml:low>0 0</gml:low><gml:high>{} {}</gml:high></gml:GridEnvelope></gml:limits><gml:axisLabels>x y</gml:axisLabels></gml:Grid></gml:gridDomain>
<gml:rangeSet><gml:DataBlock><gml:rangeParameters><gml:QuantityList uom="DEM構成点"/></gml:rangeParameters><gml:tupleList>
{tuples}</gml:tupleList></gml:DataBlock></gml:rangeSet>
<gml:coverageFunction><gml:GridFunction><gml:sequenceRule order="+x-y">Linear</gml:sequenceRule><gml:startPoint>{} {}</gml:startPoint></gml:GridFunction></gml:coverageFunction>
</coverage></DEM></Dataset>"#,
        columns - 1,
        rows - 1,
        start[0],
        start[1]
    )
}

/// A full mesh of the fixtures' heights.
pub fn full_fg_gml() -> String {
    let heights: Vec<f32> = (0..8 * 6).map(|i| height(i % 8, i / 8)).collect();
    fg_gml(8, 6, [0, 0], &heights)
}

/// An RGB picture from the colours of its pixels.
pub fn png(width: u32, height: u32, rgb: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let pixels: Vec<u8> =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| rgb(x, y)).collect();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    bytes
}

/// Colours of a height in the Terrarium encoding.
pub fn terrarium(z: f32) -> [u8; 3] {
    let code = ((z + 32768.0) * 256.0) as u32;
    [(code >> 16) as u8, (code >> 8) as u8, code as u8]
}

pub fn zip(members: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in members {
        let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
        writer.start_file(*name, options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    writer.write_all(bytes).unwrap();
    writer.finish().unwrap()
}
