//! Measures the regions of the component tree: size and shape through moments, mean colour, and the mean gradient
//! across the contour.

use super::footprint::Footprint;
use super::tree::Tree;
use crate::error::Result;
use crate::exec;
use crate::geometry::lattice::Spot;
use crate::image::{Image, pyramid, try_vec};
use crate::job::Job;
use crate::maths;
use glam::{DMat2, DVec2};

/// Standard deviation of the blur of L* before the tree is built, in pixels. It keeps noise of single pixels from
/// forming regions. [convention]
const SMOOTHING: f32 = 0.6;
/// Standard deviation of the blur of L* before its gradient is computed, in pixels. [convention: Canny]
const GRADIENT_SMOOTHING: f32 = 1.0;
/// Brightness levels per unit of L*. Up to L* = 100 there are 255 levels, about as many as in an 8-bit photo.
/// [convention]
const LEVELS_PER_L: f32 = 2.55;
/// Brightness levels per doubling of L* above 100. Only photos with values above white reach them. [convention]
const LEVELS_PER_DOUBLING: f32 = 32.0;
/// Variance, in square pixels, of a position that is uniformly distributed within a pixel. [convention: exact]
const PIXEL_VARIANCE: f64 = 1.0 / 12.0;
/// A contour is soft where the gradient across it is below this share of the contour gradient of sharp lamps.
/// [bench photos:tune, photos:real]
pub const SOFT: f64 = 0.2;
/// The highest brightness level. [convention]
const MAX_LEVEL: f32 = 1023.0;

/// The brightness and colour of the photo, prepared for the component tree.
pub struct Brightness {
    pub width: usize,
    pub height: usize,
    /// CIELAB after the exposure has been scaled (see [`Self::new`]).
    pub lab: Vec<[f32; 3]>,
    /// L* after the blur by [`SMOOTHING`].
    pub smooth: Image,
    /// The brightness level of each pixel: a monotone function of `smooth`.
    pub levels: Vec<u16>,
    /// Magnitude of the gradient of L* after the blur by [`GRADIENT_SMOOTHING`], in L* per pixel.
    pub gradient: Vec<f32>,
}

/// Below `LINEAR_L`, L* is `SLOPE` times the luminance (0 to 1). [convention: CIE 15]
const LINEAR_L: f32 = 8.0;
const SLOPE: f32 = 24389.0 / 27.0;

/// Returns the luminance, relative to white, of an L*.
fn luminance(l: f32) -> f32 {
    if l > LINEAR_L { maths::powi((l + 16.0) / 116.0, 3) } else { l.max(0.0) / SLOPE }
}

/// Returns the L* of a luminance, which is relative to white.
fn lightness(y: f32) -> f32 {
    if y > LINEAR_L / SLOPE { 116.0 * maths::cbrt(y) - 16.0 } else { y * SLOPE }
}

/// Returns the brightness level of an L*, not rounded.
pub fn level(l: f32) -> f32 {
    let above = if l > 100.0 { LEVELS_PER_DOUBLING * maths::log2(l / 100.0) } else { 0.0 };
    (l.clamp(0.0, 100.0) * LEVELS_PER_L + above).min(MAX_LEVEL)
}

impl Brightness {
    /// Scales the photo's exposure so that an L* of `white` becomes 100, and computes the brightness and colour of all
    /// pixels.
    pub fn new(features: &Image, white: f32, job: Job) -> Result<Self> {
        let gain = 1.0 / luminance(white);
        let (width, height) = (features.width, features.height);
        let mut lab = try_vec(width * height, [0.0f32; 3])?;
        let mut l = Image::new(width, height, 1)?;
        let pixels = features.data.chunks_exact(features.channels);
        for ((pixel, lab), l) in pixels.zip(&mut lab).zip(&mut l.data) {
            *l = lightness(gain * luminance(pixel[0]));
            // At equal chromaticity, a* and b* are proportional to L* + 16 (not in the darkest colours).
            let chroma = (*l + 16.0) / (pixel[0] + 16.0);
            *lab = [*l, pixel[1] * chroma, pixel[2] * chroma];
        }
        let smooth = pyramid::blur(&l, SMOOTHING, job.part(0.0, 0.3))?;
        let smoother = pyramid::blur(&l, GRADIENT_SMOOTHING, job.part(0.3, 0.6))?;
        let mut levels = try_vec(width * height, 0u16)?;
        exec::for_rows(&mut levels, width, job.part(0.6, 0.8), |y, row| {
            row.iter_mut().zip(smooth.row(y)).for_each(|(out, &l)| *out = level(l).round() as u16);
        })?;
        let mut gradient = try_vec(width * height, 0f32)?;
        exec::for_rows(&mut gradient, width, job.part(0.8, 1.0), |y, row| {
            let (above, below) = (smoother.row(y.saturating_sub(1)), smoother.row((y + 1).min(height - 1)));
            let here = smoother.row(y);
            for (x, out) in row.iter_mut().enumerate() {
                let dx = here[(x + 1).min(width - 1)] - here[x.saturating_sub(1)];
                *out = 0.5 * maths::hypot(dx, below[x] - above[x]);
            }
        })?;
        Ok(Self { width, height, lab, smooth, levels, gradient })
    }
}

