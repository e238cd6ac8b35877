//! Finds the part of the exemplar that a texture copies if it fits inside the exemplar.

use super::border_cuts::BorderCuts;
use crate::emission::exemplar::{Exemplar, area_sums::AreaSums};
use crate::emission::params::Params;
use crate::emission::quilt::patch_map::{PatchMap, Shift};
use crate::error::Result;
use glam::DVec2;
use std::cmp::Ordering;

/// Parts of the exemplar count as equally bright if their lit shares differ from the lit share of the exemplar by at
/// most this much more than the lit share of the best part does, relative to the lit share of the exemplar.
/// [convention: a tenth]
const MAX_LIT_DIFFERENCE: f64 = 0.1;

/// Parts of the exemplar count as equally sharp if unwarping magnifies them at most this many times as much as the
/// least magnified part ([`Exemplar::magnification`]). [convention: a quarter more]
const MAX_MAGNIFICATION_RATIO: f64 = 1.25;

/// A part of the exemplar with the size of the texture, given by its upper left corner in unwarped pixels.
pub struct Window {
    pub corner: DVec2,
    /// Whether the texture copies this part. False if the photo does not show every pixel of the part, or if a lattice
    /// gives the positions of the lamps. `corner` then only gives the position of the lattice.
    pub is_shown: bool,
}

impl Window {
    /// Finds the part of the exemplar to copy. Candidates are all parts with the size of the texture that the photo
    /// shows completely. Of the parts whose lit share is closest to the lit share of the exemplar
    /// ([`MAX_LIT_DIFFERENCE`]), the parts are chosen that unwarping magnifies least at their centres
    /// ([`MAX_MAGNIFICATION_RATIO`]), and of these the part whose border cuts the fewest lamps. It is then moved by the
    /// negative of `params.offset`. `None` if the photo shows no part of this size completely.
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
        let corners = || {
            let all = (0..=exemplar.height - h).flat_map(|y| (0..=exemplar.width - w).map(move |x| (x, y)));
            all.filter(|&(x, y)| shown.count(x, y, w, h) == w * h)
        };
        let difference = |(x, y): (usize, usize)| (lit.count(x, y, w, h) as f64 - target).abs();
        let allowed = corners().map(difference).fold(f64::INFINITY, f64::min) + MAX_LIT_DIFFERENCE * target;
        let corner = |(x, y): (usize, usize)| DVec2::new(x as f64, y as f64);
        let half = DVec2::new(w as f64, h as f64) / 2.0;
        let magnification = |at| exemplar.magnification(corner(at) + half);
        let bright = || corners().filter(|&at| difference(at) <= allowed);
        let least = bright().map(magnification).fold(f64::INFINITY, f64::min);
        let sharp = bright().filter(|&at| magnification(at) <= MAX_MAGNIFICATION_RATIO * least);
        let cuts = BorderCuts::new(exemplar, [w, h])?;
        let rated = sharp.map(|at| ([cuts.at(at) as f64, magnification(at), difference(at)], at));
        let best = rated.min_by(|(p, _), (q, _)| {
            p.iter().zip(q).map(|(p, q)| p.total_cmp(q)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
        });
        Ok(best.map(|(_, best)| {
            let corner = corner(best) - (params.offset * params.scale).round();
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
