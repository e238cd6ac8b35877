//! Lamps as evidence: where they are and how large, each weighed by the photo pixels that show it.

use super::components::Component;
use super::foreshortening::LocalMap;
use crate::geometry::Homography;
use glam::DVec2;

/// Largest relative difference, in each of both sides, of two lamps that are alike. [judged on 20 photos]
const LIKE: f64 = 0.2;
/// Pixels of the photo by which a side may be measured wrongly, and by which bloom may lengthen a side. They are more
/// unwarped pixels where the photo is magnified more. [judged on 20 photos]
const NOISE: f64 = 0.5;
const BLOOM: f64 = 10.0;
/// The same two limits for lamps that only may be alike: another fact, such as a place on a lattice, must confirm them.
/// [judged on 20 photos]
const MAYBE_LIKE: f64 = 0.33;
const MAYBE_BLUR: f64 = 2.5;

/// A lamp of the exemplar as evidence.
#[derive(Clone, Copy, Debug)]
pub struct Evidence {
    pub component: usize,
    pub centre: DVec2,
    pub size: DVec2,
    /// Number of photo pixels that show the lamp.
    pub weight: f64,
    /// Unwarped pixels along x and y by which one photo pixel of blur moves the lamp's edges.
    pub blur: DVec2,
}

impl Evidence {
    pub fn new(component: usize, lamp: &Component, weight: f64, to_photo: Option<Homography>) -> Self {
        let size = DVec2::new(lamp.size()[0] as f64, lamp.size()[1] as f64);
        let blur = LocalMap::new(to_photo, lamp.centre).photo_pixel();
        Self { component, centre: lamp.centre, size, weight, blur }
    }

    /// Groups lamps that are alike but for blur. In each group the lamps that the photo shows best come first.
    pub fn kinds(lamps: &[Self]) -> Vec<Vec<Self>> {
        // Go from little blur to much, so that each lamp is compared with lamps of similar blur.
        let mut order = lamps.to_vec();
        order.sort_by(|a, b| a.blur.length().total_cmp(&b.blur.length()));
        let mut kinds: Vec<Vec<Self>> = Vec::new();
        for lamp in order {
            let nearest = kinds.iter_mut().filter_map(|kind| {
                let last = *kind.last()?;
                lamp.is_like(&last).then(|| ((lamp.size - last.size).length(), kind))
            });
            match nearest.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((_, kind)) => kind.push(lamp),
                None => kinds.push(vec![lamp]),
            }
        }
        kinds.iter_mut().for_each(|kind| kind.sort_by(|a, b| b.weight.total_cmp(&a.weight)));
        kinds
    }

    /// Whether two lamps may have the same size, considering their blur.
    pub fn is_like(&self, other: &Self) -> bool {
        let blur = (self.blur + other.blur) * NOISE / 2.0 + (self.blur - other.blur).abs() * BLOOM;
        let slack = self.size.max(other.size) * LIKE + blur;
        (self.size - other.size).abs().cmple(slack).all()
    }

    /// Whether two lamps may have the same size, if they lie at the same place of a lattice.
    pub fn may_be_like(&self, other: &Self) -> bool {
        let slack = self.size.max(other.size) * MAYBE_LIKE + (self.blur + other.blur) * MAYBE_BLUR;
        (self.size - other.size).abs().cmple(slack).all()
    }
}
