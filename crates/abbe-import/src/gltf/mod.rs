//! Reads glTF scenes.
//!
//! Each primitive of a node becomes an object that names one part of the glTF file. The mesh reader
//! reads the geometry and the materials of this part. This module adds the transforms and the
//! motion of the nodes, the camera, the lights and the film.

mod animation;
mod camera;
#[cfg(test)]
mod feature_tests;
mod light;
mod node;
#[cfg(test)]
mod tests;

use self::animation::Animations;
use self::camera::{DEFAULT_ASPECT, file_camera, light_from_behind, whole_view};
use self::light::{ies_light, punctual_light};
use self::node::{NodeTree, PlacedNode, steps, thickened, unit};
use crate::{ImportedScene, scene_writer::SceneWriter};
use ::gltf::{Document, Node};
use abbe_format::FileAccess;
use abbe_format::mesh::{GltfAccessors, GltfFile, RestPose, first_parts, for_each_node, has_triangles, ignored};
use abbe_format::without_nulls;
use abbe_spectra::error::{Error, Result};
use glam::{DAffine3, DQuat, DVec3};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// The largest luminance (cd/m²) of a surface in glTF without KHR_materials_emissive_strength. Such
/// surfaces are signs or displays. Stronger ones are lamps that light the scene.
const UNSCALED_EMISSION: f64 = 1.0;

/// The illuminance (lx) on a surface that faces the added sun.
const STUDIO_ILLUMINANCE: f64 = 1000.0;

/// The illuminance (lx) in a file with emission: a white surface has about 1 cd/m², like it.
const DIM_STUDIO_ILLUMINANCE: f64 = 2.0;

const WIDTH: f64 = 960.0;

/// Reads a glTF file. The geometry and the pictures are not read.
pub(super) fn import(path: &Path, folder: &str, file_access: FileAccess) -> Result<ImportedScene> {
    let mut file = GltfFile::open(path, file_access)?;
    let mut scene = SceneWriter::default();
    let has_instances = file.document.nodes().any(|node| node.extension_value(INSTANCING).is_some());
    let has_animations = file.document.animations().next().is_some();
    let reads_buffers = has_instances || has_animations || file.document.skins().next().is_some();
    let buffers = if reads_buffers { file.buffers()? } else { Vec::new() };
    let accessors = GltfAccessors::new(&buffers);
    let animations = Animations::read(&file, &accessors, &mut scene);
    scene.ignored_by_meshes = ignored(&file.document);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut reader = NodeReader {
        document: &file.document,
        accessors,
        pose: RestPose::of(&file.document)?,
        has_animations,
        shapes: BTreeMap::new(),
        path: format!("{folder}{name}"),
        folder,
        tree: NodeTree::new(animations),
        first_parts: first_parts(&file.document),
        camera: None,
        bounds: (DVec3::INFINITY, DVec3::NEG_INFINITY),
        emission: 0.0,
        hidden: BTreeSet::new(),
        scene,
    };
    for_each_node(&file.document, |node, parent, to_world| {
        reader.tree.add(node, parent);
        let visible = node.extension_value("KHR_node_visibility").and_then(|it| it["visible"].as_bool());
        if visible == Some(false) || parent.is_some_and(|parent| reader.hidden.contains(&parent)) {
            reader.hidden.insert(node.index());
        } else {
            reader.node(node, to_world);
        }
        Ok(())
    })?;
    if !reader.scene.has_objects() {
        return Err(Error::input("the file has no triangles"));
    }
    let NodeReader { camera, bounds, emission, mut scene, .. } = reader;
    let (camera, aspect) = camera.unwrap_or_else(|| {
        scene.note_added("a camera that sees the whole scene, because the file has none");
        (whole_view(bounds), DEFAULT_ASPECT)
    });
    if !scene.has_light() && emission <= UNSCALED_EMISSION {
        let toward = light_from_behind(&camera);
        if emission > 0.0 {
            let reason = "the file has no light, and its surfaces emit at most 1 cd/m² (no \
                          KHR_materials_emissive_strength above 1)";
            scene.add_studio_light(toward, DIM_STUDIO_ILLUMINANCE, reason);
        } else {
            scene.add_studio_light(toward, STUDIO_ILLUMINANCE, "the file has no light");
        }
    }
    scene.camera = camera;
    scene.film = json!({"width": WIDTH as u32, "height": (WIDTH / aspect).round().clamp(1.0, 8.0 * WIDTH) as u32});
    Ok(scene.finish(&name))
}

