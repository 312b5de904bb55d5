//! Files of bispectral matrices, and wrong fluorescent materials and media: each error says what is
//! wrong, and where.

use abbe_format::{self as format, resolve};
use abbe_optics::donaldson::DonaldsonMatrix;
use std::path::Path;

/// Reads a matrix from a file with this text.
fn matrix(text: &str) -> abbe_spectra::error::Result<DonaldsonMatrix> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("matrix.csv");
    std::fs::write(&path, text).unwrap();
    DonaldsonMatrix::read(&path)
}

#[test]
fn a_matrix_is_read_by_columns() {
    let matrix = matrix("# measured\nnm,400, 420\n500,0.001,0.002\n550,0.003,0\n").unwrap();
    assert_eq!(matrix.excitation_nm, [400.0, 420.0]);
    assert_eq!(matrix.emission_nm, [500.0, 550.0]);
    assert_eq!(matrix.factors, [[0.001, 0.003], [0.002, 0.0]]);
}

#[test]
fn errors_of_a_matrix_contain_line_and_column() {
    for (text, expected) in [
        ("", "matrix.csv: an empty file; expected a row of excitation wavelengths"),
        ("nm,400\n500,1\n", "matrix.csv:1:1: 1 excitation wavelengths; expected 2 to 500 ascending wavelengths in nm"),
        ("nm,400,390\n500,1,1\n", "matrix.csv:1:1: the excitation wavelength 390 nm after 400 nm"),
        ("nm,400,420\n500,1\n", "matrix.csv:2:1: a row of 2 cells; expected 3 cells, as in the first row"),
        ("nm,400,420\n500,1,x\n", "matrix.csv:2:7: the cell \"x\"; expected a number of at least 0"),
        ("nm,400,420\n500,1,-1\n", "matrix.csv:2:7: the cell \"-1\""),
        ("nm,0.4,0.42\n500,1,1\n", "matrix.csv:1:1: excitation wavelengths from 0.4 to 0.42 nm"),
        ("nm,400,420\n500,1,1\n", "matrix.csv:2:1: 1 emission wavelengths"),
    ] {
        let error = matrix(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text:?}: {error}");
    }
}

#[test]
fn a_matrix_file_has_a_size_limit() {
    let error = matrix(&"#".repeat((1 << 23) + 1)).unwrap_err().to_string();
    assert!(error.contains("a matrix of more than 8 MiB"), "{error}");
}

/// Resolves a scene with this material and this dye, and returns the error.
fn error_of(material: &str, dye: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let files = [("gain.csv", "0.02,0.02"), ("photons.csv", "0.004,0.004"), ("dark.csv", "0,0")];
    for (name, values) in files {
        std::fs::write(folder.path().join(name), format!("nm,400,420\n500,{values}\n550,{values}\n")).unwrap();
    }
    let path = folder.path().join("scene.json");
    let text = format!(
        r#"{{"camera": {{"from": [0, 1, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 40}}}}}},
            "film": {{"width": 4, "height": 4}}, "materials": {{"white": {material}}},
            "media": {{"dyed": {{"homogeneous": {{"absorption": 0, "scattering": 0, "phase": "isotropic", "dye": {dye}}}}}}},
            "objects": [{{"shape": {{"sphere": {{"radius": 1}}}}, "material": "white"}}],
            "lights": [{{"point": {{"at": [0, 3, 0], "spectrum": 1, "power": 1}}}}]}}"#
    );
    std::fs::write(&path, text).unwrap();
    let (scene, source) = format::read(Path::new(&path), &[]).unwrap();
    resolve::resolve(&scene, &source).unwrap_err().to_string()
}

#[test]
fn wrong_matrices_and_dyes_are_refused() {
    const DYE: &str = r#"{"absorption": 1, "emission": 1, "quantum_yield": 0.5}"#;
    let bispectral = |reflectance: f64, matrix: &str| {
        format!(r#"{{"bispectral": {{"reflectance": {reflectance}, "matrix": "{matrix}"}}}}"#)
    };
    for (material, dye, expected) in [
        (bispectral(0.5, "gain.csv"), DYE, "emitted photons for each photon of 400 nm; expected at most 1"),
        (bispectral(0.9, "photons.csv"), DYE, "1.1625 reflected and emitted photons for each arriving photon"),
        (bispectral(0.9, "dark.csv"), DYE, "a matrix without emission between 360 nm and 830 nm"),
        (bispectral(0.9, "nowhere.csv"), DYE, "cannot read the matrix"),
        (bispectral(0.9, "../gain.csv"), DYE, "materials.white.bispectral.matrix"),
        (
            r#"{"diffuse": {"reflectance": 0.5}}"#.to_owned(),
            r#"{"absorption": 1, "emission": {"lines": [{"nm": 500, "power": 1}]}, "quantum_yield": 0.5}"#,
            "an absorptance or an emission with spectral lines",
        ),
    ] {
        let error = error_of(&material, dye);
        assert!(error.contains(expected), "{material} {dye}: {error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}
