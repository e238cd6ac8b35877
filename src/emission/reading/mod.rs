//! Analyses an exemplar: finds its lamps, and how their pattern continues beyond it. The continuation is a lattice, a
//! row, repetition of the whole exemplar, or patches without a lattice.
//!
//! A single analysis is not reliable, because distant lamps are magnified with their blur and spoil the
//! autocorrelation of the near ones. So several continuations are proposed, from the whole exemplar and from its
//! sharper parts, with strict and with loose thresholds. Each is scored by how well it predicts the lamps of the whole
//! photo ([`sites`]). The continuation found in the whole exemplar with the threshold `min_regularity` is kept unless
//! another one scores clearly higher.

pub mod sites;

use super::exemplar::Exemplar;
use super::exemplar::evidence::Evidence;
use super::exemplar::roles::Role;
use super::lattice::continuation::Continuation;
use super::lattice::{self, Correlated, basis, extent, neighbours};
use super::params::{Input, Law, Params, working_side};
use crate::error::{Error, Result};
use crate::job::Job;
use glam::DVec2;
use sites::Sites;

/// Lattices and rows are also proposed from parts of the exemplar in which the magnification is at most one of these
/// values. Magnification is relative to the least magnified pixel. [judged on 20 photos]
const MAGNIFICATIONS: [f64; 2] = [4.0, 2.5];
/// Limits for shifts that are proposed as periods: `PROPOSED` is the minimum correlation, `PROPOSED_RELATIVE` the
/// minimum correlation relative to the best shift, `MAX_SHIFTS` the maximum number of shifts. [judged on 20 photos]
const PROPOSED: f32 = 0.35;
const PROPOSED_RELATIVE: f32 = 0.6;
const MAX_SHIFTS: usize = 6;
/// Score of patterns without a period (no lattice, no row); a lattice must score higher. [judged on 20 photos]
const LAWLESS: f64 = 0.35;
/// If the lattice or row found in the whole exemplar with the threshold `min_regularity` scores below this value, it
/// is dropped, and the pattern counts as having no period. [judged on 20 photos]
const HOPELESS: f64 = 0.15;
/// The lattice or row found in the whole exemplar with the threshold `min_regularity` is replaced only by one whose
/// score is higher by more than this. [judged on 20 photos]
const CLEARLY: f64 = 0.1;
/// Continuations are compared only if lamps have at least this share of the photo pixels of all lights; the other
/// lights run through the photo. [judged on 20 photos]
const MIN_LAMPS: f64 = 0.5;
/// Two lattices or rows count as equal if the relative difference between their periods is at most this.
/// [judged on 20 photos]
const SAME_LAW: f64 = 0.08;

/// The score of the chosen continuation (lattice, row, repetition or none), and the best alternative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// How well the continuation predicts the lamps of the photo, in `[0, 1]`; NaN if too few of the lights are lamps
    /// for a comparison.
    pub score: f64,
    /// The best alternative continuation, and its score; the score is 0 if there is no alternative.
    pub runner_up: Continuation,
    pub runner_up_score: f64,
}

impl Choice {
    /// The score minus the score of the runner-up.
    pub fn margin(&self) -> f64 {
        self.score - self.runner_up_score
    }

    /// The choice if there was nothing to compare: the score is NaN, and the runner-up is the continuation itself,
    /// with score 0.
    pub fn only(continuation: Continuation) -> Self {
        Self { score: f64::NAN, runner_up: continuation, runner_up_score: 0.0 }
    }
}

/// The analysis of an exemplar: its lamps, and how their pattern continues (on a lattice, in a row, by repetition or
/// without a period).
pub struct Reading {
    pub exemplar: Exemplar,
    pub continuation: Continuation,
    pub regularity: f64,
    pub choice: Choice,
    /// The settings with which the exemplar was analysed.
    working_side: f64,
    min_regularity: f32,
    law: Law,
    max_magnification: f64,
}

/// A proposed continuation (lattice, row, …), with its regularity and its score.
#[derive(Clone, Copy)]
struct Proposal {
    continuation: Continuation,
    regularity: f64,
    score: f64,
}

impl Proposal {
    /// A proposal without a period, in which no lamp predicts another.
    fn lawless(continuation: Continuation) -> Self {
        Self { continuation, regularity: 0.0, score: LAWLESS }
    }
}

