//! The effect `polarisation`: on for filters, for the layer `stokes` and for oblique faces in a row,
//! and off otherwise.

use super::common::{job, render_job};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};

/// A glass slab before a lamp, seen at an angle of incidence in degrees.
fn slab(degrees: f64) -> Value {
    let (sin, cos) = degrees.to_radians().sin_cos();
    json!({
        "camera": { "from": [0, 4.0 * cos, 4.0 * sin], "at": [0, 0, 0], "up": [0, sin, -cos],
                    "lens": { "orthographic": { "height": 0.1 } } },
        "film": { "width": 4, "height": 4 },
        "materials": { "glass": { "dielectric": { "ior": 1.5 } }, "lamp": "absorber" },
        "objects": [
            { "shape": { "box": { "size": [200, 0.01, 200] } }, "material": "glass" },
            { "shape": { "rectangle": { "width": 400, "height": 400 } }, "material": "lamp",
              "transform": [{ "translate": [0, -1, 0] }], "emission": { "spectrum": "E", "luminance": 100 } }
        ],
        "render": { "photons": 100 }
    })
}

fn rendered(scene: &Value) -> Rendered {
    render_job(&job(scene), Integrator::Photon, 2)
}

/// Returns the state, the number of events, and the reason.
fn polarisation(scene: &Value) -> (String, u64, String) {
    let job = job(scene);
    let row = job.rows.iter().find(|row| row.effect.name == "polarisation").unwrap();
    let events = render_job(&job, Integrator::Photon, 2).stats.effects["polarisation"].events;
    (row.state.word().to_string(), events, row.because.clone())
}

/// Two faces of glass at an oblique angle change the light by more than 1 %.
#[test]
fn oblique_slabs_need_polarisation_and_windows_do_not() {
    for (degrees, known) in
        [(0.0, "off"), (20.0, "off"), (40.0, "off"), (60.0, "on"), (70.0, "on"), (80.0, "on"), (85.0, "on")]
    {
        let (state, events, because) = polarisation(&slab(degrees));
        println!("{degrees}°: {state}, {events} events, {because}");
        assert_eq!(state, known, "{degrees}°: {because}");
        assert_eq!(events > 0, state == "on", "{degrees}°");
        assert!(because.contains("oblique faces in a row") || degrees == 0.0, "{because}");
    }
}

#[test]
fn filters_and_stokes_layers_need_polarisation() {
    let window = slab(0.0);
    let mut with_filter = window.clone();
    with_filter["camera"]["filter"] = json!({ "polariser": { "axis": 90 } });
    let mut with_layer = window.clone();
    with_layer["film"]["stokes"] = json!(true);
    for scene in [&with_filter, &with_layer] {
        let (state, events, _) = polarisation(scene);
        assert!(state == "on" && events > 0, "{state}, {events} events");
        let mut forbidden = scene.clone();
        forbidden["render"]["forbid"] = json!(["polarisation"]);
        let (state, events, _) = polarisation(&forbidden);
        assert!(state == "forbidden" && events == 0, "{state}, {events} events");
        let (plain, forbidden) = (rendered(&window), rendered(&forbidden));
        assert_eq!(plain.picture.xyz, forbidden.picture.xyz, "without filters, the picture is the plain one");
        assert!(forbidden.picture.layers.channels.is_empty());
    }
}
