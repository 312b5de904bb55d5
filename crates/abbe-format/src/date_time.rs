//! Dates and times in the scene file, in the format of RFC 3339 (ISO 8601).

use abbe_spectra::error::{Error, Result};

/// The Julian day of 1970-01-01 at 00:00.
const JULIAN_DAY_1970: f64 = 2_440_587.5;

/// The years in which positions of the sun are accurate.
const YEARS: std::ops::RangeInclusive<i64> = 1900..=2100;

/// Returns the Julian day of a time from 1900 to 2100 such as `2026-06-21T12:00:00+02:00`. The
/// offset from universal time is required (`Z` means none), and the seconds may be left out.
pub(super) fn julian_day(text: &str) -> Result<f64> {
    let error = || {
        let expected = "a time from 1900 to 2100 with its offset from UTC, such as \"2026-06-21T12:00:00+02:00\"";
        Error::input(format!("found \"{text}\"")).expected(expected)
    };
    parse(text).ok_or_else(error)
}

fn parse(text: &str) -> Option<f64> {
    let (date, time) = text.split_once('T')?;
    let [year, month, day] = numbers(date, '-', &[4, 2, 2])?[..] else { return None };
    let offset_at = time.find(['Z', '+', '-'])?;
    let (clock, offset) = time.split_at(offset_at);
    let seconds = match clock.matches(':').count() {
        1 => numbers(clock, ':', &[2, 2]).map(|clock| [clock[0], clock[1], 0]),
        _ => numbers(clock, ':', &[2, 2, 2]).map(|clock| [clock[0], clock[1], clock[2]]),
    };
    let [hour, minute, second] = seconds?;
    let offset_minutes = match (offset.strip_prefix('+'), offset.strip_prefix('-')) {
        (Some(offset), _) => minutes(offset)?,
        (_, Some(offset)) => -minutes(offset)?,
        _ if offset == "Z" => 0,
        _ => return None,
    };
    let valid = YEARS.contains(&year)
        && (1..=12).contains(&month)
        && (1..=days_of_month(year, month)).contains(&day)
        && hour < 24
        && minute < 60
        && second < 60;
    if !valid {
        return None;
    }
    let of_day = (hour * 60 + minute - offset_minutes) * 60 + second;
    Some(JULIAN_DAY_1970 + days_since_1970(year, month, day) as f64 + of_day as f64 / 86_400.0)
}

fn minutes(offset: &str) -> Option<i64> {
    let [hours, minutes] = numbers(offset, ':', &[2, 2])?[..] else { return None };
    (hours < 24 && minutes < 60).then_some(hours * 60 + minutes)
}

/// Returns numbers with these counts of digits, between separators.
fn numbers(text: &str, separator: char, digits: &[usize]) -> Option<Vec<i64>> {
    let parts: Vec<&str> = text.split(separator).collect();
    let fits = |(part, count): (&&str, &usize)| part.len() == *count && part.bytes().all(|byte| byte.is_ascii_digit());
    let valid = parts.len() == digits.len() && parts.iter().zip(digits).all(fits);
    if valid { parts.iter().map(|part| part.parse().ok()).collect() } else { None }
}

fn is_leap_year(year: i64) -> bool {
    year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)
}

fn days_of_month(year: i64, month: i64) -> i64 {
    match month {
        2 if is_leap_year(year) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    let of_years = |before: i64| 365 * before + before / 4 - before / 100 + before / 400;
    let of_months: i64 = (1..month).map(|month| days_of_month(year, month)).sum();
    of_years(year - 1) - of_years(1969) + of_months + day - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times with offsets have the Julian days of the reference file, to 1 ms.
    #[test]
    fn julian_days_agree_with_the_golden_values() {
        let golden: serde_json::Value = serde_json::from_str(include_str!("../../../tests/golden/sun.json")).unwrap();
        for case in golden["cases"].as_array().unwrap() {
            let (found, expected) = (julian_day(case["time"].as_str().unwrap()), case["julian_day"].as_f64().unwrap());
            assert!((found.unwrap() - expected).abs() < 1.5e-8, "{case}");
        }
        assert_eq!(julian_day("2000-01-01T12:00Z").ok(), Some(2_451_545.0));
    }

    #[test]
    fn texts_that_are_no_times_are_errors() {
        let texts = "2026-06-21|2026-06-21T12:00:00|2026-06-21 12:00:00Z|2026-02-29T12:00:00Z|2026-13-01T12:00:00Z|\
                     2026-06-21T24:00:00Z|2026-06-21T12:60:00Z|2026-06-21T12:00:00+2|2026-06-21T12:00:00Zx|\
                     1899-12-31T12:00:00Z|+026-06-21T12:00:00Z|";
        for text in texts.split('|') {
            assert!(julian_day(text).is_err(), "{text}");
        }
    }
}
