//! How many texels cover the surface, and how large they are in the photo's unwarped plane.

use crate::rectify::Unwarped;
use crate::scene::surface::Surface;

pub(super) struct TexelGrid {
    pub width: usize,
    pub height: usize,
    /// Unwarped pixels per texel.
    pub scale: f64,
}

/// Texels as fine as the unwarped photo, but no more than `max_texels` along the longer side.
pub(super) fn texel_grid(surface: &Surface, unwarped: &Unwarped, plane_distance: f64, max_texels: usize) -> TexelGrid {
    let pixel = unwarped.pixel_size * plane_distance;
    let (width, height) = (f64::from(surface.size.x), f64::from(surface.size.y));
    let texel_size = pixel.max(width.max(height) / max_texels as f64);
    let count = |length: f64| ((length / texel_size).round() as usize).clamp(1, max_texels);
    TexelGrid { width: count(width), height: count(height), scale: texel_size / pixel }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Homography;
    use crate::image::Image;
    use glam::{DMat3, DVec2, Vec2, Vec3};

    fn surface(size: Vec2) -> Surface {
        let (u_axis, v_axis, normal) = (Vec3::X, Vec3::Z, Vec3::NEG_Y);
        Surface { triangles: vec![], origin: Vec3::ZERO, u_axis, v_axis, normal, size, area: size.x * size.y }
    }

    #[test]
    fn lamps_keep_their_size_in_metres() {
        let black = Image::new(1, 1, 1).unwrap();
        let unwarped = Unwarped {
            image: black.clone(),
            valid: black,
            to_photo: Homography(DMat3::IDENTITY),
            pixel_size: 0.01,
            corners: [DVec2::ZERO; 4],
            aspect_confidence: 1.0,
            corner_error: [0.0; 4],
        };
        // A pixel is 2 cm: 300 × 150 texels of it, or 100 × 50 of 6 cm, each three pixels wide.
        let fine = texel_grid(&surface(Vec2::new(6.0, 3.0)), &unwarped, 2.0, 2048);
        assert_eq!((fine.width, fine.height), (300, 150));
        assert!((fine.scale - 1.0).abs() < 1e-6);
        let coarse = texel_grid(&surface(Vec2::new(6.0, 3.0)), &unwarped, 2.0, 100);
        assert_eq!((coarse.width, coarse.height), (100, 50));
        assert!((coarse.scale - 3.0).abs() < 1e-6);
        // A surface thinner than a texel still has one.
        assert_eq!(texel_grid(&surface(Vec2::new(1e-9, 1.0)), &unwarped, 1.0, 64).width, 1);
    }
}
