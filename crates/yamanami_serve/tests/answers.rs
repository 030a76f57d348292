//! What is answered to whoever asks properly: pages, facts, ranges, conditions, tiles, heights.

mod common;

use common::{Running, hill};
use yamanami::io::dem::{self, TileEncoding};
use yamanami::io::pack::layout::PackHead;
use yamanami::io::pack::{PackSource, write_pack};
use yamanami::{OpenOptions, SurfaceHeights, Terrain};
use yamanami_serve::{Surfaces, Viewer, write_site};

#[test]
fn the_list_speaks_the_browser_s_language_and_escapes_titles() {
    let server = Running::start();
    let page =
        |language: &str| String::from_utf8(server.ask("GET", "/", &[("Accept-Language", language)]).body).unwrap();
    assert!(page("en").contains("Surfaces served") && page("ja").contains("地形・モデル"));
    assert!(page("en").contains("&lt;hill&gt; 丘") && page("en").contains("/view/#s=hill-1"));
    let picture = server.get("/s/hill-1/picture.png");
    assert_eq!((picture.status, picture.header("content-type")), (200, Some("image/png")));
    let drawn = image::load_from_memory(&picture.body).unwrap().to_rgb8();
    assert!(drawn.pixels().any(|p| p != drawn.get_pixel(0, 0)), "something is in it");
}

#[test]
fn the_viewer_s_files_and_what_they_show() {
    let server = Running::start();
    assert_eq!(server.get("/view").status, 308);
    assert_eq!(server.get("/view/").body, b"<!doctype html><p>viewer");
    let wasm = server.get("/view/a.wasm");
    assert_eq!((wasm.header("content-type"), &*wasm.body), (Some("application/wasm"), &b"\0asm"[..]));
    let tag = wasm.header("etag").unwrap();
    assert_eq!(server.ask("GET", "/view/a.wasm", &[("If-None-Match", tag)]).status, 304);
    let site = server.get("/view/site.json").json();
    assert_eq!(site["surfaces"][0]["pack"], "../s/hill-1/surface.pack");
    assert_eq!(server.get("/view/nothing.js").status, 404);
}

#[test]
fn a_packed_surface_is_sent_whole_and_by_range() {
    let server = Running::start();
    let file = server.folder.path().join("hill.pack");
    write_pack(&PackSource::open(&server.terrain).unwrap(), &file, &|_| ()).unwrap();
    let whole = std::fs::read(file).unwrap();
    let pack = "/s/hill-1/surface.pack";
    let sent = server.get(pack);
    assert_eq!((sent.status, &sent.body), (200, &whole));
    PackHead::parse(pack.as_ref(), &sent.body).unwrap();
    let tag = sent.header("etag").unwrap();
    let length = whole.len();

    let part = |range: &str| server.ask("GET", pack, &[("Range", range)]);
    for (range, bytes) in [
        ("bytes=0-0", 0..1),
        ("bytes=10-2000", 10..2001),
        ("bytes=2000-", 2000..length),
        ("bytes=-7", length - 7..length),
        ("bytes=5-99999999999999999999", 5..length),
    ] {
        let sent = part(range);
        assert_eq!((sent.status, &*sent.body), (206, &whole[bytes.clone()]), "{range}");
        let told = format!("bytes {}-{}/{length}", bytes.start, bytes.end - 1);
        assert_eq!(sent.header("content-range"), Some(told.as_str()));
    }
    for absurd in [
        format!("bytes={length}-"),
        "bytes=18446744073709551615-18446744073709551616".into(),
        "bytes=-0".into(),
    ] {
        let sent = part(&absurd);
        assert_eq!((sent.status, sent.header("content-range")), (416, Some(format!("bytes */{length}").as_str())));
    }
    assert_eq!(part("bytes=0-1,5-6").status, 200, "several ranges are answered with the whole");
    assert_eq!(part("bytes=9-3").status, 200, "what is no range is ignored");

    let head = server.ask("HEAD", pack, &[]);
    assert_eq!((head.status, head.body.len()), (200, 0));
    assert_eq!(head.header("content-length"), Some(length.to_string().as_str()));
    assert_eq!(head.header("accept-ranges"), Some("bytes"));
    assert_eq!(server.ask("HEAD", pack, &[("Range", "bytes=1-2")]).header("content-length"), Some("2"));

    assert_eq!(server.ask("GET", pack, &[("If-None-Match", tag)]).status, 304);
    assert_eq!(server.ask("GET", pack, &[("Range", "bytes=1-2"), ("If-Range", tag)]).status, 206);
    assert_eq!(server.ask("GET", pack, &[("Range", "bytes=1-2"), ("If-Range", "\"old\"")]).status, 200);
}

