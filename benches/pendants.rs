//! Benchmark of pendants: bodies of twelve forms seen by random cameras, with noise of 0.3 pixels on their outlines and
//! of one pixel on their suspensions. It prints the share of right kinds, the errors of profile and drop, the share of
//! 95 % intervals that hold the truth, and the seconds per lamp.
//!
//! Argument: the number of cases per body; or `rendered`, for lamps in rooms that the library renders.

mod harness;

#[path = "pendants/bodies.rs"]
mod bodies;
#[path = "pendants/rendered.rs"]
mod rendered;

use bodies::{BODIES, Body, Case};
use glam::DVec2;
use harness::{Clock, Table, figure, quantile, time};
use luxfer::exec::{self, Pool};
use luxfer::job::Monitor;
use luxfer::pendant::{self, Input, Interval, Known, Params, Pendants};
use rendered::{Setup, photograph};

/// Seed of the cameras.
const SEED: u64 = 28;
/// Noise of the outlines in pixels.
const NOISE: f64 = 0.3;
/// Cases per body, unless an argument gives their number.
const CASES: usize = 40;
/// Number of heights at which radii are compared.
const HEIGHTS: usize = 50;

/// The errors of one case.
struct Outcome {
    is_right: bool,
    /// Root mean square error of the radius in % of the height, at the scale that makes the diameters equal.
    profile: f64,
    /// Error of the drop in %, if it is determined, and whether its interval holds the truth.
    drop: Option<(f64, bool)>,
    /// Whether the interval of the ratio of height to diameter holds the truth.
    aspect: bool,
    seconds: f64,
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    if words.iter().any(|word| word == "rendered") {
        return of_renderings();
    }
    let cases = words.iter().find_map(|word| word.parse().ok()).unwrap_or(CASES);
    let pool = Pool::new(2).unwrap();
    let mut table =
        Table::new(["body", "kind right", "profile", "p90", "drop", "p90", "in interval", "aspect in", "s"]);
    let mut all = Vec::new();
    for body in &BODIES {
        let monitor = Monitor::default();
        let outcomes = pool.run(|| exec::map(cases, monitor.job(), |number| outcome(body, number)).unwrap());
        table.row(line(body, &outcomes));
        all.extend(outcomes);
    }
    table.print("Bodies from outlines: medians and 90th percentiles of errors in %");
    figures(&all);
}

fn outcome(body: &Body, number: usize) -> Outcome {
    let case = Case::new(body, number, SEED, NOISE);
    let hooks: Vec<DVec2> = case.suspension.into_iter().collect();
    let input = Input { camera: &case.shot.camera, shifted: &[], suspensions: &hooks, known: Known::NoLength };
    let params = Params { distance: case.ceiling.max(0.01), ..Params::default() };
    let outlines = [case.outline.clone()];
    let run = || pendant::from_outlines(&outlines, &input, &params, Monitor::default().job());
    let (seconds, found) = time(Clock::Thread, run);
    let Ok(found) = found.map(|mut all| all.remove(0)) else {
        return Outcome { is_right: false, profile: 100.0, drop: None, aspect: false, seconds };
    };
    let holds = |interval: &Interval, truth: f64| interval.low <= truth && truth <= interval.high;
    let truth = case.drop(body);
    let drop = &found.lamps[0].drop;
    let diameter = 2.0 * body.profile().iter().map(|v| v.x).fold(0.0, f64::max);
    Outcome {
        is_right: found.kind == body.kind,
        profile: 100.0 * profile_error(&found, body, diameter),
        drop: found.is_metric.then(|| (100.0 * (drop.value / truth - 1.0).abs(), holds(drop, truth))),
        aspect: holds(&found.aspect, body.height / diameter),
        seconds,
    }
}

/// Returns the root mean square error of the radius as a share of the height, with the middles at equal heights.
fn profile_error(found: &Pendants, body: &Body, diameter: f64) -> f64 {
    let height = found.profile.last().map_or(0.0, |v| v.y);
    let radius = |y: f64| {
        let piece = found.profile.windows(2).find(|v| v[0].y <= y && y <= v[1].y && v[1].y > v[0].y);
        piece.map_or(0.0, |v| v[0].x + (y - v[0].y) / (v[1].y - v[0].y) * (v[1].x - v[0].x))
    };
    let square = |k: usize| {
        let share = (k as f64 + 0.5) / HEIGHTS as f64;
        let y = body.height / diameter * (share - 0.5) + 0.5 * height;
        ((diameter * radius(y) - (body.radius)(share)) / body.height).powi(2)
    };
    ((0..HEIGHTS).map(square).sum::<f64>() / HEIGHTS as f64).sqrt()
}

