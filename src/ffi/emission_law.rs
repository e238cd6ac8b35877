//! The numbers of laws: how the lights of an exemplar go on.

use super::emission::*;
use crate::emission::{Continuation, Law};
use crate::error::{Error, Result};

/// The law that a number asks for.
pub(super) fn law(number: luxfer_emission_law) -> Result<Law> {
    Ok(match number {
        LUXFER_LAW_BEST => Law::Best,
        LUXFER_LAW_CORRELATION => Law::Correlation,
        LUXFER_LAW_LATTICE => Law::Lattice,
        LUXFER_LAW_ROW => Law::Row,
        LUXFER_LAW_WHOLE => Law::Whole,
        LUXFER_LAW_FREE => Law::Free,
        other => {
            let message = format!("emission.law is {other}; it must be a LUXFER_LAW_ value in [0, 5]");
            return Err(Error::argument(message));
        }
    })
}

/// The number of a law that was found.
pub(super) fn number(continuation: Continuation) -> luxfer_emission_law {
    match continuation {
        Continuation::Copy => LUXFER_LAW_COPY,
        Continuation::Lattice(_) => LUXFER_LAW_LATTICE,
        Continuation::Row(_) => LUXFER_LAW_ROW,
        Continuation::Tile(_) => LUXFER_LAW_WHOLE,
        Continuation::Free => LUXFER_LAW_FREE,
    }
}
