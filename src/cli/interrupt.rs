//! Ctrl-C and termination: the first finishes the pass and saves, the second ends the program at once.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::print;
use abbe::error::{Error, Result};

static ASKED: AtomicUsize = AtomicUsize::new(0);

/// Takes over Ctrl-C (SIGINT) and termination (SIGTERM, SIGHUP) for this process.
pub(crate) fn watch() -> Result<()> {
    ctrlc::set_handler(|| {
        if ASKED.fetch_add(1, Ordering::SeqCst) == 0 {
            print::remark("interrupted: finishing this pass, then saving (once more to end at once)");
        } else {
            std::process::exit(130);
        }
    })
    .map_err(|error| Error::machine(format!("Ctrl-C cannot be watched: {error}")))
}

/// Whether the user has asked for the end.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst) > 0
}
