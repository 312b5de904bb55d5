//! Zemax files as they occur in practice: computed semi-diameters, unknown glasses, apertures of
//! all kinds, mirrors and coordinate breaks.

use super::*;
use crate::glass::lines;
use crate::lens::{AnalysisConditions, ApertureCheck, LensAnalysis, LensRay, TraceDirection};
use glam::DVec3;

const TRIPLET: &str = "VERS 140124 36 123457 L36\nMODE SEQ\nNAME Triplet\nUNIT MM X W X CM MR CPMM\nENPD 1.0E+1\n\
    GCAT SCHOTT MISC\nFTYP 0 0 3 3 0 0 0\nXFLN 0 0 0 9 9\nYFLN 0 1.4E+1 2.0E+1 9 9\nSURF 0\n  TYPE STANDARD\n  CURV 0.0 0 0 0 0 \"\"\n\
    DISZ INFINITY\nSURF 1\n  CURV 4.5405E-2 0 0 0 0\n  DISZ 3.259\n  GLAS N-SK16 0 0 1.5 4.0E+1 0 0 0 0 0 0\n  DIAM 0 0 0 0 1 \"\"\n\
    SURF 2\n  CURV -2.2955E-3\n  DISZ 6.008\nSURF 3\n  CURV -4.5020E-2\n  DISZ 1\n  GLAS OLD-F2 0 0 1.62 3.637E+1 0 0 0\n\
    SURF 4\n  STOP\n  CURV 4.9280E-2\n  DISZ 4.750\nSURF 5\n  CURV 1.2546E-2\n  DISZ 2.952\n  GLAS N-SK16 0 0 1.5 40 0\n\
    SURF 6\n  CURV -5.4419E-2\n  DISZ 4.2208E+1\nSURF 7\n  CURV 0\n  DISZ 0\n  DIAM 18\n";

fn lens(text: &str) -> Result<Lens> {
    parse(text.as_bytes(), "triplet.zmx".as_ref(), &[])
}

/// The rims of all fields' bundles pass the apertures, and each aperture touches one.
#[test]
fn missing_semi_diameters_follow_from_field_and_pupil() {
    let lens = lens(TRIPLET).unwrap();
    assert_eq!(lens.half_field_deg(), Some(20.0), "unused fields do not count");
    let at = lens.at(lines::D_NM);
    let pupil = at.paraxial().unwrap().entrance_pupil.unwrap();
    assert!((pupil.diameter_mm - 10.0).abs() < 1e-9);
    let mut heights = [0.0_f64; 6];
    for (field_deg, y) in [(0.0, 4.999), (14.0, -5.0), (14.0, 5.0), (20.0, -5.0), (20.0, 5.0)] {
        let chief = at.chief_ray(field_deg).unwrap();
        let ray = LensRay { origin: chief.origin + DVec3::Y * y, ..chief };
        // Aberrations of the pupil move some rims beyond the rim of the stop.
        let check = if field_deg == 20.0 { ApertureCheck::Enforced } else { ApertureCheck::Ignored };
        at.trace_through(ray, TraceDirection::ToSensor, check, |i, point| {
            heights[i] = heights[i].max(point.y.abs());
        })
        .unwrap();
    }
    for (i, height) in heights.iter().enumerate().filter(|(i, _)| *i != 3) {
        // F and C rays differ slightly from the d ray, so the aperture may be a little wider.
        let semi = lens.surfaces()[i].semi_aperture_mm;
        assert!((1.0..1.02).contains(&(semi / height)), "surface {i}: {semi} {height}");
    }
    let analysis = LensAnalysis::of(&lens, None).unwrap();
    assert!((analysis.paraxial.efl_mm - 50.0).abs() < 1.0, "{}", analysis.paraxial.efl_mm);
}

