//! IES TM-33 (ANSI/IES TM-33-18 and TM-33-23, *Standard Format for the Electronic Transfer of
//! Luminaire Optical Data*): XML with the intensities, the spectrum and the emission areas of the
//! emitters of a luminaire.
//!
//! The names of elements follow the schemas of the standard, `IESTM33` and `IESTM33-22`. Lengths
//! are in m, angles in degrees. Faces of the luminaire are named by their normals, so that `Length`
//! runs along C90 and `Width` along C0, as in EULUMDAT.

mod areas;
mod emitter;
mod grid;
mod spectrum;
#[cfg(test)]
mod tests;
mod xml;

use super::photometry::Photometry;
use abbe_scene::light::PhotometricType;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{Observer, Spectrum};
use emitter::EmitterData;
use roxmltree::{Document, Node};

/// The start of the name of the root element.
const ROOT: &str = "IESTM33";

/// Returns whether an XML text has the root element of TM-33.
pub(super) fn is_tm33(text: &str) -> bool {
    text.contains("<IESTM33")
}

/// Parses a file. An error has its line and column.
pub(super) fn parse(text: &str) -> Result<Photometry> {
    let document = Document::parse(text).map_err(|error| {
        let place = error.pos();
        Error::input(format!("invalid XML: {error}")).at(place.row as usize, place.col as usize)
    })?;
    let root = document.root_element();
    let format = match root.tag_name().name() {
        "IESTM33" => "IES TM-33-18",
        "IESTM33-22" => "IES TM-33-23",
        name if name.starts_with(ROOT) => "IES TM-33",
        name => {
            return Err(xml::at(root, Error::input(format!("<{name}>")).expected("<IESTM33>, an IES TM-33 document")));
        }
    };
    check_type(root)?;
    let mut notes = Vec::new();
    let mut emitters = Vec::new();
    for node in xml::few(root, "Emitter")? {
        match EmitterData::of(node, &mut notes)? {
            Some(emitter) => emitters.push(emitter),
            None => notes.push(format!("{} has no intensities and is left out", emitter::name(node))),
        }
    }
    let Some((first, others)) = emitters.split_first() else {
        let expected = "an <Emitter> with <LuminousData>, <RadiantData>, <PhotonData> or <AngularSpectral>";
        return Err(xml::at(root, Error::input("a luminaire without intensities").expected(expected)));
    };
    let mut candela = first.candela.clone();
    for other in others {
        if other.grid != first.grid {
            let what = "emitters with intensities at different angles";
            return Err(Error::input(what)
                .expected("the same angles for all emitters")
                .at(other.place.0, other.place.1));
        }
        candela.iter_mut().zip(&other.candela).for_each(|(sum, value)| *sum += value);
    }
    let tilt = match emitters.iter().find(|emitter| !emitter.tilt.is_empty()) {
        None => Vec::new(),
        Some(only) if emitters.len() == 1 => only.tilt.clone(),
        Some(one) => {
            let error = Error::input("tilt factors of one of several emitters");
            return Err(error.expected("tilt factors of a single emitter").at(one.place.0, one.place.1));
        }
    };
    let total = |value: fn(&EmitterData) -> Option<f64>| emitters.iter().map(value).sum::<Option<f64>>();
    Ok(Photometry {
        format: format.to_owned(),
        name: name(root),
        kind: PhotometricType::C,
        symmetry: first.grid.symmetry,
        vertical_deg: first.grid.vertical_deg.clone(),
        horizontal_deg: first.grid.horizontal_deg.clone(),
        candela,
        lamp_lumens: total(|emitter| emitter.rated_lumens),
        input_watts: total(|emitter| emitter.input_watts),
        opening: areas::opening(root, &mut notes)?,
        tilt,
        spectrum: mixed(&emitters)?,
        notes,
    })
}

/// Returns an error if the gonioradiometer had another type than C, whose angles mean other axes.
fn check_type(root: Node<'_, '_>) -> Result<()> {
    let device = xml::child(root, "Equipment").and_then(|equipment| xml::child(equipment, "Gonioradiometer"));
    let Some(kind) = device.and_then(|device| xml::child(device, "Type")) else { return Ok(()) };
    let text = xml::compact(kind);
    if ["CIE_C", "IES_C"].contains(&text.as_str()) {
        return Ok(());
    }
    let error = Error::input(format!("a gonioradiometer of type {text}"));
    Err(xml::at(kind, error.expected("CIE_C or IES_C")))
}

/// Returns the manufacturer, the catalogue number and the description.
fn name(root: Node<'_, '_>) -> String {
    let Some(header) = xml::child(root, "Header") else { return String::new() };
    let parts = ["Manufacturer", "CatalogNumber", "Description"];
    let parts = parts.iter().filter_map(|name| xml::child(header, name).and_then(|node| node.text()));
    let words = parts.map(|text| text.split_whitespace().collect::<Vec<_>>().join(" ")).filter(|text| !text.is_empty());
    words.collect::<Vec<_>>().join(", ").chars().filter(|c| !c.is_control()).take(200).collect()
}

/// Mixes the spectra of the emitters by their luminous fluxes. Returns `None` if one has none.
fn mixed(emitters: &[EmitterData]) -> Result<Option<Spectrum>> {
    let spectra: Option<Vec<&Spectrum>> = emitters.iter().map(|emitter| emitter.spectrum.as_ref()).collect();
    let Some(spectra) = spectra else { return Ok(None) };
    if let [single] = spectra[..] {
        return Ok(Some(single.clone()));
    }
    let mut parts = Vec::new();
    for (emitter, spectrum) in emitters.iter().zip(spectra) {
        let luminous = Observer::cie1931().xyz(spectrum)[1];
        let flux = emitter.flux_lm()?;
        if luminous > 0.0 {
            parts.push((flux / luminous, spectrum));
        }
    }
    Ok((!parts.is_empty()).then(|| Spectrum::mix(&parts)))
}
