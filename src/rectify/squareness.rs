//! Measures how far the angles between the room's directions deviate from right angles, where each direction is
//! estimated from its own lines alone.
//!
//! Deviations reveal walls that are not at right angles, non-square pixels and a wrong principal point. Non-square
//! pixels stay hidden in photos where two directions run parallel to the image sides: any pixel aspect ratio then
//! agrees with the lines.

use super::focal::FocalPrior;
use super::sphere::Refined;
use crate::maths;
use glam::DVec3;

/// How far the angle between two directions deviates from a right angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Squareness {
    /// Deviation in radians: > 0 where the angle between the axes is obtuse.
    pub angle: f64,
    /// Standard deviation of `angle`, in radians.
    pub error: f64,
}

/// The angle between two of the three directions, at the focal length with which the directions were estimated.
struct Pair {
    /// Index of the third direction, which is not part of the pair.
    beside: usize,
    /// Cosine of the angle between the two directions (`cosine`), its derivative with respect to the logarithm of the
    /// focal length (`slope`), and its variance (`variance`).
    cosine: f64,
    slope: f64,
    variance: f64,
}

impl Pair {
    fn new(beside: usize, a: &Refined, b: &Refined) -> Self {
        let (p, q) = (a.direction, b.direction);
        let cosine = p.dot(q);
        let slope = 2.0 * p.z * q.z - cosine * (p.z * p.z + q.z * q.z);
        let along = |r: &Refined, other: DVec3| other.dot(r.covariance * other);
        Self { beside, cosine, slope, variance: along(a, q) + along(b, p) }
    }

    /// Treats the pair as a measurement of the logarithm of the focal length, under the assumption that the true angle
    /// is a right angle. Returns the inverse variance of this measurement, and the inverse variance times the measured
    /// change of the logarithm.
    fn focal_constraint(&self) -> [f64; 2] {
        let weight = 1.0 / self.variance.max(1e-24);
        [weight * self.slope * self.slope, -weight * self.cosine * self.slope]
    }
}

/// Returns for each axis how far the angle between the two other axes deviates from a right angle; `None` if one of
/// the two is unknown. Each direction must point the same way as its axis.
///
/// `focal` is the focal length in pixels with which the directions were estimated; `is_given` tells whether the user
/// gave it. If not, each angle is evaluated at the focal length that the other angles and the prior `expected` imply.
pub fn measure(
    directions: &[Option<Refined>; 3],
    focal: f64,
    is_given: bool,
    expected: FocalPrior,
) -> [Option<Squareness>; 3] {
    let pair = |beside: usize| {
        let [a, b] = [(beside + 1) % 3, (beside + 2) % 3].map(|k| directions[k].as_ref());
        a.zip(b).map(|(a, b)| Pair::new(beside, a, b))
    };
    let pairs = [0, 1, 2].map(pair);
    let weight = maths::powi(expected.spread, -2);
    let prior = [weight, maths::ln(expected.focal / focal) * weight];
    pairs.each_ref().map(|pair| {
        let pair = pair.as_ref()?;
        let [growth, variance] = if is_given {
            [0.0, 0.0]
        } else {
            let others = pairs.iter().flatten().filter(|p| p.beside != pair.beside).map(Pair::focal_constraint);
            let [information, pull] =
                others.fold(prior, |sum, constraint| [sum[0] + constraint[0], sum[1] + constraint[1]]);
            [pull / information, 1.0 / information]
        };
        let cosine = (pair.cosine + pair.slope * growth).clamp(-1.0, 1.0);
        let error = (pair.variance + pair.slope * pair.slope * variance).sqrt();
        Some(Squareness { angle: -maths::asin(cosine), error })
    })
}