#[test]
fn an_unknown_glass_has_the_index_of_its_line_and_a_note() {
    let known = lens(TRIPLET).unwrap();
    assert!((known.surfaces()[2].index.nd() - 1.62).abs() < 1e-9);
    assert_eq!(known.notes().len(), 1);
    assert!(known.notes()[0].contains("OLD-F2") && known.notes()[0].contains("36.37"), "{:?}", known.notes());
    // 1.5 and 40 are the placeholder of Zemax, and 0 is no index.
    for placeholder in ["1.5 4.0E+1", "0 0"] {
        let error = lens(&TRIPLET.replace("1.62 3.637E+1", placeholder)).unwrap_err().to_string();
        assert!(error.contains("unknown glass \"OLD-F2\""), "{error}");
    }
}

#[test]
fn the_cone_from_the_object_sets_the_pupil() {
    let text = TRIPLET.replace("ENPD 1.0E+1", "OBNA 0.05 0").replace("DISZ INFINITY", "DISZ 100");
    let lens = lens(&text).unwrap();
    let pupil = lens.at(lines::D_NM).paraxial().unwrap().entrance_pupil.unwrap();
    let tangent = 0.05_f64.asin().tan();
    assert!((pupil.diameter_mm - 2.0 * tangent * (100.0 + pupil.z_mm)).abs() < 1e-9);
    assert!(lens.notes().iter().any(|note| note.contains("100 mm in front")), "{:?}", lens.notes());
}

#[test]
fn a_stop_that_floats_needs_its_semi_diameter() {
    let floating = TRIPLET.replace("ENPD 1.0E+1", "FLOA");
    let error = lens(&floating).unwrap_err().to_string();
    assert!(error.contains("the size of the stop is not stated") && error.contains("triplet.zmx:26:1"), "{error}");
    let lens = lens(&floating.replace("  STOP\n", "  STOP\n  DIAM 3.5\n")).unwrap();
    assert_eq!(lens.surfaces()[3].semi_aperture_mm, 3.5);
}

#[test]
fn image_heights_become_field_angles() {
    let lens = lens(&TRIPLET.replace("FTYP 0", "FTYP 2")).unwrap();
    let focal_mm = lens.at(lines::D_NM).paraxial().unwrap().efl_mm;
    assert!((lens.half_field_deg().unwrap() - (20.0 / focal_mm).atan().to_degrees()).abs() < 1e-9);
}

#[test]
fn a_central_obscuration_blocks_the_middle() {
    for operand in ["OBSC 0 2 0", "CLAP 2 9 0"] {
        let lens = lens(&TRIPLET.replace("  CURV 4.5405E-2", &format!("  {operand}\n  CURV 4.5405E-2"))).unwrap();
        let at = lens.at(lines::D_NM);
        let passes = |y: f64| {
            let ray = LensRay { origin: DVec3::new(0.0, y, -10.0), direction: DVec3::Z };
            at.trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced).is_ok()
        };
        assert!(!passes(0.0) && !passes(1.99) && passes(2.01) && passes(-4.9), "{operand}");
    }
}

/// A model glass with the Abbe number 0 has no dispersion.
#[test]
fn a_model_glass_may_have_no_dispersion() {
    let text = format!(
        "{HEAD}SURF 1\n  STOP\n  CURV 0.02\n  DISZ 5\n  GLAS ___BLANK 1 0 1.6 0 0 0 0 0 0 0\nSURF 2\n  DISZ 90\nSURF 3\n  DISZ 0\n"
    );
    let lens = lens(&text).unwrap();
    for nm in [lines::F_NM, lines::D_NM, lines::C_NM] {
        assert!((lens.at(nm).paraxial().unwrap().efl_mm - 50.0 / 0.6).abs() < 1e-9);
    }
    assert!(lens.notes().iter().any(|note| note.contains("no dispersion")), "{:?}", lens.notes());
}

