//! The planes of objects that face the room, and maps of importance.

use crate::harness::{figure, scenes};
use glam::{Mat3, Vec3};
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::relight::{Importance, ImportanceParams, Quantity};
use luxfer::rng::Rng;
use luxfer::scene::{Camera, Material, Mesh, Scene, Texture, surface};
use std::sync::Arc;

/// Number of made-up buildings.
const BUILDINGS: u64 = 120;

/// A box without inside, all of whose faces look outwards.
fn block(low: Vec3, high: Vec3) -> Mesh {
    let corner = |i: usize| Vec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low);
    let faces: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect(),
        ..Mesh::default()
    }
}

/// Joins a mesh to another one.
fn join(mesh: &mut Mesh, other: &Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
}

/// A building whose ceiling is a slab with a beam, and the height of the slab's lower side. Half of the buildings have
/// a storey above the ceiling, as empty as the room below. A third has no camera, and a third has two in the room and
/// one outside. In every fourth building, the ceiling's object has a panel outside, which is larger than the ceiling.
fn building(seed: u64) -> (Scene, f32) {
    let mut rng = Rng::new(61, &[seed]);
    let mut between = |low: f32, high: f32| low + (high - low) * rng.next_f32();
    let (w, d) = (between(3.0, 9.0), between(3.0, 9.0));
    let (h, above) = (between(2.2, 3.5), between(2.2, 4.5));
    let (thick, beam) = (between(0.1, 0.4), between(0.15, 0.5));
    let has_storey = seed % 2 == 1;
    let top = h + thick + if has_storey { above } else { 0.0 };
    let mut ceiling = block(Vec3::new(0.0, h, 0.0), Vec3::new(w, h + thick, d));
    ceiling.name = "Ceiling".into();
    join(&mut ceiling, &block(Vec3::new(0.3 * w, h - beam, 0.0), Vec3::new(0.3 * w + beam, h, d)));
    if seed.is_multiple_of(4) {
        let side = (w * d / between(0.02, 0.5)).sqrt();
        let corner = Vec3::new(-50.0, -side, -3.0);
        join(&mut ceiling, &Mesh::parallelogram(corner, Vec3::X * side, Vec3::Y * side, 0));
    }
    // The floor, the walls and the roof.
    let mut meshes = vec![
        ceiling,
        block(Vec3::new(0.0, -0.2, 0.0), Vec3::new(w, 0.0, d)),
        block(Vec3::new(-0.2, 0.0, 0.0), Vec3::new(0.0, top, d)),
        block(Vec3::new(w, 0.0, 0.0), Vec3::new(w + 0.2, top, d)),
        block(Vec3::new(0.0, 0.0, -0.2), Vec3::new(w, top, 0.0)),
        block(Vec3::new(0.0, 0.0, d), Vec3::new(w, top, d + 0.2)),
    ];
    if has_storey {
        meshes.push(block(Vec3::new(0.0, top, 0.0), Vec3::new(w, top + 0.2, d)));
    }
    let inside = Camera::look_at(Vec3::new(0.5 * w, 1.5, 0.8 * d), Vec3::new(0.5 * w, 1.5, 0.0), 1.0);
    let outside = Camera::look_at(Vec3::new(-8.0, 12.0, -8.0), Vec3::new(w, h, d), 1.0);
    let cameras = match seed / 2 % 3 {
        0 => vec![inside],
        1 => vec![inside.clone(), inside, outside],
        _ => vec![],
    };
    (Scene { meshes, materials: vec![Material::default()], cameras, ..Scene::default() }, h)
}

/// Prints the share of the buildings in which the ceiling's lower side is chosen: of all, and of those with cameras.
pub fn surface() {
    let [mut right, mut seen, mut count_seen] = [0; 3];
    for seed in 0..BUILDINGS {
        let (scene, height) = building(seed);
        let found = surface::find(&scene, "Ceiling").expect("a ceiling");
        let is_right = u64::from(found.normal.y < -0.99 && (found.origin.y - height).abs() < 0.01);
        right += is_right;
        if !scene.cameras.is_empty() {
            count_seen += 1;
            seen += is_right;
        }
    }
    figure("constants.surface.right", 100.0 * right as f64 / BUILDINGS as f64, "%");
    figure("constants.surface.right_with_camera", 100.0 * seen as f64 / count_seen as f64, "%");
}

/// Prints how far responses to textures of random stripes are off, because cells cut texels: the largest error over
/// textures of several sizes.
pub fn map() {
    let setting = scenes::demo_room().expect("a room");
    let ceiling = surface::find(&setting.scene, "Ceiling").expect("a ceiling");
    let emitter = setting.scene.materials.len() - 1;
    let goal = scenes::exact_goal(&ceiling.triangles, Quantity::Outgoing, Vec3::ONE);
    let (scene, monitor) = (Arc::new(setting.scene), Monitor::default());
    let mut worst = [0.0f64; 2];
    for (k, cells) in [16, 64].into_iter().enumerate() {
        let mut params = ImportanceParams { width: cells, height: cells, ..ImportanceParams::default() };
        params.tracing.paths = 1 << 14;
        let map = Importance::trace(&scene, emitter, &goal, &params, monitor.job()).expect("a map");
        let respond = |image: Image| {
            let texture = Texture::new("stripes", image);
            map.respond(&texture, &Mat3::IDENTITY, monitor.job()).expect("a response").light.mean.y
        };
        let even = respond(Image::from_fn(8, 8, |_, _| [0.5]).expect("an image"));
        for (seed, side) in [7, 37, 100, 333, 1000, 1777].into_iter().enumerate() {
            let value = |x: usize| Rng::new(67, &[seed as u64, x as u64]).next_f32();
            let striped = Image::from_fn(side, 8, |x, _| [value(x)]).expect("an image");
            // The mean of the columns in each cell, each weighted with the share of it that the cell contains.
            let mean = |x: usize, _| {
                let column = |cell: usize| cell as f64 * side as f64 / cells as f64;
                let (low, high) = (column(x), column(x + 1));
                let part = |i: usize| (high.min(i as f64 + 1.0) - low.max(i as f64)).max(0.0);
                let columns = low as usize..(high.ceil() as usize).min(side);
                [(columns.map(|i| part(i) * f64::from(value(i))).sum::<f64>() / (high - low)) as f32]
            };
            let exact = Image::from_fn(cells, 1, mean).expect("an image");
            worst[k] = worst[k].max((respond(striped) - respond(exact)).abs() / even);
        }
        figure(&format!("constants.map.{cells}_cells.off"), 100.0 * worst[k], "%");
    }
}
