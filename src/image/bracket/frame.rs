//! A photo of a bracket in the frame of the reference.

use crate::image::Image;

/// A photo with a value above this is not a picture of a display's range: it has a high dynamic range and is nowhere
/// clipped. The most saturated colours of Rec.2020 have values up to 1.66 in Rec.709. [convention: ITU-R BT.2087]
const MAX_DISPLAYED: f32 = 2.0;

#[derive(Clone, Copy)]
pub struct Frame<'a> {
    pub image: &'a Image,
    /// Column and row of this photo that show the same as column 0 and row 0 of the reference.
    pub shift: [isize; 2],
    /// Value from which on a channel is clipped; infinite if no value is.
    pub clip: f32,
}

impl<'a> Frame<'a> {
    pub fn new(image: &'a Image, saturation: f64) -> Self {
        let has_high_range = image.data.iter().any(|&v| v > MAX_DISPLAYED);
        Self { image, shift: [0; 2], clip: if has_high_range { f32::INFINITY } else { saturation as f32 } }
    }

    /// The channels of the pixel that shows what pixel `(x, y)` of the reference shows; `None` outside the photo.
    #[inline]
    pub fn pixel(&self, x: usize, y: usize) -> Option<&'a [f32]> {
        let column = x.wrapping_add_signed(self.shift[0]);
        let row = y.wrapping_add_signed(self.shift[1]);
        (column < self.image.width && row < self.image.height).then(|| self.image.pixel(column, row))
    }

    /// Like [`pixel`](Self::pixel), as the light and the largest of the colour channels.
    #[inline]
    pub fn levels(&self, x: usize, y: usize) -> Option<[f32; 2]> {
        self.pixel(x, y).map(|pixel| [light(pixel), peak(pixel)])
    }
}

/// The colour channels of a pixel: without alpha.
#[inline]
pub fn colours(pixel: &[f32]) -> &[f32] {
    &pixel[..pixel.len().min(3)]
}

/// The mean of the colour channels. (Not the luminance: the mean has the least noise.)
#[inline]
pub fn light(pixel: &[f32]) -> f32 {
    let colours = colours(pixel);
    colours.iter().sum::<f32>() / colours.len() as f32
}

/// The largest of the colour channels, by which a pixel counts as clipped: where one channel is clipped, cameras
/// and converters also change the others.
#[inline]
pub fn peak(pixel: &[f32]) -> f32 {
    colours(pixel).iter().copied().fold(f32::MIN, f32::max)
}
