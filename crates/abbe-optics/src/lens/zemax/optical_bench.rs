//! Prescriptions of the Optical Bench of photonstophotos.net (`.txt`), whose lines become operands
//! of a Zemax file.
//!
//! Values are separated by tabs. The reader uses the sections `[descriptive data]`, `[constants]`,
//! `[variable distances]`, `[lens data]` and `[aspherical data]`, and skips all others. A line of a
//! surface has its name, the radius of curvature (or `AS` for the aperture stop, `FS` for a field
//! stop and `CG` for a cover glass), the thickness or the name of a variable distance, n_d, the
//! diameter, V_d, and the name of the glass. A line of an asphere has the name of its surface, the
//! radius, the conic constant and the coefficients of h⁴, h⁶ and so on, or with the constant
//! `AsphericalA2` those of h², h⁴ and so on. Lengths are in mm.

use super::operand::{Operand, glass_name, read_all};
use super::reader::ZmxReader;
use super::words::{parsed, unsupported};
use crate::glass::AgfCatalogue;
use abbe_spectra::error::{Error, Result};

/// A line of a section.
struct Row<'a> {
    line: usize,
    cells: Vec<&'a str>,
}

impl Row<'_> {
    /// Returns a cell, or an empty text.
    fn cell(&self, i: usize) -> &str {
        self.cells.get(i).copied().unwrap_or_default()
    }

    fn operand(&self, name: &'static str, arguments: &[&str]) -> Operand {
        Operand::new((self.line, 1), name, arguments)
    }
}

/// The lines of the sections.
#[derive(Default)]
struct Sections<'a> {
    descriptive: Vec<Row<'a>>,
    constants: Vec<Row<'a>>,
    distances: Vec<Row<'a>>,
    surfaces: Vec<Row<'a>>,
    aspheres: Vec<Row<'a>>,
}

impl<'a> Sections<'a> {
    fn of(text: &'a str) -> Self {
        let mut sections = Self::default();
        let mut name = String::new();
        for (i, line) in text.lines().enumerate() {
            let cells: Vec<&str> = line.split('\t').map(str::trim).collect();
            if cells.iter().all(|cell| cell.is_empty()) {
                continue;
            }
            if cells[0].starts_with('[') {
                name = cells[0].to_lowercase();
                continue;
            }
            let rows = match name.as_str() {
                "[descriptive data]" => &mut sections.descriptive,
                "[constants]" => &mut sections.constants,
                "[variable distances]" => &mut sections.distances,
                "[lens data]" => &mut sections.surfaces,
                "[aspherical data]" => &mut sections.aspheres,
                _ => continue,
            };
            rows.push(Row { line: i + 1, cells });
        }
        sections
    }

    /// Returns the line of a variable, in any case.
    fn variable(&self, name: &str) -> Option<&Row<'a>> {
        self.distances.iter().find(|row| row.cell(0).eq_ignore_ascii_case(name))
    }

    /// Returns the first value of a variable that is a number, with the line.
    fn number(&self, name: &str) -> Result<Option<(f64, &Row<'a>)>> {
        match self.variable(name) {
            Some(row) if !["", "undefined"].contains(&row.cell(1)) => Ok(Some((value(row.cell(1), row)?, row))),
            Some(_) | None => Ok(None),
        }
    }
}

/// Reads the text of a file. Of a zoom lens, or of a lens with several focus settings, the first
/// column is read, and a note says so. Returns an error with its line for a malformed value, an
/// unknown variable and an asphere with odd powers.
pub(super) fn read(text: &str, reader: &mut ZmxReader<'_>, catalogues: &[AgfCatalogue]) -> Result<()> {
    let sections = Sections::of(text);
    if sections.surfaces.is_empty() {
        return Err(Error::input("found no section [lens data]").expected("a prescription of the Optical Bench"));
    }
    let mut operands = header(&sections)?;
    let columns = sections.distances.iter().map(|row| row.cells.iter().skip(1).filter(|cell| !cell.is_empty()).count());
    let columns = columns.max().unwrap_or(1);
    if columns > 1 {
        let focal = sections.variable("Focal Length").map_or("", |row| row.cell(1));
        reader.notes.push(format!(
            "the lens file has {columns} settings of zoom or focus; the first one is read (focal length {focal} mm)"
        ));
    }
    let object = sections.variable("d0").map_or("Infinity", |row| row.cell(1));
    let object = if ["", "undefined"].contains(&object) { "Infinity" } else { object };
    let first = &sections.surfaces[0];
    operands.push(first.operand("SURF", &[]));
    operands.push(first.operand("DISZ", &[infinity(object)]));
    for row in &sections.surfaces {
        operands.extend(surface(&sections, row, catalogues)?);
    }
    let last = &sections.surfaces[sections.surfaces.len() - 1];
    operands.extend([last.operand("SURF", &[]), last.operand("DISZ", &["0"])]);
    read_all(operands.iter(), reader)
}

