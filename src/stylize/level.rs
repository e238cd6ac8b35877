//! The stylisation problem at one pyramid level: in floating point ([`Problem`]), and quantised for matching
//! ([`Level`]).

use super::directions::with_normals;
use super::guide_record::GuideRecord;
use super::guides::{Channels, no_guides};
use super::lack::LightSamples;
use super::params::{Input, Params, check_side};
use super::pca;
use crate::error::{Error, Result};
use crate::exec;
use crate::image::colour::linear_to_srgb;
use crate::image::{Image, try_collect, try_vec};
use crate::job::Job;
use crate::maths;
use crate::patch::{Domain, Kernel, QuantisedImage, Quantiser, Search, halve, halve_mask};

/// The problem at one pyramid level, in floating-point numbers. The next coarser problem is derived from it.
pub(super) struct Problem {
    pub patch: usize,
    /// Artwork, encoded for display (sRGB).
    pub style: Image,
    pub guides: Channels,
    /// Exemplar pixels from which patches may be taken; all if `None`.
    pub source_mask: Option<Vec<bool>>,
    /// Target pixels to synthesise; all if `None`.
    pub target_mask: Option<Vec<bool>>,
    /// Colours of the target outside `target_mask`, encoded for display.
    pub known: Option<Image>,
    /// Number of non-finite pixels in the exemplar (`.0`) and in the target (`.1`).
    pub broken: (usize, usize),
    /// The target's guides for the next frame of a sequence. A run moves the record out of the problem, which leaves
    /// `None`. Coarse levels have none.
    pub guide_record: Option<GuideRecord>,
    /// Samples of the guides of light; `None` on coarse levels, and if no guide of light has a weight above 0.
    pub light: Option<LightSamples>,
    /// Weight of [`Input::normals`]: 0 if they are not used.
    pub normals_weight: f32,
}

impl Problem {
    pub fn new(input: &Input, params: &Params, job: Job) -> Result<Self> {
        let artwork = input.artwork;
        check_side("artwork", artwork)?;
        if ![1, 3, 4].contains(&artwork.channels) {
            return Err(Error::argument(format!("artwork has {} channels; it must have 1, 3 or 4", artwork.channels)));
        }
        let first = input.guides.first().ok_or_else(no_guides)?;
        check_side(&first.side("target"), first.target)?;
        artwork.check_same_size("artwork", first.source, &first.side("source"))?;
        // A preview works at half the resolution if the halved images are at least as large as a patch.
        let sides = [artwork.width, artwork.height, first.target.width, first.target.height];
        let shortest = sides.into_iter().min().unwrap_or(1);
        let half = params.preview && shortest >= 2 * params.patch;
        let mut source_mask = mask("source_mask", input.source_mask, first.source)?;
        let mut target_mask = mask("target_mask", input.target_mask, first.target)?;
        let (chosen, normals_weight) = with_normals(input, source_mask.as_deref(), job)?;
        let mut guides = Channels::new(&chosen, params.match_appearance, half, job)?;
        let mut style = artwork.try_clone()?;

        // Mask out non-finite exemplar pixels.
        let pixels = style.data.chunks_exact(style.channels);
        let mut broken = try_collect(pixels.map(|p| p.iter().any(|v| !v.is_finite())))?;
        encode(&mut style, job)?;
        let mut known =
            input.known.map(|known| encode_known(known, first.target, artwork.channels, job)).transpose()?;
        if half {
            (broken, style) = (halve_mask(&broken, style.width, style.height, true)?, halve(&style, job)?);
            source_mask = halve_source_mask(source_mask.as_deref(), artwork)?;
            let (width, height) = (first.target.width, first.target.height);
            target_mask = target_mask.map(|m| halve_mask(&m, width, height, true)).transpose()?;
            known = known.map(|k| halve(&k, job)).transpose()?;
        }
        broken.iter_mut().zip(&guides.broken_source).for_each(|(a, b)| *a |= b);
        let counts = (broken.iter().filter(|b| **b).count(), guides.broken_target.iter().filter(|b| **b).count());
        if counts.0 > 0 {
            let mask = match &mut source_mask {
                Some(mask) => mask,
                none => none.insert(try_vec(broken.len(), true)?),
            };
            mask.iter_mut().zip(&broken).for_each(|(m, b)| *m &= !b);
        }
        check_motion(input, first.target)?;
        // Reduce the patch to an odd width that fits.
        let patch = if params.patch <= shortest { params.patch } else { (shortest - 1) | 1 };
        let guide_record = Some(GuideRecord::of(&guides, normals_weight, patch, job)?);
        let light = LightSamples::of(&guides, source_mask.as_deref())?;
        if params.preview {
            pca::compress(&mut guides, job)?;
        }
        Ok(Self {
            patch,
            style,
            guides,
            source_mask,
            target_mask,
            known,
            broken: counts,
            guide_record,
            light,
            normals_weight,
        })
    }

