//! Tests of scenes that lie far from the origin, but have an object near the origin, and of lamps of extreme shape or
//! brightness.

use super::place::room;
use super::*;

/// A small square of ground with a corner at a position.
fn tile(at: Vec3) -> Mesh {
    Mesh::parallelogram(at, Vec3::Z * 0.25, Vec3::X * 0.25, 0)
}

#[test]
fn an_object_left_at_the_origin_does_not_blur_the_building() {
    let params = Params { width: 32, height: 24, samples: 16, ..Params::default() };
    let film = |at: Vec3, outlier: Vec3| {
        let (mut scene, camera) = room(at);
        scene.meshes.push(tile(outlier));
        render(&world(scene), &camera, &params).beauty
    };
    let mean = |image: &Image| image.data.iter().sum::<f32>() / image.data.len() as f32;
    for distance in [1024.0, 131_072.0, 1_048_576.0] {
        let at = Vec3::new(distance, 0.0, -distance);
        let home = film(Vec3::ZERO, -at);
        let away = film(at, Vec3::ZERO);
        let off = home.data.iter().zip(&away.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off <= 1e-4 * mean(&home), "{at}: {off} of {}, mean {}", mean(&home), mean(&away));
    }
    // Compare two renders of one room: far from the origin with an object at the origin, and alone at the origin.
    let (scene, camera) = room(Vec3::ZERO);
    let alone = render(&world(scene), &camera, &Params { samples: 256, ..params.clone() });
    let (mut scene, camera) = room(Vec3::X * 131_072.0);
    scene.meshes.push(tile(Vec3::ZERO));
    let film = render(&world(scene), &camera, &Params { samples: 256, ..params });
    let ratio = mean(&film.beauty) / mean(&alone.beauty);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

#[test]
fn points_in_air_see_the_light_near_them_however_far_the_scene_extends() {
    let lux = |at: Vec3, outlier: Option<Vec3>| {
        let (mut scene, _) = room(at);
        scene.meshes.extend(outlier.map(tile));
        let world = world(scene);
        let mut sum = ContributionSum(DVec3::ZERO);
        // Measure at a point 8 mm above the table.
        let point = Vec3::new(2.5, 0.7578125, 1.5) + at;
        (0..1024).for_each(|i| irradiance_in_air(&world, point, Vec3::Y, 1, i, &mut sum));
        sum.0.x / 1024.0
    };
    let (home, away) = (lux(Vec3::ZERO, None), lux(Vec3::X * 131_072.0, Some(Vec3::ZERO)));
    assert!((away / home - 1.0).abs() < 0.01, "{away} and {home}");
}

#[test]
fn lamps_as_thin_as_a_hair_give_their_whole_light() {
    // The lamp is 3 m long and about 0.01 mm wide; every coordinate is exact in f32.
    let width = 2f32.powi(-17);
    let floor = Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let receiver = centre_of(0);
    for (low, side) in [(0.0, 1.0), (1.0, 1.0), (-0.5, 1.0)] {
        let lamp = Mesh::parallelogram(Vec3::new(low, 1.5, -1.5), Vec3::X * width, Vec3::Z * 3.0 * side, 1);
        let scene = Scene {
            meshes: vec![floor.clone(), lamp],
            materials: vec![matt(0.3, 0.0), Material { double_sided: false, ..matt(0.0, 1e6) }],
            ..Scene::default()
        };
        let world = world(scene);
        let at = Vertex::new(&world, world.id(0, 0), receiver.barycentric).position.as_dvec3();
        // Treat the lamp as a line of light, and integrate along it the product of both cosines, divided by the
        // squared distance.
        let steps = 200_000;
        let integral: f64 = (0..steps)
            .map(|i| {
                let z = -1.5 + 3.0 * (f64::from(i) + 0.5) / f64::from(steps);
                let d = DVec3::new(f64::from(low) + f64::from(width) / 2.0, 1.5, z) - at;
                d.y * d.y / d.length_squared().powi(2) * 3.0 / f64::from(steps)
            })
            .sum();
        let expected = 1e6 * f64::from(width) * integral;
        let (mean, error) = measure(&world, &receiver);
        assert!(error < 0.005 * expected, "{error} of {expected}");
        assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected, "{mean} ± {error}, expected {expected}");
    }
}

