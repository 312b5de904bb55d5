//! Ends a pass or the pilot before it is done.

use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that ends the work of a pass or of the pilot early. Another thread may raise it.
///
/// As soon as it is raised, no further photon and no camera path is traced, so that the work ends
/// soon. Its result is incomplete and must be discarded.
#[derive(Debug, Default)]
pub struct StopFlag(AtomicBool);

/// The flag of work that always ends.
pub static NEVER_STOP: StopFlag = StopFlag::new();

impl StopFlag {
    /// Returns a flag that is not raised.
    pub const fn new() -> Self {
        Self(AtomicBool::new(false))
    }

    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    #[inline]
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
