//! Sampling of distances along a segment at which the medium scatters direct light.

use abbe_scene::geometry::Ray;
use abbe_scene::light::LitInterval;
use abbe_scene::medium::Medium;
use abbe_spectra::math::elementary::{atan, exp, exp_m1, ln_1p, tan};

#[derive(Debug, Clone, Copy)]
pub(super) struct DistanceSample {
    /// In m.
    pub(super) t_m: f64,
    pub(super) pdf_per_m: f64,
}

/// Samples a distance within the light's reach, or `None` if the medium is empty there.
///
/// If the light has a pivot, half of the samples are equiangular as seen from it (Kulla & Fajardo
/// 2012, "Importance Sampling Techniques for Path Tracing in Participating Media"). The others are
/// distributed like the transmittance, one half each with the least and the largest extinction
/// coefficient over the band, so that one of the techniques has a suitable density at every
/// wavelength and distance. The returned density is that of the mixture (balance heuristic).
pub(super) fn sample(medium: &Medium, ray: &Ray, lit: &LitInterval, u: [f64; 2]) -> Option<DistanceSample> {
    let techniques = Techniques::new(medium, ray, lit)?;
    let by_angle = if techniques.equiangular.is_some() { 0.5 } else { 0.0 };
    let t = match &techniques.equiangular {
        Some(equiangular) if u[0] < by_angle => equiangular.at(u[1]),
        _ => {
            let sigma = techniques.sigma[usize::from((u[0] - by_angle) / (1.0 - by_angle) >= 0.5)];
            techniques.sample_transmittance(sigma, u[1])?
        }
    };
    let pdf = techniques.equiangular.as_ref().map_or(0.0, |equiangular| by_angle * equiangular.pdf(t))
        + (1.0 - by_angle) * techniques.transmittance_pdf(t);
    (pdf > 0.0 && t.is_finite()).then_some(DistanceSample { t_m: t, pdf_per_m: pdf })
}

#[derive(Debug, Clone, Copy)]
pub(super) struct StratifiedDistance {
    /// In m.
    pub(super) t_m: f64,
    /// The column density (m) between the ray's origin and this distance.
    pub(super) column_m: f64,
    /// The relative density ρ divided by the sampling density (1/m). For any f, the sum of
    /// `strength_m` × f over the distances estimates the integral of ρ f along the ray.
    pub(super) strength_m: f64,
}

pub(super) const MOST_DISTANCES: usize = 8;

/// Calls `visit` with stratified distances in increasing order, divided among the techniques of
/// [`sample`], in one traversal of the medium. `shift` in [0, 1)² moves those of each technique
/// within their strata.
pub(super) fn for_each_stratified(
    medium: &Medium,
    ray: &Ray,
    lit: &LitInterval,
    shift: [f64; 2],
    mut visit: impl FnMut(StratifiedDistance),
) {
    let Some(techniques) = Techniques::new(medium, ray, lit) else { return };
    let by_angle = if techniques.equiangular.is_some() { MOST_DISTANCES / 2 } else { 0 };
    let by_column = (MOST_DISTANCES - by_angle) / 2;
    let stratum = |i: usize, count: usize, shift: f64| (i as f64 + shift.fract()) / count as f64;
    let angle = |i: usize| {
        let equiangular = techniques.equiangular.as_ref().filter(|_| i < by_angle)?;
        Some((equiangular.at(stratum(i, by_angle, shift[0])) - techniques.start).clamp(0.0, techniques.length))
    };
    // The two techniques are half a stratum apart, so they differ even for equal coefficients.
    let column = |technique: usize, i: usize| {
        let u = stratum(i, by_column, shift[1] + 0.5 * technique as f64);
        (i < by_column).then(|| (technique, techniques.sample_column(techniques.sigma[technique], u)))
    };
    let before = medium.column_m(ray, lit.from);
    let rest = |from: f64| Ray { origin: techniques.ray.at(from), direction: ray.direction };
    let mut taken = [0; 3];
    let (mut t, mut passed, mut ahead) = (0.0, 0.0, None);
    loop {
        if ahead.is_none() {
            let next = [0, 1]
                .map(|technique| column(technique, taken[technique]))
                .into_iter()
                .flatten()
                .min_by(|a, b| a.1.total_cmp(&b.1));
            ahead = next.and_then(|(technique, wanted)| {
                let more = medium.distance_at(&rest(t), techniques.length - t, wanted - passed)?;
                Some((technique, wanted, t + more))
            });
        }
        let by_angle_next = angle(taken[2]);
        match (ahead, by_angle_next) {
            (None, None) => return,
            (Some((technique, wanted, there)), other) if other.is_none_or(|other| there <= other) => {
                (t, passed, ahead) = (there, wanted, None);
                taken[technique] += 1;
            }
            (_, Some(there)) => {
                passed += medium.column_m(&rest(t), there - t);
                t = there;
                taken[2] += 1;
            }
            (Some(_), None) => return,
        }
        let density = medium.density_at(techniques.ray.at(t));
        let of_columns =
            (0..2).map(|technique| techniques.column_pdf(techniques.sigma[technique], passed)).sum::<f64>();
        let of_angles =
            techniques.equiangular.as_ref().map_or(0.0, |equiangular| equiangular.pdf(techniques.start + t));
        let distances_per_m = by_column as f64 * of_columns * density + by_angle as f64 * of_angles;
        if density > 0.0 {
            visit(StratifiedDistance {
                t_m: techniques.start + t,
                column_m: before + passed,
                strength_m: density / distances_per_m,
            });
        }
    }
}

