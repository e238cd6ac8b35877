//! Analyses an exemplar: finds its lamps, and the law by which their pattern continues beyond the exemplar. The law is
//! a lattice, a row, repetition of the whole exemplar, or patches without a lattice.
//!
//! A single analysis is not reliable: unwarping magnifies the blur of distant lamps, which then spoil the
//! autocorrelation of the near lamps. So several laws are proposed, from the whole exemplar and from its sharper parts,
//! with strict and with loose thresholds for the autocorrelation. The score of a law tells how well the law predicts
//! the lamps of the whole photo ([`sites`]). The law found in the whole exemplar with the threshold `min_regularity` is
//! kept unless another law scores clearly higher.

pub mod evidence;
pub mod sites;

use super::exemplar::Exemplar;
use super::exemplar::roles::Role;
use super::lattice::law::{self, Law};
use super::lattice::{self, Correlated, extent, neighbours, steps};
use super::params::{Input, LawMode, Params, working_side};
use crate::error::{Error, Result};
use crate::job::Job;
use evidence::Evidence;
use glam::DVec2;
use sites::Sites;

/// Lattices and rows are also proposed from the sharper parts of the exemplar, one part for each of these values.
/// Unwarping magnifies such a part at most this many times as much as the least magnified pixel. [judged on 20 photos]
const MAGNIFICATIONS: [f64; 2] = [4.0, 2.5];
/// Limits for shifts that are proposed as periods. [judged on 20 photos]
///
/// - `MIN_CORRELATION`: minimum autocorrelation of the lights at the shift.
/// - `MIN_RELATIVE_CORRELATION`: minimum ratio of the autocorrelation at the shift to the highest lower bound of the
///   autocorrelation at any shift ([`lattice::shifts`]).
/// - `MAX_SHIFTS`: maximum number of shifts.
const MIN_CORRELATION: f32 = 0.35;
const MIN_RELATIVE_CORRELATION: f32 = 0.6;
const MAX_SHIFTS: usize = 6;
/// Score of a law without a period, which predicts no lamp: repetition of the whole exemplar, or patches without a
/// lattice. A lattice or row must score higher if it is to replace another law. [judged on 20 photos]
const SCORE_WITHOUT_PERIOD: f64 = 0.35;
/// If the lattice or row found in the whole exemplar scores below this value, and no other one replaces it, the
/// pattern counts as having no period. [bench photos:tune, photos:real]
const MIN_SCORE: f64 = 0.2;
/// One score is clearly higher than another if it is higher by more than this. [judged on 20 photos]
const CLEAR_MARGIN: f64 = 0.1;
/// Let w be the number of photo pixels that show whole lamps, and t the number that show lights running through the
/// photo. Laws are compared only if w / (w + t) is at least this. [judged on 20 photos]
const MIN_LAMP_SHARE: f64 = 0.5;
/// Two lattices or rows count as equal if their periods agree in pairs: the two periods of a pair differ by less than
/// this share of the longer one. [judged on 20 photos]
const MAX_PERIOD_DIFFERENCE: f64 = 0.08;
/// On a luminous ceiling, a law counts only if the correlation of the panes at its periods is at least this share of
/// the highest such correlation of all proposed laws. [`lattice::find_law`] demands the same share of its shifts.
/// [bench photos:real]
const MIN_PANE_CORRELATION: f32 = 0.9;

/// The score of the chosen law (lattice, row, repetition or none), and the best alternative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// How well the law predicts the lamps of the photo, in `[0, 1]`. NaN if the law comes from the autocorrelation
    /// alone (for example because the photo shows too few whole lamps), and for [`Law::Copy`].
    pub score: f64,
    /// The best alternative law, and its score. Without an alternative, the chosen law itself, with score 0.
    pub runner_up: Law,
    pub runner_up_score: f64,
}

impl Choice {
    /// How clearly the law was chosen: the score minus the score of the runner-up. NaN if `score` is NaN.
    pub fn margin(&self) -> f64 {
        self.score - self.runner_up_score
    }

    /// The choice if laws were not compared: the score is NaN, and the runner-up is the law itself, with score 0.
    pub fn only(law: Law) -> Self {
        Self { score: f64::NAN, runner_up: law, runner_up_score: 0.0 }
    }
}

