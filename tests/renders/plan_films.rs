//! The effect `thin-films`: on if a surface has films, off otherwise, and without events if it is
//! forbidden.

use super::common::{job, render_job};
use abbe_session::render::Integrator;
use serde_json::{Value, json};

/// A ball on a floor. `coating` is added to its material.
fn ball(coating: Option<&Value>, forbid: &[&str]) -> Value {
    let mut glass = json!({ "ior": 1.5 });
    if let Some(coating) = coating {
        glass["coating"] = coating.clone();
    }
    json!({
        "camera": { "from": [0, 2, 5], "at": [0, 0.6, 0], "lens": { "pinhole": { "fov": 32 } } },
        "film": { "width": 16, "height": 16 },
        "materials": { "glass": { "dielectric": glass }, "grey": { "diffuse": { "reflectance": 0.5 } } },
        "objects": [
            { "shape": { "sphere": { "radius": 0.6, "center": [0, 0.61, 0] } }, "material": "glass" },
            { "shape": { "rectangle": { "width": 8, "height": 8 } }, "material": "grey" }
        ],
        "lights": [{ "point": { "at": [1, 4, 2], "spectrum": "D65", "luminous_flux": 800 } }],
        "render": { "photons": 2000, "forbid": forbid }
    })
}

#[test]
fn films_are_planned_only_where_they_are() {
    let coating = json!({ "layers": [{ "ior": 2.0, "thickness_nm": 70 }] });
    let rendered = |scene: &Value| render_job(&job(scene), Integrator::Photon, 2);
    let films = |scene: &Value| {
        let found = rendered(scene).stats.effects["thin-films"].clone();
        (found.state, found.events)
    };
    let (state, events) = films(&ball(Some(&coating), &[]));
    assert!(state == "on" && events > 0, "{state}, {events} events");
    assert_eq!(films(&ball(None, &[])).1, 0);
    assert_eq!(films(&ball(Some(&coating), &["thin-films"])).1, 0);
    let (bare, forbidden) = (rendered(&ball(None, &[])), rendered(&ball(Some(&coating), &["thin-films"])));
    assert_eq!(bare.picture.xyz, forbidden.picture.xyz, "without its films, the glass is bare");
}
