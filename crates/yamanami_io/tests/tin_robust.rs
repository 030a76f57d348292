//! Bad TIN files: one clear line each or a TIN that keeps its promises, no panic, and never much more memory than the file
//! deserves.

mod damage;
mod tin_xml_samples;

use damage::{Noise, largest_piece};
use proptest::prelude::*;
use robust::{Coord, orient2d};
use tin_xml_samples::{FACES, METRES, ONE, TWO, city_model, landxml, tin_relief};
use yamanami_io::tin_file::{TinReadOptions, read_tin_from_bytes};

/// Most bytes at once for files of a few kilobytes.
const MOST: usize = 16 << 20;

/// Small files with something of everything.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let source = "<SourceData><Breaklines><Breakline brkType=\"wall\"><PntList3D>0 0 1 5 5 2</PntList3D></Breakline>\
        <Breakline><PntList2D>0 0 5 5</PntList2D></Breakline></Breaklines>\
        <Boundaries><Boundary bndType=\"outer\"><PntList3D>0 0 1 0 9 2 9 9 3</PntList3D></Boundary></Boundaries></SourceData>";
    let before = "<CgPoints><CgPoint name=\"A\">1 2 3</CgPoint></CgPoints>\
        <CoordinateSystem name=\"C\" horizontalDatum=\"JGD2011\" horizontalCoordinateSystemName=\"9(X,Y)\"/>";
    let faces = format!("{FACES}<F i=\"1\">3 4 5</F><F>3 4 7 900000</F>");
    let point = "<P id=\"5\" pntRef=\"A\"/></Pnts>";
    let metres = landxml(METRES, before, source, &faces).replace("</Pnts>", point);
    let feet = landxml("<Imperial linearUnit=\"foot\"/>", before, source, &faces).replace("</Pnts>", point);
    let declared = feet.replace("<?xml version=\"1.0\"?>", "<?xml version=\"1.0\" encoding=\"Shift_JIS\"?>");
    let lines = "<dem:BreaklineRelief><dem:breaklines><gml:LineString><gml:posList>0 0 1 10 10 3</gml:posList>\
        </gml:LineString></dem:breaklines></dem:BreaklineRelief>";
    let degrees = [
        "35 139 1 35 139.1 2 35.1 139.1 3 35 139 1",
        "35 139 1 35.1 139.1 3 35 139.1 4 35 139 1 35 139 1",
    ];
    vec![
        ("a.xml", metres.into_bytes()),
        ("b.landxml", declared.into_bytes()),
        ("c.gml", city_model("EPSG:25832", &[&tin_relief("a", 1, &[ONE, TWO]), lines].concat()).into_bytes()),
        ("d.gml", city_model("urn:ogc:def:crs:EPSG::6697", &tin_relief("a", 1, &degrees)).into_bytes()),
    ]
}

/// Reads a file; what comes out keeps the promises that reading makes.
fn read(name: &str, bytes: &[u8]) -> Result<(), String> {
    let (read, largest) = largest_piece(|| read_tin_from_bytes(name, bytes, &TinReadOptions::default()));
    assert!(largest < MOST, "{name}: {largest} bytes at once");
    match read {
        Ok(read) => {
            let (tin, vertices) = (&read.tin, read.tin.mesh.positions.len());
            assert!(tin.mesh.positions.iter().all(|p| p.is_finite()) && !tin.mesh.triangles.is_empty());
            for t in tin.mesh.triangles.iter().chain(&tin.hidden) {
                assert!(t.iter().all(|&i| (i as usize) < vertices), "{t:?} of {vertices}");
                let [a, b, c] = t.map(|i| tin.mesh.positions[i as usize]).map(|p| Coord { x: p.x, y: p.y });
                assert!(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "{t:?}");
                let area = orient2d(a, b, c);
                assert!(area >= 0.0 || area.is_nan(), "{area}");
            }
            assert!(
                tin.breaklines.iter().all(|line| line.points.len() > 1 && line.points.iter().all(|p| p.is_finite()))
            );
            assert!(tin.unit_m.is_finite() && tin.unit_m > 0.0 && read.notes.iter().all(|note| !note.contains('\n')));
            Ok(())
        }
        Err(error) => {
            let line = error.to_string();
            assert!(!line.contains('\n') && line.starts_with(name), "{line}");
            Err(line)
        }
    }
}

#[test]
fn every_sample_is_read() {
    for (name, bytes) in samples() {
        assert_eq!(read(name, &bytes), Ok(()), "{name}");
        for length in 0..bytes.len() {
            let _ = read(name, &bytes[..length]);
        }
    }
}

#[test]
fn bytes_flipped_cut_and_spliced_never_panic() {
    let samples = samples();
    let mut noise = Noise(0x5eed_5eed_5eed_5eed);
    for case in 0..10_000 {
        let bytes = noise.damaged(case % samples.len(), &samples);
        let _ = read(samples[case % samples.len()].0, &bytes);
    }
}

proptest! {
    #[test]
    fn any_bytes_are_an_error_or_a_tin(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for name in ["a.xml", "a.gml", "a.xml.gz", "a.xml.zst"] {
            let _ = read(name, &bytes);
        }
        let _ = read("a.xml", &[b"<LandXML><Surface>", &bytes[..]].concat());
    }
}

#[test]
fn large_numbers_and_packed_nothing_take_no_memory() {
    // ids that lie far apart
    let points: String = (1..5000u64).map(|i| format!("<P id=\"{}\">0 {i} 0</P>", i * 60_000)).collect();
    let text = landxml(METRES, "", "", FACES).replace("</Pnts>", &(points + "</Pnts>"));
    assert_eq!(read("a.xml", text.as_bytes()), Ok(()));
    let huge = landxml(METRES, "", "", "<F>7 900000 18446744073709551615</F><F>7 3 4</F>")
        .replace("\"7\">0 0", "\"7\">1e308 -1e308");
    let _ = read("a.xml", huge.replace("meter", "kilometer").as_bytes());
    // 128 MiB of blanks, packed: a text is not kept beyond its limit
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    for _ in 0..128 {
        std::io::Write::write_all(&mut packer, &vec![b' '; 1 << 20]).unwrap();
    }
    let packed = packer.finish().unwrap();
    let (read, largest) = largest_piece(|| read_tin_from_bytes("a.xml.gz", &packed, &TinReadOptions::default()));
    let line = read.unwrap_err().to_string();
    assert!(line.ends_with("a tag or a text of more than 67108864 bytes") && largest <= 128 << 20, "{line} {largest}");
}
