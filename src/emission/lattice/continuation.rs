//! How a texture goes on beyond its exemplar.

use crate::error::{Error, Result};
use glam::{DMat2, DVec2};

/// Largest slant at which a row of lamps still follows an axis. [judged on 5 photos]
pub const MAX_SLANT: f64 = 0.04;

/// How the texture goes on beyond the exemplar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Continuation {
    /// The texture is a part of the exemplar.
    Copy,
    /// Two periods were found in the lights, in unwarped pixels.
    Lattice([DVec2; 2]),
    /// One period was found (the first); the extent of the exemplar serves as the second.
    Row([DVec2; 2]),
    /// Too few lights to have a law: the exemplar repeats as a whole, its extent serving as both periods.
    Tile([DVec2; 2]),
    /// Many lights without a period: patches go anywhere.
    Free,
}

impl Continuation {
    /// The lattice on which patches must stay, if any.
    pub fn lattice(&self) -> Option<[DVec2; 2]> {
        match *self {
            Self::Lattice(basis) | Self::Row(basis) | Self::Tile(basis) => Some(basis),
            Self::Copy | Self::Free => None,
        }
    }

    /// The same law with its lattice stretched so that a whole number of periods, at least one, fits a size.
    ///
    /// Errors: `Degenerate` where that leaves no lattice.
    pub fn fitted(self, size: DVec2) -> Result<Self> {
        let fit = |[a, b]: [DVec2; 2]| {
            // Steps along both periods to the far ends of the two sides.
            let inverse = DMat2::from_cols(a, b).inverse();
            let steps = |side: DVec2| (inverse * side).round();
            let whole = DMat2::from_cols(steps(DVec2::X * size.x), steps(DVec2::Y * size.y)).inverse();
            let basis = DMat2::from_diagonal(size) * whole;
            match basis.is_finite() {
                true => Ok([basis.x_axis, basis.y_axis]),
                false => Err(Error::degenerate(format!(
                    "a texture of {} x {} unwarped pixels is less than a period of its lights and cannot repeat: enlarge it",
                    size.x, size.y
                ))),
            }
        };
        Ok(match self {
            Self::Lattice(basis) => Self::Lattice(fit(basis)?),
            Self::Row(basis) => Self::Row(fit(basis)?),
            Self::Tile(basis) => Self::Tile(fit(basis)?),
            Self::Copy | Self::Free => self,
        })
    }

    /// The periods along x and along y, in unwarped pixels, where the lattice has a period along that axis. Both
    /// periods of a copy are infinite.
    pub fn periods(&self) -> [Option<f64>; 2] {
        if *self == Self::Copy {
            return [Some(f64::INFINITY); 2];
        }
        let along = |axis: DVec2| {
            let is_along = |v: &DVec2| v.perp_dot(axis).abs() < MAX_SLANT * v.length();
            self.lattice().and_then(|basis| basis.into_iter().find(is_along)).map(|v| v.length())
        };
        [along(DVec2::X), along(DVec2::Y)]
    }
}
