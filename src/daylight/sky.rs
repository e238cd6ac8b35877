//! Scales a sky model to the wanted illuminance and draws it as an environment image, with the ground below the horizon
//! and the sun as a disc.

use super::cie::StandardSky;
use super::perez::{self, SkyState};
use super::shape::LuminanceShape;
use super::sun::SunPosition;
use crate::error::{Error, ErrorKind, Result, check_range};
use crate::image::{Image, try_with_capacity};
use crate::maths;
use crate::photometry::temperature::{self, MAX_KELVIN, MIN_KELVIN};
use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Half of the angle of the sun's disc at one astronomical unit: 0.2665° in radians. [convention]
const SUN_HALF_ANGLE: f64 = 0.2665 * PI / 180.0;
/// Largest irradiance in W/m² and illuminance in lux of sky or sun. Outside the atmosphere, the sun has at most
/// 1415 W/m² and 140,000 lx; values beyond these limits are mistakes, for example in the unit. [convention]
const MAX_IRRADIANCE: f64 = 2000.0;
const MAX_ILLUMINANCE: f64 = 1e6;
/// Largest luminance of the zenith in cd/m². [convention]
const MAX_LUMINANCE: f64 = 1e6;
/// Range of the distance to the sun in astronomical units; the Earth's lies between 0.983 and 1.017. [convention]
const DISTANCES: [f64; 2] = [0.9, 1.1];
/// Range of dew points in °C. [convention]
const DEW_POINTS: [f64; 2] = [-90.0, 60.0];
/// Range of the number of rows of the image.
const ROWS: [u32; 2] = [16, 4096];

/// Number of iterations that find the irradiances of which the efficacies make given illuminances. Where these settle
/// at all, they are then constant to rounding; elsewhere they alternate between two bins. [convention]
const ITERATIONS: usize = 32;

/// The model of the sky's relative luminance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SkyModel {
    /// A standard sky by its number ([`StandardSky::new`]).
    Cie(u32),
    /// The all-weather sky of Perez et al.
    Perez,
}

/// The unit of the direct normal and the diffuse horizontal light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightUnit {
    /// Illuminance in lux.
    Lux,
    /// Irradiance in W/m², which the efficacies of Perez et al. (1990) convert.
    Watts,
}

/// A state of sun and sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    pub model: SkyModel,
    pub sun: SunPosition,
    pub unit: LightUnit,
    /// Light of the sun on a plane that faces it. It counts only if the sun is above the horizon.
    pub direct_normal: f64,
    /// Light of the sky on a level plane, without the sun.
    pub diffuse_horizontal: f64,
    /// Luminance of the zenith in cd/m². If it is not 0, it takes the place of `diffuse_horizontal`; only for standard
    /// skies.
    pub zenith_luminance: f64,
    /// Dew point at the ground in °C, for the efficacies.
    pub dew_point: f64,
    /// Reflectance in `[0, 1]` of the ground, which fills the lower half of the environment with uniform luminance.
    pub ground_reflectance: f64,
    /// Colour temperatures in kelvin of sky and sun; 0 for neutral white.
    pub sky_kelvin: f64,
    pub sun_kelvin: f64,
}

impl Default for Conditions {
    /// The overcast sky of type 1 with 10,000 lx, of which 100 lx indoors are a daylight factor of 1 %.
    fn default() -> Self {
        Self {
            model: SkyModel::Cie(1),
            sun: SunPosition { altitude: PI / 4.0, azimuth: PI, distance: 1.0 },
            unit: LightUnit::Lux,
            direct_normal: 0.0,
            diffuse_horizontal: 10_000.0,
            zenith_luminance: 0.0,
            dew_point: 11.0,
            ground_reflectance: 0.2,
            sky_kelvin: 0.0,
            sun_kelvin: 0.0,
        }
    }
}

/// The light of the sun: a disc infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunDisc {
    /// Unit vector towards the sun.
    pub towards: Vec3,
    /// Illuminance per channel in lux of a plane that faces the sun.
    pub illuminance: Vec3,
    /// Half of the angle in radians under which the disc is seen.
    pub half_angle: f32,
}

