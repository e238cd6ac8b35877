//! The exemplar room, which is to be photographed: an office of 5.4 × 9 m, 2.7 m high, under a grid of square
//! luminaires.

use super::shapes::{cuboid, pierced, sheet};
use super::{Builder, furniture, pattern};
use crate::error::Result;
use crate::maths;
use crate::scene::{Camera, Material, Mesh, Scene};
use glam::{Vec2, Vec3};

const SIZE: Vec3 = Vec3::new(5.4, 2.7, 9.0);
/// Side of the ceiling's tiles in metres (`TILE`), and number of tiles along x and z (`TILES`). [convention]
const TILE: f32 = 0.6;
const TILES: [usize; 2] = [9, 15];
/// Width and depth in metres of the bars that carry the tiles.
const BAR: Vec2 = Vec2::new(0.024, 0.004);
/// Side of a luminaire in metres; the rest of its tile is a white rim. [convention]
const LUMINAIRE: f32 = 0.56;
/// Luminance of the luminaires in cd/m². [convention]
const LUMINANCE: f32 = 3000.0;
/// Linear Rec.709 colour of a blackbody at 3500 K (CIE xy 0.4053, 0.3907), with luminance 1.
const WARM_WHITE: Vec3 = Vec3::new(1.564, 0.892, 0.406);

/// The grid of luminaires on the ceiling, as ground truth. Positions are (x, z) in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuminaireGrid {
    pub columns: usize,
    pub rows: usize,
    /// Centre of the luminaire with the smallest x and z.
    pub first: Vec2,
    /// Distance in metres between neighbouring centres along x and z.
    pub period: Vec2,
    /// Extent in metres of the emitting part of a luminaire along x and z.
    pub size: Vec2,
    /// Emission of the luminaires: linear RGB in cd/m².
    pub emission: Vec3,
}

impl LuminaireGrid {
    /// Iterates over the centres row by row, x first.
    pub fn centres(&self) -> impl Iterator<Item = Vec2> {
        let grid = *self;
        (0..grid.rows * grid.columns)
            .map(move |i| grid.first + grid.period * Vec2::new((i % grid.columns) as f32, (i / grid.columns) as f32))
    }
}

/// The office, with the ground truth about its lights.
#[derive(Clone, Debug)]
pub struct Exemplar {
    pub scene: Scene,
    pub grid: LuminaireGrid,
    /// Height in metres of the plane in which the ceiling tiles and luminaires lie.
    pub ceiling_height: f32,
    /// Index of the camera that takes the photo. It is meant for an aspect ratio of 3:2, with a horizontal angle of
    /// view of 66°, and it is pitched up by 22°.
    pub camera: usize,
}

/// Builds the office, lit only by the luminaires in its ceiling.
pub fn exemplar_room() -> Result<Exemplar> {
    let grid = LuminaireGrid {
        columns: 3,
        rows: 6,
        first: Vec2::new(1.5, 2.5) * TILE,
        period: Vec2::new(3.0, 2.0) * TILE,
        size: Vec2::splat(LUMINAIRE),
        emission: WARM_WHITE * LUMINANCE,
    };
    let mut b = Builder::default();
    ceiling(&mut b, &grid)?;
    shell(&mut b)?;
    fittings(&mut b)?;

    // Rotate the camera relative to the room and roll it slightly, so that all three vanishing points are finite.
    let (yaw, pitch, roll) = (-17f32.to_radians(), 22f32.to_radians(), 1.2f32.to_radians());
    let turn =
        maths::rotation_3d(Vec3::Y, yaw) * maths::rotation_3d(Vec3::X, pitch) * maths::rotation_3d(Vec3::Z, roll);
    let fov_y = 2.0 * maths::atan(maths::tan(33f32.to_radians()) / 1.5);
    b.scene.cameras.push(Camera {
        name: "Photographer".into(),
        position: Vec3::new(1.75, 1.5, 8.6),
        forward: turn * Vec3::NEG_Z,
        up: turn * Vec3::Y,
        fov_y,
    });
    Ok(Exemplar { scene: b.build()?, grid, ceiling_height: SIZE.y, camera: 0 })
}

