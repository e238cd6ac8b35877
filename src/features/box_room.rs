//! A room as a box around the camera, aligned with the room's axes.

use crate::geometry::Perspective;
use crate::geometry::perspective::{HORIZONTAL_A, HORIZONTAL_B, VERTICAL};
use glam::{DMat3, DVec2, DVec3};

/// The faces of the box, in the order of [`Layout::sides`], the back wall last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    Left,
    Right,
    Ceiling,
    Floor,
    Back,
}

impl Face {
    pub const COUNT: usize = 5;
    pub const ALL: [Self; Self::COUNT] = [Self::Left, Self::Right, Self::Ceiling, Self::Floor, Self::Back];

    /// Returns the room axis along the face's normal.
    pub fn axis(self) -> usize {
        match self {
            Self::Left | Self::Right => HORIZONTAL_A,
            Self::Ceiling | Self::Floor => VERTICAL,
            Self::Back => HORIZONTAL_B,
        }
    }

    /// Returns the unit normal into the room, in room axes.
    pub fn normal(self) -> DVec3 {
        match self {
            Self::Left => DVec3::X,
            Self::Right => DVec3::NEG_X,
            Self::Ceiling => DVec3::Y,
            Self::Floor => DVec3::NEG_Y,
            Self::Back => DVec3::NEG_Z,
        }
    }
}

/// A box room around the camera, in units of the distance to its back wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Distances, all > 0, to the left wall, the right wall, the ceiling and the floor.
    pub sides: [f64; 4],
    /// Agreement of the segments with the box, in `[-1.5, 3]`. It is 1 if all segments lie on faces that can contain
    /// them, and higher if segments also lie on seams, the edges at which two faces meet.
    pub score: f64,
    /// Confidence in the box as a whole, in `[0, 1]`. It rises with the number of segments, and with the lead of the
    /// box over the best clearly different box. The lead is a difference of scores in which, unlike in `score`, the
    /// strokes and the prior of the sides count as well.
    pub trust: f64,
}

/// Returns the room's axes as columns in camera space. If the room's z axis points backwards, x and z are negated: z
/// then points into the photo, x to the right, and the vertical axis is unchanged.
pub fn facing_axes(perspective: &Perspective) -> DMat3 {
    let axes = perspective.axes;
    if axes.z_axis.z >= 0.0 { axes } else { DMat3::from_cols(-axes.x_axis, axes.y_axis, -axes.z_axis) }
}

/// Returns the two faces that a ray from the camera meets first, each with `1/t`, where the ray meets the plane of the
/// face at the point `t ray`. `ray` is in the axes of [`facing_axes`].
pub fn faces(sides: &[f64; 4], ray: DVec3) -> [(Face, f64); 2] {
    let x = if ray.x < 0.0 { (Face::Left, -ray.x / sides[0]) } else { (Face::Right, ray.x / sides[1]) };
    let y = if ray.y < 0.0 { (Face::Ceiling, -ray.y / sides[2]) } else { (Face::Floor, ray.y / sides[3]) };
    let z = (Face::Back, ray.z.max(0.0));
    // Inside a convex room, the ray hits the face with the largest 1/t.
    let (high, low) = if x.1 >= y.1 { (x, y) } else { (y, x) };
    if z.1 >= high.1 {
        [z, high]
    } else if z.1 >= low.1 {
        [high, z]
    } else {
        [high, low]
    }
}

/// A room that is enlarged until a face contains given points becomes larger than necessary by this factor. The face
/// then reaches beyond these points, and surrounds lamps that lie there. [convention]
const MARGIN: f64 = 1.05;

/// A face of the room is common to a set of pixels if at least this fraction of them lies on it. [convention]
const SHARED: f64 = 0.9;

impl Layout {
    /// Returns the face on which most of the given pixels lie.
    pub(super) fn face_of(&self, perspective: &Perspective, pixels: impl Iterator<Item = DVec2>) -> Face {
        self.most_common_face(perspective, pixels).0
    }

    /// Returns the face on which nearly all of the given pixels lie; `None` if there is no such face.
    pub(super) fn shared_face(&self, perspective: &Perspective, pixels: impl Iterator<Item = DVec2>) -> Option<Face> {
        let (face, share) = self.most_common_face(perspective, pixels);
        (share >= SHARED).then_some(face)
    }

    /// Returns the face on which most of the given pixels lie, and the share of the pixels that lie on it.
    fn most_common_face(&self, perspective: &Perspective, pixels: impl Iterator<Item = DVec2>) -> (Face, f64) {
        let to_room = facing_axes(perspective).transpose();
        let mut counts = [0usize; Face::COUNT];
        pixels.for_each(|p| counts[self.hit(to_room * perspective.ray(p)).0 as usize] += 1);
        let fullest = (0..Face::COUNT).rev().max_by_key(|&k| counts[k]).unwrap_or(0);
        (Face::ALL[fullest], counts[fullest] as f64 / counts.iter().sum::<usize>().max(1) as f64)
    }

    /// Moves the other faces of the room away until all given pixels lie on `face`, which keeps its place. Returns the
    /// new room, and the largest factor by which a face has moved away. Pixels whose rays do not meet the plane of
    /// `face` are ignored.
    pub(super) fn enlarged(
        &self,
        face: Face,
        perspective: &Perspective,
        pixels: impl Iterator<Item = DVec2>,
    ) -> (Self, f64) {
        let to_room = facing_axes(perspective).transpose();
        let [mut left, mut right, mut top, mut bottom] = self.sides;
        let mut back = 1.0f64;
        let distance = if face == Face::Back { 1.0 } else { self.sides[face as usize] };
        for pixel in pixels {
            let ray = to_room * perspective.ray(pixel);
            let at = ray * (distance / -ray.dot(face.normal()));
            if !(at.is_finite() && at.dot(ray) > 0.0) {
                continue;
            }
            let at = at * MARGIN;
            if face.axis() != HORIZONTAL_A {
                (left, right) = (left.max(-at.x), right.max(at.x));
            }
            if face.axis() != VERTICAL {
                (top, bottom) = (top.max(-at.y), bottom.max(at.y));
            }
            if face.axis() != HORIZONTAL_B {
                back = back.max(at.z);
            }
        }
        let sides = [left, right, top, bottom];
        let growth = sides.iter().zip(self.sides).map(|(new, old)| new / old).fold(back, f64::max);
        // Rescale the room, so that the back wall is at distance one.
        (Self { sides: sides.map(|side| side / back), ..*self }, growth)
    }

    /// Returns the face seen along a ray in the axes of [`facing_axes`], and `1/t`, where the ray meets the face at the
    /// point `t ray`.
    pub fn hit(&self, ray: DVec3) -> (Face, f64) {
        faces(&self.sides, ray)[0]
    }
}
