//! TINs as a user goes: made, converted, built, told, measured, drawn, extracted; and what is wrong with some.

mod common;

use common::{error, json, run, stdout};
use std::path::Path;

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).unwrap();
}

/// A LandXML surface of points `northing easting height`, numbered from 1, and faces.
fn landxml(points: &str, faces: &str, lines: &str) -> String {
    let points: String =
        points.split(", ").enumerate().map(|(i, p)| format!("<P id=\"{}\">{p}</P>\n", i + 1)).collect();
    let faces: String = faces.split(", ").filter(|f| !f.is_empty()).map(|f| format!("<F>{f}</F>\n")).collect();
    let lines: String = lines.split(", ").filter(|l| !l.is_empty()).map(line_of).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" version=\"1.2\">\n\
         <Units><Metric linearUnit=\"meter\" areaUnit=\"squareMeter\" volumeUnit=\"cubicMeter\"/></Units>\n\
         <Surfaces><Surface name=\"s\"><SourceData><Breaklines>{lines}</Breaklines></SourceData>\n\
         <Definition surfType=\"TIN\"><Pnts>\n{points}</Pnts><Faces>\n{faces}</Faces></Definition></Surface></Surfaces>\n\
         </LandXML>\n"
    )
}

fn line_of(points: &str) -> String {
    format!("<Breakline brkType=\"standard\"><PntList3D>{points}</PntList3D></Breakline>\n")
}

const SQUARE: &str = "0 0 1, 0 10 2, 10 10 3, 10 0 4";
const FACES: &str = "1 2 3, 1 3 4";

fn nothing_at(folder: &Path, name: &str) {
    let left: Vec<_> = std::fs::read_dir(folder).unwrap().flatten().map(|e| e.file_name()).collect();
    assert!(left.iter().all(|n| !n.to_string_lossy().starts_with(name)), "{left:?}");
}

