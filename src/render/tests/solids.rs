//! Tests of solid glass: furnaces, slabs and absorption in closed form, and extremes. Intervals are 4 standard errors
//! (99.99 %) unless stated otherwise.

use super::*;

/// Clear glass that bounds a solid.
fn glass(roughness: f32) -> Material {
    Material { transmission: 1.0, metallic: 0.0, roughness, ior: 1.5, thickness: 1.0, ..Material::default() }
}

/// A box with outward faces, from corner to corner.
fn block(low: Vec3, high: Vec3, material: usize) -> Mesh {
    let corner = |i: usize| Vec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low);
    let positions = (0..8).map(corner).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { material, positions, triangles, ..Mesh::default() }
}

fn under_a_sky(mesh: Mesh, material: Material) -> World {
    let environment = Some(Environment::Constant(Vec3::ONE));
    world(Scene { meshes: vec![mesh], materials: vec![material], environment, ..Scene::default() })
}

/// Returns the mean of a film (red channel) and its standard error.
fn mean_of(film: &Film) -> (f64, f64) {
    assert_eq!((film.beauty.count_non_finite(), film.discarded), (0, 0));
    let n = (film.beauty.width * film.beauty.height) as f64;
    let red = |image: &Image| image.data.iter().step_by(3).map(|&v| f64::from(v)).sum::<f64>();
    (red(&film.beauty) / n, red(&film.variance).sqrt() / n)
}

fn seen(world: &World, camera: &Camera, samples: u32) -> (f64, f64) {
    mean_of(&render(world, camera, &Params { width: 16, height: 16, samples, ..Params::default() }))
}

/// A view in which the bodies of the furnaces fill most of the image.
fn furnace_camera() -> Camera {
    Camera::look_at(Vec3::new(0.9, 0.7, 2.1), Vec3::ZERO, 0.45)
}

#[test]
fn clear_glass_in_a_furnace_cannot_be_seen() {
    for mesh in [ball(Vec3::ZERO, 1.0), block(Vec3::splat(-0.4), Vec3::splat(0.4), 0)] {
        assert!(mesh.is_closed());
        let (mean, error) = seen(&under_a_sky(mesh.clone(), glass(0.0)), &furnace_camera(), 64);
        assert!((mean - 1.0).abs() < 4.0 * error + 1e-4 && error < 2e-3, "{mean} ± {error}");
        // A furnace whose wall emits is the same, although its light is sampled. The ball rests inside.
        let meshes = vec![mesh, inward_sphere(4.0, 1)];
        let materials = vec![glass(0.0), matt(0.5, 0.5)];
        let (mean, error) = seen(&world(Scene { meshes, materials, ..Scene::default() }), &furnace_camera(), 64);
        assert!((mean - 1.0).abs() < 4.0 * error + 1e-4 && error < 1e-2, "{mean} ± {error}");
    }
}

#[test]
fn rough_glass_in_a_furnace_loses_what_its_facets_lose() {
    // Light that meets a second facet is lost. The ball loses 0.0004 of the light in view at a roughness of 0.1, and
    // 0.153 at 0.5; the block 0.0012 and 0.20 (as measured).
    for (roughness, most_lost) in [(0.1, 0.004), (0.5, 0.3)] {
        for mesh in [ball(Vec3::ZERO, 1.0), block(Vec3::splat(-0.4), Vec3::splat(0.4), 0)] {
            let sky = seen(&under_a_sky(mesh.clone(), glass(roughness)), &furnace_camera(), 64);
            let meshes = vec![mesh, inward_sphere(4.0, 1)];
            let materials = vec![glass(roughness), matt(0.0, 1.0)];
            let walls = seen(&world(Scene { meshes, materials, ..Scene::default() }), &furnace_camera(), 64);
            println!("roughness {roughness}: {sky:?} and {walls:?}");
            for (mean, error) in [sky, walls] {
                assert!(mean < 1.0 + 4.0 * error + 1e-4 && mean > 1.0 - most_lost, "{mean} ± {error}");
            }
            // Light samples of the sky and of the walls have other pdfs, but the means are the same.
            assert!((sky.0 - walls.0).abs() < 4.0 * sky.1.hypot(walls.1), "{sky:?} and {walls:?}");
        }
    }
}

