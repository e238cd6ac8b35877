//! If the first texture clearly differs from the photo, makes textures by other laws, and keeps the best texture. A law
//! is the rule by which the pattern of lamps continues beyond the photo, such as a lattice or a row.
//!
//! The lamps of a photo may suggest a wrong law, for example if bars merge the panes of a skylight, or if the farthest
//! row of lamps is displaced by blur. The score of a law ([`super::analysis::Choice`]) does not show this, but the
//! statistics of the texture do.

use super::analysis::{Analysis, is_same};
use super::assemble::assemble;
use super::compose::composition::Composition;
use super::lattice::law::Law;
use super::output::Emission;
use super::params::{Input, LawMode, Params};
use super::warnings::UNLIT_ERROR;
use crate::error::{ErrorKind, Result};
use crate::job::Job;
use std::mem::discriminant;

const OTHER_LAWS: [LawMode; 4] = [LawMode::Lattice, LawMode::Row, LawMode::Whole, LawMode::Free];

/// Returns the texture that differs least from the photo: `first`, or a texture by another law. Other laws are tried
/// only if `params` leave the law open, and if the error of `first` exceeds the error of a texture without light.
///
/// The error of a texture by another law is the larger of two differences: from the statistics that this law expects,
/// and from the statistics that the law of `first` expects. The second difference is needed because each law weights
/// the parts of the photo in its own way, so that a law may expect hardly any light.
///
/// Errors: cancelled; no memory.
pub fn try_other_laws(first: Emission, input: &Input, params: &Params, job: Job) -> Result<Emission> {
    if !(first.error > UNLIT_ERROR) || params.law != LawMode::Best {
        return Ok(first);
    }
    let (expected, first_error) = (first.statistics[0], first.error);
    let mut tried = vec![first.law];
    let mut best = first;
    for (k, mode) in OTHER_LAWS.into_iter().enumerate() {
        let part = |share: f64| (k as f64 + share) / OTHER_LAWS.len() as f64;
        let params = Params { law: mode, ..params.clone() };
        let analysis = match Analysis::new(input, &params, job.part(part(0.0), part(0.2))) {
            // The lights show no law of the type that `mode` demands.
            Err(error) if error.kind == ErrorKind::Degenerate => continue,
            other => other?,
        };
        if tried.iter().any(|law| is_equal(*law, analysis.law)) {
            continue;
        }
        tried.push(analysis.law);
        let composition = Composition::of(Some(analysis), input, &[], &params, job.part(part(0.2), part(0.6)))?;
        let mut made = assemble(composition, input, &[], &params, job.part(part(0.6), part(1.0)))?;
        made.error = made.error.max(made.statistics[1].difference(&expected));
        if made.error < best.error {
            best = made;
        }
    }
    Ok(Emission { first_error: Some(first_error), ..best })
}

fn is_equal(a: Law, b: Law) -> bool {
    discriminant(&a) == discriminant(&b) && is_same(a, b)
}
