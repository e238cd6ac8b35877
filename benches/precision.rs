//! Why each quantity is kept in the precision it is: what a narrower and a wider number would cost and buy.
//!
//! Each kernel is written once, for any type of number, after the arithmetic of the stage that it stands for, and runs in f32 and in
//! f64 on the same data; distances of patches run in the library's own integers, in f32 and in halves. Errors are against what is
//! exact, or against f64 where that cannot be had. Times are of one thread, interleaved, relative to what the library keeps; no code is written
//! for wider registers here, so that types differ only where the compiler makes them.

#[path = "precision/film.rs"]
mod film;
#[path = "precision/fourier.rs"]
mod fourier;
mod harness;
#[path = "precision/map.rs"]
mod map;
#[path = "precision/newton.rs"]
mod newton;
#[cfg(feature = "stylize")]
#[path = "precision/patches.rs"]
mod patches;
#[path = "precision/rays.rs"]
mod rays;
#[path = "precision/real.rs"]
mod real;
#[path = "precision/vanishing.rs"]
mod vanishing;

use harness::{Clock, Table, interleaved};
use std::hint::black_box;

/// One way to keep numbers: its name, bytes of what there are many of, error, and the work to be timed.
struct Way<'a> {
    name: &'a str,
    bytes: usize,
    error: f64,
    work: &'a mut dyn FnMut(),
}

/// Work whose result nobody needs, done all the same.
fn timed<T>(mut work: impl FnMut() -> T) -> impl FnMut() {
    move || {
        black_box(work());
    }
}

/// Rows of the table.
struct Study(Table);

impl Study {
    /// The ways to keep one quantity; `kept` is the library's.
    fn add(&mut self, what: &str, error_of: &str, kept: usize, ways: &mut [Way]) {
        let mut work: Vec<&mut dyn FnMut()> = Vec::new();
        let mut about = Vec::new();
        for way in ways {
            about.push((way.name, way.bytes, way.error));
            work.push(&mut *way.work);
        }
        let timings = interleaved(Clock::Thread, 15, &mut work);
        for (i, (name, bytes, error)) in about.into_iter().enumerate() {
            let is_kept = if i == kept { "kept" } else { "" };
            let error = if error == 0.0 { "0".to_string() } else { format!("{error:.1e}") };
            let time = format!("{:.2}", timings.ratio(i, kept));
            self.0.row([what, name, is_kept, &error, error_of, &time, &bytes.to_string()]);
        }
    }
}

fn main() {
    let head = ["quantity", "in", "", "error", "which is", "time", "bytes"];
    let mut study = Study(Table::new(head));
    film::measure(&mut study);
    rays::measure(&mut study);
    map::measure(&mut study);
    vanishing::measure(&mut study);
    newton::measure(&mut study);
    fourier::measure(&mut study);
    #[cfg(feature = "stylize")]
    patches::measure(&mut study);
    study.0.print("precisions: errors, and times relative to what is kept, one thread");
    study.0.write("precision").expect("out/bench can be written to");
}
