//! Tests of irradiance, against closed forms and against an estimate by BSDF sampling alone.

use super::*;
use glam::Vec4;

#[test]
fn irradiance_under_a_rectangle_is_its_form_factor() {
    let floor = Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    // Test a lamp overhead that faces down: four quarters of 0.5 × 0.75 m at a height of 1.5 m, 100 cd/m².
    let lamp = Mesh::parallelogram(Vec3::new(-0.5, 1.5, -0.75), Vec3::X, Vec3::Z * 1.5, 1);
    let scene = Scene {
        meshes: vec![floor.clone(), lamp],
        materials: vec![matt(0.3, 0.0), Material { double_sided: false, ..matt(0.0, 100.0) }],
        ..Scene::default()
    };
    let expected = 100.0 * std::f64::consts::PI * 4.0 * parallel_form_factor(0.5, 0.75, 1.5);
    assert_close(&world(scene.clone()), &centre_of(0), expected);
    // The back of the lamp is dark, except for rounding in the common plane of its two triangles.
    let above = SurfacePoint { front: false, ..centre_of(1) };
    assert!(measure(&world(scene.clone()), &above).0 < 1e-6);
    // Test a vertical window that stands on the plane of the floor: 0.8 m to each side, 1.2 m high, 0.7 m away.
    let window = Mesh::parallelogram(Vec3::new(0.7, 0.0, -0.8), Vec3::Z * 1.6, Vec3::Y * 1.2, 1);
    let scene = Scene { meshes: vec![floor, window], ..scene };
    let expected = 100.0 * std::f64::consts::PI * 2.0 * perpendicular_form_factor(0.8, 1.2, 0.7);
    assert_close(&world(scene), &centre_of(0), expected);
}

