//! Bounds on the positions, directions and intensities of a cluster of lights, and the cluster's importance for a
//! receiver, by which the light tree selects lights.
//!
//! The importance is the intensity of the cluster, times an upper bound of the cosine at the emitters, times an upper
//! bound of the cosine at the receiver, divided by the squared distance (Conty Estevez and Kulla 2018, "Importance
//! sampling of many lights with adaptive tree splitting", section 4). The importance is never 0 if light of the cluster
//! can reach the receiver.

use crate::maths;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// A surface point that receives light.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    pub position: Vec3,
    /// Unit normal on the side that receives light.
    pub normal: Vec3,
}

/// Bounds of a single light or of a cluster of lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
    /// The cone of the emission: its unit axis (`axis`), and the angle to the axis beyond which no light is emitted
    /// (`cone_angle`, in radians). `axis` is 0 if the light may go in all directions.
    ///
    /// At an angle θ to the axis, the bound on the intensity is `intensity` if θ ≤ `cone_angle` - 90°. Otherwise it is
    /// `intensity` × cos(θ + 90° - `cone_angle`), or 0 if this cosine is negative. A flat surface has a cone angle of
    /// 90°, so that its bound is `intensity` × cos θ. For narrower cones, the bound is scaled such that it is
    /// `intensity` at θ = 0.
    pub axis: Vec3,
    pub cone_angle: f32,
    /// Whether all lights of the cluster also emit on the side of -`axis`.
    pub two_sided: bool,
    /// Sum of the peaks of the lights, in cd. The peak of a light is its largest luminous intensity over all
    /// directions, averaged over the channels.
    pub intensity: f32,
}

/// Cone angle of a light that may have its full intensity in all directions. The intensity is full up to the cone angle
/// minus 90°, so this cone angle is 180° + 90°. [convention]
const FULL_SPHERE: f32 = PI + FRAC_PI_2;

/// Angle in radians by which cones are widened, so that rounding does not put light outside them. [rounding]
pub const CONE_MARGIN: f64 = 0.01;

impl Bounds {
    /// Returns the bounds of a flat emitting surface; `points` are corners of a polygon that encloses it.
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

    /// Returns the bounds of a point light that emits up to `angle` (radians) off its axis.
    pub fn of_cone(position: Vec3, axis: Vec3, angle: f32, intensity: f32) -> Self {
        Self { axis, cone_angle: angle, ..Self::of_point(position, intensity) }
    }

    /// Returns the bounds of all `parts` together; there must be at least one part.
    pub fn union(parts: &[Self]) -> Self {
        let mut whole = parts[0];
        // Average the axes, weighted by intensity. A two-sided light may count with either sign of its axis; take the
        // sign that agrees with the sum so far.
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
            // Take axes that agree up to rounding as equal, because acos magnifies rounding errors near 1. Most
            // clusters are flat, with equal axes.
            let angle = if cosine > 1.0 - 1e-6 { 0.0 } else { maths::acos(cosine.clamp(-1.0, 1.0)) };
            whole.cone_angle =
                whole.cone_angle.max(if one_way { angle + part.cone_angle } else { FULL_SPHERE }).min(FULL_SPHERE);
        }
        if whole.axis == Vec3::ZERO {
            whole.cone_angle = FULL_SPHERE;
        }
        whole
    }

    /// Whether the bounds of two lights are equal except for the intensity. The ratio of the lights' importances is
    /// then the same for every receiver.
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

/// Number of clusters whose importance is computed together, one per SIMD lane. [convention]
pub const LANES: usize = 8;
type Lanes = [f32; LANES];

/// Bounds of up to [`LANES`] clusters in structure-of-arrays layout. Unused lanes have zero intensity.
#[derive(Clone)]
#[repr(align(32))]
pub struct BoundsLanes {
    centre: [Lanes; 3],
    /// Half-extents of the box, widened by the rounding error of its coordinates.
    half: [Lanes; 3],
    /// Upper limit on 1 / squared distance: the reciprocal of the squared half-diagonal of the box. It takes effect for
    /// receivers that are nearer to the centre of the box than the corners are.
    inverse_square: Lanes,
    axis: [Lanes; 3],
    /// Allowance for the extent of the box. Divided by the distance from the receiver to the centre of the box, it is
    /// added to the bound of the cosine at the emitters. The allowance is the half-extent of the box along the axis if
    /// the cone angle is 90°, and half the diagonal of the box otherwise.
    box_extent: Lanes,
    /// -1 for two-sided lights, 1 for all others. Let c be the cosine of the angle between the axis and the direction
    /// to the receiver. The bound is computed from the larger of c and `back_sign` × c, which is |c| for two-sided
    /// lights.
    back_sign: Lanes,
    /// `cone_rotation` holds the sine and the cosine of `cone_angle` - 90°. `full_cosine` is the smallest cosine of the
    /// angle to the axis at which the bound is the full intensity; it is 2, which no cosine reaches, for cone angles
    /// below 90°.
    cone_rotation: [Lanes; 2],
    full_cosine: Lanes,
    intensity: Lanes,
}

