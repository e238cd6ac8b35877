//! Tests of the responses to single lamps, and of the solved powers of lamp groups.

use super::*;
use crate::image::Image;
use crate::photometry::Luminaire;
use crate::scene::{Texture, TextureRef};

/// Number of texels along each side of the ceiling's texture.
const TEXELS: usize = 16;

/// A grey room with emissive texels at `lamps` in the ceiling's texture; each of these texels is a lamp.
fn lamp_room(lamps: &[[usize; 2]], values: &[f32]) -> (World, EmissionLamps) {
    let mut image = Image::new(TEXELS, TEXELS, 1).unwrap();
    for (&[x, y], &value) in lamps.iter().zip(values) {
        image.pixel_mut(x, y)[0] = value;
    }
    let found = EmissionLamps::of_texture(&image).unwrap();
    let mut scene = room(Vec3::new(4.0, 2.5, 4.0), Vec3::splat(0.5), Vec3::splat(0.7), Vec3::splat(100.0));
    scene.textures.push(Texture::new("lamps", image));
    scene.materials[1].emission_texture = Some(TextureRef::new(0));
    (World::build(Arc::new(scene), Monitor::default().job()).unwrap(), found)
}

const FLOOR: &[(usize, usize)] = &[(0, 0), (0, 1)];

fn goal(geometry: TargetGeometry<'_>, target: Vec3) -> Goal<'_> {
    Goal { geometry, quantity: Quantity::Incident, target, aspect: Aspect::Colour, constraint: EXACTLY, weight: 1.0 }
}

/// A horizontal square with sides of 1 m, at desk height, centred under the point (x, z) of the ceiling.
fn desk(x: f32, z: f32) -> TargetGeometry<'static> {
    let origin = Vec3::new(x - 0.5, 0.8, z - 0.5);
    TargetGeometry::Grid { origin, across: Vec3::X, down: Vec3::Z, normal: Vec3::Y }
}

fn respond(world: &World, lamps: &EmissionLamps, goals: &[Goal]) -> Responses {
    let params = Params { paths: 1 << 15, target_error: 0.0, ..Params::default() };
    let monitor = Monitor::default();
    Pool::new(2).unwrap().run(|| lamp_responses(world, 1, lamps, goals, &params, monitor.job()).unwrap())
}

#[test]
fn lamps_sum_to_the_whole_and_mirrored_lamps_respond_alike() {
    let (world, lamps) = lamp_room(&[[3, 3], [12, 3], [3, 12], [12, 12]], &[1.0; 4]);
    let responses = respond(&world, &lamps, &[goal(TargetGeometry::Surface(FLOOR), Vec3::ONE)]);
    let params = Params { paths: 1 << 15, target_error: 0.0, quantity: Quantity::Incident, ..Params::default() };
    let input = Input { world: &world, emitter: 1, target_triangles: FLOOR, target: Vec3::ONE };
    let whole = Pool::new(2).unwrap().run(|| run(&input, &params, Monitor::default().job()).unwrap());
    // The response to all lamps and the response of `run` come from the same paths, sorted into different bins.
    let all = responses.all(0).mean;
    assert!((all - whole.response).abs().max_element() < 1e-9 * all.x, "{all} {}", whole.response);
    for lamp in 1..4 {
        let (a, b) = (responses.lamp(0, 0), responses.lamp(0, lamp));
        let sigma = a.standard_error.x.hypot(b.standard_error.x);
        assert!((a.mean.x - b.mean.x).abs() < 4.5 * sigma, "lamp {lamp}: {a:?} {b:?}");
        assert!(a.standard_error.x / a.mean.x < 0.02);
    }
    // Group the lamps by rows of the texture.
    let (rows, count) = lamps.rows(1, 0.1);
    assert_eq!((rows.as_slice(), count), (&[0, 0, 1, 1][..], 2));
    let rows = responses.grouped(&rows, count).unwrap();
    let (top, bottom) = (rows.lamp(0, 0).mean.x, rows.lamp(0, 1).mean.x);
    assert!((top + bottom - all.x).abs() < 1e-9 * all.x);
    assert!(responses.grouped(&[0, 0, 0], 1).is_err() && responses.grouped(&[0, 0, 0, 7], 2).is_err());
}

