//! Properties of all renders: bit-identical pictures on any number of threads, a balanced ledger,
//! correct colours of lamps, and media around cameras and lights.

use super::common::{example_job, example_names, job_with, render_job};
use abbe_session::render::{Integrator, Job, Monitor, NoMonitor, Progress, Rendered, Request, Run, StopRules};
use abbe_spectra::colour;
use abbe_spectra::spectrum::{Observer, library};

fn mean_xyz(rendered: &Rendered) -> [f64; 3] {
    let count = rendered.picture.xyz.len() as f64;
    std::array::from_fn(|c| rendered.picture.xyz.iter().map(|xyz| xyz[c]).sum::<f64>() / count)
}

/// A floor, a dispersive ball, a mirror, coated and rough objects, absorbing glass, an area light
/// and a point light.
const EVERYTHING: &str = r#"{
  "camera": {"from": [0, 3, 7], "at": [0, 0.8, 0], "lens": {"thin": {"fov": 40, "focus_distance": 7, "defocus_angle": 1}}},
  "film": {"width": 24, "height": 20},
  "materials": {
    "grey": {"diffuse": {"reflectance": 0.6}},
    "flint": {"dielectric": {"ior": "N-SF10"}},
    "bottle": {"dielectric": {"ior": "N-BK7", "absorption": {"rgb": [0.8, 0.1, 0.6]}}},
    "frosted": {"dielectric": {"ior": 1.5, "roughness": 0.4}},
    "gold": {"conductor": {"metal": "gold", "roughness": 0.5}},
    "paint": {"glossy": {"reflectance": {"rgb": [0.2, 0.4, 0.7]}, "ior": 1.5, "roughness": 0.3}},
    "paper": {"translucent": {"reflectance": 0.4, "transmittance": 0.4}},
    "pane": {"thin_dielectric": {"ior": 1.5}},
    "mirror": {"mirror": {"reflectance": 0.9}},
    "coated": {"dielectric": {"ior": "N-BK7", "coating": {"layers": [{"ior": 1.38, "thickness_nm": 100}, {"ior": "silver", "thickness_nm": 12}]}}},
    "soap": {"thin_film": {"layers": [{"ior": "water", "thickness_nm": {"gradient": {"a": 50, "b": 900}}}]}},
    "grating": {"grating": {"lines_per_mm": 600, "transmittance": 0.6, "reflectance": 0.2}},
    "mixed": {"mix": [{"material": "mirror", "weight": 1}, {"material": "grey", "weight": 2}]},
    "black": "absorber"},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 12, "height": 12}}, "material": "grey"},
    {"name": "a", "shape": {"sphere": {"center": [-2.4, 0.61, 0], "radius": 0.6}}, "material": "flint"},
    {"name": "b", "shape": {"sphere": {"center": [-1.2, 0.61, 0.4], "radius": 0.6}}, "material": "bottle"},
    {"name": "c", "shape": {"sphere": {"center": [0, 0.61, 0], "radius": 0.6}}, "material": "frosted"},
    {"name": "d", "shape": {"sphere": {"center": [1.3, 0.61, 0], "radius": 0.6}}, "material": "gold"},
    {"name": "e", "shape": {"sphere": {"center": [2.5, 0.61, 0.3], "radius": 0.6}}, "material": "paint"},
    {"name": "f", "shape": {"box": {"size": [0.6, 0.8, 0.05]}}, "material": "pane", "transform": [{"translate": [0.6, 0.5, 1.5]}]},
    {"name": "g", "shape": {"rectangle": {"width": 1, "height": 1}}, "material": "paper", "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 80}}, {"translate": [-1, 0.6, 2]}]},
    {"name": "h", "shape": {"box": {"size": [3, 2, 0.2]}}, "material": "mixed", "transform": [{"translate": [0, 1, -1.5]}]},
    {"name": "i", "shape": {"sphere": {"center": [-1.8, 0.41, 1.6], "radius": 0.4}}, "material": "coated"},
    {"name": "j", "shape": {"sphere": {"center": [1.9, 0.41, 1.6], "radius": 0.4}}, "material": "soap"},
    {"name": "k", "shape": {"rectangle": {"width": 1, "height": 1}}, "material": "grating", "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 50}}, {"translate": [0.5, 1.9, 0.5]}]},
    {"name": "lamp", "shape": {"rectangle": {"width": 0.5, "height": 0.5}}, "material": "black", "emission": {"spectrum": "A", "luminous_flux": 2000},
     "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 180}}, {"translate": [0.5, 4, 1]}]}],
  "lights": [{"point": {"at": [-2, 3, 2], "spectrum": "sodium-low-pressure", "power": 3}}],
  "render": {"photons": 6000}}"#;

#[test]
fn pixels_are_the_same_bits_on_any_number_of_threads() {
    let job = job_with(EVERYTHING, &[]);
    for integrator in [Integrator::Photon, Integrator::Path] {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render_job(&job, integrator, 3)).picture
        };
        let reference = on(1);
        assert!(reference.mean_y() > 0.0);
        for threads in [1, 2, 3, 8] {
            assert_eq!(on(threads), reference, "{integrator:?} on {threads} threads");
        }
    }
}

