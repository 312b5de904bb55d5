//! The layers of a picture: the light of path classes and of light groups sums to the picture, the
//! layers do not change the picture, and the layers of first surfaces have known values.

use super::common::compare::{Measured, compare};
use super::common::{block_means, channel, job_with, render_job};
use abbe_session::render::{Integrator, Rendered};
use abbe_spectra::colour::xyz_to_linear_srgb;
use abbe_transport::sensor::Picture;
use abbe_transport::sensor::cryptomatte::{hash_name, normal_hash};

/// Glass, dispersive glass, a mirror, coated paint, fog, a flame, a sky, and several other lights.
/// Three lights have the same spectrum, and two of them have the same group.
const EVERYTHING: &str = r#"{
  "camera": {"from": [0, 3, 7], "at": [0, 0.8, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 24, "height": 20},
  "media": {
    "fog": {"homogeneous": {"absorption": 0.01, "scattering": 0.1, "phase": {"henyey_greenstein": {"g": 0.3}}}},
    "flame": {"homogeneous": {"absorption": 1, "scattering": 0, "phase": "isotropic", "emission": {"spectrum": "neon-glow", "power": 2}}}},
  "materials": {
    "grey": {"diffuse": {"reflectance": 0.6}},
    "red": {"diffuse": {"reflectance": {"rgb": [0.7, 0.1, 0.1]}}},
    "flint": {"dielectric": {"ior": "N-SF10"}},
    "crown": {"dielectric": {"ior": 1.5}},
    "gold": {"conductor": {"metal": "gold", "roughness": 0.5}},
    "paint": {"glossy": {"reflectance": {"rgb": [0.2, 0.4, 0.7]}, "ior": 1.5, "roughness": 0.3}},
    "mirror": {"mirror": {"reflectance": 0.9}},
    "fog": {"boundary": {"medium": "fog"}},
    "flame": {"boundary": {"medium": "flame"}},
    "black": "absorber"},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 12, "height": 12}}, "material": "grey"},
    {"name": "flint ball", "shape": {"sphere": {"center": [-2.4, 0.61, 0], "radius": 0.6}}, "material": "flint"},
    {"name": "crown ball", "shape": {"sphere": {"center": [-1.2, 0.61, 0.4], "radius": 0.6}}, "material": "crown"},
    {"name": "red ball", "shape": {"sphere": {"center": [0, 0.61, 0], "radius": 0.6}}, "material": "red"},
    {"name": "gold ball", "shape": {"sphere": {"center": [1.3, 0.61, 0], "radius": 0.6}}, "material": "gold"},
    {"name": "paint ball", "shape": {"sphere": {"center": [2.5, 0.61, 0.3], "radius": 0.6}}, "material": "paint"},
    {"name": "mirror", "shape": {"box": {"size": [3, 2, 0.2]}}, "material": "mirror", "transform": [{"translate": [0, 1, -1.5]}]},
    {"name": "cloud", "shape": {"box": {"size": [3, 1.5, 2]}}, "material": "fog", "transform": [{"translate": [1, 0.9, 1.5]}]},
    {"name": "tube", "shape": {"box": {"size": [0.2, 0.6, 0.2]}}, "material": "flame", "transform": [{"translate": [-2, 0.4, 1.5]}]},
    {"name": "panel", "shape": {"rectangle": {"width": 0.8, "height": 0.8}}, "material": "black",
     "emission": {"spectrum": "A", "luminous_flux": 2000, "group": "ceiling"},
     "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 180}}, {"translate": [0.5, 4, 1]}]},
    {"name": "bulb", "shape": {"sphere": {"center": [-0.9, 1.2, 2], "radius": 0.1}}, "material": "black",
     "emission": {"spectrum": "D65", "luminous_flux": 300}}],
  "lights": [
    {"point": {"at": [-2, 3, 2], "spectrum": "A", "power": 5, "group": "ceiling"}},
    {"point": {"at": [2, 3, 2], "spectrum": "A", "power": 5}},
    {"directional": {"toward": [0.3, -1, -0.4], "angular_diameter": 3, "spectrum": "D65", "illuminance": 50, "group": "the sun"}},
    {"environment": {"spectrum": "D65", "illuminance": 20}}],
  "render": {"photons": 6000}}"#;

const GROUPS: [&str; 6] = ["ceiling", "point_1", "the_sun", "environment_3", "bulb", "medium_flame"];

const CLASSES: [&str; 5] = ["emission", "direct", "caustic", "indirect", "volume"];

