//! The media that a path is in: air, or the inside of solid transparent bodies.
//!
//! A path keeps a stack of the bodies that it has entered. It is in the medium of the body entered last. A path enters
//! a body where it passes the front side of a surface, and leaves it where it passes the back side; the winding of the
//! triangles says which side is which. Where bodies overlap, such as water and its glass, the body entered last
//! displaces the others: the surface by which the path leaves a displaced body does nothing. (Schmidt and Budge 2002,
//! "Simple nested dielectrics in ray traced images", give bodies priorities instead, which glTF does not have.) A body
//! that lies wholly inside another one needs no overlap.
//!
//! Not modelled: scattering inside a body.

use crate::error::{Error, ErrorKind, Result};
use crate::maths;
use crate::scene::Material;
use glam::Vec3;

/// Number of the medium outside all bodies.
pub const AIR: u16 = 0;

/// A homogeneous medium, which refracts and absorbs light but does not scatter it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    pub ior: f32,
    /// Absorption coefficient per channel and metre.
    absorption: Vec3,
}

impl Medium {
    const OF_AIR: Self = Self { ior: 1.0, absorption: Vec3::ZERO };

    fn inside(material: &Material) -> Self {
        let coefficient = |share: f32| {
            // The limits make the products with every distance numbers: 0 × 0, but never 0 × infinity.
            let coefficient = -maths::ln(share.max(f32::MIN_POSITIVE)) / material.attenuation_distance;
            if share > 0.0 || coefficient == 0.0 { coefficient.clamp(0.0, f32::MAX) } else { f32::MAX }
        };
        Self { ior: material.ior, absorption: Vec3::from_array(material.attenuation_color.to_array().map(coefficient)) }
    }

    /// Returns the share of light that is left after `distance` metres, which may be infinite (Beer and Lambert).
    pub fn transmittance(&self, distance: f32) -> Vec3 {
        let depth = self.absorption * distance.min(f32::MAX);
        Vec3::from_array(depth.to_array().map(|depth| maths::exp(-depth)))
    }
}

/// Numbers the media inside solid bodies. Returns the media by their numbers, and for each material the number of the
/// medium inside its bodies; [`AIR`] if it has none.
///
/// # Errors
/// Too many solid materials.
pub fn number(materials: &[Material]) -> Result<(Vec<Medium>, Vec<u16>)> {
    let mut media = vec![Medium::OF_AIR];
    let numbers = materials.iter().map(|material| {
        if !material.is_solid() {
            return Ok(AIR);
        }
        let number = u16::try_from(media.len()).map_err(|_| {
            let message = format!("scene has more than {} materials of solid glass", u16::MAX);
            Error::new(ErrorKind::Unsupported, message)
        })?;
        media.push(Medium::inside(material));
        Ok(number)
    });
    let numbers = numbers.collect::<Result<_>>()?;
    Ok((media, numbers))
}

/// The numbers of the media of the bodies that contain a point of a path, in 16 bits each. The lowest 16 bits belong to
/// the body entered last. Only the last four bodies are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Media(u64);

/// A surface of a solid body, as a path meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Index of refraction on the side of the viewer, divided by the index on the far side.
    pub eta: f32,
    /// The media on the far side.
    pub beyond: Media,
}

impl Media {
    pub const NONE: Self = Self(0);

    /// Whether the point lies outside all bodies.
    #[inline]
    pub fn is_none(self) -> bool {
        self.0 == 0
    }

    /// Returns the number of the medium that fills the point.
    #[inline]
    pub fn innermost(self) -> u16 {
        self.0 as u16
    }

    pub fn entered(self, medium: u16) -> Self {
        Self(self.0 << 16 | u64::from(medium))
    }

    /// Removes the body of this medium that was entered last, if there is one.
    fn left(self, medium: u16) -> Self {
        match (0..4).map(|place| 16 * place).find(|shift| (self.0 >> shift) as u16 == medium) {
            Some(shift) => {
                let inner = self.0 & ((1 << shift) - 1);
                // Shift in two steps, because a shift by 64 bits is not defined.
                Self((self.0 >> shift >> 16) << shift | inner)
            }
            None => self,
        }
    }

