//! Furniture of the demonstration rooms. A piece with a front is built at the origin with the front towards +z, then
//! rotated and moved. Vases, bowls and plants are built in their places.

use super::Builder;
use super::shapes::{ball, cuboid, lathe, moved};
use crate::maths;
use crate::rng::Rng;
use crate::scene::Mesh;
use glam::{Vec2, Vec3};

/// Adds a box. (x, y, z) is the centre of its base, and `size` is its extent along x, y and z, in metres.
fn block(mesh: &mut Mesh, x: f32, y: f32, z: f32, size: [f32; 3]) {
    let half = Vec3::new(size[0] / 2.0, 0.0, size[2] / 2.0);
    let foot = Vec3::new(x, y, z);
    cuboid(mesh, foot - half, foot + half + Vec3::Y * size[1]);
}

/// Adds a dining table, 0.75 m high.
pub fn table(b: &mut Builder, at: Vec3, size: Vec2, wood: usize) {
    let mut mesh = Mesh::default();
    block(&mut mesh, 0.0, 0.71, 0.0, [size.x, 0.04, size.y]);
    let (x, z) = (size.x / 2.0 - 0.08, size.y / 2.0 - 0.08);
    for (sx, sz) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        block(&mut mesh, sx * x, 0.0, sz * z, [0.06, 0.71, 0.06]);
    }
    for s in [-1.0, 1.0] {
        block(&mut mesh, 0.0, 0.63, s * z, [2.0 * x, 0.08, 0.03]);
        block(&mut mesh, s * x, 0.63, 0.0, [0.03, 0.08, 2.0 * z]);
    }
    b.add("Table", wood, moved(mesh, 0.0, at));
}

/// Adds a wooden chair with a cushion. Before the rotation by `degrees`, its back is at -z.
pub fn chair(b: &mut Builder, at: Vec3, degrees: f32, wood: usize, cloth: usize) {
    let mut mesh = Mesh::default();
    block(&mut mesh, 0.0, 0.42, 0.0, [0.42, 0.03, 0.42]);
    for (x, z, height) in [(-0.18, 0.18, 0.42), (0.18, 0.18, 0.42), (-0.18, -0.18, 0.92), (0.18, -0.18, 0.92)] {
        block(&mut mesh, x, 0.0, z, [0.04, height, 0.04]);
    }
    for y in [0.56, 0.68, 0.80] {
        block(&mut mesh, 0.0, y, -0.18, [0.34, 0.07, 0.02]);
    }
    b.add("Chair", wood, moved(mesh, degrees, at));
    let mut cushion = Mesh::default();
    let profile = [(0.0, 0.45), (0.17, 0.45), (0.195, 0.465), (0.195, 0.48), (0.17, 0.50), (0.0, 0.505)];
    lathe(&mut cushion, Vec3::ZERO, &profile.map(Vec2::from), 32);
    b.add("Cushion", cloth, moved(cushion, degrees, at));
}

/// Adds an open shelf with books on every board. Before the rotation by `degrees`, its back is at z = 0. Each book
/// takes one of the materials `covers` at random.
pub fn bookshelf(b: &mut Builder, at: Vec3, degrees: f32, width: f32, wood: usize, covers: &[usize]) {
    /// Depth of the shelf and heights of its boards, in metres. [convention]
    const DEPTH: f32 = 0.30;
    const BOARDS: [f32; 5] = [0.06, 0.44, 0.82, 1.20, 1.58];
    let mut frame = Mesh::default();
    let half = width / 2.0;
    for x in [-half, half] {
        block(&mut frame, x, 0.0, DEPTH / 2.0, [0.025, 1.95, DEPTH]);
    }
    block(&mut frame, 0.0, 0.0, 0.01, [width, 1.95, 0.02]);
    for y in BOARDS.into_iter().chain([1.93]) {
        block(&mut frame, 0.0, y, DEPTH / 2.0, [width, 0.025, DEPTH]);
    }
    b.add("Shelf", wood, moved(frame, degrees, at));

    // Books of random width and height stand upright, with gaps between some of them.
    let mut books = vec![Mesh::default(); covers.len()];
    let mut rng = Rng::new(5, &[]);
    for y in BOARDS {
        let mut x = -half + 0.04;
        while x < half - 0.10 {
            let (thick, tall, deep) =
                (0.02 + 0.035 * rng.next_f32(), 0.19 + 0.1 * rng.next_f32(), 0.15 + 0.08 * rng.next_f32());
            if rng.next_f32() < 0.85 {
                let low = Vec3::new(x, y + 0.026, 0.03);
                cuboid(&mut books[rng.below(covers.len())], low, low + Vec3::new(thick, tall, deep));
            } else {
                x += 0.08;
            }
            x += thick + 0.002;
        }
    }
    for (mesh, &cover) in books.into_iter().zip(covers) {
        b.add("Books", cover, moved(mesh, degrees, at));
    }
}

