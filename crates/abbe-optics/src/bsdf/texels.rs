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
    /// The angle in rad from the first axis of the local frame to the direction across the grooves.
    pub axis_angle: f32,
}

impl Texels {
    /// The texels of a surface without textures.
    pub const NONE: Self = Self { reflectance: 0, transmittance: 0, thickness_nm: 0.0, axis_angle: 0.0 };

    pub(super) fn of_reflectance(reflectance: Texel) -> Self {
        Self { reflectance, ..Self::NONE }
    }

    pub(super) fn of_thickness(thickness_nm: f64) -> Self {
        Self { thickness_nm: thickness_nm as f32, ..Self::NONE }
    }
}
