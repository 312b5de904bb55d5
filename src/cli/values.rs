//! Parses the values of options and arguments.

use std::ops::RangeInclusive;
use std::time::Duration;

use abbe_optics::lens::SensorFocus;
use abbe_scene::{Bloom, Exposure};
use abbe_session::output::gates::{Gate, GateSide};
use abbe_session::output::relight::LightGain;
use abbe_session::output::selection::Region;
use abbe_session::render::PassPart;
use abbe_spectra::colour::decode_srgb;

/// Parses a duration such as `90s`, `5m`, `1h30m` or `500ms`, or a number of seconds.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let wrong = || "expected a time such as 90s, 5m or 1h30m".to_string();
    let mut seconds = 0.0;
    let mut rest = text.trim();
    if rest.is_empty() {
        return Err(wrong());
    }
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let number: f64 = rest[..digits].parse().map_err(|_| wrong())?;
        rest = &rest[digits..];
        let letters = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
        let unit = match &rest[..letters] {
            "" | "s" => 1.0,
            "ms" => 1e-3,
            "m" | "min" => 60.0,
            "h" => 3600.0,
            _ => return Err(wrong()),
        };
        seconds += number * unit;
        rest = &rest[letters..];
    }
    match Duration::try_from_secs_f64(seconds) {
        Ok(duration) if !duration.is_zero() => Ok(duration),
        _ => Err("expected a time above 0".to_string()),
    }
}

/// Parses a ratio such as `2%` or `0.02`. The ratio must be above 0. A number of 1 or more is
/// meant as a percentage, so it needs the sign.
pub(crate) fn fraction(text: &str) -> Result<f64, String> {
    let (number, unit, end) = match text.trim().strip_suffix('%') {
        Some(percent) => (percent.trim_end(), 0.01, f64::INFINITY),
        None => (text.trim(), 1.0, 1.0),
    };
    match number.parse::<f64>() {
        Ok(value) if value > 0.0 && value < end => Ok(value * unit),
        Ok(value) if value >= 1.0 && value.is_finite() => Err(format!("expected a ratio below 1, or {value}%")),
        Ok(_) | Err(_) => Err("expected a ratio above 0 such as 2% or 0.02".to_string()),
    }
}

/// Parses the half angle of a field of view, in degrees. The value must be above 0 and below 90.
pub(crate) fn half_field_deg(text: &str) -> Result<f64, String> {
    let inside = |degrees: &f64| 0.0 < *degrees && *degrees < 90.0;
    text.trim().parse().ok().filter(inside).ok_or_else(|| "expected degrees above 0 and below 90".to_string())
}

/// Parses the position of the sensor of a lens: a distance in mm, or `best`.
pub(crate) fn sensor_focus(text: &str) -> Result<SensorFocus, String> {
    match text.trim() {
        "best" => Ok(SensorFocus::Best),
        number => match number.parse::<f64>() {
            Ok(mm) if mm.is_finite() => Ok(SensorFocus::Shift(mm)),
            _ => Err("expected a distance in mm such as -0.2, or best".to_string()),
        },
    }
}

/// Parses a size in pixels such as `640x360`.
pub(crate) fn size(text: &str) -> Result<(u32, u32), String> {
    let parse = |number: &str| number.trim().parse::<u32>().ok().filter(|&n| n > 0);
    text.split_once(['x', 'X', '×'])
        .and_then(|(width, height)| Some((parse(width)?, parse(height)?)))
        .ok_or_else(|| "expected a size in pixels such as 640x360".to_string())
}

/// Parses text such as `0/4`, which selects the first of four parts of the passes.
pub(crate) fn part(text: &str) -> Result<PassPart, String> {
    let numbers = text.split_once('/').and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
    let (index, of) = numbers.ok_or_else(|| "expected a part such as 0/4, the first of four".to_string())?;
    PassPart::new(index, of).map_err(|error| error.to_string())
}

