//! Converts the BSDFs of a Mitsuba scene to materials.

use super::reader::{MitsubaReader, MitsubaSurface};
use super::{properties::Properties, texture::Textured, xml::XmlElement};
use abbe_format::without_nulls;
use abbe_optics::fresnel;
use abbe_spectra::error::Result;
use serde_json::{Value, json};
use std::rc::Rc;

/// The median slope of Beckmann's microfacets with α = 1: √ln 2. That of GGX microfacets is 1.
const MEDIAN_SLOPE: f64 = 0.832_554_611_157_697_8;

pub(super) struct BsdfContext<'a> {
    /// The name that the material gets, if it is free.
    pub(super) name: &'a str,
    /// The name of the medium inside the shape.
    pub(super) medium: Option<&'a str>,
    /// True inside `twosided`.
    twosided: bool,
}

impl MitsubaReader<'_> {
    /// Converts a BSDF. `medium` is the name of the medium inside the shape.
    pub(super) fn surface(&mut self, bsdf: &Rc<XmlElement>, medium: Option<&str>) -> Result<MitsubaSurface> {
        let key = (Rc::as_ptr(bsdf), medium.map(str::to_string));
        if let Some((_, surface)) = self.surfaces.iter().find(|(known, _)| *known == key) {
            return Ok(surface.clone());
        }
        let context = BsdfContext { name: bsdf.title(), medium, twosided: false };
        let surface = self.converted(bsdf, &context)?;
        self.surfaces.push((key, surface.clone()));
        Ok(surface)
    }

    /// Returns the surface of a shape without BSDF. A light reflects nothing.
    pub(super) fn default_surface(&mut self, emits: bool) -> MitsubaSurface {
        let (name, material) =
            if emits { ("absorber", json!("absorber")) } else { ("default", json!({"diffuse": {"reflectance": 0.5}})) };
        MitsubaSurface::Material { name: self.scene.add_material(name, material), one_sided: !emits }
    }

    fn converted(&mut self, bsdf: &Rc<XmlElement>, context: &BsdfContext) -> Result<MitsubaSurface> {
        let properties = Properties::new(bsdf);
        let surface = match bsdf.plugin() {
            "twosided" => {
                let sides = self.tagged(&properties, "bsdf");
                if sides.len() > 1 {
                    self.note(bsdf, "the second BSDF of \"twosided\" is left out");
                }
                properties.ignore(&["allow_transmission"]);
                self.first(&properties, &sides, &BsdfContext { twosided: true, ..*context })?
            }
            "mask" => self.mask(&properties, context)?,
            "normalmap" => self.normal_map(&properties, context)?,
            "bumpmap" => {
                self.note(bsdf, "\"bumpmap\" is left out: the surface is smooth");
                let sides = self.tagged(&properties, "bsdf");
                properties.take(|_| true);
                self.first(&properties, &sides, context)?
            }
            "blendbsdf" => self.blend(&properties, context)?,
            "null" => match context.medium {
                Some(medium) => self.add(context, json!({"boundary": {"medium": medium}}), false),
                None => MitsubaSurface::Invisible,
            },
            _ => self.simple(&properties, context)?,
        };
        self.note_unread(&properties);
        Ok(surface)
    }

    pub(super) fn add(&mut self, context: &BsdfContext, material: Value, one_sided: bool) -> MitsubaSurface {
        let name = self.scene.add_material(context.name, material);
        MitsubaSurface::Material { name, one_sided: one_sided && !context.twosided }
    }

    fn first(&mut self, outer: &Properties, parts: &[Rc<XmlElement>], context: &BsdfContext) -> Result<MitsubaSurface> {
        let element = outer.element;
        let inner = parts.first().ok_or_else(|| element.error(format!("\"{}\" without a BSDF", element.plugin())))?;
        self.converted(inner, context)
    }

    /// Converts a surface with partial opacity. It becomes a surface with holes.
    fn mask(&mut self, properties: &Properties, context: &BsdfContext) -> Result<MitsubaSurface> {
        let weights = self.weight(properties, "opacity")?;
        let nested = self.tagged(properties, "bsdf");
        let place = properties.element.place();
        let surface = self.first(properties, &nested, context)?;
        let (Some([covered, open]), MitsubaSurface::Material { name, one_sided }) = (weights, &surface) else {
            return Ok(surface);
        };
        let Some(name) = self.scene.with_holes(name, &covered, &open) else {
            self.scene.leave_out(place, "the mask of a body, or of a blend, is left out");
            return Ok(surface);
        };
        Ok(MitsubaSurface::Material { name, one_sided: *one_sided })
    }

    fn normal_map(&mut self, properties: &Properties, context: &BsdfContext) -> Result<MitsubaSurface> {
        let place = properties.element.place();
        let map = self.textured(properties, "normalmap")?;
        let nested = self.tagged(properties, "bsdf");
        let surface = self.first(properties, &nested, context)?;
        let MitsubaSurface::Material { name, one_sided } = &surface else { return Ok(surface) };
        let map = map.as_ref().and_then(Textured::normals);
        let Some(name) = map.and_then(|map| self.scene.with_normal_map(name, map)) else {
            self.scene.leave_out(place, "a normal map without a picture, or inside another one, is left out");
            return Ok(surface);
        };
        Ok(MitsubaSurface::Material { name, one_sided: *one_sided })
    }

    /// Converts a mix of two BSDFs. The weight belongs to the second one.
    fn blend(&mut self, properties: &Properties, context: &BsdfContext) -> Result<MitsubaSurface> {
        let element = properties.element;
        let weight = self.weight(properties, "weight")?;
        let [second, first] = weight.ok_or_else(|| element.error("\"blendbsdf\" without the property \"weight\""))?;
        let nested = self.tagged(properties, "bsdf");
        let error = || element.error(format!("\"blendbsdf\" with {} BSDFs", nested.len()));
        let [a, b] = nested.as_slice() else { return Err(error().expected("two BSDFs")) };
        let parts = [(a, first), (b, second)];
        let mut mix = Vec::new();
        let mut one_sided = false;
        for (bsdf, weight) in parts {
            let inner = BsdfContext { name: bsdf.title(), ..*context };
            match self.converted(bsdf, &inner)? {
                MitsubaSurface::Material { name, one_sided: one } => {
                    one_sided |= one;
                    let inner = self.scene.without_normal_map(&name);
                    if inner != name {
                        self.note(bsdf, "the normal map of a part of a blend is left out");
                    }
                    mix.push(json!({"material": inner, "weight": weight}));
                }
                MitsubaSurface::Invisible => self.note(bsdf, "an invisible part of a blend is left out"),
            }
        }
        Ok(match mix.len() {
            0 => MitsubaSurface::Invisible,
            _ => self.add(context, json!({"mix": mix}), one_sided),
        })
    }

    fn simple(&mut self, properties: &Properties, context: &BsdfContext) -> Result<MitsubaSurface> {
        let bsdf = properties.element;
        let (material, one_sided) = match bsdf.plugin() {
            "diffuse" => {
                let reflectance = self.reflectance(properties, "reflectance", 0.5)?;
                (json!({"diffuse": {"reflectance": reflectance}}), true)
            }
            "dielectric" => (self.glass(properties, None, context)?, false),
            "roughdielectric" => {
                let roughness = self.microfacets(properties)?;
                (self.glass(properties, Some(roughness), context)?, false)
            }
            "thindielectric" => {
                let ior = self.relative_index(properties, 1.5046)?;
                self.note_factors(properties, &["specular_reflectance", "specular_transmittance"])?;
                if let Some(medium) = context.medium {
                    let what = "a thin pane around a medium reflects nothing: it becomes the boundary of the medium";
                    self.note(bsdf, what);
                    return Ok(self.add(context, json!({"boundary": {"medium": medium}}), false));
                }
                (json!({"thin_dielectric": {"ior": ior}}), false)
            }
            "conductor" => (self.conductor(properties, None)?, true),
            "roughconductor" => {
                let roughness = self.microfacets(properties)?;
                (self.conductor(properties, Some(roughness))?, true)
            }
            "plastic" => (self.plastic(properties, json!(0.0))?, true),
            "roughplastic" | "pplastic" => {
                let roughness = self.microfacets(properties)?;
                (self.plastic(properties, roughness)?, true)
            }
            "principled" => return self.principled(properties, context),
            "difftrans" | "diffuse_transmitter" => {
                let transmittance = self.reflectance(properties, "transmittance", 0.5)?;
                let reflectance = self.reflectance(properties, "reflectance", 0.0)?;
                (json!({"translucent": {"reflectance": reflectance, "transmittance": transmittance}}), false)
            }
            other => {
                let what = format!("a BSDF of the type \"{other}\" is not supported and becomes diffuse with 0.5");
                self.note(bsdf, what);
                properties.take(|_| true);
                (json!({"diffuse": {"reflectance": 0.5}}), true)
            }
        };
        if context.medium.is_some() && material.get("dielectric").is_none() {
            self.note(bsdf, "a medium behind an opaque surface is left out");
        }
        Ok(self.add(context, material, one_sided))
    }

    fn glass(&mut self, properties: &Properties, roughness: Option<Value>, context: &BsdfContext) -> Result<Value> {
        self.note_factors(properties, &["specular_reflectance", "specular_transmittance"])?;
        let ior = self.index_inside(properties, 1.5046)?;
        Ok(json!({"dielectric": without_nulls(json!({"ior": ior, "roughness": roughness, "medium": context.medium}))}))
    }

    fn conductor(&mut self, properties: &Properties, roughness: Option<Value>) -> Result<Value> {
        properties.ignore(&["ext_eta"]);
        match self.metal(properties)? {
            Some(mut metal) => {
                self.note_factors(properties, &["specular_reflectance"])?;
                if let Some(roughness) = roughness {
                    metal["roughness"] = roughness;
                }
                Ok(json!({"conductor": metal}))
            }
            None => {
                let reflectance = self.reflectance(properties, "specular_reflectance", 1.0)?;
                Ok(match roughness {
                    Some(roughness) => json!({"conductor": {"reflectance": reflectance, "roughness": roughness}}),
                    None => json!({"mirror": {"reflectance": reflectance}}),
                })
            }
        }
    }

    fn plastic(&mut self, properties: &Properties, roughness: Value) -> Result<Value> {
        let ior = self.relative_index(properties, 1.49)?;
        self.note_factors(properties, &["specular_reflectance"])?;
        let reflectance = if properties.boolean("nonlinear", false)? {
            match self.textured(properties, "diffuse_reflectance")? {
                Some(textured) if !textured.is_uniform() => {
                    self.note(properties.element, "`nonlinear` is left out, because the reflectance is a texture");
                    self.reflectance(properties, "diffuse_reflectance", 0.5)?
                }
                textured => {
                    // The fraction of diffuse light that the coat reflects back to the base. Of the
                    // light that enters the coat, Abbe states the fraction that leaves it again.
                    let inside = internal_reflectance(ior);
                    let seen = |r: f64| r.clamp(0.0, 1.0) * (1.0 - inside) / (1.0 - r.clamp(0.0, 1.0) * inside);
                    textured.map_or(json!(seen(0.5)), |textured| textured.mean().map(seen).coefficient())
                }
            }
        } else {
            self.reflectance(properties, "diffuse_reflectance", 0.5)?
        };
        Ok(json!({"glossy": {"reflectance": reflectance, "ior": ior, "roughness": roughness}}))
    }

    fn microfacets(&mut self, properties: &Properties) -> Result<Value> {
        let place = properties.element.place();
        properties.ignore(&["sample_visible"]);
        let distribution = properties.text("distribution")?.unwrap_or("beckmann");
        let mut scale = 1.0;
        if !distribution.eq_ignore_ascii_case("ggx") {
            let what = format!(
                "the microfacet distribution \"{distribution}\" is replaced by GGX with the same median slope: α is \
                 multiplied by 0.83, unless it is a picture"
            );
            self.scene.leave_out(place.clone(), what);
            scale = MEDIAN_SLOPE;
        }
        let [along, across] = ["alpha_u", "alpha_v"].map(|name| self.textured(properties, name));
        if let (Some(along), Some(across)) = (along?, across?) {
            if !(along.is_uniform() && across.is_uniform()) {
                let what = "textures of the roughness along u and v are replaced by their means";
                self.scene.leave_out(place.clone(), what);
            }
            let [along, across] = [along, across].map(|alpha| alpha.mean().mean());
            if along != across {
                self.scene.leave_out(place, "different roughnesses along u and v are replaced by their geometric mean");
            }
            return Ok(json!((scale * (along * across).sqrt()).clamp(0.0, 1.0).sqrt()));
        }
        self.roughness(properties, "alpha", 0.1, Some(scale))
    }

    /// Notes factors of reflection and transmission that are not 1.
    fn note_factors(&mut self, properties: &Properties, names: &[&str]) -> Result<()> {
        for name in names {
            if let Some(factor) = self.textured(properties, name)?
                && (!factor.is_uniform() || factor.mean().constant() != Some(1.0))
            {
                self.note(properties.element, format!("the factor \"{name}\" is left out"));
            }
        }
        Ok(())
    }
}

/// Returns the fraction of diffuse light inside a body of index `ior` that its surface reflects.
fn internal_reflectance(ior: f64) -> f64 {
    let steps = 2000_u32;
    let squared_cosine = |step: u32| (f64::from(step) + 0.5) / f64::from(steps);
    let sum: f64 = (0..steps).map(|step| fresnel::dielectric(squared_cosine(step).sqrt(), ior, 1.0)).sum();
    sum / f64::from(steps)
}
