//! Today's date.

use std::time::{SystemTime, UNIX_EPOCH};

const SECONDS_PER_DAY: u64 = 86_400;

/// Returns the date in UTC, such as `2026-06-21`.
pub fn today() -> String {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    date_of((since_1970.as_secs() / SECONDS_PER_DAY) as i64)
}

/// Returns the date of a day by its number since 1970-01-01, in the Gregorian calendar. Years begin
/// in March here, so that the leap day ends them (Hinnant 2013, "chrono-Compatible Low-Level Date
/// Algorithms").
fn date_of(day: i64) -> String {
    const DAYS_OF_400_YEARS: i64 = 146_097;
    // From 0000-03-01.
    let day = day + 719_468;
    let era = day.div_euclid(DAYS_OF_400_YEARS);
    let of_era = day.rem_euclid(DAYS_OF_400_YEARS);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * of_year + 2) / 153;
    let day_of_month = of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = year_of_era + 400 * era + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day_of_month:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_have_their_dates() {
        let cases = [(0, "1970-01-01"), (59, "1970-03-01"), (11_016, "2000-02-29"), (20_624, "2026-06-20")];
        for (day, date) in cases {
            assert_eq!(date_of(day), date);
        }
    }
}