/// What Zemax accepts and Abbe simplifies is read with a note, and changes no focal length.
#[test]
fn simplifications_are_read_with_a_note() {
    let focal_mm = |lens: &Lens| lens.at(lines::D_NM).paraxial().unwrap().efl_mm;
    let known = focal_mm(&lens(TRIPLET).unwrap());
    for (from, to, words) in [
        ("  CURV 4.5405E-2", "  SQAP 6 8 0\n  CURV 4.5405E-2", "the circle around it replaces the aperture SQAP 6 8"),
        ("  CURV 4.5405E-2", "  CLAP 0 3 0\n  OBDC 0 9\n  CURV 4.5405E-2", "a decentred aperture (OBDC 0 9) blocks no"),
        ("  CURV 4.5405E-2", "  UDAD 1 2\n  CURV 4.5405E-2", "the aperture UDAD 1 2 blocks no light"),
        ("  STOP\n", "", "marks no aperture stop, so the first surface"),
        ("  CURV 0\n  DISZ 0", "  CURV 1e-3\n  DISZ 0", "the image surface is curved"),
        ("DIAM 0 0 0 0 1", "DIAM 30 0 0 0 1", "the semi-diameter of the surface of line 14 is"),
    ] {
        let text = TRIPLET.replacen(from, to, 1);
        assert_ne!(text, TRIPLET);
        let lens = lens(&text).unwrap();
        assert!(lens.notes().iter().any(|note| note.contains(words)), "{words}: {:?}", lens.notes());
        assert!((focal_mm(&lens) / known - 1.0).abs() < 1e-12, "{words}");
    }
    let wide = lens(&TRIPLET.replace("  CURV 4.5405E-2", "  SQAP 6 8 0\n  CURV 4.5405E-2")).unwrap();
    assert!((wide.surfaces()[0].semi_aperture_mm - 10.0).abs() < 1e-12);
}

#[test]
fn idle_coordinate_breaks_leave_a_lens() {
    let idle = "SURF 9\n  TYPE COORDBRK\n  PARM 3 0\n  PARM 6 1\n  DISZ 2\n";
    let text = TRIPLET.replace("  DISZ 4.750\n", &format!("  DISZ 2.750\n{idle}"));
    assert_eq!(lens(&text).unwrap(), lens(TRIPLET).unwrap());
}

/// The first surface has the smallest semi-diameter for its ray height.
#[test]
fn other_semi_diameters_size_a_stop_without_one() {
    let text = TRIPLET.replace("ENPD 1.0E+1", "FLOA").replace("DIAM 0 0 0", "DIAM 5 0 0");
    let lens = lens(&text).unwrap();
    let pupil = lens.at(lines::D_NM).paraxial().unwrap().entrance_pupil.unwrap();
    assert!((pupil.diameter_mm - 10.0).abs() < 1e-6, "{pupil:?}");
    assert!(lens.notes().iter().any(|note| note.contains("does not state the size of the stop")), "{:?}", lens.notes());
}

/// Zemax wrote UTF-16 with and without a byte order mark, UTF-8 with one, and Latin-1.
#[test]
fn all_encodings_give_the_same_lens() {
    let text = TRIPLET.replace("NAME Triplet", "NAME Tripl\u{e9}t");
    let known = lens(&text).unwrap();
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = [0xFE, 0xFF].into_iter().chain(text.encode_utf16().flat_map(u16::to_be_bytes)).collect();
    let marked: Vec<u8> = [0xEF, 0xBB, 0xBF].into_iter().chain(text.bytes()).collect();
    let latin: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
    for bytes in [little, big, marked, latin] {
        assert_eq!(parse(&bytes, "triplet.zmx".as_ref(), &[]).unwrap(), known);
    }
}

/// The values of a glass that Zemax may substitute (3) can belong to another glass.
#[test]
fn the_index_of_a_substituted_glass_is_not_used() {
    let error = lens(&TRIPLET.replace("OLD-F2 0 0", "OLD-F2 3 0")).unwrap_err().to_string();
    assert!(error.contains("unknown glass \"OLD-F2\"") && error.contains("triplet.zmx"), "{error}");
}

