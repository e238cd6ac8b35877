//! Images with planar rows: each row stores all its values of channel 0, then all its values of channel 1, and so on,
//! so that loops along a row vectorise.

use crate::error::Result;
use crate::exec;
use crate::image::{try_collect, try_vec};
use crate::job::Job;
use crate::simd::widest;

/// Offsets of the eight neighbours of a pixel.
pub const NEIGHBOURS: [[isize; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// An image with planar rows.
pub struct Planes {
    pub data: Vec<f32>,
    pub width: usize,
    pub height: usize,
    pub channels: usize,
}

impl Planes {
    /// Computes the image row by row, in parallel; `work` receives the number of the row and the row, filled with 0.
    pub fn from_rows(
        [width, height, channels]: [usize; 3],
        job: Job,
        work: impl Fn(usize, &mut [f32]) + Sync,
    ) -> Result<Self> {
        let mut data = try_vec(width * height * channels, 0.0f32)?;
        exec::for_rows(&mut data, width * channels, job, work)?;
        Ok(Self { data, width, height, channels })
    }

    /// Like [`from_rows`](Self::from_rows), with scratch memory: see [`exec::for_rows_with`].
    pub fn from_rows_with<S>(
        [width, height, channels]: [usize; 3],
        job: Job,
        new_scratch: impl Fn() -> Result<S> + Sync,
        work: impl Fn(&mut S, usize, &mut [f32]) + Sync,
    ) -> Result<Self> {
        let mut data = try_vec(width * height * channels, 0.0f32)?;
        exec::for_rows_with(&mut data, width * channels, job, new_scratch, work)?;
        Ok(Self { data, width, height, channels })
    }

    /// Returns one channel of a row.
    pub fn row(&self, y: usize, channel: usize) -> &[f32] {
        let start = (y * self.channels + channel) * self.width;
        &self.data[start..start + self.width]
    }

    /// Returns `N` channels of a row from `first` on, restricted to `span` pixels from column `from` on.
    pub fn part<const N: usize>(&self, y: usize, first: usize, from: usize, span: usize) -> [&[f32]; N] {
        std::array::from_fn(|c| &self.row(y, first + c)[from..from + span])
    }

    /// Averages each channel over the neighbours of each pixel, with weights that fall linearly to 0 at `radius` + 1
    /// pixels along each axis. No value is ever subtracted (as running sums would do), so that rounding cannot make the
    /// mean of non-negative values negative.
    pub fn smoothed(&self, radius: usize, job: Job) -> Result<Self> {
        let Self { width, height, channels, .. } = *self;
        let weight = |distance: usize| (radius + 1 - distance) as f32;
        let down = Self::from_rows([width, height, channels], job, |y, out| {
            let rows = y.saturating_sub(radius)..(y + radius + 1).min(height);
            let total: f32 = rows.clone().map(|row| weight(row.abs_diff(y))).sum();
            for row in rows {
                add_scaled(weight(row.abs_diff(y)) / total, &self.data[row * out.len()..(row + 1) * out.len()], out);
            }
        })?;
        let total = |x: usize| -> f32 {
            (x.saturating_sub(radius)..(x + radius + 1).min(width)).map(|column| weight(column.abs_diff(x))).sum()
        };
        let scales = try_collect((0..width).map(|x| 1.0 / total(x)))?;
        Self::from_rows([width, height, channels], job, |y, out| {
            for (channel, out) in out.chunks_exact_mut(width).enumerate() {
                let row = down.row(y, channel);
                for distance in 0..(radius + 1).min(width) {
                    add_scaled(weight(distance), &row[distance..], &mut out[..width - distance]);
                    if distance > 0 {
                        add_scaled(weight(distance), &row[..width - distance], &mut out[distance..]);
                    }
                }
                out.iter_mut().zip(&scales).for_each(|(out, scale)| *out *= scale);
            }
        })
    }
}

/// A division of the pixels into two classes, such as edges and all others.
pub struct Classes<'a> {
    /// One channel: 1 for pixels of the first class, 0 for pixels of the second.
    pub is_first: &'a Planes,
}

impl Classes<'_> {
    /// Averages each channel over the neighbours of each pixel that are of the pixel's own class, with the weights of
    /// [`Planes::smoothed`].
    pub fn smoothed(&self, image: &Planes, radius: usize, job: Job) -> Result<Planes> {
        let Planes { width, height, channels, .. } = *image;
        // Smooth three images: the values of the first class (0 at pixels of the second), the values of the second
        // class (0 at pixels of the first), and the indicator of the first class (1 or 0). The mean over a class is its
        // smoothed values divided by its smoothed indicator. The smoothed indicator of the second class is 1 minus the
        // smoothed indicator of the first class.
        let parts = Planes::from_rows([width, height, 2 * channels + 1], job.part(0.0, 0.1), |y, row| {
            let is_first = self.is_first.row(y, 0);
            let (values, share) = row.split_at_mut(2 * channels * width);
            share.copy_from_slice(is_first);
            for (channel, pair) in values.chunks_exact_mut(2 * width).enumerate() {
                for (x, &value) in image.row(y, channel).iter().enumerate() {
                    pair[if is_first[x] > 0.0 { x } else { width + x }] = value;
                }
            }
        })?;
        let around = parts.smoothed(radius, job.part(0.1, 0.9))?;
        Planes::from_rows([width, height, channels], job.part(0.9, 1.0), |y, row| {
            let (is_first, share) = (self.is_first.row(y, 0), around.row(y, 2 * channels));
            for (channel, out) in row.chunks_exact_mut(width).enumerate() {
                for (x, out) in out.iter_mut().enumerate() {
                    *out = match is_first[x] > 0.0 {
                        true => around.row(y, 2 * channel)[x] / share[x],
                        false => around.row(y, 2 * channel + 1)[x] / (1.0 - share[x]).max(f32::EPSILON),
                    };
                }
            }
        })
    }
}

/// The pixels of a row that have a neighbour at some offset, and these neighbours.
pub struct Shift {
    /// First pixel of the row, and number of pixels.
    pub from: usize,
    pub span: usize,
    /// Row and first column of the neighbours.
    pub row: usize,
    pub there: usize,
}

impl Shift {
    /// Returns the pixels of row `y` whose neighbour at an offset lies in the image; `None` if no pixel has one.
    pub fn new([width, height]: [usize; 2], y: usize, [dx, dy]: [isize; 2]) -> Option<Self> {
        let row = y.checked_add_signed(dy).filter(|&row| row < height)?;
        let from = dx.min(0).unsigned_abs();
        let to = width.saturating_sub(dx.max(0).unsigned_abs());
        let there = from.checked_add_signed(dx)?;
        (from < to).then(|| Self { from, span: to - from, row, there })
    }
}

widest! {
    /// Adds `scale` times `values` to `sums`.
    fn add_scaled(scale: f32, values: &[f32], sums: &mut [f32]) {
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += scale * value);
    }
}
