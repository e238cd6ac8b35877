//! False colour: shows a luminance or illuminance image by an ordered scale of colours, with a scale bar.
//!
//! The colours run from dark violet over red to light yellow in OKLab (Ottosson 2020). Lightness increases uniformly
//! with the value, so the order is visible also to colour-blind people and in greyscale print. Hue helps to tell steps
//! apart.

use super::glyphs::{self, draw};
use crate::error::{Error, Result, check_range};
use crate::image::{Image, colour};
use crate::maths;
use glam::Vec3;

/// How values map to positions on the colour scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    Linear,
    /// Equal ratios of values have equal distances on the scale.
    Logarithmic,
}

/// The quantity that the image holds, which selects the unit on the scale bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Luminance, in cd/m².
    Luminance,
    /// Illuminance, in lux.
    Illuminance,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub scale: Scale,
    pub unit: Unit,
    /// Value of the darkest colour, ≥ 0, in the unit of the image. On a logarithmic scale, 0 selects a thousandth of
    /// the maximum.
    pub minimum: f64,
    /// Value of the lightest colour, > `minimum`, in the unit of the image; 0 selects the largest value of the image.
    pub maximum: f64,
    /// Whether to draw the scale bar to the right of the image, which makes the output wider.
    pub bar: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self { scale: Scale::Linear, unit: Unit::Luminance, minimum: 0.0, maximum: 0.0, bar: true }
    }
}

/// Linear colour of pixels whose value is NaN, such as pixels between the triangles in an illuminance map of a mesh.
/// [convention]
const NO_VALUE: Vec3 = Vec3::splat(0.05);
/// Colours of the background and of the text of the scale bar. [convention]
const PAPER: Vec3 = Vec3::splat(1.0);
const INK: Vec3 = Vec3::ZERO;

/// Returns the linear RGB colour at a position on the scale, 0 (darkest) to 1 (lightest).
pub fn colour_of(share: f64) -> Vec3 {
    let t = share.clamp(0.0, 1.0) as f32;
    let lightness = 0.22 + 0.73 * t;
    // Let the chroma follow the sRGB gamut: small at both ends of the scale, largest at the reds.
    let chroma = 0.19 * (4.0 * t * (1.0 - t)).sqrt() * (1.0 - 0.25 * t) + 0.03 + 0.05 * t;
    let hue = (-75.0 + 180.0 * t).to_radians();
    let wanted = oklab_to_linear(lightness, chroma * maths::cos(hue), chroma * maths::sin(hue));
    // Reduce the chroma, never the lightness, until the colour is in gamut. Bisect, since the gamut has no closed
    // form.
    if inside(wanted) {
        return wanted.clamp(Vec3::ZERO, Vec3::ONE);
    }
    let (mut low, mut high) = (0.0, chroma);
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        let fits = inside(oklab_to_linear(lightness, middle * maths::cos(hue), middle * maths::sin(hue)));
        if fits { low = middle } else { high = middle }
    }
    oklab_to_linear(lightness, low * maths::cos(hue), low * maths::sin(hue)).clamp(Vec3::ZERO, Vec3::ONE)
}

fn inside(rgb: Vec3) -> bool {
    rgb.min_element() >= -1e-4 && rgb.max_element() <= 1.0 + 1e-4
}

/// Converts OKLab to linear RGB (Ottosson 2020, "A perceptual color space for image processing").
fn oklab_to_linear(lightness: f32, a: f32, b: f32) -> Vec3 {
    let l = lightness + 0.396_337_78 * a + 0.215_803_76 * b;
    let m = lightness - 0.105_561_346 * a - 0.063_854_17 * b;
    let s = lightness - 0.089_484_18 * a - 1.291_485_5 * b;
    let (l, m, s) = (l * l * l, m * m * m, s * s * s);
    Vec3::new(
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    )
}

