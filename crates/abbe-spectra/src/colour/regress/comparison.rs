//! Judges the colours that a converter computed for the regression set.

use super::set::{CaseColour, CaseGroup, REGRESSION_SET, RegressionCase, RegressionSet};
use crate::colour::{RgbSpace, Xyz, decode_srgb, delta_e_2000, lab, linear_srgb_to_xyz};
use crate::error::{Error, Result};
use serde::Serialize;

/// The tolerances of a judgement. The defaults accept every correct sum over samples in steps of 1
/// nm: with or without half weights at the ends, with linear or Sprague interpolation of the
/// colour-matching functions at lines, and with the matrix of IEC 61966-2-1 that is rounded to four
/// digits (at most ΔE2000 0.055 and a difference of 0.0002). They accept neither samples in steps
/// of 5 nm (up to ΔE2000 1.3 and 0.011) nor lines that are moved to a whole number of nm (0.49 and
/// 0.011).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RegressionTolerances {
    /// The largest ΔE2000. The white is D65 for all cases, because with the light as the white, b*
    /// would exaggerate differences under lights with almost no Z, such as sodium light.
    pub delta_e_2000: f64,
    /// The largest difference of a component, relative to the largest component of the expected
    /// colour, or to white if white is larger.
    pub component: f64,
}

impl Default for RegressionTolerances {
    fn default() -> Self {
        Self { delta_e_2000: 0.1, component: 0.0005 }
    }
}

/// The colour that a converter computed for a case, with `None` for forms that it does not compute.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ConvertedColour {
    /// XYZ.
    pub xyz: Option<[f64; 3]>,
    /// Linear sRGB.
    pub linear_srgb: Option<[f64; 3]>,
    /// Encoded sRGB.
    pub srgb: Option<[f64; 3]>,
}

/// A form in which a colour is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ColourForm {
    Xyz,
    LinearSrgb,
    Srgb,
}

impl ColourForm {
    const ALL: [Self; 3] = [Self::Xyz, Self::LinearSrgb, Self::Srgb];

    fn name(self) -> &'static str {
        match self {
            Self::Xyz => "xyz",
            Self::LinearSrgb => "linear_srgb",
            Self::Srgb => "srgb",
        }
    }

    fn converted(self, colour: &ConvertedColour) -> Option<[f64; 3]> {
        match self {
            Self::Xyz => colour.xyz,
            Self::LinearSrgb => colour.linear_srgb,
            Self::Srgb => colour.srgb,
        }
    }

    fn expected(self, colour: &CaseColour) -> [f64; 3] {
        match self {
            Self::Xyz => colour.xyz,
            Self::LinearSrgb => colour.linear_srgb,
            Self::Srgb => colour.srgb,
        }
    }

    fn white(self) -> f64 {
        match self {
            Self::Xyz => 100.0,
            Self::LinearSrgb | Self::Srgb => 1.0,
        }
    }

    /// Returns XYZ with Y = 100 for white.
    fn to_xyz(self, colour: [f64; 3]) -> Xyz {
        match self {
            Self::Xyz => colour,
            Self::LinearSrgb => linear_srgb_to_xyz(colour).map(|value| 100.0 * value),
            Self::Srgb => linear_srgb_to_xyz(colour.map(decode_srgb)).map(|value| 100.0 * value),
        }
    }
}

/// The judgement of one form of a colour.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColourComparison {
    /// `xyz`, `linear_srgb` or `srgb`.
    pub form: &'static str,
    /// The expected colour.
    pub expected: [f64; 3],
    /// The colour of the converter.
    pub found: [f64; 3],
    /// The colour difference, or `None` if a component is not finite.
    pub delta_e_2000: Option<f64>,
    /// The largest difference of a component, as in [`RegressionTolerances::component`].
    pub component: Option<f64>,
}

/// The judgement of a case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CaseComparison {
    /// The name of the case.
    pub id: String,
    /// The group of the case.
    pub group: CaseGroup,
    /// True if all forms are within the tolerances.
    pub passed: bool,
    /// The judgements of the forms that the converter computed.
    pub colours: Vec<ColourComparison>,
    /// A sentence that states the fault of a failed case.
    pub fault: Option<String>,
}

impl CaseComparison {
    /// Returns the largest ΔE2000 of all forms, infinite if a component is not finite.
    pub fn delta_e_2000(&self) -> f64 {
        self.colours.iter().map(|colour| colour.delta_e_2000.unwrap_or(f64::INFINITY)).fold(0.0, f64::max)
    }

    /// Returns the largest difference of a component of all forms.
    pub fn component(&self) -> f64 {
        self.colours.iter().map(|colour| colour.component.unwrap_or(f64::INFINITY)).fold(0.0, f64::max)
    }
}

