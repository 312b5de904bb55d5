//! Colour rendition of ANSI/IES TM-30-20, whose fidelity index is the index Rf of CIE 224:2017.
//!
//! The 99 colour evaluation samples are tabulated every 5 nm, and a cubic polynomial through four
//! of these nodes interpolates a reflectance between them. Because the result is linear in the
//! reflectances at the nodes, a light is first distributed over the nodes, at which alone the
//! samples are then evaluated.

use std::sync::OnceLock;

use super::difference::delta_e_76;
use super::matrix::{Matrix3, apply, diagonal, inverse, product};
use super::rendering::RANGE_K;
use super::temperature::{CorrelatedTemperature, cct_duv};
use super::tristimulus::Xyz;
use crate::math::elementary::{atan2, cbrt, exp, hypot, ln_1p, powf, sin_cos};
use crate::spectrum::{BAND_NM, Observer, Spectrum, daylight_extended, library};
use serde::Serialize;

const SAMPLES: usize = 99;

/// The number of hue bins, which have equal angles and begin at the hue angle 0.
const HUE_BINS: usize = 16;

/// The range of wavelengths in nm, and the distance of the nodes.
const RANGE_NM: (u32, u32) = (380, 780);
const STEP_NM: u32 = 5;
const NODES: usize = ((RANGE_NM.1 - RANGE_NM.0) / STEP_NM) as usize + 1;

/// The reference is a black body up to the first temperature in K, daylight from the second on.
const MIX_K: (f64, f64) = (4000.0, 5000.0);

/// The decrease of the fidelity index for a colour difference of 1 in CAM02-UCS.
const FIDELITY_SLOPE: f64 = 6.73;

/// The colour rendition of a light, relative to a reference of the same colour temperature.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColourRendition {
    /// The fidelity index Rf, which is 100 if all samples look the same as under the reference.
    pub rf: f64,
    /// The gamut index Rg, which is above 100 if the samples look more saturated on average.
    pub rg: f64,
    /// The local fidelity index Rf,h of each hue bin.
    pub rf_bins: [f64; HUE_BINS],
    /// The local chroma shift Rcs,h of each hue bin, in percent.
    pub chroma_shift_percent: [f64; HUE_BINS],
    /// The local hue shift Rhs,h of each hue bin, positive if it is counterclockwise.
    pub hue_shift: [f64; HUE_BINS],
    /// The fidelity index of each sample.
    #[serde(skip)]
    pub samples: [f64; SAMPLES],
    /// The arrows of the colour vector graphic: from the mean a′, b′ of each hue bin under the
    /// reference, on the unit circle, to that under the light on the same scale.
    #[serde(skip)]
    pub arrows: [[[f64; 2]; 2]; HUE_BINS],
}

/// Computes the colour rendition of a light. Returns `None` if it has no correlated colour
/// temperature, if this is outside 1000–50,000 K as for [`super::cri`], or if a hue bin contains no
/// sample, as for some black bodies below 1200 K.
///
/// The light is summed from 380 to 780 nm. As in the standard, the step of the sums is that of the
/// light: 5 nm if the continuum is linear between multiples of 5 nm, and 1 nm otherwise. Peaks of
/// the continuum narrower than 5 nm are integrated, and each line is evaluated at its wavelength.
/// The same sums give the correlated colour temperature, which may thus differ slightly from that
/// of a [`super::ColourReport`].
pub fn rendition(light: &Spectrum) -> Option<ColourRendition> {
    rendition_in_steps(light, sum_step_nm(light))
}

/// Computes the same as [`rendition`], but sums both continua in steps of `step_nm`.
pub fn rendition_in_steps(light: &Spectrum, step_nm: u32) -> Option<ColourRendition> {
    let CorrelatedTemperature { cct_k, .. } = cct_duv(white(&node_weights(light, Observer::cie1931(), step_nm)))?;
    if !(RANGE_K.0..=RANGE_K.1).contains(&cct_k) {
        return None;
    }
    let of_light = node_weights(light, Observer::cie1964(), step_nm);
    let of_reference = reference_weights(cct_k, step_nm)?;
    ColourRendition::of_colours(&sample_colours(&of_light), &sample_colours(&of_reference))
}

/// The coordinates J′, a′ and b′ of all samples in CAM02-UCS.
type SampleColours = [[f64; 3]; SAMPLES];

