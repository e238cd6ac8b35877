//! The target room, which is to be lit: 6 × 4 m, 2.8 m high, furnished, without lights.

use super::shapes::{ball, cuboid, mesh_of, moved, pierced, sheet};
use super::{Builder, furniture, pattern};
use crate::error::Result;
use crate::maths;
use crate::scene::{Camera, Mesh, Scene};
use glam::{Vec2, Vec3};

const SIZE: Vec3 = Vec3::new(6.0, 2.8, 4.0);
/// Side in metres of the cells into which walls, floor and ceiling are divided. [convention]
const CELL: f32 = 0.25;
/// Depth in metres of the door and window openings. [convention]
const REVEAL: f32 = 0.12;
/// Lower left and upper right corner (x, y), in metres, of the openings in the wall at z = 0.
const WINDOW: [Vec2; 2] = [Vec2::new(1.1, 0.95), Vec2::new(3.1, 2.25)];
const DOOR: [Vec2; 2] = [Vec2::new(4.3, 0.0), Vec2::new(5.2, 2.05)];

/// Builds a furnished living room without lights. Its first camera is named `Camera`, its ceiling `Ceiling`.
pub fn target_room() -> Result<Scene> {
    let mut b = Builder::default();
    shell(&mut b)?;
    openings(&mut b);
    furnish(&mut b)?;
    b.scene.cameras.push(Camera {
        name: "Camera".into(),
        ..Camera::look_at(Vec3::new(5.65, 1.55, 3.75), Vec3::new(2.2, 1.32, 1.15), 56f32.to_radians())
    });
    b.build()
}

/// Adds floor, ceiling and walls, all of which face inwards.
fn shell(b: &mut Builder) -> Result<()> {
    let Vec3 { x, y, z } = SIZE;
    let cells = |a: f32, b: f32| [(a / CELL).ceil() as u32, (b / CELL).ceil() as u32];
    let floor = b.pattern("Floor planks", pattern::planks()?, Vec2::splat(1.6), 0.45);
    b.add("Floor", floor, mesh_of(|m| sheet(m, Vec3::Z * z, Vec3::X * x, Vec3::NEG_Z * z, cells(x, z))));
    let white = b.paint("White plaster", Vec3::splat(0.82), 1.0);
    b.add("Ceiling", white, mesh_of(|m| sheet(m, Vec3::Y * y, Vec3::X * x, Vec3::Z * z, cells(x, z))));

    let bricks = b.pattern("White bricks", pattern::bricks(Vec3::new(0.72, 0.69, 0.64))?, Vec2::splat(0.9), 0.9);
    let front = mesh_of(|m| pierced(m, Vec3::ZERO, [Vec3::X, Vec3::Y], Vec2::new(x, y), &[WINDOW, DOOR], CELL));
    b.add("Front wall", bricks, front);
    let terracotta = b.pattern("Terracotta", pattern::plaster(Vec3::new(0.56, 0.13, 0.06))?, Vec2::splat(1.5), 0.95);
    b.add("Left wall", terracotta, mesh_of(|m| sheet(m, Vec3::Z * z, Vec3::NEG_Z * z, Vec3::Y * y, cells(z, y))));
    let cream = b.pattern("Cream plaster", pattern::plaster(Vec3::new(0.74, 0.68, 0.56))?, Vec2::splat(1.5), 0.95);
    b.add("Right wall", cream, mesh_of(|m| sheet(m, Vec3::X * x, Vec3::Z * z, Vec3::Y * y, cells(z, y))));
    let back = Vec3::new(x, 0.0, z);
    b.add("Back wall", cream, mesh_of(|m| sheet(m, back, Vec3::NEG_X * x, Vec3::Y * y, cells(x, y))));

    let lacquer = b.paint("White lacquer", Vec3::splat(0.78), 0.4);
    let skirting = mesh_of(|m| {
        cuboid(m, Vec3::ZERO, Vec3::new(DOOR[0].x - 0.08, 0.09, 0.015));
        cuboid(m, Vec3::new(DOOR[1].x + 0.08, 0.0, 0.0), Vec3::new(x, 0.09, 0.015));
        cuboid(m, Vec3::new(0.0, 0.0, 0.015), Vec3::new(0.015, 0.09, z));
        cuboid(m, Vec3::new(x - 0.015, 0.0, 0.015), Vec3::new(x, 0.09, z));
    });
    b.add("Skirting", lacquer, skirting);
    Ok(())
}

