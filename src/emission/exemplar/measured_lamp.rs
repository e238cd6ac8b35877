//! Position and size of the lamps of an exemplar. They are evidence for a lattice and for kinds of lamps. The weight of
//! a lamp is the number of photo pixels that show it.

use super::components::Component;
use super::foreshortening::LocalMap;
use crate::geometry::PhotoMap;
use glam::DVec2;

/// Two lamps are of one kind if they differ along each axis by at most this share of the longer side, plus an allowance
/// for measurement error and bloom. [judged on 20 photos]
pub const MAX_SIDE_DIFFERENCE: f64 = 0.2;
/// Allowances when sides of two lamps are compared, in photo pixels. `NOISE`: measurement error of a side. `BLOOM`:
/// lengthening of a side by bloom. Bloom makes the sides differ in unwarped pixels only if unwarping magnifies the two
/// lamps differently. So `BLOOM` is multiplied by the difference between the lengths of a photo pixel at the two lamps.
/// [judged on 20 photos]
const NOISE: f64 = 0.5;
const BLOOM: f64 = 10.0;
/// As [`MAX_SIDE_DIFFERENCE`], but for two panes of a luminous ceiling: windows of two widths may lie side by side.
/// [bench photos:real]
pub const MAX_PANE_DIFFERENCE: f64 = 0.15;
/// A wider tolerance, for lamps that lie at one site of a lattice and are therefore probably of one kind.
/// `MAX_SITE_DIFFERENCE`: maximum difference of a side, as a share of the longer one. `SITE_NOISE`: measurement error
/// of each side, in photo pixels. [judged on 20 photos]
pub const MAX_SITE_DIFFERENCE: f64 = 0.33;
const SITE_NOISE: f64 = 2.5;

/// A lamp of the exemplar, as evidence for kinds of lamps and for a lattice. Position and size are in unwarped pixels.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredLamp {
    /// Index of the lamp's component in the exemplar.
    pub component: usize,
    pub centre: DVec2,
    pub size: DVec2,
    /// Number of photo pixels that show the lamp.
    pub weight: f64,
    /// Length of a photo pixel at the lamp, in unwarped pixels along x and along y. The lamp's edges are blurred by
    /// about this length.
    pub blur: DVec2,
}

impl MeasuredLamp {
    pub fn new(component: usize, lamp: &Component, weight: f64, to_photo: Option<PhotoMap>) -> Self {
        let size = DVec2::new(lamp.size()[0] as f64, lamp.size()[1] as f64);
        let blur = LocalMap::new(to_photo, lamp.centre).photo_pixel();
        Self { component, centre: lamp.centre, size, weight, blur }
    }

    /// Groups lamps of equal size: `is_like` decides whether two sizes are equal. The lamps of each group are returned
    /// in the order of decreasing weight.
    pub fn kinds(lamps: &[Self], is_like: fn(&Self, &Self) -> bool) -> Vec<Vec<Self>> {
        // Process lamps in the order of increasing blur, so that each lamp is compared with lamps of similar blur. A
        // lamp joins the group whose last lamp is nearest in size.
        let mut order = lamps.to_vec();
        order.sort_by(|a, b| a.blur.length().total_cmp(&b.blur.length()));
        let mut kinds: Vec<Vec<Self>> = Vec::new();
        for lamp in order {
            let nearest = kinds.iter_mut().filter_map(|kind| {
                let last = *kind.last()?;
                is_like(&lamp, &last).then(|| ((lamp.size - last.size).length(), kind))
            });
            match nearest.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((_, kind)) => kind.push(lamp),
                None => kinds.push(vec![lamp]),
            }
        }
        kinds.iter_mut().for_each(|kind| kind.sort_by(|a, b| b.weight.total_cmp(&a.weight)));
        kinds
    }

    /// Whether two lamps may have equal sizes: each side differs by at most the share [`MAX_SIDE_DIFFERENCE`], plus an
    /// allowance for measurement error and for bloom.
    pub fn is_like(&self, other: &Self) -> bool {
        self.is_within(MAX_SIDE_DIFFERENCE, other)
    }

    /// Like [`Self::is_like`], but for panes of a luminous ceiling ([`MAX_PANE_DIFFERENCE`]).
    pub fn is_like_pane(&self, other: &Self) -> bool {
        self.is_within(MAX_PANE_DIFFERENCE, other)
    }

    fn is_within(&self, share: f64, other: &Self) -> bool {
        let blur = (self.blur + other.blur) * NOISE / 2.0 + (self.blur - other.blur).abs() * BLOOM;
        let slack = self.size.max(other.size) * share + blur;
        (self.size - other.size).abs().cmple(slack).all()
    }

    /// Like [`Self::is_like`], but without the allowance for bloom.
    pub fn is_as_large(&self, other: &Self) -> bool {
        let slack = self.size.max(other.size) * MAX_SIDE_DIFFERENCE + (self.blur + other.blur) * NOISE / 2.0;
        (self.size - other.size).abs().cmple(slack).all()
    }

    /// Whether two lamps may have equal sizes, with the wider tolerance for lamps at one site of a lattice.
    pub fn may_be_like(&self, other: &Self) -> bool {
        let slack = self.size.max(other.size) * MAX_SITE_DIFFERENCE + (self.blur + other.blur) * SITE_NOISE;
        (self.size - other.size).abs().cmple(slack).all()
    }
}
