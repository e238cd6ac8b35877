//! Blends several exemplars in one texture: the mixture of styles that the paper leaves to future work (§8).
//!
//! A lamp halfway between two designs would belong to neither, so each lamp is taken from one exemplar, chosen at
//! random:
//!
//! 1. The pattern of each exemplar is planned over the whole texture.
//! 2. Each lamp gets a random number in [0, 1). Lamps of different exemplars that would overlap share one number.
//! 3. The weights at the lamp's centre divide [0, 1) into one interval per exemplar. The lamp is kept if its number
//!    lies in the interval of its own exemplar. The intervals are disjoint, so of two overlapping lamps at most one is
//!    kept if the weights are equal at both centres. The mean light per area follows the weights.
//!
//! If many lamps overlap several lamps of earlier exemplars, all lamps in a square of the texture share one number, and
//! the style changes from square to square. If two kept lamps overlap nevertheless, only the lamp of the exemplar that
//! comes first in the list stays. Lights that run through their exemplar are not chosen at random: the weight dims them
//! instead.
//!
//! Lattices of different exemplars keep their own period and phase. With [`crate::emission::Centring::Always`], a lamp
//! of each lattice, or the middle between two lamps, lies at the texture's centre.

use super::layer::Layer;
use super::weights::Weights;
use crate::emission::lamps::instance::{self, Instance};
use crate::emission::params::Params;
use crate::rng::Rng;
use glam::DVec2;
use std::collections::HashMap;

/// Where lamps are dense, all lamps in one square of the texture share a random number. This is the square's side, as a
/// multiple of the longest lamp's length. [bench constants:lamps]
const SHARED_SQUARE: f64 = 3.0;
/// Consider the lamps of the second and all further exemplars. Lamps are dense if more than this share of them overlap
/// two or more lamps of earlier exemplars. [bench constants:lamps]
const MIN_DENSE_SHARE: f64 = 0.1;

/// A lamp of an exemplar: its bounding box in texels, and its random number.
struct Lamp {
    low: DVec2,
    high: DVec2,
    /// A random number in [0, 1). The weights divide this interval into one subinterval per exemplar. The lamp is kept
    /// if its number lies in the subinterval of its own exemplar.
    draw: f64,
}

impl Lamp {
    fn centre(&self) -> DVec2 {
        (self.low + self.high) / 2.0
    }

    /// Area, in texels, of the intersection of this lamp's box with the box of `other` after the latter is moved by
    /// `shift`.
    fn overlap(&self, other: &Self, shift: DVec2) -> f64 {
        let sides = self.high.min(other.high + shift) - self.low.max(other.low + shift);
        sides.max(DVec2::ZERO).element_product()
    }
}

