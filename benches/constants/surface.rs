//! The planes of objects that face the room, and maps of importance.

use crate::harness::{figure, scenes};
use glam::{Mat3, Vec2, Vec3};
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::relight::{Aspect, Constraint, Goal, Importance, ImportanceParams, Quantity, TargetGeometry};
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

/// Prints the share of the buildings in which the ceiling's lower side is chosen. A ceiling is a slab with a beam. Half
/// of the buildings have a storey above it, as large and as empty as the room below. Some have no camera in the room.
pub fn surface() {
    let [mut right, mut seen, mut count_seen] = [0, 0, 0];
    for seed in 0..BUILDINGS {
        let mut rng = Rng::new(61, &[seed]);
        let mut between = |low: f32, high: f32| low + (high - low) * rng.next_f32();
        let (w, d) = (between(3.0, 9.0), between(3.0, 9.0));
        let (h, above) = (between(2.2, 3.5), between(2.2, 4.5));
        let thick = between(0.1, 0.4);
        let storeys = 1 + seed % 2;
        let top = h + thick + if storeys == 2 { above } else { 0.0 };
        let mut meshes = vec![block(Vec3::new(0.0, h, 0.0), Vec3::new(w, h + thick, d))];
        meshes[0].name = "Ceiling".into();
        let beam = between(0.15, 0.5);
        let below = block(Vec3::new(0.3 * w, h - beam, 0.0), Vec3::new(0.3 * w + beam, h, d));
        let first = meshes[0].positions.len() as u32;
        meshes[0].positions.extend(below.positions);
        meshes[0].triangles.extend(below.triangles.iter().map(|t| t.map(|v| v + first)));
        // In every fourth building, the ceiling's object has a panel outside, which is larger than the ceiling.
        if seed % 4 == 0 {
            let side = (w * d / between(0.02, 0.5)).sqrt();
            let panel = Mesh::parallelogram(Vec3::new(-50.0, -side, -3.0), Vec3::X * side, Vec3::Y * side, 0);
            let first = meshes[0].positions.len() as u32;
            meshes[0].positions.extend(panel.positions);
            meshes[0].triangles.extend(panel.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        // The floor, the roof, and walls.
        meshes.push(block(Vec3::new(0.0, -0.2, 0.0), Vec3::new(w, 0.0, d)));
        if storeys == 2 {
            meshes.push(block(Vec3::new(0.0, top, 0.0), Vec3::new(w, top + 0.2, d)));
        }
        meshes.push(block(Vec3::new(-0.2, 0.0, 0.0), Vec3::new(0.0, top, d)));
        meshes.push(block(Vec3::new(w, 0.0, 0.0), Vec3::new(w + 0.2, top, d)));
        meshes.push(block(Vec3::new(0.0, 0.0, -0.2), Vec3::new(w, top, 0.0)));
        meshes.push(block(Vec3::new(0.0, 0.0, d), Vec3::new(w, top, d + 0.2)));
        // Cameras in the room, and one that shows the building from outside.
        let inside = Camera::look_at(Vec3::new(0.5 * w, 1.5, 0.8 * d), Vec3::new(0.5 * w, 1.5, 0.0), 1.0);
        let outside = Camera::look_at(Vec3::new(-8.0, 12.0, -8.0), Vec3::new(w, h, d), 1.0);
        let cameras = match seed / 2 % 3 {
            0 => vec![inside],
            1 => vec![inside.clone(), inside, outside],
            _ => vec![],
        };
        let has_camera = !cameras.is_empty();
        let scene = Scene { meshes, materials: vec![Material::default()], cameras, ..Scene::default() };
        let found = surface::find(&scene, "Ceiling").expect("a ceiling");
        let is_right = found.normal.y < -0.99 && (found.origin.y - h).abs() < 0.01;
        right += u64::from(is_right);
        count_seen += u64::from(has_camera);
        seen += u64::from(is_right && has_camera);
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
    let mut scene = setting.scene;
    for mesh in scene.meshes.iter_mut().filter(|m| m.material == emitter) {
        mesh.uvs[0] = mesh.positions.iter().map(|p| Vec2::new((p.x - 2.2) / 1.6, (p.z - 1.2) / 1.6)).collect();
    }
    let goal = Goal {
        geometry: TargetGeometry::Surface(&ceiling.triangles),
        quantity: Quantity::Outgoing,
        target: Vec3::ONE,
        aspect: Aspect::Colour,
        constraint: [Constraint::Exactly; 3],
        weight: 1.0,
    };
    let (scene, monitor) = (Arc::new(scene), Monitor::default());
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
