//! The diffraction at the camera's aperture, in the form that the film needs.

use abbe_optics::aperture::{Blades, fraunhofer};
use abbe_scene::camera::{ApertureDiffraction, Camera};
use abbe_transport::emit::LightSampler;
use abbe_transport::plan::Plan;
use abbe_transport::sensor::DiffractionPsf;
use serde::{Deserialize, Serialize};

/// The number of wavelengths that represent the spectrum of the lights.
const WAVELENGTHS: u32 = 1024;

/// The diffraction at the camera's aperture. Saved runs contain it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiffractionSetup {
    blades: Option<Blades>,
    /// The diffraction length λN in pixels, divided by the wavelength λ in nm. N is the f-number.
    spread_px_per_nm: f64,
    /// Wavelengths in nm that represent equal fractions of the lights' visible power.
    light_nm: Vec<f64>,
}

impl DiffractionSetup {
    pub(super) fn of(camera: &Camera, plan: &Plan, lights: &LightSampler) -> Option<Self> {
        let ApertureDiffraction { blades, spread_px_per_nm } =
            ApertureDiffraction::of(camera).filter(|_| plan.aperture.diffracts())?;
        let fraction = |i: u32| (f64::from(i) + 0.5) / f64::from(WAVELENGTHS);
        let light_nm = (0..WAVELENGTHS).map(|i| lights.wavelengths.sample(fraction(i)).0).collect();
        Some(Self { blades, spread_px_per_nm, light_nm })
    }

    pub fn slices(&self) -> usize {
        DiffractionPsf::slices_of(&self.light_nm)
    }

    pub(super) fn for_film(&self, (width, height): (usize, usize)) -> DiffractionPsf {
        let pattern = |place| fraunhofer(self.blades, place);
        DiffractionPsf::new(self.spread_px_per_nm, width.max(height), self.light_nm.clone(), pattern)
    }
}