/// Sums over the pixels of each node of the component tree. A pixel's weight is the area of the room's face that it
/// shows; only `on_face` counts pixels. u and v are coordinates on the face ([`Footprint::at`]).
pub struct OnFace {
    pub area: Vec<f64>,
    /// For each node, the number of its pixels that show the face itself, not its extension beyond the edges.
    pub on_face: Vec<f64>,
    /// Area of all pixels that show the face itself.
    pub shown: f64,
    u: Vec<f64>,
    v: Vec<f64>,
    uu: Vec<f64>,
    vv: Vec<f64>,
    uv: Vec<f64>,
    /// For each node, the sum of the squared areas of its pixels.
    squares: Vec<f64>,
}

impl OnFace {
    fn new(tree: &Tree, footprint: &Footprint) -> Result<Self> {
        let blank = || try_vec(tree.len(), 0f64);
        let mut sums = Self {
            area: blank()?,
            on_face: blank()?,
            shown: 0.0,
            u: blank()?,
            v: blank()?,
            uu: blank()?,
            vv: blank()?,
            uv: blank()?,
            squares: blank()?,
        };
        let shown = footprint.area.iter().zip(&footprint.at).zip(&footprint.is_on_face);
        for (&node, ((&area, at), &is_on_face)) in tree.node_of.iter().zip(shown) {
            let (node, area, [u, v]) = (node as usize, f64::from(area), at.map(f64::from));
            sums.shown += if is_on_face && area.is_finite() { area } else { 0.0 };
            // The shape of the root is not needed: the root is the whole image.
            if node != 0 {
                sums.area[node] += area;
                sums.on_face[node] += f64::from(is_on_face);
                sums.u[node] += area * u;
                sums.v[node] += area * v;
                sums.uu[node] += area * u * u;
                sums.vv[node] += area * v * v;
                sums.uv[node] += area * u * v;
                sums.squares[node] += area * area;
            }
        }
        let Self { area, on_face, u, v, uu, vv, uv, squares, .. } = &mut sums;
        [area, on_face, u, v, uu, vv, uv, squares].into_iter().for_each(|values| tree.accumulate(values));
        Ok(sums)
    }

    /// Whether two nodes lie in a row along u or along v, the axes of the room's face. They lie in a row along u if
    /// their centres differ in v by at most `share` times the larger of their extents in v. The rule for rows along v
    /// is the same with u and v exchanged.
    pub fn are_in_row(&self, a: usize, b: usize, share: f64) -> bool {
        self.across(a, b)
            .into_iter()
            .any(|[(at, extent), (other, other_extent)]| (at - other).abs() <= share * extent.max(other_extent))
    }

    /// Whether two nodes lie in a row along u or along v, and have equal extents across this row. Both the centres and
    /// the extents may differ by at most `share` times the larger extent.
    pub fn are_in_line(&self, a: usize, b: usize, share: f64) -> bool {
        self.across(a, b).into_iter().any(|[(at, extent), (other, other_extent)]| {
            (at - other).abs().max((extent - other_extent).abs()) <= share * extent.max(other_extent)
        })
    }

    /// Whether a node continues a regular row of lamps along u or along v. The least distance between two lamps of the
    /// row is a step; all distances between its lamps are whole numbers of steps, and the node is one or two steps from
    /// the nearest lamp, each within `tolerance` steps. Lamps are in a row with the node as in [`Self::are_in_row`].
    pub fn continues_regular_row(&self, node: usize, lamps: &[usize], share: f64, tolerance: f64) -> bool {
        [0, 1].into_iter().any(|along| {
            let in_row = |lamp: &&usize| {
                let [(at, extent), (other, other_extent)] = self.across(node, **lamp)[1 - along];
                (at - other).abs() <= share * extent.max(other_extent)
            };
            let place = |k: usize| self.across(k, k)[along][0].0;
            let mut row: Vec<f64> = lamps.iter().filter(in_row).map(|&lamp| place(lamp)).collect();
            row.sort_by(f64::total_cmp);
            row.dedup();
            let steps: Vec<f64> = row.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let Some(step) = steps.iter().copied().reduce(f64::min).filter(|step| *step > 0.0) else { return false };
            let is_whole = |length: f64, most: f64| {
                let steps = length / step;
                (steps - steps.round()).abs() <= tolerance && (1.0..=most).contains(&steps.round())
            };
            let nearest = row.iter().map(|at| (place(node) - at).abs()).fold(f64::INFINITY, f64::min);
            is_whole(nearest, 2.0) && steps.iter().all(|&length| is_whole(length, f64::INFINITY))
        })
    }

