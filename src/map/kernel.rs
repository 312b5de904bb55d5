//! Kernels for density estimation: the weight of a photon as a function of its distance.

use std::f64::consts::FRAC_1_PI;

/// The values of two kernels at one distance. Both kernels have the same radius. The Epanechnikov
/// kernel gives the estimate. The uniform kernel is needed only to estimate the bias. Both kernels
/// integrate to 1 over the disk or over the line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KernelValues {
    /// The value of the Epanechnikov kernel at the distance d. With the radius r, the value is
    /// 2/(πr²)·(1 − d²/r²) on the disk, and 3/(4r)·(1 − d²/r²) on the line.
    pub estimate: f64,
    /// The value of the uniform kernel. With the radius r, the value is 1/(πr²) on the disk, and
    /// 1/(2r) on the line.
    pub uniform: f64,
    /// The ratio μ_e/(μ_u − μ_e). Here μ_e and μ_u are the second moments of the Epanechnikov
    /// kernel and of the uniform kernel.
    moment_ratio: f64,
}

/// The two kernels on a disk. The fields hold the factors that do not depend on the photon's
/// distance.
#[derive(Debug, Clone, Copy)]
pub struct DiskKernel {
    per_r2: f64,
    /// The Epanechnikov kernel at distance 0.
    peak: f64,
    uniform: f64,
}

impl DiskKernel {
    /// Creates the kernels on a disk with the squared radius `r2` in m².
    #[inline]
    pub fn new(r2: f64) -> Self {
        let per_r2 = 1.0 / r2;
        Self { per_r2, peak: 2.0 * FRAC_1_PI * per_r2, uniform: FRAC_1_PI * per_r2 }
    }

    /// Divides each kernel by the fraction of the kernel that lies on the surface. Each kernel then
    /// integrates to 1 over the part of the disk that lies on the surface.
    #[inline]
    pub fn corrected(self, correction: BoundaryCorrection) -> Self {
        Self { peak: self.peak / correction.estimate, uniform: self.uniform / correction.uniform, ..self }
    }

    /// Returns the kernel values (1/m²) at the squared distance `d2` (m²). `d2` must not exceed the
    /// squared radius.
    #[inline]
    pub fn at(&self, d2: f64) -> KernelValues {
        KernelValues {
            estimate: self.peak * (1.0 - d2 * self.per_r2).max(0.0),
            uniform: self.uniform,
            moment_ratio: 2.0,
        }
    }
}

/// Returns the kernel values (1/m) on a line at the distance `d`. The kernel radius is `r`. Both
/// lengths are in m, and `d` must not exceed `r`. The second moments are μ_u = r²/3 and μ_e = r²/5.
pub fn on_line(d: f64, r: f64) -> KernelValues {
    let (uniform, relative) = (0.5 / r, d / r);
    KernelValues { estimate: 1.5 * uniform * (1.0 - relative * relative), uniform, moment_ratio: 1.5 }
}

/// The fraction of each kernel that lies on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryCorrection {
    /// The fraction of the Epanechnikov kernel.
    pub estimate: f64,
    /// The fraction of the uniform kernel.
    pub uniform: f64,
}

impl BoundaryCorrection {
    /// Both kernels lie completely on the surface.
    pub const WHOLE: Self = Self { estimate: 1.0, uniform: 1.0 };

    /// Returns the fraction of each kernel within the distance `t` of its centre. `t` is in units
    /// of the kernel radius.
    pub fn within(t: f64) -> Self {
        let t2 = (t * t).min(1.0);
        Self { estimate: t2 * (2.0 - t2), uniform: t2 }
    }
}

impl KernelValues {
    /// Multiplies both kernels by a factor.
    #[inline]
    pub fn times(self, factor: f64) -> Self {
        Self { estimate: self.estimate * factor, uniform: self.uniform * factor, ..self }
    }

