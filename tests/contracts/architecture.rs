//! The architecture, checked on the source itself: imports go one way, each crate is used only in
//! its place, and files stay short.
//!
//! Comments, strings and `#[cfg(test)]` code do not count, except for the bans on `unsafe`, macros
//! and long files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The modules in the order of imports, each with the modules directly below it. A module may
/// import these and everything below them.
const ORDER: [(&str, &[&str]); 25] = [
    ("error", &[]),
    ("math", &["error"]),
    ("spectrum", &["math"]),
    ("colour", &["spectrum"]),
    ("texture", &["spectrum"]),
    ("optics", &["texture"]),
    ("geometry", &["math"]),
    ("scene", &["colour", "optics", "geometry"]),
    ("json", &["error"]),
    ("format", &["scene", "json"]),
    ("plan", &["scene"]),
    ("walk", &["plan"]),
    ("map", &["walk"]),
    ("emit", &["map"]),
    ("gather", &["map"]),
    ("sensor", &["colour"]),
    ("output", &["sensor"]),
    ("pass", &["emit", "gather", "sensor"]),
    ("render", &["pass", "output"]),
    ("study", &["render", "format"]),
    ("validate", &["render", "format"]),
    ("api", &["render", "format"]),
    ("view", &["api"]),
    ("cli", &["study", "validate", "view", "api"]),
    ("python", &["cli"]),
];

/// Modules whose code runs for every photon and every camera ray. They handle light by wavelength
/// only.
const HOT: [&str; 5] = ["walk", "map", "emit", "gather", "pass"];

/// The files or folders below src that may use each crate; an empty name means everywhere.
const CRATES: [(&str, &[&str]); 37] = [
    ("glam", &[""]),
    ("serde", &[""]),
    ("obvhs", &["geometry/bvh.rs", "map/box_tree.rs"]),
    (
        "wide",
        &["map/point_tree.rs", "map/volume/beam.rs", "gather/density/responses.rs", "spectrum/smooth_reflectance.rs"],
    ),
    ("smallvec", &["scene/initial_stack.rs", "walk/transmittance.rs"]),
    ("rand", &["math/random.rs"]),
    ("rand_pcg", &["math/random.rs"]),
    ("rayon", &["math/parallel.rs", "render/", "map/", "sensor/", "texture/palette.rs"]),
    ("exr", &["output/", "format/picture_file.rs"]),
    ("png", &["output/png.rs"]),
    ("moxcms", &["output/icc.rs"]),
    ("image", &["output/", "format/picture_file.rs"]),
    (
        "serde_json",
        &[
            "json/",
            "format/",
            "optics/glass/catalogue.rs",
            "optics/lens/catalogue.rs",
            "output/",
            "render/",
            "study/",
            "validate/",
            "api/",
            "view/",
            "cli/",
            "python/",
        ],
    ),
    ("serde_path_to_error", &["format/"]),
    ("schemars", &["format/"]),
    ("strsim", &["error.rs"]),
    ("axum", &["view/"]),
    ("tokio", &["view/"]),
    ("clap", &["cli/"]),
    ("clap_complete", &["cli/"]),
    ("clap_mangen", &["cli/"]),
    ("indicatif", &["cli/"]),
    ("maud", &["output/", "study/"]),
    ("base64", &["output/data_uri.rs", "format/mesh/gltf_texture.rs"]),
    ("blake3", &["output/hash.rs"]),
    ("roxmltree", &["spectrum/", "format/import/mitsuba/xml.rs"]),
    ("yaml_rust2", &["optics/glass/index_file.rs"]),
    ("ctrlc", &["cli/"]),
    ("zip", &["format/volume_file.rs"]),
    ("tobj", &["format/mesh/"]),
    ("stl_io", &["format/mesh/"]),
    ("gltf", &["format/mesh/", "format/import/"]),
    ("flate2", &["spectrum/embedded.rs", "format/mesh/mod.rs", "format/mesh/serialized.rs"]),
    ("ply_rs_bw", &["format/mesh/"]),
    ("libm", &["math/elementary.rs"]),
    ("pyo3", &["python/"]),
    ("numpy", &["python/"]),
];

