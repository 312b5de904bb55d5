//! Translates spectra of the scene file to functions of wavelength, checked for their role.

use super::context::Resolver;
use crate::{JsonPath, JsonSource, LineFile, SpectrumFile, SpectrumPathFile, is_hex_colour, linear_of_hex};
use abbe_optics::phase::MAX_MEAN_COSINE;
use abbe_spectra::colour::{PrimaryMatch, match_primaries};
use abbe_spectra::error::{Error, Result, both, every};
use abbe_spectra::spectrum::{Observer, Outside, SpectralLine, Spectrum, library, read};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// The use of a spectrum, which decides its valid values and its extrapolation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The power of a light, at any scale: above 0 somewhere in the band, and 0 beyond a table.
    Light,
    /// A reflectance or a transmittance, from 0 to 1. It is constant beyond the ends of a table.
    Reflectance,
    /// The fraction of the light that a fluorophore absorbs, from 0 to 1. It is 0 beyond a table.
    Absorptance,
    /// The absorption coefficient of a dye. Beyond the ends of a table, it is 0.
    DyeAbsorption,
    /// Any other non-negative quantity. It is constant beyond the ends of a table.
    Coefficient,
    /// The mean cosine of a phase function, below 0 for backward light, constant beyond a table.
    MeanCosine,
}

impl Role {
    /// Returns how a spectrum in this role is extrapolated beyond the ends of a table.
    pub fn outside(self) -> Outside {
        match self {
            Self::Light | Self::Absorptance | Self::DyeAbsorption => Outside::Zero,
            Self::Reflectance | Self::Coefficient | Self::MeanCosine => Outside::Hold,
        }
    }
}

/// References between spectra that are nested more deeply are reported as circular.
const MAX_DEPTH: usize = 64;

/// The context in which a spectrum is resolved.
pub(super) struct Spectra<'a> {
    pub(super) named: &'a BTreeMap<String, SpectrumFile>,
    pub(super) source: &'a JsonSource,
    /// Remarks on what the readers of files decided from the values, without repetitions.
    pub(super) notes: &'a RefCell<Vec<String>>,
}

impl Resolver<'_> {
    pub(super) fn spectra(&self) -> Spectra<'_> {
        Spectra { named: &self.scene.spectra, source: self.source, notes: &self.spectrum_notes }
    }

    pub(super) fn spectrum(&self, at: &JsonPath, file: &SpectrumFile, role: Role) -> Result<Spectrum> {
        self.spectra().checked(at, file, role)
    }

    /// Resolves a named spectrum of the scene. The caller needs only the errors.
    pub(super) fn named_spectrum(&self, name: &str, role: Role) -> Result<Spectrum> {
        let root = JsonPath::Root;
        let at = root.key("spectra");
        self.spectra().spectrum_at_depth(&at.key(name), &self.scene.spectra[name], role, 0)
    }

    /// Returns a remark about the colour difference between a spectrum of the form `match` and its
    /// target. Returns `None` for a spectrum of another form.
    pub(super) fn match_note(&self, file: &SpectrumFile, what: &str) -> Option<String> {
        let file = if let SpectrumFile::Name(name) = file { self.scene.spectra.get(name)? } else { file };
        let SpectrumFile::Match { target, primaries } = file else { return None };
        let root = JsonPath::Root;
        let resolve = |file: &SpectrumFile| self.spectra().spectrum_at_depth(&root, file, Role::Light, 0).ok();
        let target = resolve(target)?;
        let primaries: Option<Vec<Spectrum>> = primaries.iter().map(resolve).collect();
        let found = nearest_mix(&target, &primaries?).ok()?;
        let far = if !found.is_exact() { ": the target is outside the gamut of the primaries" } else { "" };
        let left = found.residual;
        Some(format!("{what} matches its target to Δxy {:.5}, ΔE2000 {:.3}{far}", left.delta_xy, left.delta_e_2000))
    }
}

