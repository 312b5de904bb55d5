//! How many threads take part.

use crate::error::{Error, Result};

/// Runs something with a pool of this many worker threads; without a number, as many as the machine runs at once.
///
/// # Errors
/// The machine's: threads that cannot be started.
pub fn on_threads<R: Send>(threads: Option<u32>, run: impl FnOnce() -> R + Send) -> Result<R> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0) as usize);
    let pool = builder.build().map_err(|error| Error::machine(format!("threads cannot be started: {error}")))?;
    Ok(pool.install(run))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_threads_as_asked_take_part() {
        assert_eq!(on_threads(Some(3), rayon::current_num_threads), Ok(3));
        assert!(on_threads(None, rayon::current_num_threads).unwrap() >= 1);
    }
}
