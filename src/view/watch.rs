//! Watches the scene file, and notices interruptions.

use super::channel::ViewChannel;
use abbe_spectra::error::{Error, Result};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

/// The time between two looks.
const INTERVAL: Duration = Duration::from_millis(100);

/// The time of the last change of a file, and its length in bytes.
type FileStamp = Option<(SystemTime, u64)>;

fn stamp(path: &Path) -> FileStamp {
    let found = std::fs::metadata(path).ok()?;
    Some((found.modified().ok()?, found.len()))
}

/// Starts the watch thread for a file, or only for interruptions. The thread ends with the
/// process or after an interruption. Returns a machine error if it cannot be started.
pub(super) fn start(path: Option<&Path>, is_interrupted: fn() -> bool, channel: Arc<ViewChannel>) -> Result<()> {
    let path = path.map(Path::to_path_buf);
    let look = move || path.as_deref().and_then(stamp);
    let mut seen = look();
    let watch = move || {
        while !is_interrupted() {
            std::thread::sleep(INTERVAL);
            let now = look();
            // Some editors remove the file before they write it again.
            if now.is_some() && now != seen {
                seen = now;
                channel.scene_file_changed();
            }
        }
        channel.interrupt();
    };
    let started = std::thread::Builder::new().name("abbe-watch".to_string()).spawn(watch);
    started.map(drop).map_err(|error| Error::machine(format!("the watch thread cannot be started: {error}")))
}
