//! Scores a texture against the design that it continues, by several statistics.
//!
//! All statistics are means weighted by a Hann window, which falls to zero at the border, so lamps that the border
//! cuts do not count, whatever the method. No estimate of the period by a method enters the score.

use crate::{Design, photos};
use glam::DVec2;
use luxfer::emission::pairs::{self, Points};
use luxfer::emission::{Emission, Luminaire, statistics};
use luxfer::image::colour::luminance;
use std::f64::consts::PI;

/// Names of the statistics. The first five are relative differences: number of lamps per area, mean area of lamps,
/// light per area, sorted areas of lamps, and mean distance to the nearest lamp. The sixth is the share of pairs of
/// lamps whose distance does not occur in the design. The seventh is the root mean square distance of lamps from the
/// lattice, in periods.
pub const STATISTICS: [&str; 7] = ["lamps %", "area %", "light %", "sizes %", "nearest %", "pairs %", "phase %"];

/// Score of a texture against the design that it continues; 0 is perfect.
#[derive(Clone, Copy, Default)]
pub struct Score {
    /// One value for each of [`STATISTICS`].
    pub off: [f64; STATISTICS.len()],
    /// Number of lamps smaller than 70 % of the smallest lamp of the design, or larger than 130 % of its largest lamp.
    pub broken: usize,
}

impl Score {
    /// Scores a texture. Its exemplar shows lamps at the share `filled` of the lattice sites, with luminance
    /// `luminance_of_lamps`.
    pub fn of(result: &Emission, design: &Design, filled: f64, luminance_of_lamps: f64) -> Self {
        let size = DVec2::new(result.mask.width as f64, result.mask.height as f64);
        let lamps = photos::whole(result);
        let centres: Vec<DVec2> = lamps.iter().map(|l| l.centre).collect();
        let cell = design.periods[0].perp_dot(design.periods[1]).abs() / filled;
        let [least, largest] = [design.areas[1], design.areas[2]];

        // Sum the Hann weights over the plane, over all lamps, and over whole lamps.
        let plane = size.element_product() / 4.0;
        let seen: f64 = result.luminaires.iter().map(|l| hann(l.centre, size)).sum();
        let all: f64 = lamps.iter().map(|l| hann(l.centre, size)).sum();
        let area = lamps.iter().map(|l| hann(l.centre, size) * l.area).sum::<f64>() / all;
        let light = light(result, size) / luminance_of_lamps / plane * cell / design.areas[0];

        // Compare the mean distance to the nearest lamp with that in a part of the design of equal size.
        let truth = design.places(size);
        let nearest = |points: &[DVec2]| {
            let weights: f64 = points.iter().map(|p| hann(*p, size)).sum();
            let distances = statistics::nearest_distances(points);
            points.iter().zip(distances).map(|(p, d)| hann(*p, size) * d).sum::<f64>() / weights
        };
        let relative = |value: f64| if value.is_finite() { (value - 1.0).abs() } else { 1.0 };
        let is_broken = |l: &&&Luminaire| l.area < 0.7 * least || l.area > 1.3 * largest;
        Self {
            off: [
                relative(seen / plane * cell),
                relative(area / design.areas[0]),
                relative(light),
                sizes(&lamps, design, size),
                relative(nearest(&centres) / nearest(&truth)),
                pair_distance(&centres, size, design),
                statistics::phase(&centres, design.periods),
            ],
            broken: lamps.iter().filter(is_broken).count(),
        }
    }

    /// The largest difference among the statistics; the phase is left out, because it has its own target.
    pub fn worst(&self) -> f64 {
        self.off[..6].iter().copied().fold(0.0, f64::max)
    }

    pub fn pairs(&self) -> f64 {
        self.off[5]
    }

    pub fn phase(&self) -> f64 {
        self.off[6]
    }

    /// Returns the larger value of each statistic of two scores, and the sum of their broken lamps.
    pub fn worse(self, other: Self) -> Self {
        Self { off: std::array::from_fn(|k| self.off[k].max(other.off[k])), broken: self.broken + other.broken }
    }

    /// Number of statistics, including broken lamps, in which `other` is nearer to the design by more than rounding.
    pub fn behind(&self, other: &Self) -> usize {
        const ROUNDING: f64 = 1e-3;
        let nearer = self.off.iter().zip(&other.off).filter(|(own, other)| **own > **other + ROUNDING).count();
        nearer + usize::from(self.broken > other.broken)
    }

    /// Cells of a table row: the values of [`STATISTICS`], and the number of broken lamps.
    pub fn columns(&self) -> impl Iterator<Item = String> {
        let broken = self.broken.to_string();
        self.off.iter().map(|off| format!("{:.2}", 100.0 * off)).chain([broken])
    }
}

/// Hann weight of a position: 1 in the middle of the texture, 0 at its border, a quarter on average.
fn hann(at: DVec2, size: DVec2) -> f64 {
    let along = |at: f64, side: f64| (PI * at / side).sin().powi(2);
    along(at.x, size.x) * along(at.y, size.y)
}

/// Sum of the luminance of all texels, weighted by the Hann window.
fn light(result: &Emission, size: DVec2) -> f64 {
    let texels = result.texture.data.chunks_exact(3).enumerate();
    let width = result.texture.width;
    texels
        .filter(|(_, texel)| **texel != [0.0; 3])
        .map(|(i, texel)| {
            let at = DVec2::new((i % width) as f64, (i / width) as f64) + 0.5;
            hann(at, size) * f64::from(luminance(glam::Vec3::from_slice(texel)))
        })
        .sum()
}

/// Mean difference between the sorted areas of the lamps and the sorted areas in the design, relative to the mean area
/// (Wasserstein distance).
fn sizes(lamps: &[&Luminaire], design: &Design, size: DVec2) -> f64 {
    let [mean, least, largest] = design.areas;
    let small = if largest > least { (largest - mean) / (largest - least) } else { 0.0 };
    let mut sorted: Vec<(f64, f64)> = lamps.iter().map(|l| (l.area, hann(l.centre, size))).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = sorted.iter().map(|l| l.1).sum();
    let (mut below, mut off) = (0.0, 0.0);
    for (area, weight) in sorted {
        // Split the lamp's share: the part that falls on the smaller kind of lamp in the design, and the rest.
        let share = weight / all;
        let of_small = (small - below).clamp(0.0, share);
        off += of_small * (area - least).abs() + (share - of_small) * (area - largest).abs();
        below += share;
    }
    if all > 0.0 { off / mean } else { 1.0 }
}

/// Share of pairs of lamps whose distance does not occur in the design. Only lamps away from the border count, where
/// all lamps are whole.
fn pair_distance(centres: &[DVec2], size: DVec2, design: &Design) -> f64 {
    let margin = design.areas[2].sqrt();
    let inner = size - 2.0 * margin;
    let is_inside = |p: &DVec2| p.cmpge(DVec2::ZERO).all() && p.cmplt(inner).all();
    let made: Vec<DVec2> = centres.iter().map(|c| *c - margin).filter(is_inside).collect();
    let truth = design.places(inner);
    pairs::distance(&Points { at: &truth, size: inner }, &Points { at: &made, size: inner }).unwrap_or(1.0)
}