/// Adds a low cupboard with doors. Before the rotation by `degrees`, its back is at z = 0.
pub fn sideboard(b: &mut Builder, at: Vec3, degrees: f32, width: f32, wood: usize, front: usize) {
    let mut body = Mesh::default();
    block(&mut body, 0.0, 0.12, 0.21, [width, 0.62, 0.42]);
    for (x, z) in [(-0.45, 0.05), (0.45, 0.05), (-0.45, 0.37), (0.45, 0.37)] {
        block(&mut body, x * width, 0.0, z, [0.04, 0.12, 0.04]);
    }
    b.add("Sideboard", wood, moved(body, degrees, at));
    let mut doors = Mesh::default();
    let mut knobs = Mesh::default();
    let step = width / 3.0;
    for i in 0..3 {
        let x = (i as f32 - 1.0) * step;
        block(&mut doors, x, 0.15, 0.425, [step - 0.02, 0.56, 0.02]);
        ball(&mut knobs, Vec3::new(x + 0.38 * step, 0.45, 0.45), Vec2::splat(0.015), 16);
    }
    b.add("Sideboard doors", front, moved(doors, degrees, at));
    b.add("Knobs", wood, moved(knobs, degrees, at));
}

pub fn vase(b: &mut Builder, foot: Vec3, scale: f32, glaze: usize) {
    let outline = [
        (0.0, 0.0),
        (0.05, 0.0),
        (0.055, 0.01),
        (0.085, 0.06),
        (0.10, 0.12),
        (0.09, 0.18),
        (0.06, 0.24),
        (0.038, 0.29),
        (0.036, 0.33),
        (0.05, 0.36),
        (0.046, 0.36),
        (0.030, 0.32),
    ];
    let mut mesh = Mesh::default();
    lathe(&mut mesh, foot, &outline.map(|p| Vec2::from(p) * scale), 48);
    b.add("Vase", glaze, mesh);
}

/// Adds a bowl with five fruits.
pub fn fruit_bowl(b: &mut Builder, foot: Vec3, glaze: usize, fruit: [usize; 2]) {
    let outline = [
        (0.0, 0.0),
        (0.06, 0.0),
        (0.06, 0.01),
        (0.11, 0.035),
        (0.145, 0.08),
        (0.14, 0.082),
        (0.10, 0.042),
        (0.0, 0.02),
    ];
    let mut bowl = Mesh::default();
    lathe(&mut bowl, foot, &outline.map(Vec2::from), 48);
    b.add("Bowl", glaze, bowl);
    for (k, material) in fruit.into_iter().enumerate() {
        let mut mesh = Mesh::default();
        for i in (k..5).step_by(2) {
            let (s, c) = maths::sin_cos(i as f32 * std::f32::consts::TAU / 5.0);
            ball(&mut mesh, foot + Vec3::new(0.06 * c, 0.075, 0.06 * s), Vec2::splat(0.036), 24);
        }
        b.add("Fruit", material, mesh);
    }
}

/// Adds a pot with a round leafy plant.
pub fn plant(b: &mut Builder, foot: Vec3, height: f32, pot: usize, leaves: usize) {
    let outline = [(0.0, 0.0), (0.13, 0.0), (0.17, 0.30), (0.18, 0.32), (0.165, 0.32), (0.15, 0.28), (0.0, 0.28)];
    let mut mesh = Mesh::default();
    lathe(&mut mesh, foot, &outline.map(Vec2::from), 40);
    b.add("Pot", pot, mesh);
    let mut crown = Mesh::default();
    let mut rng = Rng::new(6, &[]);
    for i in 0..60 {
        let (s, c) = maths::sin_cos(i as f32 * 2.399_963);
        let up = (i as f32 + 0.5) / 60.0;
        let radius = 0.05 + 0.25 * maths::sin(std::f32::consts::PI * up) * (0.6 + 0.4 * rng.next_f32());
        let centre = foot + Vec3::new(radius * c, 0.30 + (height - 0.4) * up, radius * s);
        ball(&mut crown, centre, Vec2::new(0.055, 0.03 + 0.03 * rng.next_f32()), 10);
    }
    b.add("Plant", leaves, crown);
}

/// Adds a desk with a screen. Before the rotation by `degrees`, its user sits at +z.
pub fn desk(b: &mut Builder, at: Vec3, degrees: f32, top: usize, dark: usize) {
    let mut board = Mesh::default();
    block(&mut board, 0.0, 0.72, 0.0, [1.6, 0.03, 0.8]);
    b.add("Desk", top, moved(board, degrees, at));
    let mut rest = Mesh::default();
    for x in [-0.72, 0.72] {
        block(&mut rest, x, 0.0, 0.0, [0.05, 0.72, 0.6]);
    }
    block(&mut rest, 0.0, 0.75, -0.2, [0.24, 0.015, 0.18]);
    block(&mut rest, 0.0, 0.76, -0.24, [0.04, 0.14, 0.03]);
    block(&mut rest, 0.0, 0.86, -0.22, [0.56, 0.34, 0.03]);
    b.add("Screen", dark, moved(rest, degrees, at));
}
