//! Tests of several emitters that are solved for together.

use super::*;

/// Side of the lamps and of the square floors in metres, and position of the centres of both lamps and of both floors
/// along x. The lamps are one metre above the floors.
const LAMP: f64 = 1.0;
const FLOOR: f64 = 2.0;
const LAMPS: [f64; 2] = [-0.6, 1.1];
const FLOORS: [f64; 2] = [-1.0, 1.0];
/// The true radiance of both lamps in cd/m².
const TRUTH: [Vec3; 2] = [Vec3::new(300.0, 200.0, 100.0), Vec3::new(50.0, 120.0, 400.0)];

/// Two black floors (meshes 0 and 1) below two lamps (meshes 2 and 3, materials 1 and 2). The lamps have the radiance
/// `emission`.
fn scene(emission: [Vec3; 2]) -> Scene {
    let square = |x: f64, y: f32, side: f64, is_floor: bool, material| {
        let half = 0.5 * side as f32;
        let corner = Vec3::new(x as f32 - half, y, -half);
        let (u, v) = (Vec3::X * side as f32, Vec3::Z * side as f32);
        let (u, v) = if is_floor { (v, u) } else { (u, v) };
        Mesh::parallelogram(corner, u, v, material)
    };
    let black = |emission| Material { emission, double_sided: false, ..Material::diffuse("black", Vec3::ZERO) };
    Scene {
        meshes: vec![
            square(FLOORS[0], 0.0, FLOOR, true, 0),
            square(FLOORS[1], 0.0, FLOOR, true, 0),
            square(LAMPS[0], 1.0, LAMP, false, 1),
            square(LAMPS[1], 1.0, LAMP, false, 2),
        ],
        materials: vec![black(Vec3::ZERO), black(emission[0]), black(emission[1])],
        ..Scene::default()
    }
}

/// Mean of irradiance / π over a floor at `floor` under a lamp of radiance 1 at `lamp`: the form factor of a parallel
/// rectangle at distance 1 (Howell, configuration B-4), averaged by the midpoint rule.
fn response(floor: f64, lamp: f64) -> f64 {
    let corner = |a: f64, b: f64| {
        let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
        (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) / (2.0 * std::f64::consts::PI)
    };
    let steps = 200;
    let at = |k: usize| ((k as f64 + 0.5) / f64::from(steps) - 0.5) * FLOOR;
    let value = |i: usize| {
        let (x, z) = (floor + at(i % steps as usize), at(i / steps as usize));
        let (x, z) = ([lamp - 0.5 * LAMP - x, lamp + 0.5 * LAMP - x], [-0.5 * LAMP - z, 0.5 * LAMP - z]);
        corner(x[1], z[1]) - corner(x[0], z[1]) - corner(x[1], z[0]) + corner(x[0], z[0])
    };
    (0..(steps * steps) as usize).map(value).sum::<f64>() / f64::from(steps * steps)
}

/// The light of both floors under the lamps with their true radiance.
fn targets() -> [Vec3; 2] {
    FLOORS.map(|floor| (0..2).map(|k| TRUTH[k] * response(floor, LAMPS[k]) as f32).sum())
}

const TRIANGLES: [[(usize, usize); 2]; 2] = [[(0, 0), (0, 1)], [(1, 0), (1, 1)]];

fn planes(targets: [Vec3; 2]) -> [EmitterTarget<'static>; 2] {
    [0, 1].map(|k| EmitterTarget {
        emitter: k + 1,
        target_triangles: &TRIANGLES[k],
        target: targets[k],
        constraint: EXACTLY,
    })
}

fn together(scene: &Scene, planes: &[EmitterTarget], params: &Params) -> Result<Vec<Solution>> {
    let monitor = Monitor::default();
    let world = World::build(Arc::new(scene.clone()), monitor.job()).unwrap();
    Pool::new(2).unwrap().run(|| run_together(&world, planes, params, monitor.job()))
}

fn precise() -> Params {
    Params { quantity: Quantity::Incident, target_error: 0.004, ..Params::default() }
}

