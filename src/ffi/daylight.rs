//! Daylight
//!
//! The sun's position, and skies as the environment of a scene: the standard skies of CIE S 011 and the all-weather sky
//! of Perez et al. These calls are synchronous: they do their work before they return.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::Owned;
use super::params::{self, Report, Versioned, versioned};
use super::query::LUXFER_NONE;
use super::scene::luxfer_scene;
use super::status::luxfer_status;
use crate::daylight::sky::check_rows;
use crate::daylight::{Conditions, LightUnit, PlaceAndTime, SkyModel, SunPosition};
use crate::error::{Error, Result};
use crate::scene::Environment;
use glam::DVec3;

/// A place on the Earth and a time. Fill it with luxfer_sun_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_sun_params {
    /// sizeof(luxfer_sun_params), set by luxfer_sun_params_init.
    pub struct_size: u32,
    /// Year in the Gregorian calendar, in [1600, 2500]; default 2000.
    pub year: i32,
    /// Month, in [1, 12]; default 1.
    pub month: u32,
    /// Day of the month, from 1 to the number of its days; default 1.
    pub day: u32,
    /// Hours of universal time (UTC) since the midnight with which the date begins, in [-24, 48]; default 12. For a
    /// local time it is the local hour minus the zone, such as 14.5 - 2 for half past two in a zone two hours ahead.
    pub hour: f64,
    /// Latitude in degrees, in [-90, 90], positive to the north; default 0.
    pub latitude: f64,
    /// Longitude in degrees, in [-180, 180], positive to the east; default 0.
    pub longitude: f64,
}

versioned!(luxfer_sun_params, [40], {
    Self { struct_size: 40, year: 2000, month: 1, day: 1, hour: 12.0, latitude: 0.0, longitude: 0.0 }
});

/// The position of the sun.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_sun_position {
    /// sizeof(luxfer_sun_position), set by the function that fills the struct.
    pub struct_size: u32,
    /// Reserved; always 0.
    pub reserved: u32,
    /// Angle of the sun's centre above the horizon in radians, in [-pi / 2, pi / 2], without refraction.
    pub altitude: f64,
    /// Angle in radians from north over east, in [0, 2 pi).
    pub azimuth: f64,
    /// Distance of the sun in astronomical units.
    pub distance: f64,
}

versioned!(luxfer_sun_position, [32], {
    Self { struct_size: 32, reserved: 0, altitude: 0.0, azimuth: 0.0, distance: 1.0 }
});

/// A model of the sky's relative luminance: a LUXFER_SKY_ value.
pub type luxfer_sky_model = i32;
/// A standard sky of CIE S 011 / ISO 15469.
pub const LUXFER_SKY_CIE: luxfer_sky_model = 0;
/// The all-weather sky of Perez et al. (1993).
pub const LUXFER_SKY_PEREZ: luxfer_sky_model = 1;

/// The unit of the light of sun and sky: a LUXFER_DAYLIGHT_ value.
pub type luxfer_daylight_unit = i32;
/// Illuminance in lux.
pub const LUXFER_DAYLIGHT_LUX: luxfer_daylight_unit = 0;
/// Irradiance in W/m², converted to lux by the luminous efficacies of Perez et al. (1990).
pub const LUXFER_DAYLIGHT_WATTS: luxfer_daylight_unit = 1;

