//! Polarising filters: sheets that change the polarisation of light and reflect nothing.

use super::check::check_within;
use crate::texture::{LookupRandom, SurfaceScalar, TexturePoint};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{atan2, hypot};
use abbe_spectra::spectrum::Spectrum;
use std::f64::consts::FRAC_PI_2;

/// A stack of polarisers and retarders, from the front of the sheet (the outside of the surface) to
/// its back. Light crosses it straight on.
///
/// Axes lie in the sheet. At oblique incidence, the direction that a polariser absorbs and the fast
/// axis of a retarder are projected on the plane perpendicular to the light.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarisingFilter {
    layers: Vec<FilterLayer>,
    /// The number of the retarder that varies over the sheet.
    varying: Option<usize>,
}

/// A layer of a [`PolarisingFilter`].
#[derive(Debug, Clone, PartialEq)]
pub struct FilterLayer {
    /// What the layer does to light.
    pub element: FilterElement,
    /// The angle in rad from u to the transmitted direction of a polariser or to the fast axis of a
    /// retarder, counter-clockwise as seen from the front.
    pub axis_rad: f64,
    /// How a retarder varies over the sheet. Only one layer of a filter may vary.
    pub field: RetardanceField,
}

/// How the retardance and the fast axis of a retarder vary over a sheet.
#[derive(Debug, Clone, PartialEq)]
pub enum RetardanceField {
    /// Not at all.
    Uniform,
    /// By textures.
    Textured {
        /// The factor of the retardance.
        factor: SurfaceScalar,
        /// The angle in degrees that is added to the axis.
        turn_deg: SurfaceScalar,
    },
    /// By the stress in a disc that is pressed at its upper and its lower edge, by the full solution
    /// of Hertz (Timoshenko & Goodier, *Theory of Elasticity*, §41). The texture coordinates of a
    /// disk cover its square. The factor is 1 in the middle.
    PressedDisc,
    /// By the stress in a beam along u that is bent without a shear force. The factor is 1 at both
    /// edges.
    BentBeam,
}

/// The retardance and the axis of a varying retarder at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalRetardance {
    /// The factor of the retardance, at least 0.
    pub factor: f32,
    /// The angle in rad that is added to the axis.
    pub turn_rad: f32,
}

/// What a layer does to light.
#[derive(Debug, Clone, PartialEq)]
pub enum FilterElement {
    /// A linear polariser without retardance.
    Polariser {
        /// The transmittance for light along the axis, from 0 to 1.
        k1: Spectrum,
        /// The transmittance for light across the axis, from 0 to 1.
        k2: Spectrum,
    },
    /// A linear retarder.
    Retarder {
        /// The path by which light across the axis lags behind light along it, in nm.
        retardance_nm: Spectrum,
    },
    /// A retarder whose axis turns evenly from the front to the back, such as a liquid crystal.
    TwistedRetarder {
        /// The path by which light across the fast axis lags behind light along it, in nm, as if
        /// the axis did not turn.
        retardance_nm: Spectrum,
        /// The angle in rad by which the axis turns, counter-clockwise as seen from the front.
        twist_rad: f64,
    },
}

impl FilterElement {
    /// Returns the polariser that transmits all light along the axis and none across it.
    pub fn ideal_polariser() -> Self {
        Self::Polariser { k1: Spectrum::constant(1.0), k2: Spectrum::constant(0.0) }
    }
}

impl PolarisingFilter {
    /// Creates a filter. Returns an error without layers, or if a transmittance lies outside \[0,
    /// 1\] or a retardance is negative.
    pub fn new(layers: Vec<FilterLayer>) -> Result<Self> {
        if layers.is_empty() {
            return Err(Error::input("found a filter without layers").expected("at least one layer"));
        }
        for layer in &layers {
            match &layer.element {
                FilterElement::Polariser { k1, k2 } => {
                    check_within("transmittance", k1, 1.0)?;
                    check_within("transmittance", k2, 1.0)?;
                }
                FilterElement::Retarder { retardance_nm } | FilterElement::TwistedRetarder { retardance_nm, .. } => {
                    check_within("retardance", retardance_nm, f64::INFINITY)?;
                }
            }
            if let RetardanceField::Textured { factor, .. } = &layer.field
                && factor.range().0 < 0.0
            {
                let what = format!("a factor of the retardance of {}", factor.range().0);
                return Err(Error::input(what).expected("at least 0"));
            }
        }
        let mut varying = (0..layers.len()).filter(|&number| layers[number].field.varies());
        let (first, second) = (varying.next(), varying.next());
        if second.is_some() {
            return Err(Error::input("several retarders that vary over the sheet").expected("at most one"));
        }
        Ok(Self { layers, varying: first })
    }

    /// Returns the number of the layer that varies over the sheet.
    #[inline]
    pub fn varying(&self) -> Option<usize> {
        self.varying
    }

    /// Returns the retardance and the axis of the varying layer at a point.
    pub fn retardance_at(&self, point: &TexturePoint, random: &mut LookupRandom) -> LocalRetardance {
        self.varying.map_or(LocalRetardance::WHOLE, |number| self.layers[number].field.at(point, random))
    }

