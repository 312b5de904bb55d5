//! Laws that hold for all matrices: conservation of power, physical states, reciprocity.

use super::elements;
use crate::jones::Jones;
use crate::scattering::{AIR_DEPOLARISATION, rayleigh};
use crate::sheet::Sheet;
use crate::surface::SurfaceMatrices;
use crate::{DiattenuatingRetarder, Mueller, Rotation, Stokes, StokesFrame, filter};
use abbe_optics::fresnel;
use abbe_optics::thin_film::{CoatedPlate, response};
use abbe_spectra::math::complex::Complex;
use glam::DVec3;

const COSINES: [f64; 8] = [1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 1e-3, 0.0];

fn near(a: impl Into<Mueller>, b: impl Into<Mueller>, tolerance: f64) -> bool {
    let (a, b) = (elements(a), elements(b));
    (0..16).all(|i| (a[i] - b[i]).abs() <= tolerance)
}

/// Polarised states all over the sphere of Poincaré.
fn states() -> impl Iterator<Item = Stokes> {
    (0..200).map(|i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 200.0;
        let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        Stokes([1.0, radius * cos, radius * sin, z])
    })
}

/// A matrix is physical if no state becomes more than fully polarised or gains power.
fn assert_physical(matrix: impl Into<Mueller>) {
    let matrix = matrix.into();
    for state in states() {
        let light = matrix * state;
        let polarised = light.degree_of_polarisation() * light.power();
        assert!((-1e-14..=1.0 + 1e-12).contains(&light.power()), "{matrix:?}: {light:?}");
        assert!(polarised <= light.power() + 1e-12, "{matrix:?}: {light:?}");
    }
}

#[test]
fn matrices_are_physical_and_surfaces_conserve_power() {
    for cos in COSINES {
        for (n_i, n_t) in [(1.0, 1.5), (1.5, 1.0), (1.0, 1.0 + 1e-9), (2.4, 1.333), (1.3, 1.3)] {
            let SurfaceMatrices { reflected, transmitted } = SurfaceMatrices::dielectric(cos, n_i, n_t);
            assert_physical(reflected);
            assert_physical(transmitted);
            assert!((reflected.s + transmitted.s - 1.0).abs() < 1e-15);
            assert!((reflected.p + transmitted.p - 1.0).abs() < 1e-15);
            let pane = Sheet::plate(cos, n_i, n_t, 1.0).pile(3);
            for matrix in [pane.front, pane.transmitted] {
                assert_physical(matrix);
            }
            assert!((pane.front.s + pane.transmitted.s - 1.0).abs() < 1e-12, "{cos} {n_i} {n_t} {pane:?}");
            assert!((pane.front.p + pane.transmitted.p - 1.0).abs() < 1e-12, "{cos} {n_i} {n_t} {pane:?}");
        }
        let gold = SurfaceMatrices::conductor(cos, 0.424, 2.47, 1.0);
        assert_physical(gold.reflected);
        assert_physical(gold.transmitted);
        let layers = [(Complex::new(1.38, 0.0), 120.0), (Complex::new(0.06, 3.6), 20.0)];
        let film = SurfaceMatrices::of_films(&response(cos, 1.0, layers.into_iter(), 1.52.into(), 480.0));
        assert_physical(film.reflected);
        assert_physical(film.transmitted);
        assert_physical(rayleigh(cos, AIR_DEPOLARISATION) * 8.0);
    }
    assert_physical(filter::linear_polariser(0.8, 0.01));
    assert_physical(filter::retarder(1.0));
    assert_physical(Mueller::depolariser(0.5));
}

/// The closed form of a dielectric and the general amplitudes agree, also in total reflection.
#[test]
fn the_closed_form_of_a_dielectric_is_that_of_films() {
    for cos in COSINES {
        for (n_i, n_t) in [(1.0, 1.5), (1.5, 1.0), (2.4, 1.333), (1.0, 1.0003)] {
            let films = SurfaceMatrices::of_films(&response(cos, n_i, std::iter::empty(), n_t.into(), 550.0));
            let found = SurfaceMatrices::dielectric(cos, n_i, n_t);
            assert!(near(found.reflected, films.reflected, 1e-12), "{cos} {n_i} {n_t}");
            assert!(near(found.transmitted, films.transmitted, 1e-12), "{cos} {n_i} {n_t}");
            let (s, p) = fresnel::dielectric_sp(cos, n_i, n_t);
            assert!((found.reflected.s, found.reflected.p) == (s, p), "{cos} {n_i} {n_t}");
        }
    }
}

#[test]
fn refraction_is_reciprocal() {
    for cos in COSINES.into_iter().filter(|&cos| cos > 0.0) {
        let there = SurfaceMatrices::dielectric(cos, 1.0, 1.5).transmitted;
        let back = SurfaceMatrices::dielectric(fresnel::cos_transmitted(cos, 1.0, 1.5), 1.5, 1.0).transmitted;
        assert!(near(there, back, 1e-12), "{cos}");
        assert!(near(Mueller::from(there).reversed(), back, 1e-12));
    }
}

/// A path of tilted elements, traced backwards through the reversed matrices.
#[test]
fn a_reversed_path_has_the_reversed_matrix() {
    let turn = Rotation::degrees(31.0);
    let mirror = Mueller::from(SurfaceMatrices::conductor(0.5, 0.6, 5.4, 1.0).reflected);
    let plate = Mueller::from(filter::retarder(0.8)).turned(Rotation::degrees(20.0));
    let there = plate * turn * mirror;
    // For the opposite direction of travel, angles have the opposite sign.
    let turned_plate = Mueller::from(filter::retarder(0.8)).turned(Rotation::degrees(-20.0));
    let back = mirror * turn * turned_plate;
    assert!(near(there.reversed(), back, 1e-14));
}

