//! Chooses the size of the pattern and of the texels on a surface.

use super::camera_distance::CameraDistance;
use super::measure::{Measurements, measure};
use super::params::{Input, Params, SCALES};
use crate::error::{Error, Result};
use crate::job::Job;
use glam::DVec2;

/// The length that determines the size of the pattern on the surface. Lengths are in metres, in `[1e-6, 1e6]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// The distance of the photo's camera from the lit plane: a given distance, or an estimate from the lamps.
    Distance,
    /// The length of the longer side of a lamp (the median over the photo's lamps).
    Lamp(f64),
    /// The shorter period of the lamps' lattice; without a lattice, the median distance from a lamp to its nearest
    /// neighbour.
    Spacing(f64),
    /// The width of the surface: the plane in the photo is scaled to this width, so that the surface has as many lamps
    /// side by side as the plane in the photo.
    Across,
}

/// A lamp counts as rectangular if it covers more than this share of its bounding box. The limit lies halfway between
/// the share of a disc, π/4, and the share of a rectangle, 1. [convention]
const MIN_FILL: f64 = f64::midpoint(std::f64::consts::FRAC_PI_4, 1.0);

/// Maximum ratio of the surface's length to the length of the plane in the photo, for example 600 m to 6 m. Beyond
/// this ratio, the pattern is refused if the plane also spans fewer than `MIN_SHOWN_TEXELS` texels. [convention]
const MAX_REPEATS: f64 = 100.0;

/// Minimum number of texels along the plane in the photo: enough to show two lamps with a gap beside each. With fewer
/// texels, no pattern would be visible. [convention]
const MIN_SHOWN_TEXELS: f64 = 4.0;

/// The size of the pattern, given by the size of an unwarped pixel on the surface.
pub struct Sizing {
    /// Metres per unwarped pixel.
    pub pixel: f64,
    /// The distance of the photo's camera from the lit plane. `pixel` is in proportion to it.
    pub distance: CameraDistance,
    /// The measured sizes of the exemplar's lamps; `None` if the size of the pattern does not depend on them.
    pub measured: Option<Measurements>,
}

/// The texels of the surface.
pub struct TexelGrid {
    pub width: usize,
    pub height: usize,
    /// Unwarped pixels per texel.
    pub scale: f64,
    /// Number of texels per metre along u and along v.
    pub texels_per_metre: DVec2,
}

impl Sizing {
    /// Computes the size of an unwarped pixel on the surface, in metres.
    ///
    /// - `pixel`: this size divided by the distance of the photo's camera from the lit plane.
    /// - `plane_distance`: the distance of the camera from the lit plane, in metres. Only [`Scale::Distance`] uses it;
    ///   if it is 0, the distance is estimated from the lamps. The other scales compute the distance from the length
    ///   that they give.
    /// - `surface_width`: the width of the surface in metres. Only [`Scale::Across`] uses it.
    pub fn new(
        scale: Scale,
        (pixel, plane_distance): (f64, f64),
        (exemplar, params): (&Input, &Params),
        surface_width: f64,
        job: Job,
    ) -> Result<Self> {
        if scale == Scale::Distance && plane_distance > 0.0 {
            let distance = CameraDistance::exact(plane_distance);
            return Ok(Self { pixel: pixel * plane_distance, distance, measured: None });
        }
        let measured = measure(exemplar, params, job)?;
        let per_length = |metres: f64, pixels: f64, name: &str| match pixels > 0.0 {
            true => Ok(CameraDistance::exact(metres / pixels / pixel)),
            false => Err(Error::degenerate(format!(
                "the pattern cannot be scaled by {name}: the photo shows too few whole ones; scale it by the distance"
            ))),
        };
        let distance = match scale {
            Scale::Distance => {
                // Estimate the distance from rectangular lamps only, because round lamps come in no usual sizes. Sides
                // of 0 stand for "no rectangular lamp".
                let is_rectangle = measured.lamp_fill > MIN_FILL;
                CameraDistance::of_lamps(measured.lamp_sides.map(|side| if is_rectangle { side * pixel } else { 0.0 }))
            }
            Scale::Lamp(metres) => per_length(metres, measured.lamp_sides[0], "its lamps")?,
            Scale::Spacing(metres) => per_length(metres, measured.spacing, "the spacing of its lamps")?,
            Scale::Across => per_length(surface_width, measured.width, "its width")?,
        };
        Ok(Self { pixel: pixel * distance.metres, distance, measured: Some(measured) })
    }
}