#[test]
fn a_body_that_is_partly_clear_reflects_the_rest() {
    // White glass, milk glass and metal share the surface; only the table of the coat's albedo is inexact.
    let material = Material { transmission: 0.5, metallic: 0.3, ..glass(0.0) };
    let (mean, error) = seen(&under_a_sky(ball(Vec3::ZERO, 1.0), material), &furnace_camera(), 64);
    assert!((mean - 1.0).abs() < 4.0 * error + 0.01, "{mean} ± {error}");
}

/// Returns the radiance that a camera measures at normal incidence through a slab, in front of a wall of radiance 1.
fn through_slab(material: Material, d: f32) -> (f64, f64) {
    let slab = block(Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, d), 0);
    let wall = Mesh::parallelogram(Vec3::new(-5.0, -5.0, -1.0), Vec3::X * 10.0, Vec3::Y * 10.0, 1);
    let scene = Scene { meshes: vec![slab, wall], materials: vec![material, matt(0.0, 1.0)], ..Scene::default() };
    let camera = Camera::look_at(Vec3::new(0.05, 0.02, 3.0), Vec3::new(0.05, 0.02, 0.0), 1e-3);
    seen(&world(scene), &camera, 64)
}

#[test]
fn a_slab_transmits_by_the_series_of_its_reflections() {
    // T = (1 - R)² e^{-σ d} / (1 - R² e^{-2 σ d}), with R the reflectance at normal incidence.
    for (ior, share, d) in [(1.5, 1.0, 0.2), (1.5, 0.3, 0.2), (2.4, 0.6, 0.05), (1.0, 0.3, 0.2), (3.9, 1.0, 0.1)] {
        // After 0.1 m, the share is left.
        let material = Material { ior, attenuation_color: Vec3::splat(share), attenuation_distance: 0.1, ..glass(0.0) };
        let (mean, error) = through_slab(material.clone(), d);
        let r = f64::from((ior - 1.0) / (ior + 1.0)).powi(2);
        let left = f64::from(share).powf(f64::from(d) / 0.1);
        let expected = (1.0 - r).powi(2) * left / (1.0 - (r * left).powi(2));
        let what = format!("ior {ior}, {share} after 0.1 m, {d} m: {mean} ± {error}, expected {expected}");
        assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected, "{what}");
        // The base colour tints the light at both surfaces. Each reflection inside passes none.
        let tinted = Material { base_color: Vec3::splat(0.5), ..material };
        let (mean, error) = through_slab(tinted, d);
        let expected = expected * 0.25;
        assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected, "tinted: {mean} ± {error}, {expected}");
    }
}

#[test]
fn a_camera_inside_glass_sees_the_radiance_there() {
    // Radiance grows by the squared index. From points near the centre, all light finds out.
    let world = under_a_sky(ball(Vec3::ZERO, 1.0), glass(0.0));
    let camera = Camera::look_at(Vec3::new(0.1, 0.05, -0.02), Vec3::X, 1.5);
    let (mean, error) = seen(&world, &camera, 64);
    assert!((mean - 2.25).abs() < 4.0 * error + 1e-3, "{mean} ± {error}");
    // A light meter inside measures π times that.
    let mut sum = ContributionSum(DVec3::ZERO);
    (0..4096).for_each(|i| irradiance_in_air(&world, Vec3::new(0.1, 0.0, 0.0), Vec3::Y, 1, i, &mut sum));
    let lux = sum.0.x / 4096.0;
    assert!((lux / (2.25 * std::f64::consts::PI) - 1.0).abs() < 0.02, "{lux}");
    // With absorption, the first leg counts: at the centre of a ball of index 1, with half left after its radius.
    let (attenuation_color, attenuation_distance) = (Vec3::splat(0.5), 0.5);
    let tinted = Material { ior: 1.0, attenuation_color, attenuation_distance, ..glass(0.0) };
    let world = under_a_sky(ball(Vec3::ZERO, 1.0), tinted);
    let (mean, _) = seen(&world, &Camera::look_at(Vec3::ZERO, Vec3::X, 1.5), 16);
    // The faces of the ball lie up to 0.6 % of the radius inside the sphere.
    assert!((mean - 0.5).abs() < 3e-3, "{mean}");
}

