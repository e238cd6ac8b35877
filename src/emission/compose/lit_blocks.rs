//! A coarse map of the light of an exemplar. Most texels are dark; the map finds dark texels without reading the pixels
//! that they show.

use crate::emission::exemplar::Exemplar;
use crate::error::Result;
use crate::image::{Image, try_vec};
use glam::DVec2;

/// Side of a block in unwarped pixels.
const BLOCK: usize = 8;

/// A set of lights of the exemplar.
#[derive(Clone, Copy)]
#[repr(u8)]
pub enum LightSet {
    All = 1,
    /// The lights that are copied patch by patch.
    OfPatches = 2,
}

/// For each block of `BLOCK` × `BLOCK` unwarped pixels, the sets of lights that reach into it. Each [`LightSet`] is one
/// bit of an entry of `sets`.
pub struct LitBlocks {
    columns: usize,
    rows: usize,
    sets: Vec<u8>,
}

impl LitBlocks {
    /// Builds the map from the light mask `light`. Every pixel with light counts for `LightSet::All`. A pixel also
    /// counts for `LightSet::OfPatches` if `is_of_patches` is true for its component, or if it has no component. Pixels
    /// with light but without a component lie at the rim of a lamp: light covers less than half of them.
    pub fn new(exemplar: &Exemplar, light: &Image, is_of_patches: impl Fn(usize) -> bool) -> Result<Self> {
        let (columns, rows) = (exemplar.width.div_ceil(BLOCK), exemplar.height.div_ceil(BLOCK));
        let mut sets = try_vec(columns * rows, 0)?;
        for (pixel, label) in exemplar.components.labels.iter().enumerate() {
            if exemplar.coverage(light, pixel) > 0.0 {
                let (x, y) = (pixel % exemplar.width, pixel / exemplar.width);
                let of_patches = label.checked_sub(1).is_none_or(|component| is_of_patches(component as usize));
                let set = LightSet::All as u8 | if of_patches { LightSet::OfPatches as u8 } else { 0 };
                sets[y / BLOCK * columns + x / BLOCK] |= set;
            }
        }
        Ok(Self { columns, rows, sets })
    }

    /// Whether a light of the set may lie in a square, or less than a pixel from it. The square is given by the corner
    /// with the smallest coordinates, and by its side, in unwarped pixels. False only if there is certainly no light.
    pub fn may_reach(&self, set: LightSet, corner: DVec2, side: f64) -> bool {
        // The cast turns negative coordinates into 0.
        let block = |at: f64| at as usize / BLOCK;
        let range = |at: f64, count: usize| block(at - 1.0)..(block(at + side + 1.0) + 1).min(count);
        let is_lit = |x: usize, y: usize| self.sets[y * self.columns + x] & set as u8 != 0;
        range(corner.y, self.rows).any(|y| range(corner.x, self.columns).any(|x| is_lit(x, y)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emission::params::Input;
    use crate::job::Monitor;

    #[test]
    fn a_square_is_dark_only_if_no_pixel_within_one_pixel_of_it_is_lit() {
        let (unwarped, mut light) = (Image::from_fn(40, 30, |_, _| [1.0; 3]).unwrap(), Image::new(40, 30, 1).unwrap());
        let valid = Image::from_fn(40, 30, |_, _| [1.0]).unwrap();
        (10..14).for_each(|y| (20..26).for_each(|x| light.data[y * 40 + x] = 1.0));
        let input = Input { unwarped: &unwarped, light: &light, valid: &valid, photo: None };
        let exemplar = Exemplar::new(&input, 40.0, 0.0, Monitor::default().job()).unwrap();
        let blocks = LitBlocks::new(&exemplar, &light, |_| false).unwrap();
        for (x, y) in (-20..60).flat_map(|x| (-20..60).map(move |y| (x, y))) {
            let (corner, side) = (DVec2::new(f64::from(x), f64::from(y)), 3.0);
            let [near_x, near_y] = [x + 4 >= 20 && x - 1 < 26, y + 4 >= 10 && y - 1 < 14];
            assert!(blocks.may_reach(LightSet::All, corner, side) || !(near_x && near_y), "{corner}");
            assert!(!blocks.may_reach(LightSet::OfPatches, corner, side));
        }
        assert!(!blocks.may_reach(LightSet::All, DVec2::new(0.0, 0.0), 3.0));
        assert!(!blocks.may_reach(LightSet::All, DVec2::new(1e30, f64::NAN), 3.0));
    }
}
