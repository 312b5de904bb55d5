//! The power that a light emits between two wavelengths.

use abbe_scene::light::{EmittedSpd, Light};
use abbe_spectra::spectrum::{BAND_NM, Observer, WavelengthDistribution};

/// The power of a spectrum below each wavelength.
#[derive(Debug, Clone)]
pub struct EmittedPower {
    distribution: WavelengthDistribution,
    /// The power in the band per watt of the light.
    total: f64,
    has_lines: bool,
    /// The wavelengths (nm) between which almost all visible power lies.
    visible_nm: (f64, f64),
}

/// The visible power below the visible wavelengths, as a fraction, and above them.
const INVISIBLE: f64 = 1e-5;

/// A wavelength, and the power of the light's own spectrum below it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) nm: f64,
    below: f64,
}

/// The power of a part of the spectrum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    /// A wavelength in the middle of the piece, by power.
    pub(super) nm: f64,
    /// The power in W per watt of the light.
    pub(super) power: f64,
}

impl EmittedPower {
    /// Returns `None` if the light emits nothing in the band.
    pub fn of(light: &Light, observer: &Observer) -> Option<Self> {
        let distribution = WavelengthDistribution::new(&light.spectrum)?;
        let visible = WavelengthDistribution::new(&light.spectrum.product(observer.sum_bar()));
        let visible_nm = visible.map_or(distribution.support(), |visible| {
            let [from, to] = [INVISIBLE, 1.0 - INVISIBLE].map(|u| visible.sample(u).0);
            (from, to)
        });
        let (total, has_lines) = (light.spectrum.integral(), !light.spectrum.line_segments().is_empty());
        Some(Self { distribution, total, has_lines, visible_nm })
    }

    /// Returns the wavelengths (nm) between which the light emits power in the band.
    pub(super) fn support_nm(&self, spd: EmittedSpd) -> (f64, f64) {
        match spd {
            EmittedSpd::Own | EmittedSpd::Filtered(_) => self.distribution.support(),
            EmittedSpd::Mixed(_) | EmittedSpd::Bands(_) | EmittedSpd::Thermal(_) => BAND_NM,
        }
    }

    pub(super) fn visible_nm(&self) -> (f64, f64) {
        self.visible_nm
    }

    #[inline]
    pub(super) fn edge(&self, nm: f64) -> Edge {
        Edge { nm, below: self.distribution.cdf(nm) }
    }

    /// Returns the power between two wavelengths. Own spectra are integrated exactly, and the
    /// smooth spectra of flames and pictures by their value in the middle.
    #[inline]
    pub(super) fn between(&self, light: &Light, spd: EmittedSpd, [from, to]: [Edge; 2]) -> Piece {
        let middle = 0.5 * (from.nm + to.nm);
        match spd {
            EmittedSpd::Own | EmittedSpd::Filtered(_) => {
                let nm = if self.has_lines && to.below > from.below {
                    self.distribution.sample(0.5 * (from.below + to.below)).0.clamp(from.nm, to.nm)
                } else {
                    middle
                };
                Piece { nm, power: self.total * (to.below - from.below) * light.filter_at(spd, nm) }
            }
            EmittedSpd::Mixed(_) | EmittedSpd::Bands(_) | EmittedSpd::Thermal(_) => {
                Piece { nm: middle, power: light.spd_at(spd, middle) * (to.nm - from.nm) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_format::{self as format, resolve::resolve};

    fn light_of(spectrum: &str) -> Light {
        let text = format!(
            r#"{{
  "camera": {{"from": [0, 0, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 40}}}}}},
  "film": {{"width": 8, "height": 8}},
  "materials": {{"white": {{"diffuse": {{"reflectance": 0.8}}}}}},
  "objects": [{{"shape": {{"sphere": {{"radius": 1}}}}, "material": "white"}}],
  "lights": [{{"point": {{"at": [3, 3, 3], "spectrum": {spectrum}, "power": 1}}}}]
}}"#
        );
        let (written, source) = format::parse(&text, "light.json".as_ref(), &[]).unwrap();
        resolve(&written, &source).unwrap().lights.remove(0)
    }

    fn pieces(light: &Light, width_nm: f64) -> Vec<Piece> {
        let power = EmittedPower::of(light, Observer::cie1931()).unwrap();
        let count = ((BAND_NM.1 - BAND_NM.0) / width_nm) as usize;
        let edge = |i: usize| power.edge(BAND_NM.0 + i as f64 * width_nm);
        (0..count).map(|i| power.between(light, EmittedSpd::Own, [edge(i), edge(i + 1)])).collect()
    }

    /// The pieces of a watt sum to a watt, and each has the integral of the spectrum.
    #[test]
    fn pieces_have_the_integral_of_the_spectrum() {
        for spectrum in [r#""D65""#, r#"{"blackbody": {"temperature": 2856}}"#] {
            let light = light_of(spectrum);
            let pieces = pieces(&light, 2.0);
            let sum: f64 = pieces.iter().map(|piece| piece.power).sum();
            assert!((sum - 1.0).abs() < 1e-9, "{sum}");
            for piece in pieces {
                let at = |offset: f64| light.spectrum.at(piece.nm + offset);
                let simpson = (at(-0.999) + 4.0 * at(0.0) + at(0.999)) / 3.0;
                assert!((piece.power / simpson - 1.0).abs() < 0.01, "{} nm: {}", piece.nm, piece.power);
            }
        }
    }

    #[test]
    fn a_line_lies_in_one_piece_with_its_power_and_its_wavelength() {
        let light = light_of(r#"{"lines": [{"nm": 435.8, "power": 1}, {"nm": 546.1, "power": 3}]}"#);
        let lit: Vec<Piece> = pieces(&light, 2.0).into_iter().filter(|piece| piece.power > 0.0).collect();
        let [blue, green] = lit[..] else { panic!("{lit:?}") };
        assert!((blue.power - 0.25).abs() < 1e-9 && (blue.nm - 435.8).abs() < 0.06, "{blue:?}");
        assert!((green.power - 0.75).abs() < 1e-9 && (green.nm - 546.1).abs() < 0.06, "{green:?}");
    }
}
