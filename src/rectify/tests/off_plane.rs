//! Lamps on a plane raise no warning; lamps whose sizes do not follow its perspective raise one.

use super::*;
use crate::geometry::Homography;
use glam::DVec2;

const WIDTH: usize = 1600;
const HEIGHT: usize = 1200;

/// A ceiling that runs from the photo's top towards a horizon near its lower edge.
fn ceiling() -> Unwarped {
    let square = [DVec2::ZERO, DVec2::new(500.0, 0.0), DVec2::new(500.0, 500.0), DVec2::new(0.0, 500.0)];
    let corners = [[0.0, 0.0], [1600.0, 0.0], [920.0, 800.0], [680.0, 800.0]].map(DVec2::from);
    Unwarped {
        image: Image::new(500, 500, 3).unwrap(),
        valid: Image::new(500, 500, 1).unwrap(),
        to_photo: Homography::from_corners(square, corners).unwrap().into(),
        pixel_size: 0.01,
        corners,
        aspect_confidence: 1.0,
        corner_error: [0.0; 4],
    }
}

/// The photo's mask of lamps at a grid of 4 × 4 places of the ceiling, except the places that `is_left_out`. `radius`
/// returns the radius in photo pixels of the lamp at a place, from the length in the photo of one pixel of the ceiling.
fn mask(radius: impl Fn(f64) -> f64, is_left_out: impl Fn(usize) -> bool) -> Image {
    let to_photo = ceiling().to_photo;
    let lamps: Vec<(DVec2, f64)> = (0..16)
        .filter(|k| !is_left_out(*k))
        .map(|k| {
            let at = DVec2::new((k % 4) as f64, (k / 4) as f64) * 110.0 + 85.0;
            let p = |x: f64, y: f64| to_photo.apply(at + DVec2::new(x, y));
            let scale = (p(0.5, 0.0) - p(-0.5, 0.0)).perp_dot(p(0.0, 0.5) - p(0.0, -0.5)).abs().sqrt();
            (p(0.0, 0.0), radius(scale))
        })
        .collect();
    let is_lit = |at: DVec2| lamps.iter().any(|(centre, radius)| at.distance(*centre) <= *radius);
    Image::from_fn(WIDTH, HEIGHT, |x, y| [f32::from(is_lit(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)))]).unwrap()
}

fn warning(radius: impl Fn(f64) -> f64) -> Option<Warning> {
    off_plane(&mask(radius, |_| false), &ceiling())
}

#[test]
fn lamps_on_the_plane_raise_nothing() {
    assert_eq!(warning(|scale| 6.0 * scale), None);
}

#[test]
fn lamps_with_bloom_raise_nothing() {
    // The widest lamps appear only about twice as wide as the narrowest, instead of four times.
    assert_eq!(warning(|scale| 1.3 * scale + 1.4 * BLOOM_UNIT * WIDTH as f64), None);
}

#[test]
fn lamps_of_one_size_in_the_photo_do_not_lie_on_the_plane() {
    let raised = warning(|_| 12.0).unwrap();
    assert_eq!((raised.code, raised.limit), (Code::OffPlane, MIN_EXPONENT));
    assert!(raised.severity.abs() < 0.1, "{raised:?}");
    // Lamps that look smaller where the plane is nearer lie behind it or below it.
    assert!(warning(|scale| 10.0 / scale.sqrt()).unwrap().severity < 0.0);
}

#[test]
fn few_lamps_tell_nothing() {
    let of = |count: usize| off_plane(&mask(|_| 12.0, |k| k >= count), &ceiling());
    assert_eq!(of(0), None);
    assert_eq!(of(MIN_LAMPS - 1), None);
    assert!(of(MIN_LAMPS).is_some());
}

#[test]
fn lamps_of_a_plane_that_faces_the_camera_tell_nothing() {
    let flat = Unwarped { to_photo: Homography(glam::DMat3::IDENTITY).into(), ..ceiling() };
    assert_eq!(off_plane(&mask(|_| 12.0, |_| false), &flat), None);
}

#[test]
fn lamps_that_the_border_cuts_do_not_count() {
    let mut lights = mask(|_| 12.0, |k| k >= MIN_LAMPS);
    assert!(off_plane(&lights, &ceiling()).is_some());
    // A strip of light joins the first lamp to the border.
    let first = ceiling().to_photo.apply(DVec2::splat(85.0));
    let row = first.y as usize * WIDTH;
    lights.data[row..row + first.x as usize].fill(1.0);
    assert_eq!(off_plane(&lights, &ceiling()), None);
}
