//! Glasses of the makers' catalogues, and the names under which lens files know them.
//!
//! `data/glass/makers.agf` holds the dispersion formulas of the glasses of Schott, Ohara, Hoya,
//! Hikari, CDGM and Sumita that the built-in catalogue lacks.

use std::path::Path;
use std::sync::LazyLock;

use super::agf::AgfCatalogue;
use super::catalogue::{self, Glass};
use super::index::RefractiveIndex;
use abbe_spectra::error::{Error, Result};

/// Names of lens files without a rule, in upper case, and the glasses that replace them.
const SUBSTITUTES: [(&str, &str); 14] = [
    ("SILICA", "fused silica"),
    ("F_SILICA", "fused silica"),
    ("FUSEDSILICA", "fused silica"),
    ("FUSED_SILICA", "fused silica"),
    ("SIO2", "fused silica"),
    ("C79-80", "fused silica"),
    ("SUPRASIL", "fused silica"),
    ("INFRASIL", "fused silica"),
    ("K9", "H-K9L"),
    ("ACRYLIC", "PMMA"),
    ("POLYCARB", "polycarbonate"),
    ("POLYSTYR", "polystyrene"),
    ("LASFN31", "N-LASF31"),
    ("LAFN21", "N-LAF21"),
];

/// Glasses without a formula here: lines of a name, n_d and V_d.
static MODELS: LazyLock<Vec<(&str, f64, f64)>> = LazyLock::new(|| {
    let lines = include_str!("../../data/glass/models.txt").lines().filter(|line| !line.starts_with('#'));
    let row = |line: &'static str| {
        let mut words = line.split(' ');
        Some((words.next()?, words.next()?.parse().ok()?, words.next()?.parse().ok()?))
    };
    lines.map(|line| row(line).expect("a test parses the table")).collect()
});

/// Materials of infrared lenses, of which each name begins with one of these.
const OPAQUE: [&str; 6] = ["GERMANIUM", "SILICON", "GAAS", "AMTIR", "IRG2", "GASIR"];

static MAKERS: LazyLock<AgfCatalogue> = LazyLock::new(|| {
    let path = Path::new("refractiveindex.info, catalogues of the makers");
    AgfCatalogue::parse(include_bytes!("../../data/glass/makers.agf"), path).expect("a test parses the catalogue")
});

/// Returns the glasses of the makers that are not in the built-in catalogue.
pub fn makers() -> &'static AgfCatalogue {
    &MAKERS
}

/// Returns a glass of the built-in catalogue or of a maker; case is ignored. The error for an
/// unknown name suggests a similar one of the built-in catalogue.
pub fn find(name: &str) -> Result<Glass> {
    catalogue::find(name).cloned().or_else(|unknown| MAKERS.find(name).map_err(|_| unknown))
}

impl RefractiveIndex {
    /// Returns the index of a material by name, in any case, or an error if it is unknown.
    pub fn catalogue(name: &str) -> Result<Self> {
        Ok(find(name)?.index)
    }
}

