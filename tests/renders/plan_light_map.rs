//! Light maps are planned where they are exact and save time, and wherever they are forced.

use super::common::{diffuse, glass, job, with_setting};
use super::plan_negligible::is;
use abbe_transport::plan::EffectState;
use serde_json::{Value, json};

/// A box of haze with this optical depth across it, with a floor and a light inside.
fn haze(depth: f64) -> Value {
    json!({
        "camera": { "from": [0, 1, 1.9], "at": [0, 1, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 8, "height": 8 },
        "media": { "haze": { "homogeneous": { "absorption": 0, "scattering": 0.5 * depth, "phase": "isotropic" } } },
        "materials": { "haze": { "boundary": { "medium": "haze" } }, "grey": diffuse(0.5), "glass": glass(1.5) },
        "objects": [
            { "name": "haze", "shape": { "box": { "size": [4, 2, 4] } }, "material": "haze", "transform": [{ "translate": [0, 1, 0] }] },
            { "name": "floor", "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "grey" }
        ],
        "lights": [{ "point": { "at": [0.3, 1.5, 0.2], "spectrum": "E", "luminous_intensity": 1 } }]
    })
}

#[test]
fn light_maps_are_planned_for_thin_even_haze_only() {
    let thin = haze(0.3);
    is(&thin, "light-map", EffectState::On, "haze");
    is(&haze(0.6), "light-map", EffectState::Off, "sampled distances");
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut scene = thin.clone();
        change(&mut scene);
        is(&scene, "light-map", EffectState::Off, "sampled distances");
    };
    changed(&|scene| scene["lights"][0]["point"]["at"] = json!([0.3, 2.5, 0.2]));
    changed(&|scene| scene["objects"][1]["material"] = json!("glass"));
    changed(&|scene| scene["objects"][1]["emission"] = json!({ "spectrum": "E", "luminance": 1 }));
    changed(&|scene| {
        scene["objects"][1]["motion"] =
            json!([{ "time": 0, "transform": [] }, { "time": 1, "transform": [{ "translate": [0, 0.1, 0] }] }]);
        scene["camera"]["shutter"] = json!({ "open": 0, "close": 1 });
    });
    changed(&|scene| {
        scene["media"]["haze"] = json!({ "grid": { "bounds": [[-2, 0, -2], [2, 2, 2]], "density": { "constant": 1 },
            "absorption": 0, "scattering": 0.15, "phase": "isotropic" } });
    });
}

#[test]
fn forced_light_maps_are_built_and_budgeted() {
    let thick = haze(3.0);
    let stated = with_setting(&thick, "light_map", json!({ "resolution": 64 }));
    is(&stated, "light-map", EffectState::On, "`render.light_map` of 64 cells");
    is(&with_setting(&thick, "force", json!(["light-map"])), "light-map", EffectState::Forced, "forced by name");
    is(&with_setting(&haze(0.3), "forbid", json!(["light-map"])), "light-map", EffectState::Forbidden, "haze");
    let bytes = |scene: &Value| job(&with_setting(scene, "passes", json!(1))).budget.memory_bytes;
    let map = bytes(&stated) - bytes(&thick);
    // A node has a byte and a float, and needs less than two more floats while the map is built.
    let nodes = 65 * 65 * 65;
    assert!((5 * nodes..12 * nodes).contains(&map), "{map} bytes for {nodes} nodes");
}