    /// Returns the shortest side of exemplar and target, in pixels.
    pub fn shortest_side(&self) -> usize {
        let (s, t) = (&self.style, &self.guides.target);
        s.width.min(s.height).min(t.width).min(t.height)
    }

    /// Whether the problem has the full size of the artwork; false for a preview at half the resolution.
    pub fn is_of(&self, artwork: &Image) -> bool {
        (self.style.width, self.style.height) == (artwork.width, artwork.height)
    }

    /// Returns the given picture of the target (`known`), encoded for display, or a black picture if none was given.
    pub fn blank_picture(&self) -> Result<Image> {
        match &self.known {
            Some(known) => known.try_clone(),
            None => Image::new(self.guides.target.width, self.guides.target.height, self.style.channels),
        }
    }

    /// Returns the problem at half the resolution.
    pub fn halve(&self, job: Job) -> Result<Self> {
        let (source, target) = (&self.guides.source, &self.guides.target);
        Ok(Self {
            patch: self.patch,
            style: halve(&self.style, job)?,
            source_mask: halve_source_mask(self.source_mask.as_deref(), source)?,
            target_mask: (self.target_mask.as_ref())
                .map(|m| halve_mask(m, target.width, target.height, true))
                .transpose()?,
            known: self.known.as_ref().map(|k| halve(k, job)).transpose()?,
            guides: Channels {
                source: halve(source, job)?,
                target: halve(target, job)?,
                weights: self.guides.weights.clone(),
                is_light: self.guides.is_light.clone(),
                broken_source: Vec::new(),
                broken_target: Vec::new(),
            },
            broken: self.broken,
            guide_record: None,
            light: None,
            normals_weight: self.normals_weight,
        })
    }
}

/// Checks the motion, if any, against the target of the guides.
fn check_motion(input: &Input, target: &Image) -> Result<()> {
    let Some(motion) = input.motion else { return Ok(()) };
    motion.check_same_size("motion", target, "the target of the guides")?;
    if motion.channels != 2 || input.previous.is_none() {
        return Err(Error::argument(format!(
            "motion has {} channels and previous is {}; motion needs 2 channels and a previous field",
            motion.channels,
            if input.previous.is_some() { "given" } else { "missing" }
        )));
    }
    Ok(())
}

/// Halves the mask of usable exemplar pixels; `of` gives the size of the mask. A coarse pixel is usable if all fine
/// pixels under it are usable. If no coarse pixel of the whole mask is usable by this rule, each coarse pixel with at
/// least one usable fine pixel is usable instead. A mask of thin regions alone then does not become empty.
fn halve_source_mask(mask: Option<&[bool]>, of: &Image) -> Result<Option<Vec<bool>>> {
    let Some(mask) = mask else { return Ok(None) };
    let inside = halve_mask(mask, of.width, of.height, false)?;
    Ok(Some(if inside.contains(&true) { inside } else { halve_mask(mask, of.width, of.height, true)? }))
}

/// Thresholds a mask at 0.5. The mask must have the size of `of` and at least one pixel set.
fn mask(name: &str, mask: Option<&Image>, of: &Image) -> Result<Option<Vec<bool>>> {
    let Some(mask) = mask else { return Ok(None) };
    mask.check_same_size(name, of, "the guides of its side")?;
    if mask.channels != 1 {
        return Err(Error::argument(format!("{name} has {} channels; it must have 1", mask.channels)));
    }
    let set = try_collect(mask.data.iter().map(|&v| v > 0.5))?;
    if !set.contains(&true) {
        return Err(Error::degenerate(format!("{name} is empty: no pixel is above 0.5")));
    }
    Ok(Some(set))
}

/// Encodes linear colours for display, in place; non-finite values become black.
pub(super) fn encode(image: &mut Image, job: Job) -> Result<()> {
    let row_len = image.row_len();
    exec::for_rows(&mut image.data, row_len, job, |_, row| row.iter_mut().for_each(|v| *v = encoded(*v)))
}

pub(super) fn encoded(linear: f32) -> f32 {
    if linear.is_finite() { linear_to_srgb(linear) } else { 0.0 }
}

fn encode_known(known: &Image, target: &Image, channels: usize, job: Job) -> Result<Image> {
    known.check_same_size("known", target, "the target of the guides")?;
    if known.channels != channels {
        return Err(Error::argument(format!(
            "known has {} channels and the artwork {channels}; they must have the same number",
            known.channels
        )));
    }
    let mut encoded = known.try_clone()?;
    encode(&mut encoded, job)?;
    Ok(encoded)
}

