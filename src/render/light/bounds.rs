//! Bounds of where lights are, which way they shine and how strongly, and what that can mean to a receiver.
//!
//! The importance of a cluster is its intensity times the largest cosine at the emitters and at the receiver, over the
//! squared distance (Conty Estevez and Kulla 2018, "Importance sampling of many lights with adaptive tree splitting",
//! section 4). It is never 0 where any light of the cluster could arrive.

use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// A point of a surface that is to be lit.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    pub position: Vec3,
    /// Unit, on the side that is lit.
    pub normal: Vec3,
}

/// Where and how one light or several shine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
    /// Unit, or 0 where `reach` is all there is; no light goes farther than `reach` (radians) off it. Reaching 90 degrees,
    /// the intensity falls with the cosine; reaching farther, it is full up to 90 degrees less.
    pub axis: Vec3,
    pub cone_angle: f32,
    /// Whether every light shines backwards as well.
    pub two_sided: bool,
    /// Sum of luminous intensities along the axis in cd, mean of the channels.
    pub intensity: f32,
}

/// Reaching all directions at full intensity.
const FULL_SPHERE: f32 = PI + FRAC_PI_2;

impl Bounds {
    /// A flat surface with some of its points, which enclose it.
    pub fn of_surface(points: impl IntoIterator<Item = Vec3>, normal: Vec3, two_sided: bool, intensity: f32) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for point in points {
            (low, high) = (low.min(point), high.max(point));
        }
        Self { low, high, axis: normal, cone_angle: FRAC_PI_2, two_sided, intensity }
    }

    pub fn of_point(position: Vec3, intensity: f32) -> Self {
        Self { low: position, high: position, axis: Vec3::ZERO, cone_angle: FULL_SPHERE, two_sided: false, intensity }
    }

    /// A point that shines up to an angle off its axis.
    pub fn of_cone(position: Vec3, axis: Vec3, angle: f32, intensity: f32) -> Self {
        Self { axis, cone_angle: angle, ..Self::of_point(position, intensity) }
    }

    /// Bounds of all the lights of several bounds, at least one.
    pub fn union(parts: &[Self]) -> Self {
        let mut whole = parts[0];
        // Axes by intensity; those of two-sided lights are known up to their sign.
        let mut sum = Vec3::ZERO;
        whole.intensity = 0.0;
        for part in parts {
            whole.low = whole.low.min(part.low);
            whole.high = whole.high.max(part.high);
            whole.two_sided &= part.two_sided;
            whole.intensity += part.intensity;
            let flipped = part.two_sided && sum.dot(part.axis) < 0.0;
            sum += if flipped { -part.axis } else { part.axis } * part.intensity;
        }
        whole.axis = sum.normalize_or_zero();
        whole.cone_angle = 0.0;
        for part in parts {
            let cosine = whole.axis.dot(part.axis);
            let cosine = if whole.two_sided { cosine.abs() } else { cosine };
            let one_way = whole.two_sided || !part.two_sided;
            // Axes that agree up to rounding are the same: flat clusters are the common case.
            let angle = if cosine > 1.0 - 1e-6 { 0.0 } else { cosine.clamp(-1.0, 1.0).acos() };
            whole.cone_angle =
                whole.cone_angle.max(if one_way { angle + part.cone_angle } else { FULL_SPHERE }).min(FULL_SPHERE);
        }
        if whole.axis == Vec3::ZERO {
            whole.cone_angle = FULL_SPHERE;
        }
        whole
    }

    /// Whether two lights mean the same to every receiver, but for how strong they are.
    pub fn differs_only_in_intensity(&self, other: &Self) -> bool {
        Self { intensity: 0.0, ..*self } == Self { intensity: 0.0, ..*other }
    }

    pub fn centre(&self) -> Vec3 {
        // Halved first, so that nothing overflows.
        self.low * 0.5 + self.high * 0.5
    }

    pub fn radius(&self) -> f32 {
        (self.high - self.centre()).length()
    }
}

/// How many bounds are weighed at once.
pub const LANES: usize = 8;
type Lanes = [f32; LANES];

