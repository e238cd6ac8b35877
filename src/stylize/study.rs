//! Shading study (§4.2): the artist goes on painting, and what was made from the changed part of the artwork is made
//! anew, starting from the field of the last result. The cost of matching is that of the places concerned.

use super::level::{Level, Problem, encode, encoded};
use super::report::sources;
use super::schedule::{self, paint};
use super::{Input, Output, Params, Publish};
use crate::error::{Error, Result};
use crate::image::{Image, try_vec};
use crate::job::Job;
use crate::patch::{Field, NONE, Sweep, halve, halve_mask, unpack};

/// Rounds of matching and voting after a change.
const ROUNDS: usize = 2;
/// Random search goes this far, in pixels; propagation goes farther.
const REACH: usize = 16;

/// A stylised target that follows its artwork.
pub struct Study {
    problem: Problem,
    params: Params,
    /// The whole artwork, linear and encoded for display.
    artwork: Image,
    encoded: Image,
    /// What the target shows outside its mask, linear.
    known: Option<Image>,
    field: Field,
    /// Pixels of the artwork that have changed since the field was last brought up to date: a cancelled update leaves some.
    pending: Vec<bool>,
}

impl Study {
    /// Stylises the target once, as [`super::run`] does.
    pub fn new(input: &Input, params: &Params, publish: Publish, job: Job) -> Result<(Self, Output)> {
        params.check()?;
        let problem = Problem::new(input, params, job.part(0.0, 0.03))?;
        let output = schedule::run(&problem, input, params, publish, job.part(0.03, 1.0))?;
        let mut display = input.artwork.try_clone()?;
        encode(&mut display, job)?;
        let study = Self {
            problem,
            params: params.clone(),
            artwork: input.artwork.try_clone()?,
            encoded: display,
            known: input.known.map(Image::try_clone).transpose()?,
            field: output.field.try_clone()?,
            pending: try_vec(input.artwork.width * input.artwork.height, false)?,
        };
        job.report(1.0);
        Ok((study, output))
    }

    /// Takes over the pixels of `artwork` (linear, of the first one's size) where the one-channel `changed` is above
    /// 0.5, and returns the new picture, linear. A change that is no number counts as black. After an error (a cancel) the
    /// next call brings up to date what this one has not.
    pub fn repaint(&mut self, artwork: &Image, changed: &Image, job: Job) -> Result<Image> {
        self.artwork.check_same_size("the first artwork", artwork, "artwork")?;
        self.artwork.check_same_size("artwork", changed, "changed")?;
        if artwork.channels != self.artwork.channels || changed.channels != 1 {
            return Err(Error::argument(format!(
                "artwork has {} channels and changed {}; they must have {} and 1",
                artwork.channels, changed.channels, self.artwork.channels
            )));
        }
        let channels = artwork.channels;
        for i in (0..changed.data.len()).filter(|&i| changed.data[i] > 0.5) {
            self.pending[i] = true;
            let pixel = i * channels..(i + 1) * channels;
            self.artwork.data[pixel.clone()].copy_from_slice(&artwork.data[pixel.clone()]);
            self.encoded.data[pixel.clone()].iter_mut().zip(&artwork.data[pixel]).for_each(|(e, v)| *e = encoded(*v));
        }
        let halved;
        let changed = if self.problem.is_of(artwork) {
            self.problem.style.data.copy_from_slice(&self.encoded.data);
            &self.pending
        } else {
            self.problem.style = halve(&self.encoded, job.part(0.0, 0.1))?;
            halved = halve_mask(&self.pending, artwork.width, artwork.height, true);
            &halved
        };
        let picture = rematch(&self.problem, &mut self.field, changed, &self.params, job.part(0.1, 0.9))?;
        let job = job.part(0.9, 1.0);
        let image = schedule::finish(&picture, &self.field, &self.problem, &self.artwork, self.known.as_ref(), job)?;
        self.pending.fill(false);
        Ok(image)
    }

    /// Where in the artwork each pixel comes from now: see `Report::sources`.
    pub fn sources(&self, job: Job) -> Result<Image> {
        sources(&self.field, &self.problem, usize::from(!self.problem.is_of(&self.artwork)), job)
    }
}

/// Matches every target patch anew that shows a changed exemplar pixel, and returns the encoded picture.
fn rematch(problem: &Problem, field: &mut Field, changed: &[bool], params: &Params, job: Job) -> Result<Image> {
    let mut level = Level::new(problem, params, 1.0, params.seed, job.part(0.0, 0.05))?;
    let (patch, width) = (problem.patch, problem.style.width);
    let concerned: Vec<bool> = (field.at.iter().enumerate())
        .map(|(i, &at)| {
            let (x, y) = unpack(at);
            let touches = |row: usize| changed[row * width + x..][..patch].contains(&true);
            at != NONE && level.wanted.contains_index(i) && (y..y + patch).any(touches)
        })
        .collect();

    // The new paint in the old places, then matching and voting.
    let mut picture = problem.blank_picture()?;
    paint(&mut picture, field, problem, &level, params.vote, job.part(0.0, 0.1))?;
    for round in 0..ROUNDS {
        let part = |from: f64, to: f64| {
            let n = ROUNDS as f64;
            job.part(0.1 + 0.9 * (round as f64 + from) / n, 0.1 + 0.9 * (round as f64 + to) / n)
        };
        level.set_picture(&picture, part(0.0, 0.05))?;
        let search = level.forward();
        search.rescore(field, part(0.0, 0.2), |i| concerned[i])?;
        let sweep = Sweep { index: round as u64, reach: REACH, fresh: 4 };
        search.sweep(field, sweep, part(0.2, 0.8), |i| concerned[i])?;
        let how = if round + 1 == ROUNDS { params.final_vote } else { params.vote };
        paint(&mut picture, field, problem, &level, how, part(0.8, 1.0))?;
    }
    Ok(picture)
}
