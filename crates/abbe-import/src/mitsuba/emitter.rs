//! Converts the emitters of a Mitsuba scene to lights.

use super::spectrum::{EmissionSpectrum, MitsubaSpectrum};
use super::transform::{affine, steps};
use super::{properties::Properties, reader::MitsubaReader, texture::Textured, xml::XmlElement};
use abbe_spectra::error::Result;
use glam::DVec3;
use serde_json::{Value, json};

impl MitsubaReader<'_> {
    pub(super) fn emitter(&mut self, emitter: &XmlElement) -> Result<()> {
        let properties = Properties::new(emitter);
        let light = match emitter.plugin() {
            "point" => self.point_light(&properties)?,
            "spot" => self.spot_light(&properties)?,
            "directional" => self.directional_light(&properties)?,
            "constant" => {
                let light = self.light_spectrum(&properties, "radiance")?;
                let environment = json!({"spectrum": light.spectrum, "luminance": light.quantity});
                (!light.is_dark()).then(|| json!({"environment": environment}))
            }
            "envmap" => Some(self.environment_map(&properties)?),
            other => {
                self.note(emitter, format!("an emitter of the type \"{other}\" is not supported and is left out"));
                self.scene.left_out_lights = true;
                return Ok(());
            }
        };
        self.note_unread(&properties);
        if let Some(light) = light {
            self.scene.add_light(light);
        }
        Ok(())
    }

    /// Converts the emission of a shape. Returns `None` if the shape emits no light.
    pub(super) fn area_emission(&mut self, emitter: &XmlElement) -> Result<Option<Value>> {
        if emitter.plugin() != "area" {
            self.note(emitter, format!("an emitter of the type \"{}\" on a shape is left out", emitter.plugin()));
            return Ok(None);
        }
        let properties = Properties::new(emitter);
        let textured = self.light_texture(&properties, "radiance")?;
        if let Some((slide, peak)) = textured.slide() {
            self.note_unread(&properties);
            // Without a filter of D65, Mitsuba emits the reflectance spectra of the texels.
            let spectrum = if textured.filters_d65() { json!("D65") } else { json!(1) };
            return Ok(Some(json!({"spectrum": spectrum, "luminance": peak, "slide": slide})));
        }
        let light = self.mean_light(&properties, "radiance", &textured)?;
        self.note_unread(&properties);
        Ok((!light.is_dark()).then(|| json!({"spectrum": light.spectrum, "luminance": light.quantity})))
    }

    /// Reads the radiance, intensity or irradiance of an emitter, or the mean of its texture.
    fn light_spectrum(&mut self, properties: &Properties, name: &str) -> Result<EmissionSpectrum> {
        let textured = self.light_texture(properties, name)?;
        self.mean_light(properties, name, &textured)
    }

    /// Reads the spectrum or the texture of an emitter, which is 1 by default.
    fn light_texture(&mut self, properties: &Properties, name: &str) -> Result<Textured> {
        properties.ignore(&["sampling_weight"]);
        let textured = self.textured(properties, name)?;
        Ok(textured.unwrap_or(Textured::Spectrum(MitsubaSpectrum::Number(1.0))))
    }

    /// Returns the light of a spectrum, or of the mean of a texture.
    fn mean_light(&mut self, properties: &Properties, name: &str, textured: &Textured) -> Result<EmissionSpectrum> {
        if !textured.is_uniform() {
            self.note(properties.element, format!("the texture of \"{name}\" is replaced by its mean"));
        }
        textured.mean().light().map_err(|error| properties.element.locate(error))
    }

    fn point_light(&mut self, properties: &Properties) -> Result<Option<Value>> {
        let light = self.light_spectrum(properties, "intensity")?;
        let to_world = affine(properties.element, properties.transform("to_world")?)?;
        let at = properties.vector("position")?.map_or(to_world.translation, |at| to_world.transform_point3(at));
        let point = json!({"at": at.to_array(), "spectrum": light.spectrum, "luminous_intensity": light.quantity});
        Ok((!light.is_dark()).then(|| json!({"point": point})))
    }

    fn spot_light(&mut self, properties: &Properties) -> Result<Option<Value>> {
        let light = self.light_spectrum(properties, "intensity")?;
        let element = properties.element;
        let to_world = affine(element, properties.transform("to_world")?)?;
        let cutoff = properties.number("cutoff_angle", 20.0)?;
        let beam = properties.number("beam_width", 0.75 * cutoff)?.clamp(0.0, cutoff.max(0.0));
        if !(cutoff > 0.0 && cutoff < 180.0) {
            return Err(element.error(format!("found the cutoff angle {cutoff}")).expected("above 0 and below 180"));
        }
        let axis = to_world.transform_vector3(DVec3::Z).normalize_or(DVec3::Z);
        let spot = json!({
            "at": to_world.translation.to_array(), "to": (to_world.translation + axis).to_array(),
            "half_angle": cutoff, "penumbra": cutoff - beam, "falloff": "linear",
            "spectrum": light.spectrum, "luminous_intensity": light.quantity
        });
        Ok((!light.is_dark()).then(|| json!({"spot": spot})))
    }

    fn directional_light(&mut self, properties: &Properties) -> Result<Option<Value>> {
        let light = self.light_spectrum(properties, "irradiance")?;
        let to_world = affine(properties.element, properties.transform("to_world")?)?;
        let local = properties.vector("direction")?.unwrap_or(DVec3::Z);
        let toward = to_world.transform_vector3(local).try_normalize();
        let toward = toward.ok_or_else(|| properties.element.error("the direction of the light is zero"))?;
        let form = json!({"toward": toward.to_array(), "spectrum": light.spectrum, "illuminance": light.quantity});
        Ok((!light.is_dark()).then(|| json!({"directional": form})))
    }

    /// Converts a picture of all directions. In Mitsuba, the middle of the picture is in the
    /// direction +z. In Abbe, it is in the direction −z.
    fn environment_map(&mut self, properties: &Properties) -> Result<Value> {
        let element = properties.element;
        properties.ignore(&["mis_compensation", "sampling_weight"]);
        let (path, _) = self.document.file(element, properties.required_text("filename")?)?;
        let to_world = affine(element, properties.transform("to_world")?)?;
        let rotation = glam::DAffine3 { translation: DVec3::ZERO, ..to_world };
        let mut transform = vec![json!({"rotate": {"axis": [0, 1, 0], "degrees": 180}})];
        transform.extend(steps(rotation));
        Ok(json!({"environment": {
            "image": format!("{}{path}", self.folder), "luminance": properties.number("scale", 1.0)?,
            "transform": transform
        }}))
    }
}
