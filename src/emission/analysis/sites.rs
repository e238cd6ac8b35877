//! The sites of a lattice: the positions within a cell at which lamps lie, and how well the lattice predicts the
//! lamps.
//!
//! A lattice or row is scored by how well it predicts the lamps. A lamp is predicted if whole steps of the lattice
//! lead to it from another lamp of similar size. A false prediction is a position in full view to which the lattice
//! leads, but which has no lamp. Predictions are weighted by the photo pixels of the lamp, so that the blurred distant
//! part of a photo has little weight. A lattice that predicts no lamp from another scores 0.

use super::evidence::Evidence;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::foreshortening::LocalMap;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::emission::lattice::basis::MAX_UNCHANGING_LENGTH;
use crate::emission::lattice::cells;
use crate::emission::lattice::law::Law;
use glam::{DMat2, DVec2};

/// Two lamps belong to one site if the vector between them differs from a lattice vector, along x and along y, by at
/// most this share of the shorter period plus the blur of both lamps. [judged on 20 photos]
const MAX_OFF_SITE: f64 = 0.12;
/// A position at which the light mask has no lamp counts as shining if it is bright in the photo. Its contrast with its
/// surroundings must be at least the share `MIN_SHINING` of the highest contrast among the site's lamps. Only the first
/// `MAX_COMPARED` lamps of the site are measured. [judged on 20 photos]
const MIN_SHINING: f64 = 0.2;
const MAX_COMPARED: usize = 5;
/// Maximum number of predicted positions of a site that are tested. [bench emission:seconds]
const MAX_SITES: usize = 20_000;

/// A site: a position in the lattice cell at which lamps lie.
#[derive(Clone, Debug)]
pub struct Site {
    /// Position of the site in unwarped pixels: the mean position of its lamps, weighted by their photo pixels, after
    /// each lamp is moved by whole periods next to the first one.
    pub at: DVec2,
    /// The lamps at this site, sorted by their number of photo pixels, largest first.
    pub lamps: Vec<MeasuredLamp>,
    /// Total area of the lamps in photo pixels.
    pub shown: f64,
    /// Area, in photo pixels, of lamps that the lattice predicts in full view but that the light mask lacks.
    /// `unmarked`: at positions that shine in the photo. `missing`: at positions that do not.
    pub unmarked: f64,
    pub missing: f64,
    /// `holes`: the part of `missing` that lies between lamps of the site, in photo pixels. `hole_count`: the number of
    /// positions between lamps of the site at which a predicted lamp is missing. If the site has one lamp, the lamps of
    /// all sites count instead.
    pub holes: f64,
    pub hole_count: usize,
    /// First and last cell, along both periods, in which the pattern continues. Cell (0, 0) holds `at`. If predicted
    /// lamps are missing beyond the outermost lamp on one side, for example because of a wall, the pattern ends with
    /// the outermost lamp on this side. If no predicted lamp is missing, the pattern has no known end on this side, and
    /// the coordinate is infinite.
    pub cells: [DVec2; 2],
}

impl Site {
    /// (shown + unmarked) / (shown + unmarked + holes): of the visible positions between the first and the last lamp of
    /// the site, the share with a lamp or with light that the light mask lacks. Positions are weighted by photo pixels.
    pub fn occupancy(&self) -> f64 {
        let seen = self.shown + self.unmarked;
        seen / (seen + self.holes).max(f64::MIN_POSITIVE)
    }

    /// Whether the pattern of the site ends on any side.
    pub fn ends(&self) -> bool {
        self.cells != [DVec2::NEG_INFINITY, DVec2::INFINITY]
    }
}

/// The sites of a lattice or a row. The pattern expects a lamp at the position of each site in every cell.
pub struct Sites {
    pub list: Vec<Site>,
    /// Maps unwarped pixels to lattice cells. A row uses only the first coordinate, along its period.
    pub to_cells: DMat2,
    pub basis: [DVec2; 2],
    /// Length of the shorter period, or of the only period of a row, in unwarped pixels.
    shortest: f64,
    /// Whether the lamps repeat along the first vector of the basis only.
    is_row: bool,
}

