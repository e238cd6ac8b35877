//! The pixel features by which patches are compared: weighted colour and metadata (confidence, x and y distance to the
//! nearest light; "Lighting Style Transfer", §6).

use crate::emission::exemplar::working::Working;
use crate::image::Image;
use glam::{Vec3, Vec4};

/// The features of a pixel: colour and metadata (confidence, distances), scaled by the square roots of their weights,
/// so that the squared differences of features add up to the weighted error.
pub type Feature = [Vec4; 2];

/// Colour and metadata (confidence, x and y distance to the nearest light) of the exemplar, and the settings of the
/// comparison.
pub struct Guide<'a> {
    pub working: &'a Working,
    pub metadata: &'a Image,
    pub metadata_weight: f32,
    /// `cap`: distance to a light at which the x and y distances in the metadata saturate at 1. `lamp`: mean area of a
    /// lamp. Both in pixels at the reduced size of the synthesis.
    pub cap: f64,
    pub lamp: f64,
    /// Number of candidate shifts per patch if there is no lattice.
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

    /// The factors of the colour channels and of the metadata channels (confidence, distances) in a feature.
    fn scales(&self) -> (f32, f32) {
        ((1.0f32 / 3.0).sqrt(), self.metadata_weight.sqrt())
    }

    /// The period of each metadata channel (confidence, x and y distance to the nearest light); infinite for the
    /// confidence. Values that differ by a period are equivalent: a distance of `cap` to the left of a light means the
    /// same as a distance of `cap` to its right.
    pub fn turns(&self) -> Vec4 {
        let turn = 2.0 * self.scales().1;
        Vec4::new(f32::INFINITY, turn, turn, f32::INFINITY)
    }
}

/// Sum of squared differences between two rows of pixels, over colour and metadata (confidence, x and y distance to
/// the nearest light). Metadata channels are periodic, with the periods `turns`.
pub fn squares(a: &[Feature], b: &[Feature], turns: Vec4) -> f32 {
    let add = |[colour, metadata]: [Vec4; 2], a: &Feature, b: &Feature| {
        let (off, apart) = (a[0] - b[0], (a[1] - b[1]).abs());
        let apart = apart.min(turns - apart);
        [colour + off * off, metadata + apart * apart]
    };
    // Add two pixels at once, so that two independent chains of additions run in parallel.
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
