//! Compiles all expressions of a render into one deterministic finite automaton (Thompson 1968; subset construction by
//! Rabin and Scott 1959; minimisation by partition refinement, Moore 1956).
//!
//! A path consists of the camera, scattering events and a light. It moves through the automaton with one look-up per
//! event. States from which no light can complete an expression are merged into [`DEAD`]; the light of a path in this
//! state is dropped. Equivalent states are merged too, because a path stores its light separately for each state.

use super::alphabet::{Alphabet, SCATTERS, Scatter};
use super::parse::{Event, EventSet, SyntaxTree, kind};
use super::{EmitterAs, Expression};
use crate::error::{Error, Result};
use crate::render::contribution::LightSource;
use crate::scene::Scene;
use std::collections::BTreeMap;

/// The state from which no expression can be completed.
pub const DEAD: u16 = 0;

/// Limits of the construction, which bound time and memory: number of states of the nondeterministic automaton, number
/// of states before minimisation, and number of visited transitions. [convention]
const MAX_NFA_STATES: usize = 20_000;
const MAX_STATES: usize = 4096;
const MAX_TRANSITIONS: usize = 20_000_000;

/// The automaton that matches paths, as sequences of the events of a scene, against all expressions.
pub struct Automaton {
    alphabet: Alphabet,
    start: u16,
    /// For each state and class of meshes: the next state after each kind of scattering. No expression distinguishes
    /// the meshes of a class.
    next: Vec<[u16; SCATTERS.len()]>,
    /// For each state and light event: index in `lists`. A path that reaches this light in this state is accepted by
    /// exactly the expressions on that list.
    ends: Vec<u16>,
    /// Lists of expressions. For each path, the expressions that accept it form one of these lists; list 0 is empty.
    lists: Vec<Vec<u16>>,
    /// For each state, whether every scattering event leaves it unchanged.
    absorbing: Vec<bool>,
}

impl Automaton {
    /// Compiles the expressions. The index of an expression in `expressions` identifies it in [`Automaton::lists`].
    ///
    /// # Errors
    /// A label that does not exist in the scene; an expression that no path can match; too many states.
    pub fn new(scene: &Scene, expressions: &[&Expression], emitter_as: EmitterAs) -> Result<Self> {
        let alphabet = Alphabet::new(scene, expressions, emitter_as)?;
        let mut nfa = Nfa::default();
        let start = nfa.add()?;
        for (number, expression) in expressions.iter().enumerate() {
            let end = nfa.build(&expression.tree, start)?;
            nfa.accepts[end as usize].push(number as u16);
        }
        let mut construction = SubsetConstruction::new(&nfa, &alphabet);
        let first = construction.explore(start)?;
        let SubsetConstruction { next, ends, lists, .. } = construction;
        // Refuse expressions that accept no path.
        for (number, expression) in expressions.iter().enumerate() {
            if !lists.iter().flatten().any(|&n| usize::from(n) == number) {
                return Err(Error::argument(format!(
                    "expression {:?} matches no path of light: one is a camera, any number of scatterings, and a light",
                    expression.text()
                )));
            }
        }
        let (next, _) = next.as_chunks();
        Ok(Self { start: first, next: next.to_vec(), ends, lists, alphabet, absorbing: Vec::new() }.minimised())
    }

    /// Returns the state of a path that has left the camera.
    pub fn start(&self) -> u16 {
        self.start
    }

    /// Returns the class of a mesh. No expression distinguishes the meshes of a class.
    #[inline]
    pub fn class(&self, mesh: u32) -> usize {
        self.alphabet.class(mesh)
    }

    /// Returns the states after each kind of scattering at a mesh of a class, in the order of [`Scatter`].
    #[inline]
    pub fn next(&self, state: u16, class: usize) -> &[u16; SCATTERS.len()] {
        &self.next[usize::from(state) * self.alphabet.classes() + class]
    }

    /// Adds to `states` the states that follow `state` after diffuse scattering at a mesh and, if `is_layered`, after
    /// glossy scattering. Leaves out the dead state.
    pub fn spread(&self, state: u16, mesh: u32, is_layered: bool, states: &mut Vec<u16>) {
        let next = self.next(state, self.class(mesh));
        for scatter in [Scatter::Diffuse, Scatter::Glossy].into_iter().take(1 + usize::from(is_layered)) {
            let state = next[scatter as usize];
            if state != DEAD && !states.contains(&state) {
                states.push(state);
            }
        }
    }

    /// Returns the index, among the light events of the alphabet, of the event with which a path ends at this light.
    #[inline]
    pub fn light(&self, source: LightSource) -> usize {
        self.alphabet.light(source)
    }

