//! A lamp of the exemplar in the texture.

use glam::DVec2;

/// A lamp of the exemplar in the texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index of its component in the exemplar.
    pub component: usize,
    /// Place in the texture minus place in the exemplar, in unwarped pixels.
    pub shift: DVec2,
}

/// Offsets of a repeating texture and of its eight neighbours, as multiples of its sides.
pub fn turns() -> impl Iterator<Item = DVec2> {
    (-1..=1).flat_map(|y| (-1..=1).map(move |x| DVec2::new(f64::from(x), f64::from(y))))
}

/// Copies every lamp to the eight neighbours of a texture of this size, in unwarped pixels, so that a lamp that leaves
/// the texture on one side comes in on the opposite side.
pub fn wrapped(instances: &[Instance], size: DVec2) -> Vec<Instance> {
    instances.iter().flat_map(|i| turns().map(|t| Instance { shift: i.shift + t * size, ..*i })).collect()
}