/// Damaged files give errors or lenses, and no panic.
#[test]
fn damaged_files_never_panic() {
    let mirrors = format!(
        "{HEAD}SURF 1\n  STOP\n  CURV -0.005\n  CONI -1\n  DISZ -100\n  GLAS MIRROR\n  OBSC 0 4\nSURF 2\n  TYPE COORDBRK\n  PARM 3 45\n  DISZ 9\nSURF 3\n  DISZ 0\n"
    );
    let sequence = "RDM;LEN\nTITLE 'a b'\nEPD 5; DIM M\nYAN 0 &\n 3\nSO 0 1e14\nS 50 5 NBK7_SCHOTT\nSTO\nCIR OBS 1\nK -0.5\nA 1e-6\nS -80 45\nTHI S1 4\nSI 0 0\n";
    let oslo = "LEN NEW \"a b\" 100 3\nEBR 5; ANG 3\nUNI 1\nTH 1e20\nNXT\nGLA MOD G 1.5168 1.5224 1.5143\nRD 50\nTH 5\nAP CHK 9\nNXT\nAST\n\
        PK CVM -1 -0.001\nCC -0.5\nAD 1e-6\nTH 45\nNXT\nEND 3\n";
    let bench = "[variable distances]\nF-Number\t9\nAngle of View\t6\nd1\t5\t6\nBf\t45\n[lens data]\n1\t50\td1\t1.5168\t18\t64.2\n\
        2\tAS\t1\t\t15\n3\t-80\tBf\t\t18\n[aspherical data]\n3\t-80\t-0.5\t1e-6\n";
    let words = [
        "",
        "-1",
        "0",
        "1e308",
        "TYPE TOROIDAL",
        "TYPE DGRATING",
        "TYPE SZERNSAG",
        "XDAT 999 1",
        "-1e308",
        "INFINITY",
        "NaN",
        "x",
        "SURF",
        "\u{e9}",
        "GLAS",
        "PARM 8 1",
        "DIAM 1e9",
        "S",
        "SO",
        "&",
        "'",
        "\t",
        "\"",
        "NXT",
        "PK TH 0",
        "Infinity",
        "d1",
    ];
    // A linear congruential generator (Numerical Recipes) makes the choices reproducible.
    let mut state = 1_u32;
    let mut below = |count: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % count.max(1)
    };
    let others = format!(
        "MNUM 2 1\n{HEAD}SURF 1\n  STOP\n  TYPE BICONICX\n  PARM 1 9\n  SCBD 1 0 0 0 0 5 0 0\n  DISZ 5\n  GLAS F2\nSURF 2\n  TYPE FZERNSAG\n  XDAT 1 2\n  XDAT 2 9\n  XDAT 4 1e-3\nSURF 3\n  TYPE PARAXIAL\n  PARM 1 9\nSURF 4\n  TYPE XPOLYNOM\n  XDAT 1 3\n  XDAT 2 9\n  XDAT 5 1\nSURF 5\n  TYPE BINARY_2\n  DISZ 4\nSURF 6\n  DISZ 0\n"
    );
    let files = [
        (TRIPLET, "a.zmx"),
        (&mirrors, "a.zmx"),
        (&others, "a.zmx"),
        (sequence, "a.seq"),
        (oslo, "a.len"),
        (bench, "a.txt"),
    ];
    for (text, path) in files {
        for _ in 0..300 {
            let mut parts: Vec<&str> = text.split_inclusive([' ', '\t', '\n']).collect();
            for _ in 0..=below(3) {
                if parts.is_empty() {
                    break;
                }
                let at = below(parts.len());
                match below(4) {
                    0 => drop(parts.remove(at)),
                    1 => parts.insert(at, parts[below(parts.len())]),
                    2 => parts.truncate(at),
                    _ => parts.splice(at..at, [" ", words[below(words.len())], " "]).for_each(drop),
                }
            }
            let mut bytes = parts.concat().into_bytes();
            if below(4) == 0 && !bytes.is_empty() {
                let at = below(bytes.len());
                bytes[at] ^= 1 << below(8);
            }
            if let Err(error) = parse_system(&bytes, path.as_ref(), &[]) {
                assert_eq!(error.exit_status(), 2, "{error}");
            }
        }
    }
}