#[test]
fn heights_and_profiles_are_those_of_the_surface() {
    let server = Running::start();
    let terrain = Terrain::open(std::slice::from_ref(&server.terrain), &OpenOptions::default(), &|_| ()).unwrap();
    let field = terrain.field().unwrap();
    let (column, row) = (30, 40);
    let [lon, lat] = terrain.geo().source_from_grid(f64::from(column), f64::from(row));
    let told = server.get(&format!("/s/hill-1/height?lon={lon:.15}&lat={lat:.15}")).json();
    let height_m = told["height_m"].as_f64().unwrap();
    assert!((height_m - f64::from(field.at(30, 40))).abs() < 1e-3, "{height_m}");
    assert!(server.get(&format!("/s/hill-1/height?x={lon:.15}&y={lat:.15}")).json()["height_m"].is_number());
    assert!(server.get("/s/hill-1/height?lon=0&lat=0").json()["height_m"].is_null());
    let line = format!("{:.12},{lat:.12};{:.12},{lat:.12}", lon - 0.01, lon + 0.02);
    let profile = server.get(&format!("/s/hill-1/profile?line={line}&points=4")).json();
    assert!((profile["distance_m"].as_f64().unwrap() - 2724.0).abs() < 5.0, "{profile}");
    assert!(profile["points"][0]["height_m"].is_null());
    assert!((profile["points"][1]["height_m"].as_f64().unwrap() - height_m).abs() < 0.1);
    for bad in [
        "height",
        "height?lon=1",
        "height?lon=a&lat=1",
        "height?lon=1&lat=1&x=2",
        "profile?line=1,2",
        "profile?line=1,2;3,999",
        "profile?line=1,2;3,4&points=1",
        "profile?line=1,2;3,4&points=99999999",
    ] {
        assert_eq!(server.get(&format!("/s/hill-1/{bad}")).status, 400, "{bad}");
    }
}

#[test]
fn tiles_are_the_surface_at_the_middle_of_their_pixels() {
    let server = Running::start();
    let json = server.get("/s/hill-1/terrain-rgb/tilejson.json").json();
    let zoom = json["maxzoom"].as_u64().unwrap() as u32;
    assert_eq!(json["tiles"][0], "http://x/s/hill-1/terrain-rgb/{z}/{x}/{y}.png");
    let heights = SurfaceHeights::open(&server.terrain).unwrap();
    let n = f64::from(1u32 << zoom);
    let lat = 35.385f64.to_radians();
    let [x, y] = [(138.718 + 180.0) / 360.0 * n, (0.5 - lat.tan().asinh() / std::f64::consts::TAU) * n];
    let [x, y] = [x, y].map(|v| v as u32);
    for (name, encoding) in [
        ("", TileEncoding::TerrainRgb),
        ("?encoding=terrarium", TileEncoding::Terrarium),
        ("?encoding=gsi", TileEncoding::Gsi),
    ] {
        let sent = server.get(&format!("/s/hill-1/terrain-rgb/{zoom}/{x}/{y}.png{name}"));
        assert_eq!(sent.status, 200);
        let picture = image::load_from_memory(&sent.body).unwrap().to_rgba8();
        let mut seen = 0;
        for (i, j, pixel) in picture.enumerate_pixels() {
            let across = (f64::from(x) + (f64::from(i) + 0.5) / 256.0) / n;
            let down = (f64::from(y) + (f64::from(j) + 0.5) / 256.0) / n;
            let lat = (std::f64::consts::PI * (1.0 - 2.0 * down)).sinh().atan().to_degrees();
            let place = heights.grid_from_lon_lat(360.0 * (across - 0.5), lat).unwrap();
            let [r, g, b, a] = pixel.0;
            let told = if a == 0 { f32::NAN } else { encoding.height_m([r, g, b]) };
            let exact = heights.at(0, &[place]).unwrap()[0];
            if told.is_nan() || exact.is_nan() {
                assert!(told.is_nan() && exact.is_nan());
            } else {
                assert!(f64::from((told - exact).abs()) <= 0.5 * encoding.quantum_m() + 0.03, "{told} {exact}");
                seen += 1;
            }
        }
        assert!(seen > 2000, "{seen}");
    }
    for missing in ["0/0/1.png", "99/0/0.png", "3/1/1.png", "1/0/0.jpg", "a/b/c.png"] {
        assert_eq!(server.get(&format!("/s/hill-1/terrain-rgb/{missing}")).status, 404, "{missing}");
    }
    // what we serve we can read
    let file = server.folder.path().join(format!("dem_z{zoom}_x{x}_y{y}.png"));
    std::fs::write(&file, server.get(&format!("/s/hill-1/terrain-rgb/{zoom}/{x}/{y}.png")).body).unwrap();
    dem::open(&[file], &dem::OpenOptions::default()).unwrap().read_all().unwrap();
}

