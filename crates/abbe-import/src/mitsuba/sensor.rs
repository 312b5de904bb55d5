//! Converts the sensor of a Mitsuba scene to the camera and the film.

use super::xml::{XmlElement, parse};
use super::{properties::Properties, reader::MitsubaReader, transform::affine};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::{atan, hypot, tan};
use glam::DVec3;
use serde_json::json;
use std::rc::Rc;

/// The default size of a film in pixels.
const DEFAULT_SIZE: [f64; 2] = [768.0, 576.0];

/// The largest size of a film in pixels.
const MAX_SIZE: f64 = 100_000.0;

/// The size of 35 mm film in mm, which `focal_length` refers to.
const FILM_MM: [f64; 2] = [36.0, 24.0];

impl MitsubaReader<'_> {
    /// Converts the first sensor of the scene.
    pub(super) fn sensor(&mut self, sensors: &[Rc<XmlElement>]) -> Result<()> {
        let usable = |sensor: &&Rc<XmlElement>| ["perspective", "thinlens", "orthographic"].contains(&sensor.plugin());
        let Some(sensor) = sensors.iter().find(usable) else {
            let other = sensors.first().map_or(&self.document.root, |sensor| sensor);
            let error = other.error("the scene has no sensor that can be converted");
            return Err(error.expected("a sensor of the type \"perspective\", \"thinlens\" or \"orthographic\""));
        };
        for other in sensors.iter().filter(|other| !Rc::ptr_eq(other, sensor)) {
            self.note(other, "a further sensor is left out");
        }
        let properties = Properties::new(sensor);
        let [width, height] = self.film(&properties)?;
        let to_world = affine(sensor, properties.transform("to_world")?)?;
        if to_world.matrix3.determinant() < 0.0 {
            self.note(sensor, "the mirrored sensor is left out: the picture is not mirrored");
        }
        // A Mitsuba camera looks along +z, +y is up, and +x is to the left.
        let direction = |local: DVec3| to_world.transform_vector3(local).normalize_or(local);
        let lens = if sensor.plugin() == "orthographic" {
            // The picture is 2 wide before the transform.
            let half_width = to_world.transform_vector3(DVec3::X).length();
            let pictured = to_world.transform_vector3(DVec3::Y).length() / half_width;
            if (pictured - 1.0).abs() > 1e-6 {
                self.note(sensor, "the vertical stretch of an orthographic sensor is left out");
            }
            json!({"orthographic": {"height": 2.0 * half_width * height / width}})
        } else if sensor.plugin() == "thinlens" {
            let fov = vertical_fov(&properties, width / height)?;
            let focus = properties.optional_number("focus_distance")?.filter(|&distance| distance > 0.0);
            let focus = focus.ok_or_else(|| sensor.error("a thin lens without a focus distance above 0"))?;
            let radius = properties.number("aperture_radius", 0.0)?;
            let defocus = 2.0 * atan(radius.max(0.0) / focus).to_degrees();
            json!({"thin": {"fov": fov, "focus_distance": focus, "defocus_angle": defocus}})
        } else {
            // A pinhole camera has no focus.
            properties.ignore(&["focus_distance"]);
            json!({"pinhole": {"fov": vertical_fov(&properties, width / height)?}})
        };
        self.scene.camera = json!({
            "from": to_world.translation.to_array(), "at": (to_world.translation + direction(DVec3::Z)).to_array(),
            "up": direction(DVec3::Y).to_array(), "lens": lens
        });
        let [near, far] = [properties.number("near_clip", 1e-2)?, properties.number("far_clip", 1e4)?];
        if near > 0.1 || far < 100.0 {
            let what = format!(
                "the clip planes of the sensor are left out: surfaces nearer than {near} or farther than {far} are visible"
            );
            self.note(sensor, what);
        }
        properties.take(|child| child.tag == "sampler");
        if let Some(medium) = self.tagged(&properties, "medium").pop() {
            self.scene.atmosphere = self.medium(&medium)?;
            self.outside = Some(medium);
        }
        self.note_unread(&properties);
        Ok(())
    }

    /// Converts the size of the film. Its other properties concern the output file.
    fn film(&mut self, properties: &Properties) -> Result<[f64; 2]> {
        let mut size = DEFAULT_SIZE;
        if let Some(film) = self.tagged(properties, "film").pop() {
            let inner = Properties::new(&film);
            size = [inner.number("width", DEFAULT_SIZE[0])?, inner.number("height", DEFAULT_SIZE[1])?];
            if size.iter().any(|&pixels| !(1.0..=MAX_SIZE).contains(&pixels)) {
                return Err(film.error("the size of the film is out of range").expected("from 1 to 100000 pixels"));
            }
            inner.take(|child| !child.name().starts_with("crop"));
            self.note_unread(&inner);
        }
        let [width, height] = size.map(|pixels| pixels as u32);
        self.scene.film = json!({"width": width, "height": height});
        Ok(size.map(f64::floor))
    }
}

/// Returns the vertical field of view in degrees for a film of the aspect width / height.
fn vertical_fov(properties: &Properties, aspect: f64) -> Result<f64> {
    let element = properties.element;
    let axis = properties.text("fov_axis")?.unwrap_or("x").to_lowercase();
    let focal_length = properties.find("focal_length");
    let (half_tangent, axis) = match properties.optional_number("fov")? {
        Some(fov) if fov > 0.0 && fov < 180.0 => (tan(0.5 * fov.to_radians()), axis),
        Some(fov) => {
            return Err(element.error(format!("found the field of view {fov}")).expected("above 0 and below 180"));
        }
        None => {
            let text = focal_length.map_or(Ok("50mm"), |length| length.required("value"))?;
            let millimetres = parse(element, text.trim().trim_end_matches("mm"))?;
            if millimetres <= 0.0 {
                return Err(element.error(format!("found the focal length {text}")).expected("a length above 0"));
            }
            (0.5 * hypot(FILM_MM[0], FILM_MM[1]) / millimetres, "diagonal".to_string())
        }
    };
    let half_height = match axis.as_str() {
        "x" => half_tangent / aspect,
        "y" => half_tangent,
        "smaller" if aspect > 1.0 => half_tangent,
        "smaller" => half_tangent / aspect,
        "larger" if aspect > 1.0 => half_tangent / aspect,
        "larger" => half_tangent,
        "diagonal" => half_tangent / hypot(aspect, 1.0),
        other => {
            let known = "x, y, diagonal, smaller or larger";
            return Err(element.error(format!("found \"{other}\" for \"fov_axis\"")).expected(known));
        }
    };
    Ok(2.0 * atan(half_height).to_degrees())
}
