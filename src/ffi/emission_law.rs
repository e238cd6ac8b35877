//! Laws of an emission
//!
//! A law is the rule by which an emissive texture continues the lights of its exemplar, for example on a lattice.

use crate::emission::{Law, LawMode};
use crate::error::{Error, Result};

/// The law, that is, the rule by which a texture continues the lights of its exemplar: a LUXFER_LAW_ value.
pub type luxfer_emission_law = i32;
/// In settings only: the law that predicts the lamps of the photo best. The law of LUXFER_LAW_CORRELATION is kept
/// unless another law predicts the lamps clearly better. If luxfer_emission_report.error of the texture then exceeds 1,
/// and there is a single exemplar, the other laws are tried, and the texture with the smallest error is kept. The
/// emission has the warning LUXFER_WARNING_NO_PATTERN even if another law gives a better texture.
pub const LUXFER_LAW_BEST: luxfer_emission_law = 0;
/// In settings only: the law follows from the periods in the autocorrelation of the lights. Two periods give
/// LUXFER_LAW_LATTICE, one period gives LUXFER_LAW_ROW. Without a period, the law is LUXFER_LAW_WHOLE if the exemplar
/// shows few lamps or one isolated group of lamps, and otherwise LUXFER_LAW_FREE. A period counts only if the
/// correlation after a shift by this period is at least the setting min_regularity.
pub const LUXFER_LAW_CORRELATION: luxfer_emission_law = 1;
/// The lamps form a lattice with two periods.
pub const LUXFER_LAW_LATTICE: luxfer_emission_law = 2;
/// The lamps form a row with one period. Across the row, the strip that the exemplar shows is repeated edge to edge.
pub const LUXFER_LAW_ROW: luxfer_emission_law = 3;
/// The exemplar repeats as a whole, edge to edge, in both directions.
pub const LUXFER_LAW_WHOLE: luxfer_emission_law = 4;
/// The lights have no period: patches of the exemplar are placed anywhere in the texture.
pub const LUXFER_LAW_FREE: luxfer_emission_law = 5;
/// In results only: the texture is a copied part of the exemplar, or the caller supplied the texture.
pub const LUXFER_LAW_COPY: luxfer_emission_law = 6;

/// Converts a LUXFER_LAW_ value of the settings to the [`LawMode`] of the synthesis.
pub(super) fn law(number: luxfer_emission_law) -> Result<LawMode> {
    Ok(match number {
        LUXFER_LAW_BEST => LawMode::Best,
        LUXFER_LAW_CORRELATION => LawMode::Correlation,
        LUXFER_LAW_LATTICE => LawMode::Lattice,
        LUXFER_LAW_ROW => LawMode::Row,
        LUXFER_LAW_WHOLE => LawMode::Whole,
        LUXFER_LAW_FREE => LawMode::Free,
        other => {
            let message = format!("emission.law is {other}; it must be a LUXFER_LAW_ value in [0, 5]");
            return Err(Error::argument(message));
        }
    })
}

/// Returns the LUXFER_LAW_ value of a law that the synthesis has used.
pub(super) fn number(law: Law) -> luxfer_emission_law {
    match law {
        Law::Copy => LUXFER_LAW_COPY,
        Law::Lattice(_) => LUXFER_LAW_LATTICE,
        Law::Row(_) => LUXFER_LAW_ROW,
        Law::Whole(_) => LUXFER_LAW_WHOLE,
        Law::Free => LUXFER_LAW_FREE,
    }
}
