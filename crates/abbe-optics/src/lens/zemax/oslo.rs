//! OSLO lens files (`.len`), whose commands become operands of a Zemax file.
//!
//! A command ends at the end of its line or at `;`, `//` starts a comment, and quotes join words.
//! `NXT` ends a surface. The reader uses `LEN`, `UNI`, `EBR`, `FNO`, `NAO`, `NAP`, `ANG`, `OBH`,
//! `GIH`, `WV`, and for surfaces `AIR`, `GLA`, `RFL`, `RFH`, `RD`, `CV`, `TH`, `AP`, `AST`, `CC`,
//! `AD` to `AG` and `PK`. It refuses commands that are known to change the rays but are not
//! supported, and ignores all others. What follows `END` is not read.
//! Source: *OSLO Program Reference*, Lambda Research.

use super::operand::{Operand, glass_name, read_all};
use super::reader::ZmxReader;
use super::words::{parsed, unsupported};
use crate::glass::{AgfCatalogue, lines};
use abbe_spectra::error::{Error, Result};

/// Distances in any unit from which on the object is at infinity.
const FAR: f64 = 1e8;
/// The wavelengths in µm to which the indices of a model glass belong, if the file names none.
const WAVELENGTHS_UM: [f64; 3] = [0.58756, 0.48613, 0.65627];
/// The coefficients of h⁴, h⁶, h⁸ and h¹⁰, with the numbers of their Zemax parameters.
const TERMS: [(&str, &str); 4] = [("AD", "2"), ("AE", "3"), ("AF", "4"), ("AG", "5")];
/// Commands that are errors unless their value is 0.
const ZERO: [&str; 11] = ["DCX", "DCY", "DCZ", "TLA", "TLB", "TLC", "CVX", "RDX", "GSP", "GOR", "PFL"];
/// Commands that are errors.
const REFUSED: [&str; 12] = ["ASP", "GTO", "GC", "RCO", "BEN", "EC", "PU", "PUC", "PUK", "NSS", "GRN", "SPL"];
/// Solves of a thickness by the height of a paraxial ray.
const SOLVES: [&str; 2] = ["PY", "PYC"];

/// A command with its place from 1.
struct Command {
    place: (usize, usize),
    words: Vec<String>,
}

/// A surface in the unit of the file.
#[derive(Clone, Default)]
struct OsloSurface {
    place: (usize, usize),
    curvature: f64,
    thickness: f64,
    /// The place and the arguments of the `GLAS` operand, or `None` for air.
    glass: Option<((usize, usize), Vec<String>)>,
    /// 0 if the file does not state it.
    aperture: f64,
    stop: bool,
    conic: f64,
    terms: [f64; TERMS.len()],
    /// The place of a solve of the thickness.
    solve: Option<(usize, usize)>,
}

/// The commands that are read so far.
struct OsloFile {
    header: Vec<Operand>,
    unit_mm: f64,
    wavelengths_um: Vec<f64>,
    /// The last one is being read.
    surfaces: Vec<OsloSurface>,
}

/// Reads the text of a file. Returns an error with its line and column for an unsupported command
/// or a malformed value.
pub(super) fn read(text: &str, reader: &mut ZmxReader<'_>, catalogues: &[AgfCatalogue]) -> Result<()> {
    let first = OsloSurface { place: (1, 1), ..OsloSurface::default() };
    let wavelengths_um = WAVELENGTHS_UM.to_vec();
    let mut file = OsloFile { header: Vec::new(), unit_mm: 1.0, wavelengths_um, surfaces: vec![first] };
    let mut is_lens = false;
    for command in commands(text) {
        let (line, column) = command.place;
        let Some((name, values)) = command.words.split_first() else { continue };
        let name = name.to_uppercase();
        if name == "END" {
            break;
        }
        is_lens |= name == "LEN";
        file.command(&name, values, command.place, catalogues).map_err(|error| error.at(line, column))?;
    }
    if !is_lens {
        return Err(Error::input("found no LEN command").expected("an OSLO lens file"));
    }
    file.check_solves()?;
    reader.unit_mm = file.unit_mm;
    let operands: Vec<Operand> = file.surfaces.iter().enumerate().flat_map(|(i, it)| it.operands(i)).collect();
    read_all(file.header.iter().chain(&operands), reader)
}

