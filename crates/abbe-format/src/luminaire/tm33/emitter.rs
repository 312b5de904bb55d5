//! One emitter of a luminaire: its intensities in cd, its spectrum and its figures.

use super::grid::{self, AngleGrid};
use super::spectrum::{self, SpectralPower};
use super::xml;
use crate::luminaire::number::{PlacedValue, ascending, candela};
use crate::luminaire::photometry::type_c_table;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Spectrum;
use roxmltree::Node;

/// The largest number of emitters of one kind.
const MAX_QUANTITY: f64 = 1e6;

/// How far the stated flux may be from a multiple of the flux of the table.
const FLUX_TOLERANCE: f64 = 0.1;

/// An emitter with intensities.
#[derive(Debug)]
pub(super) struct EmitterData {
    pub(super) grid: AngleGrid,
    /// The intensities in cd, plane by plane.
    pub(super) candela: Vec<f64>,
    pub(super) spectrum: Option<Spectrum>,
    pub(super) rated_lumens: Option<f64>,
    pub(super) input_watts: Option<f64>,
    /// Pairs of a tilt angle in degrees and a factor.
    pub(super) tilt: Vec<(f64, f64)>,
    /// The line and the column of the emitter.
    pub(super) place: (usize, usize),
}

/// Intensities in cd in the directions of a grid.
struct CandelaTable {
    grid: AngleGrid,
    candela: Vec<f64>,
}

/// The quantities that intensities have, with the names of their elements, in the order in which
/// they are used.
const QUANTITIES: [(&str, &str, Quantity); 3] = [
    ("LuminousData", "LuminousIntensity", Quantity::Luminous),
    ("RadiantData", "RadiantIntensity", Quantity::Radiant),
    ("PhotonData", "PhotonIntensity", Quantity::Photons),
];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Quantity {
    /// In cd.
    Luminous,
    /// In W/sr.
    Radiant,
    /// In µmol/s/sr.
    Photons,
}

impl EmitterData {
    /// Reads an emitter. Returns `None` if it has no intensities.
    pub(super) fn of(node: Node<'_, '_>, notes: &mut Vec<String>) -> Result<Option<Self>> {
        let power = SpectralPower::of(node)?;
        let quantity = quantity(node)?;
        let mut spectrum = power.as_ref().map(|power| power.spectrum.clone());
        let Some(mut table) = tabulated(node, power.as_ref(), &mut spectrum)? else { return Ok(None) };
        if table.candela.iter().all(|value| *value == 0.0) {
            return Err(xml::at(node, Error::input("an emitter without light").expected("an intensity above 0")));
        }
        let is_single = quantity > 1.0 && states_several(node, &table, quantity)?;
        if quantity > 1.0 {
            let name = name(node);
            notes.push(if is_single {
                format!("{name}: the luminous flux of the file is that of {quantity} emitters with these intensities")
            } else {
                format!("{name}: the intensities are those of all {quantity} emitters together")
            });
        }
        let repeated = if is_single { quantity } else { 1.0 };
        table.candela.iter_mut().for_each(|value| *value *= repeated);
        let positive = |number: Option<PlacedValue>| number.map(|number| number.value).filter(|value| *value > 0.0);
        Ok(Some(Self {
            grid: table.grid,
            candela: table.candela,
            spectrum,
            rated_lumens: positive(xml::number_in(node, "RatedLumens")?).map(|lumens| lumens * quantity),
            input_watts: positive(xml::number_in(node, "InputWattage")?).map(|watts| watts * repeated),
            tilt: tilt(node)?,
            place: xml::place(node),
        }))
    }

    /// Returns the luminous flux in lm.
    pub(super) fn flux_lm(&self) -> Result<f64> {
        flux(&self.grid, &self.candela)
    }
}

fn flux(grid: &AngleGrid, candela: &[f64]) -> Result<f64> {
    let AngleGrid { symmetry, vertical_deg, horizontal_deg } = grid;
    type_c_table(*symmetry, vertical_deg, horizontal_deg, candela).map(|table| table.flux())
}

/// Returns the description of an emitter for notes.
pub(super) fn name(node: Node<'_, '_>) -> String {
    let text = xml::child(node, "Description").and_then(|node| node.text()).unwrap_or("").trim();
    let text: String = text.chars().filter(|c| !c.is_control()).take(80).collect();
    if text.is_empty() { "an emitter".to_owned() } else { format!("the emitter \"{text}\"") }
}

/// Returns the number of identical emitters.
fn quantity(node: Node<'_, '_>) -> Result<f64> {
    let Some(number) = xml::number_in(node, "Quantity")? else { return Ok(1.0) };
    let is_count = number.value.fract() == 0.0 && (1.0..=MAX_QUANTITY).contains(&number.value);
    if is_count { Ok(number.value) } else { Err(number.wrong("<Quantity>", "a whole number from 1 to 10⁶")) }
}

/// Returns whether the luminous flux that the file states is that of all emitters, while its
/// intensities are those of one.
fn states_several(node: Node<'_, '_>, table: &CandelaTable, quantity: f64) -> Result<bool> {
    let stated = xml::child(node, "LuminousData").map(|data| xml::number_in(data, "LuminousFlux")).transpose()?;
    let Some(stated) = stated.flatten() else { return Ok(false) };
    let ratio = stated.value / flux(&table.grid, &table.candela)?;
    Ok((ratio / quantity - 1.0).abs() < FLUX_TOLERANCE)
}

