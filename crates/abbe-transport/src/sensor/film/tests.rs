//! Tests of the film's sums.

use super::*;

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