/// Renders the image in false colour, as linear RGB. Images with three channels are shown by their luminance, images
/// with one channel by their values. If `params.bar` is set, the result is wider than the image by [`bar_width`].
///
/// # Errors
/// An invalid range of values; no value above 0 although the range is to be taken from the image.
pub fn render(image: &Image, params: &Params) -> Result<Image> {
    let range = Range::new(params, image)?;
    // Use 256 colours: the difference between neighbours is then too small to see.
    let table: Vec<Vec3> = (0..256).map(|i| colour_of(f64::from(i) / 255.0)).collect();
    let seen = |x: usize, y: usize| {
        let share = range.share(f64::from(value(image, x, y)));
        if share.is_nan() { NO_VALUE } else { table[(share * 255.0).round() as usize] }
    };
    if !params.bar {
        return Image::from_fn(image.width, image.height, |x, y| seen(x, y).to_array());
    }
    let bar = Bar::new(&range, params.unit, image.height);
    let mut out = Image::from_fn(image.width + bar.width, image.height, |x, y| {
        (if x < image.width { seen(x, y) } else { bar.background(x - image.width, y, &table) }).to_array()
    })?;
    bar.label(&mut out, image.width);
    Ok(out)
}

/// Width in pixels that the scale bar adds to the image; 0 without a bar.
pub fn bar_width(image: &Image, params: &Params) -> Result<usize> {
    Ok(if params.bar { Bar::new(&Range::new(params, image)?, params.unit, image.height).width } else { 0 })
}

fn value(image: &Image, x: usize, y: usize) -> f32 {
    if image.channels == 1 { image.pixel(x, y)[0] } else { colour::luminance(image.rgb(x, y)) }
}

struct Range {
    scale: Scale,
    minimum: f64,
    maximum: f64,
}

impl Range {
    fn new(params: &Params, image: &Image) -> Result<Self> {
        check_range("minimum", params.minimum, 0.0, f64::from(f32::MAX))?;
        check_range("maximum", params.maximum, 0.0, f64::from(f32::MAX))?;
        let largest = || {
            let all = (0..image.height).flat_map(|y| (0..image.width).map(move |x| value(image, x, y)));
            f64::from(all.filter(|v| v.is_finite()).fold(0.0, f32::max))
        };
        let maximum = if params.maximum > 0.0 { params.maximum } else { largest() };
        let minimum = match params.scale {
            Scale::Logarithmic if params.minimum == 0.0 => maximum / 1e3,
            _ => params.minimum,
        };
        if !(maximum > minimum) {
            return Err(Error::argument(format!(
                "the scale goes from {minimum} to {maximum}; the second must be larger: set minimum and maximum, or give an \
                 image with light"
            )));
        }
        Ok(Self { scale: params.scale, minimum, maximum })
    }

    /// Returns the position of a value on the scale, clamped to `[0, 1]`; NaN stays NaN.
    fn share(&self, value: f64) -> f64 {
        let share = match self.scale {
            Scale::Linear => (value - self.minimum) / (self.maximum - self.minimum),
            // Values of at most 0 have no logarithm: show them with the darkest colour.
            Scale::Logarithmic if value <= 0.0 => 0.0,
            Scale::Logarithmic => maths::ln(value / self.minimum) / maths::ln(self.maximum / self.minimum),
        };
        share.clamp(0.0, 1.0)
    }

    /// Returns the values at which the scale is labelled. A linear scale has at most `count + 1` labels, at multiples
    /// of 1, 2 or 5 times a power of ten. A logarithmic scale has at most `count` labels: 1, 2 and 5 times the powers
    /// of ten, or the powers of ten alone, or every second or fourth power of ten.
    fn ticks(&self, count: usize) -> Vec<f64> {
        let nice = |exponent: i32, digit: f64| digit * maths::powi(10f64, exponent);
        let exponents = (maths::log10(self.minimum.max(self.maximum / 1e6)).floor() as i32 - 1)
            ..=(maths::log10(self.maximum).ceil() as i32);
        let within = |v: &f64| *v >= self.minimum * (1.0 - 1e-9) && *v <= self.maximum * (1.0 + 1e-9);
        match self.scale {
            Scale::Linear => {
                // Choose the smallest round step that gives at most `count` intervals.
                let wide = (self.maximum - self.minimum) / count.max(1) as f64;
                let exponent = maths::log10(wide).floor() as i32;
                let steps = [(exponent, 1.0), (exponent, 2.0), (exponent, 5.0), (exponent + 1, 1.0)];
                let step = steps.map(|(e, d)| nice(e, d)).into_iter().find(|s| *s >= wide * (1.0 - 1e-9));
                let step = step.unwrap_or(wide);
                let first = (self.minimum / step * (1.0 - 1e-12)).ceil();
                (0..=count).map(|i| (first + i as f64) * step).filter(within).collect()
            }
            Scale::Logarithmic => {
                let all = |digits: &'static [f64], every: usize| -> Vec<f64> {
                    let decades = exponents.clone().filter(|e| e.rem_euclid(every as i32) == 0);
                    decades.flat_map(|e| digits.iter().map(move |d| nice(e, *d))).filter(within).collect()
                };
                let choices = [(&[1.0, 2.0, 5.0][..], 1), (&[1.0][..], 1), (&[1.0][..], 2), (&[1.0][..], 4)];
                let choices = choices.map(|(digits, every)| all(digits, every));
                choices.into_iter().find(|ticks| ticks.len() <= count).unwrap_or_default()
            }
        }
    }
}

