//! Unified glare rating of a luminance image (CIE 117:1995): `UGR = 8 log10(0.25 / Lb · Σ L² ω / p²)`. The sum runs
//! over the glare sources with their luminance `L` in cd/m², solid angle `ω` in sr and position index `p`; `Lb` is the
//! background luminance in cd/m².
//!
//! Glare sources are the 4-connected regions of pixels whose luminance is at least a threshold. Rating each luminaire
//! by its mean luminance would underestimate the glare of emissive textures, which are not uniform (Scheir et al.
//! 2017). The background luminance is the mean over the remaining pixels, weighted by the contribution of each pixel to
//! the illuminance at the eye; an image with a wider angle of view makes this mean more accurate. Above the line of
//! sight, the position index is Guth's; below it, the position index follows Iwata and Tokura (1997), as in versions 1
//! and 2 of `evalglare`.
//!
//! The daylight glare probability (Wienold and Christoffersen 2006) uses the same sources and the vertical illuminance
//! at the eye `Ev` in lux: `DGP = 5.87e-5 Ev + 0.0918 log10(1 + Σ L² ω / (Ev^1.87 p²)) + 0.16`. Versions 1 and 2 of
//! `evalglare` multiply it by a correction for low light below 1000 lux; version 3 does not.

use crate::error::{Error, Result, check_range};
use crate::image::{Image, colour, try_vec};
use crate::maths;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// The factors of the daylight glare probability, in the order of the formula, and the exponent of the vertical
/// illuminance. [paper Wienold and Christoffersen 2006 §5]
const DGP: [f64; 4] = [5.87e-5, 0.0918, 0.16, 1.87];

/// Vertical illuminance in lux below which the probability is corrected for low light, and the slope and the offset of
/// the logistic function that corrects it. [convention: evalglare 2]
const LOW_LIGHT: [f64; 3] = [1000.0, 0.024, 4.0];

/// The projection of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// A pinhole camera.
    #[default]
    Perspective,
    /// A fisheye whose distance from the centre is proportional to the angle from the line of sight.
    Angular,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Params {
    pub projection: Projection,
    /// Vertical angle of view of the image in radians: in `(0, π)`, or up to `2π` for an angular projection, of which
    /// the half-space ahead counts. The line of sight is horizontal, through the centre of the image.
    pub fov_y: f64,
    /// A pixel belongs to a glare source if its luminance in cd/m² is at least this value. 0 selects five times the
    /// mean luminance of the image, weighted by solid angle.
    pub threshold: f64,
    /// Vertical illuminance at the eye in lux; 0: that of the light in the image.
    pub vertical_illuminance: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Rating {
    /// Daylight glare probability, in `[0, 1]`.
    pub dgp: f64,
    /// Daylight glare probability corrected for low light.
    pub dgp_low_light: f64,
    /// Vertical illuminance at the eye in lux.
    pub vertical_illuminance: f64,
    /// Unified glare rating. Below 10 glare causes no discomfort; `-∞` means that there is no glare source.
    pub ugr: f64,
    /// Background luminance `Lb` in cd/m².
    pub background: f64,
    /// The luminance threshold used, in cd/m².
    pub threshold: f64,
    pub sources: Vec<Source>,
}

/// A glare source: a 4-connected region of pixels whose luminance is at least the threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Mean luminance `L` in cd/m².
    pub luminance: f64,
    /// Solid angle `ω` in steradian. CIE 117 is valid for 0.0003 to 0.1 sr.
    pub solid_angle: f64,
    /// Position index `p`, which is 1 on the line of sight and grows away from it.
    pub position: f64,
}

/// Sums over the pixels of a region: Σ ω, Σ L ω and Σ L ω d. L is a pixel's luminance, ω its solid angle, and d its
/// unit direction.
#[derive(Clone, Copy, Default)]
struct RegionSums {
    solid_angle: f64,
    light: f64,
    direction: DVec3,
}

