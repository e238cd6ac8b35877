//! Statistics of a light pattern. They measure how well a texture agrees with its exemplar.
//!
//! The border of the image cuts the pattern at an arbitrary place. Plain means would therefore depend on the lamps that
//! happen to lie at the border, above all if there are few lamps. So every mean is weighted by position:
//!
//! - Along an axis with a known period, imagine a window that slides from one border of the image to the other. Its
//!   length is the largest whole number of periods that fits into the image. The weight of a position is the share of
//!   the window's placements that contain it. Each part of the period then has the same total weight, wherever the
//!   border cuts the pattern.
//! - Along other axes, the weights are a Hann window, which falls to 0 at the border (Harris 1978).

use crate::emission::exemplar::components::Components;
use crate::image::colour::luminance;
use crate::maths;
use glam::{DMat2, DVec2, Vec3};
use std::f64::consts::{PI, TAU};

/// Statistics of a light pattern. Lengths are in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Share of the pattern that is lit.
    pub lit: f64,
    /// Mean luminance of the lit part, in the units of the pattern's colours.
    pub luminance: f64,
    /// Mean area of a whole lamp; 0 if there is none.
    pub area: f64,
    /// Mean distance from a whole lamp to the nearest other whole lamp. Whole lamps to which a cut lamp lies nearer are
    /// left out, because the distance to the centre of a cut lamp is unknown. 0 if no lamp remains.
    pub spacing: f64,
    /// Number of whole lamps.
    pub whole: usize,
}

/// A pattern of lights: its pixels and its lamps.
pub struct Pattern<'a, C> {
    pub width: usize,
    pub height: usize,
    /// `components`: the connected lights of the pattern. `whole`: for each of them, whether it counts as a whole lamp.
    pub components: &'a Components,
    pub whole: &'a [bool],
    /// Period along x and along y, in pixels; `None` without a period, infinite if the whole pattern is one period.
    pub periods: [Option<f64>; 2],
    /// Function from a pixel index to linear RGB; `None` for a pixel that is left out, such as one that the photo does
    /// not show.
    pub colour: C,
}

impl Statistics {
    pub fn of<C: Fn(usize) -> Option<Vec3>>(pattern: &Pattern<C>) -> Self {
        let Pattern { width, height, components, whole, periods, colour } = pattern;
        let columns: Vec<f64> = (0..*width).map(|x| weight(x as f64 + 0.5, *width, periods[0])).collect();

        // Sum up light and area over the pixels. Weight them by position, so that the sums do not depend on the place
        // where the border cuts the pattern (see the beginning of this file).
        let (mut all, mut lit, mut light) = (0.0, 0.0, 0.0);
        for y in 0..*height {
            let row = weight(y as f64 + 0.5, *height, periods[1]);
            for (x, column) in columns.iter().enumerate() {
                let Some(colour) = colour(y * width + x) else { continue };
                all += row * column;
                if components.labels[y * width + x] != 0 {
                    lit += row * column;
                    light += row * column * f64::from(luminance(colour));
                }
            }
        }

        // Average over the whole lamps. Weight each lamp by the position of its centre, so that the mean does not
        // depend on the place where the border cuts the pattern.
        let lamps: Vec<(DVec2, f64)> =
            components.list.iter().zip(*whole).filter(|(_, w)| **w).map(|(c, _)| (c.centre, c.area as f64)).collect();
        let place = |at: DVec2| weight(at.x, *width, periods[0]) * weight(at.y, *height, periods[1]);
        let mean = |of: &dyn Fn(usize) -> bool, value: &dyn Fn(usize) -> f64| {
            let counted = || (0..lamps.len()).filter(|i| of(*i));
            let weights: f64 = counted().map(|i| place(lamps[i].0)).sum();
            ratio(counted().map(|i| place(lamps[i].0) * value(i)).sum(), weights)
        };
        // If a cut lamp is nearer than the nearest whole lamp, the distance to the nearest lamp is unknown: the centre
        // of the cut lamp's visible part is not the lamp's centre.
        let cut = components.list.iter().zip(*whole).filter(|(_, whole)| !**whole).map(|(c, _)| c.centre);
        let mut centres: Vec<DVec2> = lamps.iter().map(|l| l.0).collect();
        let nearest = nearest_distances(&centres);
        centres.extend(cut);
        let nearest_of_all = nearest_distances(&centres);
        let is_known = |i: usize| nearest[i].is_finite() && nearest_of_all[i] >= nearest[i];
        Self {
            lit: ratio(lit, all),
            luminance: ratio(light, lit),
            area: mean(&|_| true, &|i| lamps[i].1),
            spacing: mean(&is_known, &|i| nearest[i]),
            whole: lamps.len(),
        }
    }