/// Parses a gain of a light group such as `lamp=2`, `lamp=#ff8800` or `lamp=1,0.5,0.2`.
pub(crate) fn light_gain(text: &str) -> Result<LightGain, String> {
    let wrong = || "expected a gain such as lamp=2, lamp=#ff8800 or lamp=1,0.5,0.2".to_string();
    let (group, gain) = text.rsplit_once('=').ok_or_else(wrong)?;
    let rgb = match gain.trim().strip_prefix('#') {
        Some(hex) if hex.len() == 6 && hex.is_ascii() => {
            let code = |c: usize| u8::from_str_radix(&hex[2 * c..2 * c + 2], 16);
            let component = |c: usize| code(c).map(|code| decode_srgb(f64::from(code) / 255.0)).map_err(|_| wrong());
            [component(0)?, component(1)?, component(2)?]
        }
        Some(_) => return Err(wrong()),
        None => {
            let factors: Option<Vec<f64>> = gain.split(',').map(|factor| factor.trim().parse().ok()).collect();
            match factors.as_deref() {
                Some(&[factor]) => [factor; 3],
                Some(&[red, green, blue]) => [red, green, blue],
                _ => return Err(wrong()),
            }
        }
    };
    let is_valid = rgb.iter().all(|factor| factor.is_finite() && *factor >= 0.0);
    if is_valid { Ok(LightGain { group: group.trim().to_string(), rgb }) } else { Err(wrong()) }
}

/// Parses a region such as `0,0,64,32`: columns x0 to x1, and rows y0 to y1, both ends excluded.
pub(crate) fn region(text: &str) -> Result<Region, String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Region { x0, y0, x1, y1 }),
        _ => Err("expected x0,y0,x1,y1 in pixels with x0 < x1 and y0 < y1".to_string()),
    }
}

/// Parses a wavelength in nm. The wavelength must be above 0.
pub(crate) fn wavelength_nm(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(nm) if nm > 0.0 && nm.is_finite() => Ok(nm),
        _ => Err("expected a wavelength in nm, above 0".to_string()),
    }
}

/// Parses the thickness of a plate in µm, from 0 to a metre.
pub(crate) fn thickness_um(text: &str) -> Result<f64, String> {
    let thickness = text.trim().parse().ok().filter(|um| (0.0..=1e6).contains(um));
    thickness.ok_or_else(|| "expected a thickness in µm from 0 to 1000000".to_string())
}

/// The wavelengths of an option, in nm.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WavelengthList(pub(crate) Vec<f64>);

/// Parses wavelengths within 360–830 nm, such as `450,589.3`, or `400:700:50` with a step.
pub(crate) fn wavelengths(text: &str) -> Result<WavelengthList, String> {
    /// The largest number of wavelengths.
    const MOST: f64 = 1e5;
    let wrong = || "expected wavelengths in nm from 360 to 830, such as 450,550 or 400:700:50".to_string();
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|nm| nm.is_finite());
    let parts: Vec<&str> = text.split(':').collect();
    let list: Option<Vec<f64>> = match parts.as_slice() {
        [list] => list.split(',').map(number).collect(),
        [from, to, step] => match (number(from), number(to), number(step)) {
            (Some(from), Some(to), Some(step)) if from <= to && step > 0.0 && (to - from) / step < MOST => {
                let count = ((to - from) / step + 1e-9).floor() as u32;
                Some((0..=count).map(|i| from + f64::from(i) * step).collect())
            }
            _ => None,
        },
        _ => None,
    };
    let inside = |list: &Vec<f64>| list.iter().all(|nm| (360.0..=830.0).contains(nm));
    list.filter(inside).map(WavelengthList).ok_or_else(wrong)
}

/// Parses an angle of incidence in degrees, from 0 to 90.
pub(crate) fn incidence_deg(text: &str) -> Result<f64, String> {
    let angle = text.trim().parse().ok().filter(|degrees| (0.0..=90.0).contains(degrees));
    angle.ok_or_else(|| "expected degrees from 0 to 90".to_string())
}

/// Parses a limit on a figure of a comparison, such as `delta_e_2000.p95=2` or `relative_mse=1%`,
/// or a number that limits `relative_mse`.
pub(crate) fn gate_above(text: &str) -> Result<Gate, String> {
    let (figure, limit) = text.split_once('=').unwrap_or(("relative_mse", text));
    gate(figure, limit, GateSide::Above)
}

/// Parses a lower limit on a figure of a comparison, such as `z.p=0.01` or `covered=90%`.
pub(crate) fn gate_below(text: &str) -> Result<Gate, String> {
    let wrong = || "expected a figure and its limit such as z.p=0.01 or covered=90%".to_string();
    let (figure, limit) = text.split_once('=').ok_or_else(wrong)?;
    gate(figure, limit, GateSide::Below)
}

