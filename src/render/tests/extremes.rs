//! Tests of extreme sizes, positions and light intensities.

use super::*;

#[test]
fn scale_changes_nothing() {
    let irradiance_at = |scale: f32| {
        let mut room = inward_sphere(1.0, 0);
        room.positions.iter_mut().for_each(|p| *p *= scale);
        let lamp =
            Mesh::parallelogram(Vec3::new(-0.2, 0.5, -0.2) * scale, Vec3::X * 0.4 * scale, Vec3::Z * 0.4 * scale, 1);
        let table =
            Mesh::parallelogram(Vec3::new(-0.3, -0.2, -0.3) * scale, Vec3::Z * 0.6 * scale, Vec3::X * 0.6 * scale, 0);
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

const SMALL: fn() -> Params = || Params { width: 24, height: 16, samples: 16, ..Params::default() };

/// The scene of [`everything`], enlarged by `scale`, with lights that are brighter by the factor `light`. The intensity
/// of the point light is also multiplied by `scale`², so that the illuminance of surfaces does not depend on `scale`.
fn grown(scale: f32, light: f32) -> Scene {
    let mut scene = everything();
    scene.meshes.iter_mut().flat_map(|m| &mut m.positions).for_each(|p| *p *= scale);
    scene.materials.iter_mut().for_each(|m| m.emission *= light);
    scene.lights = vec![PunctualLight::Point {
        position: Vec3::new(0.5, 0.5, 1.0) * scale,
        intensity: Vec3::splat(20.0) * light * scale * scale,
    }];
    scene.environment = Some(Environment::Constant(Vec3::splat(light)));
    scene
}

fn grown_viewer(scale: f32) -> Camera {
    let camera = viewer();
    Camera { position: camera.position * scale, ..camera }
}

/// Returns the share of values at which `a` and `b / scale` differ by more than rounding. The tolerance is 1/1000 of
/// the value in `a`, or of the mean of `a` if that is larger.
fn differing(a: &Image, b: &Image, scale: f32) -> f64 {
    let mean = a.data.iter().sum::<f32>() / a.data.len() as f32;
    let differs = |(a, b): (&f32, &f32)| (a - b / scale).abs() > 1e-3 * a.max(mean);
    a.data.iter().zip(&b.data).filter(|&(a, b)| differs((a, b))).count() as f64 / a.data.len() as f64
}

#[test]
fn lamps_of_any_brightness_make_the_same_image() {
    let unit = render(&world(grown(1.0, 1.0)), &viewer(), &SMALL());
    // Scale all lights by about 1e-9 and by about 1e9. The factors are powers of two, so that scaling is exact.
    for light in [2f32.powi(-30), 2f32.powi(30)] {
        let film = render(&world(grown(1.0, light)), &viewer(), &SMALL());
        assert_eq!(differing(&unit.beauty, &film.beauty, light), 0.0, "{light}");
        assert_eq!(differing(&unit.variance, &film.variance, light * light), 0.0, "{light}");
        assert!((film.error / unit.error - 1.0).abs() < 1e-5);
    }
}

#[test]
fn scenes_of_any_size_make_the_same_image() {
    let unit = render(&world(grown(1.0, 1.0)), &viewer(), &SMALL());
    for scale in [2f32.powi(-13), 1e-4, 1e3, 2f32.powi(20), 1e6] {
        let film = render(&world(grown(scale, 1.0)), &grown_viewer(scale), &SMALL());
        // A rounded coordinate occasionally changes a path.
        let share = differing(&unit.beauty, &film.beauty, 1.0);
        assert!(share < 0.03, "scale {scale}: {share}");
        assert!((film.error / unit.error - 1.0).abs() < 0.1);
    }
}

/// A room with a table and a lamp under its ceiling, and a camera in it.
fn room() -> (Scene, Camera) {
    let (x, y, z) = (Vec3::X * 4.0, Vec3::Y * 3.0, Vec3::Z * 4.0);
    let meshes = vec![
        Mesh::parallelogram(Vec3::ZERO, z, x, 0),
        Mesh::parallelogram(y, x, z, 0),
        Mesh::parallelogram(Vec3::ZERO, x, y, 0),
        Mesh::parallelogram(z, y, x, 0),
        Mesh::parallelogram(Vec3::ZERO, y, z, 0),
        Mesh::parallelogram(x, z, y, 0),
        Mesh::parallelogram(Vec3::new(1.0, 2.75, 1.0), Vec3::X * 1.5, Vec3::Z, 1),
        Mesh::parallelogram(Vec3::new(1.0, 1.0, 0.5), Vec3::X * 2.0, Vec3::new(0.0, 0.5, 0.5), 0),
    ];
    let scene = Scene { meshes, materials: vec![matt(0.6, 0.0), matt(0.0, 100.0)], ..Scene::default() };
    (scene, Camera::look_at(Vec3::new(2.0, 1.5, 3.5), Vec3::new(2.0, 1.5, 0.0), 1.2))
}

#[test]
fn one_pixel_and_very_wide_and_very_high_images() {
    let world = world(everything());
    for (width, height) in [(1, 1), (16_384, 1), (1, 16_384)] {
        let params = Params { width, height, samples: 2, ..Params::default() };
        let film = render(&world, &viewer(), &params);
        assert!(film.paths.data.iter().all(|&n| n == 2.0));
        assert_eq!(film.beauty.count_non_finite() + film.variance.count_non_finite(), 0);
        assert!(film.beauty.data.iter().any(|&v| v > 0.0));
    }
    // The middle columns of a wide image agree, up to noise, with a narrow image that has the same number of rows.
    let params = |width| Params { width, height: 8, samples: 4096, ..Params::default() };
    let (narrow, wide) = (render(&world, &viewer(), &params(2)), render(&world, &viewer(), &params(4)));
    for y in 0..8 {
        for (a, b) in [(0, 1), (1, 2)] {
            let (p, q) = (narrow.beauty.pixel(a, y)[0], wide.beauty.pixel(b, y)[0]);
            let error = (narrow.variance.pixel(a, y)[0] + wide.variance.pixel(b, y)[0]).sqrt();
            assert!((p - q).abs() < 8.0 * error, "{p} and {q} ± {error}");
        }
    }
}

#[test]
fn an_empty_scene_is_black_or_shows_the_sky() {
    let camera = Camera::look_at(Vec3::ZERO, Vec3::X, 1.0);
    let params = Params { width: 1, height: 1, samples: 1, ..Params::default() };
    let film = render(&world(Scene::default()), &camera, &params);
    assert_eq!(film.beauty.data, [0.0; 3]);
    let sky = Scene { environment: Some(Environment::Constant(Vec3::new(1.0, 2.0, 3.0))), ..Scene::default() };
    assert_eq!(render(&world(sky), &camera, &params).beauty.data, [1.0, 2.0, 3.0]);
    let nowhere = SurfacePoint { mesh: 3, triangle: 0, barycentric: Vec2::ZERO, front: true };
    assert_eq!(measure(&world(Scene::default()), &nowhere).0, 0.0);
}

#[test]
fn without_light_every_target_is_reached_at_once() {
    let mut scene = everything();
    scene.materials.iter_mut().for_each(|m| m.emission = Vec3::ZERO);
    scene.lights.clear();
    scene.environment = None;
    let params = Params { samples: 1 << 20, target_error: 1e-3, pixel_error: 1e-3, ..SMALL() };
    let film = render(&world(scene), &viewer(), &params);
    assert!(film.beauty.data.iter().chain(&film.variance.data).all(|&v| v == 0.0));
    assert_eq!((film.error, film.samples), (0.0, 16));
}

#[test]
fn a_camera_inside_a_wall_or_on_it_sees_something_finite() {
    let scene = everything();
    // Test a camera in the plane of the lamp, at a corner of the lamp, on the sphere's wall, and outside the scene.
    for position in [Vec3::new(0.1, 1.2, 0.2), Vec3::new(-1.0, 1.2, -1.0), Vec3::Y * 2.0, Vec3::splat(90.0)] {
        let camera = Camera { position, ..Camera::look_at(Vec3::ZERO, Vec3::new(0.3, -0.4, -1.0), 1.2) };
        let film = render(&world(scene.clone()), &camera, &SMALL());
        assert_eq!(film.beauty.count_non_finite(), 0);
        assert_eq!(film.discarded, 0);
    }
    // The inside of a closed body is dark if it contains no light.
    let solid = Scene {
        meshes: vec![inward_sphere(1.0, 0), Mesh::parallelogram(Vec3::new(-1.0, 3.0, -1.0), Vec3::X, Vec3::Z, 1)],
        materials: vec![matt(0.9, 0.0), matt(0.0, 1e6)],
        ..Scene::default()
    };
    let film = render(&world(solid), &Camera::look_at(Vec3::ZERO, Vec3::X, 1.0), &SMALL());
    let leaks = film.beauty.data.iter().filter(|&&v| v > 0.0).count();
    assert_eq!(leaks, 0);
}

#[test]
fn closed_white_rooms_end_with_the_right_energy() {
    // In a closed room with white walls of albedo 1 and a lamp that reflects nothing, all radiances equal the radiance
    // of the lamp.
    let (mut scene, camera) = room();
    scene.materials[0] = matt(1.0, 0.0);
    // Let the lamp cover nearly the whole ceiling. It emits on both sides.
    scene.meshes[6] = Mesh::parallelogram(Vec3::new(0.25, 2.75, 0.25), Vec3::X * 3.5, Vec3::Z * 3.5, 1);
    let film = render(&world(scene), &camera, &Params { samples: 128, ..SMALL() });
    assert_mean(&film, 100.0);
    // Test emissive walls of albedo 0.99, whose radiance is the emission divided by 1 - albedo.
    let scene = Scene { meshes: vec![inward_sphere(2.0, 0)], materials: vec![matt(0.99, 1.0)], ..Scene::default() };
    let camera = Camera::look_at(Vec3::new(0.3, 0.1, 0.2), Vec3::X, 1.0);
    let film = render(&world(scene), &camera, &Params { samples: 128, width: 8, height: 8, ..SMALL() });
    assert_mean(&film, 100.0);
    // Test emissive walls of albedo 0.998: a share of 0.998^1000 = 0.135 of their light has scattered more than a
    // thousand times.
    let scene = Scene { meshes: vec![inward_sphere(2.0, 0)], materials: vec![matt(0.998, 0.2)], ..Scene::default() };
    let film = render(&world(scene), &camera, &Params { samples: 128, width: 8, height: 8, ..SMALL() });
    assert_mean(&film, 100.0);
}

fn assert_mean(film: &Film, expected: f64) {
    let n = film.beauty.data.len() as f64;
    let mean = film.beauty.data.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
    // The channels are equal, so only a third of the values are independent.
    let error = film.variance.data.iter().step_by(3).map(|&v| f64::from(v)).sum::<f64>().sqrt() / (n / 3.0);
    assert!(error < 0.02 * expected, "{error}");
    assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected, "{mean} ± {error}, expected {expected}");
}

#[test]
fn surfaces_in_the_same_place_are_one_or_the_other() {
    let scene = |materials: [usize; 2]| Scene {
        meshes: materials
            .map(|m| Mesh::parallelogram(Vec3::new(-3.0, -3.0, -2.0), Vec3::X * 6.0, Vec3::Y * 6.0, m))
            .to_vec(),
        materials: vec![matt(0.2, 0.0), matt(0.8, 0.0)],
        environment: Some(Environment::Constant(Vec3::ONE)),
        ..Scene::default()
    };
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 1.0);
    let film = |materials| render(&world(scene(materials)), &camera, &SMALL());
    let both = film([0, 1]).beauty;
    // Each path hits one of the two coincident surfaces, and neither surface shadows the other. The value of each pixel
    // therefore lies between its values in two renders with the same paths: one with two dark surfaces, one with two
    // bright surfaces.
    let (dark, bright) = (film([0, 0]).beauty, film([1, 1]).beauty);
    for ((&d, &v), &b) in dark.data.iter().zip(&both.data).zip(&bright.data) {
        assert!(v >= d * 0.99999 && v <= b * 1.00001, "{d} {v} {b}");
    }
    // The dark surfaces reflect a fifth of the light of the sky, the bright surfaces four fifths.
    for (image, albedo) in [(&dark, 0.2), (&bright, 0.8)] {
        let mean = image.data.iter().map(|&v| f64::from(v)).sum::<f64>() / image.data.len() as f64;
        assert!((mean / albedo - 1.0).abs() < 0.01, "{mean} of {albedo}");
    }
    assert_eq!(both, film([0, 1]).beauty);
}

