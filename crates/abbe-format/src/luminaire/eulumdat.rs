//! EULUMDAT (`.ldt`): one value per line (Stockmar 1990, *EULUMDAT – a data format for the exchange
//! of luminaire data*).

use super::number::{PlacedValue, ascending, candela, check_values};
use super::photometry::{LuminaireSymmetry, OpeningSize, Photometry};
use abbe_scene::light::{OpeningShape, PhotometricType};
use abbe_spectra::error::{Error, Result};

/// The largest number of sets of lamps. The format allows 20.
const MAX_LAMP_SETS: usize = 64;

/// The number of lines of each set of lamps.
const LINES_PER_SET: usize = 6;

/// The number of direct ratios, which follow the sets of lamps.
const DIRECT_RATIOS: usize = 10;

/// The lines of a file. The lines are counted from 1, as in the definition of the format.
struct LdtLines<'a>(Vec<&'a str>);

impl LdtLines<'_> {
    fn text(&self, line: usize) -> &str {
        self.0.get(line - 1).map_or("", |text| text.trim())
    }

    /// Returns the number in a line. The number may have a decimal comma.
    fn number(&self, line: usize, what: &str) -> Result<PlacedValue> {
        if line > self.0.len() {
            return Err(Error::input("the file ends too early").expected(what).at(self.0.len().max(1), 1));
        }
        let text = self.text(line).trim_end_matches('\u{1a}').replace(',', ".");
        PlacedValue::parse(text.trim(), what, line, 1)
    }

    /// Returns the number in a line, or 0 if the line is empty.
    fn number_or_0(&self, line: usize, what: &str) -> Result<f64> {
        if line <= self.0.len() && self.text(line).is_empty() { Ok(0.0) } else { Ok(self.number(line, what)?.value) }
    }

    fn numbers(&self, first: usize, count: usize, what: &str) -> Result<Vec<PlacedValue>> {
        (first..first + count).map(|line| self.number(line, what)).collect()
    }
}

/// Parses a file. An error has its line and column.
pub(super) fn parse(text: &str) -> Result<Photometry> {
    let lines = LdtLines(text.lines().collect());
    let symmetry = symmetry(lines.number(3, "the symmetry (Isym)")?)?;
    let plane_place = lines.number(4, "the number of C planes (Mc)")?;
    let planes = plane_place.count("the number of C planes (Mc)", 1)?;
    let angles = lines.number(6, "the number of intensities per plane (Ng)")?;
    let angles = angles.count("the number of intensities per plane (Ng)", 2)?;
    check_values(angles, planes, plane_place)?;
    let factor = lines.number(24, "the conversion factor of the intensities")?;
    let factor = factor.not_negative("the conversion factor of the intensities")?;
    let sets_place = lines.number(26, "the number of lamp sets")?;
    let sets = sets_place.count("the number of lamp sets", 1)?;
    if sets > MAX_LAMP_SETS {
        return Err(sets_place.wrong("the number of lamp sets", &format!("at most {MAX_LAMP_SETS}")));
    }
    // The intensities are stated for 1000 lm of the lamps. The first set of lamps is used.
    let lumens = lines.number(29, "the luminous flux of the lamps")?;
    if lumens.value <= 0.0 {
        return Err(lumens.wrong("the luminous flux of the lamps", "a number above 0"));
    }
    let watts = lines.number_or_0(32, "the wattage of the lamps")?;
    let first_c = 27 + LINES_PER_SET * sets + DIRECT_RATIOS;
    let c_angles = lines.numbers(first_c, planes, "an angle C")?;
    let (c_deg, stored) = planes_of(symmetry, &c_angles, plane_place)?;
    let first_gamma = first_c + planes;
    let gammas = lines.numbers(first_gamma, angles, "an angle γ")?;
    let vertical_deg = ascending(&gammas, "an angle γ", (0.0, 180.0))?;
    let values = lines.numbers(first_gamma + angles, stored * angles, "an intensity")?;
    let candela = candela(&values, factor * lumens.value / 1000.0)?;
    if candela.iter().all(|value| *value == 0.0) {
        return Err(plane_place.wrong("all intensities are 0; the number of C planes", "light"));
    }
    let name: String =
        [lines.text(1), lines.text(9)].into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(", ");
    Ok(Photometry {
        format: "EULUMDAT".to_string(),
        name: name.chars().filter(|c| !c.is_control()).take(200).collect(),
        kind: PhotometricType::C,
        symmetry,
        vertical_deg,
        horizontal_deg: c_deg,
        candela,
        lamp_lumens: Some(lumens.value),
        input_watts: (watts > 0.0).then_some(watts),
        opening: opening(&lines)?,
        tilt: Vec::new(),
        spectrum: None,
        notes: Vec::new(),
    })
}

