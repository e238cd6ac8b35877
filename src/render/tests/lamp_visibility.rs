//! Tests of renders that learn which lights reach the surfaces in view: learning leaves means and confidence intervals
//! correct, results do not depend on the number of threads, and light through a gap is not lost.

use super::*;
use crate::exec::Pool;
use crate::render::illuminance as lux;

/// Adds a room of 3 × 2.5 × 3 m, whose sides face inwards, with a lamp under its ceiling. The walls at the smaller and
/// at the larger x have gaps from floor to ceiling, with the widths `gap` in metres; 0 for none.
fn add_room(scene: &mut Scene, x: f32, gap: [f32; 2], lamp: usize) {
    let (w, h, d) = (Vec3::X * 3.0, Vec3::Y * 2.5, Vec3::Z * 3.0);
    let at = Vec3::X * x;
    let mut sides = vec![(at, d, w), (at + h, w, d), (at, w, h), (at + d, h, w)];
    for (corner, gap) in [(at, gap[0]), (at + w, gap[1])] {
        let half = Vec3::Z * (3.0 - gap) / 2.0;
        sides.extend([(corner, half, h), (corner + Vec3::Z * (3.0 + gap) / 2.0, half, h)]);
    }
    let floor = scene.meshes.len();
    scene.meshes.extend(sides.into_iter().map(|(corner, u, v)| Mesh::parallelogram(corner, u, v, 0)));
    scene.meshes[floor].material = 1;
    scene.meshes.push(Mesh::parallelogram(at + Vec3::new(1.2, 2.45, 1.2), Vec3::X * 0.6, Vec3::Z * 0.6, lamp));
}

/// Six rooms in a row; the camera is in the first. Through a gap of 5 cm, the first room gets light from the second.
/// No light of the other rooms, of the sun or of the sky gets into the first room.
fn building() -> Scene {
    let gloss = Material { base_color: Vec3::splat(0.5), metallic: 0.0, roughness: 0.3, ..Material::default() };
    let mut scene = Scene {
        materials: vec![matt(0.6, 0.0), gloss, matt(0.0, 100.0), matt(0.0, 1000.0)],
        environment: Some(Environment::Constant(Vec3::splat(500.0))),
        lights: vec![
            PunctualLight::Point { position: Vec3::new(7.5, 1.0, 1.5), intensity: Vec3::splat(2000.0) },
            PunctualLight::Directional {
                direction: Vec3::new(0.1, -1.0, 0.2),
                illuminance: Vec3::splat(5000.0),
                half_angle: 0.0,
            },
        ],
        ..Scene::default()
    };
    for i in 0..6 {
        let gap = [[0.0, 0.05], [0.05, 0.0], [0.0; 2]][i.min(2)];
        add_room(&mut scene, 3.0 * i as f32, gap, if i == 0 { 2 } else { 3 });
    }
    scene
}

fn inside() -> Camera {
    Camera::look_at(Vec3::new(0.4, 1.4, 2.4), Vec3::new(2.6, 0.7, 1.0), 1.3)
}

/// Returns two worlds: one that learns which lights reach the view, and one that does not learn.
fn worlds(scene: Scene) -> [World; 2] {
    let learns = world(scene);
    let mut alike = learns.clone();
    alike.disable_learning();
    [learns, alike]
}

/// Returns, for each of several seeds, the mean radiance of each tile of 8 × 8 pixels.
fn tiles(world: &World, params: &Params, seeds: u64) -> Vec<Vec<f64>> {
    let across = params.width / 8;
    (0..seeds)
        .map(|seed| {
            let film = render(world, &inside(), &Params { seed: 7 + seed, ..params.clone() });
            let mut sums = vec![0.0; across * params.height / 8];
            for (x, y) in (0..params.height).flat_map(|y| (0..params.width).map(move |x| (x, y))) {
                sums[y / 8 * across + x / 8] += f64::from(film.beauty.rgb(x, y).element_sum()) / 192.0;
            }
            sums
        })
        .collect()
}

fn mean_and_variance(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    (mean, values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0)))
}

