//! Finds the lamps that lie on the sites of a lattice, seen in perspective: the lattice grows from one cell of four lamps.

use super::lattice::Lamp;
use crate::geometry::{Homography, linear};
use crate::maths;
use glam::{DMat3, DVec2};

/// A lamp lies on a site if its distance from the site is below this, in lattice steps. [bench photos:tune]
const MAX_OFF_SITE: f64 = 0.2;
/// Number of nearest lamps that are tried as neighbours of a lamp on the lattice. [bench photos:tune]
const NEIGHBOURS: usize = 8;
/// Two steps of a lattice are refused if the sine of the angle between them is below this; lengths and angles are
/// measured by the extent of the lamp. [convention]
const MIN_SINE: f64 = 0.25;
/// The fourth lamp of a cell lies at most this far from the place that completes a parallelogram, as a share of the
/// shorter step. Perspective within the cell moves it from that place. [convention]
const MAX_OFF_CORNER: f64 = 0.5;

/// Returns the largest lattice that grows from any four lamps, and of several the one that fits best. `None` if none
/// grows.
pub fn largest(lamps: &[Lamp]) -> Option<Growth> {
    let mut best: Option<Growth> = None;
    for cell in (0..lamps.len()).flat_map(|first| cells(lamps, first)) {
        let Some(growth) = Growth::from_cell(lamps, cell) else { continue };
        if best.as_ref().is_none_or(|best| growth.is_better_than(best)) {
            best = Some(growth);
        }
        if best.as_ref().is_some_and(|best| best.count() == lamps.len()) {
            break;
        }
    }
    best
}

/// Returns the cells of which the lamp `first` may be a corner, each as the lamps at (0, 0), (1, 0), (1, 1) and (0, 1).
fn cells(lamps: &[Lamp], first: usize) -> Vec<[usize; 4]> {
    let Lamp { centre, inverse } = lamps[first];
    let product = |a: DVec2, b: DVec2| a.dot(inverse * b);
    let square = |k: usize| product(lamps[k].centre - centre, lamps[k].centre - centre);
    let mut near: Vec<usize> = (0..lamps.len()).filter(|k| *k != first).collect();
    near.sort_by(|a, b| square(*a).total_cmp(&square(*b)));
    near.truncate(NEIGHBOURS);
    let mut found = Vec::new();
    for (n, &a) in near.iter().enumerate() {
        for &b in &near[..n] {
            let (right, down) = (lamps[a].centre - centre, lamps[b].centre - centre);
            let squares = [product(right, right), product(down, down)];
            let cosine = product(right, down) / (squares[0] * squares[1]).sqrt();
            if !(cosine.abs() < (1.0 - MIN_SINE * MIN_SINE).sqrt()) {
                continue;
            }
            let off = |k: usize| {
                let off = lamps[k].centre - (centre + right + down);
                product(off, off)
            };
            let others = (0..lamps.len()).filter(|k| ![first, a, b].contains(k));
            let opposite = others.min_by(|x, y| off(*x).total_cmp(&off(*y)));
            let max_off = MAX_OFF_CORNER * MAX_OFF_CORNER * squares[0].min(squares[1]);
            found.extend(opposite.filter(|&k| off(k) < max_off).map(|k| [first, a, k, b]));
        }
    }
    found
}

/// A lattice that has grown from one cell.
pub struct Growth {
    /// For each lamp, the number of steps from the first lamp along the two axes of the lattice; `None` if it lies on no
    /// site.
    pub steps: Vec<Option<DVec2>>,
    /// Maps lattice steps to the centres of the lamps in the photo.
    pub to_photo: Homography,
    /// Sum of the squared distances between lamps and sites, in lattice steps.
    off: f64,
}

impl Growth {
    /// Grows the lattice from the four lamps of one cell until no further lamp lies on a site beside it.
    fn from_cell(lamps: &[Lamp], cell: [usize; 4]) -> Option<Self> {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
        let to_photo = Homography::from_corners(corners, cell.map(|k| lamps[k].centre)).ok()?;
        let mut growth = Self { steps: vec![None; lamps.len()], to_photo, off: 0.0 };
        cell.iter().zip(corners).for_each(|(&k, corner)| growth.steps[k] = Some(corner));
        // Each round adds a lamp or ends the growth.
        for _ in 0..lamps.len() {
            let before = growth.count();
            growth.add_neighbours(lamps);
            if growth.count() == before {
                break;
            }
            growth.to_photo = growth.fitted(lamps)?;
            growth.drop_off_site(lamps);
        }
        (growth.count() > 4).then_some(growth)
    }

