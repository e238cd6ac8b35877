//! Lattices in the plane, and lattices seen in perspective.
//!
//! A lattice in perspective ("Detection, Rectification and Segmentation of Coplanar Repeated Patterns", Pritts, Chum
//! and Matas, CVPR 2014) is found from the centres of the spots on its sites: it grows from one cell of four spots.

use super::{Homography, linear};
use crate::maths;
use glam::{DMat2, DMat3, DVec2};

/// Minimum number of spots on a lattice: four spots determine a homography, and two further spots confirm it.
/// [convention]
const MIN_SITES: usize = 6;
/// Minimum share of all spots that lie on the lattice. [bench photos:tune]
const MIN_SHARE: f64 = 0.7;
/// Maximum number of sites per spot, in the smallest rectangle of sites that holds all spots. Any spots fit a lattice
/// that has enough sites. [convention]
const MAX_SITES_PER_SPOT: f64 = 4.0;
/// Only this number of spots is used: more take time and add no certainty. [bench photos:tune]
pub const MAX_SPOTS: usize = 64;
/// A spot lies on a site if its distance from the site is below this, in lattice steps. [bench photos:tune]
const MAX_OFF_SITE: f64 = 0.2;
/// Number of nearest spots that are tried as neighbours of a spot on the lattice. [bench photos:tune]
const NEIGHBOURS: usize = 8;
/// Two steps of a lattice are refused if the sine of the angle between them is below this; lengths and angles are
/// measured by the extent of the spot. [convention]
const MIN_SINE: f64 = 0.25;
/// The fourth spot of a cell lies at most this far from the place that completes a parallelogram, as a share of the
/// shorter step. Perspective within the cell moves it from that place. [convention]
const MAX_OFF_CORNER: f64 = 0.5;

/// The two shortest vectors that span the same lattice as the given ones (Lagrange's reduction).
pub fn reduced([mut a, mut b]: [DVec2; 2]) -> [DVec2; 2] {
    // The number of steps grows only with the logarithm of the vectors' lengths: 64 steps suffice for any image.
    for _ in 0..64 {
        if b.length_squared() < a.length_squared() {
            std::mem::swap(&mut a, &mut b);
        }
        let times = (a.dot(b) / a.length_squared()).round();
        if times == 0.0 || !times.is_finite() {
            break;
        }
        b -= a * times;
    }
    [a, b]
}

/// A spot in an image.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    pub centre: DVec2,
    /// Inverse of the covariance of the spot's pixels. Distances measured in units of the spot's extent hardly depend
    /// on the tilt of its plane.
    pub inverse: DMat2,
}

/// Returns the cells of which the spot `first` may be a corner, each as the spots at (0, 0), (1, 0), (1, 1) and (0, 1).
fn cells(spots: &[Spot], first: usize) -> Vec<[usize; 4]> {
    let Spot { centre, inverse } = spots[first];
    let product = |a: DVec2, b: DVec2| a.dot(inverse * b);
    let square = |k: usize| product(spots[k].centre - centre, spots[k].centre - centre);
    let mut near: Vec<usize> = (0..spots.len()).filter(|k| *k != first).collect();
    near.sort_by(|a, b| square(*a).total_cmp(&square(*b)));
    near.truncate(NEIGHBOURS);
    let mut found = Vec::new();
    for (n, &a) in near.iter().enumerate() {
        for &b in &near[..n] {
            let (right, down) = (spots[a].centre - centre, spots[b].centre - centre);
            let squares = [product(right, right), product(down, down)];
            let cosine = product(right, down) / (squares[0] * squares[1]).sqrt();
            if !(cosine.abs() < (1.0 - MIN_SINE * MIN_SINE).sqrt()) {
                continue;
            }
            let off = |k: usize| {
                let off = spots[k].centre - (centre + right + down);
                product(off, off)
            };
            let others = (0..spots.len()).filter(|k| ![first, a, b].contains(k));
            let opposite = others.min_by(|x, y| off(*x).total_cmp(&off(*y)));
            let max_off = MAX_OFF_CORNER * MAX_OFF_CORNER * squares[0].min(squares[1]);
            found.extend(opposite.filter(|&k| off(k) < max_off).map(|k| [first, a, k, b]));
        }
    }
    found
}

/// A lattice seen in perspective.
#[derive(Clone, Debug)]
pub struct SeenLattice {
    /// For each spot, the number of steps from the first spot along the two axes of the lattice; `None` if it lies on
    /// no site.
    pub steps: Vec<Option<DVec2>>,
    /// Maps lattice steps to the centres of the spots in the image.
    pub to_image: Homography,
    /// Sum of the squared distances between spots and sites, in lattice steps.
    off: f64,
}

impl SeenLattice {
    /// Finds the lattice that holds most of the spots; `None` if no lattice does. Only the first [`MAX_SPOTS`] spots
    /// count, so the caller puts the most certain ones first.
    pub fn find(spots: &[Spot]) -> Option<Self> {
        let spots = &spots[..spots.len().min(MAX_SPOTS)];
        if spots.len() < MIN_SITES {
            return None;
        }
        let mut best: Option<Self> = None;
        for cell in (0..spots.len()).flat_map(|first| cells(spots, first)) {
            let Some(grown) = Self::from_cell(spots, cell) else { continue };
            if best.as_ref().is_none_or(|best| grown.is_better_than(best)) {
                best = Some(grown);
            }
            if best.as_ref().is_some_and(|best| best.count() == spots.len()) {
                break;
            }
        }
        best.filter(Self::is_plausible)
    }

