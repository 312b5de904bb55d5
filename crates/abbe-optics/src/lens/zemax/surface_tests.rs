//! Surfaces that no camera lens has, against closed forms and against simpler surfaces.

use super::tests::folded;
use super::*;
use crate::lens::folded::{FoldedAnalysis, FoldedSystem};
use crate::lens::{AnalysisConditions, LINES};

const HEAD: &str = "MODE SEQ\nUNIT MM\nENPD 10\nFTYP 0 0 2 1\nYFLN 0 2\nSURF 0\n  DISZ INFINITY\n";

fn analysed(system: &FoldedSystem) -> FoldedAnalysis {
    system.analysis(AnalysisConditions::default()).unwrap()
}

/// Analyses one surface in front of a plane of glass, and the image.
fn single(surface: &str) -> FoldedAnalysis {
    // A break that changes nothing but y keeps the system folded.
    let tail = "  DISZ 5\n  GLAS N-BK7\nSURF 2\n  DISZ 90\nSURF 3\n  TYPE COORDBRK\n  PARM 2 1e-9\nSURF 4\n  DISZ 0\n";
    analysed(&folded(&format!("{HEAD}SURF 1\n  STOP\n{surface}{tail}")))
}

fn assert_same(one: &FoldedAnalysis, other: &FoldedAnalysis, what: &str) {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-7 * b.abs().max(1e-3);
    for (a, b) in one.efl_mm.iter().zip(other.efl_mm) {
        assert!(near(a.unwrap(), b.unwrap()), "{what}: {a:?} {b:?}");
    }
    for (a, b) in one.fields.iter().zip(&other.fields) {
        assert!((a.centroid_mm - b.centroid_mm).length() < 1e-9, "{what}");
        assert!(a.rms_mm.iter().zip(&b.rms_mm).all(|(a, b)| near(*a, *b)), "{what}: {a:?} {b:?}");
    }
}

fn error(text: &str) -> String {
    parse_system(text.as_bytes(), "a.zmx".as_ref(), &[]).unwrap_err().to_string()
}

#[test]
fn ideal_lenses_have_the_focal_length_of_the_formula() {
    let lens = |f: f64, gap: f64| format!("  TYPE PARAXIAL\n  PARM 1 {f}\n  PARM 2 1\n  DISZ {gap}\n");
    let text = |f1, f2, gap, to_image| {
        format!("{HEAD}SURF 1\n  STOP\n{}SURF 2\n{}SURF 3\n  DISZ 0\n", lens(f1, gap), lens(f2, to_image))
    };
    // 1/f = 1/f₁ + 1/f₂ − d/(f₁ f₂), and the back focus is f (1 − d/f₁).
    for (f1, f2, gap) in [(100.0, 50.0, 20.0), (100.0, -80.0, 40.0)] {
        let efl: f64 = 1.0 / (1.0 / f1 + 1.0 / f2 - gap / (f1 * f2));
        let back = efl * (1.0 - gap / f1);
        let found = analysed(&folded(&text(f1, f2, gap, back)));
        assert!((found.efl_mm[0].unwrap() / efl - 1.0).abs() < 1e-7, "{:?} {efl}", found.efl_mm);
        assert!((found.back_focus_mm[1].unwrap() / back - 1.0).abs() < 1e-7, "{:?}", found.back_focus_mm);
        // All rays of a point meet in a point at every field.
        assert!(found.fields.iter().flat_map(|field| &field.rms_mm).all(|rms| *rms < 1e-10), "{found:?}");
        assert!((found.fields[2].centroid_mm.y - efl * 2_f64.to_radians().tan()).abs() < 1e-9);
    }
    let telescope = analysed(&folded(&text(100.0, 50.0, 150.0, 30.0)));
    assert_eq!((telescope.efl_mm, telescope.f_number), ([None; 2], None));
    let diverging = analysed(&folded(&text(100.0, -80.0, 10.0, 30.0).replace("PARM 1 100", "PARM 1 -100")));
    assert!(diverging.efl_mm[0].unwrap() < 0.0 && diverging.back_focus_mm[0].unwrap() < 0.0);
}