#[test]
fn one_group_is_the_closed_form_and_bounds_hold() {
    let (world, lamps) = lamp_room(&[[3, 3], [12, 12]], &[1.0; 2]);
    let target = Vec3::splat(20.0);
    let goals = [goal(TargetGeometry::Surface(FLOOR), target)];
    let responses = respond(&world, &lamps, &goals).grouped(&[0, 0], 1).unwrap();
    let free = powers(&responses, &goals, &GroupParams::default()).unwrap();
    let expected = 20.0 / responses.all(0).mean.x;
    assert!((free.scale[0].x / expected - 1.0).abs() < 1e-9, "{free:?}, expected {expected}");
    assert!(free.half_width[0].x > 0.0 && free.half_width[0].x < 0.05 * expected);
    assert_eq!((free.outcomes[0].status, &free.unreachable), ([TargetStatus::Met; 3], &None));
    // If the upper bound is half the required power, the solution is the bound, and the explanation names the bound.
    let bounded = GroupParams { max_scale: vec![expected / 2.0], ..GroupParams::default() };
    let bounded = powers(&responses, &goals, &bounded).unwrap();
    assert_eq!(bounded.scale[0].x, expected / 2.0);
    assert_eq!(bounded.outcomes[0].status, [TargetStatus::TooDim; 3]);
    assert!((bounded.outcomes[0].achieved.x - 10.0).abs() < 1e-6);
    assert!(bounded.unreachable.unwrap().contains("largest power"));
}

/// Identical groups get equal powers, groups of very different strength cause no problems, and darkness is a valid
/// goal.
#[test]
fn groups_of_equal_or_very_different_strength_and_dark_goals() {
    let (world, lamps) = lamp_room(&[[3, 3], [12, 3], [3, 12], [12, 12]], &[1.0, 1.0, 1.0, 1e-12]);
    let goals = [goal(TargetGeometry::Surface(FLOOR), Vec3::splat(20.0))];
    let responses = respond(&world, &lamps, &goals);
    let solution = powers(&responses, &goals, &GroupParams::default()).unwrap();
    let x: Vec<f64> = solution.scale.iter().map(|x| x.x).collect();
    // A single goal leaves the distribution over the lamps open; the regularisation makes all powers equal.
    assert!(x.iter().all(|v| (v / x[0] - 1.0).abs() < 1e-6), "{x:?}");
    assert!((solution.outcomes[0].achieved.x / 20.0 - 1.0).abs() < 1e-6);
    // The faint lamp would have to be 1e12 times as strong to light the second desk. The solution stays finite, and the
    // goal of this desk is reported as missed.
    let ask = [goal(desk(0.9, 0.9), Vec3::splat(20.0)), goal(desk(3.1, 3.1), Vec3::splat(90.0))];
    let (faint, pair) = lamp_room(&[[3, 3], [12, 12]], &[1.0, 1e-12]);
    let most = GroupParams { max_scale: vec![f64::INFINITY, 2.0], ..GroupParams::default() };
    for params in [GroupParams::default(), most] {
        let solution = powers(&respond(&faint, &pair, &ask), &ask, &params).unwrap();
        let finite = solution.scale.iter().chain(&solution.half_width).all(|x| x.is_finite());
        let met = solution.outcomes.iter().all(|o| o.status == [TargetStatus::Met; 3]);
        assert!(finite && met == solution.unreachable.is_none(), "{solution:?}");
    }
    // A goal of darkness switches the lamps off.
    let dark = [goal(TargetGeometry::Surface(FLOOR), Vec3::ZERO)];
    let off = powers(&responses, &dark, &GroupParams::default()).unwrap();
    assert!(off.scale.iter().all(|x| *x == DVec3::ZERO) && off.unreachable.is_none(), "{off:?}");
    // There are two desks, each below a lamp; the first is to be brighter.
    let goals = [goal(desk(0.9, 0.9), Vec3::splat(40.0)), goal(desk(3.1, 3.1), Vec3::splat(25.0))];
    let (world, lamps) = lamp_room(&[[3, 3], [12, 12]], &[1.0; 2]);
    let responses = respond(&world, &lamps, &goals);
    let solution = powers(&responses, &goals, &GroupParams::default()).unwrap();
    assert!(solution.scale[0].x > 1.3 * solution.scale[1].x, "{solution:?}");
    for (outcome, want) in solution.outcomes.iter().zip([40.0, 25.0]) {
        assert!(
            (outcome.achieved.x / want - 1.0).abs() < 1e-3 && outcome.status == [TargetStatus::Met; 3],
            "{outcome:?}"
        );
    }
    // A single group cannot meet both goals: the solution is a compromise, and the explanation names a goal.
    let one = responses.grouped(&[0, 0], 1).unwrap();
    let torn = powers(&one, &goals, &GroupParams::default()).unwrap();
    assert!(torn.outcomes[0].achieved.x < 40.0 && torn.outcomes[1].achieved.x > 25.0);
    assert!(torn.unreachable.unwrap().contains("goal 0"));
    // A goal of larger weight has a smaller error.
    let heavy = [Goal { weight: 100.0, ..goals[0] }, goals[1]];
    let heavy = powers(&one, &heavy, &GroupParams::default()).unwrap();
    assert!((heavy.outcomes[0].achieved.x / 40.0 - 1.0).abs() < 1e-3);
}