/// A state of sun and sky. Fill it with luxfer_sky_params_init. The default is the overcast sky of type 1 with 10,000
/// lx: 100 lx indoors are then a daylight factor of 1 %.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_sky_params {
    /// sizeof(luxfer_sky_params), set by luxfer_sky_params_init.
    pub struct_size: u32,
    /// Model of the sky: a LUXFER_SKY_ value; default LUXFER_SKY_CIE.
    pub model: luxfer_sky_model,
    /// Type of a standard sky: 1 to 15 as in CIE S 011 (1 overcast, 5 uniform, 12 clear), or 16 for the traditional
    /// overcast sky, whose zenith is three times as bright as its horizon; default 1.
    pub cie_type: u32,
    /// Unit of direct_normal and diffuse_horizontal: a LUXFER_DAYLIGHT_ value; default LUXFER_DAYLIGHT_LUX.
    pub unit: luxfer_daylight_unit,
    /// Altitude of the sun in radians, in [-pi / 2, pi / 2], such as luxfer_sun_get_position gives it; default pi / 4.
    /// A sun at 0 or below gives no light, and the sky has the shape that it has with the sun at 0.
    pub sun_altitude: f64,
    /// Azimuth of the sun in radians, from north over east, in [-2 pi, 2 pi]; default pi, the south.
    pub sun_azimuth: f64,
    /// Distance of the sun in astronomical units, in [0.9, 1.1]; default 1. It counts for the Perez sky, for
    /// irradiances and for the size of the sun's disc.
    pub sun_distance: f64,
    /// Light of the sun on a plane that faces it, in [0, 1e6] lx or [0, 2000] W/m²; default 0.
    pub direct_normal: f64,
    /// Light of the sky, without the sun, on a level plane, in [0, 1e6] lx or [0, 2000] W/m²; default 10000.
    pub diffuse_horizontal: f64,
    /// Luminance of the zenith in cd/m², in [0, 1e6]. If it is not 0, it replaces diffuse_horizontal. It must be 0 for
    /// the Perez sky. Default 0.
    pub zenith_luminance: f64,
    /// Dew point at the ground in degrees Celsius, in [-90, 60], from which the efficacies of irradiances estimate the
    /// water in the air; default 11, which stands for 2.0 cm of water.
    pub dew_point: f64,
    /// Reflectance of the ground, in [0, 1]; default 0.2. Below the horizon the environment has the uniform luminance
    /// of a diffuse ground with this reflectance under the unobstructed sun and sky.
    pub ground_reflectance: f64,
    /// Colour temperature of the sky in kelvin, in [1000, 20000]; 0, the default: neutral white.
    pub sky_kelvin: f64,
    /// Colour temperature of the sun in kelvin, in [1000, 20000]; 0, the default: neutral white.
    pub sun_kelvin: f64,
    /// Direction of north in the scene, of which only the part perpendicular to y counts; default (0, 0, -1), so that
    /// east is +x.
    pub north: [f32; 3],
    /// Rows of the environment image, an even number in [16, 4096]; default 256. The image has twice as many columns.
    pub rows: u32,
}

versioned!(luxfer_sky_params, [112], {
    let d = Conditions::default();
    Self {
        struct_size: 112,
        model: LUXFER_SKY_CIE,
        cie_type: 1,
        unit: LUXFER_DAYLIGHT_LUX,
        sun_altitude: d.sun.altitude,
        sun_azimuth: d.sun.azimuth,
        sun_distance: d.sun.distance,
        direct_normal: d.direct_normal,
        diffuse_horizontal: d.diffuse_horizontal,
        zenith_luminance: d.zenith_luminance,
        dew_point: d.dew_point,
        ground_reflectance: d.ground_reflectance,
        sky_kelvin: d.sky_kelvin,
        sun_kelvin: d.sun_kelvin,
        north: [0.0, 0.0, -1.0],
        rows: 256,
    }
});

impl luxfer_sky_params {
    fn conditions(&self) -> Result<Conditions> {
        Ok(Conditions {
            model: match self.model {
                LUXFER_SKY_CIE => SkyModel::Cie(self.cie_type),
                LUXFER_SKY_PEREZ => SkyModel::Perez,
                other => return Err(Error::argument(format!("model is {other}; it must be a LUXFER_SKY_ value"))),
            },
            unit: match self.unit {
                LUXFER_DAYLIGHT_LUX => LightUnit::Lux,
                LUXFER_DAYLIGHT_WATTS => LightUnit::Watts,
                other => return Err(Error::argument(format!("unit is {other}; it must be a LUXFER_DAYLIGHT_ value"))),
            },
            sun: SunPosition { altitude: self.sun_altitude, azimuth: self.sun_azimuth, distance: self.sun_distance },
            direct_normal: self.direct_normal,
            diffuse_horizontal: self.diffuse_horizontal,
            zenith_luminance: self.zenith_luminance,
            dew_point: self.dew_point,
            ground_reflectance: self.ground_reflectance,
            sky_kelvin: self.sky_kelvin,
            sun_kelvin: self.sun_kelvin,
        })
    }
}

