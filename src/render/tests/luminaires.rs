//! Tests of light from measured luminaires that shine from points, against closed forms.

use super::*;
use crate::exec::Pool;
use crate::photometry::{Luminaire, ies, ldt};
use crate::render::illuminance::{self, CalculationPoints};
use std::f64::consts::PI;

const POSITION: Vec3 = Vec3::new(0.3, 2.5, -0.4);

fn hung(luminaire: Luminaire, axis: Vec3, c0: Vec3) -> Scene {
    Scene {
        meshes: vec![Mesh::parallelogram(Vec3::splat(-90.0), Vec3::X, Vec3::Z, 0)],
        materials: vec![matt(0.0, 0.0)],
        lights: vec![PunctualLight::Luminaire {
            position: POSITION,
            axis,
            c0,
            colour: Vec3::ONE,
            distribution: 0,
            is_point: true,
        }],
        distributions: vec![Arc::new(luminaire)],
        ..Scene::default()
    }
}

/// Returns the illuminance over a parallelogram, on the side of `normal`.
fn lux(scene: Scene, [origin, across, down, normal]: [Vec3; 4], cells: usize) -> illuminance::Output {
    let place = CalculationPoints::Grid { origin, across, down, normal };
    let params = illuminance::Params { columns: cells, rows: cells, samples: 16, seed: 1 };
    let world = world(scene);
    Pool::new(2).unwrap().run(|| illuminance::run(&world, &place, &params, Monitor::default().job()).unwrap())
}

const FLOOR: [Vec3; 4] = [Vec3::new(-2.0, 0.0, -2.0), Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 4.0), Vec3::Y];

/// A luminaire of uniform intensity lights a plane like a point light. A Lambertian luminaire of intensity I cos γ, at
/// a height of h above the plane, gives the illuminance `I cos⁴ γ / h²`.
#[test]
fn uniform_and_lambertian_luminaires_agree_with_closed_forms() {
    let even = b"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 10\n0 180\n0\n250 250\n";
    let even = ies::read(even).unwrap();
    let matt = Luminaire::lambertian("panel", 1000.0, [0.6, 0.6, 0.0]);
    let matt = ldt::read(ldt::write(&matt).unwrap().as_bytes()).unwrap();
    for (luminaire, intensity, share) in
        [(even, &(|_| 250.0) as &dyn Fn(f64) -> f64, 1e-5), (matt, &|cosine: f64| 1000.0 / PI * cosine, 6e-4)]
    {
        let seen = lux(hung(luminaire, Vec3::NEG_Y, Vec3::X), FLOOR, 5);
        for (i, lux) in seen.lux.data.iter().enumerate() {
            let at = |i: usize| -2.0 + 4.0 * (i as f32 + 0.5) / 5.0;
            let from = (POSITION - Vec3::new(at(i % 5), 0.0, at(i / 5))).as_dvec3();
            let cosine = from.normalize().y;
            let expected = intensity(cosine) * cosine / from.length_squared();
            assert!((f64::from(*lux) / expected - 1.0).abs() < share, "{lux} {expected}");
        }
    }
}

/// In the direction of a C plane, the luminaire has the intensity of this plane; midway between two planes, it has the
/// mean of their intensities. This holds for any orientation of the luminaire.
#[test]
fn c_planes_follow_the_axes_of_the_luminaire() {
    let quarters = Luminaire {
        gammas: vec![0.0, 180.0],
        planes: vec![0.0, 90.0, 180.0, 270.0],
        candela: vec![10.0, 10.0, 20.0, 20.0, 30.0, 30.0, 40.0, 40.0],
        ..Luminaire::lambertian("", 0.0, [0.0; 3])
    };
    for (axis, c0, c90) in
        [(Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z), (Vec3::NEG_Y, Vec3::Z, Vec3::X), (Vec3::X, Vec3::Y, Vec3::NEG_Z)]
    {
        for (towards, candela) in [(c0, 10.0), (c90, 20.0), (-c0, 30.0), (-c90, 40.0), (c0 + c90, 15.0)] {
            let towards = towards.normalize();
            let across = 1e-3 * towards.any_orthonormal_vector();
            let place = [POSITION + 2.0 * towards, across, 1e-3 * towards.cross(across).normalize(), -towards];
            let seen = lux(hung(quarters.clone(), axis, c0), place, 1).mean;
            assert!((seen / (candela / 4.0) - 1.0).abs() < 2e-3, "{axis} {c0} {towards}: {seen} lx");
        }
    }
}

/// The flux through all sides of a box equals the flux of the luminaire inside it.
#[test]
fn flux_is_conserved() {
    let uneven = Luminaire {
        gammas: (0..=18).map(|i| f64::from(i) * 10.0).collect(),
        planes: (0..8).map(|i| f64::from(i) * 45.0).collect(),
        candela: (0..19 * 8).map(|i| 50.0 + 40.0 * f64::from(i * 7 % 11)).collect(),
        ..Luminaire::lambertian("", 0.0, [0.0; 3])
    };
    let wanted = uneven.flux();
    let tilted = Vec3::new(0.6, -0.8, 0.0);
    let mut flux = 0.0;
    for axis in 0..3 {
        for far in [false, true] {
            let [n, u, v] = [axis, axis + 1, axis + 2].map(|i| Vec3::AXES[i % 3]);
            let origin = POSITION - Vec3::ONE + if far { 2.0 * n } else { Vec3::ZERO };
            let side = [origin, 2.0 * u, 2.0 * v, if far { -n } else { n }];
            flux += 4.0 * lux(hung(uneven.clone(), tilted, Vec3::Z), side, 96).mean;
        }
    }
    assert!((flux / wanted - 1.0).abs() < 1e-3, "{flux} lm of {wanted}");
}
