//! By what and when a page was made.

use std::time::{SystemTime, UNIX_EPOCH};

/// What made a page, such as a command, and the time: `optimize a.json --report, 2026-03-01 12:30 UTC`.
pub(crate) fn made(by: &str) -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let seconds = now.map_or(0, |own| own.as_secs());
    format!("{by}, {}", date(seconds))
}

/// Seconds since 1970 as a date of the Gregorian calendar and a time (H. Hinnant, chrono-compatible low-level date
/// algorithms, `civil_from_days`).
fn date(seconds: u64) -> String {
    let (days, minutes) = (seconds / 86_400 + 719_468, seconds % 86_400 / 60);
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let of_year = day - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let of_month = of_year - (153 * month + 2) / 5 + 1;
    let (month, year) = match month < 10 {
        true => (month + 3, year + 400 * era),
        false => (month - 9, year + 400 * era + 1),
    };
    let (hour, minute) = (minutes / 60, minutes % 60);
    format!("{year}-{month:02}-{of_month:02} {hour:02}:{minute:02} UTC")
}

#[cfg(test)]
mod tests {
    use super::date;

    #[test]
    fn days_are_those_of_the_calendar() {
        for (seconds, expected) in [
            (0, "1970-01-01 00:00 UTC"),
            (951_782_400, "2000-02-29 00:00 UTC"),
            (1_709_251_199, "2024-02-29 23:59 UTC"),
            (4_107_542_400, "2100-03-01 00:00 UTC"),
            (1_767_225_599, "2025-12-31 23:59 UTC"),
        ] {
            assert_eq!(date(seconds), expected);
        }
    }
}
