//! The owned image, and allocation that reports a lack of memory as an error.

use super::pages::{prefer_huge, zeros};
use crate::error::{Error, ErrorKind, Result};
use crate::reserve;
use glam::{DVec2, Vec3};

/// Largest allowed width and height of any image, in pixels.
pub const MAX_SIDE: usize = 65_536;

/// An image of interleaved `f32` samples, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    pub width: usize,
    pub height: usize,
    pub channels: usize,
    pub data: Vec<f32>,
}

/// Returns a vector of `len` copies of `value`, or an error if memory is short. (An ordinary allocation would abort
/// the host's process instead.)
pub fn try_vec<T: Clone>(len: usize, value: T) -> Result<Vec<T>> {
    let mut data = try_with_capacity(len)?;
    data.resize(len, value);
    Ok(data)
}

/// Returns an empty vector with room for `len` items, or an error if memory is short.
pub fn try_with_capacity<T>(len: usize) -> Result<Vec<T>> {
    let mut data = reserve::list(len).ok_or_else(|| no_memory::<T>(len))?;
    prefer_huge(data.spare_capacity_mut());
    Ok(data)
}

/// Collects an iterator, or returns an error if memory is short.
pub fn try_collect<T>(items: impl IntoIterator<Item = T>) -> Result<Vec<T>> {
    let mut items = items.into_iter();
    let promised = items.size_hint().0;
    let mut data = try_with_capacity(promised)?;
    // The vector has capacity for `promised` items. `extend` therefore adds this many without a check per item, and the
    // compiler may vectorise it.
    data.extend(items.by_ref().take(promised));
    for item in items {
        try_push(&mut data, item)?;
    }
    Ok(data)
}

/// Appends an item, or returns an error if memory is short.
pub fn try_push<T>(data: &mut Vec<T>, item: T) -> Result<()> {
    reserve_capacity(data, 1)?;
    data.push(item);
    Ok(())
}

/// Ensures capacity for `more` further items, or returns an error if memory is short. The capacity at least doubles
/// when it grows.
#[inline]
pub(crate) fn reserve_capacity<T>(data: &mut Vec<T>, more: usize) -> Result<()> {
    if reserve::reserve_capacity(data, more) { Ok(()) } else { Err(no_memory::<T>(data.len().saturating_add(more))) }
}

/// Returns the error for a failed allocation of `len` items.
pub(crate) fn no_memory<T>(len: usize) -> Error {
    let mib = (len as f64) * size_of::<T>() as f64 / (1 << 20) as f64;
    Error::new(ErrorKind::OutOfMemory, format!("could not allocate {mib:.1} MiB"))
}

