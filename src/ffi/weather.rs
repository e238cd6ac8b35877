//! Weather files
//!
//! Reads the weather files of EnergyPlus (EPW): a place, and the light of sun and sky in each hour of a year. The call
//! is synchronous: it does its work before it returns.

use super::context::luxfer_context;
use super::guard::enter;
use super::params::{Report, Versioned, versioned};
use super::pointer::{bytes_mut, set_optional, strided, text};
use super::status::luxfer_status;
use crate::daylight::epw::{Hour, Weather};
use crate::error::{Error, ErrorKind};
use crate::image::io;
use std::ffi::c_char;
use std::path::Path;

/// The place of a weather file.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_weather_report {
    /// sizeof(luxfer_weather_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of hours in the file.
    pub hours: u32,
    /// Latitude in degrees, positive to the north.
    pub latitude: f64,
    /// Longitude in degrees, positive to the east.
    pub longitude: f64,
    /// Hours by which the file's time is ahead of universal time.
    pub time_zone: f64,
    /// Height above the sea in metres.
    pub elevation: f64,
}

versioned!(luxfer_weather_report, [40], {
    Self { struct_size: 40, hours: 0, latitude: 0.0, longitude: 0.0, time_zone: 0.0, elevation: 0.0 }
});

/// The weather of an hour; values that the file does not have are NaN. Callers pass arrays of this struct, so its size
/// and fields never change in later versions.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_weather_hour {
    /// Year; in files of typical years, months may have different years.
    pub year: i32,
    /// Month, in [1, 12].
    pub month: u32,
    /// Day of the month, in [1, 31], in the time zone of the file.
    pub day: u32,
    /// Reserved; always 0.
    pub reserved: u32,
    /// Middle of the hour in universal time, in hours since the midnight with which year, month and day begin; negative
    /// or above 24 if universal time has another date. It suits luxfer_sun_params.
    pub hour: f64,
    /// Dew point in degrees Celsius.
    pub dew_point: f64,
    /// Direct normal irradiance in W/m², the mean of the hour.
    pub direct_normal: f64,
    /// Diffuse horizontal irradiance in W/m², the mean of the hour.
    pub diffuse_horizontal: f64,
    /// Direct normal illuminance in lux, the mean of the hour.
    pub direct_normal_illuminance: f64,
    /// Diffuse horizontal illuminance in lux, the mean of the hour.
    pub diffuse_horizontal_illuminance: f64,
}

impl luxfer_weather_hour {
    fn new(hour: &Hour, time_zone: f64) -> Self {
        Self {
            year: hour.year,
            month: hour.month,
            day: hour.day,
            reserved: 0,
            hour: hour.universal(time_zone),
            dew_point: hour.dew_point,
            direct_normal: hour.direct_normal,
            diffuse_horizontal: hour.diffuse_horizontal,
            direct_normal_illuminance: hour.direct_normal_lux,
            diffuse_horizontal_illuminance: hour.diffuse_horizontal_lux,
        }
    }
}

/// Reads a weather file of EnergyPlus (.epw) with one row per hour; path is UTF-8. The array hours receives count
/// hours, in the order of the file, from the hour of index first on; hour_stride is the distance between its elements
/// in bytes; 0: sizeof(luxfer_weather_hour). With a count of 0, hours may be NULL and only *report is filled. size is
/// sizeof *report. A file has at most 8784 hours. Any thread.
/// LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is malformed, lacks an hour or ends early (the message
/// names the line); LUXFER_UNSUPPORTED if it has several rows per hour; LUXFER_NOT_FOUND if the file ends before the
/// last of the hours; LUXFER_INVALID_ARGUMENT if the stride is too small.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_weather_read(
    context: *mut luxfer_context,
    path: *const c_char,
    first: usize,
    count: usize,
    hours: *mut luxfer_weather_hour,
    hour_stride: usize,
    report: *mut luxfer_weather_report,
    size: usize,
) -> luxfer_status {
    enter(context, |_| {
        let out = Report::new(report, size)?;
        let (stride, bytes) = strided::<luxfer_weather_hour>(count.max(1), hour_stride, "hours")?;
        if count > 0 {
            bytes_mut(hours.cast(), bytes, "hours")?;
        }
        let path = text(path, "path")?;
        let weather = Weather::read(&io::read_file(Path::new(path))?).map_err(|e| e.context(path))?;
        let all = &weather.hours;
        let wanted = first.checked_add(count).and_then(|end| all.get(first..end));
        let wanted = wanted.ok_or_else(|| {
            let message = format!("{count} hours from index {first} are wanted; the file has {} hours", all.len());
            Error::new(ErrorKind::NotFound, message)
        })?;
        // Each hour is written alone, because other data may lie between the hours.
        for (i, hour) in wanted.iter().enumerate() {
            let place = hours.wrapping_byte_add(i * stride);
            set_optional(place, luxfer_weather_hour::new(hour, weather.time_zone));
        }
        out.set(luxfer_weather_report {
            hours: all.len() as u32,
            latitude: weather.latitude,
            longitude: weather.longitude,
            time_zone: weather.time_zone,
            elevation: weather.elevation,
            ..luxfer_weather_report::defaults()
        });
        Ok(())
    })
}