    /// Returns the photon's contribution to the estimated bias, per unit of power.
    ///
    /// The bias of a second-order kernel is proportional to its second moment μ (Silverman 1986,
    /// "Density Estimation", section 3.3). The two kernels give the estimates L_e and L_u. The bias
    /// of L_e is therefore b = μ_e/(μ_u − μ_e)·(L_u − L_e). The second moments on the disk are μ_u
    /// = r²/2 and μ_e = r²/3.
    #[inline]
    pub fn bias(&self) -> f64 {
        self.moment_ratio * (self.uniform - self.estimate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Returns the integral of f(d²) over the disk of radius r.
    fn over_disk(r: f64, f: impl Fn(f64) -> f64) -> f64 {
        let n = 100_000;
        (0..n)
            .map(|i| {
                let d = (f64::from(i) + 0.5) / f64::from(n) * r;
                f(d * d) * TAU * d * r / f64::from(n)
            })
            .sum()
    }

    /// Checks that the kernels on the disk integrate to 1. Also checks the second moments from
    /// which `bias` is derived.
    #[test]
    fn disk_kernels_have_unit_mass_and_stated_moments() {
        let r = 0.3_f64;
        let r2 = r * r;
        assert!((over_disk(r, |d2| DiskKernel::new(r2).at(d2).estimate) - 1.0).abs() < 1e-8);
        assert!((over_disk(r, |d2| DiskKernel::new(r2).at(d2).uniform) - 1.0).abs() < 1e-8);
        assert!((over_disk(r, |d2| d2 * DiskKernel::new(r2).at(d2).estimate) - r2 / 3.0).abs() < 1e-8);
        assert!((over_disk(r, |d2| d2 * DiskKernel::new(r2).at(d2).uniform) - r2 / 2.0).abs() < 1e-8);
    }

    /// `BoundaryCorrection::within` equals the integral of the kernel.
    #[test]
    fn mass_within_half_a_radius_is_the_integral() {
        let within = over_disk(0.5, |d2| DiskKernel::new(1.0).at(d2).estimate);
        assert!((BoundaryCorrection::within(0.5).estimate - within).abs() < 1e-8);
        assert_eq!(BoundaryCorrection::within(0.5).uniform, 0.25);
        assert_eq!(
            [BoundaryCorrection::within(1.0), BoundaryCorrection::within(f64::INFINITY)],
            [BoundaryCorrection::WHOLE; 2]
        );
    }

    /// The kernels on the line integrate to 1. Their bias estimate is exact for a parabolic
    /// density.
    #[test]
    fn line_kernels_have_unit_mass_and_measure_bias() {
        let (r, c, n) = (0.4_f64, 0.7, 100_000);
        let over_line = |f: &dyn Fn(f64) -> f64| {
            let place = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * r;
            (0..n).map(|i| 2.0 * f(place(i)) * r / f64::from(n)).sum::<f64>()
        };
        assert!((over_line(&|d| on_line(d, r).estimate) - 1.0).abs() < 1e-8);
        assert!((over_line(&|d| on_line(d, r).uniform) - 1.0).abs() < 1e-8);
        let estimate = over_line(&|d| (1.0 + c * d * d) * on_line(d, r).estimate);
        let uniform = over_line(&|d| (1.0 + c * d * d) * on_line(d, r).uniform);
        let bias = KernelValues { estimate, uniform, ..on_line(0.0, r) }.bias();
        assert!((bias - (estimate - 1.0)).abs() < 1e-8);
    }

    /// The bias estimate is exact for a parabolic density.
    #[test]
    fn disk_bias_of_a_parabola_is_exact() {
        // If the density is 1 + c·d², the estimate at d = 0 is 1 + c·μ_e, and its bias is c·μ_e.
        let (r, c) = (0.5_f64, 0.8);
        let r2 = r * r;
        let estimate = over_disk(r, |d2| (1.0 + c * d2) * DiskKernel::new(r2).at(d2).estimate);
        let uniform = over_disk(r, |d2| (1.0 + c * d2) * DiskKernel::new(r2).at(d2).uniform);
        let bias = KernelValues { estimate, uniform, ..DiskKernel::new(r2).at(0.0) }.bias();
        assert!((bias - (estimate - 1.0)).abs() < 1e-8);
    }
}