#[test]
fn a_picture_of_a_room_lit_by_a_hair_has_its_light() {
    let (scene, camera) = room(Vec3::ZERO);
    let lit = |corner: Vec3, u: Vec3, v: Vec3, nits: f32| {
        let mut scene = scene.clone();
        scene.lights.clear();
        scene.materials[2] = Material { double_sided: false, ..matt(0.0, nits) };
        *scene.meshes.last_mut().unwrap() = Mesh::parallelogram(corner, u, v, 2);
        let params = Params { width: 32, height: 24, samples: 1024, ..Params::default() };
        let film = render(&world(scene), &camera, &params);
        let mean = film.beauty.data.iter().map(|&v| f64::from(v)).sum::<f64>();
        let error = film.variance.data.iter().step_by(3).map(|&v| f64::from(v)).sum::<f64>().sqrt() * 3.0;
        (mean, error)
    };
    // Both lamps have the same flux and lie along the same line.
    let (low, x) = (Vec3::new(2.5, 2.5, 0.5), Vec3::X);
    let thin = lit(low, x * 2f32.powi(-16), Vec3::Z * 3.0, 65536.0 * 90.0);
    let wide = lit(low - x / 128.0, x / 64.0, Vec3::Z * 3.0, 64.0 * 90.0);
    let off = (thin.0 - wide.0).abs();
    assert!(off < 4.0 * thin.1.hypot(wide.1) + 0.002 * wide.0, "{thin:?} {wide:?}, {}", thin.0 / wide.0);
}

#[test]
fn a_lamp_whose_lit_texels_are_outside_its_triangles_is_no_light() {
    let mut image = Image::new(8, 8, 3).unwrap();
    image.pixel_mut(7, 7).copy_from_slice(&[1.0; 3]);
    let lamp = Material { emission_texture: Some(TextureRef::new(0)), ..matt(0.0, 90.0) };
    let mut mesh = Mesh::parallelogram(Vec3::Y, Vec3::X, Vec3::Z, 0);
    mesh.uvs[0].iter_mut().for_each(|uv| *uv *= 0.5);
    let dark = Scene {
        meshes: vec![mesh.clone()],
        materials: vec![lamp],
        textures: vec![Texture::new("lamps", image)],
        ..Scene::default()
    };
    let found = world(dark.clone());
    assert!(!found.requirements().surfaces && !found.requirements().textured_surfaces);
    let mut lit = dark;
    lit.meshes[0].uvs[0].iter_mut().for_each(|uv| *uv *= 2.0);
    assert!(world(lit).requirements().textured_surfaces);
}

#[test]
fn light_too_bright_to_be_summed_is_refused_by_name() {
    let base = everything();
    let refused = |change: &dyn Fn(&mut Scene), word: &str| {
        let mut scene = base.clone();
        change(&mut scene);
        let error = World::build(Arc::new(scene), Monitor::default().job()).err().expect(word);
        assert!(error.message.contains(word) && error.message.contains("1e15"), "{}", error.message);
    };
    refused(&|s| s.materials[1].emission = Vec3::splat(3e38), "emission");
    refused(&|s| s.textures[0].image.data[20] = 1e14, "material 1");
    refused(&|s| s.lights = vec![PunctualLight::Point { position: Vec3::Y, intensity: Vec3::splat(3e38) }], "light 0");
    refused(&|s| s.environment = Some(Environment::Constant(Vec3::splat(3e38))), "environment");
    refused(
        &|s| s.environment = Some(Environment::Image(Image::from_fn(4, 2, |_, _| [1e16; 3]).unwrap())),
        "environment",
    );
    // The brightest lights that are allowed give a finite image with a finite error.
    let mut scene = base.clone();
    scene.materials[1].emission = Vec3::splat(1e15);
    scene.lights = vec![PunctualLight::Point { position: Vec3::Y, intensity: Vec3::splat(1e15) }];
    scene.environment = Some(Environment::Constant(Vec3::splat(1e15)));
    let params = Params { width: 24, height: 16, samples: 16, ..Params::default() };
    let film = render(&world(scene), &viewer(), &params);
    assert_eq!((film.beauty.count_non_finite(), film.variance.count_non_finite(), film.discarded), (0, 0, 0));
    assert!(film.error.is_finite(), "{}", film.error);
}
