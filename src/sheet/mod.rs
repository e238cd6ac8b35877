//! Print sheets (StyLit, section 4.2). The exemplar is printed at low contrast between alignment marks, for an artist
//! to paint over. A photo or scan of the painted sheet is then registered to the exemplar by its marks.
//!
//! A mark is a disk of two black and two white quadrants. Their common corner is a saddle of brightness, which can be
//! located to a small fraction of a pixel. In a perspective view it is still the corner of the quadrants, whereas the
//! centre of a plain disk would no longer be the centre of its outline. Ten marks surround the picture: at the corners,
//! at the midpoints of the sides, and two more that determine the orientation of the sheet. Six marks suffice. Between
//! the marks there are small dots, which are found by the map through the marks. They show how the paper is bent;
//! sheets without dots are read too.
//!
//! ```text
//! page ─▶ print
//! photo ─▶ detect ─▶ fit ─▶ Aligned          fit: marks and dots ─▶ select (model) ─▶ relief
//! ```
//!
//! `page` arranges the page, [`print()`] draws it, `detect` finds marks in a photo, `fit` identifies them, `dots` finds
//! the dots, `model` is the map of paper bent in one direction through a lens with radial distortion, `select` chooses
//! its terms, and `relief` adds what the model cannot hold, with the error of the map. [`align`] resamples the photo
//! once and removes uneven illumination, which it measures on the white of the marks.
//!
//! Not modelled: waves and creases of the paper are only measured around the picture; within it they are interpolated,
//! and `Aligned::error` states by how much they may differ. Bumps that end within the picture, thick paint and
//! stretched paper do not show around the picture.

mod dense;
mod detect;
mod dots;
mod fit;
mod model;
mod page;
mod params;
mod relief;
mod select;

#[cfg(test)]
mod tests;

pub use params::Params;

use crate::error::{Error, Result};
use crate::exec;
use crate::geometry::Homography;
use crate::geometry::linear::solve;
use crate::image::colour::{linear_to_srgb, luminance, srgb_to_linear};
use crate::image::{Image, pyramid};
use crate::job::Job;
use crate::maths;
use crate::rectify::{self, GridMap};
use glam::{DVec2, Vec3};
use page::Page;

/// Returns the width and height of a sheet in pixels.
pub fn size(params: &Params) -> Result<(usize, usize)> {
    params.check()?;
    let page = Page::new(params, 1, 1)?;
    Ok((page.width, page.height))
}

/// Draws the sheet for a picture (linear, 1 is white; 1, 3 or 4 channels) in linear RGB.
pub fn print(picture: &Image, params: &Params, job: Job) -> Result<Image> {
    params.check()?;
    let page = Page::new(params, picture.width, picture.height)?;
    let [left, top] = page.corner.map(|v| v.round() as usize);
    let [width, height] = page.size.map(|v| (v.round() as usize).max(1));
    let shown = pyramid::resize(&picture.to_rgb()?, width, height, job.part(0.0, 0.5))?;
    let mut sheet = Image::new(page.width, page.height, 3)?;
    exec::for_rows(&mut sheet.data, 3 * page.width, job.part(0.5, 1.0), |y, row| {
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            pixel.fill(page.mark_shade(x, y));
            if (left..left + width).contains(&x) && (top..top + height).contains(&y) {
                for (out, v) in pixel.iter_mut().zip(shown.pixel(x - left, y - top)) {
                    let v = if v.is_finite() { linear_to_srgb(v.clamp(0.0, 1.0)) } else { 0.0 };
                    *out = srgb_to_linear(1.0 - params.contrast * (1.0 - v));
                }
            }
        }
    })?;
    Ok(sheet)
}

/// A painted sheet registered to its picture.
#[derive(Debug)]
pub struct Aligned {
    /// Linear RGB at the picture's size; after removal of uneven illumination, paper is 1.
    pub image: Image,
    /// Maps pixels of the picture to pixels of the photo.
    pub map: GridMap,
    /// The homography that is nearest to `map`, with the root mean square distance between the two in pixels of the
    /// picture.
    pub to_photo: Homography,
    pub bend: f64,
    /// Number of marks and of dots used.
    pub marks: usize,
    pub dots: usize,
    /// Root mean square distance between marks and dots and the positions predicted by the model of bent paper and a
    /// lens, in pixels of the photo.
    pub residual: f64,
    /// Standard deviation of the alignment, in pixels of the picture: the expected root mean square distance, over the
    /// picture, between true and found positions.
    pub error: f64,
}

/// Numbers of places along each side of the picture, its borders included, at which the error of the map is computed.
const PLACES: [usize; 2] = [9, 9];

