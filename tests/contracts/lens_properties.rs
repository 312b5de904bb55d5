//! Properties of every lens: rays are reversible, impossible prescriptions are refused with a
//! reason, and foci have their known positions.

use abbe_format as format;
use abbe_format::resolve::lone_lens;
use abbe_optics::glass::{AgfCatalogue, RefractiveIndex, lines};
use abbe_optics::lens::{
    ApertureCheck, ApertureSpec, Lens, LensAnalysis, LensRay, LensSurface, Prescription, RayLoss, SurfaceProfile,
    TraceDirection, catalogue, medium, zemax,
};
use glam::DVec3;
use proptest::prelude::*;

/// Makes a lens from (radius, thickness, medium behind, semi-aperture), all in mm.
fn prescription(surfaces: &[(f64, f64, &str, f64)]) -> Prescription {
    let surface = |&(radius_mm, thickness_mm, name, semi_aperture_mm): &(f64, f64, &str, f64)| LensSurface {
        profile: SurfaceProfile::sphere(radius_mm),
        thickness_mm,
        index: medium(name).unwrap(),
        semi_aperture_mm,
        obscuration_mm: 0.0,
        coating: None,
    };
    Prescription {
        name: "test".to_string(),
        source: None,
        surfaces: surfaces.iter().map(surface).collect(),
        stop: Some(0),
        opening: ApertureSpec::Stop,
        half_field_deg: None,
        notes: Vec::new(),
    }
}

const SINGLET: [(f64, f64, &str, f64); 2] = [(50.0, 5.0, "N-BK7", 10.0), (-50.0, 0.0, "air", 10.0)];

#[track_caller]
fn refused(prescription: Prescription, words: &[&str]) {
    let error = Lens::new(prescription).unwrap_err();
    let text = error.to_string();
    assert!(words.iter().all(|word| text.contains(word)) && error.exit_status() == 2, "{text}");
}

#[test]
fn impossible_prescriptions_are_refused_by_surface() {
    refused(prescription(&[]), &["surfaces: found a lens of 0 surfaces", "1 to 64"]);
    refused(prescription(&[SINGLET[0]; 65]), &["65 surfaces"]);
    refused(Prescription { stop: None, ..prescription(&SINGLET) }, &["no stop", "aperture stop"]);
    refused(Prescription { stop: Some(7), ..prescription(&SINGLET) }, &["no stop"]);
    refused(
        prescription(&[(50.0, 5.0, "N-BK7", 10.0), (-50.0, -1.0, "air", 10.0)]),
        &["surfaces[1]", "thickness of -1"],
    );
    refused(prescription(&[(50.0, f64::NAN, "N-BK7", 10.0)]), &["surfaces[0]", "thickness of NaN"]);
    refused(prescription(&[(f64::NAN, 5.0, "N-BK7", 10.0)]), &["surfaces[0]", "not finite"]);
    refused(prescription(&[(50.0, 5.0, "N-BK7", 0.0)]), &["surfaces[0]", "semi-aperture of 0"]);
    refused(prescription(&[(8.0, 5.0, "N-BK7", 10.0)]), &["surfaces[0]", "is not defined up to", "radius"]);
    // A biconvex lens of 1 mm between surfaces with a sag of 1 mm each: they meet at the rim.
    let sharp = prescription(&[(50.0, 1.0, "N-BK7", 10.0), (-50.0, 0.0, "air", 10.0)]);
    refused(sharp, &["surfaces[0]", "crosses the next one", "larger thickness"]);
    refused(Prescription { half_field_deg: Some(120.0), ..prescription(&SINGLET) }, &["half field"]);
    for diameter_mm in [0.0, f64::NAN] {
        let opening = ApertureSpec::EntrancePupil { diameter_mm };
        refused(Prescription { opening, ..prescription(&SINGLET) }, &["entrance pupil", "positive semi-aperture"]);
    }
    assert!(medium("N-BK8").unwrap_err().to_string().contains("unknown glass \"N-BK8\""));
}