impl OsloFile {
    fn command(
        &mut self,
        name: &str,
        values: &[String],
        place: (usize, usize),
        catalogues: &[AgfCatalogue],
    ) -> Result<()> {
        let count = self.surfaces.len();
        let Some(surface) = self.surfaces.last_mut() else { return Ok(()) };
        let word = || values.first().ok_or_else(|| Error::input(format!("found {name} without a value")));
        let number = || parsed(word()?);
        let mut header = |name, words: &[&str]| self.header.push(Operand::new(place, name, words));
        match name {
            "LEN" => {
                if let Some(title) = values.get(1).filter(|title| !title.is_empty()) {
                    header("NAME", &[title]);
                }
            }
            "UNI" => {
                self.unit_mm = number()?;
                if !(self.unit_mm > 0.0 && self.unit_mm.is_finite()) {
                    return Err(Error::input(format!("found a unit of {} mm", self.unit_mm)).expected("above 0"));
                }
            }
            "EBR" => header("ENPD", &[&(2.0 * number()?).to_string()]),
            "FNO" => header("FNUM", &[word()?]),
            "NAO" => header("OBNA", &[word()?]),
            "NAP" => header("FNUM", &[&(0.5 / number()?).to_string()]),
            "ANG" | "OBH" | "GIH" => {
                let kind = match name {
                    "ANG" => "0",
                    "OBH" => "1",
                    _ => "2",
                };
                header("FTYP", &[kind]);
                header("YFLN", &[word()?]);
            }
            "WV" => self.wavelengths_um = values.iter().map(|word| parsed(word)).collect::<Result<_>>()?,
            "NXT" => self.surfaces.push(OsloSurface { place, ..OsloSurface::default() }),
            "AIR" | "AIF" => surface.glass = None,
            "RFL" | "RFH" => surface.glass = Some((place, vec!["MIRROR".to_string()])),
            "GLA" | "GLF" => surface.glass = Some((place, glass(values, &self.wavelengths_um, catalogues)?)),
            "RD" | "RDF" => {
                let radius = number()?;
                surface.curvature = if radius == 0.0 { 0.0 } else { 1.0 / radius };
            }
            "CV" | "CVF" => surface.curvature = number()?,
            "TH" | "THF" => surface.thickness = number()?,
            "AP" | "APF" => {
                // A checked aperture blocks rays in OSLO, and an unchecked one states the size.
                let is_flag = |word: &&String| ["CHK", "UNC"].iter().any(|flag| word.eq_ignore_ascii_case(flag));
                let radius = values.iter().find(|word| !is_flag(word));
                let radius = radius.ok_or_else(|| Error::input("found AP without a radius"))?;
                surface.aperture = parsed(radius)?;
            }
            "AST" => {
                self.surfaces.iter_mut().for_each(|surface| surface.stop = false);
                self.surfaces[count - 1].stop = true;
            }
            "CC" => surface.conic = number()?,
            "PK" => self.pick_up(values, count - 1)?,
            _ if SOLVES.contains(&name) => surface.solve = Some(place),
            _ if ZERO.contains(&name) => {
                if number()? != 0.0 {
                    return Err(unsupported(name, "surfaces of revolution on one axis"));
                }
            }
            _ if REFUSED.contains(&name) => {
                return Err(unsupported(name, "surfaces that are spheres, conics or aspheres with AD to AG"));
            }
            _ => {
                if let Some(i) = TERMS.iter().position(|(term, _)| *term == name) {
                    surface.terms[i] = number()?;
                }
            }
        }
        Ok(())
    }