#[test]
fn a_lens_images_a_near_object_at_twice_its_focal_length() {
    let head = HEAD.replace("ENPD 10", "OBNA 0.1 0").replace("FTYP 0", "FTYP 1").replace("INFINITY", "200");
    let text = format!("{head}SURF 1\n  STOP\n  TYPE PARAXIAL\n  PARM 1 100\n  DISZ 200\nSURF 2\n  DISZ 0\n");
    let found = analysed(&folded(&text));
    assert!((found.efl_mm[0].unwrap() - 100.0).abs() < 1e-6 && found.f_number.is_none());
    assert!((found.entrance_mm - 2.0 * 200.0 * 0.1 / 0.99_f64.sqrt()).abs() < 1e-6, "{}", found.entrance_mm);
    assert!((found.half_field - 2.0).abs() < 1e-12);
    assert!((found.fields[2].centroid_mm.y + 2.0).abs() < 1e-9 && found.fields[2].rms_mm[0] < 1e-10, "{found:?}");
}

#[test]
fn cylinders_have_power_along_one_axis() {
    let n = crate::glass::RefractiveIndex::catalogue("N-BK7").unwrap().nd();
    let toroid = single("  TYPE TOROIDAL\n  CURV 0.02\n  XDAT 1 0\n  XDAT 2 100\n");
    let biconic = single("  TYPE BICONICX\n  CURV 0\n  PARM 1 50\n");
    for (found, curved) in [(toroid, 0), (biconic, 1)] {
        assert!((found.efl_mm[curved].unwrap() - 50.0 / (n - 1.0)).abs() < 1e-5, "{:?}", found.efl_mm);
        assert_eq!(found.efl_mm[1 - curved], None);
    }
}

/// Each surface without symmetry can describe a sphere or an even asphere.
#[test]
fn other_descriptions_of_a_surface_give_its_rays() {
    let sphere = single("  CURV 0.02\n");
    assert_same(&single("  TYPE BICONICX\n  CURV 0.02\n  PARM 1 50\n"), &sphere, "biconic");
    assert_same(&single("  TYPE TOROIDAL\n  CURV 0.02\n  PARM 1 50\n"), &sphere, "toroid");
    let asphere = single("  TYPE EVENASPH\n  CURV 0.02\n  CONI -0.5\n  PARM 1 1e-3\n  PARM 2 2e-6\n");
    let base = "  CURV 0.02\n  CONI -0.5\n";
    for other in [
        "  TYPE ODDASPHE\n  PARM 2 1e-3\n  PARM 4 2e-6\n",
        "  TYPE XASPHERE\n  XDAT 1 2\n  XDAT 2 10\n  XDAT 3 0.1\n  XDAT 4 0.02\n  XDAT 5 9\n",
        "  TYPE XODDASPH\n  XDAT 1 4\n  XDAT 2 10\n  XDAT 4 0.1\n  XDAT 6 0.02\n",
        // x², y², x⁴, x²y² and y⁴ in units of 10 mm.
        "  TYPE XPOLYNOM\n  XDAT 1 14\n  XDAT 2 10\n  XDAT 5 0.1\n  XDAT 7 0.1\n  XDAT 12 0.02\n  XDAT 14 0.04\n  XDAT 16 0.02\n",
        // Defocus, 2ρ² − 1, and spherical aberration, 6ρ⁴ − 6ρ² + 1, in the fringe order.
        "  TYPE FZERNSAG\n  XDAT 1 9\n  XDAT 2 10\n  XDAT 3 0.0566666666666667\n  XDAT 6 0.06\n  XDAT 11 0.00333333333333333\n",
        // The same in Noll's order, in which they have the norms √3 and √5.
        "  TYPE SZERNSAG\n  XDAT 1 11\n  XDAT 2 10\n  XDAT 3 0.0566666666666667\n  XDAT 6 0.0346410161513775\n  XDAT 13 0.00149071198499986\n",
    ] {
        assert_same(&single(&format!("{base}{other}")), &asphere, other);
    }
}

