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
}

impl<'a> Trail<'a> {
    pub fn new(table: &'a Table) -> Self {
        let [parts, before, ends] = [Vec::new(), Vec::new(), Vec::new()];
        Self { table, parts, settled: true, before, ends, panes: Vec::new() }
    }

    /// A new path leaves the camera.
    pub fn start(&mut self) {
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

    fn step(&mut self, mesh: u32, kind: Kind, lobes: Lobes) {
        let Self { table, parts, before, .. } = self;
        std::mem::swap(parts, before);
        match kind {
            Kind::Spread(_) => spread(table, mesh, lobes, before, parts),
            Kind::Mirrored => all_go(table, mesh, Scatter::Mirror, before, parts),
            Kind::Through => all_go(table, mesh, Scatter::Pane, before, parts),
        }
        self.settled = self.parts.iter().all(|&(state, _)| self.table.is_settled(state));
    }

    /// The path, or a connection of it, has come to a light, and brings a contribution: each expression gets its share.
    #[inline]
    pub fn add(&mut self, world: &World, contribution: Vec3, source: LightSource, found: Found, sums: &mut [Vec3]) {
        let table = self.table;
        let parts = match found {
            Found::Chosen { mesh, lobes } if !self.settled => self.connect(world, mesh, lobes),
            _ => &self.parts,
        };
        let light = table.light(source);
        for &(state, share) in parts {
            for &expression in table.accepting(state, light) {
                sums[usize::from(expression)] += share * contribution;
            }
        }
    }

    /// The parts behind a vertex and the panes listed.
    fn connect(&mut self, world: &World, mesh: u32, lobes: Lobes) -> &[(u16, Vec3)] {
        let Self { table, parts, before, ends, panes, .. } = self;
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
        ends
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
    if lobes.glossy == Vec3::ZERO {
        return all_go(table, mesh, Scatter::Diffuse, from, to);
    }
    if lobes.diffuse == Vec3::ZERO {
        return all_go(table, mesh, Scatter::Glossy, from, to);
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
