//! `abbe grating`: the angles and the efficiencies of the orders of a diffraction grating.

use std::f64::consts::PI;

use super::{Outcome, print, values};
use abbe_optics::bsdf::ScatterEvent;
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::grating::{DiffractedOrder, EfficiencyTable, Grating, GratingProfile};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{atan2, sin_cos};
use abbe_spectra::spectrum::Spectrum;
use glam::DVec3;
use serde::Serialize;

#[derive(Debug, clap::Args)]
pub(crate) struct GratingArgs {
    /// The number of grooves per mm
    #[arg(long, value_name = "N")]
    lines_per_mm: f64,
    /// The wavelength in nm
    #[arg(long, value_name = "NM", value_parser = values::wavelength_nm)]
    wavelength: f64,
    /// The angle of incidence in degrees, from -90 to 90
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_negative_numbers = true)]
    angle: f64,
    /// The angle in degrees between the plane of incidence and the plane across the grooves. If it
    /// is not 0, the orders lie on a cone, and their angles are those to the normal
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_negative_numbers = true)]
    azimuth: f64,
    /// The fraction of the light that is reflected, from 0 to 1. The rest is transmitted. 1 stands
    /// for a reflection grating and 0 for a transmission grating
    #[arg(long, value_name = "R", default_value_t = 0.5)]
    reflectance: f64,
    /// The profile of the grooves
    #[arg(long, value_enum, default_value_t = ProfileName::Blazed)]
    profile: ProfileName,
    /// The order of the blaze
    #[arg(long, value_name = "M", default_value_t = 1, allow_negative_numbers = true)]
    blaze_order: i32,
    /// The wavelength of the blaze in nm
    #[arg(long, value_name = "NM", default_value_t = 500.0, value_parser = values::wavelength_nm)]
    blaze: f64,
    /// The amplitude of a sinusoidal phase, or the step of a lamellar phase, in rad [default:
    /// 1.8412 for sinusoidal, which sends most light to the first orders; π for lamellar]
    #[arg(long, value_name = "RAD")]
    phase: Option<f64>,
    /// The wavelength in nm at which `--phase` holds
    #[arg(long, value_name = "NM", default_value_t = 550.0, value_parser = values::wavelength_nm)]
    phase_at: f64,
    /// The fraction of the period that is raised (lamellar) or clear (slits), from 0 to 1
    #[arg(long, value_name = "D", default_value_t = 0.5)]
    duty: f64,
    /// Measured efficiencies of single orders, instead of a profile, such as 0=0.1,1=0.75
    #[arg(long, value_name = "LIST", value_parser = efficiencies, allow_hyphen_values = true, conflicts_with = "profile")]
    efficiencies: Option<OrderEfficiencies>,
    /// The index of the medium behind the grating: a number or the name of a glass
    #[arg(long, value_name = "N|NAME", default_value = "1")]
    substrate: String,
    /// The diameter of a round stop across each order, in mm. The output then contains the
    /// resolving power that diffraction at the stop allows
    #[arg(long, value_name = "MM")]
    stop_mm: Option<f64>,
    /// The width of a slit, seen from the grating, in degrees. The output then contains the width
    /// of its image in nm
    #[arg(long, value_name = "DEG")]
    slit_deg: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Numbers of orders with their efficiencies.
#[derive(Debug, Clone)]
struct OrderEfficiencies(Vec<(i32, f64)>);

fn efficiencies(text: &str) -> std::result::Result<OrderEfficiencies, String> {
    let pair = |text: &str| {
        let (order, efficiency) = text.split_once('=')?;
        Some((order.trim().parse().ok()?, efficiency.trim().parse().ok()?))
    };
    let orders: Option<Vec<(i32, f64)>> = text.split(',').map(pair).collect();
    orders.map(OrderEfficiencies).ok_or_else(|| "expected orders with their efficiencies, such as 0=0.1,1=0.75".into())
}