#[test]
fn a_tin_goes_through_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert!(stdout(folder, "generate tin -o %/a.xml --size 41x31 --spacing 8 --seed 3").contains("a road and a river"));
    let told = json(folder, "tin %/a.xml -o %/a.yama");
    let number = |value: &serde_json::Value, key: &str| value[key].as_u64().unwrap_or_else(|| panic!("{key}: {value}"));
    let (triangles, vertices) = (number(&told, "triangles"), number(&told, "vertices"));
    assert!(triangles > 2000 && number(&told, "source_triangles") == triangles);
    assert!(number(&told, "breaklines") >= 4 && told["notes"].as_array().is_some_and(Vec::is_empty), "{told}");
    assert_eq!((told["unit_m"].as_f64(), told["crs_epsg"].is_null()), (Some(1.0), true));

    let built = json(folder, "build %/a.xml -o %/b.yama");
    assert_eq!((number(&built, "faces"), number(&built, "vertices")), (triangles, vertices));
    assert_eq!(built["max_error_m"].as_f64(), Some(0.0));
    let info = json(folder, "info %/b.yama --verify");
    assert_eq!((number(&info, "faces"), info["verified"].as_bool()), (triangles, Some(true)));
    for source in ["a.xml", "b.yama"] {
        assert!(stdout(folder, &format!("info %/{source}")).contains("TIN"), "{source}");
    }
    // everything comes out of the database as it went in
    for name in ["c.xml", "c.dxf", "c.2dm"] {
        let again = json(folder, &format!("tin %/b.yama -o %/{name}"));
        assert_eq!(
            (number(&again, "triangles"), number(&again, "breaklines")),
            (triangles, number(&told, "breaklines"))
        );
        let apart = json(folder, &format!("compare %/a.xml %/{name} --samples 1000"));
        assert_eq!(
            (apart["max_vertical_m"].as_f64(), apart["rms_vertical_m"].as_f64()),
            (Some(0.0), Some(0.0)),
            "{name}"
        );
    }
    stdout(folder, "tin %/b.yama -o %/c.gpkg");

    // both by the paper's way and by ours
    for method in ["collapse", "hiraoka"] {
        let thin = json(folder, &format!("tin %/a.xml --levels 2 --method {method} -o %/thin.xml"));
        let levels = thin["levels"].as_array().unwrap();
        assert!(levels.len() == 2 && number(&thin, "triangles") < triangles * 2 / 5, "{thin}");
        let judged = json(folder, "compare %/a.xml %/thin.xml --samples 1000");
        let off = |key: &str| judged[key].as_f64().unwrap() - levels[1][key].as_f64().unwrap();
        assert!(off("max_vertical_m").abs() < 1e-9 && off("rms_vertical_m").abs() < 1e-9, "{judged} {thin}");
    }

    for source in ["a.xml", "b.yama"] {
        let mut last = u64::MAX;
        for tolerance in ["0", "1", "100"] {
            let part = json(folder, &format!("extract %/{source} --tolerance {tolerance} --check -o %/part.xml"));
            assert!(number(&part, "triangles") < last, "{part}");
            last = number(&part, "triangles");
            let apart = json(folder, "compare %/a.xml %/part.xml --samples 1000");
            assert!(apart["max_vertical_m"].as_f64().unwrap() <= tolerance.parse().unwrap(), "{apart}");
        }
        let heights = json(folder, &format!("heights %/{source} --at 100,100 --at -5,7"));
        assert!(heights[0]["height_m"].as_f64().is_some() && heights[1]["height_m"].is_null(), "{heights}");
        let section = json(folder, &format!("profile %/{source} --line 10,10;300,230 -o %/p.csv"));
        assert!((section["covered_m"].as_f64().unwrap() - 364.005).abs() < 0.01, "{section}");
        let lake = json(folder, &format!("volume %/{source} --level 0"));
        assert!(lake["volume_m3"].as_f64().unwrap() > 0.0, "{lake}");
        let same = json(folder, &format!("volume %/a.xml %/{source}"));
        assert_eq!((same["cut_m3"].as_f64(), same["fill_m3"].as_f64()), (Some(0.0), Some(0.0)));
        let flight = json(folder, &format!("fly %/{source} --budget 600 --frames 8 --no-draw"));
        assert_eq!(flight["frames"].as_array().map(Vec::len), Some(8));
        let drawn = json(folder, &format!("render %/{source} --size 160x100 --draw software -o %/p.png"));
        assert!(number(&drawn, "triangles") > 0);
    }
    for command in ["tin", "build", "extract", "generate"] {
        assert!(stdout(folder, &format!("{command} --help")).contains("TIN"), "{command}");
    }
}

#[test]
fn faults_are_mended_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let cases = [
        (
            "dup",
            landxml(&format!("{SQUARE}, 0 0 1"), "1 2 3, 5 3 4, 2 2 3", ""),
            2,
            &["a point twice", "vertex 5 at"][..],
        ),
        (
            "wall",
            landxml(&format!("{SQUARE}, 0 10 9"), "1 2 3, 1 3 4, 1 2 5", ""),
            2,
            &["1 vertical faces dropped", "face 3 at"],
        ),
        ("flipped", landxml(SQUARE, "1 2 3, 1 4 3", ""), 2, &["turned up"]),
        (
            "overlap",
            landxml(&format!("{SQUARE}, 5 2 1, 5 9 1, 1 5 1"), "1 2 3, 1 3 4, 5 6 7", ""),
            2,
            &["cover an earlier one in plan dropped", "face 3 at"],
        ),
        (
            "unclosed",
            landxml(SQUARE, "1 2 3, 1 3, 1 3 9, a b c", ""),
            1,
            &["three or four ids dropped: 2, first at line", "not there dropped: 1"],
        ),
        (
            "far",
            landxml(&format!("{SQUARE}, 1e300 0 1"), "1 2 3, 1 3 4, 1 4 5", ""),
            2,
            &["within 1e12 m dropped: 1, first point 5"],
        ),
        (
            "nan",
            landxml(&format!("{SQUARE}, nan 0 1"), "1 2 3, 1 3 4", ""),
            2,
            &["not three numbers dropped: 1, first at line"],
        ),
        (
            "unit",
            landxml(SQUARE, FACES, "").replace("\"meter\"", "\"furlong\""),
            2,
            &["'furlong' is not known, metres assumed"],
        ),
    ];
    for (name, text, faces, told) in cases {
        write(folder, &format!("{name}.xml"), &text);
        for command in ["tin", "build"] {
            let output = run(folder, &format!("{command} %/{name}.xml -o %/{name}.yama"));
            let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success() && told.iter().all(|t| stderr.contains(t)), "{name}: {stderr}");
            assert_eq!(json(folder, &format!("info %/{name}.yama"))["faces"].as_u64(), Some(faces), "{name}");
        }
        // who measures sees the same surface
        let volume = json(folder, &format!("volume %/{name}.xml %/{name}.yama"));
        assert_eq!((volume["cut_m3"].as_f64(), volume["fill_m3"].as_f64()), (Some(0.0), Some(0.0)), "{name}");
        assert!((volume["overlap_m2"].as_f64().unwrap() - 50.0 * faces as f64).abs() < 1e-6, "{name}: {volume}");
    }
}

