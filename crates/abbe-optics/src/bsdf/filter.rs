//! Polarising filters: sheets that change the polarisation of light and reflect nothing.

use super::check::check_within;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Spectrum;

/// A stack of polarisers and retarders, from the front of the sheet (the outside of the surface) to
/// its back. Light crosses it straight on.
///
/// Axes lie in the sheet. At oblique incidence, the direction that a polariser absorbs and the fast
/// axis of a retarder are projected on the plane perpendicular to the light.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarisingFilter {
    layers: Vec<FilterLayer>,
}

/// A layer of a [`PolarisingFilter`].
#[derive(Debug, Clone, PartialEq)]
pub struct FilterLayer {
    /// What the layer does to light.
    pub element: FilterElement,
    /// The angle in rad from u to the transmitted direction of a polariser or to the fast axis of a
    /// retarder, counter-clockwise as seen from the front.
    pub axis_rad: f64,
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
                FilterElement::Retarder { retardance_nm } => {
                    check_within("retardance", retardance_nm, f64::INFINITY)?;
                }
            }
        }
        Ok(Self { layers })
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