/// The largest length of a file in lines.
const LONGEST: usize = 500;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns all Rust files below a folder.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a readable folder").path()).collect();
    paths.sort();
    let nested = |path: PathBuf| {
        if path.is_dir() {
            rust_files(&path)
        } else {
            vec![path].into_iter().filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
        }
    };
    paths.into_iter().flat_map(nested).collect()
}

/// A source file of the library without comments, strings and test code.
struct Source {
    /// The path below src, with forward slashes.
    name: String,
    code: String,
}

impl Source {
    /// Returns the top-level module; `lib` and `main` are their own.
    fn top(&self) -> &str {
        let first = self.name.split('/').next().unwrap_or_default();
        first.trim_end_matches(".rs")
    }

    /// Returns the number of modules between the crate's root and the file's code.
    fn depth(&self) -> usize {
        let path = self.name.trim_end_matches(".rs").trim_end_matches("/mod");
        path.split('/').count()
    }
}

/// Returns the library's sources without files that are declared under `#[cfg(test)]`.
fn sources() -> Vec<Source> {
    let src = root().join("src");
    let mut left_out: Vec<String> = Vec::new();
    let mut sources = Vec::new();
    for path in rust_files(&src) {
        let text = std::fs::read_to_string(&path).expect("a source file is UTF-8");
        let relative = path.strip_prefix(&src).expect("below src");
        let name = relative.to_string_lossy().replace('\\', "/");
        let (code, test_modules) = without_tests(&without_comments_and_strings(&text));
        let folder =
            name.strip_suffix("mod.rs").map_or_else(|| name.trim_end_matches(".rs").to_string() + "/", str::to_string);
        left_out.extend(test_modules.iter().map(|module| format!("{folder}{module}")));
        sources.push(Source { name, code });
    }
    sources.retain(|source| {
        !left_out
            .iter()
            .any(|module| source.name == format!("{module}.rs") || source.name.starts_with(&format!("{module}/")))
    });
    assert!(sources.len() > 50, "only {} sources found", sources.len());
    sources
}

/// Replaces comments, string literals and character literals by blanks.
fn without_comments_and_strings(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(hashes) = raw_string_hashes(rest, out.chars().last()) {
            let end = format!("\"{}", "#".repeat(hashes));
            let open = rest.find('"').expect("a raw string opens") + 1;
            rest[open..].find(&end).map_or(rest.len(), |close| open + close + end.len())
        } else if first == '"' {
            quoted_length(rest, '"')
        } else if first == '\'' && is_character(rest) {
            quoted_length(rest, '\'')
        } else {
            out.push(first);
            rest = &rest[first.len_utf8()..];
            continue;
        };
        out.push(' ');
        rest = &rest[skipped..];
    }
    out
}

/// Returns the number of `#` that open a raw string here, if one opens.
fn raw_string_hashes(rest: &str, before: Option<char>) -> Option<usize> {
    let inside_name = before.is_some_and(|c| c.is_alphanumeric() || c == '_');
    let tail = rest.strip_prefix("br").or_else(|| rest.strip_prefix('r')).filter(|_| !inside_name)?;
    let hashes = tail.len() - tail.trim_start_matches('#').len();
    tail[hashes..].starts_with('"').then_some(hashes)
}

/// Tells whether a quote opens a character literal rather than a lifetime.
fn is_character(rest: &str) -> bool {
    let mut chars = rest.chars().skip(1);
    matches!((chars.next(), chars.next()), (Some('\\'), _) | (Some(_), Some('\'')))
}

