//! Classifies the components by role: whole lamp, part of a lamp, or a light that runs through the exemplar.

use super::components::{Component, Components};
use crate::maths;
use std::ops::RangeInclusive;

/// A light cut by the border resembles a whole lamp if its sides are at most this many times the whole lamp's sides.
/// [judged on 5 photos]
const MAX_CUT_RATIO: f64 = 1.35;
/// A lamp at the border counts as whole if the number of its border pixels is at most this share of its width, because
/// masks fray. The width is the lamp's area divided by the diagonal of its bounding box. A square lamp that the border
/// cuts exceeds the limit. A disc does not exceed it as long as less than about a hundredth of its area is cut off.
/// [judged on 5 photos]
const MAX_WHOLE_CONTACT: f64 = 0.6;
/// A light runs through the exemplar along x if hardly any visible pixels lie to its left and right: of the pixels that
/// the photo shows in the rows of the light, at least this share lies between the first and the last column of the
/// light. Along y, rows and columns are exchanged. The share is less than 1 because masks fray at the border of the
/// photo. [convention: 3 pixels in 100]
const MIN_THROUGH_SPAN: f64 = 0.97;

/// The role of a component of the exemplar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A lamp that the photo shows completely.
    Whole,
    /// A lamp that counts as whole although a few of its pixels touch the border.
    WholeAtBorder,
    /// The visible part of a lamp that the border cuts and that resembles a whole lamp. The texture does not show it:
    /// whole lamps take its place. Fragments ([`super::fragments`]) get this role as well.
    Cut,
    /// A light that the border cuts and that resembles no whole lamp. The visible part is copied as one piece.
    Partial,
    /// A light that runs through the whole region that the photo shows. It is copied patch by patch, not as one piece.
    Through,
}

impl Role {
    /// Whether the component is a lamp that the photo shows completely, or that counts as whole.
    pub fn is_whole(self) -> bool {
        matches!(self, Self::Whole | Self::WholeAtBorder)
    }

    /// Whether the component is copied as one piece.
    pub fn is_piece(self) -> bool {
        self.is_whole() || self == Self::Partial
    }
}

/// Finds the role of each component of a `width` × `height` image. `shown` tells which pixels the photo shows.
pub fn classify(components: &Components, shown: &[bool], width: usize, height: usize) -> Vec<Role> {
    let contacts = contacts(components, shown, width, height);
    let is_whole = |(c, &n): (&Component, &usize)| {
        let [across, down] = c.size().map(|s| s as f64);
        n as f64 <= MAX_WHOLE_CONTACT * c.area as f64 / maths::hypot(across, down)
    };
    let whole: Vec<bool> = components.list.iter().zip(&contacts).map(is_whole).collect();
    let sizes: Vec<[usize; 2]> =
        components.list.iter().zip(&whole).filter(|(_, w)| **w).map(|(c, _)| c.size()).collect();
    let resembles_whole =
        |c: &Component| sizes.iter().any(|size| (0..2).all(|k| c.size()[k] as f64 <= size[k] as f64 * MAX_CUT_RATIO));
    let role = |((c, &whole), &contacts): ((&Component, &bool), &usize)| match () {
        () if whole && contacts == 0 => Role::Whole,
        () if whole => Role::WholeAtBorder,
        () if resembles_whole(c) => Role::Cut,
        () if runs_through(c, shown, width, height) => Role::Through,
        () => Role::Partial,
    };
    components.list.iter().zip(&whole).zip(&contacts).map(role).collect()
}

/// Counts the pixels of each component at the border of the image or of the region that the photo shows.
fn contacts(components: &Components, shown: &[bool], width: usize, height: usize) -> Vec<usize> {
    let mut contacts = vec![0usize; components.list.len()];
    for (i, &label) in components.labels.iter().enumerate().filter(|(_, l)| **l != 0) {
        let (x, y) = (i % width, i / width);
        let inside = x > 0 && y > 0 && x + 1 < width && y + 1 < height;
        if !(inside && shown[i - 1] && shown[i + 1] && shown[i - width] && shown[i + width]) {
            contacts[label as usize - 1] += 1;
        }
    }
    contacts
}

/// Whether a component reaches from one border of the visible region to the opposite one, along x or along y.
fn runs_through(c: &Component, shown: &[bool], width: usize, height: usize) -> bool {
    let count = |xs: RangeInclusive<usize>, ys: RangeInclusive<usize>| {
        let row = |y: usize| shown[y * width..][xs.clone()].iter().filter(|shown| **shown).count();
        ys.map(row).sum::<usize>() as f64
    };
    let [columns, rows] = [0, 1].map(|axis| c.min[axis]..=c.max[axis]);
    let inside = count(columns.clone(), rows.clone());
    inside >= MIN_THROUGH_SPAN * count(0..=width - 1, rows)
        || inside >= MIN_THROUGH_SPAN * count(columns, 0..=height - 1)
}
