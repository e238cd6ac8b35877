//! Tracks a light path through the automaton of light path expressions. The path is a list of components. Each
//! component is a state of the automaton with its share of the path's light.
//!
//! A sample at a surface with a diffuse and a glossy layer stands for both layers, as it is weighted by the sum of the
//! BSDF values of the two layers (Veach 1997, 9.2.4). A component therefore splits in two, in proportion to these
//! values, channel by channel. Components with equal states are merged, so there are never more components than states.
//! Components in the dead state are dropped. Once all components are in absorbing states, which scattering leaves
//! unchanged, further scattering costs nothing.
//!
//! A subpath that several paths reuse is traced only once. It is tracked separately for each of its initial states:
//! the states in which these paths may join it.

use super::alphabet::Scatter;
use super::automaton::{Automaton, DEAD};
use super::sparse_sums::SparseSums;
use crate::render::bsdf::{Lobes, ScatterKind};
use crate::render::contribution::LightSource;
use crate::render::path::Strategy;
use crate::render::world::{Pane, World};
use glam::{Vec3, Vec3A};

/// A state of the automaton with its share of the path's light.
#[derive(Clone, Copy)]
struct Component {
    /// Index, in `PathTracker::sums`, of the first sum that belongs to the component's initial state. Each initial
    /// state has one sum per list of expressions.
    offset: u32,
    state: u16,
    share: Vec3A,
}

/// Light of a recorded subpath for one initial state (`origin`) and one list of expressions.
pub struct PathOutcome {
    origin: u16,
    list: u16,
    light: Vec3A,
}

pub struct PathTracker<'a> {
    automaton: &'a Automaton,
    components: Vec<Component>,
    /// Whether all components are in absorbing states.
    absorbing: bool,
    /// Scratch memory: the components before an event (`before`), and the components at a light (`ends`).
    before: Vec<Component>,
    ends: Vec<Component>,
    /// The panes between the current vertex and its light sample.
    panes: Vec<Pane>,
    /// Light of the path so far, for each initial state and each list of expressions.
    sums: SparseSums,
    /// Light that has arrived since all states became absorbing and is not yet in `sums`. All of it has the light event
    /// `rest_light`. `flush_rest` adds it to the sums of the components.
    rest: Vec3A,
    rest_light: usize,
}

impl<'a> PathTracker<'a> {
    pub fn new(automaton: &'a Automaton) -> Self {
        let [components, before, ends] = [const { Vec::new() }; 3];
        let (panes, sums) = (Vec::new(), SparseSums::default());
        Self { automaton, components, absorbing: false, before, ends, panes, sums, rest: Vec3A::ZERO, rest_light: 0 }
    }

    /// Begins a path at the camera.
    #[inline]
    pub fn start(&mut self) {
        self.start_from(&[self.automaton.start()]);
    }

    /// Begins a subpath that is tracked from each of the given initial states.
    #[inline]
    pub fn start_from(&mut self, origins: &[u16]) {
        self.sums.begin(origins.len() * self.automaton.lists().len());
        self.rest = Vec3A::ZERO;
        self.reset_components(origins);
    }

    /// Goes back to the camera to begin another path of the same pixel. The sums are kept.
    #[inline]
    pub fn restart(&mut self) {
        self.flush_rest();
        self.reset_components(&[self.automaton.start()]);
    }

    #[inline(always)]
    fn reset_components(&mut self, origins: &[u16]) {
        let lists = self.automaton.lists().len() as u32;
        let component = |(i, &state): (usize, &u16)| Component { offset: i as u32 * lists, state, share: Vec3A::ONE };
        self.components.clear();
        self.components.extend(origins.iter().enumerate().map(component));
        self.absorbing = origins.iter().all(|&state| self.automaton.is_absorbing(state));
    }

