//! Kernel radii: fixed per pixel by the pilot, shrinking with the pass.

use glam::DVec3;

/// How far the radius of pass `pass` (counted from 0) has shrunk: r_pass = scale · r_first. From r²_{i+1} = r²_i (i + α)/(i + 1), i counted from
/// 1, with α = 2/3 for surfaces (Knaus & Zwicker 2011, eq. 15): mean square error then falls as N^(−2/3). Depends on the
/// pass's number alone, so that passes may run in any order.
pub fn scale(pass: u64) -> f64 {
    const ALPHA: f64 = 2.0 / 3.0;
    // Π (i + α)/(i + 1) for i = 1…pass: exact for the first, then by the ratio Γ(n + α)/Γ(n + 1) ~ n^(α−1)(1 + (α−1)α/2n).
    const EXACT: u64 = 4096;
    let product: f64 = (1..=pass.min(EXACT)).map(|i| (i as f64 + ALPHA) / (i as f64 + 1.0)).product();
    let tail = if pass > EXACT {
        let ratio = |n: f64| n.powf(ALPHA - 1.0) * (1.0 + (ALPHA - 1.0) * ALPHA / (2.0 * n));
        ratio(pass as f64 + 1.0) / ratio(EXACT as f64 + 1.0)
    } else {
        1.0
    };
    (product * tail).sqrt()
}

/// The first radius (m) of a pixel: that of the k-th nearest photon, at least the pixel's footprint (a smaller kernel only adds
/// noise within one pixel) and at most `largest`. Coincident photons (distance 0) give the footprint.
pub fn first(kth_distance_m: Option<f64>, footprint_m: f64, largest_m: f64) -> f64 {
    kth_distance_m.unwrap_or(largest_m).clamp(footprint_m.min(largest_m), largest_m)
}

/// The smallest radius (m) of a kernel at a place relative to the scene's centre: 16 of the steps in which photons' positions, in single precision,
/// are kept there. A smaller kernel would see their lattice.
pub fn least(place: DVec3) -> f64 {
    const SIXTEEN_STEPS: f64 = 16.0 * (f32::EPSILON as f64);
    SIXTEEN_STEPS * place.abs().max_element()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_shrink_as_the_recurrence_says() {
        let mut squared = 1.0;
        for i in 1..6000_u64 {
            assert!((scale(i - 1).powi(2) / squared - 1.0).abs() < 1e-7, "pass {i}");
            squared *= (i as f64 + 2.0 / 3.0) / (i as f64 + 1.0);
        }
        assert_eq!(scale(0), 1.0);
    }

    #[test]
    fn a_first_radius_stays_within_its_bounds() {
        assert_eq!(first(Some(0.0), 0.01, 1.0), 0.01);
        assert_eq!(first(Some(0.5), 0.01, 1.0), 0.5);
        assert_eq!(first(None, 0.01, 1.0), 1.0);
        assert_eq!(first(Some(0.5), 2.0, 1.0), 1.0);
    }
}