impl Sites {
    /// Groups the lamps into sites of a lattice or a row. `None` if the law has no period, or if the pattern does not
    /// change along one of the law's vectors, so that this vector is no true period.
    pub fn new(exemplar: &Exemplar, lamps: &[MeasuredLamp], law: Law) -> Option<Self> {
        let (basis, is_row) = match law {
            Law::Lattice(basis) => (basis, false),
            // On a luminous ceiling, the second vector is a period too (`extent::of_panes`).
            Law::Row(basis) => (basis, !exemplar.is_luminous_ceiling()),
            _ => return None,
        };
        let to_cells = DMat2::from_cols(basis[0], basis[1]).inverse();
        let shortest = if is_row { basis[0].length() } else { basis[0].length().min(basis[1].length()) };
        if !to_cells.is_finite() || shortest <= MAX_UNCHANGING_LENGTH {
            return None;
        }
        let mut sites = Self { list: Vec::new(), to_cells, basis, shortest, is_row };
        for lamp in lamps {
            let is_here = |site: &Site| {
                let first = &site.lamps[0];
                let slack = MAX_OFF_SITE * shortest + (lamp.blur + first.blur);
                let off = sites.residual(lamp.centre - first.centre);
                lamp.may_be_like(first) && off.abs().cmple(slack).all()
            };
            match sites.list.iter().position(is_here) {
                Some(k) => sites.list[k].lamps.push(*lamp),
                None => {
                    sites.list.push(Site {
                        at: lamp.centre,
                        lamps: vec![*lamp],
                        shown: 0.0,
                        unmarked: 0.0,
                        missing: 0.0,
                        holes: 0.0,
                        hole_count: 0,
                        cells: [DVec2::NEG_INFINITY, DVec2::INFINITY],
                    });
                }
            }
        }
        for k in 0..sites.list.len() {
            sites.weigh(k, lamps, exemplar);
        }
        Some(sites)
    }

    /// The difference between a step from lamp to lamp and the nearest lattice vector.
    pub fn residual(&self, step: DVec2) -> DVec2 {
        step - self.whole_steps(step)
    }

    /// The lattice vector nearest to a step.
    pub fn whole_steps(&self, step: DVec2) -> DVec2 {
        let cells = (self.to_cells * step).round();
        self.basis[0] * cells.x + if self.is_row { DVec2::ZERO } else { self.basis[1] * cells.y }
    }

    /// Moves site `k` to the mean position of its lamps, weighted by their photo pixels. Then finds the positions where
    /// the lattice predicts a lamp of this site in full view but the light mask shows none.
    fn weigh(&mut self, k: usize, all: &[MeasuredLamp], exemplar: &Exemplar) {
        let lamps = &self.list[k].lamps;
        let first = lamps[0];
        let shown: f64 = lamps.iter().map(|l| l.weight).sum();
        let off: DVec2 = lamps.iter().map(|l| self.residual(l.centre - first.centre) * l.weight).sum();
        let at = first.centre + off / shown.max(f64::MIN_POSITIVE);
        let site = Site { at, shown, ..self.list[k].clone() };
        self.list[k] = self.with_empty_positions(site, all, exemplar);
    }

    /// The cell of a position, counted from the cell of the site at `at`. For a row, the second coordinate is 0.
    fn cell(&self, at: DVec2, position: DVec2) -> DVec2 {
        let cell = (self.to_cells * (position - at)).round();
        if self.is_row { DVec2::new(cell.x, 0.0) } else { cell }
    }

    /// Whether the pattern of a site reaches a position, that is, has not ended before it.
    pub fn continues(&self, site: &Site, position: DVec2) -> bool {
        let cell = self.cell(site.at, position);
        cell.cmpge(site.cells[0]).all() && cell.cmple(site.cells[1]).all()
    }