/// Rates an image of luminance (1 channel) or of linear RGB, both in cd/m².
///
/// # Errors
/// An image that is empty or not finite; parameters out of range.
pub fn rate(image: &Image, params: &Params) -> Result<Rating> {
    let widest = if params.projection == Projection::Angular { 2.0 * PI } else { PI - 1e-3 };
    check_range("fov_y", params.fov_y, 1e-3, widest)?;
    check_range("threshold", params.threshold, 0.0, 1e12)?;
    check_range("vertical_illuminance", params.vertical_illuminance, 0.0, 1e12)?;
    if image.width == 0 || image.height == 0 || image.count_non_finite() > 0 {
        return Err(Error::argument("the luminance image is empty or has values that are not finite"));
    }
    let (width, height) = (image.width, image.height);
    let luminance = |i: usize| match image.pixel(i % width, i / width) {
        [r, g, b, ..] => f64::from(colour::luminance(Vec3::new(*r, *g, *b))).max(0.0),
        [l, ..] => f64::from(*l).max(0.0),
        [] => 0.0,
    };
    let view = View::new(width, height, params);
    let threshold = match params.threshold {
        t if t > 0.0 => t,
        _ => default_threshold(width * height, &luminance, &view),
    };
    let glares = |i: usize| threshold > 0.0 && luminance(i) >= threshold && view.pixel(i).1 > 0.0;
    let background = background((0..width * height).filter(|&i| !glares(i)), &luminance, &view);
    let sources = sources([width, height], &luminance, &glares, &view)?;
    let sum: f64 = sources.iter().map(|s| s.luminance * s.luminance * s.solid_angle / (s.position * s.position)).sum();
    let ugr = 8.0 * maths::log10(0.25 / background.max(f64::MIN_POSITIVE) * sum);
    let vertical_illuminance = match params.vertical_illuminance {
        lux if lux > 0.0 => lux,
        _ => vertical_illuminance(width * height, &luminance, &view),
    };
    let dgp = daylight_glare_probability(vertical_illuminance, sum);
    let dgp_low_light = dgp * low_light_correction(vertical_illuminance);
    Ok(Rating { dgp, dgp_low_light, vertical_illuminance, ugr, background, threshold, sources })
}

/// Returns the illuminance in lux at the eye, on a plane across the line of sight, of the light in the image.
fn vertical_illuminance(pixels: usize, luminance: &impl Fn(usize) -> f64, view: &View) -> f64 {
    (0..pixels).fold(0.0, |lux, i| {
        let (direction, omega) = view.pixel(i);
        lux + luminance(i) * omega * -direction.z
    })
}

/// Returns the daylight glare probability for a vertical illuminance in lux and the sum `Σ L² ω / p²` of the sources.
fn daylight_glare_probability(lux: f64, sum: f64) -> f64 {
    let [per_lux, factor, offset, exponent] = DGP;
    let contrast = if sum > 0.0 { sum / maths::powf(lux.max(f64::MIN_POSITIVE), exponent) } else { 0.0 };
    (per_lux * lux + factor * maths::log10(1.0 + contrast.min(f64::MAX)) + offset).min(1.0)
}

/// Returns the factor of the daylight glare probability for low light.
fn low_light_correction(lux: f64) -> f64 {
    let [limit, slope, shift] = LOW_LIGHT;
    if lux < limit { 1.0 / (1.0 + maths::exp(shift - slope * lux)) } else { 1.0 }
}

/// Returns five times the mean luminance of the image, weighted by the solid angles of its pixels.
fn default_threshold(pixels: usize, luminance: &impl Fn(usize) -> f64, view: &View) -> f64 {
    let (light, angle) = (0..pixels).fold((0.0, 0.0), |(light, angle), i| {
        let (_, omega) = view.pixel(i);
        (light + luminance(i) * omega, angle + omega)
    });
    5.0 * light / angle
}

/// Returns the background luminance: the mean over the given pixels, weighted by solid angle and by the cosine of the
/// angle to the line of sight. 0 if there are no pixels.
fn background(pixels: impl Iterator<Item = usize>, luminance: &impl Fn(usize) -> f64, view: &View) -> f64 {
    let (mut light, mut weight) = (0.0, 0.0);
    for i in pixels {
        let (direction, omega) = view.pixel(i);
        light += luminance(i) * omega * -direction.z;
        weight += omega * -direction.z;
    }
    if weight > 0.0 { light / weight } else { 0.0 }
}

