//! Tests of the least squares fit over the target's points against closed forms.

use super::*;

/// Half the side, in metres, of the black floor and of the lamps one metre above it.
const FLOOR: f64 = 2.0;
const LAMP: f64 = 0.5;
/// Position along x of the lamp to solve for and of another lamp, and the radiance of the other lamp.
const PLACES: [f64; 2] = [-0.7, 1.0];
const OTHER: f64 = 2.0;

/// A black floor below two lamps of materials 1 and 2.
fn scene() -> Scene {
    let mut scene = room(Vec3::new(1.0, 1.0, 1.0), Vec3::ZERO, Vec3::ZERO, Vec3::ONE);
    scene.meshes.truncate(2);
    let other = Material { emission: Vec3::splat(OTHER as f32), ..scene.materials[1].clone() };
    scene.materials.push(other);
    let mut second = scene.meshes[1].clone();
    second.material = 2;
    scene.meshes.push(second);
    for (mesh, (half, x)) in scene.meshes.iter_mut().zip([(FLOOR, 0.0), (LAMP, PLACES[0]), (LAMP, PLACES[1])]) {
        let centre = Vec3::new(0.5, 0.0, 0.5);
        let size = Vec3::new(2.0 * half as f32, 1.0, 2.0 * half as f32);
        mesh.positions.iter_mut().for_each(|p| *p = (*p - centre) * size + Vec3::X * x as f32);
    }
    scene
}

/// Irradiance / π at a point of the floor under a lamp of radiance 1: the form factor of a parallel rectangle at
/// distance 1 (Howell, configuration B-4), from its four corners.
fn response(x: f64, z: f64, lamp: f64) -> f64 {
    let corner = |a: f64, b: f64| {
        let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
        (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) / (2.0 * std::f64::consts::PI)
    };
    let (x, z) = ([lamp - LAMP - x, lamp + LAMP - x], [-LAMP - z, LAMP - z]);
    corner(x[1], z[1]) - corner(x[0], z[1]) - corner(x[1], z[0]) + corner(x[0], z[0])
}

/// Returns the mean of `f` over the floor.
fn mean(f: impl Fn(f64, f64) -> f64) -> f64 {
    const N: usize = 400;
    let at = |i: usize| FLOOR * ((2 * i + 1) as f64 / N as f64 - 1.0);
    let sum: f64 = (0..N * N).map(|i| f(at(i % N), at(i / N))).sum();
    sum / (N * N) as f64
}

fn solve_with(scene: &Scene, fit: Fit, params: &Params) -> Solution {
    super::solve(scene, Vec3::ONE, &Params { fit, quantity: Quantity::Incident, ..params.clone() }).unwrap()
}

/// Without other light, the scale by least squares is the scale by the mean, divided by `1 + CV²`. CV is the
/// coefficient of variation of the response over the target.
#[test]
fn bright_points_count_more_by_the_coefficient_of_variation() {
    let mut scene = scene();
    scene.meshes.truncate(2);
    let r = |x, z| response(x, z, PLACES[0]);
    let (first, second) = (mean(r), mean(|x, z| r(x, z).powi(2)));
    let variation = second / (first * first) - 1.0;
    // The floor must be far from uniformly lit; otherwise both fits would give equal results.
    assert!(variation > 0.5, "{variation}");
    let params = Params { target_error: 0.004, ..Params::default() };
    let (plain, least) = (solve_with(&scene, Fit::Mean, &params), solve_with(&scene, Fit::LeastSquares, &params));
    for (solution, expected) in [(&plain, 1.0 / first), (&least, first / second)] {
        let off = solution.scale.x - expected;
        assert!(off.abs() < 2.0 * solution.half_width.x, "{solution:?}, expected {expected}");
        assert!(solution.half_width.x < 0.01 * expected);
    }
    let sigma = (plain.half_width.x / plain.scale.x).hypot(least.half_width.x / least.scale.x) / 2.04;
    let ratio = least.scale.x / plain.scale.x;
    assert!((ratio * (1.0 + variation) - 1.0).abs() < 4.0 * sigma, "{ratio}, {variation}");
}

/// With other light `b`, the least squares solution for the target `t` is `c = E[r (t - b)] / E[r²]`. With few paths,
/// `c` is noisy but unbiased. An estimate of `E[r²]` by the mean square of single paths would be far too large, and `c`
/// too small.
#[test]
fn noise_does_not_make_the_answer_dark() {
    let scene = scene();
    let (r, b) = (|x, z| response(x, z, PLACES[0]), |x, z| OTHER * response(x, z, PLACES[1]));
    let expected = mean(|x, z| r(x, z) * (1.0 - b(x, z))) / mean(|x, z| r(x, z).powi(2));
    const SEEDS: u64 = 60;
    let answers: Vec<f64> = (0..SEEDS)
        .map(|seed| {
            let params = Params { paths: 2048, target_error: 0.0, seed, ..Params::default() };
            solve_with(&scene, Fit::LeastSquares, &params).scale.x
        })
        .collect();
    let n = SEEDS as f64;
    let average = answers.iter().sum::<f64>() / n;
    let error = (answers.iter().map(|a| (a - average).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    assert!((average - expected).abs() < 4.0 * error && error < 0.01 * expected, "{average} ± {error}, {expected}");
}

#[test]
fn pairs_have_the_same_bits_for_any_number_of_threads() {
    let monitor = Monitor::default();
    let world = World::build(Arc::new(scene()), monitor.job()).unwrap();
    let input = Input { world: &world, emitter: 1, target_triangles: &[(0, 0), (0, 1)], target: Vec3::ONE };
    let params = Params { fit: Fit::LeastSquares, paths: 5000, target_error: 0.0, ..Params::default() };
    let params = Params { quantity: Quantity::Incident, ..params };
    let with = |threads| Pool::new(threads).unwrap().run(|| run(&input, &params, monitor.job()).unwrap());
    assert_eq!(with(1), with(3));
}
