//! Verdicts on the requirements of a scene, by the intervals of the readings.

use super::measurement::significant;
use abbe_format::RequirementFile;
use abbe_session::render::{MeasurementReport, MeterReport, Value};
use serde::Serialize;
use std::fmt::Write as _;

/// The verdict on a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The whole interval is on the right side of the limit.
    Met,
    /// The whole interval is on the wrong side of the limit.
    NotMet,
    /// The interval contains the limit, or it is not known.
    Undecided,
}

/// The judgement of one limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judgement {
    pub meter: String,
    /// The limit in words, such as `mean at least 500 lx`.
    pub requirement: String,
    pub limit: f64,
    /// The measured value: of a limit of each reading, that of the worst reading.
    pub value: Option<f64>,
    /// Contains the true value with a probability of at least 95 %.
    pub interval_95: Option<[f64; 2]>,
    pub verdict: Verdict,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

/// A measurement with the judgements of its requirements, as JSON.
#[derive(Debug, Serialize)]
pub struct JudgedMeasurement<'a> {
    #[serde(flatten)]
    pub report: &'a MeasurementReport,
    #[serde(skip_serializing_if = "<[Judgement]>::is_empty")]
    pub requirements: &'a [Judgement],
}

/// A measured value with its interval.
#[derive(Debug, Clone, Copy, Default)]
struct Estimate {
    value: Option<f64>,
    interval: Option<[f64; 2]>,
}

impl Verdict {
    pub fn words(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::NotMet => "not met",
            Self::Undecided => "undecided",
        }
    }
}

/// Judges the requirements whose meters were read, in the order of the scene file.
pub fn judgements(requirements: &[RequirementFile], report: &MeasurementReport) -> Vec<Judgement> {
    let of_meter = |requirement: &RequirementFile| {
        let meter = report.meters.iter().find(|meter| meter.name == requirement.meter);
        meter.map(|meter| of_requirement(requirement, meter)).unwrap_or_default()
    };
    requirements.iter().flat_map(of_meter).collect()
}

fn of_requirement(requirement: &RequirementFile, meter: &MeterReport) -> Vec<Judgement> {
    let RequirementFile { meter: name, source, .. } = requirement;
    // Indices and ratings are numbers of the unit 1.
    let unit = if meter.unit == "1" { "" } else { meter.unit };
    let (mean, uniformity) = (mean(meter), uniformity(meter));
    let (least, largest) = (extreme(meter, f64::min), extreme(meter, f64::max));
    let limits = [
        ("mean", unit, requirement.mean_at_least, true, mean),
        ("mean", unit, requirement.mean_at_most, false, mean),
        ("uniformity U0", "", requirement.uniformity_at_least, true, uniformity),
        ("each reading", unit, requirement.at_least, true, least),
        ("each reading", unit, requirement.at_most, false, largest),
    ];
    let judged = limits.into_iter().filter_map(|(what, unit, limit, is_least, estimate)| {
        let limit = limit?;
        let side = if is_least { "at least" } else { "at most" };
        let words = format!("{what} {side} {} {unit}", significant(limit));
        Some(Judgement {
            meter: name.clone(),
            requirement: words.trim_end().to_owned(),
            limit,
            value: estimate.value,
            interval_95: estimate.interval,
            verdict: verdict(estimate.interval, limit, is_least),
            source: source.clone(),
        })
    });
    judged.collect()
}

fn verdict(interval: Option<[f64; 2]>, limit: f64, is_least: bool) -> Verdict {
    let Some([low, high]) = interval else { return Verdict::Undecided };
    let (reached, missed) = if is_least { (low >= limit, high < limit) } else { (high <= limit, low > limit) };
    if reached {
        Verdict::Met
    } else if missed {
        Verdict::NotMet
    } else {
        Verdict::Undecided
    }
}