struct Techniques<'a> {
    medium: &'a Medium,
    /// The part of the ray within the light's reach.
    ray: Ray,
    /// The distance (m) from the origin of the whole ray to the start of this part.
    start: f64,
    /// The length of this part in m.
    length: f64,
    /// The column density of this part in m.
    column: f64,
    /// The least and the largest extinction coefficient over the band, in 1/m.
    sigma: [f64; 2],
    equiangular: Option<Equiangular>,
}

impl<'a> Techniques<'a> {
    fn new(medium: &'a Medium, ray: &Ray, lit: &LitInterval) -> Option<Self> {
        let (start, length) = (lit.from, lit.to - lit.from);
        let part = Ray { origin: ray.at(start), direction: ray.direction };
        let column = medium.column_m(&part, length);
        let equiangular = lit.pivot.and_then(|pivot| Equiangular::new(ray, pivot, lit.from, lit.to));
        let sigma = [medium.extinction_range.0, medium.extinction_range.1];
        (column > 0.0).then_some(Self { medium, ray: part, start, length, column, sigma, equiangular })
    }

    /// Returns the distance at which 1 − T reaches the fraction `u` of its final value.
    fn sample_transmittance(&self, sigma: f64, u: f64) -> Option<f64> {
        let column = self.sample_column(sigma, u);
        self.medium.distance_at(&self.ray, self.length, column).map(|t| self.start + t)
    }

    /// Returns the column density at which 1 − T reaches the fraction `u` of its final value.
    fn sample_column(&self, sigma: f64, u: f64) -> f64 {
        let depth = sigma * self.column;
        if depth < 1e-6 {
            u * self.column
        } else if self.column.is_finite() {
            -ln_1p(u * exp_m1(-depth)) / sigma
        } else {
            -ln_1p(-u) / sigma
        }
    }

    /// Returns the mean of the probability densities (1/m) of the two transmittance techniques.
    fn transmittance_pdf(&self, t: f64) -> f64 {
        let along = t - self.start;
        let density = self.medium.density_at(self.ray.at(along));
        let column = self.medium.column_m(&self.ray, along);
        0.5 * density * (self.column_pdf(self.sigma[0], column) + self.column_pdf(self.sigma[1], column))
    }

    /// Returns the pdf (1/m) with which one technique samples a column density.
    fn column_pdf(&self, sigma: f64, column: f64) -> f64 {
        let depth = sigma * self.column;
        if depth < 1e-6 { 1.0 / self.column } else { sigma * exp(-sigma * column) / -exp_m1(-depth) }
    }
}

/// Equiangular sampling: distances at equal angles as seen from a pivot (Kulla & Fajardo 2012).
struct Equiangular {
    /// The distance along the ray to the point nearest to the pivot, in m.
    nearest: f64,
    /// The distance from the pivot to the nearest point of the ray, in m.
    height: f64,
    from: f64,
    /// The angle at the end of the sampled range.
    to: f64,
}

impl Equiangular {
    /// Prepares distances between `from` and `to` (m). `None` if the ray passes through the pivot.
    fn new(ray: &Ray, pivot: glam::DVec3, from: f64, to: f64) -> Option<Self> {
        let nearest = (pivot - ray.origin).dot(ray.direction);
        let height = (ray.at(nearest) - pivot).length();
        let angle = |t: f64| atan((t - nearest) / height);
        (height > 0.0).then(|| Self { nearest, height, from: angle(from), to: angle(to) })
    }

    fn at(&self, u: f64) -> f64 {
        self.nearest + self.height * tan(self.from + u * (self.to - self.from))
    }

    fn pdf(&self, t: f64) -> f64 {
        let offset = (t - self.nearest) / self.height;
        1.0 / (self.height * (1.0 + offset * offset) * (self.to - self.from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_optics::phase::PhaseFunction;
    use abbe_scene::medium::Density;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};
    use abbe_spectra::spectrum::{Outside, Spectrum};
    use glam::DVec3;

    /// The mean of f(t)/pdf(t) equals the integral of f, with and without a pivot.
    #[test]
    fn sampled_distances_integrate_without_bias() {
        let sigma = Spectrum::table(&[360.0, 830.0], &[20.0, 0.2], Outside::Hold).unwrap();
        let none = Spectrum::constant(0.0);
        let medium = Medium::new("test".into(), (none, sigma), PhaseFunction::Isotropic, Density::Uniform);
        let ray = Ray::new(DVec3::ZERO, DVec3::X);
        for pivot in [None, Some(DVec3::new(1.0, 0.2, 0.0))] {
            let lit = LitInterval { from: 0.5, to: 3.0, pivot };
            for (nm, falls_off) in [(400.0, false), (800.0, true)] {
                let light = DVec3::new(1.0, 0.2, 0.0);
                let f = |t: f64| {
                    let distance2 = if falls_off { (ray.at(t) - light).length_squared() } else { 1.0 };
                    (-medium.extinction.at(nm) * t).exp() / distance2
                };
                let n = 200_000;
                let exact: f64 = (0..n).map(|i| f(0.5 + 2.5 * (f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() * 2.5
                    / f64::from(n);
                let mut stream = Stream::new(Seed::new(7), Purpose::Camera, 0, 0);
                let mean = (0..n)
                    .filter_map(|_| sample(&medium, &ray, &lit, stream.pair()))
                    .map(|distance| f(distance.t_m) / distance.pdf_per_m)
                    .sum::<f64>()
                    / f64::from(n);
                assert!((mean / exact - 1.0).abs() < 0.02, "{pivot:?} {nm}: {mean} for {exact}");
            }
        }
    }
}