#[test]
fn a_lit_texel_is_a_lamp_of_its_size_however_the_texture_wraps() {
    let floor = Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let mut image = Image::new(8, 8, 3).unwrap();
    image.pixel_mut(5, 2).copy_from_slice(&[1.0, 0.5, 0.25]);
    let lamp = Material {
        emission: Vec3::splat(5000.0),
        emission_texture: Some(TextureRef::new(0)),
        double_sided: false,
        ..matt(0.0, 0.0)
    };
    let textured = Mesh::parallelogram(Vec3::new(-1.0, 1.0, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0, 1);
    let small = Mesh::parallelogram(Vec3::new(-1.0 + 1.25, 1.0, -0.5), Vec3::X * 0.25, Vec3::Z * 0.25, 2);
    let scene = Scene {
        meshes: vec![floor.clone(), textured.clone()],
        materials: vec![matt(0.5, 0.0), lamp, Material { double_sided: false, ..matt(0.0, 5000.0) }],
        textures: vec![Texture::new("lamps", image)],
        ..Scene::default()
    };
    let (expected, error) =
        measure(&world(Scene { meshes: vec![floor.clone(), small], ..scene.clone() }), &centre_of(0));
    let (mean, own_error) = measure(&world(scene.clone()), &centre_of(0));
    assert!((mean - expected).abs() < 4.0 * error.hypot(own_error), "{mean} and {expected}");
    // The standard error is less than twice the standard error of the separate lamp, because no light samples go to
    // dark texels.
    assert!(own_error < 2.0 * error, "{own_error} and {error}");

    // Shift or mirror the texture coordinates; the wrap mode must map the lit texel to the same place. With
    // `Wrap::Mirror`, the copy of the texture between 1 and 2 is mirrored. Reading u and v from 2 down to 1 mirrors it
    // again, which restores the original.
    for (wrap, from, to) in [
        (crate::scene::Wrap::Repeat, Vec2::new(3.0, -2.0), Vec2::new(4.0, -1.0)),
        (crate::scene::Wrap::Mirror, Vec2::new(2.0, 2.0), Vec2::new(1.0, 1.0)),
        (crate::scene::Wrap::Clamp, Vec2::ZERO, Vec2::ONE),
    ] {
        let mut moved = scene.clone();
        moved.textures[0].wrap = [wrap; 2];
        moved.meshes[1].uvs[0].iter_mut().for_each(|uv| *uv = from + (to - from) * *uv);
        let (mean, own_error) = measure(&world(moved), &centre_of(0));
        assert!((mean - expected).abs() < 4.0 * error.hypot(own_error), "{wrap:?}: {mean} and {expected}");
    }

    // If the texture coordinates of a triangle have no area, the whole triangle emits like the texel at these
    // coordinates.
    let mut flat = scene.clone();
    flat.meshes[1].uvs[0].iter_mut().for_each(|uv| *uv = Vec2::new(5.5, 2.5) / 8.0);
    let even = 5000.0 * std::f64::consts::PI * 4.0 * parallel_form_factor(1.0, 1.0, 1.0);
    assert_close(&world(flat), &centre_of(0), even);
}

#[test]
fn punctual_lights_follow_the_inverse_square_and_their_cones() {
    let floor = Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let lit = |light| {
        let scene = Scene {
            meshes: vec![floor.clone()],
            materials: vec![matt(0.5, 0.0)],
            lights: vec![light],
            ..Scene::default()
        };
        measure(&world(scene), &centre_of(0)).0
    };
    let close = |a: f64, b: f64| (a - b).abs() < 1e-4 * b;
    let position = Vec3::new(0.0, 3.0, 4.0);
    assert!(close(lit(PunctualLight::Point { position, intensity: Vec3::splat(500.0) }), 500.0 / 25.0 * 0.6));
    let direction = Vec3::new(0.0, -1.0, -1.0);
    let sun = PunctualLight::Directional { direction, illuminance: Vec3::splat(1000.0), half_angle: 0.0 };
    assert!(close(lit(sun), 1000.0 * 0.5f64.sqrt()));
    let spot = |towards: Vec3| PunctualLight::Spot {
        position,
        direction: towards - position,
        intensity: Vec3::splat(500.0),
        inner_angle: 0.1,
        outer_angle: 0.4,
    };
    assert!(close(lit(spot(Vec3::ZERO)), 500.0 / 25.0 * 0.6));
    assert_eq!(lit(spot(Vec3::new(0.0, 3.0, 0.0))), 0.0);
}

/// A disc lights a floor like a directional light. An edge through its centre hides half of its light. The eye sees its
/// luminance E / (π sin² α), also by a mirror; it sees nothing beside it, and nothing of parallel rays.
#[test]
fn discs_light_and_are_seen_as_their_luminance_demands() {
    let floor = Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let base = Scene { meshes: vec![floor.clone()], materials: vec![matt(0.0, 0.0)], ..Scene::default() };
    let disc = |towards: Vec3, half_angle: f32| {
        let direction = -towards.normalize();
        PunctualLight::Directional { direction, illuminance: Vec3::splat(1000.0), half_angle }
    };
    for half_angle in [0.0, 0.00465, 0.3] {
        let lit = Scene { lights: vec![disc(Vec3::new(0.4, 1.0, -0.3), half_angle)], ..base.clone() };
        assert_close(&world(lit), &centre_of(0), 1000.0 / 1.25f64.sqrt());
    }
    let screen = Mesh::parallelogram(Vec3::new(0.0, 1.0, -9.0), Vec3::X * 9.0, Vec3::Z * 18.0, 0);
    for half_angle in [0.00465, 0.3] {
        let meshes = vec![floor.clone(), screen.clone()];
        assert_close(
            &world(Scene { meshes, lights: vec![disc(Vec3::Y, half_angle)], ..base.clone() }),
            &centre_of(0),
            500.0,
        );
    }

    let seen = |meshes: Vec<Mesh>, half_angle: f32, origin: Vec3, direction: Vec3| {
        let mirror = Material { metallic: 1.0, roughness: 0.0, ..Material::default() };
        let lights = vec![disc(Vec3::Y, half_angle)];
        let world = world(Scene { meshes, materials: vec![mirror], lights, ..Scene::default() });
        let mut sum = ContributionSum(DVec3::ZERO);
        let length = path::PathLength { max_bounces: 8, roulette_weight: None };
        let ray = crate::accel::Ray::new(world.from_scene(origin), direction.normalize());
        let (mut sampler, mut sink) = (sampler::Sampler::new(1, 0), path::Contributions(&mut sum));
        path::trace(&world, ray, medium::Media::NONE, (0.5, 0.5), length, &mut sampler, &mut sink);
        sum.0.x
    };
    let luminance = 1000.0 / (std::f64::consts::PI * 0.1f64.sin().powi(2));
    let close = |value: f64| (value / luminance - 1.0).abs() < 1e-5;
    assert!(close(seen(Vec::new(), 0.1, Vec3::ZERO, Vec3::new(0.09, 1.0, 0.0))));
    assert_eq!(seen(Vec::new(), 0.1, Vec3::ZERO, Vec3::new(0.11, 1.0, 0.0)), 0.0);
    assert_eq!(seen(Vec::new(), 0.1, Vec3::ZERO, Vec3::new(0.05, -1.0, 0.0)), 0.0);
    assert_eq!(seen(Vec::new(), 0.0, Vec3::ZERO, Vec3::Y), 0.0);
    assert!(close(seen(vec![floor.clone()], 0.1, Vec3::Y, Vec3::new(0.05, -1.0, 0.0))));
}

#[test]
fn skies_light_a_floor_by_their_integral() {
    let floor = Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let base = Scene { meshes: vec![floor], materials: vec![matt(0.5, 0.0)], ..Scene::default() };
    let constant = Scene { environment: Some(Environment::Constant(Vec3::splat(7.0))), ..base.clone() };
    assert_close(&world(constant), &centre_of(0), 7.0 * std::f64::consts::PI);
    // With a sky proportional to the cosine of the zenith angle, E = 2π/3 times the zenith radiance, except for
    // interpolation between rows.
    let image =
        Image::from_fn(16, 256, |_, y| [((std::f32::consts::PI * (y as f32 + 0.5) / 256.0).cos()).max(0.0) * 3.0; 3]);
    let sky = Scene { environment: Some(Environment::Image(image.unwrap())), ..base.clone() };
    let (mean, error) = measure(&world(sky), &centre_of(0));
    let expected = 3.0 * std::f64::consts::TAU / 3.0;
    assert!((mean - expected).abs() < 4.0 * error + 2e-4 * expected, "{mean} ± {error}, expected {expected}");
    // Test a small sun among dark pixels, 30 degrees above the horizon towards -z.
    let mut image = Image::new(64, 32, 3).unwrap();
    image.pixel_mut(32, 10).fill(1e4);
    let sun = Scene { environment: Some(Environment::Image(image)), ..base };
    let world = world(sun);
    let (mean, error) = measure(&world, &centre_of(0));
    // Compare with a sum over directions of the same interpolated image.
    let environment = world.scene().environment.as_ref().unwrap();
    let n = 2000;
    let mut expected = 0.0;
    for i in 0..n {
        for j in 0..n {
            // Sum over the emissive part of the sky only.
            let (theta, phi) = (0.8 + 0.5 * (i as f64 + 0.5) / n as f64, 0.4 * (j as f64 + 0.5) / n as f64 - 0.2);
            let d = DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos()).as_vec3();
            let radiance = f64::from(environment::radiance(environment, d).x);
            expected += radiance * theta.cos() * theta.sin() * (0.5 / n as f64) * (0.4 / n as f64);
        }
    }
    assert!((mean - expected).abs() < 4.0 * error + 1e-3 * expected, "{mean} ± {error}, expected {expected}");
    assert!(error < 0.02 * mean, "the sun is found by its brightness: {error}");
}