#[test]
fn other_light_that_is_too_bright_is_named() {
    let (world, lamps) = lamp_room(&[[3, 3], [12, 12]], &[1.0; 2]);
    let mut scene = (**world.scene()).clone();
    scene.lights.push(PunctualLight::Point { position: Vec3::new(2.0, 1.0, 2.0), intensity: Vec3::splat(1e4) });
    let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
    let goals = [goal(TargetGeometry::Surface(FLOOR), Vec3::ONE)];
    let responses = respond(&world, &lamps, &goals);
    let params = GroupParams { colour: Colour::PerChannel, ..GroupParams::default() };
    let solution = powers(&responses, &goals, &params).unwrap();
    assert!(solution.scale.iter().all(|x| *x == DVec3::ZERO));
    assert_eq!(solution.outcomes[0].status, [TargetStatus::TooBright; 3]);
    assert!(solution.unreachable.unwrap().contains("other lights alone"));
    // Invalid parameters are errors.
    for bad in [
        GroupParams { regularisation: 0.0, ..GroupParams::default() },
        GroupParams { max_scale: vec![1.0], ..GroupParams::default() },
        GroupParams { max_scale: vec![1.0, f64::NAN], ..GroupParams::default() },
    ] {
        assert_eq!(powers(&responses, &goals, &bad).unwrap_err().kind, ErrorKind::InvalidArgument);
    }
}

/// Causes each reason for a missed goal, and checks that the reason is reported.
#[test]
fn every_reason_for_a_missed_goal_is_reported() {
    let (world, lamps) = lamp_room(&[[3, 3], [12, 12]], &[1.0; 2]);
    let reason_for = |world: &World, goals: &[Goal], params: &GroupParams| {
        let responses = respond(world, &lamps, goals);
        powers(&responses, goals, params).unwrap().unreachable.unwrap_or_default()
    };
    let (kept, free) = (GroupParams::default(), GroupParams { colour: Colour::PerChannel, ..GroupParams::default() });
    let floor = |target| Goal { quantity: Quantity::Outgoing, ..goal(TargetGeometry::Surface(FLOOR), target) };
    // A floor that absorbs red reflects none of it.
    let mut redless = (**world.scene()).clone();
    redless.materials[0].base_color.x = 0.0;
    let redless = World::build(Arc::new(redless), Monitor::default().job()).unwrap();
    let reason = reason_for(&redless, &[floor(Vec3::splat(5.0))], &free);
    assert!(reason.contains("in red") && reason.contains("no light of these lamps finds its way there"), "{reason}");
    // Test a colour that the groups cannot produce, then goals that contradict each other, with fixed and with free
    // colours.
    let reason = reason_for(&world, &[floor(Vec3::new(9.0, 5.0, 1.0))], &kept);
    assert!(reason.contains("a colour that the groups do not have"), "{reason}");
    let torn = [floor(Vec3::splat(5.0)), floor(Vec3::splat(9.0))];
    let reason = reason_for(&world, &torn, &free);
    assert!(reason.contains("different things") && !reason.contains("colours"), "{reason}");
    let lux = torn.map(|goal| Goal { aspect: Aspect::Luminance, ..goal });
    let reason = reason_for(&world, &lux, &kept);
    assert!(
        reason.contains("luminance") && reason.contains("different things") && !reason.contains("colour"),
        "{reason}"
    );
    // Test goals for which the powers reach their upper bounds, then goals that the other lights alone exceed.
    let reason =
        reason_for(&world, &[floor(Vec3::splat(1e6))], &GroupParams { max_scale: vec![1.0; 2], ..kept.clone() });
    assert!(reason.contains("all groups are at their largest power"), "{reason}");
    let mut bright = (**world.scene()).clone();
    bright.lights.push(PunctualLight::Point { position: Vec3::new(2.0, 1.0, 2.0), intensity: Vec3::splat(1e4) });
    let bright = World::build(Arc::new(bright), Monitor::default().job()).unwrap();
    let reason = reason_for(&bright, &[floor(Vec3::ONE)], &kept);
    assert!(reason.contains("the other lights alone are brighter"), "{reason}");
    // If no group has any response, the result is an error.
    let mut black = (**world.scene()).clone();
    black.materials[0].base_color = Vec3::ZERO;
    let black = World::build(Arc::new(black), Monitor::default().job()).unwrap();
    let responses = respond(&black, &lamps, &[floor(Vec3::ONE)]);
    let error = powers(&responses, &[floor(Vec3::ONE)], &kept).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Unreachable);
    assert!(error.message.contains("no light of any group finds its way to a goal"), "{error}");
}

