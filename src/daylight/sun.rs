//! The sun's position by the low-precision formulas of Meeus, "Astronomical Algorithms" (2nd edition, 1998): the sun's
//! longitude of chapter 25, the mean sidereal time of chapter 12, and the largest terms of nutation and aberration.
//!
//! The tests compare with the Solar Position Algorithm of Reda and Andreas (2004): the direction is right to within
//! 0.01° from 1600 to 2500. Positions are topocentric: the parallax counts, refraction does not.

use crate::error::{Error, Result, check_range};
use crate::maths;
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// First and last year. Before them, calendars other than the Gregorian were in use; after them, the rotation of the
/// Earth cannot be predicted well enough.
pub const YEARS: [i32; 2] = [1600, 2500];

/// Julian day of the epoch J2000: noon of 1 January 2000. [convention]
const J2000: f64 = 2_451_545.0;
/// Horizontal parallax of the sun at one astronomical unit: 8.794″ in radians. [paper: Meeus 1998, chapter 40]
const PARALLAX: f64 = 8.794 / 3600.0 * std::f64::consts::PI / 180.0;

/// A place on the Earth and a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceAndTime {
    /// Latitude in degrees, in `[-90, 90]`; positive to the north.
    pub latitude: f64,
    /// Longitude in degrees, in `[-180, 180]`; positive to the east.
    pub longitude: f64,
    /// Date in the Gregorian calendar; the year lies within [`YEARS`].
    pub year: i32,
    pub month: u32,
    pub day: u32,
    /// Hours of universal time since the midnight with which the date begins, in `[-24, 48]`, so that a local time
    /// minus its zone needs no other date.
    pub hour: f64,
}

/// The position of the sun in the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// Angle above the horizon in radians, in `[-π / 2, π / 2]`, without refraction.
    pub altitude: f64,
    /// Angle in radians from north over east, in `[0, 2π)`. At a pole, north is the direction of the opposite meridian
    /// or, at the South Pole, of the meridian of the longitude itself.
    pub azimuth: f64,
    /// Distance in astronomical units.
    pub distance: f64,
}

impl SunPosition {
    /// Returns the unit vector towards the sun in coordinates with y up. `north` is a direction whose component
    /// perpendicular to y counts.
    ///
    /// # Errors
    /// `north` points straight up or down, or is not finite.
    pub fn towards(&self, north: DVec3) -> Result<DVec3> {
        let across = north.try_normalize().map(|n| DVec2::new(n.x, n.z)).filter(|across| across.length() > 1e-6);
        let across = across.ok_or_else(|| {
            Error::argument(format!("north is {north}; it must be finite and not along the y axis, which points up"))
        })?;
        let [north, east] = [across.normalize(), across.normalize().perp()];
        let (sine, cosine) = maths::sin_cos(self.azimuth);
        let (up, level) = maths::sin_cos(self.altitude);
        let flat = (north * cosine + east * sine) * level;
        Ok(DVec3::new(flat.x, up, flat.y))
    }
}

impl PlaceAndTime {
    /// Computes the position of the sun.
    ///
    /// # Errors
    /// A value out of range; a date that does not exist.
    pub fn sun(&self) -> Result<SunPosition> {
        check_range("latitude", self.latitude, -90.0, 90.0)?;
        check_range("longitude", self.longitude, -180.0, 180.0)?;
        let days = self.julian_day()? - J2000;
        let (right_ascension, declination, distance, equation) = equatorial(days + delta_t(self.year) / 86_400.0);

        // Turn the Earth to the apparent sidereal time (chapter 12).
        let t = days / 36_525.0;
        let sidereal = 280.460_618_37 + 360.985_647_366_29 * days + t * t * (0.000_387_933 - t / 38_710_000.0);
        let hour_angle = ((sidereal + equation + self.longitude) % 360.0).to_radians() - right_ascension;

        // Change to horizontal coordinates: east, north and up (chapter 13).
        let (sin_latitude, cos_latitude) = maths::sin_cos(self.latitude.to_radians());
        let (sin_declination, cos_declination) = maths::sin_cos(declination);
        let (sin_hour, cos_hour) = maths::sin_cos(hour_angle);
        let east = -cos_declination * sin_hour;
        let north = sin_declination * cos_latitude - cos_declination * cos_hour * sin_latitude;
        let up = sin_declination * sin_latitude + cos_declination * cos_hour * cos_latitude;
        let level = maths::hypot(east, north);
        let altitude = maths::atan2(up, level) - PARALLAX / distance * level;
        let azimuth = maths::atan2(east, north).rem_euclid(std::f64::consts::TAU) % std::f64::consts::TAU;
        Ok(SunPosition { altitude: altitude.clamp(-FRAC_PI_2, FRAC_PI_2), azimuth, distance })
    }

