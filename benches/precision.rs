//! Precision of each quantity: error and time of a narrower and a wider number type.
//!
//! Each kernel is generic over the number type, follows the arithmetic of its stage, and runs in f32 and in f64 on the
//! same data; distances of patches run in the library's integers, in f32 and in halves. Errors are against the exact
//! value, or against f64 where the exact value is unknown. Times are of one thread, interleaved, relative to the
//! library's choice; no kernel is written for wide registers, so types differ only by the compiler's vectorisation.

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

/// One number format: its name, bytes per stored element, error, and the timed work.
struct Way<'a> {
    name: &'a str,
    bytes: usize,
    error: f64,
    work: &'a mut dyn FnMut(),
}

/// Wraps work so that the compiler does not remove it.
fn timed<T>(mut work: impl FnMut() -> T) -> impl FnMut() {
    move || {
        black_box(work());
    }
}

/// Rows of the table.
struct Study(Table);

impl Study {
    /// Adds the formats of one quantity; `kept` is the index of the library's choice.
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
