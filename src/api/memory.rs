//! Refuses renders that need more memory than the machine has, before the system kills the process.

use std::path::Path;

use abbe_scene::Scene;
use abbe_session::render::Job;
use abbe_spectra::error::{Error, Result};
use abbe_transport::plan::Budget;

/// Plans a render, and checks that it fits into the available memory. Errors of the scene name the
/// scene file `path`.
///
/// # Errors
/// Returns an error if the scene cannot be planned, and the error of [`check`].
pub fn plan(scene: Scene, path: &Path) -> Result<Job> {
    let job = Job::new(scene).map_err(|error| error.in_file(path))?;
    check(&job.budget)?;
    Ok(job)
}

/// Checks that a render fits into the available memory.
///
/// # Errors
/// Returns an error of the machine if the render needs more memory than is available. The error
/// says which settings make the render fit.
pub fn check(budget: &Budget) -> Result<()> {
    match available_bytes() {
        Some(available) if budget.memory_bytes > available => Err(refusal(budget, available)),
        Some(_) | None => Ok(()),
    }
}

fn refusal(budget: &Budget, available: u64) -> Error {
    let gigabytes = |bytes: u64| format!("{:.1} GB", bytes as f64 * 1e-9);
    let what = format!("not enough memory: film and photons need {}", gigabytes(budget.memory_bytes));
    let remedy = match budget.photons_within(available) {
        0 => "a smaller --size, --no-denoise, fewer --spectral-bands or a smaller `render.light_map`".to_string(),
        photons => format!("at most --photons {photons}"),
    };
    Error::machine(what).expected(format!("at most {}, which are available; use {remedy}", gigabytes(available)))
}

/// Returns the available memory in bytes, beyond which the machine swaps, or the process exceeds
/// the limit of its control group. `None` if the system does not report it.
fn available_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kilobytes = line.and_then(|rest| rest.split_whitespace().next()).and_then(|n| n.parse::<u64>().ok());
    let free = kilobytes.map(|kilobytes| kilobytes.saturating_mul(1024));
    let limit = std::fs::read_to_string("/sys/fs/cgroup/memory.max").ok().and_then(|text| text.trim().parse().ok());
    free.into_iter().chain(limit).min()
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::Seed;

    fn budget(memory_bytes: u64, photons: u64) -> Budget {
        let fixed = Budget {
            passes: 1,
            photons,
            photon_bytes: 68,
            photons_are_explicit: true,
            camera_samples: None,
            nearest: 1,
            radius_m: None,
            light_map_cells: 2,
            seed: Seed::new(0),
            memory_bytes,
            motion_px: 0.0,
        };
        assert!(fixed.memory_bytes > 0);
        fixed
    }

    #[test]
    fn a_render_that_does_not_fit_is_refused_with_a_remedy() {
        assert!(check(&budget(1 << 20, 1)).is_ok());
        let error = refusal(&budget(41_000_000_000, 300_000_000), 8_000_000_000);
        assert_eq!(error.exit_status(), 1);
        let error = error.to_string();
        assert!(
            error.contains("need 41.0 GB") && error.contains("8.0 GB") && error.contains("at most --photons"),
            "{error}"
        );
        let error = refusal(&budget(41_000_000_000, 1000), 8_000_000_000).to_string();
        assert!(error.contains("a smaller --size"), "{error}");
    }
}
