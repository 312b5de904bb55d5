//! IES LM-63: versions of 1986, 1991, 1995, 2002 and 2019.
//!
//! ANSI/IES LM-63-19, *Approved Method: IES Standard File Format for the Electronic Transfer of
//! Photometric Data and Related Information*.

use super::number::{MAX_VALUES, PlacedValue, ascending, candela, check_values};
use super::photometry::{LuminaireSymmetry, OpeningSize, Photometry};
use abbe_scene::light::{OpeningShape, PhotometricType};
use abbe_spectra::error::{Error, Result};

/// The length of a foot in m.
const METRES_PER_FOOT: f64 = 0.3048;

/// Reads the text of a file with tilt factors, given its name.
type TiltFile<'a> = &'a dyn Fn(&str) -> Result<String>;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Lm63Version {
    Y1986,
    Y1991,
    Y1995,
    Y2002,
    Y2019,
}

impl Lm63Version {
    /// Recognises the version by the first line, in which some programs write blanks. A file of
    /// 1986 begins with any text.
    fn of(first: &str) -> Result<Self> {
        let words: String = first.split_whitespace().collect::<String>().to_ascii_uppercase();
        let number = words.strip_prefix("IESNA").or(words.strip_prefix("IES:"));
        let Some(number) = number.filter(|_| words.starts_with("IESNA") || words.starts_with("IES:LM-63")) else {
            return Ok(Self::Y1986);
        };
        let number = number.trim_start_matches(':').trim_start_matches("LM-63").trim_start_matches('-');
        let year = number.strip_prefix("19").or(number.strip_prefix("20")).filter(|year| year.len() >= 2);
        let versions =
            [("86", Self::Y1986), ("91", Self::Y1991), ("95", Self::Y1995), ("02", Self::Y2002), ("19", Self::Y2019)];
        let year = year.unwrap_or(number);
        let known = versions.into_iter().find(|(short, _)| year.starts_with(short)).map(|(_, version)| version);
        known.ok_or_else(|| {
            let shown: String = first.trim().chars().take(40).collect();
            let versions = "IESNA91, IESNA:LM-63-1995, IESNA:LM-63-2002 or IES:LM-63-2019";
            Error::input(format!("the version \"{shown}\"")).expected(versions).at(1, 1)
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Y1986 => "IES LM-63-1986",
            Self::Y1991 => "IES LM-63-1991",
            Self::Y1995 => "IES LM-63-1995",
            Self::Y2002 => "IES LM-63-2002",
            Self::Y2019 => "IES LM-63-2019",
        }
    }
}

/// The numbers of a file, which blanks, line ends or commas separate.
struct NumberReader<'a> {
    words: Box<dyn Iterator<Item = (&'a str, (usize, usize))> + 'a>,
    /// The line after the last one.
    end: usize,
}

impl<'a> NumberReader<'a> {
    /// The numbers of these lines. The first line has the number `first`, counted from 1.
    fn new(lines: &'a [&'a str], first: usize) -> Self {
        let words =
            lines.iter().enumerate().flat_map(move |(i, row)| words(row).map(move |(at, w)| (w, (first + i, at))));
        Self { words: Box::new(words), end: first + lines.len().saturating_sub(1) }
    }

    fn next(&mut self, what: &str) -> Result<PlacedValue> {
        let Some((word, (line, column))) = self.words.next() else {
            return Err(Error::input("the file ends too early").expected(what).at(self.end, 1));
        };
        PlacedValue::parse(word, what, line, column)
    }

    fn list(&mut self, what: &str, count: usize) -> Result<Vec<PlacedValue>> {
        (0..count).map(|_| self.next(what)).collect()
    }
}

