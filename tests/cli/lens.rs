//! The command `abbe lens`.

use crate::abbe_command::abbe;

const LENS: &str = r#"{"surfaces": [
  {"radius_mm": 100, "thickness_mm": 5, "ior": "N-BK7", "semi_aperture_mm": 10, "stop": true},
  {"radius_mm": -100, "thickness_mm": 0, "ior": 1, "semi_aperture_mm": 10.2}
]}"#;

#[test]
fn a_lens_has_its_stated_figures() {
    let folder = tempfile::tempdir().unwrap();
    let lens = abbe(folder.path(), &["lens", "double-gauss", "--json"]).json();
    // The values come from tests/golden/lenses.json.
    for (key, value) in
        [("efl_mm", 100.0037297), ("bfd_mm", 61.4874933), ("fc_shift_mm", -0.1459071452), ("f_number", 2.000074593)]
    {
        let found = lens[key].as_f64().unwrap();
        assert!((found / value - 1.0).abs() < 1e-6, "{key}: {found}");
    }
    for key in ["name", "source", "length_mm", "entrance_pupil", "exit_pupil", "lines", "half_field_deg", "surfaces"] {
        assert!(!lens[key].is_null(), "{key}");
    }
    let fields = lens["fields"].as_array().unwrap();
    assert_eq!(fields.len(), 3);
    assert!(fields.iter().all(|field| field["spots"][1]["rms_mm"].as_f64().unwrap() > 0.01));
    assert!(fields[0]["distortion"].is_null() && fields[2]["lateral_colour_mm"].is_f64());
    let text = abbe(folder.path(), &["lens", "double-gauss"]);
    for words in ["double Gauss f/2 f100", "focal length    100.0037 mm", "entrance pupil", "14.00°", "µm", "source"]
    {
        assert!(text.out.contains(words), "{}", text.out);
    }
}

#[test]
fn files_are_read_as_built_in_lenses_are() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("own.json"), LENS).unwrap();
    let own = abbe(folder.path(), &["lens", "own.json", "--field", "5", "--json"]).json();
    let known = abbe(folder.path(), &["lens", "singlet", "--json"]).json();
    assert_eq!(own["name"], "own");
    for key in ["efl_mm", "bfd_mm", "fc_shift_mm", "f_number"] {
        assert_eq!(own[key], known[key], "{key}");
    }
    let spot = |lens: &serde_json::Value| lens["fields"][0]["spots"][1]["rms_mm"].as_f64().unwrap();
    assert!((spot(&own) / spot(&known) - 1.0).abs() < 1e-9);
    assert_eq!(own["fields"][2]["angle_deg"], 5.0);
}