#[test]
fn lenses_that_form_no_image_say_so() {
    let analysis =
        |surfaces| LensAnalysis::of(&Lens::new(prescription(surfaces)).unwrap(), None).unwrap_err().to_string();
    let diverging = analysis(&[(-50.0, 5.0, "N-BK7", 10.0), (50.0, 0.0, "air", 10.0)]);
    assert!(diverging.contains("forms no image behind it"), "{diverging}");
    let pane = analysis(&[(0.0, 5.0, "N-BK7", 10.0), (0.0, 0.0, "air", 10.0)]);
    assert!(pane.contains("no power"), "{pane}");
    let inside = analysis(&[(5.0, 30.0, "N-BK7", 4.0), (-5.0, 0.0, "air", 4.0)]);
    assert!(inside.contains("forms no image behind it"), "{inside}");
    let mut stopped = prescription(&SINGLET);
    stopped.surfaces.insert(
        0,
        LensSurface {
            semi_aperture_mm: 1.0,
            thickness_mm: 100.0,
            ..prescription(&[(0.0, 0.0, "air", 1.0)]).surfaces.remove(0)
        },
    );
    let dark = LensAnalysis::of(&Lens::new(stopped).unwrap(), Some(30.0)).unwrap_err().to_string();
    assert!(dark.contains("every ray is vignetted") && dark.contains("smaller field"), "{dark}");
}

#[test]
fn the_image_recedes_as_the_object_approaches() {
    for lens in catalogue::all() {
        let at = lens.at(lines::D_NM);
        let paraxial = at.paraxial().unwrap();
        let mut before_mm = at.image_distance_mm(f64::INFINITY).unwrap();
        for times in [1e6, 100.0, 30.0, 10.0] {
            let object_mm = times * paraxial.efl_mm - paraxial.front_focus_z_mm;
            let distance_mm = at.image_distance_mm(object_mm).unwrap();
            // Newton's equation: the image lies f²/x behind the focus.
            let newton_mm = paraxial.bfd_mm + paraxial.efl_mm / times;
            assert!((distance_mm - newton_mm).abs() < 1e-9 * newton_mm && distance_mm > before_mm, "{}", lens.name());
            before_mm = distance_mm;
        }
        for object_mm in [-paraxial.front_focus_z_mm, 0.0, -1.0, f64::NAN] {
            let error = at.image_distance_mm(object_mm).unwrap_err().to_string();
            assert!(error.contains("cannot focus on an object") && error.contains("a distance above"), "{error}");
        }
    }
    // Another wavelength has another focus.
    let singlet = catalogue::find("singlet").unwrap();
    let [f, c] = [lines::F_NM, lines::C_NM].map(|nm| singlet.at(nm).image_distance_mm(1000.0).unwrap());
    assert!(f < c - 1.0);
}

#[test]
fn stopping_down_narrows_the_stop_and_never_opens_it() {
    let lens = catalogue::find("double-gauss").unwrap();
    let stopped = lens.stopped_down(8.0).unwrap();
    assert!((stopped.at(lines::D_NM).paraxial().unwrap().f_number.unwrap() - 8.0).abs() < 1e-12);
    let error = lens.stopped_down(1.0).unwrap_err().to_string();
    assert!(error.contains("f/1") && error.contains("at least 2.0"), "{error}");
    assert!(
        lens.stopped_down(f64::NAN).is_err() && lens.stopped_down(0.0).is_err() && lens.stopped_down(-2.0).is_err()
    );
}

