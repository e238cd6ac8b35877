//! Cost of lights that do not reach the camera: rooms in a building against the one room alone.
//!
//! Each scene contains the same room, with nine lamps, seen by the same camera. The bench renders the room alone and
//! the room within the scene to the same error of the image (5 %), in turns, and prints the ratio of the processor
//! times: the median over rounds with different seeds. Build times are not included. Without an argument all sections
//! run: `rooms` (9, 49, 225 closed rooms), `neighbours` (a brighter hall next door, with its door closed and ajar; the
//! sun and the sky outside; a sealed box of 1e9 cd/m²), `build` (time to prepare four copies of the room).

mod harness;

use glam::Vec3;
use harness::plot::Plot;
use harness::{Clock, Table, figure, interleaved, median, time};
use luxfer::exec::Pool;
use luxfer::job::Monitor;
use luxfer::render::{self, Film, Params, World};
use luxfer::scene::{Camera, Environment, Material, Mesh, PunctualLight, Scene};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// Error of the image at which times are compared.
const ERROR: f32 = 0.05;
const ROUNDS: u64 = 5;
const SIZE: [usize; 2] = [160, 120];

/// Inner size of a room, and the thickness of its walls, in metres.
const ROOM: Vec3 = Vec3::new(5.0, 2.8, 4.0);
const WALL: f32 = 0.2;
const LAMP: f32 = 0.3;
const DOOR: [f32; 2] = [0.9, 2.0];

const GREY: usize = 0;
const SHINING: usize = 1;
const BRIGHT: usize = 2;
const WOOD: usize = 3;
const EXTREME: usize = 4;

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let is_chosen = |name: &str| chosen.is_empty() || chosen.iter().any(|c| c == name);
    let pool = Pool::new(2).expect("threads");
    let mut table = Table::new(["scene", "lamps", "hidden", "paths", "error", "seconds", "over the room alone"]);
    let mut plot = Plot::new("A room in a building of n closed rooms", "rooms", "time at equal error");
    let mut points = vec![[1.0, 1.0]];
    if is_chosen("rooms") {
        for side in [3, 7, 15] {
            let scene = rooms(side);
            let ratio = compare(&pool, &format!("{} rooms", side * side), &scene, &mut table);
            figure(&format!("render.buildings.{}_over_1", side * side), ratio, "ratio");
            points.push([(side * side) as f64, ratio]);
        }
    }
    if is_chosen("neighbours") {
        for (name, scene) in [
            ("hall_closed", hall(0.0)),
            ("hall_ajar", hall(0.25)),
            ("sun_and_sky", sun_and_sky()),
            ("sealed_box", sealed_box()),
        ] {
            let ratio = compare(&pool, name, &scene, &mut table);
            figure(&format!("render.buildings.{name}_over_1"), ratio, "ratio");
        }
    }
    if is_chosen("build") {
        let times = interleaved(
            Clock::Process,
            ROUNDS as usize,
            &mut [&mut || drop(build(&pool, furnished_rooms(1))), &mut || drop(build(&pool, furnished_rooms(4)))],
        );
        println!("# ready in {:.3} s and {:.3} s", times.median(0), times.median(1));
        figure("render.buildings.build.4_over_1", times.ratio(1, 0), "ratio");
    }
    table.print("a room in a building, to 5 % error");
    plot.add("closed rooms", points);
    if let Err(error) = plot.write("buildings") {
        println!("# no plot: {error}");
    }
}

/// Ratio of the times to equal error in a scene and in the room alone.
fn compare(pool: &Pool, name: &str, scene: &Scene, table: &mut Table) -> f64 {
    let worlds = [build(pool, alone()), build(pool, scene.clone())];
    let (mut ratios, mut times, mut last) = (Vec::new(), Vec::new(), None);
    for round in 0..ROUNDS {
        let mut seconds = [0.0; 2];
        for turn in 0..2 {
            let which = (round as usize + turn) % 2;
            let params = Params {
                width: SIZE[0],
                height: SIZE[1],
                samples: 1 << 14,
                target_error: ERROR,
                seed: 1 + round,
                ..Params::default()
            };
            let (taken, film) = time(Clock::Process, || shot(pool, &worlds[which], &params));
            // The last pass goes a little beyond the target.
            seconds[which] = taken * (film.error / f64::from(ERROR)).powi(2);
            if which == 1 {
                last = Some(film);
            }
        }
        ratios.push(seconds[1] / seconds[0]);
        times.push(seconds[1]);
    }
    let film = last.expect("a film");
    let [lamps, hidden] = film.lamp_visibility.map_or([0; 2], |r| [r.lamps, r.hidden]);
    table.row([
        name.to_string(),
        lamps.to_string(),
        hidden.to_string(),
        film.samples.to_string(),
        format!("{:.4}", film.error),
        format!("{:.2}", median(&times)),
        format!("{:.3}", median(&ratios)),
    ]);
    median(&ratios)
}

