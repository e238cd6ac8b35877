//! Procedural textures of linear reflectance for the demonstration rooms. All of them, except [`painting`], tile
//! without seams.

use crate::error::Result;
use crate::image::Image;
use crate::rng::Rng;
use glam::{Vec2, Vec3};

/// Side of a texture in pixels.
const SIDE: usize = 256;

/// Returns smooth noise in `[0, 1]` that repeats every `period` cells (value noise on a lattice of unit cells).
pub(super) fn noise(at: Vec2, period: [u64; 2], seed: u64) -> f32 {
    let cell = at.floor();
    let t = at - cell;
    let t = t * t * (3.0 - 2.0 * t);
    let value = |dx: i64, dy: i64| {
        let x = (cell.x as i64 + dx).rem_euclid(period[0] as i64) as u64;
        let y = (cell.y as i64 + dy).rem_euclid(period[1] as i64) as u64;
        Rng::new(seed, &[x, y]).next_f32()
    };
    let top = value(0, 0) + (value(1, 0) - value(0, 0)) * t.x;
    let bottom = value(0, 1) + (value(1, 1) - value(0, 1)) * t.x;
    top + (bottom - top) * t.y
}

/// Returns the weighted sum of three octaves of noise at a point of the unit square. The first octave has `cells`
/// lattice cells along each side.
fn cloud(at: Vec2, cells: u64, seed: u64) -> f32 {
    let octave = |factor: u64| noise(at * (cells * factor) as f32, [cells * factor; 2], seed + factor);
    octave(1) * 0.5 + octave(2) * 0.3 + octave(4) * 0.2
}

/// Creates a texture from the function `reflectance`, which gives the colour at each point of the unit square.
fn paint(reflectance: impl Fn(Vec2) -> Vec3) -> Result<Image> {
    Image::from_fn(SIDE, SIDE, |x, y| {
        let at = (Vec2::new(x as f32, y as f32) + 0.5) / SIDE as f32;
        reflectance(at).clamp(Vec3::splat(0.02), Vec3::splat(0.92)).to_array()
    })
}

/// Wooden boards along u with individual tones: 8 boards across, with staggered ends.
pub fn planks() -> Result<Image> {
    paint(|at| {
        let board = (at.y * 8.0).floor();
        let shift = Rng::new(11, &[board as u64]).next_f32();
        let along = at.x + shift;
        let tone = 0.75 + 0.4 * Rng::new(12, &[board as u64, (along * 2.0).floor() as u64 % 2]).next_f32();
        let grain = noise(at * Vec2::new(6.0, 96.0), [6, 96], 13) * 0.6
            + noise(at * Vec2::new(24.0, 128.0), [24, 128], 14) * 0.4;
        let (edge, end) = ((at.y * 8.0).fract(), (along * 2.0).fract());
        let gap = if edge < 0.04 || end < 0.008 { 0.35 } else { 1.0 };
        Vec3::new(0.36, 0.20, 0.095) * tone * (0.75 + 0.5 * grain) * gap
    })
}

/// Fine wood without joints, whose grain runs along u.
pub fn wood(colour: Vec3) -> Result<Image> {
    paint(|at| {
        let ring =
            noise(at * Vec2::new(2.0, 16.0), [2, 16], 21) * 0.7 + noise(at * Vec2::new(8.0, 64.0), [8, 64], 22) * 0.3;
        colour * (0.7 + 0.6 * ring)
    })
}

/// Painted bricks in running bond, 4 along u and 8 along v.
pub fn bricks(colour: Vec3) -> Result<Image> {
    paint(|at| {
        let row = (at.y * 8.0).floor();
        let along = at.x * 4.0 + 0.5 * (row % 2.0);
        let joint = along.fract() < 0.045 || (at.y * 8.0).fract() < 0.09;
        let tone = 0.85 + 0.25 * Rng::new(31, &[row as u64, along.floor() as u64 % 4]).next_f32();
        let grain = 0.9 + 0.2 * cloud(at, 32, 32);
        if joint { colour * 0.55 * grain } else { colour * tone * grain }
    })
}

