//! What the lamps of a photo tell about the tilt of their plane: they are alike, and most of them may lie on a lattice.

use super::lattice::Lattice;
use super::likeness::{self, Shape};
use super::tilt::Tilt;
use crate::error::Result;
use crate::geometry::lattice::{MAX_SPOTS, Spot};
use crate::geometry::{Perspective, Radial};
use crate::image::Image;
use crate::image::regions::{Moments, Regions};
use crate::maths;
use glam::DVec2;

/// Regions with fewer pixels than this are ignored, because the pixel grid dominates their form. [bench photos:tune]
const MIN_PIXELS: f64 = 12.0;
/// Shapes with fewer pixels than this do not overrule certain lines, because blur and bloom make small lamps round at
/// every tilt. [bench photos:tune, photos:real]
const MIN_CERTAIN_PIXELS: f64 = 100.0;
/// `LATTICE_FOCALS`: number of focal lengths on either side of the expected focal length for which the tilt of a
/// lattice is tried. `LATTICE_FOCAL_STEP`: logarithm of the ratio between neighbouring focal lengths. [convention]
const LATTICE_FOCALS: i32 = 10;
const LATTICE_FOCAL_STEP: f64 = 0.1;

/// The lamps of a mask.
pub struct Evidence {
    /// The largest lamps.
    pub shapes: Vec<Shape>,
    pub lattice: Option<Lattice>,
    /// Factor of the cost of the shapes, at most 1.
    shape_weight: f64,
}

impl Evidence {
    /// The lamps that the regions of a mask show. Regions that touch the border of the photo or have fewer than
    /// [`MIN_PIXELS`] pixels are left out, and shapes of fewer than [`MIN_CERTAIN_PIXELS`] if they must overrule
    /// certain lines (`over_lines`).
    pub fn of_mask(mask: &Image, camera: &Perspective, over_lines: bool) -> Result<Self> {
        let mut whole = Regions::of(mask)?.moments([mask.width, mask.height])?;
        whole.retain(|region| !region.is_cut && region.area >= MIN_PIXELS);
        whole.sort_by(|a, b| b.area.total_cmp(&a.area));
        whole.truncate(MAX_SPOTS);
        let lens = Radial { centre: DVec2::ZERO, bend: camera.bend };
        let bloom_unit = likeness::BLOOM_UNIT * mask.width.max(mask.height) as f64;
        let centre = |region: &Moments| region.centre - camera.principal;
        let shape = |region: &Moments| Shape::new(centre(region), region.covariance, &lens, bloom_unit);
        let spot = |region: &Moments| Spot { centre: lens.ideal(centre(region)), inverse: region.covariance.inverse() };
        let min_pixels = if over_lines { MIN_CERTAIN_PIXELS } else { MIN_PIXELS };
        let large = whole.iter().filter(|region| region.area >= min_pixels);
        let shapes = large.take(likeness::MAX_SHAPES).map(shape).collect();
        let spots: Vec<Spot> = whole.iter().map(spot).collect();
        let lamps = Self { shapes, lattice: Lattice::find(&spots), shape_weight: 1.0 };
        Ok(Self { shape_weight: lamps.weight_of_shapes(camera.focal), ..lamps })
    }

    /// If there is a lattice, returns the weight with which the shapes cost one per shape at the tilt of the lattice
    /// that suits them best. Bloom and blur can make shapes deviate by more than their errors; they must not outweigh
    /// the lattice then.
    fn weight_of_shapes(&self, focal: f64) -> f64 {
        let costs = self.tilts(focal, false).map(|tilt| likeness::cost(&self.shapes, &tilt));
        let least = costs.fold(f64::INFINITY, f64::min);
        if least.is_finite() { (self.shapes.len() as f64 / least).min(1.0) } else { 1.0 }
    }

    /// The tilts that the lattice implies: for the expected focal length alone if it `is_known`, else for a wide range.
    /// Empty without a lattice.
    pub fn tilts(&self, expected: f64, is_known: bool) -> impl Iterator<Item = Tilt> {
        let range = if is_known { 0 } else { LATTICE_FOCALS };
        let focals = (-range..=range).map(move |k| expected * maths::exp(LATTICE_FOCAL_STEP * f64::from(k)));
        focals.filter_map(|focal| Some(self.lattice.as_ref()?.tilt(focal)))
    }

    /// Minus twice the logarithm of the likelihood of the lamps if their plane has this tilt.
    pub fn cost(&self, tilt: &Tilt) -> f64 {
        self.shape_weight * likeness::cost(&self.shapes, tilt) + self.lattice_cost(tilt)
    }

    /// Like [`Self::cost`], but faster and less exact.
    pub fn rough_cost(&self, tilt: &Tilt) -> f64 {
        self.shape_weight * likeness::rough_cost(&self.shapes, tilt) + self.lattice_cost(tilt)
    }

    fn lattice_cost(&self, tilt: &Tilt) -> f64 {
        self.lattice.as_ref().map_or(0.0, |lattice| lattice.cost(tilt))
    }
}