/// In a cone narrower than 90°, the bound on the axis is the intensity times cos(90° - `cone_angle`), and the intensity
/// is divided by this cosine, so that the bound on the axis is the full intensity. The divisor is at least this value,
/// which it has for a cone of 2.9°. Light sampling is unbiased for any positive value. [convention]
const MIN_NARROW_COSINE: f32 = 0.05;

/// Computed upper bounds of a cosine are rounded: the true cosine is certainly negative only if its bound is below
/// -`MARGIN`. [rounding]
const MARGIN: f32 = 1e-4;

impl BoundsLanes {
    /// Builds the lanes from at most [`LANES`] bounds, whose intensities are multiplied by `scale`.
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
            let (sine, cosine) = if flat { (0.0, 1.0) } else { maths::sin_cos(b.cone_angle - FRAC_PI_2) };
            lanes.cone_rotation[0][i] = sine;
            lanes.cone_rotation[1][i] = cosine;
            let narrow = b.cone_angle < FRAC_PI_2;
            lanes.full_cosine[i] = if narrow { 2.0 } else { cosine };
            lanes.intensity[i] = b.intensity * scale / if narrow { cosine.max(MIN_NARROW_COSINE) } else { 1.0 };
        }
        lanes
    }

    /// Returns the importance of each cluster for a receiver. A squared distance below `nearest` (in m²) counts as
    /// `nearest`, which must be positive.
    pub fn importance(&self, receiver: &Receiver, nearest: f32) -> Lanes {
        let (p, n, m) = (receiver.position, receiver.normal, receiver.normal.abs());
        // Evaluate all lanes without branches, so that the compiler vectorises the loop.
        let mut importance = [0.0; LANES];
        for i in 0..LANES {
            let d = [self.centre[0][i] - p.x, self.centre[1][i] - p.y, self.centre[2][i] - p.z];
            let squared = larger(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], nearest);
            let inverse = 1.0 / squared.sqrt();
            // Bound the cosine at the emitters. A surface emits up to 90° from its normal, so the normals of a cluster
            // of surfaces lie within α = `cone_angle` - 90° of the axis. θ is the angle between the axis and the
            // direction from the centre of the box to the receiver. If θ ≤ α, a normal may point at the receiver, and
            // the bound is 1. Otherwise, the bound is cos(θ - α). Then add the allowance for the extent of the box to
            // the bound. Point lights have no normal; their `cone_angle` is defined such that the same formula bounds
            // their intensity.
            let cosine = -(self.axis[0][i] * d[0] + self.axis[1][i] * d[1] + self.axis[2][i] * d[2]) * inverse;
            let cosine = larger(cosine, cosine * self.back_sign[i]);
            let sine = larger(1.0 - cosine * cosine, 0.0).sqrt();
            let turned = cosine * self.cone_rotation[1][i] + sine * self.cone_rotation[0][i];
            let turned = if cosine >= self.full_cosine[i] { 1.0 } else { turned };
            let emitted = turned + self.box_extent[i] * inverse;
            // Bound the cosine at the receiver. The component of `d` along the normal is largest at a corner of the
            // box. Divide this component by the distance from the receiver to the centre of the box.
            let reached = n.x * d[0] + n.y * d[1] + n.z * d[2];
            let widened = m.x * self.half[0][i] + m.y * self.half[1][i] + m.z * self.half[2][i];
            let received = (reached + widened) * inverse;
            let over_square = smaller(inverse * inverse, self.inverse_square[i]);
            importance[i] = self.intensity[i] * clamp_cosine(emitted) * clamp_cosine(received) * over_square;
        }
        importance
    }
}

/// Clamps the bound of a cosine to [`MARGIN`, 1]; returns 0 if the cosine is certainly negative.
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
