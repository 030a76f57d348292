//! What is answered to whoever asks badly: the server says so, and lives on.

mod common;

use common::{Running, read_answer};
use proptest::prelude::*;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use yamanami_serve::Limits;

fn assert_alive(server: &Running) {
    assert_eq!(server.get("/s/hill-1/info.json").status, 200);
}

#[test]
fn no_name_leads_out_of_what_is_served() {
    let server = Running::start();
    for up in [
        "..",
        "%2e%2e",
        "%252e%252e",
        ".%2e",
        "..%00",
        "..%5c..",
        "..\\..",
        "..%2f..",
        "..%252f..",
        "....//..",
        "%c0%ae%c0%ae",
        "~",
        "%7e",
    ] {
        for target in [
            format!("/{up}/secret.txt"),
            format!("/view/{up}/secret.txt"),
            format!("/view/{up}%2fsecret.txt"),
            format!("/view/a.wasm/{up}/{up}/secret.txt"),
            format!("/s/{up}/surface.pack"),
            format!("/s/hill-1/{up}/{up}/secret.txt"),
            format!("/s/hill-1%2f{up}/info.json"),
            format!("/s/Hill%201.yama{up}/info.json"),
            format!("//{up}/secret.txt"),
        ] {
            let answer = server.get(&target);
            assert!(matches!(answer.status, 400 | 404), "{target}: {}", answer.status);
            assert!(!answer.body.windows(6).any(|w| w == b"secret"), "{target}");
        }
    }
    let absolute = format!("/view/{}", server.terrain.display());
    assert_eq!(server.get(&absolute).status, 404);
    assert_alive(&server);
}

