//! From the camera's opening and the lights' spectrum to what the film needs to know of diffraction.

use crate::emit::LightChoice;
use crate::optics::aperture::{Blades, fraunhofer};
use crate::plan::Plan;
use crate::scene::camera::{Camera, Diffraction as Opening};
use crate::sensor::Diffraction;
use serde::{Deserialize, Serialize};

/// Wavelengths that stand for the lights' spectrum.
const WAVELENGTHS: u32 = 1024;

/// What diffraction does to a picture, in a form that a part or a checkpoint can hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Diffracting {
    blades: Option<Blades>,
    /// λN in pixels, for each nm of wavelength.
    spread_px_per_nm: f64,
    /// The lights' wavelengths, each for an equal share of the light as it is seen.
    light_nm: Vec<f64>,
}

impl Diffracting {
    /// What the plan calls for.
    pub(super) fn of(camera: &Camera, plan: &Plan, choice: &LightChoice) -> Option<Self> {
        let Opening { blades, spread_px_per_nm } = Opening::of(camera).filter(|_| plan.aperture.diffracts())?;
        let share = |i: u32| (f64::from(i) + 0.5) / f64::from(WAVELENGTHS);
        let light_nm = (0..WAVELENGTHS).map(|i| choice.wavelengths.sample(share(i)).0).collect();
        Some(Self { blades, spread_px_per_nm, light_nm })
    }

    /// How many slices of the spectrum the film keeps apart.
    pub fn slices(&self) -> usize {
        Diffraction::slices_of(&self.light_nm)
    }

    /// With the opening's pattern.
    pub(super) fn for_film(&self, (width, height): (usize, usize)) -> Diffraction {
        let pattern = |place| fraunhofer(self.blades, place);
        Diffraction::new(self.spread_px_per_nm, width.max(height), self.light_nm.clone(), pattern)
    }
}