/// Adds the ceiling: tiles, luminaires with their rims, and the bars between them. Everything but the bars lies in one
/// plane.
fn ceiling(b: &mut Builder, grid: &LuminaireGrid) -> Result<()> {
    let fibre = b.pattern("Ceiling tile", pattern::tile()?, Vec2::splat(TILE), 1.0);
    let white = b.paint("White steel", Vec3::splat(0.75), 0.5);
    b.scene.materials.push(Material {
        emission: grid.emission,
        double_sided: false,
        ..Material::diffuse("Diffuser", Vec3::splat(0.6))
    });
    let diffuser = b.scene.materials.len() - 1;

    // Add a square with the side `edge`. It faces down, because x × z = -y.
    let square = |m: &mut Mesh, centre: Vec2, edge: f32| {
        let corner = centre - edge / 2.0;
        sheet(m, Vec3::new(corner.x, SIZE.y, corner.y), Vec3::X * edge, Vec3::Z * edge, [1, 1]);
    };
    let (mut tiles, mut rims, mut lamps) = (Mesh::default(), Mesh::default(), Mesh::default());
    let lit: Vec<Vec2> = grid.centres().collect();
    for row in 0..TILES[1] {
        for column in 0..TILES[0] {
            let centre = (Vec2::new(column as f32, row as f32) + 0.5) * TILE;
            if !lit.iter().any(|l| (*l - centre).length() < 0.5 * TILE) {
                square(&mut tiles, centre, TILE);
                continue;
            }
            square(&mut lamps, centre, LUMINAIRE);
            let corner = Vec3::new(centre.x - TILE / 2.0, SIZE.y, centre.y - TILE / 2.0);
            let rim = (TILE - LUMINAIRE) / 2.0;
            let hole = [Vec2::splat(rim), Vec2::splat(TILE - rim)];
            pierced(&mut rims, corner, [Vec3::X, Vec3::Z], Vec2::splat(TILE), &[hole], TILE);
        }
    }
    b.add("Ceiling", fibre, tiles);
    b.add("Luminaires", diffuser, lamps);
    b.add("Luminaire rims", white, rims);

    let steel = b.paint("Grid steel", Vec3::splat(0.42), 0.5);
    let mut bars = Mesh::default();
    let (half, low) = (BAR.x / 2.0, SIZE.y - BAR.y);
    for i in 0..=TILES[0] {
        let x = i as f32 * TILE;
        cuboid(&mut bars, Vec3::new((x - half).max(0.0), low, 0.0), Vec3::new((x + half).min(SIZE.x), SIZE.y, SIZE.z));
    }
    for i in 0..=TILES[1] {
        let z = i as f32 * TILE;
        cuboid(
            &mut bars,
            Vec3::new(0.0, low - 0.0005, (z - half).max(0.0)),
            Vec3::new(SIZE.x, SIZE.y, (z + half).min(SIZE.z)),
        );
    }
    b.add("Ceiling grid", steel, bars);
    Ok(())
}

/// Returns the lower and upper corner of each window in the wall at x = 0. Corners are in metres: the first coordinate
/// is the distance from the end at z = 9, along -z; the second is the height.
fn windows() -> [[Vec2; 2]; 4] {
    std::array::from_fn(|i| {
        let start = 0.5 + 2.1 * i as f32;
        [Vec2::new(start, 0.9), Vec2::new(start + 1.7, 2.4)]
    })
}

fn shell(b: &mut Builder) -> Result<()> {
    let Vec3 { x, y, z } = SIZE;
    let carpet = b.pattern("Carpet", pattern::carpet(Vec3::new(0.24, 0.25, 0.28))?, Vec2::splat(1.0), 1.0);
    let mut floor = Mesh::default();
    sheet(&mut floor, Vec3::Z * z, Vec3::X * x, Vec3::NEG_Z * z, [18, 30]);
    b.add("Floor", carpet, floor);

    let paint = b.pattern("Wall paint", pattern::plaster(Vec3::new(0.66, 0.66, 0.62))?, Vec2::splat(1.8), 0.9);
    let mut walls = Mesh::default();
    pierced(&mut walls, Vec3::Z * z, [Vec3::NEG_Z, Vec3::Y], Vec2::new(z, y), &windows(), 0.3);
    sheet(&mut walls, Vec3::X * x, Vec3::Z * z, Vec3::Y * y, [30, 9]);
    sheet(&mut walls, Vec3::new(x, 0.0, z), Vec3::NEG_X * x, Vec3::Y * y, [18, 9]);
    b.add("Walls", paint, walls);
    let green = b.pattern("Green wall", pattern::plaster(Vec3::new(0.16, 0.34, 0.22))?, Vec2::splat(1.8), 0.9);
    let mut end = Mesh::default();
    sheet(&mut end, Vec3::ZERO, Vec3::X * x, Vec3::Y * y, [18, 9]);
    b.add("End wall", green, end);

    // Windows at night: dark glossy panes behind white mullions.
    let frame = b.paint("Mullions", Vec3::splat(0.72), 0.4);
    let pane = b.paint("Night pane", Vec3::new(0.05, 0.07, 0.10), 0.1);
    let (mut bars, mut panes) = (Mesh::default(), Mesh::default());
    for [low, high] in windows() {
        let (near, far) = (z - low.x, z - high.x);
        sheet(&mut panes, Vec3::new(-0.08, low.y, near), Vec3::Z * (far - near), Vec3::Y * (high.y - low.y), [4, 4]);
        for at in [near, (near + far) / 2.0, far] {
            cuboid(&mut bars, Vec3::new(-0.1, low.y, at - 0.03), Vec3::new(0.02, high.y, at + 0.03));
        }
        for at in [low.y, 1.9, high.y] {
            cuboid(&mut bars, Vec3::new(-0.1, at - 0.03, far - 0.03), Vec3::new(0.02, at + 0.03, near + 0.03));
        }
    }
    b.add("Windows", pane, panes);
    b.add("Mullions", frame, bars);
    Ok(())
}

