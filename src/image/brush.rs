//! The pixels a brush covers, as lists of `y * width + x` in rising order.

use crate::error::{Error, Result, check_range};
use crate::image::{Image, try_vec};
use glam::{DVec2, Vec3};

/// Pixels whose centre lies within `radius` of a polyline given in pixels; none where it leaves the image. One point
/// makes a dot.
pub fn polyline(points: &[DVec2], radius: f64, width: usize, height: usize) -> Result<Vec<u32>> {
    if points.is_empty() {
        return Err(Error::argument("a stroke has no points; it needs at least one"));
    }
    if let Some(bad) = points.iter().find(|p| !(p.abs().max_element() <= 1e6)) {
        return Err(Error::argument(format!("a stroke has a point at {bad}; coordinates must lie in [-1e6, 1e6]")));
    }
    check_range("the stroke's radius", radius, 0.5, 1e4)?;
    let mut covered = try_vec(width * height, false)?;
    let ends = points.windows(2).map(|w| (w[0], w[1])).chain([(points[0], points[0])]);
    for (a, b) in ends {
        // Rows and columns the thick line can reach.
        let (low, high) = (a.min(b) - radius, a.max(b) + radius);
        let clamp = |v: f64, n: usize| v.clamp(0.0, n as f64) as usize;
        for y in clamp(low.y.floor(), height)..clamp(high.y.ceil(), height) {
            for x in clamp(low.x.floor(), width)..clamp(high.x.ceil(), width) {
                let centre = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                covered[y * width + x] |= distance_squared(centre, a, b) <= radius * radius;
            }
        }
    }
    Ok(selected(covered.iter().copied()))
}

/// Pixels of an image that show a colour: an 8-bit drawing compressed with care still does.
pub fn of_colour(drawing: &Image, colour: Vec3) -> Vec<u32> {
    const TOLERANCE: f32 = 0.1;
    let pixels = (0..drawing.width * drawing.height).map(|i| {
        let (x, y) = (i % drawing.width, i / drawing.width);
        let is_opaque = drawing.channels < 4 || drawing.pixel(x, y)[3] > 0.5;
        is_opaque && (drawing.rgb(x, y) - colour).abs().max_element() < TOLERANCE
    });
    selected(pixels)
}

fn selected(covered: impl Iterator<Item = bool>) -> Vec<u32> {
    (0u32..).zip(covered).filter_map(|(i, is_covered)| is_covered.then_some(i)).collect()
}

fn distance_squared(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance_squared(a + (b - a) * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_covers_the_pixels_within_its_radius() {
        let points = [DVec2::new(10.0, 5.0), DVec2::new(30.0, 5.0)];
        let pixels = polyline(&points, 2.0, 40, 10).unwrap();
        let inside = |x: f64, y: f64| {
            let dx = (10.0 - x).max(x - 30.0).max(0.0);
            dx * dx + (y - 5.0) * (y - 5.0) <= 4.0
        };
        let expected: Vec<u32> = (0..400).filter(|i| inside((i % 40) as f64 + 0.5, (i / 40) as f64 + 0.5)).collect();
        assert_eq!(pixels, expected);
    }

    #[test]
    fn dots_and_strokes_beyond_the_border_are_fine_and_nonsense_is_not() {
        assert_eq!(polyline(&[DVec2::new(3.5, 2.5)], 0.5, 10, 10).unwrap(), [23]);
        assert!(polyline(&[DVec2::splat(-50.0)], 3.0, 10, 10).unwrap().is_empty());
        assert!(polyline(&[], 3.0, 10, 10).is_err());
        assert!(polyline(&[DVec2::new(f64::NAN, 0.0)], 3.0, 10, 10).is_err());
        assert!(polyline(&[DVec2::ZERO], f64::NAN, 10, 10).is_err());
    }

    #[test]
    fn colours_are_told_apart() {
        let drawing =
            Image::from_fn(3, 1, |x, _| [[1.0, 0.0, 0.0, 1.0], [0.95, 0.05, 0.0, 0.0], [0.0, 1.0, 0.0, 1.0]][x])
                .unwrap();
        assert_eq!(of_colour(&drawing, Vec3::X), [0]);
        assert_eq!(of_colour(&drawing, Vec3::Y), [2]);
    }
}
