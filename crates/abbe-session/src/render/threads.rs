//! The thread pool of a render.

use abbe_spectra::error::{Error, Result};

/// Runs a function in a pool of this many threads, by default one per logical processor. Returns a
/// machine error if they cannot be started.
pub fn on_threads<R: Send>(threads: Option<u32>, run: impl FnOnce() -> R + Send) -> Result<R> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0) as usize);
    let pool = builder.build().map_err(|error| Error::machine(format!("threads cannot be started: {error}")))?;
    Ok(pool.install(run))
}

pub fn current_threads() -> usize {
    rayon::current_num_threads()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pool_has_the_requested_number_of_threads() {
        assert_eq!(on_threads(Some(3), rayon::current_num_threads), Ok(3));
        assert!(on_threads(None, rayon::current_num_threads).unwrap() >= 1);
    }
}
