//! Tests of passes: results that do not depend on the number of threads, stated errors, and stopping conditions.

use super::*;
use crate::exec::Pool;
use std::time::Duration;

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let base = Params { width: 70, height: 40, samples: 8, ..Params::default() };
    let adaptive = Params { width: 36, height: 20, samples: 256, ..base.clone() };
    for params in [
        base.clone(),
        Params { samples: 5, ..base },
        Params { target_error: 0.2, ..adaptive.clone() },
        Params { relative_error: 0.2, ..adaptive.clone() },
        Params { pixel_error: 0.5, ..adaptive },
    ] {
        let film = |threads| Pool::new(threads).unwrap().run(|| render(&world(everything()), &viewer(), &params));
        let (one, three, many) = (film(1), film(3), film(64));
        for other in [three, many] {
            assert!(one.beauty == other.beauty && one.variance == other.variance && one.paths == other.paths);
            assert_eq!((one.error, one.samples, one.discarded), (other.error, other.samples, 0));
        }
        assert_eq!(one.beauty.count_non_finite() + one.variance.count_non_finite(), 0);
        assert!(one.error > 0.0);
    }
}

/// Renders films with different seeds.
fn repeated(world: &World, params: &Params, count: u64) -> Vec<Film> {
    (0..count).map(|seed| render(world, &viewer(), &Params { seed: 100 + seed, ..params.clone() })).collect()
}

#[test]
fn stated_variances_are_those_of_repeated_renders() {
    let world = world(everything());
    for samples in [6, 64] {
        let params = Params { width: 12, height: 12, samples, ..Params::default() };
        let films = repeated(&world, &params, 32);
        let n = films.len() as f64;
        let (mut stated, mut observed) = (0.0, 0.0);
        for i in 0..films[0].beauty.data.len() {
            let mean = films.iter().map(|f| f64::from(f.beauty.data[i])).sum::<f64>() / n;
            // Divide by the squared mean of the pixel, so that no bright pixel dominates the sums.
            let scale = mean.max(1e-3).powi(2);
            observed +=
                films.iter().map(|f| (f64::from(f.beauty.data[i]) - mean).powi(2)).sum::<f64>() / (n - 1.0) / scale;
            stated += films.iter().map(|f| f64::from(f.variance.data[i])).sum::<f64>() / n / scale;
        }
        assert!((stated / observed - 1.0).abs() < 0.15, "{samples} paths: stated {stated}, observed {observed}");
    }
}

#[test]
fn intervals_hold_the_truth_and_the_errors_are_those_of_the_image() {
    let world = world(everything());
    let size = Params { width: 24, height: 16, ..Params::default() };
    let truth = render(&world, &viewer(), &Params { samples: 2048, ..size.clone() }).beauty;
    let monitor = Monitor::default();
    let mean = truth.data.iter().map(|&v| f64::from(v)).sum::<f64>() / truth.data.len() as f64;
    let shown = |i: usize| truth.data[i / 3 * 3..][..3].iter().map(|&v| f64::from(v)).sum::<f64>() / 3.0;
    let mut relative_ratios = Vec::new();
    for samples in [8, 20, 64] {
        let films = repeated(&world, &Params { samples, ..size.clone() }, 16);
        let (mut inside, mut count, mut squared, mut stated) = (0, 0, 0.0, 0.0);
        let (mut relative, mut stated_relative) = (0.0, 0.0);
        for film in &films {
            let interval = film.interval(monitor.job()).unwrap();
            for ((&value, &truth), &half) in film.beauty.data.iter().zip(&truth.data).zip(&interval.data) {
                // Skip pixels without noise.
                if half > 1e-4 * truth {
                    inside += usize::from((value - truth).abs() <= half);
                    count += 1;
                    squared += f64::from(value - truth).powi(2);
                }
            }
            stated += film.error.powi(2);
            for (i, (&value, &truth)) in film.beauty.data.iter().zip(&truth.data).enumerate() {
                relative += (f64::from(value - truth) / shown(i).max(0.01 * mean)).powi(2);
            }
            stated_relative += film.relative_error.powi(2);
        }
        let share = inside as f64 / count as f64;
        assert!((0.925..0.975).contains(&share), "{samples} paths: {share}");
        // Compare the stated with the measured root mean square error.
        let measured = (squared / (films.len() * truth.data.len()) as f64).sqrt() / mean;
        let stated = (stated / films.len() as f64).sqrt();
        assert!((stated / measured - 1.0).abs() < 0.1, "{samples} paths: stated {stated}, measured {measured}");
        let measured = (relative / (films.len() * truth.data.len()) as f64).sqrt();
        let stated = (stated_relative / films.len() as f64).sqrt();
        relative_ratios.push(stated / measured);
    }
    // With more paths, the stated error approaches the measured error from above: with few paths, the errors of dark
    // pixels are overestimated.
    for (ratio, max_ratio) in relative_ratios.iter().zip([1.3, 1.2, 1.1]) {
        assert!((0.95..max_ratio).contains(ratio), "stated over measured: {relative_ratios:?}");
    }
}