/// Adds a frame of bars around an opening in the wall at z = 0. The bars are as deep as the opening and project 3 cm
/// into the room.
fn frame(m: &mut Mesh, [low, high]: [Vec2; 2], bar: f32, sill: bool) {
    let mut piece = |a: Vec2, b: Vec2| cuboid(m, a.extend(-REVEAL), b.extend(0.03));
    piece(Vec2::new(low.x - bar, low.y), Vec2::new(low.x, high.y));
    piece(Vec2::new(high.x, low.y), Vec2::new(high.x + bar, high.y));
    piece(Vec2::new(low.x - bar, high.y), Vec2::new(high.x + bar, high.y + bar));
    if sill {
        piece(Vec2::new(low.x - bar, low.y - bar), Vec2::new(high.x + bar, low.y));
    }
}

/// Adds the window with a frosted pane and curtains, and the door.
fn openings(b: &mut Builder) {
    let lacquer = b.paint("Frame lacquer", Vec3::splat(0.80), 0.35);
    let frames = mesh_of(|m| {
        frame(m, WINDOW, 0.06, true);
        frame(m, DOOR, 0.08, false);
        let [low, high] = WINDOW;
        let middle = (low.x + high.x) / 2.0;
        for x in [low.x + 0.03, middle, high.x - 0.03] {
            cuboid(m, Vec3::new(x - 0.03, low.y, -0.10), Vec3::new(x + 0.03, high.y, -0.05));
        }
        for y in [low.y, 1.85, high.y - 0.05] {
            cuboid(m, Vec3::new(low.x, y, -0.10), Vec3::new(high.x, y + 0.05, -0.05));
        }
        cuboid(m, Vec3::new(low.x - 0.1, low.y - 0.03, 0.0), Vec3::new(high.x + 0.1, low.y, 0.16));
    });
    b.add("Frames", lacquer, frames);
    let frosted = b.paint("Frosted glass", Vec3::new(0.50, 0.60, 0.68), 0.25);
    let pane = |[low, high]: [Vec2; 2]| {
        mesh_of(|m| {
            let d = high - low;
            sheet(m, low.extend(-0.08), Vec3::X * d.x, Vec3::Y * d.y, [8, 6]);
        })
    };
    b.add("Window", frosted, pane(WINDOW));

    let blue = b.paint("Door paint", Vec3::new(0.10, 0.19, 0.27), 0.5);
    let [low, high] = DOOR;
    let leaf = mesh_of(|m| {
        cuboid(m, low.extend(-0.09), high.extend(-0.04));
        for (y0, y1) in [(0.2, 0.95), (1.1, 1.85)] {
            cuboid(m, Vec3::new(low.x + 0.12, y0, -0.04), Vec3::new(high.x - 0.12, y1, -0.025));
        }
    });
    b.add("Door", blue, leaf);
    let brass = b.paint("Brass", Vec3::new(0.80, 0.62, 0.30), 0.3);
    b.scene.materials[brass].metallic = 1.0;
    let mut knob = Mesh::default();
    ball(&mut knob, Vec3::new(low.x + 0.08, 1.03, 0.02), Vec2::splat(0.028), 24);
    b.add("Door knob", brass, knob);

    // Curtains: folded sheets.
    let mustard = b.paint("Curtain", Vec3::new(0.66, 0.40, 0.05), 1.0);
    for (from, to) in [(0.75, 1.25), (2.95, 3.45)] {
        let mut mesh =
            mesh_of(|m| sheet(m, Vec3::new(from, 0.12, 0.10), Vec3::X * (to - from), Vec3::Y * 2.3, [60, 6]));
        for p in &mut mesh.positions {
            p.z += 0.035 * maths::sin((p.x - from) * 75.0) * (1.15 - 0.1 * p.y);
        }
        b.add("Curtain", mustard, mesh);
    }
    let rod = mesh_of(|m| cuboid(m, Vec3::new(0.6, 2.42, 0.09), Vec3::new(3.6, 2.445, 0.115)));
    b.add("Curtain rod", brass, rod);
}

/// Indices of the materials that several pieces of furniture share.
struct Paints {
    oak: usize,
    walnut: usize,
    cloth: usize,
    ceramic: usize,
    cobalt: usize,
}