/// The judgement of all cases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegressionReport {
    /// The name of the set.
    pub set: &'static str,
    /// The tolerances.
    pub tolerances: RegressionTolerances,
    /// The number of cases.
    #[serde(rename = "judged")]
    pub compared: usize,
    /// The number of cases that failed.
    pub failed: usize,
    /// A likely cause, if many cases fail in the same way.
    pub hint: Option<String>,
    /// The cases. The case with the largest difference comes first.
    pub cases: Vec<CaseComparison>,
}

impl RegressionReport {
    /// Returns the result in words.
    pub fn verdict(&self) -> String {
        let Self { compared, failed, .. } = self;
        if *failed == 0 { format!("all {compared} cases pass") } else { format!("{failed} of {compared} cases fail") }
    }
}

/// Judges the colours of a converter for all cases of some groups, or of all if there are none.
/// Returns an error if a case is unknown, occurs twice, is missing, or has a colour in no form.
pub fn compare_groups(
    converted: &[(String, ConvertedColour)],
    groups: &[CaseGroup],
    tolerances: RegressionTolerances,
) -> Result<RegressionReport> {
    let is_wanted = |case: &RegressionCase| groups.is_empty() || groups.contains(&case.group);
    let given = given(converted)?;
    let wanted: Vec<&RegressionCase> = RegressionSet::get().cases.iter().filter(|case| is_wanted(case)).collect();
    let is_given = |case: &RegressionCase| given.iter().any(|(given, _)| given.id == case.id);
    let missing: Vec<&str> = wanted.iter().filter(|case| !is_given(case)).map(|case| case.id.as_str()).collect();
    if let Some((first, rest)) = missing.split_first() {
        let more = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
        let what = format!("{} of {} cases are missing: {first}{more}", missing.len(), wanted.len());
        return Err(Error::input(what).expected("every case of the set, or only the groups that --group names"));
    }
    let pairs: Vec<CaseOfConverter<'_>> = given.into_iter().filter(|(case, _)| is_wanted(case)).collect();
    Ok(report(&pairs, tolerances))
}

/// Judges the colours of a converter for some cases. Returns an error if a case is unknown or
/// occurs twice, or if a colour has no form.
pub fn compare_given(
    converted: &[(String, ConvertedColour)],
    tolerances: RegressionTolerances,
) -> Result<RegressionReport> {
    Ok(report(&given(converted)?, tolerances))
}

/// A case, and the colour that the converter computed for it.
type CaseOfConverter<'a> = (&'static RegressionCase, &'a ConvertedColour);

fn given(converted: &[(String, ConvertedColour)]) -> Result<Vec<CaseOfConverter<'_>>> {
    let all = &RegressionSet::get().cases;
    let case = |(i, (id, colour)): (usize, &'_ (String, ConvertedColour))| {
        let known = || all.iter().map(|case| case.id.as_str());
        let case = all
            .iter()
            .find(|case| case.id == *id)
            .ok_or_else(|| Error::unknown_name("case", id, known()).expected("an id of the exported file cases.csv"))?;
        if converted[..i].iter().any(|(earlier, _)| earlier == id) {
            return Err(Error::input(format!("the case {id} occurs twice")));
        }
        if *colour == ConvertedColour::default() {
            return Err(Error::input(format!("the case {id} has no colour")).expected("XYZ, linear sRGB or sRGB"));
        }
        Ok(case)
    };
    let cases = converted.iter().enumerate().map(case).collect::<Result<Vec<_>>>()?;
    Ok(cases.into_iter().zip(converted.iter().map(|(_, colour)| colour)).collect())
}