    /// Returns the centres and extents of two nodes, as (centre, extent) for each node: first in u, which is across a
    /// row along v, then in v. The extent is the width w of a strip with the node's variance w² / 12. The variance
    /// within a pixel, a twelfth of its area, is added; it is the mean over the node's pixels, weighted by area.
    fn across(&self, a: usize, b: usize) -> [[(f64, f64); 2]; 2] {
        [(&self.u, &self.uu), (&self.v, &self.vv)].map(|(first, second)| {
            [a, b].map(|node| {
                let area = self.area[node].max(f64::MIN_POSITIVE);
                let mean = first[node] / area;
                let variance = (second[node] / area - mean * mean).max(0.0) + self.squares[node] / area / 12.0;
                (mean, (12.0 * variance).sqrt())
            })
        })
    }

    /// Length of a node on the face of the room: the long side of the rectangle with the node's area and aspect.
    pub fn length(&self, node: usize) -> f64 {
        (self.area[node] * self.aspect(node)).sqrt()
    }

    /// Aspect of a node, measured on the face of the room: the ratio of the axes of the ellipse with the node's second
    /// moments, at least 1.
    pub fn aspect(&self, node: usize) -> f64 {
        let area = self.area[node].max(f64::MIN_POSITIVE);
        let mean = |sums: &[f64]| sums[node] / area;
        let (u, v) = (mean(&self.u), mean(&self.v));
        let moments = [mean(&self.uu) - u * u, mean(&self.vv) - v * v, mean(&self.uv) - u * v];
        // Add the variance within a pixel, which is a twelfth of the area of a square pixel: the mean over the node's
        // pixels, weighted by area.
        let [long, short] = ellipse(moments, mean(&self.squares) / 12.0);
        long / short.max(f64::MIN_POSITIVE)
    }
}

/// Lengths of the axes of the ellipse with the central second moments xx, yy and xy, the long axis first. `pixel` is
/// the variance within a pixel. It is added to xx and yy, and is the least variance along an axis.
fn ellipse([xx, yy, xy]: [f64; 3], pixel: f64) -> [f64; 2] {
    let (mean, spread) = (0.5 * (xx + yy) + pixel, (0.25 * maths::powi(xx - yy, 2) + xy * xy).sqrt());
    [mean + spread, (mean - spread).max(pixel)].map(|variance| 4.0 * variance.sqrt())
}

/// The share of a node's contour across which the gradient is below `min_gradient`, in L* per pixel.
pub fn soft_share(node: u32, tree: &Tree, photo: &Brightness, min_gradient: f64) -> f64 {
    let pixels = tree.pixels(node);
    let contour = pixels.iter().map(|&p| photo.levels[p as usize]).min().unwrap_or(0);
    let (mut length, mut soft) = (0usize, 0usize);
    for pixel in pixels.iter().map(|&p| p as usize) {
        let (x, y) = (pixel % photo.width, pixel / photo.width);
        let neighbours = [
            (x > 0).then(|| pixel - 1),
            (x + 1 < photo.width).then(|| pixel + 1),
            (y > 0).then(|| pixel - photo.width),
            (y + 1 < photo.height).then(|| pixel + photo.width),
        ];
        // The node is connected, so neighbours that are darker than its darkest pixel lie outside.
        for beside in neighbours.into_iter().flatten().filter(|&beside| photo.levels[beside] < contour) {
            length += 1;
            soft += usize::from(f64::from(photo.gradient[pixel] + photo.gradient[beside]) < 2.0 * min_gradient);
        }
    }
    soft as f64 / length.max(1) as f64
}

/// Sums over the pixels of each node of the component tree, and over the pixel edges along its contour.
pub struct Regions {
    /// Area of each node in pixels.
    pub area: Vec<f64>,
    /// Sums measured on a face of the room instead of in pixels; `None` if the room has no box layout.
    pub surface: Option<OnFace>,
    x: Vec<f64>,
    y: Vec<f64>,
    xx: Vec<f64>,
    yy: Vec<f64>,
    xy: Vec<f64>,
    lab: [Vec<f64>; 3],
    contour_gradient_sum: Vec<f64>,
    contour_length: Vec<f64>,
}

