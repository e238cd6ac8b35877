//! The lattice on which most lamps of a photo lie, and how well it fits a tilt of their plane.
//!
//! The centres of the lamps are the images of lattice sites under a homography, which shows the horizon of the plane.
//! Bloom and overexposure change the shapes of lamps, but hardly their centres.

use super::tilt::Tilt;
use crate::geometry::lattice::{SeenLattice, Spot, reduced};
use crate::geometry::{Homography, linear};
use crate::maths;
use glam::{DMat2, DVec2, DVec3};

/// Standard deviation of a lamp's centre: in photo pixels (`CENTRE_ERROR`), and in lattice steps (`SITE_ERROR`),
/// because ceilings are built with tolerances. [bench photos:tune]
const CENTRE_ERROR: f64 = 0.5;
const SITE_ERROR: f64 = 0.015;
/// Most lattices of lamps are symmetric. A lattice with a right angle between its shortest steps costs `(deviation /
/// ASYMMETRY)²`, where the deviation is the cosine of the angle. Lattices with equally long steps, and lattices of
/// which every second row is shifted by half a step, are rarer and cost `RARE_SYMMETRY_COST` more; lattices with both
/// symmetries cost only `HEXAGONAL_COST` more, because both hardly appear together by chance. No lattice costs more
/// than `MAX_ASYMMETRY_COST`. [bench photos:tune]
const ASYMMETRY: f64 = 0.03;
const RARE_SYMMETRY_COST: f64 = 4.0;
const HEXAGONAL_COST: f64 = 1.0;
const MAX_ASYMMETRY_COST: f64 = 8.0;

/// Degrees of freedom of a homography. [convention: exact]
const HOMOGRAPHY_FREEDOM: f64 = 8.0;

/// A lamp on a site of the lattice.
#[derive(Clone, Copy, Debug)]
struct Site {
    centre: DVec2,
    /// Number of steps from the first lamp along the two axes of the lattice.
    steps: DVec2,
    /// Variance of each coordinate of the centre, in square pixels.
    variance: f64,
}

/// Lamps on the sites of a lattice.
#[derive(Clone, Debug)]
pub struct Lattice {
    sites: Vec<Site>,
    /// Maps lattice steps to pixels relative to the principal point.
    to_photo: Homography,
}

impl Lattice {
    /// Finds the lattice that holds most of the lamps; `None` if no lattice does. The centres of `lamps` are relative
    /// to the principal point, in pixels of the photo that an ideal lens would take; the largest lamps must come first.
    pub fn find(lamps: &[Spot]) -> Option<Self> {
        let seen = SeenLattice::find(lamps)?;
        let sites = seen.steps.iter().zip(lamps).filter_map(|(steps, lamp)| {
            let steps = (*steps)?;
            let variance = maths::powi(CENTRE_ERROR, 2) + maths::powi(SITE_ERROR, 2) * seen.cell_area(steps);
            Some(Site { centre: lamp.centre, steps, variance })
        });
        Some(Self { sites: sites.collect(), to_photo: seen.to_image })
    }

    /// Number of lamps on the lattice.
    pub fn count(&self) -> usize {
        self.sites.len()
    }

    /// Returns the tilt of the plane for this focal length.
    pub fn tilt(&self, focal: f64) -> Tilt {
        // The plane's horizon is the image of the line at infinity. The ray (x / f, y / f, 1) to a point of the horizon
        // is perpendicular to the normal.
        let horizon = self.to_photo.0.inverse().transpose() * DVec3::Z;
        let normal = DVec3::new(horizon.x * focal, horizon.y * focal, horizon.z).normalize_or(DVec3::Z);
        let ahead = self.sites.iter().filter(|site| normal.dot((site.centre / focal).extend(1.0)) > 0.0).count();
        Tilt { normal: if 2 * ahead >= self.sites.len() { normal } else { -normal }, focal }
    }