/// Returns the mean of some numbers and its standard error.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

#[test]
fn the_ledger_balances_and_sampling_is_unbiased() {
    let runs: Vec<_> = (1..=24)
        .map(|seed| {
            let job = job_with(EVERYTHING, &[&format!("render.seed={seed}")]);
            (render_job(&job, Integrator::Photon, 1).ledger, job.light_power_w())
        })
        .collect();
    for (ledger, _) in &runs {
        assert!(ledger.balance().abs() < 1e-6, "{}", ledger.balance());
        assert!(ledger.absorbed_total() > 0.0 && ledger.escaped > 0.0);
    }
    let (sampling, error) = mean_and_error(&runs.iter().map(|(l, _)| l.sampling / l.emitted).collect::<Vec<_>>());
    println!("sampling {sampling:.2e} ± {error:.2e}");
    assert!(sampling.abs() < 4.0 * error, "{sampling} ± {error}");
    let (emitted, error) = mean_and_error(&runs.iter().map(|(l, lamps)| l.emitted / lamps - 1.0).collect::<Vec<_>>());
    println!("emitted / lamps − 1 {emitted:.2e} ± {error:.2e}");
    assert!(emitted.abs() < 4.0 * error.max(1e-9), "{emitted} ± {error}");
}

/// Photons are traced in tasks. No task leaves out a photon.
#[test]
fn each_pass_emits_all_its_photons() {
    for photons in [2048, 5000] {
        let job = job_with(EVERYTHING, &[&format!("render.photons={photons}")]);
        assert_eq!(render_job(&job, Integrator::Photon, 1).stats.photons_emitted, photons);
    }
}

#[test]
fn a_ledger_notices_a_loss_of_one_part_in_ten_thousand() {
    let job = job_with(EVERYTHING, &[]);
    let mut ledger = render_job(&job, Integrator::Photon, 1).ledger;
    assert!(ledger.balance().abs() < 1e-6);
    ledger.absorbed.iter_mut().for_each(|watts| *watts *= 1.0 - 1e-4);
    assert!(ledger.balance().abs() > 1e-6, "{}", ledger.balance());
}

#[test]
#[ignore = "nightly: 32 seconds of CPU time"]
fn every_example_scene_balances_and_rejects_nothing() {
    let names = example_names();
    assert!(names.len() >= 8, "{names:?}");
    for name in names {
        let job = example_job(&name, &["film.width=24", "film.height=15", "render.photons=5000"]);
        let rendered = render_job(&job, Integrator::Photon, 2);
        let (ledger, stats) = (&rendered.ledger, &rendered.stats);
        assert!(ledger.balance().abs() < 1e-6, "{}: {}", name, ledger.balance());
        let emitted = (ledger.emitted - ledger.ultraviolet) / job.light_power_w();
        if stats.wavelengths != "free" {
            // Shared photons of a pass estimate the emitted power from four wavelengths only.
            let (mean, error) = emitted_on_shared_wavelengths(&name);
            assert!((mean - 1.0).abs() < 4.0 * error && error < 0.1, "{}: {mean} ± {error}", name);
        } else {
            assert!((emitted - 1.0).abs() < 0.05, "{}: {emitted}", name);
        }
        assert!(rendered.picture.mean_y() > 0.0, "{}", name);
    }
}

/// Returns the emitted power relative to the power of the lights, and its standard error, over
/// renders with independent seeds.
fn emitted_on_shared_wavelengths(name: &str) -> (f64, f64) {
    let run = |seed: u32| {
        let sets = ["film.width=8", "film.height=5", "render.photons=400", &format!("render.seed={seed}")];
        let job = example_job(name, &sets);
        render_job(&job, Integrator::Photon, 4).ledger.emitted / job.light_power_w()
    };
    mean_and_error(&(1..=12).map(run).collect::<Vec<_>>())
}