    /// Copies a value of an earlier surface (`PK`): `CV` with the asphere, `TH`, `AP` or `GLA`.
    /// `CVM` and `THM` change its sign, and a last number is added. A negative number of the
    /// surface counts backwards.
    fn pick_up(&mut self, values: &[String], at: usize) -> Result<()> {
        let kind = values.first().map(|word| word.to_uppercase()).unwrap_or_default();
        let from = parsed(values.get(1).ok_or_else(|| Error::input("found PK without a surface"))?)?;
        let from = if from < 0.0 { at as f64 + from } else { from };
        let source = self.surfaces[..at].get(from as usize).filter(|_| from >= 0.0).cloned();
        let source = source.ok_or_else(|| {
            Error::input(format!("found a pickup of surface {from}")).expected("the number of an earlier surface")
        })?;
        let added = values.get(2).map_or(Ok(0.0), |word| parsed(word))?;
        let sign = if kind.ends_with('M') { -1.0 } else { 1.0 };
        let surface = &mut self.surfaces[at];
        match kind.as_str() {
            "CV" | "CVM" => {
                surface.curvature = sign * source.curvature + added;
                surface.conic = source.conic;
                surface.terms = source.terms.map(|term| sign * term);
            }
            "TH" | "THM" => surface.thickness = sign * source.thickness + added,
            "AP" => surface.aperture = source.aperture,
            "GLA" => surface.glass = source.glass,
            _ => return Err(unsupported(&format!("a pickup of {kind}"), "CV, CVM, TH, THM, AP or GLA")),
        }
        Ok(())
    }

    /// Checks that only the distance to the image is solved, and only in a lens without mirrors,
    /// for which it does not matter.
    fn check_solves(&self) -> Result<()> {
        let is_mirror = |surface: &OsloSurface| surface.glass.as_ref().is_some_and(|(_, words)| words[0] == "MIRROR");
        let has_mirror = self.surfaces.iter().any(is_mirror);
        for (i, surface) in self.surfaces.iter().enumerate() {
            let Some((line, column)) = surface.solve else { continue };
            if has_mirror || i + 2 < self.surfaces.len() {
                let what = "a solve of a thickness other than the distance of a lens to its image";
                return Err(unsupported(what, "TH with the thickness").at(line, column));
            }
        }
        Ok(())
    }
}

impl OsloSurface {
    /// Returns the operands of the surface with this number, of which 0 is the object.
    fn operands(&self, number: usize) -> Vec<Operand> {
        let place = self.place;
        let one = |name, value: f64| Operand::new(place, name, &[&value.to_string()]);
        let is_far_object = number == 0 && self.thickness >= FAR;
        let mut operands = vec![Operand::new(place, "SURF", &[]), one("CURV", self.curvature), one("CONI", self.conic)];
        operands.push(if is_far_object {
            Operand::new(place, "DISZ", &["INFINITY"])
        } else {
            one("DISZ", self.thickness)
        });
        if self.terms.iter().any(|term| *term != 0.0) {
            operands.push(Operand::new(place, "TYPE", &["EVENASPH"]));
            let terms = TERMS.iter().zip(&self.terms);
            operands.extend(terms.map(|((_, number), term)| Operand::new(place, "PARM", &[number, &term.to_string()])));
        }
        if self.aperture > 0.0 {
            operands.push(one("DIAM", self.aperture));
        }
        if self.stop {
            operands.push(Operand::new(place, "STOP", &[]));
        }
        if let Some((place, arguments)) = &self.glass {
            operands.push(Operand { place: *place, name: "GLAS", arguments: arguments.clone() });
        }
        operands
    }
}

/// Returns the arguments of a `GLAS` operand for a name, for an index, or for the indices of a
/// model glass at the wavelengths (`MOD` and a name may precede them).
fn glass(values: &[String], wavelengths_um: &[f64], catalogues: &[AgfCatalogue]) -> Result<Vec<String>> {
    let what = || Error::input("found GLA without a glass").expected("a name or an index");
    let first = values.first().ok_or_else(what)?;
    let is_model = first.eq_ignore_ascii_case("MOD");
    let indices = if is_model { values.get(2..).unwrap_or_default() } else { values };
    if !is_model && first.parse::<f64>().is_err() {
        return Ok(vec![glass_name(first, catalogues).to_string()]);
    }
    let indices: Vec<f64> = indices.iter().map(|word| parsed(word)).collect::<Result<_>>()?;
    let Some(&n) = indices.first() else { return Err(what()) };
    let (nd, vd) = nd_and_vd(n, &indices, wavelengths_um);
    Ok(["___BLANK".to_string(), "1".to_string(), "0".to_string(), nd.to_string(), vd.to_string()].to_vec())
}