    /// The statistics of a mixture of patterns. `parts` holds the statistics and the weight of each pattern. The
    /// spacing of several patterns is 0, because the distance between lamps of different patterns is unknown.
    pub fn mixed(parts: impl Iterator<Item = (Self, f64)>) -> Self {
        let parts: Vec<(Self, f64)> = parts.collect();
        if let [(only, _)] = parts[..] {
            return only;
        }
        let sum = |value: &dyn Fn(&Self) -> f64| parts.iter().map(|(part, weight)| weight * value(part)).sum::<f64>();
        let lit = sum(&|p| p.lit);
        Self {
            lit: ratio(lit, sum(&|_| 1.0)),
            luminance: ratio(sum(&|p| p.lit * p.luminance), lit),
            // A pattern with the lit share s and the mean lamp area a has s / a lamps per area. With the weight w of
            // each pattern, the mean lamp area of the mixture is Σ w s / Σ (w s / a).
            area: ratio(sum(&|p| if p.area > 0.0 { p.lit } else { 0.0 }), sum(&|p| ratio(p.lit, p.area))),
            spacing: 0.0,
            whole: parts.iter().map(|(part, _)| part.whole).sum(),
        }
    }

    /// The statistics after all lengths are multiplied by `scale`.
    pub fn scaled(self, scale: f64) -> Self {
        Self { area: self.area * scale * scale, spacing: self.spacing * scale, ..self }
    }

    /// The statistics after the area of each lamp is multiplied by `ratio`. The lit share is multiplied as well, up to
    /// 1.
    pub fn with_area(self, ratio: f64) -> Self {
        Self { lit: (self.lit * ratio).min(1.0), area: self.area * ratio, ..self }
    }

    /// The largest difference between two patterns in lit share, lamp area and lamp spacing, relative to `other`. A
    /// quantity that is 0 in `other` is skipped. Area and spacing are also skipped if they are 0 in this pattern. If
    /// only this pattern is unlit, its lit share differs by 1. Luminance is not compared: a texture holds relative
    /// values, and its absolute luminance is solved for later.
    pub fn difference(&self, other: &Self) -> f64 {
        let pairs = [(self.lit, other.lit), (self.area, other.area), (self.spacing, other.spacing)];
        let is_unlit = self.lit == 0.0 && other.lit > 0.0;
        let known = pairs.iter().filter(|(a, b)| *a > 0.0 && *b > 0.0).map(|(a, b)| (a / b - 1.0).abs());
        known.fold(if is_unlit { 1.0 } else { 0.0 }, f64::max)
    }
}

/// Root mean square distance of points from the nearest positions of a lattice. Its basis is `a`, `b`; its origin is
/// chosen to fit the points. Distances are in cell coordinates: a step of `a`, or of `b`, has length 1.
pub fn phase(points: &[DVec2], [a, b]: [DVec2; 2]) -> f64 {
    // Convert the points to cell coordinates. The circular mean of their fractional parts is the lattice's origin.
    let inverse = DMat2::from_cols(a, b).inverse();
    let cells: Vec<DVec2> = points.iter().map(|&p| inverse * p).collect();
    let angle =
        |f: &dyn Fn(&DVec2) -> f64| maths::angle_of(cells.iter().map(|c| maths::direction_at(TAU * f(c))).sum()) / TAU;
    let origin = DVec2::new(angle(&|c| c.x), angle(&|c| c.y));
    let off = |c: &DVec2| {
        let d = *c - origin;
        (d - d.round()).length_squared()
    };
    (cells.iter().map(off).sum::<f64>() / cells.len().max(1) as f64).sqrt()
}

/// The weight of the position `at` along an axis of length `side`: a Hann window or, for a known period, a trapezoid
/// (see the beginning of this file).
fn weight(at: f64, side: usize, period: Option<f64>) -> f64 {
    let side = side as f64;
    let Some(period) = period else { return maths::powi(maths::sin(PI * at / side), 2) };
    // All positions have equal weights if the axis is no longer than one period, or a whole number of periods long.
    let spare = if period < side { side % period } else { 0.0 };
    if spare > 0.0 { (at.min(side - at) / spare).min(1.0) } else { 1.0 }
}

fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// The distance from each point to the nearest other point; infinite for a single point. The search runs from each
/// point to both sides in the order of x, until the difference in x alone exceeds the nearest distance so far.
pub fn nearest_distances(points: &[DVec2]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_unstable_by(|&i, &j| points[i].x.total_cmp(&points[j].x));
    let mut nearest = vec![f64::INFINITY; points.len()];
    for (place, &i) in order.iter().enumerate() {
        let search = |others: &mut dyn Iterator<Item = &usize>, mut best: f64| {
            for &j in others {
                if (points[j].x - points[i].x).abs() >= best {
                    break;
                }
                best = best.min(points[i].distance(points[j]));
            }
            best
        };
        let after = search(&mut order[place + 1..].iter(), f64::INFINITY);
        nearest[i] = search(&mut order[..place].iter().rev(), after);
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emission::exemplar::components;
    use crate::rng::Rng;

    #[test]
    fn nearest_neighbours_are_those_of_trying_all() {
        let mut rng = Rng::new(3, &[]);
        let points: Vec<DVec2> = (0..300).map(|_| DVec2::new(rng.next_f64(), rng.next_f64())).collect();
        for (i, found) in nearest_distances(&points).into_iter().enumerate() {
            let others = points.iter().enumerate().filter(|(j, _)| *j != i);
            assert_eq!(found, others.map(|(_, p)| p.distance(points[i])).fold(f64::INFINITY, f64::min));
        }
    }

    /// Statistics of a grid of lamps of 9 × 5 pixels with periods 20 and 16, shifted by `shift` pixels relative to an
    /// image of `width` × `height`.
    fn grid(width: usize, height: usize, shift: [usize; 2], periods: [Option<f64>; 2]) -> Statistics {
        let lit = |i: usize| (i % width + shift[0]) % 20 < 9 && (i / width + shift[1]) % 16 < 5;
        let components = components::find(width, height, lit).unwrap();
        let whole: Vec<bool> = (components.list.iter())
            .map(|c| c.min.iter().all(|&v| v > 0) && c.max[0] + 1 < width && c.max[1] + 1 < height)
            .collect();
        let colour = |i: usize| Some(if lit(i) { Vec3::splat(2.0) } else { Vec3::ZERO });
        Statistics::of(&Pattern { width, height, components: &components, whole: &whole, periods, colour })
    }

    #[test]
    fn where_the_border_cuts_hardly_matters() {
        let truth = Statistics { lit: 45.0 / 320.0, luminance: 2.0, area: 45.0, spacing: 16.0, whole: 0 };
        for shift in [[0, 0], [3, 1], [9, 7], [15, 12]] {
            for (width, height) in [(67, 61), (90, 83), (200, 150)] {
                let seen = grid(width, height, shift, [None; 2]);
                assert!(seen.difference(&truth) < 0.02, "{width} x {height}, {shift:?}: {seen:?}");
            }
            // With known periods, the position of the border must not matter at all.
            for (width, height) in [(47, 39), (67, 61), (80, 64)] {
                let seen = grid(width, height, shift, [Some(20.0), Some(16.0)]);
                assert!(seen.difference(&truth) < 1e-9, "{width} x {height}, {shift:?}: {seen:?}");
            }
        }
        // Without the weights, the lit share would be wrong by more than a tenth.
        let counted = 4.0 * 4.0 * 45.0 / (67.0 * 61.0) / truth.lit;
        assert!((counted - 1.0f64).abs() > 0.1, "{counted}");
    }

    #[test]
    fn differences_are_relative_and_of_what_both_have() {
        let one = Statistics { lit: 0.1, luminance: 1.0, area: 10.0, spacing: 5.0, whole: 9 };
        assert_eq!(one.difference(&one), 0.0);
        assert!((Statistics { area: 12.0, ..one }.difference(&one) - 0.2).abs() < 1e-12);
        assert_eq!(Statistics { luminance: 2.0, ..one }.difference(&one), 0.0);
        assert_eq!(Statistics { area: 0.0, spacing: 0.0, whole: 0, ..one }.difference(&one), 0.0);
        assert_eq!(Statistics::default().difference(&one), 1.0, "a black texture lacks all light");
        assert!((one.scaled(2.0).difference(&one) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn phase_is_the_distance_from_the_lattice() {
        let basis = [DVec2::new(10.0, 2.0), DVec2::new(-3.0, 8.0)];
        let mut rng = Rng::new(5, &[]);
        let at = |i: i32, j: i32| basis[0] * f64::from(i) + basis[1] * f64::from(j) + DVec2::new(3.7, 1.1);
        let exact: Vec<DVec2> = (0..100).map(|k| at(k % 10, k / 10)).collect();
        assert!(phase(&exact, basis) < 1e-12);
        let off: Vec<DVec2> = exact.iter().map(|p| *p + basis[0] * 0.02 * (2.0 * rng.next_f64() - 1.0)).collect();
        // The offsets are uniform in ± 0.02 periods along one axis.
        assert!((phase(&off, basis) / (0.02 / 3f64.sqrt()) - 1.0).abs() < 0.15);
    }
}