/// Returns the values of the readings, and both ends of their intervals. `None` if one is missing.
fn readings(meter: &MeterReport) -> (Option<Vec<f64>>, Option<[Vec<f64>; 2]>) {
    let number = |value: &Value| match value {
        Value::Number(number) => Some(*number),
        Value::Spectrum(_) => None,
    };
    let end = |k: usize| meter.points.iter().map(|point| number(&point.interval_95.as_ref()?[k])).collect();
    let (low, high): (Option<Vec<f64>>, Option<Vec<f64>>) = (end(0), end(1));
    let values = meter.points.iter().map(|point| number(&point.value)).collect();
    (values, low.zip(high).map(|(low, high)| [low, high]))
}

fn mean_of(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The noise of readings may be common to all, so the interval is the mean of their intervals.
fn mean(meter: &MeterReport) -> Estimate {
    let (_, ends) = readings(meter);
    Estimate { value: meter.mean, interval: ends.map(|ends| ends.map(|end| mean_of(&end))) }
}

fn extreme(meter: &MeterReport, of: fn(f64, f64) -> f64) -> Estimate {
    let fold = |values: &[f64]| values.iter().copied().reduce(of);
    let (values, ends) = readings(meter);
    let interval = ends.and_then(|[low, high]| Some([fold(&low)?, fold(&high)?]));
    Estimate { value: values.and_then(|values| fold(&values)), interval }
}

/// The interval contains U0 whatever the correlation of the readings is.
fn uniformity(meter: &MeterReport) -> Estimate {
    let Estimate { interval: Some([low, high]), .. } = extreme(meter, f64::min) else {
        return Estimate { value: meter.uniformity, interval: None };
    };
    let interval = mean(meter).interval.filter(|[least, _]| *least > 0.0);
    let interval = interval.map(|[least, largest]| [(low / largest).max(0.0), (high / least).min(1.0)]);
    Estimate { value: meter.uniformity, interval }
}

impl Judgement {
    /// The meter, the limit, the value, its interval, the verdict and the source, as texts.
    pub fn cells(&self) -> [String; 6] {
        let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), significant);
        let interval = self
            .interval_95
            .map_or_else(|| "–".to_owned(), |[low, high]| format!("{} to {}", significant(low), significant(high)));
        let source = self.source.clone().unwrap_or_default();
        [
            self.meter.clone(),
            self.requirement.clone(),
            number(self.value),
            interval,
            self.verdict.words().to_owned(),
            source,
        ]
    }
}

/// Returns the judgements as lines of text.
pub fn table(judgements: &[Judgement]) -> String {
    let rows: Vec<[String; 6]> = judgements.iter().map(Judgement::cells).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 6] = std::array::from_fn(width);
    let mut text = if rows.is_empty() { String::new() } else { "requirements\n".to_owned() };
    for [meter, requirement, value, interval, verdict, source] in &rows {
        let line = format!(
            "  {meter:0$}  {requirement:1$}  {value:>2$}  {interval:>3$}  {verdict:4$}  {source}",
            widths[0], widths[1], widths[2], widths[3], widths[4]
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limit itself counts as reached.
    #[test]
    fn a_limit_is_judged_by_the_whole_interval() {
        let at_least = |low, high| verdict(Some([low, high]), 500.0, true);
        assert_eq!(at_least(500.0, 520.0), Verdict::Met);
        assert_eq!(at_least(499.9, 520.0), Verdict::Undecided);
        assert_eq!(at_least(480.0, 500.0), Verdict::Undecided);
        assert_eq!(at_least(480.0, 499.9), Verdict::NotMet);
        let at_most = |low, high| verdict(Some([low, high]), 19.0, false);
        assert_eq!(at_most(18.0, 19.0), Verdict::Met);
        assert_eq!(at_most(18.0, 19.1), Verdict::Undecided);
        assert_eq!(at_most(19.1, 20.0), Verdict::NotMet);
        assert_eq!(verdict(None, 19.0, false), Verdict::Undecided);
    }
}
