//! The measured intensity of a luminaire as a function of direction.
//!
//! The intensity is bilinear between the nodes of a table over two angles of a spherical coordinate
//! system, and 0 outside. The sampling pdf is exactly proportional to it.

use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::distribution::DiscreteDistribution;
use abbe_spectra::math::elementary::{atan2, cos, hypot, sin, sin_cos};
use abbe_spectra::math::quadrature::gauss4;
use glam::{DMat3, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The largest polar interval in radians, 15°: longer ones are divided, so that the four-point rule
/// integrates the intensity over solid angle up to rounding.
const LONGEST_INTERVAL: f64 = PI / 12.0;

/// Two azimuths whose difference is within this many radians of 2π are the same plane.
const FULL_TURN_MARGIN: f64 = 1e-9;

/// The coordinate system of a table (CIE 121 and IES LM-75) for the axes of a luminaire: z is the
/// photometric axis, which points down for a ceiling luminaire, x is C0, and y is C90.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhotometricType {
    /// The polar axis is the photometric axis. The polar angle is γ, and the azimuth is C.
    C,
    /// The polar axis is x. The polar angle is 90° − H, and the azimuth is V, from z towards y,
    /// where H and V are the horizontal and the vertical angle.
    B,
    /// The polar axis is y. The polar angle is 90° − V, and the azimuth is H, from z towards x.
    A,
}

impl PhotometricType {
    /// As columns: azimuth 0, azimuth 90°, and the polar axis.
    fn axes(self) -> DMat3 {
        match self {
            Self::C => DMat3::IDENTITY,
            Self::B => DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::X),
            Self::A => DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y),
        }
    }
}

/// The intensity of a luminaire over all directions, in an arbitrary unit.
#[derive(Debug, Clone, PartialEq)]
pub struct IntensityTable {
    /// See [`PhotometricType::axes`].
    axes: DMat3,
    /// In radians, ascending.
    polar: Vec<f64>,
    /// In radians, ascending over at most 2π.
    azimuth: Vec<f64>,
    /// Plane by plane, each with one value for each polar angle.
    values: Vec<f64>,
    intervals: DiscreteDistribution,
    /// By polar interval: selects the azimuth interval. `None` if there is no light.
    sectors: Vec<Option<DiscreteDistribution>>,
    /// The integral ∫ I sin θ dθ of each plane over each polar interval, interval by interval.
    plane_integrals: Vec<f64>,
    /// Over all directions.
    flux: f64,
    /// The smallest and the largest cosine of the angle between the photometric axis and the light.
    cosines: [f64; 2],
}

impl IntensityTable {
    /// Creates a table of `values` plane by plane: a plane has one azimuth, and one value for each
    /// polar angle. The angles are in radians: `polar` from 0 to π, and `azimuth` over at most 2π,
    /// outside of which the intensity is 0. Returns an error if there are fewer than two angles of
    /// a kind, angles are not strictly ascending or out of range, the number of values is wrong, a
    /// value is negative or not finite, or all values are 0.
    pub fn new(kind: PhotometricType, polar: &[f64], azimuth: &[f64], values: &[f64]) -> Result<Self> {
        let ascending = |angles: &[f64]| angles.len() >= 2 && angles.windows(2).all(|pair| pair[0] < pair[1]);
        let span = |angles: &[f64]| angles.last().zip(angles.first()).map_or(0.0, |(last, first)| last - first);
        if !ascending(polar) || !ascending(azimuth) || span(azimuth) > TAU + FULL_TURN_MARGIN {
            return Err(Error::input("angles that are not ascending").expected("two or more ascending angles"));
        }
        let within = |angle: &f64| (-FULL_TURN_MARGIN..=PI + FULL_TURN_MARGIN).contains(angle);
        if !polar.iter().all(within) || azimuth.iter().any(|angle| angle.abs() > 2.0 * TAU) {
            return Err(Error::input("angles out of range").expected("polar angles from 0° to 180°"));
        }
        if values.len() != polar.len() * azimuth.len()
            || values.iter().any(|value| !(*value >= 0.0 && value.is_finite()))
        {
            return Err(Error::input("wrong intensities").expected("one finite value of at least 0 for each direction"));
        }
        let (polar, values) = divided(polar, values);
        let plane = |number: usize| &values[number * polar.len()..][..polar.len()];
        let integral = |plane: &[f64], interval: usize| {
            let (from, to) = (polar[interval], polar[interval + 1]);
            gauss4((from, to), |angle| {
                mix(plane[interval], plane[interval + 1], (angle - from) / (to - from)) * sin(angle)
            })
        };
        let plane_integrals: Vec<f64> = (0..polar.len() - 1)
            .flat_map(|interval| (0..azimuth.len()).map(move |number| (interval, number)))
            .map(|(interval, number)| integral(plane(number), interval).max(0.0))
            .collect();
        let sector_fluxes = |planes: &[f64]| -> Vec<f64> {
            let sectors = planes.windows(2).zip(azimuth.windows(2));
            sectors.map(|(flux, angle)| 0.5 * (flux[0] + flux[1]) * (angle[1] - angle[0])).collect()
        };
        let fluxes: Vec<Vec<f64>> = plane_integrals.chunks(azimuth.len()).map(sector_fluxes).collect();
        let flux: f64 = fluxes.iter().flatten().sum();
        let intervals = DiscreteDistribution::new(fluxes.iter().map(|sectors| sectors.iter().sum()));
        let Some(intervals) = intervals.filter(|_| flux.is_finite()) else {
            return Err(Error::input("no light").expected("at least one intensity above 0"));
        };
        let sectors = fluxes.into_iter().map(DiscreteDistribution::new).collect();
        let mut table = Self {
            axes: kind.axes(),
            azimuth: azimuth.to_vec(),
            intervals,
            sectors,
            plane_integrals,
            flux,
            cosines: [1.0, -1.0],
            polar,
            values,
        };
        table.cosines = table.lit_cosines();
        Ok(table)
    }

