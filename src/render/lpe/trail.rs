//! What a path carries through the automaton: parts, each a state and a throughput, that sum to the throughput of the
//! path.
//!
//! Where a surface has a diffuse and a glossy layer, one sample stands for both (Veach 1997, 9.2.4: the sampled direction
//! is weighed by the sum of the layers), so each part goes on as two. Parts of equal state are one again: there are never
//! more of them than states, and nothing has to be cut off. Parts that no expression can accept any more are dropped.

use super::alphabet::Scatter;
use super::automaton::{DEAD, Table};
use crate::render::LightSource;
use crate::render::bsdf::{Kind, Lobes, Scattered};
use crate::render::world::{Pane, World};
use glam::Vec3;

pub struct Trail<'a> {
    table: &'a Table,
    parts: Vec<(u16, Vec3)>,
    /// The parts before the last step, and those of a connection.
    before: Vec<(u16, Vec3)>,
    spare: Vec<(u16, Vec3)>,
    /// Those between a vertex and the light chosen for it.
    pub panes: Vec<Pane>,
}

impl<'a> Trail<'a> {
    pub fn new(table: &'a Table) -> Self {
        Self { table, parts: Vec::new(), before: Vec::new(), spare: Vec::new(), panes: Vec::new() }
    }

    /// A new path leaves the camera.
    pub fn start(&mut self) {
        self.parts.clear();
        add(&mut self.parts, self.table.start(), Vec3::ONE);
    }

    pub fn survive(&mut self, chance: f32) {
        self.parts.iter_mut().for_each(|part| part.1 /= chance);
    }

    pub fn scatter(&mut self, mesh: u32, scattered: &Scattered) {
        std::mem::swap(&mut self.parts, &mut self.before);
        self.parts.clear();
        for &(state, throughput) in &self.before {
            let mut go = |scatter, weight: Vec3| {
                if weight != Vec3::ZERO {
                    add(&mut self.parts, self.table.scatter(state, mesh, scatter), throughput * weight);
                }
            };
            match scattered.kind {
                Kind::Spread(density) => {
                    go(Scatter::Diffuse, scattered.lobes.diffuse / density);
                    go(Scatter::Glossy, scattered.lobes.glossy / density);
                }
                Kind::Mirrored => go(Scatter::Mirror, scattered.weight),
                Kind::Through => go(Scatter::Pane, scattered.weight),
            }
        }
    }

    /// The path ends at a light that scattering found; `value` is what a throughput of 1 contributes.
    pub fn arrive(&self, source: LightSource, value: Vec3, sums: &mut [Vec3]) {
        for &(state, throughput) in &self.parts {
            record(self.table.light(state, source), throughput * value, sums);
        }
    }

    /// The path ends at a light chosen for a vertex, past the panes listed; `value` is what lobes of 1 contribute.
    pub fn connect(
        &mut self,
        world: &World,
        mesh: u32,
        lobes: Lobes,
        value: Vec3,
        source: LightSource,
        sums: &mut [Vec3],
    ) {
        let Self { table, parts, before: ends, spare, panes } = self;
        ends.clear();
        for &(state, throughput) in parts.iter() {
            for (scatter, lobe) in [(Scatter::Diffuse, lobes.diffuse), (Scatter::Glossy, lobes.glossy)] {
                if lobe != Vec3::ZERO {
                    add(ends, table.scatter(state, mesh, scatter), throughput * lobe);
                }
            }
        }
        // In the order in which light from the vertex would meet them.
        panes.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        for pane in panes.iter() {
            let (mesh, _) = world.locate(pane.triangle);
            std::mem::swap(ends, spare);
            ends.clear();
            for &(state, throughput) in spare.iter() {
                if pane.beside > 0.0 {
                    add(ends, state, throughput * pane.beside);
                }
                if pane.through != Vec3::ZERO {
                    add(ends, table.scatter(state, mesh, Scatter::Pane), throughput * pane.through);
                }
            }
        }
        for &(state, throughput) in ends.iter() {
            record(table.light(state, source), throughput * value, sums);
        }
    }
}

/// Adds a part, to one of equal state if there is one.
fn add(parts: &mut Vec<(u16, Vec3)>, state: u16, throughput: Vec3) {
    if state == DEAD {
        return;
    }
    match parts.iter_mut().find(|part| part.0 == state) {
        Some(part) => part.1 += throughput,
        None => parts.push((state, throughput)),
    }
}

fn record(expressions: &[u16], value: Vec3, sums: &mut [Vec3]) {
    for &expression in expressions {
        sums[usize::from(expression)] += value;
    }
}
