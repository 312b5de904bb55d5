//! Handles Ctrl-C and termination: the first signal discards the unfinished pass and saves the run,
//! and the second ends the program at once.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

use super::print;
use abbe_spectra::error::{Error, Result};
use abbe_transport::walk::StopFlag;

static SIGNALS: AtomicUsize = AtomicUsize::new(0);

/// Ends the pass of a running render.
static STOP: LazyLock<Arc<StopFlag>> = LazyLock::new(Arc::default);

/// Installs a handler for Ctrl-C (SIGINT) and for termination (SIGTERM, SIGHUP) in this process.
pub(crate) fn watch() -> Result<()> {
    let installed = ctrlc::set_handler(|| {
        if SIGNALS.fetch_add(1, Ordering::SeqCst) == 0 {
            STOP.raise();
            print::remark("interrupted: saving what is finished; interrupt again to quit at once");
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

/// Returns the flag that the first signal raises.
pub(crate) fn stop_flag() -> Arc<StopFlag> {
    Arc::clone(&STOP)
}

/// Returns true if the user has interrupted the program.
pub(crate) fn is_requested() -> bool {
    SIGNALS.load(Ordering::SeqCst) > 0
}
