//! The luminous surfaces of luminaires, for glare ratings.

use super::{Emitter, LiSample, Light};

impl Light {
    /// Returns true if the light is a luminaire with a luminous surface, which may glare.
    pub fn is_luminaire(&self) -> bool {
        match &self.emitter {
            Emitter::Area(_) => true,
            Emitter::Goniometric(light) => !light.is_point(),
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) | Emitter::Volume(_) => false,
            Emitter::Directional(_) | Emitter::Environment(_) => false,
        }
    }

    /// Returns true if the light is a lamp without a surface, so that its luminance is infinite.
    pub fn has_infinite_luminance(&self) -> bool {
        match &self.emitter {
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) => true,
            Emitter::Goniometric(light) => light.is_point(),
            Emitter::Directional(_) | Emitter::Environment(_) | Emitter::Area(_) | Emitter::Volume(_) => false,
        }
    }

    /// Returns the solid angle that a sample of a luminaire stands for, whose mean over all samples
    /// is that of the luminous parts. Returns 0 for other lights.
    pub fn apparent_solid_angle(&self, sample: &LiSample) -> f64 {
        match &self.emitter {
            Emitter::Area(_) => sample.pdf_solid_angle.map_or(0.0, |pdf| 1.0 / pdf),
            Emitter::Goniometric(light) => light.apparent_solid_angle(sample),
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) | Emitter::Volume(_) => 0.0,
            Emitter::Directional(_) | Emitter::Environment(_) => 0.0,
        }
    }
}