pub(super) fn folded(text: &str) -> FoldedSystem {
    match parse_system(text.as_bytes(), "mirror.zmx".as_ref(), &[]).unwrap() {
        ZmxSystem::Folded(system) => system,
        ZmxSystem::Lens(_) => panic!("found a lens"),
    }
}

const HEAD: &str = "MODE SEQ\nUNIT MM\nENPD 20\nFTYP 0 0 2 1\nYFLN 0 0.5\nSURF 0\n  DISZ INFINITY\n";

/// A paraboloid has no spherical aberration, and a focal length of half of its radius.
#[test]
fn a_paraboloid_focuses_parallel_light_to_a_point() {
    let surface = "SURF 1\n  STOP\n  CURV -0.005\n  CONI -1\n  DISZ -100\n  GLAS MIRROR 0 0 1.5 40\n  DIAM 10\n";
    let system = folded(&format!("{HEAD}{surface}SURF 2\n  DISZ 0\n"));
    let analysis = system.analysis(AnalysisConditions::default()).unwrap();
    assert!(analysis.efl_mm.iter().all(|efl| (efl.unwrap() - 100.0).abs() < 1e-6), "{:?}", analysis.efl_mm);
    assert!(
        (analysis.back_focus_mm[0].unwrap() - 100.0).abs() < 1e-6 && (analysis.image_distance_mm - 100.0).abs() < 1e-9
    );
    assert!((analysis.f_number.unwrap() - 5.0).abs() < 1e-6);
    assert!(analysis.fields[0].rms_mm.iter().all(|rms| *rms < 1e-9), "{:?}", analysis.fields[0]);
    // Coma of a paraboloid at f/5 and 0.5°: the spot is wider than on the axis.
    assert!((analysis.fields[2].centroid_mm.y.abs() / (100.0 * 0.5_f64.to_radians().tan()) - 1.0).abs() < 0.01);
    assert!(analysis.fields[2].rms_mm[1] > 1e-3);
}

/// Two mirrors and a central obscuration. Two conics with common foci are sharp on the axis.
#[test]
fn a_cassegrain_telescope_has_its_focal_length() {
    // Primary f = 100 mm, secondary 70 mm in front of it, magnification 4.
    let (gap, magnification): (f64, f64) = (70.0, 4.0);
    let before = 100.0 - gap;
    let behind = magnification * before;
    let radius = 2.0 / (1.0 / before - 1.0 / behind);
    let conic = -((magnification + 1.0) / (magnification - 1.0)).powi(2);
    let text = format!(
        "{HEAD}SURF 1\n  STOP\n  CURV -0.005\n  CONI -1\n  DISZ -{gap}\n  GLAS MIRROR\n  OBSC 0 4 0\nSURF 2\n  CURV {}\n  CONI {conic}\n\
         DISZ {behind}\n  GLAS MIRROR\nSURF 3\n  DISZ 0\n",
        -1.0 / radius
    );
    let analysis = folded(&text).analysis(AnalysisConditions::default()).unwrap();
    assert!((analysis.efl_mm[0].unwrap() - 400.0).abs() < 1e-3, "{:?}", analysis.efl_mm);
    assert!(
        (analysis.image_distance_mm - behind).abs() < 1e-9
            && (analysis.back_focus_mm[0].unwrap() - behind).abs() < 1e-4
    );
    assert!(analysis.fields[0].rms_mm[1] < 1e-8, "{:?}", analysis.fields[0]);
    // The obscuration covers (4/10)² of the bundle.
    assert!((analysis.fields[0].passing - 0.84).abs() < 0.02, "{}", analysis.fields[0].passing);
}

