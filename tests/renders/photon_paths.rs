//! Photon paths with their vertices, for drawings.

use super::common::{example_job, job};
use abbe_session::render::{Job, PathQuery, PhotonPaths, PointUnder};
use abbe_spectra::math::sphere::BoundingSphere;
use glam::{DVec2, DVec3};
use serde_json::json;

const QUERY: PathQuery = PathQuery { light: None, count: 100, target: None, most_traced: 1 << 18 };

fn paths_to(job: &Job, film: DVec2, light: Option<usize>) -> (DVec3, f64, PhotonPaths) {
    let PointUnder { position: centre, pixel_width_m: width_m, .. } = job.point_under(film).unwrap();
    let radius_m = 4.0 * width_m;
    let target = Some(BoundingSphere { centre, radius_m });
    (centre, radius_m, job.photon_paths(&PathQuery { light, target, ..QUERY }))
}

/// A photon enters the prism with four wavelengths and leaves it with one.
#[test]
fn paths_lose_wavelengths_in_a_prism() {
    let job = example_job("prism", &[]);
    let found = job.photon_paths(&QUERY);
    assert_eq!((found.paths.len(), found.traced), (100, 100));
    assert_eq!(found, job.photon_paths(&QUERY), "the same query returns the same paths");
    let mut dispersed = 0;
    for path in &found.paths {
        let counts: Vec<usize> = path.segments.iter().map(|segment| segment.wavelengths.count).collect();
        assert_eq!(counts[0], 4);
        assert!(counts.windows(2).all(|pair| pair[1] <= pair[0]), "{counts:?}");
        dispersed += usize::from(counts.last() == Some(&1));
    }
    assert!(dispersed > 20, "{dispersed}");
}

/// Only paths of the wanted light that end at the wanted point are returned.
#[test]
fn paths_reach_a_point_from_a_light() {
    let job = job(&json!({
        "camera": {"from": [0, 3, 6], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
        "film": {"width": 64, "height": 48},
        "materials": {"grey": {"diffuse": {"reflectance": 0.5}}},
        "objects": [{"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"}],
        "lights": [
            {"point": {"at": [-1, 2, 0], "spectrum": "D65", "power": 10}},
            {"point": {"at": [1, 2, 0], "spectrum": "A", "power": 10}}]
    }));
    let middle = DVec2::new(32.0, 24.0);
    for (light, x) in [(0, -1.0), (1, 1.0)] {
        let (centre, radius_m, found) = paths_to(&job, middle, Some(light));
        assert_eq!(found.paths.len(), 100, "{} photons", found.traced);
        for path in &found.paths {
            assert!((path.origin + job.scene.centre).distance(DVec3::new(x, 2.0, 0.0)) < 1e-6);
            assert!(path.segments.last().unwrap().end.distance(centre) <= radius_m);
        }
    }
    // Both lights are equally strong and equally far away.
    let (_, _, all) = paths_to(&job, middle, None);
    let left = all.paths.iter().filter(|path| (path.origin + job.scene.centre).x < 0.0).count();
    assert!((25..=75).contains(&left), "{left}");
    assert!(job.photon_paths(&PathQuery { light: Some(2), ..QUERY }).paths.is_empty());
}

/// Opaque surfaces hide lines. Glass does not.
#[test]
fn opaque_surfaces_hide_lines() {
    let scene = |material: &str| {
        job(&json!({
            "camera": {"from": [0, 0, 10], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
            "film": {"width": 100, "height": 100},
            "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": 1.5}}},
            "objects": [{"name": "ball", "shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "material": material}],
            "lights": [{"point": {"at": [0, 4, 5], "spectrum": "D65", "power": 10}}]
        }))
    };
    let parts = |material: &str, z: f64| {
        let job = scene(material);
        let [from, to] = [-3.0, 3.0].map(|x| DVec3::new(x, 0.0, z) - job.scene.centre);
        let mut parts = job.visible_parts(from, to);
        parts.sort_by(|a, b| a[0].x.total_cmp(&b[0].x));
        parts
    };
    let length = |parts: &[[DVec2; 2]]| parts.iter().map(|[a, b]| a.distance(*b)).sum::<f64>();
    let (front, glass, hidden) = (parts("grey", 2.0), parts("glass", -2.0), parts("grey", -2.0));
    assert_eq!((front.len(), glass.len(), hidden.len()), (1, 1, 2));
    // From a distance of 10, the outline of the ball has the slope 1/√99.
    let known = 2.0 * (3.0 / 12.0 - 1.0 / 99.0_f64.sqrt()) / (2.0 * 20.0_f64.to_radians().tan()) * 100.0;
    assert!((length(&hidden) - known).abs() < 4.0, "{} instead of {known}", length(&hidden));
    // A line that passes the camera ends before it.
    let job = scene("grey");
    let behind = job.visible_parts(DVec3::new(0.1, 0.0, 5.0), DVec3::new(0.1, 0.0, 30.0));
    assert_eq!(behind.len(), 1);
    assert!(behind[0].iter().all(|end| end.is_finite()), "{behind:?}");
}
