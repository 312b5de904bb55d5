//! Diffraction gratings.

use glam::DVec3;

use super::check::check_within;
use super::hemisphere::{flip_z, z_sign};
use super::sample::{BsdfSample, InterfaceIors, ScatterEvent, TransportMode};
use crate::grating::Grating;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::sin_cos;
use abbe_spectra::spectrum::Spectrum;

/// The course of the grooves over a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Grooves {
    /// Parallel grooves: the angle in rad from u to the direction of diffraction.
    Parallel(f64),
    /// Circles around the centre of the unit square of uv, as on an optical disc.
    Circular,
}

/// A thin diffraction grating that reflects, transmits or both, in one medium.
///
/// Light of each wavelength leaves in the directions of the orders. Their efficiencies are lossless
/// and reciprocal ([`Grating::efficiency`]), so they are the same for photons and for camera paths,
/// unless they are measured: then camera paths use those of light that travels against the path.
#[derive(Debug, Clone, PartialEq)]
pub struct DiffractionGrating {
    grating: Grating,
    reflectance: Spectrum,
    transmittance: Spectrum,
    grooves: Grooves,
    /// The wavelength in nm that decides all orders, if they do not depend on that of the light.
    fixed_nm: Option<f64>,
}

/// The coordinates in the plane of the grating: x across the grooves.
#[derive(Debug, Clone, Copy)]
struct GrooveFrame {
    sin: f64,
    cos: f64,
}

impl GrooveFrame {
    fn new(angle: f32) -> Self {
        let (sin, cos) = sin_cos(f64::from(angle));
        Self { sin, cos }
    }

    fn to_grooves(self, v: DVec3) -> DVec3 {
        DVec3::new(self.cos * v.x + self.sin * v.y, self.cos * v.y - self.sin * v.x, v.z)
    }

    fn to_surface(self, v: DVec3) -> DVec3 {
        DVec3::new(self.cos * v.x - self.sin * v.y, self.cos * v.y + self.sin * v.x, v.z)
    }
}

impl DiffractionGrating {
    /// Creates a grating that reflects and transmits these fractions of the light. Returns an error
    /// if a fraction is negative, or if their sum exceeds 1 at a wavelength.
    pub fn new(grating: Grating, reflectance: Spectrum, transmittance: Spectrum, grooves: Grooves) -> Result<Self> {
        check_within("reflectance", &reflectance, 1.0)?;
        check_within("transmittance", &transmittance, 1.0)?;
        let sum = Spectrum::mix(&[(1.0, &reflectance), (1.0, &transmittance)]).max();
        if sum > 1.0 + 1e-9 {
            return Err(Error::input(format!("reflectance and transmittance with a sum of {sum}"))
                .expected("a sum of at most 1"));
        }
        Ok(Self { grating, reflectance, transmittance, grooves, fixed_nm: None })
    }

    /// Returns the course of the grooves.
    pub fn grooves(&self) -> Grooves {
        self.grooves
    }

    /// Returns the grating with the orders of the wavelength `nm` for all light.
    #[must_use]
    pub fn without_dispersion(self, nm: f64) -> Self {
        Self { fixed_nm: Some(nm), ..self }
    }

    pub(super) fn is_upsampled(&self) -> bool {
        let upsampled = self.reflectance.is_upsampled() || self.transmittance.is_upsampled();
        upsampled || self.grating.profile().is_upsampled()
    }

    pub(super) fn transmits(&self) -> bool {
        self.transmittance.max() > 0.0
    }

    pub(super) fn sample(
        &self,
        wo: DVec3,
        iors: InterfaceIors<'_>,
        angle: f32,
        nm: f64,
        u: [f64; 3],
    ) -> Option<BsdfSample> {
        let (reflected, transmitted) = (self.reflectance.at(nm), self.transmittance.at(nm));
        let either = reflected + transmitted;
        if either <= 0.0 {
            return None;
        }
        let (event, chosen) = if u[2] * either < reflected {
            (ScatterEvent::Reflection, reflected / either)
        } else {
            (ScatterEvent::Transmission, transmitted / either)
        };
        let (frame, sign) = (GrooveFrame::new(angle), z_sign(wo));
        let incident = -frame.to_grooves(flip_z(wo, sign));
        let (index, wave_nm) = (iors.here.n(nm), self.fixed_nm.unwrap_or(nm));
        let (order, fraction) = self.grating.sample_order(incident, index, wave_nm, u[0]);
        let out = self.grating.direction(incident, order, event, [index; 2], wave_nm)?;
        let sample = BsdfSample::delta(flip_z(frame.to_surface(out), sign), event, chosen * fraction);
        Some(BsdfSample { disperses: self.fixed_nm.is_none(), ..sample })
    }

