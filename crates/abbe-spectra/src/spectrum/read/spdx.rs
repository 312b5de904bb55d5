//! IES TM-27: spectral data as XML (ANSI/IES TM-27-14 and TM-27-20, *Standard Format for the
//! Electronic Transfer of Spectral Data*).
//!
//! The element `SpectralDistribution` contains one element `SpectralData` per sample, whose
//! attribute `wavelength` is in nm and whose text is the value. `SpectralQuantity` names the
//! measured quantity.
//!
//! The spectrum of a luminaire file of IES TM-33 is read as well: the element `EmitterSpectral`,
//! which contains one element `PwrData` per sample with the attribute `w`.

use roxmltree::{Document, Node};

use super::spectrum_samples::{PlacedNumber, SpectrumSamples};
use crate::error::{Error, Result};
use crate::spectrum::library::SpectrumKind;

/// Parses the samples of a TM-27 document. Returns an error with the line and the column if the
/// text is not well-formed XML, contains no spectral data, or contains invalid samples.
pub fn parse(text: &str) -> Result<SpectrumSamples> {
    let document = Document::parse(text).map_err(|error| {
        let place = error.pos();
        Error::input(format!("invalid XML: {error}")).at(place.row as usize, place.col as usize)
    })?;
    let root = document.root_element();
    if root.tag_name().name().starts_with("IESTM33") {
        return luminaire(root);
    }
    let distribution = child(root, "SpectralDistribution").ok_or_else(|| {
        let (line, column) = place(root);
        let what = format!("<{}> without <SpectralDistribution>", root.tag_name().name());
        Error::input(what).expected("an IES TM-27 document").at(line, column)
    })?;
    let data = distribution.children().filter(|node| node.tag_name().name() == "SpectralData");
    let samples = data.map(|node| sample(node, "wavelength")).collect::<Result<Vec<_>>>()?;
    SpectrumSamples::checked(&samples, child(distribution, "SpectralQuantity").and_then(|node| kind_of(node.text()?)))
}

/// Returns the spectrum of a luminaire of TM-33 with one spectrum.
fn luminaire(root: Node<'_, '_>) -> Result<SpectrumSamples> {
    let spectra: Vec<Node<'_, '_>> =
        root.descendants().filter(|node| node.tag_name().name() == "EmitterSpectral").take(2).collect();
    let [spectrum] = spectra[..] else {
        let (what, at) = match spectra.last() {
            Some(second) => ("a luminaire with several spectra", *second),
            None => ("a luminaire without a spectrum", root),
        };
        let (line, column) = place(at);
        return Err(Error::input(what).expected("one element <EmitterSpectral>").at(line, column));
    };
    let data = spectrum.children().filter(|node| node.tag_name().name() == "PwrData");
    SpectrumSamples::checked(
        &data.map(|node| sample(node, "w")).collect::<Result<Vec<_>>>()?,
        Some(SpectrumKind::Light),
    )
}

fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|child| child.tag_name().name() == name)
}

fn place(node: Node<'_, '_>) -> (usize, usize) {
    let place = node.document().text_pos_at(node.range().start);
    (place.row as usize, place.col as usize)
}

fn sample(node: Node<'_, '_>, wavelength: &str) -> Result<(PlacedNumber, PlacedNumber)> {
    let (line, column) = place(node);
    let number = |text: &str| {
        text.trim()
            .parse::<f64>()
            .map_err(|_| Error::input(format!("\"{text}\"")).expected("a number").at(line, column))
    };
    let Some(nm) = node.attribute(wavelength) else {
        let expected = format!("{wavelength}=\"…\" in nm");
        return Err(Error::input("a sample without a wavelength").expected(expected).at(line, column));
    };
    Ok(((number(nm)?, (line, column)), (number(node.text().unwrap_or(""))?, (line, column))))
}

/// Absorptance and unknown quantities have no kind.
fn kind_of(quantity: &str) -> Option<SpectrumKind> {
    match quantity.trim().to_ascii_lowercase().as_str() {
        "flux" | "intensity" | "irradiance" | "radiance" | "exitance" | "relative" => Some(SpectrumKind::Light),
        "reflectance" | "r-factor" => Some(SpectrumKind::Reflectance),
        "transmittance" | "t-factor" => Some(SpectrumKind::Transmittance),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAMP: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<IESTM2714 xmlns="http://www.ies.org/iestm2714" version="1.0">
  <Header><Description>A lamp</Description></Header>
  <SpectralDistribution>
    <SpectralQuantity>relative</SpectralQuantity>
    <SpectralData wavelength="400.0">0.034</SpectralData>
    <SpectralData wavelength="403.1">0.037</SpectralData>
    <SpectralData wavelength="405.5"> 1e-1 </SpectralData>
  </SpectralDistribution>
</IESTM2714>"#;

    #[test]
    fn irregular_samples_and_their_kind_are_read() {
        let samples = parse(LAMP).unwrap();
        assert_eq!(samples.nm, [400.0, 403.1, 405.5]);
        assert_eq!(samples.values, [0.034, 0.037, 0.1]);
        assert_eq!(samples.kind, Some(SpectrumKind::Light));
    }

    #[test]
    fn the_spectrum_of_a_luminaire_is_read() {
        let lamp = "<IESTM33>\n<Emitter>\n<SpectralData><EmitterSpectral>\n<PwrData w=\"400\">1</PwrData>\n\
                    <PwrData w=\"500\">3</PwrData></EmitterSpectral></SpectralData></Emitter></IESTM33>";
        let samples = parse(lamp).unwrap();
        assert_eq!((samples.nm, samples.values), (vec![400.0, 500.0], vec![1.0, 3.0]));
        let end = "</EmitterSpectral>";
        for (changed, place, word) in [
            (lamp.replace("w=\"500\"", ""), (5, 1), "w=\"…\""),
            (lamp.replace("500", "300"), (5, 1), "ascending"),
            (lamp.replace("EmitterSpectral", "Spectral"), (1, 1), "without a spectrum"),
            (lamp.replace(end, &format!("{end}\n<EmitterSpectral/>")), (6, 1), "several spectra"),
        ] {
            let error = parse(&changed).unwrap_err();
            assert_eq!(error.location.line_column, Some(place), "{error}");
            assert!(error.to_string().contains(word), "{word}: {error}");
        }
    }

    #[test]
    fn errors_name_line_and_column() {
        for (from, to, place, word) in [
            ("403.1", "399", Some((7, 5)), "ascending"),
            ("403.1", "400.0", Some((7, 5)), "twice"),
            ("403.1", "nan", Some((7, 5)), "NaN"),
            ("405.5", "2e6", Some((8, 5)), "wavelengths from 10"),
            ("0.037", "NaN", Some((7, 5)), "NaN"),
            ("0.037", "-1", Some((7, 5)), "negative"),
            ("0.037", "bright", Some((7, 5)), "\"bright\""),
            ("wavelength=\"403.1\"", "", Some((7, 5)), "without a wavelength"),
            ("</IESTM2714>", "", Some((9, 26)), "XML"),
            ("SpectralDistribution", "Distribution", Some((2, 1)), "TM-27"),
            ("SpectralData", "Data", None, "no samples"),
        ] {
            let error = parse(&LAMP.replace(from, to)).unwrap_err();
            assert!(error.to_string().contains(word), "{word}: {error}");
            if word != "XML" {
                assert_eq!(error.location.line_column, place, "{error}");
            }
        }
    }
}
