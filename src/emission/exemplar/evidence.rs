//! Lamps as evidence: where they are and how large, each weighed by the photo pixels that show it.

use super::components::Component;
use super::foreshortening::LocalMap;
use crate::geometry::Homography;
use glam::DVec2;

/// Relative difference of both sides up to which two lamps are alike, and the photo pixels that blur may add to each.
/// [judged on 20 photos]
const LIKE: f64 = 0.33;
const BLUR: f64 = 2.5;

/// A lamp of the exemplar as evidence.
#[derive(Clone, Copy, Debug)]
pub struct Evidence {
    pub component: usize,
    pub centre: DVec2,
    pub size: DVec2,
    /// Pixels of the photo that show it.
    pub weight: f64,
    /// Unwarped pixels along x and y by which a photo pixel of blur moves its edges.
    pub blur: DVec2,
}

impl Evidence {
    pub fn new(component: usize, lamp: &Component, weight: f64, to_photo: Option<Homography>) -> Self {
        let size = DVec2::new(lamp.size()[0] as f64, lamp.size()[1] as f64);
        let blur = LocalMap::new(to_photo, lamp.centre).photo_pixel();
        Self { component, centre: lamp.centre, size, weight, blur }
    }

    /// Groups of lamps that are alike but for blur, around the lamp that the photo shows best.
    pub fn kinds(lamps: &[Self]) -> Vec<Vec<Self>> {
        let mut kinds: Vec<Vec<Self>> = Vec::new();
        for lamp in lamps {
            match kinds.iter_mut().find(|kind| kind[0].is_like(lamp)) {
                Some(kind) => kind.push(*lamp),
                None => kinds.push(vec![*lamp]),
            }
        }
        kinds
    }

    /// Whether two lamps may be of one size, seen through their blur.
    pub fn is_like(&self, other: &Self) -> bool {
        let slack = self.size.max(other.size) * LIKE + (self.blur + other.blur) * BLUR;
        (self.size - other.size).abs().cmple(slack).all()
    }
}
