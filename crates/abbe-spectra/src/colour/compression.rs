//! Chroma compression: brings spectral colours into the gamut of a display and keeps their order.
//!
//! The saturation of a colour is its Oklab chroma divided by its Oklab lightness. It does not
//! depend on the brightness, and neither does the largest saturation of a hue without negative
//! components, which is the edge of the gamut. The compression changes only the saturation: the
//! Oklab hue and the luminance stay.
//!
//! If each colour moved to the edge of the gamut, a spectrum would be a walk along this edge, with
//! bright stripes at the corners (the primaries). The compression therefore aims at a rounded edge,
//! the edge as it is after a smoothing over the hues.

use std::sync::OnceLock;

use super::coordinates::{from_oklab, oklab};
use super::matrix::{Matrix3, apply, dot, inverse};
use super::space::RgbSpace;
use super::tristimulus::{Rgb, Xyz};
use crate::math::elementary::{atan2, exp, hypot};
use crate::spectrum::Observer;

/// The number of hues in the tables, with linear interpolation between them. A multiple of 4.
const HUES: usize = 512;

/// The standard deviation in degrees of hue of the smoothing that rounds the corners: enough for a
/// spectrum without stripes, and narrow enough to keep most of the chroma of green and red.
const ROUNDING_DEGREES: f64 = 8.0;

/// The power of the mean that rounds the corners. Its negative sign favours the smaller values.
const ROUNDING_POWER: i32 = -4;

/// Saturations below this fraction of the largest shown one do not change.
const KNEE: f64 = 0.7;

/// The distance from the edge of the gamut to the spectral locus is at least this fraction of the
/// saturation at the edge, so that the reach is defined where the locus touches the gamut.
const LEAST_MARGIN: f64 = 0.1;

/// The wavelengths in nm between which the spectral locus is tabulated. Beyond them, the
/// chromaticity hardly changes.
const LOCUS_NM: (u32, u32) = (380, 700);

/// The steps of the line of purples, which joins the ends of the spectral locus.
const PURPLES: u32 = 64;

/// The edge and the rounded edge of a gamut.
type Edges = OnceLock<(Vec<f64>, Vec<f64>)>;

static SRGB: Edges = OnceLock::new();
static DISPLAY_P3: Edges = OnceLock::new();
static REC2020: Edges = OnceLock::new();
static ACES_CG: Edges = OnceLock::new();

/// The largest saturations of each hue, for a display and a white balance.
#[derive(Debug, Clone, PartialEq)]
pub struct HueLimits {
    to_d65: Matrix3,
    from_d65: Matrix3,
    luminance_weights: [f64; 3],
    /// The saturation at the edge of the gamut.
    pub edge: Vec<f64>,
    /// The saturation at the edge with rounded corners, at most that of the edge.
    pub rounded: Vec<f64>,
    /// The saturation of the spectral locus or of the line of purples, beyond the edge.
    pub locus: Vec<f64>,
}

impl HueLimits {
    /// Tabulates the limits for a display. `matrix` converts XYZ to its linear components and
    /// includes the white balance.
    pub fn new(space: RgbSpace, matrix: &[[f64; 3]; 3]) -> Self {
        let from_d65 = space.picture_matrix();
        let mut limits = Self {
            to_d65: inverse(&from_d65),
            from_d65,
            luminance_weights: space.luminance_weights(),
            edge: Vec::new(),
            rounded: Vec::new(),
            locus: Vec::new(),
        };
        let tables = match space {
            RgbSpace::Srgb => &SRGB,
            RgbSpace::DisplayP3 => &DISPLAY_P3,
            RgbSpace::Rec2020 => &REC2020,
            RgbSpace::AcesCg => &ACES_CG,
        };
        // The white balance moves the locus, but not the edge of the gamut.
        let (edge, rounded) = tables.get_or_init(|| {
            let edge: Vec<f64> = (0..HUES).map(|hue| limits.edge_at(direction(hue))).collect();
            let rounded = rounded(&edge);
            (limits.with_corners(edge), rounded)
        });
        limits.edge.clone_from(edge);
        limits.rounded.clone_from(rounded);
        limits.locus = limits.locus_of(matrix);
        limits
    }

    /// Returns the largest saturation in a direction of the plane of Oklab a, b at which no
    /// component is negative.
    fn edge_at(&self, [a, b]: [f64; 2]) -> f64 {
        const STEP: f64 = 1.0 / 64.0;
        let is_inside = |saturation: f64| {
            apply(&self.from_d65, from_oklab([1.0, saturation * a, saturation * b])).iter().all(|c| *c >= 0.0)
        };
        // No display shows a saturation of 4.
        let first = (1..256).map(|step| STEP * f64::from(step)).find(|&saturation| !is_inside(saturation));
        let (mut inside, mut outside) = first.map_or((4.0, 4.0), |outside| (outside - STEP, outside));
        for _ in 0..40 {
            let middle = 0.5 * (inside + outside);
            if is_inside(middle) { inside = middle } else { outside = middle }
        }
        inside
    }

