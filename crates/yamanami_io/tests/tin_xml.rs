//! Small LandXML and CityGML files: what the real ones do not have, and what is wrong with some.

mod tin_xml_samples;

use glam::DVec3;
use tin_xml_samples::{FACES, METRES, ONE, TWO, city_model, comes_back, landxml, parse, tin_relief};
use yamanami_core::{Breakline, BreaklineKind, FOOT_M, US_SURVEY_FOOT_M};
use yamanami_io::crs;
use yamanami_io::tin_file::{TinReadOptions, read_tin_from_bytes};

#[test]
fn points_are_northing_easting_and_ids_are_no_offsets() {
    // the second face is clockwise
    let read = parse(&landxml(METRES, "", "", "<F>7 900000 3</F><F i=\"1\">3 7 4</F><F>4 3 7</F>")).unwrap();
    let tin = read.tin;
    assert_eq!(tin.name, "ground & more");
    assert_eq!(tin.mesh.positions[1], DVec3::new(10.0, 0.0, 2.0));
    assert_eq!(tin.mesh.triangles, [[0, 1, 2], [3, 0, 2]]);
    assert_eq!(tin.hidden, [[2, 3, 0]]);
    assert_eq!(read.notes, ["2 triangles that faced down turned up"]);
}

#[test]
fn units_become_metres() {
    for (unit, metres) in [
        ("<Metric linearUnit=\"millimeter\"/>", 0.001),
        ("<Metric linearUnit=\"kilometer\"/>", 1000.0),
        ("<Imperial linearUnit=\"foot\"/>", FOOT_M),
        ("<Imperial linearUnit=\"USSurveyFoot\"/>", US_SURVEY_FOOT_M),
        ("<Imperial linearUnit=\"inch\"/>", 0.0254),
        ("<Imperial linearUnit=\"mile\"/>", 1609.344),
    ] {
        let read = parse(&landxml(unit, "", "", FACES)).unwrap();
        assert_eq!((read.tin.unit_m, read.tin.mesh.positions[2]), (metres, DVec3::new(10.0, 10.0, 3.0) * metres));
        assert_eq!(read.notes, Vec::<String>::new());
        comes_back(&read.tin, "a.xml");
    }
    let read = parse(&landxml("<Metric linearUnit=\"parsec\"/>", "", "", FACES)).unwrap();
    assert_eq!(read.notes, ["line 3: unit 'parsec' is not known, metres assumed"]);
    let text = landxml("", "", "", FACES);
    assert_eq!(parse(&text).unwrap().notes, ["no unit is stated, metres assumed"]);
    let options = TinReadOptions { unit_m: Some(0.001), epsg: Some(6670), ..TinReadOptions::default() };
    let read = read_tin_from_bytes("a.xml", text.as_bytes(), &options).unwrap();
    assert_eq!((read.tin.mesh.positions[3].z, read.tin.crs), (0.004, crs::from_epsg(6670).unwrap()));
    let options = TinReadOptions { unit_m: Some(-1.0), ..TinReadOptions::default() };
    assert!(read_tin_from_bytes("a.xml", text.as_bytes(), &options).is_err());
}

#[test]
fn coordinate_systems_by_code_or_by_words() {
    for (words, epsg) in [
        ("epsgCode=\"6677\" name=\"zone\"", 6677),
        (
            "name=\"CRS1\" horizontalDatum=\"JGD2011\" horizontalCoordinateSystemName=\"9(X,Y)\" verticalDatum=\"T.P\"",
            6677,
        ),
        ("name=\"CRS1\" horizontalDatum=\"JGD2000\" horizontalCoordinateSystemName=\"１２(X,Y)\"", 2454),
        ("desc=\"JGD2011 / 9(X,Y)\"", 6677),
        ("name=\"平面直角座標系 第8系\" horizontalDatum=\"JGD2011\"", 6676),
        ("name=\"EPSG:32654\"", 32654),
    ] {
        let read = parse(&landxml(METRES, &format!("<CoordinateSystem {words}/>"), "", FACES)).unwrap();
        assert_eq!((read.tin.crs, read.notes), (crs::from_epsg(epsg).unwrap(), vec![]), "{words}");
    }
    let read = parse(&landxml(METRES, "<CoordinateSystem name=\"site grid\"/>", "", FACES)).unwrap();
    assert_eq!((read.tin.crs.epsg, read.tin.crs.name.as_str(), read.notes.len()), (None, "site grid", 1));
    comes_back(&read.tin, "a.xml");
    let words = "<CoordinateSystem epsgCode=\"2264\" name=\"NAD83 / North Carolina (ftUS)\"/>";
    let read = parse(&landxml(METRES, words, "", FACES)).unwrap();
    assert_eq!((read.tin.crs.epsg, read.tin.crs.name.as_str()), (Some(2264), "NAD83 / North Carolina (ftUS)"));
    comes_back(&read.tin, "a.xml");
}

