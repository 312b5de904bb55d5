//! `abbe grating`: the angles and the efficiencies of the orders of a diffraction grating.

use std::f64::consts::PI;

use super::{Outcome, print, values};
use crate::reports::grating::{GratingReport, GratingSetup, OrderReport};
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::grating::{EfficiencyTable, Grating, GratingProfile};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Spectrum;

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
    let GratingArgs { lines_per_mm, angle, azimuth, reflectance, stop_mm, slit_deg, .. } = *arguments;
    within("--angle", angle, (-90.0, 90.0))?;
    within("--azimuth", azimuth, (-360.0, 360.0))?;
    within("--reflectance", reflectance, (0.0, 1.0))?;
    for (option, value, most) in [("--stop-mm", stop_mm, f64::MAX), ("--slit-deg", slit_deg, 90.0)] {
        let Some(value) = value else { continue };
        within(option, value, (f64::MIN_POSITIVE, most))?;
        if azimuth != 0.0 {
            return Err(Error::input(format!("{option} with --azimuth {azimuth}"))
                .expected("incidence across the grooves, without --azimuth"));
        }
    }
    let grating = Grating::new(lines_per_mm, profile(arguments)?)?;
    let substrate = &arguments.substrate;
    let behind = match substrate.trim().parse() {
        Ok(n) => RefractiveIndex::constant(n)?,
        Err(_) if substrate.eq_ignore_ascii_case("air") => RefractiveIndex::constant(1.0)?,
        Err(_) => RefractiveIndex::catalogue(substrate)?,
    };
    let (angle_deg, azimuth_deg) = (angle, azimuth);
    let setup = GratingSetup { lines_per_mm, angle_deg, azimuth_deg, reflectance, behind, stop_mm, slit_deg };
    Ok(GratingReport::of(&grating, &setup, arguments.wavelength))
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