/// Bare surfaces of index 1.5 reflect 4 %. A quarter-wave film of index √1.5 reflects nothing at its
/// wavelength, the d line.
#[test]
fn the_transmittance_on_the_axis_follows_from_coatings() {
    let folder = tempfile::tempdir().unwrap();
    let n = 1.5_f64.sqrt();
    let films = format!(r#", "coating": {{"layers": [{{"ior": {n}, "thickness_nm": {}}}]}}"#, 587.5618 / (4.0 * n));
    let surfaces = |films: &str| {
        LENS.replace("\"N-BK7\"", "1.5").replace("10.2", "10").replace(", \"semi", &format!("{films}, \"semi"))
    };
    std::fs::write(folder.path().join("bare.json"), surfaces("")).unwrap();
    std::fs::write(folder.path().join("coated.json"), surfaces(&films)).unwrap();
    let lens = |name: &str| abbe(folder.path(), &["lens", name, "--json"]).json();
    let (bare, coated) = (lens("bare.json"), lens("coated.json"));
    let at = |lens: &serde_json::Value, line: usize| lens["lines"][line]["transmittance"].as_f64().unwrap();
    for line in 0..3 {
        assert!((at(&bare, line) - 0.96 * 0.96).abs() < 1e-12);
    }
    assert!((at(&coated, 1) - 1.0).abs() < 1e-9, "{}", at(&coated, 1));
    assert!(at(&coated, 0) < 0.9995 && at(&coated, 0) > 0.96 && at(&coated, 2) < 0.9999);
    let text = abbe(folder.path(), &["lens", "bare.json"]);
    assert!(text.out.contains("transmittance") && text.out.contains("92.160 %"), "{}", text.out);
}

const AGF: &str = "CC own glasses\nNM OWN-7 2 517642 1.5168 64.17 0 1\nCD 1.03961212 6.00069867E-3 0.231792344 2.00179144E-2 1.01046945 1.03560653E+2 0 0 0 0\n\
    LD 0.31 2.325\nNM ODD 14 0 1.5 60\nCD 1\nLD 0.3 2\n";

const ZMX: &str = "MODE SEQ\nUNIT MM\nGCAT SHOP\nENPD 20\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.01\n  DISZ 5\n  GLAS OWN-7\n  DIAM 10\n\
    SURF 2\n  CURV -0.01\n  DISZ 95\n  DIAM 10.2\nSURF 3\n  DISZ 0\n";

#[test]
fn glasses_come_from_catalogues_named_or_lying_beside() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("own.zmx"), ZMX).unwrap();
    std::fs::write(folder.path().join("mine.agf"), AGF).unwrap();
    abbe(folder.path(), &["lens", "own.zmx"]).is_error(2, &["own.zmx:11:1", "unknown glass \"OWN-7\"", ".agf"]);
    let efl = |arguments: &[&str]| abbe(folder.path(), arguments).json()["efl_mm"].as_f64().unwrap();
    let known = efl(&["lens", "singlet", "--json"]);
    assert!((efl(&["lens", "own.zmx", "--glasses", "mine.agf", "--json"]) / known - 1.0).abs() < 1e-9);
    std::fs::rename(folder.path().join("mine.agf"), folder.path().join("shop.AGF")).unwrap();
    assert!((efl(&["lens", "own.zmx", "--json"]) / known - 1.0).abs() < 1e-9);
    std::fs::write(
        folder.path().join("own.json"),
        LENS.replace("\"N-BK7\"", r#"{"glass": {"path": "shop.AGF", "name": "OWN-7"}}"#),
    )
    .unwrap();
    assert!((efl(&["lens", "own.json", "--json"]) / known - 1.0).abs() < 1e-9);

    let glass = |arguments: &[&str]| abbe(folder.path(), &[&["glass", "--catalogue", "shop.AGF"], arguments].concat());
    let json = glass(&["own-7", "--at", "550", "--json"]).json();
    assert!((json["nd"].as_f64().unwrap() - 1.5168).abs() < 1e-5 && json["sellmeier"]["b"][0] == 1.03961212);
    assert!(json["cauchy"]["max_error"].as_f64().unwrap() < 1e-3 && json["n"][0]["nm"] == 550.0);
    glass(&["ODD"]).is_error(2, &["shop.AGF:5:1", "formula 14 of ODD is not supported", "1 to 13"]);
    glass(&["OWN-8"]).is_error(2, &["unknown glass \"OWN-8\"", "OWN-7"]);
    let list = glass(&["--list"]);
    assert!(list.out.starts_with("OWN-7") && list.err.contains("formula 14 of ODD"), "{} {}", list.out, list.err);
}

/// A folder is searched for the catalogues that the lens names (`GCAT SHOP`), and serves other
/// names only if no built-in catalogue knows them.
#[test]
fn folders_of_catalogues_are_searched() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("own.zmx"), ZMX).unwrap();
    std::fs::create_dir(folder.path().join("glass")).unwrap();
    let catalogue = |name: &str, glass: &str, nd: f64| {
        let text = format!("NM {glass} 5 0 {nd} 60\nCD {nd} 0 0\nLD 0.3 2\n");
        std::fs::write(folder.path().join("glass").join(name), text).unwrap();
    };
    catalogue("any.agf", "OWN-7", 1.6);
    let efl = |arguments: &[&str]| abbe(folder.path(), arguments).json()["efl_mm"].as_f64().unwrap();
    let in_folder = || efl(&["lens", "own.zmx", "--glass-catalogue", "glass", "--json"]);
    let thin = in_folder();
    catalogue("shop.AGF", "OWN-7", 1.5);
    let named = in_folder();
    assert!(named > 1.1 * thin, "{named} {thin}");
    let bk7 = |name: &str| {
        std::fs::write(folder.path().join("own.zmx"), ZMX.replace("OWN-7", name)).unwrap();
        in_folder()
    };
    let built_in = bk7("N-BK7");
    catalogue("any.agf", "N-BK7", 1.9);
    assert_eq!(bk7("N-BK7"), built_in);
    let said = abbe(folder.path(), &["lens", "own.zmx"]);
    assert!(said.err.is_empty(), "{}", said.err);
    bk7("BK7");
    let said = abbe(folder.path(), &["lens", "own.zmx"]);
    assert!(said.err.contains("note: the glass BK7 is not in the catalogues; N-BK7 replaces it"), "{}", said.err);
    abbe(folder.path(), &["lens", "own.zmx", "--glass-catalogue", "none"]).is_error(2, &["none: cannot be read"]);
}