impl ColourRendition {
    /// Computes the rendition from samples' colours, or returns `None` for an empty hue bin.
    fn of_colours(light: &SampleColours, reference: &SampleColours) -> Option<Self> {
        let mut bins = [HueBin::default(); HUE_BINS];
        let mut samples = [0.0; SAMPLES];
        let mut sum = 0.0;
        for ((sample, light), reference) in samples.iter_mut().zip(light).zip(reference) {
            let shift = delta_e_76(*light, *reference);
            (*sample, sum) = (fidelity(shift), sum + shift);
            bins[hue_bin(*reference)].add(*light, *reference, shift);
        }
        if bins.iter().any(|bin| bin.count == 0.0) {
            return None;
        }
        let bins = bins.map(HueBin::mean);
        let area = |colour: fn(&HueBin) -> [f64; 2]| polygon_area(&bins.map(|bin| colour(&bin)));
        let shifts: [[f64; 2]; HUE_BINS] = std::array::from_fn(|i| bins[i].relative_shift(i));
        Some(Self {
            rf: fidelity(sum / SAMPLES as f64),
            rg: 100.0 * area(|bin| bin.light) / area(|bin| bin.reference),
            rf_bins: bins.map(|bin| fidelity(bin.shift)),
            chroma_shift_percent: shifts.map(|[radial, _]| 100.0 * radial),
            hue_shift: shifts.map(|[_, tangential]| tangential),
            samples,
            arrows: bins.map(|bin| {
                let chroma = bin.reference_chroma();
                [bin.reference, bin.light].map(|colour| colour.map(|value| value / chroma))
            }),
        })
    }
}

/// The sums over the samples of a hue bin, or their means.
#[derive(Debug, Clone, Copy, Default)]
struct HueBin {
    count: f64,
    /// a′ and b′ under the light.
    light: [f64; 2],
    /// a′ and b′ under the reference.
    reference: [f64; 2],
    shift: f64,
}

impl HueBin {
    /// Adds a sample by its J′, a′ and b′ under the light and under the reference.
    fn add(&mut self, light: [f64; 3], reference: [f64; 3], shift: f64) {
        self.count += 1.0;
        self.shift += shift;
        let add = |sum: &mut [f64; 2], [_, a, b]: [f64; 3]| *sum = [sum[0] + a, sum[1] + b];
        add(&mut self.light, light);
        add(&mut self.reference, reference);
    }

    fn mean(self) -> Self {
        let mean = |sum: f64| sum / self.count;
        Self { count: 1.0, light: self.light.map(mean), reference: self.reference.map(mean), shift: mean(self.shift) }
    }

    fn reference_chroma(&self) -> f64 {
        hypot(self.reference[0], self.reference[1])
    }

    /// Returns the mean shift along the middle of bin `i`, and across, relative to the chroma.
    fn relative_shift(&self, i: usize) -> [f64; 2] {
        let (sin, cos) = sin_cos(bin_angle() * (i as f64 + 0.5));
        let [a, b] = [0, 1].map(|i| (self.light[i] - self.reference[i]) / self.reference_chroma());
        [a * cos + b * sin, b * cos - a * sin]
    }
}

fn bin_angle() -> f64 {
    std::f64::consts::TAU / HUE_BINS as f64
}

fn hue_bin([_, a, b]: [f64; 3]) -> usize {
    (atan2(b, a) / bin_angle()).floor().rem_euclid(HUE_BINS as f64) as usize
}

fn polygon_area(corners: &[[f64; 2]; HUE_BINS]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(from, to)| from[0] * to[1] - from[1] * to[0]).sum::<f64>()
}

/// Returns the fidelity index of a colour difference in CAM02-UCS, which is never negative.
fn fidelity(shift: f64) -> f64 {
    10.0 * ln_1p(exp(10.0 - 0.1 * FIDELITY_SLOPE * shift))
}

/// Returns the reflectances of the colour evaluation samples at the nodes.
fn samples() -> &'static [Vec<f64>] {
    static TABLE: OnceLock<[Vec<f64>; SAMPLES + 1]> = OnceLock::new();
    let table = TABLE.get_or_init(|| library::columns(include_str!("../../data/reflectance/ces_tm30_5nm.csv")));
    &table[1..]
}

/// For each node, the XYZ of a reflectance that is 1 there and 0 at all other nodes.
type NodeWeights = [Xyz; NODES];

fn sum_step_nm(light: &Spectrum) -> u32 {
    /// Deviations below this fraction of the value are rounding errors.
    const ROUNDING: f64 = 1e-9;
    let at = |nm: u32| light.continuum_at(f64::from(nm));
    let linear = (RANGE_NM.0..RANGE_NM.1).all(|nm| {
        let before = nm - nm % STEP_NM;
        let t = f64::from(nm - before) / f64::from(STEP_NM);
        let between = (1.0 - t) * at(before) + t * at(before + STEP_NM);
        (at(nm) - between).abs() <= ROUNDING * between
    });
    if linear { STEP_NM } else { 1 }
}

