//! IES TM-27: spectral data as XML (ANSI/IES TM-27-14 and TM-27-20, *Standard Format for the
//! Electronic Transfer of Spectral Data*).
//!
//! The element `SpectralDistribution` contains one element `SpectralData` per sample, whose
//! attribute `wavelength` is in nm and whose text is the value. `SpectralQuantity` names the
//! measured quantity.

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
    let distribution = child(document.root_element(), "SpectralDistribution").ok_or_else(|| {
        let root = document.root_element();
        let (line, column) = place(root);
        let what = format!("<{}> without <SpectralDistribution>", root.tag_name().name());
        Error::input(what).expected("an IES TM-27 document").at(line, column)
    })?;
    let data = distribution.children().filter(|node| node.tag_name().name() == "SpectralData");
    let samples = data.map(sample).collect::<Result<Vec<_>>>()?;
    SpectrumSamples::checked(&samples, child(distribution, "SpectralQuantity").and_then(|node| kind_of(node.text()?)))
}

fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|child| child.tag_name().name() == name)
}

fn place(node: Node<'_, '_>) -> (usize, usize) {
    let place = node.document().text_pos_at(node.range().start);
    (place.row as usize, place.col as usize)
}

fn sample(node: Node<'_, '_>) -> Result<(PlacedNumber, PlacedNumber)> {
    let (line, column) = place(node);
    let number = |text: &str| {
        text.trim()
            .parse::<f64>()
            .map_err(|_| Error::input(format!("\"{text}\"")).expected("a number").at(line, column))
    };
    let Some(nm) = node.attribute("wavelength") else {
        return Err(Error::input("a sample without a wavelength").expected("wavelength=\"…\" in nm").at(line, column));
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
