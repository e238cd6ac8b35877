//! Whether plans come true: seconds and errors that `plan` expects against those of the runs it plans.
//!
//! Of renderings and of the light of whole transfers, on scenes, sizes and photos of all kinds; nothing was fitted to any.
//! Times are of one thread, by its own clock, so that what else the machine does weighs on neither side; time budgets, which
//! are of the clock on the wall, are taken off for that, and the paths that they bound stay. The error of a picture is that
//! of two pictures of different seeds, which needs no reference: half the mean square of their difference.
//!
//! `cargo bench --bench plan -- renderings` or `-- transfers` makes the one or the other alone.

mod harness;
#[path = "plan/photos.rs"]
mod photos;
#[path = "plan/renderings.rs"]
mod renderings;
#[path = "plan/transfers.rs"]
mod transfers;

use harness::{Table, figure, quantile};
use luxfer::exec::Pool;
use luxfer::image::Image;
use std::time::Duration;

fn main() {
    let pool = Pool::new(1).expect("a thread");
    let asked = |what: &str| std::env::args().any(|a| a == what);
    pool.run(|| {
        let mut all = Outcomes::default();
        if !asked("transfers") {
            renderings::measure(&mut all);
        }
        if !asked("renderings") {
            transfers::measure(&mut all);
        }
        for (name, ratios) in [("time", &all.times), ("error", &all.errors)] {
            figure(&format!("plan.{name}.within_25"), 100.0 * within(ratios), "%");
            figure(&format!("plan.{name}.median"), quantile(ratios, 0.5), "x");
        }
    });
}

/// Processor time of the calling thread.
fn cpu() -> Duration {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call fills the structure it is given.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = cpu();
    let value = work();
    ((cpu() - start).as_secs_f64(), value)
}

/// What came out over what was expected.
#[derive(Default)]
struct Outcomes {
    times: Vec<f64>,
    errors: Vec<f64>,
}

/// The share of ratios that are 1 give or take a quarter of what was expected.
fn within(ratios: &[f64]) -> f64 {
    ratios.iter().filter(|r| (*r - 1.0).abs() <= 0.25).count() as f64 / ratios.len().max(1) as f64
}

fn mean(image: &Image) -> f64 {
    image.data.iter().map(|&v| f64::from(v)).sum::<f64>() / image.data.len() as f64
}

/// Root mean square error of two pictures with independent errors, relative to their mean.
fn error_of(a: &Image, b: &Image) -> f64 {
    let square = a.data.iter().zip(&b.data).map(|(&a, &b)| f64::from(a - b).powi(2)).sum::<f64>();
    (square / a.data.len() as f64 / 2.0).sqrt() / (0.5 * (mean(a) + mean(b)))
}

/// Expected and found, and their ratio.
fn columns([expected, found]: [f64; 2]) -> [String; 3] {
    [format!("{expected:.4}"), format!("{found:.4}"), format!("{:.2}", found / expected)]
}