/// The layout in pixels of the scale bar: a strip of colours on white, with ticks, numbers, and the unit above.
struct Bar {
    /// Side in pixels of a dot of a glyph.
    dot: usize,
    width: usize,
    top: usize,
    bottom: usize,
    left: usize,
    right: usize,
    unit: &'static str,
    /// Row in the image, and text, of each tick.
    ticks: Vec<(usize, String)>,
}

impl Bar {
    fn new(range: &Range, unit: Unit, height: usize) -> Self {
        // Glyphs are a twenty-fourth as high as the image, rounded down to whole pixels per dot, but a dot has at
        // least one pixel.
        let dot = (height / (24 * glyphs::HEIGHT)).max(1);
        let line = (glyphs::HEIGHT + 2) * dot;
        let (top, bottom) = ((2 * line).min(height / 3), height - line.min(height / 3));
        let unit = match unit {
            Unit::Luminance => "cd/m2",
            Unit::Illuminance => "lx",
        };
        let count = (bottom - top) / (2 * line);
        let row =
            |value: f64| bottom - 1 - (range.share(value) * (bottom - top).saturating_sub(1) as f64).round() as usize;
        let ticks: Vec<(usize, String)> = range.ticks(count).iter().map(|&v| (row(v), text(v))).collect();
        let letters = ticks.iter().map(|t| t.1.len() + 1).chain([unit.len()]).max().unwrap_or(0);
        let (left, right) = (2 * dot, 8 * dot);
        Self { dot, width: right + (letters * glyphs::ADVANCE + 3) * dot, top, bottom, left, right, unit, ticks }
    }

    fn background(&self, x: usize, y: usize, table: &[Vec3]) -> Vec3 {
        if !(self.top..self.bottom).contains(&y) || !(self.left..self.right + self.dot).contains(&x) {
            return PAPER;
        }
        if x >= self.right {
            let ticked = self.ticks.iter().any(|(row, _)| y.abs_diff(*row) <= self.dot / 2);
            return if ticked { INK } else { PAPER };
        }
        let height = (self.bottom - self.top).saturating_sub(1).max(1);
        table[(self.bottom - 1 - y) * 255 / height]
    }

    fn label(&self, out: &mut Image, from: usize) {
        let half = glyphs::HEIGHT * self.dot / 2;
        draw(out, self.unit, [from + self.left, self.top / 2 - half.min(self.top / 2)], self.dot, INK);
        for (row, text) in &self.ticks {
            draw(out, text, [from + self.right + 3 * self.dot, row.saturating_sub(half)], self.dot, INK);
        }
    }
}

