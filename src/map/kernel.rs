//! Kernels: how a photon's power spreads over the surface around it.

use std::f64::consts::FRAC_1_PI;

/// The kernel in use, Epanechnikov's, and the uniform one of the same radius; both integrate to 1 over the disk, or over the line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kernels {
    /// Epanechnikov's: 2/(πr²)·(1 − d²/r²) on the disk, 3/(4r)·(1 − d²/r²) on the line.
    pub estimate: f64,
    /// The uniform kernel: 1/(πr²), or 1/(2r).
    pub uniform: f64,
    /// μ_e/(μ_u − μ_e) of their second moments.
    moments: f64,
}

/// The kernels on a disk, for many photons: all that does not depend on their distance.
#[derive(Debug, Clone, Copy)]
pub struct Disk {
    per_r2: f64,
    /// Epanechnikov's in the middle.
    peak: f64,
    uniform: f64,
}

impl Disk {
    /// The disk of the squared radius `r2`, in m².
    #[inline]
    pub fn new(r2: f64) -> Self {
        let per_r2 = 1.0 / r2;
        Self { per_r2, peak: 2.0 * FRAC_1_PI * per_r2, uniform: FRAC_1_PI * per_r2 }
    }

    /// The same where only shares of the kernels lie on the surface: what lies there integrates to 1 again.
    #[inline]
    pub fn over(self, shares: Shares) -> Self {
        Self { peak: self.peak / shares.estimate, uniform: self.uniform / shares.uniform, ..self }
    }

    /// The kernels' values (1/m²) at the squared distance `d2`, at most the squared radius.
    #[inline]
    pub fn at(&self, d2: f64) -> Kernels {
        Kernels { estimate: self.peak * (1.0 - d2 * self.per_r2).max(0.0), uniform: self.uniform, moments: 2.0 }
    }
}

/// The kernels' values on a line (1/m) at the distance `d` within the radius `r`; μ_u = r²/3 and μ_e = r²/5.
pub fn on_line(d: f64, r: f64) -> Kernels {
    let (uniform, share) = (0.5 / r, d / r);
    Kernels { estimate: 1.5 * uniform * (1.0 - share * share), uniform, moments: 1.5 }
}

/// What shares of the two kernels' masses lie on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    /// Of Epanechnikov's.
    pub estimate: f64,
    /// Of the uniform one's.
    pub uniform: f64,
}

impl Shares {
    /// Both kernels lie on the surface as a whole.
    pub const WHOLE: Self = Self { estimate: 1.0, uniform: 1.0 };

    /// What lies within `t` radii of the kernels' centre.
    pub fn within(t: f64) -> Self {
        let t2 = (t * t).min(1.0);
        Self { estimate: t2 * (2.0 - t2), uniform: t2 }
    }
}

impl Kernels {
    /// The kernels times a factor.
    #[inline]
    pub fn times(self, factor: f64) -> Self {
        Self { estimate: self.estimate * factor, uniform: self.uniform * factor, ..self }
    }

    /// A photon's share in the estimated bias of the Epanechnikov estimate L_e, from L_u by the uniform kernel of the same radius. The
    /// bias of a second-order kernel is proportional to its second moment μ; on the disk μ_u = r²/2 and μ_e = r²/3, so that
    /// b = μ_e/(μ_u − μ_e)·(L_u − L_e).
    #[inline]
    pub fn bias(&self) -> f64 {
        self.moments * (self.uniform - self.estimate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// ∫ f(d²) over the disk of radius r.
    fn over_disk(r: f64, f: impl Fn(f64) -> f64) -> f64 {
        let n = 100_000;
        (0..n)
            .map(|i| {
                let d = (f64::from(i) + 0.5) / f64::from(n) * r;
                f(d * d) * TAU * d * r / f64::from(n)
            })
            .sum()
    }

    #[test]
    fn kernels_integrate_to_one_and_have_the_stated_second_moments() {
        let r = 0.3_f64;
        let r2 = r * r;
        assert!((over_disk(r, |d2| Disk::new(r2).at(d2).estimate) - 1.0).abs() < 1e-8);
        assert!((over_disk(r, |d2| Disk::new(r2).at(d2).uniform) - 1.0).abs() < 1e-8);
        assert!((over_disk(r, |d2| d2 * Disk::new(r2).at(d2).estimate) - r2 / 3.0).abs() < 1e-8);
        assert!((over_disk(r, |d2| d2 * Disk::new(r2).at(d2).uniform) - r2 / 2.0).abs() < 1e-8);
    }

    #[test]
    fn the_mass_within_half_a_radius_is_the_integral_over_it() {
        let within = over_disk(0.5, |d2| Disk::new(1.0).at(d2).estimate);
        assert!((Shares::within(0.5).estimate - within).abs() < 1e-8);
        assert_eq!(Shares::within(0.5).uniform, 0.25);
        assert_eq!([Shares::within(1.0), Shares::within(f64::INFINITY)], [Shares::WHOLE; 2]);
    }

    #[test]
    fn kernels_on_a_line_integrate_to_one_and_find_the_bias_of_a_parabola() {
        let (r, c, n) = (0.4_f64, 0.7, 100_000);
        let over_line = |f: &dyn Fn(f64) -> f64| {
            let place = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * r;
            (0..n).map(|i| 2.0 * f(place(i)) * r / f64::from(n)).sum::<f64>()
        };
        assert!((over_line(&|d| on_line(d, r).estimate) - 1.0).abs() < 1e-8);
        assert!((over_line(&|d| on_line(d, r).uniform) - 1.0).abs() < 1e-8);
        let estimate = over_line(&|d| (1.0 + c * d * d) * on_line(d, r).estimate);
        let uniform = over_line(&|d| (1.0 + c * d * d) * on_line(d, r).uniform);
        let bias = Kernels { estimate, uniform, ..on_line(0.0, r) }.bias();
        assert!((bias - (estimate - 1.0)).abs() < 1e-8);
    }

    #[test]
    fn the_bias_of_a_parabola_is_found_exactly() {
        // Density 1 + c·d² seen at its vertex: the estimate is 1 + c·μ_e, its bias c·μ_e.
        let (r, c) = (0.5_f64, 0.8);
        let r2 = r * r;
        let estimate = over_disk(r, |d2| (1.0 + c * d2) * Disk::new(r2).at(d2).estimate);
        let uniform = over_disk(r, |d2| (1.0 + c * d2) * Disk::new(r2).at(d2).uniform);
        let bias = Kernels { estimate, uniform, ..Disk::new(r2).at(0.0) }.bias();
        assert!((bias - (estimate - 1.0)).abs() < 1e-8);
    }
}