/// A patch that fills the picture, under a light of this spectrum and 1000 lm.
fn patch(reflectance: &str, spectrum: &str) -> Job {
    let text = format!(
        r#"{{
  "camera": {{"from": [0, 1, 0.2], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 20}}}}}},
  "film": {{"width": 12, "height": 12}},
  "materials": {{"patch": {{"diffuse": {{"reflectance": {reflectance}}}}}}},
  "objects": [{{"shape": {{"rectangle": {{"width": 2, "height": 2}}}}, "material": "patch"}}],
  "lights": [{{"point": {{"at": [0.5, 2, 0], "spectrum": {spectrum}, "luminous_flux": 1000}}}}],
  "render": {{"photons": 100}}}}"#
    );
    job_with(&text, &[])
}

/// Two lines, red and green, with the colour of low-pressure sodium light.
const TWIN: &str = r#"{"match": {"target": "sodium-low-pressure", "primaries": [{"lines": [{"nm": 620, "power": 1}]}, {"lines": [{"nm": 550, "power": 1}]}]}}"#;

#[test]
fn white_under_sodium_and_its_match_has_one_chromaticity() {
    let chromaticity = |spectrum| colour::xy(mean_xyz(&render_job(&patch("0.9", spectrum), Integrator::Photon, 64)));
    let (sodium, twin) = (chromaticity("\"sodium-low-pressure\""), chromaticity(TWIN));
    println!("sodium {sodium:?}, twin {twin:?}");
    let distance = |a: [f64; 2], b: [f64; 2]| ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt();
    assert!(distance(sodium, [0.5704, 0.4289]) < 0.002);
    assert!(distance(twin, sodium) < 0.002);
}

#[test]
fn colours_split_between_sodium_and_its_match_as_predicted() {
    let observer = Observer::cie1931();
    let sodium = library::find("sodium-low-pressure").unwrap().spectrum;
    let lines = [620.0, 550.0].map(|nm| {
        let line = abbe_spectra::spectrum::SpectralLine { nm, power: 1.0, fwhm_nm: None };
        abbe_spectra::spectrum::Spectrum::lines(&[line]).unwrap()
    });
    let matched =
        colour::match_primaries(observer.xyz(&sodium), &lines.each_ref().map(|line| observer.xyz(line))).unwrap();
    let twin =
        abbe_spectra::spectrum::Spectrum::mix(&[(matched.weights[0], &lines[0]), (matched.weights[1], &lines[1])]);
    for name in ["colorchecker/dark-skin", "colorchecker/blue"] {
        let reflectance = library::find(name).unwrap().spectrum;
        // Both lamps have 1000 lm. Colours are compared at Y = 1 of the perfect diffuser, in Lab
        // relative to D65.
        let white = observer.xyz(&library::find("D65").unwrap().spectrum);
        let white = white.map(|c| c / white[1]);
        let predicted = [&sodium, &twin].map(|lamp| {
            let scale = observer.xyz(lamp)[1];
            colour::lab(observer.xyz_under(&reflectance, lamp).map(|c| c / scale), white)
        });
        let perfect = mean_xyz(&render_job(&patch("1", "\"sodium-low-pressure\""), Integrator::Photon, 64))[1];
        let rendered = ["\"sodium-low-pressure\"", TWIN].map(|lamp| {
            let xyz = mean_xyz(&render_job(&patch(&format!("\"{name}\""), lamp), Integrator::Photon, 64));
            colour::lab(xyz.map(|c| c / perfect), white)
        });
        let expected = colour::delta_e_2000(predicted[0], predicted[1]);
        let found = colour::delta_e_2000(rendered[0], rendered[1]);
        println!("{name}: ΔE2000 {found:.3}, predicted {expected:.3}");
        assert!((found - expected).abs() < 1.0, "{name}: {found} against {expected}");
        assert!(expected > 1.0, "{name} should split");
    }
}

#[test]
fn a_lamp_centred_in_a_glass_ball_keeps_its_irradiance() {
    // Rays from the centre meet the ball at normal incidence, and reflected ones return through the
    // centre: E = I/d² below.
    let text = r#"{
  "camera": {"from": [0, 3, 1.2], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 12}}},
  "film": {"width": 6, "height": 6},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "N-SF10"}}},
  "objects": [
    {"shape": {"rectangle": {"width": 4, "height": 4}}, "material": "grey"},
    {"shape": {"sphere": {"center": [0, 1.2, 0], "radius": 0.3}}, "material": "glass"}],
  "lights": [{"point": {"at": [0, 1.2, 0], "spectrum": "E", "luminous_intensity": 100}}],
  "render": {"photons": 40000}}"#;
    // The camera looks past the ball at the floor in front of it. There cos θ and d vary little,
    // and their average is exact.
    let job = job_with(text, &["camera.from=[0, 0.4, 1.2]"]);
    let camera = &job.scene.camera;
    let mut expected = 0.0;
    let n = 60;
    for i in 0..n {
        for j in 0..n {
            let film = glam::DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5) * 6.0 / f64::from(n);
            let ray = camera.ray(film, [0.5; 2]);
            let hit = job.scene.geometry.intersect(&ray, None, f64::INFINITY).unwrap();
            let offset = glam::DVec3::new(0.0, 1.2, 0.0) - (hit.position + job.scene.centre);
            let d2 = offset.length_squared();
            expected += 0.5 / std::f64::consts::PI * 100.0 / d2 * (offset.y / d2.sqrt()) / f64::from(n * n);
        }
    }
    let found = render_job(&job, Integrator::Photon, 24).picture.mean_y();
    println!("floor under glass: {found:.4}, {expected:.4} expected");
    assert!((found / expected - 1.0).abs() < 0.005, "{found} against {expected}");
}

