//! The primaries of picture files whose RGB is not that of sRGB.

use abbe_spectra::colour::{AdaptationTransform, Rgb, RgbSpace, adaptation, from_xy};
use abbe_spectra::error::{Error, Result};
use glam::{DMat3, DVec3};

/// The meaning of the components of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FilePrimaries {
    /// The matrices to linear sRGB.
    light: DMat3,
    reflectance: DMat3,
}

/// What colours are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ColourUse {
    /// Light keeps its XYZ.
    Light,
    /// Reflectances are adapted (Bradford), so that the white of the file reflects all light.
    Reflectance,
}

impl FilePrimaries {
    /// Creates the primaries of the chromaticities x, y of red, green, blue and white. Returns
    /// `None` for those of sRGB.
    ///
    /// # Errors
    /// Returns an error if the chromaticities span no colours.
    pub(super) fn new(xy: [[f64; 2]; 4]) -> Result<Option<Self>> {
        let [red, green, blue, white] = xy;
        let own = RgbSpace::Srgb;
        let [r, g, b] = own.primaries_xy();
        if [r, g, b, own.white_xy()].as_flattened().iter().zip(xy.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-4) {
            return Ok(None);
        }
        let columns = [red, green, blue].map(|xy| from_xy(xy, 1.0));
        let (columns, white) = (DMat3::from_cols_array_2d(&columns), from_xy(white, 1.0));
        let to_xyz = columns * DMat3::from_diagonal(columns.inverse() * DVec3::from_array(white));
        let transform = AdaptationTransform::Bradford;
        if !(to_xyz.is_finite() && transform.can_adapt_from(white)) {
            return Err(Error::input(format!("the image states primaries that span no colours: {xy:?}")));
        }
        let light = from_xyz() * to_xyz;
        let adapted = DMat3::from_cols_array_2d(&adaptation(white, own.white(), transform)).transpose();
        Ok(Some(Self { light, reflectance: from_xyz() * adapted * to_xyz }))
    }

    /// The components X, Y and Z of a file. Equal values are the white of sRGB.
    pub(super) fn xyz() -> Self {
        Self { light: from_xyz(), reflectance: from_xyz() }
    }

    /// Converts linear components to linear sRGB. A colour outside the gamut of sRGB gets the
    /// nearest one of its hue and luminance inside.
    pub(super) fn srgb(&self, rgb: [f32; 3], usage: ColourUse) -> [f32; 3] {
        let given = DVec3::from_array(rgb.map(f64::from));
        let (matrix, most) = match usage {
            ColourUse::Light => (&self.light, f64::INFINITY),
            // Values above 1 are faults, which remain visible.
            ColourUse::Reflectance if given.max_element() > 1.0 => (&self.reflectance, f64::INFINITY),
            ColourUse::Reflectance => (&self.reflectance, 1.0),
        };
        let srgb = (*matrix * given).to_array();
        let srgb = if given.min_element() >= 0.0 { in_gamut(srgb, most) } else { srgb };
        srgb.map(|component| component as f32)
    }
}

/// Returns the matrix from XYZ to linear sRGB.
fn from_xyz() -> DMat3 {
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|xyz| RgbSpace::Srgb.from_xyz(xyz));
    DMat3::from_cols_array_2d(&columns)
}

/// Mixes a colour with the grey of its luminance until its components are from 0 to `most`.
fn in_gamut(rgb: Rgb, most: f64) -> Rgb {
    let luminance = RgbSpace::Srgb.to_xyz(rgb)[1].clamp(0.0, most);
    let kept = |component: f64| {
        let limit = component.clamp(0.0, most);
        if component == limit { 1.0 } else { (limit - luminance) / (component - luminance) }
    };
    let kept = rgb.into_iter().map(kept).fold(1.0, f64::min);
    rgb.map(|component| (luminance + kept * (component - luminance)).clamp(0.0, most))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACES_CG: [[f64; 2]; 4] = [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044], [0.321_68, 0.337_67]];

    #[test]
    fn light_keeps_its_luminance_and_white_reflects_all_light() {
        let primaries = FilePrimaries::new(ACES_CG).unwrap().unwrap();
        for (rgb, luminance) in [([0.5, 0.1, 0.1], 0.208_89), ([0.0, 1.0, 0.0], 0.674_08), ([0.0, 0.0, 2.0], 0.107_38)]
        {
            let srgb = primaries.srgb(rgb, ColourUse::Light).map(f64::from);
            let found = RgbSpace::Srgb.to_xyz(srgb)[1];
            assert!((found - luminance).abs() < 1e-4 && srgb.iter().all(|c| *c >= 0.0), "{rgb:?}: {srgb:?}");
        }
        let white = primaries.srgb([1.0; 3], ColourUse::Reflectance);
        assert!(white.iter().all(|c| (c - 1.0).abs() < 1e-5), "{white:?}");
        assert_eq!(FilePrimaries::new([[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]]).unwrap(), None);
        assert!(FilePrimaries::new([[0.3, 0.3]; 4]).is_err());
    }
}