impl Reading {
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
        let (continuation, regularity) = lattice::law(&exemplar, &whole, min_regularity);
        let mut reading = Self {
            choice: Choice::only(continuation),
            exemplar,
            continuation,
            regularity,
            working_side,
            min_regularity,
            law: params.law,
            max_magnification: params.max_magnification,
        };
        match params.law {
            Law::Correlation => {}
            Law::Best if min_regularity >= 1.0 => {}
            Law::Best => reading.compare(&whole, job.part(0.6, 1.0))?,
            Law::Whole => reading.set(Proposal::lawless(extent::as_period(&reading.exemplar))),
            Law::Free => reading.set(Proposal::lawless(Continuation::Free)),
            Law::Lattice | Law::Row => reading.fix(params.law, &whole, job.part(0.6, 1.0))?,
        }
        Ok(reading)
    }

    /// Whether an analysis with the given input and settings would have the same result, so that this one can be
    /// reused.
    pub fn serves(&self, input: &Input, params: &Params) -> bool {
        let Exemplar { width, height, .. } = self.exemplar;
        [width, height] == [input.unwarped.width, input.unwarped.height]
            && self.working_side == working_side(input, params)
            && self.min_regularity == params.min_regularity
            && self.law == params.law
            && self.max_magnification == params.max_magnification
    }

    /// Compares the continuation found in the whole exemplar with other proposals, and chooses one.
    fn compare(&mut self, whole: &Correlated, job: Job) -> Result<()> {
        let exemplar = &self.exemplar;
        let evidence = exemplar.evidence(Role::is_whole);
        let parts = exemplar.evidence(|role| matches!(role, Role::Cut | Role::Partial));
        let seen: f64 = evidence.iter().map(|l| l.weight).sum();
        let through = exemplar.roles.iter().zip(&exemplar.photo_area).filter(|(role, _)| **role == Role::Through);
        let endless: f64 = through.map(|(_, area)| area).sum();
        if evidence.len() == 1 && parts.is_empty() && endless == 0.0 {
            // A single lamp shows no repetition, even if its few pixels correlate.
            self.set(Proposal::lawless(lattice::lawless(exemplar, extent::of(exemplar))));
            return Ok(());
        }
        if evidence.len() < 2 || seen < MIN_LAMPS * (seen + endless) {
            return Ok(());
        }
        let score = |law: Continuation| score(exemplar, (&evidence, &parts), law);
        let own =
            Proposal { continuation: self.continuation, regularity: self.regularity, score: score(self.continuation) };
        if own.score.is_nan() {
            return Ok(());
        }
        let mut proposals = self.propose(&evidence, whole, job)?;
        proposals.iter_mut().for_each(|p| p.score = score(p.continuation));
        proposals.retain(|p| p.score.is_finite());
        let lawless = Proposal::lawless(lattice::lawless(exemplar, extent::of(exemplar)));

        // Find the proposal with the highest score, the first one among equals. It replaces the continuation found in
        // the whole exemplar only if its score is clearly higher.
        let best = proposals.iter().fold(own, |best, p| if p.score > best.score + 1e-9 { *p } else { best });
        let lattices = proposals.iter().filter(|p| matches!(p.continuation, Continuation::Lattice(_)));
        let lattice = lattices.copied().max_by(|a, b| a.score.total_cmp(&b.score));
        // For the panes of a luminous ceiling, prefer the best lattice, unless the continuation found in the whole
        // exemplar scores clearly higher.
        let panes = lattice
            .filter(|p| exemplar.is_luminous_ceiling() && p.score > LAWLESS + CLEARLY && p.score > own.score - CLEARLY);
        let chosen = match panes {
            Some(panes) => panes,
            None if best.score > own.score + CLEARLY && best.score > LAWLESS => best,
            None if own.score < HOPELESS => lawless,
            None => own,
        };
        proposals.extend([own, lawless]);
        let others = proposals.iter().filter(|p| !is_same(p.continuation, chosen.continuation));
        let runner_up = others.max_by(|a, b| a.score.total_cmp(&b.score));
        (self.continuation, self.regularity) = (chosen.continuation, chosen.regularity);
        self.choice = Choice {
            score: chosen.score,
            runner_up: runner_up.map_or(chosen.continuation, |p| p.continuation),
            runner_up_score: runner_up.map_or(0.0, |p| p.score),
        };
        Ok(())
    }

    /// Proposes continuations from the whole exemplar and from each of its sharper parts: one with the threshold
    /// `min_regularity`, and several rows and lattices with looser thresholds. A luminous ceiling also gets lattices
    /// from the distances between neighbouring panes.
    fn propose(&self, evidence: &[Evidence], whole: &Correlated, job: Job) -> Result<Vec<Proposal>> {
        let exemplar = &self.exemplar;
        let mut parts = Vec::new();
        for limit in MAGNIFICATIONS {
            let Some(limit) = exemplar.magnification_limit(limit) else { continue };
            let pitch = exemplar.working.pitch;
            let width = exemplar.working.width;
            let centre = |i: usize| (DVec2::new((i % width) as f64, (i / width) as f64) + 0.5) * pitch;
            parts.extend(Correlated::new(exemplar, |i| limit.contains(centre(i)), job.part(0.0, 0.0)).ok());
        }
        let mut proposals = Vec::new();
        let extent = extent::of(exemplar);
        for correlated in std::iter::once(whole).chain(&parts) {
            let (continuation, regularity) = lattice::law(exemplar, correlated, self.min_regularity);
            proposals.push(Proposal { continuation, regularity, score: 0.0 });
            let shifts = lattice::shifts(exemplar, correlated, PROPOSED, PROPOSED_RELATIVE, MAX_SHIFTS);
            for (n, &(a, goodness)) in shifts.iter().enumerate() {
                let row = lattice::row(exemplar, a, extent);
                proposals.push(Proposal { continuation: row, regularity: goodness, score: 0.0 });
                for &(b, other) in shifts[n + 1..].iter().filter(|(b, _)| !lattice::is_parallel(a, *b)) {
                    let continuation = Continuation::Lattice(basis::refine(exemplar, [a, b], 2));
                    proposals.push(Proposal { continuation, regularity: goodness.min(other), score: 0.0 });
                }
            }
            job.check()?;
        }
        let panes = if exemplar.is_luminous_ceiling() { neighbours::lattices(evidence) } else { Vec::new() };
        for basis in panes {
            let continuation = Continuation::Lattice(basis::refine(exemplar, basis, 2));
            proposals.push(Proposal { continuation, regularity: 0.0, score: 0.0 });
        }
        Ok(proposals)
    }

    /// Chooses the best lattice or the best row, as `law` asks. Errors: `Degenerate` if there is none.
    fn fix(&mut self, law: Law, whole: &Correlated, job: Job) -> Result<()> {
        let is_asked = |c: &Continuation| match law {
            Law::Row => matches!(c, Continuation::Row(_)),
            _ => matches!(c, Continuation::Lattice(_)),
        };
        if is_asked(&self.continuation) {
            return Ok(());
        }
        let evidence = self.exemplar.evidence(Role::is_whole);
        let parts = self.exemplar.evidence(|role| matches!(role, Role::Cut | Role::Partial));
        let mut proposals = self.propose(&evidence, whole, job)?;
        proposals.retain(|p| is_asked(&p.continuation));
        proposals.iter_mut().for_each(|p| p.score = score(&self.exemplar, (&evidence, &parts), p.continuation));
        let best = proposals.into_iter().filter(|p| p.score.is_finite()).max_by(|a, b| a.score.total_cmp(&b.score));
        let best = best.ok_or_else(|| {
            Error::degenerate("emission.law asks for a period that the lights do not show: set it to the best law")
        })?;
        self.set(best);
        Ok(())
    }

    fn set(&mut self, chosen: Proposal) {
        (self.continuation, self.regularity) = (chosen.continuation, chosen.regularity);
        self.choice = Choice { score: chosen.score, ..Choice::only(chosen.continuation) };
    }
}

