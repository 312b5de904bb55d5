//! Where along a stretch of a medium to look for light that is scattered into the camera's ray.

use crate::scene::geometry::Ray;
use crate::scene::light::Reach;
use crate::scene::medium::Medium;

/// A place along a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Its distance in m.
    pub(super) t: f64,
    /// The density per m with which it was drawn.
    pub(super) pdf: f64,
}

/// Draws a place within the light's reach: half of the draws by the angle under which the light's pivot sees the ray (Kulla & Fajardo 2012), if it
/// has one; the others by the transmittance at the wavelengths that pass best and worst. The density is that of the mixture (balance
/// heuristic), so that no wavelength and no place is starved.
pub(super) fn draw(medium: &Medium, ray: &Ray, reach: &Reach, u: [f64; 2]) -> Option<Place> {
    let ways = Ways::new(medium, ray, reach)?;
    let by_angle = if ways.angles.is_some() { 0.5 } else { 0.0 };
    let t = match &ways.angles {
        Some(angles) if u[0] < by_angle => angles.at(u[1]),
        _ => {
            let sigma = ways.sigma[usize::from((u[0] - by_angle) / (1.0 - by_angle) >= 0.5)];
            ways.by_transmittance(sigma, u[1])?
        }
    };
    let pdf = ways.angles.as_ref().map_or(0.0, |angles| by_angle * angles.pdf(t)) + (1.0 - by_angle) * ways.pdf(t);
    (pdf > 0.0 && t.is_finite()).then_some(Place { t, pdf })
}

/// The ways of drawing.
struct Ways<'a> {
    medium: &'a Medium,
    /// The part of the ray in question, from its start on.
    ray: Ray,
    start: f64,
    length: f64,
    /// Its column density.
    column: f64,
    /// The least and the largest extinction.
    sigma: [f64; 2],
    angles: Option<Angles>,
}

impl<'a> Ways<'a> {
    fn new(medium: &'a Medium, ray: &Ray, reach: &Reach) -> Option<Self> {
        let (start, length) = (reach.from, reach.to - reach.from);
        let part = Ray { origin: ray.at(start), direction: ray.direction };
        let column = medium.column_m(&part, length);
        let angles = reach.pivot.and_then(|pivot| Angles::new(ray, pivot, (reach.from, reach.to)));
        let sigma = [medium.extinction_range.0, medium.extinction_range.1];
        (column > 0.0).then_some(Self { medium, ray: part, start, length, column, sigma, angles })
    }

    /// The distance at which a share u of the light that is lost has been lost.
    fn by_transmittance(&self, sigma: f64, u: f64) -> Option<f64> {
        let depth = sigma * self.column;
        let column = if depth < 1e-6 {
            u * self.column
        } else if self.column.is_finite() {
            -(u * (-depth).exp_m1()).ln_1p() / sigma
        } else {
            -(-u).ln_1p() / sigma
        };
        self.medium.distance_at(&self.ray, self.length, column).map(|t| self.start + t)
    }

    /// The density per m of both transmittances, mixed evenly.
    fn pdf(&self, t: f64) -> f64 {
        let along = t - self.start;
        let density = self.medium.density_at(self.ray.at(along));
        let column = self.medium.column_m(&self.ray, along);
        let one = |sigma: f64| {
            let depth = sigma * self.column;
            let per_column =
                if depth < 1e-6 { 1.0 / self.column } else { sigma * (-sigma * column).exp() / -(-depth).exp_m1() };
            0.5 * per_column * density
        };
        one(self.sigma[0]) + one(self.sigma[1])
    }
}

/// Equal angles as seen from a point.
struct Angles {
    /// The ray's distance from the start to where it is nearest the point.
    nearest: f64,
    /// How near that is.
    height: f64,
    from: f64,
    to: f64,
}

impl Angles {
    fn new(ray: &Ray, pivot: glam::DVec3, (from, to): (f64, f64)) -> Option<Self> {
        let nearest = (pivot - ray.origin).dot(ray.direction);
        let height = (ray.at(nearest) - pivot).length();
        let angle = |t: f64| ((t - nearest) / height).atan();
        (height > 0.0).then(|| Self { nearest, height, from: angle(from), to: angle(to) })
    }

    fn at(&self, u: f64) -> f64 {
        self.nearest + self.height * (self.from + u * (self.to - self.from)).tan()
    }

    fn pdf(&self, t: f64) -> f64 {
        let offset = (t - self.nearest) / self.height;
        1.0 / (self.height * (1.0 + offset * offset) * (self.to - self.from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::{Purpose, Stream};
    use crate::optics::phase::Phase;
    use crate::scene::medium::Density;
    use crate::spectrum::{Outside, Spectrum};
    use glam::DVec3;

    /// The mean of f(t)/pdf(t) is the integral of f, whatever the medium and wherever the light.
    #[test]
    fn drawn_places_integrate_what_is_scattered_without_bias() {
        let sigma = Spectrum::table(&[360.0, 830.0], &[20.0, 0.2], Outside::Hold).unwrap();
        let none = Spectrum::constant(0.0);
        let medium = Medium::new("test".into(), (none, sigma), Phase::Isotropic, Density::Uniform);
        let ray = Ray::new(DVec3::ZERO, DVec3::X);
        for pivot in [None, Some(DVec3::new(1.0, 0.2, 0.0))] {
            let reach = Reach { from: 0.5, to: 3.0, pivot };
            for (nm, falls_off) in [(400.0, false), (800.0, true)] {
                let light = DVec3::new(1.0, 0.2, 0.0);
                let f = |t: f64| {
                    let distance2 = if falls_off { (ray.at(t) - light).length_squared() } else { 1.0 };
                    (-medium.extinction.at(nm) * t).exp() / distance2
                };
                let n = 200_000;
                let exact: f64 = (0..n).map(|i| f(0.5 + 2.5 * (f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() * 2.5
                    / f64::from(n);
                let mut stream = Stream::new(7, Purpose::Camera, 0, 0);
                let mean = (0..n)
                    .filter_map(|_| draw(&medium, &ray, &reach, stream.pair()))
                    .map(|place| f(place.t) / place.pdf)
                    .sum::<f64>()
                    / f64::from(n);
                assert!((mean / exact - 1.0).abs() < 0.02, "{pivot:?} {nm}: {mean} for {exact}");
            }
        }
    }
}
