//! The parts of a scene's text that affect its passes, and the first difference of two scenes.

use serde_json::Value;

/// The keys, by section, that do not change a pass: the length of a render, its threads and
/// checkpoints, and the display of the picture.
const KEYS_WITHOUT_EFFECT_ON_A_PASS: [(&str, &[&str]); 2] = [
    ("render", &["passes", "threads", "checkpoint_seconds"]),
    ("film", &["exposure", "white_balance", "output_space", "tone", "gamut", "bloom", "denoise"]),
];

const LONGEST_VALUE: usize = 60;

/// Returns whether an entry of a section of a scene can change the result of a pass.
#[must_use]
pub fn affects_passes(section: &str, key: &str) -> bool {
    !KEYS_WITHOUT_EFFECT_ON_A_PASS.iter().any(|(of, keys)| *of == section && keys.contains(&key))
}

/// Returns a scene without the keys that do not change the result of a pass.
fn scene_of_passes(scene: &Value) -> Value {
    let mut scene = scene.clone();
    for (section, entries) in scene.as_object_mut().into_iter().flatten() {
        if let Value::Object(entries) = entries {
            entries.retain(|key, _| affects_passes(section, key));
        }
    }
    scene
}

/// Finds the first difference of two scenes that affects their passes. Returns the path with the
/// value in each scene, such as `film.width is 64`.
pub(super) fn first_difference(found: &Value, expected: &Value) -> Option<[String; 2]> {
    difference(String::new(), Some(&scene_of_passes(found)), Some(&scene_of_passes(expected)))
}

fn difference(path: String, found: Option<&Value>, expected: Option<&Value>) -> Option<[String; 2]> {
    match (found, expected) {
        (Some(Value::Object(a)), Some(Value::Object(b))) => {
            let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            let step = |key: &String| if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            keys.into_iter().find_map(|key| difference(step(key), a.get(key), b.get(key)))
        }
        (Some(Value::Array(a)), Some(Value::Array(b))) => {
            (0..a.len().max(b.len())).find_map(|i| difference(format!("{path}[{i}]"), a.get(i), b.get(i)))
        }
        (found, expected) if found == expected => None,
        (found, expected) => Some([found, expected].map(|value| statement(&path, value))),
    }
}

/// Says which value the path has.
fn statement(path: &str, value: Option<&Value>) -> String {
    let Some(value) = value else { return format!("{path} is absent") };
    let text = value.to_string();
    let shown: String = text.chars().take(LONGEST_VALUE).collect();
    let more = if shown.len() < text.len() { "…" } else { "" };
    format!("{path} is {shown}{more}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_first_difference_is_named() {
        let scene = json!({"objects": [{"material": "glass"}, {"material": "grey"}], "render": {"seed": 1}});
        let other = |change: &dyn Fn(&mut Value)| {
            let mut other = scene.clone();
            change(&mut other);
            first_difference(&scene, &other).unwrap()
        };
        assert_eq!(first_difference(&scene, &scene), None);
        assert_eq!(
            other(&|scene| scene["objects"][1]["material"] = json!("crown")),
            [r#"objects[1].material is "grey""#, r#"objects[1].material is "crown""#]
        );
        assert_eq!(
            other(&|scene| scene["camera"] = json!({"at": [0, 0, 0]})),
            ["camera is absent", r#"camera is {"at":[0,0,0]}"#]
        );
        let long = other(&|scene| scene["render"] = json!("x".repeat(100)));
        assert!(long[1].ends_with('…') && long[1].len() < 90, "{long:?}");
    }

    #[test]
    fn development_and_length_do_not_change_a_scene() {
        let a = json!({"film": {"width": 8, "exposure": "auto"}, "render": {"passes": 4, "seed": 2}});
        let b =
            json!({"film": {"width": 8, "exposure": {"ev": 1}, "tone": "clip"}, "render": {"passes": 9, "seed": 2}});
        assert_eq!(first_difference(&a, &b), None);
        assert_eq!(scene_of_passes(&a), scene_of_passes(&b));
    }
}
