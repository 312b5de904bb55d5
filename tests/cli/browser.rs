//! Opens a page in a headless browser and records the picture, the console and the requests.
//!
//! This process serves the page under a policy that forbids every request, so an attempt shows as
//! an error on the browser's console. Requests to the server are recorded as well.

use image::RgbImage;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// The content security policy: pages may use only what they contain.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

/// The longest time to wait for a screenshot.
const PATIENCE: Duration = Duration::from_secs(90);

/// The colour scheme that the reader prefers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scheme {
    Light,
    Dark,
}

/// What the browser recorded.
#[derive(Debug)]
pub(crate) struct Seen {
    /// The window's pixels.
    pub(crate) picture: RgbImage,
    /// All console messages, including script errors and policy violations.
    pub(crate) console: Vec<String>,
    /// All requests except the one for the page itself.
    pub(crate) requests: Vec<String>,
}

/// Finds an installed browser and returns its name. If none is installed, returns `None`, or
/// panics under `ABBE_REQUIRE_EXTERNAL`, which `tests/run --external` sets.
pub(crate) fn find() -> Option<&'static str> {
    let starts = |name: &&str| {
        let tried = Command::new(name).arg("--version").stdin(Stdio::null()).output();
        tried.is_ok_and(|output| output.status.success())
    };
    let found = NAMES.into_iter().find(starts);
    assert!(
        found.is_some() || std::env::var_os("ABBE_REQUIRE_EXTERNAL").is_none(),
        "no browser is installed; tests/run --external installs chromium"
    );
    found
}

/// Opens a page in a window of this size.
pub(crate) fn open(browser: &str, page: &str, size: (u32, u32), scheme: Scheme) -> Seen {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a local port");
    let address = listener.local_addr().expect("a bound port has an address");
    let requests = Arc::new(Mutex::new(Vec::new()));
    let (log, body) = (Arc::clone(&requests), page.to_string());
    // The thread ends with the process of the test.
    std::thread::spawn(move || listener.incoming().flatten().for_each(|stream| answer(stream, &body, &log)));

    let shot = folder.path().join("shot.png");
    let said = folder.path().join("said.txt");
    let preference = match scheme {
        Scheme::Light => 1,
        Scheme::Dark => 0,
    };
    let mut child = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-dev-shm-usage", "--no-proxy-server"])
        .args(["--force-color-profile=srgb", "--force-device-scale-factor=1", "--enable-logging=stderr"])
        // The screenshot waits until the pictures are decoded and painted.
        .args(["--run-all-compositor-stages-before-draw", "--virtual-time-budget=5000"])
        .arg(format!("--blink-settings=preferredColorScheme={preference}"))
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("--window-size={},{}", size.0, size.1))
        .arg(format!("--screenshot={}", shot.display()))
        .arg(format!("http://{address}/"))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(std::fs::File::create(&said).expect("a scratch file"))
        .spawn()
        .expect("the browser starts");
    let start = Instant::now();
    while child.try_wait().expect("the browser can be asked").is_none() {
        if start.elapsed() > PATIENCE {
            let _ = child.kill();
            panic!("the browser took longer than {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let said = std::fs::read(&said).expect("the browser's words");
    let said = String::from_utf8_lossy(&said);
    let picture = image::open(&shot).unwrap_or_else(|error| panic!("no screenshot: {error}\n{said}")).into_rgb8();
    let console = said.lines().filter(|line| line.contains(":CONSOLE")).map(str::to_string).collect();
    let requests = requests.lock().expect("no thread panicked").clone();
    Seen { picture, console, requests }
}

/// Serves the page; all other paths are missing. The icon, which browsers request by themselves, is
/// not recorded.
fn answer(mut stream: TcpStream, page: &str, log: &Mutex<Vec<String>>) {
    let mut line = String::new();
    let _ = BufReader::new(&stream).read_line(&mut line);
    let path = line.split_whitespace().nth(1).unwrap_or_default();
    let (status, body) = if path == "/" { ("200 OK", page) } else { ("404 Not Found", "") };
    if !matches!(path, "" | "/" | "/favicon.ico")
        && let Ok(mut log) = log.lock()
    {
        log.push(path.to_string());
    }
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {}\r\n\
         Content-Security-Policy: {POLICY}\r\nConnection: close\r\n\r\n",
        body.len()
    );
    let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body.as_bytes()));
}