fn fittings(b: &mut Builder) -> Result<()> {
    lockers(b);
    let dark = end_wall(b);
    desks(b, dark)?;
    let (pot, leaves) =
        (b.paint("Grey pot", Vec3::splat(0.3), 0.6), b.paint("Leaves", Vec3::new(0.07, 0.24, 0.05), 0.6));
    furniture::plant(b, Vec3::new(0.45, 0.0, 0.5), 2.1, pot, leaves);
    furniture::plant(b, Vec3::new(0.45, 0.0, SIZE.z - 4.4), 2.0, pot, leaves);
    Ok(())
}

/// Adds lockers in two colours along the right wall, with gaps that form vertical lines, and boxes on top.
fn lockers(b: &mut Builder) {
    let x = SIZE.x;
    let blues = [
        b.paint("Locker blue", Vec3::new(0.06, 0.16, 0.34), 0.4),
        b.paint("Locker grey", Vec3::new(0.40, 0.44, 0.48), 0.4),
    ];
    let mut lockers = [Mesh::default(), Mesh::default()];
    for i in 0..14 {
        let near = 8.4 - 0.5 * i as f32;
        cuboid(&mut lockers[i % 2], Vec3::new(x - 0.48, 0.08, near - 0.49), Vec3::new(x, 2.02, near));
    }
    for (mesh, material) in lockers.into_iter().zip(blues) {
        b.add("Lockers", material, mesh);
    }
    let card = b.paint("Cardboard", Vec3::new(0.45, 0.30, 0.17), 1.0);
    let mut boxes = Mesh::default();
    for (at, width, height) in
        [(7.1, 0.5, 0.28), (6.0, 0.42, 0.34), (4.3, 0.6, 0.25), (3.6, 0.4, 0.36), (2.4, 0.5, 0.3)]
    {
        cuboid(&mut boxes, Vec3::new(x - 0.42, 2.02, at - width), Vec3::new(x - 0.06, 2.02 + height, at));
    }
    b.add("Boxes", card, boxes);
}

/// Furnishes the end wall: a door, a sign above it and a board. Returns the index of the trim's dark material.
fn end_wall(b: &mut Builder) -> usize {
    let orange = b.paint("Door orange", Vec3::new(0.62, 0.25, 0.06), 0.5);
    let white = b.paint("Board white", Vec3::splat(0.80), 0.2);
    let dark = b.paint("Dark plastic", Vec3::splat(0.05), 0.4);
    let (mut door, mut board, mut trim) = (Mesh::default(), Mesh::default(), Mesh::default());
    cuboid(&mut door, Vec3::new(3.7, 0.0, 0.0), Vec3::new(4.65, 2.1, 0.05));
    cuboid(&mut board, Vec3::new(0.9, 0.95, 0.0), Vec3::new(3.0, 2.15, 0.03));
    cuboid(&mut trim, Vec3::new(3.62, 0.0, 0.0), Vec3::new(3.70, 2.18, 0.07));
    cuboid(&mut trim, Vec3::new(4.65, 0.0, 0.0), Vec3::new(4.73, 2.18, 0.07));
    cuboid(&mut trim, Vec3::new(3.62, 2.10, 0.0), Vec3::new(4.73, 2.18, 0.07));
    cuboid(&mut trim, Vec3::new(3.9, 2.28, 0.0), Vec3::new(4.45, 2.46, 0.04));
    b.add("Door", orange, door);
    b.add("Board", white, board);
    b.add("Trim", dark, trim);
    dark
}

/// Adds desks in two rows, back to back, with dividers between them. `dark` is the index of the screens' material.
fn desks(b: &mut Builder, dark: usize) -> Result<()> {
    let top = b.pattern("Beech", pattern::wood(Vec3::new(0.55, 0.38, 0.22))?, Vec2::new(1.2, 0.6), 0.5);
    let cloth = b.pattern(
        "Divider",
        pattern::weave(Vec3::new(0.40, 0.10, 0.08), Vec3::new(0.5, 0.14, 0.1))?,
        Vec2::splat(0.3),
        1.0,
    );
    let mut dividers = Mesh::default();
    for i in 0..3 {
        let at = Vec3::new(2.2, 0.0, 1.8 + 2.0 * i as f32);
        furniture::desk(b, at + Vec3::Z * 0.45, 0.0, top, dark);
        furniture::desk(b, at - Vec3::Z * 0.45, 180.0, top, dark);
        cuboid(&mut dividers, at + Vec3::new(-0.8, 0.5, -0.015), at + Vec3::new(0.8, 1.45, 0.015));
    }
    b.add("Dividers", cloth, dividers);
    Ok(())
}