/// Returns n_d and V_d of n = a + b/λ² through the first index, with the dispersion between the
/// shortest and the longest wavelength. V_d is 0 without dispersion.
fn nd_and_vd(n: f64, indices: &[f64], wavelengths_um: &[f64]) -> (f64, f64) {
    let square = |um: f64| 1.0 / (um * um);
    let known = || wavelengths_um.iter().copied().zip(indices.iter().copied());
    let short = known().min_by(|a, b| a.0.total_cmp(&b.0));
    let long = known().max_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(short), Some(long)) = (short, long) else { return (n, 0.0) };
    let [f, d, c] = [lines::F_NM, lines::D_NM, lines::C_NM].map(|nm| square(1e-3 * nm));
    let b = (short.1 - long.1) / (square(short.0) - square(long.0));
    if !(b.is_finite() && b > 0.0) {
        return (n, 0.0);
    }
    let nd = n + b * (d - square(wavelengths_um[0]));
    (nd, (nd - 1.0) / (b * (f - c)))
}

/// Splits a text into commands of words, where quotes join words.
fn commands(text: &str) -> Vec<Command> {
    let mut commands: Vec<Command> = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let (mut quoted, mut open, mut ended) = (false, false, true);
        let letters: Vec<char> = line.chars().collect();
        for (column, letter) in letters.iter().copied().enumerate() {
            let is_comment = letter == '/' && letters.get(column + 1) == Some(&'/');
            match letter {
                '/' if is_comment && !quoted => break,
                ';' if !quoted => (ended, open) = (true, false),
                _ if (letter.is_whitespace() || letter == ',') && !quoted => open = false,
                _ => {
                    if ended {
                        commands.push(Command { place: (i + 1, column + 1), words: Vec::new() });
                        ended = false;
                    }
                    let Some(command) = commands.last_mut() else { continue };
                    if !open {
                        command.words.push(String::new());
                        open = true;
                    }
                    if letter == '"' {
                        quoted = !quoted;
                    } else if let Some(word) = command.words.last_mut() {
                        word.push(letter);
                    }
                }
            }
        }
    }
    commands
}

#[cfg(test)]
mod tests {
    use crate::glass::lines;
    use crate::lens::zemax::{ZmxSystem, parse, parse_system};

    const ACHROMAT: &str = "// OSLO 6.6 58447     0     0\nLEN NEW \"An achromat\" 100 4\nEBR 12.5; ANG 1.0\nDES \"OSLO\"\nUNI 1.0\n\
        // SRF 0\nAIR\nTH 1.0e+20\nAP 1.7e18\nNXT // SRF 1\nGLA NBK7\nRD 61.47\nTH 6.0\nAP CHK 12.7\nAST\nNXT // SRF 2\nGLA N-SF5\n\
        RD -44.64\nTH 2.5\nNXT // SRF 3\nAIR\nRD -129.94\nPY 0.0\nCC -0.5\nAD 1e-7\nNXT // SRF 4\nAIR\nTH 0.1\n\
        WV 0.58756 0.48613 0.65627\nWW 1.0 1.0 1.0\nEND  4\nCFG NEW\nRD 99\n";

    #[test]
    fn a_lens_file_gives_the_lens_of_the_same_zemax_file() {
        let zmx = "NAME An achromat\nUNIT MM\nENPD 25\nFTYP 0\nYFLN 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.016268098259313486\n\
            DISZ 6\n  GLAS N-BK7\n  DIAM 12.7\nSURF 2\n  CURV -0.022401433691756272\n  DISZ 2.5\n  GLAS N-SF5\nSURF 3\n  TYPE EVENASPH\n\
            CURV -0.007695859627520394\n  DISZ 0\n  CONI -0.5\n  PARM 2 1e-7\n  PARM 5 0\nSURF 4\n  DISZ 0\n";
        let parsed = |text: &str, path: &str| parse(text.as_bytes(), path.as_ref(), &[]).unwrap();
        let (ours, theirs) = (parsed(ACHROMAT, "a.len"), parsed(zmx, "a.zmx"));
        assert_eq!(ours, theirs);
        let paraxial = |lens: &crate::lens::Lens| lens.at(lines::D_NM).paraxial().unwrap();
        // Lengths in inches, in a file that states its unit in mm.
        let inches = parsed(&ACHROMAT.replace("UNI 1.0", "UNI 25.4"), "a.len");
        assert!((paraxial(&inches).efl_mm / paraxial(&ours).efl_mm - 25.4).abs() < 1e-9);
    }

