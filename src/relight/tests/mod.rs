mod extremes;
mod groups;
mod importance;
mod least_squares;
mod several;

use super::*;
use crate::error::ErrorKind;
use crate::exec::Pool;
use crate::job::Monitor;
use crate::scene::{Material, Mesh, PunctualLight, Scene};
use glam::{DVec3, Vec2};
use std::sync::Arc;

const EXACTLY: [Constraint; 3] = [Constraint::Exactly; 3];

/// A box room of `size` metres whose six sides face inwards: floor, ceiling, then the walls. The ceiling has material
/// 1, everything else material 0.
fn room(size: Vec3, walls: Vec3, ceiling: Vec3, emission: Vec3) -> Scene {
    let corner = |i: usize| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32) * size;
    let side = |name: &str, material, quad: [usize; 4]| Mesh {
        name: name.into(),
        material,
        positions: quad.map(corner).to_vec(),
        uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y], Vec::new()],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    Scene {
        meshes: vec![
            side("floor", 0, [0, 4, 5, 1]),
            side("ceiling", 1, [2, 3, 7, 6]),
            side("back", 0, [0, 1, 3, 2]),
            side("front", 0, [4, 6, 7, 5]),
            side("left", 0, [0, 2, 6, 4]),
            side("right", 0, [1, 5, 7, 3]),
        ],
        materials: vec![
            Material { double_sided: false, ..Material::diffuse("walls", walls) },
            Material { emission, double_sided: false, ..Material::diffuse("ceiling", ceiling) },
        ],
        ..Scene::default()
    }
}

fn solve(scene: &Scene, target: Vec3, params: &Params) -> Result<Solution> {
    let pool = Pool::new(2).unwrap();
    let monitor = Monitor::default();
    let world = World::build(Arc::new(scene.clone()), monitor.job()).unwrap();
    // The whole ceiling emits. The floor is the target, because it has no lamps, which a target excludes.
    let input = Input { world: &world, emitter: 1, target_triangles: &[(0, 0), (0, 1)], target };
    pool.run(|| run(&input, params, monitor.job()))
}

fn powers(responses: &Responses, goals: &[Goal], params: &GroupParams) -> Result<GroupSolution> {
    Pool::new(2).unwrap().run(|| solve_groups(responses, goals, params, Monitor::default().job()))
}

/// In a room with black walls, the floor gets light directly from the ceiling only: its irradiance is `E = π F L`,
/// where L is the radiance of the ceiling and F the form factor of two equal parallel rectangles.
#[test]
fn a_black_room_answers_with_the_form_factor() {
    let scene = room(Vec3::new(2.0, 1.0, 2.0), Vec3::ZERO, Vec3::ZERO, Vec3::ONE);
    let params = Params { quantity: Quantity::Incident, target_error: 0.002, ..Params::default() };
    let solution = solve(&scene, Vec3::ONE, &params).unwrap();
    // Equal parallel rectangles at distance 1 with sides X = Y = 2 (Howell, configuration C-11).
    let (x, y) = (2.0f64, 2.0f64);
    let (x1, y1) = (1.0 + x * x, 1.0 + y * y);
    let f = 2.0 / (std::f64::consts::PI * x * y)
        * ((x1 * y1 / (x1 + y1 - 1.0)).sqrt().ln()
            + x * y1.sqrt() * (x / y1.sqrt()).atan()
            + y * x1.sqrt() * (y / x1.sqrt()).atan()
            - x * x.atan()
            - y * y.atan());
    for c in 0..3 {
        assert!(
            (solution.scale[c] - 1.0 / f).abs() < 1.5 * solution.half_width[c],
            "{solution:?}, expected {}",
            1.0 / f
        );
        assert!(solution.half_width[c] / solution.scale[c] < 0.002);
    }
    // For a middle grey, a relative error of 0.2 % in all channels changes the CIELAB lightness by about 0.07.
    assert!(solution.delta_e > 0.01 && solution.delta_e < 0.1, "{}", solution.delta_e);
}

/// The emission that caused a target radiance is recovered from this radiance, with another light in the room.
#[test]
fn a_known_emitter_is_recovered_under_other_light() {
    let truth = Vec3::new(120.0, 80.0, 40.0);
    let mut scene = room(Vec3::new(4.0, 2.5, 3.0), Vec3::new(0.7, 0.5, 0.3), Vec3::splat(0.8), Vec3::ONE);
    scene
        .lights
        .push(PunctualLight::Point { position: Vec3::new(1.0, 1.2, 1.0), intensity: Vec3::new(20.0, 30.0, 60.0) });
    let params = Params { target_error: 0.004, ..Params::default() };
    let unit = solve(&scene, Vec3::splat(1e6), &params).unwrap();
    let target = (unit.response * truth.as_dvec3() + unit.background).as_vec3();
    let solution = solve(&scene, target, &Params { seed: 99, ..params }).unwrap();
    for c in 0..3 {
        let error = (solution.scale[c] - f64::from(truth[c])).abs();
        // The target and the solution are independent estimates, each with its own interval.
        assert!(error < 2.0 * std::f64::consts::SQRT_2 * solution.half_width[c], "{solution:?}");
    }
}