    /// Returns the index, in [`Automaton::lists`], of the list of expressions that accept a path which reaches `light`
    /// in `state`. List 0 is empty.
    #[inline]
    pub fn accepting(&self, state: u16, light: usize) -> u16 {
        self.ends[usize::from(state) * self.alphabet.lights.len() + light]
    }

    /// Returns the lists of expressions. For each path, the expressions that accept it form one of these lists.
    pub fn lists(&self) -> &[Vec<u16>] {
        &self.lists
    }

    /// Whether every scattering event leaves the state unchanged.
    #[inline]
    pub fn is_absorbing(&self, state: u16) -> bool {
        self.absorbing[usize::from(state)]
    }

    #[cfg(test)]
    pub fn states(&self) -> usize {
        self.ends.len() / self.alphabet.lights.len()
    }

    /// Returns the automaton with equivalent states merged.
    fn minimised(self) -> Self {
        let (classes, lights) = (self.alphabet.classes(), self.alphabet.lights.len());
        let count = self.ends.len() / lights;
        // Group the states by the expressions that they accept. Then divide each group whose states lead to different
        // groups, and repeat this until all groups stay as they are.
        let mut group = vec![0u16; count];
        let mut groups = 0;
        loop {
            let mut seen = BTreeMap::new();
            let refined: Vec<u16> = (0..count)
                .map(|state| {
                    let ahead =
                        self.next[state * classes..][..classes].iter().map(|n| n.map(|n| group[usize::from(n)]));
                    let signature = (&self.ends[state * lights..][..lights], ahead.collect::<Vec<_>>());
                    let number = seen.len() as u16;
                    *seen.entry(signature).or_insert(number)
                })
                .collect();
            let found = seen.len();
            group = refined;
            if found == groups {
                break;
            }
            groups = found;
        }
        // Groups are numbered in the order of their first states, so that the dead state 0 stays 0.
        let mut next = vec![[0; SCATTERS.len()]; groups * classes];
        let mut ends = vec![0; groups * lights];
        for state in 0..count {
            let to = usize::from(group[state]);
            for class in 0..classes {
                next[to * classes + class] = self.next[state * classes + class].map(|n| group[usize::from(n)]);
            }
            ends[to * lights..][..lights].copy_from_slice(&self.ends[state * lights..][..lights]);
        }
        let stays =
            |state: usize| next[state * classes..][..classes].as_flattened().iter().all(|&n| usize::from(n) == state);
        let absorbing = (0..groups).map(stays).collect();
        Self { start: group[usize::from(self.start)], next, ends, absorbing, ..self }
    }
}

/// All expressions as one nondeterministic finite automaton (NFA).
#[derive(Default)]
struct Nfa<'a> {
    /// Targets of the epsilon transitions of each state.
    epsilon: Vec<Vec<u32>>,
    /// The event transition of each state, if it has one: the accepted events, and the next state.
    transitions: Vec<Option<(&'a EventSet, u32)>>,
    accepts: Vec<Vec<u16>>,
}

impl<'a> Nfa<'a> {
    fn add(&mut self) -> Result<u32> {
        if self.epsilon.len() >= MAX_NFA_STATES {
            return Err(too_large());
        }
        self.epsilon.push(Vec::new());
        self.transitions.push(None);
        self.accepts.push(Vec::new());
        Ok(self.epsilon.len() as u32 - 1)
    }

    fn add_epsilon(&mut self, from: u32, to: u32) {
        self.epsilon[from as usize].push(to);
    }

    /// Adds states and transitions that match `node`, starting from state `from`. Returns the end state.
    fn build(&mut self, node: &'a SyntaxTree, from: u32) -> Result<u32> {
        match node {
            SyntaxTree::Event(set) => {
                let (before, after) = (self.add()?, self.add()?);
                self.add_epsilon(from, before);
                self.transitions[before as usize] = Some((set, after));
                Ok(after)
            }
            SyntaxTree::Sequence(nodes) => nodes.iter().try_fold(from, |at, node| self.build(node, at)),
            SyntaxTree::Either(nodes) => {
                let end = self.add()?;
                for node in nodes {
                    let last = self.build(node, from)?;
                    self.add_epsilon(last, end);
                }
                Ok(end)
            }
            SyntaxTree::Repeat(node, min, max) => {
                let mut at = from;
                for _ in 0..*min {
                    at = self.build(node, at)?;
                }
                let end = self.add()?;
                self.add_epsilon(at, end);
                match max {
                    None => {
                        let last = self.build(node, end)?;
                        self.add_epsilon(last, end);
                    }
                    Some(max) => {
                        for _ in *min..*max {
                            at = self.build(node, at)?;
                            self.add_epsilon(at, end);
                        }
                    }
                }
                Ok(end)
            }
        }
    }
}

