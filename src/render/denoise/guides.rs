//! Guide images (albedo, normal, position). The distance between the guides of two pixels measures how much the
//! surfaces at these pixels differ.

use super::input::Input;
use super::planes::{NEIGHBOURS, Planes, Shift};
use crate::error::Result;
use crate::image::try_vec;
use crate::job::Job;
use crate::simd::widest;

/// Channels of the guide images, three each: albedo, normal, position.
pub const GUIDES: usize = 9;
/// Index of the channel after the guides. For each pixel, it holds the factor by which the pixel's distances to its
/// neighbours are multiplied (see [`scales`]).
const SCALE: usize = GUIDES;
/// Squared difference in albedo, summed over the channels, that counts as a distance of 1. [bench filter]
const ALBEDO: f32 = 0.02;
/// Value of 1 - cos θ that counts as a distance of 1, where θ is the angle between the two normals. [bench filter]
const NORMAL: f32 = 0.02;
/// Value of sin² φ that counts as a distance of 1, where φ is the angle between the tangent plane of the pixel's
/// surface and the direction to the neighbour's position. [bench filter]
const PLANE: f32 = 0.01;

/// The guide images of a picture.
pub struct Guides(Planes);

impl Guides {
    pub fn new(input: &Input, job: Job) -> Result<Self> {
        let (width, height) = (input.albedo.width, input.albedo.height);
        let mut planes = Planes::from_rows([width, height, GUIDES + 1], job.part(0.0, 0.5), |y, row| {
            for (first, image) in [(0, input.albedo), (3, input.normal), (6, input.position)] {
                for x in 0..width {
                    for (c, &v) in image.pixel(x, y)[..3].iter().enumerate() {
                        row[(first + c) * width + x] = if v.is_finite() { v } else { 0.0 };
                    }
                }
            }
        })?;
        let new_scratch = || Ok((try_vec(width, [0.0; 3])?, try_vec(width, 0.0)?));
        let job = job.part(0.5, 1.0);
        let scales = Planes::from_rows_with([width, height, 1], job, new_scratch, |(nearest, distance), y, row| {
            scales(&planes, y, nearest, distance, row);
            // Where the variance is unknown, the statistical test cannot separate the surfaces at an edge; only the
            // guides can. Set the factor to 1 there, which leaves the distances in the guides unchanged.
            (0..width).filter(|&x| !input.is_known(x, y)).for_each(|x| row[x] = 1.0);
        })?;
        for y in 0..height {
            let start = (y * (GUIDES + 1) + SCALE) * width;
            planes.data[start..start + width].copy_from_slice(scales.row(y, 0));
        }
        Ok(Self(planes))
    }

    /// Returns one channel of the albedo of a row.
    pub fn albedo(&self, y: usize, channel: usize) -> &[f32] {
        self.0.row(y, channel)
    }

    /// Returns an image that marks the edges of surfaces: 1 at pixels that have a distance of at most 1 to fewer than
    /// three of their eight neighbours, and 0 elsewhere. Pixels of unknown variance get 0.
    pub fn edges(&self, job: Job) -> Result<Planes> {
        let Planes { width, height, .. } = self.0;
        Planes::from_rows([width, height, 1], job, |y, row| {
            row.iter_mut().zip(self.0.row(y, SCALE)).for_each(|(out, scale)| *out = f32::from(u8::from(*scale < 1.0)));
        })
    }

    /// Computes the distances in the guides between the pixels of row `y` and their neighbours at one offset (`at`).
    /// Each distance is multiplied by the factor of its pixel ([`scales`]).
    pub fn distances(&self, y: usize, at: &Shift, out: &mut [f32]) {
        distances(self.0.part(y, 0, at.from, at.span), self.0.part(at.row, 0, at.there, at.span), out);
        out.iter_mut().zip(&self.0.row(y, SCALE)[at.from..]).for_each(|(out, scale)| *out *= scale);
    }
}

/// Computes the factors of the pixels of a row. At an edge of a surface, the guides of a pixel are means over several
/// surfaces, and few neighbours have similar guides. The factor reduces the distances such that the third smallest of
/// the eight is at most 1. Every pixel then has neighbours to be averaged with. (For the same reason, the bandwidth in
/// Rousselle et al. 2013, section 4.1, follows the gradient of the guides.) `nearest` and `distance` are scratch
/// memory.
fn scales(guides: &Planes, y: usize, nearest: &mut [[f32; 3]], distance: &mut [f32], row: &mut [f32]) {
    let width = row.len();
    nearest.fill([f32::INFINITY; 3]);
    for offset in NEIGHBOURS {
        let Some(at) = Shift::new([width, guides.height], y, offset) else { continue };
        let distance = &mut distance[..at.span];
        distances(guides.part(y, 0, at.from, at.span), guides.part(at.row, 0, at.there, at.span), distance);
        for (nearest, &d) in nearest[at.from..].iter_mut().zip(&*distance) {
            let [a, b, c] = *nearest;
            *nearest = [a.min(d), b.min(a.max(d)), c.min(b.max(d))];
        }
    }
    for (scale, [.., third]) in row.iter_mut().zip(nearest) {
        *scale = if third.is_finite() { 1.0 / third.max(1.0) } else { 1.0 };
    }
}

widest! {
    /// Computes the distances between the guides of pixels (`here`) and of their neighbours (`there`).
    fn distances(here: [&[f32]; GUIDES], there: [&[f32]; GUIDES], out: &mut [f32]) {
        let n = out.len();
        // Slice to a common length, which removes the bounds checks of the loop.
        let (a, b) = (here.map(|s| &s[..n]), there.map(|s| &s[..n]));
        let square = |v: f32| v * v;
        for i in 0..n {
            let albedo = square(a[0][i] - b[0][i]) + square(a[1][i] - b[1][i]) + square(a[2][i] - b[2][i]);
            let cosine = a[3][i] * b[3][i] + a[4][i] * b[4][i] + a[5][i] * b[5][i];
            let d = [b[6][i] - a[6][i], b[7][i] - a[7][i], b[8][i] - a[8][i]];
            let height = a[3][i] * d[0] + a[4][i] * d[1] + a[5][i] * d[2];
            let plane = square(height) / (square(d[0]) + square(d[1]) + square(d[2]) + f32::MIN_POSITIVE);
            out[i] = albedo * (1.0 / ALBEDO) + (1.0 - cosine) * (1.0 / NORMAL) + plane * (1.0 / PLANE);
        }
    }
}
