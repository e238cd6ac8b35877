//! Finds lamps of kinds that no stroke touches, such as downlights between painted panels: bright regions on the plane
//! that equal each other and lie on a lattice, and single regions that stand out as much as the painted lamps do.

use super::similar::{LampLimits, Limits, Search, Similar};
use super::surroundings::{self, Bounds};
use super::tree::Disjoint;
use crate::error::Result;
use crate::geometry::lattice::{SeenLattice, Spot};
use crate::image::try_vec;
use crate::job::Job;

/// Limits for a lamp of a further kind: as bright, as sharp and as high in contrast as the painted lamps, but of any
/// size. Regions of fewer than 30 pixels have no clear shape. [convention]
const FURTHER: Limits = Limits { contrast: 1.0, negatives: 0.0, pixels: 30.0, area: 0.0, dimmer: 0.0, any_size: true };
/// Minimum share of the ring of pixels around a lamp of a further kind that lies on the plane. It is higher than for
/// regions like painted lamps, because panes of windows also equal each other and lie on a lattice. [bench photos:real]
const ON_PLANE: f64 = 0.9;
/// Limits for a lamp of a further kind that lies on no lattice. Things on the ceiling that are no lamps, such as
/// reflections and signs, are rarely as sharp and as high in contrast as the median painted lamp. Highlights on
/// fittings are, but they are small. [bench photos:real]
const ALONE: Limits = Limits { contrast: 1.5, negatives: 0.0, pixels: 150.0, area: 0.0, dimmer: 0.0, any_size: true };
/// Maximum aspect (length over width on the face of the room) of a lamp of a further kind that lies on no lattice.
/// Long bright strips are often gaps, edges and reflections. [convention]
const COMPACT: f64 = 2.0;

impl Search<'_> {
    /// Adds the regions of each kind that no stroke touches, if enough regions of the kind lie on a lattice
    /// ([`SeenLattice::find`]), or if they meet the limits [`ALONE`]. Only regions that stand apart from other lamps
    /// are added. Without a box layout of the room nothing is added, because sizes are compared on its face.
    pub fn add_further_kinds(
        &self,
        model: &LampLimits,
        painted: &[u32],
        taken: &[bool],
        chosen: &mut Disjoint,
        similar: &mut Similar,
        job: Job,
    ) -> Result<()> {
        let contrast = |node: u32| -> Result<f64> {
            let ring = surroundings::around(node, self.tree, self.photo, self.plane, taken)?;
            let ring = ring.filter(|ring| ring.on_plane >= ON_PLANE && self.is_on_face(node as usize));
            Ok(ring.map_or(0.0, |ring| self.ring_likeness(model, node as usize, &ring)))
        };
        // Choose the sharpest of nested regions. Which of them are lamps is decided below.
        let mut apart = chosen.try_clone()?;
        let mut rest: Vec<u32> = Vec::new();
        for (k, (node, likeness)) in self.candidates(model, painted, chosen, FURTHER)?.into_iter().enumerate() {
            if k % 256 == 0 {
                job.check()?;
            }
            if likeness < 1.0 || !apart.admits(node) || self.is_cut(node) || self.is_soft(model, node) {
                continue;
            }
            if contrast(node)? >= FURTHER.contrast {
                apart.choose(node);
                rest.push(node);
            }
        }
        // Mark the pixels of all lamps and of all regions that may be lamps by the number of their node.
        let mut owner = try_vec(self.tree.node_of.len(), 0u32)?;
        for &node in painted.iter().chain(&similar.found).chain(&rest) {
            self.tree.pixels(node).iter().for_each(|&p| owner[p as usize] = node);
        }
        // Group the regions by kind, and keep the kinds whose regions lie on a lattice.
        rest.sort_by(|a, b| self.regions.area[*b as usize].total_cmp(&self.regions.area[*a as usize]));
        while let Some(&first) = rest.first() {
            job.check()?;
            let (kind, others): (Vec<u32>, Vec<u32>) =
                rest.iter().partition(|&&node| node == first || self.are_of_equal_shape(first, node));
            let spots: Vec<Spot> = kind.iter().map(|&node| self.regions.spot(node as usize)).collect();
            let is_lattice = SeenLattice::find(&spots).is_some();
            for node in kind {
                let is_like_painted = || -> Result<bool> {
                    Ok(self.is_compact(node)
                        && self.likeness(model, node as usize, ALONE) >= 1.0
                        && contrast(node)? >= ALONE.contrast)
                };
                if self.stands_apart(&owner, node) && (is_lattice || is_like_painted()?) {
                    chosen.choose(node);
                    similar.doubtful.retain(|other| *other != node);
                    similar.found.push(node);
                }
            }
            rest = others;
        }
        Ok(())
    }

    /// Whether no other lamp lies within the square root of a node's area from its bounding box. Panes of a window lie
    /// closer together.
    fn stands_apart(&self, owner: &[u32], node: u32) -> bool {
        let margin = self.regions.area[node as usize].sqrt() as isize;
        let around = Bounds::of(self.tree.pixels(node), self.photo, margin);
        let [width, height] = around.size();
        (0..width * height).all(|k| [0, node].contains(&owner[around.pixel(k, self.photo.width)]))
    }

    fn is_compact(&self, node: u32) -> bool {
        self.regions.surface.as_ref().is_some_and(|surface| surface.aspect(node as usize) <= COMPACT)
    }

    fn are_of_equal_shape(&self, a: u32, b: u32) -> bool {
        self.lamps_of_equal_shape(std::iter::once(&a), b as usize).next().is_some()
    }
}