    /// Finds the positions in full view where the lattice predicts a lamp of this site but the light mask shows none.
    /// Sets the site's `unmarked`, `missing`, `holes`, `hole_count` and `cells` from them. `all` holds the lamps of all
    /// sites.
    fn with_empty_positions(&self, mut site: Site, all: &[MeasuredLamp], exemplar: &Exemplar) -> Site {
        let empty = self.empty_positions(&site, all, exemplar);
        let Site { at, ref lamps, .. } = site;
        let half = lamps[0].size / 2.0;
        let contrast = |p: DVec2| exemplar.working.contrast(p, half);
        let of_lamps = lamps.iter().take(MAX_COMPARED).filter_map(|l| contrast(l.centre));
        let brightest = of_lamps.fold(0.0, f64::max);
        let shines = |p: &DVec2| {
            exemplar.label_at(*p) == 0 && brightest > 0.0 && contrast(*p).is_some_and(|c| c >= MIN_SHINING * brightest)
        };
        let (shining, dark): (Vec<DVec2>, Vec<DVec2>) = empty.into_iter().partition(shines);

        // A dark position is a hole if it lies between the first and the last lamp along both periods. A single lamp
        // shows no repetition, so its dark positions among the lamps of all sites are holes too. A dark position
        // before the first or after the last lamp along a period ends the pattern on that side.
        let bounds = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (first, last) = all.iter().fold(bounds, |(a, b), l| (a.min(l.centre), b.max(l.centre)));
        let is_among_lamps = |p: DVec2| lamps.len() == 1 && p.cmpge(first).all() && p.cmple(last).all();
        let lit = lamps.iter().map(|l| l.centre).chain(shining.iter().copied()).map(|p| self.cell(at, p));
        let (low, high) = lit.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)));
        let mut cells = [DVec2::NEG_INFINITY, DVec2::INFINITY];
        let pixels = |p: DVec2| 4.0 * half.element_product() * LocalMap::new(exemplar.to_photo, p).area();
        let (mut missing, mut holes, mut hole_count) = (0.0, 0.0, 0);
        for p in dark {
            let (cell, pixels) = (self.cell(at, p), pixels(p));
            let (before, after) = (cell.cmplt(low), cell.cmpgt(high));
            missing += pixels;
            if !(before | after).any() || is_among_lamps(p) {
                (holes, hole_count) = (holes + pixels, hole_count + 1);
            }
            cells = [DVec2::select(before, low, cells[0]), DVec2::select(after, high, cells[1])];
        }
        let unmarked = shining.into_iter().map(pixels).sum();
        (site.unmarked, site.missing, site.holes, site.hole_count, site.cells) =
            (unmarked, missing, holes, hole_count, cells);
        site
    }

    /// The positions in full view where the lattice predicts a lamp of `site` but the light mask shows none. A position
    /// also counts as empty if the lamp that covers it has the size of this site's lamps but belongs to another site.
    fn empty_positions(&self, site: &Site, all: &[MeasuredLamp], exemplar: &Exemplar) -> Vec<DVec2> {
        let Site { at, ref lamps, .. } = *site;
        let size = DVec2::new(exemplar.width as f64, exemplar.height as f64);
        let half = lamps[0].size / 2.0;
        let is_shown = |p: DVec2| {
            let inside = p.cmpge(DVec2::ZERO).all() && p.cmplt(size).all();
            inside && exemplar.shown[p.y as usize * exemplar.width + p.x as usize]
        };
        let corners = [DVec2::ZERO, half, -half, DVec2::new(half.x, -half.y), DVec2::new(-half.x, half.y)];
        // A lamp of similar size that is not at this site contradicts the lattice, even if it covers the position.
        let contradicts = |component: usize| {
            let is_displaced = |l: &MeasuredLamp| {
                l.component == component
                    && l.may_be_like(&lamps[0])
                    && !lamps.iter().any(|own| own.component == component)
            };
            all.iter().any(is_displaced)
        };
        let is_lit = |p: DVec2| match exemplar.label_at(p) {
            0 => false,
            label => !contradicts(label as usize - 1),
        };
        let is_taken = |p: DVec2| {
            is_lit(p)
                || lamps.iter().any(|l| {
                    let off = self.residual(l.centre - at);
                    (l.centre - off - p).abs().max_element() < 1.0 + MAX_OFF_SITE * half.max_element()
                })
        };
        let steps = cells::between(self.to_cells, DVec2::ZERO - at, size - at);
        let along = steps.filter(|[_, j]| !self.is_row || *j == 0).take(MAX_SITES);
        along
            .map(|[i, j]| at + self.basis[0] * i as f64 + self.basis[1] * j as f64)
            .filter(|&p| corners.iter().all(|c| is_shown(p + *c)) && !is_taken(p))
            .collect()
    }

    /// How well the lattice predicts the lamps: (P / A) (1 - s / n), in [0, 1].
    ///
    /// - P: photo pixels of the lamps that are predicted correctly.
    /// - A: photo pixels of all lamps, and of lamps that a site with at least two lamps predicts but that are missing.
    /// - s: number of sites; n: number of lamps. The first lamp of each site defines the site, so no other lamp
    ///   predicts it, and only n - s lamps can be predicted.
    ///
    /// A cut lamp of known size is predicted if whole steps of the lattice lead from a site to the lamp's centre. A cut
    /// lamp of unknown size is predicted if whole steps lead from a site to any position on the lamp's visible part. A
    /// cut lamp counts in n only if its size is known and it is predicted.
    pub fn score(&self, evidence: &Evidence) -> f64 {
        let (predicted, all) = self.list.iter().fold((0.0, 0.0), |(predicted, all), site| match site.lamps.len() > 1 {
            true => (predicted + site.shown, all + site.shown + site.missing),
            false => (predicted, all + site.shown),
        });
        let is_led_to = |lamp: &MeasuredLamp, leads: fn(&Self, &MeasuredLamp, &Site) -> bool| {
            self.list.iter().any(|site| leads(self, lamp, site))
        };
        let completed = evidence.completed.iter().map(|lamp| (lamp, is_led_to(lamp, Self::leads_to_centre)));
        let parts = evidence.parts.iter().map(|part| (part, is_led_to(part, Self::leads_to_part)));
        let cut = completed.clone().chain(parts);
        let (predicted, all) = cut.fold((predicted, all), |(predicted, all), (lamp, is_predicted)| {
            (predicted + if is_predicted { lamp.weight } else { 0.0 }, all + lamp.weight)
        });
        let whole: usize = self.list.iter().map(|s| s.lamps.len()).sum();
        let lamps = whole + completed.filter(|(_, is_predicted)| *is_predicted).count();
        if lamps == 0 || all <= 0.0 {
            return 0.0;
        }
        predicted / all * (1.0 - self.list.len() as f64 / lamps as f64)
    }

    /// Whether whole steps of the lattice lead from a site to the centre of a lamp.
    fn leads_to_centre(&self, lamp: &MeasuredLamp, site: &Site) -> bool {
        let slack = MAX_OFF_SITE * self.shortest + lamp.blur;
        self.residual(lamp.centre - site.at).abs().cmple(slack).all()
    }

    /// Whether whole steps of the lattice lead from a site to a position on the visible part of a lamp.
    fn leads_to_part(&self, part: &MeasuredLamp, site: &Site) -> bool {
        let slack = site.lamps[0].size / 2.0 + part.blur;
        self.residual(part.centre - site.at).abs().cmple(slack).all()
    }

    /// Whether steps between lamps of one site, whole or cut, show both periods of a lattice: two such steps are not
    /// parallel.
    pub fn show_both_periods(&self, evidence: &Evidence) -> bool {
        let mut direction: Option<DVec2> = None;
        for site in &self.list {
            let completed = evidence.completed.iter().filter(|lamp| self.leads_to_centre(lamp, site));
            let parts = evidence.parts.iter().filter(|part| self.leads_to_part(part, site));
            let steps = site.lamps[1..].iter().chain(completed).chain(parts).map(|lamp| {
                let step = self.to_cells * (lamp.centre - site.lamps[0].centre);
                step.round()
            });
            for step in steps.filter(|step| *step != DVec2::ZERO) {
                let first = *direction.get_or_insert(step);
                if first.perp_dot(step) != 0.0 {
                    return true;
                }
            }
        }
        false
    }
}
