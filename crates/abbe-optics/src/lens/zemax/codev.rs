//! CODE V sequence files (`.seq`), whose commands become operands of a Zemax file.
//!
//! A command ends at the end of its line or at `;`. The sign `!` starts a comment, and `&` at the
//! end of a line continues it. Case is ignored. [`COMMANDS`] lists what the reader uses; it refuses
//! commands that are known to change the rays but are not supported, and ignores all others.

use super::operand::{Operand, glass_name, read_all};
use super::reader::ZmxReader;
use super::words::{parsed, unsupported};
use crate::glass::AgfCatalogue;
use abbe_spectra::error::{Error, Result};

/// What a command does.
#[derive(Debug, Clone, Copy)]
enum Meaning {
    /// The same as this operand, with the same arguments.
    Same(&'static str),
    /// `RDM`: the first value of a surface is a radius, or after `N` a curvature as without `RDM`.
    RadiusMode,
    /// `DIM`: the unit of length.
    Unit,
    /// `NA`: the numerical aperture at the image.
    ImageAperture,
    /// Fields of this Zemax type, along this axis.
    Field(&'static str, &'static str),
    /// A radius of curvature.
    Radius,
    /// A thickness.
    Thickness,
    /// A glass.
    Glass,
    /// A coefficient of an asphere, with the number of its Zemax parameter.
    Term(&'static str),
    /// A circular aperture, or with `OBS` an obscuration.
    Circle,
    /// An error, unless all values are 0.
    Zero,
    /// An error.
    Refused,
    /// The start of the data of private glasses, which end at `END`.
    PrivateGlasses,
}

/// The commands that the reader knows, besides those of surfaces (`SO`, `S`, `S3`, `SI`).
const COMMANDS: [(&str, Meaning); 57] = [
    ("TITLE", Meaning::Same("NAME")),
    ("TIT", Meaning::Same("NAME")),
    ("RDM", Meaning::RadiusMode),
    ("DIM", Meaning::Unit),
    ("EPD", Meaning::Same("ENPD")),
    ("FNO", Meaning::Same("FNUM")),
    ("NAO", Meaning::Same("OBNA")),
    ("NA", Meaning::ImageAperture),
    ("XAN", Meaning::Field("0", "XFLN")),
    ("YAN", Meaning::Field("0", "YFLN")),
    ("XOB", Meaning::Field("1", "XFLN")),
    ("YOB", Meaning::Field("1", "YFLN")),
    ("XIM", Meaning::Field("2", "XFLN")),
    ("YIM", Meaning::Field("2", "YFLN")),
    ("XRI", Meaning::Field("2", "XFLN")),
    ("YRI", Meaning::Field("2", "YFLN")),
    ("RDY", Meaning::Radius),
    ("CUY", Meaning::Same("CURV")),
    ("THI", Meaning::Thickness),
    ("GLA", Meaning::Glass),
    ("STO", Meaning::Same("STOP")),
    ("STOP", Meaning::Same("STOP")),
    ("K", Meaning::Same("CONI")),
    ("A", Meaning::Term("2")),
    ("B", Meaning::Term("3")),
    ("C", Meaning::Term("4")),
    ("D", Meaning::Term("5")),
    ("E", Meaning::Term("6")),
    ("F", Meaning::Term("7")),
    ("G", Meaning::Term("8")),
    ("H", Meaning::Term("9")),
    ("J", Meaning::Term("10")),
    ("CIR", Meaning::Circle),
    ("REX", Meaning::Same("REX")),
    ("REY", Meaning::Same("REY")),
    ("ELX", Meaning::Same("ELX")),
    ("ELY", Meaning::Same("ELY")),
    ("XDE", Meaning::Zero),
    ("YDE", Meaning::Zero),
    ("ZDE", Meaning::Zero),
    ("ADE", Meaning::Zero),
    ("BDE", Meaning::Zero),
    ("CDE", Meaning::Zero),
    ("ZOO", Meaning::Refused),
    ("SPS", Meaning::Refused),
    ("DIF", Meaning::Refused),
    ("GRT", Meaning::Refused),
    ("CYL", Meaning::Refused),
    ("YTO", Meaning::Refused),
    ("XTO", Meaning::Refused),
    ("AAS", Meaning::Refused),
    ("SPL", Meaning::Refused),
    ("XYP", Meaning::Refused),
    ("ARY", Meaning::Refused),
    ("NSS", Meaning::Refused),
    ("GRN", Meaning::Refused),
    ("PRV", Meaning::PrivateGlasses),
];

/// Distances in any unit from which on the object is at infinity, and surfaces are plane.
const FAR: f64 = 1e9;

/// A command with its place from 1.
struct Command {
    line: usize,
    column: usize,
    words: Vec<String>,
}

/// The commands that are read so far.
#[derive(Default)]
struct Sequence {
    /// True if the first value of a surface is a radius of curvature.
    radii: bool,
    private_glasses: bool,
    header: Vec<Operand>,
    surfaces: Vec<Vec<Operand>>,
}

/// Reads the text of a file. Returns an error with its line and column for an unsupported command
/// or a malformed value.
pub(super) fn read(text: &str, reader: &mut ZmxReader<'_>, catalogues: &[AgfCatalogue]) -> Result<()> {
    let mut sequence = Sequence::default();
    for command in commands(text) {
        sequence.command(&command, catalogues).map_err(|error| error.at(command.line, command.column))?;
    }
    let Sequence { header, surfaces, .. } = sequence;
    read_all(header.iter().chain(surfaces.iter().flatten()), reader)
}

impl Sequence {
    fn command(&mut self, command: &Command, catalogues: &[AgfCatalogue]) -> Result<()> {
        let place = (command.line, command.column);
        let Some((first, values)) = command.words.split_first() else { return Ok(()) };
        let keyword = first.to_uppercase();
        if self.private_glasses {
            self.private_glasses = keyword != "END";
            return Ok(());
        }
        if let Some(number) = surface_number(&keyword, self.surfaces.len()) {
            return self.surface(number, place, values, catalogues);
        }
        let Some((_, meaning)) = COMMANDS.iter().find(|(name, _)| *name == keyword) else { return Ok(()) };
        // A command may name its surface.
        let named = values.first().and_then(|word| surface_number(&word.to_uppercase(), self.surfaces.len()));
        let values = if named.is_some() { &values[1..] } else { values };
        let value = || values.first().ok_or_else(|| Error::input(format!("found {keyword} without a value")));
        let of_surface = |name: &'static str, words: &[&str]| vec![Operand::new(place, name, words)];
        let operands = match meaning {
            Meaning::RadiusMode => {
                self.radii = !values.first().is_some_and(|value| value.eq_ignore_ascii_case("N"));
                return Ok(());
            }
            Meaning::PrivateGlasses => {
                self.private_glasses = true;
                return Ok(());
            }
            Meaning::Refused => return Err(unsupported(&keyword, "surfaces that are spheres, conics or aspheres")),
            Meaning::Zero => {
                return match parsed(value()?)? {
                    0.0 => Ok(()),
                    _ => Err(unsupported("a tilted or decentred surface of a CODE V file", "surfaces on one axis")),
                };
            }
            Meaning::Unit => {
                let unit = match value()?.to_uppercase().as_str() {
                    "M" => "MM",
                    "C" => "CM",
                    "I" => "IN",
                    other => return Err(unsupported(&format!("the unit {other}"), "M (mm), C (cm) or I (inches)")),
                };
                self.header.extend(of_surface("UNIT", &[unit]));
                return Ok(());
            }
            Meaning::ImageAperture => {
                let f_number = 0.5 / parsed(value()?)?;
                self.header.extend(of_surface("FNUM", &[&f_number.to_string()]));
                return Ok(());
            }
            Meaning::Field(kind, axis) => {
                self.header.extend(of_surface("FTYP", &[kind]));
                self.header.push(Operand { place, name: axis, arguments: values.to_vec() });
                return Ok(());
            }
            Meaning::Same(name @ ("NAME" | "ENPD" | "FNUM" | "OBNA")) => {
                self.header.push(Operand { place, name, arguments: values.to_vec() });
                return Ok(());
            }
            Meaning::Same(name) => vec![Operand { place, name, arguments: values.to_vec() }],
            Meaning::Radius => of_surface("CURV", &[&curvature(value()?)?]),
            Meaning::Thickness => of_surface("DISZ", &[&distance(value()?)?]),
            Meaning::Glass => glass(value()?, catalogues, place),
            Meaning::Term(number) => {
                let mut operands = of_surface("TYPE", &["EVENASPH"]);
                operands.extend(of_surface("PARM", &[number, value()?]));
                operands
            }
            Meaning::Circle => {
                let is = |word: &str| values.iter().any(|value| value.eq_ignore_ascii_case(word));
                let radius = values.last().ok_or_else(|| Error::input("found CIR without a radius"))?;
                match (is("OBS"), is("EDG")) {
                    (true, _) => of_surface("OBSC", &["0", radius]),
                    (false, true) => Vec::new(),
                    (false, false) => of_surface("CLAP", &["0", radius]),
                }
            }
        };
        let number = named.unwrap_or_else(|| self.surfaces.len().saturating_sub(1));
        let what = || Error::input(format!("{keyword} does not follow a surface")).expected("SO, S or SI");
        self.surfaces.get_mut(number).ok_or_else(what)?.extend(operands);
        Ok(())
    }

    /// Adds a surface, or changes an existing one: the radius or curvature, the thickness and the
    /// glass, each of which may be absent.
    fn surface(
        &mut self,
        number: usize,
        place: (usize, usize),
        values: &[String],
        catalogues: &[AgfCatalogue],
    ) -> Result<()> {
        let one = |name: &'static str, argument: String| Operand { place, name, arguments: vec![argument] };
        if number == self.surfaces.len() {
            self.surfaces.push(vec![Operand { place, name: "SURF", arguments: Vec::new() }]);
        }
        let what = || Error::input(format!("found surface {number}")).expected("surfaces in their order");
        let operands = self.surfaces.get_mut(number).ok_or_else(what)?;
        if let Some(word) = values.first() {
            operands.push(one("CURV", if self.radii { curvature(word)? } else { word.clone() }));
        }
        if let Some(word) = values.get(1) {
            operands.push(one("DISZ", distance(word)?));
        }
        if let Some(word) = values.get(2) {
            operands.extend(glass(word, catalogues, place));
        }
        Ok(())
    }
}

/// Returns the number of a surface (`SO` is 0; `S` and `SI` follow the last of `count` surfaces).
fn surface_number(word: &str, count: usize) -> Option<usize> {
    match word.strip_prefix('S')? {
        "" | "I" => Some(count),
        "O" => Some(0),
        digits => digits.parse().ok(),
    }
}

/// Returns the operands of a glass: the name of a catalogue with an underscore and a maker or not,
/// `REFL` for a mirror, or n_d and V_d with a colon between them.
fn glass(word: &str, catalogues: &[AgfCatalogue], place: (usize, usize)) -> Vec<Operand> {
    let operand = |words: &[&str]| vec![Operand::new(place, "GLAS", words)];
    if word.eq_ignore_ascii_case("AIR") {
        return Vec::new();
    }
    if word.eq_ignore_ascii_case("REFL") {
        return operand(&["MIRROR"]);
    }
    if let Some((nd, vd)) = word.split_once(':') {
        return operand(&["___BLANK", "1", "0", nd, vd]);
    }
    // CODE V leaves the hyphens out: NBK7_SCHOTT is N-BK7.
    let plain = word.split('_').next().unwrap_or(word);
    operand(&[glass_name(plain, catalogues)])
}

fn curvature(radius: &str) -> Result<String> {
    let radius = parsed(radius)?;
    Ok(if radius == 0.0 || radius.abs() >= FAR { "0".to_string() } else { (1.0 / radius).to_string() })
}

fn distance(word: &str) -> Result<String> {
    Ok(if parsed(word)? >= FAR { "INFINITY".to_string() } else { word.to_string() })
}

/// Splits a text into commands of words, where quotes join words.
fn commands(text: &str) -> Vec<Command> {
    let mut commands: Vec<Command> = Vec::new();
    let mut continued = false;
    for (i, line) in text.lines().enumerate() {
        let mut quote = None;
        let mut word_open = false;
        let mut ended = !continued;
        continued = false;
        for (column, letter) in line.chars().enumerate() {
            match (quote, letter) {
                (None, '!') => break,
                (None, ';') => (ended, word_open) = (true, false),
                (None, '&') => continued = true,
                (None, '\'' | '"') => quote = Some(letter),
                (Some(open), _) if open == letter => quote = None,
                (None, _) if letter.is_whitespace() => word_open = false,
                (_, _) => {
                    if ended {
                        commands.push(Command { line: i + 1, column: column + 1, words: Vec::new() });
                        ended = false;
                    }
                    if let Some(command) = commands.last_mut() {
                        if !word_open {
                            command.words.push(String::new());
                        }
                        command.words.last_mut().into_iter().for_each(|word| word.push(letter));
                    }
                    word_open = true;
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

    const ACHROMAT: &str = "RDM;LEN \"VERSION: 11\"\nTITLE 'An achromat'  ! of two glasses\nEPD 25.0; DIM M\nYAN 0.0 &\n 1.0\n\
        SO 0.0 0.1e14\nS 61.47 6.0 NBK7_SCHOTT\n  STO\n  CIR 12.7\ns -44.64 2.5 N-SF5\nS -129.94 95.95\n  K -0.5\n  A 1e-7\nSI 0.0 0.0\nGO\n";

    #[test]
    fn a_sequence_gives_the_lens_of_the_same_zemax_file() {
        let zmx = "NAME An achromat\nUNIT MM\nENPD 25\nFTYP 0\nYFLN 0 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.016268098259313486\n\
            DISZ 6\n  GLAS N-BK7\n  CLAP 0 12.7\nSURF 2\n  CURV -0.022401433691756272\n  DISZ 2.5\n  GLAS N-SF5\nSURF 3\n  TYPE EVENASPH\n\
            CURV -0.007695859627520394\n  DISZ 95.95\n  CONI -0.5\n  PARM 2 1e-7\nSURF 4\n  DISZ 0\n";
        let [ours, theirs] = [(ACHROMAT, "a.seq"), (zmx, "a.zmx")]
            .map(|(text, path)| parse(text.as_bytes(), path.as_ref(), &[]).unwrap());
        assert_eq!(ours, theirs);
        let curvatures = ACHROMAT.replace("RDM;", "RDM N;").replace("S 61.47", "S 0.016268098259313486");
        let curvatures = curvatures.replace("s -44.64", "s -0.022401433691756272");
        let curvatures = curvatures.replace("S -129.94", "S -0.007695859627520394");
        assert_eq!(parse(curvatures.as_bytes(), "a.seq".as_ref(), &[]).unwrap(), theirs);
    }

    #[test]
    fn surfaces_are_also_changed_by_their_number() {
        let text = ACHROMAT.replace("GO\n", "THI S1 7.0\nRDY S2 -50\nGLA S1 1.5168:64.17\nSTO S2\n");
        let lens = parse(text.as_bytes(), "a.seq".as_ref(), &[]).unwrap();
        assert_eq!((lens.surfaces()[0].thickness_mm, lens.surfaces()[1].profile.curvature_per_mm), (7.0, -0.02));
        assert!((lens.surfaces()[0].index.n(lines::D_NM) - 1.5168).abs() < 1e-12);
    }

    #[test]
    fn a_mirror_is_a_folded_system() {
        let text = "RDM\nEPD 20\nSO 0 1e10\nS -200 -100 REFL\n  STO\nSI 0 0\n";
        let system = parse_system(text.as_bytes(), "m.seq".as_ref(), &[]).unwrap();
        assert!(matches!(system, ZmxSystem::Folded(system) if system.mirrors() == 1));
    }

    #[test]
    fn errors_name_the_line_and_the_column() {
        for (from, to, words) in [
            ("EPD 25.0; DIM M", "EPD 25.0; DIM F", &["a.seq:3:11", "the unit F"][..]),
            ("  K -0.5", "  ADE 2", &["a.seq:12:3", "tilted or decentred"]),
            ("  K -0.5", "  SPS XYP", &["a.seq:12:3", "SPS is not supported"]),
            ("  K -0.5", "  K half", &["a.seq:12:3", "found \"half\""]),
            ("s -44.64", "s -4x", &["a.seq:10:1", "found \"-4x\""]),
            ("N-SF5", "N-SF500", &["a.seq:10:1", "unknown glass \"N-SF500\""]),
            ("SO 0.0", "K 1\nSO 0.0", &["a.seq:6:1", "K does not follow a surface"]),
            ("GO", "S9 1 2", &["a.seq:15:1", "found surface 9"]),
        ] {
            let text = ACHROMAT.replace(from, to);
            assert_ne!(text, ACHROMAT);
            let error = parse(text.as_bytes(), "a.seq".as_ref(), &[]).unwrap_err().to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }
}
