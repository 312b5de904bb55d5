use super::*;
use crate::luminaire::photometry::{LuminaireSymmetry, OpeningSize};
use abbe_scene::light::OpeningShape;
use std::fmt::Write;

/// A luminaire with the intensities of `rows`: angles C, angles γ, and a function of both.
fn table(c: &[f64], gamma: &[f64], value: impl Fn(f64, f64) -> f64) -> String {
    let mut text = String::new();
    for c in c {
        for gamma in gamma {
            writeln!(text, "<IntData h=\"{c}\" v=\"{gamma}\">{}</IntData>", value(*c, *gamma)).unwrap();
        }
    }
    text
}

/// Cosine of an angle in degrees: the intensity of a Lambertian emitter per cd along the axis.
fn lambert(gamma: f64) -> f64 {
    gamma.to_radians().cos().max(0.0)
}

fn luminaire(emitters: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<IESTM33>\n<Version>1.0</Version>\n<Header><Manufacturer>Example</Manufacturer>\n\
         <Description>Panel\n of  light</Description></Header>\n{emitters}</IESTM33>\n"
    )
}

/// An emitter with 100 cd along its axis. `rest` are its other elements.
fn emitter(rest: &str) -> String {
    let gamma: Vec<f64> = (0..=90).map(f64::from).collect();
    let data = table(&[0.0], &gamma, |_, gamma| 100.0 * lambert(gamma));
    format!(
        "<Emitter>\n<Description>LED</Description>\n<InputWattage>5</InputWattage>\n{rest}\n<LuminousData>\n\
         <LuminousIntensity>\n{data}</LuminousIntensity>\n</LuminousData>\n</Emitter>\n"
    )
}

/// A spectrum of equal power per nm from 400 to 700 nm.
const FLAT: &str = "<SpectralData><EmitterSpectral><NumberWavelength>2</NumberWavelength>\
                    <PwrData w=\"400\">0.5</PwrData><PwrData w=\"700\">0.5</PwrData></EmitterSpectral></SpectralData>";

fn flux(photometry: &Photometry) -> f64 {
    photometry.table().unwrap().flux()
}

fn near(found: f64, expected: f64, relative: f64) {
    assert!((found / expected - 1.0).abs() < relative, "{found} and {expected}");
}

#[test]
fn a_lambertian_emitter_has_pi_times_its_axial_intensity() {
    let photometry = parse(&luminaire(&emitter(FLAT))).unwrap();
    near(flux(&photometry), 100.0 * std::f64::consts::PI, 1e-4);
    assert_eq!(photometry.format, "IES TM-33-18");
    assert_eq!(photometry.name, "Example, Panel of light");
    assert_eq!((photometry.symmetry, photometry.input_watts), (LuminaireSymmetry::Rotational, Some(5.0)));
    let spectrum = photometry.spectrum.unwrap();
    assert_eq!([399.0, 401.0, 699.0, 701.0].map(|nm| spectrum.at(nm)), [0.0, 0.5, 0.5, 0.0]);
    assert_eq!(parse(&luminaire(&emitter(""))).unwrap().spectrum, None);
    let newer = luminaire(&emitter("")).replace("IESTM33", "IESTM33-22");
    assert_eq!(parse(&newer).unwrap().format, "IES TM-33-23");
}