#[test]
fn unreachable_targets_are_reported() {
    let params = Params { paths: 1 << 14, ..Params::default() };
    let unreachable = |scene: &Scene, target: Vec3, reason: &str| {
        let error = solve(scene, target, &params).unwrap_err();
        assert!(error.message.contains(reason), "{error}");
        error.kind
    };
    // A black floor reflects nothing.
    let black = room(Vec3::ONE, Vec3::ZERO, Vec3::ONE * 0.5, Vec3::ONE);
    assert_eq!(unreachable(&black, Vec3::ONE, "no light of the emission finds its way back"), ErrorKind::Unreachable);
    // Another light exceeds the target.
    let mut bright = room(Vec3::ONE, Vec3::splat(0.5), Vec3::splat(0.5), Vec3::ONE);
    bright.lights.push(PunctualLight::Point { position: Vec3::splat(0.5), intensity: Vec3::splat(1e3) });
    assert_eq!(unreachable(&bright, Vec3::ONE, "the other lights of the scene alone"), ErrorKind::Unreachable);
    // A channel that the walls absorb completely gets the mean scale of the other channels.
    let redless = room(Vec3::ONE, Vec3::new(0.0, 0.5, 0.5), Vec3::splat(0.5), Vec3::ONE);
    let solution = solve(&redless, Vec3::ONE, &params).unwrap();
    assert_eq!(solution.status, [TargetStatus::Dark, TargetStatus::Met, TargetStatus::Met]);
    assert!((solution.scale.x - (solution.scale.y + solution.scale.z) / 2.0).abs() < 1e-9);
    // Errors name the parameter.
    for target in [Vec3::splat(-1.0), Vec3::NAN] {
        assert!(solve(&redless, target, &params).unwrap_err().message.starts_with("target is"));
    }
}

/// If a channel has a limit, the emission keeps its colour unless the limit would then be violated.
#[test]
fn a_limit_binds_only_where_it_is_broken() {
    let scene = room(Vec3::new(4.0, 2.5, 3.0), Vec3::new(0.7, 0.5, 0.3), Vec3::splat(0.8), Vec3::ONE);
    let params = Params { target_error: 0.005, ..Params::default() };
    let unit = solve(&scene, Vec3::ONE, &params).unwrap();
    let truth = (unit.response * 100.0).as_vec3();
    let least = |target: Vec3, constraint: Constraint| {
        let constraint = [constraint, Constraint::Exactly, Constraint::Exactly];
        solve(&scene, target, &Params { seed: 99, constraint, ..params.clone() }).unwrap()
    };
    // The lower limit of red is 0.6 times the red light of lamps of unchanged colour, so the limit changes nothing.
    let free = least(truth * Vec3::new(0.6, 1.0, 1.0), Constraint::AtLeast);
    for c in 0..3 {
        let allowed = 2.0 * (free.half_width[c] + 0.005 * 100.0);
        assert!((free.scale[c] - 100.0).abs() < allowed && free.status[c] == TargetStatus::Met, "{free:?}");
    }
    assert!((free.scale.x - (free.scale.y + free.scale.z) / 2.0).abs() < 1e-9);
    assert!(free.half_width.x > 0.0 && free.error() < 0.006 && free.delta_e < 1.0, "{free:?}");
    // Channel x has a limit, and the others have exact targets. If the scale that fits the others would violate the
    // limit of x, channel x meets its limit exactly.
    for (factor, constraint) in [(1.5, Constraint::AtLeast), (0.5, Constraint::AtMost)] {
        let bound = least(truth * Vec3::new(factor, 1.0, 1.0), constraint);
        let exact = least(truth * Vec3::new(factor, 1.0, 1.0), Constraint::Exactly);
        assert_eq!((bound.scale, bound.half_width), (exact.scale, exact.half_width));
    }
    assert_eq!(least(truth * Vec3::new(1.5, 1.0, 1.0), Constraint::AtMost).scale.x, {
        let s = least(truth, Constraint::AtMost).scale;
        (s.y + s.z) / 2.0
    });
    // If all channels have lower limits, the solution is the least light that satisfies them.
    let all =
        solve(&scene, truth, &Params { constraint: [Constraint::AtLeast; 3], seed: 99, ..params.clone() }).unwrap();
    assert_eq!(all.scale, least(truth, Constraint::Exactly).scale);
    // No light is needed where other light satisfies the limits.
    let mut bright = scene.clone();
    bright.lights.push(PunctualLight::Point { position: Vec3::ONE, intensity: Vec3::splat(1e3) });
    let none = solve(&bright, Vec3::splat(1e-3), &Params { constraint: [Constraint::AtLeast; 3], ..params }).unwrap();
    assert_eq!((none.scale, none.status), (DVec3::ZERO, [TargetStatus::Met; 3]));
}

#[test]
fn a_black_target_needs_no_light() {
    let scene = room(Vec3::ONE, Vec3::splat(0.5), Vec3::splat(0.5), Vec3::ONE);
    let solution = solve(&scene, Vec3::ZERO, &Params { paths: 1 << 14, ..Params::default() }).unwrap();
    assert_eq!(solution.scale, DVec3::ZERO);
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let scene = Arc::new(room(Vec3::new(3.0, 2.0, 1.0), Vec3::splat(0.6), Vec3::splat(0.7), Vec3::ONE));
    let monitor = Monitor::default();
    let world = World::build(scene, monitor.job()).unwrap();
    let input = Input { world: &world, emitter: 1, target_triangles: &[(0, 0)], target: Vec3::ONE };
    let params = Params { paths: 1 << 15, target_error: 0.0, ..Params::default() };
    let with = |threads| Pool::new(threads).unwrap().run(|| run(&input, &params, monitor.job()).unwrap());
    assert_eq!(with(1), with(3));
}
