//! Processors with other instructions give the same bits. On Linux with the GNU C library, the
//! variable `GLIBC_TUNABLES` hides instructions, and the library then selects other implementations
//! of `sin`, `exp` and the like.

use crate::abbe_command::command;
use crate::common::example_names;
use exr::prelude::{FlatSamples, read_all_flat_layers_from_file};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// Hides the instructions for which the GNU C library has implementations of elementary functions.
/// The library ignores the names that it does not know.
const MASK: [(&str, &str); 1] =
    [("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX2_Usable,-FMA_Usable,-FMA4_Usable")];

/// Renders a scene with a mask. Returns the bits of the checkpoint, which contains the exact sums,
/// and the bits of the picture.
fn bits(scene: &Path, mask: &[(&str, &str)]) -> BTreeMap<String, Vec<u32>> {
    let folder = tempfile::tempdir().expect("a folder of its own");
    let mut run = command(folder.path());
    run.arg("render").arg(scene).envs(mask.iter().copied());
    run.args(["-o", "o.exr", "--size", "48x27", "--photons", "4000", "--passes", "2", "--keep-checkpoint", "--quiet"]);
    let run = run.output().expect("abbe can be started");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let mut bits = BTreeMap::new();
    for name in ["o.exr", "o.checkpoint.exr"] {
        let image = read_all_flat_layers_from_file(folder.path().join(name)).expect("an EXR file");
        for (i, layer) in image.layer_data.into_iter().enumerate() {
            for channel in layer.channel_data.list {
                let values = match channel.sample_data {
                    FlatSamples::F16(values) => values.into_iter().map(|value| u32::from(value.to_bits())).collect(),
                    FlatSamples::F32(values) => values.into_iter().map(f32::to_bits).collect(),
                    FlatSamples::U32(values) => values,
                };
                bits.insert(format!("{name}, layer {i}, channel {}", channel.name), values);
            }
        }
    }
    bits
}

/// Checks that an example scene has the same bits with and without the mask.
fn example_is_independent_of_the_processor(name: &str) {
    is_independent_of_the_processor(&Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.json")));
}

/// Checks that a scene has the same bits with and without the mask.
fn is_independent_of_the_processor(scene: &Path) {
    let (own, masked) = (bits(scene, &[]), bits(scene, &MASK));
    assert!(own.keys().any(|name| name.contains("sums.")), "no sums in {:?}", own.keys());
    assert!(own.keys().eq(masked.keys()), "{}", scene.display());
    for (name, values) in &own {
        let different = values.iter().zip(&masked[name]).filter(|(a, b)| a != b).count();
        assert!(different == 0, "{}, {name}: {different} of {} values differ", scene.display(), values.len());
    }
}

/// These scenes differed when the renderer called the C library.
#[test]
fn sums_and_pictures_do_not_depend_on_the_processor() {
    for name in ["cornell", "prism_in_fog", "rainbow"] {
        example_is_independent_of_the_processor(name);
    }
}

#[test]
fn diffraction_does_not_depend_on_the_processor() {
    let folder = tempfile::tempdir().expect("a folder of its own");
    let scene = folder.path().join("star.json");
    std::fs::write(&scene, super::diffraction::SCENE).expect("a folder that can be written");
    is_independent_of_the_processor(&scene);
}

#[test]
#[ignore = "slow: renders every example scene twice"]
fn no_example_scene_depends_on_the_processor() {
    for name in example_names() {
        example_is_independent_of_the_processor(&name);
        println!("{name}: the same bits");
    }
}

/// Prints a hash of results of the C library. `the_mask_changes_the_c_library` runs this test in a
/// process of its own, because the library selects its implementations when a process starts.
#[test]
#[ignore = "a helper that another test runs"]
fn hash_of_the_c_library() {
    let hash = (1..200_000).map(f64::from).fold(0_u64, |hash, i| {
        let x = 1e-4 * i;
        [x.sin(), x.cos(), x.exp(), x.ln(), x.atan(), x.powf(0.3)]
            .iter()
            .fold(hash, |hash, value| (hash.rotate_left(5) ^ value.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15))
    });
    println!("hash {hash}");
}

/// Without this check, the other tests would pass if the mask had no effect.
#[test]
#[cfg(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64"))]
fn the_mask_changes_the_c_library() {
    if !std::is_x86_feature_detected!("fma") {
        println!("this processor has no instructions to hide");
        return;
    }
    let hash = |mask: &[(&str, &str)]| {
        let mut run = Command::new(std::env::current_exe().expect("the path of this test"));
        run.args(["--exact", "processors::hash_of_the_c_library", "--ignored", "--nocapture"]);
        let run = run.envs(mask.iter().copied()).stdin(Stdio::null()).output().expect("the test can be started");
        let out = String::from_utf8_lossy(&run.stdout);
        let line = out.lines().find_map(|line| line.split_once("hash ")).map(|(_, hash)| hash.to_owned());
        line.unwrap_or_else(|| panic!("no hash in {out}"))
    };
    assert_ne!(hash(&[]), hash(&MASK), "the mask {MASK:?} has no effect");
}
