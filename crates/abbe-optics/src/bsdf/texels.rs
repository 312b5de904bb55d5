use super::filter::LocalRetardance;
use crate::texture::Texel;

/// The texels that a path selected at a point of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Texels {
    /// Of the reflectance.
    pub reflectance: Texel,
    /// Of the transmittance.
    pub transmittance: Texel,
    /// The thickness in nm of the thin film that varies over the surface.
    pub thickness_nm: f32,
    /// The angle in rad from the first axis of the local frame to the direction across the grooves of
    /// a grating, or to the axis u of a filter.
    pub axis_angle: f32,
}

impl Texels {
    /// The texels of a surface without textures.
    pub const NONE: Self = Self { reflectance: 0, transmittance: 0, thickness_nm: 0.0, axis_angle: 0.0 };

    pub(super) fn of_reflectance(reflectance: Texel) -> Self {
        Self { reflectance, ..Self::NONE }
    }

    pub(super) fn of_retarder(local: LocalRetardance) -> Self {
        // Sheets with filters have neither films nor a texel of the transmittance.
        Self { thickness_nm: local.factor, transmittance: local.turn_rad.to_bits(), ..Self::NONE }
    }

    /// Returns the retardance and the axis of a varying retarder.
    pub fn retardance(&self) -> LocalRetardance {
        LocalRetardance { factor: self.thickness_nm, turn_rad: f32::from_bits(self.transmittance) }
    }

    pub(super) fn of_thickness(thickness_nm: f64) -> Self {
        Self { thickness_nm: thickness_nm as f32, ..Self::NONE }
    }
}