#[test]
fn lost_rays_say_where_and_why() {
    let ball = Lens::new(prescription(&[(5.0, 10.0, "N-SF11", 5.0), (-5.0, 0.0, "air", 5.0)])).unwrap();
    let at = ball.at(lines::D_NM);
    let ray = |y, direction: DVec3| LensRay { origin: DVec3::new(0.0, y, -5.0), direction: direction.normalize() };
    assert_eq!(
        at.trace(ray(5.5, DVec3::Z), TraceDirection::ToSensor, ApertureCheck::Enforced),
        Err(RayLoss::Missed(0))
    );
    let narrow = ball.stopped_down(4.0).unwrap();
    let edge = narrow.at(lines::D_NM).trace(ray(3.0, DVec3::Z), TraceDirection::ToSensor, ApertureCheck::Enforced);
    assert_eq!(edge, Err(RayLoss::Vignetted(0)));
    assert!(narrow.at(lines::D_NM).trace(ray(3.0, DVec3::Z), TraceDirection::ToSensor, ApertureCheck::Ignored).is_ok());
    // From inside a plano-convex lens, at height 1.5 mm of 2 mm, the angle in the glass exceeds the
    // critical angle.
    let dome = Lens::new(prescription(&[(0.0, 2.0, "N-SF11", 1.9), (-2.0, 0.0, "air", 1.9)])).unwrap();
    let lost = dome.at(lines::D_NM).trace(ray(1.5, DVec3::Z), TraceDirection::ToSensor, ApertureCheck::Enforced);
    assert_eq!(lost, Err(RayLoss::Reflected(1)));
    let odd = LensRay { origin: DVec3::NAN, direction: DVec3::Z };
    assert_eq!(at.trace(odd, TraceDirection::ToSensor, ApertureCheck::Enforced), Err(RayLoss::Missed(0)));
}

#[test]
fn an_ellipsoid_of_glass_focuses_without_spherical_aberration() {
    // Descartes: an ellipsoid of eccentricity 1/n refracts parallel light exactly to its far focus.
    let n = 1.5;
    let profile = SurfaceProfile { curvature_per_mm: 1.0 / 20.0, conic: -1.0 / (n * n), even_terms: [].into() };
    let surface = LensSurface {
        profile,
        thickness_mm: 0.0,
        index: RefractiveIndex::constant(n).unwrap(),
        semi_aperture_mm: 12.0,
        obscuration_mm: 0.0,
        coating: None,
    };
    let lens = Lens::new(Prescription { surfaces: vec![surface], ..prescription(&SINGLET) }).unwrap();
    let at = lens.at(500.0);
    let focus_mm = at.image_distance_mm(f64::INFINITY).unwrap();
    assert!((focus_mm - 20.0 * n / (n - 1.0)).abs() < 1e-12);
    for y in [0.1, 3.0, 11.9] {
        let ray = LensRay { origin: DVec3::new(0.0, y, -9.0), direction: DVec3::Z };
        let out = at.trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced).unwrap();
        assert!(out.at_z(focus_mm).truncate().length() < 1e-12, "{y}");
    }
}

#[test]
fn the_middle_of_every_bundle_passes_and_comes_back() {
    for lens in catalogue::all() {
        for share in [0.0, 0.5, 1.0] {
            let at = lens.at(lines::D_NM);
            let chief = at.chief_ray(share * lens.half_field_deg().unwrap()).unwrap();
            let out = at.trace(chief, TraceDirection::ToSensor, ApertureCheck::Enforced).unwrap();
            let turned = LensRay { origin: out.origin, direction: -out.direction };
            let back = at.trace(turned, TraceDirection::ToScene, ApertureCheck::Enforced).unwrap();
            assert!((back.direction + chief.direction).length() < 1e-12, "{}", lens.name());
        }
    }
}

