//! An acceleration structure for part of the scene: the triangles whose bounding boxes meet a given box. For rays that
//! stay within that box, this structure gives the same hits as the structure of the whole scene, in fewer steps.

use super::node::Node;
use super::packet::Packet;
use super::traverse::Accel;
use crate::error::Result;
use crate::image::try_collect;
use crate::job::Job;
use glam::Vec3;

impl Accel {
    /// Builds the structure of the triangles whose bounding boxes meet the box from `low` to `high`. Its hits have the
    /// triangle indices of the whole structure. Returns `None` if no triangle meets the box, or more than `max` do.
    pub fn part(&self, [low, high]: [Vec3; 2], max: usize, job: Job) -> Result<Option<Self>> {
        let Some(found) = self.triangles_in([low, high], max) else { return Ok(None) };
        let ids = try_collect(found.iter().map(|&(id, _)| id))?;
        let mut part = Self::build(&try_collect(found.into_iter().map(|(_, corners)| corners))?, job)?;
        part.renumber(&ids);
        Ok(Some(part))
    }

    /// Returns the indices and corners of the triangles whose bounding boxes meet a box, by ascending index. Returns
    /// `None` if no triangle meets the box, or more than `max` do.
    fn triangles_in(&self, [low, high]: [Vec3; 2], max: usize) -> Option<Vec<(u32, [Vec3; 3])>> {
        let meets = |from: Vec3, to: Vec3| from.cmple(high).all() && to.cmpge(low).all();
        let mut found = Vec::new();
        let mut open = vec![self.root];
        while let Some(child) = open.pop().filter(|_| found.len() <= max) {
            if child.is_empty() {
                continue;
            }
            if child.is_packet() {
                let packet = self.lines.checked::<Packet>(child.line());
                let within = |corners: &[Vec3; 3]| {
                    let [a, b, c] = *corners;
                    meets(a.min(b).min(c), a.max(b).max(c))
                };
                found.extend(packet.triangles().filter(|(_, corners)| within(corners)));
            } else {
                let node = self.lines.checked::<Node>(child.line());
                open.extend((0..8).filter(|&lane| node.is_met(lane, meets)).map(|lane| node.child(lane)));
            }
        }
        found.sort_unstable_by_key(|&(id, _)| id);
        (!found.is_empty() && found.len() <= max).then_some(found)
    }

    /// Renumbers the triangles: the index `i` of a triangle becomes `ids[i]`.
    fn renumber(&mut self, ids: &[u32]) {
        let mut open = vec![self.root];
        while let Some(child) = open.pop() {
            if child.is_packet() && !child.is_empty() {
                self.lines.get_mut::<Packet>(child.line()).renumber(ids);
            } else if !child.is_empty() {
                let node = self.lines.checked::<Node>(child.line());
                open.extend((0..8).map(|lane| node.child(lane)));
            }
        }
    }
}