#[test]
fn bsdf_sampling_alone_agrees_with_mis() {
    let floor = Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let lamp = Mesh::parallelogram(Vec3::new(-0.7, 0.8, -0.5), Vec3::X, Vec3::new(0.0, 0.3, 1.5), 1);
    let shade = Mesh::parallelogram(Vec3::new(-0.2, 0.4, -0.3), Vec3::X * 0.5, Vec3::Z * 0.5, 2);
    let image = Image::from_fn(5, 3, |x, y| [((x * 7 + y * 5) % 4) as f32]).unwrap();
    let shining = Material { emission_texture: Some(TextureRef::new(0)), ..matt(0.0, 10.0) };
    let scene = Scene {
        meshes: vec![floor, lamp, shade],
        materials: vec![matt(0.0, 0.0), shining, matt(0.0, 0.0)],
        textures: vec![Texture::new("lamp", image)],
        environment: Some(Environment::Constant(Vec3::splat(0.3))),
        ..Scene::default()
    };
    let world = world(scene);
    // All surfaces are black, so all light is direct. Sample cosine-weighted directions, and add the emission that
    // they hit.
    let n = 400_000;
    let (mut sum, mut square) = (0.0, 0.0);
    let mut rng = crate::rng::Rng::new(5, &[]);
    for _ in 0..n {
        let (u, angle) = (rng.next_f32(), std::f32::consts::TAU * rng.next_f32());
        let direction = Vec3::new(u.sqrt() * angle.cos(), (1.0 - u).sqrt(), u.sqrt() * angle.sin());
        let ray = crate::accel::Ray::new(Vec3::ZERO, direction);
        let floor = world.id(0, 0)..world.id(0, 0) + 2;
        let radiance = match world.accel().closest(&ray, |hit| !floor.contains(&hit.triangle)) {
            None => 0.3,
            Some(hit) => world.emitter_of(hit.triangle).map_or(0.0, |e| {
                let emitter = &world.lights().emitters.emitters[e];
                emitter.emission(world.scene(), Vec2::new(hit.u, hit.v)).0.x
            }),
        };
        let value = f64::from(radiance) * std::f64::consts::PI;
        sum += value;
        square += value * value;
    }
    let expected = sum / f64::from(n);
    let error = ((square / f64::from(n) - expected * expected) / f64::from(n)).sqrt();
    let (mean, own) = measure(&world, &centre_of(0));
    assert!((mean - expected).abs() < 4.0 * error.hypot(own), "{mean} ± {own} and {expected} ± {error}");
}

