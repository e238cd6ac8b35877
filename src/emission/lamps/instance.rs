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

/// The nine vectors (x, y) with x and y in {-1, 0, 1}: the offsets, in units of the texture's sides, from a tileable
/// texture to itself and to its eight neighbouring copies.
pub fn neighbour_offsets() -> impl Iterator<Item = DVec2> {
    (-1..=1).flat_map(|y| (-1..=1).map(move |x| DVec2::new(f64::from(x), f64::from(y))))
}

/// Returns every lamp nine times: in the tileable texture itself and in its eight neighbouring copies. If the result is
/// drawn in the texture alone, a lamp that crosses one side re-enters on the opposite side. `size` is the texture's
/// size in unwarped pixels.
pub fn wrapped(instances: &[Instance], size: DVec2) -> Vec<Instance> {
    instances.iter().flat_map(|i| neighbour_offsets().map(|t| Instance { shift: i.shift + t * size, ..*i })).collect()
}