/// Returns the length of a quoted literal with its escapes.
fn quoted_length(rest: &str, quote: char) -> usize {
    let mut escaped = false;
    for (i, c) in rest.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if c == quote => return i + c.len_utf8(),
            _ => {}
        }
    }
    rest.len()
}

/// Removes items under `#[cfg(test)]` from the code. Also returns the names of the modules among
/// them that have their own files.
fn without_tests(code: &str) -> (String, Vec<String>) {
    const MARK: &str = "#[cfg(test)]";
    let (mut kept, mut modules, mut rest) = (String::new(), Vec::new(), code);
    while let Some(start) = rest.find(MARK) {
        kept.push_str(&rest[..start]);
        let item = &rest[start + MARK.len()..];
        let end = item_length(item);
        let words: Vec<&str> = item[..end].split_whitespace().collect();
        if let Some(at) = words.iter().position(|&word| word == "mod")
            && let Some(name) = words.get(at + 1).and_then(|name| name.strip_suffix(';'))
        {
            modules.push(name.to_string());
        }
        rest = &item[end..];
    }
    kept.push_str(rest);
    (kept, modules)
}

/// Returns the length of an item, up to the end of its block or its semicolon.
fn item_length(item: &str) -> usize {
    let mut depth = 0;
    for (i, c) in item.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 1 => return i + 1,
            '}' => depth -= 1,
            ';' if depth == 0 => return i + 1,
            _ => {}
        }
    }
    item.len()
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Returns the names that follow each occurrence of `prefix` at the start of a path: one name, or
/// several in braces.
fn names_after(code: &str, prefix: &str) -> Vec<String> {
    let starts_path = |at: usize| !code[..at].chars().next_back().is_some_and(|c| is_name(c) || c == ':' || c == '$');
    let occurrences = code.match_indices(prefix).filter(|(at, _)| starts_path(*at));
    occurrences.flat_map(|(at, _)| names_at(&code[at + prefix.len()..])).collect()
}