fn furnish(b: &mut Builder) -> Result<()> {
    let oak = b.pattern("Oak", pattern::wood(Vec3::new(0.46, 0.28, 0.13))?, Vec2::new(1.2, 0.5), 0.5);
    let walnut = b.pattern("Walnut", pattern::wood(Vec3::new(0.20, 0.105, 0.055))?, Vec2::new(1.0, 0.5), 0.45);
    let weave = pattern::weave(Vec3::new(0.10, 0.30, 0.32), Vec3::new(0.16, 0.42, 0.42))?;
    let cloth = b.pattern("Teal cloth", weave, Vec2::splat(0.25), 1.0);
    let ceramic = b.paint("White ceramic", Vec3::new(0.78, 0.77, 0.74), 0.15);
    let cobalt = b.paint("Cobalt glaze", Vec3::new(0.03, 0.09, 0.42), 0.12);
    let paints = Paints { oak, walnut, cloth, ceramic, cobalt };
    dining_table(b, &paints)?;
    left_wall(b, &paints)?;

    // A plant by the window, and a round pouf.
    let (pot, leaves) =
        (b.paint("Clay", Vec3::new(0.42, 0.20, 0.12), 0.8), b.paint("Leaves", Vec3::new(0.06, 0.22, 0.04), 0.6));
    furniture::plant(b, Vec3::new(3.85, 0.0, 0.38), 1.35, pot, leaves);
    let mut pouf = Mesh::default();
    ball(&mut pouf, Vec3::ZERO, Vec2::new(0.30, 0.21), 40);
    b.add("Pouf", cloth, moved(pouf, 0.0, Vec3::new(1.05, 0.21, 2.3)));
    Ok(())
}

/// Adds the rug, and on it the table and its chairs.
fn dining_table(b: &mut Builder, paints: &Paints) -> Result<()> {
    let (centre, rug_size) = (Vec3::new(3.0, 0.0, 1.95), Vec2::new(2.9, 2.1));
    let rug = b.pattern("Rug", pattern::rug()?, rug_size, 1.0);
    let corner = centre + Vec3::new(-rug_size.x / 2.0, 0.012, rug_size.y / 2.0);
    b.add("Rug", rug, mesh_of(|m| sheet(m, corner, Vec3::X * rug_size.x, Vec3::NEG_Z * rug_size.y, [12, 8])));
    furniture::table(b, centre, Vec2::new(1.7, 0.9), paints.oak);
    for (x, z, degrees) in [(-0.42, 0.62, 180.0), (0.42, 0.66, 172.0), (-0.42, -0.64, 0.0), (0.45, -0.60, 8.0)] {
        furniture::chair(b, centre + Vec3::new(x, 0.0, z), degrees, paints.walnut, paints.cloth);
    }
    let (red, green) = (
        b.paint("Apple red", Vec3::new(0.50, 0.03, 0.02), 0.3),
        b.paint("Apple green", Vec3::new(0.28, 0.42, 0.04), 0.3),
    );
    furniture::fruit_bowl(b, centre + Vec3::new(0.1, 0.751, 0.0), paints.ceramic, [red, green]);
    furniture::vase(b, centre + Vec3::new(-0.45, 0.751, 0.1), 0.8, paints.cobalt);
    Ok(())
}

/// Furnishes the left wall: shelf, sideboard and painting.
fn left_wall(b: &mut Builder, paints: &Paints) -> Result<()> {
    let covers = [
        ("Book red", Vec3::new(0.42, 0.05, 0.04)),
        ("Book blue", Vec3::new(0.05, 0.12, 0.34)),
        ("Book sand", Vec3::new(0.58, 0.48, 0.30)),
        ("Book green", Vec3::new(0.06, 0.22, 0.10)),
        ("Book white", Vec3::new(0.75, 0.73, 0.68)),
    ]
    .map(|(name, colour)| b.paint(name, colour, 0.7));
    furniture::bookshelf(b, Vec3::new(0.0, 0.0, 1.1), 90.0, 1.5, paints.walnut, &covers);
    furniture::sideboard(b, Vec3::new(0.0, 0.0, 2.95), 90.0, 1.7, paints.oak, paints.ceramic);
    furniture::vase(b, Vec3::new(0.22, 0.741, 3.45), 1.1, paints.ceramic);
    let canvas = b.pattern("Painting", pattern::painting()?, Vec2::new(1.1, 0.75), 0.9);
    // The rows of a texture run down, so start the canvas at its upper left corner as seen from the room. With these
    // axes the sheet would face the wall (-z × -y = -x), so swap two corners of each triangle to turn its front to the
    // room.
    let upper_left = Vec3::new(0.031, 2.15, 3.5);
    b.add(
        "Painting",
        canvas,
        mesh_of(|m| {
            sheet(m, upper_left, Vec3::NEG_Z * 1.1, Vec3::NEG_Y * 0.75, [4, 4]);
            m.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }),
    );
    let border = mesh_of(|m| {
        let (low, high) = (Vec3::new(0.0, 1.36, 2.36), Vec3::new(0.03, 2.19, 3.54));
        cuboid(m, low, high);
    });
    b.add("Picture frame", paints.walnut, border);
    Ok(())
}
