//! The graphics state of a pbrt file.

use super::{material::ReadMaterial, parameters::Parameters};
use abbe_spectra::colour::RgbSpace;
use glam::{DMat4, DVec3, DVec4};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::rc::Rc;

/// The attributes that `AttributeBegin` saves and `AttributeEnd` restores.
#[derive(Debug, Clone)]
pub(super) struct GraphicsState {
    /// The current transformation matrix.
    pub(super) ctm: DMat4,
    /// False while only the transform at the end of the shutter interval is changed.
    pub(super) changes_start: bool,
    /// True if the front and the back of shapes are exchanged.
    pub(super) reverse: bool,
    /// The name and the value of the current material.
    pub(super) material: (String, Rc<ReadMaterial>),
    pub(super) area_light: Option<Parameters>,
    /// The names of the media inside and outside the next shapes. An empty name means no medium.
    pub(super) media: [String; 2],
    pub(super) space: RgbSpace,
    /// Default parameters of `Attribute` for each kind of directive.
    pub(super) defaults: BTreeMap<String, Parameters>,
}

impl Default for GraphicsState {
    fn default() -> Self {
        let material = ReadMaterial::Surface { material: json!({"diffuse": {"reflectance": 0.5}}), normal_map: None };
        Self {
            ctm: DMat4::IDENTITY,
            changes_start: true,
            reverse: false,
            material: ("default".into(), Rc::new(material)),
            area_light: None,
            media: Default::default(),
            space: RgbSpace::Srgb,
            defaults: BTreeMap::new(),
        }
    }
}

/// Returns the matrix of `LookAt`. It maps the world to the camera.
pub(super) fn look_at(eye: DVec3, at: DVec3, up: DVec3) -> Option<DMat4> {
    let forward = (at - eye).try_normalize()?;
    let right = up.try_normalize()?.cross(forward).try_normalize()?;
    let up = forward.cross(right);
    let columns = [right, up, forward].map(|axis| axis.extend(0.0));
    let world_from_camera = DMat4::from_cols(columns[0], columns[1], columns[2], eye.extend(1.0));
    Some(world_from_camera.inverse())
}

/// Returns the matrix of sixteen numbers of a file, which go from column to column.
pub(super) fn matrix(numbers: &[f64]) -> DMat4 {
    let column = |c: usize| DVec4::new(numbers[4 * c], numbers[4 * c + 1], numbers[4 * c + 2], numbers[4 * c + 3]);
    DMat4::from_cols(column(0), column(1), column(2), column(3))
}

pub(super) fn is_placement(matrix: &DMat4) -> bool {
    let last = matrix.row(3);
    matrix.is_finite() && last.abs_diff_eq(DVec4::W, 1e-9) && matrix.determinant() != 0.0
}

/// Returns the transform of a scene file. It is empty for the identity.
pub(super) fn transform(matrix: &DMat4) -> Value {
    if *matrix == DMat4::IDENTITY {
        return json!([]);
    }
    let mut rows = [0, 1, 2].map(|row| matrix.row(row).to_array()).to_vec();
    rows.push([0.0, 0.0, 0.0, 1.0]);
    json!([{"matrix": rows}])
}
