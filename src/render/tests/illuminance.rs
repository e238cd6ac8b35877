//! Tests of calculation grids and of illuminance maps of surfaces, against closed forms.

use super::*;
use crate::exec::Pool;
use crate::render::illuminance::{CalculationPoints, Output, Params, run};

fn measure(world: &World, place: &CalculationPoints, params: &Params) -> Output {
    run(world, place, params, Monitor::default().job()).unwrap()
}

/// A floor below a lamp of 1 × 1.5 m and 100 cd/m², which faces down at a height of 1.5 m.
fn lit_floor() -> Scene {
    Scene {
        meshes: vec![
            Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0),
            Mesh::parallelogram(Vec3::new(-0.5, 1.5, -0.75), Vec3::X, Vec3::Z * 1.5, 1),
        ],
        materials: vec![matt(0.3, 0.0), Material { double_sided: false, ..matt(0.0, 100.0) }],
        ..Scene::default()
    }
}

/// Critical value for the deviation of a point in standard errors. The standard error is estimated from 16 batches, so
/// the deviation follows Student's t with 15 degrees of freedom. The probability that any of the 45 points below
/// exceeds the critical value is 1/1000 (2.2e-5 for each point, by Šidák's formula).
const T15: f64 = 6.02;

#[test]
fn grids_in_the_air_on_a_floor_and_maps_of_it_agree_with_form_factors() {
    let world = world(lit_floor());
    // Compute the closed form at a point `d` below the lamp and (x, z) off its centre: the signed sum over four
    // rectangles, each of which has a corner above the point.
    let expected = |x: f64, z: f64, d: f64| {
        let part = |a: f64, b: f64| a.signum() * b.signum() * parallel_form_factor(a.abs(), b.abs(), d);
        let (l, r, n, f) = (0.5 + x, 0.5 - x, 0.75 + z, 0.75 - z);
        100.0 * std::f64::consts::PI * (part(l, n) + part(l, f) + part(r, n) + part(r, f))
    };
    let params = Params { columns: 5, rows: 3, samples: 4096, seed: 3 };
    for height in [0.0f32, 0.75] {
        let origin = Vec3::new(-1.0, height, -1.0);
        let place =
            CalculationPoints::Grid { origin, across: Vec3::X * 2.0, down: Vec3::Z * 2.0, normal: Vec3::Y * 7.0 };
        let output = measure(&world, &place, &params);
        assert_eq!(output.points, 15);
        let mut sum = 0.0;
        for y in 0..3 {
            for x in 0..5 {
                let at = (-0.8 + 0.4 * x as f64, (y as f64 - 1.0) * 2.0 / 3.0);
                let truth = expected(at.0, at.1, 1.5 - f64::from(height));
                let (value, error) = (output.lux.pixel(x, y)[0], output.error.pixel(x, y)[0]);
                let off = (f64::from(value) - truth).abs();
                assert!(off < T15 * f64::from(error) + 1e-5 * truth, "{value} ± {error}, expected {truth}");
                assert!(error > 0.0 && f64::from(error) < 0.05 * truth);
                sum += truth / 15.0;
            }
        }
        assert!((output.mean - sum).abs() < 4.0 * output.mean_error && output.mean_error < 0.005 * sum);
        assert!(output.min < output.mean && output.mean < output.max);
    }
    // On the floor's texture, u runs along z, and v along x.
    let map = measure(
        &world,
        &CalculationPoints::Mesh { mesh: 0, front: true },
        &Params { columns: 3, rows: 5, ..params.clone() },
    );
    for y in 0..5 {
        for x in 0..3 {
            let truth = expected(-0.8 + 0.4 * y as f64, (x as f64 - 1.0) * 2.0 / 3.0, 1.5);
            let (value, error) = (f64::from(map.lux.pixel(x, y)[0]), f64::from(map.error.pixel(x, y)[0]));
            assert!((value - truth).abs() < T15 * error + 1e-5 * truth, "{value} ± {error}, expected {truth}");
        }
    }
    // No light reaches the underside of the floor.
    assert_eq!(measure(&world, &CalculationPoints::Mesh { mesh: 0, front: false }, &params).max, 0.0);
}

#[test]
fn texels_without_surface_have_no_value_and_threads_do_not_show() {
    let mut scene = lit_floor();
    scene.meshes[0].uvs[0].iter_mut().for_each(|uv| *uv *= 0.5);
    let params = Params { columns: 8, rows: 8, samples: 64, seed: 1 };
    let place = CalculationPoints::Mesh { mesh: 0, front: true };
    let output = |threads| Pool::new(threads).unwrap().run(|| measure(&world(scene.clone()), &place, &params));
    let (one, three) = (output(1), output(3));
    assert_eq!(one.points, 16);
    assert!((0..64).all(|i| one.lux.data[i].is_nan() == (i % 8 > 3 || i / 8 > 3)));
    let bits = |o: &Output| o.lux.data.iter().chain(&o.error.data).map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&one), bits(&three));
}

#[test]
fn grids_that_cannot_be_are_refused_by_name() {
    let world = world(lit_floor());
    let grid = |normal: Vec3| CalculationPoints::Grid { origin: Vec3::ZERO, across: Vec3::X, down: Vec3::Z, normal };
    let none = Params::default();
    let refused =
        |place: &CalculationPoints, params: &Params| run(&world, place, params, Monitor::default().job()).unwrap_err();
    assert!(refused(&grid(Vec3::ZERO), &none).message.contains("normal"));
    assert!(refused(&grid(Vec3::NAN), &none).message.contains("normal"));
    assert!(refused(&CalculationPoints::Mesh { mesh: 9, front: true }, &none).message.contains("mesh is 9"));
    assert!(refused(&grid(Vec3::Y), &Params { samples: 3, ..none.clone() }).message.contains("samples is 3"));
    assert!(refused(&grid(Vec3::Y), &Params { columns: 0, ..none.clone() }).message.contains("columns is 0"));
    let monitor = Monitor::default();
    monitor.cancel();
    assert_eq!(run(&world, &grid(Vec3::Y), &none, monitor.job()).unwrap_err(), Error::cancelled());
}
