//! The whole transfer, from a photo to a lit picture: how long it takes, and what memory.
//!
//! What `make demo` makes, but for its files: the photo of an office, and the picture of a room in its light, 640 x 360. Once as it is to
//! be looked at in the end, and once as a preview: two paths for each pixel, filtered, and the strength to 5 %.

mod harness;

use harness::{Clock, figure, forget_peak_memory, median, peak_memory, time};
use luxfer::demo::{self, photo};
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::transfer::{Input, Params, Stage, Transfer};
use std::sync::Arc;

const ROUNDS: usize = 5;

fn main() {
    Pool::new(2).expect("two threads").run(demonstration);
}

/// The demonstration's office, whole.
fn photograph([width, height]: [usize; 2], samples: u32) -> Image {
    let room = demo::exemplar_room().expect("a room");
    let camera = room.scene.cameras[room.camera].clone();
    let params = photo::Params { width, height, samples, ..photo::Params::default() };
    photo::photograph(Arc::new(room.scene), &camera, &params, Monitor::default().job()).expect("a photo").0
}

/// A transfer from a photo of the office to the demonstration's room.
fn transfer(photo: Image, params: Params) -> Transfer {
    let room = demo::exemplar_room().expect("a room");
    let input = Input {
        strokes: demo::strokes(&room, photo.width, photo.height).expect("strokes"),
        photo: Some(Arc::new(photo)),
        scene: Some(Arc::new(demo::target_room().expect("a room"))),
        surface: "Ceiling".into(),
        ..Input::default()
    };
    Transfer { input, params, ..Transfer::default() }
}

fn run(transfer: &mut Transfer, from: Stage, to: Stage) {
    transfer.run(from, to, Monitor::default().job(), |_| ()).expect("a transfer");
}

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
    let seconds = |set: &dyn Fn(&mut Params)| {
        let mut params = Params::default();
        set(&mut params);
        let of_round = |_| {
            let size = photo::Params::default();
            let whole = || {
                let mut transfer = transfer(photograph([size.width, size.height], size.samples), params.clone());
                run(&mut transfer, Stage::View, Stage::Render);
            };
            time(Clock::Wall, whole).0
        };
        median(&(0..ROUNDS).map(of_round).collect::<Vec<_>>())
    };
    figure("transfer.demo.seconds", seconds(&final_quality), "s");
    figure("peak.transfer_demo.mb", peak_memory().unwrap_or(0) as f64 / 1e6, "MB");
    figure("transfer.demo.preview_seconds", seconds(&preview), "s");
}
