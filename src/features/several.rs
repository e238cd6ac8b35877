//! Features for several planes of one photo.

use super::grow::{self, Surfaces};
use super::input::{Input, Params, PlaneStroke, RoomView};
use super::search::{self, PlaneEvidence};
use super::{Features, clean};
use crate::error::{Error, Result};
use crate::job::Job;

/// Computes the features of a photo for several planes with strokes of their own. The planes share the image of
/// features and, if the built-in layout is used, one box for the strokes of all planes. Each plane has the surfaces
/// over which its own strokes have grown. Ignores the strokes of `input.room`. The results are in the order of
/// `planes`, and do not depend on it otherwise.
///
/// Errors: as for [`super::run`]; also if there is no plane.
pub fn run_for_planes(input: &Input, planes: &[&[PlaneStroke]], params: &Params, job: Job) -> Result<Vec<Features>> {
    params.check()?;
    let (photo, _) = clean::clean(input.photo, job.part(0.0, 0.05))?;
    let mut surfaces: Vec<Option<Surfaces>> = Vec::with_capacity(planes.len());
    for strokes in planes {
        surfaces.push(grow::grow(&photo, if input.room.is_some() { strokes } else { &[] }, job.part(0.05, 0.1))?);
    }
    let room = match &input.room {
        None => None,
        Some(room) if input.depth.is_some() || room.layout.is_some() => Some(RoomView { strokes: &[], ..*room }),
        Some(room) => {
            let evidence: Vec<PlaneEvidence> = planes
                .iter()
                .zip(&surfaces)
                .map(|(strokes, surfaces)| PlaneEvidence { strokes, surfaces: surfaces.as_ref() })
                .collect();
            let size = [input.photo.width, input.photo.height];
            let layout = search::find_common(room, &evidence, size, job.part(0.1, 0.4))?;
            Some(RoomView { strokes: &[], layout: Some(layout), ..*room })
        }
    };
    let shared = super::run(&Input { room, ..*input }, params, job.part(0.4, 1.0))?;
    if surfaces.is_empty() {
        return Err(Error::argument("there is no plane; give the strokes of at least one"));
    }
    Ok(surfaces.into_iter().map(|surfaces| Features { surfaces, ..shared.clone() }).collect())
}
