//! Judges the colours that a converter computed for the regression set.

use super::cause::{LikelyCause, Observation, likely_cause};
use super::form::{ColourForm, FormColours};
use super::set::{CaseGroup, RegressionCase, RegressionSet};
use crate::colour::difference::delta_e_2000;
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
    /// The largest ΔE2000. The white is D65 for all cases except for [`ColourForm::Lab`], because
    /// with the light as the white, b* would exaggerate differences under lights with almost no Z,
    /// such as sodium light.
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

/// The judgement of one form of a colour.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColourComparison {
    /// The name of the form.
    #[serde(serialize_with = "form_name")]
    pub form: ColourForm,
    /// The expected colour.
    pub expected: [f64; 3],
    /// The colour of the converter.
    pub found: [f64; 3],
    /// The colour difference, or `None` if a component is not finite.
    pub delta_e_2000: Option<f64>,
    /// The largest difference of a component, as in [`RegressionTolerances::component`].
    pub component: Option<f64>,
}

fn form_name<S: serde::Serializer>(form: &ColourForm, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    serializer.serialize_str(form.name())
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
    /// The fault that explains the failed cases, if one of the known faults does.
    pub cause: Option<LikelyCause>,
    /// The explanation of the likely cause.
    pub hint: Option<String>,
    /// The groups that have cases.
    pub groups: Vec<GroupSummary>,
    /// The cases. The case with the largest difference comes first.
    pub cases: Vec<CaseComparison>,
}

/// The counts of a group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GroupSummary {
    /// The group.
    pub group: CaseGroup,
    /// The number of cases.
    #[serde(rename = "judged")]
    pub compared: usize,
    /// The number of cases that failed.
    pub failed: usize,
    /// The largest ΔE2000, infinite if a component is not finite.
    pub delta_e_2000: f64,
}

impl GroupSummary {
    fn of(group: CaseGroup, cases: &[CaseComparison]) -> Option<Self> {
        let own = || cases.iter().filter(|case| case.group == group);
        let failed = own().filter(|case| !case.passed).count();
        let delta_e_2000 = own().map(CaseComparison::delta_e_2000).fold(0.0, f64::max);
        Some(Self { group, compared: own().count(), failed, delta_e_2000 }).filter(|summary| summary.compared > 0)
    }
}

impl RegressionReport {
    /// Returns the result in words.
    pub fn verdict(&self) -> String {
        let Self { compared, failed, .. } = self;
        if *failed == 0 { format!("all {compared} cases pass") } else { format!("{failed} of {compared} cases fail") }
    }

    /// Returns a sentence with the likely cause, or that none is known. `None` if no case failed.
    pub fn cause_in_words(&self) -> Option<String> {
        let Some(LikelyCause { name, explanation, residual, .. }) = &self.cause else {
            return (self.failed > 0).then(|| "no known cause explains the errors".to_string());
        };
        let left = 100.0 * residual;
        Some(format!("likely cause: {}: {explanation} (this leaves {left:.1} % of the error)", name.words()))
    }
}

/// Judges the colours of a converter for all cases of some groups of a set, or of all if there are
/// none. Returns an error if a case is unknown, occurs twice, is missing, or has no colour.
pub fn compare_groups(
    set: &'static RegressionSet,
    converted: &[(String, FormColours)],
    groups: &[CaseGroup],
    tolerances: RegressionTolerances,
) -> Result<RegressionReport> {
    let is_wanted = |case: &RegressionCase| groups.is_empty() || groups.contains(&case.group);
    let given = given(set, converted)?;
    let wanted: Vec<&RegressionCase> = set.cases.iter().filter(|case| is_wanted(case)).collect();
    if let (true, Some(group)) = (wanted.is_empty(), groups.first()) {
        return Err(Error::input(format!("the set {} has no group {}", set.name, group.name())));
    }
    let is_given = |case: &RegressionCase| given.iter().any(|(given, _)| given.id == case.id);
    let missing: Vec<&str> = wanted.iter().filter(|case| !is_given(case)).map(|case| case.id.as_str()).collect();
    if let Some((first, rest)) = missing.split_first() {
        let more = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
        let what = format!("{} of {} cases are missing: {first}{more}", missing.len(), wanted.len());
        return Err(Error::input(what).expected("every case of the set, or only the groups that --group names"));
    }
    let pairs: Vec<CaseOfConverter<'_>> = given.into_iter().filter(|(case, _)| is_wanted(case)).collect();
    Ok(report(set, &pairs, tolerances))
}

/// Judges the colours of a converter for some cases of a set. Returns an error if a case is unknown
/// or occurs twice, or if a colour has no form.
pub fn compare_given(
    set: &'static RegressionSet,
    converted: &[(String, FormColours)],
    tolerances: RegressionTolerances,
) -> Result<RegressionReport> {
    Ok(report(set, &given(set, converted)?, tolerances))
}

