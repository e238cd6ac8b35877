//! Detail that texels recover from a photo. Compares luxfer's texels, and the texels of an elliptical weighted average
//! (EWA), with the true mean of the plane over each texel.

use crate::harness::{Clock, Table, figure, time};
use glam::{DMat3, DVec2, Vec3};
use luxfer::emission::{Composition, Input, Params};
use luxfer::geometry::Homography;
use luxfer::image::Image;
use luxfer::job::Monitor;

/// Number of texels along a side of the texture.
const SIDE: usize = 64;
/// Variances of the Gaussian that stands for a texel and for a pixel, in squared sides. The first is as published
/// (Greene and Heckbert 1986), with half a side as standard deviation; the second is the variance of the square
/// itself.
const WIDTHS: [(&str, f64); 2] = [("EWA", 0.25), ("EWA, as narrow as a texel", 1.0 / 12.0)];

/// Brightness of a plane with fine detail and sharp edges; `p` is in pixels of the photo where its scale is largest.
fn pattern(p: DVec2) -> f64 {
    let fine = 0.5 + 0.2 * (0.9 * p.x + 0.2 * p.y).sin() + 0.3 * (0.13 * p.x - 0.31 * p.y).sin();
    let is_bright = (0.11 * p.x).sin() * (0.02 * p.x + 0.09 * p.y).sin() > 0.0;
    0.4 * fine + if is_bright { 0.6 } else { 0.0 }
}

/// Mean of the pattern over the unit square at `corner`, whose points `map` maps into the pattern; from `samples`
/// squared samples.
fn mean(samples: usize, corner: DVec2, map: impl Fn(DVec2) -> DVec2) -> f64 {
    let step = |i: usize| DVec2::new((i % samples) as f64 + 0.5, (i / samples) as f64 + 0.5) / samples as f64;
    (0..samples * samples).map(|i| pattern(map(corner + step(i)))).sum::<f64>() / (samples * samples) as f64
}

/// Recovers photos of the pattern from three views, with texels from a fraction of a photo pixel up to many pixels.
pub fn recovery() {
    let names = ["view", "pixels per texel", "ours", WIDTHS[0].0, WIDTHS[1].0, "ours us", "EWA us"];
    let mut table = Table::new(names);
    let mut behind = 0;
    for (view, squeezed, far) in [("from below", 1.0, 0.3), ("4 : 1", 0.25, 0.2), ("12 : 1", 1.0 / 12.0, 0.1)] {
        for pixels in [0.33, 0.75, 1.5, 3.0, 6.0, 12.0, 20.0] {
            let (map, photo) = photograph(pixels, squeezed, far);
            let plane = |texel: DVec2| texel * pixels;
            let texel = |i: usize| DVec2::new((i % SIDE) as f64, (i / SIDE) as f64);
            let truth: Vec<f64> = (0..SIDE * SIDE).map(|i| mean(64, texel(i), plane)).collect();
            let error = |shown: &dyn Fn(usize) -> f64| {
                let squares = truth.iter().enumerate().map(|(i, t)| (shown(i) - t).powi(2));
                (squares.sum::<f64>() / truth.len() as f64).sqrt()
            };
            let (seconds, ours) = recovered(&photo, map);
            let ours = error(&|i| f64::from(ours.data[3 * i]));
            let [wide, narrow] = WIDTHS.map(|(_, variance)| {
                let ewa = Ewa::new(variance);
                let all = || (0..SIDE * SIDE).map(|i| ewa.at(&photo, map, texel(i) + 0.5)).collect::<Vec<f64>>();
                let (seconds, values) = time(Clock::Process, all);
                (error(&|i| values[i]), seconds)
            });
            behind += usize::from(ours > wide.0) + usize::from(ours > narrow.0);
            let per_texel = |seconds: f64| format!("{:.2}", 1e6 * seconds / (SIDE * SIDE) as f64);
            let errors = [ours, wide.0, narrow.0].map(|e| format!("{e:.4}"));
            let row = [view.to_string(), format!("{pixels:.2}")].into_iter().chain(errors);
            table.row(row.chain([per_texel(seconds), per_texel(narrow.1)]));
        }
    }
    table.print("Root mean square error of texels recovered from a photo in perspective; processor time per texel");
    figure("emission.recovery.behind_ewa", behind as f64, "cases");
}