    /// The integral of the intensity over all directions: in lm if the values are in cd.
    pub fn flux(&self) -> f64 {
        self.flux
    }

    pub fn largest(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }

    /// The direction of the largest intensity, as a unit vector.
    pub fn brightest(&self) -> DVec3 {
        let largest = self.largest();
        let node = self.values.iter().position(|value| *value == largest).unwrap_or_default();
        self.direction(self.polar[node % self.polar.len()], self.azimuth[node / self.polar.len()])
    }

    /// The extreme cosines of the angle between the photometric axis and light.
    pub(super) fn cosines(&self) -> [f64; 2] {
        self.cosines
    }

    fn value(&self, plane: usize, angle: usize) -> f64 {
        self.values[plane * self.polar.len() + angle]
    }

    fn direction(&self, polar: f64, azimuth: f64) -> DVec3 {
        let ((sin_polar, cos_polar), (sin, cos)) = (sin_cos(polar), sin_cos(azimuth));
        self.axes * DVec3::new(sin_polar * cos, sin_polar * sin, cos_polar)
    }

    /// Returns the intensity in the direction of a unit vector with the axes of the luminaire.
    pub fn at(&self, direction: DVec3) -> f64 {
        let local = self.axes.transpose() * direction;
        let polar = atan2(hypot(local.x, local.y), local.z);
        let (first, last) = (self.azimuth[0], self.azimuth[self.azimuth.len() - 1]);
        let mut azimuth = first + (atan2(local.y, local.x) - first).rem_euclid(TAU);
        if last - first >= TAU - FULL_TURN_MARGIN {
            azimuth = azimuth.min(last);
        }
        let (Some((angle, down)), Some((plane, round))) = (place(&self.polar, polar), place(&self.azimuth, azimuth))
        else {
            return 0.0;
        };
        let along = |plane: usize| mix(self.value(plane, angle), self.value(plane, angle + 1), down);
        mix(along(plane), along(plane + 1), round)
    }

    /// The pdf of a direction per steradian: the intensity divided by the flux.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.at(direction) / self.flux
    }

    /// Samples a unit vector, with the axes of the luminaire, in proportion to the intensity.
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        let [mut u_polar, mut u_azimuth] = u;
        let interval = self.intervals.sample(&mut u_polar);
        let sector = self.sectors[interval].as_ref().map_or(0, |sectors| sectors.sample(&mut u_azimuth));
        let planes = &self.plane_integrals[interval * self.azimuth.len() + sector..];
        let round = inverse_of_linear([planes[0], planes[1]], u_azimuth);
        let ends =
            [interval, interval + 1].map(|angle| mix(self.value(sector, angle), self.value(sector + 1, angle), round));
        let polar = inverse_of_arc((self.polar[interval], self.polar[interval + 1]), ends, u_polar);
        self.direction(polar, mix(self.azimuth[sector], self.azimuth[sector + 1], round))
    }

    /// Computes `cosines` from the cells with light.
    fn lit_cosines(&self) -> [f64; 2] {
        let is_polar = self.axes.z_axis == DVec3::Z;
        let (mut least, mut most) = (1.0_f64, -1.0_f64);
        for (plane, round) in self.azimuth.windows(2).enumerate() {
            let [low, high] = cosine_range((round[0], round[1]));
            for (angle, down) in self.polar.windows(2).enumerate() {
                let is_lit = [plane, plane + 1].iter().any(|&p| self.value(p, angle) + self.value(p, angle + 1) > 0.0);
                if !is_lit {
                    continue;
                }
                let ends = if is_polar {
                    [cos(down[1]), cos(down[0])]
                } else {
                    // The axis has azimuth 0 and polar angle 90°, so the cosine is sin θ cos φ.
                    let [narrow, wide] = [sin(down[0]).min(sin(down[1])), widest_sine((down[0], down[1]))];
                    [low * if low < 0.0 { wide } else { narrow }, high * if high < 0.0 { narrow } else { wide }]
                };
                (least, most) = (least.min(ends[0]), most.max(ends[1]));
            }
        }
        [least.max(-1.0), most.min(1.0)]
    }
}

