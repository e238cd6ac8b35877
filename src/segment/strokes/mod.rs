//! The strokes that a user paints as examples: pixels that belong, or do not belong, to the plane or the lights.

mod image;
mod text;

pub use image::from_image;
pub use text::parse;

use crate::error::{Error, Result, check_range};
use crate::image::{Image, reserve_capacity, try_collect};
use glam::DVec2;

/// Pixels of plane strokes count as lamp if they are at least as bright as this quantile of L* under the positive
/// light strokes. The quantile ignores the darkest quarter, because hurried strokes run over the edges of lamps.
/// [judged on 36 photos]
const LIT: f64 = 0.25;

/// One brush stroke: the pixels that it covers (`y * width + x`), and whether they are positive or negative examples.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    pub pixels: Vec<u32>,
    pub positive: bool,
}

impl Stroke {
    /// Returns a stroke along a polyline: the pixels of a `width × height` image whose centres lie within `radius`
    /// pixels of the polyline. `radius` lies in `[1e-3, 4096]`. One point makes a dot. A stroke entirely off the image
    /// has no pixels.
    pub fn polyline(points: &[DVec2], radius: f64, positive: bool, width: usize, height: usize) -> Result<Self> {
        check_range("stroke radius", radius, 1e-3, 4096.0)?;
        if points.is_empty() || !points.iter().all(|p| p.is_finite()) {
            return Err(Error::argument("a stroke needs at least one point, and finite coordinates"));
        }
        let mut pixels = Vec::new();
        let ends = points.iter().zip(points.iter().skip(1).chain(points.last()));
        for (&a, &b) in ends {
            // Test all pixels of the segment's bounding box, clipped to the image.
            let clip = |v: f64, size: usize| v.clamp(0.0, size as f64) as usize;
            let (low, high) = (a.min(b) - radius, a.max(b) + radius);
            for y in clip(low.y.floor(), height)..clip(high.y.ceil(), height) {
                for x in clip(low.x.floor(), width)..clip(high.x.ceil(), width) {
                    let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    let along = b - a;
                    let t = if along == DVec2::ZERO { 0.0 } else { (p - a).dot(along) / along.length_squared() };
                    if p.distance(a + along * t.clamp(0.0, 1.0)) <= radius {
                        // Segments may overlap completely, so remove duplicates before the list grows.
                        if pixels.len() == pixels.capacity() {
                            pixels.sort_unstable();
                            pixels.dedup();
                            let more = pixels.len().max(64);
                            reserve_capacity(&mut pixels, more)?;
                        }
                        pixels.push((y * width + x) as u32);
                    }
                }
            }
        }
        pixels.sort_unstable();
        pixels.dedup();
        Ok(Self { pixels, positive })
    }
}

/// The strokes for both phases of the segmentation: the plane, then the lights on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrokeSet {
    /// Positive strokes lie on the plane that holds the lights, negative strokes elsewhere.
    pub plane: Vec<Stroke>,
    /// Positive strokes lie on lights, negative strokes on the plane beside them.
    pub lights: Vec<Stroke>,
}

impl StrokeSet {
    /// Returns the examples for the first phase, which finds the plane: the plane strokes and the positive light
    /// strokes. Lights lie in the plane; without their strokes, bright lamps would be cut out of a dark ceiling.
    /// Negative light strokes are left out, because they do not say whether a pixel lies on the plane.
    pub fn plane_examples(&self) -> Vec<Stroke> {
        self.plane_strokes().cloned().collect()
    }

    /// Iterates over the strokes of [`Self::plane_examples`] without copying them.
    pub fn plane_strokes(&self) -> impl Iterator<Item = &Stroke> {
        self.plane.iter().chain(self.lights.iter().filter(|s| s.positive))
    }

    /// Returns the examples for the second phase, which finds the lights: the light strokes, and the plane strokes as
    /// negative examples. Plane strokes lose the pixels that a light stroke also covers. Positive plane strokes also
    /// lose their pixels that are as bright as lamps (see `LIT`), because the stroke runs over a lamp there. The first
    /// channel of `features` is L*.
    pub fn light_examples(&self, features: &Image) -> Result<Vec<Stroke>> {
        let mut of_lights = try_collect(self.lights.iter().flat_map(|s| s.pixels.iter().copied()))?;
        of_lights.sort_unstable();
        let lightness = |p: u32| features.data.get(p as usize * features.channels).copied();
        let painted = self.lights.iter().filter(|s| s.positive).flat_map(|s| &s.pixels);
        let mut painted = try_collect(painted.filter_map(|&p| lightness(p)))?;
        let bright = (painted.len() as f64 * LIT) as usize;
        let limit = match painted.is_empty() {
            true => f32::INFINITY,
            false => *painted.select_nth_unstable_by(bright, f32::total_cmp).1,
        };
        let beside = |s: &Stroke| -> Result<Stroke> {
            let is_lit = |p: u32| s.positive && lightness(p).is_some_and(|l| l >= limit);
            let pixels = s.pixels.iter().copied().filter(|&p| of_lights.binary_search(&p).is_err() && !is_lit(p));
            Ok(Stroke { pixels: try_collect(pixels)?, positive: false })
        };
        self.plane.iter().map(beside).chain(self.lights.iter().cloned().map(Ok)).collect()
    }
}

/// The kinds of strokes in the file formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Plane,
    NotPlane,
    Light,
    NotLight,
}

impl StrokeSet {
    fn push(&mut self, kind: Kind, stroke: Stroke) {
        match kind {
            Kind::Plane | Kind::NotPlane => self.plane.push(stroke),
            Kind::Light | Kind::NotLight => self.lights.push(stroke),
        }
    }
}

impl Kind {
    fn is_positive(self) -> bool {
        matches!(self, Self::Plane | Self::Light)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polyline_covers_what_is_within_its_radius() {
        let dot = Stroke::polyline(&[DVec2::new(2.5, 1.5)], 1.0, true, 5, 4).unwrap();
        assert_eq!(dot.pixels, [2, 6, 7, 8, 12]);
        let line = Stroke::polyline(&[DVec2::new(0.5, 0.5), DVec2::new(4.5, 0.5)], 0.4, false, 5, 4).unwrap();
        assert_eq!(line.pixels, [0, 1, 2, 3, 4]);
        assert!(!line.positive);
    }

    #[test]
    fn pieces_that_overlap_take_no_more_room_than_the_image() {
        let corner = |i: usize| DVec2::new([0.0, 100.0][i % 2], [0.0, 100.0][i / 2 % 2]);
        let crossed = Stroke::polyline(&(0..200).map(corner).collect::<Vec<_>>(), 200.0, true, 100, 100).unwrap();
        assert_eq!(crossed.pixels, (0..10_000).collect::<Vec<u32>>());
        assert!(crossed.pixels.capacity() <= 40_000, "{}", crossed.pixels.capacity());
    }

    #[test]
    fn off_image_strokes_are_empty_and_bad_ones_refused() {
        let far = [DVec2::new(-1e9, 50.0), DVec2::new(-1e9, 1e12)];
        assert!(Stroke::polyline(&far, 3.0, true, 100, 100).unwrap().pixels.is_empty());
        assert!(Stroke::polyline(&[], 1.0, true, 9, 9).is_err());
        assert!(Stroke::polyline(&[DVec2::NAN], 1.0, true, 9, 9).is_err());
        assert!(Stroke::polyline(&[DVec2::ONE], 0.0, true, 9, 9).is_err());
        assert!(Stroke::polyline(&[DVec2::ONE], f64::NAN, true, 9, 9).is_err());
    }
}
