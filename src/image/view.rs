//! Strided views of pixels in the caller's memory. The layout of a view is checked against the size of the memory;
//! then the pixels are read into an [`Image`] or written from one.

use crate::error::{Error, Result};
use crate::image::colour::{linear_to_srgb, srgb_to_linear, srgb8_table};
use crate::image::{Image, MAX_SIDE};
use half::f16;

/// The number format of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleFormat {
    U8,
    U16,
    F16,
    F32,
}

impl SampleFormat {
    pub fn size(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
            Self::F32 => 4,
        }
    }
}

/// How the numbers of a view encode colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourSpace {
    /// Scene-linear Rec.709 colours, or data other than colour.
    Linear,
    /// sRGB-encoded colours. The last of 2 or 4 channels is alpha, which is linear.
    Srgb,
}

/// Size, sample format and strides of an image in the caller's memory. Integer samples stand for `[0, 1]`.
#[derive(Clone, Copy, Debug)]
pub struct PixelLayout {
    pub sample: SampleFormat,
    pub channels: usize,
    pub colour_space: ColourSpace,
    pub width: usize,
    pub height: usize,
    /// Bytes from one pixel to the next; 0 if pixels follow each other without gaps.
    pub pixel_stride: usize,
    /// Bytes from one row to the next; 0 if rows follow each other without gaps.
    pub row_stride: usize,
    /// Whether the first row in memory is the bottom row of the image.
    pub bottom_up: bool,
}

impl PixelLayout {
    /// Replaces strides of 0 by their values, and checks that all pixels fit into `byte_size` bytes.
    pub fn checked(mut self, byte_size: usize) -> Result<Self> {
        let side = |name: &str, v: usize| {
            if (1..=MAX_SIDE).contains(&v) {
                Ok(())
            } else {
                Err(Error::argument(format!("view.{name} is {v}; it must lie in [1, {MAX_SIDE}]")))
            }
        };
        side("width", self.width)?;
        side("height", self.height)?;
        if !(1..=4).contains(&self.channels) {
            return Err(Error::argument(format!("view has {} channels; it must have 1 to 4", self.channels)));
        }
        let pixel_size = self.sample.size() * self.channels;
        if self.pixel_stride == 0 {
            self.pixel_stride = pixel_size;
        }
        if self.pixel_stride < pixel_size {
            return Err(Error::argument(format!(
                "view.pixel_stride is {}; it must be 0 (packed) or at least the pixel size, {pixel_size} bytes",
                self.pixel_stride
            )));
        }
        let overflow = || Error::argument("view strides overflow the address space".to_string());
        let row_size = self
            .pixel_stride
            .checked_mul(self.width - 1)
            .and_then(|b| b.checked_add(pixel_size))
            .ok_or_else(overflow)?;
        if self.row_stride == 0 {
            self.row_stride = self.pixel_stride.checked_mul(self.width).ok_or_else(overflow)?;
        }
        if self.row_stride < row_size {
            return Err(Error::argument(format!(
                "view.row_stride is {}; it must be 0 (packed) or at least the row size, {row_size} bytes",
                self.row_stride
            )));
        }
        let needed =
            self.row_stride.checked_mul(self.height - 1).and_then(|b| b.checked_add(row_size)).ok_or_else(overflow)?;
        if byte_size < needed {
            return Err(Error::argument(format!("view.byte_size is {byte_size}; this layout needs {needed} bytes")));
        }
        Ok(self)
    }

    fn offset(&self, x: usize, y: usize) -> usize {
        let y = if self.bottom_up { self.height - 1 - y } else { y };
        y * self.row_stride + x * self.pixel_stride
    }

    /// Whether a channel is sRGB-encoded. Alpha never is.
    fn is_encoded(&self, channel: usize) -> bool {
        self.colour_space == ColourSpace::Srgb && channel < 3 && !(self.channels == 2 && channel == 1)
    }
}

