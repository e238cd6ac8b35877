//! The whole transfer, from a photo to a lit picture: how long it takes, what memory, and how its error falls with time.
//!
//! The photo is that of the demonstration, whose lamps are known, the room the one that it lights. The error is the picture's,
//! root mean square relative to its mean, against a transfer that takes a hundred times as long as the defaults, from
//! the largest photo. Each curve varies one thing and leaves the others at their defaults, so where it levels off what is left
//! is of the others; the last is of what a plan chooses for a time, with the time that planning takes.
//!
//! Beside the picture: its mean light, which tells the error of the solution from lamps that lie elsewhere, as they do if
//! a smaller photo shows them less well.

mod harness;

use harness::plot::Plot;
use harness::{Clock, Table, figure, forget_peak_memory, median, peak_memory, time};
use luxfer::demo::{self, photo};
use luxfer::exec::Pool;
use luxfer::image::{Image, pyramid};
use luxfer::job::Monitor;
use luxfer::plan::{self, Goal};
use luxfer::transfer::{Input, Params, Stage, Transfer};
use std::sync::Arc;

/// Of the largest photo.
const PHOTO: [usize; 2] = [1200, 800];
/// Of the picture in the curves.
const PICTURE: [usize; 2] = [160, 90];
const ROUNDS: usize = 3;

fn main() {
    let pool = Pool::new(2).expect("two threads");
    pool.run(|| {
        demonstration();
        let photo = photograph(PHOTO, 64);
        curves(&photo);
    });
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

/// What `make demo` makes, but for its files: a photo, and the picture of a room in its light.
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
        median(&(0..5).map(of_round).collect::<Vec<_>>())
    };
    figure("transfer.demo.seconds", seconds(&final_quality), "s");
    figure("peak.transfer_demo.mb", peak_memory().unwrap_or(0) as f64 / 1e6, "MB");
    figure("transfer.demo.preview_seconds", seconds(&preview), "s");
}

/// The defaults, for a picture of the curves' size.
fn defaults() -> Params {
    let mut params = Params::default();
    (params.render.width, params.render.height) = (PICTURE[0], PICTURE[1]);
    params
}

fn curves(photo: &Image) {
    let mut fine = defaults();
    fine.max_texels = 4096;
    fine.relight.target_error = 0.0005;
    fine.render.samples = 100 * fine.render.samples;
    (fine.relight.seed, fine.render.seed) = (1001, 1002);
    let (seconds, truth) = time(Clock::Wall, || {
        let mut transfer = transfer(photo.clone(), fine);
        run(&mut transfer, Stage::View, Stage::Render);
        picture(&transfer)
    });

    let mut study = Study {
        truth,
        photo,
        table: Table::new(["what varies", "at", "seconds", "error %", "mean light off %"]),
        plot: Plot::new("A whole transfer, 160 x 90", "seconds", "error of the picture"),
    };
    println!("# the reference took {seconds:.1} s");
    study.vary("width of the photo, px", &[150, 300, 450, 600, 900, 1200], |_, _| (), |&width| width);
    study.vary("texels", &[64, 128, 256, 512, 1024, 2048], |p, &n| p.max_texels = n, |_| PHOTO[0]);
    study.vary(
        "error of the strength, %",
        &[20.0, 5.0, 2.0, 1.0, 0.3],
        |p, e| p.relight.target_error = 0.01 * e,
        |_| PHOTO[0],
    );
    study.vary("paths of a pixel", &[1, 4, 16, 64, 256], |p, &n| p.render.samples = n, |_| PHOTO[0]);
    study.plans(&[0.5, 1.0, 2.0, 4.0, 8.0]);
    study.table.print("a whole transfer against one a hundred times as long, 2 threads");
    study.plot.write("transfer").expect("out/bench can be written to");
}

struct Study<'a> {
    truth: Image,
    photo: &'a Image,
    table: Table,
    plot: Plot,
}

impl Study<'_> {
    /// A curve of transfers whose settings and width of photo differ.
    fn vary<T: std::fmt::Display>(
        &mut self,
        name: &str,
        values: &[T],
        set: impl Fn(&mut Params, &T),
        width: impl Fn(&T) -> usize,
    ) {
        let point = |value: &T| {
            let mut params = defaults();
            set(&mut params, value);
            let photo = self.reduced(width(value));
            let runs = (0..ROUNDS).map(|round| {
                let mut transfer = transfer(photo.clone(), params.clone());
                (transfer.params.relight.seed, transfer.params.render.seed) = (11 + round as u64, 21 + round as u64);
                let (seconds, ()) = time(Clock::Wall, || run(&mut transfer, Stage::View, Stage::Render));
                (seconds, picture(&transfer))
            });
            (value.to_string(), runs.collect())
        };
        let points = values.iter().map(point).collect();
        self.add(name, points);
    }

    /// A curve of what plans choose.
    fn plans(&mut self, budgets: &[f64]) {
        let point = |&budget: &f64| {
            let runs = (0..ROUNDS).map(|round| {
                let mut transfer = transfer(self.photo.clone(), defaults());
                (transfer.params.relight.seed, transfer.params.render.seed) = (31 + round as u64, 41 + round as u64);
                let (seconds, ()) = time(Clock::Wall, || {
                    run(&mut transfer, Stage::View, Stage::Emission);
                    let job = Monitor::default();
                    let plan = plan::lighting(&transfer, Goal::Seconds(budget), &plan::wall(), job.job());
                    let plan = plan.expect("a plan");
                    (transfer.params.relight, transfer.params.render) = (plan.relight, plan.render);
                    run(&mut transfer, Stage::Relight, Stage::Render);
                });
                (seconds, picture(&transfer))
            });
            (format!("{budget} s"), runs.collect())
        };
        let points = budgets.iter().map(point).collect();
        self.add("by a plan for the light, s", points);
    }

    fn add(&mut self, name: &str, points: Vec<(String, Vec<(f64, Image)>)>) {
        let rows = points.into_iter().map(|(value, runs)| {
            let of = |f: &dyn Fn(&(f64, Image)) -> f64| median(&runs.iter().map(f).collect::<Vec<_>>());
            let seconds = of(&|r| r.0);
            let error = of(&|r| error(&r.1, &self.truth));
            let light = of(&|r| (mean(&r.1) / mean(&self.truth) - 1.0).abs());
            self.table.row([
                name.to_string(),
                value,
                format!("{seconds:.3}"),
                format!("{:.2}", 100.0 * error),
                format!("{:.2}", 100.0 * light),
            ]);
            [seconds, error]
        });
        let points: Vec<_> = rows.collect();
        self.plot.add(name, points);
    }

    fn reduced(&self, width: usize) -> Image {
        let height = width * PHOTO[1] / PHOTO[0];
        pyramid::resize(self.photo, width, height, Monitor::default().job()).expect("a photo")
    }
}

fn picture(transfer: &Transfer) -> Image {
    transfer.results.film.as_ref().expect("a film").beauty.clone()
}

fn mean(image: &Image) -> f64 {
    image.data.iter().map(|&v| f64::from(v)).sum::<f64>() / image.data.len() as f64
}

/// Root mean square of the difference, relative to the mean of the truth.
fn error(found: &Image, truth: &Image) -> f64 {
    let squares = found.data.iter().zip(&truth.data).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
    (squares / truth.data.len() as f64).sqrt() / mean(truth)
}