/// Distributes a light, summed in steps of `step_nm`, over the nodes.
fn node_weights(light: &Spectrum, observer: &Observer, step_nm: u32) -> NodeWeights {
    let mut nodes = [[0.0; 3]; NODES];
    let narrow = light.narrow_part();
    for nm in (RANGE_NM.0..=RANGE_NM.1).step_by(step_nm as usize).map(f64::from) {
        let power_per_nm = light.continuum_at(nm) - narrow.as_ref().map_or(0.0, |narrow| narrow.continuum_at(nm));
        let power = power_per_nm * f64::from(step_nm);
        distribute(&mut nodes, nm, observer.xyz_bar(nm).map(|bar| bar * power));
    }
    if let Some(narrow) = &narrow {
        for (nm, xyz) in (BAND_NM.0 as u32..).map(f64::from).zip(observer.xyz_near_each_nm(narrow)) {
            distribute(&mut nodes, nm, xyz);
        }
    }
    for line in light.line_segments() {
        let nm = line.centre();
        distribute(&mut nodes, nm, observer.xyz_bar(nm).map(|bar| bar * line.power));
    }
    nodes
}

/// Distributes the XYZ of light at one wavelength over four nodes, by the weights of Lagrange's
/// cubic interpolation. Light outside the range is left out.
fn distribute(nodes: &mut NodeWeights, nm: f64, xyz: Xyz) {
    let place = (nm - f64::from(RANGE_NM.0)) / f64::from(STEP_NM);
    if !(0.0..=(NODES - 1) as f64).contains(&place) {
        return;
    }
    let first = (place as usize).saturating_sub(1).min(NODES - 4);
    let t = place - first as f64;
    let weights = [
        (1.0 - t) * (t - 2.0) * (t - 3.0) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        t * (1.0 - t) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    ];
    for (node, weight) in nodes[first..].iter_mut().zip(weights) {
        node.iter_mut().zip(xyz).for_each(|(sum, value)| *sum += weight * value);
    }
}

/// Returns the weights of the reference illuminant, on any scale.
fn reference_weights(cct_k: f64, step_nm: u32) -> Option<NodeWeights> {
    let daylight = ((cct_k - MIX_K.0) / (MIX_K.1 - MIX_K.0)).clamp(0.0, 1.0);
    let mut nodes = [[0.0; 3]; NODES];
    let mut add = |light: &Spectrum, fraction: f64| {
        // Both parts of a mix have equal luminance before they are weighted.
        let factor = fraction / white(&node_weights(light, Observer::cie1931(), step_nm))[1];
        let weights = node_weights(light, Observer::cie1964(), step_nm);
        nodes.as_flattened_mut().iter_mut().zip(weights.as_flattened()).for_each(|(sum, of)| *sum += factor * of);
    };
    if daylight < 1.0 {
        add(&Spectrum::blackbody(cct_k).ok()?, 1.0 - daylight);
    }
    if daylight > 0.0 {
        add(&daylight_extended(cct_k), daylight);
    }
    Some(nodes)
}

/// Returns the XYZ of a reflectance with these values at the nodes.
fn total(nodes: &NodeWeights, reflectance: impl Iterator<Item = f64>) -> Xyz {
    let mut sum = [0.0; 3];
    for (node, value) in nodes.iter().zip(reflectance) {
        sum.iter_mut().zip(node).for_each(|(sum, node)| *sum += value * node);
    }
    sum
}

fn white(nodes: &NodeWeights) -> Xyz {
    total(nodes, std::iter::repeat(1.0))
}

fn sample_colours(nodes: &NodeWeights) -> SampleColours {
    let appearance = ColourAppearance::new(white(nodes));
    let samples = samples();
    std::array::from_fn(|i| appearance.cam02_ucs(total(nodes, samples[i].iter().copied())))
}

/// CIECAM02 with the viewing conditions of TM-30: an adapting luminance of 100 cd/m², a background
/// of 20 % of the luminance of white, an average surround, and complete adaptation to the light.
struct ColourAppearance {
    /// The matrix from XYZ to the adapted cone responses.
    cones: Matrix3,
    /// The achromatic response to white.
    white: f64,
}

const CAT02: Matrix3 = [[0.7328, 0.4296, -0.1624], [-0.7036, 1.6975, 0.0061], [0.0030, 0.0136, 0.9834]];
const HUNT_POINTER_ESTEVEZ: Matrix3 =
    [[0.389_71, 0.688_98, -0.078_68], [-0.229_81, 1.183_40, 0.046_41], [0.0, 0.0, 1.0]];