#[test]
fn a_grating_deflects_by_the_grating_equation() {
    let grating = "SURF 1\n  STOP\n  TYPE DGRATING\n  PARM 1 0.6\n  PARM 2 -1\n";
    let lens = "  DISZ 0\nSURF 2\n  TYPE PARAXIAL\n  PARM 1 100\n  DISZ 100\nSURF 3\n  DISZ 0\n";
    let found = analysed(&folded(&format!("{HEAD}{grating}{lens}")));
    // sin θ = m λ / d, and the ideal lens focuses at f tan θ.
    let sine = -0.6 * LINES[1].1 * 1e-3;
    let height = 100.0 * sine / (1.0 - sine * sine).sqrt();
    assert!((found.fields[0].centroid_mm.y - height).abs() < 1e-9, "{:?} {height}", found.fields[0]);
    let mirror = analysed(&folded(&format!("{HEAD}{grating}  GLAS MIRROR\n  DISZ -100\nSURF 2\n  DISZ 0\n")));
    assert!((mirror.fields[0].centroid_mm.y - height).abs() < 1e-9, "{:?}", mirror.fields[0]);
}

#[test]
fn a_diffractive_lens_has_the_focal_length_of_its_phase() {
    // The phase −π r²/(λ f) of f = 100 mm at the d line, in units of 5 mm.
    let a = -std::f64::consts::PI * 25.0 / (LINES[1].1 * 1e-6 * 100.0);
    let surface = format!("  TYPE BINARY_2\n  XDAT 1 1\n  XDAT 2 5\n  XDAT 3 {a}\n");
    let found = analysed(&folded(&format!("{HEAD}SURF 1\n  STOP\n{surface}  DISZ 100\nSURF 2\n  DISZ 0\n")));
    assert!((found.efl_mm[0].unwrap() - 100.0).abs() < 1e-5, "{:?}", found.efl_mm);
}

/// A tilt of one surface is a coordinate break in front of it and the reverse one behind it.
#[test]
fn a_tilted_surface_is_a_surface_between_coordinate_breaks() {
    let lens = "SURF 1\n  STOP\n  CURV 0.02\n  DISZ 5\n  GLAS N-BK7\nSURF 2\n";
    let turn = |n: u32, deg: f64, order: u32| {
        format!("SURF {n}\n  TYPE COORDBRK\n  PARM 2 {}\n  PARM 3 {deg}\n  PARM 6 {order}\n  DISZ 0\n", deg * 0.1)
    };
    let breaks = format!(
        "{HEAD}{lens}  DISZ 10\n{}SURF 4\n  CURV -0.01\n  DISZ 0\n  GLAS N-SF6\n{}SURF 6\n  DISZ 70\nSURF 7\n  DISZ 0\n",
        turn(3, 5.0, 0),
        turn(5, -5.0, 1)
    );
    let tilt = "  SCBD 1 0 0 0 0.5 5 0 0\n  SCBD 2 1 2 0 -0.5 -5 0 0\n";
    let own = format!(
        "{HEAD}{lens}  DISZ 10\nSURF 3\n  CURV -0.01\n{tilt}  DISZ 0\n  GLAS N-SF6\nSURF 4\n  DISZ 70\nSURF 5\n  DISZ 0\n"
    );
    assert_same(&analysed(&folded(&own)), &analysed(&folded(&breaks)), "tilt");
}

