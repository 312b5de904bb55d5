//! Textures of pbrt files.
//!
//! In pbrt, the texture coordinate v points up, and in Abbe it points down. The maps of texture
//! coordinates in this module contain the change of direction.

use super::parameters::{Parameter, Parameters};
use super::spectrum::SpectrumContext;
use abbe_spectra::error::Result;
use serde_json::{Value, json};

/// The affine map from pbrt's texture coordinates (u, v) to (s, t).
struct UvMapping {
    scale: [f64; 2],
    offset: [f64; 2],
}

impl UvMapping {
    fn read(parameters: &Parameters) -> Result<Self> {
        Ok(Self {
            scale: [parameters.number_or("uscale", 1.0)?, parameters.number_or("vscale", 1.0)?],
            offset: [parameters.number_or("udelta", 0.0)?, parameters.number_or("vdelta", 0.0)?],
        })
    }

    /// Returns the map for a picture. The upper edge of a picture is at t = 1.
    fn of_picture(&self) -> Value {
        let [scale, offset] = [self.scale, self.offset];
        json!({"scale": scale, "offset": [offset[0], 1.0 - scale[1] - offset[1]]})
    }

    /// Returns the map for a pattern over (s, t).
    fn of_pattern(&self) -> Value {
        let [scale, offset] = [self.scale, self.offset];
        json!({"scale": [scale[0], -scale[1]], "offset": [offset[0], offset[1] + scale[1]]})
    }
}

/// A reader of textures. It collects the parts that are left out.
pub(super) struct TextureReader<'a> {
    pub(super) spectra: SpectrumContext<'a>,
    /// The path from the folder of the scene file to the folder of the main file.
    pub(super) folder: &'a str,
    /// Returns the texture of a name, and whether it is a texture of numbers.
    pub(super) named: &'a dyn Fn(&str, bool) -> Option<Value>,
    pub(super) left_out: Vec<String>,
}