    /// Returns the efficiency of the order from `wo` to the sample, or back for radiance.
    pub(super) fn coefficient(
        &self,
        wo: DVec3,
        sample: &BsdfSample,
        iors: InterfaceIors<'_>,
        angle: f32,
        mode: TransportMode,
        nm: f64,
    ) -> f64 {
        let (frame, sign) = (GrooveFrame::new(angle), z_sign(wo));
        let arriving = -frame.to_grooves(flip_z(wo, sign));
        let leaving = frame.to_grooves(flip_z(sample.wi, sign));
        let (index, wave_nm) = (iors.here.n(nm), self.fixed_nm.unwrap_or(nm));
        let order = (leaving.x - arriving.x) * index * self.grating.period_nm() / wave_nm;
        let incident = match mode {
            TransportMode::Importance => arriving,
            TransportMode::Radiance => -leaving,
        };
        let fraction = match sample.event {
            ScatterEvent::Reflection => self.reflectance.at(nm),
            ScatterEvent::Transmission => self.transmittance.at(nm),
        };
        fraction * self.grating.efficiency(incident, order.round() as i32, index, wave_nm)
    }

    pub(super) fn absorbed_fraction(&self, wo: DVec3, iors: InterfaceIors<'_>, angle: f32, nm: f64) -> f64 {
        let incident = -GrooveFrame::new(angle).to_grooves(flip_z(wo, z_sign(wo)));
        let total = self.grating.total_efficiency(incident, iors.here.n(nm), self.fixed_nm.unwrap_or(nm));
        (1.0 - total * (self.reflectance.at(nm) + self.transmittance.at(nm))).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glass::RefractiveIndex;
    use crate::grating::GratingProfile;

    /// The efficiency of order −1 of a blazed grating is that of the light that is sent back along
    /// it, although scalar theory gives most of the power to an order that is evanescent.
    #[test]
    fn efficiencies_are_reciprocal() {
        let air = RefractiveIndex::constant(1.0).unwrap();
        let iors = InterfaceIors { here: &air, there: &air };
        let profile = GratingProfile::Blazed { order: 1, blaze_nm: 550.0 };
        let grating = Grating::new(1200.0, profile).unwrap();
        let [white, black] = [1.0, 0.0].map(Spectrum::constant);
        let grating = DiffractionGrating::new(grating, white, black, Grooves::Parallel(0.0)).unwrap();
        let at = |degrees: f64| DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        // Light that travels towards +x at 5° to the normal leaves at −43.86°.
        let (lamp, out) = (at(-5.0), at(-43.855_680_335));
        let coefficient = |wo: DVec3, wi: DVec3, mode| {
            let sample = BsdfSample::delta(wi, ScatterEvent::Reflection, 1.0);
            grating.coefficient(wo, &sample, iors, 0.0, mode, 650.0)
        };
        let forward = coefficient(lamp, out, TransportMode::Importance);
        for (wo, wi, mode) in [
            (out, lamp, TransportMode::Radiance),
            (out, lamp, TransportMode::Importance),
            (lamp, out, TransportMode::Radiance),
        ] {
            let other = coefficient(wo, wi, mode);
            assert!((other - forward).abs() < 1e-9, "{other} for {forward}");
        }
    }

    /// A coarse grating has too many orders for reciprocal efficiencies. The order that misses the
    /// blaze by 17 orders still has the same efficiency in both modes.
    #[test]
    fn camera_paths_use_the_efficiency_of_the_light() {
        let air = RefractiveIndex::constant(1.0).unwrap();
        let iors = InterfaceIors { here: &air, there: &air };
        let profile = GratingProfile::Blazed { order: 20, blaze_nm: 500.0 };
        let grating = Grating::new(20.0, profile).unwrap();
        let [white, black] = [1.0, 0.0].map(Spectrum::constant);
        let grating = DiffractionGrating::new(grating, white, black, Grooves::Parallel(0.0)).unwrap();
        let at = |sin: f64| DVec3::new(sin, 0.0, (1.0 - sin * sin).sqrt());
        // Orders are 0.0102 apart. The blaze is evanescent for light from the lamp and not from `out`.
        let (lamp, out) = (at(-0.9), at(0.93));
        let coefficient = |wo: DVec3, wi: DVec3, mode| {
            let sample = BsdfSample::delta(wi, ScatterEvent::Reflection, 1.0);
            grating.coefficient(wo, &sample, iors, 0.0, mode, 510.0)
        };
        let forward = coefficient(lamp, out, TransportMode::Importance);
        let backward = coefficient(out, lamp, TransportMode::Radiance);
        assert!(forward > 0.0 && (backward - forward).abs() < 1e-12 * forward, "{backward} for {forward}");
    }

    #[test]
    fn fractions_with_a_sum_above_1_are_refused() {
        let grating = Grating::new(600.0, GratingProfile::BinaryAmplitude { duty: 0.5 }).unwrap();
        let half = || Spectrum::constant(0.6);
        let message = DiffractionGrating::new(grating, half(), half(), Grooves::Circular).unwrap_err().to_string();
        assert!(message.contains("a sum of 1.2"), "{message}");
    }
}