#[test]
fn breaklines_and_boundaries() {
    let source = "<SourceData><Breaklines>\
        <Breakline brkType=\"standard\" name=\"ridge\"><PntList3D>0 0 1 5 5 2 10 10 3</PntList3D></Breakline>\
        <Breakline brkType=\"proximity\"><PntList2D>0.1 9.9 9 9</PntList2D></Breakline>\
        <Breakline brkType=\"wall\"><PntList3D>0 0 1 5 5</PntList3D></Breakline></Breaklines>\
        <Boundaries><Boundary bndType=\"outer\" edgeTrim=\"false\"><PntList3D>0 0 1 0 10 2 10 10 3</PntList3D></Boundary>\
        <Boundary bndType=\"void\" name=\"\"><PntList3D>1 1 1 2 1 2 2 2 3</PntList3D></Boundary></Boundaries>\
        <Contours><Contour elev=\"1\"><PntList2D>0 0 1 1</PntList2D></Contour></Contours></SourceData>";
    let read = parse(&landxml(METRES, "", source, FACES)).unwrap();
    let line = |name: &str, kind, points: &[[f64; 3]]| Breakline {
        name: name.into(),
        kind,
        points: points.iter().map(|&p| DVec3::from(p)).collect(),
    };
    let expected = [
        line("ridge", BreaklineKind::Hard, &[[0.0, 0.0, 1.0], [5.0, 5.0, 2.0], [10.0, 10.0, 3.0]]),
        line("", BreaklineKind::Soft, &[[9.9, 0.1, 2.0], [9.0, 9.0, 3.0]]),
        line("outer", BreaklineKind::Boundary, &[[0.0, 0.0, 1.0], [10.0, 0.0, 2.0], [10.0, 10.0, 3.0]]),
        line("", BreaklineKind::Boundary, &[[1.0, 1.0, 1.0], [1.0, 2.0, 2.0], [2.0, 2.0, 3.0]]),
    ];
    assert_eq!(read.tin.breaklines, expected);
    assert_eq!(
        read.notes,
        [
            "1 lines without heights: those of the nearest points taken",
            "breaklines that are not a list of points dropped: 1, first at line 5",
            "contours not read: 1, first at line 5",
        ]
    );
    comes_back(&read.tin, "a.xml");
}

#[test]
fn what_is_wrong_is_dropped_and_told_once_a_kind() {
    let faces =
        "<F>7 3 3</F>\n<F>7 3 99</F>\n<F>7 3</F>\n<F>7 900000 3</F>\n<F>4 4 3</F>\n<F>7 900000 3 4</F>\n<F>a b c</F>";
    let text = landxml(METRES, "", "", faces).replace(
        "</Pnts>",
        "<P id=\"3\">9 9 9</P>\n<P id=\"20\">1 2 nan</P>\n<P id=\"21\">1 2</P>\n<P>1 2 3</P>\n<P id=\"22\" pntRef=\"A\"/></Pnts>",
    );
    let read = parse(&text).unwrap();
    assert_eq!((read.tin.mesh.positions.len(), read.tin.mesh.triangles.len()), (4, 3));
    assert_eq!(
        read.notes,
        [
            "points without a place within 1e12 m dropped: 1, first point 5",
            "points with the id of another one dropped: 1, first at line 11",
            "points that are not three numbers dropped: 2, first at line 12",
            "points without an id above zero dropped: 1, first at line 14",
            "faces with a point twice dropped: 2, first at line 17",
            "faces with a point that is not there dropped: 1, first at line 18",
            "faces that are not three or four ids dropped: 2, first at line 19",
            "faces of four points cut in two: 1, first at line 22",
            "points at a survey point that is not there: 1, first at 'A'",
        ]
    );
}