/// The analysis of an exemplar: its lamps, and how their pattern continues (on a lattice, in a row, by repetition or
/// without a period).
pub struct Analysis {
    pub exemplar: Exemplar,
    pub law: Law,
    pub regularity: f64,
    pub choice: Choice,
    /// The settings with which the exemplar was analysed.
    working_side: f64,
    min_regularity: f32,
    law_mode: LawMode,
    max_magnification: f64,
}

/// A proposed law (lattice, row, …), with its regularity and its score.
#[derive(Clone, Copy)]
struct Proposal {
    law: Law,
    regularity: f64,
    score: f64,
}

impl Proposal {
    /// A proposal without a period, in which no lamp predicts another.
    fn without_period(law: Law) -> Self {
        Self { law, regularity: 0.0, score: SCORE_WITHOUT_PERIOD }
    }

    /// Makes each period of a lattice that is nearly parallel to an axis of the unwarped image exactly parallel to this
    /// axis. Returns the proposal unchanged if this would lower the score by [`CLEAR_MARGIN`] or more, and for the
    /// panes of a luminous ceiling.
    fn aligned(self, exemplar: &Exemplar, score: impl Fn(Law) -> f64) -> Self {
        let law = self.law.aligned();
        if law == self.law || exemplar.is_luminous_ceiling() {
            return self;
        }
        let aligned = Self { law, score: score(law), ..self };
        if aligned.score > self.score - CLEAR_MARGIN { aligned } else { self }
    }

    /// The value by which proposals are compared: the score, plus [`CLEAR_MARGIN`] if the periods are parallel to the
    /// axes of the unwarped image, as on most ceilings. Panes of a luminous ceiling get no such bonus.
    fn rank(&self, exemplar: &Exemplar) -> f64 {
        let is_preferred = self.law.is_aligned() && !exemplar.is_luminous_ceiling();
        self.score + if is_preferred { CLEAR_MARGIN } else { 0.0 }
    }
}

impl Analysis {
    /// Analyses the exemplar of an input. Errors: no valid pixel, no light (`Degenerate`).
    pub fn new(input: &Input, params: &Params, job: Job) -> Result<Self> {
        let exemplar = Exemplar::new(input, working_side(input, params), params.max_magnification, job.part(0.0, 0.4))?;
        Self::of(exemplar, input, params, job)
    }

    /// Analyses an exemplar that has been built already: finds how its pattern continues.
    pub fn of(exemplar: Exemplar, input: &Input, params: &Params, job: Job) -> Result<Self> {
        let working_side = working_side(input, params);
        let min_regularity = params.min_regularity;
        let whole = Correlated::new(&exemplar, |_| true, job.part(0.4, 0.6))?;
        let (law, regularity) = lattice::find_law(&exemplar, &whole, min_regularity);
        let mut analysis = Self {
            choice: Choice::only(law),
            exemplar,
            law,
            regularity,
            working_side,
            min_regularity,
            law_mode: params.law,
            max_magnification: params.max_magnification,
        };
        match params.law {
            LawMode::Correlation => {}
            LawMode::Best if min_regularity >= 1.0 => {}
            LawMode::Best => analysis.compare(&whole, job.part(0.6, 1.0))?,
            LawMode::Whole => analysis.set(Proposal::without_period(extent::as_period(&analysis.exemplar))),
            LawMode::Free => analysis.set(Proposal::without_period(Law::Free)),
            LawMode::Lattice | LawMode::Row => analysis.choose_by_mode(params.law, &whole, job.part(0.6, 1.0))?,
        }
        Ok(analysis)
    }

    /// Whether this analysis can be reused for the given input and settings: the size of the input and all settings
    /// that affect an analysis are equal. Pixels are not compared, so the caller must pass the input that was analysed.
    pub fn is_reusable_for(&self, input: &Input, params: &Params) -> bool {
        let Exemplar { width, height, .. } = self.exemplar;
        [width, height] == [input.unwarped.width, input.unwarped.height]
            && self.working_side == working_side(input, params)
            && self.min_regularity == params.min_regularity
            && self.law_mode == params.law
            && self.max_magnification == params.max_magnification
    }