#[test]
fn light_through_a_clear_pane_is_the_same_by_either_strategy() {
    // A pane between lamp and floor attenuates the light by its Fresnel transmittance (0.96) and its colour.
    let floor = Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let lamp = Mesh::parallelogram(Vec3::new(-0.01, 2.0, -0.01), Vec3::X * 0.02, Vec3::Z * 0.02, 1);
    let pane = Mesh::parallelogram(Vec3::new(-1.0, 1.0, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0, 2);
    let glass = Material {
        base_color: Vec3::new(0.8, 0.9, 1.0),
        metallic: 0.0,
        roughness: 0.0,
        transmission: 1.0,
        ..Material::default()
    };
    let scene = Scene {
        meshes: vec![floor, lamp, pane],
        materials: vec![matt(0.0, 0.0), matt(0.0, 1e5), glass],
        ..Scene::default()
    };
    let expected = 1e5 * std::f64::consts::PI * 4.0 * parallel_form_factor(0.01, 0.01, 2.0) * 0.96 * 0.8;
    let (mean, error) = measure(&world(scene), &centre_of(0));
    assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected, "{mean} ± {error}, expected {expected}");
}

#[test]
fn every_contribution_names_the_light_it_came_from() {
    struct Sources(Vec<LightSource>, Vec4);
    impl PathSink for Sources {
        fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3) {
            assert!(importance.is_finite() && importance.min_element() >= 0.0 && emission.max_element() > 0.0);
            self.0.push(source);
            self.1 += (importance * emission).extend(1.0);
        }
    }
    let world = world(everything());
    let mut sink = Sources(Vec::new(), Vec4::ZERO);
    let point = SurfacePoint { mesh: 0, triangle: 241, barycentric: Vec2::splat(0.3), front: true };
    (0..2000).for_each(|i| irradiance(&world, &point, 9, i, &mut sink));
    let has = |f: &dyn Fn(&LightSource) -> bool| sink.0.iter().any(f);
    assert!(has(&|s| matches!(s, LightSource::Surface { mesh: 1, triangle: 0 | 1, .. })));
    assert!(has(&|s| *s == LightSource::Punctual(0)));
    assert!(!has(&|s| matches!(s, LightSource::Environment)), "the sphere is closed");
}
