//! Extremes of size, place and light.

use super::*;

#[test]
fn scale_changes_nothing() {
    let irradiance_at = |scale: f32| {
        let mut room = inward_sphere(1.0, 0);
        room.positions.iter_mut().for_each(|p| *p *= scale);
        let lamp = quad(Vec3::new(-0.2, 0.5, -0.2) * scale, Vec3::X * 0.4 * scale, Vec3::Z * 0.4 * scale, 1);
        let table = quad(Vec3::new(-0.3, -0.2, -0.3) * scale, Vec3::Z * 0.6 * scale, Vec3::X * 0.6 * scale, 0);
        let scene = Scene {
            meshes: vec![room, lamp, table],
            materials: vec![matt(0.6, 0.0), matt(0.0, 50.0)],
            ..Scene::default()
        };
        measure(&world(scene), &centre_of(2))
    };
    let (expected, error) = irradiance_at(1.0);
    for scale in [1e-4, 1e-2, 1e3, 1e6] {
        let (mean, own) = irradiance_at(scale);
        assert!((mean - expected).abs() < 4.0 * error.hypot(own), "scale {scale}: {mean} and {expected}");
    }
}

#[test]
fn nothing_at_all_is_black_or_the_sky() {
    let camera = Camera::look_at(Vec3::ZERO, Vec3::X, 1.0);
    let params = Params { width: 1, height: 1, samples: 1, ..Params::default() };
    let film = render(&world(Scene::default()), &camera, &params);
    assert_eq!(film.beauty.data, [0.0; 3]);
    let sky = Scene { environment: Some(Environment::Constant(Vec3::new(1.0, 2.0, 3.0))), ..Scene::default() };
    assert_eq!(render(&world(sky), &camera, &params).beauty.data, [1.0, 2.0, 3.0]);
    let nowhere = SurfacePoint { mesh: 3, triangle: 0, barycentric: Vec2::ZERO, front: true };
    assert_eq!(measure(&world(Scene::default()), &nowhere).0, 0.0);
}
