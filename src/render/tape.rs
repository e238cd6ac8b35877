//! Recorded subpaths for `shared`. [`SumTape`] only adds up contributions; [`LpeTape`] also tracks the states of light
//! path expressions.

use super::bsdf::{Lobes, ScatterKind};
use super::contribution::LightSource;
use super::layers::{Layers, Recorder};
use super::lpe::{Automaton, PathOutcome, PathTracker};
use super::path::{Observer, Strategy};
use super::shared::{ReplayObserver, Scratch, Tape};
use super::world::{Pane, World};
use glam::Vec3;

/// An observer and tape that only adds up contributions.
#[derive(Clone, Copy, Default)]
pub struct SumTape(pub Vec3);

impl Observer for SumTape {
    #[inline]
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3, _: Strategy) {
        self.0 += importance * emission;
    }
}

impl Tape for SumTape {
    fn begin(&mut self) {
        self.0 = Vec3::ZERO;
    }

    fn end(&mut self) -> bool {
        self.0 != Vec3::ZERO
    }
}

impl ReplayObserver for SumTape {
    type Tape = Self;

    fn restart(&mut self) {}

    #[inline]
    fn replay(&mut self, tape: &Self, importance: Vec3) {
        self.0 += importance * tape.0;
    }

    #[inline]
    fn replay_from(&mut self, _: u32, _: Lobes, tape: &Self, importance: Vec3) {
        self.replay(tape, importance);
    }
}

/// A tape that adds up contributions, and also tracks the subpath through the automaton of light path expressions. The
/// observers that replay the subpath may be in different states, so the tape tracks it from each of these states.
pub struct LpeTape<'a> {
    world: &'a World,
    automaton: &'a Automaton,
    sum: Vec3,
    tracker: PathTracker<'a>,
    /// States of the automaton. `viewers` are the states after scattering at the primary vertices. `origins` are the
    /// states in which the recorded subpath may begin: the `viewers`, or the states after a further scattering at the
    /// secondary vertex ([`Tape::begin_after_scattering`]).
    viewers: Vec<u16>,
    origins: Vec<u16>,
    outcome: Vec<PathOutcome>,
}

impl<'a> LpeTape<'a> {
    pub fn new(world: &'a World, automaton: &'a Automaton) -> Self {
        let [viewers, origins] = [const { Vec::new() }; 2];
        Self {
            world,
            automaton,
            sum: Vec3::ZERO,
            tracker: PathTracker::new(automaton),
            viewers,
            origins,
            outcome: Vec::new(),
        }
    }
}

impl Observer for LpeTape<'_> {
    #[inline(always)]
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3, strategy: Strategy) {
        let contribution = importance * emission;
        self.sum += contribution;
        self.tracker.add(self.world, contribution.into(), source, strategy);
    }

    #[inline]
    fn scatter(&mut self, mesh: u32, kind: ScatterKind, lobes: Lobes) {
        self.tracker.scatter(mesh, kind, lobes);
    }

    #[inline]
    fn panes(&mut self) -> Option<&mut Vec<Pane>> {
        self.tracker.panes_wanted()
    }
}

impl Tape for LpeTape<'_> {
    fn expect(&mut self, viewers: impl Iterator<Item = (u32, bool)>) {
        self.viewers.clear();
        viewers
            .for_each(|(mesh, layers)| self.automaton.spread(self.automaton.start(), mesh, layers, &mut self.viewers));
    }

    fn begin(&mut self) {
        self.origins.clone_from(&self.viewers);
        self.sum = Vec3::ZERO;
        self.tracker.start_from(&self.origins);
    }

    fn begin_after_scattering(&mut self, mesh: u32) {
        self.origins.clear();
        self.viewers.iter().for_each(|&state| self.automaton.spread(state, mesh, true, &mut self.origins));
        self.sum = Vec3::ZERO;
        self.tracker.start_from(&self.origins);
    }

    fn end(&mut self) -> bool {
        self.tracker.end_from(&self.origins, &mut self.outcome);
        self.sum != Vec3::ZERO
    }
}

impl Layers<'_> {
    /// Returns scratch memory for subpaths that several recorders replay.
    pub fn scratch(&self) -> Scratch<LpeTape<'_>> {
        Scratch::new(LpeTape::new(self.world, &self.automaton))
    }
}

impl<'a> ReplayObserver for Recorder<'a> {
    type Tape = LpeTape<'a>;

    #[inline]
    fn restart(&mut self) {
        self.tracker.restart();
    }

    fn take_panes(&mut self, panes: &[Pane]) {
        self.tracker.set_panes(panes);
    }

    #[inline]
    fn replay(&mut self, tape: &LpeTape, importance: Vec3) {
        self.beauty += importance * tape.sum;
        self.tracker.replay(&tape.outcome, importance.into());
    }

    #[inline]
    fn replay_from(&mut self, mesh: u32, lobes: Lobes, tape: &LpeTape, importance: Vec3) {
        self.beauty += importance * tape.sum;
        self.tracker.replay_from_camera(mesh, lobes, &tape.outcome, importance.into());
    }
}
