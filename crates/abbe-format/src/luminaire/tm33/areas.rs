//! The emission areas of a luminaire.

use super::xml;
use crate::luminaire::photometry::OpeningSize;
use abbe_scene::light::OpeningShape;
use abbe_spectra::error::Result;
use roxmltree::Node;

/// The faces whose areas are vertical, each with the name of its areas.
const SIDES: [(&str, &str); 4] =
    [("C0Face", "C0Area"), ("C90Face", "C90Area"), ("C180Face", "C180Area"), ("C270Face", "C270Area")];

/// The horizontal faces, in the order in which they are looked for.
const FLAT: [(&str, &str); 2] = [("BottomFace", "BottomArea"), ("TopFace", "TopArea")];

/// Returns the opening that encloses the areas of the bottom face, or of the top face if it has
/// none. Several areas become their enclosing rectangle, and a note says so.
pub(super) fn opening(root: Node<'_, '_>, notes: &mut Vec<String>) -> Result<OpeningSize> {
    let faces: Vec<Node<'_, '_>> =
        xml::children(root, "Emitter").flat_map(|emitter| xml::children(emitter, "EmissionAreas")).collect();
    let areas = |(face, area): (&'static str, &'static str)| -> Result<Vec<Node<'_, '_>>> {
        let mut found = Vec::new();
        for face in faces.iter().flat_map(|faces| xml::children(*faces, face)) {
            found.extend(xml::few(face, area)?);
        }
        Ok(found)
    };
    let mut height_m = 0.0_f64;
    for side in SIDES {
        for area in areas(side)? {
            height_m = height_m.max(length(area, "Height")?);
        }
    }
    let [bottom, top] = FLAT.map(areas);
    let flat = Some(bottom?).filter(|areas| !areas.is_empty()).map_or_else(|| top, Ok)?;
    let point = OpeningSize { shape: OpeningShape::Point, along_c0_m: 0.0, along_c90_m: 0.0, height_m };
    let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 2];
    for area in &flat {
        for (range, [size, offset]) in ranges.iter_mut().zip([["Width", "WidthOffset"], ["Length", "LengthOffset"]]) {
            let half = 0.5 * length(*area, size)?;
            let centre = xml::number_in(*area, offset)?.map_or(0.0, |number| number.value);
            *range = (range.0.min(centre - half), range.1.max(centre + half));
        }
    }
    let [along_c0_m, along_c90_m] = ranges.map(|(from, to)| to - from);
    if !(along_c0_m > 0.0 && along_c90_m > 0.0) {
        return Ok(point);
    }
    let is_circular = match flat[..] {
        [area] => xml::truth_in(area, "Circular")?.unwrap_or(false),
        _ => false,
    };
    if flat.len() > 1 {
        notes.push(format!("the luminous opening is the rectangle around the {} emission areas", flat.len()));
    }
    let shape = if is_circular { OpeningShape::Ellipse } else { OpeningShape::Rectangle };
    Ok(OpeningSize { shape, along_c0_m, along_c90_m, height_m })
}

/// Returns a length of at least 0 in m, or 0 if it is missing.
fn length(area: Node<'_, '_>, name: &str) -> Result<f64> {
    xml::number_in(area, name)?.map_or(Ok(0.0), |number| number.not_negative(&format!("<{name}>")))
}
