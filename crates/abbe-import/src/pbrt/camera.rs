//! Cameras and films of pbrt files.

use super::parameters::Parameters;
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::{atan2, sin_cos};
use glam::{DMat4, DVec3};
use serde_json::{Value, json};

/// The size of the film in pixels, if the file states none.
pub(super) const DEFAULT_FILM: [f64; 2] = [1280.0, 720.0];

#[derive(Debug)]
pub(super) struct ReadCamera {
    world_from_camera: DMat4,
    is_orthographic: bool,
    /// The field of view in degrees along the shorter side of the picture.
    fov: f64,
    /// The ratio of width to height, if the file states one.
    aspect: Option<f64>,
    /// The ends of the screen window along y.
    window: Option<[f64; 4]>,
    lens_radius: f64,
    focal_distance: f64,
}

pub(super) fn read_camera(
    class: &str,
    parameters: &Parameters,
    camera_from_world: &DMat4,
    left_out: &mut Vec<String>,
) -> Result<Option<ReadCamera>> {
    let is_orthographic = class == "orthographic";
    if !is_orthographic && class != "perspective" {
        parameters.ignore_all();
        left_out.push(format!("camera \"{class}\" is left out"));
        return Ok(None);
    }
    let [open, close] = [parameters.number_or("shutteropen", 0.0)?, parameters.number_or("shutterclose", 1.0)?];
    if (open, close) != (0.0, 1.0) {
        left_out.push("the shutter of the camera is left out: the picture shows the scene at the first time".into());
    }
    let half = parameters.number("halffov")?.map(|half| 2.0 * half);
    Ok(Some(ReadCamera {
        world_from_camera: camera_from_world.inverse(),
        is_orthographic,
        fov: half.unwrap_or(parameters.number_or("fov", 90.0)?),
        aspect: parameters.number("frameaspectratio")?,
        window: parameters.tuple("screenwindow")?,
        lens_radius: parameters.number_or("lensradius", 0.0)?,
        focal_distance: parameters.number_or("focaldistance", 1e6)?,
    }))
}

impl Default for ReadCamera {
    fn default() -> Self {
        Self {
            world_from_camera: DMat4::IDENTITY,
            is_orthographic: false,
            fov: 90.0,
            aspect: None,
            window: None,
            lens_radius: 0.0,
            focal_distance: 1e6,
        }
    }
}

impl ReadCamera {
    /// Returns true if the picture would be mirrored without a mirrored scene.
    pub(super) fn needs_mirror(&self) -> bool {
        let axis = |axis: DVec3| self.world_from_camera.transform_vector3(axis);
        axis(DVec3::X).dot(axis(DVec3::Z).cross(axis(DVec3::Y))) < 0.0
    }

    /// Returns the camera of the scene file. `world` maps pbrt's world to Abbe's.
    pub(super) fn finish(&self, world: &DMat4, film: [f64; 2], left_out: &mut Vec<String>) -> Value {
        let to_world = *world * self.world_from_camera;
        let from = to_world.transform_point3(DVec3::ZERO);
        let axis = |axis: DVec3| to_world.transform_vector3(axis).normalize_or(axis);
        let aspect = film[0] / film[1];
        if self.aspect.is_some_and(|explicit| (explicit / aspect - 1.0).abs() > 1e-3) {
            left_out.push("the aspect ratio of the camera is that of the film".into());
        }
        // The window is [−1, 1] along the shorter side.
        let mut top = if aspect >= 1.0 { 1.0 } else { 1.0 / aspect };
        if let Some([x0, x1, y0, y1]) = self.window {
            let is_centred = (x0 + x1).abs() < 1e-6 && (y0 + y1).abs() < 1e-6;
            if is_centred && ((x1 / y1) / aspect - 1.0).abs() < 1e-3 {
                top = y1;
            } else {
                left_out.push("the screen window of the camera is left out".into());
            }
        }
        let (sin, cos) = sin_cos(0.5 * self.fov.to_radians());
        let fov = 2.0 * atan2(top * sin, cos).to_degrees();
        let lens = if self.is_orthographic {
            if self.lens_radius > 0.0 {
                left_out.push("the lens of an orthographic camera is left out: all distances are sharp".into());
            }
            json!({"orthographic": {"height": 2.0 * top * to_world.transform_vector3(DVec3::Y).length()}})
        } else if self.lens_radius > 0.0 {
            let defocus = 2.0 * atan2(self.lens_radius, self.focal_distance).to_degrees();
            json!({"thin": {"fov": fov, "focus_distance": self.focal_distance, "defocus_angle": defocus}})
        } else {
            json!({"pinhole": {"fov": fov}})
        };
        let at = from + axis(DVec3::Z);
        json!({"from": from.to_array(), "at": at.to_array(), "up": axis(DVec3::Y).to_array(), "lens": lens})
    }
}

pub(super) fn read_film(parameters: &Parameters, left_out: &mut Vec<String>) -> Result<[f64; 2]> {
    parameters.ignore(&["filename", "savefp16", "diagonal", "maxcomponentvalue"]);
    let sensor = parameters.string("sensor")?.unwrap_or("cie1931");
    if sensor != "cie1931" {
        left_out.push(format!("the sensor \"{sensor}\" is replaced by the CIE 1931 observer"));
    }
    if ["cropwindow", "pixelbounds"].iter().filter(|key| parameters.get(key).is_some()).count() > 0 {
        left_out.push("the crop of the film is left out: the whole picture is rendered".into());
    }
    let exposure = parameters.number_or("iso", 100.0)? * parameters.number_or("exposuretime", 1.0)? / 100.0;
    if exposure != 1.0 {
        left_out.push(format!("the exposure of the film is left out: pbrt's values are {exposure} times as large"));
    }
    if parameters.number_or("whitebalance", 0.0)? != 0.0 {
        left_out.push("the white balance of the film is left out".into());
    }
    let size =
        [parameters.number_or("xresolution", DEFAULT_FILM[0])?, parameters.number_or("yresolution", DEFAULT_FILM[1])?];
    Ok(size.map(|pixels| pixels.round().clamp(1.0, 100_000.0)))
}