fn symmetry(number: PlacedValue) -> Result<LuminaireSymmetry> {
    match number.value {
        0.0 => Ok(LuminaireSymmetry::None),
        1.0 => Ok(LuminaireSymmetry::Rotational),
        2.0 => Ok(LuminaireSymmetry::AboutC0),
        3.0 => Ok(LuminaireSymmetry::AboutC90),
        4.0 => Ok(LuminaireSymmetry::Quadrants),
        _ => Err(number.wrong("the symmetry (Isym)", "a whole number from 0 to 4")),
    }
}

/// Returns the angles of the planes that the file contains, in degrees, and the number of these
/// planes. The file lists the angles of all planes.
fn planes_of(symmetry: LuminaireSymmetry, listed: &[PlacedValue], count: PlacedValue) -> Result<(Vec<f64>, usize)> {
    let planes = listed.len();
    let parts = match symmetry {
        LuminaireSymmetry::None | LuminaireSymmetry::Rotational => 1,
        LuminaireSymmetry::AboutC0 => 2,
        LuminaireSymmetry::AboutC90 | LuminaireSymmetry::Quadrants => 4,
    };
    if !planes.is_multiple_of(parts) {
        let expected = format!("a multiple of {parts} for this symmetry");
        return Err(count.wrong("the number of C planes (Mc)", &expected));
    }
    let all = ascending(listed, "an angle C", (0.0, 360.0))?;
    let angles: Vec<f64> = match symmetry {
        LuminaireSymmetry::Rotational => vec![0.0],
        LuminaireSymmetry::None => all,
        LuminaireSymmetry::AboutC0 => all.into_iter().take(planes / 2 + 1).collect(),
        LuminaireSymmetry::Quadrants => all.into_iter().take(planes / 4 + 1).collect(),
        // The planes from C270 over C0 to C90.
        LuminaireSymmetry::AboutC90 => {
            let (right, left) = (&all[..planes / 4 + 1], &all[3 * planes / 4..]);
            left.iter().map(|angle| angle - 360.0).chain(right.iter().copied()).collect()
        }
    };
    let ends = angles.first().copied().zip(angles.last().copied());
    let wanted = match symmetry {
        LuminaireSymmetry::AboutC0 => Some((0.0, 180.0)),
        LuminaireSymmetry::AboutC90 => Some((-90.0, 90.0)),
        LuminaireSymmetry::Quadrants => Some((0.0, 90.0)),
        LuminaireSymmetry::None | LuminaireSymmetry::Rotational => None,
    };
    if let (Some((first, last)), Some(wanted)) = (ends, wanted)
        && (first, last) != wanted
    {
        let what = format!("planes from C{first} to C{last}");
        let expected = format!("planes from C{} to C{} for this symmetry", wanted.0, wanted.1);
        let place = listed.first().map_or((1, 1), |angle| (angle.line, angle.column));
        return Err(Error::input(what).expected(expected).at(place.0, place.1));
    }
    let stored = angles.len();
    Ok((angles, stored))
}

/// Returns the luminous opening (mm in the file): the length along C90, and a disk for width 0.
fn opening(lines: &LdtLines) -> Result<OpeningSize> {
    let mut sides = [0.0; 3];
    for (side, line) in sides.iter_mut().zip([16, 17, 18]) {
        *side = lines.number_or_0(line, "a side of the luminous area in mm")?.abs() / 1000.0;
    }
    let [length, width, height_m] = sides;
    let shape = match (length, width) {
        (0.0, 0.0) => OpeningShape::Point,
        (_, 0.0) => OpeningShape::Ellipse,
        _ => OpeningShape::Rectangle,
    };
    let along_c0_m = if shape == OpeningShape::Ellipse { length } else { width };
    Ok(OpeningSize { shape, along_c0_m, along_c90_m: length, height_m })
}