/// Measures lamps in renderings: sharp, blurred by 1 pixel, blurred and clipped, and far away.
fn of_renderings() {
    let near = Setup { distance: 2.0, drop: 0.8, luminance: 60.0, white: 100.0, blur: 0.0 };
    let setups = [
        ("sharp", near),
        ("blurred", Setup { blur: 1.0, ..near }),
        ("clipped", Setup { luminance: 1000.0, blur: 1.0, ..near }),
        ("far", Setup { distance: 3.5, ..near }),
    ];
    let columns = ["body", "photo", "width", "kind", "probability", "diameter", "in", "height", "in", "drop", "in"];
    let mut table = Table::new(columns);
    for body in &BODIES {
        for (name, setup) in &setups {
            table.row(of_rendering(body, name, setup));
        }
    }
    table.print("Bodies from renderings: width in pixels, errors in %, and whether the interval holds the truth");
}

fn of_rendering(body: &Body, name: &str, setup: &Setup) -> Vec<String> {
    let shot = photograph(body, setup);
    let input = Input { camera: &shot.camera, shifted: &[], suspensions: &[shot.hook], known: Known::NoLength };
    let params = Params { distance: shot.ceiling, ..Params::default() };
    let diameter = 2.0 * body.profile().iter().map(|v| v.x).fold(0.0, f64::max);
    let is_lit = |x: usize| (0..shot.mask.height).any(|y| shot.mask.pixel(x, y)[0] > 0.5);
    let width = (0..shot.mask.width).filter(|x| is_lit(*x)).count();
    let head = [body.name.to_string(), name.to_string(), width.to_string()];
    let found = match pendant::run(&shot.photo, &shot.mask, &input, &params, Monitor::default().job()) {
        Ok(mut found) => found.remove(0),
        Err(error) => return head.into_iter().chain([error.message]).collect(),
    };
    let error = |interval: Interval, truth: f64| {
        let holds = interval.low <= truth && truth <= interval.high;
        [format!("{:+.2}", 100.0 * (interval.value / truth - 1.0)), if holds { "yes" } else { "no" }.to_string()]
    };
    let kind = if found.kind == body.kind { "right".to_string() } else { format!("{:?}", found.kind) };
    let numbers = [
        error(found.diameter, diameter),
        error(found.height, body.height),
        error(found.lamps[0].drop, f64::from(setup.drop)),
    ];
    head.into_iter().chain([kind, format!("{:.2}", found.probability)]).chain(numbers.into_iter().flatten()).collect()
}

/// Returns the share in % of the flags that are set.
fn share(flags: impl Iterator<Item = bool>) -> f64 {
    let flags: Vec<bool> = flags.collect();
    100.0 * flags.iter().filter(|f| **f).count() as f64 / flags.len().max(1) as f64
}

/// Returns the values of the outcomes that have one.
fn values(outcomes: &[Outcome], of: impl Fn(&Outcome) -> Option<f64>) -> Vec<f64> {
    outcomes.iter().filter_map(of).collect()
}

fn line(body: &Body, outcomes: &[Outcome]) -> Vec<String> {
    let profiles = values(outcomes, |o| Some(o.profile));
    let drops = values(outcomes, |o| o.drop.map(|d| d.0));
    let held = outcomes.iter().filter_map(|o| o.drop).map(|d| d.1);
    vec![
        body.name.into(),
        format!("{:.0} %", share(outcomes.iter().map(|o| o.is_right))),
        format!("{:.2}", quantile(&profiles, 0.5)),
        format!("{:.2}", quantile(&profiles, 0.9)),
        format!("{:.2}", quantile(&drops, 0.5)),
        format!("{:.2}", quantile(&drops, 0.9)),
        format!("{:.0} %", share(held)),
        format!("{:.0} %", share(outcomes.iter().map(|o| o.aspect))),
        format!("{:.2}", quantile(&values(outcomes, |o| Some(o.seconds)), 0.5)),
    ]
}

fn figures(all: &[Outcome]) {
    let profiles = values(all, |o| Some(o.profile));
    let drops = values(all, |o| o.drop.map(|d| d.0));
    let seconds = values(all, |o| Some(o.seconds));
    figure("pendants.kind", share(all.iter().map(|o| o.is_right)), "% right");
    figure("pendants.profile", quantile(&profiles, 0.5), "% of the height, median");
    figure("pendants.profile.p90", quantile(&profiles, 0.9), "% of the height, 90th percentile");
    figure("pendants.drop", quantile(&drops, 0.5), "%, median");
    figure("pendants.drop.p90", quantile(&drops, 0.9), "%, 90th percentile");
    figure("pendants.coverage", share(all.iter().filter_map(|o| o.drop).map(|d| d.1)), "% of intervals of the drop");
    figure("pendants.coverage.aspect", share(all.iter().map(|o| o.aspect)), "% of intervals of height / diameter");
    figure("pendants.seconds", quantile(&seconds, 0.5), "s per lamp, median");
    figure("pendants.seconds.worst", quantile(&seconds, 1.0), "s per lamp");
}
