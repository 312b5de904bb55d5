//! Stacks of layers with their materials.

use super::airy::{StackResponse, response};
use super::clear::clear_reflectance;
use crate::glass::RefractiveIndex;
use crate::texture::{LookupRandom, SurfaceScalar, TexturePoint};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::complex::Complex;
use abbe_spectra::spectrum::Spectrum;

/// The complex index n + ik of a material as a function of wavelength.
#[derive(Debug, Clone, PartialEq)]
pub enum OpticalIndex {
    /// A transparent material.
    Transparent(RefractiveIndex),
    /// A metal, or another material that absorbs.
    Absorbing {
        /// The real part.
        n: Spectrum,
        /// The extinction coefficient.
        k: Spectrum,
    },
}

impl OpticalIndex {
    /// Creates an absorbing index; negative n or k, or n = k = 0 at a wavelength, is an error.
    pub fn absorbing(n: Spectrum, k: Spectrum) -> Result<Self> {
        for (name, part) in [("refractive index", &n), ("extinction coefficient", &k)] {
            let lowest = part.min();
            if lowest < 0.0 || lowest.is_nan() {
                return Err(Error::input(format!("a {name} of {lowest}")).expected("0 or more"));
            }
        }
        for nm in 360..=830 {
            if n.at(f64::from(nm)) + k.at(f64::from(nm)) <= 0.0 {
                return Err(Error::input(format!("n and k are both 0 at {nm} nm")).expected("n or k above 0"));
            }
        }
        Ok(Self::Absorbing { n, k })
    }

    /// Returns n + ik at a wavelength in nm.
    #[inline]
    pub fn at(&self, nm: f64) -> Complex {
        match self {
            Self::Transparent(index) => Complex::from(index.n(nm)),
            Self::Absorbing { n, k } => Complex::new(n.at(nm), k.at(nm)),
        }
    }

    /// Returns true if the material absorbs light.
    pub fn absorbs(&self) -> bool {
        match self {
            Self::Transparent(_) => false,
            Self::Absorbing { n: _, k } => k.max() > 0.0,
        }
    }
}

/// A layer of a stack.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmLayer {
    /// The material.
    pub index: OpticalIndex,
    /// The thickness in nm, which may vary over a surface.
    pub thickness_nm: SurfaceScalar,
}

/// Thin films on top of each other, of which at most one varies in thickness over the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmStack {
    layers: Vec<FilmLayer>,
    absorbs: bool,
    varying: Option<usize>,
}

/// The largest thickness in nm: light of no lamp is coherent enough to interfere in thicker layers.
const MOST_THICKNESS_NM: f64 = 1e6;

impl FilmStack {
    /// Creates a stack of layers from the side of the incident light. Returns an error if a
    /// thickness is negative or above 1 mm, or several thicknesses vary.
    pub fn new(layers: Vec<FilmLayer>) -> Result<Self> {
        for layer in &layers {
            let (low, high) = layer.thickness_nm.range();
            if !(low >= 0.0 && high <= MOST_THICKNESS_NM) {
                let wrong = if low >= 0.0 { high } else { low };
                return Err(Error::input(format!("a thickness of {wrong} nm")).expected("from 0 to 1000000 nm"));
            }
        }
        let mut varying = (0..).zip(&layers).filter(|(_, layer)| layer.thickness_nm.is_textured());
        let (first, second) = (varying.next(), varying.next());
        if second.is_some() {
            return Err(Error::input("several layers with a thickness that varies").expected("at most one"));
        }
        let (absorbs, varying) = (layers.iter().any(|layer| layer.index.absorbs()), first.map(|(number, _)| number));
        Ok(Self { layers, absorbs, varying })
    }

    /// Returns the stack with the layers in the opposite order.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        self.layers.reverse();
        self.varying = self.varying.map(|number| self.layers.len() - 1 - number);
        self
    }

    /// Returns the layers from the side of the incident light to the substrate.
    pub fn layers(&self) -> &[FilmLayer] {
        &self.layers
    }

    /// Returns true if a layer absorbs light.
    pub fn absorbs(&self) -> bool {
        self.absorbs
    }

    /// Returns true if the thickness of a layer varies over the surface.
    pub fn is_textured(&self) -> bool {
        self.varying.is_some()
    }

    /// Returns the thickness in nm of the layer that varies at a point, or 0 if none does.
    pub fn thickness_at(&self, point: &TexturePoint, random: &mut LookupRandom) -> f64 {
        self.varying.map_or(0.0, |number| self.layers[number].thickness_nm.value_at(point, random))
    }

    /// Returns the stack with the mean thickness of each layer.
    #[must_use]
    pub fn without_textures(mut self) -> Self {
        for layer in &mut self.layers {
            layer.thickness_nm = SurfaceScalar::Uniform(layer.thickness_nm.mean());
        }
        self.varying = None;
        self
    }

    /// Returns the response to light that meets the first layer first; see [`response`].
    /// `thickness_nm` replaces the thickness of the layer that varies.
    pub fn response(&self, cos: f64, incident: f64, substrate: Complex, nm: f64, thickness_nm: f64) -> StackResponse {
        response(cos, incident, self.layers_at(nm, thickness_nm), substrate, nm)
    }

    /// Returns the response to light from the substrate's side, in a medium of index `incident`.
    pub fn response_reversed(
        &self,
        cos: f64,
        incident: f64,
        substrate: Complex,
        nm: f64,
        thickness_nm: f64,
    ) -> StackResponse {
        response(cos, incident, self.layers_at(nm, thickness_nm).rev(), substrate, nm)
    }

    /// Returns the reflectance for unpolarised light between two transparent media, which is
    /// quicker than [`response`](Self::response). `None` if a layer absorbs, or if light does not
    /// propagate in one. If `outside` is false, the light arrives at the last layer.
    pub fn clear_reflectance(
        &self,
        outside: bool,
        cos: f64,
        [incident, substrate]: [f64; 2],
        nm: f64,
        thickness_nm: f64,
    ) -> Option<f64> {
        if self.absorbs {
            return None;
        }
        let layers = self.layers_at(nm, thickness_nm).map(|(index, thickness_nm)| (index.re, thickness_nm));
        if outside {
            clear_reflectance(cos, incident, layers, substrate, nm)
        } else {
            clear_reflectance(cos, incident, layers.rev(), substrate, nm)
        }
    }

    fn layers_at(&self, nm: f64, thickness_nm: f64) -> impl DoubleEndedIterator<Item = (Complex, f64)> {
        self.layers.iter().map(move |layer| {
            let thickness = match layer.thickness_nm {
                SurfaceScalar::Uniform(thickness) => thickness,
                SurfaceScalar::Textured(_) => thickness_nm,
            };
            (layer.index.at(nm), thickness)
        })
    }
}