fn report(pairs: &[CaseOfConverter<'_>], tolerances: RegressionTolerances) -> RegressionReport {
    let mut cases: Vec<CaseComparison> =
        pairs.iter().map(|(case, colour)| compare_case(case, colour, &tolerances)).collect();
    let failed = cases.iter().filter(|case| !case.passed).count();
    let hint = if failed == 0 { None } else { scale_hint(pairs, &tolerances) };
    cases.sort_by(|a, b| {
        (a.passed, b.delta_e_2000(), b.component())
            .partial_cmp(&(b.passed, a.delta_e_2000(), a.component()))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    RegressionReport { set: REGRESSION_SET, tolerances, compared: cases.len(), failed, hint, cases }
}

fn compare_case(case: &RegressionCase, colour: &ConvertedColour, tolerances: &RegressionTolerances) -> CaseComparison {
    let forms = ColourForm::ALL.into_iter().filter_map(|form| Some((form, form.converted(colour)?)));
    let colours: Vec<ColourComparison> = forms.map(|(form, found)| compare_colour(case, form, found)).collect();
    let faults: Vec<String> = colours.iter().filter_map(|colour| fault(colour, tolerances)).collect();
    let fault = (!faults.is_empty()).then(|| faults.join("; "));
    CaseComparison { id: case.id.clone(), group: case.group, passed: fault.is_none(), colours, fault }
}

fn compare_colour(case: &RegressionCase, form: ColourForm, found: [f64; 3]) -> ColourComparison {
    let expected = form.expected(&case.expected);
    let is_finite = found.iter().all(|value| value.is_finite());
    let white = RgbSpace::Srgb.white().map(|value| 100.0 * value);
    let seen = |colour: [f64; 3]| lab(form.to_xyz(colour), white);
    let component = largest_difference(form, found, expected);
    ColourComparison {
        form: form.name(),
        expected,
        found,
        delta_e_2000: is_finite.then(|| delta_e_2000(seen(expected), seen(found))),
        component: is_finite.then_some(component),
    }
}

/// Returns the largest difference of a component, relative to white or to the largest component.
fn largest_difference(form: ColourForm, found: [f64; 3], expected: [f64; 3]) -> f64 {
    let scale = expected.iter().fold(form.white(), |scale, value| scale.max(value.abs()));
    found.iter().zip(expected).map(|(found, expected)| (found - expected).abs() / scale).fold(0.0, f64::max)
}

/// Returns a sentence if a colour is not within the tolerances.
fn fault(colour: &ColourComparison, tolerances: &RegressionTolerances) -> Option<String> {
    let form = colour.form;
    let (Some(delta_e), Some(component)) = (colour.delta_e_2000, colour.component) else {
        return Some(format!("{form} is {:?}, which is not finite", colour.found));
    };
    if delta_e > tolerances.delta_e_2000 {
        return Some(format!("{form} differs by ΔE2000 {delta_e:.4}, above {}", tolerances.delta_e_2000));
    }
    (component > tolerances.component)
        .then(|| format!("a component of {form} differs by {component:.6}, above {}", tolerances.component))
}

/// A scale explains the differences if it leaves at most this multiple of the tolerance.
const SCALE_SLACK: f64 = 10.0;

/// The smallest relative deviation of a factor from 1, or from another factor, that counts.
const SCALE_DEVIATION: f64 = 0.01;

/// Returns a hint if one factor for all cases, or one for each light, explains the differences.
fn scale_hint(pairs: &[CaseOfConverter<'_>], tolerances: &RegressionTolerances) -> Option<String> {
    [ColourForm::Xyz, ColourForm::LinearSrgb].into_iter().find_map(|form| {
        let mut lights: Vec<&str> = pairs.iter().map(|(case, _)| case.light.as_str()).collect();
        lights.sort_unstable();
        lights.dedup();
        let factors =
            lights.iter().map(|light| light_factor(form, light, pairs, tolerances)).collect::<Option<Vec<f64>>>()?;
        let (least, most) = factors.iter().fold((f64::INFINITY, 0.0), |(least, most), &f| (f.min(least), f.max(most)));
        let name = form.name();
        let unit = format!("a light and the perfect diffuser have Y = {} in {name}", form.white());
        let what = if most / least - 1.0 > SCALE_DEVIATION {
            format!("the values of {name} have another factor for each light")
        } else if (most - 1.0).abs() > SCALE_DEVIATION {
            format!("all values of {name} are {most:.4} times the expected values")
        } else {
            return None;
        };
        Some(format!("{what}; {unit}"))
    })
}

/// Returns the factor between converted and expected colours under a light, if one explains them.
fn light_factor(
    form: ColourForm,
    light: &str,
    pairs: &[CaseOfConverter<'_>],
    tolerances: &RegressionTolerances,
) -> Option<f64> {
    let own = pairs.iter().filter(|(case, _)| case.light == light);
    let colours = own
        .map(|(case, colour)| Some((form.converted(colour)?, form.expected(&case.expected))))
        .collect::<Option<Vec<([f64; 3], [f64; 3])>>>()?;
    let (products, squares) = colours.iter().fold((0.0, 0.0), |(products, squares), (found, expected)| {
        let product: f64 = found.iter().zip(expected).map(|(found, expected)| found * expected).sum();
        (products + product, squares + expected.iter().map(|value| value * value).sum::<f64>())
    });
    let factor = products / squares;
    let fits = |(found, expected): &([f64; 3], [f64; 3])| {
        largest_difference(form, found.map(|value| value / factor), *expected) <= SCALE_SLACK * tolerances.component
    };
    (factor > 0.0 && colours.iter().all(fits)).then_some(factor)
}
