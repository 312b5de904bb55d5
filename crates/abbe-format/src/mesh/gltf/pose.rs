//! Skins and morph targets: the shape of a mesh in the pose that the file states.

use super::accessor::GltfAccessors;
use super::node::{for_each_node, placed_normal};
use ::gltf::{Document, Mesh, Node, Primitive, Semantic, Skin};
use abbe_spectra::error::{Error, Result};
use glam::{DAffine3, DMat4, DVec3};

/// The transforms of the nodes of a file at rest.
pub struct RestPose {
    /// By the number of the node. Nodes outside the scene have the identity.
    to_world: Vec<DAffine3>,
}

/// How a node deforms the primitives of its mesh.
pub struct Deformation {
    /// The weights of the morph targets.
    weights: Vec<f64>,
    /// For each joint of the skin, the map from the mesh to the world. `None` without a skin.
    joints: Option<Vec<DAffine3>>,
}

/// The vertices of a primitive in the frame of their node.
pub(super) struct VertexData {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Option<Vec<DVec3>>,
}

impl RestPose {
    /// Places all nodes of a file. A damaged transform is an error.
    pub fn of(document: &Document) -> Result<Self> {
        let mut to_world = vec![DAffine3::IDENTITY; document.nodes().len()];
        for_each_node(document, |node, _, placed| {
            to_world[node.index()] = *placed;
            Ok(())
        })?;
        Ok(Self { to_world })
    }

    pub fn deformation(&self, node: &Node, mesh: &Mesh, accessors: &GltfAccessors) -> Result<Deformation> {
        let weights = node.weights().or(mesh.weights()).unwrap_or(&[]);
        let joints = node.skin().map(|skin| self.joints(&skin, accessors)).transpose()?;
        Ok(Deformation { weights: weights.iter().map(|&weight| f64::from(weight)).collect(), joints })
    }

    fn joints(&self, skin: &Skin, accessors: &GltfAccessors) -> Result<Vec<DAffine3>> {
        let joints: Vec<DAffine3> = skin.joints().map(|joint| self.to_world[joint.index()]).collect();
        let Some(accessor) = skin.inverse_bind_matrices() else { return Ok(joints) };
        let inverse = accessors.matrices(&accessor)?;
        if inverse.len() < joints.len() {
            return Err(Error::input("the skin does not have one matrix per joint"));
        }
        let placed = |(joint, it): (DAffine3, [f64; 16])| joint * DAffine3::from_mat4(DMat4::from_cols_array(&it));
        Ok(joints.into_iter().zip(inverse).map(placed).collect())
    }
}

impl Deformation {
    /// Returns true if the skin places the mesh, so that the node's transform has no effect.
    pub(super) fn has_skin(&self) -> bool {
        self.joints.is_some()
    }

    /// Returns the map from the mesh to the world that the first joint has. `None` without a skin.
    pub fn first_joint(&self) -> Option<DAffine3> {
        self.joints.as_ref()?.first().copied()
    }

    /// Moves the vertices of a primitive.
    pub(super) fn apply(&self, primitive: &Primitive, accessors: &GltfAccessors, data: &mut VertexData) -> Result<()> {
        let VertexData { positions, normals } = data;
        for (target, &weight) in primitive.morph_targets().zip(&self.weights).filter(|(_, weight)| **weight != 0.0) {
            if let Some(accessor) = target.positions() {
                let offsets = accessors.vectors(&accessor)?;
                positions.iter_mut().zip(offsets).for_each(|(position, offset)| *position += weight * offset);
            }
            if let (Some(normals), Some(accessor)) = (normals.as_mut(), target.normals()) {
                let offsets = accessors.vectors(&accessor)?;
                normals.iter_mut().zip(offsets).for_each(|(normal, offset)| *normal += weight * offset);
            }
        }
        let Some(joints) = &self.joints else { return Ok(()) };
        let found = primitive.get(&Semantic::Joints(0)).zip(primitive.get(&Semantic::Weights(0)));
        let (numbers, weights) = found.ok_or_else(|| Error::input("a mesh with a skin has no joints"))?;
        let (numbers, weights) = (accessors.floats(&numbers)?, accessors.floats(&weights)?);
        if numbers.len() != positions.len() || weights.len() != positions.len() {
            return Err(Error::input("a mesh with a skin does not have joints for each vertex"));
        }
        for (i, position) in positions.iter_mut().enumerate() {
            let blended = blended(joints, numbers[i], weights[i])?;
            *position = blended.transform_point3(*position);
            if let Some(normal) = normals.as_mut().and_then(|normals| normals.get_mut(i)) {
                *normal = placed_normal(&blended, *normal);
            }
        }
        Ok(())
    }
}

/// Returns the weighted mean of the transforms of up to four joints.
fn blended(joints: &[DAffine3], numbers: [f64; 4], weights: [f64; 4]) -> Result<DAffine3> {
    let sum: f64 = weights.iter().sum();
    let mut mean = [0.0; 12];
    for (number, weight) in numbers.into_iter().zip(weights).filter(|(_, weight)| *weight != 0.0) {
        let missing = || Error::input("a vertex names a joint that does not exist");
        let joint = joints.get(number as usize).ok_or_else(missing)?;
        mean.iter_mut().zip(joint.to_cols_array()).for_each(|(mean, x)| *mean += weight / sum * x);
    }
    if sum > 0.0 { Ok(DAffine3::from_cols_array(&mean)) } else { Ok(DAffine3::IDENTITY) }
}
