//! The links of the documentation.

use std::path::{Path, PathBuf};

fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
}

/// Returns the anchors of the headings of a page, as GitHub and mdBook make them.
fn anchors(text: &str) -> Vec<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        let words = heading.trim_start_matches('#').trim().to_lowercase();
        words
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect()
    };
    headings.map(anchor).collect()
}

/// Returns the targets of the links and pictures of a page, outside of code.
fn targets(text: &str) -> Vec<String> {
    let mut is_code = false;
    let prose = text.lines().filter(|line| {
        is_code ^= line.starts_with("```");
        !is_code
    });
    let prose: String = prose.map(|line| format!("{line}\n")).collect();
    let ends = prose.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    ends.map(|target| target.split_whitespace().next().unwrap_or("").to_string()).collect()
}

/// Each relative link leads to a file, and each fragment to a heading.
#[test]
fn the_links_of_the_documentation_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found: Vec<PathBuf> = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root.join(name)).to_vec();
    for folder in ["docs", "benches", "scenes", "python", "blender"] {
        pages(&root.join(folder), &mut found);
    }
    let (mut links, mut broken) = (0, Vec::new());
    for page in &found {
        let text = std::fs::read_to_string(page).unwrap();
        for target in targets(&text).iter().filter(|target| !target.contains("://") && !target.starts_with("mailto:")) {
            links += 1;
            let (path, fragment) = target.split_once('#').unwrap_or((target, ""));
            let file = if path.is_empty() { page.clone() } else { page.parent().unwrap().join(path) };
            let is_sound = file.exists()
                && (fragment.is_empty()
                    || file.extension().is_none_or(|extension| extension != "md")
                    || anchors(&std::fs::read_to_string(&file).unwrap()).iter().any(|anchor| anchor == fragment));
            if !is_sound {
                broken.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(links > 200, "{links} links");
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}
