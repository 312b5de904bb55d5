//! Transforms and motion as written.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, DVec4};
use schemars::JsonSchema;
use serde::de::MapAccess;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::check;
use super::forms::{self, Form, Forms};
use super::path::JsonPath;
use crate::error::Result;
use crate::scene::motion::Pose;

/// A list of steps, applied first to last.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(transparent)]
pub struct TransformFile(pub Vec<TransformStepFile>);

/// One step of a transform.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum TransformStepFile {
    /// Moves by a vector, in the scene's unit.
    Translate([f64; 3]),
    /// Turns counter-clockwise, seen against the axis.
    Rotate {
        /// The axis through the origin; its length does not matter.
        axis: [f64; 3],
        /// The angle in degrees.
        degrees: f64,
    },
    /// Scales about the origin.
    Scale(ScaleFile),
    /// A 4×4 matrix by rows, for column vectors; the last column translates, the last row is 0 0 0 1.
    Matrix([[f64; 4]; 4]),
}

/// A scale: one number, or one for each axis. A negative one mirrors.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema)]
#[schemars(untagged)]
pub enum ScaleFile {
    /// The same along every axis.
    Uniform(f64),
    /// Along x, y and z.
    Axes([f64; 3]),
}

impl Forms for ScaleFile {
    const EXPECTED: &'static str = "a number or an array of 3 numbers";
    const HAS_TRIPLE: bool = true;

    fn from_number(number: f64) -> Option<Self> {
        Some(Self::Uniform(number))
    }

    fn from_triple(triple: [f64; 3]) -> Option<Self> {
        Some(Self::Axes(triple))
    }

    fn from_object<'de, A: MapAccess<'de>>(_: Form<A>) -> std::result::Result<Self, A::Error> {
        Err(serde::de::Error::invalid_type(serde::de::Unexpected::Map, &Self::EXPECTED))
    }
}

impl<'de> Deserialize<'de> for ScaleFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for ScaleFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Uniform(scale) => scale.serialize(serializer),
            Self::Axes(scale) => scale.serialize(serializer),
        }
    }
}

/// One key of a motion.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KeyframeFile {
    /// The moment in s.
    pub time: f64,
    /// The pose at that moment, composed after the thing's own transform.
    pub transform: TransformFile,
}

impl TransformFile {
    /// Whether there is no step.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The affine map of all steps, first to last, in the scene's unit.
    pub fn to_affine(&self) -> DAffine3 {
        self.after(DAffine3::IDENTITY)
    }

    /// The affine map of all steps, first to last, after another; step by step, to the bit as if one list had them all.
    pub fn after(&self, before: DAffine3) -> DAffine3 {
        self.0.iter().fold(before, |before, step| step.to_affine() * before)
    }

    /// Checks that every step can be undone: no scale of 0, no zero axis, no singular matrix.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        self.0.iter().enumerate().try_for_each(|(i, step)| step.validate(&at.index(i)))
    }
}

impl TransformStepFile {
    /// The affine map of this step, in the scene's unit. A zero axis (an error when read) turns nothing.
    pub fn to_affine(&self) -> DAffine3 {
        match self {
            Self::Translate(by) => DAffine3::from_translation(DVec3::from_array(*by)),
            Self::Rotate { axis, degrees } => {
                DVec3::from_array(*axis).try_normalize().map_or(DAffine3::IDENTITY, |axis| {
                    DAffine3::from_quat(DQuat::from_axis_angle(axis, degrees.to_radians()))
                })
            }
            Self::Scale(ScaleFile::Uniform(scale)) => DAffine3::from_scale(DVec3::splat(*scale)),
            Self::Scale(ScaleFile::Axes(scale)) => DAffine3::from_scale(DVec3::from_array(*scale)),
            Self::Matrix(rows) => {
                let rows = rows.map(DVec4::from_array);
                let columns = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
                DAffine3::from_mat4(columns)
            }
        }
    }

    /// Checks that the step can be undone.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Translate(_) => Ok(()),
            Self::Rotate { axis, degrees: _ } => check::direction(&at.key("rotate").key("axis"), *axis),
            Self::Scale(ScaleFile::Uniform(scale)) => not_zero(&at.key("scale"), *scale),
            Self::Scale(ScaleFile::Axes(scale)) => {
                let at = at.key("scale");
                scale.iter().enumerate().try_for_each(|(i, &scale)| not_zero(&at.index(i), scale))
            }
            Self::Matrix(rows) => validate_matrix(&at.key("matrix"), rows, self.to_affine().matrix3),
        }
    }
}

/// A scale that can be undone.
fn not_zero(at: &JsonPath, scale: f64) -> Result<()> {
    check::rule(at, scale, scale != 0.0, "a number other than 0")
}

/// Checks the last row, and that the linear part is not singular: its determinant is compared with the product of its
/// columns' lengths (Hadamard's bound), so that the test does not depend on the unit.
fn validate_matrix(at: &JsonPath, rows: &[[f64; 4]; 4], linear: DMat3) -> Result<()> {
    if rows[3] != [0.0, 0.0, 0.0, 1.0] {
        let found = rows[3].map(check::number).join(", ");
        return Err(check::fault(&at.index(3), format!("found [{found}]"), "the last row [0, 0, 0, 1]"));
    }
    let unit = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::try_normalize);
    if let [Some(x), Some(y), Some(z)] = unit
        && DMat3::from_cols(x, y, z).determinant().abs() > 1e-12
    {
        return Ok(());
    }
    Err(check::fault(at, "found a singular matrix", "a matrix that can be inverted"))
}

