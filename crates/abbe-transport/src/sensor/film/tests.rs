//! Tests of the film's sums.

use super::*;
use crate::sensor::first_surface::{ALBEDO_NM, FirstSurface, Sight};

const NM: f64 = 550.0;

/// One pixel. Each pass adds the radiance 1, with this bias.
fn exposed(passes: &[u64], bias: impl Fn(u64) -> f64) -> Film {
    let mut film = Film::new(1, 1, Observer::cie1931(), 0);
    for &pass in passes {
        film.rows().for_each(|mut row| {
            let exposed = row.expose(|_, sink| {
                sink.biased((0, 0), NM, 1.0, bias(pass));
                1
            });
            row.add(pass, &exposed);
        });
        film.count_pass(pass);
    }
    film
}

fn relative_bias(film: &Film) -> f64 {
    let picture = film.picture();
    f64::from(picture.bias[0].unwrap()) / picture.xyz[0][1]
}

/// Each half of the replicates has its own mean bias, also with different numbers of passes. The
/// squared bias of the picture is the product of the two.
#[test]
fn each_half_of_the_passes_keeps_its_own_bias() {
    assert!((relative_bias(&exposed(&[0], |_| 0.2)) - 0.2).abs() < 1e-6, "only an even pass");
    assert!((relative_bias(&exposed(&[3], |_| 0.2)) - 0.2).abs() < 1e-6, "only an odd pass");
    let uneven = exposed(&[0, 2, 4, 1], |pass| if pass % 2 == 0 { 0.1 } else { 0.4 });
    assert!((relative_bias(&uneven) - 0.2).abs() < 1e-6, "three even passes and one odd pass");
}

/// A camera sample and a connected photon of the same radiance have the same colour: the
/// colour-matching functions at their wavelength.
#[test]
fn samples_and_splats_have_the_colour_of_their_wavelength() {
    for nm in [440.0, 520.0, 610.5] {
        let bar = Observer::cie1931().xyz_bar(nm).map(|bar| 0.3 * bar * LUMENS_PER_WATT);
        let [mut samples, mut splats] = [0, 1].map(|_| Film::new(1, 1, Observer::cie1931(), 0));
        samples.rows().for_each(|mut row| {
            let exposed = row.expose(|_, sink| {
                sink.radiance((0, 0), nm, 0.3);
                1
            });
            row.add(0, &exposed);
        });
        let mut sink = splats.splat_sink();
        sink.splat((0, 0), 0, [(nm, 0.3)].into_iter());
        splats.add_splats(0, &sink);
        for film in [&mut samples, &mut splats] {
            film.count_pass(0);
            let xyz = film.picture().xyz[0];
            (0..3).for_each(|c| assert!((xyz[c] / bar[c] - 1.0).abs() < 1e-6, "{nm} nm: {xyz:?}"));
        }
    }
}

#[test]
fn truncated_splats_count_in_the_half_of_their_pass() {
    let mut film = exposed(&[0, 1, 2, 3], |_| 0.0);
    for pass in 0..4 {
        let mut sink = film.splat_sink();
        sink.splat((0, 0), 0, [(NM, 0.3)].into_iter());
        film.add_truncated_splats(pass, &sink);
    }
    assert!((relative_bias(&film) - 0.3).abs() < 1e-6);
}

fn denoising_film() -> Film {
    Film::new(1, 1, Observer::cie1931(), 0).with_layers(&LayerSet { denoising: true, ..LayerSet::default() })
}

/// Adds passes of the radiance 1 + pass, with a surface whose albedo and depth depend on the pass.
fn expose_for_denoising(film: &mut Film, passes: std::ops::Range<u64>) {
    for pass in passes {
        let records = film.records_surfaces(pass);
        film.rows().for_each(|mut row| {
            let exposed = row.expose(|_, sink| {
                sink.radiance((0, 0), NM, 1.0 + pass as f64);
                if records {
                    let albedo = if pass % 2 == 0 { 0.25 } else { 0.5 };
                    let surface = FirstSurface {
                        albedo: [albedo; ALBEDO_NM.len()],
                        normal: [0.0, 0.0, 1.0],
                        depth_m: 4.0,
                        uv: [0.0; 2],
                        object: 0,
                        material: 0,
                        sight: Sight { normal: [0.0, 0.0, 1.0], depth_m: 4.0 },
                    };
                    sink.add_surface(Some(&surface));
                }
                1
            });
            row.add(pass, &exposed);
        });
        film.count_pass(pass);
    }
}

/// The means of the groups are those of their passes, and surfaces are those of the first passes.
#[test]
fn denoising_means_are_those_of_their_passes() {
    let mut film = denoising_film();
    expose_for_denoising(&mut film, 0..3);
    assert!(film.denoising_samples().is_none(), "the last group has no passes");
    expose_for_denoising(&mut film, 3..4);
    let means = film.denoising_samples().expect("each group has a pass");
    assert!(means.y.iter().flatten().all(|y| y.is_finite()) && means.y[4].iter().all(|y| *y == 0.0));
    expose_for_denoising(&mut film, 4..18);
    let means = film.denoising_samples().unwrap();
    let bar = Observer::cie1931().xyz_bar(NM).map(|bar| bar * LUMENS_PER_WATT);
    let mean = |of: &dyn Fn(u64) -> bool| {
        let values: Vec<f64> = (0..18).filter(|pass| of(*pass)).map(|pass| 1.0 + pass as f64).collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    for r in 0..8_u64 {
        let known = bar[1] * mean(&|pass| pass % 8 == r);
        assert!((f64::from(means.y[r as usize][0]) / known - 1.0).abs() < 1e-6, "replicate {r}");
    }
    for g in 0..4_u64 {
        for (plane, c) in [(&means.x, 0), (&means.z, 2)] {
            let known = bar[c] * mean(&|pass| pass % 4 == g);
            assert!((f64::from(plane[g as usize][0]) - known).abs() < 1e-6 * known.max(1.0), "group {g}");
        }
    }
    for (surfaces, albedo) in means.features.iter().zip([0.25, 0.5]) {
        assert!(surfaces[0].albedo.iter().all(|value| (value - albedo).abs() < 1e-3), "{:?}", surfaces[0]);
        assert_eq!((surfaces[0].normal, surfaces[0].log_depth), ([0.0, 0.0, 1.0], 2.0));
    }
}

/// All planes of a film, added to a blank one, give its means again.
#[test]
fn planes_for_a_denoiser_survive_a_round_trip() {
    let mut film = denoising_film();
    expose_for_denoising(&mut film, 0..8);
    let mut copy = denoising_film();
    for plane in 0..film.light_plane_names().len() {
        let sums: Vec<_> = film.plane(plane).collect();
        copy.add_plane(plane, 0, sums.into_iter());
    }
    (0..8).for_each(|pass| copy.count_pass(pass));
    let (found, known) = (copy.denoising_samples().unwrap(), film.denoising_samples().unwrap());
    assert_eq!((found.y, found.x, found.z, found.features), (known.y, known.x, known.z, known.features));
    let names = film.light_plane_names();
    assert_eq!(names.len(), names.iter().collect::<std::collections::BTreeSet<_>>().len(), "{names:?}");
}