/// Collects the glare sources by flood fill over the four neighbours of each pixel for which `glares` is true.
fn sources(
    [width, height]: [usize; 2],
    luminance: &impl Fn(usize) -> f64,
    glares: &impl Fn(usize) -> bool,
    view: &View,
) -> Result<Vec<Source>> {
    let mut seen = try_vec(width * height, false)?;
    let (mut open, mut sources) = (Vec::new(), Vec::new());
    for start in 0..width * height {
        if seen[start] || !glares(start) {
            continue;
        }
        let mut region = RegionSums::default();
        seen[start] = true;
        open.push(start);
        while let Some(i) = open.pop() {
            let (direction, omega) = view.pixel(i);
            region.solid_angle += omega;
            region.light += luminance(i) * omega;
            region.direction += direction * (luminance(i) * omega);
            let (x, y) = (i % width, i / width);
            let sides = [
                (x > 0, i.wrapping_sub(1)),
                (x + 1 < width, i + 1),
                (y > 0, i.wrapping_sub(width)),
                (y + 1 < height, i + width),
            ];
            for (_, next) in sides.into_iter().filter(|(inside, _)| *inside) {
                if !seen[next] && glares(next) {
                    seen[next] = true;
                    open.push(next);
                }
            }
        }
        sources.push(Source {
            luminance: region.light / region.solid_angle,
            solid_angle: region.solid_angle,
            position: position_index(region.direction.normalize()),
        });
    }
    Ok(sources)
}

/// The view of the image: a camera that looks along -z, with y up.
struct View {
    projection: Projection,
    width: usize,
    centre: [f64; 2],
    /// Side of a pixel on the image plane at distance 1, or the angle that it covers in an angular projection.
    pixel: f64,
}

impl View {
    fn new(width: usize, height: usize, params: &Params) -> Self {
        let extent = match params.projection {
            Projection::Perspective => 2.0 * maths::tan(params.fov_y / 2.0),
            Projection::Angular => params.fov_y,
        };
        let centre = [width as f64 / 2.0, height as f64 / 2.0];
        Self { projection: params.projection, width, centre, pixel: extent / height as f64 }
    }

    /// Returns the unit direction of a pixel's centre, and the solid angle of the pixel. The solid angle of a pixel
    /// that is not in the half-space ahead is 0.
    fn pixel(&self, i: usize) -> (DVec3, f64) {
        let x = ((i % self.width) as f64 - self.centre[0]) * self.pixel;
        let y = (self.centre[1] - (i / self.width) as f64) * self.pixel;
        match self.projection {
            Projection::Perspective => self.on_plane(x, y),
            Projection::Angular => self.on_angles(x + self.pixel / 2.0, y - self.pixel / 2.0),
        }
    }

    /// Returns direction and exact solid angle of a pixel of a perspective image; x and y are its upper left corner.
    fn on_plane(&self, x: f64, y: f64) -> (DVec3, f64) {
        let corner = |x: f64, y: f64| maths::atan(x * y / (1.0 + x * x + y * y).sqrt());
        let (x1, y0) = (x + self.pixel, y - self.pixel);
        let omega = corner(x1, y) - corner(x, y) - corner(x1, y0) + corner(x, y0);
        (DVec3::new(x + self.pixel / 2.0, y - self.pixel / 2.0, -1.0).normalize(), omega)
    }

    /// Returns direction and solid angle of a pixel of an angular image; x and y are its centre.
    fn on_angles(&self, x: f64, y: f64) -> (DVec3, f64) {
        let angle = maths::hypot(x, y);
        if angle >= PI / 2.0 {
            return (DVec3::NEG_Z, 0.0);
        }
        let per_angle = if angle > 0.0 { maths::sin(angle) / angle } else { 1.0 };
        let direction = DVec3::new(x * per_angle, y * per_angle, -maths::cos(angle));
        (direction, per_angle * self.pixel * self.pixel)
    }
}

