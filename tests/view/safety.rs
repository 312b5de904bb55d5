//! Requests that the server must refuse, and clients that must not disturb the render.

use crate::abbe_command::abbe;
use crate::abbe_command::folder::with_ball;
use crate::client::{SCENE, View};
use serde_json::json;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Starts a view whose render does not end.
fn endless() -> (tempfile::TempDir, View) {
    let folder = with_ball(SCENE);
    let view = View::start(folder.path(), &["ball.json", "--passes", "1000000"]);
    view.wait("a picture", |state| !state["picture"].is_null());
    (folder, view)
}

#[test]
fn the_server_listens_on_the_loopback_interface() {
    let (_folder, view) = endless();
    assert!(view.url.starts_with("http://127.0.0.1:"), "{}", view.url);
    let port: u16 = view.host.rsplit_once(':').unwrap().1.parse().unwrap();
    // Another address of the loopback network stands for the other addresses of the machine.
    #[cfg(target_os = "linux")]
    assert!(TcpStream::connect(("127.0.0.2", port)).is_err());
    let folder = with_ball(SCENE);
    let said = abbe(folder.path(), &["view", "ball.json", "--no-open", "--port", &port.to_string()]);
    said.is_error(1, &["cannot listen on", &port.to_string()]);
    let said = abbe(folder.path(), &["view", "ball.json", "--no-open", "--bind", "example.org"]);
    said.is_error(2, &["--bind"]);
}

#[test]
fn a_faulty_scene_ends_the_program() {
    let folder = with_ball("{");
    let said = abbe(folder.path(), &["view", "ball.json", "--no-open"]);
    assert_eq!(said.status, 2, "{}", said.err);
    assert!(said.err.contains("ball.json:1:"), "{}", said.err);
}

#[test]
fn requests_need_the_token() {
    let (_folder, view) = endless();
    let token = view.path.trim_matches('/');
    assert_eq!(token.len(), 32);
    let other = format!("{}{}", &token[..31], if token.ends_with('0') { '1' } else { '0' });
    for path in ["/", "/state", &format!("/{other}/"), &format!("/{other}/state"), &format!("/{token}")] {
        let answer = view.send(&format!("GET {path} HTTP/1.1\r\nHost: {}", view.host), b"").unwrap();
        assert_eq!((answer.status, answer.body.len()), (404, 0), "{path}");
    }
    assert_eq!(view.get("").status, 200);
}

/// A page of another site may let its domain name point to this machine (DNS rebinding).
#[test]
fn requests_of_other_sites_are_refused() {
    let (_folder, view) = endless();
    let port = view.host.rsplit_once(':').unwrap().1;
    let request = |lines: &str| view.send(&format!("GET {}state HTTP/1.1\r\n{lines}", view.path), b"").unwrap().status;
    for lines in [
        format!("Host: evil.example:{port}"),
        "Host: 127.0.0.1".to_string(),
        format!("Host: 10.0.0.1:{port}"),
        format!("Host: {}\r\nOrigin: http://evil.example", view.host),
        format!("Host: {}\r\nOrigin: null", view.host),
    ] {
        assert_eq!(request(&lines), 403, "{lines}");
    }
    assert_eq!(request(&format!("Host: {0}\r\nOrigin: http://{0}", view.host)), 200);
    assert_eq!(request(&format!("Host: localhost:{port}")), 200);
    // HTTP/1.0 has requests without a host.
    let old = view.send(&format!("GET {}state HTTP/1.0", view.path), b"");
    assert!(old.is_none_or(|answer| matches!(answer.status, 400 | 403)));
}

#[test]
fn no_file_is_served() {
    let (_folder, view) = endless();
    for name in ["ball.json", "../ball.json", "%2e%2e/ball.json", "..%2fball.json", "/etc/passwd", "page.js"] {
        let answer = view.get(name);
        assert_eq!((answer.status, answer.body.len()), (404, 0), "{name}");
    }
    let page = view.get("");
    assert!(page.head.to_lowercase().contains("content-security-policy: default-src 'none'"), "{}", page.head);
    // The page's changes cannot name files outside the scene's folder.
    view.post(&json!({"changes": ["objects[0].shape={\"mesh\": {\"path\": \"/etc/passwd\"}}"]}));
    let state = view.wait("a refusal", |state| state["session"] == "failed");
    assert!(state["error"].as_str().unwrap().contains("folder"), "{}", state["error"]);
}