/// Bounds of several clusters, laid out so that they are weighed at once. Lanes without light have no intensity.
#[derive(Clone)]
#[repr(align(32))]
pub struct BoundsLanes {
    centre: [Lanes; 3],
    /// Half of the box, widened by what rounding can move a point.
    half: [Lanes; 3],
    /// Reciprocal of the squared distance from the centre to a corner.
    inverse_square: Lanes,
    axis: [Lanes; 3],
    /// How far the box reaches along the axis, or in any direction where the axis is not all.
    box_extent: Lanes,
    /// -1 for two-sided lights, else 1.
    back_sign: Lanes,
    /// Sine and cosine of `reach` less 90 degrees, and the cosine from which on the intensity is full.
    cone_rotation: [Lanes; 2],
    full_cosine: Lanes,
    intensity: Lanes,
}

/// What remains of cosines that may be 0 but for rounding.
const MARGIN: f32 = 1e-4;

impl BoundsLanes {
    /// `scale` is multiplied to the intensities.
    pub fn new(bounds: impl IntoIterator<Item = Bounds>, scale: f32) -> Self {
        let zero = [0.0; LANES];
        let mut lanes = Self {
            centre: [zero; 3],
            half: [zero; 3],
            inverse_square: zero,
            axis: [zero; 3],
            box_extent: zero,
            back_sign: [1.0; LANES],
            cone_rotation: [zero; 2],
            full_cosine: zero,
            intensity: zero,
        };
        for (i, b) in bounds.into_iter().take(LANES).enumerate() {
            let centre = b.centre();
            let rounding = b.low.abs().max(b.high.abs()).max_element() * (1.0 / (1 << 22) as f32);
            let half = b.high - centre + rounding;
            for axis in 0..3 {
                lanes.centre[axis][i] = centre[axis];
                lanes.half[axis][i] = half[axis];
                lanes.axis[axis][i] = b.axis[axis];
            }
            lanes.inverse_square[i] = half.length_squared().max(f32::MIN_POSITIVE).recip();
            let flat = b.cone_angle == FRAC_PI_2;
            lanes.box_extent[i] = if flat { half.dot(b.axis.abs()) } else { half.length() };
            lanes.back_sign[i] = if b.two_sided { -1.0 } else { 1.0 };
            let (sine, cosine) = if flat { (0.0, 1.0) } else { (b.cone_angle - FRAC_PI_2).sin_cos() };
            lanes.cone_rotation[0][i] = sine;
            lanes.cone_rotation[1][i] = cosine;
            let narrow = b.cone_angle < FRAC_PI_2;
            lanes.full_cosine[i] = if narrow { 2.0 } else { cosine };
            // Narrow cones are to count in full on their axis.
            lanes.intensity[i] = b.intensity * scale / if narrow { cosine.max(0.05) } else { 1.0 };
        }
        lanes
    }

    /// The importance of each cluster to a receiver. Nearer than `nearest` (squared, positive) counts as that far.
    pub fn importance(&self, receiver: &Receiver, nearest: f32) -> Lanes {
        let (p, n, m) = (receiver.position, receiver.normal, receiver.normal.abs());
        // Lane by lane without branches, for the compiler to do at once.
        let mut importance = [0.0; LANES];
        for i in 0..LANES {
            let d = [self.centre[0][i] - p.x, self.centre[1][i] - p.y, self.centre[2][i] - p.z];
            let squared = larger(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], nearest);
            let inverse = 1.0 / squared.sqrt();
            // The largest cosine at any emitter: of the angle less `reach` and more 90 degrees, widened by the box.
            let cosine = -(self.axis[0][i] * d[0] + self.axis[1][i] * d[1] + self.axis[2][i] * d[2]) * inverse;
            let cosine = larger(cosine, cosine * self.back_sign[i]);
            let sine = larger(1.0 - cosine * cosine, 0.0).sqrt();
            let turned = cosine * self.cone_rotation[1][i] + sine * self.cone_rotation[0][i];
            let turned = if cosine >= self.full_cosine[i] { 1.0 } else { turned };
            let emitted = turned + self.box_extent[i] * inverse;
            // The largest cosine at the receiver.
            let reached = n.x * d[0] + n.y * d[1] + n.z * d[2];
            let widened = m.x * self.half[0][i] + m.y * self.half[1][i] + m.z * self.half[2][i];
            let received = (reached + widened) * inverse;
            let over_square = smaller(inverse * inverse, self.inverse_square[i]);
            importance[i] = self.intensity[i] * within(emitted) * within(received) * over_square;
        }
        importance
    }
}

/// A bound of a cosine: at most 1, and 0 only where it is clearly negative.
fn within(cosine: f32) -> f32 {
    let positive = smaller(larger(cosine, MARGIN), 1.0);
    if cosine < -MARGIN { 0.0 } else { positive }
}

fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
