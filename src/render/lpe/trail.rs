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
    /// The state of a path that has not split.
    state: u16,
    /// The parts of one that has.
    parts: Vec<(u16, Vec3)>,
    split: bool,
    /// Whether no scattering changes any of the parts.
    settled: bool,
    /// The parts before a step, and those at a light.
    before: Vec<(u16, Vec3)>,
    ends: Vec<(u16, Vec3)>,
    /// What stands between a vertex and the light chosen for it.
    panes: Vec<Pane>,
    /// What the path has brought so far, and the list of the expressions that it is for.
    brought: Vec<(u16, Vec3)>,
    /// What it has brought since it settled, by lights of this number: its parts share in it alike, in the end.
    rest: Vec3,
    rest_light: usize,
}

impl<'a> Trail<'a> {
    pub fn new(table: &'a Table) -> Self {
        let [parts, before, ends, brought] = [const { Vec::new() }; 4];
        let (state, settled) = (table.start(), table.is_settled(table.start()));
        let (panes, rest, rest_light) = (Vec::new(), Vec3::ZERO, 0);
        Self { table, state, parts, split: false, settled, before, ends, panes, brought, rest, rest_light }
    }

    /// A new path leaves the camera.
    #[inline]
    pub fn start(&mut self) {
        self.brought.clear();
        self.rest = Vec3::ZERO;
        self.state = self.table.start();
        self.split = false;
        self.settled = self.table.is_settled(self.state);
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
        let scatter = match kind {
            Kind::Spread(_) => only_layer(lobes),
            Kind::Mirrored => Some(Scatter::Mirror),
            Kind::Through => Some(Scatter::Pane),
        };
        match scatter {
            Some(scatter) if !self.split => {
                self.state = self.table.next(self.state, self.table.event(mesh, scatter));
                self.settled = self.table.is_settled(self.state);
            }
            _ => self.step(mesh, scatter, lobes),
        }
    }

    /// A step of a path that has split or may do so now.
    #[inline(never)]
    fn step(&mut self, mesh: u32, scatter: Option<Scatter>, lobes: Lobes) {
        let Self { table, parts, before, .. } = self;
        if !self.split {
            let [one, other] = layers(table, self.state, mesh);
            if one == other {
                self.state = one;
                self.settled = table.is_settled(one);
                return;
            }
            self.split = true;
            let diffuse = share_of(lobes.diffuse, lobes.sum());
            parts.clear();
            parts.extend([(one, diffuse), (other, Vec3::ONE - diffuse)].into_iter().filter(|part| part.0 != DEAD));
        } else {
            std::mem::swap(parts, before);
            match scatter {
                Some(scatter) => all_go(table, mesh, scatter, before, parts),
                None => spread(table, mesh, lobes, before, parts),
            }
        }
        self.settled = parts.iter().all(|&(state, _)| table.is_settled(state));
    }

    /// The path, or a connection of it, has come to a light, and brings a contribution: each part of it is for the
    /// expressions of a list.
    #[inline(always)]
    pub fn add(&mut self, world: &World, contribution: Vec3, source: LightSource, found: Found) {
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
            Found::Met if !self.split => self.bring(self.state, light, contribution),
            Found::Chosen { mesh, lobes } => match only_layer(lobes) {
                Some(scatter) if !self.split && self.panes.is_empty() => {
                    self.bring(self.table.next(self.state, self.table.event(mesh, scatter)), light, contribution);
                }
                _ => self.connect(world, contribution, light, mesh, lobes),
            },
            Found::Met => self.share(light, contribution),
        }
    }

    /// A connection in several parts.
    #[inline(never)]
    fn connect(&mut self, world: &World, contribution: Vec3, light: usize, mesh: u32, lobes: Lobes) {
        let whole = [(self.state, Vec3::ONE)];
        let (mut parts, mut ends) = (std::mem::take(&mut self.parts), std::mem::take(&mut self.ends));
        let from = if self.split { &parts[..] } else { &whole };
        if self.panes.is_empty() {
            let diffuse = share_of(lobes.diffuse, lobes.sum());
            for &(state, share) in from {
                let [one, other] = layers(self.table, state, mesh);
                let all = share * contribution;
                let first = if one == other { all } else { diffuse * all };
                self.bring(one, light, first);
                if one != other {
                    self.bring(other, light, all - first);
                }
            }
        } else {
            connect(self.table, world, mesh, lobes, from, &mut self.panes, &mut ends, &mut self.before);
            ends.iter().for_each(|&(state, share)| self.bring(state, light, share * contribution));
        }
        std::mem::swap(&mut self.parts, &mut parts);
        self.ends = ends;
    }

    /// A contribution of which each part has its share.
    #[inline(never)]
    fn share(&mut self, light: usize, contribution: Vec3) {
        if !self.split {
            return self.bring(self.state, light, contribution);
        }
        for i in 0..self.parts.len() {
            let (state, share) = self.parts[i];
            self.bring(state, light, share * contribution);
        }
    }

    #[inline]
    fn bring(&mut self, state: u16, light: usize, contribution: Vec3) {
        match self.table.accepting(state, light) {
            0 => {}
            list => match self.brought.last_mut() {
                Some(last) if last.0 == list => last.1 += contribution,
                _ => self.brought.push((list, contribution)),
            },
        }
    }

    fn share_rest(&mut self) {
        let rest = std::mem::replace(&mut self.rest, Vec3::ZERO);
        if rest != Vec3::ZERO {
            self.share(self.rest_light, rest);
        }
    }

    /// Ends the path: what it has brought, and for which list of expressions.
    #[inline]
    pub fn finish(&mut self) -> &[(u16, Vec3)] {
        self.share_rest();
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

/// The states after the diffuse and after the glossy layer of a mesh.
#[inline]
fn layers(table: &Table, state: u16, mesh: u32) -> [u16; 2] {
    [Scatter::Diffuse, Scatter::Glossy].map(|scatter| table.next(state, table.event(mesh, scatter)))
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
    let diffuse = share_of(lobes.diffuse, lobes.sum());
    to.clear();
    for &(state, share) in from {
        let [one, other] = layers(table, state, mesh);
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