proptest! {
    #[test]
    fn rays_go_back_the_way_they_came(
        lens in 0..10_usize, x in -1.0..1.0, y in -1.0..1.0, tilt in -0.5..0.5, nm in 380.0..780.0,
    ) {
        let lens = &catalogue::all()[lens];
        let at = lens.at(nm);
        let pupil = at.paraxial().unwrap().entrance_pupil.unwrap();
        let radius_mm = 0.5 * pupil.diameter_mm;
        let field: f64 = tilt * lens.half_field_deg().unwrap().to_radians();
        let (sin, cos) = field.sin_cos();
        let origin = DVec3::new(x * radius_mm, y * radius_mm, pupil.z_mm);
        let ray = LensRay { origin, direction: DVec3::new(0.6 * sin, 0.8 * sin, cos) };
        if let Ok(out) = at.trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced) {
            let turned = LensRay { origin: out.origin, direction: -out.direction };
            let back = at.trace(turned, TraceDirection::ToScene, ApertureCheck::Enforced).unwrap();
            let scale_mm = lens.length_mm();
            prop_assert!((back.direction + ray.direction).length() < 1e-11);
            prop_assert!((back.at_z(origin.z) - origin).length() < 1e-10 * scale_mm);
        }
    }

    #[test]
    fn a_single_lens_has_the_power_of_the_lensmaker_s_formula(
        c1 in -0.02..0.02, c2 in -0.02..0.02, thickness_mm in 0.5..20.0, n in 1.3..2.0,
    ) {
        let surface = |curvature_per_mm, index, thickness_mm| LensSurface {
            profile: SurfaceProfile { curvature_per_mm, ..SurfaceProfile::default() },
            thickness_mm,
            index: RefractiveIndex::constant(index).unwrap(),
            semi_aperture_mm: 1.0,
            obscuration_mm: 0.0,
        coating: None,
        };
        let power: f64 = (n - 1.0) * (c1 - c2 + (n - 1.0) * thickness_mm * c1 * c2 / n);
        prop_assume!(power.abs() > 1e-5);
        let surfaces = vec![surface(c1, n, thickness_mm), surface(c2, 1.0, 0.0)];
        let lens = Lens::new(Prescription { surfaces, ..prescription(&SINGLET) }).unwrap();
        let paraxial = lens.at(500.0).paraxial().unwrap();
        prop_assert!((paraxial.efl_mm * power - 1.0).abs() < 1e-9);
        let bfd_mm = (1.0 - (n - 1.0) * thickness_mm * c1 / n) / power;
        prop_assert!((paraxial.bfd_mm - bfd_mm).abs() < 1e-9 * paraxial.efl_mm.abs());
        // An exact ray close to the axis has the same focus.
        let ray = LensRay { origin: DVec3::new(0.0, 1e-4, -1.0), direction: DVec3::Z };
        let out = lens.at(500.0).trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced).unwrap();
        let end_mm = out.at_z(lens.length_mm() + paraxial.bfd_mm).y;
        prop_assert!(end_mm.abs() < 1e-9, "{end_mm}");
    }
}

const ZMX: &str = "VERS 140124 258 36214\nMODE SEQ\nNAME achromat\nUNIT MM X W X CM MR CPMM\nENPD 2.5E+1\nFTYP 0 0 2 3 0 0 0\n\
    YFLN 0 1 0 0\nSURF 0\n  TYPE STANDARD\n  CURV 0.0 0 0 0 0 \"\"\n  DISZ INFINITY\n  DIAM 0 0 0 0 1 \"\"\nSURF 1\n  STOP\n  TYPE STANDARD\n\
    \x20 CURV 1.62680982593E-02 0 0 0 0 \"\"\n  DISZ 6\n  GLAS N-BK7 0 0 1.5168 64.17 0 0 0 0 0 0\n  DIAM 12.5 1 0 0 1 \"\"\nSURF 2\n  TYPE STANDARD\n\
    \x20 CURV -2.24014336918E-02 0 0 0 0 \"\"\n  DISZ 2.5\n  GLAS N-SF5 0 0 1.67 32.2 0 0 0 0 0 0\n  DIAM 12.66 1 0 0 1 \"\"\nSURF 3\n  TYPE EVENASPH\n\
    \x20 CURV -7.69585962752E-03 0 0 0 0 \"\"\n  CONI 0\n  PARM 1 0\n  PARM 2 0\n  DISZ 95.95\n  DIAM 12.53 1 0 0 1 \"\"\nSURF 4\n  TYPE STANDARD\n\
    \x20 CURV 0 0 0 0 0 \"\"\n  DISZ 0\n  DIAM 2 0 0 0 1 \"\"\n";

