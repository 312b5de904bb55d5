//! Transforms and motion in the scene file.

use crate::forms::{Form, Forms};
use crate::prelude::*;
use crate::{JsonPath, check, forms};
use abbe_scene::motion::DecomposedTransform;
use abbe_spectra::error::Result;
use abbe_spectra::math::rotation::{angle_between, quaternion};
use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};
use serde::de::MapAccess;

/// A list of transform steps. The first step is applied first.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(transparent)]
#[schemars(title = "Transform", example = json!([{"rotate": {"axis": [0, 1, 0], "degrees": 30}}, {"translate": [0, 0.5, 0]}]))]
pub struct TransformFile(pub Vec<TransformStepFile>);

/// One step of a transform. It must be invertible.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Transform step")]
pub enum TransformStepFile {
    /// Translation by a vector.
    #[schemars(example = json!({"translate": [0, 0.5, 0]}))]
    Translate(#[schemars(extend("x-unit" = "scene unit"))] [f64; 3]),
    /// Rotation about an axis through the origin. The rotation is counter-clockwise if the axis
    /// points towards the viewer.
    #[schemars(example = json!({"rotate": {"axis": [0, 0, 1], "degrees": 60}}))]
    Rotate {
        /// Direction of the axis. Its length has no effect.
        #[schemars(extend("x-range" = "not zero"))]
        axis: [f64; 3],
        /// Angle of the rotation.
        #[schemars(extend("x-unit" = "°"))]
        degrees: f64,
    },
    /// Scaling about the origin.
    #[schemars(example = json!({"scale": 2}), example = json!({"scale": [1, 2, -3]}))]
    Scale(#[schemars(extend("x-range" = "not 0"))] ScaleFile),
    /// A 4×4 matrix, row by row, for column vectors. The last column is the translation. The last
    /// row must be [0, 0, 0, 1].
    #[schemars(example = json!({"matrix": [[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]}))]
    Matrix([[f64; 4]; 4]),
}

/// A scale factor: one number, or one number for each axis. A negative factor mirrors.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema)]
#[schemars(untagged, title = "Scale", example = json!(2), example = json!([1, 2, -3]))]
pub enum ScaleFile {
    /// The same factor along every axis.
    Uniform(f64),
    /// Factors along x, y and z.
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

/// A keyframe of a motion.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Keyframe", example = json!({"time": 0.02, "transform": [{"translate": [0, 1, 0]}]}))]
pub struct KeyframeFile {
    /// Time of the keyframe, later than the time of the keyframe before it.
    #[schemars(extend("x-unit" = "s"))]
    pub time: f64,
    /// Placement at that time, applied after the `transform` of the object, light or medium.
    /// Between keyframes, position, rotation and scale are interpolated. Rotations between two
    /// keyframes must be below 180°, and the placements must not shear.
    pub transform: TransformFile,
}

impl TransformFile {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the affine map that applies all steps in order. Lengths are in the scene's unit.
    pub fn to_affine(&self) -> DAffine3 {
        self.after(DAffine3::IDENTITY)
    }

    /// Returns the affine map that applies `before` first, and then all steps. If `before` is the
    /// map of another list, and the two lists are joined into one list, the map of the joined list
    /// has exactly the same bits as the result.
    pub fn after(&self, before: DAffine3) -> DAffine3 {
        self.0.iter().fold(before, |before, step| step.to_affine() * before)
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        check::all(self.0.iter().enumerate().map(|(i, step)| step.validate(&at.index(i))))
    }
}

impl TransformStepFile {
    /// Returns the affine map of this step, in the scene's unit. A rotation about a zero axis is
    /// the identity, but `validate` refuses such a rotation.
    pub fn to_affine(&self) -> DAffine3 {
        match self {
            Self::Translate(by) => DAffine3::from_translation(DVec3::from_array(*by)),
            Self::Rotate { axis, degrees } => DVec3::from_array(*axis)
                .try_normalize()
                .map_or(DAffine3::IDENTITY, |axis| DAffine3::from_quat(quaternion(axis, degrees.to_radians()))),
            Self::Scale(ScaleFile::Uniform(scale)) => DAffine3::from_scale(DVec3::splat(*scale)),
            Self::Scale(ScaleFile::Axes(scale)) => DAffine3::from_scale(DVec3::from_array(*scale)),
            Self::Matrix(rows) => {
                let rows = rows.map(DVec4::from_array);
                let columns = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
                DAffine3::from_mat4(columns)
            }
        }
    }

    fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Translate(_) => Ok(()),
            Self::Rotate { axis, degrees: _ } => check::direction(&at.key("rotate").key("axis"), *axis),
            Self::Scale(ScaleFile::Uniform(scale)) => not_zero(&at.key("scale"), *scale),
            Self::Scale(ScaleFile::Axes(scale)) => {
                let at = at.key("scale");
                check::all(scale.iter().enumerate().map(|(i, &scale)| not_zero(&at.index(i), scale)))
            }
            Self::Matrix(rows) => validate_matrix(&at.key("matrix"), rows, self.to_affine().matrix3),
        }
    }
}

fn not_zero(at: &JsonPath, scale: f64) -> Result<()> {
    check::rule(at, scale, scale != 0.0, "a number other than 0")
}

/// Checks that the last row is [0, 0, 0, 1] and that the linear part is not singular in any unit:
/// the determinant is divided by Hadamard's bound, the product of the column lengths.
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

/// Checks a motion: rising times, invertible transforms and unambiguous interpolation.
pub(super) fn validate_motion(at: &JsonPath, motion: &[KeyframeFile]) -> Result<()> {
    check::rising(at, motion.iter().map(|key| key.time), Some("time"))?;
    check::all(motion.iter().enumerate().map(|(i, key)| key.transform.validate(&at.index(i).key("transform"))))?;
    for (i, pair) in motion.windows(2).enumerate() {
        for (i, key) in (i..).zip(pair) {
            if DecomposedTransform::is_sheared(&key.transform.to_affine()) {
                let expected = "steps that translate, rotate and scale without shear: unequal scales before rotations";
                return Err(check::fault(&at.index(i).key("transform"), "found a shear", expected));
            }
        }
        let at = at.index(i + 1);
        let at = at.key("transform");
        let [before, after] = [&pair[0], &pair[1]].map(|key| DecomposedTransform::of(&key.transform.to_affine()));
        if (before.scale * after.scale).min_element() <= 0.0 {
            let what = "found a mirror image of the keyframe before: the interpolation would be flat in between";
            return Err(check::fault(&at, what, "a scale that does not pass through 0"));
        }
        let shortest = angle_between(before.rotation, after.rotation).to_degrees();
        let degrees = written_rotation_deg(&pair[0].transform, &pair[1].transform).max(shortest);
        if degrees > 180.0 - 1e-6 {
            let what = format!("found a rotation of {}° from the keyframe before", check::number(degrees.round()));
            return Err(check::fault(
                &at,
                what,
                "less than 180°, because the direction of a larger rotation is ambiguous; add keyframes in between",
            ));
        }
    }
    Ok(())
}

/// Returns the largest difference in degrees between the rotation steps of two lists, pair by pair,
/// or 0 if the axes of a pair differ. A missing step counts as 0°. The angles are compared as they
/// are written, because affine maps contain no full turns.
fn written_rotation_deg(before: &TransformFile, after: &TransformFile) -> f64 {
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
    fn a_matrix_is_read_row_by_row() {
        let map = transform(r#"[{"matrix": [[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]}]"#).to_affine();
        assert_eq!(map.transform_point3(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(3.0, 7.0, 10.0));
    }

    #[test]
    fn a_small_matrix_is_accepted_and_a_singular_one_is_not() {
        let small = transform(r#"[{"matrix": [[1e-9, 0, 0, 0], [0, 1e-9, 0, 0], [0, 0, 1e-9, 0], [0, 0, 0, 1]]}]"#);
        assert_eq!(small.validate(&JsonPath::Root), Ok(()));
        let flat = transform(r#"[{"matrix": [[1, 2, 3, 0], [4, 5, 6, 0], [7, 8, 9, 0], [0, 0, 0, 1]]}]"#);
        assert!(flat.validate(&JsonPath::Root).is_err());
    }
}
