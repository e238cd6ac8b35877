//! Error of a whole transfer's picture against the transfer's time.
//!
//! The error is the root mean square difference, relative to the mean, from the picture of a reference transfer with a
//! hundred times the default number of paths, a finer texture and a strength ten times as accurate. Each curve varies
//! one setting and leaves the others at their defaults, so it levels off at the error of the other settings. The last
//! curve shows plans for a time, including the time of planning. Times are of whole transfers: they include stages
//! that are not run again because their input has not changed.
//!
//! The mean of the picture is reported too. It separates the error of the solution from lamps at wrong positions,
//! which occur if a smaller photo shows the lamps less clearly.

use super::harness::plot::Plot;
use super::harness::scenes::office_photo;
use super::harness::{Clock, Table, median, time};
use super::{run, transfer};
use luxfer::demo::photo;
use luxfer::image::{Image, pyramid};
use luxfer::job::Monitor;
use luxfer::plan::{self, Goal};
use luxfer::transfer::{Params, Stage, Transfer};
use std::fmt::Display;

const PHOTO: [usize; 2] = [900, 600];
const PICTURE: [usize; 2] = [96, 54];
const ROUNDS: u64 = 3;

pub fn draw() {
    let photo =
        office_photo(&photo::Params { width: PHOTO[0], height: PHOTO[1], samples: 16, ..photo::Params::default() });
    let truth = reference(&photo);

    // Run the stages before relighting once, for all curves that do not change them.
    let mut lit = transfer(photo.clone(), defaults());
    let (before, ()) = time(Clock::Wall, || run(&mut lit, Stage::View, Stage::Emission));

    let mut study = Study {
        truth,
        table: Table::new(["what varies", "at", "seconds", "error %", "mean light off %"]),
        plot: Plot::new("A whole transfer, 96 x 54", "seconds", "error of the picture"),
    };
    let whole = |photo: &Image, params: Params, seed: u64| {
        let mut transfer = transfer(photo.clone(), seeded(params, seed));
        let (seconds, ()) = time(Clock::Wall, || run(&mut transfer, Stage::View, Stage::Render));
        (seconds, picture(&transfer))
    };
    study.vary("width of the photo, px", &[150, 225, 300, 450, 600, 900], |&width, seed| {
        let height = width * PHOTO[1] / PHOTO[0];
        let reduced = pyramid::resize(&photo, width, height, Monitor::default().job()).expect("a photo");
        whole(&reduced, defaults(), seed)
    });
    study.vary("texels", &[64, 128, 256, 512, 1024, 2048], |&texels, seed| {
        whole(&photo, Params { max_texels: texels, ..defaults() }, seed)
    });
    let light = |set: &dyn Fn(&mut Params), seed: u64| {
        let mut transfer = lit.clone();
        transfer.params = seeded(defaults(), seed);
        set(&mut transfer.params);
        let (seconds, ()) = time(Clock::Wall, || run(&mut transfer, Stage::Relight, Stage::Render));
        (before + seconds, picture(&transfer))
    };
    study.vary("error of the strength, %", &[20.0, 5.0, 2.0, 1.0, 0.3], |&error, seed| {
        light(&|params| params.relight.target_error = 0.01 * error, seed)
    });
    study.vary("paths of a pixel", &[1, 4, 16, 64, 256], |&samples, seed| {
        light(&|params| params.render.samples = samples, seed)
    });
    study.vary("a plan for the light, s", &[0.25, 0.5, 1.0, 2.0, 4.0], |&budget, seed| {
        let mut transfer = lit.clone();
        transfer.params = seeded(defaults(), seed);
        let (seconds, ()) = time(Clock::Wall, || {
            let plan = plan::lighting(&transfer, Goal::Seconds(budget), &plan::wall(), Monitor::default().job());
            let plan = plan.expect("a plan");
            (transfer.params.relight, transfer.params.render) = (plan.relight, plan.render);
            run(&mut transfer, Stage::Relight, Stage::Render);
        });
        (before + seconds, picture(&transfer))
    });
    study.table.print("a whole transfer against one of a hundred times as many paths, 2 threads");
    study.plot.write("transfer").expect("out/bench can be written to");
}

/// The picture of the reference transfer, with more paths, a finer texture and a more accurate strength.
fn reference(photo: &Image) -> Image {
    let (seconds, truth) = time(Clock::Wall, || {
        let mut fine = defaults();
        fine.max_texels *= 2;
        fine.relight.target_error *= 0.1;
        fine.render.samples *= 100;
        (fine.relight.seed, fine.render.seed) = (1001, 1002);
        let mut transfer = transfer(photo.clone(), fine);
        run(&mut transfer, Stage::View, Stage::Render);
        picture(&transfer)
    });
    println!("# the reference took {seconds:.1} s");
    truth
}

/// The library's default settings, for a small picture.
fn defaults() -> Params {
    let mut params = Params::default();
    (params.render.width, params.render.height) = (PICTURE[0], PICTURE[1]);
    params
}

fn seeded(mut params: Params, seed: u64) -> Params {
    (params.relight.seed, params.render.seed) = (11 + seed, 21 + seed);
    params
}

struct Study {
    truth: Image,
    table: Table,
    plot: Plot,
}

impl Study {
    /// Adds a curve over some values of a setting: median seconds and median error over several seeds.
    fn vary<T: Display>(&mut self, name: &str, values: &[T], make: impl Fn(&T, u64) -> (f64, Image)) {
        let points = values.iter().map(|value| {
            let runs: Vec<_> = (0..ROUNDS).map(|seed| make(value, seed)).collect();
            let of = |f: &dyn Fn(&(f64, Image)) -> f64| median(&runs.iter().map(f).collect::<Vec<_>>());
            let seconds = of(&|r| r.0);
            let error = of(&|r| error(&r.1, &self.truth));
            let light = of(&|r| (mean(&r.1) / mean(&self.truth) - 1.0).abs());
            let cells = [format!("{seconds:.3}"), format!("{:.2}", 100.0 * error), format!("{:.2}", 100.0 * light)];
            self.table.row([name.to_string(), value.to_string()].into_iter().chain(cells));
            [seconds, error]
        });
        let points: Vec<_> = points.collect();
        self.plot.add(name, points);
    }
}

fn picture(transfer: &Transfer) -> Image {
    transfer.results.film.as_ref().expect("a film").beauty.clone()
}

fn mean(image: &Image) -> f64 {
    image.data.iter().map(|&v| f64::from(v)).sum::<f64>() / image.data.len() as f64
}

/// Root mean square of the difference from the true picture, relative to the mean of the truth.
fn error(found: &Image, truth: &Image) -> f64 {
    let squares = found.data.iter().zip(&truth.data).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
    (squares / truth.data.len() as f64).sqrt() / mean(truth)
}
