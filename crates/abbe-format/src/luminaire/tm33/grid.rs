//! Values on a grid of directions, as in `LuminousIntensity`.

use super::xml::{self, Places};
use crate::luminaire::ies;
use crate::luminaire::number::{MAX_VALUES, PlacedValue, ascending};
use crate::luminaire::photometry::LuminaireSymmetry;
use abbe_scene::light::PhotometricType;
use abbe_spectra::error::{Error, Result};
use roxmltree::Node;

/// The directions of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AngleGrid {
    pub(super) symmetry: LuminaireSymmetry,
    /// The angles γ in degrees, ascending, at least two.
    pub(super) vertical_deg: Vec<f64>,
    /// The angles C in degrees, ascending.
    pub(super) horizontal_deg: Vec<f64>,
}

/// A value in a direction, and at a wavelength if the table is spectral.
#[derive(Debug, Clone, Copy)]
pub(super) struct DirectedValue {
    c: PlacedValue,
    gamma: PlacedValue,
    /// In nm; 0 in a table without wavelengths.
    pub(super) wavelength_nm: f64,
    pub(super) value: PlacedValue,
}

/// Reads the elements `IntData` of a table. With `has_wavelengths`, each needs the attribute `w`.
pub(super) fn values(table: Node<'_, '_>, has_wavelengths: bool) -> Result<Vec<DirectedValue>> {
    let mut places = Places::new(table.document().input_text());
    let mut values = Vec::new();
    for node in xml::children(table, "IntData") {
        let (line, column) = places.of(node);
        if values.len() == MAX_VALUES {
            return Err(Error::input("too many intensities")
                .expected(format!("at most {MAX_VALUES}"))
                .at(line, column));
        }
        let attribute = |name: &str, what: &str| {
            let missing = || Error::input(format!("an intensity without {name}=\"…\"")).expected(what).at(line, column);
            PlacedValue::parse(node.attribute(name).ok_or_else(missing)?.trim(), what, line, column)
        };
        values.push(DirectedValue {
            c: attribute("h", "an angle C in degrees")?,
            gamma: attribute("v", "an angle γ in degrees")?,
            wavelength_nm: if has_wavelengths { attribute("w", "a wavelength in nm")?.value } else { 0.0 },
            value: PlacedValue::parse(node.text().unwrap_or("").trim(), "an intensity", line, column)?,
        });
    }
    Ok(values)
}

/// Sorts values by C and γ, and checks that they fill a grid. Returns its angles.
///
/// # Errors
/// Returns an error with line and column if a direction is missing or occurs twice, if the counts
/// or the symmetry that the table states differ, or if the angles do not cover the symmetry.
pub(super) fn sort(table: Node<'_, '_>, values: &mut [DirectedValue]) -> Result<AngleGrid> {
    values.sort_by(|a, b| (a.c.value.total_cmp(&b.c.value)).then(a.gamma.value.total_cmp(&b.gamma.value)));
    let Some(first) = values.first() else {
        return Err(xml::at(table, Error::input("a table without values").expected("elements <IntData>")));
    };
    let plane = values.iter().take_while(|value| value.c.value == first.c.value).count();
    let gammas: Vec<PlacedValue> = values[..plane].iter().map(|value| value.gamma).collect();
    let vertical_deg = ascending(&gammas, "an angle γ", (0.0, 180.0))?;
    if plane < 2 {
        return Err(gammas[0].wrong("a plane with one angle γ", "two or more"));
    }
    let mut planes = Vec::new();
    for part in values.chunks(plane) {
        planes.push(part[0].c);
        let other = |value: &DirectedValue| value.c.value != part[0].c.value;
        let wrong = part.iter().zip(&gammas).find(|(value, gamma)| value.gamma.value != gamma.value || other(value));
        if let Some((value, gamma)) = wrong {
            let what = format!("intensities at C {}° that lack γ {}°: γ", part[0].c.value, gamma.value);
            return Err(value.gamma.wrong(&what, "the angles γ of the first plane"));
        }
        if part.len() < plane {
            let what = format!("a plane of {} intensities: C", part.len());
            return Err(part[0].c.wrong(&what, &format!("{plane}, as the first plane has")));
        }
    }
    let horizontal_deg = ascending(&planes, "an angle C", (0.0, 360.0))?;
    check_count(table, "NumberVert", plane)?;
    check_count(table, "NumberHorz", planes.len())?;
    let (line, column) = (planes[0].line, planes[0].column);
    let range =
        ies::symmetry(PhotometricType::C, &vertical_deg, &horizontal_deg).map_err(|error| error.at(line, column))?;
    let symmetry = stated(table, range)?;
    Ok(AngleGrid { symmetry, vertical_deg, horizontal_deg })
}

fn check_count(table: Node<'_, '_>, name: &str, found: usize) -> Result<()> {
    match xml::number_in(table, name)? {
        Some(count) if count.value != found as f64 => {
            Err(count.wrong(&format!("<{name}>"), &format!("{found}, the number of angles of the intensities")))
        }
        Some(_) | None => Ok(()),
    }
}

/// Returns the symmetry, which follows from the range of the angles C, if the table states the same
/// or none. A table of all planes may state any.
fn stated(table: Node<'_, '_>, range: LuminaireSymmetry) -> Result<LuminaireSymmetry> {
    let Some(node) = xml::child(table, "Symm") else { return Ok(range) };
    let text = xml::compact(node);
    let stated = match text.as_str() {
        "Symm_None" | "Symm_Arbitrary" => LuminaireSymmetry::None,
        "Symm_Bi_0" => LuminaireSymmetry::AboutC0,
        "Symm_Bi_90" => LuminaireSymmetry::AboutC90,
        "Symm_Quad" => LuminaireSymmetry::Quadrants,
        "Symm_Full" => LuminaireSymmetry::Rotational,
        _ => {
            let names = "Symm_None, Symm_Bi_0, Symm_Bi_90, Symm_Quad, Symm_Full or Symm_Arbitrary";
            return Err(xml::at(node, Error::input(format!("<Symm>: \"{text}\"")).expected(names)));
        }
    };
    if stated == range || range == LuminaireSymmetry::None {
        return Ok(range);
    }
    let what = format!("the symmetry {text}");
    let expected = format!("planes for it; the range of the angles C means: {}", range.description());
    Err(xml::at(node, Error::input(what).expected(expected)))
}