/// Finds the marks in a photo (linear RGB) of a sheet, and resamples the photo onto the picture. The sheet must have
/// been printed for a picture of `width × height` pixels with the same parameters.
///
/// # Errors
/// `Degenerate` if fewer than six marks are found in a consistent arrangement.
pub fn align(photo: &Image, width: usize, height: usize, params: &Params, job: Job) -> Result<Aligned> {
    params.check()?;
    let page = Page::new(params, width, height)?;
    let mut grey = Image::new(photo.width, photo.height, 1)?;
    exec::for_rows(&mut grey.data, photo.width, job.part(0.0, 0.05), |y, row| {
        for (x, out) in row.iter_mut().enumerate() {
            let v = luminance(photo.rgb(x, y));
            *out = if v.is_finite() { linear_to_srgb(v.clamp(0.0, 4.0)) } else { 0.0 };
        }
    })?;
    let candidates = detect::candidates(&grey, job.part(0.05, 0.5))?;
    let from_picture = page.from_picture(width, height);
    let places = places(width, height);
    let on_page: Vec<DVec2> = places.iter().map(|p| from_picture.apply(*p)).collect();
    let found = fit::fit(&page, &grey, &candidates, &on_page, job.part(0.5, 0.7))?;
    let map = GridMap::sample(width, height, |p| found.apply(from_picture.apply(p)))?;
    let converted = (photo.channels != 3).then(|| photo.to_rgb()).transpose()?;
    let mut image = rectify::warp_grid(converted.as_ref().unwrap_or(photo), &map, job.part(0.7, 0.95))?;
    if params.even_light {
        even_light(&mut image, photo, &page, &found, width, height, job.part(0.95, 1.0))?;
    }
    let scales: Vec<f64> = places.iter().map(|p| scale(&map, *p)).collect();
    let mean = |values: &dyn Fn(usize) -> f64| (0..places.len()).map(values).sum::<f64>() / places.len() as f64;
    let error = mean(&|i| found.variance[i] / maths::powi(scales[i], 2)).sqrt();
    let to_photo = nearest_homography(&map, &places)?;
    let beside = |i: usize| to_photo.apply(places[i]).distance(map.apply(places[i])) / scales[i];
    let bend = mean(&|i| maths::powi(beside(i), 2)).sqrt();
    job.report(1.0);
    let (marks, dots, residual) = (found.marks.len(), found.dots, found.residual);
    Ok(Aligned { image, map, to_photo, bend, marks, dots, residual, error })
}

/// Returns a regular grid of points of the picture.
fn places(width: usize, height: usize) -> Vec<DVec2> {
    let [columns, rows] = PLACES;
    let share = |i: usize, n: usize| i as f64 / (n - 1) as f64;
    let size = DVec2::new(width as f64, height as f64);
    (0..columns * rows).map(|i| size * DVec2::new(share(i % columns, columns), share(i / columns, rows))).collect()
}

/// Returns the number of pixels of the photo per pixel of the picture at a point: the root of the ratio of areas.
fn scale(map: &GridMap, at: DVec2) -> f64 {
    let [x, y] = [DVec2::X, DVec2::Y].map(|step| map.apply(at + 0.5 * step) - map.apply(at - 0.5 * step));
    x.perp_dot(y).abs().max(f64::MIN_POSITIVE).sqrt()
}

/// Fits a homography to a map, by least squares over the places.
fn nearest_homography(map: &GridMap, places: &[DVec2]) -> Result<Homography> {
    let (w, h) = (map.width as f64, map.height as f64);
    let corners = [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(DVec2::from);
    let start = Homography::from_corners(corners, corners.map(|c| map.apply(c)))?;
    let pairs: Vec<(DVec2, DVec2)> = places.iter().map(|p| (*p, map.apply(*p))).collect();
    Ok(fit::least_squares(0.5 * DVec2::new(w, h), start, &pairs))
}

/// Divides each channel of the image by the brightness of white paper in this channel. The logarithm of this brightness
/// is a bilinear function of the position on the sheet, fitted to the white quadrants of the marks.
fn even_light(
    image: &mut Image,
    photo: &Image,
    page: &Page,
    found: &fit::Fit,
    width: usize,
    height: usize,
    job: Job,
) -> Result<()> {
    let terms = |p: DVec2| {
        let q = p / DVec2::new(page.width as f64, page.height as f64);
        [1.0, q.x, q.y, q.x * q.y]
    };
    let mut white = [[0.0f64; 4]; 3];
    for (channel, coefficients) in white.iter_mut().enumerate() {
        let (mut matrix, mut right) = ([[0.0; 4]; 4], [0.0; 4]);
        for &mark in &found.marks {
            let centre = page.marks[mark];
            // Sample the centres of the white quadrants.
            let places = [1.0, -1.0].map(|s| centre + s * DVec2::new(0.4, -0.4) * page.radius);
            let value = places.map(|p| {
                let at = found.apply(p);
                f64::from(photo.sample(at.x, at.y, channel.min(photo.channels - 1)))
            });
            let brightness = maths::ln(((value[0] + value[1]) / 2.0).max(1e-4));
            let row = terms(centre);
            for i in 0..4 {
                right[i] += row[i] * brightness;
                (0..4).for_each(|j| matrix[i][j] += row[i] * row[j]);
            }
        }
        *coefficients = solve(matrix, right)
            .ok_or_else(|| Error::degenerate("the marks found are collinear: uneven light cannot be corrected"))?;
    }
    let from_picture = page.from_picture(width, height);
    exec::for_rows(&mut image.data, 3 * width, job, |y, row| {
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            let at = terms(from_picture.apply(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)));
            let white = white.map(|c| maths::exp(c.iter().zip(at).map(|(c, t)| c * t).sum::<f64>()) as f32);
            let even = Vec3::from_slice(pixel) / Vec3::from_array(white);
            pixel.copy_from_slice(&even.to_array());
        }
    })
}