    pub fn count(&self) -> usize {
        self.steps.iter().flatten().count()
    }

    /// Returns the lattice coordinates of a lamp; `None` if the horizon of the plane separates it from the first cell.
    fn place(&self, lamp: &Lamp) -> Option<DVec2> {
        let [here, first] =
            [lamp.centre, self.to_photo.apply(DVec2::ZERO)].map(|at| self.to_photo.inverse().apply_homogeneous(at));
        let is_ahead = here.z * first.z > 0.0;
        is_ahead.then(|| here.truncate() / here.z).filter(|place| place.is_finite())
    }

    /// Puts lamps on the sites beside the occupied sites.
    fn add_neighbours(&mut self, lamps: &[Lamp]) {
        let occupied: Vec<DVec2> = self.steps.iter().flatten().copied().collect();
        let mut added: Vec<(usize, DVec2, f64)> = Vec::new();
        for (k, lamp) in lamps.iter().enumerate().filter(|(k, _)| self.steps[*k].is_none()) {
            let Some(place) = self.place(lamp) else { continue };
            let site = place.round();
            let off = place.distance(site);
            let is_beside = occupied.iter().any(|o| (*o - site).abs().max_element() <= 1.0);
            if off > MAX_OFF_SITE || !is_beside || occupied.contains(&site) {
                continue;
            }
            match added.iter_mut().find(|(_, other, _)| *other == site) {
                Some(rival) if rival.2 > off => *rival = (k, site, off),
                Some(_) => {}
                None => added.push((k, site, off)),
            }
        }
        added.into_iter().for_each(|(k, site, _)| self.steps[k] = Some(site));
    }

    /// Fits the homography to the lamps on sites by least squares. Multiplied by the third homogeneous coordinate, the
    /// equations are linear; weights, the former values of this coordinate, undo the multiplication.
    fn fitted(&self, lamps: &[Lamp]) -> Option<Homography> {
        let at: Vec<(DVec2, DVec2)> =
            self.steps.iter().zip(lamps).filter_map(|(s, lamp)| Some(((*s)?, lamp.centre))).collect();
        // The origin of the steps is the first lamp, which the camera sees, so the last entry of the matrix is not 0.
        let former = self.to_photo.0 * self.to_photo.0.z_axis.z.recip();
        let (mut gram, mut right) = ([[0.0; 8]; 8], [0.0; 8]);
        for (steps, centre) in at {
            let weight = maths::powi((former * steps.extend(1.0)).z, -2);
            let (u, v) = (steps.x, steps.y);
            let rows = [
                ([u, v, 1.0, 0.0, 0.0, 0.0, -centre.x * u, -centre.x * v], centre.x),
                ([0.0, 0.0, 0.0, u, v, 1.0, -centre.y * u, -centre.y * v], centre.y),
            ];
            for (row, value) in rows {
                for i in 0..8 {
                    (0..8).for_each(|j| gram[i][j] += weight * row[i] * row[j]);
                    right[i] += weight * row[i] * value;
                }
            }
        }
        let [a, b, c, d, e, f, g, h] = linear::solve(gram, right)?;
        let rows = [[a, b, c], [d, e, f], [g, h, 1.0]];
        let matrix = DMat3::from_cols_array_2d(&rows).transpose();
        matrix.is_finite().then_some(Homography(matrix))
    }

    /// Takes lamps off the lattice that no longer lie on their sites.
    fn drop_off_site(&mut self, lamps: &[Lamp]) {
        self.off = 0.0;
        for (k, lamp) in lamps.iter().enumerate() {
            let Some(site) = self.steps[k] else { continue };
            match self.place(lamp).map(|place| place.distance(site)) {
                Some(off) if off <= MAX_OFF_SITE => self.off += off * off,
                _ => self.steps[k] = None,
            }
        }
    }

    fn is_better_than(&self, other: &Self) -> bool {
        let (count, others) = (self.count(), other.count());
        count > others || count == others && self.off < other.off
    }
}
