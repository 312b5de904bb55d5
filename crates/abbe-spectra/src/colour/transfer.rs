//! Transfer functions of display codes: that of the colour space, and PQ for HDR displays.

use super::by_name;
use super::space::RgbSpace;
use crate::error::Result;
use crate::math::elementary::powf;
use serde::{Deserialize, Serialize};

/// The function that encodes linear components as display codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Transfer {
    /// The function of the colour space. The component 1 is the white of the display.
    #[default]
    OfSpace,
    /// PQ (SMPTE ST 2084, ITU-R BT.2100), whose codes are absolute luminances.
    Pq,
}

/// The luminance in cd/m² at which an HDR display shows the component 1 (ITU-R BT.2408).
pub const HDR_WHITE: f64 = 203.0;

/// The luminance in cd/m² of the brightest component on an HDR display. Tone curves end there.
pub const HDR_PEAK: f64 = 1000.0;

/// The luminance in cd/m² of the largest PQ code.
const PQ_LIMIT: f64 = 10_000.0;

const M1: f64 = 2610.0 / 16_384.0;
const M2: f64 = 2523.0 / 4096.0 * 128.0;
const C1: f64 = 3424.0 / 4096.0;
const C2: f64 = 2413.0 / 4096.0 * 32.0;
const C3: f64 = 2392.0 / 4096.0 * 32.0;

impl Transfer {
    /// Returns the largest component that the display shows.
    pub fn peak(self) -> f64 {
        match self {
            Self::OfSpace => 1.0,
            Self::Pq => HDR_PEAK / HDR_WHITE,
        }
    }

    /// Encodes a linear component as a signal from 0 to 1.
    pub fn encode(self, component: f64, space: RgbSpace) -> f64 {
        match self {
            Self::OfSpace => space.encode(component),
            Self::Pq => encode_pq(component * HDR_WHITE),
        }
    }

    /// Inverts [`encode`](Self::encode).
    pub fn decode(self, signal: f64, space: RgbSpace) -> f64 {
        match self {
            Self::OfSpace => space.decode(signal),
            Self::Pq => decode_pq(signal) / HDR_WHITE,
        }
    }
}

/// The name of the output space with the primaries of Rec. 2020 and the PQ curve.
pub const REC2100_PQ: &str = "rec2100-pq";

/// Returns a colour space and a transfer function by the name of an output space (`srgb`,
/// `display-p3`, `rec2020`, `acescg` or `rec2100-pq`), or an error.
pub fn output_space_by_name(name: &str) -> Result<(RgbSpace, Transfer)> {
    let [srgb, p3, rec2020, aces] = RgbSpace::ALL.map(|space| (space.name(), (space, Transfer::OfSpace)));
    by_name("output space", name, &[srgb, p3, rec2020, aces, (REC2100_PQ, (RgbSpace::Rec2020, Transfer::Pq))])
}

/// Returns the PQ signal of a luminance in cd/m².
pub fn encode_pq(luminance: f64) -> f64 {
    let y = powf((luminance / PQ_LIMIT).clamp(0.0, 1.0), M1);
    powf((C1 + C2 * y) / (1.0 + C3 * y), M2)
}

/// Returns the luminance in cd/m² of a PQ signal.
pub fn decode_pq(signal: f64) -> f64 {
    let root = powf(signal.clamp(0.0, 1.0), 1.0 / M2);
    PQ_LIMIT * powf((root - C1).max(0.0) / (C2 - C3 * root), 1.0 / M1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Report ITU-R BT.2408 states 58 % for reference white at 203 cd/m², and 75 % for 1000 cd/m².
    #[test]
    fn pq_has_the_published_signals() {
        for (luminance, signal) in [(0.0, 7e-7), (100.0, 0.508), (203.0, 0.581), (1000.0, 0.752), (10_000.0, 1.0)] {
            assert!((encode_pq(luminance) - signal).abs() < 6e-4, "{luminance}: {}", encode_pq(luminance));
        }
    }

    #[test]
    fn decoding_inverts_pq() {
        for i in 0..=1000 {
            let luminance = 1e4 * (f64::from(i) / 1000.0).powi(3);
            assert!((decode_pq(encode_pq(luminance)) - luminance).abs() < 1e-6 * luminance.max(1e-3), "{luminance}");
        }
        assert!(
            (Transfer::Pq.decode(Transfer::Pq.encode(1.0, RgbSpace::Rec2020), RgbSpace::Rec2020) - 1.0).abs() < 1e-9
        );
    }

    #[test]
    fn output_spaces_have_names() {
        assert_eq!(output_space_by_name("rec2100-pq"), Ok((RgbSpace::Rec2020, Transfer::Pq)));
        assert_eq!(output_space_by_name("srgb"), Ok((RgbSpace::Srgb, Transfer::OfSpace)));
        assert_eq!(output_space_by_name("hlg").unwrap_err().exit_status(), 2);
    }
}
