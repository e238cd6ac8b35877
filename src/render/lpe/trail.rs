//! What a path carries through the automaton: parts, each a state and its share of whatever the path brings.
//!
//! Where a surface has a diffuse and a glossy layer, one sample stands for both (Veach 1997, 9.2.4: the sampled direction
//! is weighed by the sum of the layers), so a part goes on as two whose shares are those of the layers in that sum, channel
//! by channel. Parts of equal state are one again: there are never more of them than states, and nothing has to be cut
//! off. Parts that no expression can accept any more are dropped, and a path whose parts have all come to states that
//! nothing leaves carries them on for free.

use super::alphabet::Scatter;
use super::automaton::{DEAD, Table};
use crate::render::LightSource;
use crate::render::bsdf::{Kind, Lobes};
use crate::render::path::Found;
use crate::render::world::{Pane, World};
use glam::Vec3;

pub struct Trail<'a> {
    table: &'a Table,
    parts: Vec<(u16, Vec3)>,
    /// Whether no scattering changes any of the parts.
    settled: bool,
    /// The parts before a step, and those at a light.
    before: Vec<(u16, Vec3)>,
    ends: Vec<(u16, Vec3)>,
    /// What stands between a vertex and the light chosen for it.
    panes: Vec<Pane>,
    /// What the path has brought so far, and the list of the expressions that it is for.
    brought: Vec<(u16, Vec3)>,
}

impl<'a> Trail<'a> {
    pub fn new(table: &'a Table) -> Self {
        let [parts, before, ends, brought] = [const { Vec::new() }; 4];
        Self { table, parts, settled: true, before, ends, panes: Vec::new(), brought }
    }

    /// A new path leaves the camera.
    #[inline]
    pub fn start(&mut self) {
        self.brought.clear();
        self.parts.clear();
        add(&mut self.parts, self.table.start(), Vec3::ONE);
        self.settled = self.table.is_settled(self.table.start());
    }

    /// A place for the panes between a vertex and a light, if they matter.
    #[inline]
    pub fn wants_panes(&mut self) -> Option<&mut Vec<Pane>> {
        if self.settled { None } else { Some(&mut self.panes) }
    }

    #[inline]
    pub fn scatter(&mut self, mesh: u32, kind: Kind, lobes: Lobes) {
        if !self.settled {
            self.step(mesh, kind, lobes);
        }
    }

    #[inline]
    fn step(&mut self, mesh: u32, kind: Kind, lobes: Lobes) {
        let Self { table, parts, before, .. } = self;
        let scatter = match kind {
            Kind::Spread(_) => only_layer(lobes),
            Kind::Mirrored => Some(Scatter::Mirror),
            Kind::Through => Some(Scatter::Pane),
        };
        // One part that goes one way is the common case.
        if let (Some(scatter), [(state, _)]) = (scatter, parts.as_mut_slice()) {
            *state = table.next(*state, table.event(mesh, scatter));
            self.settled = table.is_settled(*state);
            if *state == DEAD {
                parts.clear();
            }
            return;
        }
        std::mem::swap(parts, before);
        match scatter {
            Some(scatter) => all_go(table, mesh, scatter, before, parts),
            None => spread(table, mesh, lobes, before, parts),
        }
        self.settled = self.parts.iter().all(|&(state, _)| self.table.is_settled(state));
    }

    /// The path, or a connection of it, has come to a light, and brings a contribution: each part of it is for the
    /// expressions of a list.
    #[inline]
    pub fn add(&mut self, world: &World, contribution: Vec3, source: LightSource, found: Found) {
        let Self { table, parts, settled, before, ends, panes, brought } = self;
        let light = table.light(source);
        let mut bring = |state: u16, share: Vec3| match table.accepting(state, light) {
            0 => {}
            list => match brought.last_mut() {
                Some(last) if last.0 == list => last.1 += share * contribution,
                _ => brought.push((list, share * contribution)),
            },
        };
        let Found::Chosen { mesh, lobes } = found else {
            return parts.iter().for_each(|&(state, share)| bring(state, share));
        };
        if *settled {
            return parts.iter().for_each(|&(state, share)| bring(state, share));
        }
        if let (Some(scatter), [(state, share)], true) = (only_layer(lobes), parts.as_slice(), panes.is_empty()) {
            return bring(table.next(*state, table.event(mesh, scatter)), *share);
        }
        connect(table, world, mesh, lobes, parts, panes, ends, before);
        ends.iter().for_each(|&(state, share)| bring(state, share));
    }

    /// What the path has brought, and for which list of expressions.
    #[inline]
    pub fn brought(&self) -> &[(u16, Vec3)] {
        &self.brought
    }
}

/// The parts behind a vertex and the panes between it and a light.
#[allow(clippy::too_many_arguments)]
fn connect(
    table: &Table,
    world: &World,
    mesh: u32,
    lobes: Lobes,
    parts: &[(u16, Vec3)],
    panes: &mut [Pane],
    ends: &mut Vec<(u16, Vec3)>,
    before: &mut Vec<(u16, Vec3)>,
) {
    spread(table, mesh, lobes, parts, ends);
    // In the order in which light from the vertex would meet them.
    panes.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
    for pane in panes.iter() {
        let (mesh, _) = world.locate(pane.triangle);
        let through = share_of(pane.through, Vec3::splat(pane.beside) + pane.through);
        let event = table.event(mesh, Scatter::Pane);
        std::mem::swap(ends, before);
        ends.clear();
        for &(state, share) in before.iter() {
            go_two_ways(ends, table.next(state, event), state, share, through);
        }
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

/// All parts go on by one event.
fn all_go(table: &Table, mesh: u32, scatter: Scatter, from: &[(u16, Vec3)], to: &mut Vec<(u16, Vec3)>) {
    let event = table.event(mesh, scatter);
    to.clear();
    for &(state, share) in from {
        add(to, table.next(state, event), share);
    }
}

/// All parts go on by the layers of a surface.
fn spread(table: &Table, mesh: u32, lobes: Lobes, from: &[(u16, Vec3)], to: &mut Vec<(u16, Vec3)>) {
    if let Some(scatter) = only_layer(lobes) {
        return all_go(table, mesh, scatter, from, to);
    }
    let events = [Scatter::Diffuse, Scatter::Glossy].map(|scatter| table.event(mesh, scatter));
    let diffuse = share_of(lobes.diffuse, lobes.sum());
    to.clear();
    for &(state, share) in from {
        let [one, other] = events.map(|event| table.next(state, event));
        go_two_ways(to, one, other, share, diffuse);
    }
}

/// Of a part, the share `first` goes to one state and the rest to another.
#[inline]
fn go_two_ways(to: &mut Vec<(u16, Vec3)>, one: u16, other: u16, share: Vec3, first: Vec3) {
    if one == other {
        return add(to, one, share);
    }
    let first = share * first;
    add(to, one, first);
    add(to, other, share - first);
}

/// Adds a part, to one of equal state if there is one.
#[inline]
fn add(parts: &mut Vec<(u16, Vec3)>, state: u16, share: Vec3) {
    if state == DEAD {
        return;
    }
    match parts.iter_mut().find(|part| part.0 == state) {
        Some(part) => part.1 += share,
        None => parts.push((state, share)),
    }
}

/// Channel by channel; none of nothing.
fn share_of(part: Vec3, whole: Vec3) -> Vec3 {
    Vec3::select(whole.cmpgt(Vec3::ZERO), part / whole, Vec3::ZERO)
}
