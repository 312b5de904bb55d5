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

/// A place along a ray of which many are taken together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stop {
    /// Its distance in m.
    pub(super) t: f64,
    /// The column density from the ray's start to it, in m.
    pub(super) column_m: f64,
    /// The density of the medium there over that of the places, in m: the sum of strength × f over the stops is ∫ρ f dt.
    pub(super) strength: f64,
}

/// How many stops there are on a ray, at most.
pub(super) const STOPS: usize = 8;

/// Visits places within the light's reach in order of their distance, spread evenly over the ways of drawing of [`draw`]; `shift` moves those
/// of each way within their shares. The ray is gone along once, however many they are.
pub(super) fn spread(medium: &Medium, ray: &Ray, reach: &Reach, shift: [f64; 2], mut visit: impl FnMut(Stop)) {
    let Some(ways) = Ways::new(medium, ray, reach) else { return };
    let by_angle = if ways.angles.is_some() { STOPS / 2 } else { 0 };
    let by_column = (STOPS - by_angle) / 2;
    let share = |i: usize, count: usize, shift: f64| (i as f64 + shift.fract()) / count as f64;
    let angle = |i: usize| {
        let angles = ways.angles.as_ref().filter(|_| i < by_angle)?;
        Some((angles.at(share(i, by_angle, shift[0])) - ways.start).clamp(0.0, ways.length))
    };
    // Where both extinctions are the same, half a share apart they fill each other's gaps.
    let column = |way: usize, i: usize| {
        let u = share(i, by_column, shift[1] + 0.5 * way as f64);
        (i < by_column).then(|| (way, ways.column_lost(ways.sigma[way], u)))
    };
    let before = medium.column_m(ray, reach.from);
    let rest = |from: f64| Ray { origin: ways.ray.at(from), direction: ray.direction };
    let mut taken = [0; 3];
    let (mut t, mut passed, mut ahead) = (0.0, 0.0, None);
    loop {
        if ahead.is_none() {
            let next =
                [0, 1].map(|way| column(way, taken[way])).into_iter().flatten().min_by(|a, b| a.1.total_cmp(&b.1));
            let way = next.and_then(|(way, wanted)| {
                let more = medium.distance_at(&rest(t), ways.length - t, wanted - passed)?;
                Some((way, wanted, t + more))
            });
            ahead = way;
        }
        let turn = angle(taken[2]);
        match (ahead, turn) {
            (None, None) => return,
            (Some((way, wanted, there)), turn) if turn.is_none_or(|turn| there <= turn) => {
                (t, passed, ahead) = (there, wanted, None);
                taken[way] += 1;
            }
            (_, Some(turn)) => {
                passed += medium.column_m(&rest(t), turn - t);
                t = turn;
                taken[2] += 1;
            }
            (Some(_), None) => return,
        }
        let density = medium.density_at(ways.ray.at(t));
        let of_columns = (0..2).map(|way| ways.per_column(ways.sigma[way], passed)).sum::<f64>();
        let of_angles = ways.angles.as_ref().map_or(0.0, |angles| angles.pdf(ways.start + t));
        let places = by_column as f64 * of_columns * density + by_angle as f64 * of_angles;
        if density > 0.0 {
            visit(Stop { t: ways.start + t, column_m: before + passed, strength: density / places });
        }
    }
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
        let column = self.column_lost(sigma, u);
        self.medium.distance_at(&self.ray, self.length, column).map(|t| self.start + t)
    }

    /// The column density at which a share u of the light that is lost has been lost.
    fn column_lost(&self, sigma: f64, u: f64) -> f64 {
        let depth = sigma * self.column;
        if depth < 1e-6 {
            u * self.column
        } else if self.column.is_finite() {
            -(u * (-depth).exp_m1()).ln_1p() / sigma
        } else {
            -(-u).ln_1p() / sigma
        }
    }

    /// The density per m of both transmittances, mixed evenly.
    fn pdf(&self, t: f64) -> f64 {
        let along = t - self.start;
        let density = self.medium.density_at(self.ray.at(along));
        let column = self.medium.column_m(&self.ray, along);
        0.5 * density * (self.per_column(self.sigma[0], column) + self.per_column(self.sigma[1], column))
    }

    /// The density of one transmittance's draws, per m of column density.
    fn per_column(&self, sigma: f64, column: f64) -> f64 {
        let depth = sigma * self.column;
        if depth < 1e-6 { 1.0 / self.column } else { sigma * (-sigma * column).exp() / -(-depth).exp_m1() }
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