    /// Returns the filter with the mean of each texture, and with the stress in the middle.
    #[must_use]
    pub fn without_textures(mut self) -> Self {
        if let Some(layer) = self.varying.and_then(|number| self.layers.get_mut(number)) {
            let field = std::mem::replace(&mut layer.field, RetardanceField::Uniform);
            if let RetardanceField::Textured { factor, turn_deg } = field
                && let FilterElement::Retarder { retardance_nm } | FilterElement::TwistedRetarder { retardance_nm, .. } =
                    &mut layer.element
            {
                *retardance_nm = retardance_nm.scaled(factor.mean());
                layer.axis_rad += turn_deg.mean().to_radians();
            }
        }
        self.varying = None;
        self
    }

    /// Returns the layers, from the front.
    pub fn layers(&self) -> &[FilterLayer] {
        &self.layers
    }

    /// Returns true if a layer absorbs light.
    pub fn absorbs(&self) -> bool {
        self.layers.iter().any(|layer| matches!(layer.element, FilterElement::Polariser { .. }))
    }
}

impl LocalRetardance {
    /// The retardance and the axis of a uniform retarder.
    pub const WHOLE: Self = Self { factor: 1.0, turn_rad: 0.0 };
}

impl RetardanceField {
    fn varies(&self) -> bool {
        match self {
            Self::Uniform => false,
            Self::Textured { factor, turn_deg } => factor.is_textured() || turn_deg.is_textured(),
            Self::PressedDisc | Self::BentBeam => true,
        }
    }

    fn at(&self, point: &TexturePoint, random: &mut LookupRandom) -> LocalRetardance {
        // v points downwards in a picture.
        let [x, y] = [2.0 * point.uv[0] - 1.0, 1.0 - 2.0 * point.uv[1]];
        let (factor, turn_rad) = match self {
            Self::Uniform => (1.0, 0.0),
            Self::Textured { factor, turn_deg } => {
                (factor.value_at(point, random), turn_deg.value_at(point, random).to_radians())
            }
            Self::PressedDisc => pressed_disc([x, y]),
            Self::BentBeam => (y.abs(), if y < 0.0 { 0.0 } else { FRAC_PI_2 }),
        };
        LocalRetardance { factor: factor as f32, turn_rad: turn_rad as f32 }
    }
}

/// Returns the difference of the principal stresses, relative to that in the middle, and the angle in
/// rad of the smaller one at a point of the unit disc, which is pressed at (0, ±1). The lower limit of
/// the distance to these points stands for the width of the contact.
fn pressed_disc([x, y]: [f64; 2]) -> (f64, f64) {
    const CONTACT2: f64 = 1e-4;
    let (above, below) = (1.0 - y, 1.0 + y);
    let [r1, r2] = [above, below].map(|distance| (x * x + distance * distance).max(CONTACT2));
    // In units of 2P/(πhR). The pressure of all sides is the same in both directions.
    let along_x = -(above * x * x / (r1 * r1) + below * x * x / (r2 * r2));
    let along_y = -(above.powi(3) / (r1 * r1) + below.powi(3) / (r2 * r2));
    let shear = above * above * x / (r1 * r1) - below * below * x / (r2 * r2);
    let difference = hypot(along_x - along_y, 2.0 * shear);
    (0.5 * difference, 0.5 * atan2(2.0 * shear, along_x - along_y) + FRAC_PI_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// In the middle, the vertical pressure is three times the horizontal tension; on the horizontal
    /// diameter, σx − σy = (4P/πhD)·(…) of the textbook, and the edge at its end is free of stress.
    #[test]
    fn a_pressed_disc_has_the_stress_of_the_closed_form() {
        let (middle, axis) = pressed_disc([0.0, 0.0]);
        assert!((middle - 1.0).abs() < 1e-15 && (axis.rem_euclid(PI) - FRAC_PI_2).abs() < 1e-12, "{middle} {axis}");
        assert!(pressed_disc([1.0, 0.0]).0 < 1e-15);
        for x in [0.2, 0.5, 0.8_f64] {
            // σx − σy = (8P/πhD)·(1 − ξ²)/(1 + ξ²)² with ξ = x/R.
            let known = (1.0 - x * x) / (1.0 + x * x).powi(2);
            assert!((pressed_disc([x, 0.0]).0 - known).abs() < 1e-14, "{x}");
        }
        // Elsewhere, the pressures of both points of contact add: each acts along the line to it, and
        // is cos φ/r (Flamant).
        for (x, y) in [(0.3, 0.4), (-0.5, 0.1), (0.2, -0.7_f64)] {
            let (mut twice_cos, mut twice_sin) = (0.0_f64, 0.0);
            for top in [1.0, -1.0] {
                let (dx, dy): (f64, f64) = (x, top - y);
                let r = dx.hypot(dy);
                let pressure = dy.abs() / (r * r);
                let (c, s) = (dx / r, -dy / r);
                twice_cos -= pressure * (c * c - s * s);
                twice_sin -= pressure * 2.0 * c * s;
            }
            let (difference, axis) = pressed_disc([x, y]);
            assert!((difference - 0.5 * twice_cos.hypot(twice_sin)).abs() < 1e-12, "{x}, {y}: {difference}");
            // The axis of the smaller stress is across that of the larger one.
            let (c, s) = ((2.0 * axis).cos(), (2.0 * axis).sin());
            assert!((c * twice_cos + s * twice_sin + 2.0 * difference).abs() < 1e-12, "{x}, {y}: {axis}");
        }
    }
}