#[test]
fn a_code_v_file_is_analysed() {
    let folder = tempfile::tempdir().unwrap();
    let text = "RDM;LEN\nEPD 20; DIM M\nYAN 0 5\nSO 0 1e13\nS 100 5 NBK7_SCHOTT\nSTO\nS -100 95\nSI 0 0\n";
    std::fs::write(folder.path().join("own.seq"), text).unwrap();
    let own = abbe(folder.path(), &["lens", "own.seq", "--json"]).json();
    let known = abbe(folder.path(), &["lens", "singlet", "--json"]).json();
    assert_eq!(own["efl_mm"], known["efl_mm"]);
    std::fs::write(folder.path().join("bad.seq"), text.replace("STO", "  ADE 3")).unwrap();
    abbe(folder.path(), &["lens", "bad.seq"]).is_error(2, &["bad.seq:6:3", "tilted or decentred"]);
}

/// The singlet of the catalogue as OSLO and the Optical Bench write it, also in a scene.
#[test]
fn files_of_oslo_and_of_the_optical_bench_are_analysed() {
    let folder = tempfile::tempdir().unwrap();
    let oslo = "LEN NEW \"own\" 100 3\nEBR 10\nANG 5\nUNI 1.0\nTH 1e20\nNXT\nGLA N-BK7\nRD 100\nTH 5\nAST\nNXT\nAIR\nPK CVM 1\nPY 0\nNXT\nEND 3\n";
    let bench = "[variable distances]\nF-Number\t4.879020143\nAngle of View\t10\nBf\t95\n[lens data]\n1\tAS\t0\t\t20\n\
        2\t100\t5\t1.5168\t20.4\t64.17\tN-BK7\n3\t-100\tBf\t\t20.4\n";
    std::fs::write(folder.path().join("own.len"), oslo).unwrap();
    std::fs::write(folder.path().join("own.txt"), bench).unwrap();
    let known = abbe(folder.path(), &["lens", "singlet", "--json"]).json();
    for file in ["own.len", "own.txt"] {
        let own = abbe(folder.path(), &["lens", file, "--json"]).json();
        assert_eq!((&own["efl_mm"], &own["half_field_deg"]), (&known["efl_mm"], &5.0.into()), "{file}");
        let f_number = |lens: &serde_json::Value| lens["f_number"].as_f64().unwrap();
        assert!((f_number(&own) / f_number(&known) - 1.0).abs() < 1e-6, "{file}");
        let scene = format!(
            r#"{{"camera": {{"from": [0, 0, 0], "at": [0, 0, 1], "lens": {{"system":
            {{"prescription": "{file}", "focus_distance": 9, "sensor_height_mm": 12}}}}}},
            "film": {{"width": 8, "height": 8}}, "objects": []}}"#
        );
        std::fs::write(folder.path().join("scene.json"), scene).unwrap();
        let checked = abbe(folder.path(), &["check", "scene.json"]);
        assert!(!checked.err.contains(file), "{file}: {}", checked.err);
    }
    std::fs::write(folder.path().join("bad.len"), oslo.replace("AST", "  TLA 3")).unwrap();
    abbe(folder.path(), &["lens", "bad.len"]).is_error(2, &["bad.len:10:3", "TLA is not supported"]);
    std::fs::write(folder.path().join("bad.txt"), bench.replace("Bf\t\t", "Bg\t\t")).unwrap();
    abbe(folder.path(), &["lens", "bad.txt"]).is_error(2, &["bad.txt:8:1", "the thickness \"Bg\""]);
}