impl Image {
    /// Creates an image of zeros.
    pub fn new(width: usize, height: usize, channels: usize) -> Result<Self> {
        if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
            return Err(Error::argument(format!(
                "image size is {width} x {height}; each side must lie in [1, {MAX_SIDE}]"
            )));
        }
        if channels == 0 || channels > 64 {
            return Err(Error::argument(format!("image has {channels} channels; it must have 1 to 64")));
        }
        let len = width * height * channels;
        Ok(Self { width, height, channels, data: zeros(len).ok_or_else(|| no_memory::<f32>(len))? })
    }

    /// Returns a copy, or an error if memory is short.
    pub fn try_clone(&self) -> Result<Self> {
        Ok(Self { data: try_collect(self.data.iter().copied())?, ..*self })
    }

    /// Creates an image from a function of each pixel's column and row.
    pub fn from_fn<const C: usize>(
        width: usize,
        height: usize,
        pixel: impl Fn(usize, usize) -> [f32; C],
    ) -> Result<Self> {
        let mut image = Self::new(width, height, C)?;
        for (i, out) in image.data.chunks_exact_mut(C).enumerate() {
            out.copy_from_slice(&pixel(i % width, i / width));
        }
        Ok(image)
    }

    /// Length of a row in samples.
    pub fn row_len(&self) -> usize {
        self.width * self.channels
    }

    pub fn row(&self, y: usize) -> &[f32] {
        &self.data[y * self.row_len()..(y + 1) * self.row_len()]
    }

    /// Returns the centre, in pixels, of the pixel with the row-major index `y * width + x`.
    pub fn centre_of(&self, pixel: usize) -> DVec2 {
        DVec2::new((pixel % self.width) as f64 + 0.5, (pixel / self.width) as f64 + 0.5)
    }

    pub fn pixel(&self, x: usize, y: usize) -> &[f32] {
        let start = (y * self.width + x) * self.channels;
        &self.data[start..start + self.channels]
    }

    pub fn pixel_mut(&mut self, x: usize, y: usize) -> &mut [f32] {
        let start = (y * self.width + x) * self.channels;
        &mut self.data[start..start + self.channels]
    }

    /// Returns the first three channels of a pixel. An image of one or two channels gives its first channel three
    /// times.
    pub fn rgb(&self, x: usize, y: usize) -> Vec3 {
        let pixel = self.pixel(x, y);
        if pixel.len() >= 3 { Vec3::from_slice(pixel) } else { Vec3::splat(pixel[0]) }
    }

    /// Returns one channel as a new image.
    pub fn channel(&self, channel: usize) -> Result<Self> {
        let mut out = Self::new(self.width, self.height, 1)?;
        for (o, p) in out.data.iter_mut().zip(self.data.chunks_exact(self.channels)) {
            *o = p[channel];
        }
        Ok(out)
    }

    /// Returns an image of the first three channels. With one or two channels, the first one is repeated three times.
    pub fn to_rgb(&self) -> Result<Self> {
        let mut out = Self::new(self.width, self.height, 3)?;
        for (o, p) in out.data.chunks_exact_mut(3).zip(self.data.chunks_exact(self.channels)) {
            if p.len() >= 3 { o.copy_from_slice(&p[..3]) } else { o.fill(p[0]) }
        }
        Ok(out)
    }

    /// Checks that another image has the same width and height. `name` and `other_name` stand for the images in the
    /// error message.
    pub fn check_same_size(&self, name: &str, other: &Self, other_name: &str) -> Result<()> {
        if (self.width, self.height) == (other.width, other.height) {
            return Ok(());
        }
        Err(Error::argument(format!(
            "{name} is {} x {} and {other_name} is {} x {}; they must have the same size",
            self.width, self.height, other.width, other.height
        )))
    }

    /// Number of samples that are NaN or infinite.
    pub fn count_non_finite(&self) -> usize {
        self.data.iter().filter(|v| !v.is_finite()).count()
    }

    /// Interpolates one channel bilinearly at a position in pixels; pixel centres lie at half-integers. Beyond the
    /// border, the border pixels are repeated.
    pub fn sample(&self, x: f64, y: f64, channel: usize) -> f32 {
        let (x, y) = (x - 0.5, y - 0.5);
        let clamp = |v: f64, n: usize| (v.clamp(0.0, (n - 1) as f64)) as usize;
        let (x0, y0) = (clamp(x.floor(), self.width), clamp(y.floor(), self.height));
        let (x1, y1) = (clamp(x.floor() + 1.0, self.width), clamp(y.floor() + 1.0, self.height));
        let (tx, ty) = ((x - x.floor()) as f32, (y - y.floor()) as f32);
        let at = |x: usize, y: usize| self.data[(y * self.width + x) * self.channels + channel];
        let top = at(x0, y0) + (at(x1, y0) - at(x0, y0)) * tx;
        let bottom = at(x0, y1) + (at(x1, y1) - at(x0, y1)) * tx;
        top + (bottom - top) * ty
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_out_of_range_are_refused_with_their_values() {
        for (w, h, c) in [(0, 1, 1), (1, 0, 3), (MAX_SIDE + 1, 1, 1), (1, 1, 0), (1, 1, 65)] {
            assert_eq!(Image::new(w, h, c).unwrap_err().kind, ErrorKind::InvalidArgument);
        }
        assert!(Image::new(0, 7, 3).unwrap_err().message.contains("0 x 7"));
    }

    #[test]
    fn bilinear_samples_hit_pixel_centres_and_clamp() {
        let image = Image::from_fn(3, 2, |x, y| [(x + 10 * y) as f32]).unwrap();
        assert_eq!(image.sample(0.5, 0.5, 0), 0.0);
        assert_eq!(image.sample(2.5, 1.5, 0), 12.0);
        assert_eq!(image.sample(1.0, 1.0, 0), 5.5);
        assert_eq!(image.sample(-50.0, 1.5, 0), 10.0);
        assert_eq!(image.sample(1e9, -1e9, 0), 2.0);
    }
}
