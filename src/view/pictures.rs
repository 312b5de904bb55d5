//! Shows saved pictures instead of a render.

use super::channel::ViewChannel;
use super::watch;
use crate::page::{ScenePanels, SessionState, Snapshot, ViewProgress};
use abbe_session::output::exr::{ExrFile, read};
use abbe_spectra::error::{Error, Result};
use std::path::Path;
use std::sync::Arc;

/// Publishes a picture until the user interrupts the program, again when its file changes, for
/// example during a render. Returns an error if the first read fails, or if a thread cannot be
/// started.
pub(super) fn run(channel: &Arc<ViewChannel>, path: &Path, is_interrupted: fn() -> bool) -> Result<()> {
    watch::start(Some(path), is_interrupted, Arc::clone(channel))?;
    let mut number = 0;
    loop {
        let orders = channel.orders();
        if orders.interrupted {
            return Ok(());
        }
        match snapshot(path, number + 1) {
            Ok(snapshot) => {
                number += 1;
                let progress = ViewProgress {
                    passes: snapshot.passes,
                    relative_error: snapshot.picture.error_means().relative,
                    typical_error: snapshot.picture.error_distribution().map(|errors| errors.typical),
                    ..ViewProgress::default()
                };
                channel.begin(Arc::clone(&snapshot.scene), None);
                channel.publish(orders.revision, Arc::new(snapshot));
                channel.report(orders.revision, SessionState::Finished, progress);
            }
            Err(error) if number == 0 => return Err(error),
            Err(error) => channel.fail(orders.revision, error.to_string()),
        }
        channel.wait(None, |now| now.revision != orders.revision || now.interrupted);
    }
}

/// Reads the reference. Returns an error if it cannot be read, or the sizes differ.
pub(super) fn set_reference(channel: &ViewChannel, path: &Path, picture: Option<&Path>) -> Result<()> {
    let reference = snapshot(path, 1)?;
    if let Some(picture) = picture.map(read).transpose()? {
        let (a, b) = (&picture.picture, &reference.picture);
        if (a.width, a.height) != (b.width, b.height) {
            let what = format!("pictures of {} × {} and {} × {} pixels", a.width, a.height, b.width, b.height);
            return Err(Error::input(what).expected("two pictures of the same size"));
        }
    }
    channel.set_reference(Arc::new(reference));
    Ok(())
}

fn snapshot(path: &Path, number: u64) -> Result<Snapshot> {
    let ExrFile { picture, metadata } = read(path)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let scene = Arc::new(ScenePanels::of_file(number, &name, &picture, &metadata));
    Ok(Snapshot::of_file(number, &name, scene, picture, metadata))
}
