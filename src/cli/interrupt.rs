//! Handles Ctrl-C and termination: the first signal finishes the pass and saves the run, and the
//! second ends the program at once.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::print;
use abbe_spectra::error::{Error, Result};

static SIGNALS: AtomicUsize = AtomicUsize::new(0);

/// Installs a handler for Ctrl-C (SIGINT) and for termination (SIGTERM, SIGHUP) in this process.
pub(crate) fn watch() -> Result<()> {
    let installed = ctrlc::set_handler(|| {
        if SIGNALS.fetch_add(1, Ordering::SeqCst) == 0 {
            print::remark("interrupted: finishing this step and saving; interrupt again to quit at once");
        } else {
            std::process::exit(130);
        }
    });
    match installed {
        // A process may run several commands, so the handler may be installed already.
        Ok(()) | Err(ctrlc::Error::MultipleHandlers) => Ok(()),
        Err(error) => Err(Error::machine(format!("the handler of Ctrl-C cannot be installed: {error}"))),
    }
}

/// Returns true if the user has interrupted the program.
pub(crate) fn is_requested() -> bool {
    SIGNALS.load(Ordering::SeqCst) > 0
}