#[test]
fn a_target_sends_paths_to_where_the_error_is_and_darkens_little() {
    let world = world(everything());
    let size = Params { width: 32, height: 24, ..Params::default() };
    let mean =
        |film: &Film| film.beauty.data.iter().map(|&v| f64::from(v)).sum::<f64>() / film.beauty.data.len() as f64;
    let truth = mean(&render(&world, &viewer(), &Params { samples: 1024, ..size.clone() }));
    let count = 8;
    for (target_error, relative_error, pixel_error) in [(0.06, 0.0, 0.0), (0.0, 0.05, 0.0), (0.0, 0.0, 0.6)] {
        let targets = Params { samples: 1024, target_error, relative_error, pixel_error, ..size.clone() };
        let films = repeated(&world, &targets, count);
        let (mut sum, mut square, mut spread) = (0.0, 0.0, 0.0f32);
        for film in &films {
            let relative = mean(film) / truth - 1.0;
            sum += relative;
            square += relative * relative;
            assert!(target_error == 0.0 || film.error <= f64::from(target_error));
            assert!(relative_error == 0.0 || film.relative_error <= f64::from(relative_error));
            let (low, high) = film.paths.data.iter().fold((f32::MAX, 0.0f32), |(l, h), &n| (l.min(n), h.max(n)));
            assert!(low >= 16.0 && high <= 1024.0 && film.samples < 512);
            spread = spread.max(high / low);
        }
        let min = if relative_error > 0.0 { 2.0 } else { 4.0 };
        assert!(spread >= min, "{target_error} {relative_error} {pixel_error}: {spread}");
        let bias = sum / count as f64;
        let error = ((square / count as f64 - bias * bias) / count as f64).sqrt();
        assert!(bias.abs() < 0.01 + 3.0 * error, "bias {bias} ± {error}");
    }
}

#[test]
fn pixels_reach_the_requested_error() {
    let world = world(everything());
    let params = Params { width: 32, height: 32, samples: 1 << 14, pixel_error: 0.3, ..Params::default() };
    let film = render(&world, &viewer(), &params);
    let interval = film.interval(Monitor::default().job()).unwrap();
    let mean = film.beauty.data.iter().sum::<f32>() / film.beauty.data.len() as f32;
    // The target applies to the root mean square of the pixels' errors over a tile.
    for top in (0..32).step_by(8) {
        for left in (0..32).step_by(8) {
            let mut squares = 0.0;
            for i in 0..64 {
                let (x, y) = (left + i % 8, top + i / 8);
                let half = crate::image::colour::luminance(interval.rgb(x, y));
                squares += (half / crate::image::colour::luminance(film.beauty.rgb(x, y)).max(0.1 * mean)).powi(2);
            }
            assert!((squares / 64.0).sqrt() < 0.301, "tile at {left}, {top}: {}", (squares / 64.0).sqrt());
        }
    }
}