    /// Compares the law found in the whole exemplar with other proposals, and chooses one of these laws. An exemplar of
    /// a single lamp gets a law without a period. Otherwise keeps the law without a comparison if there are fewer than
    /// two lamps of known size, if lights that run through the photo prevail ([`MIN_LAMP_SHARE`]), or if the law has no
    /// score.
    fn compare(&mut self, whole: &Correlated, job: Job) -> Result<()> {
        let exemplar = &self.exemplar;
        let evidence = Evidence::of(exemplar);
        let seen: f64 = evidence.whole.iter().map(|l| l.weight).sum();
        let through = exemplar.roles.iter().zip(&exemplar.photo_area).filter(|(role, _)| **role == Role::Through);
        let endless: f64 = through.map(|(_, area)| area).sum();
        if evidence.is_single(exemplar) && endless == 0.0 {
            // A single lamp shows no repetition, even if the autocorrelation of its few pixels has a peak.
            self.set(Proposal::without_period(lattice::without_period(exemplar, extent::of(exemplar))));
            return Ok(());
        }
        if evidence.whole.len() + evidence.completed.len() < 2 || seen < MIN_LAMP_SHARE * (seen + endless) {
            return Ok(());
        }
        let score = |law: Law| score(exemplar, &evidence, law);
        let own = Proposal { law: self.law, regularity: self.regularity, score: score(self.law) };
        if own.score.is_nan() {
            return Ok(());
        }
        let mut proposals = self.propose(&evidence, whole, job)?;
        proposals.iter_mut().for_each(|p| p.score = score(p.law));
        proposals.retain(|p| p.score.is_finite());
        let without_period = Proposal::without_period(lattice::without_period(exemplar, extent::of(exemplar)));
        let may_stay = match exemplar.is_luminous_ceiling() {
            true => keep_correlated(own, &mut proposals, whole),
            false => keep_shown(own, &mut proposals, exemplar, &evidence),
        };
        let best = || best_of(&proposals).filter(|p| p.score > SCORE_WITHOUT_PERIOD);
        let own = if may_stay { own } else { best().unwrap_or(without_period) };

        // Make the periods of lattices exactly parallel to the axes of the unwarped image, if the lattice then predicts
        // the lamps nearly as well.
        let own = own.aligned(exemplar, score);
        proposals.iter_mut().for_each(|p| *p = p.aligned(exemplar, score));

        // Find the proposal that ranks highest, the first one among equals. It replaces the law found in the whole
        // exemplar only under two conditions: its score is clearly higher than the score of that law, and higher than
        // the score of a law without a period.
        let rank = |p: &Proposal| p.rank(exemplar);
        let best = proposals.iter().fold(own, |best, p| if rank(p) > rank(&best) + 1e-9 { *p } else { best });
        let lattice = best_of(proposals.iter().filter(|p| matches!(p.law, Law::Lattice(_))));
        // For the panes of a luminous ceiling, prefer the best lattice if two conditions hold. The lattice scores
        // clearly higher than a law without a period, and no other law scores clearly higher than the lattice.
        let panes = lattice.filter(|p| {
            exemplar.is_luminous_ceiling()
                && p.score > SCORE_WITHOUT_PERIOD + CLEAR_MARGIN
                && p.score > best.score - CLEAR_MARGIN
        });
        let chosen = match panes {
            Some(panes) => panes,
            None if best.score > own.score + CLEAR_MARGIN && best.score > SCORE_WITHOUT_PERIOD => best,
            None if own.score < MIN_SCORE => without_period,
            None => own,
        };
        proposals.extend([own, without_period]);
        let others = proposals.iter().filter(|p| !is_same(p.law, chosen.law));
        let runner_up = others.max_by(|a, b| a.score.total_cmp(&b.score));
        (self.law, self.regularity) = (chosen.law, chosen.regularity);
        self.choice = Choice {
            score: chosen.score,
            runner_up: runner_up.map_or(chosen.law, |p| p.law),
            runner_up_score: runner_up.map_or(0.0, |p| p.score),
        };
        Ok(())
    }

