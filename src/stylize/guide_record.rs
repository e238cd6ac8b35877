//! The guides of a frame as the next frame of a sequence needs them: the light to which the paint of each patch was
//! matched, and the data by which points of surfaces are recognised.

use super::guides::{Channels, MAX_CHANNELS, MAX_PATCH};
use crate::error::Result;
use crate::exec;
use crate::image::{Comparison, Image, neighbourhood, try_collect, try_vec};
use crate::job::Job;
use crate::maths;

/// Number of steps into which the range `[0, 1]` of a guide is divided: values are stored in 8 bits. [rounding]
const STEPS: f32 = 255.0;
/// A pixel shows another surface than before if a channel of its data differs by more than this share of the channel's
/// range. [judged on 1 scene]
const DATA_TOLERANCE: f32 = 0.25;

/// Record of the guides of a frame. The default has no pixels and cannot be compared with the record of any frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GuideRecord {
    /// Size of the target in pixels, and number of patches along x and y.
    size: [usize; 2],
    patches: [usize; 2],
    /// For each patch, the mean of each channel of light when the patch's match was chosen, as multiples of 1/255.
    light: Vec<u8>,
    /// Weight of each channel of light; the weights sum to 1, or to 0 if there is no light.
    weights: Vec<f32>,
    /// The guides of data (`Range::Data`), such as normals: for each pixel, the value of each channel, as a multiple of
    /// 1/255. Empty without such guides.
    data: Vec<u8>,
    /// Weight of [`Input::normals`](super::Input::normals) in this frame: 0 if they were not used.
    pub(super) normals_weight: f32,
}

impl GuideRecord {
    /// Stores the guides of a target.
    pub(super) fn of(guides: &Channels, normals_weight: f32, patch: usize, job: Job) -> Result<Self> {
        let target = &guides.target;
        let size = [target.width, target.height];
        let patches = size.map(|n| n + 1 - patch);
        let channel = |is_light: bool| -> Vec<usize> {
            (0..target.channels).filter(|&c| guides.is_light[c] == is_light).collect()
        };
        let (lights, others) = (channel(true), channel(false));
        let mut light = try_vec(patches[0] * patches[1] * lights.len(), 0u8)?;
        if !lights.is_empty() {
            let row_len = patches[0] * lights.len();
            exec::for_rows(&mut light, row_len, job, |y, row| means(row, target, &lights, y, patch))?;
        }
        let pixels = target.data.chunks_exact(target.channels);
        let data = try_collect(pixels.flat_map(|p| others.iter().map(|&c| stored(p[c]))))?;
        let total: f64 = lights.iter().map(|&c| guides.weights[c]).sum();
        let weight = |&c: &usize| if total > 0.0 { (guides.weights[c] / total) as f32 } else { 0.0 };
        Ok(Self { size, patches, light, weights: lights.iter().map(weight).collect(), data, normals_weight })
    }

    /// Whether this is the record of a frame; false for the default record.
    pub(super) fn is_of_frame(&self) -> bool {
        self.size != [0, 0]
    }

    /// Whether values of both records can be compared: the guides have equal sizes and channels.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        (self.size, self.patches, self.weights.len(), self.data.len())
            == (other.size, other.patches, other.weights.len(), other.data.len())
    }

    /// Returns the weighted root mean square difference between the light on a patch of this record and the light on
    /// the patch `other_patch` of the record `other`.
    pub(super) fn change(&self, patch: usize, other: &Self, other_patch: usize) -> f32 {
        let n = self.weights.len();
        let light = self.light[patch * n..(patch + 1) * n].iter();
        let pairs = light.zip(&other.light[other_patch * n..(other_patch + 1) * n]);
        let terms =
            pairs.zip(&self.weights).map(|((a, b), w)| w * maths::powi((f32::from(*a) - f32::from(*b)) / STEPS, 2));
        terms.sum::<f32>().sqrt()
    }

    /// Replaces the light on a patch of this record by the light on the patch `other_patch` of the record `other`.
    pub(super) fn recall(&mut self, patch: usize, other: &Self, other_patch: usize) {
        let n = self.weights.len();
        self.light[patch * n..(patch + 1) * n].copy_from_slice(&other.light[other_patch * n..(other_patch + 1) * n]);
    }

    /// Follows the motion of each pixel into the previous frame. Compares the guides of data at the pixel with the
    /// guides of data within one pixel of the end of the motion; the smallest difference is the error of the pixel.
    /// Compares nothing if there are no guides of data, or if `motion` has another size than the target.
    pub(super) fn agreement(&self, before: &Self, motion: &Image, job: Job) -> Result<Comparison> {
        let [width, height] = self.size;
        let channels = self.data.len().checked_div(width * height).unwrap_or(0);
        if channels == 0 || [motion.width, motion.height] != self.size {
            return Ok(Comparison::default());
        }
        let at = |x: usize, y: usize| (y * width + x) * channels..(y * width + x + 1) * channels;
        Comparison::of(self.size, DATA_TOLERANCE, job, |x, y| {
            let step = motion.pixel(x, y);
            let (u, v) = ((x as f32 + 0.5 + step[0]).floor(), (y as f32 + 0.5 + step[1]).floor());
            if !(u >= 0.0 && v >= 0.0 && u < width as f32 && v < height as f32) {
                return None;
            }
            let own = &self.data[at(x, y)];
            let around = neighbourhood([u as usize, v as usize], self.size);
            let differences = around.map(|(u, v)| difference(own, &before.data[at(u, v)]));
            Some(differences.fold(f32::INFINITY, f32::min))
        })
    }
}

fn stored(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * STEPS + 0.5) as u8
}

/// Returns the largest difference of any channel between two pixels, as a share of the channel's range.
fn difference(a: &[u8], b: &[u8]) -> f32 {
    f32::from(a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)) / STEPS
}

/// Writes the means of the chosen channels over the patches of row `y`. Sums each column of pixels first, because
/// neighbouring patches share these sums.
fn means(row: &mut [u8], target: &Image, channels: &[usize], y: usize, patch: usize) {
    let n = channels.len();
    let scale = 1.0 / (patch * patch) as f32;
    let column = |x: usize| {
        let mut sums = [0.0f32; MAX_CHANNELS];
        for dy in 0..patch {
            let pixel = target.pixel(x, y + dy);
            sums.iter_mut().zip(channels).for_each(|(sum, &c)| *sum += pixel[c]);
        }
        sums
    };
    // A ring buffer of the column sums of the current patch. For the patch at `x`, the sum of the patch's last column
    // replaces the sum of column `x - 1`, which the patch no longer contains.
    let mut columns = [[0.0f32; MAX_CHANNELS]; MAX_PATCH];
    (0..patch - 1).for_each(|x| columns[x] = column(x));
    for (x, out) in row.chunks_exact_mut(n).enumerate() {
        let last = x + patch - 1;
        columns[last % patch] = column(last);
        for (i, out) in out.iter_mut().enumerate() {
            // Add the columns from left to right, so that equal patches have equal sums wherever they lie.
            let from_left = (0..patch).map(|k| columns[(x + k) % patch][i]);
            let sum: f32 = from_left.sum();
            *out = stored(sum * scale);
        }
    }
}
