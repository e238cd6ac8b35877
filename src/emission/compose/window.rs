//! Finds the part of the exemplar that a texture copies if it fits inside the exemplar.

use crate::emission::exemplar::{Exemplar, area_sums::AreaSums};
use crate::emission::params::Params;
use crate::emission::quilt::patch_map::{PatchMap, Shift};
use crate::error::Result;
use glam::DVec2;

/// A part of the exemplar with the size of the texture, given by its upper left corner in unwarped pixels.
pub struct Window {
    pub corner: DVec2,
    /// Whether the texture copies this part. False if the photo does not show every pixel of the part, or if its lamps
    /// are drawn anew with clean outlines. `corner` then only gives the position of the lattice.
    pub is_shown: bool,
}

impl Window {
    /// Finds the part of the exemplar to copy. Candidates are all parts with the size of the texture that the photo
    /// shows completely. The part is chosen whose lit share is closest to the lit share of the exemplar. It is then
    /// moved by the negative of `params.offset`. `None` if the photo shows no part of this size completely.
    pub fn find(exemplar: &Exemplar, params: &Params) -> Result<Option<Self>> {
        let side = |n: usize| (n as f64 * params.scale - 1e-9).ceil().max(1.0);
        let (w, h) = (side(params.width), side(params.height));
        if w > exemplar.width as f64 || h > exemplar.height as f64 {
            return Ok(None);
        }
        let (w, h) = (w as usize, h as usize);
        let shown = AreaSums::new(|i| exemplar.shown[i], exemplar.width, exemplar.height)?;
        let lit = AreaSums::new(|i| exemplar.components.labels[i] != 0, exemplar.width, exemplar.height)?;
        let target = exemplar.lit_share * (w * h) as f64;
        let mut best: Option<(f64, DVec2)> = None;
        for y in 0..=exemplar.height - h {
            for x in 0..=exemplar.width - w {
                if shown.count(x, y, w, h) == w * h {
                    let off = (lit.count(x, y, w, h) as f64 - target).abs();
                    if best.is_none_or(|b| off < b.0) {
                        best = Some((off, DVec2::new(x as f64, y as f64)));
                    }
                }
            }
        }
        Ok(best.map(|(_, best)| {
            let corner = best - (params.offset * params.scale).round();
            let inside = corner.cmpge(DVec2::ZERO).all()
                && corner.x + w as f64 <= exemplar.width as f64
                && corner.y + h as f64 <= exemplar.height as f64;
            let is_shown = inside && shown.count(corner.x as usize, corner.y as usize, w, h) == w * h;
            Self { corner, is_shown }
        }))
    }
}

/// The patch map of a texture that copies a part of the exemplar: a single shift.
pub fn copy(corner: DVec2, (width, height): (usize, usize), pitch: DVec2) -> PatchMap {
    let working = (-corner / pitch).round();
    PatchMap::single(width, height, Shift { working: [working.x as i32, working.y as i32], exact: -corner })
}