/// The subset construction: each set of NFA states that a path can be in becomes one state.
struct SubsetConstruction<'a> {
    nfa: &'a Nfa<'a>,
    scatters: &'a [Event],
    lights: &'a [Event],
    /// Index of each set of NFA states found so far, and of each list of expressions found so far.
    number_of_set: BTreeMap<Vec<u32>, u16>,
    number_of_list: BTreeMap<Vec<u16>, u16>,
    next: Vec<u16>,
    ends: Vec<u16>,
    lists: Vec<Vec<u16>>,
    /// For each NFA state, the number of the last call of `closure` that visited the state (`visited`), and the number
    /// of calls of `closure` so far (`rounds`).
    visited: Vec<u32>,
    rounds: u32,
    transitions_left: usize,
}

impl<'a> SubsetConstruction<'a> {
    fn new(nfa: &'a Nfa<'a>, alphabet: &'a Alphabet) -> Self {
        Self {
            nfa,
            scatters: &alphabet.scatters,
            lights: &alphabet.lights,
            number_of_set: BTreeMap::from([(Vec::new(), DEAD)]),
            number_of_list: BTreeMap::from([(Vec::new(), 0)]),
            next: Vec::new(),
            ends: Vec::new(),
            lists: vec![Vec::new()],
            visited: vec![0; nfa.epsilon.len()],
            rounds: 0,
            transitions_left: MAX_TRANSITIONS,
        }
    }

    /// Finds all states that a path can reach after the camera event, and fills `next`, `ends` and `lists`. Returns
    /// the state right after the camera event.
    fn explore(&mut self, start: u32) -> Result<u16> {
        let camera = Event { kinds: kind::CAMERA, modes: 0, labels: Vec::new() };
        let mut sets = vec![Vec::new()];
        let before = self.closure(&[start])?;
        let first = self.after(&before, &camera)?;
        let first = self.number(first, &mut sets)?;
        let (scatters, lights) = (self.scatters, self.lights);
        let mut state = 0;
        while let Some(set) = sets.get(state).cloned() {
            for event in scatters {
                let after = self.after(&set, event)?;
                let number = self.number(after, &mut sets)?;
                self.next.push(number);
            }
            for light in lights {
                let after = self.after(&set, light)?;
                let mut list: Vec<u16> = after.iter().flat_map(|&p| &self.nfa.accepts[p as usize]).copied().collect();
                list.sort_unstable();
                list.dedup();
                let number = self.lists.len() as u16;
                let number = *self.number_of_list.entry(list.clone()).or_insert(number);
                if usize::from(number) == self.lists.len() {
                    self.lists.push(list);
                }
                self.ends.push(number);
            }
            state += 1;
        }
        Ok(first)
    }

    fn number(&mut self, set: Vec<u32>, sets: &mut Vec<Vec<u32>>) -> Result<u16> {
        if let Some(&number) = self.number_of_set.get(&set) {
            return Ok(number);
        }
        if sets.len() >= MAX_STATES {
            return Err(too_large());
        }
        let number = sets.len() as u16;
        self.number_of_set.insert(set.clone(), number);
        sets.push(set);
        Ok(number)
    }

    fn after(&mut self, set: &[u32], event: &Event) -> Result<Vec<u32>> {
        self.spend(set.len())?;
        let transitions = set.iter().filter_map(|&p| self.nfa.transitions[p as usize]);
        let reached: Vec<u32> = transitions.filter(|(events, _)| events.contains(event)).map(|(_, to)| to).collect();
        self.closure(&reached)
    }

    /// Returns the epsilon closure of NFA states, without the states that have no event transition and accept no
    /// expression.
    fn closure(&mut self, from: &[u32]) -> Result<Vec<u32>> {
        self.rounds += 1;
        let matters = |p: usize| self.nfa.transitions[p].is_some() || !self.nfa.accepts[p].is_empty();
        let (mut waiting, mut reached, mut visited) = (from.to_vec(), Vec::new(), 0);
        while let Some(place) = waiting.pop() {
            let at = place as usize;
            if std::mem::replace(&mut self.visited[at], self.rounds) != self.rounds {
                visited += 1;
                waiting.extend(&self.nfa.epsilon[at]);
                reached.extend(matters(at).then_some(place));
            }
        }
        self.spend(visited)?;
        reached.sort_unstable();
        Ok(reached)
    }

    fn spend(&mut self, transitions: usize) -> Result<()> {
        self.transitions_left = self.transitions_left.checked_sub(transitions).ok_or_else(too_large)?;
        Ok(())
    }
}

fn too_large() -> Error {
    Error::argument(format!(
        "the expressions together need an automaton of more than {MAX_STATES} states, or too much work to build it; \
         shorten their repetitions or render them in groups"
    ))
}
