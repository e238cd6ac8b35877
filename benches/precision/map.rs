//! Precision of the positions in the photo to which the texels of an unwarped plane map.

use super::real::Real;
use super::{Study, Way, timed};

/// Width and height of the photo, in pixels.
const SIDE: f64 = 16_384.0;
const TEXELS: usize = 1 << 16;

/// Homography from the unwarped plane to the photo, for a plane that is seen at a grazing angle.
const MAP: [[f64; 3]; 3] = [[1.9, 0.35, -900.0], [0.12, 2.3, 310.0], [4.1e-5, 9.7e-5, 1.0]];

fn map<R: Real>() -> Vec<[R; 2]> {
    let m = MAP.map(|row| row.map(R::of));
    let texel = |i: usize| {
        let (x, y) = (R::of((i * 7919 % 16_384) as f64 + 0.5), R::of((i * 104_729 % 16_384) as f64 + 0.5));
        let [u, v, w] = m.map(|[a, b, c]| a * x + b * y + c);
        let inverse = R::of(1.0) / w;
        [u * inverse, v * inverse]
    };
    (0..TEXELS).map(texel).collect()
}

pub fn measure(study: &mut Study) {
    let (narrow, wide) = (map::<f32>(), map::<f64>());
    let inside = |p: &[f64; 2]| p.iter().all(|c| (0.0..SIDE).contains(c));
    let off = |(n, w): (&[f32; 2], &[f64; 2])| (0..2).map(|i| (f64::from(n[i]) - w[i]).abs()).fold(0.0, f64::max);
    let error = narrow.iter().zip(&wide).filter(|(_, w)| inside(w)).map(off).fold(0.0, f64::max);
    study.add(
        "rectification: places in a photo of 16 k",
        "pixels, the largest",
        1,
        &mut [
            Way { name: "f32", bytes: 8, error, work: &mut timed(map::<f32>) },
            Way { name: "f64", bytes: 16, error: 0.0, work: &mut timed(map::<f64>) },
        ],
    );
}
