//! Lamps as shapes in a plane, and statistics of a set of lamps: size, aspect ratio and spacing.

use glam::DVec2;
use luxfer::geometry::polygon;
use std::f64::consts::PI;

/// Aspect ratio above which lamps count as lines. The photo or a joint cuts the ends of lines, so lines are described
/// by their width and the distance between neighbouring lines. [convention]
const LINE_ASPECT: f64 = 6.0;

/// Minimum aspect ratio of a lamp whose long side has a meaningful direction. [convention]
const LONG: f64 = 1.2;
/// Rectangles around a lamp whose areas differ by less than this factor are equally small. [convention]
const SAME_AREA: f64 = 1.02;
/// Cosine of the maximum angle between a row and a step from lamp to lamp along the row. [convention: 20 degrees]
const ALONG: f64 = 0.94;

/// The shape of one lamp.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Centroid of the convex hull.
    pub centroid: DVec2,
    /// Centre of the smallest rectangle around the lamp.
    pub centre: DVec2,
    /// Sides of the smallest rectangle around the lamp, the longer side first.
    pub sides: DVec2,
    /// Unit vector along the longer side.
    pub axis: DVec2,
    pub area: f64,
}

impl Shape {
    /// Measures a polygon. `area` is the lit area, if it is not the polygon's area. `None` if the polygon has no area.
    pub fn of(outline: &[DVec2], area: Option<f64>) -> Option<Self> {
        let hull = polygon::convex_hull(outline.to_vec());
        if hull.len() < 3 {
            return None;
        }
        // Find the smallest rectangle: one of its sides lies along a side of the convex hull. A right triangle has two
        // of equal area, so the shorter circumference decides.
        let along = |i: usize| (hull[(i + 1) % hull.len()] - hull[i]).normalize_or_zero();
        let rectangle = |axis: DVec2| DVec2::new(polygon::extent(&hull, axis), polygon::extent(&hull, axis.perp()));
        let axes = (0..hull.len()).map(along).filter(|axis| *axis != DVec2::ZERO);
        let smallest = axes.clone().map(|axis| rectangle(axis).element_product()).fold(f64::MAX, f64::min);
        let small = axes.filter(|axis| rectangle(*axis).element_product() <= SAME_AREA * smallest);
        let axis = small.min_by(|a, b| rectangle(*a).element_sum().total_cmp(&rectangle(*b).element_sum()))?;
        let sides = rectangle(axis);
        let (sides, axis) =
            if sides.x >= sides.y { (sides, axis) } else { (DVec2::new(sides.y, sides.x), axis.perp()) };
        // Compute the centre of this rectangle.
        let middle = |axis: DVec2| {
            let at = hull.iter().map(|p| p.dot(axis));
            at.clone().fold(f64::MAX, f64::min) / 2.0 + at.fold(f64::MIN, f64::max) / 2.0
        };
        let centre = axis * middle(axis) + axis.perp() * middle(axis.perp());
        let area = area.unwrap_or_else(|| polygon::area(outline).abs());
        let centroid = centroid(&hull);
        (area > 0.0 && sides.y > 0.0).then_some(Self { centroid, centre, sides, axis, area })
    }

    pub fn aspect(&self) -> f64 {
        self.sides.x / self.sides.y
    }

    /// Corners of the smallest rectangle around the lamp.
    fn corners(&self) -> [DVec2; 4] {
        let (a, b) = (self.axis * self.sides.x / 2.0, self.axis.perp() * self.sides.y / 2.0);
        [self.centre + a + b, self.centre - a + b, self.centre - a - b, self.centre + a - b]
    }

    /// The width of the gap between two lamps that lie side by side; `None` if they do not.
    fn gap(&self, other: &Self) -> Option<f64> {
        let corners = other.corners();
        let apart = |axis: DVec2, side: f64| {
            let own = axis.dot(self.centre);
            let at = corners.iter().map(|p| p.dot(axis));
            let (low, high) = (at.clone().fold(f64::MAX, f64::min), at.fold(f64::MIN, f64::max));
            (low - own - side / 2.0).max(own - side / 2.0 - high)
        };
        let [along, across] = [apart(self.axis, self.sides.x), apart(self.axis.perp(), self.sides.y)];
        let is_beside = along.min(across) < -0.5 * self.sides.min(other.sides).min_element();
        is_beside.then_some(along.max(across))
    }

    /// The smallest rectangle around lamps, with the sum of their areas.
    fn around(lamps: &[&Self]) -> Option<Self> {
        let corners: Vec<DVec2> = lamps.iter().flat_map(|lamp| lamp.corners()).collect();
        Self::of(&corners, Some(lamps.iter().map(|lamp| lamp.area).sum()))
    }
}

/// Centroid of a convex polygon.
fn centroid(hull: &[DVec2]) -> DVec2 {
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for i in 1..hull.len() - 1 {
        let (a, b) = (hull[i] - hull[0], hull[i + 1] - hull[0]);
        sum += (a + b) / 3.0 * a.perp_dot(b);
        area += a.perp_dot(b);
    }
    if area == 0.0 { hull[0] } else { hull[0] + sum / area }
}