/// Splits a row into words, each with its column.
fn words(row: &str) -> impl Iterator<Item = (usize, &str)> {
    // A file from MS-DOS may end with the character 0x1A.
    let is_separator = |c: char| c.is_whitespace() || c == ',' || c == '\u{1a}';
    let mut start = 0;
    row.split(is_separator).filter_map(move |word| {
        let begin = start;
        start += word.len() + row[begin + word.len()..].chars().next().map_or(0, char::len_utf8);
        (!word.is_empty()).then(|| (row[..begin].chars().count() + 1, word))
    })
}

/// Parses a file. An error has its line and column.
pub(super) fn parse(text: &str, tilt_file: TiltFile<'_>) -> Result<Photometry> {
    let lines: Vec<&str> = text.lines().collect();
    let version = Lm63Version::of(lines.first().copied().unwrap_or_default())?;
    let Some((tilt_line, tilt)) = lines.iter().enumerate().find_map(|(i, line)| Some((i, tilt_value(line)?))) else {
        let what = "a file without a line that begins with TILT=";
        return Err(Error::input(what).expected("an IES LM-63 file"));
    };
    let header = &lines[..tilt_line];
    if let Some(line) = header.iter().position(|line| line.trim_start().starts_with("[BLOCK]")) {
        let what = "a file with several luminaires ([BLOCK])";
        return Err(Error::input(what).expected("a file with one luminaire").at(line + 1, 1));
    }
    let mut numbers = NumberReader::new(&lines[tilt_line + 1..], tilt_line + 2);
    let tilt = match tilt {
        none if none.eq_ignore_ascii_case("NONE") => Vec::new(),
        include if include.eq_ignore_ascii_case("INCLUDE") => tilt_factors(&mut numbers)?,
        name => other_tilt(name, tilt_file).map_err(|error| error.at(tilt_line + 1, 1))?,
    };
    let mut photometry = luminaire(&mut numbers, version)?;
    if let Some((word, (line, column))) = numbers.words.next()
        && word.parse::<f64>().is_ok()
    {
        let what = "more numbers than the counts of angles require";
        return Err(Error::input(what).expected("the end of the file").at(line, column));
    }
    photometry.name = name_of(header, version);
    photometry.tilt = tilt;
    Ok(photometry)
}

/// Returns the value of the line `TILT=`, around whose sign blanks may stand.
fn tilt_value(line: &str) -> Option<&str> {
    let (word, value) = line.split_once('=')?;
    word.trim().eq_ignore_ascii_case("TILT").then(|| value.trim())
}

/// Returns the name of the luminaire from the keywords, or the first line of a file of 1986.
fn name_of(header: &[&str], version: Lm63Version) -> String {
    let keyword = |key: &str| {
        let line = header.iter().find_map(|line| line.trim_start().strip_prefix(key));
        line.map(str::trim).filter(|value| !value.is_empty())
    };
    let named: Vec<&str> = ["[MANUFAC]", "[LUMINAIRE]", "[LUMCAT]"].into_iter().filter_map(keyword).collect();
    let name = if named.is_empty() && version == Lm63Version::Y1986 {
        header.first().copied().unwrap_or_default().to_string()
    } else {
        named.join(", ")
    };
    name.trim().chars().filter(|c| !c.is_control()).take(200).collect()
}

/// Reads tilt factors: the geometry of the lamp, the number of pairs, the angles and the factors.
fn tilt_factors(numbers: &mut NumberReader) -> Result<Vec<(f64, f64)>> {
    let geometry = numbers.next("the geometry of the lamp (1 to 3)")?;
    if ![1.0, 2.0, 3.0].contains(&geometry.value) {
        return Err(geometry.wrong("the geometry of the lamp", "1, 2 or 3"));
    }
    let count = numbers.next("the number of tilt angles")?.count("the number of tilt angles", 1)?;
    let angles = numbers.list("a tilt angle", count)?;
    let angles = ascending(&angles, "a tilt angle", (0.0, 180.0))?;
    let factors = numbers.list("a tilt factor", count)?;
    let factors = factors.iter().map(|factor| factor.not_negative("a tilt factor"));
    Ok(angles.into_iter().zip(factors.collect::<Result<Vec<f64>>>()?).collect())
}