/// A goal in lux is met if the luminance at the goal's place is right, whatever the colour of the light.
#[test]
fn lux_are_luminance() {
    let (world, lamps) = lamp_room(&[[3, 3], [12, 12]], &[1.0; 2]);
    let mut scene = (**world.scene()).clone();
    scene.materials[0].base_color = Vec3::new(0.7, 0.4, 0.2);
    let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
    let lux = Goal { aspect: Aspect::Luminance, ..goal(desk(2.0, 2.0), Vec3::splat(500.0 / std::f32::consts::PI)) };
    let responses = respond(&world, &lamps, &[lux]);
    let solution = powers(&responses, &[lux], &GroupParams::default()).unwrap();
    let outcome = &solution.outcomes[0];
    assert_eq!((outcome.status, &solution.unreachable), ([TargetStatus::Met; 3], &None));
    let illuminance = std::f32::consts::PI * crate::image::colour::luminance(outcome.achieved.as_vec3());
    assert!((illuminance - 500.0).abs() < 0.1 && outcome.achieved.x > 1.05 * outcome.achieved.z, "{outcome:?}");
    let free = GroupParams { colour: Colour::PerChannel, ..GroupParams::default() };
    assert_eq!(powers(&responses, &[lux], &free).unwrap_err().kind, ErrorKind::InvalidArgument);
}

/// Two lamps above two desks: if limits can be satisfied, the solution satisfies them with the least light.
#[test]
fn limits_count_on_one_side() {
    let (world, lamps) = lamp_room(&[[3, 3], [12, 12]], &[1.0; 2]);
    let at =
        |x, z, target: f32, constraint| Goal { constraint: [constraint; 3], ..goal(desk(x, z), Vec3::splat(target)) };
    let traced = [at(0.9, 0.9, 1.0, Constraint::Exactly), at(3.1, 3.1, 1.0, Constraint::Exactly)];
    let responses = respond(&world, &lamps, &traced);
    let solve = |first, second| {
        let goals = [Goal { geometry: traced[0].geometry, ..first }, Goal { geometry: traced[1].geometry, ..second }];
        powers(&responses, &goals, &GroupParams { tolerance: 1e-4, ..GroupParams::default() }).unwrap()
    };
    let one = |least, constraint| at(0.0, 0.0, least, constraint);
    // With two equal lower limits, both lamps get the power at which the darker desk just reaches its limit. The
    // brighter desk exceeds its limit.
    let both = responses.all(0).mean.x.min(responses.all(1).mean.x);
    let solution = solve(one(40.0, Constraint::AtLeast), one(40.0, Constraint::AtLeast));
    assert!(solution.unreachable.is_none(), "{solution:?}");
    let power = solution.scale.iter().map(|x| x.x).fold(0.0, f64::max);
    assert!((power / (40.0 / both) - 1.0).abs() < 1e-3, "{solution:?} {both}");
    // Equal powers would violate the upper limit of the second desk, so the lamp above the first desk takes over some
    // power.
    let solution = solve(one(40.0, Constraint::AtLeast), one(25.0, Constraint::AtMost));
    let light: Vec<f64> = solution.outcomes.iter().map(|o| o.achieved.x).collect();
    assert!(light[0] > 39.99 && light[1] < 25.01 && solution.unreachable.is_none(), "{solution:?}");
    // With upper limits alone, lamps keep their power or are reduced to the limit.
    let caps = [1e3, 0.5 * responses.all(0).mean.x as f32];
    assert_eq!(solve(one(caps[0], Constraint::AtMost), one(1e3, Constraint::AtMost)).scale, [DVec3::ONE; 2]);
    let solution = solve(one(caps[1], Constraint::AtMost), one(1e3, Constraint::AtMost));
    assert!((solution.outcomes[0].achieved.x / f64::from(caps[1]) - 1.0).abs() < 1e-3, "{solution:?}");
    // If two goals contradict each other, the missed lower limit is reported as too dim, and the missed upper limit as
    // too bright.
    let goals = [at(0.9, 0.9, 40.0, Constraint::AtLeast), at(3.1, 3.1, 1.0, Constraint::AtMost)];
    let torn = powers(&responses, &goals, &GroupParams::default()).unwrap();
    assert_eq!([0, 1].map(|goal| torn.outcomes[goal].status[0]), [TargetStatus::TooDim, TargetStatus::TooBright]);
    assert!(torn.unreachable.unwrap().contains("at least 40.0000 cd/m²"));
    // A luminance goal can have only one kind of constraint.
    let mixed = [Constraint::AtLeast, Constraint::AtMost, Constraint::Exactly];
    let goals = [Goal { aspect: Aspect::Luminance, constraint: mixed, ..traced[0] }, traced[1]];
    assert_eq!(powers(&responses, &goals, &GroupParams::default()).unwrap_err().kind, ErrorKind::InvalidArgument);
}

