//! Benchmark of precision: for each quantity, the error and the time with a narrower and a wider number type.
//!
//! Each kernel is generic over the number type, follows the arithmetic of its stage, and runs in f32 and in f64 on the
//! same data. Distances of patches run in the library's integers, in f32 and in half floats. Errors are relative to
//! the exact value, or to the result in f64 if the exact value is unknown. Times are of one thread, measured in turns,
//! and relative to the type that the library uses. No kernel is written for vector registers, so the types differ only
//! by the compiler's vectorisation.

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

/// A kernel with one number type: name of the type, bytes per stored element, error, and the work to be timed.
struct Way<'a> {
    name: &'a str,
    bytes: usize,
    error: f64,
    work: &'a mut dyn FnMut(),
}

/// Wraps work so that the compiler cannot remove it.
fn timed<T>(mut work: impl FnMut() -> T) -> impl FnMut() {
    move || {
        black_box(work());
    }
}

/// The table of all quantities.
struct Study(Table);

impl Study {
    /// Adds a row for each number type of one quantity; `kept` is the index of the type that the library uses.
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