impl TextureReader<'_> {
    /// Reads a texture of numbers if `is_scalar` is true, and of reflectances otherwise.
    pub(super) fn read(&mut self, class: &str, is_scalar: bool, parameters: &Parameters) -> Result<Value> {
        parameters.ignore(&["filter", "maxanisotropy", "aamode"]);
        if let Some(mapping) = parameters.string("mapping")?
            && mapping != "uv"
        {
            self.left_out
                .push(format!("texture mapping \"{mapping}\" is replaced by the texture coordinates of the shape"));
        }
        match class {
            "constant" => self.value(parameters, "value", is_scalar, 1.0),
            "imagemap" => self.picture(parameters, is_scalar),
            "checkerboard" => {
                let [a, b] = [("tex1", 1.0), ("tex2", 0.0)]
                    .map(|(key, default)| self.value(parameters, key, is_scalar, default));
                let (a, b) = (a?, b?);
                if parameters.number_or("dimension", 2.0)? != 2.0 {
                    self.left_out.push("a checkerboard in space is replaced by one over texture coordinates".into());
                }
                if is_scalar && !(a.is_number() && b.is_number()) {
                    self.left_out.push("a checkerboard of textures of numbers has their mean values".into());
                }
                let [a, b] = if is_scalar { [a, b].map(|value| mean(&value)) } else { [a, b] };
                let uv = UvMapping::read(parameters)?.of_pattern();
                Ok(json!({"checker": {"a": a, "b": b, "scale": 1, "uv": uv}}))
            }
            "scale" => {
                let texture = self.value(parameters, "tex", is_scalar, 1.0)?;
                let factor = self.value(parameters, "scale", true, 1.0)?;
                Ok(self.product(texture, &factor, is_scalar))
            }
            "mix" => {
                let a = self.value(parameters, "tex1", is_scalar, 0.0)?;
                let b = self.value(parameters, "tex2", is_scalar, 1.0)?;
                let amount = mean(&self.value(parameters, "amount", true, 0.5)?).as_f64().unwrap_or(0.5);
                if !is_uniform(&a) || !is_uniform(&b) {
                    self.left_out.push("a mix of textures is replaced by the texture with the larger share".into());
                    return Ok(if amount < 0.5 { a } else { b });
                }
                Ok(match (a.as_f64(), b.as_f64()) {
                    (Some(a), Some(b)) => json!(a + amount * (b - a)),
                    _ if amount <= 0.0 => a,
                    _ if amount >= 1.0 => b,
                    _ => json!({"mix": [{"spectrum": a, "weight": 1.0 - amount}, {"spectrum": b, "weight": amount}]}),
                })
            }
            "fbm" | "wrinkled" | "windy" if is_scalar => {
                self.left_out.push(format!("texture \"{class}\" is replaced by noise"));
                let octaves = parameters.number_or("octaves", 8.0)?.clamp(1.0, 16.0);
                parameters.ignore(&["roughness"]);
                let uv = UvMapping::read(parameters)?.of_pattern();
                Ok(json!({"noise": {"a": 0, "b": 1, "scale": 1, "octaves": octaves as u32, "uv": uv}}))
            }
            _ => {
                self.left_out.push(format!("texture \"{class}\" is replaced by 0.5"));
                parameters.ignore_all();
                Ok(json!(0.5))
            }
        }
    }

    /// Reads a parameter that is a value or the name of a texture.
    pub(super) fn value(&mut self, parameters: &Parameters, key: &str, is_scalar: bool, default: f64) -> Result<Value> {
        let Some(parameter) = parameters.get(key) else { return Ok(json!(default)) };
        self.parameter(parameter, is_scalar)
    }

    fn parameter(&mut self, parameter: &Parameter, is_scalar: bool) -> Result<Value> {
        if parameter.kind != "texture" {
            let spectra = &self.spectra;
            return if is_scalar { spectra.coefficient(parameter, 1.0) } else { spectra.reflectance(parameter) };
        }
        let name = parameter.string()?;
        (self.named)(name, is_scalar).ok_or_else(|| parameter.place.error(format!("there is no texture \"{name}\"")))
    }

    fn picture(&mut self, parameters: &Parameters, is_scalar: bool) -> Result<Value> {
        let Some(file) = parameters.file("filename", self.spectra.folder, self.spectra.file_access)? else {
            self.left_out.push("a picture without a file name is replaced by 0.5".into());
            return Ok(json!(0.5));
        };
        let scale = parameters.number_or("scale", 1.0)?;
        let invert = parameters.flag_or("invert", false)?;
        let mut picture = json!({"path": format!("{}{file}", self.folder)});
        picture["wrap"] = match parameters.string("wrap")? {
            None | Some("repeat") => json!("repeat"),
            Some("clamp") => json!("clamp"),
            Some(other) => {
                self.left_out.push(format!("wrap mode \"{other}\" is replaced by \"clamp\""));
                json!("clamp")
            }
        };
        match parameters.string("encoding")? {
            None => {}
            Some("linear") => picture["encoding"] = json!("linear"),
            Some("sRGB") => picture["encoding"] = json!("srgb"),
            Some(other) => self.left_out.push(format!("encoding \"{other}\" is replaced by that of the file type")),
        }
        let uv = UvMapping::read(parameters)?.of_picture();
        if uv != json!({"scale": [1.0, 1.0], "offset": [0.0, 0.0]}) {
            picture["uv"] = uv;
        }
        if is_scalar {
            picture["range"] = if invert { json!([scale, 0.0]) } else { json!([0.0, scale]) };
        } else {
            picture["factor"] = json!([scale, scale, scale]);
            if invert {
                self.left_out.push("a picture of reflectances is not inverted".into());
            }
        }
        Ok(json!({"image": picture}))
    }

    /// Returns a texture multiplied by a number.
    pub(super) fn product(&mut self, texture: Value, factor: &Value, is_scalar: bool) -> Value {
        let Some(factor) = factor.as_f64() else {
            self.left_out.push("a texture of factors is replaced by its mean value".into());
            return self.product(texture, &mean(factor), is_scalar);
        };
        if is_scalar {
            return map_numbers(texture, &|x| factor * x);
        }
        match texture {
            Value::Number(number) => json!(factor * number.as_f64().unwrap_or(0.0)),
            Value::Object(mut form) => {
                if let Some(factors) = form.get_mut("image").and_then(|image| image["factor"].as_array_mut()) {
                    factors.iter_mut().for_each(|x| *x = json!(factor * x.as_f64().unwrap_or(1.0)));
                } else if let Some(pattern) = form.get_mut("checker") {
                    for key in ["a", "b"] {
                        pattern[key] = self.product(pattern[key].take(), &json!(factor), is_scalar);
                    }
                } else {
                    return super::spectrum::scaled(Value::Object(form), factor);
                }
                Value::Object(form)
            }
            other @ (Value::Null | Value::Bool(_) | Value::String(_) | Value::Array(_)) => {
                super::spectrum::scaled(other, factor)
            }
        }
    }
}

pub(super) fn is_uniform(value: &Value) -> bool {
    !["image", "checker", "noise", "stripes", "bands"].iter().any(|key| value.get(key).is_some())
}

/// Returns a mean number of a texture of numbers. For pictures, returns the middle of their range.
pub(super) fn mean(value: &Value) -> Value {
    let number = |key: &str| value.pointer(key).and_then(Value::as_f64);
    let ends = [("/image/range/0", "/image/range/1"), ("/checker/a", "/checker/b"), ("/noise/a", "/noise/b")];
    let middle = ends.iter().find_map(|(a, b)| Some(0.5 * (number(a)? + number(b)?)));
    if value.is_number() { value.clone() } else { json!(middle.unwrap_or(0.5)) }
}

/// Applies a function to a number, or to the extreme values of a texture of numbers.
pub(super) fn map_numbers(mut value: Value, f: &dyn Fn(f64) -> f64) -> Value {
    let apply = |x: &mut Value| *x = json!(f(x.as_f64().unwrap_or(0.5)));
    if value.is_number() {
        apply(&mut value);
    }
    if let Some(range) = value.pointer_mut("/image/range").and_then(Value::as_array_mut) {
        range.iter_mut().for_each(apply);
    }
    for pattern in ["checker", "noise"] {
        if let Some(pattern) = value.get_mut(pattern) {
            ["a", "b"].iter().for_each(|key| apply(&mut pattern[*key]));
        }
    }
    value
}
