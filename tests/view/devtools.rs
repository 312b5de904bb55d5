//! A small client of the Chrome DevTools Protocol: a WebSocket with JSON messages (RFC 6455).

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// A connection to a tab of the browser.
pub(crate) struct DevTools {
    stream: BufReader<TcpStream>,
    last_id: u64,
    /// The events that arrived between the answers.
    pub(crate) events: Vec<Value>,
}

impl DevTools {
    /// Connects to the only tab of the browser with this debugging port.
    pub(crate) fn connect(port: u16) -> Self {
        let address = format!("127.0.0.1:{port}");
        let mut stream = TcpStream::connect(&address).unwrap();
        write!(stream, "GET /json HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").unwrap();
        let mut stream = BufReader::new(stream);
        let mut length = 0;
        for line in stream.by_ref().lines() {
            let line = line.unwrap().to_lowercase();
            if let Some(stated) = line.strip_prefix("content-length:") {
                length = stated.trim().parse().unwrap();
            }
            if line.is_empty() {
                break;
            }
        }
        let mut body = vec![0; length];
        stream.read_exact(&mut body).unwrap();
        let tabs: Value = serde_json::from_slice(&body).unwrap();
        let tab = tabs.as_array().unwrap().iter().find(|tab| tab["type"] == "page").unwrap();
        let url = tab["webSocketDebuggerUrl"].as_str().unwrap();
        let path = &url[url.find("/devtools").unwrap()..];
        let mut stream = TcpStream::connect(&address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(120))).unwrap();
        let upgrade = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==";
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {address}\r\n{upgrade}\r\n\r\n").unwrap();
        let mut stream = BufReader::new(stream);
        let mut line = String::new();
        while stream.read_line(&mut line).unwrap() > 2 {
            line.clear();
        }
        Self { stream, last_id: 0, events: Vec::new() }
    }

    /// Calls a method, and returns its result.
    pub(crate) fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.try_call(method, parameters).unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    /// Calls a method, and returns its result, or the error of the browser.
    pub(crate) fn try_call(&mut self, method: &str, parameters: &Value) -> Result<Value, Value> {
        self.last_id += 1;
        let message = json!({"id": self.last_id, "method": method, "params": parameters}).to_string();
        // The final text frame. A client masks its frames; this mask changes nothing.
        let mut frame = vec![0x81, 0xff];
        frame.extend((message.len() as u64).to_be_bytes());
        frame.extend([0; 4]);
        frame.extend(message.as_bytes());
        self.stream.get_mut().write_all(&frame).unwrap();
        loop {
            let answer = self.message();
            if answer["id"] == self.last_id {
                let error = answer["error"].clone();
                return if error.is_null() { Ok(answer["result"].clone()) } else { Err(error) };
            }
            self.events.push(answer);
        }
    }

    /// Reads a message, which may consist of several frames.
    fn message(&mut self) -> Value {
        let mut text = Vec::new();
        loop {
            let mut head = [0; 2];
            self.stream.read_exact(&mut head).unwrap();
            let length = match head[1] & 0x7f {
                126 => self.number::<2>(),
                127 => self.number::<8>(),
                short => usize::from(short),
            };
            let start = text.len();
            text.resize(start + length, 0);
            self.stream.read_exact(&mut text[start..]).unwrap();
            if head[0] & 0x80 != 0 {
                return serde_json::from_slice(&text).unwrap();
            }
        }
    }

    fn number<const BYTES: usize>(&mut self) -> usize {
        let mut bytes = [0; BYTES];
        self.stream.read_exact(&mut bytes).unwrap();
        bytes.iter().fold(0, |number, byte| number * 256 + usize::from(*byte))
    }
}
