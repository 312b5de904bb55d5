//! Refusing what the machine cannot hold, rather than being killed in the middle of it.

use abbe::error::{Error, Result};
use abbe::plan::Budget;

/// Refuses a render that needs more memory than is available.
pub(crate) fn check(budget: &Budget) -> Result<()> {
    match available_bytes() {
        Some(available) if budget.memory_bytes > available => Err(refusal(budget, available)),
        Some(_) | None => Ok(()),
    }
}

fn refusal(budget: &Budget, available: u64) -> Error {
    let gigabytes = |bytes: u64| format!("{:.1} GB", bytes as f64 * 1e-9);
    let what = format!("out of memory: picture and photons need {}", gigabytes(budget.memory_bytes));
    let lower = match budget.photons_within(available) {
        0 => "lower --size (or --spectral-bands, or `render.light_map`)".to_string(),
        photons => format!("lower --photons to {photons} or fewer"),
    };
    Error::machine(what).expected(format!("at most the {} that are available: {lower}", gigabytes(available)))
}

/// What new allocations may take before the machine swaps, or before a control group's limit, where Linux tells.
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

    fn budget(memory_bytes: u64, photons: u64) -> Budget {
        let fixed = Budget {
            passes: 1,
            photons,
            max_depth: 1,
            nearest: 1,
            radius_m: None,
            light_map_cells: 2,
            seed: 0,
            memory_bytes,
            motion_px: 0.0,
        };
        assert!(fixed.memory_bytes > 0);
        fixed
    }

    #[test]
    fn a_render_that_fits_is_let_through_and_one_that_does_not_is_told_how_it_would() {
        assert!(check(&budget(1 << 20, 1)).is_ok());
        let said = refusal(&budget(41_000_000_000, 180_000_000), 8_000_000_000);
        assert_eq!(said.exit_status(), 1);
        let said = said.to_string();
        assert!(
            said.contains("need 41.0 GB") && said.contains("8.0 GB") && said.contains("lower --photons to"),
            "{said}"
        );
        let said = refusal(&budget(41_000_000_000, 1000), 8_000_000_000).to_string();
        assert!(said.contains("lower --size"), "{said}");
    }
}
