//! The spectra of an emitter, and factors that convert intensities to cd.

use super::grid::DirectedValue;
use super::xml::{self, Places};
use crate::luminaire::number::PlacedValue;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer, Outside, Spectrum};
use roxmltree::Node;

/// The samples of the spectral power of an emitter.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SpectralPower {
    /// Pairs of the wavelength in nm and the power per nm, by the wavelength.
    samples: Vec<(f64, f64)>,
    pub(super) spectrum: Spectrum,
}

impl SpectralPower {
    /// Reads `SpectralData`. The elements `EmitterSpectral` of a tunable emitter are added with
    /// their multipliers and those of the channels of the same name.
    pub(super) fn of(emitter: Node<'_, '_>) -> Result<Option<Self>> {
        let Some(data) = xml::child(emitter, "SpectralData") else { return Ok(None) };
        let mut parts = Vec::new();
        for node in xml::few(data, "EmitterSpectral")? {
            let factor = xml::factor_in(node, "Multiplier")? * channel(emitter, node)?;
            parts.push((factor, Self::of_part(node)?));
        }
        let mut nm: Vec<f64> = parts.iter().flat_map(|(_, part)| part.samples.iter().map(|(nm, _)| *nm)).collect();
        nm.sort_by(f64::total_cmp);
        nm.dedup();
        let value = |nm: f64| parts.iter().map(|(factor, part)| factor * part.at(nm)).sum::<f64>();
        let samples: Vec<(f64, f64)> = nm.into_iter().map(|nm| (nm, value(nm))).collect();
        if samples.is_empty() {
            return Ok(None);
        }
        let spectrum = Spectrum::mix(&parts.iter().map(|(factor, part)| (*factor, &part.spectrum)).collect::<Vec<_>>());
        if spectrum.integral() <= 0.0 {
            let error = Error::input("a spectrum without power within 360–830 nm");
            return Err(xml::at(data, error.expected("spectral power in the visible band")));
        }
        Ok(Some(Self { samples, spectrum }))
    }

    fn of_part(node: Node<'_, '_>) -> Result<Self> {
        let mut places = Places::new(node.document().input_text());
        let mut samples = Vec::new();
        for data in xml::children(node, "PwrData") {
            let (line, column) = places.of(data);
            let missing = || Error::input("a power without w=\"…\"").expected("a wavelength in nm").at(line, column);
            let nm = PlacedValue::parse(data.attribute("w").ok_or_else(missing)?.trim(), "a wavelength", line, column)?;
            let value = PlacedValue::parse(data.text().unwrap_or("").trim(), "a spectral power", line, column)?;
            if samples.last().is_some_and(|(before, _)| nm.value <= *before) {
                return Err(nm.wrong("a wavelength", "wavelengths in ascending order"));
            }
            if nm.value <= 0.0 {
                return Err(nm.wrong("a wavelength", "a number of nm above 0"));
            }
            samples.push((nm.value, value.not_negative("a spectral power")?));
        }
        if let Some(count) = xml::number_in(node, "NumberWavelength")?
            && count.value != samples.len() as f64
        {
            return Err(count.wrong("<NumberWavelength>", &format!("{}, the number of powers", samples.len())));
        }
        let spectrum = table(&samples).map_err(|error| xml::at(node, error))?;
        Ok(Self { samples, spectrum })
    }

    fn at(&self, nm: f64) -> f64 {
        let after = self.samples.partition_point(|(sample, _)| *sample < nm);
        match (after.checked_sub(1).map(|before| self.samples[before]), self.samples.get(after)) {
            (_, Some((exact, value))) if *exact == nm => *value,
            (Some((from, low)), Some((to, high))) => low + (nm - from) / (to - from) * (high - low),
            (None, _) | (_, None) => 0.0,
        }
    }

    /// Returns the luminous flux in lm of the spectrum per power in W between two wavelengths, or
    /// per flux of photons in µmol/s. Returns `None` if the spectrum has no power there.
    pub(super) fn lumens_per_unit(&self, (from, to): (f64, f64), is_photons: bool) -> Option<f64> {
        // Beyond its ends, the spectrum is 0.
        let (from, to) = (from.max(self.samples.first()?.0), to.min(self.samples.last()?.0));
        if from >= to {
            return None;
        }
        let inside = self.samples.iter().map(|(nm, _)| *nm).filter(|nm| *nm > from && *nm < to);
        let nm: Vec<f64> = std::iter::once(from).chain(inside).chain([to]).collect();
        // Photons per energy rise with the wavelength: N = E λ / (h c N_A).
        let density = |nm: f64| self.at(nm) * if is_photons { nm * MICROMOLES_PER_JOULE_AND_NM } else { 1.0 };
        let pieces = nm.windows(2).map(|pair| {
            let middle = density(0.5 * (pair[0] + pair[1]));
            (pair[1] - pair[0]) / 6.0 * (density(pair[0]) + 4.0 * middle + density(pair[1]))
        });
        let amount: f64 = pieces.sum();
        let lumens = LUMENS_PER_WATT * Observer::cie1931().xyz(&self.spectrum)[1];
        (amount > 0.0 && amount.is_finite()).then(|| lumens / amount)
    }
}

/// 10⁶ / (h c N_A) in µmol/J per nm, with the exact constants of the SI.
const MICROMOLES_PER_JOULE_AND_NM: f64 = 1e-9 * 1e6 / (6.626_070_15e-34 * 299_792_458.0 * 6.022_140_76e23);

/// Returns the spectrum that interpolates samples. Beyond its ends it is 0.
pub(super) fn table(samples: &[(f64, f64)]) -> Result<Spectrum> {
    let (nm, values): (Vec<f64>, Vec<f64>) = samples.iter().copied().unzip();
    Spectrum::table(&nm, &values, Outside::Zero)
}

/// Returns the multiplier of the channel of an emitter with the name of a spectrum, by default 1.
fn channel(emitter: Node<'_, '_>, spectrum: Node<'_, '_>) -> Result<f64> {
    let Some(name) = xml::child(spectrum, "EmitterName").and_then(|name| name.text()) else { return Ok(1.0) };
    let channels = xml::children(emitter, "Channels").flat_map(|channels| xml::children(channels, "ChannelMult"));
    let mut same = channels.filter(|channel| channel.attribute("name").is_some_and(|own| own.trim() == name.trim()));
    same.next().map_or(Ok(1.0), |channel| xml::number(channel)?.not_negative("<ChannelMult>"))
}

/// Returns the factor with which a spectral intensity at each wavelength contributes to cd: the
/// integral of the linear interpolation between the wavelengths, weighted with 683 V(λ).
pub(super) fn luminous_weights(nm: &[f64]) -> Result<Vec<f64>> {
    let weight = |index: usize| {
        let hat: Vec<(f64, f64)> =
            nm.iter().enumerate().map(|(i, nm)| (*nm, f64::from(u8::from(i == index)))).collect();
        let near = &hat[index.saturating_sub(1)..(index + 2).min(hat.len())];
        Ok(LUMENS_PER_WATT * Observer::cie1931().xyz(&table(near)?)[1])
    };
    (0..nm.len()).map(weight).collect()
}

/// Splits the values of a spectral table by their wavelengths, which ascend in the result.
pub(super) fn by_wavelength(mut values: Vec<DirectedValue>) -> Vec<(f64, Vec<DirectedValue>)> {
    values.sort_by(|a, b| a.wavelength_nm.total_cmp(&b.wavelength_nm));
    let groups = values.chunk_by(|a, b| a.wavelength_nm == b.wavelength_nm);
    groups.map(|group| (group[0].wavelength_nm, group.to_vec())).collect()
}