/// Reads the first table of intensities, and converts it to cd. A spectral table gives the spectrum
/// if the emitter has no other.
fn tabulated(
    node: Node<'_, '_>,
    power: Option<&SpectralPower>,
    spectrum: &mut Option<Spectrum>,
) -> Result<Option<CandelaTable>> {
    for (data, table, quantity) in QUANTITIES {
        let Some(data) = xml::child(node, data) else { continue };
        let Some(table) = xml::child(data, table) else { continue };
        let factor = factor(node, table)?
            * match (quantity, power) {
                (Quantity::Luminous, _) => 1.0,
                (Quantity::Radiant | Quantity::Photons, None) => {
                    let error = Error::input(format!("<{}> without a spectrum", table.tag_name().name()));
                    return Err(xml::at(table, error.expected("<LuminousIntensity>, or <SpectralData> to convert it")));
                }
                (Quantity::Radiant | Quantity::Photons, Some(power)) => {
                    let range = (bound(data, "MinWavelength")?, bound(data, "MaxWavelength")?);
                    let lumens = power.lumens_per_unit(range, quantity == Quantity::Photons);
                    let empty = || Error::input(format!("no spectral power from {} to {} nm", range.0, range.1));
                    lumens.ok_or_else(|| xml::at(data, empty().expected("the range of wavelengths of the emitter")))?
                }
            };
        let mut values = grid::values(table, false)?;
        let grid = grid::sort(table, &mut values)?;
        let values: Vec<PlacedValue> = values.iter().map(|value| value.value).collect();
        return Ok(Some(CandelaTable { grid, candela: candela(&values, factor)? }));
    }
    let Some(table) = xml::child(node, "SpectralData").and_then(|data| xml::child(data, "AngularSpectral")) else {
        return Ok(None);
    };
    let (found, own) = spectral_table(table, factor(node, table)?)?;
    spectrum.get_or_insert(own);
    Ok(Some(found))
}

/// Returns the factor of a table: its multiplier, and for relative photometry the ballast factor.
fn factor(emitter: Node<'_, '_>, table: Node<'_, '_>) -> Result<f64> {
    let absolute = xml::truth_in(table, "AbsolutePhotometry")?.or(xml::truth_in(table, "Absolute")?).unwrap_or(true);
    let ballast = if absolute { 1.0 } else { xml::factor_in(emitter, "BallastFactor")? };
    Ok(xml::factor_in(table, "Multiplier")? * ballast)
}

fn bound(data: Node<'_, '_>, name: &str) -> Result<f64> {
    let missing = || xml::at(data, Error::input(format!("missing <{name}>")).expected("a wavelength in nm"));
    let number = xml::number_in(data, name)?.ok_or_else(missing)?;
    number.not_negative(&format!("<{name}>"))
}

/// Converts a table of spectral intensities to cd. Returns the spectrum of its flux as well.
fn spectral_table(table: Node<'_, '_>, factor: f64) -> Result<(CandelaTable, Spectrum)> {
    let groups = spectrum::by_wavelength(grid::values(table, true)?);
    let nm: Vec<f64> = groups.iter().map(|(nm, _)| *nm).collect();
    if nm.len() < 2 || nm[0] <= 0.0 {
        let error = Error::input(format!("a spectral table with the wavelengths {nm:?}"));
        return Err(xml::at(table, error.expected("two or more wavelengths above 0 nm")));
    }
    let weights = spectrum::luminous_weights(&nm).map_err(|error| xml::at(table, error))?;
    let mut sum: Option<CandelaTable> = None;
    let mut fluxes = Vec::new();
    for ((nm, mut values), weight) in groups.into_iter().zip(weights) {
        let grid = grid::sort(table, &mut values)?;
        let placed: Vec<PlacedValue> = values.iter().map(|value| value.value).collect();
        let intensities = candela(&placed, factor)?;
        let is_dark = intensities.iter().all(|value| *value == 0.0);
        fluxes.push((nm, if is_dark { 0.0 } else { flux(&grid, &intensities)? }));
        let total = sum.get_or_insert_with(|| CandelaTable { grid: grid.clone(), candela: vec![0.0; placed.len()] });
        if total.grid != grid {
            return Err(placed[0].wrong("directions that differ between wavelengths; intensity", "the same directions"));
        }
        total.candela.iter_mut().zip(intensities).for_each(|(sum, value)| *sum += weight * value);
    }
    let spectrum = spectrum::table(&fluxes).map_err(|error| xml::at(table, error))?;
    let no_light = || xml::at(table, Error::input("a spectral table without visible light").expected("light"));
    sum.filter(|_| spectrum.integral() > 0.0).map(|sum| (sum, spectrum)).ok_or_else(no_light)
}

/// Reads the tilt factors.
fn tilt(node: Node<'_, '_>) -> Result<Vec<(f64, f64)>> {
    let Some(angles) = xml::child(node, "TiltAngles") else { return Ok(Vec::new()) };
    let (mut tilts, mut factors) = (Vec::new(), Vec::new());
    for tilt in xml::few(angles, "Tilt")? {
        let (line, column) = xml::place(tilt);
        let missing = || Error::input("a tilt factor without angle=\"…\"").expected("degrees").at(line, column);
        let angle = tilt.attribute("angle").ok_or_else(missing)?;
        tilts.push(PlacedValue::parse(angle.trim(), "a tilt angle", line, column)?);
        factors.push(xml::number(tilt)?.not_negative("a tilt factor")?);
    }
    Ok(ascending(&tilts, "a tilt angle", (0.0, 180.0))?.into_iter().zip(factors).collect())
}