/// The order of the elements does not matter, and the range of C or `Symm` gives the symmetry.
#[test]
fn planes_are_completed_by_their_symmetry() {
    let gamma = [0.0, 30.0, 60.0, 90.0];
    for (range, symmetry, expected) in [
        (vec![0.0, 45.0, 90.0], "Symm_Quad", LuminaireSymmetry::Quadrants),
        (vec![0.0, 90.0, 180.0], "Symm _ Bi _ 0", LuminaireSymmetry::AboutC0),
        (vec![90.0, 180.0, 270.0], "Symm _ Bi _90", LuminaireSymmetry::AboutC90),
        (vec![0.0, 90.0, 180.0, 270.0], "Symm_None", LuminaireSymmetry::None),
        (vec![0.0, 90.0, 180.0, 270.0, 360.0], "Symm_Full", LuminaireSymmetry::None),
    ] {
        let mut rows: Vec<String> =
            table(&range, &gamma, |_, gamma| 100.0 * lambert(gamma)).lines().map(str::to_owned).collect();
        rows.reverse();
        let data = format!("<Multiplier>2</Multiplier><Symm>{symmetry}</Symm>{}", rows.join(""));
        let text =
            format!("<Emitter><LuminousData><LuminousIntensity>{data}</LuminousIntensity></LuminousData></Emitter>");
        let photometry = parse(&luminaire(&text)).unwrap();
        assert_eq!(photometry.symmetry, expected, "{symmetry}");
        // Linear interpolation in steps of 30° loses 2.3 %.
        near(flux(&photometry), 200.0 * std::f64::consts::PI, 0.03);
    }
}

/// 1 W/sr of green light has 683 V(555) cd, and photons at 555 nm carry 0.2155 J/µmol.
#[test]
fn radiant_and_photon_intensities_become_candelas() {
    let narrow = FLAT.replace("400", "554").replace("700", "556");
    let of = |kind: &str, value: f64, from: f64, to: f64| {
        let data = table(&[0.0], &[0.0, 90.0], |_, _| value);
        let text = format!(
            "<Emitter>{narrow}<{kind}Data><MinWavelength>{from}</MinWavelength><MaxWavelength>{to}</MaxWavelength>\
             <{kind}Intensity>{data}</{kind}Intensity></{kind}Data></Emitter>"
        );
        parse(&luminaire(&text)).unwrap().candela[0]
    };
    near(of("Radiant", 1.0, 380.0, 780.0), 683.0, 1e-3);
    near(of("Photon", 1.0, 380.0, 780.0), 683.0 * 0.215_544, 1e-3);
    // Half of the power lies within half of the range.
    near(of("Radiant", 1.0, 555.0, 780.0), 2.0 * 683.0, 1e-3);
    let without = emitter("").replace("Luminous", "Radiant");
    assert!(parse(&luminaire(&without)).unwrap_err().to_string().contains("<RadiantIntensity> without a spectrum"));
}

#[test]
fn spectral_intensities_give_candelas_and_the_spectrum() {
    let mut data = String::new();
    for (nm, value) in [(554.0, 0.5), (556.0, 0.5), (600.0, 0.0)] {
        data += &table(&[0.0], &[0.0, 90.0], |_, gamma| value * lambert(gamma))
            .replace("<IntData", &format!("<IntData w=\"{nm}\""));
    }
    let text = format!("<Emitter><SpectralData><AngularSpectral>{data}</AngularSpectral></SpectralData></Emitter>");
    let photometry = parse(&luminaire(&text)).unwrap();
    let spectrum = photometry.spectrum.clone().unwrap();
    near(spectrum.at(578.0), 0.5 * spectrum.at(555.0), 1e-9);
    let luminous = 683.0 * Observer::cie1931().xyz(&spectrum)[1];
    near(flux(&photometry), luminous, 1e-9);
    near(photometry.candela[0] / spectrum.at(555.0), flux(&photometry) / flux_of_unit() / spectrum.at(555.0), 1e-9);
}

/// The flux of the table of `spectral_intensities_give_candelas_and_the_spectrum` for 1 cd.
fn flux_of_unit() -> f64 {
    let data = table(&[0.0], &[0.0, 90.0], |_, gamma| lambert(gamma));
    let text = format!("<Emitter><LuminousData><LuminousIntensity>{data}</LuminousIntensity></LuminousData></Emitter>");
    flux(&parse(&luminaire(&text)).unwrap())
}