#[test]
fn the_section_is_drawn_whole() {
    let folder = tempfile::tempdir().unwrap();
    // At 85°, the bundle of the fisheye is so narrow that its outer rays do not pass in all lines.
    for (name, elements, rays) in
        [("double-gauss", 6, 60), ("singlet", 1, 60), ("cemented achromat", 2, 60), ("fisheye", 9, 56)]
    {
        assert_eq!(abbe(folder.path(), &["lens", name, "--svg", "lens.svg"]).status, 0);
        let svg = std::fs::read_to_string(folder.path().join("lens.svg")).unwrap();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
        assert_eq!(svg.matches("class=\"glass\"").count(), elements, "{name}");
        // Two bundles of five rays in three lines, drawn once in the lens and once in the
        // enlargement.
        assert_eq!(svg.matches("class=\"ray\"").count(), rays, "{name}");
    }
}

const PLOTS: [(&str, &str, usize); 9] = [
    ("section", "focus on the axis", 0),
    ("spots", "RMS ", 0),
    ("ray-fans", "14.00°, sagittal", 18),
    ("mtf", "diffraction limit", 7),
    ("through-focus", "best focus", 7),
    ("field-curves", "distortion in %", 7),
    ("lateral-colour", "radius of the Airy disk", 5),
    ("illumination", "cos⁴", 2),
    ("axial-colour", "chromatic focal shift", 4),
];

#[test]
fn every_plot_is_a_whole_file_with_its_curves() {
    let folder = tempfile::tempdir().unwrap();
    for (plot, words, curves) in PLOTS {
        assert_eq!(abbe(folder.path(), &["lens", "double-gauss", "--svg", "a.svg", "--plot", plot]).status, 0);
        let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
        assert!(
            svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && svg.contains("double Gauss f/2 f100"),
            "{plot}"
        );
        assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.contains(words), "{plot}");
        assert_eq!(svg.matches("class=\"curve\"").count(), curves, "{plot}");
    }
    abbe(folder.path(), &["lens", "double-gauss", "--plot", "mtf"]).is_error(2, &["--svg"]);
    abbe(folder.path(), &["lens", "double-gauss", "--svg", "a.svg", "--plot", "psf"]).is_error(2, &["ray-fans"]);
}

/// The page contains all plots and refers to nothing outside, for a built-in lens, a Zemax file and
/// wavelengths of one's own.
#[test]
fn the_page_of_a_lens_is_whole_and_alone() {
    let folder = tempfile::tempdir().unwrap();
    let zemax = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/abbe-optics/examples/cooke_triplet.zmx");
    for (lens, more, words) in [
        ("cemented", &["--focus", "best"][..], "Lateral colour"),
        (zemax, &["--wavelengths", "450,550"], "550 nm (reference)"),
        ("fisheye", &[], "M. Laikin"),
        // One wavelength has no lateral colour.
        ("singlet", &["--wavelengths", "633"], "633 nm"),
    ] {
        let arguments = [&["lens", lens, "--html", "lens.html"], more].concat();
        assert_eq!(abbe(folder.path(), &arguments).status, 0, "{lens}");
        let page = std::fs::read_to_string(folder.path().join("lens.html")).unwrap();
        assert_eq!(page.matches("</svg>").count(), if lens == "singlet" { 10 } else { 11 }, "{lens}");
        for heading in ["Fields", "Prescription", "Spot diagrams", "Ray fans", "Modulation transfer", "Aberrations"] {
            assert!(page.contains(heading), "{lens}: {heading}");
        }
        assert!(page.contains(words) && !page.contains("NaN"), "{lens}");
        let links = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!links.contains("http") && !links.contains("src="), "{lens}");
    }
}