fn names_at(tail: &str) -> Vec<String> {
    let name = |text: &str| text.trim_start().chars().take_while(|&c| is_name(c)).collect::<String>();
    let Some(group) = tail.strip_prefix('{') else { return vec![name(tail)] };
    let (mut depth, mut begin, mut names) = (0, 0, Vec::new());
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            ',' | '}' if depth == 0 => {
                names.push(name(&group[begin..i]));
                begin = i + 1;
                if c == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

/// Returns the modules that a source names from the crate's root.
fn imports(source: &Source) -> BTreeSet<String> {
    let mut names = names_after(&source.code, "crate::");
    names.extend(names_after(&source.code, &"super::".repeat(source.depth())));
    // `super` and `self` lead to a closer module. Capitals are items, which a short chain of
    // `super` in an inline module may name.
    let is_module = |name: &String| name.starts_with(char::is_lowercase) && !matches!(name.as_str(), "super" | "self");
    names.into_iter().filter(is_module).collect()
}

/// Returns all modules that each module may import.
fn allowed() -> BTreeMap<&'static str, BTreeSet<&'static str>> {
    let mut allowed: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (module, below) in ORDER {
        let further = below.iter().flat_map(|&b| allowed[b].iter().copied().chain([b])).collect();
        allowed.insert(module, further);
    }
    allowed
}

#[test]
fn imports_go_one_way() {
    let allowed = allowed();
    let mut faults = Vec::new();
    for source in sources() {
        let top = source.top();
        if matches!(top, "lib" | "main") {
            continue;
        }
        let Some(below) = allowed.get(top) else {
            faults.push(format!("{}: the module {top} has no place in the order", source.name));
            continue;
        };
        for name in imports(&source) {
            if name != top && !below.contains(name.as_str()) {
                faults.push(format!("{} imports {name}", source.name));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_order_of_modules_is_the_one_the_pipeline_states() {
    let allowed = allowed();
    assert!(!allowed["emit"].contains("gather") && !allowed["gather"].contains("emit"));
    assert!(!allowed["gather"].contains("sensor") && !allowed["output"].contains("scene"));
    assert!(allowed["python"].len() == ORDER.len() - 1, "the Python package stands on everything");
}

#[test]
fn transport_knows_light_by_wavelength_only() {
    for source in sources().iter().filter(|source| HOT.contains(&source.top())) {
        assert!(!imports(source).contains("colour"), "{} imports colour", source.name);
    }
}

#[test]
fn crates_are_used_where_they_belong() {
    let places: BTreeMap<&str, &[&str]> = CRATES.into_iter().collect();
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("a manifest");
    let (_, tail) = manifest.split_once("[dependencies]\n").expect("dependencies");
    let section = tail.split("\n[").next().unwrap_or_default();
    let lines = section.lines().filter(|line| !line.starts_with('#'));
    let crates: Vec<String> =
        lines.filter_map(|line| line.split_once(" = ")).map(|(name, _)| name.replace('-', "_")).collect();
    assert!(crates.len() > 10, "{crates:?}");
    let mut faults = Vec::new();
    for name in &crates {
        let Some(places) = places.get(name.as_str()) else {
            faults.push(format!("the crate {name} has no place"));
            continue;
        };
        for source in sources() {
            let used = !names_after(&source.code, &format!("{name}::")).is_empty();
            if used && !places.iter().any(|place| source.name.starts_with(place)) {
                faults.push(format!("{} uses {name}", source.name));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn inner_loops_have_no_virtual_calls_locks_or_hash_maps() {
    // Light beyond a stated depth reaches its sink by a virtual call. Other light never does.
    let cold = "walk/depth_limit.rs";
    for source in sources().iter().filter(|source| HOT.contains(&source.top()) && source.name != cold) {
        let mut words = source.code.split(|c| !is_name(c));
        let banned =
            words.find(|word| matches!(*word, "dyn" | "Mutex" | "RwLock" | "HashMap" | "BTreeMap" | "Rc" | "Arc"));
        assert_eq!(banned, None, "{}", source.name);
    }
}

#[test]
fn nothing_is_unsafe_and_no_macro_is_defined() {
    assert!(!root().join("build.rs").exists(), "the package needs no build script");
    for folder in ["src", "tests", "benches", "examples"] {
        for path in rust_files(&root().join(folder)) {
            let text = std::fs::read_to_string(&path).expect("a source file is UTF-8");
            let code = without_comments_and_strings(&text);
            let banned = code.split(|c| !is_name(c)).find(|word| matches!(*word, "unsafe" | "macro_rules"));
            assert_eq!(banned, None, "{}", path.display());
        }
    }
}

#[test]
fn files_are_short() {
    let mut faults = Vec::new();
    for folder in ["src", "tests", "benches", "examples"] {
        for path in rust_files(&root().join(folder)) {
            let lines = std::fs::read_to_string(&path).expect("a source file is UTF-8").lines().count();
            if lines > LONGEST {
                faults.push(format!("{}: {lines} lines", path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_scanner_sees_through_comments_strings_and_test_code() {
    let text = r##"
        use crate::{math::{self, sum}, optics};
        // crate::colour
        const A: &str = "crate::gather"; const B: &str = r#"crate::emit "quoted""#; const C: char = '"';
        fn f<'a>(x: &'a str) -> u8 { crate::scene::x(x) /* crate::plan */ + super::super::walk::y() }
        #[cfg(test)]
        mod tests { use crate::render::Job; fn g() {} }
        #[cfg(test)]
        mod apart;
        use not_crate::cli;
    "##;
    let (code, modules) = without_tests(&without_comments_and_strings(text));
    assert_eq!(modules, ["apart"]);
    let source = Source { name: "map/kernel.rs".into(), code };
    let found: Vec<String> = imports(&source).into_iter().collect();
    assert_eq!(found, ["math", "optics", "scene", "walk"]);
}