#[test]
fn lights_inside_a_body_are_sampled_and_absorbed() {
    // The index is 1, so that nothing is reflected: E = I / r² e^{-σ r}.
    let dark = Material { ior: 1.0, attenuation_color: Vec3::splat(0.2), attenuation_distance: 0.5, ..glass(0.0) };
    let tank = block(Vec3::splat(-1.0), Vec3::splat(1.0), 0);
    let lamp = |r: f32| PunctualLight::Point { position: Vec3::Y * r, intensity: Vec3::splat(3.0) };
    for r in [0.1f32, 0.5, 0.9, 2.0] {
        let scene = Scene {
            meshes: vec![tank.clone()],
            materials: vec![dark.clone()],
            lights: vec![lamp(r)],
            ..Scene::default()
        };
        let mut sum = ContributionSum(DVec3::ZERO);
        irradiance_in_air(&world(scene), Vec3::ZERO, Vec3::Y, 1, 0, &mut sum);
        // Light from a point passes no surface of a solid.
        let expected = if r < 1.0 { 3.0 / f64::from(r * r) * 0.2f64.powf(f64::from(r) / 0.5) } else { 0.0 };
        assert!((sum.0.x - expected).abs() <= 1e-5 * expected, "{r}: {}, expected {expected}", sum.0.x);
    }
    // A lamp with a surface that fills the tank's lid, found by light samples and by BSDF samples. Its radiance is 1.
    // A small square far below it measures nearly its own absorption; compare with a quadrature of the form factor.
    let (half, h) = (0.4f64, 0.5f64);
    let lid = Mesh::parallelogram(Vec3::new(-0.4, 0.5, -0.4), Vec3::X * 0.8, Vec3::Z * 0.8, 1);
    let scene = Scene { meshes: vec![tank, lid], materials: vec![dark, matt(0.0, 1.0)], ..Scene::default() };
    let world = world(scene);
    let (n, mut expected) = (400, 0.0);
    for i in 0..n * n {
        let [x, z] = [i % n, i / n].map(|k| ((k as f64 + 0.5) / n as f64 * 2.0 - 1.0) * half);
        let r2 = x * x + z * z + h * h;
        expected += h * h / (r2 * r2) * 0.2f64.powf(r2.sqrt() / 0.5) * (2.0 * half / n as f64).powi(2);
    }
    let mut means = Vec::new();
    for batch in 0..16 {
        let mut sum = ContributionSum(DVec3::ZERO);
        (0..1024).for_each(|i| irradiance_in_air(&world, Vec3::ZERO, Vec3::Y, batch, i, &mut sum));
        means.push(sum.0.x / 1024.0);
    }
    let mean = means.iter().sum::<f64>() / 16.0;
    let error = (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (16.0 * 15.0)).sqrt();
    assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected, "{mean} ± {error}, expected {expected}");
}