#[test]
fn learning_changes_no_mean_and_gains_variance() {
    let [learns, alike] = worlds(building());
    let params = Params { width: 24, height: 16, samples: 32, ..Params::default() };
    let (seeds, count) = (32, 6);
    let [learned, reference] = [&learns, &alike].map(|world| tiles(world, &params, seeds));
    let (mut squares, mut variances) = (0.0, [0.0; 2]);
    for tile in 0..count {
        let (mean, variance) = mean_and_variance(learned.iter().map(|t| t[tile]));
        let (expected, other) = mean_and_variance(reference.iter().map(|t| t[tile]));
        let z = (mean - expected) / (variance + other).sqrt();
        // The probability that any of the six differences exceeds this limit is 0.1 %, by Student's t with 62 degrees
        // of freedom.
        assert!(z.abs() < 4.0, "tile {tile}: {mean} instead of {expected}, {z} standard errors");
        squares += z * z;
        variances = [variances[0] + variance / mean.powi(2), variances[1] + other / mean.powi(2)];
    }
    // The sum of the squares is approximately a chi-squared variable with six degrees of freedom. Such a variable is
    // below this limit with a probability of 99.9 %.
    assert!(squares < 22.5, "{squares}");
    assert!(variances[0] * 1.5 < variances[1], "variances {variances:?}");
}

#[test]
fn intervals_hold_the_truth_where_lights_are_hidden() {
    let [learns, _] = worlds(building());
    let size = Params { width: 24, height: 16, ..Params::default() };
    let truth = render(&learns, &inside(), &Params { samples: 4096, seed: 99, ..size.clone() }).beauty;
    for samples in [16, 64] {
        let (mut held, mut count) = (0, 0);
        for seed in 0..16 {
            let film = render(&learns, &inside(), &Params { samples, seed, ..size.clone() });
            let interval = film.interval(Monitor::default().job()).unwrap();
            for ((&value, &truth), &half) in film.beauty.data.iter().zip(&truth.data).zip(&interval.data) {
                held += usize::from((value - truth).abs() <= half);
                count += 1;
            }
        }
        let share = held as f64 / count as f64;
        assert!((0.925..0.975).contains(&share), "{samples} paths: {share}");
    }
}

#[test]
fn any_number_of_threads_learns_the_same() {
    let [learns, alike] = worlds(building());
    let base = Params { width: 40, height: 24, samples: 32, ..Params::default() };
    for params in [base.clone(), Params { target_error: 0.1, samples: 256, ..base }] {
        let film = |world: &World, threads| Pool::new(threads).unwrap().run(|| render(world, &inside(), &params));
        let (one, two, seven) = (film(&learns, 1), film(&learns, 2), film(&learns, 7));
        assert!(one.lamp_visibility.is_some_and(|seen| seen.hidden >= 5), "{:?}", one.lamp_visibility);
        for other in [two, seven] {
            assert!(one.beauty == other.beauty && one.variance == other.variance && one.paths == other.paths);
            assert_eq!((one.lamp_visibility, &one.requirements), (other.lamp_visibility, &other.requirements));
        }
        assert!(one.beauty != film(&alike, 2).beauty);
    }
}

#[test]
fn paths_in_one_room_need_only_the_surfaces_around_it() {
    let mut scene = building();
    (6..30).for_each(|i| add_room(&mut scene, 3.0 * i as f32, [0.0; 2], 3));
    let surroundings = world(scene);
    let mut whole = surroundings.clone();
    whole.disable_vicinity();
    let params = Params { width: 40, height: 24, samples: 32, ..Params::default() };
    let [a, b] = [&surroundings, &whole].map(|world| render(world, &inside(), &params));
    assert!(a.beauty == b.beauty && a.variance == b.variance && a.lamp_visibility == b.lamp_visibility);
    // After 1024 paths, `surroundings` has the acceleration structure `vicinity`; `whole` has none, because it may not
    // build one.
    let has_vicinity = |world: &World| {
        let learning = world.learning().unwrap();
        let point = SurfacePoint { mesh: 0, triangle: 0, barycentric: Vec2::splat(0.3), front: true };
        (0..1024).for_each(|i| irradiance(&learning, &point, 5, i, &mut ContributionSum(DVec3::ZERO)));
        learning.settled().unwrap().vicinity().is_some()
    };
    assert!(has_vicinity(&surroundings) && !has_vicinity(&whole));
}