/// Returns the shortest text of a number rounded to four digits, with an exponent if the text would otherwise have
/// many zeros.
fn text(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded) { rounded.to_string() } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lightness also increases nearly uniformly in CIELAB, which was not used to design the scale, and no two
    /// neighbouring colours are equal.
    #[test]
    fn colours_are_in_perceptual_order() {
        let lightness: Vec<f32> = (0..=32).map(|i| colour::linear_to_lab(colour_of(f64::from(i) / 32.0)).x).collect();
        let steps: Vec<f32> = lightness.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mean = (lightness[32] - lightness[0]) / 32.0;
        assert!(lightness[0] < 12.0 && lightness[32] > 90.0, "{lightness:?}");
        assert!(steps.iter().all(|s| (0.5 * mean..1.6 * mean).contains(s)), "{steps:?}");
        let hues = [0.0, 0.33, 0.67, 1.0].map(colour_of);
        assert!(hues[0].z > hues[0].y && hues[1].x > hues[1].y && hues[3].x > hues[3].z, "{hues:?}");
    }

    #[test]
    fn values_get_the_colour_of_their_place_on_the_scale() {
        let image = Image::from_fn(4, 1, |x, _| [[1.0, 10.0, 100.0, f32::NAN][x]]).unwrap();
        let plain = Params { bar: false, ..Params::default() };
        let at = |params: &Params, x| render(&image, params).unwrap().rgb(x, 0);
        let close = |a: Vec3, share: f64| (a - colour_of(share)).abs().max_element() < 0.01;
        assert!(close(at(&plain, 2), 1.0) && close(at(&plain, 1), 0.1) && at(&plain, 3) == NO_VALUE);
        let log = Params { scale: Scale::Logarithmic, minimum: 1.0, maximum: 1e4, ..plain.clone() };
        assert!(close(at(&log, 0), 0.0) && close(at(&log, 1), 0.25) && close(at(&log, 2), 0.5));
        // A colour image is shown by its luminance.
        let green = Image::from_fn(1, 1, |_, _| [0.0, 100.0, 0.0]).unwrap();
        let shown = render(&green, &Params { maximum: 143.033_74, ..plain.clone() }).unwrap().rgb(0, 0);
        assert!(close(shown, 0.5), "{shown}");
        // Invalid ranges give an error.
        let dark = Image::new(2, 2, 1).unwrap();
        for (image, params) in [
            (&dark, plain.clone()),
            (&image, Params { minimum: 5.0, maximum: 5.0, ..plain.clone() }),
            (&image, Params { minimum: -1.0, ..plain.clone() }),
            (&image, Params { maximum: f64::NAN, ..plain.clone() }),
        ] {
            assert!(render(image, &params).is_err(), "{params:?}");
        }
    }

    #[test]
    fn ticks_are_round_numbers() {
        let range = |scale, minimum, maximum| Range { scale, minimum, maximum };
        assert_eq!(range(Scale::Linear, 0.0, 1000.0).ticks(5), [0.0, 200.0, 400.0, 600.0, 800.0, 1000.0]);
        assert_eq!(range(Scale::Linear, 120.0, 310.0).ticks(4), [150.0, 200.0, 250.0, 300.0]);
        assert_eq!(range(Scale::Logarithmic, 1.0, 1000.0).ticks(12).len(), 10);
        assert_eq!(range(Scale::Logarithmic, 1.0, 1000.0).ticks(5), [1.0, 10.0, 100.0, 1000.0]);
        assert_eq!([0.0, 0.5, 1500.0, 2e7, 1e-5].map(text), ["0", "0.5", "1500", "2e7", "1e-5"]);
    }

    /// The bar is dark at the bottom and light at the top, and it has labels. Images that are too small for labels are
    /// accepted as well.
    #[test]
    fn the_bar_is_drawn() {
        let image = Image::from_fn(200, 300, |x, y| [(x * y) as f32]).unwrap();
        let shown = render(&image, &Params { unit: Unit::Illuminance, ..Params::default() }).unwrap();
        assert!(shown.width > 220 && shown.height == 300);
        let strip: Vec<f32> = (0..300).map(|y| colour::luminance(shown.rgb(204, y))).collect();
        let (low, high) = (strip[280], strip[60]);
        assert!(low < 0.1 && high > 0.5, "{low} {high}");
        let ink =
            (0..300).flat_map(|y| (210..shown.width).map(move |x| (x, y))).filter(|&(x, y)| shown.rgb(x, y) == INK);
        assert!(ink.count() > 100);
        for (width, height) in [(1, 1), (3, 2), (1, 40)] {
            let small = Image::from_fn(width, height, |_, _| [1.0]).unwrap();
            let shown = render(&small, &Params::default()).unwrap();
            assert_eq!(shown.height, height);
        }
    }
}