/// If the stated flux is that of all emitters, the intensities are those of one.
#[test]
fn the_luminous_flux_decides_what_the_quantity_means() {
    let four = emitter("<Quantity>4</Quantity><RatedLumens>400</RatedLumens>");
    let one = parse(&luminaire(&four)).unwrap();
    assert_eq!((one.candela[0], one.lamp_lumens, one.input_watts), (100.0, Some(1600.0), Some(5.0)));
    assert!(one.notes[0].contains("the emitter \"LED\": the intensities are those of all 4 emitters together"));
    let stated = |lumens: f64| {
        let end = format!("</LuminousIntensity>\n<LuminousFlux>{lumens}</LuminousFlux>");
        parse(&luminaire(&four.replace("</LuminousIntensity>", &end))).unwrap()
    };
    let all = stated(4.0 * 314.0);
    assert_eq!((all.candela[0], all.input_watts), (400.0, Some(20.0)));
    assert!(all.notes[0].contains("that of 4 emitters"), "{:?}", all.notes);
    assert_eq!(stated(314.0).candela[0], 100.0);
}

#[test]
fn emitters_are_added_with_their_spectra() {
    let blue = FLAT.replace("700", "500");
    let [first, second] = [emitter(FLAT), emitter(&blue)];
    let empty = "<Emitter><Description>driver</Description></Emitter>";
    let photometry = parse(&luminaire(&format!("{first}{second}{empty}"))).unwrap();
    assert_eq!((photometry.candela[0], photometry.input_watts), (200.0, Some(10.0)));
    assert!(
        photometry.notes.iter().any(|note| note.contains("\"driver\" has no intensities")),
        "{:?}",
        photometry.notes
    );
    let spectrum = photometry.spectrum.unwrap();
    // Equal luminous fluxes: the blue emitter needs more power.
    let y = |text: &str| Observer::cie1931().xyz(&parse(&luminaire(&emitter(text))).unwrap().spectrum.unwrap())[1];
    near((spectrum.at(450.0) - spectrum.at(600.0)) / spectrum.at(600.0), y(FLAT) / y(&blue), 1e-9);
}

#[test]
fn channels_weight_the_spectra_of_a_tunable_emitter() {
    let part = |name: &str, from: u32, to: u32| {
        format!(
            "<EmitterSpectral><EmitterName>{name}</EmitterName><Multiplier>2</Multiplier>\
             <PwrData w=\"{from}\">1</PwrData><PwrData w=\"{to}\">1</PwrData></EmitterSpectral>"
        )
    };
    let data = format!("<SpectralData>{}{}</SpectralData>", part("red", 600, 650), part("blue", 450, 500));
    let channels = "<Channels><NumChannels>2</NumChannels><ChannelMult name=\"blue\">0.25</ChannelMult></Channels>";
    let spectrum = parse(&luminaire(&emitter(&(data + channels)))).unwrap().spectrum.unwrap();
    assert_eq!([475.0, 550.0, 625.0].map(|nm| spectrum.at(nm)), [0.5, 0.0, 2.0]);
}

#[test]
fn emission_areas_become_the_opening() {
    let area = |face: &str, offset: f64, rest: &str| {
        format!(
            "<{face}Area><Length>0.5</Length><Width>0.2</Width><LengthOffset>{offset}</LengthOffset>\
             <WidthOffset>0</WidthOffset>{rest}</{face}Area>"
        )
    };
    let of = |areas: &str| parse(&luminaire(&emitter(&format!("<EmissionAreas>{areas}</EmissionAreas>")))).unwrap();
    let disk = of(&format!("<BottomFace>{}</BottomFace>", area("Bottom", 0.0, "<Circular>True</Circular>")));
    let OpeningSize { shape, along_c0_m, along_c90_m, height_m } = disk.opening;
    assert_eq!((shape, along_c0_m, along_c90_m, height_m), (OpeningShape::Ellipse, 0.2, 0.5, 0.0));
    let two = format!("{}{}", area("Bottom", -0.3, ""), area("Bottom", 0.3, ""));
    let side = "<C0Face><C0Area><Length>1</Length><Height>0.05</Height></C0Area></C0Face>";
    let panels = of(&format!("<BottomFace>{two}</BottomFace>{side}"));
    let OpeningSize { shape, along_c0_m, along_c90_m, height_m } = panels.opening;
    assert_eq!((shape, along_c0_m, height_m), (OpeningShape::Rectangle, 0.2, 0.05));
    near(along_c90_m, 1.1, 1e-12);
    assert!(panels.notes[0].contains("rectangle around the 2 emission areas"));
    assert_eq!(of("").opening.shape, OpeningShape::Point);
    let up = of(&format!("<TopFace>{}</TopFace>", area("Top", 0.0, "")));
    assert_eq!(up.opening.along_c90_m, 0.5);
}