/// Divides polar intervals above [`LONGEST_INTERVAL`] equally, and interpolates the values.
fn divided(polar: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let parts: Vec<usize> =
        polar.windows(2).map(|pair| ((pair[1] - pair[0]) / LONGEST_INTERVAL - 1e-9).ceil().max(1.0) as usize).collect();
    let divide = |nodes: &[f64]| -> Vec<f64> {
        let inside = nodes.windows(2).zip(&parts).flat_map(|(pair, &count)| {
            let (from, to) = (pair[0], pair[1]);
            (0..count).map(move |part| if part == 0 { from } else { mix(from, to, part as f64 / count as f64) })
        });
        inside.chain(nodes.last().copied()).collect()
    };
    (divide(polar), values.chunks(polar.len()).flat_map(divide).collect())
}

/// Returns the number of the interval that contains `x`, and the fraction of it below `x`, or
/// `None` if `x` is outside all intervals.
fn place(nodes: &[f64], x: f64) -> Option<(usize, f64)> {
    let last = nodes.len() - 1;
    if !(nodes[0]..=nodes[last]).contains(&x) {
        return None;
    }
    let interval = nodes.partition_point(|&node| node <= x).clamp(1, last) - 1;
    Some((interval, (x - nodes[interval]) / (nodes[interval + 1] - nodes[interval])))
}

/// Interpolates linearly. The result is exact if both values are equal.
fn mix(from: f64, to: f64, fraction: f64) -> f64 {
    from + fraction * (to - from)
}

/// Samples a number in [0, 1] with a pdf that is linear between the values at both ends.
fn inverse_of_linear([low, high]: [f64; 2], u: f64) -> f64 {
    let root = mix(low * low, high * high, u).max(0.0).sqrt();
    if low + root > 0.0 { (u * (low + high) / (low + root)).clamp(0.0, 1.0) } else { u.sqrt() }
}

/// Samples an angle θ with a pdf proportional to sin θ times an intensity that is linear between
/// the values `ends` at both ends. Inverts the integral by Newton's method, and by bisection where
/// Newton's method leaves the interval.
fn inverse_of_arc((from, to): (f64, f64), ends: [f64; 2], u: f64) -> f64 {
    const MOST_STEPS: u32 = 60;
    let unnormalised_pdf = |angle: f64| mix(ends[0], ends[1], (angle - from) / (to - from)) * sin(angle);
    let wanted = u * gauss4((from, to), unnormalised_pdf);
    let start = inverse_of_linear([unnormalised_pdf(from).max(0.0), unnormalised_pdf(to).max(0.0)], u);
    let (mut low, mut high, mut angle) = (from, to, mix(from, to, start));
    for _ in 0..MOST_STEPS {
        let excess = gauss4((from, angle), unnormalised_pdf) - wanted;
        if excess > 0.0 {
            high = angle;
        } else {
            low = angle;
        }
        let step = excess / unnormalised_pdf(angle);
        let next = angle - step;
        let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
        let change = (next - angle).abs();
        angle = next;
        if change <= 1e-13 * (to - from) {
            break;
        }
    }
    angle
}

/// Returns the smallest and the largest cosine of the angles in an interval, in radians.
fn cosine_range((from, to): (f64, f64)) -> [f64; 2] {
    let contains = |angle: f64| (angle - from).rem_euclid(TAU) <= to - from;
    let (a, b) = (cos(from), cos(to));
    [if contains(PI) { -1.0 } else { a.min(b) }, if contains(0.0) { 1.0 } else { a.max(b) }]
}

/// Returns the largest sine of the angles in an interval within [0, π].
fn widest_sine((from, to): (f64, f64)) -> f64 {
    if (from..=to).contains(&FRAC_PI_2) { 1.0 } else { sin(from).max(sin(to)) }
}

#[cfg(test)]
mod tests;