/// Reads the caller's pixels as linear values. NaN and infinity are kept; the stages that use the image handle them.
pub fn read(layout: PixelLayout, bytes: &[u8]) -> Result<Image> {
    let layout = layout.checked(bytes.len())?;
    let mut image = Image::new(layout.width, layout.height, layout.channels)?;
    let table = srgb8_table();
    let size = layout.sample.size();
    for (i, pixel) in image.data.chunks_exact_mut(layout.channels).enumerate() {
        let start = layout.offset(i % layout.width, i / layout.width);
        for (c, out) in pixel.iter_mut().enumerate() {
            let b = &bytes[start + c * size..start + (c + 1) * size];
            let encoded = layout.is_encoded(c);
            let value = match layout.sample {
                SampleFormat::U8 if encoded => {
                    *out = table[b[0] as usize];
                    continue;
                }
                SampleFormat::U8 => f32::from(b[0]) / 255.0,
                SampleFormat::U16 => f32::from(u16::from_ne_bytes([b[0], b[1]])) / 65535.0,
                SampleFormat::F16 => f16::from_ne_bytes([b[0], b[1]]).to_f32(),
                SampleFormat::F32 => f32::from_ne_bytes([b[0], b[1], b[2], b[3]]),
            };
            *out = if encoded { srgb_to_linear(value) } else { value };
        }
    }
    Ok(image)
}

/// Writes linear values to the caller's pixels. For integer samples, values are clamped to `[0, 1]` and rounded, and
/// NaN becomes 0.
pub fn write(image: &Image, layout: PixelLayout, bytes: &mut [u8]) -> Result<()> {
    let layout = layout.checked(bytes.len())?;
    if (image.width, image.height, image.channels) != (layout.width, layout.height, layout.channels) {
        return Err(Error::argument(format!(
            "view is {} x {} with {} channels; the image is {} x {} with {}",
            layout.width, layout.height, layout.channels, image.width, image.height, image.channels
        )));
    }
    let size = layout.sample.size();
    for (i, pixel) in image.data.chunks_exact(layout.channels).enumerate() {
        let start = layout.offset(i % layout.width, i / layout.width);
        for (c, &linear) in pixel.iter().enumerate() {
            let v = if layout.is_encoded(c) { linear_to_srgb(linear) } else { linear };
            let b = &mut bytes[start + c * size..start + (c + 1) * size];
            match layout.sample {
                SampleFormat::U8 => b[0] = (v.clamp(0.0, 1.0) * 255.0).round() as u8,
                SampleFormat::U16 => b.copy_from_slice(&((v.clamp(0.0, 1.0) * 65535.0).round() as u16).to_ne_bytes()),
                SampleFormat::F16 => b.copy_from_slice(&f16::from_f32(v).to_ne_bytes()),
                SampleFormat::F32 => b.copy_from_slice(&v.to_ne_bytes()),
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(sample: SampleFormat, colour_space: ColourSpace) -> PixelLayout {
        PixelLayout {
            sample,
            channels: 3,
            colour_space,
            width: 4,
            height: 3,
            pixel_stride: 0,
            row_stride: 0,
            bottom_up: false,
        }
    }

    #[test]
    fn every_format_round_trips_to_its_precision() {
        let image = Image::from_fn(4, 3, |x, y| [x as f32 / 3.0, y as f32 / 2.0, 0.25]).unwrap();
        for (sample, tolerance) in
            [(SampleFormat::U8, 0.003), (SampleFormat::U16, 1e-5), (SampleFormat::F16, 5e-4), (SampleFormat::F32, 3e-7)]
        {
            for space in [ColourSpace::Linear, ColourSpace::Srgb] {
                for bottom_up in [false, true] {
                    let layout = PixelLayout { pixel_stride: 16, row_stride: 80, bottom_up, ..layout(sample, space) };
                    let mut bytes = vec![0; 80 * 3];
                    write(&image, layout, &mut bytes).unwrap();
                    let back = read(layout, &bytes).unwrap();
                    // The sRGB decoding curve multiplies rounding errors by its slope, which is steepest at white: 2.3.
                    let worst = back.data.iter().zip(&image.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                    assert!(worst <= 2.3 * tolerance, "{sample:?} {space:?}: {worst}");
                }
            }
        }
    }

    #[test]
    fn layouts_that_lie_are_refused() {
        let good = layout(SampleFormat::F32, ColourSpace::Linear);
        assert!(good.checked(4 * 3 * 12).is_ok());
        assert!(good.checked(4 * 3 * 12 - 1).is_err());
        for bad in [
            PixelLayout { pixel_stride: 11, ..good },
            PixelLayout { row_stride: 47, ..good },
            PixelLayout { width: 0, ..good },
            PixelLayout { height: MAX_SIDE + 1, ..good },
            PixelLayout { channels: 5, ..good },
            PixelLayout { row_stride: usize::MAX, ..good },
            PixelLayout { pixel_stride: usize::MAX / 2, ..good },
        ] {
            assert!(bad.checked(usize::MAX).is_err(), "{bad:?}");
        }
    }
}
