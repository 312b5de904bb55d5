//! The architecture, checked on the source itself: no circles of files, light by wavelength only in
//! the transport, no slow constructs in inner loops, and short files. Cargo checks the order of the
//! crates.
//!
//! Comments, strings and `#[cfg(test)]` code do not count, except for the bans on `unsafe`, macros
//! and long files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Modules of `abbe-transport` whose code runs for every photon and every camera ray. They handle
/// light by wavelength only.
const HOT: [&str; 7] = ["walk/", "map/", "emit/", "gather/", "pass/", "pilot/", "photon_paths.rs"];

/// A module whose files may import each other: a box tree of objects that are box trees.
const NATURAL: &str = "geometry::";

/// The largest length of a file in lines.
const LONGEST: usize = 500;

/// The folders of Rust files.
const FOLDERS: [&str; 6] = ["src", "crates", "python", "tests", "benches", "examples"];

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

/// A source file of a library without comments, strings and test code.
struct Source {
    /// The path below the `src` of its crate, with forward slashes.
    name: String,
    code: String,
}

impl Source {
    /// Returns the path of the module, such as `["map", "kernel"]`. It is empty for the root.
    fn module(&self) -> Vec<String> {
        let path = self.name.trim_end_matches(".rs");
        let path = path.strip_suffix("/mod").unwrap_or(path);
        if path == "lib" { Vec::new() } else { path.split('/').map(str::to_string).collect() }
    }
}

/// Returns the folders that hold the sources of the libraries.
fn libraries() -> Vec<PathBuf> {
    let crates = std::fs::read_dir(root().join("crates")).expect("the folder of the crates");
    let mut folders: Vec<PathBuf> = crates.map(|entry| entry.expect("a crate").path().join("src")).collect();
    folders.extend(["src", "python/native/src"].map(|folder| root().join(folder)));
    folders.sort();
    folders
}

/// Returns the sources of a library without files that are declared under `#[cfg(test)]`.
fn sources(src: &Path) -> Vec<Source> {
    let mut left_out: Vec<String> = Vec::new();
    let mut sources = Vec::new();
    for path in rust_files(src) {
        let text = std::fs::read_to_string(&path).expect("a source file is UTF-8");
        let relative = path.strip_prefix(src).expect("below src");
        let name = relative.to_string_lossy().replace('\\', "/");
        let (code, test_modules) = without_tests(&without_comments_and_strings(&text));
        let folder = match name.rsplit_once('/') {
            Some((folder, "mod.rs")) => format!("{folder}/"),
            None if name == "lib.rs" => String::new(),
            _ => name.trim_end_matches(".rs").to_string() + "/",
        };
        left_out.extend(test_modules.iter().map(|module| format!("{folder}{module}")));
        sources.push(Source { name, code });
    }
    sources.retain(|source| {
        !left_out
            .iter()
            .any(|module| source.name == format!("{module}.rs") || source.name.starts_with(&format!("{module}/")))
    });
    assert!(!sources.is_empty(), "no sources in {}", src.display());
    sources
}

/// Returns the sources of the modules of `abbe-transport` in [`HOT`].
fn hot_sources() -> Vec<Source> {
    let mut sources = sources(&root().join("crates/abbe-transport/src"));
    sources.retain(|source| HOT.iter().any(|folder| source.name.starts_with(folder)));
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

/// Returns all paths in the code that start with one of the names, as lists of names. A group in
/// braces gives one path for each of its parts.
fn paths(code: &str, starts: &BTreeSet<String>) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let mut rest = code;
    let mut before = ' ';
    while let Some(first) = rest.chars().next() {
        let name: String = rest.chars().take_while(|&c| is_name(c)).collect();
        if name.is_empty() {
            before = first;
            rest = &rest[first.len_utf8()..];
            continue;
        }
        let tail = &rest[name.len()..];
        if starts.contains(&name) && tail.starts_with("::") && !matches!(before, ':' | '.' | '$') {
            path_parts(&tail[2..], std::slice::from_ref(&name), &mut found);
        }
        before = name.chars().next_back().unwrap_or(' ');
        rest = tail;
    }
    found
}

/// Adds the paths that continue `start` to a list.
fn path_parts(text: &str, start: &[String], found: &mut Vec<Vec<String>>) {
    let text = text.trim_start();
    if let Some(group) = text.strip_prefix('{') {
        let (mut depth, mut begin) = (0, 0);
        for (i, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                ',' | '}' if depth == 0 => {
                    path_parts(&group[begin..i], start, found);
                    begin = i + 1;
                    if c == '}' {
                        return;
                    }
                }
                '}' => depth -= 1,
                _ => {}
            }
        }
        return;
    }
    let name: String = text.chars().take_while(|&c| is_name(c)).collect();
    if name.is_empty() {
        found.push(start.to_vec());
        return;
    }
    let path = [start, std::slice::from_ref(&name)].concat();
    match text[name.len()..].strip_prefix("::") {
        Some(rest) => path_parts(rest, &path, found),
        None => found.push(path),
    }
}

/// The modules of a library by their paths, and the paths that each of them names.
struct Modules(BTreeMap<Vec<String>, Vec<Vec<String>>>);

