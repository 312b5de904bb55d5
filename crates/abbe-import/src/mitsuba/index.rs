//! Indices of refraction that Mitsuba knows by name.

use super::{properties::Properties, reader::MitsubaReader, texture::Textured, xml::number};
use abbe_spectra::error::{Error, Result};
use serde_json::{Value, json};

/// The names and the indices of Mitsuba 3 (`ior.h`).
const INDICES: &str = "vacuum 1.0, helium 1.000036, hydrogen 1.000132, air 1.000277, carbon dioxide 1.00045, \
    water 1.3330, acetone 1.36, ethanol 1.361, carbon tetrachloride 1.461, glycerol 1.4729, benzene 1.501, \
    silicone oil 1.52045, bromine 1.661, water ice 1.31, fused quartz 1.458, pyrex 1.470, acrylic glass 1.49, \
    polypropylene 1.49, bk7 1.5046, sodium chloride 1.544, amber 1.55, pet 1.5750, diamond 2.419";

/// Indices up to this value are those of a gas, which is like air in Abbe.
const GAS: f64 = 1.001;

/// The names of metals in Mitsuba, each followed by Abbe's name.
const METALS: &str = "Ag silver, Al aluminium, Au gold, Cr chromium, Cu copper, Cu_palik copper, Fe iron, Ni nickel, \
    Ni_palik nickel, Pt platinum, Ti titanium, W tungsten";

impl MitsubaReader<'_> {
    /// Reads an index of refraction: a number, or the name of a material.
    fn named_index(&self, properties: &Properties, name: &str, default: f64) -> Result<f64> {
        let Some(element) = properties.find(name) else { return Ok(default) };
        if element.tag != "string" {
            return number(element);
        }
        let material = element.required("value")?.to_lowercase();
        let entries = || INDICES.split(", ").filter_map(|entry| entry.rsplit_once(' '));
        let known = entries().find(|(known, _)| *known == material).and_then(|(_, index)| index.parse().ok());
        known.ok_or_else(|| {
            let names = entries().map(|(known, _)| known);
            element.locate(Error::unknown_name("index of refraction", &material, names))
        })
    }

    /// Reads `int_ior` and `ext_ior` as the index inside a body, and their ratio for a coat.
    pub(super) fn indices(&mut self, properties: &Properties, default: f64) -> Result<(f64, f64)> {
        let inside = self.named_index(properties, "int_ior", default)?;
        let outside = self.named_index(properties, "ext_ior", 1.000277)?;
        if inside <= 0.0 || outside <= 0.0 {
            return Err(properties.element.error("found an index of refraction that is not above 0"));
        }
        let ratio = if outside <= GAS { inside } else { inside / outside };
        Ok((inside, ratio))
    }

    /// Reads the index inside a body. Abbe takes the index outside from the body around.
    pub(super) fn index_inside(&mut self, properties: &Properties, default: f64) -> Result<f64> {
        let (inside, ratio) = self.indices(properties, default)?;
        if inside != ratio {
            self.note(properties.element, "`ext_ior` is left out: the body around states the index outside");
        }
        Ok(self.at_least_one(properties, inside))
    }

    /// Reads the index of a coat or a thin pane relative to its surroundings.
    pub(super) fn relative_index(&mut self, properties: &Properties, default: f64) -> Result<f64> {
        let (_, ratio) = self.indices(properties, default)?;
        Ok(self.at_least_one(properties, ratio))
    }

    fn at_least_one(&mut self, properties: &Properties, index: f64) -> f64 {
        if index < 1.0 {
            self.note(properties.element, "an index of refraction below 1 becomes 1");
        }
        index.max(1.0)
    }

    /// Reads the complex index of a metal as Abbe's `conductor`. `None` is an ideal mirror.
    pub(super) fn metal(&mut self, properties: &Properties) -> Result<Option<Value>> {
        let material = properties.text("material")?.unwrap_or("none");
        let indices = [self.textured(properties, "eta")?, self.textured(properties, "k")?];
        match indices {
            [None, None] if material == "none" => Ok(None),
            [None, None] => {
                let mut entries = METALS.split(", ").filter_map(|entry| entry.split_once(' '));
                let metal = entries.find(|(known, _)| *known == material).map(|(_, metal)| metal);
                if metal.is_none() {
                    let what = format!("the metal \"{material}\" is not known and becomes chromium");
                    self.note(properties.element, what);
                }
                Ok(Some(json!({"metal": metal.unwrap_or("chromium")})))
            }
            [eta, k] => {
                let value = |textured: Option<Textured>, default: f64| {
                    textured.map_or(json!(default), |textured| textured.mean().held())
                };
                Ok(Some(json!({"eta": value(eta, 0.0), "k": value(k, 1.0)})))
            }
        }
    }
}
