//! A photon's way between surfaces through what absorbs and scatters there.
//!
//! All of a photon's wavelengths go the same way. Where along it they meet a particle is drawn for one of them, chosen by its share of the
//! power, and each is weighted by the balance heuristic over what the others would have drawn (spectral multiple importance sampling,
//! Wilkie et al. 2014): no weight exceeds 1/its share, however much the extinction varies over the band.

use super::photon::{Flight, Receiver};
use crate::math::random::Stream;
use crate::plan::partition::LightPath;
use crate::scene::Scene;
use crate::scene::geometry::Ray;
use crate::scene::medium::Medium;
use crate::spectrum::{LANES, Lanes, Spectrum, Wavelengths};
use crate::walk::ledger::Ledger;
use crate::walk::{Encounter, Start, Stretch, travel};
use glam::DVec3;
use std::ops::ControlFlow;

/// Scatterings in media that a photon may have between two surfaces.
const MAX_COLLISIONS: u32 = 10_000;

/// A photon that sets out through a medium.
#[derive(Debug)]
pub struct Crossing<'a> {
    /// Its way: to the medium's end or to the next surface, whether it will get there or not.
    pub stretch: &'a Stretch<'a>,
    /// The medium's number.
    pub medium: usize,
    /// What happened to it before.
    pub path: LightPath,
    /// Its wavelengths.
    pub wavelengths: Wavelengths,
    /// Power per wavelength at the start of the way: W for free photons, W/nm for shared ones.
    pub power: Lanes,
    /// Which of the set's shared wavelengths a single wavelength is.
    pub lane: usize,
}

/// A photon that has met a particle of a medium.
#[derive(Debug)]
pub struct Collision {
    /// Where.
    pub position: DVec3,
    /// The way it came, unit.
    pub incoming: DVec3,
    /// The medium's number.
    pub medium: usize,
    /// What happened to it before.
    pub path: LightPath,
    /// Its wavelengths.
    pub wavelengths: Wavelengths,
    /// Power per wavelength that is scattered here, all directions together.
    pub power: Lanes,
    /// Which of the set's shared wavelengths a single wavelength is.
    pub lane: usize,
}

/// Follows the photon through media to the next surface; `None` where it ends before.
pub(super) fn drift<'a, R: Receiver>(
    scene: &'a Scene,
    flight: &mut Flight,
    (stream, receiver): (&mut Stream, &mut R),
    ledger: &mut Ledger,
) -> Option<Encounter<'a>> {
    for _ in 0..MAX_COLLISIONS {
        let component = stream.uniform();
        let mut met = None;
        let leg = travel(scene, flight.start, component, |stretch| {
            let collision = flight.cross(stretch, (&mut *stream, &mut *receiver), ledger);
            let Some(distance) = collision else {
                return ControlFlow::Continue(());
            };
            met = Some((*stretch, distance));
            ControlFlow::Break(())
        });
        match leg {
            ControlFlow::Continue(Some(encounter)) => return Some(encounter),
            ControlFlow::Continue(None) => {
                ledger.escaped += flight.total_w();
                return None;
            }
            ControlFlow::Break(()) => {}
        }
        let (stretch, distance) = met?;
        let (number, medium) = stretch.medium?;
        if !flight.collide((number, medium), &stretch, distance, (&mut *stream, &mut *receiver), ledger) {
            return None;
        }
    }
    ledger.depth_limit += flight.total_w();
    None
}

impl Flight {
    /// The share of each wavelength in the power, in W.
    fn shares(&self) -> Lanes {
        let total = self.total_w();
        std::array::from_fn(|k| if total > 0.0 { self.power[k] * self.watts[k] / total } else { 0.0 })
    }

    /// Draws one of the wavelengths by its share of the power.
    fn hero(&self, shares: &Lanes, u: f64) -> usize {
        let mut left = u;
        let last = self.wavelengths.count - 1;
        (0..last)
            .find(|&k| {
                left -= shares[k];
                left < 0.0
            })
            .unwrap_or_else(|| (0..=last).rev().find(|&k| shares[k] > 0.0).unwrap_or(last))
    }

    /// The balance heuristic: each wavelength's own density of what was drawn over the mean of all, any of which could have drawn it.
    fn weigh(&mut self, shares: &Lanes, density: &Lanes) {
        let mean: f64 = shares.iter().zip(density).map(|(share, density)| share * density).sum();
        for k in 0..LANES {
            self.power[k] *= if shares[k] > 0.0 && mean > 0.0 { density[k] / mean } else { 0.0 };
        }
    }

