//! Finds further lamps on the lattice of the lamps found so far: where it predicts one, a region needs less contrast.

use super::similar::{LampLimits, Limits, Search, Similar};
use super::tree::Disjoint;
use crate::error::Result;
use crate::geometry::lattice::{SeenLattice, Spot};
use crate::geometry::robust::median;
use crate::job::Job;
use glam::DVec2;
use std::ops::RangeInclusive;

/// Limits for a region on a free site of the lattice. [bench photos:tune]
const ON_LATTICE: Limits =
    Limits { contrast: 0.5, negatives: 0.005, pixels: 12.0, area: 0.5, dimmer: 4.0, any_size: false };
/// Range of the area of a region divided by the median area of the lamps on the lattice, both relative to the cell of
/// the lattice at their place. Bloom enlarges distant lamps. [bench photos:tune]
const EQUAL_AREA: RangeInclusive<f64> = 0.6..=2.0;
/// Maximum number of times that the sites beside the lattice are searched; each time, the lattice may grow by one step.
/// [convention]
const ROUNDS: usize = 16;

impl Search<'_> {
    /// Adds the regions of the plane, and of the face of the room that holds the lamps, that lie on free sites beside
    /// the lattice of the lamps and are as large as the lamps.
    pub fn add_on_lattice(
        &self,
        model: &LampLimits,
        painted: &[u32],
        taken: &[bool],
        chosen: &mut Disjoint,
        similar: &mut Similar,
        job: Job,
    ) -> Result<()> {
        let mut candidates = self.candidates(model, painted, chosen, ON_LATTICE)?;
        candidates.retain(|&(node, likeness)| likeness >= 1.0 && !self.is_cut(node) && !self.is_soft(model, node));
        candidates.extend(similar.doubtful.iter().map(|&node| (node, 1.0)));
        for _ in 0..ROUNDS {
            job.check()?;
            let lamps = painted.iter().chain(&similar.found).chain(&similar.beyond);
            let Some(sites) = Sites::of(self, lamps.copied().collect()) else { break };
            let mut filled: Vec<DVec2> = Vec::new();
            for &(node, _) in &candidates {
                let is_free = similar.doubtful.contains(&node) || chosen.admits(node);
                let Some(site) = sites.site_of(self, node).filter(|site| is_free && !filled.contains(site)) else {
                    continue;
                };
                if !self.stands_out(model, node, ON_LATTICE, taken)? {
                    continue;
                }
                similar.doubtful.retain(|other| *other != node);
                similar.found.push(node);
                chosen.choose(node);
                filled.push(site);
            }
            if filled.is_empty() {
                break;
            }
        }
        Ok(())
    }
}

/// The lattice of the lamps, and the size of a lamp on it.
struct Sites {
    lattice: SeenLattice,
    /// Median area of the lamps on the lattice, relative to the cell of the lattice at their place.
    area: f64,
}

impl Sites {
    /// The lattice of the lamps that the photo's border does not cut; `None` if they lie on no lattice.
    fn of(search: &Search, mut lamps: Vec<u32>) -> Option<Self> {
        lamps.retain(|&lamp| !search.is_cut(lamp));
        lamps.sort_by(|a, b| search.regions.area[*b as usize].total_cmp(&search.regions.area[*a as usize]));
        let spots: Vec<Spot> = lamps.iter().map(|&lamp| search.regions.spot(lamp as usize)).collect();
        let lattice = SeenLattice::find(&spots)?;
        let on_sites = lattice.steps.iter().zip(&lamps).filter_map(|(steps, lamp)| Some(((*steps)?, *lamp as usize)));
        let areas = on_sites.map(|(steps, lamp)| search.regions.area[lamp] / lattice.cell_area(steps)).collect();
        let area = median(areas);
        Some(Self { lattice, area })
    }

    /// Returns the free site on which a node lies; `None` if it lies on no site, or is not as large as a lamp there.
    fn site_of(&self, search: &Search, node: u32) -> Option<DVec2> {
        let site = self.lattice.free_site(search.regions.spot(node as usize).centre)?;
        let area = search.regions.area[node as usize] / self.lattice.cell_area(site);
        EQUAL_AREA.contains(&(area / self.area)).then_some(site)
    }
}