/// A sky as an environment of a scene.
#[derive(Clone, Debug)]
pub struct Sky {
    /// Equirectangular luminance in cd/m²: the centre shows -z, the top row +y.
    pub image: Image,
    /// The sun; `None` if it is not above the horizon or has no light.
    pub sun: Option<SunDisc>,
    /// Illuminance in lux of a plane that faces the sun, by the sun alone; 0 if the sun is not above the horizon.
    pub direct_normal: f64,
    /// Illuminance in lux of a level plane by the sky alone: what the image gives, without obstructions.
    pub diffuse_horizontal: f64,
    /// Luminance in cd/m² of the zenith and of the ground.
    pub zenith_luminance: f64,
    pub ground_luminance: f64,
    /// Clearness ε and brightness Δ of Perez et al.
    pub clearness: f64,
    pub brightness: f64,
}

impl Conditions {
    fn check(&self) -> Result<()> {
        let limit = match self.unit {
            LightUnit::Lux => MAX_ILLUMINANCE,
            LightUnit::Watts => MAX_IRRADIANCE,
        };
        check_range("sun_altitude", self.sun.altitude, -FRAC_PI_2, FRAC_PI_2)?;
        check_range("sun_azimuth", self.sun.azimuth, -TAU, TAU)?;
        check_range("sun_distance", self.sun.distance, DISTANCES[0], DISTANCES[1])?;
        check_range("direct_normal", self.direct_normal, 0.0, limit)?;
        check_range("diffuse_horizontal", self.diffuse_horizontal, 0.0, limit)?;
        check_range("zenith_luminance", self.zenith_luminance, 0.0, MAX_LUMINANCE)?;
        check_range("dew_point", self.dew_point, DEW_POINTS[0], DEW_POINTS[1])?;
        check_range("ground_reflectance", self.ground_reflectance, 0.0, 1.0)?;
        for (name, kelvin) in [("sky_kelvin", self.sky_kelvin), ("sun_kelvin", self.sun_kelvin)] {
            if kelvin != 0.0 {
                check_range(name, kelvin, MIN_KELVIN, MAX_KELVIN)?;
            }
        }
        if self.zenith_luminance > 0.0 && self.model == SkyModel::Perez {
            return Err(Error::argument(format!(
                "zenith_luminance is {}; it must be 0 for the Perez sky, which follows from diffuse_horizontal",
                self.zenith_luminance
            )));
        }
        Ok(())
    }

    /// Draws the sky. `north` is the direction of north in the scene, of which only the part perpendicular to y counts.
    /// The image has `rows` rows and twice as many columns; an even number puts the horizon between two rows.
    ///
    /// # Errors
    /// A value out of range.
    pub fn sky(&self, north: DVec3, rows: u32) -> Result<Sky> {
        self.check()?;
        check_rows(rows)?;
        let towards = self.sun.towards(north)?;
        // A sun below the horizon gives the sky the shape that it has when the sun stands on the horizon.
        let is_up = self.sun.altitude > 0.0;
        let centre = if is_up { towards } else { (towards * DVec3::new(1.0, 0.0, 1.0)).normalize_or(DVec3::X) };
        let (state, [direct, diffuse]) = self.illuminances(if is_up { self.direct_normal } else { 0.0 });
        let relative = match self.model {
            SkyModel::Cie(number) => Relative::Cie(StandardSky::new(number)?),
            SkyModel::Perez => Relative::Perez(state.shape()),
        };

        // Draw the relative luminance, then scale it.
        let (mut luminance, illuminance) = relative.draw(centre, rows as usize)?;
        let zenith = relative.at(1.0, centre.y);
        let by_zenith = self.zenith_luminance > 0.0;
        let (wanted, drawn) = if by_zenith { (self.zenith_luminance, zenith) } else { (diffuse, illuminance) };
        let scale = if wanted > 0.0 { wanted / drawn } else { 0.0 };
        if !scale.is_finite() {
            return Err(Error::new(ErrorKind::Degenerate, "the sky model is dark for this position of the sun"));
        }
        luminance.iter_mut().for_each(|value| *value *= scale);
        let diffuse = illuminance * scale;

        // Add the ground and the sun.
        let [sky_colour, sun_colour] = [self.sky_kelvin, self.sun_kelvin].map(white);
        // `direct` is 0 unless the sun is above the horizon.
        let level = direct * towards.y;
        let ground = (sky_colour * diffuse + sun_colour * level) * (self.ground_reflectance / PI);
        let image = picture(&luminance, rows as usize, sky_colour, ground)?;
        let half_angle = (SUN_HALF_ANGLE / self.sun.distance) as f32;
        let illuminance = (sun_colour * direct).as_vec3();
        let sun = (direct > 0.0).then_some(SunDisc { towards: towards.as_vec3(), illuminance, half_angle });
        Ok(Sky {
            image,
            sun,
            direct_normal: direct,
            diffuse_horizontal: diffuse,
            zenith_luminance: zenith * scale,
            ground_luminance: (diffuse + level) * self.ground_reflectance / PI,
            clearness: state.clearness,
            brightness: state.brightness,
        })
    }

