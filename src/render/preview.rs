//! The filtered picture of a render: adds to the requested outputs the guide images that `denoise` needs, and filters
//! the film.

use super::aov::Aov;
use super::denoise::{self, Input};
use super::film::Accumulator;
use super::output::Film;
use super::params::Params;
use crate::error::{Error, ErrorKind, Result};
use crate::job::Job;

/// Surface attributes that guide the filter.
const GUIDES: [Aov; 3] = [Aov::Albedo, Aov::Normal, Aov::Position];

/// Returns a copy of the parameters. If a preview is requested, the copy also requests the guide images of the filter.
/// Guide images that the caller has not requested are appended to the requested outputs.
pub fn guided(params: &Params) -> Params {
    let mut guided = params.clone();
    if params.preview > 0.0 {
        let asked = &params.outputs.aovs;
        guided.outputs.aovs.extend(GUIDES.into_iter().filter(|guide| !asked.contains(guide)));
    }
    guided
}

/// Adds the preview, if one is requested, to a film rendered with the [`guided`] parameters. Then removes the guide
/// images that the caller has not requested.
pub fn add_preview(film: &mut Film, accumulator: &Accumulator, params: &Params, job: Job) -> Result<()> {
    if params.preview > 0.0 {
        let guide = |aov: Aov| {
            let layer = film.layers.iter().find(|l| l.expression.is_none() && l.name == aov.name());
            layer
                .map(|l| &l.image)
                .ok_or_else(|| Error::new(ErrorKind::Internal, format!("the render has no layer {}", aov.name())))
        };
        let [one, other] = accumulator.halves(job)?;
        let [first, second] = accumulator.half_variances(job)?;
        let input = Input {
            halves: [&one, &other],
            variances: [&first, &second],
            albedo: guide(Aov::Albedo)?,
            normal: guide(Aov::Normal)?,
            position: guide(Aov::Position)?,
        };
        film.preview = Some(denoise::run(&input, &denoise::Params { strength: params.preview }, job)?);
    }
    film.layers.truncate(params.outputs.expressions.len() + params.outputs.aovs.len());
    Ok(())
}