/// A set of lamps in one plane; all lengths are in one unit.
#[derive(Clone, Debug, Default)]
pub struct Lamps {
    /// The lamps that are seen whole.
    pub whole: Vec<Shape>,
    /// Kind of each lamp in `whole`; empty if the kinds are not known.
    pub kinds: Vec<usize>,
    /// Lamps that the border of a texture cuts; they count for the statistics of lines.
    pub cut: Vec<Shape>,
    /// Centroids of further lamps, which are cut or partly hidden; they count for the spacing.
    pub others: Vec<DVec2>,
    /// Lower and upper bound of the lit share of the plane.
    pub lit: Option<[f64; 2]>,
    /// Maximum width of the bars between panes that count as one lamp; 0 if each pane is a lamp.
    pub bar: f64,
}

/// Panes are one lamp if the bar between them is at most this share of the lamps' shorter side. [convention]
const MAX_BAR: f64 = 0.2;

/// Lamps listed by hand are of two kinds if every large lamp has at least `MIN_KIND_RATIO` times the area of every
/// small one, and each kind has at least the share `MIN_KIND_SHARE` of the lamps. [convention]
const MIN_KIND_RATIO: f64 = 1.5;
const MIN_KIND_SHARE: f64 = 0.25;

impl Lamps {
    /// Whether the median lamp is a line.
    pub fn are_lines(&self) -> bool {
        median(self.whole.iter().map(Shape::aspect)).is_some_and(|aspect| aspect > LINE_ASPECT)
    }

    /// For each kind: median area, median aspect ratio, and share of the lamps; empty if there is only one kind.
    pub fn by_kind(&self) -> Vec<[f64; 3]> {
        let last = self.kinds.iter().max().copied().unwrap_or(0);
        let of =
            |kind: usize| self.whole.iter().zip(&self.kinds).filter(move |(_, k)| **k == kind).map(|(shape, _)| shape);
        let kinds = (0..=last).filter(|_| last > 0).filter_map(|kind| {
            let share = of(kind).count() as f64 / self.whole.len() as f64;
            Some([median(of(kind).map(|s| s.area))?, median(of(kind).map(Shape::aspect))?, share])
        });
        kinds.collect()
    }

    /// Joins lamps that lie side by side, at most `bar` apart: panes with bars of this width between them are one
    /// window.
    pub fn joined(&self, bar: f64) -> Self {
        if bar <= 0.0 {
            return self.clone();
        }
        let mut lamps: Vec<&Shape> = self.whole.iter().collect();
        lamps.sort_by(|a, b| a.centre.x.total_cmp(&b.centre.x));
        let reach = bar + lamps.iter().map(|lamp| lamp.sides.length()).fold(0.0, f64::max);
        // Each lamp has the number of its group. Where two groups meet, the later one takes the number of the earlier.
        let mut group: Vec<usize> = (0..lamps.len()).collect();
        for i in 0..lamps.len() {
            let near = (i + 1..lamps.len()).take_while(|&j| lamps[j].centre.x - lamps[i].centre.x <= reach);
            for j in near.filter(|&j| lamps[i].gap(lamps[j]).is_some_and(|gap| gap <= bar)) {
                let (a, b) = (group[i].min(group[j]), group[i].max(group[j]));
                group.iter_mut().filter(|g| a < b && **g == b).for_each(|g| *g = a);
            }
        }
        let mut groups: Vec<Vec<&Shape>> = vec![Vec::new(); lamps.len()];
        lamps.iter().zip(&group).for_each(|(lamp, group)| groups[*group].push(lamp));
        let whole = groups.iter().filter_map(|group| match group[..] {
            [] => None,
            [lamp] => Some(lamp.clone()),
            _ => Shape::around(group),
        });
        Self { whole: whole.collect(), ..self.clone() }
    }

    /// For lamps listed by hand, where a window of several panes is one lamp: sets the width of the bars between panes.
    /// It is at most [`MAX_BAR`] times the lamps' shorter side and at most half of the narrowest gap between two lamps.
    pub fn with_bars(self) -> Self {
        let pairs = self.whole.iter().enumerate().flat_map(|(i, a)| self.whole[..i].iter().filter_map(|b| a.gap(b)));
        let side = median(self.whole.iter().map(|s| s.sides.y)).unwrap_or(0.0);
        let bar = pairs.map(|gap| 0.5 * gap).fold(MAX_BAR * side, f64::min);
        Self { bar, ..self }
    }

    /// For lamps listed by hand: gives them two kinds if they are of two sizes, like the narrow and the wide windows of
    /// a skylight. The two kinds lie on both sides of the widest gap between areas. Medians over all lamps would depend
    /// on how many of each kind the photo happens to show.
    pub fn with_kinds(mut self) -> Self {
        let mut areas: Vec<f64> = self.whole.iter().map(|shape| shape.area).collect();
        areas.sort_by(f64::total_cmp);
        let ratio = |n: &usize| areas[*n] / areas[n - 1];
        let least = (MIN_KIND_SHARE * areas.len() as f64).ceil().max(1.0) as usize;
        let gap = (least..(areas.len() + 1).saturating_sub(least)).max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        if let Some(gap) = gap.filter(|gap| ratio(gap) >= MIN_KIND_RATIO) {
            self.kinds = self.whole.iter().map(|shape| usize::from(shape.area >= areas[gap])).collect();
        }
        self
    }

