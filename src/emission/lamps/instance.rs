//! An instance: a lamp of the exemplar, placed in the texture.

use glam::DVec2;

/// A lamp of the exemplar, placed in the texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index of the lamp's component in the exemplar.
    pub component: usize,
    /// Position in the texture minus position in the exemplar, in unwarped pixels.
    pub shift: DVec2,
}

/// Offsets of a tileable texture and its eight neighbouring copies, as multiples of its sides.
pub fn turns() -> impl Iterator<Item = DVec2> {
    (-1..=1).flat_map(|y| (-1..=1).map(move |x| DVec2::new(f64::from(x), f64::from(y))))
}

/// Copies every lamp into the eight neighbouring copies of a tileable texture. A lamp that leaves the texture on one
/// side then re-enters on the opposite side. `size` is the texture's size in unwarped pixels.
pub fn wrapped(instances: &[Instance], size: DVec2) -> Vec<Instance> {
    instances.iter().flat_map(|i| turns().map(|t| Instance { shift: i.shift + t * size, ..*i })).collect()
}
