//! Tests whether a period moves lamps onto lamps of their kind.

use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::components::Component;
use glam::DVec2;

/// Two lamps are of one kind if their widths and their heights differ by at most this share of the larger value, or by
/// at most two unwarped pixels. [judged on 5 photos]
const MAX_SIDE_DIFFERENCE: f64 = 0.33;
/// A shift is not a period if, among the lamps that it moves onto lamps, more than this share land on a lamp of
/// another kind. [judged on 5 photos]
const MAX_UNLIKE: f64 = 0.4;
/// Maximum number of lamps that are tested. [bench emission:seconds]
const MAX_LAMPS: usize = 200;

/// Whether a shift, in unwarped pixels, moves lamps onto lamps of their kind. Ignores lamps that the shift moves onto
/// no lamp. The test is needed because the autocorrelation is also high at a shift that moves, for example, a row of
/// narrow panes onto a row of wide panes.
pub fn keeps_kinds(exemplar: &Exemplar, shift: DVec2) -> bool {
    let all: Vec<_> = exemplar.lamps().collect();
    let size = |lamp: &Component| DVec2::new(lamp.size()[0] as f64, lamp.size()[1] as f64);
    let (mut like, mut unlike) = (0, 0);
    for lamp in all.iter().step_by(all.len().div_ceil(MAX_LAMPS).max(1)) {
        let at = lamp.centre + shift;
        let is_hit = |other: &&&Component| {
            let max_offset = (size(other) + size(lamp)) / 4.0;
            (other.centre - at).abs().cmple(max_offset).all()
        };
        if let Some(other) = all.iter().find(is_hit) {
            let (a, b) = (size(lamp), size(other));
            let is_like = (a.max(b) - a.min(b)).cmple((MAX_SIDE_DIFFERENCE * a.max(b)).max(DVec2::splat(2.0))).all();
            if is_like { like += 1 } else { unlike += 1 }
        }
    }
    f64::from(unlike) <= MAX_UNLIKE * f64::from(like + unlike)
}
