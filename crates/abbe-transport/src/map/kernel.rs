//! Kernels for density estimation: the weight of a photon as a function of its distance.

use std::f64::consts::FRAC_1_PI;

/// The values at one distance of two kernels of the same radius, which integrate to 1 over the disk
/// or the line. The Epanechnikov kernel gives the estimate; the uniform kernel only estimates the
/// bias.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KernelValues {
    /// Epanechnikov, at the distance d for the radius r: 2/(πr²)·(1 − d²/r²) on the disk, and
    /// 3/(4r)·(1 − d²/r²) on the line.
    pub estimate: f64,
    /// Uniform: 1/(πr²) on the disk, and 1/(2r) on the line.
    pub uniform: f64,
    /// The value that a limit removed from `estimate`, in the same unit. See [`Self::limited`].
    clamped: f64,
    /// μ_e/(μ_u − μ_e), for the second moments of the Epanechnikov and of the uniform kernel.
    moment_ratio: f64,
}

/// The two kernels on a disk, without the factors that depend on the photon's distance.
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

    /// Divides each kernel by its fraction on the surface, so that it integrates to 1 there.
    #[inline]
    pub fn corrected(self, correction: BoundaryCorrection) -> Self {
        Self { peak: self.peak / correction.estimate, uniform: self.uniform / correction.uniform, ..self }
    }

    /// Returns the values (1/m²) at the squared distance `d2` (m²), at most the squared radius.
    #[inline]
    pub fn at(&self, d2: f64) -> KernelValues {
        KernelValues {
            estimate: self.peak * (1.0 - d2 * self.per_r2).max(0.0),
            uniform: self.uniform,
            clamped: 0.0,
            moment_ratio: 2.0,
        }
    }
}

/// Returns the kernel values (1/m) on a line at the distance `d` for the radius `r`, in m with `d`
/// ≤ `r`. The second moments are μ_u = r²/3 and μ_e = r²/5.
pub fn on_line(d: f64, r: f64) -> KernelValues {
    let (uniform, relative) = (0.5 / r, d / r);
    KernelValues { estimate: 1.5 * uniform * (1.0 - relative * relative), uniform, clamped: 0.0, moment_ratio: 1.5 }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KernelDomain {
    Line,
    Disk,
}

/// The fraction of each kernel that lies on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryCorrection {
    pub estimate: f64,
    pub uniform: f64,
}

impl BoundaryCorrection {
    pub const WHOLE: Self = Self { estimate: 1.0, uniform: 1.0 };

    /// Returns the fractions within the distance `t` of the centre, in kernel radii.
    pub fn within(t: f64) -> Self {
        let t2 = (t * t).min(1.0);
        Self { estimate: t2 * (2.0 - t2), uniform: t2 }
    }
}

impl KernelValues {
    #[inline]
    pub fn times(self, factor: f64) -> Self {
        let Self { estimate, uniform, clamped, moment_ratio } = self;
        Self { estimate: estimate * factor, uniform: uniform * factor, clamped: clamped * factor, moment_ratio }
    }

    /// Multiplies both kernels by `factor`, which replaces the larger factor `exact` to limit the
    /// noise. The difference counts as bias.
    pub fn limited(self, factor: f64, exact: f64) -> Self {
        let clamped = self.estimate * (exact - factor);
        Self { clamped, ..self.times(factor) }
    }

    /// Corrects the kernels of a photon in a medium beside faces.
    ///
    /// The line through the kernel's centre and the photon meets faces on both sides of the centre,
    /// at the distances `extents` in kernel radii, first on the photon's side. No photon arrives
    /// beyond the faces, so each kernel is divided by its mass between them; on the disk, this is
    /// the mass of two opposite, infinitely narrow sectors. The estimate of a constant density then
    /// has no bias.
    ///
    /// If the faces are not at equal distances, the bias contains a term proportional to the
    /// gradient of the density and to the first moment m of the kernel. The ratio m_e/(m_u − m_e)
    /// then replaces the ratio of the second moments, if it is larger.
    #[must_use]
    pub fn between_faces(self, domain: KernelDomain, extents: [f64; 2]) -> Self {
        if extents.iter().all(|&extent| extent >= 1.0) {
            return self;
        }
        let sides = extents.map(|extent| KernelSideMoments::new(domain, extent.min(1.0)));
        let estimate = 0.5 * (sides[0].estimate[0] + sides[1].estimate[0]);
        let uniform = 0.5 * (sides[0].uniform[0] + sides[1].uniform[0]);
        let first_estimate = 0.5 * (sides[0].estimate[1] - sides[1].estimate[1]).abs() / estimate;
        let first_uniform = 0.5 * (sides[0].uniform[1] - sides[1].uniform[1]).abs() / uniform;
        let excess = first_uniform - first_estimate;
        let of_first = if excess > 0.0 { first_estimate / excess } else { 0.0 };
        Self {
            estimate: self.estimate / estimate,
            uniform: self.uniform / uniform,
            clamped: self.clamped / estimate,
            moment_ratio: self.moment_ratio.max(of_first),
        }
    }

