//! Sends the picture of a running render to the image viewer tev.

use std::collections::VecDeque;
use std::fmt;
use std::io::{self, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use abbe_session::output::tev::{DEFAULT_PORT, TevImage};
use abbe_spectra::error::{Error, Result};

use super::print;

const CONNECTION_TIME: Duration = Duration::from_secs(3);

/// After the last picture, the program waits at most this time until all pictures are sent.
const END_TIME: Duration = Duration::from_secs(3);

/// The largest number of images that wait. They have different names.
const MOST_WAITING: usize = 4;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ServerAddress {
    host: String,
    port: u16,
}

impl ServerAddress {
    /// Parses `HOST` or `HOST:PORT`. IPv6 addresses with a port are in brackets.
    pub(crate) fn parse(text: &str) -> std::result::Result<Self, String> {
        let wrong = || format!("expected HOST or HOST:PORT, such as 127.0.0.1:{DEFAULT_PORT}");
        let is_ipv6 = text.parse::<std::net::Ipv6Addr>().is_ok();
        let (host, port) = match text.rsplit_once(':').filter(|(host, _)| !is_ipv6 && !host.ends_with(':')) {
            Some((host, port)) if !port.ends_with(']') => (host, port.parse().map_err(|_| wrong())?),
            Some(_) | None => (text, DEFAULT_PORT),
        };
        let host = host.strip_prefix('[').and_then(|host| host.strip_suffix(']')).unwrap_or(host);
        if host.is_empty() || port == 0 {
            return Err(wrong());
        }
        Ok(Self { host: host.to_string(), port })
    }

    fn connect(&self) -> io::Result<TcpStream> {
        let mut failure = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
        for address in (self.host.as_str(), self.port).to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, CONNECTION_TIME) {
                Ok(stream) => return Ok(stream),
                Err(error) => failure = error,
            }
        }
        Err(failure)
    }
}

impl fmt::Display for ServerAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { host, port } = self;
        if host.contains(':') { write!(f, "[{host}]:{port}") } else { write!(f, "{host}:{port}") }
    }
}

/// A connection to a display server. A thread sends the images, so a slow server does not delay the
/// render. A newer image replaces an older one with the same name.
#[derive(Debug)]
pub(crate) struct DisplayServer {
    address: ServerAddress,
    queue: Arc<ImageQueue>,
}

#[derive(Debug, Default)]
struct ImageQueue {
    state: Mutex<QueueState>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct QueueState {
    waiting: VecDeque<TevImage>,
    /// True while the thread sends an image.
    is_sending: bool,
    /// True if the connection has failed.
    is_closed: bool,
}

impl ImageQueue {
    /// No thread leaves the state inconsistent, so a panic elsewhere does not matter here.
    fn lock(&self) -> MutexGuard<'_, QueueState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn next(&self) -> TevImage {
        let mut state = self.lock();
        state.is_sending = false;
        self.changed.notify_all();
        loop {
            if let Some(image) = state.waiting.pop_front() {
                state.is_sending = true;
                return image;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl DisplayServer {
    /// Connects to a server, and starts the thread that sends images.
    pub(crate) fn connect(address: &ServerAddress) -> Result<Self> {
        let stream = address.connect().map_err(|error| {
            Error::machine(format!("no tev at {address}: {error}")).expected("a running tev that listens there")
        })?;
        let queue = Arc::new(ImageQueue::default());
        let (sent, named) = (Arc::clone(&queue), address.to_string());
        let work = move || {
            if let Err(error) = send_images(stream, &sent) {
                print::remark(&format!("warning: tev at {named} does not answer: {error}; the render continues"));
            }
            let mut state = sent.lock();
            (state.is_closed, state.is_sending) = (true, false);
            state.waiting.clear();
            sent.changed.notify_all();
        };
        let started = std::thread::Builder::new().name("abbe-display".to_string()).spawn(work);
        started.map_err(|error| Error::machine(format!("a thread cannot be started: {error}")))?;
        Ok(Self { address: address.clone(), queue })
    }

    /// Sends an image later, on another thread.
    pub(crate) fn show(&self, image: TevImage) {
        let mut state = self.queue.lock();
        if state.is_closed {
            return;
        }
        state.waiting.retain(|waiting| waiting.name != image.name);
        state.waiting.push_back(image);
        if state.waiting.len() > MOST_WAITING {
            state.waiting.pop_front();
        }
        self.queue.changed.notify_all();
    }

    /// Waits for a short time until all images are sent.
    pub(crate) fn finish(&self) {
        let end = Instant::now() + END_TIME;
        let mut state = self.queue.lock();
        while state.is_sending || !state.waiting.is_empty() {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                let address = &self.address;
                print::remark(&format!("warning: tev at {address} is too slow; it does not show the last picture"));
                return;
            }
            state = self.queue.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

/// Sends images until the connection fails.
fn send_images(mut stream: TcpStream, queue: &ImageQueue) -> io::Result<()> {
    let mut created: Option<(String, usize, usize)> = None;
    loop {
        let image = queue.next();
        let now = Some((image.name.clone(), image.width, image.height));
        if created != now {
            stream.write_all(&image.creation())?;
            created = now;
        }
        for packet in image.updates() {
            stream.write_all(&packet)?;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_port_may_be_left_out() {
        let parsed = |text: &str| ServerAddress::parse(text).map(|address| address.to_string());
        for (text, known) in [
            ("localhost", "localhost:14158"),
            ("10.0.0.7:80", "10.0.0.7:80"),
            ("::1", "[::1]:14158"),
            ("[::1]", "[::1]:14158"),
            ("[::1]:9", "[::1]:9"),
        ] {
            assert_eq!(parsed(text).as_deref(), Ok(known), "{text}");
        }
        assert!(["", ":1", "a:", "a:b", "a:0", "a:70000"].iter().all(|text| parsed(text).is_err()));
    }
}