/// The name of a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum ProfileName {
    /// A sawtooth
    Blazed,
    /// A sinusoidal phase
    Sinusoidal,
    /// Rectangular grooves: a phase with two values
    Lamellar,
    /// Opaque lines with clear gaps, which absorb the rest of the light
    Slits,
}

/// An order. If the incidence is conical, `degrees` is the angle to the normal.
#[derive(Debug, Serialize)]
struct OrderReport {
    order: i32,
    side: &'static str,
    degrees: f64,
    /// The angle around the normal. Omitted if the orders lie in the plane of incidence.
    #[serde(skip_serializing_if = "Option::is_none")]
    azimuth_degrees: Option<f64>,
    efficiency: f64,
    /// The resolving power mN/1.22 of N grooves in front of a round stop (Rayleigh's criterion).
    /// Omitted without a stop.
    #[serde(skip_serializing_if = "Option::is_none")]
    resolving_power: Option<f64>,
    /// The difference of the wavelengths whose images of the slit are side by side, in nm. Omitted
    /// without a slit, and for the order 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    slit_nm: Option<f64>,
}

#[derive(Debug, Serialize)]
struct GratingReport {
    orders: Vec<OrderReport>,
}

/// The amplitude in rad for which J₁ is largest.
const BEST_AMPLITUDE: f64 = 1.8412;

pub(crate) fn run(arguments: &GratingArgs) -> Result<Outcome> {
    let report = report(arguments)?;
    if arguments.json {
        print::json(&report)?;
    } else {
        print::result(&text(&report))?;
    }
    Ok(Outcome::Done)
}

/// Refuses a value of an option that lies outside a range.
fn within(option: &str, value: f64, (low, high): (f64, f64)) -> Result<()> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(Error::input(format!("{option} {value}")).expected(format!("from {low} to {high}")))
}

fn profile(arguments: &GratingArgs) -> Result<GratingProfile> {
    within("--duty", arguments.duty, (0.0, 1.0))?;
    if let Some(OrderEfficiencies(orders)) = &arguments.efficiencies {
        let orders = orders.iter().map(|&(order, efficiency)| (order, Spectrum::constant(efficiency)));
        return Ok(GratingProfile::Table(EfficiencyTable::new(orders.collect())?));
    }
    let phase = |default: f64| arguments.phase.unwrap_or(default);
    Ok(match arguments.profile {
        ProfileName::Blazed => GratingProfile::Blazed { order: arguments.blaze_order, blaze_nm: arguments.blaze },
        ProfileName::Sinusoidal => {
            GratingProfile::Sinusoidal { amplitude_rad: phase(BEST_AMPLITUDE), at_nm: arguments.phase_at }
        }
        ProfileName::Lamellar => {
            GratingProfile::BinaryPhase { phase_rad: phase(PI), at_nm: arguments.phase_at, duty: arguments.duty }
        }
        ProfileName::Slits => GratingProfile::BinaryAmplitude { duty: arguments.duty },
    })
}

