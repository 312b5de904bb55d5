//! The reflectance, the transmittance and the colours of a stack of thin films.

use abbe_format::resolve::FilmSystem;
use abbe_optics::thin_film::{PolarisedResponse, StackResponse};
use abbe_polarisation::surface::{EllipsometricAngles, argument_deg};
use abbe_session::output::plot::{SpectralCurve, SpectralPlot};
use abbe_spectra::colour::xy;
use abbe_spectra::math::complex::Complex;
use abbe_spectra::math::elementary::cos;
use abbe_spectra::spectrum::{BAND_NM, Observer, Spectrum};
use serde::Serialize;

/// A value for s polarised, p polarised and unpolarised light, at each wavelength.
#[derive(Debug, Default, Serialize)]
pub struct Polarised {
    /// Light that is polarised perpendicular to the plane of incidence.
    pub s: Vec<f64>,
    /// Light that is polarised in the plane of incidence.
    pub p: Vec<f64>,
    /// Unpolarised light.
    pub mean: Vec<f64>,
}

impl Polarised {
    /// Adds the values at one wavelength.
    fn push(&mut self, found: &StackResponse, of: impl Fn(&PolarisedResponse) -> f64) {
        let (s, p) = (of(&found.s), of(&found.p));
        self.s.push(s);
        self.p.push(p);
        self.mean.push(0.5 * (s + p));
    }
}

/// The ratios of the reflected or transmitted field to the incident one at the outer faces of the
/// films, at each wavelength. Fields vary as exp(−iωt), and r_p = −r_s at normal incidence.
#[derive(Debug, Default, Serialize)]
pub struct FilmAmplitudes {
    /// The real and the imaginary part for s polarised light.
    pub s: Vec<[f64; 2]>,
    /// The same for p polarised light.
    pub p: Vec<[f64; 2]>,
    /// The phase for s polarised light in degrees, above −180 and up to 180.
    pub phase_s_deg: Vec<f64>,
    /// The same for p polarised light.
    pub phase_p_deg: Vec<f64>,
}

impl FilmAmplitudes {
    /// Adds the amplitudes at one wavelength.
    fn push(&mut self, s: Complex, p: Complex) {
        self.s.push([s.re, s.im]);
        self.p.push([p.re, p.im]);
        self.phase_s_deg.push(argument_deg(s));
        self.phase_p_deg.push(argument_deg(p));
    }
}

/// The ellipsometric angles at each wavelength: r_p/r_s = tan Ψ·exp(iΔ) for fields that vary as
/// exp(+iωt).
#[derive(Debug, Default, Serialize)]
pub struct Ellipsometry {
    /// Ψ in degrees, from 0 to 90.
    pub psi_deg: Vec<f64>,
    /// Δ in degrees, from 0 to below 360.
    pub delta_deg: Vec<f64>,
}

/// CIE 1931 chromaticities of unpolarised light. `None` if there is no light.
#[derive(Debug, Serialize)]
pub struct FilmColours {
    pub reflected: Option<[f64; 2]>,
    /// The chromaticity of the transmitted light.
    pub transmitted: Option<[f64; 2]>,
}

/// The films at an angle of incidence. Powers are fractions of the incident power.
#[derive(Debug, Serialize)]
pub struct FilmAngle {
    pub degrees: f64,
    pub wavelength_nm: Vec<f64>,
    pub reflectance: Polarised,
    /// The transmitted power.
    pub transmittance: Polarised,
    /// The colours under a lamp.
    pub xy: FilmColours,
    pub reflected_field: FilmAmplitudes,
    pub transmitted_field: FilmAmplitudes,
    /// The reflected light.
    pub ellipsometry: Ellipsometry,
}

/// The powers and the colours of a stack of thin films.
#[derive(Debug, Serialize)]
pub struct FilmReport {
    pub angles: Vec<FilmAngle>,
}