/// Returns the operands of the name, the aperture and the field.
fn header(sections: &Sections<'_>) -> Result<Vec<Operand>> {
    let title = sections.descriptive.iter().find(|row| row.cell(0).eq_ignore_ascii_case("title"));
    let title = title.filter(|row| !row.cell(1).is_empty());
    let mut operands: Vec<Operand> = title.iter().map(|row| row.operand("NAME", &[row.cell(1)])).collect();
    let positive = |name: &str| Ok(sections.number(name)?.filter(|(value, _)| *value > 0.0));
    if let Some((f_number, row)) = positive("F-Number")? {
        operands.push(row.operand("FNUM", &[&f_number.to_string()]));
    } else if let Some((aperture, row)) = positive("NA")? {
        operands.push(row.operand("OBNA", &[&aperture.to_string()]));
    }
    // The angle of view and the image circle are the whole ones.
    if let Some((angle_deg, row)) = positive("Angle of View")?.filter(|(angle_deg, _)| *angle_deg < 180.0) {
        operands.push(row.operand("FTYP", &["0"]));
        operands.push(row.operand("YFLN", &[&(0.5 * angle_deg).to_string()]));
    } else if let Some((height_mm, row)) = positive("Image Height")? {
        operands.push(row.operand("FTYP", &["2"]));
        operands.push(row.operand("YFLN", &[&(0.5 * height_mm).to_string()]));
    }
    Ok(operands)
}

fn surface(sections: &Sections<'_>, row: &Row<'_>, catalogues: &[AgfCatalogue]) -> Result<Vec<Operand>> {
    let mut operands = vec![row.operand("SURF", &[])];
    match row.cell(1) {
        "AS" => operands.push(row.operand("STOP", &[])),
        "FS" | "CG" => {}
        radius => {
            let radius = value(radius, row)?;
            let curvature = if radius == 0.0 { 0.0 } else { 1.0 / radius };
            operands.push(row.operand("CURV", &[&curvature.to_string()]));
        }
    }
    let thickness = row.cell(2);
    let thickness = match thickness.parse::<f64>() {
        _ if thickness.is_empty() => "0",
        Ok(_) => thickness,
        Err(_) => {
            let variable = sections.variable(thickness).ok_or_else(|| {
                let what = format!("found the thickness \"{thickness}\"");
                Error::input(what).expected("a number, or a name of [variable distances]").at(row.line, 1)
            })?;
            variable.cell(1)
        }
    };
    operands.push(row.operand("DISZ", &[infinity(thickness)]));
    if !row.cell(3).is_empty() {
        let (nd, vd) = (row.cell(3), if row.cell(5).is_empty() { "0" } else { row.cell(5) });
        operands.push(match row.cell(6) {
            "" => row.operand("GLAS", &["___BLANK", "1", "0", nd, vd]),
            name => row.operand("GLAS", &[glass_name(name, catalogues), "0", "0", nd, vd]),
        });
    }
    if !row.cell(4).is_empty() {
        let diameter = value(row.cell(4), row)?;
        operands.push(row.operand("DIAM", &[&(0.5 * diameter).to_string()]));
    }
    if let Some(asphere) = sections.aspheres.iter().find(|asphere| asphere.cell(0) == row.cell(0)) {
        operands.extend(terms(sections, asphere)?);
    }
    Ok(operands)
}

/// Returns the operands of the conic constant and of the coefficients.
fn terms(sections: &Sections<'_>, row: &Row<'_>) -> Result<Vec<Operand>> {
    let has = |name: &str| sections.constants.iter().any(|constant| constant.cell(0).eq_ignore_ascii_case(name));
    if has("AsphericalOddCount") {
        return Err(unsupported("an asphere with odd powers", "even powers only").at(row.line, 1));
    }
    let mut operands = vec![row.operand("TYPE", &["EVENASPH"])];
    if !row.cell(2).is_empty() {
        operands.push(row.operand("CONI", &[row.cell(2)]));
    }
    let first = if has("AsphericalA2") { 1 } else { 2 };
    let coefficients = row.cells.iter().skip(3).enumerate().filter(|(_, term)| !term.is_empty());
    operands.extend(coefficients.map(|(i, term)| row.operand("PARM", &[&(first + i).to_string(), term])));
    Ok(operands)
}

/// Returns a number of a line, which may be infinite.
fn value(text: &str, row: &Row<'_>) -> Result<f64> {
    parsed(infinity(text)).map_err(|error| error.at(row.line, 1))
}

