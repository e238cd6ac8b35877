//! What patches are compared by: colour and metadata, each with its weight ("Lighting Style Transfer", §6).

use crate::emission::exemplar::working::Working;
use crate::image::Image;
use glam::{Vec3, Vec4};

/// What is compared of a pixel, colour and metadata: scaled by the roots of their weights, so that squares add up as
/// they are.
pub type Feature = [Vec4; 2];

/// Colour and metadata of the exemplar, their weights, and how many patches are compared by them.
pub struct Guide<'a> {
    pub working: &'a Working,
    pub metadata: &'a Image,
    pub metadata_weight: f32,
    /// Distance to a lamp that the metadata give as 1, and the mean area of a lamp, in working pixels.
    pub cap: f64,
    pub lamp: f64,
    /// Per patch where any shift is allowed.
    pub candidates: usize,
}

impl Guide<'_> {
    pub fn features(&self) -> Vec<Feature> {
        let (colour, metadata) = self.scales();
        let pixels = self.working.colour.data.chunks_exact(3).zip(self.metadata.data.chunks_exact(3));
        pixels
            .map(|(c, m)| [Vec3::from_slice(c).extend(0.0) * colour, Vec3::from_slice(m).extend(0.0) * metadata])
            .collect()
    }

    /// Of colours and of metadata.
    fn scales(&self) -> (f32, f32) {
        ((1.0f32 / 3.0).sqrt(), self.metadata_weight.sqrt())
    }

    /// After which difference each channel of the metadata is the same again. Distances wrap: one cap to the left of a
    /// lamp is as far as one cap to its right.
    pub fn turns(&self) -> Vec4 {
        let turn = 2.0 * self.scales().1;
        Vec4::new(f32::INFINITY, turn, turn, f32::INFINITY)
    }
}

/// Sum over two rows of pixels of the squared differences of their channels; metadata come again after `turns`.
pub fn squares(a: &[Feature], b: &[Feature], turns: Vec4) -> f32 {
    let add = |[colour, metadata]: [Vec4; 2], a: &Feature, b: &Feature| {
        let (off, apart) = (a[0] - b[0], (a[1] - b[1]).abs());
        let apart = apart.min(turns - apart);
        [colour + off * off, metadata + apart * apart]
    };
    // Two pixels at once, for chains of additions that run side by side.
    let (mut even, mut odd) = ([Vec4::ZERO; 2], [Vec4::ZERO; 2]);
    let (a, b) = (a.chunks_exact(2), b.chunks_exact(2));
    if let ([a], [b]) = (a.remainder(), b.remainder()) {
        even = add(even, a, b);
    }
    for (a, b) in a.zip(b) {
        even = add(even, &a[0], &b[0]);
        odd = add(odd, &a[1], &b[1]);
    }
    ((even[0] + odd[0]) + (even[1] + odd[1])).element_sum()
}