impl FilmReport {
    /// Computes the powers at angles in degrees and wavelengths in nm, and the colours.
    pub fn of(system: &FilmSystem, degrees: &[f64], wavelengths: &[f64], lamp: &Spectrum) -> Self {
        Self { angles: degrees.iter().map(|&degrees| at_angle(system, degrees, wavelengths, lamp)).collect() }
    }
}

fn response(system: &FilmSystem, degrees: f64, nm: f64) -> StackResponse {
    // The cosine of 90 degrees is not exactly 0.
    let cosine = if degrees == 90.0 { 0.0 } else { cos(degrees.to_radians()) };
    system.films.response(cosine, system.incident.n(nm), system.substrate.at(nm), nm, 0.0)
}

fn at_angle(system: &FilmSystem, degrees: f64, wavelengths: &[f64], lamp: &Spectrum) -> FilmAngle {
    let (mut reflectance, mut transmittance) = (Polarised::default(), Polarised::default());
    let (mut reflected_field, mut transmitted_field) = (FilmAmplitudes::default(), FilmAmplitudes::default());
    let mut ellipsometry = Ellipsometry::default();
    for &nm in wavelengths {
        let found = response(system, degrees, nm);
        reflectance.push(&found, |it| it.reflectance);
        transmittance.push(&found, |it| it.transmittance);
        reflected_field.push(found.s.reflected, found.p.reflected);
        transmitted_field.push(found.s.transmitted, found.p.transmitted);
        let EllipsometricAngles { psi_deg, delta_deg } = EllipsometricAngles::of(&found.s, &found.p);
        ellipsometry.psi_deg.push(psi_deg);
        ellipsometry.delta_deg.push(delta_deg);
    }
    let colour = |of: fn(&StackResponse) -> f64| chromaticity(lamp, |nm| of(&response(system, degrees, nm)));
    let xy = FilmColours {
        reflected: colour(StackResponse::reflectance),
        transmitted: colour(StackResponse::transmittance),
    };
    FilmAngle {
        degrees,
        wavelength_nm: wavelengths.to_vec(),
        reflectance,
        transmittance,
        xy,
        reflected_field,
        transmitted_field,
        ellipsometry,
    }
}

/// Returns the CIE 1931 chromaticity of a light times a factor, or `None` without light. The
/// continuum is summed over whole nanometres, and a line counts with the factor at its centre.
fn chromaticity(light: &Spectrum, factor: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
    let observer = Observer::cie1931();
    let mut sum = [0.0; 3];
    let mut add = |nm: f64, power: f64| {
        let weight = power * factor(nm);
        sum.iter_mut().zip(observer.xyz_bar(nm)).for_each(|(sum, bar)| *sum += weight * bar);
    };
    (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).for_each(|nm| add(nm, light.continuum_at(nm)));
    light.line_segments().iter().for_each(|line| add(line.centre(), line.power));
    (sum.iter().sum::<f64>() > 0.0).then(|| xy(sum))
}

/// Plots the powers of unpolarised light, only reflected if the substrate transmits nothing.
pub fn plot(system: &FilmSystem, angles: &[f64]) -> SpectralPlot {
    let mut curves = Vec::new();
    for &degrees in angles {
        let mut add = |name: &str, of: fn(&StackResponse) -> f64| {
            let nm = (0..=470).map(|i| BAND_NM.0 + f64::from(i));
            let points: Vec<(f64, f64)> = nm.map(|nm| (nm, of(&response(system, degrees, nm)))).collect();
            if points.iter().any(|point| point.1 > 0.0) {
                curves.push(SpectralCurve { name: format!("{name} at {degrees}°"), points });
            }
        };
        add("reflectance", StackResponse::reflectance);
        add("transmittance", StackResponse::transmittance);
    }
    SpectralPlot {
        title: "Thin films".to_string(),
        values: "fraction of the power".to_string(),
        curves,
        lines: Vec::new(),
        from_zero: true,
    }
}
