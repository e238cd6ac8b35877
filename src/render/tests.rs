//! Closed forms, invariants and statistics of the whole renderer.

use super::*;
use crate::exec::Pool;
use crate::job::Monitor;
use crate::scene::{AlphaMode, Environment, Material, Mesh, PunctualLight, Scene, Texture, TextureRef};
use glam::{DVec3, Vec4};
use std::sync::Arc;

/// A matt material without a reflecting top layer.
fn matt(albedo: f32, emission: f32) -> Material {
    Material { ior: 1.0, emission: Vec3::splat(emission), ..Material::diffuse("matt", Vec3::splat(albedo)) }
}

/// A parallelogram with texture coordinates from 0 to 1, facing `u × v`.
fn quad(corner: Vec3, u: Vec3, v: Vec3, material: usize) -> Mesh {
    Mesh {
        material,
        positions: vec![corner, corner + u, corner + u + v, corner + v],
        uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y], Vec::new()],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A closed sphere of triangles that faces its centre.
fn inward_sphere(radius: f32, material: usize) -> Mesh {
    let (rows, columns) = (12, 24);
    let mut mesh = Mesh { material, ..Mesh::default() };
    for i in 0..=rows {
        for j in 0..=columns {
            let polar = std::f32::consts::PI * i as f32 / rows as f32;
            let angle = std::f32::consts::TAU * (j % columns) as f32 / columns as f32;
            let sine = if i == rows { 0.0 } else { polar.sin() };
            mesh.positions.push(Vec3::new(sine * angle.cos(), polar.cos(), sine * angle.sin()) * radius);
        }
    }
    for i in 0..rows {
        for j in 0..columns {
            let a = i * (columns + 1) + j;
            let b = a + columns + 1;
            mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
        }
    }
    mesh
}

fn world(scene: Scene) -> World {
    World::build(Arc::new(scene), Monitor::default().job()).unwrap()
}

fn render(world: &World, camera: &Camera, params: &Params) -> Film {
    run(world, camera, params, Monitor::default().job(), &mut |_| ()).unwrap()
}

struct Sum(DVec3);

impl PathSink for Sum {
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3) {
        self.0 += (importance * emission).as_dvec3();
    }
}

/// Mean irradiance of a point (red) and its standard error, from independent scramblings.
fn measure(world: &World, point: &SurfacePoint) -> (f64, f64) {
    let (batches, per_batch) = (64, 256);
    let means: Vec<f64> = (0..batches)
        .map(|batch| {
            let mut sum = Sum(DVec3::ZERO);
            (0..per_batch).for_each(|i| irradiance(world, point, 1000 + batch, i, &mut sum));
            sum.0.x / f64::from(per_batch)
        })
        .collect();
    let mean = means.iter().sum::<f64>() / batches as f64;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (batches * (batches - 1)) as f64;
    (mean, variance.sqrt())
}

fn assert_close(world: &World, point: &SurfacePoint, expected: f64) {
    let (mean, error) = measure(world, point);
    // The second term allows for coordinates in f32.
    assert!((mean - expected).abs() < 4.0 * error + 1e-5 * expected, "{mean} ± {error}, expected {expected}");
}

/// A point in the middle of the first triangle of a mesh's front.
fn centre_of(mesh: u32) -> SurfacePoint {
    SurfacePoint { mesh, triangle: 0, barycentric: Vec2::new(0.0, 0.5), front: true }
}

#[test]
fn a_furnace_shines_as_its_albedo_demands() {
    for (albedo, samples) in [(0.0, 4), (0.5, 64), (0.9, 256)] {
        let scene =
            Scene { meshes: vec![inward_sphere(2.0, 0)], materials: vec![matt(albedo, 3.0)], ..Scene::default() };
        let camera = Camera::look_at(Vec3::new(0.3, 0.1, 0.2), Vec3::X, 1.0);
        let params = Params { width: 8, height: 8, samples, ..Params::default() };
        let film = render(&world(scene), &camera, &params);
        let mean = film.beauty.data.iter().map(|&v| f64::from(v)).sum::<f64>() / film.beauty.data.len() as f64;
        let expected = 3.0 / (1.0 - f64::from(albedo));
        let error = film.variance.data.iter().step_by(3).map(|&v| f64::from(v)).sum::<f64>().sqrt() / 64.0;
        assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected, "{mean} ± {error}, expected {expected}");
    }
}