#[test]
fn errors_name_line_and_column() {
    let good = luminaire(&emitter(FLAT)).replace(
        "</Header>",
        "</Header>\n<Equipment><Gonioradiometer>\n<Type>CIE_C</Type></Gonioradiometer></Equipment>",
    );
    assert!(parse(&good).is_ok());
    for (from, to, line, word) in [
        ("CIE_C", "IES_B", 8, "type IES_B"),
        ("v=\"30\"", "v=\"29\"", 45, "above the one before"),
        ("v=\"30\"", "v=\"thirty\"", 45, "\"thirty\""),
        ("v=\"30\"", "", 45, "v=\"…\""),
        (">100</IntData>", ">-1</IntData>", 15, "at least 0"),
        ("</LuminousIntensity>", "<NumberVert>90</NumberVert></LuminousIntensity>", 106, "91"),
        ("<LuminousIntensity>", "<LuminousIntensity><Symm>Symm_Quad</Symm>", 14, "rotational"),
        ("w=\"700\"", "w=\"300\"", 12, "ascending"),
        (">2</NumberWavelength>", ">3</NumberWavelength>", 12, "2, the number of powers"),
        ("0.5</PwrData>", "x</PwrData>", 12, "\"x\""),
        ("LuminousIntensity", "Intensity", 2, "without intensities"),
        ("</Emitter>", "", 109, "XML"),
        ("IESTM33", "Lamp", 2, "<Lamp>"),
    ] {
        let error = parse(&good.replace(from, to)).unwrap_err();
        assert_eq!(error.location.line_column.map(|place| place.0), Some(line), "{from}: {error}");
        assert!(error.to_string().contains(word), "{word}: {error}");
    }
    let gap = good.replacen("h=\"0\" v=\"30\"", "h=\"90\" v=\"30\"", 1);
    assert!(parse(&gap).unwrap_err().location.line_column.is_some());
    let other = emitter("").replacen("<IntData h=\"0\" v=\"90\">", "<IntData h=\"0\" v=\"91\">", 1);
    let error = parse(&luminaire(&format!("{}{other}", emitter("")))).unwrap_err();
    assert!(error.to_string().contains("different angles") && error.location.line_column.is_some(), "{error}");
}

/// Files with changed, cut off or doubled signs are read, or refused with a place.
#[test]
fn damaged_files_are_refused_with_a_place() {
    let mut state = 11_u64;
    let mut below = |limit: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % limit
    };
    let data = table(&[0.0, 45.0, 90.0], &[0.0, 45.0, 90.0], |c, gamma| c + lambert(gamma));
    let luminous =
        format!("<Emitter>{FLAT}<LuminousData><LuminousIntensity>{data}</LuminousIntensity></LuminousData></Emitter>");
    let spectral =
        format!("{}{}", data.replace("<IntData", "<IntData w=\"500\""), data.replace("<IntData", "<IntData w=\"600\""));
    let spectral =
        format!("<Emitter><SpectralData><AngularSpectral>{spectral}</AngularSpectral></SpectralData></Emitter>");
    let signs = "\0\t\n \"<>/=-.,019eEnNSA_&\u{fffd}";
    for good in [luminaire(&luminous), luminaire(&spectral)] {
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
            match parse(&text.into_iter().collect::<String>()).and_then(|it| it.table().map(|_| it)) {
                Ok(_) => read += 1,
                Err(error) => assert!(error.location.line_column.is_some(), "{error}"),
            }
        }
        assert!(read > 3 && read < 290, "{read}");
    }
}
