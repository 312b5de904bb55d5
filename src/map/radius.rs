//! Kernel radii: fixed per pixel by the pilot, shrinking with the pass.

use glam::DVec3;

/// How far the radii of a pass have shrunk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// On surfaces.
    pub surface: f64,
    /// Of points in media, seen along a ray.
    pub points: f64,
    /// Of beams in media, seen along a ray.
    pub beams: f64,
}

impl Scales {
    /// Those of a pass, counted from 0.
    pub fn of_pass(pass: u64) -> Self {
        Self { surface: scale(pass, 2), points: scale(pass, 2), beams: scale(pass, 1) }
    }
}

/// How far the radius of pass `pass` (counted from 0) has shrunk: r_pass = scale · r_first. From rᵈ_{i+1} = rᵈ_i (i + α)/(i + 1), i counted from
/// 1, with α = 4/(d + 4) for a kernel of d dimensions (Knaus & Zwicker 2011, eq. 15): 2 on surfaces and for points seen along a ray, where mean square
/// error then falls as N^(−2/3); 1 for beams seen along a ray, N^(−4/5). Depends on the
/// pass's number alone, so that passes may run in any order.
fn scale(pass: u64, dimensions: u32) -> f64 {
    let alpha = 4.0 / (f64::from(dimensions) + 4.0);
    // Π (i + α)/(i + 1) for i = 1…pass: exact for the first, then by the ratio Γ(n + α)/Γ(n + 1) ~ n^(α−1)(1 + (α−1)α/2n).
    const EXACT: u64 = 4096;
    let product: f64 = (1..=pass.min(EXACT)).map(|i| (i as f64 + alpha) / (i as f64 + 1.0)).product();
    let tail = if pass > EXACT {
        let ratio = |n: f64| n.powf(alpha - 1.0) * (1.0 + (alpha - 1.0) * alpha / (2.0 * n));
        ratio(pass as f64 + 1.0) / ratio(EXACT as f64 + 1.0)
    } else {
        1.0
    };
    (product * tail).powf(1.0 / f64::from(dimensions))
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
        for (dimensions, alpha) in [(1, 4.0 / 5.0), (2, 2.0 / 3.0)] {
            let mut power = 1.0;
            for i in 1..6000_u64 {
                assert!((scale(i - 1, dimensions).powi(dimensions as i32) / power - 1.0).abs() < 1e-7, "pass {i}");
                power *= (i as f64 + alpha) / (i as f64 + 1.0);
            }
            assert_eq!(scale(0, dimensions), 1.0);
        }
    }

    #[test]
    fn a_first_radius_stays_within_its_bounds() {
        assert_eq!(first(Some(0.0), 0.01, 1.0), 0.01);
        assert_eq!(first(Some(0.5), 0.01, 1.0), 0.5);
        assert_eq!(first(None, 0.01, 1.0), 1.0);
        assert_eq!(first(Some(0.5), 2.0, 1.0), 1.0);
    }
}
