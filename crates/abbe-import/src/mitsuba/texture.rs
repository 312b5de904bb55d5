//! Textures of a Mitsuba scene, as reflectances and as numbers.
//!
//! In both programs, the texture coordinate v = 0 is the upper row of a picture.

use super::{properties::Properties, reader::MitsubaReader, spectrum::MitsubaSpectrum, xml::XmlElement};
use abbe_format::without_nulls;
use abbe_format::{EncodingFile, PictureFile};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::atan2;
use glam::DMat4;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::rc::Rc;

#[derive(Debug, Clone)]
pub(super) enum Textured {
    Spectrum(MitsubaSpectrum),
    Bitmap(Bitmap),
    Checkerboard { colours: [MitsubaSpectrum; 2], uv: Option<Value> },
}

#[derive(Debug, Clone)]
pub(super) struct Bitmap {
    /// Path relative to the folder of the scene file.
    path: String,
    /// The path for reading.
    file: PathBuf,
    /// True if the picture has numbers instead of colours.
    raw: bool,
    /// True if the picture filters D65, as a light.
    filters_d65: bool,
    wrap: &'static str,
    filter: &'static str,
    uv: Option<Value>,
}

impl Textured {
    pub(super) fn mean(&self) -> MitsubaSpectrum {
        match self {
            Self::Spectrum(spectrum) => spectrum.clone(),
            Self::Bitmap(bitmap) => MitsubaSpectrum::Rgb(bitmap.mean()),
            Self::Checkerboard { colours: [a, b], .. } => a.combined(b, |a, b| 0.5 * (a + b)),
        }
    }

    pub(super) fn is_uniform(&self) -> bool {
        matches!(self, Self::Spectrum(_))
    }

    /// Returns true for a picture that filters D65. Other pictures filter a constant spectrum.
    pub(super) fn filters_d65(&self) -> bool {
        matches!(self, Self::Bitmap(bitmap) if bitmap.filters_d65)
    }

    /// Returns the picture of a normal map in the form of the scene file.
    pub(super) fn normals(&self) -> Option<Value> {
        if let Self::Bitmap(bitmap) = self { Some(bitmap.value("normals", true)) } else { None }
    }

    /// Returns the picture as a slide in the form of the scene file, and its largest component. The
    /// slide is the picture divided by this component.
    pub(super) fn slide(&self) -> Option<(Value, f64)> {
        let Self::Bitmap(bitmap) = self else { return None };
        let peak = bitmap.peak()?;
        Some((bitmap.reflectance(1.0 / peak), peak))
    }

    /// Returns the spectrum or texture times `gain` as a reflectance in the form of the scene file,
    /// at most 1. A picture is multiplied by at most the inverse of its largest component.
    pub(super) fn reflectance(&self, gain: f64) -> Value {
        let scaled = |spectrum: &MitsubaSpectrum| fraction(&spectrum.map(|value| gain * value)).coefficient();
        match self {
            Self::Spectrum(spectrum) => scaled(spectrum),
            Self::Bitmap(bitmap) => {
                let largest = if gain == 1.0 { None } else { bitmap.peak() };
                bitmap.reflectance(largest.map_or(1.0, |peak| gain.min(1.0 / peak)))
            }
            Self::Checkerboard { colours, uv } => checker(&scaled(&colours[0]), &scaled(&colours[1]), uv.as_ref()),
        }
    }
}

impl Bitmap {
    /// Returns the linear colours of the pixels. It is `None` if the picture cannot be read. The
    /// reader of the scene file then reports the picture.
    fn pixels(&self) -> Option<Vec<[f32; 3]>> {
        let picture = PictureFile::read(&self.file).ok()?;
        Some(picture.linear_rgb(self.raw.then_some(EncodingFile::Linear)))
    }

    /// Returns the largest linear component. `None` is a black or unreadable picture.
    fn peak(&self) -> Option<f64> {
        let peak = f64::from(self.pixels()?.as_flattened().iter().copied().fold(0.0, f32::max));
        (peak > 0.0 && peak.is_finite()).then_some(peak)
    }

    /// Returns the mean linear colour. It is 0.5 if the picture cannot be read.
    fn mean(&self) -> [f64; 3] {
        let Some(pixels) = self.pixels() else { return [0.5; 3] };
        let mut sum = [0.0; 3];
        for pixel in &pixels {
            sum.iter_mut().zip(pixel).for_each(|(sum, &value)| *sum += f64::from(value));
        }
        sum.map(|sum| sum / pixels.len().max(1) as f64)
    }

    /// Returns the picture as a reflectance in the form of the scene file, multiplied by a factor.
    fn reflectance(&self, factor: f64) -> Value {
        let mut image = self.value("reflectance", self.raw);
        if factor != 1.0 {
            image["factor"] = json!([factor, factor, factor]);
        }
        json!({"image": image})
    }

