//! Lamps as evidence for a lattice: their position and size, weighted by the number of photo pixels that show them.

use super::components::Component;
use super::foreshortening::LocalMap;
use crate::geometry::Homography;
use glam::DVec2;

/// Two lamps are of one kind if each side differs by at most this share, in addition to measurement error and bloom.
/// [judged on 20 photos]
const LIKE: f64 = 0.2;
/// Measurement error of a side (`NOISE`) and lengthening of a side by bloom (`BLOOM`), both in photo pixels. Where the
/// photo is magnified more, a photo pixel spans more unwarped pixels. [judged on 20 photos]
const NOISE: f64 = 0.5;
const BLOOM: f64 = 10.0;
/// Lamps are possibly of one kind if their sides differ by at most the share `MAYBE_LIKE` and, for each of the two
/// lamps, `MAYBE_BLUR` photo pixels of measurement error. Other evidence, such as their position on a lattice, must
/// confirm it. [judged on 20 photos]
const MAYBE_LIKE: f64 = 0.33;
const MAYBE_BLUR: f64 = 2.5;

/// A lamp of the exemplar as evidence: index of its component, position and size in unwarped pixels.
#[derive(Clone, Copy, Debug)]
pub struct Evidence {
    pub component: usize,
    pub centre: DVec2,
    pub size: DVec2,
    /// Number of photo pixels that show the lamp.
    pub weight: f64,
    /// Blur of the lamp's edges along x and y: one photo pixel, measured across the edge in unwarped pixels.
    pub blur: DVec2,
}

impl Evidence {
    pub fn new(component: usize, lamp: &Component, weight: f64, to_photo: Option<Homography>) -> Self {
        let size = DVec2::new(lamp.size()[0] as f64, lamp.size()[1] as f64);
        let blur = LocalMap::new(to_photo, lamp.centre).photo_pixel();
        Self { component, centre: lamp.centre, size, weight, blur }
    }

    /// Groups lamps that have equal sizes apart from blur. Within a group, the lamps with most photo pixels come
    /// first.
    pub fn kinds(lamps: &[Self]) -> Vec<Vec<Self>> {
        // Process lamps in the order of increasing blur, so that each lamp is compared with lamps of similar blur.
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

    /// Whether two lamps may have equal sizes, considering their blur.
    pub fn is_like(&self, other: &Self) -> bool {
        let blur = (self.blur + other.blur) * NOISE / 2.0 + (self.blur - other.blur).abs() * BLOOM;
        let slack = self.size.max(other.size) * LIKE + blur;
        (self.size - other.size).abs().cmple(slack).all()
    }

    /// Whether two lamps may have equal sizes, with the wider tolerance for lamps at one site of a lattice.
    pub fn may_be_like(&self, other: &Self) -> bool {
        let slack = self.size.max(other.size) * MAYBE_LIKE + (self.blur + other.blur) * MAYBE_BLUR;
        (self.size - other.size).abs().cmple(slack).all()
    }
}