/// Keeps a random selection of the lamps of each layer, with probabilities equal to the layer's weights, and removes
/// the other lamps. A single layer keeps all its lamps.
pub fn draw(layers: &mut [Layer], weights: &Weights, params: &Params) {
    if layers.len() < 2 {
        return;
    }
    let mut lamps: Vec<Vec<Lamp>> =
        layers.iter().map(|layer| layer.instances.iter().map(|i| boxed(layer, i)).collect()).collect();
    let longest = lamps.iter().flatten().map(|l| (l.high - l.low).max_element()).fold(1.0, f64::max);

    // For each lamp, find the lamps of earlier layers that it overlaps, sorted by overlap, largest first. `below[k][i]`
    // lists them for lamp i of layer k, as pairs of layer and lamp.
    let mut seen = LampGrid { cells: HashMap::new(), side: longest, size: params.repeats() };
    let mut below: Vec<Vec<Vec<(usize, usize)>>> = Vec::new();
    for (k, layer) in lamps.iter().enumerate() {
        below.push(layer.iter().map(|lamp| seen.overlapping(lamp, &lamps)).collect());
        layer.iter().enumerate().for_each(|(i, lamp)| seen.add(k, i, lamp));
    }
    let several = below.iter().flatten().filter(|b| b.len() > 1).count();
    let is_dense = several as f64 > MIN_DENSE_SHARE * below[1..].iter().map(Vec::len).sum::<usize>() as f64;

    // Give each lamp its random number. A lamp that overlaps lamps of earlier layers takes the number of the lamp that
    // it overlaps most. Any other lamp gets a number of its own or, where lamps are dense, the number of the square
    // that contains its centre.
    for k in 0..layers.len() {
        for (i, others) in below[k].iter().enumerate() {
            let patch = (lamps[k][i].centre() / (SHARED_SQUARE * longest)).floor();
            lamps[k][i].draw = match others.first() {
                Some(&(j, other)) => lamps[j][other].draw,
                None if is_dense => {
                    Rng::new(params.seed, &[0x7061, patch.x as i64 as u64, patch.y as i64 as u64]).next_f64()
                }
                None => Rng::new(params.seed, &[0x6c61, k as u64, i as u64]).next_f64(),
            };
        }
    }

    // Decide which lamps to keep. If a chosen lamp overlaps a kept lamp of an earlier layer, drop it.
    let size = DVec2::new(params.width as f64, params.height as f64);
    let mut stays: Vec<Vec<bool>> = Vec::new();
    for (k, layer) in lamps.iter().enumerate() {
        let is_drawn = |lamp: &Lamp| {
            let at = lamp.centre() / size;
            let start: f64 = (0..k).map(|j| f64::from(weights.at(j, at))).sum();
            // The last interval must end at exactly 1, despite rounding of the sum.
            let end = if k + 1 == lamps.len() { 1.0 } else { start + f64::from(weights.at(k, at)) };
            weights.at(k, at) > 0.0 && (start..end).contains(&lamp.draw)
        };
        let kept = layer
            .iter()
            .zip(&below[k])
            .map(|(lamp, others)| is_drawn(lamp) && !others.iter().any(|&(j, i)| stays[j][i]));
        stays.push(kept.collect());
    }
    for (layer, stays) in layers.iter_mut().zip(&stays) {
        let mut stays = stays.iter();
        layer.instances.retain(|_| stays.next() == Some(&true));
    }
}

/// The bounding box of a lamp in texels.
fn boxed(layer: &Layer, instance: &Instance) -> Lamp {
    let (low, high) = layer.exemplar.components.list[instance.component].bounds();
    let to_texels = |corner: DVec2| (corner + instance.shift) / layer.scale;
    Lamp { low: to_texels(low), high: to_texels(high), draw: 0.0 }
}

/// A hash grid that finds lamps by the square that holds their centre. The squares are as long as the longest lamp, so
/// that overlapping lamps lie in the same square or in adjacent ones.
///
/// A square holds triples of layer, lamp and shift. The shift moves the lamp into one of the neighbouring copies of a
/// tileable texture; otherwise it is 0.
struct LampGrid {
    cells: HashMap<[i64; 2], Vec<(usize, usize, DVec2)>>,
    side: f64,
    /// Size of the texture in texels, if it is tileable.
    size: Option<DVec2>,
}

impl LampGrid {
    fn cell(&self, at: DVec2) -> [i64; 2] {
        (at / self.side).floor().to_array().map(|c| c as i64)
    }

    fn add(&mut self, layer: usize, index: usize, lamp: &Lamp) {
        let offsets =
            self.size.map_or(vec![DVec2::ZERO], |size| instance::neighbour_offsets().map(|t| t * size).collect());
        for shift in offsets {
            let cell = self.cell(lamp.centre() + shift);
            self.cells.entry(cell).or_default().push((layer, index, shift));
        }
    }

    fn overlapping(&self, lamp: &Lamp, lamps: &[Vec<Lamp>]) -> Vec<(usize, usize)> {
        let [x, y] = self.cell(lamp.centre());
        let cells = (y - 1..=y + 1).flat_map(|v| (x - 1..=x + 1).map(move |u| [u, v]));
        let mut found: Vec<(f64, usize, usize)> = cells
            .filter_map(|c| self.cells.get(&c))
            .flatten()
            .map(|&(k, i, shift)| (lamp.overlap(&lamps[k][i], shift), k, i))
            .filter(|f| f.0 > 0.0)
            .collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        found.into_iter().map(|(_, k, i)| (k, i)).collect()
    }
}