    /// Proposes laws; their scores are not set yet. The autocorrelation of the whole exemplar, and of each of its
    /// sharper parts, gives one law with the threshold `min_regularity`, and several rows and lattices with looser
    /// thresholds. The distances between lamps give further lattices and rows, along the axes of the unwarped image.
    /// For the panes of a luminous ceiling, the autocorrelation adds periods along these axes.
    fn propose(&self, evidence: &Evidence, whole: &Correlated, job: Job) -> Result<Vec<Proposal>> {
        let exemplar = &self.exemplar;
        let mut parts = Vec::new();
        for limit in MAGNIFICATIONS {
            let Some(limit) = exemplar.magnification_limit(limit) else { continue };
            let pitch = exemplar.working.pitch;
            let width = exemplar.working.width;
            let centre = |i: usize| (DVec2::new((i % width) as f64, (i / width) as f64) + 0.5) * pitch;
            parts.push(Correlated::new(exemplar, |i| limit.contains(centre(i)), job.part(0.0, 0.0))?);
        }
        let mut proposals = Vec::new();
        for correlated in std::iter::once(whole).chain(&parts) {
            let (law, regularity) = lattice::find_law(exemplar, correlated, self.min_regularity);
            proposals.push(Proposal { law, regularity, score: 0.0 });
            let shifts = lattice::shifts(exemplar, correlated, MIN_CORRELATION, MIN_RELATIVE_CORRELATION, MAX_SHIFTS);
            for (n, &(a, goodness)) in shifts.iter().enumerate() {
                let row = lattice::row(exemplar, a);
                proposals.push(Proposal { law: row, regularity: goodness, score: 0.0 });
                for &(b, other) in shifts[n + 1..].iter().filter(|(b, _)| !lattice::is_parallel(a, *b)) {
                    let law = lattice::lattice(exemplar, [a, b]);
                    proposals.push(Proposal { law, regularity: goodness.min(other), score: 0.0 });
                }
            }
            job.check()?;
        }
        // Find periods along the axes: on a luminous ceiling from the distances between neighbouring panes, otherwise
        // from the steps between lamps.
        let periods = match exemplar.is_luminous_ceiling() {
            true => {
                let shifts = lattice::shifts(exemplar, whole, MIN_CORRELATION, MIN_RELATIVE_CORRELATION, usize::MAX);
                with_aligned(neighbours::periods(&evidence.whole), &shifts)
            }
            false => steps::periods(&[&evidence.whole[..], &evidence.completed].concat()),
        };
        let lattices = neighbours::lattices(&periods).into_iter();
        let lattices = lattices.map(|periods| lattice::lattice(exemplar, periods));
        let rows = neighbours::rows(&periods).into_iter().map(|period| lattice::row(exemplar, period));
        proposals.extend(lattices.chain(rows).map(|law| Proposal { law, regularity: 0.0, score: 0.0 }));
        Ok(proposals)
    }

    /// Chooses a law of the type that `mode` asks for: a row for [`LawMode::Row`], else a lattice. Keeps the law found
    /// so far if it has this type. Otherwise takes the proposal of this type with the highest score. Errors:
    /// `Degenerate` if there is none.
    fn choose_by_mode(&mut self, mode: LawMode, whole: &Correlated, job: Job) -> Result<()> {
        let is_asked = |c: &Law| match mode {
            LawMode::Row => matches!(c, Law::Row(_)),
            _ => matches!(c, Law::Lattice(_)),
        };
        if is_asked(&self.law) {
            return Ok(());
        }
        let evidence = Evidence::of(&self.exemplar);
        let mut proposals = self.propose(&evidence, whole, job)?;
        proposals.retain(|p| is_asked(&p.law));
        proposals.iter_mut().for_each(|p| p.score = score(&self.exemplar, &evidence, p.law));
        let best = best_of(proposals.iter().filter(|p| p.score.is_finite())).ok_or_else(|| {
            Error::degenerate("emission.law asks for a period that the lights do not show: set it to the best law")
        })?;
        self.set(best);
        Ok(())
    }

    fn set(&mut self, chosen: Proposal) {
        (self.law, self.regularity) = (chosen.law, chosen.regularity);
        self.choice = Choice { score: chosen.score, ..Choice::only(chosen.law) };
    }
}