#[test]
fn light_through_a_gap_is_not_lost() {
    // The lamp of the first room is so dim that most of the room's light comes through the gap.
    let mut scene = building();
    scene.materials[2].emission = Vec3::splat(0.01);
    let [learns, alike] = worlds(scene);
    let params = Params { width: 24, height: 16, samples: 64, ..Params::default() };
    let whole =
        |world: &World| tiles(world, &params, 24).into_iter().map(|t| t.iter().sum::<f64>()).collect::<Vec<_>>();
    let [(mean, variance), (expected, other)] =
        [&learns, &alike].map(|world| mean_and_variance(whole(world).into_iter()));
    // The means differ by more than 3.5 standard errors with a probability of 0.1 %, by Student's t with 46 degrees of
    // freedom.
    let z = (mean - expected) / (variance + other).sqrt();
    assert!(z.abs() < 3.5, "{mean} instead of {expected}: {z} standard errors");
    assert!(expected > 10.0 * other.sqrt() && mean > 10.0 * variance.sqrt(), "{expected} {other} {mean} {variance}");
    // A single render with few paths also shows the light through the gap.
    let film = render(&learns, &inside(), &params);
    let sum = film.beauty.data.iter().map(|&v| f64::from(v)).sum::<f64>() / (3.0 * 64.0);
    assert!((sum / expected - 1.0).abs() < 0.3, "{sum} {expected}");
}

#[test]
fn scenes_whose_lights_all_arrive_keep_every_bit() {
    let mut scene = building();
    (scene.environment, scene.lights) = (None, Vec::new());
    scene.meshes.truncate(9);
    let lamp = scene.meshes[8].clone();
    for shift in [-0.9, 0.9] {
        let positions = lamp.positions.iter().map(|&p| p + Vec3::X * shift).collect();
        scene.meshes.push(Mesh { positions, ..lamp.clone() });
    }
    let [learns, alike] = worlds(scene);
    let params = Params { width: 64, height: 48, samples: 16, ..Params::default() };
    let [learned, expected] = [&learns, &alike].map(|world| render(world, &inside(), &params));
    assert!(learned.beauty == expected.beauty && learned.variance == expected.variance);
    assert_eq!(learned.lamp_visibility, None);
    assert_eq!(learned.requirements, expected.requirements);
}

#[test]
fn requirements_name_the_lamps_that_cannot_be_reached() {
    let film =
        render(&world(building()), &inside(), &Params { width: 64, height: 48, samples: 8, ..Params::default() });
    let visibility = film.lamp_visibility.unwrap();
    // There are nine lights: six lamps, a point light, the sun and the sky. The lamps of the first two rooms reach the
    // view. With so few paths, one other light may still be undecided.
    assert!(visibility.lamps == 9 && (6..=7).contains(&visibility.hidden), "{visibility:?}");
    let sentence = film.requirements.last().unwrap();
    let start = format!("{} of 9 lamps cannot be reached from here", visibility.hidden);
    assert!(sentence.starts_with(&start), "{sentence}");
    let visibility = LampVisibility { lamps: 2025, hidden: 1992, samples: 1_234_567 };
    assert!(visibility.sentence().starts_with("1,992 of 2,025 lamps") && visibility.sentence().contains("1,234,567"));
}

#[test]
fn lux_in_a_building_is_that_of_all_lights() {
    let [learns, alike] = worlds(building());
    let place = lux::CalculationPoints::Grid {
        origin: Vec3::new(0.5, 0.8, 0.5),
        across: Vec3::X * 2.0,
        down: Vec3::Z * 2.0,
        normal: Vec3::Y,
    };
    let params = lux::Params { columns: 8, rows: 8, samples: 1024, ..lux::Params::default() };
    let [learned, expected] =
        [&learns, &alike].map(|world| lux::run(world, &place, &params, Monitor::default().job()).unwrap());
    let error = learned.mean_error.hypot(expected.mean_error);
    assert!((learned.mean - expected.mean).abs() < 3.5 * error, "{} {} ± {error}", learned.mean, expected.mean);
    assert!(1.2 * learned.mean_error < expected.mean_error, "{} {}", learned.mean_error, expected.mean_error);
}