/// With dimming levels, all powers are levels and the goals are still met; with too few levels, the missed goals are
/// reported.
#[test]
fn powers_in_steps() {
    let places: Vec<[usize; 2]> = (0..16).map(|i| [1 + 4 * (i % 4), 1 + 4 * (i / 4)]).collect();
    let (world, lamps) = lamp_room(&places, &[1.0; 16]);
    let goals = [goal(TargetGeometry::Surface(FLOOR), Vec3::splat(20.0)), goal(desk(1.0, 1.0), Vec3::splat(25.0))];
    let responses = respond(&world, &lamps, &goals);
    let solve = |levels: &[f64]| {
        let params = GroupParams { levels: levels.to_vec(), tolerance: 0.02, ..GroupParams::default() };
        powers(&responses, &goals, &params).unwrap()
    };
    let free = solve(&[]);
    let most = free.scale.iter().map(|x| x.x).fold(0.0, f64::max);
    let levels: Vec<f64> = (0..=10).rev().map(|i| most * 0.1 * f64::from(i)).collect();
    let stepped = solve(&levels);
    assert!(stepped.scale.iter().all(|x| levels.contains(&x.x) && *x == DVec3::splat(x.x)), "{stepped:?}");
    assert!(stepped.unreachable.is_none(), "{stepped:?}");
    // The intervals include the distance between the chosen level and the continuous power.
    for i in 0..16 {
        let step = (stepped.scale[i] - free.scale[i]).abs();
        assert_eq!(stepped.half_width[i], free.half_width[i] + step);
    }
    let coarse = solve(&[0.0, 40.0 * most]);
    assert!(coarse.unreachable.is_some(), "{coarse:?}");
    let params = GroupParams { levels: vec![-1.0], ..GroupParams::default() };
    assert_eq!(powers(&responses, &goals, &params).unwrap_err().kind, ErrorKind::InvalidArgument);
}

