//! The indices, the walk-off and the interference colours of a uniaxial crystal.

use abbe_optics::glass::lines;
use abbe_polarisation::crystal::Crystal;
use abbe_polarisation::interference::interference_colours;
use abbe_session::output::strip::ColourStrip;
use abbe_spectra::colour::{RgbSpace, Xyz, encode_srgb_u8, gamut, srgb_hex, xy, xyz_to_linear_srgb};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{BAND_NM, Spectrum};
use serde::Serialize;

/// The indices at a wavelength.
#[derive(Debug, Serialize)]
pub struct CrystalIndex {
    /// The wavelength in nm.
    pub nm: f64,
    pub n_o: f64,
    pub n_e: f64,
    /// n_e − n_o.
    pub birefringence: f64,
    /// The index of the extraordinary wave at the chosen angle to the optic axis.
    pub n_wave: f64,
    /// The angle from the wave vector to the extraordinary ray in degrees, positive away from the
    /// optic axis.
    pub walk_off_deg: f64,
}

/// The colour of a plate between crossed polarisers.
#[derive(Debug, Serialize)]
pub struct StripColour {
    /// The thickness times |n_e − n_o| at 589.2938 nm, in nm.
    pub path_difference_nm: f64,
    pub thickness_um: f64,
    /// CIE 1931, where the light without polarisers has Y = 1.
    pub xyz: Xyz,
    /// `None` if the plate is dark.
    pub xy: Option<[f64; 2]>,
    /// The display colour, where light behind parallel polarisers without a plate is white.
    pub srgb_hex: String,
}

/// The Michel-Lévy strip: plates with the axis in their surface, at 45° between crossed polarisers.
#[derive(Debug, Serialize)]
pub struct MichelLevyStrip {
    /// The name of the light.
    pub lamp: String,
    pub plates: Vec<StripColour>,
}

/// The optical data of a crystal.
#[derive(Debug, Serialize)]
pub struct CrystalReport {
    pub name: String,
    pub source: String,
    /// The wavelengths in nm at which the data is valid.
    pub range_nm: [f64; 2],
    /// A restriction of the data.
    pub warning: Option<String>,
    /// The angle between the optic axis and the wave vector, for `n_wave` and `walk_off_deg`.
    pub axis_angle_deg: f64,
    /// The indices at the requested wavelengths.
    pub index: Vec<CrystalIndex>,
    pub michel_levy: MichelLevyStrip,
}

/// A request for the figures of a crystal.
#[derive(Debug)]
pub struct CrystalRequest<'a> {
    /// Wavelengths in nm. An empty list stands for the Fraunhofer lines within the range.
    pub nm: &'a [f64],
    pub axis_angle_deg: f64,
    /// Thicknesses of plates in µm. An empty list stands for path differences in steps of 100 nm.
    pub thickness_um: &'a [f64],
    pub lamp: &'a Spectrum,
    pub lamp_name: &'a str,
}

const LINES_NM: [f64; 8] =
    [lines::H_NM, lines::G_NM, lines::F_NM, lines::E_NM, lines::D_NM, lines::SODIUM_NM, lines::C_NM, lines::R_NM];

/// The end of the strip in nm, after more than four orders.
const STRIP_END_NM: f64 = 2500.0;
const STRIP_STEP_NM: f64 = 100.0;
/// The columns of the strip's picture, 2 nm apart.
const STRIP_COLUMNS: u32 = 1250;

impl CrystalReport {
    /// Describes a crystal. Returns an error if a requested wavelength is outside the visible band
    /// and outside the valid range.
    pub fn of(crystal: &Crystal, request: &CrystalRequest<'_>) -> Result<Self> {
        let (from, to) = crystal.range_nm();
        let is_valid = |nm: f64| (BAND_NM.0..=BAND_NM.1).contains(&nm) || (from..=to).contains(&nm);
        if let Some(bad) = request.nm.iter().find(|&&nm| !is_valid(nm)) {
            let what = format!("the indices of {} at {bad} nm", crystal.name);
            return Err(Error::input(what).expected(format!("wavelengths from {from} to {to} nm")));
        }
        let lines: Vec<f64> = LINES_NM.into_iter().filter(|nm| (from..=to).contains(nm)).collect();
        let nm = if request.nm.is_empty() { &lines } else { request.nm };
        let thickness = |path_nm: f64| 1e-3 * path_nm / crystal.at(lines::SODIUM_NM).birefringence().abs();
        let steps = (0..=(STRIP_END_NM / STRIP_STEP_NM) as u32).map(|i| thickness(STRIP_STEP_NM * f64::from(i)));
        let plates = match request.thickness_um {
            [] => steps.map(|um| plate(crystal, um, request.lamp)).collect(),
            list => list.iter().map(|&um| plate(crystal, um, request.lamp)).collect(),
        };
        Ok(Self {
            name: crystal.name.clone(),
            source: crystal.source.clone(),
            range_nm: [from, to],
            warning: crystal.warning().map(str::to_string),
            axis_angle_deg: request.axis_angle_deg,
            index: nm.iter().map(|&nm| index(crystal, nm, request.axis_angle_deg)).collect(),
            michel_levy: MichelLevyStrip { lamp: request.lamp_name.to_string(), plates },
        })
    }
}

fn index(crystal: &Crystal, nm: f64, axis_angle_deg: f64) -> CrystalIndex {
    let (indices, angle) = (crystal.at(nm), axis_angle_deg.to_radians());
    CrystalIndex {
        nm,
        n_o: indices.ordinary,
        n_e: indices.extraordinary,
        birefringence: indices.birefringence(),
        n_wave: indices.extraordinary_at(angle),
        walk_off_deg: indices.walk_off(angle).to_degrees(),
    }
}

fn plate(crystal: &Crystal, thickness_um: f64, lamp: &Spectrum) -> StripColour {
    let path = |nm: f64| crystal.path_difference_nm(1e3 * thickness_um, nm);
    let xyz = interference_colours(lamp, path).crossed;
    StripColour {
        path_difference_nm: path(lines::SODIUM_NM),
        thickness_um,
        xyz,
        xy: (xyz.iter().sum::<f64>() > 0.0).then(|| xy(xyz)),
        srgb_hex: srgb_hex(shown(xyz)),
    }
}

/// Returns the linear sRGB colour, mixed with grey if it is outside sRGB. A polariser transmits
/// half of the light, so twice the light is shown.
fn shown(xyz: Xyz) -> [f64; 3] {
    gamut::desaturate(xyz_to_linear_srgb(xyz.map(|value| 2.0 * value)), RgbSpace::Srgb)
}

/// Returns the Michel-Lévy strip of a crystal as a picture, against the path difference.
pub fn strip(crystal: &Crystal, lamp: &Spectrum, lamp_name: &str) -> ColourStrip {
    let per_nm = 1.0 / crystal.at(lines::SODIUM_NM).birefringence().abs();
    let colour = |i: u32| {
        let path_nm = STRIP_END_NM * (f64::from(i) + 0.5) / f64::from(STRIP_COLUMNS);
        let path = |nm: f64| crystal.path_difference_nm(path_nm * per_nm, nm);
        shown(interference_colours(lamp, path).crossed).map(encode_srgb_u8)
    };
    ColourStrip {
        title: format!("{} between crossed polarisers under {lamp_name}", crystal.name),
        axis: "path difference at 589.3 nm in nm".to_string(),
        end: STRIP_END_NM,
        codes: (0..STRIP_COLUMNS).map(colour).collect(),
    }
}
