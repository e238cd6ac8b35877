//! Shading study (StyLit, §4.2): updates the result while the artist continues painting. Where the result shows changed
//! parts of the artwork, it is synthesised again, starting from the last field. The time for matching and painting is
//! proportional to the affected area. The guides and the artwork are quantised anew as a whole.

use super::border;
use super::level::{Level, Problem, encode, encoded};
use super::multires;
use super::output::{Output, Publish};
use super::params::{Input, Params};
use super::picture::{DecodeInput, decode_into, paint};
use super::report::sources;
use crate::error::{Error, Result};
use crate::image::{Image, try_vec};
use crate::job::Job;
use crate::patch::{Field, NONE, SearchIteration, halve, halve_mask, unpack};

/// Number of iterations of matching and voting after a change.
const ROUNDS: usize = 2;
/// Radius of the random search around a match, in pixels; propagation reaches farther.
const SEARCH_RADIUS: usize = 16;

/// A stylised target that follows changes of its artwork.
pub struct Updater {
    problem: Problem,
    params: Params,
    /// The whole artwork, in linear colour (`artwork`) and encoded for display (`encoded`).
    artwork: Image,
    encoded: Image,
    /// The picture of the target outside its mask, in linear colour.
    known: Option<Image>,
    field: Field,
    /// The last result, encoded for display (`picture`) and in linear colour (`image`).
    picture: Image,
    image: Image,
    /// Artwork pixels changed since the last update of the result (`pending`), and result pixels that are out of date
    /// as a consequence (`old`). A cancelled update leaves some of these flags set.
    pending: Vec<bool>,
    old: Vec<bool>,
}

impl Updater {
    /// Stylises the target once, like [`super::run`].
    pub fn new(input: &Input, params: &Params, publish: Publish, job: Job) -> Result<(Self, Output)> {
        params.check()?;
        let mut problem = Problem::new(input, params, job.part(0.0, 0.03))?;
        let guide_record = problem.guide_record.take();
        let output = multires::run(&problem, guide_record, input, params, publish, job.part(0.03, 1.0))?;
        let mut display = input.artwork.try_clone()?;
        encode(&mut display, job)?;
        let mut picture = output.image.try_clone()?;
        encode(&mut picture, job)?;
        let updater = Self {
            problem,
            params: params.clone(),
            artwork: input.artwork.try_clone()?,
            encoded: display,
            known: input.known.map(Image::try_clone).transpose()?,
            field: output.field.try_clone()?,
            old: try_vec(picture.width * picture.height, false)?,
            picture,
            image: output.image.try_clone()?,
            pending: try_vec(input.artwork.width * input.artwork.height, false)?,
        };
        job.report(1.0);
        Ok((updater, output))
    }

    /// Copies the pixels of `artwork` where the one-channel image `changed` is above 0.5, updates the result, and
    /// returns the new picture in linear colour. `artwork` is linear and has the size of the first artwork. Changed
    /// samples that are not finite count as black. After an error, such as a cancellation, the next call completes the
    /// update.
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
            let painted = artwork.data[pixel.clone()].iter().map(|v| if v.is_finite() { *v } else { 0.0 });
            for ((linear, display), v) in
                self.artwork.data[pixel.clone()].iter_mut().zip(&mut self.encoded.data[pixel]).zip(painted)
            {
                (*linear, *display) = (v, encoded(v));
            }
        }
        let halved;
        let changed = if self.problem.is_of(artwork) {
            self.problem.style.data.copy_from_slice(&self.encoded.data);
            &self.pending
        } else {
            self.problem.style = halve(&self.encoded, job.part(0.0, 0.1))?;
            halved = halve_mask(&self.pending, artwork.width, artwork.height, true)?;
            &halved
        };
        let target = Target { field: &mut self.field, picture: &mut self.picture, old: &mut self.old };
        rematch(&self.problem, target, changed, &self.params, job.part(0.1, 0.9))?;
        let decode_input = DecodeInput {
            field: &self.field,
            problem: &self.problem,
            artwork: &self.artwork,
            known: self.known.as_ref(),
        };
        let old = |i: usize| self.old[i];
        decode_into(&mut self.image, &self.picture, decode_input, job.part(0.9, 1.0), old)?;
        let image = self.image.try_clone()?;
        self.pending.fill(false);
        self.old.fill(false);
        Ok(image)
    }

    /// Returns for each target pixel the position in the artwork from which its paint comes: see `Report::sources`.
    pub fn sources(&self, job: Job) -> Result<Image> {
        sources(&self.field, &self.problem, usize::from(!self.problem.is_of(&self.artwork)), job)
    }
}

/// The state that an update modifies.
struct Target<'a> {
    field: &'a mut Field,
    picture: &'a mut Image,
    old: &'a mut [bool],
}

/// Rematches every target patch whose match contains a changed exemplar pixel, and repaints the pixels that these
/// target patches cover.
fn rematch(problem: &Problem, target: Target, changed: &[bool], params: &Params, job: Job) -> Result<()> {
    let Target { field, picture, old } = target;
    let mut level = Level::new(problem, params, 1.0, params.seed, job.part(0.0, 0.05))?;
    let (patch, width) = (problem.patch, problem.style.width);
    let mut concerned = try_vec(field.at.len(), false)?;
    for (i, concerned) in concerned.iter_mut().enumerate() {
        let (x, y) = unpack(field.at[i]);
        let touches = |row: usize| changed[row * width + x..][..patch].contains(&true);
        *concerned = field.at[i] != NONE && level.wanted.contains_index(i) && (y..y + patch).any(touches);
        if *concerned {
            let (x, y) = (i % field.width, i / field.width);
            (y..y + patch).for_each(|row| old[row * picture.width + x..][..patch].fill(true));
        }
    }

    // Paint the old matches with the new artwork, then iterate matching and voting.
    paint(picture, field, problem, params.vote, job.part(0.0, 0.1), |i| old[i])?;
    for round in 0..ROUNDS {
        let part = |from: f64, to: f64| {
            let n = ROUNDS as f64;
            job.part(0.1 + 0.9 * (round as f64 + from) / n, 0.1 + 0.9 * (round as f64 + to) / n)
        };
        level.set_picture(picture, part(0.0, 0.05))?;
        let search = level.forward();
        search.rescore(field, part(0.0, 0.2), |i| concerned[i])?;
        let iteration = SearchIteration { index: round as u64, radius: SEARCH_RADIUS, initial_samples: 4 };
        search.iterate(field, iteration, part(0.2, 0.8), |i| concerned[i])?;
        let vote_mode = if round + 1 == ROUNDS { params.final_vote } else { params.vote };
        paint(picture, field, problem, vote_mode, part(0.8, 1.0), |i| old[i])?;
        // Fade out the step at the border of the painted part, if the first run has done so.
        if round + 1 == ROUNDS && problem.known.is_some() {
            border::fade(picture, field, problem, vote_mode, part(1.0, 1.0), |i| old[i])?;
        }
    }
    Ok(())
}