impl Modules {
    fn of(sources: Vec<Source>) -> Self {
        let modules: BTreeSet<Vec<String>> = sources.iter().map(Source::module).collect();
        let named = |source: &Source| {
            let module = source.module();
            let below = modules.iter().filter(|path| path.len() == module.len() + 1 && path.starts_with(&module));
            let own = ["crate", "super", "self"].map(str::to_string);
            paths(&source.code, &below.map(|path| path[module.len()].clone()).chain(own).collect())
        };
        Self(sources.iter().map(|source| (source.module(), named(source))).collect())
    }

    /// Returns the module that defines what a path in `module` names. Re-exports are followed.
    fn defining(&self, module: &[String], path: &[String], hops: usize) -> Option<Vec<String>> {
        let mut place = module.to_vec();
        let mut rest = path;
        match rest.first().map(String::as_str) {
            Some("crate") => (place, rest) = (Vec::new(), &rest[1..]),
            Some("self") => rest = &rest[1..],
            Some("super") => {}
            _ => {}
        }
        while let Some(name) = rest.first() {
            if name == "super" {
                place.pop()?;
            } else if self.0.contains_key(&[&place[..], std::slice::from_ref(name)].concat()) {
                place.push(name.clone());
            } else {
                break;
            }
            rest = &rest[1..];
        }
        if let Some(name) = rest.first().filter(|_| hops > 0 && place != module) {
            for exported in self.0[&place].iter().filter(|path| path.last() == Some(name)) {
                if let Some(found) = self.defining(&place, exported, hops - 1).filter(|found| *found != place) {
                    return Some(found);
                }
            }
        }
        Some(place)
    }

    /// Returns the modules that each module imports. A child may use what the modules around it
    /// define, and these may dispatch to the child, so imports from above do not count.
    fn imports(&self) -> BTreeMap<&Vec<String>, BTreeSet<Vec<String>>> {
        let of = |module: &Vec<String>, paths: &[Vec<String>]| {
            let found = paths.iter().filter_map(|path| self.defining(module, path, 4));
            found.filter(|found| !module.starts_with(found)).collect()
        };
        self.0.iter().map(|(module, paths)| (module, of(module, paths))).collect()
    }
}

/// Returns the circles of a graph: sets of nodes from each of which all others can be reached.
fn circles(imports: &BTreeMap<&Vec<String>, BTreeSet<Vec<String>>>) -> Vec<Vec<String>> {
    let reached = |from: &Vec<String>| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(module) = open.pop() {
            for next in imports.get(&module).into_iter().flatten() {
                if seen.insert(next.clone()) {
                    open.push(next.clone());
                }
            }
        }
        seen
    };
    let all: BTreeMap<&Vec<String>, BTreeSet<Vec<String>>> =
        imports.keys().map(|&from| (from, reached(from))).collect();
    let mut found: BTreeSet<Vec<String>> = BTreeSet::new();
    for (from, to) in all.iter().filter(|(from, to)| to.contains(**from)) {
        let circle = to.iter().filter(|module| all[*module].contains(*from));
        found.insert(circle.map(|module| module.join("::")).collect());
    }
    found.into_iter().collect()
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let mut faults = Vec::new();
    for library in libraries() {
        for circle in circles(&Modules::of(sources(&library)).imports()) {
            if !circle.iter().all(|module| module.starts_with(NATURAL)) {
                faults.push(format!("{}: {}", library.display(), circle.join(", ")));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn transport_knows_light_by_wavelength_only() {
    for source in hot_sources() {
        assert!(!source.code.contains("abbe_spectra::colour"), "{} imports colour", source.name);
    }
}

#[test]
fn inner_loops_have_no_virtual_calls_locks_or_hash_maps() {
    // Light beyond a stated depth reaches its sink by a virtual call. Other light never does.
    let cold = "walk/depth_limit.rs";
    for source in hot_sources().iter().filter(|source| source.name != cold) {
        let mut words = source.code.split(|c| !is_name(c));
        let banned =
            words.find(|word| matches!(*word, "dyn" | "Mutex" | "RwLock" | "HashMap" | "BTreeMap" | "Rc" | "Arc"));
        assert_eq!(banned, None, "{}", source.name);
    }
}

#[test]
fn nothing_is_unsafe_and_no_macro_is_defined() {
    let packages = libraries().into_iter().filter_map(|src| src.parent().map(Path::to_owned));
    for package in packages {
        assert!(!package.join("build.rs").exists(), "{}: no package needs a build script", package.display());
    }
    for folder in FOLDERS {
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
    for folder in FOLDERS {
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
    let starts = ["crate", "super"].map(str::to_string).into();
    let found: Vec<String> = paths(&code, &starts).iter().map(|path| path.join("::")).collect();
    assert_eq!(
        found,
        ["crate::math::self", "crate::math::sum", "crate::optics", "crate::scene::x", "super::super::walk::y"]
    );
}

#[test]
fn circles_are_found_through_re_exports() {
    let found = |parent: &str, b: &str, c: &str| {
        let files = [("lib.rs", ""), ("a/mod.rs", parent), ("a/b.rs", b), ("a/c.rs", c)];
        let source = |(name, code): (&str, &str)| Source { name: name.to_string(), code: code.to_string() };
        circles(&Modules::of(files.map(source).into()).imports())
    };
    let dispatch = "mod b; mod c; use b::f; pub use c::C; pub struct A;";
    assert!(found(dispatch, "use super::{A, C};", "use super::A;").is_empty());
    assert_eq!(found(dispatch, "use super::C;", "use super::b::B;"), [["a::b", "a::c"]]);
}