    /// Grows the lattice from the four spots of one cell until no further spot lies on a site beside it.
    fn from_cell(spots: &[Spot], cell: [usize; 4]) -> Option<Self> {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
        let to_image = Homography::from_corners(corners, cell.map(|k| spots[k].centre)).ok()?;
        let mut growth = Self { steps: vec![None; spots.len()], to_image, off: 0.0 };
        cell.iter().zip(corners).for_each(|(&k, corner)| growth.steps[k] = Some(corner));
        // Each round adds a spot or ends the growth.
        for _ in 0..spots.len() {
            let before = growth.count();
            growth.add_neighbours(spots);
            if growth.count() == before {
                break;
            }
            growth.to_image = growth.fitted(spots)?;
            growth.drop_off_site(spots);
        }
        (growth.count() > 4).then_some(growth)
    }

    pub fn count(&self) -> usize {
        self.steps.iter().flatten().count()
    }

    /// Returns the coordinates of a point of the image in lattice steps; `None` if the horizon of the plane separates
    /// it from the first cell.
    fn place(&self, point: DVec2) -> Option<DVec2> {
        let to_steps = self.to_image.inverse();
        let [here, first] = [point, self.to_image.apply(DVec2::ZERO)].map(|at| to_steps.apply_homogeneous(at));
        (here.z * first.z > 0.0).then(|| here.truncate() / here.z).filter(|place| place.is_finite())
    }

    /// Returns the free site, beside an occupied one, on which a point of the image lies.
    pub fn free_site(&self, point: DVec2) -> Option<DVec2> {
        let place = self.place(point)?;
        let site = place.round();
        let occupied = || self.steps.iter().flatten();
        let is_beside = occupied().any(|other| (*other - site).abs().max_element() <= 1.0);
        let is_free = occupied().all(|other| *other != site);
        (place.distance(site) <= MAX_OFF_SITE && is_beside && is_free).then_some(site)
    }

    /// Puts spots on the free sites beside the occupied ones. Of several spots on a site, the nearest one is taken.
    fn add_neighbours(&mut self, spots: &[Spot]) {
        let mut added: Vec<(usize, DVec2, f64)> = Vec::new();
        for (k, spot) in spots.iter().enumerate().filter(|(k, _)| self.steps[*k].is_none()) {
            let Some(site) = self.free_site(spot.centre) else { continue };
            let off = self.to_image.apply(site).distance_squared(spot.centre);
            match added.iter_mut().find(|(_, other, _)| *other == site) {
                Some(rival) if rival.2 > off => *rival = (k, site, off),
                Some(_) => {}
                None => added.push((k, site, off)),
            }
        }
        added.into_iter().for_each(|(k, site, _)| self.steps[k] = Some(site));
    }

    /// Fits the homography to the spots on sites by least squares. Multiplied by the third homogeneous coordinate, the
    /// equations are linear; weights, the former values of this coordinate, undo the multiplication.
    fn fitted(&self, spots: &[Spot]) -> Option<Homography> {
        let at: Vec<(DVec2, DVec2)> =
            self.steps.iter().zip(spots).filter_map(|(s, spot)| Some(((*s)?, spot.centre))).collect();
        // The origin of the steps is the first spot, which the camera sees, so the last entry of the matrix is not 0.
        let former = self.to_image.0 * self.to_image.0.z_axis.z.recip();
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

    /// Takes spots off the lattice that no longer lie on their sites.
    fn drop_off_site(&mut self, spots: &[Spot]) {
        self.off = 0.0;
        for (k, spot) in spots.iter().enumerate() {
            let Some(site) = self.steps[k] else { continue };
            match self.place(spot.centre).map(|place| place.distance(site)) {
                Some(off) if off <= MAX_OFF_SITE => self.off += off * off,
                _ => self.steps[k] = None,
            }
        }
    }

    fn is_better_than(&self, other: &Self) -> bool {
        let (count, others) = (self.count(), other.count());
        count > others || count == others && self.off < other.off
    }

    /// Whether enough spots lie on the lattice, and occupy enough of its sites.
    fn is_plausible(&self) -> bool {
        let sites = || self.steps.iter().flatten();
        let min = sites().fold(DVec2::INFINITY, |min, steps| min.min(*steps));
        let max = sites().fold(DVec2::NEG_INFINITY, |max, steps| max.max(*steps));
        let extent = max - min + 1.0;
        let count = self.count();
        count >= MIN_SITES
            && count as f64 >= MIN_SHARE * self.steps.len() as f64
            && extent.x * extent.y <= MAX_SITES_PER_SPOT * count as f64
    }

    /// Area, in square pixels, of a cell of the lattice in the image, at a point given in lattice steps.
    pub fn cell_area(&self, at: DVec2) -> f64 {
        // A homography multiplies areas by its determinant over the cube of the third homogeneous coordinate.
        (self.to_image.0.determinant() / maths::powi(self.to_image.apply_homogeneous(at).z, 3)).abs()
    }
}
