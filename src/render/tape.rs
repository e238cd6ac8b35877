//! What happens to a path from some vertex on, for those that only add up and for those that tell light apart.

use super::LightSource;
use super::bsdf::{Kind, Lobes};
use super::layers::Recorder;
use super::lpe::Trail;
use super::path::{Found, Observer};
use super::shared::{Tape, Witness};
use super::world::{Pane, World};
use glam::{Vec3, Vec3A};
use std::ops::Range;

/// Adds contributions up.
#[derive(Clone, Copy, Default)]
pub struct Sum(pub Vec3);

impl Observer for Sum {
    #[inline]
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3, _: Found) {
        self.0 += importance * emission;
    }
}

impl Tape for Sum {
    fn clear(&mut self) {
        self.0 = Vec3::ZERO;
    }

    fn is_blank(&self) -> bool {
        self.0 == Vec3::ZERO
    }
}

impl Witness for Sum {
    type Tape = Self;

    fn restart(&mut self) {}

    #[inline]
    fn replay(&mut self, tape: &mut Self, importance: Vec3) {
        self.0 += importance * tape.0;
    }
}

/// All steps of a path.
#[derive(Default)]
pub struct Steps {
    sum: Vec3,
    steps: Vec<Step>,
    /// Where panes are listed, and those of all steps.
    panes: Vec<Pane>,
    kept: Vec<Pane>,
    /// What comes of it from a state of the automaton: for each that was asked for, a part of the list.
    outcomes: Vec<(u16, Range<usize>)>,
    brought: Vec<(u16, Vec3A)>,
}

enum Step {
    Add { source: LightSource, contribution: Vec3A, found: Found, panes: Range<usize> },
    Scatter { mesh: u32, kind: Kind, lobes: Lobes },
}

impl Observer for Steps {
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3, found: Found) {
        let contribution = importance * emission;
        self.sum += contribution;
        let first = self.kept.len();
        if let Found::Chosen { .. } = found
            && !self.panes.is_empty()
        {
            self.kept.extend_from_slice(&self.panes);
        }
        self.steps.push(Step::Add { source, contribution: contribution.into(), found, panes: first..self.kept.len() });
    }

    fn scatter(&mut self, mesh: u32, kind: Kind, lobes: Lobes) {
        self.steps.push(Step::Scatter { mesh, kind, lobes });
    }

    fn panes(&mut self) -> Option<&mut Vec<Pane>> {
        Some(&mut self.panes)
    }
}

impl Tape for Steps {
    fn clear(&mut self) {
        let Self { sum, steps, panes, kept, outcomes, brought } = self;
        *sum = Vec3::ZERO;
        steps.clear();
        panes.clear();
        kept.clear();
        outcomes.clear();
        brought.clear();
    }

    fn is_blank(&self) -> bool {
        self.sum == Vec3::ZERO
    }
}

impl Steps {
    /// The panes listed last.
    pub fn panes_listed(&self) -> &[Pane] {
        &self.panes
    }

    /// What comes of it from a state of the automaton, and for which lists of expressions.
    fn outcome(&mut self, world: &World, state: u16, trail: &mut Trail) -> &[(u16, Vec3A)] {
        let Self { steps, kept, outcomes, brought, .. } = self;
        let range = match outcomes.iter().find(|(of, _)| *of == state) {
            Some((_, range)) => range.clone(),
            None => {
                trail.start_from(state);
                for step in steps.iter() {
                    match step {
                        Step::Add { source, contribution, found, panes } => {
                            trail.set_panes(&kept[panes.clone()]);
                            trail.add(world, *contribution, *source, *found);
                        }
                        Step::Scatter { mesh, kind, lobes } => trail.scatter(*mesh, *kind, *lobes),
                    }
                }
                let first = brought.len();
                brought.extend_from_slice(trail.finish());
                outcomes.push((state, first..brought.len()));
                first..brought.len()
            }
        };
        &brought[range]
    }

    /// Adds what comes of it to a trail that has come to where it begins, with the help of another trail.
    pub fn follow(&mut self, world: &World, trail: &mut Trail, helper: &mut Trail, importance: Vec3A) {
        for part in 0..trail.parts().len() {
            let (state, share) = trail.parts()[part];
            for &(list, light) in self.outcome(world, state, helper) {
                trail.bring(list, share * importance * light);
            }
        }
    }

    /// All that the path brings.
    pub fn sum(&self) -> Vec3 {
        self.sum
    }
}

impl Witness for Recorder<'_> {
    type Tape = Steps;

    #[inline]
    fn restart(&mut self) {
        self.trail.restart();
    }

    fn take_panes(&mut self, tape: &Steps) {
        self.trail.set_panes(tape.panes_listed());
    }

    fn replay(&mut self, tape: &mut Steps, importance: Vec3) {
        self.beauty += importance * tape.sum();
        tape.follow(self.layers.world, &mut self.trail, &mut self.helper, importance.into());
    }
}
