//! The features of a pixel by which patches are compared: colour, and metadata. The metadata are the confidence that
//! the pixel is light, and its x and y distance to the nearest light ("Lighting Style Transfer", §6).

use crate::emission::exemplar::working::Working;
use crate::image::Image;
use glam::{Vec3, Vec4};

/// The features of a pixel: one vector for the colour, one for the metadata; their last channel is 0. Each channel is
/// multiplied by the square root of its weight. The sum of the squared differences between two features is then the
/// weighted error.
pub type Feature = [Vec4; 2];

/// Colour and metadata (confidence, x and y distance to the nearest light) of the exemplar, and the settings of the
/// comparison.
pub struct Guide<'a> {
    pub working: &'a Working,
    pub metadata: &'a Image,
    pub guide_weight: f32,
    /// `cap`: the metadata contain distances divided by `cap`, clamped to [-1, 1]. `lamp`: mean area of a lamp. Both
    /// are in working pixels, the pixels at the reduced size of the synthesis.
    pub cap: f64,
    pub lamp: f64,
    /// Number of candidate shifts per patch if there is no lattice.
    pub candidates: usize,
}

impl Guide<'_> {
    /// The features of each pixel of the exemplar.
    pub fn features(&self) -> Vec<Feature> {
        let (colour, metadata) = self.scales();
        let pixels = self.working.colour.data.chunks_exact(3).zip(self.metadata.data.chunks_exact(3));
        pixels
            .map(|(c, m)| [Vec3::from_slice(c).extend(0.0) * colour, Vec3::from_slice(m).extend(0.0) * metadata])
            .collect()
    }

    /// The factors of the colour channels and of the metadata channels (confidence, distances) in a feature.
    fn scales(&self) -> (f32, f32) {
        ((1.0f32 / 3.0).sqrt(), self.guide_weight.sqrt())
    }

    /// The period of each metadata channel (confidence, x and y distance to the nearest light) of a feature. Values
    /// that differ by a period are equivalent: at the distances `cap` and -`cap` alike, no light is near. The
    /// confidence is not periodic, so its period is infinite.
    pub fn channel_periods(&self) -> Vec4 {
        let period = 2.0 * self.scales().1;
        Vec4::new(f32::INFINITY, period, period, f32::INFINITY)
    }
}

/// Sum of squared differences between the features of two rows of pixels, over pixels and channels. With the periods of
/// the metadata channels ([`Guide::channel_periods`]), a difference d counts as the smaller of |d| and period - |d|.
pub fn squares(a: &[Feature], b: &[Feature], channel_periods: Vec4) -> f32 {
    let add = |[colour, metadata]: [Vec4; 2], a: &Feature, b: &Feature| {
        let (off, apart) = (a[0] - b[0], (a[1] - b[1]).abs());
        let apart = apart.min(channel_periods - apart);
        [colour + off * off, metadata + apart * apart]
    };
    // Sum even and odd pixels separately, so that the CPU can execute two independent chains of additions in parallel.
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