/// Parses a limit of 0 or more, such as `0.05` or `0.1%`.
pub(crate) fn limit(text: &str) -> Result<f64, String> {
    gate("", text, GateSide::Above).map(|gate| gate.limit)
}

fn gate(figure: &str, limit: &str, fails: GateSide) -> Result<Gate, String> {
    let (number, unit) = match limit.trim().strip_suffix('%') {
        Some(percent) => (percent.trim_end(), 0.01),
        None => (limit.trim(), 1.0),
    };
    match number.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => {
            Ok(Gate { figure: figure.trim().to_string(), limit: value * unit, fails })
        }
        _ => Err("expected a limit of 0 or more such as 0.01 or 1%".to_string()),
    }
}

/// Parses an exposure: `auto`, `none`, or a number of stops.
pub(crate) fn exposure(text: &str) -> Result<Exposure, String> {
    match text.trim() {
        "auto" => Ok(Exposure::Auto),
        "none" => Ok(Exposure::None),
        stops => match stops.parse::<f64>() {
            Ok(ev) if ev.is_finite() => Ok(Exposure::Ev(ev)),
            _ => Err("expected auto, none or a number of stops such as -7.5".to_string()),
        },
    }
}

/// The bloom of a picture, or none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BloomChoice(pub(crate) Option<Bloom>);

/// Parses a bloom: `none`, or the horizontal angle of the picture in degrees.
pub(crate) fn bloom(text: &str) -> Result<BloomChoice, String> {
    match text.trim() {
        "none" => Ok(BloomChoice(None)),
        degrees => match degrees.parse::<f64>() {
            Ok(fov_degrees) if (0.1..=120.0).contains(&fov_degrees) => {
                Ok(BloomChoice(Some(Bloom { fov_degrees, age: Bloom::DEFAULT_AGE })))
            }
            _ => Err("expected none or an angle from 0.1 to 120 degrees, such as 40".to_string()),
        },
    }
}

/// Parses a range of frame numbers such as `1..48`. Both ends are included. The first frame is 1.
pub(crate) fn frames(text: &str) -> Result<RangeInclusive<u32>, String> {
    let number = |text: &str| text.trim().parse::<u32>().ok().filter(|&number| number > 0);
    match text.split_once("..").and_then(|(from, to)| Some((number(from)?, number(to)?))) {
        Some((from, to)) if from <= to => Ok(from..=to),
        Some((from, to)) => Err(format!("the last frame {to} is before the first frame {from}")),
        None => Err("expected frames such as 1..48, counted from 1".to_string()),
    }
}

/// The values of a setting in a sweep.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sweep {
    pub(crate) key: String,
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// The number of values, at least 2.
    pub(crate) count: u32,
}

/// Parses a sweep such as `lights.beam.power=1..5:9`: nine values from 1 to 5, both included.
pub(crate) fn sweep(text: &str) -> Result<Sweep, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let parsed = || {
        let (key, range) = text.rsplit_once('=')?;
        let (limits, count) = range.rsplit_once(':')?;
        let (from, to) = limits.split_once("..")?;
        let count = count.trim().parse().ok().filter(|count| (2..=100_000).contains(count))?;
        Some(Sweep { key: key.trim().to_string(), from: number(from)?, to: number(to)?, count })
    };
    parsed().filter(|sweep| !sweep.key.is_empty()).ok_or_else(|| {
        "expected a path, two numbers and how many values, at least 2, such as lights.beam.power=1..5:9".to_string()
    })
}

/// Parses a number of frames per second. The number must be above 0.
pub(crate) fn rate(text: &str) -> Result<f64, String> {
    let rate = text.trim().parse().ok().filter(|fps: &f64| *fps > 0.0 && fps.is_finite());
    rate.ok_or_else(|| "expected a number above 0".to_string())
}