    /// Describes the surface of a body with the given medium, for a viewer among these media. The viewer sees the front
    /// side if `is_front` is true. `media` are all media by their numbers.
    pub fn boundary(self, medium: u16, is_front: bool, media: &[Medium]) -> Boundary {
        let beyond = if is_front { self.entered(medium) } else { self.left(medium) };
        // A viewer who sees the back side of a body without having entered it is inside all the same: the viewer was
        // there from the start, or the body is open.
        let near = if is_front || beyond != self { self.innermost() } else { medium };
        let [near, far] = [near, beyond.innermost()].map(|number| media[usize::from(number)].ior);
        Boundary { eta: near / far, beyond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: u16 = 1;
    const GLASS: u16 = 2;

    fn media() -> [Medium; 3] {
        [1.0, 1.33, 1.5].map(|ior| Medium { ior, absorption: Vec3::ZERO })
    }

    #[test]
    fn bodies_are_left_in_any_order() {
        let both = Media::NONE.entered(GLASS).entered(WATER);
        assert_eq!(
            (both.innermost(), both.left(WATER).innermost(), both.left(GLASS).innermost()),
            (WATER, GLASS, WATER)
        );
        assert!(both.left(GLASS).left(WATER).is_none() && both.left(3) == both && Media::NONE.left(GLASS).is_none());
        // The fifth body displaces the first.
        let many = (1..=5).fold(Media::NONE, Media::entered);
        assert_eq!((many.left(2).left(3).left(4).left(5), many.left(1)), (Media::NONE, many));
    }

    #[test]
    fn the_body_entered_last_displaces_the_others() {
        let eta = |inside: Media, medium, is_front| inside.boundary(medium, is_front, &media()).eta;
        let glass = Media::NONE.entered(GLASS);
        assert_eq!((eta(Media::NONE, GLASS, true), eta(glass, GLASS, false)), (1.0 / 1.5, 1.5));
        assert_eq!(eta(glass, WATER, true), 1.5 / 1.33);
        // Behind the water's surface, the inner surface of the glass does nothing.
        assert_eq!(eta(glass.entered(WATER), GLASS, false), 1.0);
        assert_eq!(eta(Media::NONE.entered(WATER), WATER, false), 1.33);
        // Bodies of the same glass that overlap make one body.
        assert_eq!((eta(glass, GLASS, true), eta(glass.entered(GLASS), GLASS, false)), (1.0, 1.0));
        // A viewer who has entered nothing is inside the body whose back side is seen.
        assert_eq!(eta(Media::NONE, GLASS, false), 1.5);
    }

    #[test]
    fn light_is_absorbed_by_the_law_of_beer_and_lambert_even_at_the_extremes() {
        let medium = |colour: f32, attenuation_distance: f32| {
            let attenuation_color = Vec3::splat(colour);
            Medium::inside(&Material { attenuation_color, attenuation_distance, ..Material::default() })
        };
        for (colour, distance, along, expected) in [
            (0.25, 0.5, 0.5, 0.25),
            (0.25, 0.5, 1.0, 0.0625),
            (0.25, 0.5, 0.0, 1.0),
            (0.25, f32::INFINITY, f32::INFINITY, 1.0),
            (0.0, f32::INFINITY, 1.0, 1.0),
            (0.0, 1.0, 1e-30, 0.0),
            (0.0, 1.0, 0.0, 1.0),
            (1.0, f32::MIN_POSITIVE, f32::INFINITY, 1.0),
            (0.5, f32::MIN_POSITIVE, 1e-6, 0.0),
            (0.5, 1.0, f32::INFINITY, 0.0),
        ] {
            let left = medium(colour, distance).transmittance(along).x;
            assert!((left - expected).abs() <= 1e-6 * expected, "{colour} after {distance}, at {along}: {left}");
        }
    }
}
