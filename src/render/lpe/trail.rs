//! What a path carries through the automaton: parts, each a state and its share of whatever the path brings.
//!
//! Where a surface has a diffuse and a glossy layer, one sample stands for both (Veach 1997, 9.2.4: the sampled direction
//! is weighed by the sum of the layers), so a part goes on as two whose shares are those of the layers in that sum, channel
//! by channel. Parts of equal state are one again: there are never more of them than states, and nothing has to be cut
//! off. Parts that no expression can accept any more are dropped, and a path whose parts have all come to states that
//! nothing leaves carries them on for free.
//!
//! A path that several others will go on along is followed once, from each of the states in which they may come to it.

use super::alphabet::Scatter;
use super::automaton::{DEAD, Table};
use super::ledger::Ledger;
use crate::render::LightSource;
use crate::render::bsdf::{Kind, Lobes};
use crate::render::path::Found;
use crate::render::world::{Pane, World};
use glam::{Vec3, Vec3A};

/// A share of a path, and the state that it is in.
#[derive(Clone, Copy)]
struct Part {
    /// Where what it brings stands in the ledger: for each state in which the path may have begun, one sum for each list
    /// of expressions.
    place: u32,
    state: u16,
    share: Vec3A,
}

/// What is for a list of expressions when a path has begun in a state.
pub struct Brought {
    origin: u16,
    list: u16,
    light: Vec3A,
}

pub struct Trail<'a> {
    table: &'a Table,
    parts: Vec<Part>,
    /// Whether no scattering changes any of the parts.
    settled: bool,
    /// The parts before a step, and those at a light.
    before: Vec<Part>,
    ends: Vec<Part>,
    /// What stands between a vertex and the light chosen for it.
    panes: Vec<Pane>,
    /// What the path has brought so far.
    brought: Ledger,
    /// What it has brought since it settled, by lights of this number: its parts share in it alike, in the end.
    rest: Vec3A,
    rest_light: usize,
}

impl<'a> Trail<'a> {
    pub fn new(table: &'a Table) -> Self {
        let [parts, before, ends] = [const { Vec::new() }; 3];
        let (panes, brought) = (Vec::new(), Ledger::default());
        Self { table, parts, settled: false, before, ends, panes, brought, rest: Vec3A::ZERO, rest_light: 0 }
    }

    /// A new path leaves the camera.
    #[inline]
    pub fn start(&mut self) {
        self.start_from(&[self.table.start()]);
    }

    /// A path begins of which nobody knows yet in which of some states: it is followed from each.
    #[inline]
    pub fn start_from(&mut self, origins: &[u16]) {
        self.brought.begin(origins.len() * self.table.lists().len());
        self.rest = Vec3A::ZERO;
        self.set_out(origins);
    }

    /// The path leaves the camera once more, on another way. What it has brought stays.
    #[inline]
    pub fn restart(&mut self) {
        self.share_rest();
        self.set_out(&[self.table.start()]);
    }

    #[inline(always)]
    fn set_out(&mut self, origins: &[u16]) {
        let lists = self.table.lists().len() as u32;
        let part = |(i, &state): (usize, &u16)| Part { place: i as u32 * lists, state, share: Vec3A::ONE };
        self.parts.clear();
        self.parts.extend(origins.iter().enumerate().map(part));
        self.settled = origins.iter().all(|&state| self.table.is_settled(state));
    }

    /// The path goes on as one that was followed from every state that it can be in.
    pub fn follow(&mut self, outcome: &[Brought], importance: Vec3A) {
        for part in &self.parts {
            receive(&mut self.brought, part.state, part.share * importance, outcome);
        }
    }

    /// The same of a path that leaves the camera once more and goes on from its first surface, of a mesh.
    #[inline]
    pub fn follow_from(&mut self, mesh: u32, lobes: Lobes, outcome: &[Brought], importance: Vec3A) {
        let [diffuse, glossy, ..] = *self.table.next(self.table.start(), self.table.class(mesh));
        match only_layer(lobes) {
            Some(Scatter::Diffuse) => receive(&mut self.brought, diffuse, importance, outcome),
            Some(_) => receive(&mut self.brought, glossy, importance, outcome),
            None => {
                let share = diffuse_share(lobes);
                receive(&mut self.brought, diffuse, share * importance, outcome);
                receive(&mut self.brought, glossy, (Vec3A::ONE - share) * importance, outcome);
            }
        }
    }

