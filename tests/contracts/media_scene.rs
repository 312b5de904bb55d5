//! Media from the scene file to the model: units, placement, volume files, the power of emission,
//! and bad input.

use abbe_format::resolve;
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_scene::medium::TransmittanceEstimator;
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::{Spectrum, planck};
use glam::DVec3;
use std::f64::consts::PI;

/// A scene of one medium, by default in a ball of 0.5 units, in its own folder with these files.
struct Case<'a> {
    unit: &'a str,
    medium: &'a str,
    shape: &'a str,
    rest: &'a str,
    files: &'a [(&'a str, &'a [u8])],
}

impl Default for Case<'_> {
    fn default() -> Self {
        let shape = r#"{"sphere": {"center": [1, 2, 3], "radius": 0.5}}"#;
        Self { unit: "m", medium: "", shape, rest: "", files: &[] }
    }
}

impl Case<'_> {
    fn load(&self) -> Result<Scene> {
        let folder = tempfile::tempdir().expect("a folder of its own");
        let Self { unit, medium, shape, rest, files } = self;
        files.iter().for_each(|(name, bytes)| std::fs::write(folder.path().join(name), bytes).expect("a file in it"));
        let text = format!(
            r#"{{"unit": "{unit}", "camera": {{"from": [0, 1, 9], "at": [1, 2, 3], "lens": {{"pinhole": {{"fov": 35}}}}}},
                "film": {{"width": 4, "height": 4}}, "media": {{"it": {medium}}},
                "materials": {{"bounds": {{"boundary": {{"medium": "it"}}}}}},
                "objects": [{{"shape": {shape}, "material": "bounds"}}],
                "lights": [{{"point": {{"at": [0, 3, 0], "spectrum": 1, "power": 1}}}}] {rest}}}"#
        );
        let path = folder.path().join("scene.json");
        std::fs::write(&path, text).expect("the scene in it");
        resolve::load(&path, &[])
    }

    fn message(&self) -> String {
        self.load().map_or_else(|error| error.to_string(), |_| "no fault found".to_owned())
    }
}

fn load(medium: &str) -> Scene {
    Case { medium, ..Case::default() }.load().expect("a good scene")
}

/// Returns the powers of the scene's volume lights in W.
fn volume_powers(scene: &Scene) -> Vec<f64> {
    let volumes = scene.lights.iter().filter(|light| light.medium_name().is_some());
    volumes.map(|light| light.power_w(scene.extent())).collect()
}

#[test]
fn coefficients_and_places_are_in_the_scene_s_unit() {
    let medium = r#"{"grid": {"bounds": [[0, 0, 0], [4, 2, 2]], "density": {"values": [1, 3], "resolution": [2, 1, 1]},
        "absorption": 0.25, "scattering": 0.5, "phase": "rayleigh", "transmittance": "march",
        "transform": [{"scale": 2}, {"translate": [10, 0, 0]}]}}"#;
    let scene =
        Case { unit: "cm", medium, rest: r#", "render": {"march_steps": 17}"#, ..Case::default() }.load().unwrap();
    let medium = &scene.media[0];
    assert!((medium.absorption.at(500.0) - 25.0).abs() < 1e-12 && (medium.scattering.at(500.0) - 50.0).abs() < 1e-12);
    assert_eq!(medium.transmittance, TransmittanceEstimator::March { steps: 17 });
    // The box extends from (10, 0, 0) to (18, 4, 4) cm; the centres of its cells are at x = 12 and
    // 16 cm.
    let place = |cm: [f64; 3]| DVec3::from(cm) * 0.01 - scene.centre;
    for (cm, expected) in
        [([11.0, 1.0, 1.0], 1.0), ([14.0, 3.9, 0.1], 2.0), ([17.0, 1.0, 1.0], 3.0), ([9.9, 1.0, 1.0], 0.0)]
    {
        assert!((medium.density_at(place(cm)) - expected).abs() < 1e-9, "{cm:?}");
    }
    let ray = Ray::new(place([0.0, 1.0, 1.0]), DVec3::X);
    assert!((medium.column_m(&ray, f64::INFINITY) - 0.16).abs() < 1e-12);
    let interval = medium.interval(&ray, f64::INFINITY).unwrap();
    assert!((interval.0 - 0.1).abs() < 1e-12 && (interval.1 - 0.18).abs() < 1e-12);
}