    /// Continues along a recorded subpath: for each component, adds the light that the subpath has for the component's
    /// state, multiplied by `importance` and the component's share.
    pub fn replay(&mut self, outcome: &[PathOutcome], importance: Vec3A) {
        for component in &self.components {
            replay_outcome(&mut self.sums, component.state, component.share * importance, outcome);
        }
    }

    /// Adds the light of a recorded subpath, multiplied by `importance`, for a path that starts at the camera and joins
    /// the subpath after scattering at a primary vertex on `mesh`. The current components do not matter.
    #[inline]
    pub fn replay_from_camera(&mut self, mesh: u32, lobes: Lobes, outcome: &[PathOutcome], importance: Vec3A) {
        let [diffuse, glossy, ..] = *self.automaton.next(self.automaton.start(), self.automaton.class(mesh));
        match only_layer(lobes) {
            Some(Scatter::Diffuse) => replay_outcome(&mut self.sums, diffuse, importance, outcome),
            Some(_) => replay_outcome(&mut self.sums, glossy, importance, outcome),
            None => {
                let share = diffuse_fraction(lobes);
                replay_outcome(&mut self.sums, diffuse, share * importance, outcome);
                replay_outcome(&mut self.sums, glossy, (Vec3A::ONE - share) * importance, outcome);
            }
        }
    }

    /// Sets the panes between a vertex and its light sample. Does nothing if every component of the path is in an
    /// absorbing state, which no pane changes.
    pub fn set_panes(&mut self, panes: &[Pane]) {
        if !self.absorbing && !(panes.is_empty() && self.panes.is_empty()) {
            self.panes.clear();
            self.panes.extend_from_slice(panes);
        }
    }

    /// Returns the list to fill with the panes between a vertex and its light sample; `None` if every component is in
    /// an absorbing state, where panes change nothing.
    #[inline]
    pub fn panes_wanted(&mut self) -> Option<&mut Vec<Pane>> {
        if self.absorbing { None } else { Some(&mut self.panes) }
    }

    #[inline(always)]
    pub fn scatter(&mut self, mesh: u32, kind: ScatterKind, lobes: Lobes) {
        if self.absorbing {
            return;
        }
        let scatter = match kind {
            ScatterKind::NonSpecular(_) => only_layer(lobes),
            ScatterKind::Mirror => Some(Scatter::Mirror),
            ScatterKind::Pane => Some(Scatter::Pane),
            ScatterKind::Refraction { is_rough: false } => Some(Scatter::Refraction),
            ScatterKind::Refraction { is_rough: true } => Some(Scatter::RoughRefraction),
        };
        match (scatter, &mut self.components[..]) {
            // Handle the common case of a single component.
            (Some(scatter), [component]) => {
                component.state = self.automaton.next(component.state, self.automaton.class(mesh))[scatter as usize];
                self.absorbing = self.automaton.is_absorbing(component.state);
            }
            _ => self.divide(mesh, scatter, lobes),
        }
    }

    /// Advances the components by a scattering event in the general case: there are several components, or the two
    /// layers of the surface split a component.
    #[inline(never)]
    fn divide(&mut self, mesh: u32, scatter: Option<Scatter>, lobes: Lobes) {
        let Self { automaton, components, before, .. } = self;
        std::mem::swap(components, before);
        advance(automaton, automaton.class(mesh), scatter, lobes, before, components);
        self.absorbing = components.iter().all(|component| automaton.is_absorbing(component.state));
    }

    /// Adds the contribution of a light that the path has hit or that a light sample has found. Each component adds its
    /// share of the contribution to the sum of one list: the list of the expressions that accept the component's path.
    #[inline(always)]
    pub fn add(&mut self, world: &World, contribution: Vec3A, source: LightSource, strategy: Strategy) {
        let light = self.automaton.light(source);
        if self.absorbing {
            if light != self.rest_light {
                self.flush_rest();
                self.rest_light = light;
            }
            self.rest += contribution;
            return;
        }
        match strategy {
            Strategy::BsdfSample => self.add_to_components(light, contribution),
            Strategy::LightSample { mesh, lobes } if self.panes.is_empty() => {
                self.connect(light, contribution, mesh, lobes)
            }
            Strategy::LightSample { mesh, lobes } => {
                self.connect_through_panes(world, light, contribution, mesh, lobes)
            }
        }
    }