#[test]
fn survey_points_may_be_named() {
    let points = "<CgPoints><CgPoint name=\"A\">20 30 5</CgPoint></CgPoints>";
    let text = landxml(METRES, points, "", "<F>7 900000 8</F>").replace("</Pnts>", "<P id=\"8\" pntRef=\"A\"/></Pnts>");
    assert_eq!(parse(&text).unwrap().tin.mesh.positions[4], DVec3::new(30.0, 20.0, 5.0));
}

#[test]
fn the_surface_with_most_faces_or_the_one_that_is_named() {
    let surface = |name: &str, faces: &str| {
        landxml(METRES, "", "", faces)
            .split_once("<Surfaces>")
            .unwrap()
            .1
            .split_once("</Surfaces>")
            .unwrap()
            .0
            .replace("ground &amp; more", name)
    };
    let surfaces = [surface("a", "<F>7 900000 3</F>"), surface("b", FACES), surface("points", "")].concat();
    let text = format!("<LandXML><Units>{METRES}</Units><Surfaces>{surfaces}</Surfaces></LandXML>");
    let read = parse(&text).unwrap();
    assert_eq!((read.tin.name.as_str(), read.other_surfaces), ("b", vec!["a".to_owned(), "points".to_owned()]));
    let named = |name: &str| {
        let options = TinReadOptions { surface: Some(name.into()), ..TinReadOptions::default() };
        read_tin_from_bytes("a.xml", text.as_bytes(), &options).map_err(|e| e.to_string())
    };
    let read = named("a").unwrap();
    assert_eq!((read.tin.name.as_str(), read.other_surfaces), ("a", vec!["b".to_owned(), "points".to_owned()]));
    assert_eq!(named("c").unwrap_err(), "a.xml: Surfaces: expected a surface 'c', found 'a', 'b', 'points'");
    let points = "a.xml: surface 'points': expected faces that are shown, found 4 points, 0 hidden faces, 0 lines";
    assert_eq!(named("points").unwrap_err(), points);
}

#[test]
fn old_encodings_are_read() {
    let text = landxml(METRES, "", "", FACES).replace("ground &amp; more", "現況地形");
    for (label, encoding) in [
        ("Shift_JIS", encoding_rs::SHIFT_JIS),
        ("cp932", encoding_rs::SHIFT_JIS),
        ("EUC-JP", encoding_rs::EUC_JP),
        ("utf-8", encoding_rs::UTF_8),
    ] {
        let text = text.replace("<?xml version=\"1.0\"?>", &format!("<?xml version='1.0' encoding='{label}'?>"));
        let bytes = encoding.encode(&text).0;
        let read = read_tin_from_bytes("a.xml", &bytes, &TinReadOptions::default()).unwrap();
        assert_eq!(read.tin.name, "現況地形", "{label}");
    }
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(read_tin_from_bytes("a.xml", &wide, &TinReadOptions::default()).unwrap().tin.name, "現況地形");
    // undeclared Shift_JIS: the name is lost, the numbers are not
    let bytes = encoding_rs::SHIFT_JIS.encode(&text).0;
    let read = read_tin_from_bytes("a.xml", &bytes, &TinReadOptions::default()).unwrap();
    assert_eq!(read.tin.mesh.triangles.len(), 2);
}

#[test]
fn errors_are_one_line_with_their_place() {
    for (text, expected) in [
        ("", "a.xml: line 1: expected <LandXML>, <CityModel> or, of an elevation grid, <Dataset>, found no element"),
        ("<html/>", "a.xml: line 1: expected <LandXML>, <CityModel> or, of an elevation grid, <Dataset>, found <html>"),
        ("<LandXML>\n</LandXML>", "a.xml: Surfaces: expected a surface, found none"),
        ("<LandXML>\n<Units>", "a.xml: line 2: expected the ends of all elements, found the end of the file"),
        ("<CityModel/>", "a.xml: TINRelief: expected triangles, found none, and 0 lines"),
    ] {
        assert_eq!(parse(text).unwrap_err(), expected);
    }
    let line = parse("<LandXML>\n<Units>\n</Surfaces></LandXML>").unwrap_err();
    assert!(line.starts_with("a.xml: line 3: expected well-formed XML, found ") && !line.contains('\n'), "{line}");
    let line = parse(&"<a>".repeat(5000).replacen("<a>", "<LandXML>", 1)).unwrap_err();
    assert_eq!(line, "a.xml: line 1: expected at most 1000 elements inside each other, found more than 1000");
}

