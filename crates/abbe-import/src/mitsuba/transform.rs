//! Transforms of a Mitsuba scene.

use super::xml::{XmlElement, numbers, parse};
use abbe_spectra::error::Result;
use abbe_spectra::math::rotation::quaternion;
use glam::{DAffine3, DMat4, DVec3, DVec4};
use serde_json::{Value, json};

/// Returns the matrix of a `<transform>`. The first element inside is applied first.
pub(super) fn transform(element: &XmlElement) -> Result<DMat4> {
    if element.tag != "transform" {
        return Err(element.error(format!("found <{}>", element.tag)).expected("<transform>"));
    }
    element.children.iter().try_fold(DMat4::IDENTITY, |matrix, step| Ok(step_matrix(step)? * matrix))
}

fn step_matrix(step: &XmlElement) -> Result<DMat4> {
    match step.tag.as_str() {
        "translate" => Ok(DMat4::from_translation(vector(step, 0.0)?)),
        "scale" => Ok(DMat4::from_scale(vector(step, 1.0)?)),
        "rotate" => {
            let axis = vector(step, 0.0)?;
            let angle = parse(step, step.required("angle")?)?.to_radians();
            let axis = axis.try_normalize().ok_or_else(|| step.error("the axis of the rotation is zero"))?;
            Ok(DMat4::from_quat(quaternion(axis, angle)))
        }
        "lookat" | "lookAt" => look_at(step),
        "matrix" => matrix(step),
        other => Err(step
            .error(format!("found <{other}> inside <transform>"))
            .expected("translate, rotate, scale, lookat or matrix")),
    }
}

/// Returns the vector of the attribute `value`, or of the attributes `x`, `y` and `z`.
pub(super) fn vector(element: &XmlElement, default: f64) -> Result<DVec3> {
    if let Some(value) = element.attribute("value") {
        return match numbers(element, value)?.as_slice() {
            &[number] => Ok(DVec3::splat(number)),
            &[x, y, z] => Ok(DVec3::new(x, y, z)),
            other => Err(element.error(format!("found {} numbers", other.len())).expected("one or three numbers")),
        };
    }
    let component = |name: &str| element.attribute(name).map_or(Ok(default), |text| parse(element, text));
    Ok(DVec3::new(component("x")?, component("y")?, component("z")?))
}

fn look_at(step: &XmlElement) -> Result<DMat4> {
    let point = |name: &str| match numbers(step, step.required(name)?)?.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        other => Err(step.error(format!("found {} numbers in \"{name}\"", other.len())).expected("three numbers")),
    };
    let (origin, target) = (point("origin")?, point("target")?);
    let direction = (target - origin).try_normalize();
    let direction = direction.ok_or_else(|| step.error("the origin and the target of <lookat> are equal"))?;
    let up = if step.attribute("up").is_some() { point("up")? } else { DVec3::ZERO };
    let up = if up == DVec3::ZERO { direction.any_orthonormal_vector() } else { up };
    let left = up.cross(direction).try_normalize();
    let left = left.ok_or_else(|| step.error("the upward direction of <lookat> is parallel to the view"))?;
    let columns = [left, direction.cross(left), direction].map(|axis| axis.extend(0.0));
    Ok(DMat4::from_cols(columns[0], columns[1], columns[2], origin.extend(1.0)))
}

/// Returns a matrix of 16 or 9 numbers, row by row.
fn matrix(step: &XmlElement) -> Result<DMat4> {
    let values = numbers(step, step.required("value")?)?;
    match values.len() {
        16 => Ok(DMat4::from_cols_slice(&values).transpose()),
        9 => {
            let row = |i: usize| DVec4::new(values[3 * i], values[3 * i + 1], values[3 * i + 2], 0.0);
            Ok(DMat4::from_cols(row(0), row(1), row(2), DVec4::W).transpose())
        }
        other => Err(step.error(format!("found a matrix of {other} numbers")).expected("16 or 9 numbers")),
    }
}

/// Returns the affine map of a matrix, or an error at `element` if it is singular or a projection.
pub(super) fn affine(element: &XmlElement, matrix: DMat4) -> Result<DAffine3> {
    let affine = DAffine3::from_mat4(matrix);
    let lengths = affine.matrix3.to_cols_array_2d().map(|column| DVec3::from_array(column).length());
    let volume = lengths[0] * lengths[1] * lengths[2];
    let regular = affine.matrix3.determinant().abs() > 1e-12 * volume && affine.translation.is_finite();
    if matrix.row(3).abs_diff_eq(DVec4::W, 1e-9) && regular {
        Ok(affine)
    } else {
        Err(element.error("the transform is singular or is a projection").expected("an invertible affine transform"))
    }
}

/// Returns the steps of a scene file's transform. The list is empty for the identity.
pub(super) fn steps(affine: DAffine3) -> Vec<Value> {
    if affine == DAffine3::IDENTITY {
        return Vec::new();
    }
    let (m, t) = (affine.matrix3.to_cols_array_2d(), affine.translation);
    if affine.matrix3 == glam::DMat3::IDENTITY {
        return vec![json!({"translate": t.to_array()})];
    }
    let row = |i: usize| json!([m[0][i], m[1][i], m[2][i], t[i]]);
    vec![json!({"matrix": [row(0), row(1), row(2), [0, 0, 0, 1]]})]
}