#[test]
fn a_zemax_file_gives_the_lens_that_the_catalogue_has() {
    let known = catalogue::find("cemented achromat").unwrap();
    let wide: Vec<u8> = [0xFF, 0xFE].into_iter().chain(ZMX.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let inches = ZMX.replace("UNIT MM", "UNIT IN").into_bytes();
    for (bytes, scale) in [(ZMX.as_bytes(), 1.0), (&wide, 1.0), (&inches, 25.4)] {
        let lens = zemax::parse(bytes, "lens.zmx".as_ref(), &[]).unwrap();
        assert_eq!((lens.name(), lens.half_field_deg()), ("achromat", Some(1.0)));
        let [ours, theirs] = [&lens, known].map(|lens| lens.at(lines::D_NM).paraxial().unwrap());
        assert!(
            (ours.efl_mm / scale - theirs.efl_mm).abs() < 1e-7 && (ours.bfd_mm / scale - theirs.bfd_mm).abs() < 1e-7
        );
        assert!((ours.f_number.unwrap() - theirs.f_number.unwrap()).abs() < 1e-8);
    }
}

#[test]
fn a_zemax_file_takes_its_glasses_from_a_catalogue_first() {
    // The coefficients of N-BK7 under the name N-SF5.
    let agf = "NM N-SF5 2 0 1.5168 64.17\nCD 1.03961212 6.00069867E-3 0.231792344 2.00179144E-2 1.01046945 1.03560653E+2\nLD 0.31 2.3\n";
    let file = AgfCatalogue::parse(agf.as_bytes(), "own.agf".as_ref()).unwrap();
    let lens = zemax::parse(ZMX.as_bytes(), "lens.zmx".as_ref(), &[file]).unwrap();
    let [first, second] = [0, 1].map(|i| lens.surfaces()[i].index.nd());
    assert!((first - second).abs() < 1e-12, "{first} {second}");
}

#[test]
fn aspheric_terms_of_a_zemax_file_count_in_its_unit() {
    let asphere = ZMX.replace("CONI 0", "CONI -0.7").replace("PARM 2 0", "PARM 2 1.5E-7").replace("UNIT MM", "UNIT CM");
    let lens = zemax::parse(asphere.as_bytes(), "lens.zmx".as_ref(), &[]).unwrap();
    let (profile, h_cm, c) = (&lens.surfaces()[2].profile, 10.0_f64, -7.69585962752E-03_f64);
    let sag_cm = c * h_cm * h_cm / (1.0 + (1.0 - 0.3 * c * c * h_cm * h_cm).sqrt()) + 1.5e-7 * h_cm.powi(4);
    assert!((profile.sag_mm(100.0 * h_cm * h_cm) - 10.0 * sag_cm).abs() < 1e-10);
}

#[test]
fn what_a_zemax_file_asks_for_in_vain_is_named_with_its_line() {
    for (from, to, words) in [
        ("MODE SEQ", "MODE NSC", &["lens.zmx:2:1", "a non-sequential system", "MODE SEQ"][..]),
        ("UNIT MM", "UNIT FT", &["lens.zmx:4:1", "the unit FT"]),
        ("GLAS N-SF5 0 0 1.67 32.2", "GLAS N-SF500 0 0 1.5 40", &["lens.zmx:24:1", "N-SF500", "did you mean"]),
        ("GLAS N-SF5", "GLAS MIRROR", &["lens.zmx:20:1", "a mirror in a camera lens"]),
        ("TYPE EVENASPH", "TYPE GRINSUR1", &["lens.zmx:27:1", "GRINSUR1", "STANDARD, COORDBRK, EVENASPH"]),
        ("TYPE EVENASPH", "TYPE COORDBRK\n  PARM 3 5", &["lens.zmx:26:1", "a coordinate break in a camera lens"]),
        ("DISZ 2.5", "DISZ -2.5", &["lens.zmx:20:1", "a negative thickness in a camera lens"]),
        ("DISZ 2.5", "DISZ two", &["lens.zmx:23:1", "found \"two\"", "a number"]),
        ("DIAM 12.66", "SQAP 12.66 wide DIAM", &["lens.zmx:25:1", "found \"wide\""]),
        ("ENPD 2.5E+1", "OBNA 1.5 0", &["lens.zmx:5:1", "numerical aperture below 1"]),
        ("ENPD 2.5E+1", "OBNA 0.5 0", &["lens.zmx", "object at infinity", "finite distance"]),
        ("PARM 1 0", "PARM 9 1", &["lens.zmx:26:1", "the parameter 9 with the value 1"]),
    ] {
        let text = ZMX.replace(from, to);
        assert_ne!(text, ZMX);
        let error = zemax::parse(text.as_bytes(), "lens.zmx".as_ref(), &[]).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
    for bytes in [&b""[..], b"SURF 0\nSURF 1\n", b"\xFF\x00\x80", b"\xFF\xFE"] {
        assert_eq!(zemax::parse(bytes, "lens.zmx".as_ref(), &[]).unwrap_err().exit_status(), 2);
    }
}

#[test]
fn a_prescription_in_json_is_read_as_a_scene_holds_it() {
    let lens = |text: &str| {
        let (prescription, source) = format::parse_prescription(text, "lens.json".as_ref())?;
        lone_lens(&prescription, &source)
    };
    let good = r#"{"surfaces": [
        {"radius_mm": 100, "thickness_mm": 5, "ior": "N-BK7", "semi_aperture_mm": 10, "stop": true},
        {"radius_mm": -100, "thickness_mm": 96.6, "ior": 1, "semi_aperture_mm": 10.2}]}"#;
    let [ours, known] =
        [lens(good).unwrap(), lens("\"singlet\"").unwrap()].map(|lens| lens.at(lines::D_NM).paraxial().unwrap());
    assert_eq!((ours.efl_mm, ours.f_number), (known.efl_mm, known.f_number));
    assert_eq!(
        lens(&good.replace(": 1,", ": \"air\",")).unwrap().at(500.0).paraxial(),
        lens(good).unwrap().at(500.0).paraxial()
    );
    for (from, to, words) in [
        ("N-BK7", "N-BK8", &["lens.json:2:", "surfaces[0].ior", "did you mean"][..]),
        (", \"stop\": true", "", &["lens.json:1:", "surfaces: found no stop"]),
        ("\"thickness_mm\": 5", "\"thickness_mm\": 0.1", &["lens.json:2:", "surfaces[0]: the surface crosses"]),
        ("radius", "radios", &["lens.json:2:", "radios"]),
    ] {
        let error = lens(&good.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
    // A paraboloid with an h⁴ term on the curved side of a plano-convex lens: z = h²/2R + a h⁴.
    let asphere = lens(
        r#"{"surfaces": [{"radius_mm": 60, "conic": -1, "aspheric": [2e-7, -1e-11], "thickness_mm": 5, "ior": 1.5, "semi_aperture_mm": 10, "stop": true},
            {"radius_mm": 0, "thickness_mm": 0, "ior": 1, "semi_aperture_mm": 10}]}"#,
    )
    .unwrap();
    let sag_mm = 100.0 / 120.0 + 2e-7 * 1e4 - 1e-11 * 1e6;
    assert!((asphere.surfaces()[0].profile.sag_mm(100.0) - sag_mm).abs() < 1e-14);
    // Descartes: an ellipsoid of conic −1/n² focuses all parallel rays at one point inside its
    // glass, n·R/(n − 1) behind the vertex.
    let oval = lens(
        r#"{"surfaces": [{"radius_mm": 30, "conic": -0.4444444444444444, "thickness_mm": 0, "ior": 1.5, "semi_aperture_mm": 20, "stop": true}]}"#,
    )
    .unwrap();
    for height in [1.0, 10.0, 19.9] {
        let ray = LensRay { origin: DVec3::new(0.0, height, -10.0), direction: DVec3::Z };
        let out = oval.at(550.0).trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced).unwrap();
        assert!(out.at_z(90.0).y.abs() < 1e-12, "{height}: {}", out.at_z(90.0).y);
    }
    assert!(lens("\"tesar\"").unwrap_err().to_string().contains("did you mean \"Tessar\""));
}