    /// For each component, adds the contribution times the component's share to the sum of one list: the list of the
    /// expressions that accept the component's path to the light event `light`.
    #[inline(never)]
    fn add_to_components(&mut self, light: usize, contribution: Vec3A) {
        let Self { automaton, components, sums, .. } = self;
        for &Component { offset, state, share } in components.iter() {
            add_to_list(sums, offset, automaton.accepting(state, light), share * contribution);
        }
    }

    /// Adds the contribution of a light sample at a vertex on `mesh`. A copy of each component scatters at the vertex
    /// and ends at the light; the components themselves stay in their states.
    #[inline(never)]
    fn connect(&mut self, light: usize, contribution: Vec3A, mesh: u32, lobes: Lobes) {
        let Self { automaton, components, sums, .. } = self;
        let class = automaton.class(mesh);
        if let Some(scatter) = only_layer(lobes) {
            for &Component { offset, state, share } in components.iter() {
                let end = automaton.next(state, class)[scatter as usize];
                add_to_list(sums, offset, automaton.accepting(end, light), share * contribution);
            }
            return;
        }
        let diffuse = diffuse_fraction(lobes) * contribution;
        let glossy = contribution - diffuse;
        for &Component { offset, state, share } in components.iter() {
            let [first_state, second_state, ..] = *automaton.next(state, class);
            let (first_list, second_list) =
                (automaton.accepting(first_state, light), automaton.accepting(second_state, light));
            if first_list == second_list {
                add_to_list(sums, offset, first_list, share * contribution);
            } else {
                add_to_list(sums, offset, first_list, share * diffuse);
                add_to_list(sums, offset, second_list, share * glossy);
            }
        }
    }

    /// Adds the contribution of a light sample that reaches the vertex through panes. Each pane splits every component
    /// in two: one part of the component's light passes through the pane; if the pane's opacity is below 1, the
    /// remainder misses the pane.
    #[inline(never)]
    fn connect_through_panes(&mut self, world: &World, light: usize, contribution: Vec3A, mesh: u32, lobes: Lobes) {
        let Self { automaton, components, before, ends, panes, sums, .. } = self;
        advance(automaton, automaton.class(mesh), only_layer(lobes), lobes, components, ends);
        // Sort the panes by their distance from the vertex.
        panes.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        for pane in panes.iter() {
            let (mesh, _) = world.locate(pane.triangle);
            let class = automaton.class(mesh);
            let through = fraction(pane.through, Vec3::splat(pane.uncovered) + pane.through);
            std::mem::swap(ends, before);
            ends.clear();
            for component in before.iter() {
                split_component(
                    ends,
                    component,
                    automaton.next(component.state, class)[Scatter::Pane as usize],
                    component.state,
                    through,
                );
            }
        }
        for &Component { offset, state, share } in ends.iter() {
            add_to_list(sums, offset, automaton.accepting(state, light), share * contribution);
        }
    }

    fn flush_rest(&mut self) {
        let rest = std::mem::replace(&mut self.rest, Vec3A::ZERO);
        if rest != Vec3A::ZERO {
            self.add_to_components(self.rest_light, rest);
        }
    }

    /// Ends the path. Calls `take` with the index and the value of each sum of light to which the path contributes. Let
    /// n be the number of lists of expressions. The sum of list `l`, for the initial state at index `s` of the states
    /// given to [`Self::start_from`], has the index `s × n + l`. A path from the camera has one initial state, so the
    /// index of its sum is `l`.
    #[inline]
    pub fn end(&mut self, take: impl FnMut(usize, Vec3A)) {
        self.flush_rest();
        self.sums.drain(take);
    }