/// Both lamps are recovered from the closed form of the light of both floors. If each lamp is solved for as if the
/// other were dark, both are too bright.
#[test]
fn two_lamps_that_light_each_others_targets_are_both_recovered() {
    let unit = scene([Vec3::ONE; 2]);
    let found = together(&unit, &planes(targets()), &precise()).unwrap();
    for (solution, truth) in found.iter().zip(TRUTH) {
        let off = (solution.scale - truth.as_dvec3()).abs();
        assert!(off.cmple(1.5 * solution.half_width).all(), "{truth}: {solution:?}");
        assert!(solution.error() < 0.008 && solution.status == [TargetStatus::Met; 3], "{solution:?}");
        // The target equals the light that the solution states.
        assert!(solution.delta_e > 0.0 && solution.delta_e < 1.0, "{solution:?}");
    }
    for (k, plane) in planes(targets()).into_iter().enumerate() {
        let mut alone = [Vec3::ZERO; 2];
        alone[k] = Vec3::ONE;
        let alone = scene(alone);
        let world = World::build(Arc::new(alone), Monitor::default().job()).unwrap();
        let EmitterTarget { emitter, target_triangles, target, .. } = plane;
        let input = Input { world: &world, emitter, target_triangles, target };
        let single = Pool::new(2).unwrap().run(|| run(&input, &precise(), Monitor::default().job())).unwrap();
        let ratio = single.scale / TRUTH[k].as_dvec3();
        assert!(ratio.min_element() > 1.015 && ratio.max_element() > 1.3, "lamp {k} alone: {ratio}");
    }
}

/// With a single emitter, the scale is the closed form of [`run`].
#[test]
fn one_emitter_gives_the_closed_form() {
    let scene = room(Vec3::new(4.0, 2.5, 3.0), Vec3::new(0.7, 0.5, 0.3), Vec3::splat(0.8), Vec3::ONE);
    let params = Params { target_error: 0.01, ..Params::default() };
    let target = Vec3::new(3.0, 2.0, 1.0);
    let single = solve(&scene, target, &params).unwrap();
    let plane = EmitterTarget { emitter: 1, target_triangles: &[(0, 0), (0, 1)], target, constraint: EXACTLY };
    let found = &together(&scene, &[plane], &params).unwrap()[0];
    assert!((found.scale / single.scale - 1.0).abs().max_element() < 1e-3, "{found:?} {single:?}");
    assert!((found.half_width / single.half_width - 1.0).abs().max_element() < 1e-6, "{found:?} {single:?}");
    assert!((found.delta_e / single.delta_e - 1.0).abs() < 0.05, "{found:?} {single:?}");
    assert_eq!((found.response, found.background), (single.response, single.background));
}

#[test]
fn the_order_of_the_emitters_changes_nothing_but_rounding() {
    let unit = scene([Vec3::ONE; 2]);
    let params = Params { paths: 1 << 14, ..precise() };
    let [a, b] = planes(targets());
    let there = together(&unit, &[a, b], &params).unwrap();
    let back = together(&unit, &[b, a], &params).unwrap();
    for (x, y) in there.iter().zip(back.iter().rev()) {
        assert!((x.scale / y.scale - 1.0).abs().max_element() < 1e-6, "{x:?} {y:?}");
        assert_eq!(x.response, y.response);
    }
}

/// A target that the other lamp alone exceeds puts its own lamp out, and says so; the other target is still met.
#[test]
fn a_target_that_the_other_lamp_exceeds_is_too_bright() {
    let unit = scene([Vec3::ONE; 2]);
    let bright = targets()[0];
    let found = together(&unit, &planes([bright, Vec3::splat(0.01)]), &precise()).unwrap();
    assert_eq!(found[0].status, [TargetStatus::Met; 3]);
    assert!((found[0].scale * found[0].response / bright.as_dvec3() - 1.0).abs().max_element() < 1e-6, "{found:?}");
    assert_eq!(found[1].scale, DVec3::ZERO);
    assert_eq!(found[1].status, [TargetStatus::TooBright; 3]);
    assert_eq!(found[1].warnings().len(), 1);
}