/// Makes a photo of the pattern; returns the map from texels into the photo, and the photo. At the far end of the
/// plane, scale is smaller by a factor of about `1 + far`.
fn photograph(pixels: f64, squeezed: f64, far: f64) -> (Homography, Image) {
    let size = SIDE as f64 * pixels;
    let rows = [
        [pixels, 0.15 * pixels, 8.0],
        [0.05 * squeezed * pixels, squeezed * pixels, 8.0],
        [0.0, far * pixels / size, 1.0],
    ];
    let map = DMat3::from_cols_array_2d(&rows).transpose();
    let back = Homography(map.inverse());
    let (width, height) = ((1.2 * size) as usize + 16, (1.1 * squeezed * size) as usize + 16);
    let photo = Image::from_fn(width, height, |x, y| {
        [mean(8, DVec2::new(x as f64, y as f64), |p| back.apply(p) * pixels) as f32; 3]
    });
    (Homography(map), photo.expect("a photo"))
}

/// Renders a texture of the whole plane; returns the seconds that its texels take, and the texture.
fn recovered(photo: &Image, map: Homography) -> (f64, Image) {
    let image = |channels: usize| {
        let mut image = Image::new(SIDE, SIDE, channels).expect("an image");
        image.data.fill(1.0);
        image
    };
    let (unwarped, light, valid) = (image(3), image(1), image(1));
    let input = Input { unwarped: &unwarped, light: &light, valid: &valid, photo: Some((photo, map.into())) };
    let params = Params { width: SIDE, height: SIDE, clip_level: 0.0, ..Params::default() };
    let monitor = Monitor::default();
    let plan = Composition::new(&input, &[], &params, monitor.job()).expect("a plan");
    let render = || plan.tile(&input, &[], plan.whole(), monitor.job()).expect("a texture").0;
    time(Clock::Process, render)
}

/// Heckbert's EWA filter (1989, 3.5): a Gaussian over the ellipse that a texel covers in the photo, widened by the
/// Gaussian of a pixel. The weights come from a table over the squared distance, which is updated along each row of
/// pixels.
struct Ewa {
    variance: f64,
    table: Vec<f32>,
}

impl Ewa {
    const STEPS: usize = 1024;
    /// Squared distance from the centre at which the filter is cut off, in squared standard deviations.
    const END: f64 = 9.0;
    /// Maximum length in pixels of the derivative of the map along a side of a texel.
    const MAX_PIXELS: f64 = 64.0;

    fn new(variance: f64) -> Self {
        let weight = |i: usize| (-0.5 * Self::END * (i as f64 + 0.5) / Self::STEPS as f64).exp() as f32;
        Self { variance, table: (0..Self::STEPS).map(weight).collect() }
    }

    fn at(&self, photo: &Image, map: Homography, texel: DVec2) -> f64 {
        let at = map.apply(texel);
        let derivative = |step: DVec2| {
            (map.apply(texel + step * 0.5) - map.apply(texel - step * 0.5)).clamp_length_max(Self::MAX_PIXELS)
        };
        let (u, v) = (derivative(DVec2::X), derivative(DVec2::Y));
        let [xx, yy] = [u.x * u.x + v.x * v.x + 1.0, u.y * u.y + v.y * v.y + 1.0].map(|m| m * self.variance);
        let xy = (u.x * u.y + v.x * v.y) * self.variance;
        let per_step = Self::STEPS as f64 / Self::END / (xx * yy - xy * xy);
        let [a, b, c] = [yy, -2.0 * xy, xx].map(|q| q * per_step);
        let reach = DVec2::new((Self::END * xx).sqrt(), (Self::END * yy).sqrt());
        let low = (at - reach - 0.5).ceil().max(DVec2::ZERO);
        let high = (at + reach - 0.5).floor().min(DVec2::new(photo.width as f64, photo.height as f64) - 1.0);
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0f32);
        for y in low.y as usize..=high.y as usize {
            let d = DVec2::new(low.x, y as f64) + 0.5 - at;
            let mut square = a * d.x * d.x + b * d.x * d.y + c * d.y * d.y;
            let mut change = a * (2.0 * d.x + 1.0) + b * d.y;
            for x in low.x as usize..=high.x as usize {
                if let Some(weight) = self.table.get(square as usize) {
                    sum += photo.rgb(x, y) * *weight;
                    weights += weight;
                }
                square += change;
                change += 2.0 * a;
            }
        }
        f64::from(sum.x / weights)
    }
}