const CAT02_TO_CONES: Matrix3 = product(&HUNT_POINTER_ESTEVEZ, &inverse(&CAT02));

const ADAPTING_LUMINANCE: f64 = 100.0;
/// The luminance of the background divided by the luminance of white.
const BACKGROUND: f64 = 0.2;
/// The impact of an average surround, and its factor of chromatic induction.
const SURROUND_IMPACT: f64 = 0.69;
const CHROMATIC_INDUCTION: f64 = 1.0;

impl ColourAppearance {
    fn new(white: Xyz) -> Self {
        let seen = apply(&CAT02, white);
        let scale = diagonal(seen.map(|response| 100.0 / response));
        let cones = product(&CAT02_TO_CONES, &product(&scale, &CAT02));
        let mut appearance = Self { cones, white: 1.0 };
        appearance.white = achromatic(appearance.compressed(white));
        appearance
    }

    fn compressed(&self, xyz: Xyz) -> [f64; 3] {
        let factor = luminance_adaptation();
        apply(&self.cones, xyz).map(|response| {
            let power = powf(0.01 * factor * response.abs(), 0.42);
            (400.0 * power / (27.13 + power)).copysign(response) + 0.1
        })
    }

    fn cam02_ucs(&self, xyz: Xyz) -> [f64; 3] {
        let responses @ [red, green, blue] = self.compressed(xyz);
        let a = red - (12.0 * green - blue) / 11.0;
        let b = (red + green - 2.0 * blue) / 9.0;
        let ratio = (achromatic(responses) / self.white).max(0.0);
        let lightness = 100.0 * powf(ratio, SURROUND_IMPACT * (1.48 + BACKGROUND.sqrt()));
        let (sin, cos) = sin_cos(atan2(b, a));
        // cos(h + 2 rad) without a second angle.
        let (sin_2, cos_2) = sin_cos(2.0);
        let eccentricity = 0.25 * (cos * cos_2 - sin * sin_2 + 3.8);
        let t = 50_000.0 / 13.0 * CHROMATIC_INDUCTION * induction() * eccentricity * hypot(a, b)
            / (red + green + 1.05 * blue);
        let chroma = powf(t.max(0.0), 0.9) * (0.01 * lightness).sqrt() * powf(1.64 - powf(0.29, BACKGROUND), 0.73);
        let colourfulness = chroma * luminance_adaptation().sqrt().sqrt();
        let compressed = ln_1p(0.0228 * colourfulness) / 0.0228;
        [1.7 * lightness / (1.0 + 0.007 * lightness), compressed * cos, compressed * sin]
    }
}

/// The factor F_L of luminance adaptation.
fn luminance_adaptation() -> f64 {
    let k4 = (1.0 / (5.0 * ADAPTING_LUMINANCE + 1.0)).powi(4);
    k4 * ADAPTING_LUMINANCE + 0.1 * (1.0 - k4).powi(2) * cbrt(5.0 * ADAPTING_LUMINANCE)
}

/// The factors N_bb and N_cb of induction by the background.
fn induction() -> f64 {
    0.725 * powf(1.0 / BACKGROUND, 0.2)
}