#[test]
fn coordinates_far_out_keep_every_digit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let far = "6398848.0001 147963.5771 1, 6398848.0001 147973.5772 2, 6398858.0003 147973.5772 3, 6398858.0003 147963.5771 4";
    write(folder, "far.xml", &landxml(far, FACES, ""));
    stdout(folder, "tin %/far.xml -o %/far.yama");
    stdout(folder, "tin %/far.yama -o %/again.xml");
    let again = std::fs::read_to_string(folder.join("again.xml")).unwrap();
    assert!(again.contains("6398858.0003 147973.5772 3"), "{again}");
    let heights = json(folder, "heights %/far.yama --at 147963.5771,6398848.0001");
    assert_eq!(heights[0]["height_m"].as_f64(), Some(1.0));
}

#[test]
fn breaklines_come_from_drawings_and_cross_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "p.csv", "x,y,z\n0,0,1\n10,0,2\n10,10,3\n0,10,4\n");
    let line = "0\nLINE\n8\nedge\n10\n1\n20\n1\n30\n5\n11\n9\n21\n8\n31\n6\n";
    write(folder, "l.dxf", &format!("0\nSECTION\n2\nENTITIES\n{line}0\nENDSEC\n0\nEOF\n"));
    let with = json(folder, "tin %/p.csv --breaklines %/l.dxf -o %/a.xml");
    assert_eq!((with["breaklines"].as_u64(), with["vertices"].as_u64()), (Some(1), Some(6)));
    // nothing but lines is no TIN
    let told = error(folder, "tin %/l.dxf -o %/b.xml", 1);
    assert!(told.contains("l.dxf: entities: expected a 3DFACE") && told.contains("1 lines"), "{told}");
    assert!(error(folder, "tin %/p.csv --breaklines %/a.2dm -o %/b.xml", 1).contains("a.2dm"));
    write(folder, "n.2dm", "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 0 1 0\nE3T 1 1 2 3 1\n");
    assert!(
        error(folder, "tin %/p.csv --breaklines %/n.2dm -o %/b.xml", 1).contains("expected breaklines, found none")
    );
    write(folder, "c.txt", "a,1,1,1\na,9,9,2\nb,9,1,1\nb,1,9,3\n");
    let notes = json(folder, "tin %/p.csv --breaklines %/c.txt -o %/c.xml")["notes"].to_string();
    assert!(notes.contains("line 'a' and line 'b' cross at 5.000 5.000"), "{notes}");
    // lines of a surface that cross stay as they are: it has its triangles already
    write(folder, "x.xml", &landxml(SQUARE, FACES, "0 0 1 10 10 3, 10 0 1 0 10 3"));
    assert_eq!(json(folder, "tin %/x.xml -o %/x.yama")["breaklines"].as_u64(), Some(2));
    nothing_at(folder, "b.xml");
}

