//! Spectra for RGB colours (spectral upsampling).

use super::smooth;
use super::smooth_reflectance::{SmoothReflectance, basis};
use super::value::Spectrum;
use crate::error::{Error, Result};

impl Spectrum {
    /// Returns a smooth reflectance within [0, 1] of this linear sRGB colour under D65 and for the
    /// CIE 1931 observer, or an error if a component is outside [0, 1]. The error is at most 10⁻³
    /// for every colour of the RGB cube, and greys are constant.
    pub fn rgb_reflectance(rgb: [f64; 3]) -> Result<Self> {
        if !rgb.iter().all(|component| (0.0..=1.0).contains(component)) {
            return Err(
                Error::input(format!("the colour {rgb:?} for a reflectance")).expected("components from 0 to 1")
            );
        }
        if rgb == [rgb[0]; 3] {
            return Ok(Self::constant(rgb[0]));
        }
        let smooth_reflectance = SmoothReflectance::of_rgb(rgb);
        Ok(Self::upsampled(smooth::sampled(&|nm| smooth_reflectance.at(nm), &[])))
    }

    /// Returns a light of this linear sRGB colour: D65 times a smooth filter, without ultraviolet,
    /// about which a colour says nothing. Its XYZ, without the factor 683, match up to 10⁻³ of the
    /// largest component. Returns an error if a component is negative or not finite.
    pub fn rgb_light(rgb: [f64; 3]) -> Result<Self> {
        if !rgb.iter().all(|component| component.is_finite() && *component >= 0.0) {
            return Err(
                Error::input(format!("the colour {rgb:?} for a light")).expected("finite components of 0 or more")
            );
        }
        // The filter is fitted to a scaled colour whose brightest component is 0.5, because a
        // filter with values near 1 would be less smooth.
        let scale = 2.0 * rgb.iter().copied().fold(0.0, f64::max);
        let d65 = &basis().d65;
        if scale == 0.0 || rgb == [rgb[0]; 3] {
            return Ok(d65.scaled(rgb[0]).without_ultraviolet());
        }
        let filter = SmoothReflectance::of_rgb(rgb.map(|component| component / scale));
        let light = |nm: f64| scale * filter.at(nm) * d65.at(nm);
        Ok(Self::upsampled(smooth::sampled(&light, &[])).without_ultraviolet())
    }
}

#[cfg(test)]
mod tests {
    use super::super::observer::Observer;
    use super::super::smooth_reflectance::{Vec3, XYZ_TO_LINEAR_SRGB, dot};
    use super::*;

    fn linear_srgb_under_d65(reflectance: &Spectrum) -> Vec3 {
        let xyz = Observer::cie1931().xyz_under(reflectance, &basis().d65);
        XYZ_TO_LINEAR_SRGB.map(|row| dot(row, xyz))
    }

    /// Returns the largest error of a component among 9³ colours of the RGB cube, and its colour.
    fn worst(back: impl Fn(Vec3) -> Vec3) -> (f64, Vec3) {
        let colours = (0..729).map(|code| [code / 81, code / 9 % 9, code % 9].map(|level| f64::from(level) / 8.0));
        let error = |rgb: Vec3| {
            let back = back(rgb);
            (0..3).map(|i| (back[i] - rgb[i]).abs()).fold(0.0, f64::max)
        };
        colours.map(|rgb| (error(rgb), rgb)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }

    #[test]
    fn every_colour_has_a_reflectance_within_0_and_1() {
        let worst = worst(|rgb| {
            let spectrum = Spectrum::rgb_reflectance(rgb).unwrap();
            assert!(spectrum.min() >= 0.0 && spectrum.max() <= 1.0, "{rgb:?}");
            assert_eq!(spectrum.is_upsampled(), rgb != [rgb[0]; 3], "greys are not upsampled");
            linear_srgb_under_d65(&spectrum)
        });
        println!("reflectances: {worst:?}");
        assert!(worst.0 <= 1e-3, "{worst:?}");
    }

    #[test]
    fn every_colour_has_a_light_at_any_strength() {
        for strength in [1.0, 1e-6, 1e6] {
            let worst = worst(|rgb| {
                let light = Spectrum::rgb_light(rgb.map(|component| strength * component)).unwrap();
                assert!(light.min() >= 0.0, "{rgb:?}");
                let xyz = Observer::cie1931().xyz(&light).map(|value| value / strength);
                XYZ_TO_LINEAR_SRGB.map(|row| dot(row, xyz))
            });
            println!("lights of {strength}: {worst:?}");
            assert!(worst.0 <= 1e-3, "{worst:?}");
        }
    }
}