fn build(pool: &Pool, scene: Scene) -> World {
    let scene = Arc::new(scene);
    pool.run(|| World::build(scene, Monitor::default().job())).expect("a valid scene")
}

fn shot(pool: &Pool, world: &World, params: &Params) -> Film {
    let camera = Camera::look_at(Vec3::new(0.4, 1.6, 0.5), Vec3::new(4.0, 1.0, 3.5), 1.2);
    pool.run(|| render::run(world, &camera, params, Monitor::default().job(), &mut |_| ())).expect("it renders")
}

fn empty() -> Scene {
    let matt = |name: &str, albedo: Vec3| Material::diffuse(name, albedo);
    let lamp = |name: &str, luminance: f32| Material {
        emission: Vec3::splat(luminance),
        double_sided: false,
        ..matt(name, Vec3::splat(0.5))
    };
    Scene {
        materials: vec![
            matt("plaster", Vec3::new(0.7, 0.68, 0.64)),
            lamp("lamp", 3000.0),
            lamp("bright lamp", 30_000.0),
            matt("wood", Vec3::new(0.4, 0.25, 0.12)),
            lamp("extreme", 1e9),
        ],
        ..Scene::default()
    }
}

/// An axis-parallel box, whose sides face outwards.
fn cuboid(scene: &mut Scene, low: Vec3, high: Vec3, material: usize) {
    let d = high - low;
    let (x, y, z) = (Vec3::X * d.x, Vec3::Y * d.y, Vec3::Z * d.z);
    for (corner, u, v) in [(low, x, z), (low, z, y), (low, y, x), (high, -z, -x), (high, -y, -z), (high, -x, -y)] {
        scene.meshes.push(Mesh::parallelogram(corner, u, v, material));
    }
}

/// A room with furniture and nine lamps under its ceiling. The wall at x = 0 has a doorway.
fn room(scene: &mut Scene, at: Vec3, lamp: usize) {
    let slab = |scene: &mut Scene, low: [f32; 3], high: [f32; 3], material: usize| {
        cuboid(scene, at + Vec3::from(low), at + Vec3::from(high), material);
    };
    let (Vec3 { x, y, z }, t) = (ROOM, WALL / 2.0);
    slab(scene, [-t, -t, -t], [x + t, 0.0, z + t], GREY);
    slab(scene, [-t, y, -t], [x + t, y + t, z + t], GREY);
    slab(scene, [x, 0.0, 0.0], [x + t, y, z], GREY);
    slab(scene, [-t, 0.0, -t], [x + t, y, 0.0], GREY);
    slab(scene, [-t, 0.0, z], [x + t, y, z + t], GREY);
    let (left, right) = (z / 2.0 - DOOR[0] / 2.0, z / 2.0 + DOOR[0] / 2.0);
    slab(scene, [-t, 0.0, 0.0], [0.0, y, left], GREY);
    slab(scene, [-t, 0.0, right], [0.0, y, z], GREY);
    slab(scene, [-t, DOOR[1], left], [0.0, y, right], GREY);
    // Furniture.
    slab(scene, [2.2, 0.7, 1.4], [4.0, 0.75, 2.6], WOOD);
    slab(scene, [3.0, 0.0, 1.9], [3.2, 0.7, 2.1], WOOD);
    slab(scene, [4.4, 0.0, 0.4], [5.0, 1.8, 1.6], WOOD);
    for i in 0..9 {
        let centre = Vec3::new(x * ((i % 3) as f32 + 0.5) / 3.0, y - 0.02, z * ((i / 3) as f32 + 0.5) / 3.0);
        let corner = at + centre - Vec3::new(LAMP, 0.0, LAMP) / 2.0;
        scene.meshes.push(Mesh::parallelogram(corner, Vec3::X * LAMP, Vec3::Z * LAMP, lamp));
    }
}