#[test]
fn wavelengths_and_focus_change_the_figures() {
    let folder = tempfile::tempdir().unwrap();
    let lens = |more: &[&str]| abbe(folder.path(), &[&["lens", "cooke"], more].concat());
    let own = lens(&["--wavelengths", "650,450,550"]).out;
    for words in ["mm at 550 nm", "450' - 650'", "in 450, 550, 650", "ray fans of 550 nm"] {
        assert!(own.contains(words), "{words}: {own}");
    }
    let line = lens(&["--wavelengths", "587.5618", "--json"]).json();
    assert_eq!((&line["lines"][0]["line"], line["lines"].as_array().unwrap().len()), (&"d".into(), 1));
    let spot = |json: &serde_json::Value| {
        let fields = json["fields"].as_array().unwrap().iter();
        fields.map(|field| field["spots"][1]["rms_mm"].as_f64().unwrap().powi(2)).sum::<f64>()
    };
    let (paraxial, best) = (lens(&["--json"]).json(), lens(&["--focus", "best", "--json"]).json());
    assert!(spot(&best) < 0.6 * spot(&paraxial), "{} {}", spot(&best), spot(&paraxial));
    assert_eq!((&paraxial["focus_shift_mm"], &best["focus_shift_mm"]), (&0.0.into(), &best["best_focus_shift_mm"]));
    let shift = best["best_focus_shift_mm"].to_string();
    assert_eq!(lens(&["--focus", &shift, "--json"]).json()["fields"], best["fields"]);
    lens(&["--focus", "-99"]).is_error(2, &["not behind the lens", "at least -42.4"]);
    lens(&["--focus", "near"]).is_error(2, &["a distance in mm", "best"]);
    lens(&["--wavelengths", "400:700:50"]).is_error(2, &["found 7 wavelengths", "1 to 6"]);
    lens(&["--wavelengths", "550,550"]).is_error(2, &["550 nm twice"]);
}

#[test]
fn the_list_names_every_lens() {
    let folder = tempfile::tempdir().unwrap();
    let list = abbe(folder.path(), &["lens", "--list"]);
    assert!(list.out.lines().any(|line| line.starts_with("Tessar f/4.5 ")) && list.err.is_empty());
    let json = abbe(folder.path(), &["lens", "--list", "--json"]).json();
    assert_eq!(json["lenses"].as_array().unwrap().len(), list.out.lines().count());
}

#[test]
fn what_is_no_lens_is_answered_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let lens = |arguments: &[&str]| abbe(folder.path(), &[&["lens"], arguments].concat());
    lens(&["tesar"]).is_error(2, &["unknown lens \"tesar\"", "abbe lens --list", "did you mean \"Tessar\""]);
    lens(&[]).is_error(2, &["NAME|FILE"]);
    lens(&["no/such.json"]).is_error(2, &["no/such.json: cannot be read"]);
    lens(&["no/such.zmx"]).is_error(2, &["no/such.zmx: cannot be read"]);
    lens(&["tessar", "--field", "90"]).is_error(2, &["--field", "below 90"]);
    lens(&["double-gauss", "--field", "60"]).is_error(2, &["no ray at 60 degrees", "a field below 44.3"]);
    lens(&["tessar", "--svg", "no/folder.svg"]).is_error(1, &["no/folder.svg: cannot be written"]);
    for (from, to, words) in [
        ("N-BK7", "N-BK8", &["bad.json:2:", "surfaces[0].ior", "did you mean"][..]),
        (", \"stop\": true", "", &["bad.json:1:", "found no stop"]),
        ("-100", "-9", &["bad.json:3:", "surfaces[1].radius_mm"]),
        ("\"radius_mm\": 100", "\"radius_mm\": -50", &["forms no image"]),
    ] {
        std::fs::write(folder.path().join("bad.json"), LENS.replace(from, to)).unwrap();
        lens(&["bad.json"]).is_error(2, words);
    }
    std::fs::write(folder.path().join("bad.zmx"), "MODE NSC\n").unwrap();
    lens(&["bad.zmx"]).is_error(2, &["bad.zmx:1:1: a non-sequential system"]);
}

