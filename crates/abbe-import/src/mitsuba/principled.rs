//! Converts Disney's BSDF of a Mitsuba scene (Burley 2012, 2015).
//!
//! The diffuse part of this BSDF does not lose the light that the specular part reflects, so a
//! white surface reflects more light than it receives. The base of a `glossy` surface only has the
//! light that passes its coat. It is therefore made brighter, so that the albedo for diffuse light
//! is the same.

use super::reader::{MitsubaReader, MitsubaSurface};
use super::{bsdf::BsdfContext, properties::Properties};
use abbe_format::without_nulls;
use abbe_optics::bsdf::Glossy;
use abbe_optics::glass::RefractiveIndex;
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::cos;
use abbe_spectra::spectrum::Spectrum;
use serde_json::{Value, json};
use std::f64::consts::PI;

impl MitsubaReader<'_> {
    /// Converts Disney's BSDF to a mix of a metal and a coated diffuse surface, or to glass.
    pub(super) fn principled(&mut self, properties: &Properties, context: &BsdfContext) -> Result<MitsubaSurface> {
        let bsdf = properties.element;
        let what = "a BSDF of the type \"principled\" is replaced by a metal, by a glossy surface with the same \
                    albedo, by a mix of both, or by glass";
        self.note(bsdf, what);
        let roughness = self.roughness(properties, "roughness", 0.5, None)?;
        let base = self.colour(properties, "base_color", 0.5)?;
        let ior = match properties.optional_number("eta")? {
            Some(eta) => eta.max(1.0),
            None => 2.0 / (1.0 - (0.08 * properties.number("specular", 0.5)?.clamp(0.0, 1.0)).sqrt()) - 1.0,
        };
        let transmission = self.textured(properties, "spec_trans")?.map_or(0.0, |it| it.mean().mean());
        let metallic = self.weight(properties, "metallic")?;
        if transmission >= 0.5 {
            let glass = without_nulls(json!({"ior": ior, "roughness": roughness, "medium": context.medium}));
            return Ok(self.add(context, json!({"dielectric": glass}), false));
        }
        let [weight, rest] = metallic.unwrap_or([json!(0.0), json!(1.0)]);
        let is_absent = |weight: &Value| weight.as_f64() == Some(0.0);
        let metal = json!({"conductor": {"reflectance": base.reflectance(1.0), "roughness": roughness}});
        if is_absent(&rest) {
            return Ok(self.add(context, metal, true));
        }
        let gain = gain(roughness.as_f64().unwrap_or(0.5), ior)?;
        let glossy = json!({"glossy": {"reflectance": base.reflectance(gain), "ior": ior, "roughness": roughness}});
        if is_absent(&weight) {
            return Ok(self.add(context, glossy, true));
        }
        let metal = self.scene.add_material(&format!("{} metal", context.name), metal);
        let glossy = self.scene.add_material(&format!("{} base", context.name), glossy);
        let parts = json!([{"material": metal, "weight": weight}, {"material": glossy, "weight": rest}]);
        Ok(self.add(context, json!({"mix": parts}), true))
    }
}

/// Returns the ratio of the reflectance of the base of a `glossy` surface to the base colour, so
/// that both surfaces have the same albedo for diffuse light.
fn gain(roughness: f64, ior: f64) -> Result<f64> {
    Ok(diffuse_albedo(roughness) / (1.0 - coat_albedo(roughness, ior)?))
}

/// Returns the albedo of the coat alone for diffuse light.
fn coat_albedo(roughness: f64, ior: f64) -> Result<f64> {
    let coat = Glossy::new(Spectrum::constant(0.0), RefractiveIndex::constant(ior)?, roughness * roughness)?;
    Ok(coat.coat_albedo(550.0))
}

/// Returns the albedo of Disney's diffuse reflection with the base colour 1, for diffuse light. The
/// albedo is 0.953 for the roughness 0, and 1.065 for the roughness 1 (Burley 2015, eq. 4).
fn diffuse_albedo(roughness: f64) -> f64 {
    const STEPS: u32 = 24;
    let middle = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS);
    let schlick = |cosine: f64| (1.0 - cosine).powi(5);
    let mut sum = 0.0;
    for step in 0..STEPS.pow(3) {
        let [out, incoming] = [step, step / STEPS].map(|step| middle(step % STEPS).sqrt());
        let sines = ((1.0 - out * out) * (1.0 - incoming * incoming)).sqrt();
        let squared_half = 0.5 * (1.0 + out * incoming + sines * cos(PI * middle(step / STEPS.pow(2))));
        let [out, incoming] = [out, incoming].map(schlick);
        let retro = 2.0 * roughness * squared_half;
        sum += (1.0 - 0.5 * out) * (1.0 - 0.5 * incoming) + retro * (out + incoming + out * incoming * (retro - 1.0));
    }
    sum / f64::from(STEPS.pow(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_albedo_is_that_of_mitsuba() {
        // The mean weight of 120,000 samples of Mitsuba 3.9.1 (`principled`, base colour 0.5, the
        // other values by default) for diffuse light. The standard error is 0.0011 or less.
        for (roughness, expected) in [(0.2, 0.5747), (0.5, 0.5636), (0.8, 0.5521)] {
            let coat = coat_albedo(roughness, 1.5).unwrap();
            let albedo = coat + 0.5 * gain(roughness, 1.5).unwrap() * (1.0 - coat);
            assert!((albedo - expected).abs() < 0.003, "roughness {roughness}: {albedo}");
        }
    }
}