    /// Returns the state of the sky, and the direct normal and the diffuse horizontal illuminance in lux.
    fn illuminances(&self, direct: f64) -> (SkyState, [f64; 2]) {
        let water = perez::precipitable_water(self.dew_point);
        let given = [direct, self.diffuse_horizontal];
        let from = |[direct, diffuse]: [f64; 2]| {
            let state = SkyState::new(&self.sun, direct, diffuse);
            let efficacies = state.efficacies(water);
            (state, [direct * efficacies[0], diffuse * efficacies[1]], efficacies)
        };
        if self.unit == LightUnit::Watts {
            let (state, lux, _) = from(given);
            return (state, lux);
        }
        // Find irradiances that give the given illuminances, and keep the closest. They serve
        // only for the state: the illuminances are exactly the given ones.
        let mut irradiances = given.map(|lux| lux / 110.0);
        let mut best = (f64::INFINITY, from(irradiances).0);
        for _ in 0..ITERATIONS {
            let (state, lux, efficacies) = from(irradiances);
            let error = (lux[0] - given[0]).abs() + (lux[1] - given[1]).abs();
            if error < best.0 {
                best = (error, state);
            }
            irradiances = [0, 1].map(|i| given[i] / efficacies[i].max(1.0));
        }
        (best.1, given)
    }
}

/// Checks the number of rows of an image.
pub fn check_rows(rows: u32) -> Result<()> {
    check_range("rows", rows, ROWS[0], ROWS[1])?;
    if rows.is_multiple_of(2) {
        return Ok(());
    }
    Err(Error::argument(format!("rows is {rows}; it must be even, so that a row ends at the horizon")))
}

/// A sky model prepared for one state.
enum Relative {
    Cie(StandardSky),
    Perez(LuminanceShape),
}

impl Relative {
    fn at(&self, cos_zenith: f64, cos_sun: f64) -> f64 {
        match self {
            Self::Cie(standard) => standard.luminance(cos_zenith, cos_sun),
            Self::Perez(shape) => shape.luminance(cos_zenith, cos_sun),
        }
    }

    /// Draws the upper half of an image of `rows` rows: the relative luminance at the centre of each pixel. Also
    /// returns the illuminance of a level plane by these pixels, each with uniform luminance. `sun` is the unit vector
    /// towards the sun.
    fn draw(&self, sun: DVec3, rows: usize) -> Result<(Vec<f64>, f64)> {
        let columns = 2 * rows;
        let mut luminance = try_with_capacity(rows / 2 * columns)?;
        let mut illuminance = 0.0;
        for y in 0..rows / 2 {
            let (sine, cosine) = maths::sin_cos(PI * (y as f64 + 0.5) / rows as f64);
            let mut sum = 0.0;
            for x in 0..columns {
                let (east, north) = maths::sin_cos(TAU * ((x as f64 + 0.5) / columns as f64 - 0.5));
                let direction = DVec3::new(sine * east, cosine, -sine * north);
                let value = self.at(cosine, direction.dot(sun));
                luminance.push(value);
                sum += value;
            }
            // The solid angle of the row times the cosine: the integral of cos θ sin θ over its polar angles.
            let [top, bottom] = [y, y + 1].map(|y| maths::powi(maths::sin(PI * y as f64 / rows as f64), 2));
            illuminance += sum * (bottom - top) / 2.0 * TAU / columns as f64;
        }
        Ok((luminance, illuminance))
    }
}

/// Makes the environment image from the luminance of the upper half, and of the ground in RGB.
fn picture(luminance: &[f64], rows: usize, sky: DVec3, ground: DVec3) -> Result<Image> {
    let mut image = Image::new(2 * rows, rows, 3)?;
    let (upper, lower) = image.data.split_at_mut(3 * luminance.len());
    for (pixel, &value) in upper.chunks_exact_mut(3).zip(luminance) {
        (sky * value).as_vec3().write_to_slice(pixel);
    }
    for pixel in lower.chunks_exact_mut(3) {
        ground.as_vec3().write_to_slice(pixel);
    }
    Ok(image)
}

/// Returns the colour of luminance 1 of a colour temperature; 0 stands for neutral white.
fn white(kelvin: f64) -> DVec3 {
    if kelvin == 0.0 { DVec3::ONE } else { temperature::blackbody(kelvin) }
}