/// Form factor from a small facet to a rectangle `a × b` at distance `c`, one corner on the facet's normal, parallel.
fn parallel_form_factor(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / p * (y / p).atan() + y / q * (x / q).atan()) / std::f64::consts::TAU
}

/// The same for a rectangle in a plane perpendicular to the facet's, at distance `c`, `b` high and `a` wide.
fn perpendicular_form_factor(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let r = 1.0 / (1.0 + y * y).sqrt();
    (x.atan() - r * (x * r).atan()) / std::f64::consts::TAU
}

#[test]
fn irradiance_under_a_rectangle_is_its_form_factor() {
    let floor = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    // Overhead: four quarters of 0.5 × 0.75 at 1.5 m, 100 cd/m², facing down.
    let lamp = quad(Vec3::new(-0.5, 1.5, -0.75), Vec3::X, Vec3::Z * 1.5, 1);
    let scene = Scene {
        meshes: vec![floor.clone(), lamp],
        materials: vec![matt(0.3, 0.0), Material { double_sided: false, ..matt(0.0, 100.0) }],
        ..Scene::default()
    };
    let expected = 100.0 * std::f64::consts::PI * 4.0 * parallel_form_factor(0.5, 0.75, 1.5);
    assert_close(&world(scene.clone()), &centre_of(0), expected);
    // The lamp's back is dark, but for the rounding of its two triangles' common plane.
    let above = SurfacePoint { front: false, ..centre_of(1) };
    assert!(measure(&world(scene.clone()), &above).0 < 1e-6);
    // A window beside it: 0.8 to each side, 1.2 high, standing 0.7 away on the floor's plane.
    let window = quad(Vec3::new(0.7, 0.0, -0.8), Vec3::Z * 1.6, Vec3::Y * 1.2, 1);
    let scene = Scene { meshes: vec![floor, window], ..scene };
    let expected = 100.0 * std::f64::consts::PI * 2.0 * perpendicular_form_factor(0.8, 1.2, 0.7);
    assert_close(&world(scene), &centre_of(0), expected);
}

