//! Reads weather files of EnergyPlus (EPW): the place, and irradiance and dew point of each hour. The format is
//! described in "Auxiliary Programs" of EnergyPlus, chapter "Weather Converter Program".
//!
//! The reader is strict: it checks every value that it returns, the number of fields of each row, the order of the
//! rows' dates, and that the file goes on to the end of its last data period. Errors name the line. Files with several
//! rows per hour are refused.

use crate::error::{Error, ErrorKind, Result};
use crate::image::try_push;
use crate::photometry::text_lines::{Lines, at, count, within};

/// Number of header lines, of which the first states the place and the last the data periods.
const HEADER: usize = 8;
/// Number of hours of a leap year, the largest number of rows.
pub const MAX_HOURS: usize = 8784;
/// Smallest number of fields of a row. The fields up to the zenith luminance are in all editions of the format, and the
/// last field that is read stands before it, so that it is complete in a row that the end of the file cuts off.
const MIN_FIELDS: usize = 20;

/// Largest irradiance in W/m² and illuminance in lux; 9999 and values from 999,900 on stand for missing values.
/// [convention]
const MAX_IRRADIANCE: f64 = 2000.0;
const MISSING_IRRADIANCE: f64 = 9999.0;
const MAX_ILLUMINANCE: f64 = 250_000.0;
const MISSING_ILLUMINANCE: f64 = 999_900.0;
/// Range of the dew point in °C, and the number that stands for a missing one. [convention]
const DEW_POINTS: [f64; 2] = [-90.0, 70.0];
const MISSING_DEW_POINT: f64 = 99.9;

/// The weather of a place over some time, such as a year.
#[derive(Clone, Debug, PartialEq)]
pub struct Weather {
    pub city: String,
    /// Latitude and longitude in degrees, positive to the north and to the east.
    pub latitude: f64,
    pub longitude: f64,
    /// Hours by which the file's time is ahead of universal time.
    pub time_zone: f64,
    /// Height above the sea in metres.
    pub elevation: f64,
    pub hours: Vec<Hour>,
}

/// The weather of an hour. A value that the file does not have is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hour {
    pub year: i32,
    pub month: u32,
    pub day: u32,
    /// The hour, from 1 to 24: hour 1 ends at 1:00.
    pub hour: u32,
    /// Dew point in °C.
    pub dew_point: f64,
    /// Direct normal and diffuse horizontal irradiance in W/m².
    pub direct_normal: f64,
    pub diffuse_horizontal: f64,
    /// Direct normal and diffuse horizontal illuminance in lux.
    pub direct_normal_lux: f64,
    pub diffuse_horizontal_lux: f64,
}

impl Weather {
    /// Reads a file from its bytes.
    ///
    /// # Errors
    /// `Format`, with the line, if the file is malformed or ends early; `Unsupported` for several rows per hour.
    pub fn read(bytes: &[u8]) -> Result<Self> {
        let lines = Lines::new(bytes)?;
        let mut lines = lines.numbered();
        let mut weather = place(lines.next())?;
        let mut end = None;
        for number in 2..=HEADER {
            let (_, line) = lines.next().ok_or_else(|| cut_off(number - 1, "its header"))?;
            if number == HEADER {
                end = Some(last_day(number, line)?);
            }
        }
        let mut last = HEADER;
        for (number, line) in lines.filter(|(_, line)| !line.is_empty()) {
            if weather.hours.len() == MAX_HOURS {
                return Err(at(number, format_args!("the file has more than {MAX_HOURS} hours, those of a leap year")));
            }
            let hour = hour(number, line)?;
            if let Some(before) = weather.hours.last() {
                check_order(number, before, &hour)?;
            }
            try_push(&mut weather.hours, hour)?;
            last = number;
        }
        match (weather.hours.last(), end) {
            (Some(hour), Some(day)) if (hour.month, hour.day) == day && hour.hour == 24 => Ok(weather),
            (Some(_), Some((month, day))) => Err(cut_off(last, format_args!("hour 24 of {month}/{day}"))),
            _ => Err(cut_off(last, "its first hour")),
        }
    }
}

impl Hour {
    /// Returns the middle of the hour in universal time, in hours since the midnight with which its date begins. It may
    /// be negative, or larger than 24.
    pub fn universal(&self, time_zone: f64) -> f64 {
        f64::from(self.hour) - 0.5 - time_zone
    }
}

fn cut_off(line: usize, what: impl std::fmt::Display) -> Error {
    at(line, format_args!("the file ends here, before {what}"))
}

