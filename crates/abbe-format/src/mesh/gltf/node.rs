//! The nodes of a glTF file, and their transforms.

use ::gltf::scene::Transform;
use ::gltf::{Document, Node};
use abbe_spectra::error::{Error, Result};
use glam::{DAffine3, DMat4, DQuat, DVec3};

/// Calls `visit` for each node of the default scene, parents first. The second argument is the
/// number of the parent. The third argument is the transform from the node to the scene. If the
/// file has no scene, all nodes without a parent belong to the scene.
pub fn for_each_node<'d>(
    document: &'d Document,
    mut visit: impl FnMut(&Node<'d>, Option<usize>, &DAffine3) -> Result<()>,
) -> Result<()> {
    let mut roots: Vec<Node<'d>> = match document.default_scene().or_else(|| document.scenes().next()) {
        Some(scene) => scene.nodes().collect(),
        None => {
            let below = |node: Node<'d>| node.children().map(|child| child.index()).collect::<Vec<_>>();
            let children: Vec<usize> = document.nodes().flat_map(below).collect();
            document.nodes().filter(|node| !children.contains(&node.index())).collect()
        }
    };
    roots.reverse();
    let mut open: Vec<(Node<'d>, Option<usize>, DAffine3)> =
        roots.into_iter().map(|node| (node, None, DAffine3::IDENTITY)).collect();
    // It is an error to read a node twice, so a cycle of nodes cannot cause an endless loop.
    let mut visited = vec![false; document.nodes().len()];
    while let Some((node, parent, parent_to_world)) = open.pop() {
        if std::mem::replace(&mut visited[node.index()], true) {
            return Err(Error::input(format!("node {} of the glTF file has two parents", node.index())));
        }
        let to_world = parent_to_world * affine(&node.transform());
        visit(&node, parent, &to_world)?;
        let first = open.len();
        open.extend(node.children().map(|child| (child, Some(node.index()), to_world)));
        open[first..].reverse();
    }
    Ok(())
}

/// Returns the transform of a node in double precision.
pub fn affine(transform: &Transform) -> DAffine3 {
    match transform {
        Transform::Matrix { matrix } => without_rounding(DAffine3::from_mat4(DMat4::from_cols_array_2d(
            &matrix.map(|column| column.map(f64::from)),
        ))),
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = DQuat::from_array(rotation.map(f64::from));
            let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
            let [scale, translation] = [scale, translation].map(|v| DVec3::from_array(v.map(f64::from)));
            DAffine3::from_scale_rotation_translation(scale, rotation, translation)
        }
    }
}

/// Removes the rounding of a matrix in single precision, which looks like a shear or like unequal
/// scales. A matrix that differs by more than rounding stays unchanged.
fn without_rounding(whole: DAffine3) -> DAffine3 {
    const ROUNDING: f64 = 2e-6;
    let (mut scale, rotation, translation) = whole.to_scale_rotation_translation();
    let size = scale.abs().max_element();
    if (scale.abs() - DVec3::splat(size)).abs().max_element() < ROUNDING * size {
        scale = scale.signum() * size;
    }
    let again = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
    let deviation = [0, 1, 2].map(|i| (again.matrix3.col(i) - whole.matrix3.col(i)).abs().max_element());
    let deviation = deviation.into_iter().fold(0.0, f64::max);
    if deviation > 1e-12 * size && deviation < ROUNDING * size { again } else { whole }
}

/// Transforms a normal. The result points to the same side of the transformed surface.
pub(super) fn placed_normal(placed: &DAffine3, normal: DVec3) -> DVec3 {
    // Up to a factor, the cofactor matrix is the inverse transpose, and exists if singular.
    let [x, y, z] = [placed.matrix3.x_axis, placed.matrix3.y_axis, placed.matrix3.z_axis];
    let outwards = if placed.matrix3.determinant() < 0.0 { -1.0 } else { 1.0 };
    outwards * (glam::DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * normal)
}