#[test]
fn the_image_quality_is_in_the_text_and_in_json() {
    let folder = tempfile::tempdir().unwrap();
    let json = abbe(folder.path(), &["lens", "double-gauss", "--json"]).json();
    for field in json["fields"].as_array().unwrap() {
        let mtf = field["mtf"].as_array().unwrap();
        assert_eq!((mtf.len(), &mtf[0]["cycles_per_mm"]), (4, &10.0.into()));
        let contrast = |i: usize, key: &str| mtf[i][key].as_f64().unwrap();
        assert!(contrast(0, "tangential") > contrast(2, "tangential"), "{field}");
        assert!((0..4).all(|i| contrast(i, "sagittal") <= contrast(i, "diffraction_limit")));
        let fans = field["ray_fans"].as_array().unwrap();
        assert_eq!((fans.len(), &fans[1]["line"]), (3, &"d".into()));
        // The chief ray of the d line is the reference.
        assert!(fans[1]["tangential_mm"][4].as_f64().unwrap().abs() < 1e-12);
    }
    // The values of tests/golden/lens_curves.json at the edge of the field.
    let edge = |key: &str| json["fields"][2][key].as_f64().unwrap();
    assert!((edge("tangential_focus_mm") + 0.36567).abs() < 1e-4 && (edge("sagittal_focus_mm") + 0.53156).abs() < 1e-4);
    assert!(json["fields"][0]["relative_illumination"] == 1.0 && edge("relative_illumination") < 0.7);
    assert!(json["petzval_radius_mm"].as_f64().unwrap() < -300.0, "{}", json["petzval_radius_mm"]);
    let text = abbe(folder.path(), &["lens", "double-gauss"]).out;
    for words in ["MTF (geometric", "10 /mm", "limit ", "ray fans of the d line", "14.00° y"] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn a_system_with_mirrors_is_analysed_but_not_used_in_a_camera() {
    let folder = tempfile::tempdir().unwrap();
    let text = "MODE SEQ\r\nUNIT MM\r\nENPD 20\r\nFTYP 0 0 2 1\r\nYFLN 0 0.5\r\nSURF 0\r\n  DISZ INFINITY\r\nSURF 1\r\n  STOP\r\n\
        \x20 CURV -0.005\r\n  CONI -1\r\n  DISZ -100\r\n  GLAS MIRROR\r\n  OBSC 0 3\r\nSURF 2\r\n  DISZ 0\r\n";
    let wide: Vec<u8> = [0xFF, 0xFE].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    std::fs::write(folder.path().join("dish.ZMX"), wide).unwrap();
    let json = abbe(folder.path(), &["lens", "dish.ZMX", "--json"]).json();
    assert!((json["efl_mm"].as_f64().unwrap() - 100.0).abs() < 1e-5 && json["mirrors"] == 1, "{json}");
    assert!(json["fields"][0]["spots"][1]["rms_mm"].as_f64().unwrap() < 1e-9, "{json}");
    assert!((json["fields"][0]["passing"].as_f64().unwrap() - 0.91).abs() < 0.02, "{json}");
    let said = abbe(folder.path(), &["lens", "dish.ZMX"]).out;
    for words in ["1 of them mirrors", "focal length    100.0000 mm", "f-number        5.0000", "passing"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let line = abbe(folder.path(), &["lens", "dish.ZMX", "--wavelengths=550", "--json"]).json();
    assert_eq!(line["fields"][0]["spots"].as_array().unwrap().len(), 1, "{line}");
    abbe(folder.path(), &["lens", "dish.ZMX", "--focus=best"]).is_error(2, &["at the image plane of its file"]);
    for plot in ["section", "spots", "ray-fans", "mtf", "field-curves"] {
        abbe(folder.path(), &["lens", "dish.ZMX", "--plot", plot, "--svg", "dish.svg", "--html", "dish.html"]);
        let svg = std::fs::read_to_string(folder.path().join("dish.svg")).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"), "{plot}: {svg}");
    }
    let page = std::fs::read_to_string(folder.path().join("dish.html")).unwrap();
    for words in
        ["Spot diagrams", "Ray fans", "Modulation transfer function", "Field curvature", "class=\"sheet\"", "mirror"]
    {
        assert!(page.contains(words), "{words}");
    }
    for plot in ["lateral-colour", "illumination", "axial-colour", "through-focus"] {
        let plotted = abbe(folder.path(), &["lens", "dish.ZMX", "--plot", plot, "--svg", "no.svg"]);
        plotted
            .is_error(2, &["needs a lens with an axis of symmetry", "section, spots, ray-fans, mtf or field-curves"]);
    }
    let scene = r#"{"camera": {"from": [0, 0, 0], "at": [0, 0, 1], "lens": {"system":
        {"prescription": "dish.ZMX", "focus_distance": 9, "sensor_height_mm": 24}}},
        "film": {"width": 8, "height": 8}, "objects": []}"#;
    std::fs::write(folder.path().join("scene.json"), scene).unwrap();
    abbe(folder.path(), &["check", "scene.json"]).is_error(2, &["dish.ZMX:8:1", "a mirror in a camera lens"]);
}
