//! Tests of energy conservation: no scene reflects more light than it receives.

use super::*;

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

#[test]
fn energy_is_never_made() {
    // A large ground plane of each material under a sky of radiance 1 must never look brighter than the sky.
    for (metallic, ior) in [(1.0, 1.5), (0.0, 1.5), (0.5, 1.5), (0.0, 2.4)] {
        for roughness in [0.0, 0.05, 0.2, 0.5, 0.8, 1.0] {
            let material = Material { metallic, roughness, ior, ..Material::default() };
            let scene = Scene {
                meshes: vec![Mesh::parallelogram(Vec3::new(-50.0, 0.0, -50.0), Vec3::Z * 100.0, Vec3::X * 100.0, 0)],
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
                // Multiple scattering between microfacets is not modelled, so rough surfaces and grazing views lose
                // energy.
                let min = if roughness <= 0.2 && height >= 1.0 { 0.95 } else { 0.3 };
                assert!(mean > min, "{what}");
                if metallic == 1.0 && roughness == 1.0 {
                    // At roughness 1, all microfacet normals are equally likely. The integral of the reflection lobe
                    // over all directions then has a closed form.
                    let cosine = f64::from(height) / f64::from(height).hypot(3.0);
                    let expected = 1.0 - cosine * ((1.0 + cosine) / cosine).ln();
                    assert!((mean - expected).abs() < 4.0 * error + 0.01 * expected, "{what}, expected {expected}");
                }
            }
        }
    }
}
