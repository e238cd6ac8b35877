//! Converts the colours of a picture file to linear Rec.709, in place.

use super::curve::Curve;
use crate::error::{Error, ErrorKind, Result};
use crate::image::{Image, try_vec};
use glam::{DMat3, Mat3, Vec3};
use moxcms::TransformF32Executor;
use std::sync::Arc;

/// The conversion from the samples of a file (integers scaled to `[0, 1]`) to linear Rec.709.
///
/// Colours outside Rec.709 have negative components, which become 0 because later stages treat negative values as
/// damage. If the file itself stores a negative component, the converted components of this pixel are only raised to
/// that value, so that later stages see the damage. Components above 1 are kept.
#[derive(Clone)]
pub struct Conversion(ColourTransform);

#[derive(Clone)]
enum ColourTransform {
    /// One transfer curve for grey values.
    Grey(Curve),
    Rgb {
        /// Transfer curves of the channels; `None` if the samples are linear.
        curves: Option<[Curve; 3]>,
        matrix: Mat3,
    },
    /// The tables of a profile, which convert to sRGB, and the curve that converts sRGB to linear values.
    Tables(Arc<TransformF32Executor>, Curve),
}

impl Conversion {
    pub fn new(curves: [Curve; 3], matrix: DMat3) -> Self {
        Self(ColourTransform::Rgb { curves: Some(curves), matrix: matrix.as_mat3() })
    }

    pub fn grey(curve: Curve) -> Self {
        Self(ColourTransform::Grey(curve))
    }

    pub(super) fn linear(matrix: DMat3) -> Self {
        Self(ColourTransform::Rgb { curves: None, matrix: matrix.as_mat3() })
    }

    /// Returns the conversion from sRGB-encoded samples.
    pub fn srgb() -> Result<Self> {
        let curve = Curve::srgb()?;
        Ok(Self::new([curve.clone(), curve.clone(), curve], DMat3::IDENTITY))
    }

    pub fn tables(to_srgb: Arc<TransformF32Executor>) -> Result<Self> {
        Ok(Self(ColourTransform::Tables(to_srgb, Curve::srgb()?)))
    }

    /// Whether a picture with this number of channels can be converted: grey profiles cannot convert colours, nor can
    /// colour tables convert greys. For a grey profile, four channels count as grey with alpha.
    pub fn fits(&self, channels: usize) -> bool {
        match self.0 {
            ColourTransform::Grey(_) => channels != 3,
            ColourTransform::Rgb { .. } => true,
            ColourTransform::Tables(..) => channels >= 3,
        }
    }

    /// Converts a picture of 1, 3 or 4 channels. The fourth channel is alpha and stays unchanged.
    pub fn apply(&self, image: &mut Image) -> Result<()> {
        match &self.0 {
            ColourTransform::Rgb { curves, .. } if image.channels < 3 => {
                if let Some([_, curve, _]) = curves {
                    image.data.iter_mut().for_each(|v| *v = curve.at(*v));
                }
            }
            ColourTransform::Rgb { curves: Some([r, g, b]), matrix } => each_colour(image, |colour| {
                within(*matrix * Vec3::new(r.at(colour.x), g.at(colour.y), b.at(colour.z)), colour)
            }),
            ColourTransform::Rgb { curves: None, matrix } => {
                each_colour(image, |colour| within(*matrix * colour, colour))
            }
            ColourTransform::Grey(curve) if image.channels < 3 => image.data.iter_mut().for_each(|v| *v = curve.at(*v)),
            // Grey with alpha has three equal channels. Convert each, so that a coloured picture with a wrong profile
            // keeps its colours.
            ColourTransform::Grey(curve) => {
                each_colour(image, |colour| Vec3::from(colour.to_array().map(|v| curve.at(v))))
            }
            ColourTransform::Tables(to_srgb, curve) => apply_tables(image, to_srgb.as_ref(), curve)?,
        }
        Ok(())
    }
}

fn each_colour(image: &mut Image, convert: impl Fn(Vec3) -> Vec3) {
    for pixel in image.data.chunks_exact_mut(image.channels) {
        convert(Vec3::from_slice(pixel)).write_to_slice(pixel);
    }
}

/// Raises the components of a converted colour that are below a limit to this limit. The limit is 0, or the lowest
/// component of the file's colour `from` if that is negative. NaN stays NaN.
fn within(colour: Vec3, from: Vec3) -> Vec3 {
    let lowest = Vec3::splat(from.min_element().min(0.0));
    Vec3::select(colour.cmplt(lowest), lowest, colour)
}

fn apply_tables(image: &mut Image, to_srgb: &TransformF32Executor, curve: &Curve) -> Result<()> {
    let (mut stored, mut srgb) = (try_vec(3 * image.width, 0f32)?, try_vec(3 * image.width, 0f32)?);
    let (row_len, channels) = (image.row_len(), image.channels);
    for row in image.data.chunks_exact_mut(row_len) {
        for (stored, pixel) in stored.chunks_exact_mut(3).zip(row.chunks_exact(channels)) {
            stored.copy_from_slice(&pixel[..3]);
        }
        let converted = to_srgb.transform(&stored, &mut srgb);
        converted.map_err(|e| Error::new(ErrorKind::Internal, format!("the colours could not be converted: {e}")))?;
        for (srgb, pixel) in srgb.chunks_exact(3).zip(row.chunks_exact_mut(channels)) {
            pixel.iter_mut().zip(srgb).for_each(|(v, &code)| *v = curve.at(code.max(0.0)));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_add_no_negative_values() {
        let matrix = DMat3::from_cols_array(&[1.2, -0.1, -0.1, -0.1, 1.2, -0.1, -0.1, -0.1, 1.2]);
        let mut image = Image::from_fn(4, 1, |x, _| {
            [[1.0, 0.0, 0.0, 0.5], [0.5; 4], [-1.0, 0.0, 0.0, 1.0], [f32::NAN, 1.0, 1.0, 1.0]][x]
        })
        .unwrap();
        Conversion::linear(matrix).apply(&mut image).unwrap();
        assert_eq!(image.pixel(0, 0), [1.2, 0.0, 0.0, 0.5]);
        assert!(image.pixel(1, 0).iter().all(|v| (v - 0.5).abs() < 1e-6));
        assert_eq!(image.pixel(2, 0), [-1.0, 0.1, 0.1, 1.0]);
        assert!(image.pixel(3, 0)[..3].iter().all(|v| v.is_nan()));
    }
}