/// Returns the index of a glass of a lens file. The search covers `catalogues` in their order, the
/// built-in catalogue, the makers' glasses, those of `catalogues` that are a last resort, and then
/// substitutes for the name: glasses that replaced an old one (N-BK7 for BK7), and models of the
/// n_d and V_d of the maker or of the glass code (517642 for n_d 1.517 and V_d 64.2).
/// `notes` gets a remark that names the substitute. Returns an error if the name is unknown.
pub fn in_lens_file(name: &str, catalogues: &[AgfCatalogue], notes: &mut Vec<String>) -> Result<RefractiveIndex> {
    let of_file = |name: &str, last_resort: bool| {
        let file = catalogues.iter().find(|file| file.is_last_resort() == last_resort && file.has(name))?;
        Some(file.find(name).map(|glass| glass.index))
    };
    let exact = |name: &str| {
        let built_in =
            |first: Option<Result<RefractiveIndex>>| first.unwrap_or_else(|| RefractiveIndex::catalogue(name));
        built_in(of_file(name, false)).or_else(|unknown| of_file(name, true).unwrap_or(Err(unknown)))
    };
    if name.eq_ignore_ascii_case("air") {
        return RefractiveIndex::constant(1.0);
    }
    // A glass of a user's catalogue with an unsupported formula is an error without a substitute.
    let unknown = match exact(name) {
        Ok(index) => return Ok(index),
        Err(error) if error.location.file.is_some() => return Err(error),
        Err(error) => error,
    };
    let mut note = |note: String| {
        if !notes.contains(&note) {
            notes.push(note);
        }
    };
    for other in substitutes(name) {
        if let Ok(index) = exact(&other) {
            note(format!("the glass {name} is not in the catalogues; {other} replaces it"));
            return Ok(index);
        }
    }
    let is_model = |model: &str| {
        // The names of LZOS in lens files may lack the prefix of this table.
        name.eq_ignore_ascii_case(model)
            || model.strip_prefix("LZ_").is_some_and(|lzos| name.eq_ignore_ascii_case(lzos))
    };
    if let Some((_, nd, vd)) = MODELS.iter().find(|(model, _, _)| is_model(model)) {
        note(format!("the glass {name} is a model of the n_d {nd} and the Abbe number {vd} of its maker"));
        return RefractiveIndex::abbe(*nd, *vd);
    }
    if let Some((nd, vd)) = glass_code(name) {
        note(format!("the glass {name} is a model of the n_d {nd} and the Abbe number {vd} of this code"));
        return RefractiveIndex::abbe(nd, vd);
    }
    if OPAQUE.iter().any(|opaque| name.to_uppercase().starts_with(opaque)) {
        return Err(Error::input(format!(
            "the material {name} is opaque in visible light, in which lenses are analysed"
        )));
    }
    Err(unknown)
}

/// Returns the names of glasses that may replace this one, the most similar first.
fn substitutes(name: &str) -> Vec<String> {
    let upper = name.to_uppercase();
    let listed = SUBSTITUTES.iter().filter(|(old, _)| *old == upper).map(|(_, new)| (*new).to_string());
    // Schott's glasses without lead and arsenic have the prefix N.
    listed.chain([format!("N-{upper}")]).collect()
}

/// Reads a glass code: the digits of n_d behind the point, and those of the Abbe number, of which
/// two stand before the point (`517642`, `517.642`, `516800.641700`).
fn glass_code(name: &str) -> Option<(f64, f64)> {
    let (index, abbe) = match name.split_once('.') {
        Some(parts) => parts,
        None if name.len() == 6 && name.is_ascii() => name.split_at(3),
        None => return None,
    };
    let is_code = |digits: &str| (2..=9).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit());
    if !(is_code(index) && index.len() >= 3 && is_code(abbe)) {
        return None;
    }
    let nd = format!("1.{index}").parse().ok()?;
    let vd = format!("{}.{}", &abbe[..2], &abbe[2..]).parse().ok().filter(|vd| *vd > 0.0)?;
    Some((nd, vd))
}

