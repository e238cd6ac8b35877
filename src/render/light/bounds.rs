//! Bounds of the positions, directions and intensities of lights, and the importance of a cluster of lights for a
//! receiver.
//!
//! The importance of a cluster is its intensity times bounds of the cosines at the emitters and at the receiver,
//! divided by the squared distance (Conty Estevez and Kulla 2018, "Importance sampling of many lights with adaptive
//! tree splitting", section 4). It is never 0 where light of the cluster could arrive.

use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// A surface point that receives light.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    pub position: Vec3,
    /// Unit normal of the lit side.
    pub normal: Vec3,
}

/// Bounds of one light or of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
    /// Unit axis of the emission, or 0 if `cone_angle` covers all directions. The intensity vanishes beyond
    /// `cone_angle` (radians) from the axis. Within cone_angle - 90° of the axis, the intensity may be full. At a
    /// larger angle θ from the axis, it is at most cos(θ + 90° - cone_angle) times full intensity: with a cone angle of
    /// 90° it falls with the cosine.
    pub axis: Vec3,
    pub cone_angle: f32,
    /// Whether every light also emits backwards.
    pub two_sided: bool,
    /// Sum of the luminous intensities along the axis in cd, mean of the channels.
    pub intensity: f32,
}

/// The cone angle of a light with full intensity in all directions. [convention]
const FULL_SPHERE: f32 = PI + FRAC_PI_2;

impl Bounds {
    /// A flat surface; `points` must enclose it.
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

    /// A point light that emits up to an angle off its axis.
    pub fn of_cone(position: Vec3, axis: Vec3, angle: f32, intensity: f32) -> Self {
        Self { axis, cone_angle: angle, ..Self::of_point(position, intensity) }
    }

    /// Bounds of all `parts` together; there must be at least one part.
    pub fn union(parts: &[Self]) -> Self {
        let mut whole = parts[0];
        // Average the axes by intensity; the axes of two-sided lights have an arbitrary sign.
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
            // Treat axes that agree up to rounding as equal: flat clusters are the common case.
            let angle = if cosine > 1.0 - 1e-6 { 0.0 } else { cosine.clamp(-1.0, 1.0).acos() };
            whole.cone_angle =
                whole.cone_angle.max(if one_way { angle + part.cone_angle } else { FULL_SPHERE }).min(FULL_SPHERE);
        }
        if whole.axis == Vec3::ZERO {
            whole.cone_angle = FULL_SPHERE;
        }
        whole
    }

    /// Whether two lights have the same importance for every receiver, up to a factor.
    pub fn differs_only_in_intensity(&self, other: &Self) -> bool {
        Self { intensity: 0.0, ..*self } == Self { intensity: 0.0, ..*other }
    }

    pub fn centre(&self) -> Vec3 {
        // Halve before adding, so that the sum cannot overflow.
        self.low * 0.5 + self.high * 0.5
    }

    pub fn radius(&self) -> f32 {
        (self.high - self.centre()).length()
    }
}

/// Number of bounds evaluated together, one per SIMD lane. [convention]
pub const LANES: usize = 8;
type Lanes = [f32; LANES];

/// Bounds of several clusters in structure-of-arrays layout. Empty lanes have zero intensity.
#[derive(Clone)]
#[repr(align(32))]
pub struct BoundsLanes {
    centre: [Lanes; 3],
    /// Half the size of the box, widened by the rounding error of a point.
    half: [Lanes; 3],
    /// Reciprocal of the squared distance from the centre to a corner.
    inverse_square: Lanes,
    axis: [Lanes; 3],
    /// Half-extent of the box along the axis; the radius of the box if the cone angle is not 90°.
    box_extent: Lanes,
    /// -1 for two-sided lights, else 1.
    back_sign: Lanes,
    /// Sine and cosine of `cone_angle` - 90°, and the smallest cosine of full intensity.
    cone_rotation: [Lanes; 2],
    full_cosine: Lanes,
    intensity: Lanes,
}

/// A cosine may be positive if its bound is above minus this margin, because of rounding. [rounding]
const MARGIN: f32 = 1e-4;

impl BoundsLanes {
    /// `scale` multiplies the intensities.
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
            // Normalise narrow cones to full intensity on their axis.
            lanes.intensity[i] = b.intensity * scale / if narrow { cosine.max(0.05) } else { 1.0 };
        }
        lanes
    }

    /// The importance of each cluster for a receiver. `nearest` (squared, positive) is the smallest distance that
    /// counts.
    pub fn importance(&self, receiver: &Receiver, nearest: f32) -> Lanes {
        let (p, n, m) = (receiver.position, receiver.normal, receiver.normal.abs());
        // Evaluate lane by lane without branches, so that the compiler can vectorise.
        let mut importance = [0.0; LANES];
        for i in 0..LANES {
            let d = [self.centre[0][i] - p.x, self.centre[1][i] - p.y, self.centre[2][i] - p.z];
            let squared = larger(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], nearest);
            let inverse = 1.0 / squared.sqrt();
            // Bound the cosine at the emitters: the angle to the axis minus `cone_angle` plus 90°, widened by the box.
            let cosine = -(self.axis[0][i] * d[0] + self.axis[1][i] * d[1] + self.axis[2][i] * d[2]) * inverse;
            let cosine = larger(cosine, cosine * self.back_sign[i]);
            let sine = larger(1.0 - cosine * cosine, 0.0).sqrt();
            let turned = cosine * self.cone_rotation[1][i] + sine * self.cone_rotation[0][i];
            let turned = if cosine >= self.full_cosine[i] { 1.0 } else { turned };
            let emitted = turned + self.box_extent[i] * inverse;
            // Bound the cosine at the receiver.
            let reached = n.x * d[0] + n.y * d[1] + n.z * d[2];
            let widened = m.x * self.half[0][i] + m.y * self.half[1][i] + m.z * self.half[2][i];
            let received = (reached + widened) * inverse;
            let over_square = smaller(inverse * inverse, self.inverse_square[i]);
            importance[i] = self.intensity[i] * clamp_cosine(emitted) * clamp_cosine(received) * over_square;
        }
        importance
    }
}

/// Clamps the bound of a cosine to [`MARGIN`, 1]; 0 only where it is clearly negative.
fn clamp_cosine(cosine: f32) -> f32 {
    let positive = smaller(larger(cosine, MARGIN), 1.0);
    if cosine < -MARGIN { 0.0 } else { positive }
}

fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
