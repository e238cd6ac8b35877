//! Plans renderings and compares the predictions with the renderings.

use super::harness::scenes::{self, Absent, Setting};
use super::harness::{Clock, time};
use super::outcomes::{Outcomes, error_of};
use super::{Table, columns};
use luxfer::job::Monitor;
use luxfer::plan::{self, Goal};
use luxfer::render::{self, Film, Params, World};
use std::sync::Arc;

pub fn measure(all: &mut Outcomes) {
    let mut table =
        Table::new(["scene", "size", "goal", "paths", "s expected", "s", "ratio", "error expected", "error", "ratio"]);
    let settings: [Result<Setting, Absent>; 7] = [
        scenes::demo_room(),
        scenes::demo_office(),
        scenes::cornell(),
        Ok(scenes::planes("planes 8k", 8_000)),
        scenes::kitchen(),
        scenes::apartment(),
        scenes::sponza(),
    ];
    for setting in settings {
        let setting = match setting {
            Ok(setting) => setting,
            Err(reason) => {
                println!("# a scene is absent: {reason}");
                continue;
            }
        };
        let scene = Arc::new(setting.scene.clone());
        let world = World::build(scene, Monitor::default().job()).expect("a valid scene");
        for (width, goals) in [
            (120, [Goal::Seconds(0.25), Goal::Seconds(1.5), Goal::Error(0.15)]),
            (280, [Goal::Seconds(0.8), Goal::Seconds(2.5), Goal::Error(0.3)]),
        ] {
            let size = [width, (width as f32 / setting.aspect()).round() as usize];
            for goal in goals {
                outcome(&setting, &world, size, goal, all, &mut table);
            }
        }
    }
    table.print("renderings: one thread, its own time");
}

fn outcome(setting: &Setting, world: &World, size: [usize; 2], goal: Goal, all: &mut Outcomes, table: &mut Table) {
    let [width, height] = size;
    let monitor = Monitor::default();
    let params = Params { width, height, seed: 7, ..Params::default() };
    let plan =
        plan::rendering(world, &setting.camera, &params, goal, &|| Clock::Thread.now(), monitor.job()).expect("a plan");
    let shoot = |seed| -> (f64, Film) {
        let params = Params { seed, time_budget_ms: 0, ..plan.params.clone() };
        time(Clock::Thread, || {
            render::run(world, &setting.camera, &params, monitor.job(), &mut |_| ()).expect("a film")
        })
    };
    let [(s, a), (t, b)] = [shoot(100), shoot(200)];
    let (seconds, error) = (0.5 * (s + t), error_of(&a.beauty, &b.beauty));
    all.times.push(seconds / plan.expected.seconds);
    all.errors.push(error / plan.expected.error);
    let head = [setting.name.to_string(), format!("{width} x {height}"), format!("{goal:?}"), format!("{}", a.samples)];
    let cells = [columns([plan.expected.seconds, seconds]), columns([plan.expected.error, error])].concat();
    table.row(head.into_iter().chain(cells));
}