/// Returns the index of a model glass with two Cauchy terms. The Abbe number 0 means no dispersion.
///
/// # Errors
/// Returns an error if the index is below 1 in the band, or the Abbe number is negative.
pub fn model_glass(nd: f64, vd: f64) -> Result<RefractiveIndex> {
    if nd < 1.0 {
        let what = format!("found a model glass of n_d {nd}");
        return Err(Error::input(what).expected("an index of at least 1, relative to air"));
    }
    if vd == 0.0 { RefractiveIndex::constant(nd) } else { RefractiveIndex::abbe(nd, vd) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glass::lines;

    /// The third and fourth values of an `NM` line are n_d and V_d as published.
    #[test]
    fn every_glass_of_the_makers_has_its_published_index() {
        let text = include_str!("../../data/glass/makers.agf");
        let rows: Vec<Vec<&str>> =
            text.lines().filter(|l| l.starts_with("NM ")).map(|l| l.split(' ').collect()).collect();
        assert_eq!((rows.len(), MAKERS.names().count()), (1495, 1495));
        for row in rows {
            let index = MAKERS.find(row[1]).unwrap().index;
            let (nd, vd): (f64, f64) = (row[4].parse().unwrap(), row[5].parse().unwrap());
            assert!((index.nd() - nd).abs() < 1e-6, "{row:?}: {}", index.nd());
            assert!((index.vd().unwrap() / vd - 1.0).abs() < 1e-4, "{row:?}: {:?}", index.vd());
            assert!(catalogue::all().iter().all(|glass| !glass.name.eq_ignore_ascii_case(row[1])), "{row:?}");
        }
    }

    #[test]
    fn an_old_name_gives_its_successor_and_one_note() {
        let mut notes = Vec::new();
        for (old, new) in [("BK7", "N-BK7"), ("SILICA", "fused silica"), ("lasfn31", "N-LASF31"), ("acrylic", "PMMA")] {
            for _ in 0..2 {
                let index = in_lens_file(old, &[], &mut notes).unwrap();
                assert_eq!(index, RefractiveIndex::catalogue(new).unwrap());
            }
            assert!(notes.pop().unwrap().contains(&format!("the glass {old} is not in the catalogues; {new}")));
            assert!(notes.is_empty());
        }
        in_lens_file("S-LAH64", &[], &mut notes).unwrap();
        assert!(notes.is_empty() && in_lens_file("NOGLASS", &[], &mut notes).is_err());
    }

    /// Values of Schott's catalogue of 1980 and of GOST 3514.
    #[test]
    fn old_glasses_are_models_of_their_published_values() {
        for (name, nd, vd) in [("BaSF1", 1.62606, 39.09), ("LAK11", 1.6583, 57.26), ("LZ_K8", 1.51637, 64.05)] {
            let mut notes = Vec::new();
            let index = in_lens_file(name, &[], &mut notes).unwrap();
            assert!((index.nd() - nd).abs() < 2e-5 && (index.vd().unwrap() - vd).abs() < 0.1, "{name}");
            assert!(notes[0].contains("is a model"), "{notes:?}");
        }
        assert_eq!(in_lens_file("K8", &[], &mut Vec::new()), in_lens_file("LZ_K8", &[], &mut Vec::new()));
        let opaque = in_lens_file("GERMANIUM", &[], &mut Vec::new()).unwrap_err().to_string();
        assert!(opaque.contains("GERMANIUM is opaque in visible light"), "{opaque}");
    }

    /// Makers use some names, such as F2, for different glasses.
    #[test]
    fn a_last_resort_does_not_hide_the_built_in_glasses() {
        let file = |name: &str| {
            let text = format!("NM {name} 5 0 1.9 9\nCD 1.9 0 0\nLD 0.3 2\n");
            AgfCatalogue::parse(text.as_bytes(), "other.agf".as_ref()).unwrap()
        };
        let nd = |name: &str, files: &[AgfCatalogue]| in_lens_file(name, files, &mut Vec::new()).unwrap().nd();
        assert_eq!(nd("F2", &[file("F2")]), 1.9);
        assert_eq!(nd("F2", &[file("F2").as_last_resort()]), nd("F2", &[]));
        assert_eq!(nd("OWN", &[file("OWN").as_last_resort()]), 1.9);
    }

    #[test]
    fn a_glass_code_gives_a_model_glass() {
        for (code, nd, vd) in [("517642", 1.517, 64.2), ("517.642", 1.517, 64.2), ("516800.641700", 1.5168, 64.17)] {
            let index = in_lens_file(code, &[], &mut Vec::new()).unwrap();
            assert!((index.n(lines::D_NM) - nd).abs() < 1e-9 && (index.vd().unwrap() - vd).abs() < 1e-6, "{code}");
        }
        for other in ["51764", "517-642", "1.5", "517.6x", "517.", "é7642"] {
            assert_eq!(glass_code(other), None, "{other}");
        }
    }

    /// The guide states these errors of a model glass.
    #[test]
    fn a_model_glass_is_near_the_true_formula() {
        let worst = |names: &mut dyn Iterator<Item = &str>, from: f64, to: f64| {
            names.fold(0.0_f64, |worst, name| {
                let index = find(name).unwrap().index;
                let model = model_glass(index.nd(), index.vd().unwrap()).unwrap();
                let error = |nm: f64| (index.n(nm) - model.n(nm)).abs();
                (0..=100).map(|i| error(from + (to - from) * f64::from(i) / 100.0)).fold(worst, f64::max)
            })
        };
        let names = ["N-BK7", "N-SK16", "F2", "N-LASF44", "N-SF6", "N-FK51A"];
        let (visible, band) =
            (worst(&mut names.into_iter(), lines::F_NM, lines::C_NM), worst(&mut names.into_iter(), 400.0, 700.0));
        assert!(visible < 6e-4 && band < 8e-3, "{visible} {band}");
    }
}