/// A case, and the colour that the converter computed for it.
type CaseOfConverter<'a> = (&'static RegressionCase, &'a FormColours);

fn given<'a>(set: &'static RegressionSet, converted: &'a [(String, FormColours)]) -> Result<Vec<CaseOfConverter<'a>>> {
    let case = |(i, (id, colour)): (usize, &'_ (String, FormColours))| {
        let known = || set.cases.iter().map(|case| case.id.as_str());
        let case =
            set.cases.iter().find(|case| case.id == *id).ok_or_else(|| {
                Error::unknown_name("case", id, known()).expected("an id of the exported file cases.csv")
            })?;
        if converted[..i].iter().any(|(earlier, _)| earlier == id) {
            return Err(Error::input(format!("the case {id} occurs twice")));
        }
        if let Some((form, _)) = colour.iter().find(|(form, _)| !set.forms.contains(form)) {
            return Err(Error::input(format!("the set {} has no form {}", set.name, form.name())));
        }
        if *colour == FormColours::default() {
            return Err(Error::input(format!("the case {id} has no colour")).expected("XYZ, linear sRGB or sRGB"));
        }
        Ok(case)
    };
    let cases = converted.iter().enumerate().map(case).collect::<Result<Vec<_>>>()?;
    Ok(cases.into_iter().zip(converted.iter().map(|(_, colour)| colour)).collect())
}

fn report(set: &RegressionSet, pairs: &[CaseOfConverter<'_>], tolerances: RegressionTolerances) -> RegressionReport {
    let mut cases: Vec<CaseComparison> =
        pairs.iter().map(|(case, colour)| compare_case(case, colour, &tolerances)).collect();
    let failed = cases.iter().filter(|case| !case.passed).count();
    let cause = first_wrong_form(&cases, &tolerances).and_then(|form| {
        let observation = |(case, colour): &CaseOfConverter<'_>| {
            let (expected, found) = (case.expected.get(form)?, colour.get(form)?);
            Some(Observation { case, expected, found })
        };
        let observations: Vec<Observation<'_>> = pairs.iter().filter_map(observation).collect();
        likely_cause(set, form, &observations, tolerances.component)
    });
    let hint = cause.as_ref().map(|cause| cause.explanation.clone());
    let groups = CaseGroup::ALL.into_iter().filter_map(|group| GroupSummary::of(group, &cases)).collect();
    cases.sort_by(|a, b| {
        (a.passed, b.delta_e_2000(), b.component())
            .partial_cmp(&(b.passed, a.delta_e_2000(), a.component()))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    RegressionReport { set: set.name, tolerances, compared: cases.len(), failed, cause, hint, groups, cases }
}

/// Returns the first form in which a case fails. The others usually follow from it.
fn first_wrong_form(cases: &[CaseComparison], tolerances: &RegressionTolerances) -> Option<ColourForm> {
    let fails =
        |form: ColourForm, colour: &ColourComparison| colour.form == form && fault(colour, tolerances).is_some();
    let wrong = |form: &ColourForm| cases.iter().flat_map(|case| &case.colours).any(|colour| fails(*form, colour));
    ColourForm::ALL.into_iter().find(wrong)
}

fn compare_case(case: &RegressionCase, colour: &FormColours, tolerances: &RegressionTolerances) -> CaseComparison {
    let expected = |(form, found)| Some((form, case.expected.get(form)?, found));
    let forms = colour.iter().filter_map(expected);
    let colours: Vec<ColourComparison> =
        forms.map(|(form, expected, found)| compare_colour(form, expected, found)).collect();
    let faults: Vec<String> = colours.iter().filter_map(|colour| fault(colour, tolerances)).collect();
    let fault = (!faults.is_empty()).then(|| faults.join("; "));
    CaseComparison { id: case.id.clone(), group: case.group, passed: fault.is_none(), colours, fault }
}

fn compare_colour(form: ColourForm, expected: [f64; 3], found: [f64; 3]) -> ColourComparison {
    let is_finite = found.iter().all(|value| value.is_finite());
    let component = form.largest_difference(found, expected);
    ColourComparison {
        form,
        expected,
        found,
        delta_e_2000: is_finite.then(|| delta_e_2000(form.lab(expected), form.lab(found))),
        component: is_finite.then_some(component),
    }
}

/// Returns a sentence if a colour is not within the tolerances.
fn fault(colour: &ColourComparison, tolerances: &RegressionTolerances) -> Option<String> {
    let form = colour.form.name();
    let (Some(delta_e), Some(component)) = (colour.delta_e_2000, colour.component) else {
        return Some(format!("{form} is {:?}, which is not finite", colour.found));
    };
    if delta_e > tolerances.delta_e_2000 {
        return Some(format!("{form} differs by ΔE2000 {delta_e:.4}, above {}", tolerances.delta_e_2000));
    }
    (component > tolerances.component)
        .then(|| format!("a component of {form} differs by {component:.6}, above {}", tolerances.component))
}
