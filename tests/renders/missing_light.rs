//! Pictures that lack light which the path tracer cannot find.

use crate::common::{diffuse, glass, job, render, with_setting};
use abbe_format::{self as format, resolve};
use abbe_session::render::{Integrator, Job};
use serde_json::{Value, json};
use std::path::Path;

/// A lamp and a wide, dim panel above a glass plate above a floor. Paths find the panel by chance,
/// and a large lamp too.
fn below_glass(lamp_radius: f64) -> Value {
    json!({
        "camera": { "from": [0, 1, 3], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "grey": diffuse(0.5), "glass": glass(1.5), "black": "absorber" },
        "objects": [
            { "name": "floor", "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "grey" },
            { "name": "plate", "shape": { "box": { "size": [4, 0.1, 4] } }, "material": "glass",
              "transform": [{ "translate": [0, 2, 0] }] },
            { "name": "lamp", "shape": { "disk": { "radius": lamp_radius } }, "material": "black",
              "emission": { "spectrum": "E", "luminance": 10 },
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 3, 0] }] },
            { "name": "panel", "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "black",
              "emission": { "spectrum": "E", "luminance": 1 },
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 3.1, 0] }] }
        ],
        "render": { "photons": 1000 }
    })
}

/// A picture of paths that find a lamp seldom has an unknown bias and a warning; one of photons, or
/// below a large lamp, has none.
#[test]
fn the_bias_is_unknown_where_paths_miss_light() {
    for (radius, integrator, misses) in
        [(0.01, Integrator::Path, true), (0.01, Integrator::Photon, false), (1.5, Integrator::Path, false)]
    {
        let rendered = render(&below_glass(radius), integrator, 8);
        let (picture, stats) = (&rendered.picture, &rendered.stats);
        let unknown = picture.bias.iter().all(Option::is_none);
        assert_eq!(unknown, misses, "{radius} {integrator:?}");
        assert_eq!((0..64).all(|pixel| picture.error(pixel).is_none()), misses, "{radius} {integrator:?}");
        assert_eq!(stats.warnings.len(), usize::from(misses), "{:?}", stats.warnings);
        assert_eq!((stats.error.typical.is_none(), stats.forecast.is_none() || !misses), (misses, true));
        assert_eq!(stats.unfound_lights, if misses { vec!["lamp"] } else { vec![] });
        assert!(stats.warnings.iter().all(|warning| stats.notes.contains(warning)));
    }
    // The path tracer has no photons that could be left out, and finds some of this light.
    let forbidden = with_setting(&below_glass(0.01), "forbid", json!(["caustics"]));
    assert_eq!(render(&forbidden, Integrator::Path, 8).stats.unfound_lights, ["lamp"]);
}

/// Photons store the number of their medium in 16 bits.
#[test]
fn more_media_than_their_numbers_are_an_error() {
    let mut scene = below_glass(0.5);
    scene["media"] = json!({ "fog": { "homogeneous": { "absorption": 0, "scattering": 1, "phase": "isotropic" } } });
    scene["materials"]["fog"] = json!({ "boundary": { "medium": "fog" } });
    scene["objects"][1]["material"] = json!("fog");
    assert_eq!(job(&scene).scene.media.len(), 1);
    let (file, source) = format::parse(scene.to_string(), Path::new("tests/inline.json"), &[]).unwrap();
    let mut resolved = resolve::resolve(&file, &source).unwrap();
    resolved.media = vec![resolved.media[0].clone(); 65_537];
    let error = Job::new(resolved).unwrap_err().to_string();
    assert!(error.contains("65537 media") && error.contains("at most 65536"), "{error}");
}
