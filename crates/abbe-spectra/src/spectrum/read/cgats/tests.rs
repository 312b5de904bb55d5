use super::*;
use crate::spectrum::library::SpectrumKind;

/// A chart as i1Profiler exports it: fractions, and names with blanks between tabs.
const CHART: &str = "CGATS.17
ORIGINATOR\t\"i1Profiler\"
NUMBER_OF_FIELDS\t5
BEGIN_DATA_FORMAT
SAMPLE_ID\tSAMPLE_NAME\tSPECTRAL_NM400\tSPECTRAL_NM500\tSPECTRAL_NM600
END_DATA_FORMAT
NUMBER_OF_SETS\t2
BEGIN_DATA
1\tdark skin\t0.05\t0.06\t0.10
2\tA2\t0.5\t0.6\t0.95
END_DATA
";

/// A file of ArgyllCMS: percent, with bands at wavelengths that the names round.
const TI3: &str = "CTI3   

DESCRIPTOR \"Argyll Calibration Target chart information 3\"
KEYWORD \"DEVICE_CLASS\"
DEVICE_CLASS \"OUTPUT\"
SPECTRAL_BANDS \"4\"
SPECTRAL_START_NM \"400.000000\"
SPECTRAL_END_NM \"410.000000\"

NUMBER_OF_FIELDS 6
BEGIN_DATA_FORMAT
SAMPLE_ID SAMPLE_LOC SPEC_400 SPEC_403
SPEC_407 SPEC_410
END_DATA_FORMAT
NUMBER_OF_SETS 2
BEGIN_DATA
1 \"A1\" 1.0 1.5 2.0 -0.5
2 \"A2\" 80.0 85.5 90.0 92.25 # the paper
END_DATA
CAL
BEGIN_DATA_FORMAT
RGB_I RGB_R
END_DATA_FORMAT
BEGIN_DATA
0 0
END_DATA
";

fn of(text: &str, sample: &str) -> SpectrumSamples {
    parse(text, Some(sample)).unwrap()
}

#[test]
fn a_sample_is_chosen_by_its_identifier_or_name() {
    for name in ["1", "dark skin"] {
        let samples = of(CHART, name);
        assert_eq!((samples.nm, samples.values), (vec![400.0, 500.0, 600.0], vec![0.05, 0.06, 0.10]), "{name}");
    }
    assert_eq!(of(CHART, "A2").values, [0.5, 0.6, 0.95]);
    assert_eq!(of(TI3, "A2").values, [0.8, 0.855, 0.9, 0.9225]);
}

#[test]
fn several_samples_need_a_choice_and_are_listed() {
    let error = parse(CHART, None).unwrap_err();
    assert_eq!(error.location.line_column, Some((8, 1)));
    assert!(error.to_string().contains("1 (dark skin), 2 (A2)"), "{error}");
    let error = parse(CHART, Some("dark-skin")).unwrap_err();
    assert!(error.to_string().contains("unknown sample \"dark-skin\""), "{error}");
    assert_eq!(error.suggestion.as_deref(), Some("dark skin"));
    // One sample needs no choice.
    let single = CHART.replace("1\tdark skin\t0.05\t0.06\t0.10\n", "");
    assert_eq!(parse(&single, None).unwrap(), of(&single, "A2"));
    let twice = CHART.replace("dark skin", "A2");
    assert!(parse(&twice, Some("A2")).unwrap_err().to_string().contains("2 samples with the SAMPLE_NAME"));
    let long: String = (3..100).map(|i| format!("{i}\tB{i}\t0.5\t0.6\t0.95\n")).collect();
    let error = parse(&CHART.replace("END_DATA\n", &format!("{long}END_DATA\n")), None).unwrap_err().to_string();
    assert!(error.contains("40 (B40) and 59 more"), "{error}");
}

/// The values of the whole file decide, so a dark patch in percent is not taken for a fraction.
#[test]
fn percent_and_fractions_are_told_apart_by_the_file() {
    let dark = of(TI3, "A1");
    assert_eq!(dark.values, [0.01, 0.015, 0.02, 0.0]);
    let note = dark.note.unwrap();
    assert!(
        note.contains("values up to 92.25, which are read as percent") && note.contains("1 values below 0"),
        "{note}"
    );
    let note = of(CHART, "A2").note.unwrap();
    assert!(note.contains("values up to 0.95, which are read as fractions"), "{note}");
    // At the limit, a file is in fractions.
    assert_eq!(of(&CHART.replace("0.95", "2"), "A2").values[2], 2.0);
    assert_eq!(of(&CHART.replace("0.95", "2.001"), "A2").values[2], 0.02001);
    // A keyword or the name of the column states the scale.
    let stated = TI3.replace("DEVICE_CLASS \"OUTPUT\"", "SPECTRAL_NORM \"200\"");
    assert_eq!((of(&stated, "A2").values[0], of(&stated, "A2").note), (0.4, None));
    let percent = CHART.replace("SPECTRAL_NM", "SPECTRAL_PCT");
    assert_eq!((of(&percent, "A2").values[0], of(&percent, "A2").note), (0.005, None));
    let decimal = CHART.replace("SPECTRAL_NM", "SPECTRAL_DEC").replace("0.95", "3");
    assert_eq!(of(&decimal, "A2").values[2], 3.0);
}

