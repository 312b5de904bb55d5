//! sRGB colours in the place of spectra.

use std::path::Path;

use abbe_format::resolve::{Role, lone_spectrum, resolve};
use abbe_format::{parse, parse_spectrum};

/// The hexadecimal colour, the object forms and the linear colour give the same spectrum.
#[test]
fn all_forms_of_an_srgb_colour_are_the_same_spectrum() {
    let spectrum = |text: &str, role: Role| {
        let (file, source) = parse_spectrum(text, Path::new("a")).unwrap();
        lone_spectrum(&file, &source, role).unwrap()
    };
    for role in [Role::Reflectance, Role::Light] {
        let hex = spectrum("\"#ff8800\"", role);
        for text in [r##"{"srgb": "#F80"}"##, r#"{"srgb": [1, 0.5333333333333333, 0]}"#] {
            assert_eq!(spectrum(text, role), hex, "{text}");
        }
        // IEC 61966-2-1: ((136/255 + 0.055)/1.055)^2.4 = 0.246201.
        let linear = spectrum(r#"{"rgb": [1, 0.24620132669705552, 0]}"#, role);
        for nm in [450.0, 550.0, 650.0] {
            assert!((linear.at(nm) - hex.at(nm)).abs() < 1e-9, "{nm}: {} {}", linear.at(nm), hex.at(nm));
        }
    }
}

/// A colour is allowed wherever a spectrum is allowed.
#[test]
fn a_colour_may_stand_wherever_a_spectrum_may() {
    let text = r##"{
      "camera": {"from": [0, 1, 5], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 40}}},
      "film": {"width": 8, "height": 8, "white_balance": "#ffeedd"},
      "spectra": {"paint": "#336699", "mixed": {"mix": [{"spectrum": "#f00", "weight": 1}]}, "#abc": 0.25},
      "media": {"fog": {"homogeneous": {"absorption": "#112233", "scattering": {"srgb": "#fff"}, "phase": "isotropic"}}},
      "materials": {
        "a": {"diffuse": {"reflectance": "#cc3311"}}, "b": {"mirror": {"reflectance": {"srgb": [0.5, 0.5, 0.5]}}},
        "c": {"dielectric": {"ior": 1.5, "absorption": "#0000ff"}}, "d": {"diffuse": {"reflectance": "#abc"}}
      },
      "objects": [{"shape": {"sphere": {"radius": 1}}, "material": "a", "emission": {"spectrum": "#ff8800", "power": 1}}],
      "lights": [{"environment": {"spectrum": "#88aaff", "illuminance": 100}}]
    }"##;
    let (scene, source) = parse(text, Path::new("s.json"), &[]).unwrap();
    resolve(&scene, &source).unwrap();
    for (from, to, part) in [
        ("#cc3311", "#cc331", "found \"#cc331\"; expected a colour such as #ff8800"),
        ("[0.5, 0.5, 0.5]", "[128, 128, 128]", "found 128; expected a number from 0 to 1 (divide"),
    ] {
        let error = match parse(text.replace(from, to), Path::new("s.json"), &[]) {
            Ok((scene, source)) => resolve(&scene, &source).unwrap_err(),
            Err(error) => error,
        };
        assert!(error.to_string().contains(part), "{error}");
    }
}