#[test]
fn a_volume_file_gives_the_density() {
    let header = b"{'descr': '|u1', 'fortran_order': False, 'shape': (1, 2, 1), }";
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header);
    bytes.extend([0_u8, 4]);
    let medium = r#"{"grid": {"bounds": [[0, 0, 0], [1, 1, 1]], "density": {"path": "smoke.npy"},
        "absorption": 1, "scattering": 0, "phase": "isotropic"}}"#;
    let scene = Case { medium, files: &[("smoke.npy", &bytes)], ..Case::default() }.load().unwrap();
    assert!((scene.media[0].density_at(DVec3::splat(0.5) - scene.centre) - 2.0).abs() < 1e-9);
}

/// Returns ∫ σ_a B(T) dλ over the band in W/m³/sr, with σ_a = `at_550`·550/λ.
fn soot(at_550: f64, kelvin: f64) -> f64 {
    (0..4700).map(|i| 360.05 + 0.1 * f64::from(i)).map(|nm| 0.1e-9 * at_550 * 550.0 / nm * planck(nm, kelvin)).sum()
}

#[test]
fn hot_soot_emits_by_kirchhoff_s_law() {
    let absorption = r#""absorption": {"power_law": {"reference_nm": 550, "value": 2, "exponent": -1}}, "scattering": 0, "phase": "isotropic""#;
    let ball = format!(r#"{{"homogeneous": {{{absorption}, "emission": {{"blackbody": {{"temperature": 1900}}}}}}}}"#);
    let expected = 4.0 * PI * 4.0 / 3.0 * PI * 0.125 * soot(2.0, 1900.0);
    let scene = load(&ball);
    let powers = volume_powers(&scene);
    assert!(powers.len() == 1 && (powers[0] / expected - 1.0).abs() < 1e-4, "{powers:?}, expected {expected}");
    let spectral = scene.media[0].emission_per_m(DVec3::ZERO, 600.0);
    assert!((spectral / (2e-9 * 550.0 / 600.0 * planck(600.0, 1900.0)) - 1.0).abs() < 1e-4, "{spectral}");
    // A box of 2 × 1 × 1 m with density 0.5 that is hot in one half: a grid of temperatures, 1900 K
    // in all but the last cells.
    let flame = format!(
        r#"{{"grid": {{"bounds": [[0, 0, 0], [2, 1, 1]], "density": {{"constant": 0.5}}, {absorption},
            "emission": {{"blackbody": {{}}}}, "temperature": {{"values": [1900, 1900, 0, 0], "resolution": [4, 1, 1]}}}}}}"#
    );
    // From the second cell centre (x = 0.75) the emission falls to 0 within half a metre.
    let steps = 2000;
    let falling: f64 = (0..steps)
        .map(|i| soot(2.0, (1900.0 * (f64::from(i) + 0.5) / f64::from(steps)).max(1.0)) * 0.5 / f64::from(steps))
        .sum();
    let expected = 4.0 * PI * 0.5 * (0.75 * soot(2.0, 1900.0) + falling);
    let powers = volume_powers(&load(&flame));
    assert!((powers[0] / expected - 1.0).abs() < 2e-3, "{powers:?}, expected {expected}");
}