/// Two emitters that light each other's targets more than their own: if no scales ≥ 0 meet both, one
/// emitter is off, the target that is then too bright says so, and the other is met.
#[test]
fn contradicting_targets_leave_one_of_them_met() {
    // The lamps change places: each floor is now lit mostly by the lamp of the other.
    let unit = scene([Vec3::ONE; 2]);
    let wanted = [Vec3::splat(20.0), Vec3::splat(1.0)];
    let [a, b] = planes(wanted);
    let crossed = [EmitterTarget { emitter: 2, ..a }, EmitterTarget { emitter: 1, ..b }];
    let found = together(&unit, &crossed, &precise()).unwrap();
    assert_eq!((found[0].status, found[1].status), ([TargetStatus::Met; 3], [TargetStatus::TooBright; 3]), "{found:?}");
    assert!(found[0].scale == DVec3::ZERO && found[1].scale.min_element() > 0.0, "{found:?}");
    assert!((found[0].background / 20.0 - 1.0).abs().max_element() < 1e-6, "{found:?}");
}

/// A lamp without red has no scale for red; it takes the mean of its other channels, and red of the other lamp is
/// solved for without it.
#[test]
fn a_channel_without_light_follows_the_other_channels() {
    let dim = scene([Vec3::new(0.0, 1.0, 1.0), Vec3::ONE]);
    let mut wanted = targets();
    for (k, floor) in FLOORS.iter().enumerate() {
        wanted[k].x = TRUTH[1].x * response(*floor, LAMPS[1]) as f32;
    }
    let found = together(&dim, &planes(wanted), &precise()).unwrap();
    assert_eq!(found[0].status[0], TargetStatus::Dark);
    assert!((found[0].scale.x - 0.5 * (found[0].scale.y + found[0].scale.z)).abs() < 1e-9);
    let red = found[1].scale.x / f64::from(TRUTH[1].x);
    assert!((red - 1.0).abs() < 0.01, "{found:?}");
}

/// A lower limit that is met leaves the colour of its lamp as it is.
#[test]
fn a_limit_that_holds_keeps_the_colour() {
    let unit = scene([Vec3::ONE; 2]);
    let white = [Vec3::splat(200.0), Vec3::splat(90.0)];
    let light = |k: usize| (0..2).map(|j| white[j] * response(FLOORS[k], LAMPS[j]) as f32).sum::<Vec3>();
    let mut limited = planes([light(0) * Vec3::new(0.5, 1.0, 1.0), light(1)]);
    limited[0].constraint[0] = Constraint::AtLeast;
    let found = together(&unit, &limited, &precise()).unwrap();
    assert!((found[0].scale.x - 0.5 * (found[0].scale.y + found[0].scale.z)).abs() < 1e-9);
    for (solution, white) in found.iter().zip(white) {
        assert!((solution.scale / white.as_dvec3() - 1.0).abs().max_element() < 0.01, "{solution:?}");
        assert_eq!(solution.status, [TargetStatus::Met; 3]);
    }
}

#[test]
fn wrong_planes_are_named() {
    let unit = scene([Vec3::ONE; 2]);
    let message = |planes: &[EmitterTarget], params: &Params| together(&unit, planes, params).unwrap_err().message;
    let [a, b] = planes(targets());
    assert!(message(&[], &precise()).contains("there are 0 planes"));
    assert!(message(&[a, EmitterTarget { emitter: 1, ..b }], &precise()).contains("emitting material 1"));
    assert!(message(&[a, EmitterTarget { target: Vec3::NAN, ..b }], &precise()).starts_with("target is"));
    let squares = Params { fit: Fit::LeastSquares, ..precise() };
    assert!(message(&[a, b], &squares).contains("fit is least squares"));
    // Without any light at the targets, there is no solution.
    let dark = scene([Vec3::ZERO; 2]);
    let error = together(&dark, &[a, b], &Params { paths: 1 << 12, ..precise() }).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Unreachable);
}
