//! The layers of a film, from the layers that a scene requests.

use abbe_scene::{Layer, Scene};
use abbe_spectra::error::{Error, Result};
use abbe_transport::plan::PathClass;
use abbe_transport::sensor::LayerSet;
use abbe_transport::sensor::layers::SurfaceLayer;

/// Returns the requested layers, or an input error if there are too many groups of lights.
pub(super) fn layer_set(scene: &Scene) -> Result<LayerSet> {
    let wanted = |layer: Layer| scene.film.layers.contains(&layer);
    let names = |layer: Layer, names: Vec<String>| wanted(layer).then_some(names);
    let surfaces = [
        (Layer::Albedo, SurfaceLayer::Albedo),
        (Layer::Normal, SurfaceLayer::Normal),
        (Layer::Depth, SurfaceLayer::Depth),
        (Layer::Uv, SurfaceLayer::Uv),
        (Layer::Samples, SurfaceLayer::Samples),
    ];
    let mut set = LayerSet {
        surfaces: surfaces.iter().filter(|(layer, _)| wanted(*layer)).map(|(_, surface)| *surface).collect(),
        objects: names(Layer::Object, scene.objects.iter().map(|object| object.name.clone()).collect()),
        materials: names(Layer::Material, scene.materials.iter().map(|material| material.name.clone()).collect()),
        stokes: wanted(Layer::Stokes),
        ..LayerSet::default()
    };
    if wanted(Layer::Paths) {
        set.paths = PathClass::NAMES.map(String::from).to_vec();
    }
    if wanted(Layer::Lights) {
        for light in &scene.lights {
            let name = channel_name(&light.group);
            let group = set.light_groups.iter().position(|known| *known == name).unwrap_or_else(|| {
                set.light_groups.push(name);
                set.light_groups.len() - 1
            });
            let too_many = |_| Error::input("there are too many groups of lights").expected("at most 65536 groups");
            set.group_of_light.push(u16::try_from(group).map_err(too_many)?);
        }
    }
    Ok(set)
}

/// Replaces characters of a group other than ASCII letters, digits, `-` and `_` by `_`.
fn channel_name(group: &str) -> String {
    group.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}