impl Regions {
    pub fn new(tree: &Tree, photo: &Brightness, footprint: Option<&Footprint>, job: Job) -> Result<Self> {
        let blank = || try_vec(tree.len(), 0f64);
        let mut sums = Self {
            area: blank()?,
            surface: footprint.map(|footprint| OnFace::new(tree, footprint)).transpose()?,
            x: blank()?,
            y: blank()?,
            xx: blank()?,
            yy: blank()?,
            xy: blank()?,
            lab: [blank()?, blank()?, blank()?],
            contour_gradient_sum: blank()?,
            contour_length: blank()?,
        };
        for y in 0..photo.height {
            if y % 64 == 0 {
                job.check()?;
            }
            sums.add_row(tree, photo, y);
        }
        let Self { area, x, y, xx, yy, xy, lab: [l, a, b], contour_gradient_sum, contour_length, .. } = &mut sums;
        let all = [area, x, y, xx, yy, xy, l, a, b, contour_gradient_sum, contour_length];
        all.into_iter().for_each(|values| tree.accumulate(values));
        Ok(sums)
    }

    fn add_row(&mut self, tree: &Tree, photo: &Brightness, y: usize) {
        for x in 0..photo.width {
            let i = y * photo.width + x;
            let node = tree.node_of[i] as usize;
            // The shape of the root is not needed, but its pixels lie along the contours of other nodes.
            if node != 0 {
                let (u, v) = (x as f64, y as f64);
                self.area[node] += 1.0;
                self.x[node] += u;
                self.y[node] += v;
                self.xx[node] += u * u;
                self.yy[node] += v * v;
                self.xy[node] += u * v;
                (0..3).for_each(|c| self.lab[c][node] += f64::from(photo.lab[i][c]));
            }
            if x + 1 < photo.width {
                self.add_edge(tree, photo, i, i + 1);
            }
            if y + 1 < photo.height {
                self.add_edge(tree, photo, i, i + photo.width);
            }
        }
    }

    /// Adds the edge between two neighbouring pixels to the contours of all nodes that contain the brighter pixel but
    /// not the darker one. Gradient and length are added at the smallest node of the brighter pixel, and subtracted at
    /// the smallest node of the darker pixel. When `Tree::accumulate` sums over subtrees, they therefore cancel in
    /// every node that contains both pixels.
    fn add_edge(&mut self, tree: &Tree, photo: &Brightness, i: usize, j: usize) {
        let (a, b) = (tree.node_of[i] as usize, tree.node_of[j] as usize);
        if a == b || photo.levels[i] == photo.levels[j] {
            return;
        }
        let (bright, dark) = if photo.levels[i] > photo.levels[j] { (a, b) } else { (b, a) };
        let gradient = 0.5 * f64::from(photo.gradient[i] + photo.gradient[j]);
        self.contour_gradient_sum[bright] += gradient;
        self.contour_gradient_sum[dark] -= gradient;
        self.contour_length[bright] += 1.0;
        self.contour_length[dark] -= 1.0;
    }

    /// Mean gradient across the contour, in L* per pixel: high at sharp edges, low where the contour is an arbitrary
    /// level line.
    pub fn contour_gradient(&self, node: usize) -> f64 {
        if self.contour_length[node] > 0.0 { self.contour_gradient_sum[node] / self.contour_length[node] } else { 0.0 }
    }

    pub fn colour(&self, node: usize) -> [f64; 3] {
        [0, 1, 2].map(|c| self.lab[c][node] / self.area[node])
    }

    pub fn centre(&self, node: usize) -> [f64; 2] {
        [self.x[node] / self.area[node], self.y[node] / self.area[node]]
    }

    /// Central second moments xx, yy and xy of the pixels' centres.
    fn moments(&self, node: usize) -> [f64; 3] {
        let area = self.area[node];
        let [u, v] = self.centre(node);
        [self.xx[node] / area - u * u, self.yy[node] / area - v * v, self.xy[node] / area - u * v]
    }

    /// The node as a spot of the photo.
    pub fn spot(&self, node: usize) -> Spot {
        let [xx, yy, xy] = self.moments(node);
        let pixel = DMat2::from_diagonal(DVec2::splat(PIXEL_VARIANCE));
        let covariance = DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy)) + pixel;
        Spot { centre: DVec2::from_array(self.centre(node)) + 0.5, inverse: covariance.inverse() }
    }

    /// Lengths in pixels of the axes of the ellipse with the node's second moments, the long axis first.
    pub fn axes(&self, node: usize) -> [f64; 2] {
        let [xx, yy, xy] = self.moments(node);
        // Add the variance within a pixel: a twelfth of its squared side.
        ellipse([xx, yy, xy], PIXEL_VARIANCE)
    }

    /// Area divided by the area of the ellipse with the node's second moments: 1 for an ellipse, 0.95 for a rectangle,
    /// less for a ring or a branched shape.
    pub fn solidity(&self, node: usize) -> f64 {
        let [long, short] = self.axes(node);
        self.area[node] / (std::f64::consts::FRAC_PI_4 * long * short)
    }
}