/// The light of a sky.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_sky_report {
    /// sizeof(luxfer_sky_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Index of the sun among the punctual lights of the scene; LUXFER_NONE if the scene has no sun.
    pub sun: u32,
    /// Illuminance in lux of a plane that faces the sun, by the sun alone; 0 if the sun is not above the horizon.
    pub direct_normal: f64,
    /// Illuminance in lux of a level plane by the sky alone.
    pub diffuse_horizontal: f64,
    /// Luminance of the zenith in cd/m².
    pub zenith_luminance: f64,
    /// Luminance of the ground in cd/m².
    pub ground_luminance: f64,
    /// Clearness epsilon of Perez et al., from 1, an overcast sky, to 12, a clear one.
    pub clearness: f64,
    /// Brightness delta of Perez et al., in [0.01, 0.6].
    pub brightness: f64,
}

versioned!(luxfer_sky_report, [56], {
    Self {
        struct_size: 56,
        sun: LUXFER_NONE,
        direct_normal: 0.0,
        diffuse_horizontal: 0.0,
        zenith_luminance: 0.0,
        ground_luminance: 0.0,
        clearness: 1.0,
        brightness: 0.0,
    }
});

/// Computes the position of the sun, to within 0.01 degrees. size is sizeof *position. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value is out of range, or the month does not have the day.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_sun_get_position(
    context: *mut luxfer_context,
    params: *const luxfer_sun_params,
    position: *mut luxfer_sun_position,
    size: usize,
) -> luxfer_status {
    enter(context, |_| {
        let out = Report::new(position, size)?;
        let luxfer_sun_params { year, month, day, hour, latitude, longitude, .. } = params::read_required(params)?;
        let sun = PlaceAndTime { latitude, longitude, year, month, day, hour }.sun()?;
        out.set(luxfer_sun_position {
            altitude: sun.altitude,
            azimuth: sun.azimuth,
            distance: sun.distance,
            ..luxfer_sun_position::defaults()
        });
        Ok(())
    })
}

/// Sets the sky and the sun of a scene. The sky and the ground become the environment of the scene, an image that
/// replaces an earlier environment. The sun becomes a directional light with an angular diameter of 0.533 degrees at a
/// distance of 1: it casts soft shadows, and pictures and mirrors show it. A later call changes this light; if it gives
/// no sun, the light stays, with an illuminance of 0, so that the other lights keep their indices.
/// luxfer_scene_set_environment replaces the sky, but not the sun. Files of luxfer_scene_export contain the sun as a
/// light without a size, and no sky. params may be NULL for the defaults.
/// report may be NULL; size is sizeof *report. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value is out of range, or a setting does not suit the model; LUXFER_OUT_OF_MEMORY
/// beyond the memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_set_sky(
    scene: *mut luxfer_scene,
    params: *const luxfer_sky_params,
    report: *mut luxfer_sky_report,
    size: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let out = if report.is_null() { None } else { Some(Report::new(report, size)?) };
        let params = params::read(params)?;
        let conditions = params.conditions()?;
        check_rows(params.rows)?;
        // The image has 2 rows x rows pixels of 3 floats. The luminance of its upper half is drawn in double precision.
        let area = u64::from(params.rows).pow(2);
        let charge = object.context().charge(area * 6 * size_of::<f32>() as u64)?;
        let _drawing = object.context().charge(area * size_of::<f64>() as u64)?;
        let sky = conditions.sky(DVec3::from(params.north.map(f64::from)), params.rows)?;
        let (sun, image) = (sky.sun, sky.image);
        let index = object.change_environment(charge, |scene| {
            scene.environment = Some(Environment::Image(image));
            scene.set_sun(sun.map(|sun| (-sun.towards, sun.illuminance, sun.half_angle)))
        });
        if let Some(out) = out {
            out.set(luxfer_sky_report {
                sun: index.map_or(LUXFER_NONE, |index| index as u32),
                direct_normal: sky.direct_normal,
                diffuse_horizontal: sky.diffuse_horizontal,
                zenith_luminance: sky.zenith_luminance,
                ground_luminance: sky.ground_luminance,
                clearness: sky.clearness,
                brightness: sky.brightness,
                ..luxfer_sky_report::defaults()
            });
        }
        Ok(())
    })
}