/// Keeps the proposals at whose periods the lights of a luminous ceiling correlate well ([`MIN_PANE_CORRELATION`]).
/// Scores compare only the centres of panes. A correlation, in contrast, is lowered by a period that moves panes onto
/// panes of another width, or wide bars onto narrow ones. Returns whether `own` may stay: true if it correlates well or
/// has no period.
fn keep_correlated(own: Proposal, proposals: &mut Vec<Proposal>, whole: &Correlated) -> bool {
    let correlation = |p: &Proposal| whole.at_periods(p.law).unwrap_or(0.0);
    let highest = proposals.iter().chain([&own]).map(correlation).fold(0.0, f32::max);
    let is_kept = |p: &Proposal| correlation(p) >= MIN_PANE_CORRELATION * highest;
    proposals.retain(is_kept);
    matches!(own.law, Law::Whole(_) | Law::Free) || is_kept(&own)
}

/// Removes the lattices of which the lamps show only one period, or none. Returns whether `own` may stay: true if it is
/// no such lattice. Autocorrelation finds such periods in photos with few lamps, from the noise in their outlines.
fn keep_shown(own: Proposal, proposals: &mut Vec<Proposal>, exemplar: &Exemplar, evidence: &Evidence) -> bool {
    let is_shown = |p: &Proposal| match p.law {
        Law::Lattice(_) => Sites::new(exemplar, &evidence.whole, p.law).is_none_or(|s| s.show_both_periods(evidence)),
        _ => true,
    };
    proposals.retain(is_shown);
    is_shown(&own)
}

/// The proposal with the highest score.
fn best_of<'a>(proposals: impl IntoIterator<Item = &'a Proposal>) -> Option<Proposal> {
    proposals.into_iter().copied().max_by(|a, b| a.score.total_cmp(&b.score))
}

/// Adds the shifts that are parallel to an axis to the periods along this axis: the [`MAX_SHIFTS`] shortest ones that
/// differ from the periods so far ([`MAX_PERIOD_DIFFERENCE`]).
fn with_aligned(mut periods: [Vec<f64>; 2], shifts: &[(DVec2, f64)]) -> [Vec<f64>; 2] {
    for (axis, periods) in periods.iter_mut().enumerate() {
        let max_count = periods.len() + MAX_SHIFTS;
        let shifts = shifts.iter().map(|(shift, _)| law::aligned(*shift).abs());
        for length in shifts.filter(|shift| shift[1 - axis] == 0.0).map(|shift| shift[axis]) {
            let is_listed = |p: &f64| (p - length).abs() < MAX_PERIOD_DIFFERENCE * length;
            if periods.len() < max_count && !periods.iter().any(is_listed) {
                periods.push(length);
            }
        }
    }
    periods
}

/// Score of a law: how well it predicts the whole lamps and the visible parts of cut lamps. Laws without a period have
/// a fixed score. NaN if the pattern does not change along one period of the law, for example along the length of lines
/// of light. Only the autocorrelation can judge such a period.
fn score(exemplar: &Exemplar, evidence: &Evidence, law: Law) -> f64 {
    match Sites::new(exemplar, &evidence.whole, law) {
        Some(sites) => sites.score(evidence),
        None => match law {
            Law::Free | Law::Whole(_) => SCORE_WITHOUT_PERIOD,
            _ => f64::NAN,
        },
    }
}

/// Whether two laws are equal except for a small difference between their periods. `Whole` and `Free`, which have no
/// measured period, count as equal.
pub fn is_same(a: Law, b: Law) -> bool {
    let near = |[a, b]: [DVec2; 2], [c, d]: [DVec2; 2]| {
        let close = |p: DVec2, q: DVec2| {
            (p - q).length().min((p + q).length()) < MAX_PERIOD_DIFFERENCE * p.length().max(q.length())
        };
        (close(a, c) && close(b, d)) || (close(a, d) && close(b, c))
    };
    match (a, b) {
        (Law::Lattice(a), Law::Lattice(b)) | (Law::Row(a), Law::Row(b)) => near(a, b),
        (Law::Whole(_) | Law::Free, Law::Whole(_) | Law::Free) => true,
        (a, b) => a == b,
    }
}