struct NodeReader<'d> {
    document: &'d Document,
    accessors: GltfAccessors<'d>,
    pose: RestPose,
    has_animations: bool,
    /// By the number of the mesh: the skin and the weights of morph targets of its first node.
    shapes: BTreeMap<usize, (Option<usize>, Option<&'d [f32]>)>,
    /// The path of the file in the scene.
    path: String,
    /// The path from the scene file to the folder of the file.
    folder: &'d str,
    tree: NodeTree,
    /// The number of the first part of each mesh.
    first_parts: Vec<u32>,
    /// The camera, and the ratio of the film's width to its height.
    camera: Option<(Value, f64)>,
    /// The lowest and the highest coordinates of the objects.
    bounds: (DVec3, DVec3),
    /// The largest component of the emission of all objects, in cd/m².
    emission: f64,
    /// The nodes that `KHR_node_visibility` hides, by their number.
    hidden: BTreeSet<usize>,
    scene: SceneWriter,
}

impl<'d> NodeReader<'d> {
    fn node(&mut self, node: &Node<'d>, to_world: &DAffine3) {
        let name = node.name().map_or_else(|| format!("node {}", node.index()), str::to_owned);
        let has_light = node.light().is_some() || node.extension_value("EXT_lights_ies").is_some();
        if node.mesh().is_none() && node.camera().is_none() && !has_light {
            return;
        }
        let placed = self.tree.place(node.index(), to_world);
        let place = format!("node \"{name}\"");
        if placed.is_sheared {
            let what = "the animation shears the node, which a motion cannot represent; the node stays at its place \
                        at 0 s";
            self.scene.leave_out(&place, what);
        }
        if let Some(camera) = node.camera() {
            if self.camera.is_some() {
                self.scene.leave_out(&place, "a further camera is left out, because a scene has one camera");
            } else if let Some(found) = file_camera(&camera.projection(), &placed) {
                self.camera = Some(found);
            } else {
                self.scene.leave_out(&place, "an orthographic camera whose picture has no extent is left out");
            }
        }
        if let Some(light) = node.light() {
            if light.range().is_some() {
                let what = "the range of a light is left out; the light falls with the square of the distance";
                self.scene.leave_out(&place, what);
            }
            self.scene.add_named_light(node.name().into_iter().chain(light.name()), punctual_light(&light, &placed));
        }
        if let Some(extension) = node.extension_value("EXT_lights_ies") {
            match ies_light(extension, self.document, self.folder, &placed) {
                Ok((profile, light)) => self.scene.add_named_light(node.name().into_iter().chain(profile), light),
                Err(reason) => self.scene.leave_out(&place, format!("the IES light is left out: {reason}")),
            }
        }
        self.mesh(node, &name, &placed);
    }