    /// Goes along a stretch. Where it meets a particle of the medium before the stretch's end, its distance in m comes back, and the photon's power is that which arrives there.
    fn cross<R: Receiver>(
        &mut self,
        stretch: &Stretch<'_>,
        (stream, receiver): (&mut Stream, &mut R),
        ledger: &mut Ledger,
    ) -> Option<f64> {
        let mut collision = None;
        if let Some((number, medium)) = stretch.medium {
            let (path, wavelengths, power, lane) = (self.path, self.wavelengths, self.power, self.lane);
            receiver.cross(&Crossing { stretch, medium: number, path, wavelengths, power, lane }, stream);
            collision = self.draw_collision(medium, stretch, stream, ledger);
        }
        if let Some(absorption) = stretch.absorption {
            self.absorb(absorption, collision.unwrap_or(stretch.length_m), ledger);
        }
        collision
    }

    /// Beer's law in a clear body.
    fn absorb(&mut self, absorption: &Spectrum, distance: f64, ledger: &mut Ledger) {
        for k in 0..self.wavelengths.count {
            let depth = absorption.at(self.wavelengths.nm[k]) * distance;
            ledger.absorbed_inside += self.power[k] * self.watts[k] * -(-depth).exp_m1();
            self.power[k] *= (-depth).exp();
        }
    }

    /// Draws where the photon meets a particle of the medium; without one it passes. Both change its powers.
    fn draw_collision(
        &mut self,
        medium: &Medium,
        stretch: &Stretch<'_>,
        stream: &mut Stream,
        ledger: &mut Ledger,
    ) -> Option<f64> {
        let before = self.total_w();
        let shares = self.shares();
        let sigma_t = self.wavelengths.each(|nm| medium.extinction.at(nm));
        let sigma_hero = sigma_t[self.hero(&shares, stream.uniform())];
        let column = -(-stream.uniform()).ln_1p() / sigma_hero;
        let collision =
            if sigma_hero > 0.0 { medium.distance_at(&stretch.ray, stretch.length_m, column) } else { None };
        // The density of what happened, per wavelength: of meeting a particle at this column, or of passing the whole of it.
        let column = if collision.is_some() { column } else { medium.column_m(&stretch.ray, stretch.length_m) };
        let depth = |sigma: f64| if sigma > 0.0 { sigma * column } else { 0.0 };
        let least = (0..LANES).filter(|&k| shares[k] > 0.0).map(|k| depth(sigma_t[k])).fold(f64::INFINITY, f64::min);
        let density = sigma_t.map(|sigma| {
            let passes = (least - depth(sigma)).exp();
            if collision.is_some() { sigma * passes } else { passes }
        });
        self.weigh(&shares, &density);
        ledger.sampling += self.total_w() - before;
        collision
    }

    /// Scatters the photon at a particle; false where it ends.
    fn collide<R: Receiver>(
        &mut self,
        (number, medium): (usize, &Medium),
        stretch: &Stretch<'_>,
        distance: f64,
        (stream, receiver): (&mut Stream, &mut R),
        ledger: &mut Ledger,
    ) -> bool {
        let before = self.total_w();
        for k in 0..self.wavelengths.count {
            let nm = self.wavelengths.nm[k];
            let (sigma_a, sigma_s) = (medium.absorption.at(nm), medium.scattering.at(nm));
            let albedo = if sigma_a > 0.0 { sigma_s / (sigma_a + sigma_s) } else { 1.0 };
            ledger.absorbed_inside += self.power[k] * self.watts[k] * (1.0 - albedo);
            self.power[k] *= albedo;
        }
        let scattered = self.total_w();
        let (position, incoming) = (stretch.ray.at(distance), stretch.ray.direction);
        let (path, wavelengths, power, lane) = (self.path, self.wavelengths, self.power, self.lane);
        receiver.collide(&Collision { position, incoming, medium: number, path, wavelengths, power, lane }, stream);
        // Roulette by what the particle absorbed.
        let survival = if before > 0.0 { scattered / before } else { 0.0 };
        if survival <= 0.0 || stream.uniform() >= survival {
            ledger.sampling -= scattered;
            return false;
        }
        self.power.iter_mut().for_each(|power| *power /= survival);
        let direction = self.turn(medium, incoming, stream);
        ledger.sampling += self.total_w() - scattered;
        let ray = Ray { origin: position, direction };
        self.start = Start { ray, from: None, interior: stretch.interior };
        self.path = LightPath::Indirect;
        true
    }

    /// Draws the new direction for one of the wavelengths and weights all of them by the balance.
    fn turn(&mut self, medium: &Medium, incoming: DVec3, stream: &mut Stream) -> DVec3 {
        let shares = self.shares();
        let hero = self.hero(&shares, stream.uniform());
        let direction = medium.phase.sample(incoming, self.wavelengths.nm[hero], stream.pair());
        if self.wavelengths.count > 1 {
            let cosine = incoming.dot(direction);
            let density = self.wavelengths.each(|nm| medium.phase.at(cosine, nm));
            self.weigh(&shares, &density);
        }
        direction
    }
}