/// Renders the scene with these layers.
fn everything(integrator: Integrator, passes: u64, layers: &str, sets: &[&str]) -> Rendered {
    let layers = format!("film.layers=[{layers}]");
    let sets: Vec<&str> = [layers.as_str()].iter().chain(sets).copied().collect();
    render_job(&job_with(EVERYTHING, &sets), integrator, passes)
}

/// Returns the red, green and blue of a layer.
fn colours(picture: &Picture, layer: &str) -> Vec<[f64; 3]> {
    let [red, green, blue] = ["R", "G", "B"].map(|colour| channel(picture, &format!("{layer}.{colour}")));
    (0..red.len()).map(|pixel| [red, green, blue].map(|component| f64::from(component[pixel]))).collect()
}

/// Returns Y of a layer.
fn luminance(picture: &Picture, layer: &str) -> Vec<f64> {
    colours(picture, layer).into_iter().map(|rgb| abbe_spectra::colour::linear_srgb_to_xyz(rgb)[1]).collect()
}

/// Checks that the layers sum to the picture, and that each layer has light.
#[track_caller]
fn assert_sums_to_picture(picture: &Picture, kind: &str, names: &[&str]) {
    let layers: Vec<_> = names.iter().map(|name| colours(picture, &format!("{kind}.{name}"))).collect();
    for (name, layer) in names.iter().zip(&layers) {
        assert!(layer.iter().any(|rgb| rgb[1] > 0.0), "{kind}.{name} is black");
    }
    let mut lit = 0;
    for (pixel, xyz) in picture.xyz.iter().enumerate() {
        let expected = xyz_to_linear_srgb(*xyz);
        let sum: [f64; 3] = std::array::from_fn(|c| layers.iter().map(|layer| layer[pixel][c]).sum());
        let scale = expected.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
        (0..3).for_each(|c| assert!((sum[c] - expected[c]).abs() <= 1e-6 * scale, "{kind}: {sum:?}, {expected:?}"));
        lit += usize::from(scale > 0.0);
    }
    assert!(2 * lit > picture.xyz.len(), "most pixels are lit");
    let count = picture.layers.channels.iter().filter(|channel| channel.name.starts_with(kind)).count();
    assert_eq!(count, 3 * names.len(), "the test knows all layers of {kind}");
}

#[test]
fn path_classes_and_light_groups_sum_to_the_picture() {
    for (integrator, passes) in [(Integrator::Photon, 3), (Integrator::Path, 8)] {
        let picture = everything(integrator, passes, r#""paths", "lights""#, &[]).picture;
        assert_sums_to_picture(&picture, "path", &CLASSES);
        assert_sums_to_picture(&picture, "light", &GROUPS);
    }
}

/// The sums are exact with several camera samples per pass, a depth limit, spectral bands and a
/// lens.
#[test]
fn layers_sum_to_the_picture_under_all_settings() {
    for sets in [
        &["render.camera_samples=3"][..],
        &["render.max_depth=4"],
        &["film.spectral_bands=4"],
        &["camera.lens={\"thin\": {\"fov\": 40, \"focus_distance\": 7, \"defocus_angle\": 2}}"],
    ] {
        let picture = everything(Integrator::Photon, 2, r#""paths", "lights""#, sets).picture;
        assert_sums_to_picture(&picture, "path", &CLASSES);
        assert_sums_to_picture(&picture, "light", &GROUPS);
    }
}

const ALL: &str = r#""albedo", "normal", "depth", "object", "material", "uv", "samples", "paths", "lights""#;

#[test]
fn layers_do_not_change_the_bits_of_the_picture() {
    for integrator in [Integrator::Photon, Integrator::Path] {
        let with = everything(integrator, 3, ALL, &[]).picture;
        let without = everything(integrator, 3, "", &[]).picture;
        assert!(without.layers.channels.is_empty());
        assert_eq!((&with.xyz, &with.noise, &with.bias), (&without.xyz, &without.noise, &without.bias));
        assert_eq!(with.edge, without.edge);
    }
}

#[test]
fn layers_are_the_same_bits_on_any_number_of_threads() {
    let job = job_with(EVERYTHING, &[&format!("film.layers=[{ALL}]")]);
    for integrator in [Integrator::Photon, Integrator::Path] {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render_job(&job, integrator, 2)).picture.layers
        };
        let reference = on(1);
        assert!(on(3) == reference, "{integrator:?}");
    }
}