#[test]
fn water_that_overlaps_its_glass_equals_water_that_touches_nothing() {
    // A slab of glass that overlaps a slab of water, at normal incidence: three boundaries, whichever side is first.
    let wall = Mesh::parallelogram(Vec3::new(-5.0, -5.0, -1.0), Vec3::X * 10.0, Vec3::Y * 10.0, 2);
    let slab = |from: f32, to: f32, m| block(Vec3::new(-1.0, -1.0, from), Vec3::new(1.0, 1.0, to), m);
    let water = Material { ior: 1.33, ..glass(0.0) };
    let look = |meshes: [Mesh; 2]| {
        let meshes = meshes.into_iter().chain([wall.clone()]).collect();
        let materials = vec![glass(0.0), water.clone(), matt(0.0, 1.0)];
        let camera = Camera::look_at(Vec3::new(0.05, 0.02, 3.0), Vec3::new(0.05, 0.02, 0.0), 1e-3);
        seen(&world(Scene { meshes, materials, ..Scene::default() }), &camera, 256)
    };
    let reflectance = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
    // Add the layers one by one (without interference): T = T1 T2 / (1 - R1 R2).
    let add = |(t1, r1): (f64, f64), r2: f64| {
        let t2 = 1.0 - r2;
        (t1 * t2 / (1.0 - r1 * r2), r2 + t2 * t2 * r1 / (1.0 - r1 * r2))
    };
    let r = [reflectance(1.0, 1.5), reflectance(1.5, 1.33), reflectance(1.33, 1.0)];
    let (expected, _) = add(add((1.0 - r[0], r[0]), r[1]), r[2]);
    for meshes in [[slab(0.0, 0.2, 0), slab(-0.2, 0.05, 1)], [slab(-0.2, 0.05, 0), slab(0.0, 0.2, 1)]] {
        let (mean, error) = look(meshes);
        assert!((mean - expected).abs() < 4.0 * error + 1e-4, "{mean} ± {error}, expected {expected}");
    }
}

#[test]
fn layers_tell_refraction_from_reflection_and_add_up() {
    let mut scene = everything();
    scene.materials[4] = glass(0.0);
    scene.materials.push(glass(0.3));
    scene.meshes.push(block(Vec3::new(-0.9, -0.6, -0.2), Vec3::new(-0.3, 0.1, 0.2), 4));
    scene.meshes.push(Mesh { material: 6, ..ball(Vec3::new(0.4, -0.3, 0.3), 0.6) });
    let world = world(scene);
    let params = Params { width: 32, height: 24, samples: 8, ..Params::default() };
    let layers = |set: &[(&str, &str)]| {
        let mut outputs = Outputs::default();
        set.iter().for_each(|(name, text)| outputs.add(name, text).unwrap());
        let film = render(&world, &viewer(), &Params { outputs, ..params.clone() });
        let sum = |i: usize| film.layers.iter().map(|l| l.image.data[i]).sum::<f32>();
        (film.beauty.clone(), (0..film.beauty.data.len()).map(sum).collect::<Vec<_>>(), film)
    };
    let close = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-4 * b.max(1e-3));
    let plain = render(&world, &viewer(), &params);
    let kinds = ["emission", "background", "diffuse", "specular", "transmission"];
    let (beauty, all, by_kind) = layers(&kinds.map(|name| (name, name)));
    assert!(beauty == plain.beauty && close(&all, &beauty.data));
    // Light through the first surface is refracted, by a smooth or by a rough body: no thin pane is in the scene.
    let (_, refracted, parts) = layers(&[("smooth", "C<TS>.*"), ("rough", "C<TG>.*")]);
    assert!(close(&refracted, &by_kind.layers[4].image.data));
    assert!(parts.layers.iter().all(|l| l.image.data.iter().any(|&v| v > 0.0)));
    let (_, straight, _) = layers(&[("pane", "C<Ts>.*")]);
    assert!(straight.iter().all(|&v| v == 0.0));
}

