//! The provenance of a picture: the entries of its file's header, and a hash of its scene.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use abbe_format::resolve;
use abbe_format::{FileAccess, JsonSource};
use abbe_session::output::exr::read_metadata;
use abbe_session::output::hash::IdentityHash;
use abbe_session::output::metadata::{Metadata, names};
use abbe_session::render::{DisplaySettings, Integrator, Job, LedgerStats, Request, Stats, affects_passes};
use serde_json::Value;

use super::plan_report::PlanReport;

/// Returns the header entries of a scene and its plan. `source` is the text of the scene with its
/// files, if it has one.
pub fn of_scene(source: Option<(&JsonSource, &SceneFiles)>, job: &Job, integrator: Integrator) -> Metadata {
    let mut metadata = Metadata::new().with(names::VERSION, env!("CARGO_PKG_VERSION"));
    if let Some((source, files)) = source {
        metadata = metadata.with(names::SCENE_HASH, &files.hash).with(names::SCENE, &source.compact(|_, _| true));
    }
    metadata
        .with_json(names::PLAN, &PlanReport::of(job))
        .with_json(names::DISPLAY, &DisplaySettings::of(job))
        .with(names::INTEGRATOR, integrator.word())
        .with(names::SEED, &job.budget.seed.number().to_string())
        .with(names::PHOTONS, &job.budget.photons.to_string())
        .with_json(names::NOTES, &job.scene.notes)
}

/// Adds the header entries that describe a finished render.
pub fn of_render(of_scene: &Metadata, stats: &Stats) -> Metadata {
    of_passes(of_scene, stats.passes, &stats.ledger_w, stats.seconds.total)
}

/// Adds the passes of a render: their number, mean energy balance, and time in s.
pub fn of_passes(of_scene: &Metadata, passes: u64, ledger_w: &LedgerStats, seconds: f64) -> Metadata {
    of_scene
        .clone()
        .with(names::PASSES, &passes.to_string())
        .with_json(names::LEDGER, ledger_w)
        .with(names::SECONDS, &format!("{seconds:.3}"))
}

/// Removes times and facts about the machine, so that renders with equal results have equal
/// headers.
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

/// Returns the header of a file with a finished picture of this scene, from the same version of
/// Abbe and the same integrator, with at least the passes of the request.
pub fn finished(path: &Path, of_scene: &Metadata, request: Request, job: &Job) -> Option<Metadata> {
    let found = read_metadata(path).ok()?;
    let same =
        [names::VERSION, names::SCENE_HASH, names::INTEGRATOR].iter().all(|name| found.get(name) == of_scene.get(name));
    let passes = found.get(names::PASSES).and_then(|passes| passes.parse::<u64>().ok()).unwrap_or(0);
    let is_other = [names::PREVIEW, names::RELIGHT].iter().any(|name| found.get(name).is_some());
    (same && !is_other && passes >= request.stop.passes_wanted(&job.budget).unwrap_or(1)).then_some(found)
}

/// The files that a scene names, directly or through others.
#[derive(Debug)]
pub struct SceneFiles {
    /// A hash of the scene and of its files. Scenes of the same hash have equal passes: it ignores
    /// the number of passes, the threads, the checkpoint interval, the display of the picture, and
    /// the folder of the scene.
    hash: String,
    /// Each file once, in no order.
    pub paths: Vec<PathBuf>,
}

impl SceneFiles {
    /// Reads all files that a scene names.
    pub fn of(source: &JsonSource) -> Self {
        let mut files = FileHash::new(source.file_access());
        files.hash.add_part(source.compact(affects_passes).as_bytes());
        source.strings().for_each(|name| files.add_with_parts(&name, source.folder()));
        Self { hash: files.hash.hex(), paths: files.added.into_iter().collect() }
    }
}

/// The longest path (bytes) that operating systems accept. A longer text names no file.
const LONGEST_PATH: usize = 4096;

/// A hash of files. It contains each file once, and only files that the scene may name.
struct FileHash {
    hash: IdentityHash,
    file_access: FileAccess,
    added: HashSet<PathBuf>,
}

impl FileHash {
    fn new(file_access: FileAccess) -> Self {
        Self { hash: IdentityHash::default(), file_access, added: HashSet::new() }
    }

    /// Adds all files that a glTF file may name, in its order: each text may be a name.
    fn add_all(&mut self, value: &Value, folder: &Path) {
        match value {
            Value::Object(entries) => entries.values().for_each(|value| self.add_all(value, folder)),
            Value::Array(values) => values.iter().for_each(|value| self.add_all(value, folder)),
            Value::String(name) => self.add_with_parts(name, folder),
            Value::Null | Value::Bool(_) | Value::Number(_) => {}
        }
    }

