//! Enlarges a laid-out room until the face that carries the lamps also contains lamps that lie beyond it.

use super::box_room::Layout;
use crate::geometry::Perspective;
use crate::image::Image;
use glam::DVec2;

/// Maximum factor by which a room may be enlarged to contain lamps beyond it. If a larger factor is necessary, the room
/// stays as it is. `MAX_GROWTH_OF_ROWS` applies if all these lamps continue regular rows, `MAX_GROWTH_UNCERTAIN` if the
/// room layout is uncertain: if strokes for the plane are missing, or if the photo's lines do not determine the camera.
/// [bench photos:tune, photos:real]
const MAX_GROWTH: f64 = 1.25;
const MAX_GROWTH_OF_ROWS: f64 = 2.0;
const MAX_GROWTH_UNCERTAIN: f64 = 4.0;

/// A region like a lamp beyond the face that carries the lamps.
#[derive(Clone, Copy, Debug)]
pub struct RegionBeyond<'a> {
    /// Its pixels, as row-major indices.
    pub pixels: &'a [u32],
    /// Whether it continues a regular row of lamps.
    pub is_in_regular_row: bool,
}

/// The lamps of a photo, and regions like lamps that lie beyond the face of the room that carries the lamps.
pub struct LampsBeyond<'a> {
    /// Mask of the lamps.
    pub mask: &'a Image,
    /// The regions beyond the face.
    pub beyond: &'a [RegionBeyond<'a>],
    /// Whether the layout of the room is uncertain. It may then be enlarged by a larger factor.
    pub is_uncertain: bool,
    /// Whether to leave out a region that alone would enlarge the room too much: it may be no lamp.
    pub may_leave_out: bool,
}

impl Layout {
    /// Moves the other faces of the room away until the face that carries the lamps contains the regions beyond it.
    /// Leaves out regions that alone would enlarge the room too much, if `lamps.may_leave_out` allows it. If a face
    /// would still have to move too far ([`MAX_GROWTH`]), leaves out all regions that continue no regular row. Returns
    /// the new room and the indices of the regions that it contains; `None` if no region remains, or if a face would
    /// have to move too far.
    pub fn enlarged_for(&self, perspective: &Perspective, lamps: &LampsBeyond) -> Option<(Self, Vec<usize>)> {
        let face = self.face_of(perspective, marked(lamps.mask));
        let enlarged = |regions: &[usize]| {
            let max_growth = match () {
                _ if lamps.is_uncertain => MAX_GROWTH_UNCERTAIN,
                _ if regions.iter().all(|&k| lamps.beyond[k].is_in_regular_row) => MAX_GROWTH_OF_ROWS,
                _ => MAX_GROWTH,
            };
            let pixels =
                regions.iter().flat_map(|&k| lamps.beyond[k].pixels).map(|&p| lamps.mask.centre_of(p as usize));
            let (layout, growth) = self.enlarged(face, perspective, pixels);
            (growth <= max_growth).then_some(layout)
        };
        let mut regions: Vec<usize> = (0..lamps.beyond.len()).collect();
        regions.retain(|&k| !lamps.may_leave_out || enlarged(&[k]).is_some());
        let in_rows: Vec<usize> = regions.iter().copied().filter(|&k| lamps.beyond[k].is_in_regular_row).collect();
        let mut choices = [regions, in_rows].into_iter().filter(|regions| !regions.is_empty());
        choices.find_map(|regions| Some((enlarged(&regions)?, regions)))
    }

    /// Returns the indices of the two room axes along the face that holds nearly all pixels of a mask; `None` if there
    /// is no such face.
    pub fn axes_along(&self, perspective: &Perspective, mask: &Image) -> Option<[usize; 2]> {
        let normal = self.shared_face(perspective, marked(mask))?.axis();
        Some([(normal + 1) % 3, (normal + 2) % 3])
    }
}

/// Centres of the pixels of a mask.
fn marked(mask: &Image) -> impl Iterator<Item = DVec2> {
    (0..mask.data.len()).filter(|&p| mask.data[p] > 0.5).map(|p| mask.centre_of(p))
}