    /// Returns the picture in the form of the scene file. `linear` is the encoding of the file.
    fn value(&self, purpose: &str, linear: bool) -> Value {
        let encoding = match (purpose, linear) {
            ("reflectance", true) => Some("linear"),
            ("number", false) => Some("srgb"),
            _ => None,
        };
        let wrap = (self.wrap != "repeat").then_some(self.wrap);
        let filter = (self.filter != "bilinear").then_some(self.filter);
        without_nulls(json!({"path": self.path, "encoding": encoding, "wrap": wrap, "filter": filter, "uv": self.uv}))
    }
}

/// Returns the checkerboard of two values. Mitsuba has 2 × 2 squares per unit of uv.
fn checker(a: &Value, b: &Value, uv: Option<&Value>) -> Value {
    json!({"checker": without_nulls(json!({"a": a, "b": b, "scale": 2, "uv": uv}))})
}

fn fraction(spectrum: &MitsubaSpectrum) -> MitsubaSpectrum {
    spectrum.map(|value| value.clamp(0.0, 1.0))
}

impl MitsubaReader<'_> {
    /// Reads a property that is a spectrum or a texture.
    pub(super) fn textured(&mut self, properties: &Properties, name: &str) -> Result<Option<Textured>> {
        let Some(element) = properties.find(name) else { return Ok(None) };
        let element = self.document.resolve(element);
        self.texture(&element).map(Some)
    }

    pub(super) fn colour(&mut self, properties: &Properties, name: &str, default: f64) -> Result<Textured> {
        let textured = self.textured(properties, name)?;
        let textured = textured.unwrap_or(Textured::Spectrum(MitsubaSpectrum::Number(default)));
        if let Textured::Spectrum(spectrum) = &textured
            && !spectrum.is_fraction()
        {
            self.note(properties.element, format!("the values of \"{name}\" above 1 or below 0 become 1 and 0"));
        }
        Ok(textured)
    }

    /// Reads a property that is a reflectance, in the form of the scene file.
    pub(super) fn reflectance(&mut self, properties: &Properties, name: &str, default: f64) -> Result<Value> {
        Ok(self.colour(properties, name, default)?.reflectance(1.0))
    }

    /// Reads a property that is a number from 0 to 1 or a texture of such numbers, in the form of
    /// the scene file. Returns the number and 1 minus the number.
    pub(super) fn weight(&mut self, properties: &Properties, name: &str) -> Result<Option<[Value; 2]>> {
        let textured = self.textured(properties, name)?;
        Ok(textured.map(|textured| match &textured {
            Textured::Spectrum(spectrum) => {
                let value = spectrum.mean().clamp(0.0, 1.0);
                [json!(value), json!(1.0 - value)]
            }
            Textured::Bitmap(bitmap) => {
                let value = bitmap.value("number", bitmap.raw);
                let mut rest = value.clone();
                rest["range"] = json!([1, 0]);
                [json!({"image": value}), json!({"image": rest})]
            }
            // For numbers, Mitsuba exchanges the two values of a checkerboard.
            Textured::Checkerboard { colours, uv } => {
                let [b, a] = [0, 1].map(|i| colours[i].mean().clamp(0.0, 1.0));
                let [inverse_a, inverse_b] = [1.0 - a, 1.0 - b];
                [checker(&json!(a), &json!(b), uv.as_ref()), checker(&json!(inverse_a), &json!(inverse_b), uv.as_ref())]
            }
        }))
    }

    /// Reads a roughness. If there is an `alpha_scale`, the number is the microfacet parameter α,
    /// and not the roughness √α of the scene file. The scale multiplies α, unless it is a picture.
    pub(super) fn roughness(
        &mut self,
        properties: &Properties,
        name: &str,
        default: f64,
        alpha_scale: Option<f64>,
    ) -> Result<Value> {
        let root = |value: f64, scale: f64| (scale * value).clamp(0.0, 1.0).sqrt();
        let convert = |value: f64| alpha_scale.map_or(value.clamp(0.0, 1.0), |scale| root(value, scale));
        let Some(textured) = self.textured(properties, name)? else { return Ok(json!(convert(default))) };
        let place = properties.element.place();
        Ok(match &textured {
            Textured::Spectrum(spectrum) => json!(convert(spectrum.mean())),
            Textured::Checkerboard { colours, uv } => {
                let [b, a] = [0, 1].map(|i| convert(colours[i].mean()));
                checker(&json!(a), &json!(b), uv.as_ref())
            }
            Textured::Bitmap(bitmap) if alpha_scale.is_none() => json!({"image": bitmap.value("number", bitmap.raw)}),
            // The square root of the decoded value is nearly the encoded value.
            Textured::Bitmap(bitmap) if !bitmap.raw => {
                self.scene.leave_out(place, "a picture of roughnesses is decoded approximately");
                json!({"image": bitmap.value("number", true)})
            }
            Textured::Bitmap(_) => {
                self.scene.leave_out(place, "a picture of roughnesses with linear values is replaced by its mean");
                json!(convert(textured.mean().mean()))
            }
        })
    }

    fn texture(&mut self, element: &Rc<XmlElement>) -> Result<Textured> {
        if element.tag != "texture" {
            return self.spectrum(element).map(Textured::Spectrum);
        }
        let properties = Properties::new(element);
        if element.plugin() == "d65"
            && let Some(mut picture) = self.picture_before_d65(&properties)?
        {
            picture.filters_d65 = true;
            self.note_unread(&properties);
            return Ok(Textured::Bitmap(picture));
        }
        let textured = match element.plugin() {
            "bitmap" => Textured::Bitmap(self.bitmap(&properties)?),
            "checkerboard" => {
                let mut colour = |name: &str, default: f64| -> Result<MitsubaSpectrum> {
                    let textured = self.textured(&properties, name)?;
                    let textured = textured.unwrap_or(Textured::Spectrum(MitsubaSpectrum::Number(default)));
                    if !textured.is_uniform() {
                        self.note(element, "a texture inside a checkerboard is replaced by its mean");
                    }
                    Ok(textured.mean())
                };
                let colours = [colour("color0", 0.4)?, colour("color1", 0.2)?];
                Textured::Checkerboard { colours, uv: self.uv_map(&properties)? }
            }
            "uniform" | "rawconstant" | "srgb" | "d65" | "regular" | "irregular" | "blackbody" => {
                return self.spectrum(element).map(Textured::Spectrum);
            }
            other => {
                self.note(element, format!("a texture of the type \"{other}\" is not supported and becomes 0.5"));
                return Ok(Textured::Spectrum(MitsubaSpectrum::Number(0.5)));
            }
        };
        self.note_unread(&properties);
        Ok(textured)
    }

    /// Reads the picture inside a spectrum of the type "d65", if there is one.
    fn picture_before_d65(&mut self, properties: &Properties) -> Result<Option<Bitmap>> {
        let is_picture = |child: &Rc<XmlElement>| self.document.resolve(child).plugin() == "bitmap";
        let picture = properties.take(is_picture).pop().map(|it| self.document.resolve(it));
        let Some(picture) = picture else { return Ok(None) };
        let inner = Properties::new(&picture);
        let bitmap = self.bitmap(&inner)?;
        self.note_unread(&inner);
        Ok(Some(bitmap))
    }

    fn bitmap(&mut self, properties: &Properties) -> Result<Bitmap> {
        let element = properties.element;
        let (path, file) = self.document.file(element, properties.required_text("filename")?)?;
        let raw = properties.boolean("raw", false)?;
        let wrap = choice(properties, "wrap_mode", &["repeat", "mirror", "clamp"])?;
        let filter = choice(properties, "filter_type", &["bilinear", "nearest"])?;
        properties.ignore(&["format", "accel"]);
        let (path, uv) = (format!("{}{path}", self.folder), self.uv_map(properties)?);
        Ok(Bitmap { path, file, raw, filters_d65: false, wrap, filter, uv })
    }

    /// Reads the map of texture coordinates. `None` is the identity.
    fn uv_map(&mut self, properties: &Properties) -> Result<Option<Value>> {
        let matrix = properties.transform("to_uv")?;
        if matrix == DMat4::IDENTITY {
            return Ok(None);
        }
        let (u, v, offset) = (matrix.x_axis.truncate().truncate(), matrix.y_axis.truncate().truncate(), matrix.w_axis);
        if u.dot(v).abs() > 1e-6 * u.length() * v.length() {
            self.note(properties.element, "a shear of texture coordinates is left out");
        }
        let angle = atan2(-u.y, u.x).to_degrees();
        let scale_u = u.length();
        let scale_v = if scale_u > 0.0 { u.perp_dot(v) / scale_u } else { v.length() };
        let angle = if scale_u > 0.0 { angle } else { 0.0 };
        Ok(Some(json!({"scale": [scale_u, scale_v], "rotate": angle, "offset": [offset.x, offset.y]})))
    }
}

/// Returns one of the known words. The first word is the default.
fn choice(properties: &Properties, name: &str, known: &[&'static str]) -> Result<&'static str> {
    let Some(text) = properties.text(name)? else { return Ok(known[0]) };
    known
        .iter()
        .find(|word| **word == text)
        .copied()
        .ok_or_else(|| properties.element.error(format!("found \"{text}\" for \"{name}\"")).expected(known.join(", ")))
}
