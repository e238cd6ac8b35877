//! The law of a texture: the rule by which its pattern continues beyond the exemplar. The pattern continues on a
//! lattice, in a row, by repetition, or by patches without a lattice.

use super::basis;
use crate::error::{Error, Result};
use crate::geometry::lattice::reduced;
use glam::{DMat2, DVec2};

/// A row of lamps counts as parallel to an axis if the tangent of the angle between them is below this.
/// [judged on 5 photos]
pub const MAX_SLANT: f64 = 0.04;

/// A period of a lattice is made parallel to an axis if the tangent of the angle between them is below this.
/// [judged on 50 photos]
const MAX_LATTICE_SLANT: f64 = 0.06;

/// Returns a period, made exactly parallel to an axis if it is nearly parallel. The length stays.
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
    /// The lights form a row. The first vector is the period along the row. The second vector leads across the row; its
    /// length follows from the extent of the exemplar or of its panes ([`super::row`]).
    Row([DVec2; 2]),
    /// There are too few lights for a period, or all lights form one isolated group. The exemplar repeats as a whole;
    /// both periods follow from its extent.
    Whole([DVec2; 2]),
    /// There are many lights, but no period. Patches are placed without a lattice.
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

    /// Stretches the lattice so that a texture of `size` unwarped pixels can repeat: its width and its height become
    /// lattice vectors. Laws without a lattice are returned unchanged.
    ///
    /// Errors: `Degenerate` if this is impossible, for example because a side of the texture is shorter than half a
    /// period.
    pub fn fitted(self, size: DVec2) -> Result<Self> {
        let fit = |[a, b]: [DVec2; 2]| {
            // Express the two sides of the texture in lattice coordinates and round these to integers. Then solve for
            // the periods: [a b] = diag(size) N⁻¹, where the columns of N are the integers of the two sides.
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

    /// Returns the lattice with its two shortest periods, each made exactly parallel to an axis if it is nearly
    /// parallel. Laws other than lattices are returned unchanged.
    pub fn aligned(self) -> Self {
        match self {
            Self::Lattice(found) => Self::Lattice(reduced(found).map(aligned)),
            other => other,
        }
    }

    /// Whether the periods are exactly parallel to the axes. Of a row, only the period along the row counts. True for
    /// the other laws: they have no periods, or periods that are parallel to the axes by construction (`Whole`).
    pub fn is_aligned(&self) -> bool {
        let on_axis = |period: DVec2| period.min_element() == 0.0 || period.max_element() == 0.0;
        match *self {
            Self::Lattice([a, b]) => on_axis(a) && on_axis(b),
            Self::Row([along, _]) => on_axis(along),
            Self::Copy | Self::Whole(_) | Self::Free => true,
        }
    }

    /// The lengths of the periods along x and along y in unwarped pixels; `None` for an axis to which no period is
    /// nearly parallel (`MAX_SLANT`). For `Copy`, both are infinite.
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
