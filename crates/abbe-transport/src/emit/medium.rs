//! Photon tracing through media that absorb and scatter.
//!
//! All wavelengths of a photon share one path. The free-flight distance and the scattered direction
//! are sampled for the hero, a wavelength that is selected in proportion to its power. Each
//! wavelength could have been the hero, so the balance heuristic weights it (spectral multiple
//! importance sampling: Wilkie, Nawaz, Droske, Weidlich & Hanika 2014, "Hero Wavelength Spectral
//! Sampling"). The weight of a wavelength with the fraction f of the photon's power is at most 1/f,
//! even if the extinction varies strongly over the band.

use super::fluorescence::scatter_in_fluorescent_medium;
use super::photon_path::PhotonPath;
use super::source::PhotonSource;
use super::visitor::{MediumCollision, MediumCrossing, PhotonFlight, PhotonVisitor};
use crate::plan::partition::LightPath;
use crate::walk::ledger::Ledger;
use crate::walk::{
    MAX_EVENTS, MediumSegment, NumberedMedium, RayState, SurfaceInteraction, SurfaceLookup,
    next_interaction_through_media,
};
use abbe_optics::phase::Deflection;
use abbe_polarisation::ScatteringEvent;
use abbe_scene::geometry::Ray;
use abbe_scene::medium::Medium;
use abbe_spectra::math::elementary::{exp, exp_m1, ln_1p};
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::{LANES, Spectrum};
use glam::DVec3;
use std::ops::ControlFlow;

/// Advances the photon through media to the next surface, unless its path ends before.
pub(super) fn advance_through_media<'a, V: PhotonVisitor>(
    source: &PhotonSource<'a>,
    path: &mut PhotonPath,
    stream: &mut Stream,
    visitor: &mut V,
    ledger: &mut Ledger,
) -> Option<SurfaceInteraction<'a>> {
    for _ in 0..MAX_EVENTS {
        let lookup = SurfaceLookup::of_line(stream.uniform());
        let (mut collision, mut inside) = (None, false);
        let end = next_interaction_through_media(source.scene, path.ray_state, lookup, |segment| {
            inside = !segment.medium_stack.is_air();
            let Some(distance) = path.sample_segment(segment, stream, visitor, ledger) else {
                return ControlFlow::Continue(());
            };
            collision = Some((*segment, distance));
            ControlFlow::Break(())
        });
        match end {
            ControlFlow::Continue(Some(interaction)) => return Some(interaction),
            ControlFlow::Continue(None) => {
                ledger.add_escaped(path.total_w(), inside);
                visitor.on_escape(&path.ray_state.ray, &path.photon);
                return None;
            }
            ControlFlow::Break(()) => {}
        }
        let (segment, distance) = collision?;
        let survives = if segment.medium.is_some_and(|filling| filling.medium.fluorophore.is_some()) {
            scatter_in_fluorescent_medium(source, path, &segment, distance, stream, visitor, ledger)
        } else {
            path.scatter_in_medium(&segment, distance, stream, visitor, ledger)
        };
        if !survives {
            return None;
        }
    }
    ledger.depth_limit += path.total_w();
    ledger.depth_limit_indirect += path.total_w();
    None
}

impl PhotonPath {
    /// Advances the photon along a segment, and its power to that at the end or at a collision.
    /// Returns the free-flight distance in m if the photon collides with the medium.
    fn sample_segment<V: PhotonVisitor>(
        &mut self,
        segment: &MediumSegment<'_>,
        stream: &mut Stream,
        visitor: &mut V,
        ledger: &mut Ledger,
    ) -> Option<f64> {
        let mut collision = None;
        let (ray, length_m) = (segment.ray, segment.length_m);
        visitor.on_flight(&PhotonFlight { ray, length_m, photon: &self.photon, segment: Some(segment) });
        if let Some(medium) = segment.medium {
            if !self.photon.excitation {
                visitor.on_medium_crossing(&MediumCrossing { segment, medium, photon: &self.photon }, stream);
            }
            collision = self.sample_free_flight(medium.medium, segment, stream, ledger);
        }
        if let Some(absorption) = segment.absorption {
            self.absorb(absorption, collision.unwrap_or(segment.length_m), ledger);
        }
        collision
    }

    /// Attenuates the photon in a clear body by Beer's law.
    fn absorb(&mut self, absorption: &Spectrum, distance: f64, ledger: &mut Ledger) {
        for k in 0..self.photon.wavelengths.count {
            let depth = absorption.at(self.photon.wavelengths.nm[k]) * distance;
            ledger.absorbed_inside += self.photon.power[k] * self.watts[k] * -exp_m1(-depth);
            self.photon.power[k] *= exp(-depth);
        }
    }

