//! The truth about a photo, as far as it is known: where its lamps are in the photo and in their plane.

use super::masks::Mask;
use super::shapes::Lamps;
use glam::DVec2;
use luxfer::geometry::Homography;
use luxfer::image::Image;
use luxfer::segment::StrokeSet;
use std::sync::Arc;

/// A photo with its strokes and its truth.
#[derive(Clone)]
pub struct Photo {
    pub name: String,
    /// Linear RGB, 1 = display white.
    pub image: Arc<Image>,
    pub strokes: StrokeSet,
    pub truth: Truth,
}

/// Removes the strokes of a photo, so that the library proposes its masks.
pub fn remove_strokes(photo: &mut Photo) {
    photo.strokes = StrokeSet::default();
}

/// A lamp in a photo.
#[derive(Clone, Debug)]
pub struct Lamp {
    /// Centre in photo pixels.
    pub centre: DVec2,
    pub polygons: Vec<Vec<DVec2>>,
    /// Pixels of the lamp (`y * width + x`); empty if they are not known one by one.
    pub pixels: Vec<u32>,
}

#[derive(Clone, Debug)]
pub struct Truth {
    /// Pixels of all lamps.
    pub lights: Mask,
    /// Pixels of lamps that no list contains: there a mask of lights counts neither as right nor as wrong.
    pub unlisted: Option<Mask>,
    /// Pixels of the plane with its lamps, if known.
    pub plane: Option<Mask>,
    /// Pixels that may count as plane or not, such as beams under a ceiling.
    pub either: Option<Mask>,
    pub lamps: Vec<Lamp>,
    /// Centres of lamps of which only the centre is listed: parts of a mask there count neither as right nor as wrong.
    pub centres: Vec<DVec2>,
    /// The lamps in their plane, if the camera is known; the unit of length is the distance of the camera from the
    /// plane.
    pub layout: Option<Lamps>,
    /// Distance of the camera from the plane in metres, if known.
    pub distance: Option<f64>,
    /// Homography from the plane of `layout` to photo pixels.
    pub to_photo: Option<Homography>,
    /// Whether the photo has no pattern of lamps, so that a run should end in an error or warn.
    pub is_trap: bool,
    /// Whether the lamps of the photo lie on no plane or shine away from the camera, so that a run may report that its
    /// texture should not be used.
    pub may_decline: bool,
}
