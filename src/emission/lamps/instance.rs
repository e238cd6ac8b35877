//! A lamp of the exemplar in the texture.

use glam::DVec2;

/// A lamp of the exemplar in the texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index of its component in the exemplar.
    pub component: usize,
    /// Where it is shown less where it is taken from, in unwarped pixels.
    pub shift: DVec2,
}

/// A texture that repeats, and its eight neighbours, in sides of it.
pub fn turns() -> impl Iterator<Item = DVec2> {
    (-1..=1).flat_map(|y| (-1..=1).map(move |x| DVec2::new(f64::from(x), f64::from(y))))
}

/// Every lamp again where it comes in when it leaves a texture of this size, in unwarped pixels.
pub fn wrapped(instances: &[Instance], size: DVec2) -> Vec<Instance> {
    instances.iter().flat_map(|i| turns().map(|t| Instance { shift: i.shift + t * size, ..*i })).collect()
}