#[test]
fn forms_of_a_matrix_agree() {
    let element = DiattenuatingRetarder::from_amplitudes(Complex::new(0.3, -0.5), Complex::new(-0.2, 0.7));
    let jones = Jones::diagonal(Complex::new(0.3, -0.5), Complex::new(-0.2, 0.7));
    assert!(near(element, jones.mueller(), 1e-15));
    let turn = Rotation::degrees(17.0);
    for state in states() {
        let (found, known) = (element * state, Mueller::from(element) * state);
        assert!((0..4).all(|i| (found.0[i] - known.0[i]).abs() < 1e-15));
        let (found, known) = (turn * state, (turn * Mueller::IDENTITY) * state);
        assert!((0..4).all(|i| (found.0[i] - known.0[i]).abs() < 1e-15));
        let stored: Stokes = Stokes::<f32>::from(state).into();
        assert!((0..4).all(|i| (stored.0[i] - state.0[i]).abs() < 1e-7));
    }
    assert!(near(element * element, Mueller::from(element) * Mueller::from(element), 1e-15));
    assert!(near(turn * Mueller::IDENTITY * turn.inverse(), Mueller::IDENTITY, 1e-15));
}

/// The sum over 60 orders of reflection between the faces of an absorbing plate.
#[test]
fn plates_are_the_series_of_their_reflections() {
    let (cos, n, passage) = (0.4, 1.6, 0.8);
    let enters = SurfaceMatrices::dielectric(cos, 1.0, n);
    let inside = SurfaceMatrices::dielectric(fresnel::cos_transmitted(cos, 1.0, n), n, 1.0);
    let mut light = enters.transmitted * passage;
    let (mut transmitted, mut reflected) = (DiattenuatingRetarder::OPAQUE, enters.reflected);
    for _ in 0..60 {
        transmitted = transmitted + light * inside.transmitted;
        light = light * inside.reflected * passage;
        reflected = reflected + light * inside.transmitted;
        light = light * inside.reflected * passage;
    }
    let plate = Sheet::plate(cos, 1.0, n, passage);
    assert!(near(plate.transmitted, transmitted, 1e-14) && near(plate.front, reflected, 1e-14));
    assert!(near(plate.back, plate.front, 1e-14));
}

/// Panes with films on both faces, against the powers of [`CoatedPlate`].
#[test]
fn coated_panes_have_the_powers_of_coated_plates() {
    let (cos, n, passage, nm) = (0.6, 1.52, 0.9, 500.0);
    let cos_t = fresnel::cos_transmitted(cos, 1.0, n);
    let films = [(Complex::from(1.38), 95.0), (Complex::new(0.1, 3.1), 8.0)];
    let outside = response(cos, 1.0, films.into_iter(), n.into(), nm);
    let inside = response(cos_t, n, films.into_iter().rev(), 1.0.into(), nm);
    let face = Sheet::films(&outside, &inside);
    let back = Sheet::films(&inside, &outside);
    let pane = face.then(Sheet::absorber(passage)).then(back);
    let known = CoatedPlate { front: outside, front_inside: inside, back_inside: inside, passage }.response();
    for (reflected, transmitted, known) in
        [(pane.front.s, pane.transmitted.s, known.s), (pane.front.p, pane.transmitted.p, known.p)]
    {
        assert!((reflected - known[0]).abs() < 1e-12 && (transmitted - known[1]).abs() < 1e-12, "{pane:?}");
    }
    assert!(near(pane.front, pane.back, 1e-12));
    assert_physical(pane.front);
    assert_physical(pane.transmitted);
}

/// A field in three dimensions gives the same light as frames, rotations and matrices.
#[test]
fn a_mirror_acts_on_fields_as_on_stokes_vectors() {
    let (travel, normal) = (DVec3::new(0.6, 0.0, -0.8), DVec3::new(0.1, 0.3, 1.0).normalize());
    let leaving = travel - normal * (2.0 * travel.dot(normal));
    let start = StokesFrame::canonical(travel);
    let field = start.x * 0.8 - start.y() * 0.6;
    let (arrive, leave) = (StokesFrame::perpendicular(travel, normal), StokesFrame::perpendicular(leaving, normal));
    let found = response(-travel.dot(normal), 1.0, std::iter::empty(), 1.5.into(), 550.0);
    let (s, p) = (found.s.reflected.re * field.dot(arrive.x), found.p.reflected.re * field.dot(arrive.y()));
    let reflected = leave.x * s + leave.y() * p;
    let end = StokesFrame::canonical(leaving);
    let (x, y) = (reflected.dot(end.x), reflected.dot(end.y()));
    let known = Stokes([x * x + y * y, x * x - y * y, 2.0 * x * y, 0.0]);
    let light = Stokes([1.0, 0.8 * 0.8 - 0.6 * 0.6, -2.0 * 0.8 * 0.6, 0.0]);
    let matrix = SurfaceMatrices::of_films(&found).reflected;
    let light = leave.rotation_to(end.x) * (matrix * (start.rotation_to(arrive.x) * light));
    assert!((0..4).all(|i| (light.0[i] - known.0[i]).abs() < 1e-15), "{light:?} {known:?}");
}
