//! Radial distortion: the map between the photo that a lens takes and the photo that an ideal lens would take (Brown
//! 1971, "Close-range camera calibration"; its first coefficient).
//!
//! With coordinates from the principal point, the pixel at `p` shows the point that an ideal lens shows at
//! `p (1 - b |p|²)`. This direction of the map is a polynomial; its inverse is the root of a cubic.

use crate::error::{Error, Result, check_range};
use glam::{DMat2, DVec2};

/// Range of the parameter `corner` of [`Radial::new`]. The displacement at the photo corner farthest from the principal
/// point must lie in this range too. At -1, an ideal lens shows the corner at twice its distance, as a fisheye lens
/// does. Above 1/3, the map folds over inside the photo; 0.2 keeps the fold 29 % of the distance away from the corner.
/// \[convention\]
pub const MIN_CORNER: f64 = -1.0;
pub const MAX_CORNER: f64 = 0.2;

/// Largest value of `b |q|²` for which the cubic has a root on the near side of the fold. [convention: exact]
const FOLD: f64 = 4.0 / 27.0;
/// Number of Newton steps that find the root of the cubic to full precision over the range of the coefficient.
/// [rounding]
const STEPS: usize = 7;

/// The radial distortion of a photo's lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radial {
    /// The principal point in pixels.
    pub centre: DVec2,
    /// The coefficient `b` per square pixel; 0 for an ideal lens, negative for barrel distortion.
    pub bend: f64,
}

impl Radial {
    /// A lens without distortion.
    pub const NONE: Self = Self { centre: DVec2::ZERO, bend: 0.0 };

    /// The lens that moves points at half of the photo's diagonal outwards by the share `corner` of their distance from
    /// the principal point. `size` is the size of the photo in pixels.
    ///
    /// Errors: `corner` is outside `[MIN_CORNER, MAX_CORNER]`, or so is the share by which the lens moves the photo
    /// corner farthest from the principal point.
    pub fn new(corner: f64, centre: DVec2, size: DVec2) -> Result<Self> {
        check_range("distortion", corner, MIN_CORNER, MAX_CORNER)?;
        let half_diagonal = 0.25 * size.length_squared();
        let bend = corner / half_diagonal;
        let farthest = centre.abs().max((size - centre).abs());
        // For a principal point in the photo's centre, the factor in parentheses is exactly 1, so the limits of the
        // range themselves are allowed.
        let at_farthest = corner * (farthest.length_squared() / half_diagonal);
        if !(MIN_CORNER..=MAX_CORNER).contains(&at_farthest) {
            return Err(Error::argument(format!(
                "distortion is {corner}; about the principal point {centre} it must lie in [{:.4}, {:.4}]",
                MIN_CORNER * corner / at_farthest,
                MAX_CORNER * corner / at_farthest
            )));
        }
        Ok(Self { centre, bend })
    }

    /// Whether the lens has no distortion.
    pub fn is_none(&self) -> bool {
        self.bend == 0.0
    }

    /// Returns the pixel at which an ideal lens would show what the photo shows at the pixel `shown`.
    pub fn ideal(&self, shown: DVec2) -> DVec2 {
        if self.is_none() {
            return shown;
        }
        let p = shown - self.centre;
        self.centre + p * (1.0 - self.bend * p.length_squared())
    }

    /// Returns the pixel at which the photo shows what an ideal lens would show at the pixel `ideal`: the inverse of
    /// [`Self::ideal`]. Beyond the fold of a pincushion distortion, no pixel of the photo shows the same; the result
    /// then lies outside the photo.
    pub fn shown(&self, ideal: DVec2) -> DVec2 {
        if self.is_none() {
            return ideal;
        }
        let q = ideal - self.centre;
        self.centre + q * magnification(self.bend * q.length_squared())
    }

    /// Returns the derivative of [`Self::ideal`] at a pixel of the photo.
    pub fn derivative(&self, shown: DVec2) -> DMat2 {
        let p = shown - self.centre;
        let across = 1.0 - self.bend * p.length_squared();
        let cross = -2.0 * self.bend * p.x * p.y;
        DMat2::from_cols(
            DVec2::new(across - 2.0 * self.bend * p.x * p.x, cross),
            DVec2::new(cross, across - 2.0 * self.bend * p.y * p.y),
        )
    }
}

