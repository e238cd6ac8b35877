//! Passes: the same bits on any number of threads, stated errors, and when a render stops.

use super::*;
use crate::exec::Pool;

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let params = Params { width: 70, height: 40, samples: 8, ..Params::default() };
    let film = |threads| Pool::new(threads).unwrap().run(|| render(&world(everything()), &viewer(), &params));
    let (one, three) = (film(1), film(3));
    assert!(one.beauty == three.beauty && one.variance == three.variance);
    assert_eq!(one.beauty.count_non_finite() + one.variance.count_non_finite(), 0);
    assert!(one.error > 0.0 && one.error == three.error);
}

#[test]
fn stated_variances_are_those_of_repeated_renders() {
    let world = world(everything());
    let params = Params { width: 12, height: 12, samples: 64, ..Params::default() };
    let films: Vec<Film> = (0..24).map(|seed| render(&world, &viewer(), &Params { seed, ..params.clone() })).collect();
    let n = films.len() as f64;
    let (mut stated, mut observed) = (0.0, 0.0);
    for i in 0..films[0].beauty.data.len() {
        let mean = films.iter().map(|f| f64::from(f.beauty.data[i])).sum::<f64>() / n;
        // Relative to the pixel, so that no bright one outvotes the others.
        let scale = mean.max(1e-3).powi(2);
        observed += films.iter().map(|f| (f64::from(f.beauty.data[i]) - mean).powi(2)).sum::<f64>() / (n - 1.0) / scale;
        stated += films.iter().map(|f| f64::from(f.variance.data[i])).sum::<f64>() / n / scale;
    }
    assert!((stated / observed - 1.0).abs() < 0.15, "stated {stated}, observed {observed}");
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
    assert_eq!(last.unwrap().samples, 4);
}

#[test]
fn a_render_stops_when_it_is_good_enough_or_out_of_time() {
    let world = world(everything());
    let base = Params { width: 16, height: 16, samples: 1 << 20, ..Params::default() };
    let film = render(&world, &viewer(), &Params { target_error: 0.2, ..base.clone() });
    assert!(film.error <= 0.2 && film.samples < 1 << 20);
    let start = Instant::now();
    let film = render(&world, &viewer(), &Params { time_budget_ms: 50, ..base });
    assert!(film.samples >= 4 && start.elapsed().as_secs_f64() < 5.0);
}