fn other_tilt(name: &str, tilt_file: TiltFile<'_>) -> Result<Vec<(f64, f64)>> {
    let shown: String = name.chars().take(80).collect();
    if name.is_empty() {
        return Err(Error::input("TILT= without a value").expected("TILT=NONE, TILT=INCLUDE or a file"));
    }
    let text = tilt_file(name).map_err(|error| {
        let what = format!("the file \"{shown}\" with tilt factors: {}", error.what);
        let expected = error.expected.unwrap_or_else(|| "TILT=NONE, TILT=INCLUDE or a readable file".to_string());
        Error::input(what).expected(expected)
    })?;
    let lines: Vec<&str> = text.lines().collect();
    tilt_factors(&mut NumberReader::new(&lines, 1)).map_err(|error| {
        let line = error.location.line_column.map_or(1, |(line, _)| line);
        Error { location: Default::default(), what: format!("line {line} of \"{shown}\": {}", error.what), ..error }
    })
}

fn luminaire(numbers: &mut NumberReader, version: Lm63Version) -> Result<Photometry> {
    let lamps = numbers.next("the number of lamps")?;
    let lumens = numbers.next("the lumens per lamp")?;
    let multiplier = numbers.next("the multiplier of the intensities")?;
    let vertical_count = numbers.next("the number of vertical angles")?;
    let verticals = vertical_count.count("the number of vertical angles", 2)?;
    let horizontals = numbers.next("the number of horizontal angles")?.count("the number of horizontal angles", 1)?;
    check_values(verticals, horizontals, vertical_count)?;
    let kind = photometric_type(numbers.next("the photometric type")?)?;
    let units = numbers.next("the type of units")?;
    let metres = match units.value {
        1.0 => METRES_PER_FOOT,
        2.0 => 1.0,
        _ => return Err(units.wrong("the type of units", "1 for feet or 2 for metres")),
    };
    let [width, length, height] = [
        numbers.next("the width of the opening")?,
        numbers.next("the length of the opening")?,
        numbers.next("the height of the opening")?,
    ]
    .map(|side| side.value * metres);
    let ballast = numbers.next("the ballast factor")?.not_negative("the ballast factor")?;
    let second = numbers.next("the factor after the ballast factor")?;
    // Files of 1986 and 1991 state the ballast-lamp photometric factor here. Later versions
    // reserve the number, or state the origin of the file.
    let second = if version <= Lm63Version::Y1991 { second.not_negative("the photometric factor")? } else { 1.0 };
    let watts = numbers.next("the input watts")?.value;
    let factor = multiplier.not_negative("the multiplier of the intensities")? * ballast * second;
    let vertical = numbers.list("a vertical angle", verticals)?;
    let horizontal = numbers.list("a horizontal angle", horizontals)?;
    let (vertical_range, horizontal_range) = match kind {
        PhotometricType::C => ((0.0, 180.0), (0.0, 360.0)),
        PhotometricType::B => ((-180.0, 180.0), (-90.0, 90.0)),
        PhotometricType::A => ((-90.0, 90.0), (-180.0, 180.0)),
    };
    let vertical_deg = ascending(&vertical, "a vertical angle", vertical_range)?;
    let horizontal_deg = ascending(&horizontal, "a horizontal angle", horizontal_range)?;
    let symmetry = symmetry(kind, &vertical_deg, &horizontal_deg).map_err(|error| {
        let place = horizontal.first().map_or((1, 1), |first| (first.line, first.column));
        error.at(place.0, place.1)
    })?;
    let values = numbers.list("an intensity", verticals.saturating_mul(horizontals).min(MAX_VALUES))?;
    let candela = candela(&values, factor)?;
    if candela.iter().all(|value| *value == 0.0) {
        return Err(vertical_count.wrong("all intensities are 0; the number of vertical angles", "light"));
    }
    Ok(Photometry {
        format: version.name().to_string(),
        name: String::new(),
        kind,
        symmetry,
        vertical_deg,
        horizontal_deg,
        candela,
        lamp_lumens: (lumens.value > 0.0 && lamps.value > 0.0).then_some(lamps.value * lumens.value),
        input_watts: (watts > 0.0).then_some(watts),
        opening: opening([width, length, height]),
        tilt: Vec::new(),
        spectrum: None,
        notes: Vec::new(),
    })
}