    pub fn area(&self) -> Option<f64> {
        median(self.whole.iter().map(|s| s.area))
    }

    /// All shapes that count for the statistics of lines.
    fn lines(&self) -> impl Iterator<Item = &Shape> {
        self.whole.iter().chain(&self.cut)
    }

    /// Median width of lines.
    pub fn width(&self) -> Option<f64> {
        median(self.lines().map(|s| s.sides.y))
    }

    pub fn aspect(&self) -> Option<f64> {
        median(self.whole.iter().map(Shape::aspect))
    }

    /// Median distance from the centroid of a lamp to the nearest other one.
    pub fn spacing(&self) -> Option<f64> {
        let centres: Vec<DVec2> = self.whole.iter().map(|s| s.centroid).chain(self.others.iter().copied()).collect();
        median((0..centres.len()).filter_map(|i| {
            let others = (0..centres.len()).filter(|j| *j != i);
            others.map(|j| centres[i].distance(centres[j])).min_by(f64::total_cmp)
        }))
    }

    /// For lamps in a single row: the angle from a lamp's long side to the row, in [0, π). `None` for other lamps and
    /// for lamps without a long side.
    pub fn row(&self) -> Option<f64> {
        let [first, .., last] = &self.whole[..] else { return None };
        let along = (last.centre - first.centre).try_normalize()?;
        let is_in_row = |lamp: &Shape| (lamp.centre - first.centre).perp_dot(along).abs() < lamp.sides.y / 2.0;
        let is_row = self.whole.len() > 2 && self.others.is_empty() && self.whole.iter().all(is_in_row);
        let is_long = self.aspect().is_some_and(|aspect| aspect > LONG);
        (is_row && is_long).then(|| first.axis.angle_to(along).rem_euclid(PI))
    }

    /// Median distance from a lamp's centre to the nearest other centre, in the direction at `angle` to the lamp's
    /// long side.
    pub fn spacing_along(&self, angle: f64) -> Option<f64> {
        median(self.whole.iter().filter_map(|lamp| {
            let along = DVec2::from_angle(angle).rotate(lamp.axis);
            let steps = self.whole.iter().map(|other| other.centre - lamp.centre);
            let ahead = steps.filter(|step| step.dot(along).abs() > ALONG * step.length() && step.length() > 0.0);
            ahead.map(|step| step.length()).min_by(f64::total_cmp)
        }))
    }

    /// Median distance between neighbouring lines, measured perpendicular to them.
    pub fn spacing_across(&self) -> Option<f64> {
        let beside = |a: &Shape, b: &Shape| {
            let apart = b.centre - a.centre;
            let across = apart.dot(a.axis.perp()).abs();
            let overlaps = apart.dot(a.axis).abs() < (a.sides.x + b.sides.x) / 2.0;
            (overlaps && across > a.sides.y + b.sides.y).then_some(across)
        };
        median(self.lines().filter_map(|a| self.lines().filter_map(|b| beside(a, b)).min_by(f64::total_cmp)))
    }

    /// Lengths of the two shortest steps from lamp to lamp that are not parallel, the shorter first. They are the
    /// periods of a lattice, even if some of its sites are empty.
    pub fn steps(&self) -> Option<[f64; 2]> {
        let nearest = self.spacing()?;
        let centres: Vec<DVec2> = self.whole.iter().map(|s| s.centroid).chain(self.others.iter().copied()).collect();
        let pairs = centres.iter().enumerate().flat_map(|(i, a)| centres[i + 1..].iter().map(move |b| *b - *a));
        let mut steps: Vec<DVec2> = pairs.filter(|d| d.length() > 0.5 * nearest).collect();
        steps.sort_by(|a, b| a.length().total_cmp(&b.length()));
        let first = steps.iter().find(|d| d.length() > 0.85 * nearest)?;
        let first = mean_like(&steps, *first);
        let is_across = |d: &&DVec2| d.perp_dot(first).abs() > 0.35 * d.length() * first.length();
        let second = mean_like(&steps, *steps.iter().find(is_across)?);
        Some([first.length(), second.length()])
    }
}

/// Mean of the steps that differ from `step` by less than a tenth of its length, up to sign.
fn mean_like(steps: &[DVec2], step: DVec2) -> DVec2 {
    let turned = steps.iter().map(|d| if d.dot(step) < 0.0 { -*d } else { *d });
    let like: Vec<DVec2> = turned.filter(|d| d.distance(step) < 0.1 * step.length()).collect();
    if like.is_empty() { step } else { like.iter().sum::<DVec2>() / like.len() as f64 }
}

/// Median of the values; `None` if there are none.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.into_iter().collect();
    (!values.is_empty()).then(|| crate::harness::median(&values))
}
