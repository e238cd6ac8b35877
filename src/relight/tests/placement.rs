//! Tests of gradients against finite differences, and of placements with a known optimum.

use super::*;
use crate::exec::Pool;
use crate::job::Monitor;
use std::f64::consts::PI;

/// An importance map, largest in the centre and smoothly decaying to 0 at the sides. Red has the largest values.
fn map() -> Importance {
    let cell = |i: usize, n: usize| (PI * ((i as f64 + 0.5) / n as f64 - 0.5)).cos();
    let (width, height) = (40, 32);
    let cells = (0..width * height).map(|i| {
        let weight = (cell(i % width, width) * cell(i / width, height)).powi(4);
        DVec3::new(1.0, 0.8, 0.6) * weight / (width * height) as f64
    });
    Importance::even(width, height, cells.collect(), DVec3::splat(0.5))
}

/// A warm lamp of 8 × 8 texels in a texture of 64 × 64.
fn lamp(x: usize, y: usize) -> Image {
    let inside = |at: usize, from: usize| (from..from + 8).contains(&at);
    Image::from_fn(64, 64, |i, j| if inside(i, x) && inside(j, y) { [900.0, 700.0, 400.0] } else { [1.0; 3] }).unwrap()
}

fn search(texture: &Image, aim: Aim) -> Search {
    map().search(texture, aim, Monitor::default().job()).unwrap()
}

#[test]
fn gradients_are_central_differences() {
    let texture = lamp(10, 40);
    let mut rng = Rng::new(4, &[]);
    for aim in [Aim::Brightest, Aim::Darkest, Aim::Radiance(Vec3::new(30.0, 20.0, 10.0))] {
        let search = search(&texture, aim);
        for _ in 0..20 {
            let mut numbers = [0.0; 5].map(|_: f64| rng.next_f64() * 2.0 - 1.0);
            numbers[2] = 1.3 + 2.0 * rng.next_f64();
            numbers[3] = 1.3 + 2.0 * rng.next_f64();
            let (_, gradient) = search.value_and_gradient(numbers);
            for i in 0..5 {
                const H: f64 = 1e-6;
                let moved = |by: f64| {
                    let mut at = numbers;
                    at[i] += by;
                    search.value(at)
                };
                let difference = (moved(H) - moved(-H)) / (2.0 * H);
                let size = gradient.iter().map(|s| s.abs()).fold(0.0, f64::max);
                assert!((gradient[i] - difference).abs() < 1e-5 * size, "{i}: {} {difference}", gradient[i]);
            }
        }
    }
}

fn place(texture: &Image, params: &PlacementParams) -> Placement {
    let monitor = Monitor::default();
    Pool::new(2).unwrap().run(|| map().place(texture, params, monitor.job()).unwrap())
}

/// The brightest placement moves a single lamp to the centre of the surface, where the importance is largest, wherever
/// the lamp lies in its texture. The darkest placement moves it to the corner, where the importance is smallest.
#[test]
fn a_lamp_moves_to_the_largest_or_smallest_importance() {
    for (x, y) in [(10, 40), (50, 3)] {
        let at = DVec2::new(x as f64 + 4.0, y as f64 + 4.0) / 64.0;
        for (aim, where_to) in [(Aim::Brightest, DVec2::splat(0.5)), (Aim::Darkest, DVec2::ZERO)] {
            let found = place(&lamp(x, y), &PlacementParams { aim, ..PlacementParams::default() });
            // The texture's point `at` appears where `uv + offset = at`.
            let off = at - found.pose.offset - where_to;
            let off = off - off.round();
            assert!(off.abs().max_element() < 0.01, "{aim:?}: {:?}", found.pose);
            let pose = PlacementParams::default();
            assert!(found.pose.offset.cmpge(pose.min.offset).all() && found.pose.offset.cmple(pose.max.offset).all());
        }
    }
}