    /// Raises the two nodes beside each primary to its saturation, so that the interpolated edge
    /// does not cut off the corners of the gamut.
    fn with_corners(&self, mut edge: Vec<f64>) -> Vec<f64> {
        for primary in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let Some((_, [_, saturation], place)) = self.saturation(primary) else { continue };
            for node in [place as usize, place as usize + 1] {
                edge[node % HUES] = edge[node % HUES].max(saturation);
            }
        }
        edge
    }

    /// Returns the saturation of the locus at each hue, at least that of the edge and a margin.
    fn locus_of(&self, matrix: &Matrix3) -> Vec<f64> {
        let observer = Observer::cie1931();
        let spectral = (LOCUS_NM.0..=LOCUS_NM.1).map(|nm| observer.xyz_bar(f64::from(nm)));
        let ends = [LOCUS_NM.1, LOCUS_NM.0].map(|nm| {
            let xyz = observer.xyz_bar(f64::from(nm));
            xyz.map(|value| value / (xyz[0] + xyz[1] + xyz[2]))
        });
        let purples = (1..=PURPLES).map(|step| {
            let fraction = f64::from(step) / f64::from(PURPLES);
            std::array::from_fn(|i| (1.0 - fraction) * ends[0][i] + fraction * ends[1][i])
        });
        let mut locus: Vec<f64> = self.edge.iter().map(|edge| (1.0 + LEAST_MARGIN) * edge).collect();
        let colours: Vec<(f64, f64)> = spectral
            .chain(purples)
            .filter_map(|xyz: Xyz| {
                let [lightness, a, b] = oklab(apply(&self.to_d65, apply(matrix, xyz)));
                (lightness > 0.0 && (a != 0.0 || b != 0.0)).then(|| (place(a, b), hypot(a, b) / lightness))
            })
            .collect();
        for pair in colours.windows(2) {
            let [(from, first), (to, second)] = [pair[0], pair[1]];
            let way = (to - from + 1.5 * HUES as f64).rem_euclid(HUES as f64) - 0.5 * HUES as f64;
            let (low, high) = if way < 0.0 { (from + way, from) } else { (from, from + way) };
            for node in low.ceil() as i64..=high.floor() as i64 {
                let fraction = if way == 0.0 { 0.0 } else { (node as f64 - from) / way };
                let known = &mut locus[node.rem_euclid(HUES as i64) as usize];
                *known = known.max(first + fraction * (second - first));
            }
        }
        locus
    }

    /// Returns how far linear components are beyond the gamut: 0 at the edge of the gamut or
    /// inside, and 1 at the spectral locus or beyond. Brightness has no influence.
    pub fn reach(&self, rgb: Rgb) -> f64 {
        // Rounding makes the components of colours at the edge slightly negative.
        const ROUNDING: f64 = 1e-6;
        let largest = rgb.into_iter().fold(0.0, f64::max);
        if rgb.iter().all(|component| *component >= -ROUNDING * largest) {
            return 0.0;
        }
        let Some((_, [_, saturation], place)) = self.saturation(rgb) else { return 0.0 };
        let (edge, locus) = (at(&self.edge, place), at(&self.locus, place));
        ((saturation - edge) / (locus - edge)).clamp(0.0, 1.0)
    }

    /// Returns the Oklab coordinates of a colour, its lightness and saturation, and the place of
    /// its hue in the tables. Returns `None` for neutral, black and impossible colours.
    fn saturation(&self, rgb: Rgb) -> Option<([f64; 3], [f64; 2], f64)> {
        let [lightness, a, b] = oklab(apply(&self.to_d65, rgb));
        let saturation = hypot(a, b) / lightness;
        (lightness > 0.0 && saturation > 0.0 && saturation.is_finite())
            .then(|| ([lightness, a, b], [lightness, saturation], place(a, b)))
    }
}

/// The compression of the colours of one picture, whose most saturated colours reach a certain
/// fraction of the way from the edge of the gamut to the spectral locus.
#[derive(Debug, Clone)]
pub struct ChromaCompression {
    limits: HueLimits,
    /// The saturation below which colours do not change.
    knee: Vec<f64>,
    /// The curvature above the knee: an excess d over the knee becomes d / (1 + bend · d).
    bend: Vec<f64>,
}