/// The problem at one pyramid level, with quantised guides and colours.
pub(super) struct Level<'a> {
    pub problem: &'a Problem,
    pub source: QuantisedImage,
    pub target: QuantisedImage,
    /// Exemplar patches that may be used (`allowed`), and target patches that need a match (`wanted`).
    pub allowed: Domain,
    pub wanted: Domain,
    colours: Vec<Quantiser>,
    /// Squared difference, in quantised units, of two samples that differ by 1 and have weight 1.
    unit: f64,
    pub kernel: Kernel,
    pub seed: u64,
}

impl<'a> Level<'a> {
    /// Quantises the guides, and the artwork unless its weight `colour` is 0.
    pub fn new(problem: &'a Problem, params: &Params, colour: f64, seed: u64, job: Job) -> Result<Self> {
        let (style, guides) = (&problem.style, &problem.guides);
        let channels = style.channels;
        let mut weights = vec![colour / channels as f64; channels];
        weights.extend(guides.weights.iter().map(|w| w * f64::from(params.guide_weight)));
        // If all weights are 0, all matches are equally good: give one channel the smallest positive weight.
        if weights.iter().all(|&w| w == 0.0) {
            weights[channels] = f64::MIN_POSITIVE;
        }
        let unit = maths::powi(Quantiser::unit(&weights, problem.patch), 2);
        let mut quantisers = Quantiser::for_weights(&weights, problem.patch);
        let guide_quantisers = quantisers.split_off(channels);

        let mut source = QuantisedImage::new(style.width, style.height, weights.len())?;
        let mut target = QuantisedImage::new(guides.target.width, guides.target.height, weights.len())?;
        source.fill(0, &quantisers, style, job.part(0.0, 0.2))?;
        source.fill(channels, &guide_quantisers, &guides.source, job.part(0.2, 0.6))?;
        target.fill(channels, &guide_quantisers, &guides.target, job.part(0.6, 1.0))?;
        let allowed = Domain::new(source.width, source.height, problem.patch, problem.source_mask.as_deref(), false)?;
        // If no patch fits into the mask, allow all patches that touch it.
        let allowed = if allowed.is_empty() {
            Domain::new(source.width, source.height, problem.patch, problem.source_mask.as_deref(), true)?
        } else {
            allowed
        };
        let wanted = Domain::new(target.width, target.height, problem.patch, problem.target_mask.as_deref(), true)?;
        Ok(Self { problem, source, target, allowed, wanted, colours: quantisers, unit, kernel: Kernel::detect(), seed })
    }

    /// Stores the colours of the current picture in the quantised target.
    pub fn set_picture(&mut self, picture: &Image, job: Job) -> Result<()> {
        self.target.fill(0, &self.colours, picture, job)
    }

    /// Marks the wanted patches that contain a pixel whose quantised colour in `picture` differs from that in
    /// `self.target`. The distances of all other patches remain valid.
    pub fn changed_by(&self, picture: &Image, job: Job) -> Result<Vec<bool>> {
        let (width, lanes) = (picture.width, self.target.lanes);
        let mut differs = try_vec(width * picture.height, false)?;
        exec::for_rows(&mut differs, width, job, |y, row| {
            let old = self.target.data[y * self.target.row_len()..].chunks_exact(lanes);
            for ((differs, old), new) in row.iter_mut().zip(old).zip(picture.row(y).chunks_exact(picture.channels)) {
                *differs = old.iter().zip(new).zip(&self.colours).any(|((o, n), q)| q.quantise(*n) != *o);
            }
        })?;
        let mut touched = Domain::new(width, picture.height, self.problem.patch, Some(&differs), true)?.into_flags();
        touched.iter_mut().zip(self.wanted.flags()).for_each(|(touched, wanted)| *touched &= wanted);
        Ok(touched)
    }

    /// Returns the distance, in quantised units, of two patches for which the weighted squared difference of StyLit's
    /// Eq. 1, with channels in `[0, 1]`, is 1 in every pixel.
    pub fn unit(&self) -> f64 {
        (self.problem.patch * self.problem.patch) as f64 * self.unit
    }

    /// Returns the search for the nearest exemplar patch of each target patch.
    pub fn forward(&self) -> Search<'_> {
        Search {
            query: &self.target,
            base: &self.source,
            allowed: &self.allowed,
            patch: self.problem.patch,
            kernel: self.kernel,
            seed: self.seed,
        }
    }

    /// Returns the search for the nearest target patch, among `free`, of each exemplar patch.
    pub fn reverse<'b>(&'b self, free: &'b Domain) -> Search<'b> {
        Search { query: &self.source, base: &self.target, allowed: free, seed: !self.seed, ..self.forward() }
    }
}