/// Parses a shutter angle in degrees. The angle must be from 0 to 360.
pub(crate) fn shutter_angle(text: &str) -> Result<f64, String> {
    let angle = text.trim().parse().ok().filter(|degrees| (0.0..=360.0).contains(degrees));
    angle.ok_or_else(|| "expected degrees from 0 to 360".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations() {
        let seconds = |text| duration(text).map(|duration| duration.as_secs_f64());
        let known = [("90s", 90.0), ("5m", 300.0), ("1h30m", 5400.0), ("500ms", 0.5), ("12", 12.0), ("1.5m", 90.0)];
        for (text, value) in known {
            assert_eq!(seconds(text), Ok(value), "{text}");
        }
        for text in ["", "s", "-3s", "5 parsecs", "0s", "1e3s", "nan", "5m-2s", "99999999999999999999h"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn fractions() {
        assert_eq!(fraction("2%"), Ok(0.02));
        assert_eq!(fraction("0.02"), Ok(0.02));
        assert_eq!(fraction("2"), Err("expected a ratio below 1, or 2%".to_string()));
        assert_eq!(fraction("1000%"), Ok(10.0));
        assert!(["0", "-1%", "nan", "inf", "", "%", "two"].iter().all(|text| fraction(text).is_err()));
    }

    #[test]
    fn exposures() {
        assert_eq!(exposure("auto"), Ok(Exposure::Auto));
        assert_eq!(exposure("-7.5"), Ok(Exposure::Ev(-7.5)));
        assert!(["", "bright", "inf", "nan"].iter().all(|text| exposure(text).is_err()));
    }

    #[test]
    fn blooms() {
        assert_eq!(bloom("none"), Ok(BloomChoice(None)));
        assert_eq!(bloom("40").map(|BloomChoice(eye)| eye.map(|eye| eye.fov_degrees)), Ok(Some(40.0)));
        assert!(["", "0", "121", "nan", "wide"].iter().all(|text| bloom(text).is_err()));
    }

    #[test]
    fn gates() {
        let above = |text| gate_above(text).map(|gate| (gate.figure, gate.limit));
        assert_eq!(above("0.5"), Ok(("relative_mse".to_string(), 0.5)));
        assert_eq!(above("delta_e_2000.p95=2"), Ok(("delta_e_2000.p95".to_string(), 2.0)));
        assert_eq!(gate_below("covered=90%").map(|gate| gate.limit), Ok(0.9));
        assert!(["-1", "a=", "a=x", "nan"].iter().all(|text| gate_above(text).is_err()));
        assert!(gate_below("0.01").is_err(), "a lower limit needs the name of its figure");
    }

    #[test]
    fn parts() {
        assert_eq!(part("3/4").map(|part| part.to_string()), Ok("3/4".to_string()));
        assert!(["4/4", "1", "0/0", "-1/2", "a/b", "1/2/3"].iter().all(|text| part(text).is_err()));
    }

    #[test]
    fn lists_and_ranges_of_wavelengths() {
        let list = |text| wavelengths(text).map(|list| list.0);
        assert_eq!(list("450, 589.3"), Ok(vec![450.0, 589.3]));
        assert_eq!(list("400:700:100"), Ok(vec![400.0, 500.0, 600.0, 700.0]));
        assert_eq!(list("400:401:0.1").map(|list| list.len()), Ok(11));
        assert!(
            ["", "300", "400:300:1", "400:500:0", "400:500", "1:2:3:4", "a"].iter().all(|text| list(text).is_err())
        );
        assert!(incidence_deg("91").is_err() && incidence_deg("-1").is_err() && incidence_deg("90") == Ok(90.0));
    }

    #[test]
    fn sizes_and_regions() {
        assert_eq!(size("640x360"), Ok((640, 360)));
        assert!(["640", "0x3", "3x0", "-1x2", "1x2x3"].iter().all(|text| size(text).is_err()));
        assert_eq!(region("1,2,3,4"), Ok(Region { x0: 1, y0: 2, x1: 3, y1: 4 }));
        assert!(["1,2,3", "3,2,1,4", "1,2,3,2", "a,b,c,d", "1,2,3,4,5"].iter().all(|text| region(text).is_err()));
    }

    #[test]
    fn ranges_rise_and_count_from_one() {
        assert_eq!(frames("1..48"), Ok(1..=48));
        assert_eq!(frames("5..5"), Ok(5..=5));
        for wrong in ["5..3", "0..3", "1-3", "..3", "a..b", "1..", "1...3"] {
            assert!(frames(wrong).is_err(), "{wrong}");
        }
        assert!(rate("0").is_err() && rate("nan").is_err() && rate("23.976").is_ok());
        assert!(shutter_angle("-1").is_err() && shutter_angle("361").is_err() && shutter_angle("0").is_ok());
    }
}
