//! The provenance of a picture: the entries of its file's header, and a hash of its scene.

use std::path::Path;

use crate::format::JsonSource;
use crate::format::resolve;
use crate::output::exr::read_metadata;
use crate::output::hash::IdentityHash;
use crate::output::metadata::{Metadata, names};
use crate::render::{DisplaySettings, Integrator, Job, LedgerStats, Request, Stats, scene_of_passes};
use serde_json::Value;

use super::plan_report::PlanReport;

/// Returns the header entries that describe a scene and its plan. `source` is the text of the
/// scene, or `None` for a resolved scene, which has no text.
pub fn of_scene(source: Option<&JsonSource>, job: &Job, integrator: Integrator) -> Metadata {
    let mut metadata = Metadata::new().with(names::VERSION, env!("CARGO_PKG_VERSION"));
    if let Some(source) = source {
        let scene: Value = serde_json::from_str(&source.text).unwrap_or(Value::Null);
        metadata =
            metadata.with(names::SCENE_HASH, &scene_hash(&scene, source.folder())).with_json(names::SCENE, &scene);
    }
    metadata
        .with_json(names::PLAN, &PlanReport::of(job))
        .with_json(names::DISPLAY, &DisplaySettings::of(job))
        .with(names::INTEGRATOR, integrator.word())
        .with(names::SEED, &job.budget.seed.to_string())
        .with(names::PHOTONS, &job.budget.photons.to_string())
        .with_json(names::NOTES, &job.scene.notes)
}

/// Adds the header entries that describe a finished render.
pub fn of_render(of_scene: &Metadata, stats: &Stats) -> Metadata {
    of_passes(of_scene, stats.passes, &stats.ledger_w, stats.seconds.total)
}

/// Adds the header entries that describe the passes of a render: their number, their mean energy
/// balance, and their time in s.
pub fn of_passes(of_scene: &Metadata, passes: u64, ledger_w: &LedgerStats, seconds: f64) -> Metadata {
    of_scene
        .clone()
        .with(names::PASSES, &passes.to_string())
        .with_json(names::LEDGER, ledger_w)
        .with(names::SECONDS, &format!("{seconds:.3}"))
}

/// Removes the times and the facts about the machine from a header. Two renders with equal results
/// then have equal headers.
pub fn reproducible(metadata: Metadata) -> Metadata {
    let scene: Option<Value> = metadata.get(names::SCENE).and_then(|text| serde_json::from_str(text).ok());
    let metadata = metadata.without(names::SECONDS);
    let Some(mut scene) = scene else { return metadata };
    if let Some(Value::Object(render)) = scene.get_mut("render") {
        render.retain(|key, _| !["threads", "checkpoint_seconds"].contains(&key.as_str()));
    }
    if scene.get("render").and_then(Value::as_object).is_some_and(serde_json::Map::is_empty)
        && let Value::Object(entries) = &mut scene
    {
        entries.shift_remove("render");
    }
    metadata.with_json(names::SCENE, &scene)
}

/// Returns the header of a file if the file contains a finished picture of this scene. The picture
/// must come from the same version of Abbe and from the same integrator. If the request limits the
/// number of passes, the picture must contain at least this number of passes.
pub fn finished(path: &Path, of_scene: &Metadata, request: Request, job: &Job) -> Option<Metadata> {
    let found = read_metadata(path).ok()?;
    let same =
        [names::VERSION, names::SCENE_HASH, names::INTEGRATOR].iter().all(|name| found.get(name) == of_scene.get(name));
    let passes = found.get(names::PASSES).and_then(|passes| passes.parse::<u64>().ok()).unwrap_or(0);
    let is_other = [names::PREVIEW, names::RELIGHT].iter().any(|name| found.get(name).is_some());
    (same && !is_other && passes >= request.stop.passes_wanted(&job.budget).unwrap_or(1)).then_some(found)
}

/// Hashes a scene and the files that it names. If two scenes have the same hash, their passes are
/// equal. The hash ignores the number of passes, the number of threads, the checkpoint interval,
/// the conversion of the picture for a display, and the folder of the scene.
fn scene_hash(scene: &Value, folder: &Path) -> String {
    let scene = scene_of_passes(scene);
    let mut hash = IdentityHash::default();
    hash.add_part(scene.to_string().as_bytes());
    add_files(&scene, folder, &mut hash);
    hash.hex()
}