/// Both integrators assign the same light to each path class and to each light group.
#[test]
#[ignore = "slow: 37 seconds of CPU time"]
fn photon_mapping_and_path_tracing_agree_on_the_layers() {
    const SIDE: usize = 12;
    let layers: Vec<String> = CLASSES.iter().map(|class| format!("path.{class}")).collect();
    let layers: Vec<String> = layers.into_iter().chain(GROUPS.iter().map(|group| format!("light.{group}"))).collect();
    let take = |picture: &Picture, layer: &str| {
        let everything = vec![true; picture.xyz.len()];
        block_means(&luminance(picture, layer), picture.width, SIDE, &everything)
    };
    let runs = |integrator, passes, seeds: std::ops::Range<u64>, sets: &[&str]| -> Vec<Picture> {
        let run = |seed: u64| {
            let seed = format!("render.seed={seed}");
            let sets: Vec<&str> = sets.iter().copied().chain([seed.as_str()]).collect();
            everything(integrator, passes, r#""paths", "lights""#, &sets).picture
        };
        seeds.map(run).collect()
    };
    // The path tracer does not find points behind glass, so the scene has no points here. Lights
    // that are small would be too noisy. The photons are extrapolated to kernels of radius 0.
    let sets = [
        r#"lights=[{"environment": {"spectrum": "D65", "illuminance": 20}}]"#,
        r#"objects[name=bulb].shape={"sphere": {"center": [-0.9, 1.8, 2], "radius": 0.4}}"#,
        r#"objects[name=panel].shape={"rectangle": {"width": 3, "height": 3}}"#,
    ];
    let photons = |setting: [&str; 2]| runs(Integrator::Photon, 16, 0..8, &[&sets[..], &setting].concat());
    let [whole, half] =
        [["render.radius=0.2", "render.photons=20000"], ["render.radius=0.1", "render.photons=80000"]].map(photons);
    let path = runs(Integrator::Path, 1024, 100..108, &sets);
    let mut compared = 0;
    for layer in layers {
        let absent = ["light.point_1", "light.the_sun", "light.environment_3"];
        if absent.contains(&layer.as_str()) {
            continue;
        }
        let [whole, half, b] = [&whole, &half, &path]
            .map(|runs| Measured::from_runs(runs.iter().map(|picture| take(picture, &layer)).collect::<Vec<_>>()));
        let a = Measured::extrapolated(&whole, &half);
        let found = compare(&a, &b);
        println!("{layer}: {found}; errors {:.4}, {:.4}", a.relative_error(), b.relative_error());
        assert!((found.ratio - 1.0).abs() < 0.03 && found.is_equal(), "{layer}: {found}");
        compared += 1;
    }
    assert_eq!(compared, 8);
}

/// A light that is switched off in `abbe relight` leaves the light of the other groups. The picture
/// agrees with a render without this light, within the noise.
#[test]
#[ignore = "nightly: 21 seconds of CPU time"]
fn a_group_switched_off_is_a_render_without_its_lights() {
    let with = |seed: u64| {
        let picture = everything(Integrator::Photon, 12, r#""lights""#, &[&format!("render.seed={seed}")]).picture;
        let off = [abbe_session::output::relight::LightGain { group: "ceiling".to_string(), rgb: [0.0; 3] }];
        abbe_session::output::relight::relight(&picture, &off).unwrap()
    };
    let without = |seed: u64| {
        let sets = [
            r#"objects[name=panel].emission.luminous_flux=0.000001"#.to_string(),
            "lights[0].point.power=0.000001".to_string(),
            format!("render.seed={seed}"),
        ];
        everything(Integrator::Photon, 12, "", &sets.each_ref().map(String::as_str)).picture
    };
    let blocks = |picture: Picture| {
        let y: Vec<f64> = picture.xyz.iter().map(|xyz| xyz[1]).collect();
        block_means(&y, picture.width, 12, &vec![true; y.len()])
    };
    let relit = Measured::from_runs((0..6).map(|seed| blocks(with(seed))).collect());
    let rendered = Measured::from_runs((50..56).map(|seed| blocks(without(seed))).collect());
    let found = compare(&relit, &rendered);
    println!("relit against rendered: {found}");
    assert!((found.ratio - 1.0).abs() < 0.03 && found.is_equal(), "{found}");
}

/// A sphere of radius 1 at the distance 5, seen along −z, over a black background.
const SPHERE: &str = r#"{
  "unit": "cm",
  "camera": {"from": [0, 0, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 30}}},
  "film": {"width": 33, "height": 33, "layers": ["albedo", "normal", "depth", "object", "material", "uv", "samples"]},
  "materials": {"paper": {"diffuse": {"reflectance": {"rgb": [0.6, 0.3, 0.1]}}}, "grey": {"diffuse": {"reflectance": 0.4}},
    "glass": {"dielectric": {"ior": 1.5}}},
  "objects": [
    {"name": "hello", "shape": {"sphere": {"radius": 1}}, "material": "paper"},
    {"name": "wall", "shape": {"rectangle": {"width": 2, "height": 2}}, "material": "grey",
     "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 90}}, {"translate": [2.2, 0, 0]}]}],
  "lights": [{"point": {"at": [3, 3, 3], "spectrum": "E", "power": 1}}],
  "render": {"photons": 1000}}"#;

#[test]
fn first_surfaces_have_their_known_values() {
    for integrator in [Integrator::Photon, Integrator::Path] {
        let picture = render_job(&job_with(SPHERE, &[]), integrator, 5).picture;
        let middle = 16 * 33 + 16;
        assert!((f64::from(channel(&picture, "depth.Z")[middle]) - 0.04).abs() < 1e-4, "in m, not in cm");
        let normal = ["X", "Y", "Z"].map(|axis| channel(&picture, &format!("normal.{axis}"))[middle]);
        assert!(normal[2] > 0.99 && normal[0].abs() < 0.05 && normal[1].abs() < 0.05, "{normal:?}");
        let [red, green, blue] = colours(&picture, "albedo")[middle];
        assert!((red - 0.6).abs() < 3e-3 && (green - 0.3).abs() < 3e-3 && (blue - 0.1).abs() < 3e-3);
        assert!(channel(&picture, "samples").iter().all(|&samples| samples == 5.0));
        // The corner sees nothing.
        assert_eq!(channel(&picture, "depth.Z")[0], f32::INFINITY);
        assert_eq!(colours(&picture, "albedo")[0], [0.0; 3]);
        assert_eq!(channel(&picture, "CryptoObject00.G")[0], 0.0);
        let known = f32::from_bits(normal_hash(hash_name("hello")));
        assert_eq!(channel(&picture, "CryptoObject00.R")[middle].to_bits(), known.to_bits());
        assert_eq!(channel(&picture, "CryptoObject00.G")[middle], 1.0);
        let material = f32::from_bits(normal_hash(hash_name("paper")));
        assert_eq!(channel(&picture, "CryptoMaterial00.R")[middle].to_bits(), material.to_bits());
        // The albedo of grey is the same number in all colours.
        let grey = colours(&picture, "albedo").into_iter().find(|rgb| (rgb[0] - 0.4).abs() < 1e-4).unwrap();
        grey.iter().for_each(|component| assert!((component - 0.4).abs() < 1e-6, "{grey:?}"));
        let wall = (0..33 * 33).find(|&p| colours(&picture, "albedo")[p] == grey).unwrap();
        let (u, v) = (channel(&picture, "uv.U")[wall], channel(&picture, "uv.V")[wall]);
        assert!((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v));
        let depth = f64::from(channel(&picture, "depth.Z")[wall]);
        assert!(depth > 0.05 && depth < 0.06, "the wall is slanted away from the axis: {depth}");
    }
}

/// Glass neither absorbs nor scatters, so its albedo is 1. Both sides of a silhouette share its
/// pixels.
#[test]
fn glass_is_white_and_edges_are_shared() {
    let picture = render_job(&job_with(SPHERE, &["objects[0].material=\"glass\""]), Integrator::Photon, 16).picture;
    let [red, green, blue] = colours(&picture, "albedo")[16 * 33 + 16];
    [red, green, blue].iter().for_each(|component| assert!((component - 1.0).abs() < 1e-6));
    let coverage = channel(&picture, "CryptoObject00.G");
    let shared = coverage.iter().filter(|&&coverage| coverage > 0.05 && coverage < 0.95).count();
    assert!(shared > 20, "{shared} pixels at edges");
}

/// The picture is convolved with the diffraction pattern, and the layers are not.
#[test]
fn light_layers_are_refused_with_diffraction() {
    let lens = r#"camera.lens={"thin": {"focal_length_mm": 50, "f_number": 32, "focus_distance": 10, "sensor_height_mm": 24}}"#;
    let text = SPHERE.replace(r#""layers": ["albedo", "normal""#, r#""layers": ["paths", "normal""#);
    let sets: Vec<String> = [lens, r#"render.force=["diffraction"]"#].map(String::from).to_vec();
    let (file, source) = abbe_format::parse(&text, "tests/inline.json".as_ref(), &sets).unwrap();
    let scene = abbe_format::resolve::resolve(&file, &source).unwrap();
    let error = abbe_session::render::Job::new(scene).unwrap_err().to_string();
    assert!(error.contains("diffraction") && error.contains("paths"), "{error}");
}
