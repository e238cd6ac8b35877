//! Tests of scenes a million metres from the origin, which must render as at the origin.

use super::*;

/// A room with a table, a lamp and a point light. Its coordinates are exact even a million metres from the origin.
pub(super) fn room(at: Vec3) -> (Scene, Camera) {
    let boxed = |low: Vec3, size: Vec3, material| {
        let (x, y, z) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
        let (low, high) = (low + at, low + size + at);
        [
            Mesh::parallelogram(low, z, x, material),
            Mesh::parallelogram(low, x, y, material),
            Mesh::parallelogram(low, y, z, material),
            Mesh::parallelogram(high, -x, -z, material),
            Mesh::parallelogram(high, -y, -x, material),
            Mesh::parallelogram(high, -z, -y, material),
        ]
    };
    let mut meshes = boxed(Vec3::ZERO, Vec3::new(6.0, 3.0, 4.0), 0).to_vec();
    meshes.extend(boxed(Vec3::new(2.0, 0.0, 1.0), Vec3::new(1.0, 0.75, 1.5), 1));
    meshes.push(Mesh::parallelogram(Vec3::new(2.5, 2.875, 1.5) + at, Vec3::X, Vec3::Z, 2));
    let scene = Scene {
        meshes,
        materials: vec![
            matt(0.7, 0.0),
            Material { metallic: 0.0, roughness: 0.4, ..Material::default() },
            matt(0.0, 90.0),
        ],
        lights: vec![PunctualLight::Point { position: Vec3::new(5.0, 1.5, 3.5) + at, intensity: Vec3::splat(5.0) }],
        ..Scene::default()
    };
    let mut camera = Camera::look_at(Vec3::new(5.5, 1.75, 3.75), Vec3::new(2.0, 1.0, 1.0), 1.0);
    camera.position += at;
    (scene, camera)
}

#[test]
fn a_room_a_million_metres_away_looks_the_same_as_at_the_origin() {
    let outputs = Outputs { aovs: vec![Aov::Depth, Aov::Position], ..Outputs::default() };
    let params = Params { width: 32, height: 24, samples: 16, outputs, ..Params::default() };
    let film = |at: Vec3| {
        let (scene, camera) = room(at);
        render(&world(scene), &camera, &params)
    };
    let home = film(Vec3::ZERO);
    let mean = home.beauty.data.iter().sum::<f32>() / home.beauty.data.len() as f32;
    let max = |a: &Image, b: &Image| a.data.iter().zip(&b.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    for at in [Vec3::X * 1_048_576.0, Vec3::new(-1_048_576.0, 1_048_576.0, 524_288.0)] {
        let away = film(at);
        let off = max(&home.beauty, &away.beauty);
        assert!(off <= 1e-5 * mean, "{at}: {off} of {mean}");
        assert!(max(&home.layers[0].image, &away.layers[0].image) <= 1e-5, "depths");
        for (p, q) in home.layers[1].image.data.chunks(3).zip(away.layers[1].image.data.chunks(3)) {
            // The positions agree up to the resolution of f32 at that distance.
            let off = (Vec3::from_slice(q) - (Vec3::from_slice(p) + at)).abs().max_element();
            assert!(off <= 0.125, "{at}: positions off by {off}");
        }
    }
}

#[test]
fn rays_and_points_cross_over_in_the_coordinates_of_the_scene() {
    let at = Vec3::X * 1_048_576.0;
    let (scene, camera) = room(at);
    let world = world(scene);
    let hit = world.accel().closest(&world.ray(camera.position, Vec3::NEG_Y), |_| true).unwrap();
    assert!((hit.t - 1.75).abs() < 1e-6, "{}", hit.t);
    let vertex = Vertex::of_hit(&world, &hit);
    let position = world.in_scene(vertex.position);
    assert!(position.distance(Vec3::new(5.5, 0.0, 3.75) + at) < 1e-6, "{position}");
}