/// Adds all files that the scene names to the hash, in the order in which the scene names them.
fn add_files(value: &Value, folder: &Path, hash: &mut IdentityHash) {
    match value {
        Value::Object(entries) => {
            for (key, value) in entries {
                match value {
                    Value::String(name)
                        if ["path", "file", "image", "bands", "prescription"].contains(&key.as_str()) =>
                    {
                        add_file(&folder.join(name), hash);
                    }
                    Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
                    Value::Array(_) | Value::Object(_) => add_files(value, folder, hash),
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| add_files(value, folder, hash)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// Adds a file to the hash, and then the files that it names: the materials of an OBJ file with
/// their pictures, the buffers and images of a glTF file, and the glass catalogues of a Zemax lens.
fn add_file(path: &Path, hash: &mut IdentityHash) {
    let Ok(bytes) = std::fs::read(path) else {
        return;
    };
    hash.add_part(&bytes);
    let folder = path.parent().unwrap_or(Path::new(""));
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("obj") => {
            for library in names_after("mtllib ", &bytes) {
                let library = folder.join(library);
                add_bytes(&library, hash);
                let pictures = std::fs::read(&library).map(|bytes| names_after("map_Kd ", &bytes)).unwrap_or_default();
                pictures.iter().for_each(|name| add_bytes(&folder.join(name), hash));
            }
        }
        Some("gltf") => {
            let gltf: Value = serde_json::from_slice(&bytes).unwrap_or(Value::Null);
            let of = |list: &str| gltf.get(list).and_then(Value::as_array).cloned().unwrap_or_default();
            let entries = [of("buffers"), of("images")].concat();
            let named = entries.iter().filter_map(|entry| entry.get("uri")?.as_str());
            named.filter(|uri| !uri.starts_with("data:")).for_each(|uri| add_bytes(&folder.join(uri), hash));
        }
        Some("zmx") => resolve::catalogues_beside(path, &bytes).iter().for_each(|path| add_bytes(path, hash)),
        Some(_) | None => {}
    }
}

/// Returns the rest of each line that starts with `key`.
fn names_after(key: &str, text: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(text);
    text.lines().filter_map(|line| Some(line.trim().strip_prefix(key)?.trim().to_string())).collect()
}

fn add_bytes(path: &Path, hash: &mut IdentityHash) {
    if let Ok(bytes) = std::fs::read(path) {
        hash.add_part(&bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_hash_covers_scene_and_files_but_not_passes() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.obj"), "mtllib a.mtl\n").unwrap();
        std::fs::write(folder.path().join("a.mtl"), "newmtl red\n").unwrap();
        let scene = |passes: u64, seed: u64| json!({"objects": [{"shape": {"mesh": {"path": "a.obj"}}}], "render": {"passes": passes, "seed": seed}});
        let hash = |scene: &Value| scene_hash(scene, folder.path());
        let first = hash(&scene(8, 0));
        assert_eq!(first, hash(&scene(64, 0)));
        assert_ne!(first, hash(&scene(8, 1)));
        std::fs::write(folder.path().join("a.mtl"), "newmtl blue\n").unwrap();
        let second = hash(&scene(8, 0));
        assert_ne!(first, second);
        std::fs::write(folder.path().join("a.obj"), "mtllib a.mtl\nv 0 0 0\n").unwrap();
        assert_ne!(second, hash(&scene(8, 0)));
        std::fs::write(folder.path().join("a.mtl"), "newmtl blue\nmap_Kd a.png\n").unwrap();
        let untextured = hash(&scene(8, 0));
        std::fs::write(folder.path().join("a.png"), "a picture").unwrap();
        assert_ne!(untextured, hash(&scene(8, 0)));
        let bands = json!({"reflectance": {"bands": "a.exr"}});
        let missing = hash(&bands);
        std::fs::write(folder.path().join("a.exr"), "bands").unwrap();
        assert_ne!(missing, hash(&bands));
        let lens = json!({"camera": {"lens": {"system": {"prescription": "a.lens"}}}});
        let built_in = hash(&lens);
        std::fs::write(folder.path().join("a.lens"), "{}").unwrap();
        assert_ne!(built_in, hash(&lens));
    }
}