    /// Says which panes stand between a vertex and the light chosen for it, if they matter.
    pub fn set_panes(&mut self, panes: &[Pane]) {
        if !self.settled && !(panes.is_empty() && self.panes.is_empty()) {
            self.panes.clear();
            self.panes.extend_from_slice(panes);
        }
    }

    /// A place for the panes between a vertex and a light, if they matter.
    #[inline]
    pub fn wants_panes(&mut self) -> Option<&mut Vec<Pane>> {
        if self.settled { None } else { Some(&mut self.panes) }
    }

    #[inline(always)]
    pub fn scatter(&mut self, mesh: u32, kind: Kind, lobes: Lobes) {
        if self.settled {
            return;
        }
        let way = match kind {
            Kind::Spread(_) => only_layer(lobes),
            Kind::Mirrored => Some(Scatter::Mirror),
            Kind::Through => Some(Scatter::Pane),
        };
        match (way, &mut self.parts[..]) {
            // Most paths are still whole.
            (Some(way), [part]) => {
                part.state = self.table.next(part.state, self.table.class(mesh))[way as usize];
                self.settled = self.table.is_settled(part.state);
            }
            _ => self.divide(mesh, way, lobes),
        }
    }

    /// The same for a path of several parts, or one that goes on in several ways.
    #[inline(never)]
    fn divide(&mut self, mesh: u32, way: Option<Scatter>, lobes: Lobes) {
        let Self { table, parts, before, .. } = self;
        std::mem::swap(parts, before);
        go_on(table, table.class(mesh), way, lobes, before, parts);
        self.settled = parts.iter().all(|part| table.is_settled(part.state));
    }

    /// The path, or a connection of it, has come to a light, and brings a contribution: each part of it is for the
    /// expressions of a list.
    #[inline(always)]
    pub fn add(&mut self, world: &World, contribution: Vec3A, source: LightSource, found: Found) {
        let light = self.table.light(source);
        if self.settled {
            if light != self.rest_light {
                self.share_rest();
                self.rest_light = light;
            }
            self.rest += contribution;
            return;
        }
        match found {
            Found::Met => self.share(light, contribution),
            Found::Chosen { mesh, lobes } if self.panes.is_empty() => self.connect(light, contribution, mesh, lobes),
            Found::Chosen { mesh, lobes } => self.connect_through_panes(world, light, contribution, mesh, lobes),
        }
    }

    /// A contribution of which each part has its share.
    #[inline(never)]
    fn share(&mut self, light: usize, contribution: Vec3A) {
        let Self { table, parts, brought, .. } = self;
        for &Part { place, state, share } in parts.iter() {
            bring(brought, place, table.accepting(state, light), share * contribution);
        }
    }

    /// A connection of a vertex to a light.
    #[inline(never)]
    fn connect(&mut self, light: usize, contribution: Vec3A, mesh: u32, lobes: Lobes) {
        let Self { table, parts, brought, .. } = self;
        let class = table.class(mesh);
        if let Some(scatter) = only_layer(lobes) {
            for &Part { place, state, share } in parts.iter() {
                let end = table.next(state, class)[scatter as usize];
                bring(brought, place, table.accepting(end, light), share * contribution);
            }
            return;
        }
        let diffuse = diffuse_share(lobes) * contribution;
        let glossy = contribution - diffuse;
        for &Part { place, state, share } in parts.iter() {
            let [one, other, ..] = *table.next(state, class);
            let (one, other) = (table.accepting(one, light), table.accepting(other, light));
            if one == other {
                bring(brought, place, one, share * contribution);
            } else {
                bring(brought, place, one, share * diffuse);
                bring(brought, place, other, share * glossy);
            }
        }
    }