#[test]
fn what_is_no_tin_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let ok = landxml(SQUARE, FACES, "");
    write(folder, "ok.xml", &ok);
    write(folder, "cut.xml", &ok[..400]);
    write(folder, "empty.xml", &landxml(SQUARE, "", ""));
    write(folder, "walls.xml", &landxml("0 0 1, 0 10 2, 0 10 9", "1 2 3", ""));
    write(folder, "html.xml", "<html><body>no terrain</body></html>");
    write(folder, "text.xml", "nothing");
    write(folder, "none.xml", "");
    write(
        folder,
        "grid.xml",
        "<?xml version=\"1.0\"?>\n<Dataset xmlns=\"http://fgd.gsi.go.jp/spec/2008/FGD_GMLSchema\"/>",
    );
    write(folder, "text.gml", "nothing");
    write(folder, "text.dxf", "nothing");
    write(folder, "none.2dm", "");
    write(folder, "short.terrain", "short");
    let files = [
        ("missing.xml", "missing.xml"),
        ("cut.xml", "cut.xml: line "),
        ("empty.xml", "surface 's': expected faces that are shown, found 4 points"),
        ("walls.xml", "found none (1 vertical faces dropped, the first: face 1 at"),
        ("html.xml", "expected <LandXML>, <CityModel> or, of an elevation grid, <Dataset>, found <html>"),
        ("text.xml", "expected <LandXML>, <CityModel>"),
        ("none.xml", "none.xml: "),
        ("grid.xml", "grid.xml: "),
        ("text.gml", "expected <LandXML>, <CityModel>"),
        ("text.dxf", "text.dxf: line 1: expected a group code"),
        ("none.2dm", "none.2dm: line 1: expected 'MESH2D'"),
        ("short.terrain", "short.terrain: byte 0"),
    ];
    for (name, told) in files {
        for command in [
            "build % -o out.yama",
            "info %",
            "extract % --tolerance 0 -o out.ply",
            "heights % --at 1,2",
            "profile % --line 1,2;3,4",
            "volume % --level 2",
            "compare % ok.xml",
            "render % -o out.png",
            "fly % --no-draw",
        ] {
            if name == "walls.xml" && command.starts_with("info") {
                // tells what is there, fit or not
                continue;
            }
            let line = error(folder, &command.replace('%', name), 1);
            assert!(line.contains(told), "{command}: {line}");
            nothing_at(folder, "out");
        }
        assert!(error(folder, &format!("tin {name} -o out.yama"), 1).contains(told));
        nothing_at(folder, "out");
    }
    assert!(error(folder, "build ok.xml html.xml -o out.yama", 1).contains("html.xml"));
    error(folder, "build ok.xml @ -o out.yama", 2);
    assert!(error(folder, "tin ok.xml @ -o out.yama", 1).contains("expected one TIN"));
    assert!(error(folder, "tin ok.xml -o out.tif", 1).contains("unknown ending .tif"));
    assert!(error(folder, "tin ok.xml -o ok.xml", 1).contains("is an input"));
    assert!(error(folder, "tin ok.xml --surface other -o out.yama", 1).contains("a surface 'other', found 's'"));
    assert_eq!(run(folder, "tin ok.xml --unit 0 -o out.yama").status.code(), Some(2));
    assert!(error(folder, "build ok.xml --progressive -o out.yama", 2).contains("bit for bit"));
    std::fs::copy(folder.join("ok.xml"), folder.join("ok.abc")).unwrap();
    assert!(error(folder, "tin ok.abc -o out.yama", 1).contains("ok.abc"));
    write(folder, "two.csv", "0,0,1\n10,0,2\n");
    for command in [
        "render two.csv -o out.png",
        "extract two.csv --tolerance 1 -o out.ply",
        "fly two.csv --no-draw",
    ] {
        assert!(error(folder, command, 1).contains("two.csv: points are no surface yet: yamanami tin"));
    }
    assert!(error(folder, "tin two.csv -o out.yama", 1).contains("two.csv: no triangle can be made of 2 points"));
    nothing_at(folder, "out");
}