/// A reachable target is met, whether scale and rotation are fixed or free. `respond` gives the same response for the
/// pose that was found.
#[test]
fn a_target_is_met_by_moving_the_lamp() {
    let texture = lamp(10, 40);
    let best = place(&texture, &PlacementParams::default()).response.light.mean;
    let worst =
        place(&texture, &PlacementParams { aim: Aim::Darkest, ..PlacementParams::default() }).response.light.mean;
    let target = (best * 0.4 + worst * 0.6 + 0.5).as_vec3();
    let params = PlacementParams { aim: Aim::Radiance(target), ..PlacementParams::default() };
    let free = PlacementParams {
        min: Pose { offset: DVec2::splat(-0.5), scale: DVec2::splat(0.5), rotation: -PI },
        max: Pose { offset: DVec2::splat(0.5), scale: DVec2::splat(2.0), rotation: PI },
        ..params.clone()
    };
    for params in [params, free] {
        let found = place(&texture, &params);
        let achieved = found.response.light.mean + 0.5;
        assert!((achieved / target.as_dvec3() - 1.0).abs().max_element() < 0.01, "{found:?} {target}");
        let matrix = found.pose.matrix().as_mat3();
        let texture = Texture::new("lamp", texture.clone());
        let again = map().respond(&texture, &matrix, Monitor::default().job()).unwrap();
        assert_eq!(again.light, found.response.light);
    }
    // If the bounds allow only the identity pose, the lamp must not move.
    let held = PlacementParams { min: Pose::IDENTITY, max: Pose::IDENTITY, ..PlacementParams::default() };
    assert_eq!(place(&texture, &held).pose, Pose::IDENTITY);
}

/// For a pattern with several periods and noise, the multi-start search finds the optimum over all offsets.
#[test]
fn many_starts_find_the_best_of_a_periodic_pattern() {
    let texture = Image::from_fn(60, 60, |x, y| {
        let lit = x % 30 < 9 && y % 30 < 9;
        [if lit { 500.0 + 500.0 * Rng::new(9, &[x as u64, y as u64]).next_f32() } else { 0.0 }]
    });
    let texture = texture.unwrap();
    let found = place(&texture, &PlacementParams::default());
    let (map, placed, monitor) = (map(), Texture::new("pattern", texture), Monitor::default());
    let brute = (0..144)
        .map(|i| {
            let offset = DVec2::new((i % 12) as f64, (i / 12) as f64) / 24.0;
            let matrix = Pose { offset, ..Pose::IDENTITY }.matrix().as_mat3();
            map.respond(&placed, &matrix, monitor.job()).unwrap().light.mean.y
        })
        .fold(0.0, f64::max);
    let identity = map.respond(&placed, &glam::Mat3::IDENTITY, monitor.job()).unwrap().light.mean.y;
    let best = found.response.light.mean.y;
    assert!(best > 0.998 * brute && brute > 1.1 * identity, "{best} {brute} {identity}");
}

#[test]
fn placements_have_the_same_bits_and_settings_name_themselves() {
    let texture = lamp(10, 40);
    let with = |threads| {
        let monitor = Monitor::default();
        Pool::new(threads)
            .unwrap()
            .run(|| map().place(&texture, &PlacementParams::default(), monitor.job()).unwrap().pose)
    };
    assert_eq!(with(1), with(3));
    let monitor = Monitor::default();
    let refused = |params: PlacementParams| map().place(&texture, &params, monitor.job()).unwrap_err().message;
    let d = PlacementParams::default;
    assert!(refused(PlacementParams { starts: 0, ..d() }).starts_with("starts"));
    assert!(refused(PlacementParams { min: Pose { scale: DVec2::ZERO, ..d().min }, ..d() }).starts_with("scale"));
    assert!(refused(PlacementParams { max: Pose { rotation: f64::NAN, ..d().max }, ..d() }).starts_with("rotation"));
    assert!(refused(PlacementParams { min: d().max, max: d().min, ..d() }).starts_with("offset"));
    assert!(refused(PlacementParams { aim: Aim::Radiance(-Vec3::ONE), ..d() }).starts_with("target"));
}
