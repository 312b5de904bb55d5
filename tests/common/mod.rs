//! Shared by the tests that render: scenes from JSON, renders, measured values with their spread,
//! and tests of equality.

pub(crate) mod compare;
pub(crate) mod edges;
pub(crate) mod generated;
pub(crate) mod near;

use abbe_format::{self as format, resolve};
use abbe_session::render::{Integrator, Job, NoMonitor, Rendered, Request, StopRules};
use abbe_transport::sensor::Picture;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Resolves and plans a scene from JSON.
pub(crate) fn job(scene: &Value) -> Job {
    job_with(&scene.to_string(), &[])
}

/// Resolves and plans a scene from text, with some values changed.
pub(crate) fn job_with(text: &str, sets: &[&str]) -> Job {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    let (file, source) = format::parse(text, Path::new("tests/inline.json"), &sets).expect("the scene parses");
    Job::new(resolve::resolve(&file, &source).expect("the scene resolves")).expect("the scene can be planned")
}

/// Returns the names of all example scenes in order.
pub(crate) fn example_names() -> Vec<String> {
    let files = std::fs::read_dir(examples()).expect("the folder of the example scenes");
    let names = files.map(|entry| entry.expect("a file").file_name().into_string().expect("a name in UTF-8"));
    let scenes = names.filter(|name| !name.ends_with(".schema.json"));
    let mut names: Vec<String> = scenes.filter_map(|name| Some(name.strip_suffix(".json")?.to_owned())).collect();
    names.sort();
    names
}

/// Returns the JSON of an example scene.
pub(crate) fn example(name: &str) -> Value {
    let text = std::fs::read_to_string(examples().join(format!("{name}.json"))).expect("an example scene");
    serde_json::from_str(&text).expect("a scene is JSON")
}

/// Resolves and plans an example scene, with some values changed.
pub(crate) fn example_job(name: &str, sets: &[&str]) -> Job {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    let scene = resolve::load(&examples().join(format!("{name}.json")), &sets).expect("an example scene");
    Job::new(scene).expect("the scene can be planned")
}

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// Renders a scene with a fixed number of passes.
pub(crate) fn render(scene: &Value, integrator: Integrator, passes: u64) -> Rendered {
    render_job(&job(scene), integrator, passes)
}

/// Renders a planned scene with a fixed number of passes.
pub(crate) fn render_job(job: &Job, integrator: Integrator, passes: u64) -> Rendered {
    let request = Request { integrator, stop: StopRules { passes: Some(passes), ..StopRules::default() } };
    let rendered = job.render(request, &mut NoMonitor).expect("the scene renders");
    assert_eq!(rendered.stats.rejected_samples, 0, "contributions that are not finite");
    rendered
}

/// Returns the scene with one render setting changed.
pub(crate) fn with_setting(scene: &Value, key: &str, value: impl Into<Value>) -> Value {
    let mut scene = scene.clone();
    scene["render"][key] = value.into();
    scene
}

/// A diffuse material.
pub(crate) fn diffuse(reflectance: impl Into<Value>) -> Value {
    serde_json::json!({ "diffuse": { "reflectance": reflectance.into() } })
}

/// A dielectric material.
pub(crate) fn glass(ior: impl Into<Value>) -> Value {
    serde_json::json!({ "dielectric": { "ior": ior.into() } })
}

/// A camera that looks straight down from `height` at a square of floor with its centre at `above`
/// (x, z) and the given side. A square film sees exactly this square. Rows run along +z, columns
/// along +x.
pub(crate) fn overhead_camera(above: [f64; 2], height: f64, side: f64) -> Value {
    let fov = 2.0 * (0.5 * side / height).atan().to_degrees();
    serde_json::json!({
        "from": [above[0], height, above[1]], "at": [above[0], 0.0, above[1]], "up": [0, 0, -1],
        "lens": { "pinhole": { "fov": fov } }
    })
}

/// Returns the mean Y of the picture.
pub(crate) fn mean_y(rendered: &Rendered) -> Vec<f64> {
    vec![rendered.picture.mean_y()]
}

/// Returns Y of all pixels.
pub(crate) fn all_y(rendered: &Rendered) -> Vec<f64> {
    rendered.picture.xyz.iter().map(|xyz| xyz[1]).collect()
}

/// Returns X, then Y, then Z of the whole picture in blocks of `side` × `side` pixels.
pub(crate) fn colour_blocks(side: usize) -> impl Fn(&Rendered) -> Vec<f64> {
    move |rendered| {
        let picture = &rendered.picture;
        let everything = vec![true; picture.xyz.len()];
        let channel = |c: usize| picture.xyz.iter().map(|xyz| xyz[c]).collect::<Vec<_>>();
        (0..3).flat_map(|c| block_means(&channel(c), picture.width, side, &everything)).collect()
    }
}

/// Returns the means of Y over blocks of `side` × `side` pixels, rows first. Pixels whose `mask` is
/// false do not count. Blocks with less than a quarter of their pixels are left out.
pub(crate) fn block_means(y: &[f64], width: usize, side: usize, mask: &[bool]) -> Vec<f64> {
    let height = y.len() / width;
    let mut means = Vec::new();
    for top in (0..height).step_by(side) {
        for left in (0..width).step_by(side) {
            let places = (top..(top + side).min(height))
                .flat_map(|j| (left..(left + side).min(width)).map(move |i| j * width + i))
                .filter(|&place| mask[place]);
            let values: Vec<f64> = places.map(|place| y[place]).collect();
            if 4 * values.len() >= side * side {
                means.push(values.iter().sum::<f64>() / values.len() as f64);
            }
        }
    }
    means
}

/// Returns a channel of a layer.
#[track_caller]
pub(crate) fn channel<'p>(picture: &'p Picture, name: &str) -> &'p [f32] {
    let known: Vec<&str> = picture.layers.channels.iter().map(|channel| channel.name.as_str()).collect();
    let found = picture.layers.channels.iter().find(|channel| channel.name == name);
    &found.unwrap_or_else(|| panic!("no {name} in {known:?}")).values
}
