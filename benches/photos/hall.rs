//! The target scene of every transfer: a hall so large that its ceiling shows a photo's pattern several times.

use crate::harness::scenes::sheet;
use glam::Vec3;
use luxfer::scene::{Camera, Material, Mesh, Scene};

/// Width, height and depth in metres. At a plane distance of 1.2 m, the ceiling is 13 by 10 such distances.
const SIZE: Vec3 = Vec3::new(16.0, 3.2, 12.0);
/// Boxes that stand in the hall: their lower and upper corners.
const BOXES: [[Vec3; 2]; 4] = [
    [Vec3::new(3.0, 0.0, 2.0), Vec3::new(5.5, 0.9, 3.2)],
    [Vec3::new(9.0, 0.0, 4.0), Vec3::new(10.0, 1.8, 6.5)],
    [Vec3::new(6.0, 0.0, 7.5), Vec3::new(7.2, 0.7, 8.7)],
    [Vec3::new(12.5, 0.0, 8.0), Vec3::new(13.1, 3.2, 8.6)],
];

/// The hall, without lights; its ceiling is the object `Ceiling`.
pub fn hall() -> Scene {
    let mut scene = Scene::default();
    let paints = [Vec3::splat(0.8), Vec3::new(0.62, 0.58, 0.52), Vec3::new(0.35, 0.28, 0.2), Vec3::splat(0.45)];
    for (i, colour) in paints.into_iter().enumerate() {
        scene.materials.push(Material::diffuse(&format!("Paint {i}"), colour));
    }
    let Vec3 { x, y, z } = SIZE;
    let (u, v, w) = (Vec3::X * x, Vec3::Y * y, Vec3::Z * z);
    scene.meshes = vec![
        sheet("Ceiling", 0, 1, |s, t| v + u * s + w * t),
        sheet("Floor", 2, 1, |s, t| w + u * s - w * t),
        sheet("Wall", 1, 1, |s, t| u * s + v * t),
        sheet("Wall", 1, 1, |s, t| w + u - u * s + v * t),
        sheet("Wall", 1, 1, |s, t| w - w * s + v * t),
        sheet("Wall", 1, 1, |s, t| u + w * s + v * t),
    ];
    scene.meshes.extend(BOXES.iter().flat_map(|corners| cuboid("Box", 3, *corners)));
    scene.cameras.push(Camera::look_at(Vec3::new(0.8, 1.5, 11.2), Vec3::new(10.0, 1.9, 2.0), 60f32.to_radians()));
    scene
}

/// The six sides of a box, with their front faces outwards.
pub fn cuboid(name: &str, material: usize, [low, high]: [Vec3; 2]) -> Vec<Mesh> {
    let d = high - low;
    let (x, y, z) = (Vec3::X * d.x, Vec3::Y * d.y, Vec3::Z * d.z);
    let sides =
        [(low + z, x, y), (low + x, -x, y), (low + x + z, -z, y), (low, z, y), (low + y + z, x, -z), (low, x, z)];
    sides.map(|(corner, u, v)| Mesh { name: name.into(), ..Mesh::parallelogram(corner, u, v, material) }).into()
}
