//! Benchmark of the renderer's analysis of a scene: the ratio of paths per second with it to paths per second with
//! every feature enabled, and the features that the analysis disables. One thread, in turns.

mod harness;

use harness::scenes::{self, Setting};
use harness::{Clock, figure, interleaved};
use luxfer::exec::Pool;
use luxfer::job::Monitor;
use luxfer::render::{self, Params, World};
use std::sync::Arc;

const ROUNDS: usize = 7;

fn main() {
    println!("{:10} {:>9} {:>11} {:>11} {:>7}  left out", "scene", "triangles", "paths/s", "general", "ratio");
    let matt = scenes::planes("planes8k", 8_000);
    for setting in [Ok(matt), scenes::cornell(), scenes::demo_room(), scenes::demo_office(), scenes::kitchen()] {
        match setting {
            Ok(setting) => measure(&setting),
            Err(reason) => println!("# {reason}"),
        }
    }
}

fn measure(setting: &Setting) {
    let monitor = Monitor::default();
    // This pool only builds; rendering runs in a pool of one thread.
    let builder = Pool::new(0).expect("threads");
    let scene = Arc::new(setting.scene.clone());
    let build = || builder.run(|| World::build(scene.clone(), monitor.job())).expect("the scene is valid");
    let (analysed, mut general) = (build(), build());
    general.discard_analysis();
    let pool = Pool::new(1).expect("a thread");
    let params = Params { width: setting.size[0] / 4, height: setting.size[1] / 4, samples: 8, ..Params::default() };
    let paths = (params.width * params.height) as f64 * f64::from(params.samples);
    let render = |world: &World| {
        pool.run(|| render::run(world, &setting.camera, &params, monitor.job(), &mut |_| ())).expect("it renders");
    };
    let times = interleaved(Clock::Wall, ROUNDS, &mut [&mut || render(&analysed), &mut || render(&general)]);
    let ratio = times.ratio(1, 0);
    println!(
        "{:10} {:>9} {:>11.0} {:>11.0} {ratio:>7.3}",
        setting.name,
        setting.triangle_count(),
        paths / times.median(0),
        paths / times.median(1)
    );
    for sentence in analysed.requirements().left_out() {
        println!("{:52}  {sentence}", "");
    }
    for error in [0.05, 0.01] {
        let bounces = analysed.requirements().bounces(error).map_or("no bound".into(), |n| format!("{n} bounces"));
        println!("{:52}  All but {} % of scattered light: {bounces}.", "", error * 100.0);
    }
    figure(&format!("requirements.{}.speedup", setting.name), ratio, "ratio");
}
