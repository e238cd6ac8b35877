//! Dates of files, in the form of XML (ISO 8601, UTC).

use std::time::{SystemTime, UNIX_EPOCH};

/// A moment, in seconds since the beginning of 1970.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment(pub u64);

impl Moment {
    /// Returns the present moment by the system's clock; 0 if the clock is set to a date before 1970.
    pub fn now() -> Self {
        Self(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()))
    }

    /// Returns the date in UTC, such as `2024-02-29`. The computation lets years begin in March, so that a leap day is
    /// the last day of its year. From March on, the lengths of the months repeat after five months, which together have
    /// 153 days.
    pub fn date(self) -> String {
        // 719,468 days lie between 1 March of the year 0 and 1 January 1970; 400 years have 146,097 days.
        let days = self.0 / 86_400 + 719_468;
        let (era, day) = (days / 146_097, days % 146_097);
        let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
        let day = day - (365 * year + year / 4 - year / 100);
        let month = (5 * day + 2) / 153;
        let day = day - (153 * month + 2) / 5 + 1;
        let month = if month < 10 { month + 3 } else { month - 9 };
        let year = era * 400 + year + u64::from(month <= 2);
        format!("{year:04}-{month:02}-{day:02}")
    }

    /// Returns the date and the time in UTC, such as `2024-02-29T12:34:56Z`.
    pub fn date_and_time(self) -> String {
        let second = self.0 % 86_400;
        format!("{}T{:02}:{:02}:{:02}Z", self.date(), second / 3600, second / 60 % 60, second % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_have_their_dates() {
        for (seconds, want) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_735_689_599, "2024-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(Moment(seconds).date_and_time(), want);
        }
        assert!(Moment::now().0 > 1_700_000_000);
    }
}