    /// The three indices are those of N-BK7. The focal length is that of optiland 0.6.3 for the
    /// same file (`optiland.fileio.load_oslo_file`).
    #[test]
    fn model_glasses_and_pickups_are_resolved() {
        let text = "LEN NEW \"pairs\" 50 5\nEBR 5\nANG 2\nTH 1e20\nNXT\nGLA MOD G1 1.5168 1.52238 1.51432\nRD 40\nTH 4\nNXT\nAIR\nRD -60\n\
            TH 3\nNXT\nAST\nTH 3\nPK TH -1\nNXT\nPK GLA 1\nPK CVM 2\nTH 4\nNXT\nAIR\nPK CVM 1 0.001\nTH 30\nNXT\nEND 6\n";
        let lens = parse(text.as_bytes(), "pairs.len".as_ref(), &[]).unwrap();
        let index = &lens.surfaces()[0].index;
        assert!((index.nd() - 1.5168).abs() < 1e-6 && (index.vd().unwrap() - 64.12).abs() < 0.1, "{index:?}");
        let [third, fourth] = [3, 4].map(|i| lens.surfaces()[i].profile.curvature_per_mm);
        assert!((third - 1.0 / 60.0).abs() < 1e-15 && (fourth - (0.001 - 1.0 / 40.0)).abs() < 1e-15);
        assert_eq!((lens.surfaces()[2].thickness_mm, &lens.surfaces()[3].index), (3.0, index));
        let focal_mm = lens.at(lines::D_NM).paraxial().unwrap().efl_mm;
        assert!((focal_mm - 26.363636).abs() < 1e-4, "{focal_mm}");
    }

    #[test]
    fn a_mirror_is_a_folded_system() {
        let text =
            "LEN NEW \"dish\" 100 2\nEBR 10\nANG 0.5\nTH 1e20\nNXT\nAST\nRFL\nRD -200\nCC -1\nTH -100\nNXT\nEND 2\n";
        match parse_system(text.as_bytes(), "dish.len".as_ref(), &[]).unwrap() {
            ZmxSystem::Folded(system) => {
                let analysis = system.analysis(crate::lens::AnalysisConditions::default()).unwrap();
                assert!((analysis.efl_mm[0].unwrap() - 100.0).abs() < 1e-5 && analysis.fields[0].rms_mm[1] < 1e-9);
            }
            ZmxSystem::Lens(_) => panic!("found a lens"),
        }
    }

    #[test]
    fn errors_name_the_line_and_the_column() {
        for (from, to, words) in [
            ("UNI 1.0", "UNI none", &["a.len:5:1", "found \"none\""][..]),
            ("UNI 1.0", "UNI 0", &["a.len:5:1", "a unit of 0 mm"]),
            ("ANG 1.0", "ANG", &["a.len:3:11", "ANG without a value"]),
            ("CC -0.5", "  TLA 2", &["a.len:24:3", "TLA is not supported"]),
            ("CC -0.5", "ASP ASR", &["a.len:24:1", "ASP is not supported", "AD to AG"]),
            ("CC -0.5", "PK CV 7", &["a.len:24:1", "a pickup of surface 7", "an earlier surface"]),
            ("CC -0.5", "PK LN 1 2", &["a.len:24:1", "a pickup of LN"]),
            ("TH 2.5", "PY 0", &["a.len:19:1", "a solve of a thickness"]),
            ("N-SF5", "N-SF500", &["a.len:17:1", "unknown glass \"N-SF500\""]),
            ("LEN NEW", "NEW", &["a.len", "no LEN command"]),
        ] {
            let text = ACHROMAT.replacen(from, to, 1);
            let error = parse(text.as_bytes(), "a.len".as_ref(), &[]).unwrap_err().to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{to}: {error}");
        }
    }
}