#[test]
fn only_get_and_head_without_a_body_and_of_some_length() {
    let server = Running::start();
    for method in ["POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "BREW"] {
        let answer = server.ask(method, "/", &[]);
        assert_eq!((answer.status, answer.header("allow")), (405, Some("GET, HEAD")), "{method}");
    }
    assert_eq!(server.ask("GET", "/", &[("Content-Length", "5")]).status, 413);
    assert_eq!(server.ask("GET", "/", &[("Transfer-Encoding", "chunked")]).status, 413);
    assert_eq!(server.get(&format!("/{}", "a".repeat(3000))).status, 414);
    assert_eq!(server.ask("GET", "/", &[("X", &"a".repeat(40_000))]).status, 431);
    assert!(matches!(
        server.raw(b"GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\nBad Header\r\n\r\n").status,
        0 | 400
    ));
    assert!(matches!(server.raw(b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n").status, 0 | 400), "TLS to a plain port");
    let answer = server.get("/nothing");
    assert_eq!((answer.status, answer.json()["error"].as_str().is_some()), (404, true));
    let page = server.ask("GET", "/<script>", &[("Accept", "text/html")]);
    assert!(page.status == 404 || page.status == 400);
    assert_alive(&server);
}

fn shared() -> &'static Running {
    static SERVER: OnceLock<Running> = OnceLock::new();
    SERVER.get_or_init(Running::start)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn nonsense_is_refused_and_nothing_more(
        bytes in proptest::collection::vec(any::<u8>(), 0..300),
        path in "/(s/hill-1/|view/|s/)?[!-~]{0,60}",
        range in "bytes=[0-9,\\-a]{0,25}",
    ) {
        let mut raw = b"GET /".to_vec();
        raw.extend(bytes.iter().filter(|b| **b != b'\n'));
        raw.extend(b" HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
        let status = shared().raw(&raw).status;
        prop_assert!(status == 0 || (200..500).contains(&status), "{status}");
        let status = shared().get(&path).status;
        prop_assert!(status == 0 || (200..500).contains(&status), "{path}: {status}");
        let status = shared().ask("GET", "/s/hill-1/surface.pack", &[("Range", &range)]).status;
        prop_assert!([200, 206, 416].contains(&status), "{range}: {status}");
    }
}

#[test]
fn thousands_of_idle_connections_keep_nobody_out() {
    let server = Running::with(Limits { connections: 100, ..Limits::default() }, false);
    let idle: Vec<TcpStream> = (0..2000).map_while(|_| TcpStream::connect(server.address).ok()).collect();
    assert!(idle.len() > 500, "{} could be opened", idle.len());
    assert_alive(&server);
    // half a request is idle too
    for mut stream in idle.iter().skip(idle.len() - 50) {
        let _ = stream.write_all(b"GET / HT");
    }
    assert_alive(&server);
    drop(idle);
    assert_alive(&server);
}

#[test]
fn who_is_slow_to_ask_is_not_waited_for() {
    let server = Running::with(Limits { head_time: Duration::from_millis(300), ..Limits::default() }, false);
    let mut slow = server.connect();
    slow.write_all(b"GET / HTTP/1.1\r\nHost: x\r\n").unwrap();
    let mut silent = server.connect();
    let (mut seen, mut bytes) = (Instant::now(), [0; 16]);
    // drop by drop: each moves nothing on
    while seen.elapsed() < Duration::from_secs(10) && slow.write_all(b"X-A: b\r\n").is_ok() {
        std::thread::sleep(Duration::from_millis(50));
        slow.set_nonblocking(true).unwrap();
        let read = slow.read(&mut bytes);
        let closed = read.map_or_else(|e| e.kind() != std::io::ErrorKind::WouldBlock, |_| true);
        slow.set_nonblocking(false).unwrap();
        if closed {
            break;
        }
    }
    assert!(seen.elapsed() < Duration::from_secs(10), "it was cut off");
    seen = Instant::now();
    assert_eq!(silent.read(&mut bytes).unwrap_or(0), 0);
    assert!(seen.elapsed() < Duration::from_secs(10));
    assert_alive(&server);
}

#[test]
fn who_does_not_listen_is_not_waited_for() {
    let limits = Limits { stall_time: Duration::from_millis(300), connections: 1, ..Limits::default() };
    let server = Running::with(limits, false);
    // many answers asked for at once and none taken, until the buffers of both sides are full
    let mut deaf = server.connect();
    deaf.set_write_timeout(Some(Duration::from_secs(2))).unwrap();
    for _ in 0..3000 {
        if deaf.write_all(b"GET /s/hill-1/surface.pack HTTP/1.1\r\nHost: x\r\n\r\n").is_err() {
            break;
        }
    }
    let started = Instant::now();
    while server.get("/s/hill-1/info.json").status != 200 {
        assert!(started.elapsed() < Duration::from_secs(15), "the one connection is free again");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn when_all_are_answered_the_next_is_told() {
    let server = Running::with(Limits { connections: 1, ..Limits::default() }, false);
    let mut first = server.connect();
    first.write_all(b"GET /s/hill-1/info.json HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
    // kept open and idle now: it gives way
    let mut bytes = [0; 64];
    assert!(first.read(&mut bytes).unwrap() > 0);
    assert_alive(&server);
}

#[test]
fn a_stop_lets_answers_finish() {
    let mut server = Running::start();
    let mut asking = server.connect();
    let idle = server.connect();
    // the picture takes a while
    asking.write_all(b"GET /s/hill-1/picture.png HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
    std::thread::sleep(Duration::from_millis(30));
    server.stop();
    let answer = read_answer(&mut asking);
    assert_eq!((answer.status, answer.body.starts_with(b"\x89PNG")), (200, true));
    let started = Instant::now();
    server.join();
    assert!(started.elapsed() < Duration::from_secs(5), "nobody waits for the idle one");
    drop(idle);
    assert!(TcpStream::connect(server.address).is_err());
}

#[test]
fn a_file_that_changes_is_told_and_the_server_lives_on() {
    let server = Running::start();
    let whole = std::fs::read(&server.terrain).unwrap();
    std::fs::write(&server.terrain, &whole[..whole.len() / 2]).unwrap();
    for route in [
        "surface.pack",
        "info.json",
        "height?lon=138.71&lat=35.39",
        "terrain-rgb/13/7252/3237.png",
        "picture.png",
    ] {
        let answer = server.get(&format!("/s/hill-1/{route}"));
        assert_eq!(answer.status, 410, "{route}");
        assert!(answer.json()["error"].as_str().unwrap().contains("start the server again"));
    }
    std::fs::remove_file(&server.terrain).unwrap();
    assert_eq!(server.get("/s/hill-1/surface.pack").status, 410);
    assert_eq!(server.get("/").status, 200);
}

#[test]
fn damage_within_a_file_is_a_fault_of_that_request() {
    let server = Running::start();
    let time = std::fs::metadata(&server.terrain).unwrap().modified().unwrap();
    let mut bytes = std::fs::read(&server.terrain).unwrap();
    let end = bytes.len();
    bytes[end / 2..].fill(0xAA);
    // in place and with the old time, as a failing disk would
    let mut file = std::fs::OpenOptions::new().write(true).open(&server.terrain).unwrap();
    file.write_all(&bytes).unwrap();
    file.set_modified(time).unwrap();
    drop(file);
    let statuses: Vec<u16> = ["picture.png", "height?lon=138.71&lat=35.39", "surface.pack"]
        .map(|route| server.get(&format!("/s/hill-1/{route}")).status)
        .to_vec();
    assert!(statuses.contains(&500), "{statuses:?}");
    assert_eq!(server.get("/").status, 200);
}
