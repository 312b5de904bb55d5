//! The luminous surfaces of luminaires, for glare ratings.

use super::{Emitter, LiSample, Light};

impl Light {
    /// Returns true if the light is a luminaire with a luminous surface, which may glare.
    pub fn is_luminaire(&self) -> bool {
        if let Emitter::Goniometric(light) = &self.emitter {
            return !light.is_point();
        }
        matches!(self.emitter, Emitter::Area(_))
    }

    /// Returns true if the light is a lamp without a surface, so that its luminance is infinite.
    pub fn has_infinite_luminance(&self) -> bool {
        if let Emitter::Goniometric(light) = &self.emitter {
            return light.is_point();
        }
        matches!(self.emitter, Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) | Emitter::Rays(_))
    }

    /// Returns the solid angle that a sample of a luminaire stands for, whose mean over all samples
    /// is that of the luminous parts. Returns 0 for other lights.
    pub fn apparent_solid_angle(&self, sample: &LiSample) -> f64 {
        if let Emitter::Goniometric(light) = &self.emitter {
            return light.apparent_solid_angle(sample);
        }
        let is_area = matches!(self.emitter, Emitter::Area(_));
        sample.pdf_solid_angle.filter(|_| is_area).map_or(0.0, |pdf| 1.0 / pdf)
    }
}