/// Plaster of nearly uniform colour, slightly cloudy.
pub fn plaster(colour: Vec3) -> Result<Image> {
    paint(|at| colour * (0.93 + 0.14 * cloud(at, 8, 41)))
}

/// Cloth woven from two yarns.
pub fn weave(warp: Vec3, weft: Vec3) -> Result<Image> {
    paint(|at| {
        let (x, y) = ((at.x * 32.0).floor() as i64, (at.y * 32.0).floor() as i64);
        let inside = (at * 32.0).fract() - 0.5;
        let over = (x + y) % 2 == 0;
        let round = if over { 1.0 - 1.2 * inside.y * inside.y } else { 1.0 - 1.2 * inside.x * inside.x };
        (if over { warp } else { weft }) * round * (0.85 + 0.3 * cloud(at, 16, 51))
    })
}

/// A rug with a border and diamonds inside.
pub fn rug() -> Result<Image> {
    paint(|at| {
        let rim = at.min(1.0 - at).min_element();
        let yarn = 0.85 + 0.3 * noise(at * 128.0, [128, 128], 61);
        let diamond = ((at - 0.5).abs() * 6.0).element_sum().rem_euclid(1.0);
        let colour = match () {
            () if rim < 0.03 => Vec3::new(0.65, 0.58, 0.45),
            () if rim < 0.09 => Vec3::new(0.10, 0.13, 0.25),
            () if diamond < 0.35 => Vec3::new(0.62, 0.52, 0.36),
            () => Vec3::new(0.16, 0.22, 0.40),
        };
        colour * yarn
    })
}

/// A painting of hills under an evening sky.
pub fn painting() -> Result<Image> {
    paint(|at| {
        let ridge = |height: f32, cells: u64, seed: u64| {
            at.y > height - 0.2 * noise(at * cells as f32 * Vec2::X, [cells, 1], seed)
        };
        let sun = (at - Vec2::new(0.68, 0.36)).length() < 0.09;
        match () {
            () if ridge(0.98, 7, 71) => Vec3::new(0.05, 0.16, 0.09),
            () if ridge(0.80, 5, 72) => Vec3::new(0.10, 0.26, 0.22),
            () if ridge(0.66, 4, 73) => Vec3::new(0.22, 0.30, 0.42),
            () if sun => Vec3::new(0.90, 0.72, 0.28),
            () => Vec3::new(0.30, 0.42, 0.68).lerp(Vec3::new(0.85, 0.50, 0.25), at.y * 1.5),
        }
    })
}

/// A mineral-fibre ceiling tile: white with small dark holes.
pub fn tile() -> Result<Image> {
    paint(|at| {
        let hole = noise(at * 96.0, [96, 96], 81) > 0.86;
        Vec3::splat(if hole { 0.55 } else { 0.80 + 0.04 * cloud(at, 16, 82) })
    })
}

/// Carpet tiles, two by two, whose stripes alternate in direction.
pub fn carpet(colour: Vec3) -> Result<Image> {
    paint(|at| {
        let turned = ((at * 2.0).floor().element_sum() as i64) % 2 == 0;
        let stripe = if turned { at.x } else { at.y };
        let pile = 0.8 + 0.4 * noise(at * 128.0, [128, 128], 91);
        colour * pile * if (stripe * 32.0).fract() < 0.5 { 0.9 } else { 1.1 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_reflectances_and_repeat_without_a_seam() {
        let image = plaster(Vec3::splat(0.8)).unwrap();
        assert!(image.data.iter().all(|v| (0.0..=0.95).contains(v)));
        let step = |a: usize, b: usize| {
            let sum: f32 = (0..SIDE).map(|y| (image.rgb(a, y) - image.rgb(b, y)).length()).sum();
            sum / SIDE as f32
        };
        let inside = (0..SIDE - 1).map(|x| step(x, x + 1)).sum::<f32>() / (SIDE - 1) as f32;
        assert!(step(SIDE - 1, 0) < 3.0 * inside);
    }
}