    /// A connection of a vertex to a light behind panes, each of which splits it.
    #[inline(never)]
    fn connect_through_panes(&mut self, world: &World, light: usize, contribution: Vec3A, mesh: u32, lobes: Lobes) {
        let Self { table, parts, before, ends, panes, brought, .. } = self;
        go_on(table, table.class(mesh), only_layer(lobes), lobes, parts, ends);
        // In the order in which light from the vertex would meet them.
        panes.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        for pane in panes.iter() {
            let (mesh, _) = world.locate(pane.triangle);
            let class = table.class(mesh);
            let through = share_of(pane.through, Vec3::splat(pane.beside) + pane.through);
            std::mem::swap(ends, before);
            ends.clear();
            for part in before.iter() {
                go_two_ways(ends, part, table.next(part.state, class)[Scatter::Pane as usize], part.state, through);
            }
        }
        for &Part { place, state, share } in ends.iter() {
            bring(brought, place, table.accepting(state, light), share * contribution);
        }
    }

    fn share_rest(&mut self) {
        let rest = std::mem::replace(&mut self.rest, Vec3A::ZERO);
        if rest != Vec3A::ZERO {
            self.share(self.rest_light, rest);
        }
    }

    /// Ends the path: gives what it has brought for each list of expressions.
    #[inline]
    pub fn finish(&mut self, take: impl FnMut(usize, Vec3A)) {
        self.share_rest();
        self.brought.drain(take);
    }

    /// The same for one that may have begun in any of some states.
    pub fn finish_from(&mut self, origins: &[u16], outcome: &mut Vec<Brought>) {
        let lists = self.table.lists().len();
        outcome.clear();
        self.finish(|number, light| {
            outcome.push(Brought { origin: origins[number / lists], list: (number % lists) as u16, light });
        });
    }
}

/// Notes a contribution of a part for a list of expressions.
#[inline(always)]
fn bring(brought: &mut Ledger, place: u32, list: u16, light: Vec3A) {
    if list != 0 {
        brought.add(place as usize + usize::from(list), light);
    }
}

/// Notes what came of a path for one of its viewers, who was in a state.
#[inline(always)]
fn receive(brought: &mut Ledger, state: u16, importance: Vec3A, outcome: &[Brought]) {
    for Brought { list, light, .. } in outcome.iter().filter(|b| b.origin == state) {
        brought.add(usize::from(*list), importance * *light);
    }
}

/// The layer that sends all of it on, if one does.
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

/// All parts go on by one event, or by the layers of a surface.
fn go_on(table: &Table, class: usize, scatter: Option<Scatter>, lobes: Lobes, from: &[Part], to: &mut Vec<Part>) {
    to.clear();
    if let Some(scatter) = scatter {
        return from.iter().for_each(|part| add(to, part, table.next(part.state, class)[scatter as usize], part.share));
    }
    let diffuse = diffuse_share(lobes);
    for part in from {
        let [one, other, ..] = *table.next(part.state, class);
        go_two_ways(to, part, one, other, diffuse);
    }
}

/// Of a part, the share `first` goes to one state and the rest to another.
#[inline]
fn go_two_ways(to: &mut Vec<Part>, part: &Part, one: u16, other: u16, first: Vec3A) {
    if one == other {
        return add(to, part, one, part.share);
    }
    let first = part.share * first;
    add(to, part, one, first);
    add(to, part, other, part.share - first);
}

/// Adds what a part comes to, to one of equal place and state if there is one.
#[inline(always)]
fn add(parts: &mut Vec<Part>, from: &Part, state: u16, share: Vec3A) {
    if state == DEAD {
        return;
    }
    match parts.iter_mut().find(|part| part.state == state && part.place == from.place) {
        Some(part) => part.share += share,
        None => parts.push(Part { state, share, ..*from }),
    }
}

#[inline]
fn diffuse_share(lobes: Lobes) -> Vec3A {
    share_of(lobes.diffuse, lobes.sum())
}

/// Channel by channel; none of nothing.
#[inline]
fn share_of(part: Vec3, whole: Vec3) -> Vec3A {
    let (part, whole) = (Vec3A::from(part), Vec3A::from(whole));
    Vec3A::select(whole.cmpgt(Vec3A::ZERO), part / whole, Vec3A::ZERO)
}