/// Luminaires from photometric files are lamps: their responses follow the cosine law, and the solved powers light the
/// desks as requested.
#[test]
fn luminaires_are_lamps() {
    let places = [Vec3::new(0.9, 2.2, 0.9), Vec3::new(3.1, 2.2, 2.1)];
    let hang = |position: Vec3| PunctualLight::Luminaire {
        position,
        axis: Vec3::NEG_Y,
        c0: Vec3::X,
        colour: Vec3::ONE,
        distribution: 0,
        is_point: false,
    };
    let mut scene = room(Vec3::new(4.0, 2.5, 3.0), Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    scene.lights = places.map(hang).to_vec();
    scene.distributions = vec![Arc::new(Luminaire::lambertian("panel", 1000.0, [0.0; 3]))];
    // Squares of 1 cm are nearly points.
    let desks = [Vec3::new(0.9, 0.75, 0.9), Vec3::new(2.6, 0.75, 2.1)];
    let (across, down) = (Vec3::X * 0.01, Vec3::Z * 0.01);
    let aims: Vec<Goal> = desks
        .iter()
        .zip([500.0, 300.0])
        .map(|(desk, lux)| {
            let place = TargetGeometry::Grid { origin: *desk - (across + down) / 2.0, across, down, normal: Vec3::Y };
            goal(place, Vec3::splat(lux / std::f32::consts::PI))
        })
        .collect();
    let lamps = EmissionLamps::of_lights(&scene).unwrap();
    let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
    let responses = respond(&world, &lamps, &aims);
    let mut truth = [[0.0; 2]; 2];
    for (g, desk) in desks.iter().enumerate() {
        for (l, place) in places.iter().enumerate() {
            let from = (*place - *desk).as_dvec3();
            let cosine = from.normalize().y;
            let radiance = 1000.0 * std::f64::consts::FRAC_1_PI.powi(2) * cosine * cosine / from.length_squared();
            let found = responses.lamp(g, l);
            truth[g][l] = radiance;
            let (off, error) = ((found.mean.x - radiance).abs(), found.standard_error.x);
            assert!(off < 4.0 * error + 1e-3 * radiance, "{g} {l}: {found:?}, expected {radiance}");
            assert!(error < 0.02 * radiance, "{found:?}");
        }
        assert_eq!(responses.background(g).mean, DVec3::ZERO);
    }
    let solution = powers(&responses, &aims, &GroupParams::default()).unwrap();
    for (row, lux) in truth.iter().zip([500.0, 300.0]) {
        let light = std::f64::consts::PI * (row[0] * solution.scale[0].x + row[1] * solution.scale[1].x);
        assert!((light / lux - 1.0).abs() < 0.03, "{light} lx of {lux}: {solution:?}");
    }
    assert!(solution.unreachable.is_none());
}

/// If the colour of the groups may change, every channel of a coloured goal is met, as in the closed form.
#[test]
fn free_colours_meet_a_coloured_goal() {
    let (world, lamps) = lamp_room(&[[3, 3], [12, 12]], &[1.0; 2]);
    let target = Vec3::new(30.0, 20.0, 10.0);
    let goals = [goal(TargetGeometry::Surface(FLOOR), target)];
    let responses = respond(&world, &lamps, &goals);
    let params = GroupParams { colour: Colour::PerChannel, ..GroupParams::default() };
    let solution = powers(&responses, &goals, &params).unwrap();
    let achieved = solution.outcomes[0].achieved;
    assert!(((achieved / target.as_dvec3()) - 1.0).abs().max_element() < 1e-6, "{achieved}");
    // White lamps with one power for all channels cannot be coloured.
    let kept = powers(&responses, &goals, &GroupParams::default()).unwrap();
    assert!(kept.unreachable.unwrap().contains("colour"));
}

/// With many lamps, at least 54 of the 64 confidence intervals of single lamps contain the true response. The true
/// response is estimated with many paths.
#[test]
fn intervals_of_single_lamps_cover() {
    let places: Vec<[usize; 2]> = (0..64).map(|i| [2 * (i % 8), 2 * (i / 8)]).collect();
    let (world, lamps) = lamp_room(&places, &[1.0; 64]);
    let goals = [goal(TargetGeometry::Surface(FLOOR), Vec3::ONE)];
    let trace = |paths, seed| {
        let params = Params { paths, target_error: 0.0, seed, ..Params::default() };
        let monitor = Monitor::default();
        Pool::new(2).unwrap().run(|| lamp_responses(&world, 1, &lamps, &goals, &params, monitor.job()).unwrap())
    };
    let (truth, tried) = (trace(1 << 18, 1), trace(1 << 13, 2));
    let inside = (0..64)
        .filter(|&lamp| {
            let (a, b) = (truth.lamp(0, lamp), tried.lamp(0, lamp));
            let sigma = a.standard_error.x.hypot(b.standard_error.x);
            (a.mean.x - b.mean.x).abs() < 2.04 * sigma
        })
        .count();
    // Each interval contains the truth with a probability of 95 %. The probability that fewer than 54 of 64 intervals
    // contain it is below 1e-3.
    assert!(inside >= 54, "{inside} of 64");
}

#[test]
fn responses_have_the_same_bits_for_any_number_of_threads() {
    let (world, lamps) = lamp_room(&[[3, 3], [12, 12]], &[1.0; 2]);
    let goals = [goal(TargetGeometry::Surface(FLOOR), Vec3::ONE), goal(desk(1.0, 1.0), Vec3::ONE)];
    let params = Params { paths: 1 << 12, ..Params::default() };
    let with = |threads| {
        let responses = Pool::new(threads)
            .unwrap()
            .run(|| lamp_responses(&world, 1, &lamps, &goals, &params, Monitor::default().job()).unwrap());
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(goal, lamp)| responses.lamp(goal, lamp))
    };
    assert_eq!(with(1), with(3));
}
