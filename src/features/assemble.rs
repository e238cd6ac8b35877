//! Assembles the feature channels of one row of pixels, as the last step of computing the features: colour, screen
//! depth, position by Eq. 1, and normal.

use super::depth::Surface;
use super::frustum::Frustum;
use super::input::CHANNELS;
use crate::image::{Image, colour, interleave};
use crate::simd::widest;
use glam::{Mat3, Vec2, Vec3};

/// Number of pixels processed together: their channel planes stay in the first-level cache.
const TILE: usize = 64;

/// One feature channel of the pixels of a tile.
type ChannelPlane = [f32; TILE];

/// Inputs of the geometric channels of a tile.
struct Geometry<'a> {
    inverse_depth: &'a [f32],
    /// Normals in camera space: three channels, interleaved.
    normals: &'a [f32],
    frustum: &'a Frustum,
    to_room: Mat3,
    /// Normalised device coordinates of the pixels.
    ndc: &'a [Vec2; TILE],
}

/// Computes all channels of row `y`; `to_room` rotates camera axes into room axes.
pub fn row(photo: &Image, surface: &Surface, frustum: &Frustum, to_room: Mat3, y: usize, out: &mut [f32]) {
    let (width, height) = (photo.width, photo.height);
    let mut planes = [[0.0; TILE]; CHANNELS];
    for (t, out) in out.chunks_mut(TILE * CHANNELS).enumerate() {
        let (x, n) = (t * TILE, out.len() / CHANNELS);
        let [r, g, b, ..] = &mut planes;
        spread(&photo.row(y)[x * photo.channels..][..n * photo.channels], photo.channels, [r, g, b]);
        colour::planes_to_lab(r, g, b);
        let (start, step) = (frustum.ndc(x, y, width, height), 2.0 / width as f32);
        let ndc = std::array::from_fn(|k| match frustum.lens.is_none() {
            true => Vec2::new(start.x + step * k as f32, start.y),
            false => frustum.ndc(x + k, y, width, height),
        });
        let geometry = Geometry {
            inverse_depth: &surface.inverse_depth.row(y)[x..x + n],
            normals: &surface.normals.row(y)[3 * x..3 * (x + n)],
            frustum,
            to_room,
            ndc: &ndc,
        };
        place(&geometry, &mut planes);
        join(&planes, out);
    }
}

/// Splits pixels into three colour planes; images with fewer than three channels repeat the first.
fn spread(pixels: &[f32], channels: usize, [r, g, b]: [&mut ChannelPlane; 3]) {
    if channels == 3 {
        for (k, p) in pixels.as_chunks::<3>().0.iter().enumerate().take(TILE) {
            (r[k], g[k], b[k]) = (p[0], p[1], p[2]);
        }
        return;
    }
    for (k, p) in pixels.chunks_exact(channels).enumerate() {
        (r[k], g[k], b[k]) = if channels < 3 { (p[0], p[0], p[0]) } else { (p[0], p[1], p[2]) };
    }
}

widest! {
    fn join(planes: &[ChannelPlane; CHANNELS], out: &mut [f32]) {
        interleave(planes, out);
    }
}

widest! {
    fn place(from: &Geometry, planes: &mut [ChannelPlane; CHANNELS]) {
        let [_, _, _, depth, px, py, pz, nx, ny, nz] = planes;
        let n = from.inverse_depth.len().min(TILE);
        let (inverse_depth, normals) = (&from.inverse_depth[..n], &from.normals[..3 * n]);
        for k in 0..n {
            let screen_depth = from.frustum.screen_depth(inverse_depth[k]);
            let ndc = from.ndc[k].extend(screen_depth);
            let position = from.to_room * from.frustum.unproject(ndc);
            let normal = from.to_room * Vec3::new(normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]);
            depth[k] = screen_depth;
            (px[k], py[k], pz[k]) = (position.x, position.y, position.z);
            (nx[k], ny[k], nz[k]) = (normal.x, normal.y, normal.z);
        }
    }
}