#[test]
fn wrong_and_large_requests_are_refused() {
    let (_folder, view) = endless();
    let post = |length: &str, body: &[u8]| {
        let head = format!("POST {}orders HTTP/1.1\r\nHost: {}\r\n{length}", view.path, view.host);
        view.send(&head, body).map(|answer| answer.status)
    };
    let large = vec![b' '; 40_000];
    assert_eq!(post("Content-Length: 40000", &large), Some(413));
    assert_eq!(post("Content-Length: 4000000000", b"{"), Some(413));
    let chunked = [b"9c40\r\n".as_slice(), &large, b"\r\n0\r\n\r\n"].concat();
    assert_eq!(post("Transfer-Encoding: chunked", &chunked), Some(413));
    assert_eq!(post("Content-Length: 2", b"{]"), Some(400));
    assert_eq!(view.post(&json!({"shell": "ls"})).status, 400);
    assert_eq!(view.post(&json!({"changes": vec!["a=1"; 300]})).status, 413);
    for query in [
        "probe",
        "probe?x0=0&y0=0&x1=48&y1=0",
        "probe?x0=5&y0=0&x1=4&y1=0",
        "probe?x0=0&y0=0&x1=0&y1=-1",
        "band?band=x",
    ] {
        assert_eq!(view.get(query).status, 400, "{query}");
    }
    assert!(view.get("band?band=47").body.is_empty());
    assert_eq!(view.get("orders").status, 405);
    let head = format!("GET {}{} HTTP/1.1\r\nHost: {}", view.path, "x".repeat(2_000_000), view.host);
    assert!(view.send(&head, b"").is_none_or(|answer| answer.status >= 400));
    assert_eq!(view.get("state").status, 200);
}

#[test]
fn the_number_of_clients_is_limited() {
    let (_folder, view) = endless();
    let idle: Vec<TcpStream> = (0..60).map(|_| view.connect()).collect();
    let is_closed = |mut stream: &TcpStream| {
        stream.set_read_timeout(Some(Duration::from_millis(300))).unwrap();
        matches!(stream.read(&mut [0]), Ok(0))
            || stream.read(&mut [0]).is_err_and(|error| error.kind() == std::io::ErrorKind::ConnectionReset)
    };
    assert!(idle.iter().rev().take(10).all(is_closed), "the last clients are refused");
    drop(idle);
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(view.get("state").status, 200);
}

/// Returns the number of passes after another second.
fn passes_in_a_second(view: &View) -> u64 {
    let passes = || view.get("state").json()["passes"].as_u64().unwrap();
    let before = passes();
    std::thread::sleep(Duration::from_secs(1));
    passes() - before
}

/// Clients that ask for pictures and do not read them do not slow the render.
#[test]
fn slow_clients_do_not_slow_the_render() {
    let (_folder, view) = endless();
    let before = passes_in_a_second(&view);
    let slow: Vec<TcpStream> = (0..20)
        .map(|_| {
            let mut stream = view.connect();
            let request = format!("GET {}picture HTTP/1.1\r\nHost: {}\r\n\r\n", view.path, view.host);
            stream.write_all(request.repeat(200).as_bytes()).unwrap();
            stream
        })
        .collect();
    let during = passes_in_a_second(&view);
    assert!(during * 4 > before, "{during} passes instead of {before}");
    drop(slow);
}

/// Closed browsers leave no connections behind, and the render goes on.
#[test]
#[cfg(target_os = "linux")]
fn closed_browsers_leave_nothing_behind() {
    let (_folder, view) = endless();
    let open = || std::fs::read_dir(format!("/proc/{}/fd", view.child.id())).unwrap().count();
    let before = open();
    for _ in 0..200 {
        let mut stream = view.connect();
        // A request that waits for the next version.
        let wait = format!("GET {}state?after=99999999 HTTP/1.1\r\nHost: {}\r\n\r\n", view.path, view.host);
        let _ = stream.write_all(wait.as_bytes());
    }
    // The server may still have to accept some of the closed connections.
    let request = format!("GET {}state HTTP/1.1\r\nHost: {}", view.path, view.host);
    let start = Instant::now();
    while view.send(&request, b"").is_none() || open() > before + 2 {
        assert!(start.elapsed() < Duration::from_secs(20), "{} instead of {before} open files", open());
        std::thread::sleep(Duration::from_millis(50));
    }
    assert!(passes_in_a_second(&view) > 0);
}
