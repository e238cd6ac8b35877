//! A photo of a bracket, with its shift relative to the reference photo.

use crate::image::Image;

/// A photo with a value above this has a high dynamic range: it is not limited to the range of a display, and is
/// nowhere clipped. The most saturated colours of Rec.2020 have values up to 1.66 in Rec.709.
/// [convention: ITU-R BT.2087]
const MAX_DISPLAYED: f32 = 2.0;

#[derive(Clone, Copy)]
pub struct Frame<'a> {
    pub image: &'a Image,
    /// Column and row of the pixel of this photo that shows the same point as pixel (0, 0) of the reference photo.
    pub shift: [isize; 2],
    /// Smallest value at which a channel counts as clipped; infinite in a photo of high dynamic range.
    pub clip: f32,
}

impl<'a> Frame<'a> {
    pub fn new(image: &'a Image, saturation: f64) -> Self {
        let has_high_range = image.data.iter().any(|&v| v > MAX_DISPLAYED);
        Self { image, shift: [0; 2], clip: if has_high_range { f32::INFINITY } else { saturation as f32 } }
    }

    /// Returns the channels of the pixel that shows the same point as pixel `(x, y)` of the reference photo. `None` if
    /// this point lies outside the photo.
    #[inline]
    pub fn pixel(&self, x: usize, y: usize) -> Option<&'a [f32]> {
        let column = x.wrapping_add_signed(self.shift[0]);
        let row = y.wrapping_add_signed(self.shift[1]);
        (column < self.image.width && row < self.image.height).then(|| self.image.pixel(column, row))
    }

    /// Returns two numbers about the pixel that [`pixel`](Self::pixel) returns: its light, and its largest colour
    /// channel.
    #[inline]
    pub fn levels(&self, x: usize, y: usize) -> Option<[f32; 2]> {
        self.pixel(x, y).map(|pixel| [light(pixel), peak(pixel)])
    }
}

/// Returns the colour channels of a pixel, without alpha.
#[inline]
pub fn colours(pixel: &[f32]) -> &[f32] {
    &pixel[..pixel.len().min(3)]
}

/// Returns the light of a pixel: the mean of its colour channels. (The luminance would have more noise.)
#[inline]
pub fn light(pixel: &[f32]) -> f32 {
    let colours = colours(pixel);
    colours.iter().sum::<f32>() / colours.len() as f32
}

/// Returns the largest colour channel of a pixel. It decides whether the pixel counts as clipped: where one channel is
/// clipped, cameras and converters also change the other channels.
#[inline]
pub fn peak(pixel: &[f32]) -> f32 {
    colours(pixel).iter().copied().fold(f32::MIN, f32::max)
}