    /// Returns how much the lamps deviate from a symmetric lattice if their plane has this tilt: minus twice the
    /// logarithm of the likelihood. Infinite if the camera sees a lamp beyond the plane's horizon or at too small an
    /// angle.
    pub fn cost(&self, tilt: &Tilt) -> f64 {
        self.fit(tilt).map_or(f64::INFINITY, |(steps, deviation)| deviation + Symmetry::nearest(steps).1)
    }

    /// Whether the lamps deviate from the lattice by no more than their errors if their plane has this tilt.
    pub fn is_exact(&self, tilt: &Tilt) -> bool {
        let freedom = 2.0 * self.sites.len() as f64 - HOMOGRAPHY_FREEDOM;
        self.fit(tilt).is_some_and(|(_, deviation)| deviation <= freedom)
    }

    /// The symmetry of the lattice if its plane has this tilt; `None` if it is not symmetric.
    pub fn symmetry(&self, tilt: &Tilt) -> Option<Symmetry> {
        self.fit(tilt).and_then(|(steps, _)| Symmetry::nearest(steps).0)
    }

    /// Fits the two steps of the lattice on the plane by weighted least squares. Returns them, and the sum of the
    /// squared deviations of the lamps divided by their variances.
    fn fit(&self, tilt: &Tilt) -> Option<([DVec2; 2], f64)> {
        let (mut gram, mut right) = ([[0.0; 6]; 6], [0.0; 6]);
        let mut placed = Vec::with_capacity(self.sites.len());
        for site in &self.sites {
            let (point, jacobian) = tilt.project(site.centre)?;
            let weight = (jacobian * jacobian.transpose() * site.variance).inverse();
            // The unknowns are the first lamp's place and the two steps, for x and then for y.
            let terms = [1.0, site.steps.x, site.steps.y];
            for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let factor = weight.col(column)[row];
                for (i, s) in terms.iter().enumerate() {
                    (0..3).for_each(|j| gram[3 * row + i][3 * column + j] += s * terms[j] * factor);
                    right[3 * row + i] += s * factor * point[column];
                }
            }
            placed.push((site.steps, point, weight));
        }
        let [ox, ax, bx, oy, ay, by] = linear::solve(gram, right)?;
        let (origin, a, b) = (DVec2::new(ox, oy), DVec2::new(ax, ay), DVec2::new(bx, by));
        let square = |(steps, point, weight): &(DVec2, DVec2, DMat2)| {
            let off = *point - origin - a * steps.x - b * steps.y;
            off.dot(*weight * off)
        };
        Some(([a, b], placed.iter().map(square).sum()))
    }
}

/// How a lattice is its own mirror image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// The two shortest steps are at a right angle.
    RightAngle,
    /// The two shortest steps are equally long, at an angle of 60 degrees.
    Hexagonal,
    /// The two shortest steps are equally long, or every second row is shifted by half a step.
    Other,
}

impl Symmetry {
    /// Returns the symmetry that a lattice with these steps has or nearly has, and the cost of the deviation from it.
    fn nearest(steps: [DVec2; 2]) -> (Option<Self>, f64) {
        let [a, b] = reduced(steps);
        let [short, long] = [a.length(), b.length()];
        let product = a.dot(b).abs();
        let square = |deviation: f64| maths::powi(deviation / ASYMMETRY, 2);
        let right_angle = square(product / (short * long));
        let [equal, shifted] = [long / short - 1.0, 1.0 - 2.0 * product / (short * short)].map(square);
        let symmetries = [
            (Some(Self::RightAngle), right_angle),
            (Some(Self::Hexagonal), equal + shifted + HEXAGONAL_COST),
            (Some(Self::Other), equal.min(shifted) + RARE_SYMMETRY_COST),
        ];
        let best = symmetries.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
        best.filter(|best| best.1 <= MAX_ASYMMETRY_COST).unwrap_or((None, MAX_ASYMMETRY_COST))
    }
}