#[test]
fn glass_at_the_extremes_is_finite() {
    let solid = |change: &dyn Fn(&mut Material), mesh: Mesh| {
        let mut scene = everything();
        let mut material = glass(0.2);
        change(&mut material);
        scene.materials[4] = material;
        scene.meshes.push(Mesh { material: 4, ..mesh });
        let film = render(&world(scene), &viewer(), &Params { width: 12, height: 8, samples: 8, ..Params::default() });
        mean_of(&film).0
    };
    let cube = || block(Vec3::new(-0.4, -0.5, -0.4), Vec3::new(0.4, 0.3, 0.4), 4);
    let mut inside_out = cube();
    inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let changes: [&dyn Fn(&mut Material); 9] = [
        &|_| (),
        &|m| m.ior = 1.0,
        &|m| (m.ior, m.roughness) = (1e3, 0.0),
        &|m| m.ior = 1e30,
        &|m| (m.attenuation_color, m.attenuation_distance) = (Vec3::ZERO, f32::MIN_POSITIVE),
        &|m| (m.attenuation_color, m.attenuation_distance) = (Vec3::splat(0.5), f32::MAX),
        &|m| m.base_color = Vec3::ZERO,
        &|m| (m.alpha_mode, m.alpha) = (AlphaMode::Blend, 0.5),
        &|m| (m.thickness, m.roughness) = (f32::MIN_POSITIVE, 1.0),
    ];
    for change in changes {
        for mesh in [cube(), inside_out.clone(), Mesh::parallelogram(Vec3::new(-0.5, -0.5, 0.3), Vec3::X, Vec3::Y, 4)] {
            assert!(solid(change, mesh) > 0.0);
        }
    }
    for (what, wrong) in [
        ("thickness", &(|m: &mut Material| m.thickness = f32::NAN) as &dyn Fn(&mut Material)),
        ("thickness", &|m| m.thickness = f32::INFINITY),
        ("attenuation", &|m| m.attenuation_distance = 0.0),
        ("attenuation", &|m| m.attenuation_distance = f32::NAN),
        ("attenuation", &|m| m.attenuation_color.x = 1.5),
    ] {
        let mut scene = Scene { materials: vec![glass(0.0)], ..Scene::default() };
        wrong(&mut scene.materials[0]);
        let refused = World::build(Arc::new(scene), Monitor::default().job()).err().unwrap();
        assert!(refused.message.contains(what), "{refused}");
    }
}

#[test]
fn glass_of_index_one_cannot_be_seen() {
    let look = |with: bool| {
        let mut scene = everything();
        scene.materials[4] = Material { ior: 1.0, ..glass(0.3) };
        scene.meshes.remove(4);
        scene.lights.clear();
        if with {
            scene.meshes.push(block(Vec3::new(-0.4, -0.5, -0.4), Vec3::new(0.4, 0.3, 0.4), 4));
        }
        seen(&world(scene), &viewer(), 64)
    };
    let (with, without) = (look(true), look(false));
    assert!((with.0 - without.0).abs() < 4.0 * with.1.hypot(without.1), "{with:?} and {without:?}");
}

#[test]
fn the_report_states_the_limits_of_solid_glass() {
    let text = |mesh: Mesh, lights: Vec<PunctualLight>| {
        let meshes = vec![inward_sphere(2.0, 1), mesh];
        let materials = vec![glass(0.0), matt(0.5, 1.0)];
        let world = world(Scene { meshes, materials, lights, ..Scene::default() });
        assert!(world.requirements().refraction && !world.requirements().glass);
        world.requirements().left_out().join(" ")
    };
    let sun = PunctualLight::parallel(Vec3::NEG_Y, Vec3::ONE);
    let closed = text(ball(Vec3::ZERO, 1.0), Vec::new());
    assert!(!closed.contains("not closed") && !closed.contains("black shadow") && !closed.contains("Nothing is tr"));
    assert!(closed.contains("No light is sampled through solid glass") && !closed.contains("is not bent"), "{closed}");
    let open = text(Mesh::parallelogram(Vec3::ZERO, Vec3::X, Vec3::Y, 0), vec![sun]);
    assert!(open.contains("Mesh 1 is solid glass but not closed") && open.contains("black shadow"), "{open}");
    let inverted = text(inward_sphere(0.5, 0), Vec::new());
    assert!(inverted.contains("Mesh 1 is solid glass with its front sides inwards") && !closed.contains("inwards"));
}