impl TexelGrid {
    /// Chooses the size and the number of the texels on a surface of `size` metres. The longer side of the unwarped
    /// photo has `pixels` pixels of `pixel` metres each. Let min be the longer side of the surface divided by
    /// `max_texels`. The size of a texel is
    /// - `texel_size`, if it is not 0; if it is smaller than min, an error is returned;
    /// - else the larger of `pixel` and min.
    pub fn new(size: DVec2, (pixels, pixel): (usize, f64), texel_size: f64, max_texels: usize) -> Result<Self> {
        let min = size.max_element() / max_texels as f64;
        if texel_size > 0.0 && texel_size < min * (1.0 - 1e-9) {
            return Err(Error::argument(format!(
                "pattern.texel_size is {} m; with max_texels = {max_texels} on a surface {} m long it must be at least {min}",
                texel_size,
                size.max_element()
            )));
        }
        let texel = if texel_size > 0.0 { texel_size } else { pixel.max(min) };
        // Refuse scales outside the range of the synthesis, with a message that names the cause. Also refuse a pattern
        // that the texels cannot show, because its synthesis would take minutes.
        let (surface_length, shown) = (size.max_element(), pixels as f64 * pixel);
        let is_lost = surface_length > MAX_REPEATS * shown && texel * MIN_SHOWN_TEXELS > shown;
        if is_lost || !SCALES.contains(&(texel / pixel)) {
            return Err(Error::argument(format!(
                "the surface is {surface_length} m long and the plane in the photo {shown:.3e} m, so that texels of \
                 {texel:.3e} m cannot show its pattern: check the unit of the scene (luxfer_scene_load_params.unit), \
                 plane_distance and the settings of the pattern, or raise max_texels"
            )));
        }
        let count = |length: f64| ((length / texel).round() as usize).clamp(1, max_texels);
        let (width, height) = (count(size.x), count(size.y));
        let texels_per_metre = DVec2::new(width as f64, height as f64) / size;
        Ok(Self { width, height, scale: texel / pixel, texels_per_metre })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_in_another_unit_is_named_as_the_cause() {
        // A surface of 8 m is given in millimetres and read as 8000 m. The scale is outside the range of the synthesis
        // for pixels of 2 mm, and inside it for pixels of 2 cm. Both must be refused.
        for pixel in [0.002, 0.02] {
            let grid = |size, max| TexelGrid::new(size, (500, pixel), 0.0, max).map(|_| ());
            let error = grid(DVec2::new(8000.0, 6000.0), 2048).unwrap_err();
            assert!(error.message.contains("8000 m long") && error.message.contains("unit of the scene"), "{error}");
            assert_eq!(grid(DVec2::new(8.0, 6.0), 2048), Ok(()));
            // A coarse texture for a room of usual size is allowed.
            assert_eq!(grid(DVec2::new(8.0, 6.0), 8), Ok(()));
        }
    }

    #[test]
    fn lamps_keep_their_size_in_metres() {
        // Unwarped pixels measure 2 cm. With 300 × 150 texels, a texel has the size of one pixel; with 100 × 50
        // texels, the size of three.
        let grid = |size, pixel, max| TexelGrid::new(size, (500, pixel), 0.0, max).unwrap();
        let fine = grid(DVec2::new(6.0, 3.0), 0.02, 2048);
        assert_eq!((fine.width, fine.height), (300, 150));
        assert!((fine.scale - 1.0).abs() < 1e-6 && (fine.texels_per_metre.x - 50.0).abs() < 1e-6);
        let coarse = grid(DVec2::new(6.0, 3.0), 0.02, 100);
        assert_eq!((coarse.width, coarse.height), (100, 50));
        assert!((coarse.scale - 3.0).abs() < 1e-6);
        // A surface narrower than half a texel still gets one texel.
        assert_eq!(grid(DVec2::new(1e-9, 1.0), 0.01, 64).width, 1);
    }

    #[test]
    fn texels_may_be_given_a_size_within_their_number() {
        let grid = |max| TexelGrid::new(DVec2::new(6.0, 3.0), (500, 0.02), 0.05, max);
        let fine = grid(2048).unwrap();
        assert_eq!((fine.width, fine.height), (120, 60));
        assert!((fine.scale - 2.5).abs() < 1e-6);
        let error = grid(100).err().unwrap();
        assert!(error.message.contains("texel_size is 0.05") && error.message.contains("0.06"), "{}", error.message);
    }
}