#[test]
fn damaged_databases_of_tins_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "generate tin -o %/a.yama --size 12x9");
    let whole = std::fs::read(folder.join("a.yama")).unwrap();
    let commands = [
        "info b.yama --verify",
        "extract b.yama --tolerance 0 -o out.ply",
        "heights b.yama --at 50,40",
        "tin b.yama -o out.xml",
        "compare b.yama a.yama --samples 100",
        "fly b.yama --no-draw --frames 2",
    ];
    for command in commands {
        std::fs::write(folder.join("b.yama"), &whole[..whole.len() / 2]).unwrap();
        assert!(error(folder, command, 1).contains("b.yama"), "{command}");
        nothing_at(folder, "out");
    }
    for (n, at) in (0..whole.len()).step_by(173).enumerate() {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x5a;
        std::fs::write(folder.join("b.yama"), &bytes).unwrap();
        let command = commands[n % commands.len()];
        let output = run(folder, command);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        match output.status.code() {
            Some(0) => {}
            Some(1) => {
                assert!(stderr.starts_with("error: ") && stderr.trim_end().lines().count() == 1, "{at}: {stderr}")
            }
            code => panic!("byte {at}: {command}: {code:?}: {stderr}"),
        }
        for left in ["out.ply", "out.xml"] {
            let _ = std::fs::remove_file(folder.join(left));
        }
    }
}

#[test]
fn pictures_are_laid_over_tins_and_cut_for_extracts() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "generate tin -o %/a.yama --size 21x16");
    // 200 by 150 metres: red in the west, blue in the east
    let picture =
        image::RgbImage::from_fn(40, 30, |x, _| image::Rgb(if x < 20 { [230, 20, 20] } else { [20, 20, 230] }));
    picture.save(folder.join("map.png")).unwrap();
    let colours = |arguments: &str| {
        stdout(
            folder,
            &format!("render %/a.yama --image %/map.png --size 200x150 --draw software {arguments} -o %/p.png"),
        );
        let seen = image::open(folder.join("p.png")).unwrap().into_rgb8();
        let count = |channel: usize| seen.pixels().filter(|p| p[channel] > p[2 - channel].saturating_add(50)).count();
        [count(0), count(2)]
    };
    let from_above = "--eye 100,75,300 --target 100,76,0";
    let [red, blue] = colours(from_above);
    assert!(red > 1000 && blue > 1000, "{red} {blue}");
    // pixels of 10 m from the south-west corner on: all of the TIN is in its red half
    write(folder, "map.wld", "10\n0\n0\n-10\n5\n295\n");
    let [red, blue] = colours(from_above);
    assert!(red > 5000 && blue == 0, "{red} {blue}");

    let cut = json(folder, "extract %/a.yama --tolerance 0.5 --texture %/map.png -o %/m.glb");
    assert!(cut["triangles"].as_u64().unwrap() > 2);
    let glb = std::fs::read(folder.join("m.glb")).unwrap();
    assert!(glb.windows(8).any(|w| w == b"\x89PNG\r\n\x1a\n"), "the picture is in it");
    assert!(
        error(folder, "extract %/a.yama --tolerance 0 --texture %/map.png -o %/m.stl", 1)
            .contains("unknown ending .stl")
    );
    assert!(error(folder, "extract %/a.yama --tolerance 0 --texture %/none.png -o %/n.glb", 1).contains("none.png"));
    write(folder, "map.wld", "1\n0\n0\n-1\n5000\n300\n");
    assert!(error(folder, "extract %/a.yama --tolerance 0 --texture %/map.png -o %/n.glb", 1).contains("lies nowhere"));
    nothing_at(folder, "n.glb");
}

#[test]
fn made_surveys_take_their_own_options() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for wrong in ["--relief 5", "--holes discs:2", "--splits 2", "--arc-seconds 1", "--faces 5000"] {
        error(folder, &format!("generate tin -o %/a.xml {wrong}"), 2);
    }
    assert!(error(folder, "generate tin -o %/a.tif", 1).contains("unknown ending .tif"));
    stdout(folder, "generate tin -o %/a.xml --size 9x7");
    stdout(folder, "generate tin -o %/b.xml --size 9x7 --seed 2");
    assert_ne!(std::fs::read(folder.join("a.xml")).unwrap(), std::fs::read(folder.join("b.xml")).unwrap());
}
