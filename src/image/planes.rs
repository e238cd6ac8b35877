//! Converts between interleaved pixels and one plane per channel. Blocks of four pixels and four channels are
//! transposed in registers.

use glam::{Mat4, Vec4};

/// Splits interleaved pixels into planes, one per channel. `N` is the capacity of a plane in pixels; there may be
/// fewer pixels, but not more.
#[inline(always)]
pub fn deinterleave<const N: usize>(pixels: &[f32], planes: &mut [[f32; N]]) {
    let (channels, count) = (planes.len(), pixels.len() / planes.len());
    let whole = if channels < 4 { 0 } else { count / 4 * 4 };
    for (quad, k) in pixels.chunks_exact(4 * channels).zip((0..whole).step_by(4)) {
        for c in starts(channels) {
            let rows = [0, 1, 2, 3].map(|i| Vec4::from_slice(&quad[i * channels + c..][..4]));
            let columns = Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
            for i in 0..4 {
                columns.col(i).write_to_slice(&mut planes[c + i][k..k + 4]);
            }
        }
    }
    for (k, pixel) in pixels.chunks_exact(channels).enumerate().skip(whole) {
        planes.iter_mut().zip(pixel).for_each(|(plane, &v)| plane[k] = v);
    }
}

/// Like [`deinterleave`], but for a constant number of channels, at least four, so that offsets are compile-time
/// constants. The function `of(channel, values)` converts four values of a channel at a time.
#[inline(always)]
pub fn deinterleave_of<const C: usize, const N: usize>(
    pixels: &[f32],
    planes: &mut [[f32; N]; C],
    of: impl Fn(usize, Vec4) -> Vec4,
) {
    let (whole, rest) = pixels.as_chunks::<C>();
    let (quads, last) = whole.as_chunks::<4>();
    for (k, quad) in quads.iter().enumerate().take(N / 4) {
        for c in starts(C) {
            let [a, b, d, e] = quad.each_ref().map(|pixel| Vec4::from_slice(&pixel[c..c + 4]));
            let columns = Mat4::from_cols(a, b, d, e).transpose();
            for i in 0..4 {
                of(c + i, columns.col(i)).write_to_slice(&mut planes[c + i][4 * k..4 * k + 4]);
            }
        }
    }
    debug_assert!(rest.is_empty());
    for (k, pixel) in last.iter().enumerate() {
        for (c, plane) in planes.iter_mut().enumerate() {
            plane[4 * quads.len() + k] = of(c, Vec4::splat(pixel[c])).x;
        }
    }
}

/// Interleaves planes, one per channel, into pixels.
#[inline(always)]
pub fn interleave<const N: usize>(planes: &[[f32; N]], pixels: &mut [f32]) {
    let (channels, count) = (planes.len(), pixels.len() / planes.len());
    let whole = if channels < 4 { 0 } else { count / 4 * 4 };
    for (quad, k) in pixels.chunks_exact_mut(4 * channels).zip((0..whole).step_by(4)) {
        for c in starts(channels) {
            let columns = [0, 1, 2, 3].map(|i| Vec4::from_slice(&planes[c + i][k..k + 4]));
            let rows = Mat4::from_cols(columns[0], columns[1], columns[2], columns[3]).transpose();
            for i in 0..4 {
                rows.col(i).write_to_slice(&mut quad[i * channels + c..][..4]);
            }
        }
    }
    for (k, pixel) in pixels.chunks_exact_mut(channels).enumerate().skip(whole) {
        pixel.iter_mut().zip(planes).for_each(|(v, plane)| *v = plane[k]);
    }
}

/// Iterates over the first channel of each group of four. The last group may overlap the group before it.
#[inline(always)]
fn starts(channels: usize) -> impl Iterator<Item = usize> {
    (0..channels).step_by(4).map(move |c| c.min(channels - 4))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_hold_the_channels_and_come_back() {
        for channels in 1..=11 {
            for count in [0, 1, 3, 4, 7, 64] {
                let pixels: Vec<f32> = (0..channels * count).map(|i| i as f32).collect();
                let mut planes = vec![[-1.0; 64]; channels];
                deinterleave(&pixels, &mut planes);
                for (c, plane) in planes.iter().enumerate() {
                    assert!((0..64).all(|k| plane[k] == if k < count { (k * channels + c) as f32 } else { -1.0 }));
                }
                if channels == 10 {
                    let mut constant = [[-1.0; 64]; 10];
                    deinterleave_of(&pixels, &mut constant, |_, v| v);
                    assert_eq!(constant.as_slice(), planes);
                }
                let mut back = vec![0.0; pixels.len()];
                interleave(&planes, &mut back);
                assert_eq!(back, pixels);
            }
        }
    }
}
