//! Removes crumbs: small pieces of light that resampling broke off a lamp.

use crate::emission::exemplar::components::{Component, Components};
use crate::image::Image;

/// Maximum width and height, in texels, of a crumb's bounding box: 2 √`crumb`. Here `crumb` is the area in texels below
/// which a piece of light is a crumb.
pub fn max_side(crumb: f64) -> usize {
    (2.0 * crumb.sqrt()).ceil() as usize
}

/// Removes every connected piece of light whose area is below `crumb` texels and whose bounding box is at most
/// [`max_side`] texels wide and high. Keeps a piece for which `is_cut` returns true, because it is the visible part of
/// a larger light. The arguments of `is_cut` are `[first column, first row]` and `[last column, last row]` of the
/// piece.
pub fn remove(
    texture: &mut Image,
    mask: &mut Image,
    found: &mut Components,
    crumb: f64,
    is_cut: impl Fn([usize; 2], [usize; 2]) -> bool,
) {
    let max_side = max_side(crumb);
    let is_crumb = |piece: &Component| {
        let is_small = (piece.area as f64) < crumb && piece.size().into_iter().all(|s| s <= max_side);
        is_small && !is_cut(piece.min, piece.max)
    };
    let crumbs: Vec<bool> = found.list.iter().map(is_crumb).collect();
    if crumbs.contains(&true) {
        take_out(texture, mask, found, |k, _| crumbs[k]);
        found.remove(|k| crumbs[k]);
    }
}

/// Removes the light of the lamp texels for which `goes` returns true. The arguments of `goes` are the index of the
/// lamp and the index of the texel. A texel beside a lamp may hold light as well, although light covers less than half
/// of it. Its light is removed if all lamp texels among its eight neighbours are removed.
pub fn take_out(texture: &mut Image, mask: &mut Image, found: &Components, goes: impl Fn(usize, usize) -> bool) {
    let (width, height) = (mask.width, mask.height);
    let lamp = |i: usize| (found.labels[i] as usize).checked_sub(1);
    for i in 0..width * height {
        let is_out = match lamp(i) {
            Some(k) => goes(k, i),
            None if texture.data[3 * i..3 * i + 3] == [0.0; 3] => false,
            None => {
                let (x, y) = (i % width, i / width);
                let columns = x.saturating_sub(1)..(x + 2).min(width);
                let rows = y.saturating_sub(1)..(y + 2).min(height);
                let mut near =
                    rows.flat_map(|v| columns.clone().map(move |u| v * width + u)).filter_map(|j| Some((lamp(j)?, j)));
                let first = near.next();
                first.into_iter().chain(near).all(|(k, j)| goes(k, j)) && first.is_some()
            }
        };
        if is_out {
            texture.data[3 * i..3 * i + 3].fill(0.0);
            mask.data[i] = 0.0;
        }
    }
}
