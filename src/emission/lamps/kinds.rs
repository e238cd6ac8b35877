//! Groups lamps into kinds: lamps of about equal size and shape, regardless of colour and orientation.
//!
//! Lamps are compared by their area and by the smallest rectangle that encloses their outline. A square fills all of
//! this rectangle, a disc π/4 of it, a triangle half. If lamps are narrower than about twenty texels, the tolerances
//! for rounding are too wide to distinguish a square from a disc of equal width.
//!
//! Kinds are found greedily: the lamp that resembles the largest number of other lamps forms a kind with these. This is
//! repeated for the remaining lamps.

use super::luminaire::Luminaire;
use crate::geometry::polygon;
use crate::maths;
use glam::{DVec2, Vec2Swizzles};
use std::collections::BTreeMap;

/// Maximum relative difference in area, and in each side, between two lamps of one kind.
/// [bench emission:real]
const MAX_DIFFERENCE: f64 = 0.25;
/// A lamp fills a share of its smallest enclosing rectangle. Between two lamps of one kind, this share differs by at
/// most `MAX_FILL_DIFFERENCE`, plus an allowance for the errors of outlines ([`ROUNDING`]). The value is about half the
/// difference between a square and a disc, 1 - π/4 = 0.21. With 0.21 or more, squares and discs would be one kind.
/// [convention]
const MAX_FILL_DIFFERENCE: f64 = 0.1;
/// Maximum difference, in texels, between the measured sides of two equal lamps. The sides differ because outlines are
/// rounded to texels and simplified. [rounding]
const ROUNDING: f64 = 2.0;
/// Before lamps are compared, they are binned by the logarithms of their area and sides. A factor of e = 2.718 spans
/// this number of bins, so the values in one bin differ by at most about 5 %. [convention]
const BINS_PER_E: f64 = 20.0;

/// The measures by which lamps are compared; lengths are in texels.
#[derive(Clone, Copy)]
struct Measures {
    area: f64,
    /// Sides of the smallest enclosing rectangle, the long one first.
    sides: DVec2,
}

impl Measures {
    fn of(lamp: &Luminaire) -> Self {
        Self { area: lamp.area, sides: smallest_rectangle(&lamp.outline) }
    }

    fn fill(self) -> f64 {
        self.area / (self.sides.x * self.sides.y).max(f64::MIN_POSITIVE)
    }

    fn is_like(self, other: Self) -> bool {
        let close = |a: f64, b: f64, rounding: f64| (a - b).abs() <= (MAX_DIFFERENCE * a.max(b)).max(rounding);
        let (long, short) = (self.sides.x.max(other.sides.x), self.sides.y.min(other.sides.y).max(1.0));
        close(self.area, other.area, 0.5 * ROUNDING * long)
            && close(self.sides.x, other.sides.x, ROUNDING)
            && close(self.sides.y, other.sides.y, ROUNDING)
            && (self.fill() - other.fill()).abs() <= MAX_FILL_DIFFERENCE + ROUNDING / short
    }

    /// The bin of a lamp with these measures. Lamps in one bin are treated as equal.
    fn bin(self) -> [i64; 3] {
        [self.area, self.sides.x, self.sides.y].map(|v| (maths::ln(v.max(1e-9)) * BINS_PER_E).round() as i64)
    }
}

/// A bin of lamps of nearly equal measures. `shape` holds the measures of the bin's first lamp. `count` is the number
/// of lamps in the texture that the bin stands for.
struct Bin<'a> {
    shape: Measures,
    lamps: Vec<&'a mut Luminaire>,
    count: usize,
}

/// Gives every lamp the number of its kind: 1 for the kind with the most lamps, 2 for the next, and so on. Each lamp
/// comes with a count, the number of lamps in the texture that it stands for. A lamp with count 0, for example one that
/// the border cuts, gets number 0, which means no kind.
pub fn number<'a>(lamps: impl Iterator<Item = (&'a mut Luminaire, usize)>) {
    let mut bins: BTreeMap<[i64; 3], Bin> = BTreeMap::new();
    for (lamp, count) in lamps {
        lamp.kind = 0;
        let shape = Measures::of(lamp);
        if count > 0 && shape.area > 0.0 {
            let bin = bins.entry(shape.bin()).or_insert(Bin { shape, lamps: Vec::new(), count: 0 });
            bin.lamps.push(lamp);
            bin.count += count;
        }
    }
    let mut left: Vec<Bin> = bins.into_values().collect();

    // Take the shape that the largest number of lamps resembles. Together, these lamps form a kind. Repeat this for the
    // remaining lamps.
    let count = |bins: &[Bin]| bins.iter().map(|s| s.count).sum::<usize>();
    let mut kinds: Vec<Vec<Bin>> = Vec::new();
    loop {
        let like = |bin: &Bin| left.iter().filter(|s| s.shape.is_like(bin.shape)).map(|s| s.count).sum::<usize>();
        let Some(shape) = left.iter().rev().max_by_key(|bin| like(bin)).map(|bin| bin.shape) else { break };
        let (of_kind, others): (Vec<_>, Vec<_>) = left.into_iter().partition(|s| s.shape.is_like(shape));
        kinds.push(of_kind);
        left = others;
    }
    kinds.sort_by_key(|kind| std::cmp::Reverse(count(kind)));
    for (number, kind) in (1..).zip(kinds) {
        kind.into_iter().flat_map(|s| s.lamps).for_each(|lamp| lamp.kind = number);
    }
}

