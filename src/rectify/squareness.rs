//! Whether the room stands at right angles, and its pixels are square: how far the angles between its directions are from right
//! ones, where each direction is found on its own lines alone.
//!
//! Walls that meet at other angles show here, and so do pixels that are not square and an axis of the lens that is elsewhere than
//! thought. Not all photos tell: pixels of any shape are right where two directions run along the picture's sides.

use super::camera::Expected;
use super::sphere::Refined;
use glam::DVec3;

/// How far the angle between two directions is from a right one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Squareness {
    /// In radians; > 0 where the angle between the axes is obtuse.
    pub angle: f64,
    /// Standard deviation.
    pub error: f64,
}

/// Two of the directions, under the focal length they were found with.
struct Pair {
    /// The third.
    beside: usize,
    /// Cosine of the angle between them, and its derivative by the logarithm of the focal length.
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

    /// What the pair says of the focal length, if its angle is a right one: information, and that times the logarithm by which the focal length
    /// would have to grow.
    fn of_focal(&self) -> [f64; 2] {
        let weight = 1.0 / self.variance.max(1e-24);
        [weight * self.slope * self.slope, -weight * self.cosine * self.slope]
    }
}

/// For each axis the angle between the two others, of directions that point as the axes do; nothing where one of them is unknown.
///
/// `focal` is the one they were found with, in pixels. Unless it was given, each angle is judged under the focal length that the other
/// angles, and what was expected before, lead one to expect.
pub fn measure(
    directions: &[Option<Refined>; 3],
    focal: f64,
    is_given: bool,
    expected: Expected,
) -> [Option<Squareness>; 3] {
    let pair = |beside: usize| {
        let [a, b] = [(beside + 1) % 3, (beside + 2) % 3].map(|k| directions[k].as_ref());
        a.zip(b).map(|(a, b)| Pair::new(beside, a, b))
    };
    let pairs = [0, 1, 2].map(pair);
    let weight = expected.spread.powi(-2);
    let before = [weight, (expected.focal / focal).ln() * weight];
    pairs.each_ref().map(|pair| {
        let pair = pair.as_ref()?;
        let [growth, variance] = if is_given {
            [0.0, 0.0]
        } else {
            let others = pairs.iter().flatten().filter(|p| p.beside != pair.beside).map(Pair::of_focal);
            let [information, pull] = others.fold(before, |sum, said| [sum[0] + said[0], sum[1] + said[1]]);
            [pull / information, 1.0 / information]
        };
        let cosine = (pair.cosine + pair.slope * growth).clamp(-1.0, 1.0);
        let error = (pair.variance + pair.slope * pair.slope * variance).sqrt();
        Some(Squareness { angle: -cosine.asin(), error })
    })
}