/// Reads the header line LOCATION: city, state, country, source, station, latitude, longitude, time zone, elevation.
fn place(first: Option<(usize, &str)>) -> Result<Weather> {
    let (number, line) = first.ok_or_else(|| at(1, "the file is empty"))?;
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    if !fields[0].eq_ignore_ascii_case("LOCATION") {
        return Err(at(number, "an EPW file must begin with LOCATION"));
    }
    let &[_, city, _, _, _, _, latitude, longitude, zone, elevation] = &fields[..] else {
        return Err(at(number, format_args!("LOCATION has {} fields; it must have 10", fields.len())));
    };
    Ok(Weather {
        city: city.into(),
        latitude: within(number, latitude, "the latitude", -90.0, 90.0)?,
        longitude: within(number, longitude, "the longitude", -180.0, 180.0)?,
        time_zone: within(number, zone, "the time zone", -12.0, 14.0)?,
        elevation: within(number, elevation, "the elevation", -1000.0, 9999.9)?,
        hours: Vec::new(),
    })
}

/// Reads the header line DATA PERIODS. Returns the month and the day with which its last period ends.
fn last_day(number: usize, line: &str) -> Result<(u32, u32)> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    if !fields[0].eq_ignore_ascii_case("DATA PERIODS") {
        return Err(at(number, "the header must end with DATA PERIODS"));
    }
    let [_, periods, rows, rest @ ..] = &fields[..] else {
        return Err(at(number, "DATA PERIODS lacks the numbers of periods and of rows per hour"));
    };
    let periods = count(number, periods, "the number of data periods", 1, 16)?;
    let rows = count(number, rows, "the number of rows per hour", 1, 60)?;
    if rows != 1 {
        return Err(Error::new(
            ErrorKind::Unsupported,
            format!("line {number}: the file has {rows} rows per hour; files with one row per hour are read"),
        ));
    }
    // A period has a name, a day of the week, a first and a last date.
    let end = rest
        .get(4 * periods - 1)
        .ok_or_else(|| at(number, format_args!("DATA PERIODS lacks its {periods} periods")))?;
    let mut parts = end.split('/').map(str::trim);
    let mut part = |what: &str, high: usize| {
        let word =
            parts.next().ok_or_else(|| at(number, format_args!("the last day is {end:?}; it must be month/day")))?;
        count(number, word, what, 1, high)
    };
    Ok((part("the month of the last day", 12)? as u32, part("the last day", 31)? as u32))
}

fn hour(number: usize, line: &str) -> Result<Hour> {
    let mut fields = [""; MIN_FIELDS];
    let mut found = 0;
    for (slot, field) in fields.iter_mut().zip(line.split(',')) {
        *slot = field.trim();
        found += 1;
    }
    if found < MIN_FIELDS {
        return Err(at(number, format_args!("the row has {found} fields; it must have at least {MIN_FIELDS}")));
    }
    let whole =
        |index: usize, what: &str, low, high| Ok::<_, Error>(count(number, fields[index], what, low, high)? as u32);
    let light = |index: usize, what: &str, high: f64, missing: f64| {
        let value = within(number, fields[index], what, 0.0, f64::MAX)?;
        if value >= missing { Ok(f64::NAN) } else { within(number, fields[index], what, 0.0, high) }
    };
    let dew_point: f64 = within(number, fields[7], "the dew point", f64::MIN, f64::MAX)?;
    Ok(Hour {
        year: whole(0, "the year", 1, 9999)? as i32,
        month: whole(1, "the month", 1, 12)?,
        day: whole(2, "the day", 1, 31)?,
        hour: whole(3, "the hour", 1, 24)?,
        dew_point: if dew_point >= MISSING_DEW_POINT {
            f64::NAN
        } else {
            within(number, fields[7], "the dew point", DEW_POINTS[0], DEW_POINTS[1])?
        },
        direct_normal: light(14, "the direct normal irradiance", MAX_IRRADIANCE, MISSING_IRRADIANCE)?,
        diffuse_horizontal: light(15, "the diffuse horizontal irradiance", MAX_IRRADIANCE, MISSING_IRRADIANCE)?,
        direct_normal_lux: light(17, "the direct normal illuminance", MAX_ILLUMINANCE, MISSING_ILLUMINANCE)?,
        diffuse_horizontal_lux: light(18, "the diffuse horizontal illuminance", MAX_ILLUMINANCE, MISSING_ILLUMINANCE)?,
    })
}

/// Checks that a row is the hour after the one before it, or the first hour of another day: data periods may leave out
/// days, and typical years are made of months of different years.
fn check_order(number: usize, before: &Hour, hour: &Hour) -> Result<()> {
    let same_day = (before.month, before.day) == (hour.month, hour.day);
    let follows =
        if before.hour == 24 { hour.hour == 1 && !same_day } else { same_day && hour.hour == before.hour + 1 };
    if follows {
        return Ok(());
    }
    let name = |h: &Hour| format!("hour {} of {}/{}", h.hour, h.month, h.day);
    Err(at(
        number,
        format_args!("{} follows {}; an hour is missing, or the rows are out of order", name(hour), name(before)),
    ))
}
