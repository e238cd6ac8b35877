//! Tests that plans are accurate: the times and errors that they predict match the actual ones, on rooms and image
//! sizes to which no parameter of the predictor was fitted.
//!
//! Times are processor times of one thread. The tests of this file run one at a time, because work on one processor
//! slows another one that shares its caches. `make bench ONLY=plan` measures more cases and whole transfers.

// Only benches use the other clocks of this module.
#[allow(dead_code)]
#[path = "../benches/harness/clock.rs"]
mod clock;
#[path = "../benches/plan/outcomes.rs"]
mod outcomes;

use clock::{Clock, time};
use glam::Vec3;
use luxfer::demo;
use luxfer::error::ErrorKind;
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::plan::{self, Goal};
use luxfer::render::{self, Film, Params, World};
use luxfer::scene::surface;
use luxfer::scene::{Camera, Scene};
use luxfer::transfer::{Input, Stage, Transfer};
use outcomes::{Outcomes, error_of, within};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Returns a guard; no other test of this file runs until it is dropped.
fn alone() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The furnished demonstration room with nine lamps in its ceiling, and the demonstration office with its own lamps.
fn rooms() -> [(Scene, Camera); 2] {
    let mut room = demo::target_room().unwrap();
    let ceiling = surface::find(&room, "Ceiling").unwrap();
    let lamps = Image::from_fn(60, 40, |x, y| [f32::from(x % 20 < 6 && y % 13 < 4); 3]).unwrap();
    surface::place(&mut room, &ceiling, lamps, Vec3::splat(2000.0)).unwrap();
    let office = demo::exemplar_room().unwrap();
    [room, office.scene].map(|scene| {
        let camera = scene.cameras[0].clone();
        (scene, camera)
    })
}

fn planned(world: &World, camera: &Camera, params: &Params, goal: Goal) -> plan::Rendering {
    plan::rendering(world, camera, params, goal, &|| Clock::Thread.now(), Monitor::default().job()).unwrap()
}

/// Renders without a time limit; returns the processor time in seconds and the film.
fn shot(world: &World, camera: &Camera, params: &Params) -> (f64, Film) {
    let params = Params { time_budget_ms: 0, ..params.clone() };
    time(Clock::Thread, || render::run(world, camera, &params, Monitor::default().job(), &mut |_| ()).unwrap())
}

#[test]
fn renderings_take_the_time_and_leave_the_error_that_was_expected() {
    let _alone = alone();
    let mut all = Outcomes::default();
    Pool::new(1).unwrap().run(|| {
        for (scene, camera) in rooms() {
            let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
            for (width, height) in [(72, 48), (140, 90)] {
                for goal in [Goal::Seconds(0.3), Goal::Error(0.25), Goal::Seconds(0.8)] {
                    let params = Params { width, height, ..Params::default() };
                    let plan = planned(&world, &camera, &params, goal);
                    let [(s, a), (t, b)] =
                        [11, 12].map(|seed| shot(&world, &camera, &Params { seed, ..plan.params.clone() }));
                    all.times.push(0.5 * (s + t) / plan.expected.seconds);
                    all.errors.push(error_of(&a.beauty, &b.beauty) / plan.expected.error);
                    if let Goal::Error(error) = goal {
                        assert!(
                            plan.expected.error <= error * 1.001 && a.error < 1.25 * error,
                            "{plan:?}: {}",
                            a.error
                        );
                    }
                }
            }
        }
    });
    println!("times {:.2?}\nerrors {:.2?}", all.times, all.errors);
    for ratios in [all.times, all.errors] {
        assert!(within(&ratios) >= 0.9, "{ratios:.2?}");
    }
}