fn photometric_type(number: PlacedValue) -> Result<PhotometricType> {
    match number.value {
        1.0 => Ok(PhotometricType::C),
        2.0 => Ok(PhotometricType::B),
        3.0 => Ok(PhotometricType::A),
        _ => Err(number.wrong("the photometric type", "1 for type C, 2 for type B or 3 for type A")),
    }
}

/// Returns the symmetry that the ranges of the angles express.
pub(super) fn symmetry(kind: PhotometricType, vertical: &[f64], horizontal: &[f64]) -> Result<LuminaireSymmetry> {
    let ends = |angles: &[f64]| angles.first().zip(angles.last()).map_or((0.0, 0.0), |(first, last)| (*first, *last));
    let (first, last) = ends(horizontal);
    if kind != PhotometricType::C {
        if horizontal.len() < 2 {
            return Err(Error::input("one horizontal angle").expected("two or more for photometry of type A or B"));
        }
        // Angles from 0 are mirrored to negative angles.
        return Ok(match (first == 0.0, ends(vertical).0 == 0.0) {
            (true, true) => LuminaireSymmetry::Quadrants,
            (true, false) => LuminaireSymmetry::AboutC90,
            (false, true) => LuminaireSymmetry::AboutC0,
            (false, false) => LuminaireSymmetry::None,
        });
    }
    if horizontal.len() == 1 {
        return Ok(LuminaireSymmetry::Rotational);
    }
    let widest = horizontal.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    match (first, last) {
        (0.0, 90.0) => Ok(LuminaireSymmetry::Quadrants),
        (0.0, 180.0) => Ok(LuminaireSymmetry::AboutC0),
        (90.0, 270.0) => Ok(LuminaireSymmetry::AboutC90),
        // Some files leave out the plane at 360°, which equals the plane at 0°.
        _ if last - first == 360.0 || (last - first >= 360.0 - 1.5 * widest && horizontal.len() > 2) => {
            Ok(LuminaireSymmetry::None)
        }
        _ => {
            let ranges = "a range of 0° to 0°, 90°, 180° or 360°, or of 90° to 270°";
            Err(Error::input(format!("horizontal angles from {first}° to {last}°")).expected(ranges))
        }
    }
}

/// Returns the flat opening: the width across C0–C180, the length along it. Negative is a diameter.
///
/// A horizontal cylinder is as wide as it is high. Its axis has a length above 0, its diameter is
/// the negative height, and the other side is 0 (1995) or negative (2002).
fn opening([width, length, height]: [f64; 3]) -> OpeningSize {
    let is_cylinder = height < 0.0 && (width > 0.0) != (length > 0.0);
    let shape = match (width, length) {
        _ if is_cylinder => OpeningShape::Rectangle,
        (0.0, 0.0) => OpeningShape::Point,
        _ if width < 0.0 || length < 0.0 => OpeningShape::Ellipse,
        _ => OpeningShape::Rectangle,
    };
    let diameter = |side: f64| if is_cylinder && side == 0.0 { height.abs() } else { side.abs() };
    let (across, along) = (diameter(width), diameter(length));
    // A disk may state only one diameter.
    let is_disk = shape == OpeningShape::Ellipse && (across == 0.0 || along == 0.0);
    let [across, along] = if is_disk { [across.max(along); 2] } else { [across, along] };
    OpeningSize { shape, along_c0_m: along, along_c90_m: across, height_m: height.abs() }
}