fn report(arguments: &GratingArgs) -> Result<GratingReport> {
    let GratingArgs { lines_per_mm, wavelength, angle, azimuth, reflectance, substrate, .. } = arguments;
    within("--angle", *angle, (-90.0, 90.0))?;
    within("--azimuth", *azimuth, (-360.0, 360.0))?;
    within("--reflectance", *reflectance, (0.0, 1.0))?;
    let spectroscope = Spectroscope::new(arguments)?;
    let grating = Grating::new(*lines_per_mm, profile(arguments)?)?;
    let behind = match substrate.trim().parse() {
        Ok(n) => RefractiveIndex::constant(n)?,
        Err(_) if substrate.eq_ignore_ascii_case("air") => RefractiveIndex::constant(1.0)?,
        Err(_) => RefractiveIndex::catalogue(substrate)?,
    };
    let ((sin, cos), (sin_azimuth, cos_azimuth)) = (sin_cos(angle.to_radians()), sin_cos(azimuth.to_radians()));
    let incident = DVec3::new(sin * cos_azimuth, sin * sin_azimuth, -cos);
    let sides = [
        ("reflected", ScatterEvent::Reflection, 1.0, *reflectance),
        ("transmitted", ScatterEvent::Transmission, behind.n(*wavelength), 1.0 - reflectance),
    ];
    let mut orders = Vec::new();
    for (side, event, index, share) in sides.into_iter().filter(|side| side.3 > 0.0) {
        for order in grating.orders(incident, event, [1.0, index], *wavelength) {
            let (degrees, azimuth_degrees) = angles(&order, *azimuth != 0.0);
            let efficiency = share * order.efficiency;
            let (resolving_power, slit_nm) = (spectroscope.resolving_power(&order), spectroscope.slit_nm(&order));
            let order = order.order;
            orders.push(OrderReport { order, side, degrees, azimuth_degrees, efficiency, resolving_power, slit_nm });
        }
    }
    Ok(GratingReport { orders })
}

/// A slit, a grating and a round stop behind it. All light travels across the grooves.
struct Spectroscope {
    lines_per_mm: f64,
    cos_incidence: f64,
    stop_mm: Option<f64>,
    slit_rad: Option<f64>,
}

impl Spectroscope {
    fn new(arguments: &GratingArgs) -> Result<Self> {
        let GratingArgs { lines_per_mm, angle, azimuth, stop_mm, slit_deg, .. } = *arguments;
        for (option, value, most) in [("--stop-mm", stop_mm, f64::MAX), ("--slit-deg", slit_deg, 90.0)] {
            let Some(value) = value else { continue };
            within(option, value, (f64::MIN_POSITIVE, most))?;
            if azimuth != 0.0 {
                return Err(Error::input(format!("{option} with --azimuth {azimuth}"))
                    .expected("incidence across the grooves, without --azimuth"));
            }
        }
        let (cos_incidence, slit_rad) = (sin_cos(angle.to_radians()).1, slit_deg.map(f64::to_radians));
        Ok(Self { lines_per_mm, cos_incidence, stop_mm, slit_rad })
    }

    /// Returns the resolving power. The stop is across the light of the order, so the order
    /// illuminates it through a longer part of the grating.
    fn resolving_power(&self, order: &DiffractedOrder) -> Option<f64> {
        let grooves = self.stop_mm? * self.lines_per_mm / order.direction.z.abs();
        Some(f64::from(order.order.abs()) * grooves / 1.22)
    }

    fn slit_nm(&self, order: &DiffractedOrder) -> Option<f64> {
        let per_nm = f64::from(order.order.abs()) * self.lines_per_mm * 1e-6;
        self.slit_rad.filter(|_| order.order != 0).map(|slit| slit * self.cos_incidence / per_nm)
    }
}

/// Returns the angles of an order in degrees.
fn angles(order: &DiffractedOrder, conical: bool) -> (f64, Option<f64>) {
    if conical {
        (order.polar_deg(), Some(atan2(order.direction.y, order.direction.x).to_degrees()))
    } else {
        (order.signed_deg(), None)
    }
}

fn text(report: &GratingReport) -> String {
    let mut text = " order  side            degrees  efficiency\n".to_string();
    for it in &report.orders {
        let OrderReport { order, side, degrees, azimuth_degrees, efficiency, resolving_power, slit_nm } = it;
        let azimuth = azimuth_degrees.map_or(String::new(), |azimuth| format!("  azimuth {azimuth:.4}"));
        text += &format!("{order:>6}  {side:<12} {degrees:>10.5} {:>9.4} %{azimuth}", 100.0 * efficiency);
        text += &resolving_power.map_or(String::new(), |power| format!("  resolving power {power:.0}"));
        text += &slit_nm.map_or(String::new(), |nm| format!("  slit {nm:.4} nm"));
        text += "\n";
    }
    text
}