#[test]
fn meshes_are_cut_as_they_are_asked_for() {
    let server = Running::start();
    let layer = server.get("/s/hill-1/quantized-mesh/layer.json").json();
    assert_eq!(layer["format"], "quantized-mesh-1.0");
    let zoom = layer["maxzoom"].as_u64().unwrap();
    let range = &layer["available"][zoom as usize][0];
    let target = format!("/s/hill-1/quantized-mesh/{zoom}/{}/{}.terrain", range["startX"], range["startY"]);
    let plain = server.get(&target);
    assert_eq!((plain.status, plain.header("content-encoding")), (200, None));
    // centre, heights, sphere, horizon, then the vertices' number
    let vertices = u32::from_le_bytes(plain.body[88..92].try_into().unwrap());
    assert!(vertices > 3 && (vertices as usize) * 6 < plain.body.len());
    let packed = server.ask("GET", &target, &[("Accept-Encoding", "gzip, br")]);
    assert_eq!((packed.header("content-encoding"), packed.body.starts_with(b"\x1f\x8b")), (Some("gzip"), true));
    for root in ["0/0/0", "0/1/0"] {
        assert_eq!(server.get(&format!("/s/hill-1/quantized-mesh/{root}.terrain")).status, 200, "{root}");
    }
    for missing in ["0/2/0.terrain", "3/0/0.terrain", "99/0/0.terrain", "0/0/0.png"] {
        assert_eq!(server.get(&format!("/s/hill-1/quantized-mesh/{missing}")).status, 404, "{missing}");
    }
}

#[test]
fn other_sites_may_read_only_when_told() {
    let closed = Running::start();
    assert_eq!(closed.get("/s/hill-1/info.json").header("access-control-allow-origin"), None);
    assert_eq!(closed.ask("OPTIONS", "/", &[]).status, 405);
    let open = Running::with(yamanami_serve::Limits::default(), true);
    let info = open.get("/s/hill-1/info.json");
    assert_eq!(info.header("access-control-allow-origin"), Some("*"));
    assert!(info.header("access-control-expose-headers").unwrap().contains("content-range"));
    assert_eq!(info.json()["kind"], "terrain");
    assert_eq!(open.ask("OPTIONS", "/s/hill-1/surface.pack", &[]).status, 204);
    assert_eq!(open.get("/s/nothing/info.json").header("access-control-allow-origin"), Some("*"), "faults too");
}

#[test]
fn a_site_is_page_and_data_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let [yama, web, out] = ["a.yama", "web", "site"].map(|name| folder.path().join(name));
    hill(&yama);
    let mut surfaces = Surfaces::default();
    surfaces.add(&yama).unwrap();
    assert!(
        write_site(&surfaces, &Viewer::default(), &out, &|_| ()).unwrap_err().to_string().contains("cargo xtask web")
    );
    assert!(!out.exists());
    std::fs::create_dir(&web).unwrap();
    std::fs::write(web.join("index.html"), "<p>").unwrap();
    let viewer = Viewer::from_folder(&web).unwrap();
    for _ in 0..2 {
        let report = write_site(&surfaces, &viewer, &out, &|_| ()).unwrap();
        assert_eq!(report.files, 4);
        assert!(std::fs::read(out.join("a.png")).unwrap().starts_with(b"\x89PNG"));
        assert_eq!(std::fs::read(out.join("index.html")).unwrap(), b"<p>");
        let site: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("site.json")).unwrap()).unwrap();
        let pack = out.join(site["surfaces"][0]["pack"].as_str().unwrap());
        let source = PackSource::open(&yama).unwrap();
        assert_eq!(std::fs::read(pack).unwrap(), source.read(0..source.bytes()).unwrap());
    }
}