    /// Ends a subpath. Stores in `outcome` the light of the subpath for each initial state and each list of
    /// expressions. `origins` are the initial states that [`Self::start_from`] was given.
    pub fn end_from(&mut self, origins: &[u16], outcome: &mut Vec<PathOutcome>) {
        let lists = self.automaton.lists().len();
        outcome.clear();
        self.end(|number, light| {
            outcome.push(PathOutcome { origin: origins[number / lists], list: (number % lists) as u16, light });
        });
    }
}

/// Adds light to the sum of a list of expressions; does nothing for list 0, which is empty. `offset` is the index of
/// the first sum of the initial state.
#[inline(always)]
fn add_to_list(sums: &mut SparseSums, offset: u32, list: u16, light: Vec3A) {
    if list != 0 {
        sums.add(offset as usize + usize::from(list), light);
    }
}

/// Adds the light of a recorded subpath for the initial state `state`, multiplied by `importance`.
#[inline(always)]
fn replay_outcome(sums: &mut SparseSums, state: u16, importance: Vec3A, outcome: &[PathOutcome]) {
    for PathOutcome { list, light, .. } in outcome.iter().filter(|b| b.origin == state) {
        sums.add(usize::from(*list), importance * *light);
    }
}

/// Returns the layer that scatters: `Diffuse` if the glossy value is zero, `Glossy` if only the diffuse value is zero,
/// and `None` if neither is.
#[inline]
fn only_layer(lobes: Lobes) -> Option<Scatter> {
    if lobes.glossy == Vec3::ZERO {
        Some(Scatter::Diffuse)
    } else if lobes.diffuse == Vec3::ZERO {
        Some(Scatter::Glossy)
    } else {
        None
    }
}

/// Advances all components by the event `scatter`. If `scatter` is `None`, the surface scatters in both layers, and
/// each component splits into a diffuse and a glossy one.
fn advance(
    automaton: &Automaton,
    class: usize,
    scatter: Option<Scatter>,
    lobes: Lobes,
    from: &[Component],
    to: &mut Vec<Component>,
) {
    to.clear();
    if let Some(scatter) = scatter {
        return from.iter().for_each(|component| {
            add(to, component, automaton.next(component.state, class)[scatter as usize], component.share)
        });
    }
    let diffuse = diffuse_fraction(lobes);
    for component in from {
        let [first_state, second_state, ..] = *automaton.next(component.state, class);
        split_component(to, component, first_state, second_state, diffuse);
    }
}

/// Splits a component: `first_share` of its light goes to `first_state`, the remainder to `second_state`.
#[inline]
fn split_component(
    to: &mut Vec<Component>,
    component: &Component,
    first_state: u16,
    second_state: u16,
    first_share: Vec3A,
) {
    if first_state == second_state {
        return add(to, component, first_state, component.share);
    }
    let first = component.share * first_share;
    add(to, component, first_state, first);
    add(to, component, second_state, component.share - first);
}

/// Adds a component with the given state and share and the offset of `from`. If there is a component of equal offset
/// and state, adds the share to that one. In the dead state, drops the component.
#[inline(always)]
fn add(components: &mut Vec<Component>, from: &Component, state: u16, share: Vec3A) {
    if state == DEAD {
        return;
    }
    match components.iter_mut().find(|component| component.state == state && component.offset == from.offset) {
        Some(component) => component.share += share,
        None => components.push(Component { state, share, ..*from }),
    }
}

#[inline]
fn diffuse_fraction(lobes: Lobes) -> Vec3A {
    fraction(lobes.diffuse, lobes.sum())
}

/// Returns the ratio `component / whole` per channel; 0 where `whole` is 0.
#[inline]
fn fraction(component: Vec3, whole: Vec3) -> Vec3A {
    let (component, whole) = (Vec3A::from(component), Vec3A::from(whole));
    Vec3A::select(whole.cmpgt(Vec3A::ZERO), component / whole, Vec3A::ZERO)
}
