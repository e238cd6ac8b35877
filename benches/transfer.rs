//! Benchmark of the whole transfer, from a photo to a lit picture: time, memory, and error against time.
//!
//! `cargo bench --bench transfer -- demonstration` or `-- curves` runs one section.

#[path = "transfer/curves.rs"]
mod curves;
mod harness;

use harness::scenes::{office_photo, transfer_input};
use harness::{Clock, figure, forget_peak_memory, median, peak_memory, time};
use luxfer::demo::{self, photo};
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::transfer::{Params, Stage, Transfer};
use std::sync::Arc;

const ROUNDS: usize = 5;

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let wants = |what: &str| asked.is_empty() || asked.iter().any(|a| a == what);
    Pool::new(2).expect("two threads").run(|| {
        if wants("demonstration") {
            demonstration();
        }
        if wants("curves") {
            curves::draw();
        }
    });
}

/// A transfer from a photo of the demonstration office to the demonstration room.
fn transfer(photo: Image, params: Params) -> Transfer {
    let office = demo::exemplar_room().expect("a room");
    let strokes = demo::strokes(&office, photo.width, photo.height).expect("strokes");
    let input = transfer_input(Arc::new(photo), strokes, Arc::new(demo::target_room().expect("a room")));
    Transfer { input, params, ..Transfer::default() }
}

fn run(transfer: &mut Transfer, from: Stage, to: Stage) {
    transfer.run(from, to, Monitor::default().job(), |_| ()).expect("a transfer");
}

/// Times the work of `make demo` without its files: the photo of an office, and a picture of a room in its light, 640
/// x 360. It is timed at final quality, and as a preview with two filtered paths per pixel and an error of 5 % of the
/// strength; the preview is timed also without making the photo.
fn demonstration() {
    let final_quality = |params: &mut Params| {
        (params.render.width, params.render.height, params.render.samples) = (640, 360, 12);
    };
    let preview = |params: &mut Params| {
        final_quality(params);
        (params.render.samples, params.render.preview) = (2, 1.0);
        params.relight.target_error = 0.05;
    };
    forget_peak_memory();
    let photo = || office_photo(&photo::Params::default());
    let seconds = |set: &dyn Fn(&mut Params), photo: &dyn Fn() -> Image| {
        let mut params = Params::default();
        set(&mut params);
        let whole = || {
            let mut transfer = transfer(photo(), params.clone());
            run(&mut transfer, Stage::View, Stage::Render);
        };
        median(&(0..ROUNDS).map(|_| time(Clock::Wall, whole).0).collect::<Vec<_>>())
    };
    figure("transfer.demo.seconds", seconds(&final_quality, &photo), "s");
    figure("peak.transfer_demo.mb", peak_memory().unwrap_or(0) as f64 / 1e6, "MB");
    figure("transfer.demo.preview_seconds", seconds(&preview, &photo), "s");
    let made = photo();
    figure("transfer.preview.seconds", seconds(&preview, &|| made.clone()), "s");
}