/// Sides of the smallest enclosing rectangle of the corners, the long side first. One side of that rectangle lies
/// along an edge of the convex hull (Freeman and Shapira 1975), so every edge of the hull is tried.
fn smallest_rectangle(corners: &[DVec2]) -> DVec2 {
    let extent = |axis: DVec2| polygon::extent(corners, axis);
    let hull = polygon::convex_hull(corners.to_vec());
    let edges = hull.iter().zip(hull.iter().cycle().skip(1)).filter_map(|(a, b)| (*b - *a).try_normalize());
    let sides = edges.map(|axis| DVec2::new(extent(axis), extent(axis.perp())));
    let smallest = sides.min_by(|a, b| (a.x * a.y).total_cmp(&(b.x * b.y))).unwrap_or_default();
    if smallest.x >= smallest.y { smallest } else { smallest.yx() }
}

#[cfg(test)]
mod tests {
    use super::super::luminaires;
    use super::*;
    use crate::image::Image;
    use crate::job::Monitor;
    use std::f64::consts::PI;

    fn lamps(width: usize, height: usize, is_lit: impl Fn(DVec2) -> bool) -> Vec<Luminaire> {
        let on = |x: usize, y: usize| f32::from(is_lit(DVec2::new(x as f64, y as f64) + 0.5));
        let mask = Image::from_fn(width, height, |x, y| [on(x, y)]).unwrap();
        let texture = Image::from_fn(width, height, |x, y| [on(x, y); 3]).unwrap();
        let found = luminaires::components(&mask).unwrap();
        luminaires::find(&texture, &found, &|i| mask.data[i], Monitor::default().job()).unwrap()
    }

    #[test]
    fn rectangles_around_turned_shapes_are_the_smallest() {
        for angle in [0.0, 0.3, 1.0, 2.0] {
            let turn = |x: f64, y: f64| DVec2::from_angle(angle).rotate(DVec2::new(x, y)) + DVec2::new(50.0, 70.0);
            let box_ = [turn(0.0, 0.0), turn(5.0, 0.0), turn(5.0, 2.0), turn(2.5, 1.0), turn(0.0, 2.0)];
            assert!((smallest_rectangle(&box_) - DVec2::new(5.0, 2.0)).length() < 1e-9);
            let disc: Vec<DVec2> = (0..64).map(|i| DVec2::from_angle(f64::from(i) * PI / 32.0) * 10.0).collect();
            assert!((smallest_rectangle(&disc) - 20.0).length() < 0.2);
        }
        assert_eq!(smallest_rectangle(&[]), DVec2::ZERO);
        assert_eq!(smallest_rectangle(&[DVec2::ONE]), DVec2::ZERO);
        assert_eq!(smallest_rectangle(&[DVec2::ZERO, DVec2::X]), DVec2::X);
    }

    #[test]
    fn discs_squares_however_turned_and_bars_are_kinds() {
        // A row of eight lamps: squares, of which every second one is rotated by 45°, alternate with discs of the same
        // width. The last lamp is a bar. The expected kinds are 1 for squares, 2 for discs and 3 for the bar.
        let size = DVec2::new(640.0, 200.0);
        let what = |cell: i64| match cell {
            0 | 2 | 4 | 6 => 1,
            1 | 3 | 5 => 2,
            _ => 3,
        };
        let is_lit = |p: DVec2| {
            let cell = (p.x / 80.0).floor();
            let d = p - DVec2::new(80.0 * cell + 40.0, 100.0);
            let turned = if cell as i64 % 4 == 0 { d } else { DVec2::from_angle(PI / 4.0).rotate(d) };
            match what(cell as i64) {
                1 => turned.abs().max_element() < 22.0,
                2 => d.length() < 22.0,
                _ => d.x.abs() < 8.0 && d.y.abs() < 60.0,
            }
        };
        let mut found = lamps(size.x as usize, size.y as usize, is_lit);
        number(found.iter_mut().map(|l| (l, 1)));
        for lamp in &found {
            assert_eq!(i64::from(lamp.kind), what((lamp.centre.x / 80.0) as i64), "at {}", lamp.centre);
        }
        // Lamps with count 0 get no kind.
        number(found.iter_mut().map(|l| (usize::from(l.centre.x < 300.0), l)).map(|(count, l)| (l, count)));
        assert_eq!(found.iter().filter(|l| l.kind == 0).count(), found.len() - 4);
        assert!(found.iter().filter(|l| l.centre.x < 300.0).all(|l| l.kind > 0));
    }

    #[test]
    fn lamps_of_a_few_texels_are_one_kind_where_rounding_alone_tells_them_apart() {
        // Discs with a diameter of about 5 texels, whose centres lie at different positions within a texel.
        let is_lit = |p: DVec2| {
            let cell = (p / 20.0).floor();
            let aside = DVec2::new((cell.x * 0.37).fract(), (cell.y * 0.61 + cell.x * 0.17).fract());
            (p - cell * 20.0 - 10.0 - aside).length() < 2.6
        };
        let mut found = lamps(200, 200, is_lit);
        number(found.iter_mut().map(|l| (l, 1)));
        assert!(
            found.len() == 100 && found.iter().all(|l| l.kind == 1),
            "{}",
            found.iter().map(|l| l.kind).max().unwrap()
        );
    }
}
