//! The emitters of a scene: what a light tree can select.

use super::bounds::{LightBounds, OrientationCone};
use super::tree::LightTree;
use abbe_scene::Scene;
use abbe_scene::light::IntensityBounds;
use abbe_spectra::math::distribution::DiscreteDistribution;
use std::f64::consts::PI;

/// If the luminous meshes of a scene have more triangles, each mesh is one emitter.
const MOST_TRIANGLES: usize = 1 << 16;

/// An emitter: a light, or one triangle of a luminous mesh.
#[derive(Debug, Clone, Copy)]
pub(in crate::gather::direct) struct TreeEmitter {
    pub(in crate::gather::direct) light: u32,
    pub(in crate::gather::direct) triangle: Option<SelectedTriangle>,
}

#[derive(Debug, Clone, Copy)]
pub(in crate::gather::direct) struct SelectedTriangle {
    /// A random number with which the sampling of the mesh selects the triangle.
    pub(in crate::gather::direct) selecting: f64,
    /// The probability with which the sampling of the mesh selects the triangle.
    pub(in crate::gather::direct) probability: f64,
}

#[derive(Debug, Clone, Default)]
pub(in crate::gather::direct) struct Emitters {
    pub(in crate::gather::direct) list: Vec<TreeEmitter>,
    pub(in crate::gather::direct) tree: LightTree,
}

impl Emitters {
    pub(in crate::gather::direct) fn splits_meshes(scene: &Scene) -> bool {
        let objects = scene.lights.iter().filter_map(|light| light.object());
        objects.map(|object| scene.geometry.triangle_count(object)).sum::<usize>() <= MOST_TRIANGLES
    }

    /// Adds a tree over lights that have bounds. `powers` is the distribution of photons over all
    /// lights. Returns the root, or `None` without emitters.
    pub(in crate::gather::direct) fn add_tree(
        &mut self,
        scene: &Scene,
        powers: &DiscreteDistribution,
        lights: impl Iterator<Item = (usize, IntensityBounds)>,
    ) -> Option<usize> {
        let (mut bounds, splits) = (Vec::new(), Self::splits_meshes(scene));
        for (number, whole) in lights {
            let (fraction, light) = (powers.probability(number), number as u32);
            let object = scene.lights[number].object().filter(|_| splits);
            let before = self.list.len();
            for face in object.into_iter().flat_map(|object| scene.geometry.luminous_faces(object)) {
                let corners = (face.low, face.high);
                let flat = IntensityBounds::of_flat_surface(corners, fraction * face.probability / PI, face.normal);
                bounds.push(light_bounds(&flat, 1.0));
                let (selecting, probability) = (face.selecting, face.probability);
                self.list.push(TreeEmitter { light, triangle: Some(SelectedTriangle { selecting, probability }) });
            }
            if self.list.len() == before {
                let power_w = scene.lights[number].power_w(scene.extent());
                bounds.push(light_bounds(&whole, if power_w > 0.0 { fraction / power_w } else { 0.0 }));
                self.list.push(TreeEmitter { light, triangle: None });
            }
        }
        (!bounds.is_empty()).then(|| self.tree.add(&bounds))
    }
}

/// Returns the bounds of an emitter. `per_watt` converts the intensity to the unit of the tree.
fn light_bounds(bounds: &IntensityBounds, per_watt: f64) -> LightBounds {
    let cone = OrientationCone { axis: bounds.axis, theta_o: bounds.normals_rad, theta_e: bounds.emission_rad };
    LightBounds::new((bounds.low, bounds.high), bounds.intensity * per_watt, cone)
}