/// Returns infinity as Zemax writes it, or the same text.
fn infinity(text: &str) -> &str {
    if text.trim_start_matches('-').eq_ignore_ascii_case("infinity") { "INFINITY" } else { text }
}

#[cfg(test)]
mod tests {
    use crate::glass::lines;
    use crate::lens::zemax::{parse, parse_system};
    use crate::lens::{Lens, LensAnalysis};

    /// The Cooke triplet of the catalogue by n_d and V_d, with a variable distance and two foci.
    const TRIPLET: &str = "[descriptive data]\ntitle\tCooke triplet\n[constants]\n[variable distances]\nFocal Length\t50\t49\n\
        Angle of View\t40\nF-Number\t5\nd0\tInfinity\t900\nd4\t4.75041\t4.8\nBf\t42.2078\n[lens data]\n\
        1\t22.01359\t3.25896\t1.62041\t17\t60.28\n2\t-435.76044\t6.00755\t\t16\n3\t-22.21328\t0.99997\t1.62004\t10\t36.37\n\
        4\t20.29192\td4\t\t10\n4AS\tAS\t0\t\t7.7\n5\t79.6836\t2.95208\t1.62041\t12\t60.28\tN-SK16\tschott\n6\t-18.39533\tBf\t\t13\n[figure]\nppmm\t3\n";

    fn read(text: &str) -> Lens {
        parse(text.as_bytes(), "cooke.txt".as_ref(), &[]).unwrap()
    }

    #[test]
    fn a_prescription_gives_its_lens() {
        let lens = read(TRIPLET);
        assert_eq!((lens.name(), lens.stop(), lens.half_field_deg()), ("Cooke triplet", 4, Some(20.0)));
        let paraxial = lens.at(lines::D_NM).paraxial().unwrap();
        // tests/golden/lenses.json has 50.0216 mm, with the formulas of the glasses.
        assert!((paraxial.efl_mm - 50.0216).abs() < 1e-3, "{paraxial:?}");
        assert!((paraxial.f_number.unwrap() - 5.0).abs() < 1e-9, "{paraxial:?}");
        assert!(
            lens.notes().iter().any(|note| note.contains("2 settings") && note.contains("50 mm")),
            "{:?}",
            lens.notes()
        );
        assert!(LensAnalysis::of(&lens, None).is_ok());
        // A named glass has its own formula.
        assert!((lens.surfaces()[5].index.vd().unwrap() - 60.32).abs() < 0.01);
        let unknown = read(&TRIPLET.replace("N-SK16", "X-SK99"));
        assert!((unknown.surfaces()[5].index.vd().unwrap() - 60.28).abs() < 0.05, "by n_d and V_d");
        let height = read(&TRIPLET.replace("Angle of View\t40", "Angle of View\tundefined\nImage Height\t36.397"));
        assert!((height.half_field_deg().unwrap() - 20.0).abs() < 1e-2, "{:?}", height.half_field_deg());
    }

    #[test]
    fn aspheres_have_a_conic_constant_and_even_powers() {
        let with = |constant: &str| {
            let text = TRIPLET.replace("[constants]\n", &format!("[constants]\n{constant}"));
            text + "[aspherical data]\n6\t-18.39533\t-0.9\t1e-6\t-2e-8\n"
        };
        let profile = |text: &str| read(text).surfaces()[6].profile.clone();
        assert_eq!(profile(&with("")).conic, -0.9);
        assert_eq!(profile(&with("")).even_terms[..], [0.0, 1e-6, -2e-8]);
        assert_eq!(profile(&with("AsphericalA2\n")).even_terms[..], [1e-6, -2e-8]);
        let odd = parse_system(with("AsphericalOddCount\t1\n").as_bytes(), "cooke.txt".as_ref(), &[]).unwrap_err();
        assert!(odd.to_string().contains("cooke.txt:23:1: an asphere with odd powers is not supported"), "{odd}");
    }

    #[test]
    fn errors_name_the_line() {
        for (from, to, words) in [
            ("22.01359\t", "2x\t", &["cooke.txt:12:1", "found \"2x\""][..]),
            ("\td4\t", "\td5\t", &["cooke.txt:15:1", "the thickness \"d5\"", "[variable distances]"]),
            ("F-Number\t5", "F-Number\tfive", &["cooke.txt:7:1", "found \"five\""]),
            ("\t10\t36.37", "\tten\t36.37", &["cooke.txt:14:1", "found \"ten\""]),
            ("1.62004", "glass", &["cooke.txt:14:1", "found \"glass\""]),
            ("[lens data]", "[lenses]", &["no section [lens data]", "Optical Bench"]),
        ] {
            let text = TRIPLET.replacen(from, to, 1);
            let error = parse(text.as_bytes(), "cooke.txt".as_ref(), &[]).unwrap_err().to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{to}: {error}");
        }
    }
}