impl Spectra<'_> {
    /// Resolves a spectrum and checks that it is valid for its role.
    pub(super) fn checked(&self, at: &JsonPath, file: &SpectrumFile, role: Role) -> Result<Spectrum> {
        let spectrum = self.spectrum_at_depth(at, file, role, 0)?;
        self.at(at, check_role(&spectrum, role))?;
        Ok(spectrum)
    }

    pub(super) fn at<T>(&self, path: &JsonPath, result: Result<T>) -> Result<T> {
        result.map_err(|error| self.source.error_at(&path.to_string(), error))
    }

    fn spectrum_at_depth(&self, at: &JsonPath, file: &SpectrumFile, role: Role, depth: usize) -> Result<Spectrum> {
        if depth > MAX_DEPTH {
            return self.at(at, Err(Error::input("this spectrum refers to itself, directly or through other spectra")));
        }
        let within = |at: &JsonPath, file: &SpectrumFile| self.spectrum_at_depth(at, file, role, depth + 1);
        let made = match file {
            SpectrumFile::Number(value) => Ok(Spectrum::constant(*value)),
            SpectrumFile::Name(name) => return self.spectrum_by_name(at, name, role, depth),
            SpectrumFile::Table { nm, values } if role == Role::MeanCosine => signed_table(nm, values),
            SpectrumFile::Table { nm, values } => Spectrum::table(nm, values, role.outside()),
            SpectrumFile::File(file) => self.file(file, role),
            SpectrumFile::Lines(lines) => {
                let line = |&LineFile { nm, power, fwhm_nm }: &LineFile| SpectralLine { nm, power, fwhm_nm };
                Spectrum::lines(&lines.iter().map(line).collect::<Vec<_>>())
            }
            SpectrumFile::Blackbody { temperature } => Spectrum::blackbody(*temperature),
            SpectrumFile::Daylight { temperature } => Spectrum::daylight(*temperature),
            SpectrumFile::Gaussian { peak_nm, fwhm_nm } => Spectrum::gaussian(*peak_nm, *fwhm_nm),
            SpectrumFile::Rgb(rgb) => upsampled(*rgb, role),
            SpectrumFile::Srgb(colour) => colour.linear().and_then(|rgb| upsampled(rgb, role)),
            SpectrumFile::Mix(parts) => {
                let at = at.key("mix");
                let parts = parts.iter().enumerate().map(|(i, part)| {
                    let spectrum = within(&at.index(i).key("spectrum"), &part.spectrum);
                    spectrum.map(|spectrum| (part.weight, spectrum))
                });
                let resolved = every(parts)?;
                Ok(Spectrum::mix(&resolved.iter().map(|(weight, part)| (*weight, part)).collect::<Vec<_>>()))
            }
            SpectrumFile::PowerLaw { reference_nm, value, exponent } => {
                Spectrum::power_law(*reference_nm, *value, *exponent)
            }
            SpectrumFile::Match { target, primaries } => {
                let at = at.key("match");
                let target = within(&at.key("target"), target);
                let at = at.key("primaries");
                let primaries = every(primaries.iter().enumerate().map(|(i, primary)| within(&at.index(i), primary)));
                let (target, primaries) = both(target, primaries)?;
                Ok(nearest_mix(&target, &primaries)?.mix(&primaries))
            }
        };
        self.at(at, made)
    }

    fn file(&self, SpectrumPathFile { path, sample }: &SpectrumPathFile, role: Role) -> Result<Spectrum> {
        let place = self.source.file(path)?;
        let samples = read::samples_of(&place, sample.as_deref())?;
        if let Some(note) = &samples.note {
            let note = format!("{path}: {note}");
            let mut notes = self.notes.borrow_mut();
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
        samples.spectrum(role.outside()).map_err(|error| error.in_file(&place))
    }

    fn spectrum_by_name(&self, at: &JsonPath, name: &str, role: Role, depth: usize) -> Result<Spectrum> {
        if let Some(file) = self.named.get(name) {
            let root = JsonPath::Root;
            let spectra = root.key("spectra");
            return self.spectrum_at_depth(&spectra.key(name), file, role, depth + 1);
        }
        if is_hex_colour(name) {
            return self.at(at, linear_of_hex(name).and_then(|rgb| upsampled(rgb, role)));
        }
        library::find(name).map(|entry| entry.spectrum).or_else(|_| {
            let own: Vec<&str> = self.named.keys().map(String::as_str).collect();
            let known = own.into_iter().chain(library::names().map(|name| -> &str { name }));
            let error = Error::unknown_name("spectrum", name, known)
                .expected(format!("a name of the scene's `spectra`, or {}", library::EXPECTED_NAME));
            self.at(at, Err(error))
        })
    }
}

/// Returns a table of mean cosines. `Spectrum::table` refuses negative values, so 1 is added to
/// every value, and then subtracted from the resulting spectrum.
fn signed_table(nm: &[f64], values: &[f64]) -> Result<Spectrum> {
    let raised: Vec<f64> = values.iter().map(|value| value + 1.0).collect();
    let raised = Spectrum::table(nm, &raised, Outside::Hold)?;
    Ok(Spectrum::mix(&[(1.0, &raised), (1.0, &Spectrum::constant(-1.0))]))
}

fn upsampled(rgb: [f64; 3], role: Role) -> Result<Spectrum> {
    if role == Role::Light { Spectrum::rgb_light(rgb) } else { Spectrum::rgb_reflectance(rgb) }
}

/// Finds the weights (none negative) of the mix nearest to the target in CIE 1931 XYZ.
fn nearest_mix(target: &Spectrum, primaries: &[Spectrum]) -> Result<PrimaryMatch> {
    let observer = Observer::cie1931();
    let colours: Vec<[f64; 3]> = primaries.iter().map(|primary| observer.xyz(primary)).collect();
    match_primaries(observer.xyz(target), &colours)
}

/// Checks that the values of a spectrum are valid for its role.
fn check_role(spectrum: &Spectrum, role: Role) -> Result<()> {
    let (min, max) = (spectrum.min(), spectrum.max());
    let (what, expected) = if role == Role::Light && spectrum.integral() <= 0.0 {
        let expected = "a spectrum with power in the visible band".to_string();
        ("the spectrum has no power within 360–830 nm".to_string(), expected)
    } else if matches!(role, Role::Reflectance | Role::Absorptance) && max > 1.0 + 1e-9 {
        (format!("found values up to {max:.4}"), "values from 0 to 1".to_string())
    } else if !matches!(role, Role::Light | Role::MeanCosine) && min < 0.0 {
        (format!("found values down to {min:.4}"), "values of at least 0".to_string())
    } else if role == Role::MeanCosine && max.max(-min) > MAX_MEAN_COSINE {
        let expected = format!("mean cosines from {} to {MAX_MEAN_COSINE}", -MAX_MEAN_COSINE);
        (format!("found values from {min:.4} to {max:.4}"), expected)
    } else {
        return Ok(());
    };
    Err(Error::input(what).expected(expected))
}