#[test]
fn triangles_without_area_change_nothing_and_needles_little() {
    let plain_world = world(everything());
    let plain = render(&plain_world, &viewer(), &SMALL());
    let mut scene = everything();
    let points = [Vec3::new(-1.0, 0.0, -0.5), Vec3::ZERO, Vec3::new(1.0, 0.0, 0.5)];
    let flat = |positions: [Vec3; 3], material| Mesh {
        material,
        positions: positions.to_vec(),
        uvs: [vec![Vec2::ZERO; 3], Vec::new()],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    // Add three degenerate triangles, two of them emissive.
    scene.meshes.push(flat(points, 0));
    scene.meshes.push(flat([points[0]; 3], 1));
    scene.meshes.push(flat([points[0], points[0], points[2]], 1));
    let flattened = world(scene.clone());
    // The sphere already has degenerate triangles at its poles.
    let flat_triangles = plain_world.requirements().flat_triangles + 3;
    assert_eq!(flattened.requirements().flat_triangles, flat_triangles);
    let film = render(&flattened, &viewer(), &SMALL());
    assert_eq!(film.discarded, 0);
    let share = differing(&plain.beauty, &film.beauty, 1.0);
    assert!(share < 0.03, "{share}");
    // Test a triangle that is a million times as long as it is wide.
    scene.meshes.push(flat([points[0], points[2], points[2] + Vec3::Y * 2e-6], 4));
    let film = render(&world(scene), &viewer(), &SMALL());
    assert_eq!(film.beauty.count_non_finite(), 0);
    let share = differing(&plain.beauty, &film.beauty, 1.0);
    assert!(share < 0.1, "{share}");
}