#[test]
fn a_cancelled_render_leaves_what_was_published() {
    let world = world(everything());
    let params = Params { width: 64, height: 64, samples: 1 << 20, ..Params::default() };
    let monitor = Monitor::default();
    let mut last = None;
    let result = run(&world, &viewer(), &params, monitor.job(), &mut |film| {
        last = Some(film.clone());
        monitor.cancel();
    });
    assert_eq!(result.unwrap_err(), Error::cancelled());
    // The render was cancelled after the coarse pass, which traced one path in every second pixel of every second row.
    // The three untraced pixels of each 2 × 2 block show the value of its traced pixel.
    let film = last.unwrap();
    let paths = film.paths.data.iter().sum::<f32>();
    assert!(paths > 0.0 && paths < 4096.0, "{paths}");
    for y in 0..64 {
        for x in 0..64 {
            assert_eq!(film.beauty.pixel(x, y), film.beauty.pixel(x / 2 * 2, y / 2 * 2));
            assert_eq!(film.variance.pixel(x, y)[0], f32::INFINITY);
        }
    }
    assert_eq!(film.error, f64::INFINITY);
}

#[test]
fn a_cancelled_render_does_not_filter_its_last_film() {
    let world = world(everything());
    let params = Params { width: 64, height: 64, samples: 1 << 20, preview: 1.0, ..Params::default() };
    let monitor = Monitor::default();
    let mut published = 0;
    let result = run(&world, &viewer(), &params, monitor.job(), &mut |film| {
        assert!(film.preview.is_some());
        published += 1;
        monitor.cancel();
    });
    assert_eq!((result.unwrap_err(), published), (Error::cancelled(), 1));
}

#[test]
fn a_render_stops_when_it_is_good_enough() {
    let world = world(everything());
    let base = Params { width: 16, height: 16, samples: 1 << 20, ..Params::default() };
    let film = render(&world, &viewer(), &Params { target_error: 0.3, ..base.clone() });
    assert!(film.error <= 0.3 && film.samples < 1 << 20);
}

/// Returns the CPU time of this thread, which does not depend on other programs; 0 if the system has no `/proc`.
fn processor_time() -> Duration {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    Duration::from_nanos(text.split(' ').next().and_then(|n| n.parse().ok()).unwrap_or(0))
}

#[test]
fn a_time_budget_is_kept_but_for_the_first_image() {
    let world = world(everything());
    // In the large image, the time does not suffice for a path in every pixel; in the small one, it does not suffice
    // for all samples. A single thread does all work, so its CPU time is at most the elapsed time.
    Pool::new(1).unwrap().run(|| {
        for (width, height) in [(2048, 512), (1, 1)] {
            for target_error in [0.0, 1e-6] {
                let timed = |time_budget_ms| {
                    let start = processor_time();
                    let params =
                        Params { width, height, samples: 1 << 20, time_budget_ms, target_error, ..Params::default() };
                    let film = render(&world, &viewer(), &params);
                    (film, processor_time().saturating_sub(start))
                };
                // Time the smallest possible render, which traces one path in only a few of the pixels and assembles
                // an image from them.
                let (film, min) = timed(1);
                let paths: f32 = film.paths.data.iter().sum();
                assert!(paths > 0.0 && (paths <= 1024.0 || width == 1), "{width} x {height}: {paths}");
                assert_eq!(film.beauty.count_non_finite(), 0);
                for budget in [40, 300] {
                    let (film, taken) = timed(budget);
                    assert!(film.samples < 1 << 20 && film.beauty.count_non_finite() == 0);
                    let allowed = min.max(Duration::from_millis(budget.into())) + Duration::from_millis(50);
                    assert!(taken < allowed + min, "{width} x {height}, {budget} ms: {taken:?}, at least {min:?}");
                }
            }
        }
    });
}

#[test]
fn paths_that_are_not_finite_are_dropped_and_counted() {
    // The room is so small that the irradiance from the brightest allowed lamp, intensity / squared distance,
    // overflows f32.
    let radius = 1e-13;
    let lamp = PunctualLight::Point { position: Vec3::Y * 0.3 * radius, intensity: Vec3::splat(1e15) };
    let (meshes, materials) = (vec![inward_sphere(radius, 0)], vec![matt(0.9, 0.0)]);
    let scene = Scene { meshes, materials, lights: vec![lamp], ..Scene::default() };
    let params = Params { width: 4, height: 4, samples: 16, ..Params::default() };
    let film = render(&world(scene), &Camera::look_at(Vec3::ZERO, Vec3::X, 1.0), &params);
    assert!(film.discarded > 0);
    assert_eq!(film.beauty.count_non_finite(), 0);
    assert!(film.variance.data.iter().all(|v| !v.is_nan()) && !film.error.is_nan());
}