/// The door of a room, opened by an angle in radians to the outside.
fn door(scene: &mut Scene, at: Vec3, angle: f32) {
    let hinge = at + Vec3::new(-WALL / 4.0, 0.0, ROOM.z / 2.0 - DOOR[0] / 2.0);
    // A closed door overlaps its frame, so that no light passes.
    let width = if angle == 0.0 { DOOR[0] } else { DOOR[0] - 0.01 };
    let along = Vec3::new(-angle.sin(), 0.0, angle.cos()) * width;
    scene.meshes.push(Mesh::parallelogram(hinge, Vec3::Y * DOOR[1], along, WOOD));
}

fn alone() -> Scene {
    let mut scene = empty();
    room(&mut scene, Vec3::ZERO, SHINING);
    door(&mut scene, Vec3::ZERO, 0.0);
    scene
}

/// `side` × `side` closed rooms; the camera is in the room in the middle.
fn rooms(side: i32) -> Scene {
    let mut scene = empty();
    let half = side / 2;
    for (x, z) in (-half..=half).flat_map(|x| (-half..=half).map(move |z| (x, z))) {
        let at = Vec3::new(x as f32 * (ROOM.x + WALL), 0.0, z as f32 * (ROOM.z + WALL));
        room(&mut scene, at, SHINING);
        door(&mut scene, at, 0.0);
    }
    scene
}

/// The room beside a hall with lamps of ten times its luminance, with the door between them opened by an angle.
fn hall(angle: f32) -> Scene {
    let mut scene = empty();
    room(&mut scene, Vec3::ZERO, SHINING);
    door(&mut scene, Vec3::ZERO, angle);
    let (low, high) = (Vec3::new(-10.1, 0.0, -3.0), Vec3::new(-0.1, 5.0, 7.0));
    cuboid(&mut scene, low, high, GREY);
    // The side towards the room has its doorway: the walls of the room are that side.
    let side = scene.meshes.len() - 3;
    scene.meshes.remove(side);
    let (z0, z1) = (-0.1, ROOM.z + 0.1);
    for (corner, u, v) in
        [([-3.0, 0.0], z0 + 3.0, 5.0), ([z1, 0.0], 7.0 - z1, 5.0), ([z0, ROOM.y + 0.1], z1 - z0, 5.0 - ROOM.y - 0.1)]
    {
        let corner = Vec3::new(-0.1, corner[1], corner[0]);
        scene.meshes.push(Mesh::parallelogram(corner, Vec3::Z * u, Vec3::Y * v, GREY));
    }
    for i in 0..25 {
        let at = Vec3::new(-9.0 + (i % 5) as f32 * 1.9, 4.9, -2.0 + (i / 5) as f32 * 1.9);
        scene.meshes.push(Mesh::parallelogram(at, Vec3::X * LAMP, Vec3::Z * LAMP, BRIGHT));
    }
    scene
}

fn sun_and_sky() -> Scene {
    let mut scene = alone();
    let sun = Vec3::new(0.4, -0.8, 0.3);
    scene.lights.push(PunctualLight::parallel(sun, Vec3::splat(100_000.0)));
    scene.environment = Some(Environment::Constant(Vec3::splat(5000.0)));
    scene
}

/// The room, and elsewhere a sealed box that contains an extremely bright lamp.
fn sealed_box() -> Scene {
    let mut scene = alone();
    let low = Vec3::new(20.0, 0.0, 0.0);
    cuboid(&mut scene, low, low + 1.0, GREY);
    cuboid(&mut scene, low + 0.3, low + 0.6, EXTREME);
    scene
}

/// Rooms with round furniture of 100,000 triangles each.
fn furnished_rooms(count: usize) -> Scene {
    let mut scene = empty();
    for index in 0..count {
        let at = Vec3::X * (index as f32 * (ROOM.x + WALL));
        room(&mut scene, at, SHINING);
        door(&mut scene, at, 0.0);
        let (rows, columns) = (200, 250);
        let mut sphere = Mesh { material: WOOD, ..Mesh::default() };
        for (i, j) in (0..=rows).flat_map(|i| (0..=columns).map(move |j| (i, j))) {
            let (polar, angle) = (i as f32 / rows as f32 * PI, j as f32 / columns as f32 * TAU);
            let outwards = Vec3::new(polar.sin() * angle.cos(), polar.cos(), polar.sin() * angle.sin());
            sphere.positions.push(at + Vec3::new(1.2, 0.5, 2.0) + 0.5 * outwards);
        }
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            let a = (i * (columns + 1) + j) as u32;
            let b = a + columns as u32 + 1;
            sphere.triangles.extend([[a, a + 1, b], [a + 1, b + 1, b]]);
        }
        scene.meshes.push(sphere);
    }
    scene
}