#[test]
fn what_glows_emits_the_power_or_the_radiance_that_it_states() {
    let neon = |emission: &str| {
        format!(
            r#"{{"homogeneous": {{"absorption": 0.1, "scattering": 0, "phase": "isotropic", "emission": {emission}}}}}"#
        )
    };
    for shape in [
        r#"{"sphere": {"radius": 0.5}}"#,
        r#"{"cylinder": {"radius": 0.1, "height": 2}}"#,
        r#"{"lens": {"radius1": 2, "radius2": -1, "thickness": 0.4, "diameter": 1}}"#,
        r#"{"prism": {"side": 1, "length": 0.3}}"#,
    ] {
        let medium = neon(r#"{"spectrum": "sodium-low-pressure", "power": 7}"#);
        let scene = Case { medium: &medium, shape, ..Case::default() }.load().unwrap();
        assert!((volume_powers(&scene)[0] - 7.0).abs() < 1e-9, "{shape}");
    }
    let scene = load(&neon(r#"{"spectrum": "D65", "radiance": 3}"#));
    let expected = 4.0 * PI * 0.1 * 3.0 * 4.0 / 3.0 * PI * 0.125;
    assert!((volume_powers(&scene)[0] / expected - 1.0).abs() < 1e-4);
    let spectrum: &Spectrum = &scene.lights[1].spectrum;
    assert!((spectrum.integral() - 1.0).abs() < 1e-9);
    // A medium that fills no object emits no light.
    let unheld = Case { medium: &neon(r#"{"spectrum": 1, "power": 7}"#), ..Case::default() };
    let unheld = Case { shape: r#"{"sphere": {"radius": 1}}"#, ..unheld }.load().unwrap();
    assert_eq!(volume_powers(&unheld).len(), 1);
}

#[test]
fn bad_media_are_answered_with_what_is_wrong() {
    let homogeneous =
        |keys: &str| format!(r#"{{"homogeneous": {{"absorption": 1, "scattering": 1, "phase": "isotropic" {keys}}}}}"#);
    let phase = |phase: &str| format!(r#"{{"homogeneous": {{"absorption": 1, "scattering": 1, "phase": {phase}}}}}"#);
    let grid = |density: &str| {
        format!(
            r#"{{"grid": {{"bounds": [[0, 0, 0], [1, 1, 1]], "density": {density}, "absorption": 1, "scattering": 1, "phase": "isotropic"}}}}"#
        )
    };
    let coefficient = r#"{"homogeneous": {"absorption": {"file": "a.csv"}, "scattering": 1, "phase": "isotropic"}}"#;
    let cold = homogeneous(r#", "emission": {"blackbody": {"temperature": 5}}"#);
    let no_end = homogeneous(r#", "emission": {"spectrum": 1, "power": 1}"#);
    // The medium, its files, and a part of the message.
    type Wrong<'a> = (&'a str, &'a [(&'a str, &'a [u8])], &'a str);
    let wrong: [Wrong<'_>; 13] = [
        (coefficient, &[("a.csv", b"400,1\n500,-2\n")], "media.it.homogeneous.absorption: the negative value -2"),
        (coefficient, &[("a.csv", b"400,1\n500,nan\n")], "media.it.homogeneous.absorption: the value NaN"),
        (&phase(r#"{"henyey_greenstein": {"g": 1}}"#), &[], "found 1; expected a number from -0.999999 to 0.999999"),
        (
            &phase(r#"{"henyey_greenstein": {"g": {"file": "a.csv"}}}"#),
            &[("a.csv", b"400,0\n500,2\n")],
            "mean cosines from",
        ),
        (&phase(r#"{"table": {"path": "p.csv"}}"#), &[], "cannot read the phase function"),
        (&phase(r#"{"table": {"path": "p.csv"}}"#), &[("p.csv", b"a,400\n0,1\n90,1\n")], "angles from 0 to 90°"),
        (&phase(r#"{"mie": {"radius_um": 500}}"#), &[], "or \"rainbow\" for drops of rain"),
        (
            &grid(r#"{"path": "smoke.vdb"}"#),
            &[],
            "for which there is no maintained reader; expected a .npy or .npz file",
        ),
        (&grid(r#"{"path": "smoke.npy"}"#), &[], "media.it.grid.density.path: cannot read the volume"),
        (&grid(r#"{"path": "smoke.npy"}"#), &[("smoke.npy", b"nonsense")], "does not begin like a .npy array"),
        (&grid(r#"{"values": [1, 2, 3], "resolution": [2, 1, 1]}"#), &[], "found an array of 3"),
        (&grid(r#"{"values": [1e300], "resolution": [1, 1, 1]}"#), &[], "in cell (0, 0, 0)"),
        (&cold, &[], "media.it.homogeneous.emission: found no light within 360–830 nm"),
    ];
    for (medium, files, words) in wrong {
        let message = Case { medium, files, ..Case::default() }.message();
        assert!(message.contains(words), "{medium}: {message}");
    }
    let message = Case { medium: &no_end, rest: r#", "atmosphere": "it""#, ..Case::default() }.message();
    assert!(message.contains("found on the atmosphere, which is unbounded"), "{message}");
}

#[test]
fn what_cannot_bound_a_medium_is_answered_with_what_is_wrong() {
    let medium = r#"{"homogeneous": {"absorption": 1, "scattering": 1, "phase": "isotropic"}}"#;
    let flat = Case { medium, shape: r#"{"rectangle": {"width": 1, "height": 1}}"#, ..Case::default() };
    let shape = r#"{"sphere": {"radius": 1}}, "emission": {"spectrum": 1, "power": 1}"#;
    let shines = Case { medium, shape, ..Case::default() };
    let unknown = Case { medium, rest: r#", "atmosphere": "fog""#, ..Case::default() };
    for (case, words) in [
        (flat, "found a flat shape, filled by the medium of \"bounds\"; expected a shape that encloses a space"),
        (shines, "which has no surface; expected the medium's own `emission`"),
        (unknown, "unknown medium \"fog\"; expected one of it"),
    ] {
        let message = case.message();
        assert!(message.contains(words), "{message}");
    }
}

/// A scene with a box of smoke 1 m wide in air; `more` is added to the grid.
fn smoke(more: &str) -> Scene {
    let medium = format!(
        r#"{{"grid": {{"bounds": [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]], "density": {{"constant": 1}}, "absorption": 0,
            "scattering": 2, "phase": "isotropic"{more}}}}}"#
    );
    let text = format!(
        r#"{{"camera": {{"from": [0, 0, 9], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 40}}}}, "shutter": {{"open": 0, "close": 1}}}},
            "film": {{"width": 8, "height": 8}}, "media": {{"smoke": {medium}}},
            "materials": {{"air": {{"boundary": {{"medium": "smoke"}}}}}},
            "objects": [{{"shape": {{"sphere": {{"radius": 5}}}}, "material": "air"}}],
            "lights": [{{"point": {{"at": [0, 6, 0], "spectrum": "D65", "power": 1}}}}]}}"#
    );
    let folder = tempfile::tempdir().expect("a folder of its own");
    let path = folder.path().join("smoke.json");
    std::fs::write(&path, text).expect("the scene in it");
    resolve::load(&path, &[]).expect("a good scene")
}

#[test]
fn moving_smoke_follows_its_keyframes() {
    let ray = Ray::new(DVec3::new(0.0, 3.0, 0.0), DVec3::NEG_Y);
    let still = smoke("");
    assert!(!still.moves());
    let to = |x: f64| format!(r#"{{"translate": [{x}, 0, 0]}}"#);
    let moving = smoke(&format!(
        r#", "motion": [{{"time": 0, "transform": [{}]}}, {{"time": 1, "transform": [{}]}}]"#,
        to(-2.0),
        to(2.0)
    ));
    assert!(moving.moves());
    for (time_s, expected) in [(0.0, 0.0), (0.3, 0.0), (0.4, 1.0), (0.5, 1.0), (0.6, 1.0), (0.7, 0.0), (1.0, 0.0)] {
        let posed = moving.at(time_s).expect("it can be posed");
        let column = posed.media[0].column_m(&ray, 6.0);
        assert!((column - expected).abs() < 1e-12, "{time_s} s: {column}");
    }
    assert!(moving.image_motion_px() > 3.0, "{}", moving.image_motion_px());
    let beyond =
        smoke(r#", "motion": [{"time": 2, "transform": []}, {"time": 3, "transform": [{"translate": [9, 0, 0]}]}]"#);
    assert!(!beyond.moves(), "its keyframes are beyond the shutter");
}

#[test]
fn a_medium_is_dense_where_light_meets_many_particles_in_it() {
    let thickness = |scattering: &str| {
        let medium =
            format!(r#"{{"homogeneous": {{"absorption": 0, "scattering": {scattering}, "phase": "isotropic"}}}}"#);
        Case { medium: &medium, ..Case::default() }.load().expect("a good scene").media[0].dense
    };
    assert!(!thickness("3") && thickness("30"), "a ball of 1 m");
    assert!(!smoke("").media[0].dense, "2 mean free paths");
}
