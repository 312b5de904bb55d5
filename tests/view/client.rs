//! Starts `abbe view`, and sends requests to it.

use crate::abbe_command::command;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStderr, Stdio};
use std::time::{Duration, Instant};

/// A small picture with dispersion, caustics and indirect light.
pub(crate) const SCENE: &str = r#"{
  "title": "A ball",
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 48, "height": 32},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "SF10"}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "glass"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}],
  "render": {"passes": 12, "photons": 500}
}"#;

/// The longest time to wait for anything.
pub(crate) const PATIENCE: Duration = Duration::from_secs(120);

/// A running `abbe view`. It is killed at the end of the test.
pub(crate) struct View {
    pub(crate) child: Child,
    /// The address of the page.
    pub(crate) url: String,
    /// The IP address and the port.
    pub(crate) host: String,
    /// The path of the page: the token between slashes.
    pub(crate) path: String,
    pub(crate) start: Instant,
}

impl Drop for View {
    fn drop(&mut self) {
        // The process may have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// An answer of the server.
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("no JSON: {}", self.status))
    }
}

impl View {
    /// Starts a view in a folder.
    pub(crate) fn start(folder: &Path, arguments: &[&str]) -> Self {
        let start = Instant::now();
        let mut command = command(folder);
        command.args(["view", "--no-open"]).args(arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut url = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut url).unwrap();
        let url = url.trim().to_string();
        let rest = url.strip_prefix("http://").unwrap_or_else(|| panic!("the first line is {url:?}"));
        let (host, path) = rest.split_once('/').unwrap();
        let (host, path) = (host.to_string(), format!("/{path}"));
        Self { child, url, host, path, start }
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// Sends the lines of a request, and reads the answer. Returns `None` if the server closes the
    /// connection without an answer.
    pub(crate) fn send(&self, head: &str, body: &[u8]) -> Option<Answer> {
        let mut stream = self.connect();
        stream.write_all(format!("{head}\r\nConnection: close\r\n\r\n").as_bytes()).ok()?;
        // The server may refuse a request before it has read the body.
        let _ = stream.write_all(body);
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        let end = bytes.windows(4).position(|window| window == b"\r\n\r\n")?;
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        let status = head.split_whitespace().nth(1).unwrap().parse().unwrap();
        Some(Answer { status, head, body: bytes[end + 4..].to_vec() })
    }

    pub(crate) fn get(&self, name: &str) -> Answer {
        self.send(&format!("GET {}{name} HTTP/1.1\r\nHost: {}", self.path, self.host), b"").unwrap()
    }

    pub(crate) fn post(&self, orders: &Value) -> Answer {
        let body = orders.to_string();
        let head =
            format!("POST {}orders HTTP/1.1\r\nHost: {}\r\nContent-Length: {}", self.path, self.host, body.len());
        self.send(&head, body.as_bytes()).unwrap()
    }

    /// Waits until the state fulfils a condition, and returns it.
    pub(crate) fn wait(&self, what: &str, is_met: impl Fn(&Value) -> bool) -> Value {
        let (start, mut version) = (Instant::now(), 0);
        loop {
            let state = self.get(&format!("state?after={version}")).json();
            if is_met(&state) {
                return state;
            }
            assert!(start.elapsed() < PATIENCE, "waited for {what}: {state}");
            version = state["version"].as_u64().unwrap();
        }
    }

    pub(crate) fn finished(&self) -> Value {
        self.wait("all passes", |state| state["session"] == "finished")
    }

    /// Waits for the end of the process. Returns the exit status, and what it printed on standard
    /// error.
    pub(crate) fn end(mut self) -> (i32, String) {
        let status = self.child.wait().unwrap().code().unwrap();
        let mut said = String::new();
        let mut stderr: ChildStderr = self.child.stderr.take().unwrap();
        stderr.read_to_string(&mut said).unwrap();
        (status, said)
    }
}
