//! Runs every example of the package.

use std::path::PathBuf;
use std::process::Command;

/// The folder of the compiled examples: cargo builds them with the integration tests, beside them.
fn examples_folder() -> PathBuf {
    let test = std::env::current_exe().expect("a path of this test");
    let target = test.parent().and_then(|deps| deps.parent()).expect("the test lies in target/PROFILE/deps");
    target.join("examples")
}

/// Runs an example in the package's folder, and returns its standard output.
fn output_of(name: &str, arguments: &[&str]) -> String {
    let program = examples_folder().join(name).with_extension(std::env::consts::EXE_EXTENSION);
    let mut command = Command::new(&program);
    command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command.output().unwrap_or_else(|error| {
        panic!("{}: {error}; build the examples with `cargo build --examples`", program.display())
    });
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {errors}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_scene_file_is_rendered_with_progress() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let picture = folder.path().join("ball.exr");
    let path = picture.display().to_string();
    let text = output_of("render_scene", &["scenes/glass_ball.json", &path]);
    assert!(text.contains(" passes, ") && text.contains("wrote "), "{text}");
    assert!(picture.exists() && picture.with_extension("png").exists());
    let text = output_of("error_bars", &[&path]);
    assert!(text.contains("pixels with unknown error"), "{text}");
}

#[test]
fn a_scene_is_built_without_json() {
    assert!(output_of("build_scene", &[]).starts_with("wrote "));
}

#[test]
fn spectra_become_srgb() {
    let text = output_of("spectrum_to_srgb", &[]);
    assert_eq!(text.matches('#').count(), 5, "{text}");
}

#[test]
fn a_photon_is_traced_through_the_ball() {
    let text = output_of("trace_photon", &[]);
    assert_eq!(text.matches("hits the ball").count(), 2, "{text}");
    assert!(text.contains("hits the floor"), "{text}");
}

/// The errors of a picture that the example renders itself.
#[test]
fn error_bars_are_printed() {
    let text = output_of("error_bars", &[]);
    assert!(text.contains("relative error of the picture"), "{text}");
}