#[test]
fn a_fold_mirror_changes_no_figure() {
    let lens = "SURF 1\n  STOP\n  CURV 0.01\n  DISZ 5\n  GLAS N-BK7\n  DIAM 10\nSURF 2\n  CURV -0.01\n";
    let straight = parse(
        format!("{HEAD}{lens}  DIAM 10.2\n  DISZ 95\nSURF 3\n  DISZ 0\n").as_bytes(),
        "straight.zmx".as_ref(),
        &[],
    );
    let straight = straight.unwrap();
    let at = straight.at(lines::D_NM);
    for tilt in [45.0, -45.0] {
        let turn = format!("  TYPE COORDBRK\n  PARM 3 {tilt}\n");
        let text = format!(
            "{HEAD}{lens}  DISZ 40\nSURF 3\n{turn}  DISZ 0\nSURF 4\n  GLAS MIRROR\n  DISZ 0\nSURF 5\n{turn}  DISZ -55\nSURF 6\n  DISZ 0\n"
        );
        let system = folded(&text);
        let analysis = system.analysis(AnalysisConditions::default()).unwrap();
        assert!((analysis.efl_mm[0].unwrap() - at.paraxial().unwrap().efl_mm).abs() < 1e-5, "{:?}", analysis.efl_mm);
        assert!((analysis.image_distance_mm - 55.0).abs() < 1e-9);
        // The light leaves along +y for a positive tilt about x, and along −y for a negative one.
        let image = system.image.translation;
        assert!((image.y - 55.0_f64.copysign(tilt)).abs() < 1e-9 && (image.z - 45.0).abs() < 1e-9, "{image}");
        let spot = at.spot(at.chief_ray(0.5).unwrap(), 100.0).unwrap().unwrap();
        let found = &analysis.fields[2];
        assert!((found.rms_mm[1] / spot.rms_mm - 1.0).abs() < 0.02, "{found:?} {spot:?}");
        assert!((found.centroid_mm.y.abs() - spot.centroid_mm.abs()).abs() < 1e-3);
    }
}

#[test]
fn the_order_of_a_coordinate_break_is_respected() {
    let text = |order: u32| {
        let turn = format!("  TYPE COORDBRK\n  PARM 2 10\n  PARM 3 90\n  PARM 6 {order}\n");
        format!("{HEAD}SURF 1\n  STOP\n  DISZ 0\nSURF 2\n{turn}  DISZ 0\nSURF 3\n  DISZ 0\n")
    };
    // A rotation by 90° about x turns y into z.
    let image = |order: u32| folded(&text(order)).image.translation;
    assert!((image(0) - DVec3::new(0.0, 10.0, 0.0)).length() < 1e-12, "{}", image(0));
    assert!((image(1) - DVec3::new(0.0, 0.0, 10.0)).length() < 1e-12, "{}", image(1));
}

/// A lens in front of a tilted and shifted plate, with the values of optiland 0.6.3 for the same
/// rays (`tests/golden/make_folded.py`).
#[test]
fn a_tilted_plate_shifts_and_blurs_the_image_as_computed_elsewhere() {
    let text = "MODE SEQ\nUNIT MM\nENPD 10\nFTYP 0 0 2 1\nYFLN 0 2\nSURF 0\n  DISZ INFINITY\n\
        SURF 1\n  STOP\n  CURV 0.02\n  DISZ 5\n  GLAS ___BLANK 1 0 1.5168 64.17\nSURF 2\n  CURV -0.02\n  DISZ 10\n\
        SURF 3\n  TYPE COORDBRK\n  PARM 2 1\n  PARM 3 20\n  DISZ 0\nSURF 4\n  DISZ 8\n  GLAS ___BLANK 1 0 1.67271 32.2\n\
        SURF 5\n  DISZ 0\nSURF 6\n  TYPE COORDBRK\n  PARM 2 -1\n  PARM 3 -20\n  PARM 6 1\n  DISZ 30\nSURF 7\n  DISZ 0\n";
    let analysis = folded(text).analysis(AnalysisConditions::default()).unwrap();
    for (field, height, rms) in [(0, 1.564_556_752, 0.211_356_567), (2, 3.168_357_489, 0.212_245_149)] {
        let found = &analysis.fields[field];
        assert!((found.centroid_mm.y - height).abs() < 1e-6 && found.centroid_mm.x.abs() < 1e-9, "{found:?}");
        assert!((found.rms_mm[1] - rms).abs() < 1e-6 && found.passing == 1.0, "{found:?}");
    }
}