#[test]
fn citygml_in_metres() {
    let relief = [tin_relief("a", 1, &[ONE]), tin_relief("b", 1, &[TWO])].concat();
    let tin = parse(&city_model("EPSG:25832", &relief)).unwrap().tin;
    assert_eq!((tin.name.as_str(), tin.crs.epsg), ("a", Some(25832)));
    assert_eq!((tin.mesh.positions.len(), tin.mesh.triangles), (4, vec![[0, 1, 2], [0, 2, 3]]));
    // the registry's order of a plane rectangular zone: north first
    let tin = parse(&city_model("urn:ogc:def:crs:EPSG::6677", &relief)).unwrap().tin;
    assert_eq!(tin.mesh.positions[1], DVec3::new(0.0, 10.0, 2.0));
    let options = TinReadOptions { surface: Some("b".into()), ..TinReadOptions::default() };
    let read = read_tin_from_bytes("a.gml", city_model("EPSG:25832", &relief).as_bytes(), &options).unwrap();
    assert_eq!((read.tin.mesh.triangles.len(), read.other_surfaces), (1, vec!["a".to_owned()]));
}

#[test]
fn citygml_that_is_wrong_in_places() {
    let rings = [
        ONE,
        "0 0 1 10 10 3 0 10 4",
        "0 0 1 10 0 2 0 0 1",
        "0 0 1 10 0 nan 10 10 3 0 0 1",
        "20 0 1 30 0 1 30 10 1 20 10 1 20 0 1",
        "0 0 0 10 0 0 1 1 0 0 10 0 0 0 0",
        "0 0 1 0 0 1 10 10 3 0 0 1",
    ];
    let masses = "<dem:MassPointRelief><dem:reliefPoints/></dem:MassPointRelief>";
    let lines = "<dem:BreaklineRelief><dem:breaklines><gml:MultiCurve><gml:curveMember><gml:LineString>\
        <gml:posList>0 0 1 10 10 3</gml:posList></gml:LineString></gml:curveMember></gml:MultiCurve></dem:breaklines></dem:BreaklineRelief>";
    let coarse = tin_relief("coarse", 0, &[TWO]);
    let text = city_model("EPSG:32654", &[tin_relief("a", 1, &rings).as_str(), masses, lines, &coarse].concat());
    let read = parse(&text).unwrap();
    assert_eq!((read.tin.mesh.triangles.len(), read.tin.breaklines.len()), (4, 1));
    assert_eq!(
        read.notes,
        [
            "rings that are not closed, closed: 1, first at line 5",
            "rings that are not three points or more dropped: 2, first at line 6",
            "rings of more than three corners cut into triangles: 1, first at line 8",
            "rings of more than three corners that are not convex dropped: 1, first at line 9",
            "triangles with a point twice dropped: 1, first at line 10",
            "reliefs of mass points not read: 1, first at line 11",
            "reliefs of other than the finest level of detail left out: 1, first at line 11",
        ]
    );
    let line = parse(&city_model("urn:x:y", &tin_relief("a", 1, &[ONE]))).unwrap_err();
    assert!(line.contains("look like degrees"), "{line}");
}

#[test]
fn citygml_in_degrees_of_either_order() {
    let ring = |swap: bool| {
        let corner = |lat: f64, lon: f64| if swap { format!("{lon} {lat} 5 ") } else { format!("{lat} {lon} 5 ") };
        [corner(35.0, 139.0), corner(35.0, 139.001), corner(35.001, 139.0), corner(35.0, 139.0)].concat()
    };
    let read = |swap| {
        parse(&city_model("http://www.opengis.net/def/crs/EPSG/0/4326", &tin_relief("", 1, &[&ring(swap)]))).unwrap()
    };
    let (latitude_first, longitude_first) = (read(false), read(true));
    assert_eq!(latitude_first.tin, longitude_first.tin);
    assert_eq!((latitude_first.notes.len(), longitude_first.notes.len()), (1, 2));
    assert_eq!(latitude_first.tin.crs, crs::from_epsg(32654).unwrap());
    assert_eq!(latitude_first.tin.mesh.triangles, [[0, 1, 2]]);
}