    /// Adds a file, and then the files that it names: the materials of an OBJ file with their
    /// pictures, the files of a glTF file, the tilt factors of a luminaire, and the glass
    /// catalogues of a Zemax lens.
    fn add_with_parts(&mut self, name: &str, folder: &Path) {
        let Some((path, bytes)) = self.add_named(name, folder) else { return };
        let folder = path.parent().unwrap_or(Path::new(""));
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("obj") => {
                for library in names_after(b"mtllib", &bytes) {
                    if let Some((_, bytes)) = self.add_named(&library, folder) {
                        names_after(b"", &bytes).for_each(|name| drop(self.add_named(&name, folder)));
                    }
                }
            }
            Some("ies") => names_after(b"TILT=", &bytes).for_each(|name| drop(self.add_named(&name, folder))),
            Some("gltf") => {
                let gltf: Value = serde_json::from_slice(&bytes).unwrap_or(Value::Null);
                self.add_all(&gltf, folder);
            }
            Some("zmx") => resolve::catalogues_beside(&path, &bytes).iter().for_each(|path| drop(self.add(path))),
            Some(_) | None => {}
        }
    }

    /// Adds the file of this name in a folder; see [`Self::add`]. Also returns its path.
    fn add_named(&mut self, name: &str, folder: &Path) -> Option<(PathBuf, Vec<u8>)> {
        if name.len() > LONGEST_PATH {
            return None;
        }
        let path = PathBuf::from(self.file_access.file(folder, Path::new(name)).ok()?);
        let bytes = self.add(&path)?;
        Some((path, bytes))
    }

    /// Adds a file and returns its bytes, unless it is missing or already in the hash.
    fn add(&mut self, path: &Path) -> Option<Vec<u8>> {
        if self.added.contains(path) || !path.is_file() {
            return None;
        }
        let bytes = std::fs::read(path).ok()?;
        self.hash.add_part(&bytes);
        self.added.insert(path.to_owned());
        Some(bytes)
    }
}

/// Returns the texts that may be file names on the lines that start with `key`: the rest of the
/// line from each of its words on, because options may precede a name with spaces.
fn names_after(key: &[u8], text: &[u8]) -> impl Iterator<Item = String> {
    let lines = text.split(|&byte| byte == b'\n');
    let rests = lines.filter_map(move |line| Some(line.trim_ascii().strip_prefix(key)?.trim_ascii()));
    rests.flat_map(|rest| {
        let starts = (rest.len().saturating_sub(LONGEST_PATH)..rest.len())
            .filter(|&at| !rest[at].is_ascii_whitespace() && (at == 0 || rest[at - 1].is_ascii_whitespace()));
        starts.map(|at| String::from_utf8_lossy(&rest[at..]).into_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn hash(scene: &Value, folder: &Path, access: FileAccess) -> String {
        let source = JsonSource::patched(scene.to_string(), &folder.join("scene.json"), &[]).unwrap();
        SceneFiles::of(&source.with_file_access(access)).hash
    }

    /// A scene of many instances of a mesh names one file many times.
    #[test]
    fn the_hash_reads_each_file_once() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.ply"), "ply").unwrap();
        let mut files = FileHash::new(FileAccess::default());
        assert!(files.add(&folder.path().join("a.ply")).is_some());
        assert!(files.add(&folder.path().join("a.ply")).is_none());
        assert!(files.add(folder.path()).is_none(), "a folder is not a file");
    }

    /// A scene of an unknown author cannot make the program read files outside its folder.
    #[test]
    fn the_hash_reads_only_files_that_the_scene_may_name() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("scene");
        std::fs::create_dir(&folder).unwrap();
        let hash = |access| hash(&json!({"title": "../other.txt"}), &folder, access);
        let without = [FileAccess::WithinFolder, FileAccess::Anywhere].map(hash);
        std::fs::write(parent.path().join("other.txt"), "text").unwrap();
        assert_eq!(hash(FileAccess::WithinFolder), without[0]);
        assert_ne!(hash(FileAccess::Anywhere), without[1]);
    }

    #[test]
    fn the_hash_covers_scene_and_files_but_not_passes() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.obj"), "mtllib a.mtl\n").unwrap();
        std::fs::write(folder.path().join("a.mtl"), "newmtl red\n").unwrap();
        let scene = |passes: u64, seed: u64| json!({"objects": [{"shape": {"mesh": {"path": "a.obj"}}}], "render": {"passes": passes, "seed": seed}});
        let hash = |scene: &Value| hash(scene, folder.path(), FileAccess::default());
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
        std::fs::write(folder.path().join("a.mtl"), "newmtl blue\nmap_bump -bm 0.5 my bumps.png\n").unwrap();
        let flat = hash(&scene(8, 0));
        std::fs::write(folder.path().join("my bumps.png"), "a picture").unwrap();
        assert_ne!(flat, hash(&scene(8, 0)));
        let paper = json!({"bispectral": {"reflectance": 0.85, "matrix": "paper.csv"}});
        let absent = hash(&paper);
        std::fs::write(folder.path().join("paper.csv"), "emission_nm,400").unwrap();
        assert_ne!(absent, hash(&paper));
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