#[test]
fn argyll_keywords_give_exact_wavelengths() {
    let nm = of(TI3, "A2").nm;
    let exact = [400.0, 400.0 + 10.0 / 3.0, 400.0 + 20.0 / 3.0, 410.0];
    assert!(nm.iter().zip(exact).all(|(nm, exact)| (nm - exact).abs() < 1e-12), "{nm:?}");
}

#[test]
fn emission_keeps_its_scale() {
    let light = TI3.replace("OUTPUT", "DISPLAY").replace("-0.5", "-0.01");
    let samples = of(&light, "A1");
    assert_eq!((samples.values, samples.kind), (vec![1.0, 1.5, 2.0, 0.0], Some(SpectrumKind::Light)));
    let emission = TI3.replace("DEVICE_CLASS \"OUTPUT\"", "MEAS_TYPE \"EMISSION\"");
    assert_eq!(of(&emission, "A2").values[0], 80.0);
    assert_eq!(of(&TI3.replace("CTI3   ", "CCSS"), "A2").kind, Some(SpectrumKind::Light));
    let reflectance = of(TI3, "A2").kind;
    assert_eq!(reflectance, Some(SpectrumKind::Reflectance));
}

#[test]
fn all_names_of_spectral_columns_are_read() {
    let expected = of(CHART, "A2");
    for name in ["SPECTRAL_NM_", "SPECTRAL_", "spectral_nm", "SPEC_", "nm", "NM_"] {
        assert_eq!(of(&CHART.replace("SPECTRAL_NM", name), "A2"), expected, "{name}");
    }
    let suffix = CHART.replace("SPECTRAL_NM400", "400_NM").replace("SPECTRAL_NM", "Spec_");
    assert_eq!(of(&suffix, "A2"), expected);
    let pairs = "IT8.7/3\nBEGIN_DATA_FORMAT\nSAMPLE_ID SPECTRAL_NM SPECTRAL_PCT SPECTRAL_NM SPECTRAL_PCT SPECTRAL_NM \
                 SPECTRAL_PCT\nEND_DATA_FORMAT\nBEGIN_DATA\nA2 400 50,0 500 60,0 600\n 95,0\nEND_DATA\n";
    let pairs = parse(pairs, None).unwrap();
    assert_eq!((&pairs.nm, &pairs.values), (&expected.nm, &expected.values));
}

#[test]
fn errors_name_line_and_column() {
    for (from, to, place, word) in [
        ("0.6\t0.95", "0.6", (10, 1), "a row of 4 values"),
        ("0.95", "0.95\t1", (10, 1), "a row of 6 values"),
        ("0.95", "white", (10, 14), "\"white\""),
        ("0.95", "nan", (10, 14), "NaN"),
        ("0.95", "-0.5", (10, 14), "negative"),
        ("SPECTRAL_NM", "DENSITY_", (5, 1), "DENSITY_400"),
        ("NM500", "NM400", (10, 10), "twice"),
        ("NM600", "NM450", (10, 14), "ascending"),
        ("NM", "NM0.0", (10, 6), "wavelengths in nm"),
        ("END_DATA\n", "", (10, 1), "END_DATA"),
        ("END_DATA_FORMAT\n", "", (10, 1), "END_DATA_FORMAT"),
        ("BEGIN_DATA\n", "", (10, 1), "BEGIN_DATA"),
        ("\"i1Profiler\"", "\"i1Profiler", (2, 12), "quotation mark"),
    ] {
        let error = parse(&CHART.replace(from, to), Some("A2")).unwrap_err();
        assert_eq!(error.location.line_column, Some(place), "{from}: {error}");
        assert!(error.to_string().contains(word), "{word}: {error}");
    }
    for (from, to, place, word) in [
        ("BANDS \"4\"", "BANDS \"5\"", (6, 16), "4, the number of spectral columns"),
        ("410.000000", "420.000000", (12, 31), "SPEC_403"),
        ("SPECTRAL_BANDS \"4\"", "SPECTRAL_NORM \"0\"", (6, 15), "above 0"),
    ] {
        let error = parse(&TI3.replace(from, to), Some("A2")).unwrap_err();
        assert_eq!(error.location.line_column, Some(place), "{from}: {error}");
        assert!(error.to_string().contains(word), "{word}: {error}");
    }
    assert!(parse("", None).unwrap_err().to_string().contains("BEGIN_DATA_FORMAT"));
}

#[test]
fn only_texts_with_a_data_format_are_cgats() {
    assert!(is_cgats(CHART) && is_cgats(TI3));
    assert!(!is_cgats("nm,value\n400,1\n500,1\n") && !is_cgats(""));
}

/// Files with changed, cut off or doubled bytes are read, or refused with a place.
#[test]
fn damaged_files_are_refused_with_a_place() {
    let mut state = 9_u64;
    let mut below = |limit: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % limit
    };
    let signs = "\0\t\n \"#-.,019eEnNSA_\u{fffd}";
    for good in [CHART, TI3] {
        let mut read = 0;
        for _ in 0..300 {
            let mut text: Vec<char> = good.chars().collect();
            for _ in 0..1 + below(3) {
                let at = below(text.len());
                text[at] = signs.chars().nth(below(signs.chars().count())).unwrap();
            }
            if below(5) == 0 {
                text.truncate(below(text.len()));
            }
            match parse(&text.into_iter().collect::<String>(), Some("A2")) {
                Ok(_) => read += 1,
                Err(error) => assert!(error.location.line_column.is_some(), "{error}"),
            }
        }
        assert!(read > 30 && read < 270, "{read}");
    }
}