impl ChromaCompression {
    /// Prepares the compression. With the reach 0, no colour in the gamut changes. With the reach
    /// 1, the spectral locus becomes the rounded edge of the gamut.
    pub fn new(limits: HueLimits, reach: f64) -> Self {
        let mut knees = Vec::with_capacity(HUES);
        let mut bends = Vec::with_capacity(HUES);
        for ((edge, rounded), locus) in limits.edge.iter().zip(&limits.rounded).zip(&limits.locus) {
            let farthest = edge + reach * (locus - edge);
            let shown = edge - reach * (edge - rounded);
            let knee = KNEE * shown;
            knees.push(knee);
            // The curve has the slope 1 at the knee and maps `farthest` to `shown`.
            bends.push((farthest - shown) / ((shown - knee) * (farthest - knee)));
        }
        Self { limits, knee: knees, bend: bends }
    }

    /// Reduces the saturation of linear components of any brightness. The result has no negative
    /// components, apart from rounding and if the luminance is positive. Components above 1 remain.
    #[inline]
    pub fn apply(&self, rgb: Rgb) -> Rgb {
        let limits = &self.limits;
        let luminance = dot(limits.luminance_weights, rgb);
        let Some(([lightness, a, b], [_, saturation], place)) = limits.saturation(rgb) else { return rgb };
        let excess = saturation - at(&self.knee, place);
        if excess <= 0.0 || luminance.is_nan() || luminance <= 0.0 {
            return rgb;
        }
        let reduced = saturation - excess + excess / (1.0 + at(&self.bend, place) * excess);
        let fraction = reduced.min(at(&limits.edge, place)) / saturation;
        let mapped = apply(&limits.from_d65, from_oklab([lightness, fraction * a, fraction * b]));
        let scale = luminance / dot(limits.luminance_weights, mapped);
        mapped.map(|component| component * scale)
    }
}

/// Returns the edge with rounded corners: a power mean over the neighbouring hues that favours
/// small values, scaled so that it never exceeds the edge.
fn rounded(edge: &[f64]) -> Vec<f64> {
    let degrees: Vec<f64> = (0..HUES).map(direction).map(|[a, b]| atan2(b, a).to_degrees()).collect();
    let mean = |centre: usize| {
        let (mut sum, mut weights) = (0.0, 0.0);
        // A quarter of the nodes on each side covers 90°.
        for node in (centre + HUES - HUES / 4..=centre + HUES + HUES / 4).map(|node| node % HUES) {
            let distance = (degrees[node] - degrees[centre] + 540.0).rem_euclid(360.0) - 180.0;
            // The nodes are not equally spaced in degrees.
            let spacing = (degrees[(node + 1) % HUES] - degrees[node]).rem_euclid(360.0);
            let weight = spacing * exp(-0.5 * (distance / ROUNDING_DEGREES).powi(2));
            sum += weight * edge[node].powi(ROUNDING_POWER);
            weights += weight;
        }
        (weights / sum).sqrt().sqrt()
    };
    let means: Vec<f64> = (0..HUES).map(mean).collect();
    let scale = edge.iter().zip(&means).map(|(edge, mean)| edge / mean).fold(1.0, f64::min);
    means.iter().map(|mean| scale * mean).collect()
}

/// Returns the place of a hue in the tables, from 0 to [`HUES`]. It grows with the hue angle, and
/// needs no trigonometric function: each quadrant is linear along the line that joins its axes.
#[inline]
fn place(a: f64, b: f64) -> f64 {
    let quarter = match (a >= 0.0, b >= 0.0) {
        (true, true) => b / (a + b),
        (false, true) => 1.0 + a / (a - b),
        (false, false) => 2.0 + b / (a + b),
        (true, false) => 3.0 + a / (a - b),
    };
    quarter * (HUES / 4) as f64
}

/// Returns the unit vector in the plane of Oklab a, b of a node of the tables. It inverts
/// [`place`].
fn direction(node: usize) -> [f64; 2] {
    let (quarter, rest) = (node / (HUES / 4), node % (HUES / 4));
    let y = rest as f64 / (HUES / 4) as f64;
    let (x, length) = (1.0 - y, hypot(1.0 - y, y));
    let turned = match quarter {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    };
    turned.map(|coordinate| coordinate / length)
}

/// Interpolates a table of hues linearly.
#[inline]
fn at(table: &[f64], place: f64) -> f64 {
    let node = place as usize;
    let fraction = place - node as f64;
    let (from, to) = (table[node % HUES], table[(node + 1) % HUES]);
    from + fraction * (to - from)
}

#[cfg(test)]
mod tests;
