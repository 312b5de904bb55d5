//! The live view: renders a scene, and shows the picture on a page in the browser.
//!
//! The session loads the scene on the thread of the caller, and starts a thread for each render.
//! The server answers requests on its own thread, and the watch thread notices changes of the scene
//! file and interruptions. They share a channel: a render replaces the published picture, and the
//! server reads it, so a render never waits for a browser.

mod access;
mod channel;
mod examples;
mod host;
mod listener;
mod pictures;
mod publisher;
mod server;
mod session;
mod start_page;
mod watch;

pub use examples::Example;
pub use host::ViewHost;
pub use session::SessionEnd;

use abbe_session::render::StopRules;
use abbe_spectra::error::{Error, Result};
use channel::ViewChannel;
use std::net::{IpAddr, SocketAddr};
use std::path::Path;
use std::sync::Arc;

/// A view whose server listens, and whose session has not started.
#[derive(Debug)]
pub struct LiveView {
    channel: Arc<ViewChannel>,
    address: SocketAddr,
    token: String,
}

impl LiveView {
    /// Starts the server, on a free port for 0, or returns a machine error. If `has_examples` is
    /// true, the first page offers the example scenes.
    pub fn listen(bind: IpAddr, port: u16, has_examples: bool) -> Result<Self> {
        let channel = Arc::new(ViewChannel::new(has_examples));
        let token = access::random_token();
        let wanted = SocketAddr::new(bind, port);
        let unusable = |error: std::io::Error| Error::machine(format!("cannot listen on {wanted}: {error}"));
        let listener = std::net::TcpListener::bind(wanted).map_err(unusable)?;
        let address = listener.local_addr().map_err(unusable)?;
        let access = access::Access::new(&token, address);
        server::start(listener, access, Arc::clone(&channel)).map_err(unusable)?;
        Ok(Self { channel, address, token })
    }

    pub fn url(&self) -> String {
        format!("http://{}/{}/", self.address, self.token)
    }

    /// Reads a picture with which the page compares the render, or the picture in the file
    /// `picture`. Returns an error if a file cannot be read, or if both pictures have different
    /// sizes.
    pub fn compare_with(&self, reference: &Path, picture: Option<&Path>) -> Result<()> {
        pictures::set_reference(&self.channel, reference, picture)
    }

    /// Shows the picture in an EXR file until the user interrupts the program. Returns an error if
    /// the first read fails, or if a thread cannot be started.
    pub fn show(&self, picture: &Path, is_interrupted: fn() -> bool) -> Result<()> {
        pictures::run(&self.channel, picture, is_interrupted)
    }

    /// Renders the scene until the host is interrupted; the page may pause the render and change
    /// the scene. Returns an error if the first load fails, or if a thread cannot be started.
    pub fn run(&self, host: &dyn ViewHost, stop: StopRules) -> Result<SessionEnd> {
        watch::start(host.scene_path(), host.interruption(), Arc::clone(&self.channel))?;
        session::run(host, &self.channel, stop)
    }
}