    /// Samples the free-flight distance in m, `None` beyond the segment, and changes the power.
    fn sample_free_flight(
        &mut self,
        medium: &Medium,
        segment: &MediumSegment<'_>,
        stream: &mut Stream,
        ledger: &mut Ledger,
    ) -> Option<f64> {
        let before = self.total_w();
        let fractions = self.power_fractions();
        let sigma_t = self.photon.wavelengths.each(|nm| medium.extinction.at(nm));
        let sigma_hero = sigma_t[self.sample_hero(&fractions, stream)];
        let column = -ln_1p(-stream.uniform()) / sigma_hero;
        let collision =
            if sigma_hero > 0.0 { medium.distance_at(&segment.ray, segment.length_m, column) } else { None };
        // The density of the outcome for each wavelength: σ_t e^−τ for a collision at this column
        // density, or e^−τ for the whole segment. All get the same factor, so that e^−τ does not
        // underflow.
        let column = if collision.is_some() { column } else { medium.column_m(&segment.ray, segment.length_m) };
        let depth = |sigma: f64| if sigma > 0.0 { sigma * column } else { 0.0 };
        let least = (0..LANES).filter(|&k| fractions[k] > 0.0).map(|k| depth(sigma_t[k])).fold(f64::INFINITY, f64::min);
        let pdfs = sigma_t.map(|sigma| {
            let transmittance = exp(least - depth(sigma));
            if collision.is_some() { sigma * transmittance } else { transmittance }
        });
        self.weight_by_balance_heuristic(&fractions, &pdfs);
        ledger.sampling += self.total_w() - before;
        collision
    }

    /// Scatters the photon at a collision; returns whether the photon survives Russian roulette.
    fn scatter_in_medium<V: PhotonVisitor>(
        &mut self,
        segment: &MediumSegment<'_>,
        distance: f64,
        stream: &mut Stream,
        visitor: &mut V,
        ledger: &mut Ledger,
    ) -> bool {
        let Some(numbered @ NumberedMedium { medium, .. }) = segment.medium else { return false };
        let before = self.total_w();
        for k in 0..self.photon.wavelengths.count {
            let nm = self.photon.wavelengths.nm[k];
            let (sigma_a, sigma_s) = (medium.absorption.at(nm), medium.scattering.at(nm));
            let albedo = if sigma_a > 0.0 { sigma_s / (sigma_a + sigma_s) } else { 1.0 };
            ledger.absorbed_inside += self.photon.power[k] * self.watts[k] * (1.0 - albedo);
            self.photon.power[k] *= albedo;
        }
        let scattered = self.total_w();
        let (position, incoming) = (segment.ray.at(distance), segment.ray.direction);
        let collision = MediumCollision { position, incoming, medium: numbered, photon: &self.photon };
        if !self.photon.excitation {
            visitor.on_medium_collision(&collision, stream);
        }
        // The survival probability is the mean albedo.
        let survival = if before > 0.0 { scattered / before } else { 0.0 };
        if survival <= 0.0 || stream.uniform() >= survival {
            ledger.sampling -= scattered;
            return false;
        }
        self.divide_power(survival);
        let direction = self.sample_phase_function(medium, incoming, stream);
        ledger.sampling += self.total_w() - scattered;
        let ray = Ray { origin: position, direction };
        self.ray_state = RayState { ray, from: None, medium_stack: segment.medium_stack };
        self.photon.light_path = LightPath::Indirect;
        true
    }

    /// Samples a direction from the hero's phase function, and weights by the balance heuristic.
    pub(super) fn sample_phase_function(&mut self, medium: &Medium, incoming: DVec3, stream: &mut Stream) -> DVec3 {
        let fractions = self.power_fractions();
        let hero = self.sample_hero(&fractions, stream);
        let direction = medium.phase.sample(incoming, self.photon.wavelengths.nm[hero], stream.pair());
        if self.photon.wavelengths.count > 1 {
            let deflection = Deflection::between(incoming, direction);
            let pdfs = self.photon.wavelengths.each(|nm| medium.phase.eval(deflection, nm));
            self.weight_by_balance_heuristic(&fractions, &pdfs);
        }
        if self.polarised {
            self.polarise_in_medium(&ScatteringEvent::in_medium(&medium.phase, incoming, direction));
        }
        direction
    }
}