/// Returns the root `s` of `s (1 - t s²) = 1`, the factor by which the lens magnifies the distance of a point from the
/// principal point; `t` is `b |q|²`. For t beyond the fold, returns about the root at the fold.
#[inline(always)]
pub fn magnification(t: f64) -> f64 {
    let t = if t < FOLD { t } else { FOLD };
    // Start below the root. Newton's method then rises towards it (t > 0), or comes down to it after one step (t < 0).
    let mut s = if t < 0.0 { 1.0 / (1.0 - t) } else { 1.0 + t + 3.0 * t * t };
    for _ in 0..STEPS {
        let square = t * s * s;
        s -= (s * (1.0 - square) - 1.0) / (1.0 - 3.0 * square);
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    const SIZE: DVec2 = DVec2::new(640.0, 480.0);

    fn lens(corner: f64) -> Radial {
        Radial::new(corner, 0.5 * SIZE, SIZE).unwrap()
    }

    #[test]
    fn the_limits_are_allowed_for_photos_of_any_size() {
        for size in [DVec2::new(1920.0, 1080.0), DVec2::new(3840.0, 2160.0), DVec2::new(5184.0, 3456.0)] {
            assert!(
                Radial::new(MIN_CORNER, 0.5 * size, size).is_ok() && Radial::new(MAX_CORNER, 0.5 * size, size).is_ok()
            );
        }
    }

    #[test]
    fn corners_move_by_the_coefficient_and_both_maps_are_inverse() {
        for corner in [MIN_CORNER, -0.3, -0.05, -1e-9, 0.0, 1e-9, 0.05, MAX_CORNER] {
            let lens = lens(corner);
            // The pixel in the corner shows the point that an ideal lens shows at `1 - corner` times its distance from
            // the centre.
            assert!((lens.ideal(SIZE) - 0.5 * SIZE - 0.5 * SIZE * (1.0 - corner)).length() < 1e-9);
            for i in 0..=20 {
                for k in 0..=20 {
                    let p = SIZE * DVec2::new(f64::from(i), f64::from(k)) / 20.0;
                    assert!(
                        lens.shown(lens.ideal(p)).distance(p) < 1e-9,
                        "{corner}: {p} {}",
                        lens.shown(lens.ideal(p))
                    );
                }
            }
        }
    }

    /// Cardano's formulas for the root of the cubic.
    #[test]
    fn the_root_is_that_of_the_closed_form() {
        for t in [-3.0f64, -1.0, -0.1, -1e-6, 1e-6, 0.05, 0.1, 0.128] {
            let k = (3.0 * t.abs()).sqrt();
            let root = if t < 0.0 { ((1.5 * k).asinh() / 3.0).sinh() } else { ((1.5 * k).asin() / 3.0).sin() };
            let root = 2.0 * root / k;
            assert!((magnification(t) - root).abs() < 1e-12, "{t}: {} {root}", magnification(t));
        }
    }

    #[test]
    fn the_derivative_is_that_of_finite_differences() {
        let lens = lens(-0.1);
        for p in [DVec2::new(3.0, 5.0), DVec2::new(600.0, 100.0), 0.5 * SIZE] {
            let [x, y] = [DVec2::X, DVec2::Y].map(|d| 0.5e3 * (lens.ideal(p + 1e-3 * d) - lens.ideal(p - 1e-3 * d)));
            let want = lens.derivative(p);
            assert!(want.x_axis.distance(x) < 1e-6 && want.y_axis.distance(y) < 1e-6, "{want} {x} {y}");
        }
    }

    #[test]
    fn points_that_no_pixel_shows_are_outside_the_photo() {
        let lens = lens(MAX_CORNER);
        for far in [1.3, 2.0, 1e3, 1e9] {
            let seen = lens.shown(0.5 * SIZE + 0.5 * SIZE * far);
            assert!(seen.is_finite() && seen.x > SIZE.x && seen.y > SIZE.y, "{far}: {seen}");
        }
        // A barrel shows every point in front of the camera, but far points still lie outside the photo.
        let seen = self::lens(MIN_CORNER).shown(SIZE * 1e6);
        assert!(seen.x > SIZE.x && seen.y > SIZE.y, "{seen}");
    }

    #[test]
    fn a_lens_without_distortion_changes_no_bit() {
        let p = DVec2::new(123.456_789, 0.1 + 0.2);
        for lens in [Radial::NONE, lens(0.0)] {
            assert_eq!((lens.ideal(p), lens.shown(p)), (p, p));
        }
    }

    #[test]
    fn coefficients_out_of_range_are_errors_that_name_the_range() {
        for bad in [f64::NAN, f64::INFINITY, -1e300, 1e300, -1.01, 0.201] {
            let e = Radial::new(bad, 0.5 * SIZE, SIZE).unwrap_err();
            assert_eq!(e.kind, ErrorKind::InvalidArgument);
            assert!(e.message.contains(&format!("distortion is {bad}; it must lie in [-1, 0.2]")), "{}", e.message);
        }
        // If the principal point is a corner of the photo, the farthest corner is twice as far away, so the allowed
        // range is a quarter.
        assert!(Radial::new(0.049, DVec2::ZERO, SIZE).is_ok() && Radial::new(-0.24, DVec2::ZERO, SIZE).is_ok());
        let e = Radial::new(0.1, DVec2::ZERO, SIZE).unwrap_err();
        assert!(e.message.contains("distortion is 0.1") && e.message.contains("[-0.2500, 0.0500]"), "{}", e.message);
        // Photos of one pixel.
        assert!(Radial::new(-0.05, DVec2::splat(0.5), DVec2::ONE).is_ok());
    }
}