    /// Adds one object for each primitive of a node's mesh.
    fn mesh(&mut self, node: &Node<'d>, name: &str, placed: &PlacedNode) {
        let Some(mesh) = node.mesh() else { return };
        let place = format!("node \"{name}\"");
        let instances = instances(node, self.document, &self.accessors).unwrap_or_else(|reason| {
            self.scene.leave_out(&place, format!("all instances but one are left out: {reason}"));
            vec![DAffine3::IDENTITY]
        });
        // The joints of a skin place the mesh in the world.
        let at_rest = PlacedNode { own: DAffine3::IDENTITY, motion: Vec::new(), is_sheared: false };
        let deformation = self.pose.deformation(node, &mesh, &self.accessors).ok();
        let first_joint = deformation.and_then(|deformation| deformation.first_joint());
        let placed = if first_joint.is_some() { &at_rest } else { placed };
        let shape = (node.skin().map(|skin| skin.index()), node.weights());
        if *self.shapes.entry(mesh.index()).or_insert(shape) != shape {
            let what = "a mesh whose nodes have different skins or weights has the shape of the first node";
            self.scene.leave_out(&place, what);
        }
        if first_joint.is_some() && self.has_animations {
            self.scene.leave_out(&place, "the motion of the joints is left out; the skin has the pose of the file");
        }
        let flat = (!placed.is_invertible()).then(|| thickened(&placed.own));
        let thick = match flat {
            Some(None) => {
                let what = "a node with two scales of 0 is left out, because its triangles have no area";
                self.scene.leave_out(&place, what);
                return;
            }
            Some(Some(own)) => {
                let what = "a node with a scale of 0 is flat: its thickness became a millionth of its size";
                self.scene.leave_out(&place, what);
                Some(PlacedNode { own, motion: placed.motion.clone(), is_sheared: placed.is_sheared })
            }
            None => None,
        };
        let placed = thick.as_ref().unwrap_or(placed);
        let first = self.first_parts[mesh.index()];
        for (part, primitive) in (first..).zip(mesh.primitives()) {
            if !has_triangles(&primitive) {
                self.scene.leave_out(&place, "points and lines are left out, because they have no area");
                continue;
            }
            for instance in &instances {
                let shape = json!({"mesh": {"path": self.path, "part": part}});
                let transform = steps(&(placed.own * *instance));
                let transform = (transform != json!([])).then_some(transform);
                let keys = placed.motion.iter().map(|(time, at)| json!({"time": time, "transform": steps(at)}));
                let motion = (!placed.motion.is_empty()).then(|| keys.collect::<Value>());
                let object = json!({"name": name, "shape": shape, "transform": transform, "motion": motion});
                self.scene.add_object(without_nulls(object));
            }
            let material = primitive.material();
            let brightest = material.emissive_factor().into_iter().fold(0.0, f32::max);
            self.emission = self.emission.max(f64::from(brightest * material.emissive_strength().unwrap_or(1.0)));
            if let Some(name) = material.name() {
                self.scene.name_mesh_material(name);
            }
            let corners = |value: Option<Value>| {
                let numbers: Vec<f64> = value?.as_array()?.iter().filter_map(Value::as_f64).collect();
                <[f64; 3]>::try_from(numbers).ok().map(DVec3::from)
            };
            let positions = primitive.get(&::gltf::Semantic::Positions);
            let bounds = positions.and_then(|it| Some((corners(it.min())?, corners(it.max())?)));
            if let Some((low, high)) = bounds {
                let start = first_joint.unwrap_or_else(|| placed.at_start());
                for to_world in instances.iter().map(|instance| start * *instance) {
                    for corner in 0..8 {
                        let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
                        let point = to_world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
                        self.bounds = (self.bounds.0.min(point), self.bounds.1.max(point));
                    }
                }
            }
        }
    }
}

/// Returns the transforms of a node's instances (EXT_mesh_gpu_instancing): one by default.
fn instances(node: &Node, document: &Document, accessors: &GltfAccessors) -> Result<Vec<DAffine3>> {
    let Some(extension) = node.extension_value(INSTANCING) else { return Ok(vec![DAffine3::IDENTITY]) };
    let read = |name: &str| -> Result<Option<Vec<[f64; 4]>>> {
        let Some(index) = extension.get("attributes").and_then(|it| it.get(name)) else { return Ok(None) };
        let index = index.as_u64().and_then(|index| usize::try_from(index).ok());
        let accessor = index.and_then(|index| document.accessors().nth(index));
        accessors.floats(&accessor.ok_or_else(|| Error::input(format!("{name} names no accessor")))?).map(Some)
    };
    let [translation, rotation, scale] = [read("TRANSLATION")?, read("ROTATION")?, read("SCALE")?];
    let counts: Vec<usize> = [&translation, &rotation, &scale].into_iter().flatten().map(Vec::len).collect();
    if counts.is_empty() || counts.iter().any(|&count| count != counts[0]) {
        return Err(Error::input("its attributes do not have one value for each instance"));
    }
    let vector = |values: &Option<Vec<[f64; 4]>>, i: usize, default: f64| {
        values.as_ref().map_or(DVec3::splat(default), |values| DVec3::new(values[i][0], values[i][1], values[i][2]))
    };
    let transform = |i: usize| {
        let turn = rotation.as_ref().map_or(DQuat::IDENTITY, |turns| unit(DQuat::from_array(turns[i])));
        DAffine3::from_scale_rotation_translation(vector(&scale, i, 1.0), turn, vector(&translation, i, 0.0))
    };
    Ok((0..counts[0]).map(transform).collect())
}