/// Returns the position index of a direction. The line of sight is -z, and y is up.
pub fn position_index(direction: DVec3) -> f64 {
    let (side, up, ahead) = (direction.x, direction.y, -direction.z);
    if up >= 0.0 {
        // Guth 1963: τ is the angle from the vertical in the image plane, σ the angle from the line of sight, in
        // degrees.
        let tau = maths::atan2(side.abs(), up).to_degrees();
        let tau = if side == 0.0 && up == 0.0 { 0.0 } else { tau };
        let sigma = maths::atan2(maths::hypot(side, up), ahead).to_degrees();
        let first = (35.2 - 0.318_89 * tau - 1.22 * maths::exp(-2.0 * tau / 9.0)) * 1e-3 * sigma;
        let second = (21.0 + 0.266_67 * tau - 0.002_963 * tau * tau) * 1e-5 * sigma * sigma;
        maths::exp(first + second)
    } else {
        // Iwata and Tokura 1997: a function of the tangent of the angle between the direction and the line of sight.
        let ratio = maths::hypot(side, up) / ahead.max(1e-9);
        let factor = if ratio < 0.6 { 0.8 } else { 1.2 };
        (1.0 + factor * ratio).min(16.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An image of 100 cd/m² with one square bright region, whose top-left pixel is `first` and whose side is `patch`.
    fn view(side: usize, first: [usize; 2], patch: usize, lamp: f32) -> Image {
        let inside = |v: usize, from: usize| v >= from && v < from + patch;
        let lit = |x: usize, y: usize| inside(x, first[0]) && inside(y, first[1]);
        Image::from_fn(side, side, |x, y| [if lit(x, y) { lamp } else { 100.0 }]).unwrap()
    }

    #[test]
    fn one_lamp_is_the_formula() {
        let fov_y = 1.0f64;
        let params = Params { fov_y, threshold: 1000.0, ..Params::default() };
        let rating = rate(&view(200, [90, 90], 20, 10_000.0), &params).unwrap();
        // The lamp covers a tenth of the view's side, on the line of sight. Its solid angle is `ω = 4 asin(a² / (1 +
        // a²))`, where `a` is half the lamp's side on the image plane at distance 1.
        let a = 0.1 * (fov_y / 2.0).tan();
        let omega = 4.0 * (a * a / (1.0 + a * a)).asin();
        let [source] = rating.sources[..] else { panic!("{:?}", rating.sources) };
        assert!((source.solid_angle / omega - 1.0).abs() < 1e-9 && (source.luminance - 1e4).abs() < 1e-6);
        assert!((source.position - 1.0).abs() < 1e-3 && (rating.background - 100.0).abs() < 1e-9);
        let expected = 8.0 * (0.25 / 100.0 * 1e8 * omega).log10();
        assert!((rating.ugr - expected).abs() < 1e-2, "{} {expected}", rating.ugr);
        // Two equal lamps rate 8 log10(2) higher than one, up to the difference of their position indices.
        let mut two = view(200, [60, 90], 20, 10_000.0);
        let other = view(200, [120, 90], 20, 10_000.0);
        two.data.iter_mut().zip(&other.data).for_each(|(a, b)| *a = a.max(*b));
        let (one, two) = (rate(&other, &params).unwrap(), rate(&two, &params).unwrap());
        assert_eq!(two.sources.len(), 2);
        assert!((two.ugr - one.ugr - 8.0 * 2f64.log10()).abs() < 1e-2);
    }

    #[test]
    fn glare_falls_away_from_the_line_of_sight() {
        let params = Params { fov_y: 1.4, threshold: 1000.0, ..Params::default() };
        let ugr = |at: [usize; 2]| rate(&view(201, at, 11, 2e4), &params).unwrap().ugr;
        let (ahead, above, beside, below) = (ugr([95, 95]), ugr([95, 15]), ugr([15, 95]), ugr([95, 175]));
        assert!(ahead > above + 3.0 && ahead > beside + 2.0 && ahead > below + 2.0, "{ahead} {above} {beside} {below}");
        // Guth's index at 10° straight above the line of sight is exp((35.2 - 1.22) 0.01 + 21e-3) = 1.434.
        let up = position_index(DVec3::new(0.0, 10f64.to_radians().sin(), -10f64.to_radians().cos()));
        assert!((up - (0.3398f64 + 0.021).exp()).abs() < 1e-6, "{up}");
    }

    #[test]
    fn dark_images_have_no_source_and_bad_images_are_refused() {
        let params = |fov_y: f64| Params { fov_y, ..Params::default() };
        let dark = rate(&Image::new(8, 8, 3).unwrap(), &params(1.0)).unwrap();
        assert!(dark.ugr == f64::NEG_INFINITY && dark.sources.is_empty());
        // Without light, only the offset and the correction for low light are left.
        assert!((dark.dgp, dark.vertical_illuminance) == (0.16, 0.0));
        assert!((dark.dgp_low_light - 0.16 / (1.0 + 4f64.exp())).abs() < 1e-12);
        let even = rate(&Image::from_fn(8, 8, |_, _| [50.0]).unwrap(), &params(1.0)).unwrap();
        assert!(even.sources.is_empty() && (even.background - 50.0).abs() < 1e-9);
        let bad = Image::from_fn(2, 2, |_, _| [f32::NAN]).unwrap();
        assert!(rate(&bad, &params(1.0)).is_err());
        let empty = Image::new(2, 2, 1).unwrap();
        assert!(rate(&empty, &params(4.0)).is_err());
        assert!(rate(&empty, &Params { projection: Projection::Angular, ..params(7.0) }).is_err());
        assert!(rate(&empty, &Params { vertical_illuminance: -1.0, ..params(1.0) }).is_err());
    }

    #[test]
    fn an_even_fisheye_is_a_hemisphere() {
        let image = Image::from_fn(400, 400, |_, _| [100.0]).unwrap();
        let params = Params { projection: Projection::Angular, fov_y: PI, ..Params::default() };
        let rating = rate(&image, &params).unwrap();
        let view = View::new(400, 400, &params);
        let omega: f64 = (0..160_000).map(|i| view.pixel(i).1).sum();
        assert!((omega / (2.0 * PI) - 1.0).abs() < 1e-3, "{omega}");
        assert!((rating.vertical_illuminance / (100.0 * PI) - 1.0).abs() < 1e-4, "{}", rating.vertical_illuminance);
        assert!((rating.background - 100.0).abs() < 1e-9 && rating.sources.is_empty());
    }

    #[test]
    fn dgp_is_the_formula() {
        // A disc of 10° around the line of sight in an angular image, whose background is too bright for a correction.
        let (side, lamp, rest) = (600, 40_000.0f32, 500.0f32);
        let angle = |x: usize, y: usize| {
            let [x, y] = [x, y].map(|v| (v as f64 + 0.5 - 300.0) * PI / 600.0);
            x.hypot(y)
        };
        let cap = 5f64.to_radians();
        let image = Image::from_fn(side, side, |x, y| [if angle(x, y) < cap { lamp } else { rest }]).unwrap();
        let angular = Params { projection: Projection::Angular, fov_y: PI, threshold: 2000.0, ..Params::default() };
        let rating = rate(&image, &angular).unwrap();
        let omega = 2.0 * PI * (1.0 - cap.cos());
        let lux = PI * (500.0 + 39_500.0 * cap.sin().powi(2));
        assert!((rating.vertical_illuminance / lux - 1.0).abs() < 2e-3, "{} {lux}", rating.vertical_illuminance);
        let dgp = |lux: f64| 5.87e-5 * lux + 0.0918 * (1.0 + 1.6e9 * omega / lux.powf(1.87)).log10() + 0.16;
        assert!((rating.dgp - dgp(lux)).abs() < 5e-4, "{} {}", rating.dgp, dgp(lux));
        // A measured illuminance replaces that of the image, and low light is corrected.
        let measured = rate(&image, &Params { vertical_illuminance: 200.0, ..angular }).unwrap();
        let share = (0.024f64 * 200.0 - 4.0).exp();
        let expected = dgp(200.0) * share / (1.0 + share);
        assert!((measured.dgp - dgp(200.0)).abs() < 1e-3, "{} {}", measured.dgp, dgp(200.0));
        assert!((measured.dgp_low_light - expected).abs() < 1e-3, "{} {expected}", measured.dgp_low_light);
        assert!(rating.dgp_low_light == rating.dgp);
        assert!(measured.vertical_illuminance == 200.0 && measured.ugr == rating.ugr);
    }

    #[test]
    fn projections_agree_on_a_small_view() {
        let flat = Params { fov_y: 0.2, threshold: 1000.0, ..Params::default() };
        let image = view(200, [120, 40], 20, 10_000.0);
        let one = rate(&image, &flat).unwrap();
        let other = rate(&image, &Params { projection: Projection::Angular, ..flat }).unwrap();
        assert!((one.ugr - other.ugr).abs() < 0.05 && (one.dgp - other.dgp).abs() < 2e-3, "{one:?} {other:?}");
    }
}