fn achromatic([red, green, blue]: [f64; 3]) -> f64 {
    (2.0 * red + green + blue / 20.0 - 0.305) * induction()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{Outside, SpectralLine};

    #[test]
    fn bins_average_the_samples_of_the_reference_hue() {
        // Sample i lies in bin i % 16, in its middle, with chroma 10 under the reference. Under the
        // light, the chroma is 12 for bin 0, and the samples of bin 1 move into bin 2.
        let polar = |chroma: f64, bin: f64| {
            let (sin, cos) = sin_cos(bin_angle() * (bin + 0.5));
            [50.0, chroma * cos, chroma * sin]
        };
        let reference = std::array::from_fn(|i| polar(10.0, (i % HUE_BINS) as f64));
        let light = std::array::from_fn(|i| match i % HUE_BINS {
            0 => polar(12.0, 0.0),
            1 => polar(10.0, 2.0),
            bin => polar(10.0, bin as f64),
        });
        let found = ColourRendition::of_colours(&light, &reference).unwrap();
        let chord = 20.0 * sin_cos(0.5 * bin_angle()).0;
        let near = |value: f64, known: f64| assert!((value - known).abs() < 1e-9, "{value} {known}");
        near(found.rf_bins[0], fidelity(2.0));
        near(found.rf_bins[1], fidelity(chord));
        near(found.rf_bins[2], fidelity(0.0));
        near(found.chroma_shift_percent[0], 20.0);
        near(found.hue_shift[0], 0.0);
        near(found.chroma_shift_percent[1], 100.0 * (sin_cos(bin_angle()).1 - 1.0));
        near(found.hue_shift[1], sin_cos(bin_angle()).0);
        near(found.chroma_shift_percent[2], 0.0);
        // 99 samples: seven in each of the bins 0 to 2, and six in each other bin.
        near(found.rf, fidelity((7.0 * 2.0 + 7.0 * chord) / 99.0));
        near(found.samples[17], fidelity(chord));
        // Of 16 equal triangles, one becomes 1.2 times as large, and one has no area. That between
        // bins 0 and 1 has twice the angle and 1.2 times the product of its sides.
        let sin = |bins: f64| sin_cos(bins * bin_angle()).0;
        near(found.rg, 100.0 * (13.0 * sin(1.0) + 1.2 * sin(1.0) + 1.2 * sin(2.0)) / (16.0 * sin(1.0)));
        near(hypot(found.arrows[5][0][0], found.arrows[5][0][1]), 1.0);
        assert_eq!(found.arrows[5][0], found.arrows[5][1]);
    }

    #[test]
    fn an_empty_hue_bin_has_no_rendition() {
        let red = [[50.0, 10.0, 1.0]; SAMPLES];
        assert_eq!(ColourRendition::of_colours(&red, &red), None);
    }

    /// The sums of TM-30 lack the light of a black body of 1200 K above 780 nm, which is a large
    /// part of it, so its correlated colour temperature is slightly wrong.
    #[test]
    fn a_reference_illuminant_has_the_indices_100() {
        let found = rendition(&Spectrum::blackbody(1200.0).unwrap()).unwrap();
        assert!((found.rf - 100.0).abs() < 0.02 && (found.rg - 100.0).abs() < 0.03, "{found:?}");
        for cct_k in [2000.0, 2856.0, 3999.0, 5001.0, 6504.0, 10_000.0, 20_000.0] {
            let light = if cct_k < 4500.0 { Spectrum::blackbody(cct_k).unwrap() } else { daylight_extended(cct_k) };
            let found = rendition(&light).unwrap();
            assert!((found.rf - 100.0).abs() < 0.01 && (found.rg - 100.0).abs() < 0.01, "{cct_k}: {found:?}");
            assert!(found.samples.iter().all(|sample| *sample > 99.9), "{cct_k}: {found:?}");
        }
    }

    /// A comb of narrow teeth is a narrow part with many knots.
    #[test]
    fn the_light_near_each_nm_adds_up() {
        let nm: Vec<f64> = (0..=4700).map(|i| 360.0 + 0.1 * f64::from(i)).collect();
        let values: Vec<f64> = (0..=4700).map(|i| f64::from(i % 7) + 0.001 * f64::from(i)).collect();
        let comb = Spectrum::table(&nm, &values, Outside::Zero).unwrap();
        for observer in [Observer::cie1931(), Observer::cie1964()] {
            let near = observer.xyz_near_each_nm(&comb);
            let whole = observer.xyz(&comb);
            for (c, whole) in whole.iter().enumerate() {
                let sum: f64 = near.iter().map(|xyz| xyz[c]).sum();
                assert!((sum / whole - 1.0).abs() < 1e-12, "{sum} for {whole}");
            }
            for at in [437, 438, 555] {
                let at_nm = f64::from(at);
                let triangle = [at_nm - 1.0, at_nm, at_nm + 1.0];
                let triangle = Spectrum::table(&triangle, &[0.0, 1.0, 0.0], Outside::Zero).unwrap();
                for (one, expected) in near[at as usize - 360].iter().zip(observer.xyz_under(&triangle, &comb)) {
                    assert!((one - expected).abs() <= 1e-12 * expected, "{one} for {expected}");
                }
            }
        }
    }

    #[test]
    fn narrow_peaks_equal_lines() {
        let light = |fwhm_nm: Option<f64>| {
            let line = |nm, power| SpectralLine { nm, power, fwhm_nm };
            Spectrum::lines(&[line(450.3, 0.8), line(533.0, 1.0), line(612.4, 1.3)]).unwrap()
        };
        let (lines, peaks) = (rendition(&light(None)).unwrap(), rendition(&light(Some(0.3))).unwrap());
        assert!((lines.rf - peaks.rf).abs() < 0.1 && (lines.rg - peaks.rg).abs() < 0.1, "{lines:?} {peaks:?}");
    }
}