/// For its prediction, a plan renders only a seventh of the tiles of these pictures, whose error is mostly at the
/// edges of lamps. The predicted error must not depend on which tiles the seed selects.
#[test]
fn what_is_expected_does_not_hang_on_the_seed() {
    let _alone = alone();
    Pool::new(0).unwrap().run(|| {
        for (scene, camera) in rooms() {
            let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
            let params = Params { width: 288, height: 192, samples: 16, ..Params::default() };
            let [(_, a), (_, b)] = [11, 12].map(|seed| shot(&world, &camera, &Params { seed, ..params.clone() }));
            let found = error_of(&a.beauty, &b.beauty);
            let expected = |seed| {
                let pilot = render::pilot::run(
                    &world,
                    &camera,
                    &Params { seed, ..params.clone() },
                    &plan::wall(),
                    Monitor::default().job(),
                );
                pilot.unwrap().squared_errors[1].sqrt()
            };
            let ratios: Vec<f64> = (0..5).map(|seed| found / expected(seed)).collect();
            println!("{ratios:.2?}");
            assert_eq!(within(&ratios), 1.0, "{ratios:.2?}");
        }
    });
}

#[test]
fn the_light_of_a_transfer_is_planned() {
    let _alone = alone();
    let pool = Pool::new(2).unwrap();
    let monitor = Monitor::default();
    let room = demo::exemplar_room().unwrap();
    let camera = room.scene.cameras[room.camera].clone();
    let size = demo::photo::Params { width: 300, height: 200, samples: 8, seed: 3 };
    let (photo, _) =
        pool.run(|| demo::photo::photograph(Arc::new(room.scene.clone()), &camera, &size, monitor.job())).unwrap();
    let input = Input {
        strokes: demo::strokes(&room, size.width, size.height).unwrap(),
        photo: Some(Arc::new(photo)),
        scene: Some(Arc::new(demo::target_room().unwrap())),
        surface: "Ceiling".into(),
        ..Input::default()
    };
    let mut transfer = Transfer { input, ..Transfer::default() };
    (transfer.params.render.width, transfer.params.render.height) = (64, 36);
    let clock = plan::wall();
    let plan = |transfer: &Transfer, goal| pool.run(|| plan::lighting(transfer, goal, &clock, monitor.job()));
    let early = plan(&transfer, Goal::Error(0.3)).unwrap_err();
    assert_eq!(
        (early.kind, early.message.contains("run stage Emission")),
        (ErrorKind::InvalidOperation, true),
        "{early}"
    );

    pool.run(|| transfer.run(Stage::View, Stage::Emission, monitor.job(), |_| ())).unwrap();
    let planned = plan(&transfer, Goal::Error(0.3)).unwrap();
    assert!(planned.whole.error <= 0.3 * 1.001 && planned.whole.error > 0.2, "{planned:?}");
    assert!((planned.solving.seconds + planned.rendering.seconds - planned.whole.seconds).abs() < 1e-9);
    (transfer.params.relight, transfer.params.render) = (planned.relight.clone(), planned.render.clone());
    pool.run(|| transfer.run(Stage::Relight, Stage::Render, monitor.job(), |_| ())).unwrap();
    let film = transfer.results.film.as_ref().unwrap();
    let expected = planned.rendering.error;
    assert!((film.error / expected - 1.0).abs() < 0.4, "{} where {expected} was expected", film.error);
    let solved = transfer.results.solution.as_ref().unwrap().error();
    assert!(solved <= f64::from(planned.relight.target_error), "{solved}: {planned:?}");

    // More time means less error, and a stage that cannot use time gets none.
    let [short, long] = [1.0, 20.0].map(|seconds| plan(&transfer, Goal::Seconds(seconds)).unwrap());
    assert!(long.whole.error < 0.6 * short.whole.error, "{short:?} {long:?}");
    assert!(long.relight.paths > short.relight.paths && long.render.samples > short.render.samples);
    let kept = render::Params {
        samples: long.render.samples,
        time_budget_ms: long.render.time_budget_ms,
        ..Params::default()
    };
    assert_eq!(long.render, Params { width: 64, height: 36, target_error: 0.0, ..kept });

    // Invalid goals are refused.
    for goal in [Goal::Error(0.0), Goal::Error(f64::NAN), Goal::Seconds(-1.0)] {
        assert_eq!(plan(&transfer, goal).unwrap_err().kind, ErrorKind::InvalidArgument);
    }
    let cancelled = Monitor::default();
    cancelled.cancel();
    let run = pool.run(|| plan::lighting(&transfer, Goal::Error(0.1), &clock, cancelled.job()));
    assert_eq!(run.unwrap_err().kind, ErrorKind::Cancelled);
}