#[test]
fn a_camera_inside_glass_sees_radiance_times_n_squared() {
    // In a furnace of radiance L, the radiance inside glass of index n is n²L in every direction.
    let text = r#"{
  "camera": {"from": [0.1, 0.2, 0], "at": [1, 0.3, 0.2], "lens": {"pinhole": {"fov": 60}}},
  "film": {"width": 8, "height": 8},
  "materials": {"glass": {"dielectric": {"ior": 1.5}}},
  "objects": [{"shape": {"sphere": {"radius": 1}}, "material": "glass"}],
  "lights": [{"environment": {"spectrum": "E", "illuminance": 3.141592653589793}}],
  "render": {"photons": 100}}"#;
    for integrator in [Integrator::Photon, Integrator::Path] {
        let found = render_job(&job_with(text, &[]), integrator, 64).picture.mean_y();
        assert!((found / 2.25 - 1.0).abs() < 0.005, "{integrator:?}: {found}");
    }
}

#[test]
#[ignore = "nightly: 9 seconds of CPU time"]
fn shared_and_free_photons_give_the_same_floor() {
    // The camera sees only the floor. The dispersive ball is beside the view and casts its caustic
    // into it.
    let text = r#"{
  "camera": {"from": [1.6, 4, 0], "at": [1.6, 0, 0], "up": [0, 0, -1], "lens": {"pinhole": {"fov": 22}}},
  "film": {"width": 16, "height": 16},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "flint": {"dielectric": {"ior": "N-SF10"}}},
  "objects": [
    {"shape": {"rectangle": {"width": 8, "height": 8}}, "material": "grey"},
    {"shape": {"sphere": {"center": [0, 0.7, 0], "radius": 0.6}}, "material": "flint"}],
  "lights": [{"spot": {"at": [-3, 2.4, 0], "to": [0, 0.7, 0], "half_angle": 20, "spectrum": "D65", "luminous_intensity": 1000}}],
  "render": {"photons": 10000, "radius": 0.05}}"#;
    const BLOCK: usize = 4;
    let runs = |force: &str| -> Vec<Vec<f64>> {
        (0..8)
            .map(|seed| {
                let job = job_with(text, &[&format!("render.seed={seed}"), force]);
                let picture = render_job(&job, Integrator::Photon, 10).picture;
                let mut blocks = vec![0.0; (16 / BLOCK) * (16 / BLOCK)];
                for (pixel, xyz) in picture.xyz.iter().enumerate() {
                    let (x, y) = (pixel % 16 / BLOCK, pixel / 16 / BLOCK);
                    blocks[y * (16 / BLOCK) + x] += xyz[1];
                }
                blocks
            })
            .collect()
    };
    let (plain, shared) = (runs("render.force=[]"), runs("render.force=[\"shared\"]"));
    let blocks = plain[0].len();
    let mut worst = 0.0_f64;
    for block in 0..blocks {
        let column = |runs: &[Vec<f64>]| mean_and_error(&runs.iter().map(|run| run[block]).collect::<Vec<_>>());
        let ((a, ea), (b, eb)) = (column(&plain), column(&shared));
        // Kernels of finite radius are biased: the error has a floor of 2 % of the block.
        let error = (ea * ea + eb * eb + (0.02 * a).powi(2)).sqrt();
        worst = worst.max(((a - b) / error).abs());
    }
    println!("largest |z| of {blocks} blocks: {worst:.2}");
    // Šidák's bound for 16 blocks at 1 % is 3.4. Student's t with about 14 degrees of freedom makes
    // it 4.3.
    assert!(worst < 4.3, "{worst}");
}