    /// Returns the photon's contribution to the estimated bias, per unit of power.
    ///
    /// The bias of a second-order kernel is proportional to its second moment μ (Silverman 1986,
    /// "Density Estimation", section 3.3), so the bias of L_e is μ_e/(μ_u − μ_e)·(L_u − L_e), with
    /// μ_u = r²/2 and μ_e = r²/3 on the disk. The value that a limit removed is subtracted.
    #[inline]
    pub fn bias(&self) -> f64 {
        self.moment_ratio * (self.uniform - self.estimate) - self.clamped
    }
}

/// The moments of order 0 (1 for the whole side) and 1 of each kernel on one side of its centre.
struct KernelSideMoments {
    estimate: [f64; 2],
    uniform: [f64; 2],
}

impl KernelSideMoments {
    /// Integrates the kernels over distances between 0 and `extent`, in units of the kernel radius.
    fn new(domain: KernelDomain, extent: f64) -> Self {
        let [e, e2] = [extent, extent * extent];
        match domain {
            KernelDomain::Line => {
                Self { estimate: [e * (1.5 - 0.5 * e2), e2 * (0.75 - 0.375 * e2)], uniform: [e, 0.5 * e2] }
            }
            KernelDomain::Disk => {
                Self { estimate: [e2 * (2.0 - e2), e * e2 * (4.0 / 3.0 - 0.8 * e2)], uniform: [e2, 2.0 / 3.0 * e * e2] }
            }
        }
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

    /// The kernels on the disk integrate to 1, and have the second moments of `bias`.
    #[test]
    fn disk_kernels_have_unit_mass_and_their_moments() {
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

    /// If the surface ends at half the kernel radius, both kernels integrate to 1 over the surface.
    #[test]
    fn corrected_kernels_have_unit_mass_on_the_surface() {
        let kernel = DiskKernel::new(1.0).corrected(BoundaryCorrection::within(0.5));
        assert!((over_disk(0.5, |d2| kernel.at(d2).estimate) - 1.0).abs() < 1e-8);
        assert!((over_disk(0.5, |d2| kernel.at(d2).uniform) - 1.0).abs() < 1e-8);
    }

    /// The kernels on the line integrate to 1, and their bias is exact for a parabola.
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

    /// A limit of the estimate does not hide the light that it removes.
    #[test]
    fn a_clamped_kernel_reports_the_rest_as_bias() {
        let kernels = on_line(0.1, 0.4);
        let limited = kernels.limited(10.0, 25.0);
        assert!((limited.estimate - 10.0 * kernels.estimate).abs() < 1e-12);
        assert!((limited.bias() - (10.0 * kernels.bias() - 15.0 * kernels.estimate)).abs() < 1e-12);
        assert_eq!(kernels.limited(10.0, 10.0).bias(), kernels.times(10.0).bias());
    }

    /// Beside faces, the corrected kernels of a constant density integrate to 1. If a face contains
    /// the kernel's centre and the density grows linearly, the bias estimate is exact.
    #[test]
    fn kernels_between_faces_keep_their_mass_and_know_their_bias() {
        let (r, n, gradient) = (0.4_f64, 100_000, 0.3);
        for (domain, extents) in [
            (KernelDomain::Line, [0.3, 0.8]),
            (KernelDomain::Line, [1.0, 0.0]),
            (KernelDomain::Disk, [0.5, 2.0]),
            (KernelDomain::Disk, [1.0, 0.0]),
        ] {
            let (mut mass, mut estimate, mut bias) = (0.0, 0.0, 0.0);
            for i in 0..n {
                // A position on the line, from −r to r. On the disk, the position represents a part
                // of two sectors. The area of this part is proportional to the distance.
                let x = (2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0) * r;
                let (distance, ahead) = (x.abs(), if x > 0.0 { extents } else { [extents[1], extents[0]] });
                if distance > ahead[0] * r {
                    continue;
                }
                let (kernels, measure) = match domain {
                    KernelDomain::Line => (on_line(distance, r), 1.0),
                    KernelDomain::Disk => (DiskKernel::new(r * r).at(distance * distance), 0.5 * TAU * distance),
                };
                let kernels = kernels.between_faces(domain, ahead).times(2.0 * r / f64::from(n) * measure);
                mass += kernels.estimate;
                estimate += (1.0 + gradient * x) * kernels.estimate;
                bias += (1.0 + gradient * x) * kernels.bias();
            }
            assert!((mass - 1.0).abs() < 1e-4, "{domain:?} {extents:?}: {mass}");
            if extents[1] == 0.0 {
                assert!((bias - (estimate - 1.0)).abs() < 1e-4, "{domain:?}: {bias} for {}", estimate - 1.0);
            }
        }
    }
}