    /// Returns the Julian day in universal time (chapter 7).
    fn julian_day(&self) -> Result<f64> {
        check_range("year", self.year, YEARS[0], YEARS[1])?;
        check_range("month", self.month, 1, 12)?;
        check_range("day", self.day, 1, days_of(self.year, self.month))?;
        check_range("hour", self.hour, -24.0, 48.0)?;
        // Count the year from March, so that the leap day is the last one.
        let is_early = self.month < 3;
        let year = if is_early { self.year - 1 } else { self.year };
        let month = if is_early { self.month + 12 } else { self.month };
        let century = year.div_euclid(100);
        let leap = 2 - century + century.div_euclid(4);
        let days = (365.25 * f64::from(year + 4716)).floor() + (30.6001 * f64::from(month + 1)).floor();
        Ok(days + f64::from(self.day as i32 + leap) - 1524.5 + self.hour / 24.0)
    }
}

/// Returns the number of days of a month in the Gregorian calendar.
fn days_of(year: i32, month: u32) -> u32 {
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    match month {
        2 => 28 + u32::from(is_leap),
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// Returns by how many seconds dynamical time is ahead of universal time: the parabola of Morrison and Stephenson
/// (2004). It is within 60 s of the measured values from 1600 to 2025; in 60 s, the sun moves by 0.0007°.
fn delta_t(year: i32) -> f64 {
    let centuries = f64::from(year - 1820) / 100.0;
    -20.0 + 32.0 * centuries * centuries
}

/// Returns the sun's apparent right ascension and declination in radians, its distance in astronomical units, and the
/// equation of the equinoxes in degrees (chapter 25). `days` counts in dynamical time from J2000.
fn equatorial(days: f64) -> (f64, f64, f64, f64) {
    let t = days / 36_525.0;
    let radians = |degrees: f64| (degrees % 360.0).to_radians();

    // The mean longitude, the mean anomaly and the eccentricity give the true longitude by the equation of the centre.
    let mean_longitude = 280.466_46 + t * (36_000.769_83 + t * 0.000_303_2);
    let anomaly = radians(357.529_11 + t * (35_999.050_29 - t * 0.000_153_7));
    let eccentricity = 0.016_708_634 - t * (0.000_042_037 + t * 0.000_000_126_7);
    let centre = (1.914_602 - t * (0.004_817 + t * 0.000_014)) * maths::sin(anomaly)
        + (0.019_993 - t * 0.000_101) * maths::sin(2.0 * anomaly)
        + 0.000_289 * maths::sin(3.0 * anomaly);
    let ellipse = 1.000_001_018 * (1.0 - eccentricity * eccentricity);
    let distance = ellipse / (1.0 + eccentricity * maths::cos(anomaly + centre.to_radians()));

    // Nutation, from the longitude of the Moon's ascending node, and aberration give the apparent longitude.
    let (sin_node, cos_node) = maths::sin_cos(radians(125.04 - 1934.136 * t));
    let longitude = radians(mean_longitude + centre - 0.005_69 - 0.004_78 * sin_node);
    let obliquity = 23.439_291_11 - t * (0.013_004_167 + t * (0.000_000_164 - t * 0.000_000_504)) + 0.002_56 * cos_node;
    let (sin_obliquity, cos_obliquity) = maths::sin_cos(obliquity.to_radians());
    let (sin_longitude, cos_longitude) = maths::sin_cos(longitude);
    let right_ascension = maths::atan2(cos_obliquity * sin_longitude, cos_longitude);
    let declination = maths::asin(sin_obliquity * sin_longitude);
    (right_ascension, declination, distance, -0.004_78 * sin_node * cos_obliquity)
}