/// Score of a continuation: how well it predicts the whole lamps and the visible parts of cut lamps. NaN if the
/// pattern does not change along one of its periods, because only the autocorrelation can judge such a period.
fn score(exemplar: &Exemplar, (lamps, parts): (&[Evidence], &[Evidence]), law: Continuation) -> f64 {
    match Sites::new(exemplar, lamps, law) {
        Some(sites) => sites.score(parts),
        None => match law {
            Continuation::Free | Continuation::Tile(_) => LAWLESS,
            _ => f64::NAN,
        },
    }
}

/// Whether two continuations are equal except for a small difference between their periods.
fn is_same(a: Continuation, b: Continuation) -> bool {
    let near = |[a, b]: [DVec2; 2], [c, d]: [DVec2; 2]| {
        let close = |p: DVec2, q: DVec2| (p - q).length().min((p + q).length()) < SAME_LAW * p.length().max(q.length());
        (close(a, c) && close(b, d)) || (close(a, d) && close(b, c))
    };
    match (a, b) {
        (Continuation::Lattice(a), Continuation::Lattice(b)) | (Continuation::Row(a), Continuation::Row(b)) => {
            near(a, b)
        }
        (Continuation::Tile(_) | Continuation::Free, Continuation::Tile(_) | Continuation::Free) => true,
        (a, b) => a == b,
    }
}
