//! The input of the filter.

use crate::error::{Error, Result};
use crate::image::Image;

/// The image to be filtered and its guide images, all of equal size.
pub struct Input<'a> {
    /// Two independent estimates of the image with equal numbers of paths: linear RGB, finite.
    pub halves: [&'a Image; 2],
    /// Variance of each half, per channel, at least 0, from its own paths alone; infinite where unknown.
    pub variances: [&'a Image; 2],
    /// RGB albedo of the surface; black for the background.
    pub albedo: &'a Image,
    /// Unit normal of the surface; 0 for the background.
    pub normal: &'a Image,
    /// Position of the surface, in any unit.
    pub position: &'a Image,
}

impl Input<'_> {
    /// Returns whether the variances of both halves of a pixel are known.
    pub fn is_known(&self, x: usize, y: usize) -> bool {
        self.variances.iter().all(|variance| variance.pixel(x, y)[..3].iter().all(|v| v.is_finite()))
    }

    /// Returns an error if the images do not fit together or have values out of range.
    pub fn check(&self) -> Result<()> {
        let Self { halves: [one, other], variances, albedo, normal, position } = *self;
        let images = [("first half", one), ("second half", other)];
        let [first, second] = variances;
        let others = [
            ("first variance", first),
            ("second variance", second),
            ("albedo", albedo),
            ("normal", normal),
            ("position", position),
        ];
        for (name, image) in images.into_iter().chain(others) {
            one.check_same_size("first half", image, name)?;
            if image.channels < 3 {
                return Err(Error::argument(format!("{name} has {} channels; it must have 3", image.channels)));
            }
        }
        for (name, image) in images {
            let bad = image.count_non_finite();
            if bad > 0 {
                return Err(Error::argument(format!("{bad} samples of the {name} are NaN or infinite; replace them")));
            }
        }
        if let Some(v) = first.data.iter().chain(&second.data).find(|v| !(**v >= 0.0)) {
            return Err(Error::argument(format!("a variance is {v}; it must be at least 0")));
        }
        Ok(())
    }
}