#[test]
fn a_mixed_floor_sends_as_much_light_on_by_photons_as_by_paths() {
    let text = r#"{
  "camera": {"from": [0, 1, 3], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 50}}},
  "film": {"width": 12, "height": 12},
  "materials": {
    "white": {"diffuse": {"reflectance": 0.8}}, "mirror": {"mirror": {"reflectance": 0.8}},
    "mixed": {"mix": [{"material": "white", "weight": 1}, {"material": "mirror", "weight": 1}]}},
  "objects": [
    {"shape": {"rectangle": {"width": 6, "height": 6}}, "material": "mixed"},
    {"shape": {"rectangle": {"width": 6, "height": 6}}, "material": "white", "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 180}}, {"translate": [0, 2, 0]}]}],
  "lights": [{"environment": {"spectrum": "E", "illuminance": 100}}],
  "render": {"photons": 40000, "radius": 0.05}}"#;
    let job = job_with(text, &[]);
    let photon = render_job(&job, Integrator::Photon, 24).picture.mean_y();
    let path = render_job(&job, Integrator::Path, 400).picture.mean_y();
    println!("mixed floor: photon / path {:.4}", photon / path);
    assert!((photon / path - 1.0).abs() < 0.02, "{photon} against {path}");
}

/// Records the error after every eighth pass.
#[derive(Default)]
struct Errors(Vec<f64>);

impl Monitor for Errors {
    fn after_pass(&mut self, _: &Progress) -> bool {
        true
    }

    fn checkpoint(&mut self, run: &mut Run) {
        if run.passes().is_multiple_of(8) {
            self.0.extend(run.typical_error());
        }
    }
}

#[test]
fn the_error_falls_and_a_render_stops_at_its_target() {
    let job = example_job("cornell", &["film.width=32", "film.height=32", "render.photons=4000"]);
    let mut errors = Errors::default();
    let stop = StopRules { passes: Some(65), ..StopRules::default() };
    job.render(Request { stop, ..Request::default() }, &mut errors).unwrap();
    let after = |passes: usize| errors.0[passes / 8 - 1];
    println!("errors after 8, 16, … 64 passes: {:.4?}", errors.0);
    assert!([8, 16, 32].iter().all(|&passes| after(2 * passes) < after(passes)), "{:?}", errors.0);

    let met = 24;
    assert!(after(met) < after(16), "the target is not met before");
    let stop = StopRules { target_error: Some(after(met)), ..StopRules::default() };
    let stats = job.render(Request { stop, ..Request::default() }, &mut NoMonitor).unwrap().stats;
    assert_eq!(stats.passes, met as u64);
    assert!((stats.error.typical.unwrap() / after(met) - 1.0).abs() < 1e-6, "what it says of its error is the target");
}

#[test]
fn errors_are_unknown_where_no_light_arrived() {
    let Rendered { picture, stats, .. } = render_job(&job_with(EVERYTHING, &[]), Integrator::Photon, 16);
    let dark = picture.xyz.iter().filter(|xyz| xyz[1] == 0.0).count();
    assert!(dark > 0 && dark < picture.xyz.len() && stats.error.unknown_pixels == dark, "{dark}");
    for (pixel, xyz) in picture.xyz.iter().enumerate() {
        let [noise, bias] = [&picture.noise, &picture.bias].map(|layer| layer[pixel]);
        assert!(
            if xyz[1] == 0.0 { (noise, bias) == (None, None) } else { noise > Some(0.0) && bias >= Some(0.0) },
            "{pixel}"
        );
    }
    let forecast = stats.forecast.unwrap();
    let error = stats.error.relative.unwrap();
    // Stratified samples make the error fall as 1/n at most, and the bias of kernels as n^(-1/4).
    assert!((0.25..0.75).contains(&(forecast.error_after_four_times / error)), "{forecast:?} from {error}");
    assert!(forecast.milestones.iter().all(|at| at.error < error && at.seconds > stats.seconds.total), "{forecast:?}");
}

#[test]
fn two_prisms_give_back_the_lamps_white_at_the_centre() {
    let job = example_job("two_prisms", &["film.width=160", "film.height=90"]);
    let picture = render_job(&job, Integrator::Photon, 16).picture;
    // The middle of the bright patch on the lower card.
    let mut sum = [0.0; 3];
    for (x, y) in (63..70).flat_map(|y| (129..132).map(move |x| (x, y))) {
        (0..3).for_each(|c| sum[c] += picture.xyz[y * 160 + x][c]);
    }
    let [x, y] = colour::xy(sum);
    let distance = ((x - 0.3127).powi(2) + (y - 0.3290).powi(2)).sqrt();
    println!("two prisms: xy ({x:.4}, {y:.4}), Δxy {distance:.4}");
    assert!(distance < 0.005, "({x}, {y})");
}