#[test]
fn a_lit_texel_is_a_lamp_of_its_size_however_the_texture_wraps() {
    let floor = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let mut image = Image::new(8, 8, 3).unwrap();
    image.pixel_mut(5, 2).copy_from_slice(&[1.0, 0.5, 0.25]);
    let lamp = Material {
        emission: Vec3::splat(5000.0),
        emission_texture: Some(TextureRef::new(0)),
        double_sided: false,
        ..matt(0.0, 0.0)
    };
    let textured = quad(Vec3::new(-1.0, 1.0, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0, 1);
    let small = quad(Vec3::new(-1.0 + 1.25, 1.0, -0.5), Vec3::X * 0.25, Vec3::Z * 0.25, 2);
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
    // As precise as the lamp alone: the dark texels cost nothing.
    assert!(own_error < 2.0 * error, "{own_error} and {error}");

    // The same texel reached through other texture coordinates.
    for (wrap, from, to) in [
        (crate::scene::Wrap::Repeat, Vec2::new(3.0, -2.0), Vec2::new(4.0, -1.0)),
        (crate::scene::Wrap::Mirror, Vec2::new(2.0, 2.0), Vec2::new(1.0, 1.0)),
        (crate::scene::Wrap::Clamp, Vec2::ZERO, Vec2::ONE),
    ] {
        let mut moved = scene.clone();
        moved.textures[0].wrap = [wrap; 2];
        moved.meshes[1].uvs[0].iter_mut().for_each(|uv| *uv = from + (to - from) * *uv);
        if wrap == crate::scene::Wrap::Mirror {
            // Mirrored twice over: u from 2 down to 1 runs through the texture from left to right.
            moved.meshes[1].uvs[0].iter_mut().for_each(|uv| *uv = Vec2::splat(2.0) - (*uv - Vec2::splat(2.0)));
        }
        let (mean, own_error) = measure(&world(moved), &centre_of(0));
        assert!((mean - expected).abs() < 4.0 * error.hypot(own_error), "{wrap:?}: {mean} and {expected}");
    }

    // Texture coordinates without area: the triangle shines evenly with whatever texel they name.
    let mut flat = scene.clone();
    flat.meshes[1].uvs[0].iter_mut().for_each(|uv| *uv = Vec2::new(5.5, 2.5) / 8.0);
    let even = 5000.0 * std::f64::consts::PI * 4.0 * parallel_form_factor(1.0, 1.0, 1.0);
    assert_close(&world(flat), &centre_of(0), even);
}

#[test]
fn punctual_lights_follow_the_inverse_square_and_their_cones() {
    let floor = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
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
    let sun = PunctualLight::Directional { direction, illuminance: Vec3::splat(1000.0) };
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

#[test]
fn skies_light_a_floor_by_their_integral() {
    let floor = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let base = Scene { meshes: vec![floor], materials: vec![matt(0.5, 0.0)], ..Scene::default() };
    let constant = Scene { environment: Some(Environment::Constant(Vec3::splat(7.0))), ..base.clone() };
    assert_close(&world(constant), &centre_of(0), 7.0 * std::f64::consts::PI);
    // A sky that grows with the cosine of the angle from the zenith: E = 2π/3, up to interpolation between rows.
    let image =
        Image::from_fn(16, 256, |_, y| [((std::f32::consts::PI * (y as f32 + 0.5) / 256.0).cos()).max(0.0) * 3.0; 3]);
    let sky = Scene { environment: Some(Environment::Image(image.unwrap())), ..base.clone() };
    let (mean, error) = measure(&world(sky), &centre_of(0));
    let expected = 3.0 * std::f64::consts::TAU / 3.0;
    assert!((mean - expected).abs() < 4.0 * error + 2e-4 * expected, "{mean} ± {error}, expected {expected}");
    // A small sun among dark pixels, 30 degrees up towards -z.
    let mut image = Image::new(64, 32, 3).unwrap();
    image.pixel_mut(32, 10).fill(1e4);
    let sun = Scene { environment: Some(Environment::Image(image)), ..base };
    let world = world(sun);
    let (mean, error) = measure(&world, &centre_of(0));
    // Against a sum over directions of the same interpolated image.
    let environment = world.scene().environment.as_ref().unwrap();
    let n = 2000;
    let mut expected = 0.0;
    for i in 0..n {
        for j in 0..n {
            // Only the part of the sky that is not dark.
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
fn scattering_alone_finds_the_same_light_as_the_weighed_strategies() {
    let floor = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let lamp = quad(Vec3::new(-0.7, 0.8, -0.5), Vec3::X, Vec3::new(0.0, 0.3, 1.5), 1);
    let shade = quad(Vec3::new(-0.2, 0.4, -0.3), Vec3::X * 0.5, Vec3::Z * 0.5, 2);
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
    // Surfaces are black: all light is direct. Directions by their cosine, and whatever they meet.
    let n = 400_000;
    let (mut sum, mut square) = (0.0, 0.0);
    let mut rng = crate::rng::Rng::new(5, &[]);
    for _ in 0..n {
        let (u, angle) = (rng.next_f32(), std::f32::consts::TAU * rng.next_f32());
        let direction = Vec3::new(u.sqrt() * angle.cos(), (1.0 - u).sqrt(), u.sqrt() * angle.sin());
        let ray = crate::scene::accel::Ray::new(Vec3::ZERO, direction);
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

/// A small room with everything in it: textures, mirror, glass, gloss, alpha, a lamp and a sky.
fn everything() -> Scene {
    let image = Image::from_fn(16, 16, |x, y| {
        let lit = x % 4 == 1 && y % 4 == 2;
        [f32::from(u8::from(lit)), 0.5 * f32::from(u8::from(lit)), 0.1, if x < 8 { 1.0 } else { 0.3 }]
    });
    let mut meshes = vec![inward_sphere(2.0, 0)];
    meshes.push(quad(Vec3::new(-1.0, 1.2, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0, 1));
    for (i, x) in [-1.2, -0.6, 0.0, 0.6].into_iter().enumerate() {
        meshes.push(quad(Vec3::new(x, -0.5, -0.8), Vec3::X * 0.5, Vec3::new(0.0, 0.6, -0.2), 2 + i));
    }
    let gloss = Material { base_color: Vec3::new(0.9, 0.6, 0.3), roughness: 0.3, ..Material::default() };
    Scene {
        meshes,
        materials: vec![
            matt(0.7, 0.0),
            Material { emission_texture: Some(TextureRef::new(0)), ..matt(0.0, 300.0) },
            gloss.clone(),
            Material { roughness: 0.0, ..gloss.clone() },
            Material { metallic: 0.0, roughness: 0.1, transmission: 0.9, ..gloss.clone() },
            Material {
                alpha_mode: AlphaMode::Blend,
                base_color_texture: Some(TextureRef::new(0)),
                normal_texture: Some(TextureRef::new(0)),
                metallic: 0.0,
                ..gloss
            },
        ],
        textures: vec![Texture::new("all", image.unwrap())],
        lights: vec![PunctualLight::Point { position: Vec3::new(0.5, 0.5, 1.0), intensity: Vec3::splat(20.0) }],
        environment: Some(Environment::Constant(Vec3::ONE)),
        ..Scene::default()
    }
}

fn viewer() -> Camera {
    Camera::look_at(Vec3::new(0.0, 0.2, 1.5), Vec3::new(0.0, -0.2, -0.8), 1.2)
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let params = Params { width: 70, height: 40, samples: 8, ..Params::default() };
    let film = |threads| Pool::new(threads).unwrap().run(|| render(&world(everything()), &viewer(), &params));
    let (one, three) = (film(1), film(3));
    assert!(one.beauty == three.beauty && one.variance == three.variance);
    assert_eq!(one.beauty.count_non_finite() + one.variance.count_non_finite(), 0);
    assert!(one.error > 0.0 && one.error == three.error);
}

#[test]
fn stated_variances_are_those_of_repeated_renders() {
    let world = world(everything());
    let params = Params { width: 12, height: 12, samples: 64, ..Params::default() };
    let films: Vec<Film> = (0..24).map(|seed| render(&world, &viewer(), &Params { seed, ..params.clone() })).collect();
    let n = films.len() as f64;
    let (mut stated, mut observed) = (0.0, 0.0);
    for i in 0..films[0].beauty.data.len() {
        let mean = films.iter().map(|f| f64::from(f.beauty.data[i])).sum::<f64>() / n;
        // Relative to the pixel, so that no bright one outvotes the others.
        let scale = mean.max(1e-3).powi(2);
        observed += films.iter().map(|f| (f64::from(f.beauty.data[i]) - mean).powi(2)).sum::<f64>() / (n - 1.0) / scale;
        stated += films.iter().map(|f| f64::from(f.variance.data[i])).sum::<f64>() / n / scale;
    }
    assert!((stated / observed - 1.0).abs() < 0.15, "stated {stated}, observed {observed}");
}

#[test]
fn energy_is_never_made() {
    // A sphere of each substance around a viewer, in a sky of radiance 1: nothing may look brighter than the sky.
    for (metallic, ior) in [(1.0, 1.5), (0.0, 1.5), (0.5, 1.5), (0.0, 2.4)] {
        for roughness in [0.0, 0.05, 0.2, 0.5, 0.8, 1.0] {
            let material = Material { metallic, roughness, ior, ..Material::default() };
            let scene = Scene {
                meshes: vec![quad(Vec3::new(-50.0, 0.0, -50.0), Vec3::Z * 100.0, Vec3::X * 100.0, 0)],
                materials: vec![material],
                environment: Some(Environment::Constant(Vec3::ONE)),
                ..Scene::default()
            };
            let world = world(scene);
            for height in [5.0, 1.0, 0.2] {
                let camera = Camera::look_at(Vec3::new(0.0, height, 3.0), Vec3::ZERO, 0.05);
                let film = render(&world, &camera, &Params { width: 4, height: 4, samples: 256, ..Params::default() });
                let mean = film.beauty.data.iter().map(|&v| f64::from(v)).sum::<f64>() / 48.0;
                let error = film.variance.data.iter().map(|&v| f64::from(v)).sum::<f64>().sqrt() / 48.0 * 3f64.sqrt();
                let what = format!("metallic {metallic}, ior {ior}, roughness {roughness}, height {height}: {mean}");
                assert!(mean < 1.0 + 4.0 * error + 0.003, "{what} ± {error}");
                // Light scattered twice between facets is not modelled: rough and grazing views lose it.
                let least = if roughness <= 0.2 && height >= 1.0 { 0.95 } else { 0.3 };
                assert!(mean > least, "{what}");
                if metallic == 1.0 && roughness == 1.0 {
                    // The integral of the lobe has a closed form where the facets are spread evenly.
                    let cosine = f64::from(height) / f64::from(height).hypot(3.0);
                    let expected = 1.0 - cosine * ((1.0 + cosine) / cosine).ln();
                    assert!((mean - expected).abs() < 4.0 * error + 0.01 * expected, "{what}, expected {expected}");
                }
            }
        }
    }
}

#[test]
fn light_through_a_clear_pane_is_the_same_by_either_strategy() {
    // A pane between lamp and floor takes the share that Fresnel's factor and its colour demand.
    let floor = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0);
    let lamp = quad(Vec3::new(-0.01, 2.0, -0.01), Vec3::X * 0.02, Vec3::Z * 0.02, 1);
    let pane = quad(Vec3::new(-1.0, 1.0, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0, 2);
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

#[test]
fn what_cannot_be_rendered_is_refused_by_name() {
    let valid = everything();
    let refused = |change: &dyn Fn(&mut Scene), word: &str| {
        let mut scene = valid.clone();
        change(&mut scene);
        let error = World::build(Arc::new(scene), Monitor::default().job()).err().expect(word);
        assert!(error.message.contains(word), "{}", error.message);
    };
    refused(&|s| s.meshes[1].material = 99, "99");
    refused(&|s| s.meshes[2].positions[1].y = f32::NAN, "position");
    refused(&|s| s.meshes[2].triangles[1] = [0, 1, 4], "position 4");
    refused(&|s| s.meshes[2].uvs[0].truncate(2), "uvs[0]");
    refused(&|s| s.materials[1].emission_texture = Some(TextureRef::new(7)), "texture 7");
    refused(&|s| s.textures[0].image.data[5] = f32::INFINITY, "texture 0");
    refused(&|s| s.materials[3].roughness = f32::NAN, "material 3");
    refused(&|s| s.environment = Some(Environment::Constant(Vec3::NAN)), "environment");

    let world = world(valid.clone());
    let run_with =
        |camera: &Camera, params: &Params| run(&world, camera, params, Monitor::default().job(), &mut |_| ());
    for bad in [
        Params { width: 0, ..Params::default() },
        Params { samples: 0, ..Params::default() },
        Params { samples: (1 << 20) + 1, ..Params::default() },
        Params { target_error: f32::NAN, ..Params::default() },
    ] {
        assert!(run_with(&viewer(), &bad).is_err());
    }
    assert!(run_with(&Camera { fov_y: 0.0, ..viewer() }, &Params::default()).is_err());
    assert!(run_with(&Camera { position: Vec3::NAN, ..viewer() }, &Params::default()).is_err());
}

#[test]
fn a_cancelled_render_leaves_what_was_published() {
    let world = world(everything());
    let params = Params { width: 64, height: 64, samples: 1 << 20, ..Params::default() };
    let monitor = Monitor::default();
    let mut last = None;
    let result = run(&world, &viewer(), &params, monitor.job(), &mut |film| {
        last = Some(film.clone());
        monitor.cancel();
    });
    assert_eq!(result.unwrap_err(), Error::cancelled());
    assert_eq!(last.unwrap().samples, 4);
}

#[test]
fn a_render_stops_when_it_is_good_enough_or_out_of_time() {
    let world = world(everything());
    let base = Params { width: 16, height: 16, samples: 1 << 20, ..Params::default() };
    let film = render(&world, &viewer(), &Params { target_error: 0.2, ..base.clone() });
    assert!(film.error <= 0.2 && film.samples < 1 << 20);
    let start = Instant::now();
    let film = render(&world, &viewer(), &Params { time_budget_ms: 50, ..base });
    assert!(film.samples >= 4 && start.elapsed().as_secs_f64() < 5.0);
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
