//! The law of a texture: the rule by which its pattern continues beyond the exemplar. The pattern continues on a
//! lattice, in a row, by repetition, or by patches without a lattice.

use super::basis;
use crate::error::{Error, Result};
use glam::{DMat2, DVec2};

/// A row of lamps counts as parallel to an axis if its slant, as a tangent, is at most this. [judged on 5 photos]
pub const MAX_SLANT: f64 = 0.04;

/// A period of a lattice becomes parallel to an axis if its slant, as a tangent, is at most this. [judged on 50 photos]
const MAX_LATTICE_SLANT: f64 = 0.06;

/// A period, made exactly parallel to an axis if it nearly is. Its length stays.
pub fn aligned(period: DVec2) -> DVec2 {
    basis::straight(period, MAX_LATTICE_SLANT)
}

/// The rule by which a texture continues beyond its exemplar. Vectors are in unwarped pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// The texture is a part of the exemplar.
    Copy,
    /// The lights form a lattice with two periods.
    Lattice([DVec2; 2]),
    /// The lights form a row. The first vector is the period of the row; the second is the extent of the exemplar
    /// across the row, which serves as the second period.
    Row([DVec2; 2]),
    /// Too few lights for a period: the exemplar repeats as a whole, with its extent as both periods.
    Whole([DVec2; 2]),
    /// Many lights without a period: patches are placed without a lattice.
    Free,
}

impl Law {
    /// The two periods of the lattice; patches may be shifted only by lattice vectors. `None` if there is no lattice.
    pub fn lattice(&self) -> Option<[DVec2; 2]> {
        match *self {
            Self::Lattice(basis) | Self::Row(basis) | Self::Whole(basis) => Some(basis),
            Self::Copy | Self::Free => None,
        }
    }

    /// Stretches the lattice so that a whole number of periods, at least one, fits into `size`.
    ///
    /// Errors: `Degenerate` if the stretched lattice has no area.
    pub fn fitted(self, size: DVec2) -> Result<Self> {
        let fit = |[a, b]: [DVec2; 2]| {
            // Round the two sides of the texture to whole steps along both periods.
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
            Self::Whole(basis) => Self::Whole(fit(basis)?),
            Self::Copy | Self::Free => self,
        })
    }

    /// The law with periods exactly parallel to the axes, where they nearly are. Other laws than lattices stay.
    pub fn aligned(self) -> Self {
        match self {
            Self::Lattice(found) => Self::Lattice(basis::reduced(found).map(aligned)),
            other => other,
        }
    }

    /// Whether the periods, if any, are exactly parallel to the axes.
    pub fn is_aligned(&self) -> bool {
        let on_axis = |period: DVec2| period.min_element() == 0.0 || period.max_element() == 0.0;
        match *self {
            Self::Lattice([a, b]) => on_axis(a) && on_axis(b),
            Self::Row([along, _]) => on_axis(along),
            Self::Copy | Self::Whole(_) | Self::Free => true,
        }
    }

    /// The periods along x and along y in unwarped pixels; `None` for an axis along which the lattice has no period.
    /// For `Copy`, both periods are infinite.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearly_parallel_periods_become_parallel_and_oblique_ones_stay() {
        let near = Law::Lattice([DVec2::new(100.0, 4.0), DVec2::new(98.0, 84.0)]).aligned();
        let Law::Lattice([a, b]) = near else { panic!("{near:?}") };
        assert!(near.is_aligned() && a.min_element() == 0.0 && b.min_element().abs() == 0.0, "{near:?}");
        assert!((a.length() - 80.0).abs() < 0.1 && (b.length() - 100.1).abs() < 0.1, "{near:?}");

        let hexagonal = Law::Lattice([DVec2::new(100.0, 0.0), DVec2::new(50.0, 86.6)]);
        assert!(!hexagonal.aligned().is_aligned());
        let free = Law::Free;
        assert!(free.is_aligned() && free.aligned() == free);
    }
}