/// Checks a motion: moments that rise, poses that can be undone, and between them one way to go.
pub(super) fn validate_motion(at: &JsonPath, motion: &[KeyframeFile]) -> Result<()> {
    check::rising(at, motion.iter().map(|key| key.time), Some("time"))?;
    for (i, key) in motion.iter().enumerate() {
        key.transform.validate(&at.index(i).key("transform"))?;
    }
    for (i, pair) in motion.windows(2).enumerate() {
        for (i, key) in (i..).zip(pair) {
            if Pose::is_sheared(&key.transform.to_affine()) {
                let expected = "steps that move, turn and scale without slanting: unequal scales before turns";
                return Err(check::fault(&at.index(i).key("transform"), "found a shear", expected));
            }
        }
        let at = at.index(i + 1);
        let at = at.key("transform");
        let [before, after] = [&pair[0], &pair[1]].map(|key| Pose::of(&key.transform.to_affine()));
        if (before.scale * after.scale).min_element() <= 0.0 {
            let what = "found a mirror image of the key before: between them the thing would be flat";
            return Err(check::fault(&at, what, "a scale that does not pass through 0"));
        }
        let shortest = before.rotation.angle_between(after.rotation).to_degrees();
        let degrees = written_turn(&pair[0].transform, &pair[1].transform).max(shortest);
        if degrees > 180.0 - 1e-6 {
            let what = format!("found a turn of {}° from the key before", check::number(degrees.round()));
            return Err(check::fault(&at, what, "less than 180°: which way to turn is not known; put keys in between"));
        }
    }
    Ok(())
}

/// The largest difference in degrees between the turns that two lists of steps write about the same axes; 0 if their axes are not the same.
/// (360° leave no trace in the pose.)
fn written_turn(before: &TransformFile, after: &TransformFile) -> f64 {
    let turns = |transform: &TransformFile| -> Vec<(DVec3, f64)> {
        let turn = |step: &TransformStepFile| match step {
            TransformStepFile::Rotate { axis, degrees } => {
                Some((DVec3::from_array(*axis).normalize_or_zero(), *degrees))
            }
            TransformStepFile::Translate(_) | TransformStepFile::Scale(_) | TransformStepFile::Matrix(_) => None,
        };
        transform.0.iter().filter_map(turn).collect()
    };
    let (before, after) = (turns(before), turns(after));
    let longest = before.len().max(after.len());
    let mut largest = 0.0_f64;
    for i in 0..longest {
        largest = largest.max(match (before.get(i), after.get(i)) {
            (Some((axis, from)), Some((other, to))) if axis.dot(*other) > 1.0 - 1e-9 => (to - from).abs(),
            (Some((axis, from)), Some((other, to))) if axis.dot(*other) < 1e-9 - 1.0 => (to + from).abs(),
            (Some((_, degrees)), None) | (None, Some((_, degrees))) => degrees.abs(),
            (Some(_), Some(_)) | (None, None) => return 0.0,
        });
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The transform of a JSON list.
    fn transform(json: &str) -> TransformFile {
        serde_json::from_str(json).unwrap()
    }

    #[test]
    fn steps_apply_first_to_last() {
        let turned_then_moved =
            transform(r#"[{"rotate": {"axis": [0, 0, 2], "degrees": 90}}, {"translate": [10, 0, 0]}]"#).to_affine();
        let point = turned_then_moved.transform_point3(DVec3::new(1.0, 2.0, 3.0));
        assert!((point - DVec3::new(8.0, 1.0, 3.0)).length() < 1e-12, "{point}");
        let moved_then_scaled = transform(r#"[{"translate": [1, 0, 0]}, {"scale": [2, 3, 4]}]"#).to_affine();
        assert_eq!(moved_then_scaled.transform_point3(DVec3::ONE), DVec3::new(4.0, 3.0, 4.0));
        assert_eq!(transform("[]").to_affine(), DAffine3::IDENTITY);
        assert_eq!(transform(r#"[{"scale": -2}]"#).to_affine().transform_point3(DVec3::ONE), DVec3::splat(-2.0));
    }

    #[test]
    fn a_matrix_is_written_by_rows() {
        let matrix =
            transform(r#"[{"matrix": [[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]}]"#).to_affine();
        assert_eq!(matrix.transform_point3(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(3.0, 7.0, 10.0));
    }

    #[test]
    fn a_small_matrix_is_not_singular_but_a_flat_one_is() {
        let small = transform(r#"[{"matrix": [[1e-9, 0, 0, 0], [0, 1e-9, 0, 0], [0, 0, 1e-9, 0], [0, 0, 0, 1]]}]"#);
        assert_eq!(small.validate(&JsonPath::Root), Ok(()));
        let flat = transform(r#"[{"matrix": [[1, 2, 3, 0], [4, 5, 6, 0], [7, 8, 9, 0], [0, 0, 0, 1]]}]"#);
        assert!(flat.validate(&JsonPath::Root).is_err());
    }
}