#[test]
fn the_newtonian_telescope_focuses_to_a_point_beside_its_tube() {
    let head = HEAD.replace("ENPD 10", "ENPD 200");
    let mirror = "SURF 1\n  STOP\n  CURV -0.0005\n  CONI -1\n  DISZ -800\n  GLAS MIRROR\n  OBSC 0 30\n";
    let turn = "  TYPE COORDBRK\n  PARM 3 45\n  DISZ ";
    let text = format!("{head}{mirror}SURF 2\n{turn}0\nSURF 3\n  GLAS MIRROR\nSURF 4\n{turn}200\nSURF 5\n  DISZ 0\n");
    let system = folded(&text);
    let found = analysed(&system);
    assert!((found.efl_mm[0].unwrap() - 1000.0).abs() < 1e-3, "{:?}", found.efl_mm);
    assert!(found.fields[0].rms_mm[1] < 1e-9 && (found.f_number.unwrap() - 5.0).abs() < 1e-5, "{:?}", found.fields[0]);
    // The plots: a section beside the tube, a sharp axis, and coma at the edge.
    let section = system.section(&found).unwrap();
    assert!(!section.leaves_plane && section.sheets.len() == 2 && section.image[0].y.abs() > 150.0, "{section:?}");
    let mtf = system.mtf(&found).unwrap();
    assert!((mtf.fields[0].tangential[50] / mtf.diffraction_limit[50] - 1.0).abs() < 1e-9);
    assert!(mtf.fields[2].tangential[50] < 0.1 * mtf.diffraction_limit[50]);
    let spots = system.spots(&found);
    assert!(spots[0].largest_mm < 1e-9 && spots[2].largest_mm > 0.1);
    // The tangential and the sagittal focus of a paraboloid with the stop at the mirror are at
    // −θ² f and 0 in front of the focus, to third order.
    let foci = system.field_foci(&found).unwrap();
    let shift = |curves: &[Vec<Option<f64>>]| curves[1].last().unwrap().unwrap();
    let expected = -1000.0 * 2_f64.to_radians().powi(2);
    assert!((shift(&foci.tangential_mm) / expected - 1.0).abs() < 0.01, "{} {expected}", shift(&foci.tangential_mm));
    assert!(shift(&foci.sagittal_mm).abs() < 0.01 * expected.abs(), "{}", shift(&foci.sagittal_mm));
}

#[test]
fn refusals_and_notes_state_the_true_reason() {
    for (text, words) in [
        ("VERS 1\nMODE NSC\n".to_string(), "a non-sequential system, whose objects light meets in any order"),
        (format!("{HEAD}SURF 1\n  TYPE NONSEQCO\n"), "a group of objects that light meets in any order"),
        (format!("{HEAD}SURF 1\n  TYPE USERSURF us_x.dll\n"), "a program of the user computes it"),
        (format!("{HEAD}SURF 1\n  TYPE GRINSUR1\n"), "the index varies within the glass"),
        (format!("{HEAD}SURF 1\n  STOP\n  TYPE BICONICX\n  PARM 7 1\nSURF 2\n"), "the parameter 7 with the value 1"),
        (format!("{HEAD}SURF 1\n  STOP\n  TYPE FZERNSAG\n  XDAT 1 1\n  XDAT 3 1\nSURF 2\n"), "a norm radius of 0"),
    ] {
        let message = error(&text);
        assert!(message.contains(words), "{message}");
    }
    let text = format!("MNUM 3 2\n{HEAD}SURF 1\n  STOP\n  TYPE PARAXIAL\n  PARM 1 9\n  DISZ 9\nSURF 2\n  DISZ 0\n");
    assert_eq!(folded(&text).notes, ["the file has 3 configurations, of which number 2 is read"]);
    let camera = parse(text.as_bytes(), "a.zmx".as_ref(), &[]).unwrap_err().to_string();
    assert!(camera.contains("a.zmx:9:1: an ideal lens in a camera lens is not supported"), "{camera}");
    let jones = folded(&text.replace("PARAXIAL", "JONESMAT").replace("DISZ 9", "DISZ -9"));
    assert!(jones.notes[1].contains("the Jones matrix of line 9 changes no ray"), "{:?}", jones.notes);
    // A plate has no focus, so its figures follow from rays.
    let plate = format!(
        "{HEAD}SURF 1\n  STOP\n  DISZ 5\n  GLAS N-BK7\n  DIAM 9\nSURF 2\n  DISZ 10\n  DIAM 9\nSURF 3\n  DISZ 0\n"
    );
    let plate = folded(&plate);
    assert!(plate.notes[0].contains("has no power"), "{:?}", plate.notes);
    assert_eq!(analysed(&plate).efl_mm, [None; 2]);
}
