//! What a photo truly shows, as far as it is known: where its lamps are, and how they lie in their plane.

use super::masks::Mask;
use super::shapes::Lamps;
use glam::DVec2;
use luxfer::geometry::Homography;
use luxfer::image::Image;
use luxfer::segment::StrokeSet;
use std::sync::Arc;

/// A photo with the strokes drawn on it and its truth.
#[derive(Clone)]
pub struct Photo {
    pub name: String,
    /// Linear RGB, 1 = display white.
    pub image: Arc<Image>,
    pub strokes: StrokeSet,
    pub truth: Truth,
}

/// Leaves the masks of a photo to be proposed.
pub fn remove_strokes(photo: &mut Photo) {
    photo.strokes = StrokeSet::default();
}

/// A lamp as the photo shows it.
#[derive(Clone, Debug)]
pub struct Lamp {
    /// In photo pixels.
    pub centre: DVec2,
    pub polygons: Vec<Vec<DVec2>>,
    /// Its pixels (`y * width + x`), where they are known one by one.
    pub pixels: Vec<u32>,
}

#[derive(Clone, Debug)]
pub struct Truth {
    /// Pixels of lamps.
    pub lights: Mask,
    /// Pixels of lamps that are in no list: a mask of lights is judged there neither way.
    pub unlisted: Option<Mask>,
    /// Pixels of the plane with its lamps, where known.
    pub plane: Option<Mask>,
    /// Pixels that may be taken for the plane or not, as of beams under a ceiling.
    pub either: Option<Mask>,
    pub lamps: Vec<Lamp>,
    /// Lamps of which the list gives the centre alone: what a mask holds there is judged neither way.
    pub centres: Vec<DVec2>,
    /// The lamps in their plane, where the camera is known; 1 is the distance of the camera from the plane.
    pub layout: Option<Lamps>,
    /// That distance in metres, where known.
    pub distance: Option<f64>,
    /// From that plane to photo pixels.
    pub to_photo: Option<Homography>,
    /// Whether the photo holds no answer, so that a run should decline or warn.
    pub is_trap: bool,
    /// Whether the lamps of the photo lie on no plane or shine away from the camera, so that a run may decline.
    pub may_decline: bool,
}
