//! Benchmark of growth: time and memory against the number of triangles and of pixels. (The bench `lights` measures
//! growth with lights.)
//!
//! For each number of triangles, the room of tessellated sheets is rendered with a fixed number of paths; for each
//! image size, the office is rendered. The last column is the local exponent of growth of the time per path: 0 stands
//! for constant time.

mod harness;

use harness::plot::{Plot, Series};
use harness::{Clock, Table, figure, peak_memory, scenes, time};
use luxfer::exec::Pool;
use luxfer::job::Monitor;
use luxfer::render::{self, World};
use std::sync::Arc;

fn main() {
    let pool = Pool::new(2).expect("two threads");
    triangles(&pool);
    resolution(&pool);
}

fn triangles(pool: &Pool) {
    let monitor = Monitor::default();
    let mut table = Table::new(["triangles", "build s", "render s", "peak MB", "exponent"]);
    let (mut build, mut trace) = (Vec::new(), Vec::new());
    for count in [1_000, 10_000, 100_000, 1_000_000, 10_000_000] {
        let setting = scenes::planes("planes", count);
        let (camera, exact) = (setting.camera.clone(), setting.triangle_count() as f64);
        let scene = Arc::new(setting.scene);
        let (to_build, world) = time(Clock::Wall, || pool.run(|| World::build(scene, monitor.job())));
        let world = world.expect("the room is valid");
        let params = render::Params { width: 160, height: 120, samples: 16, ..Default::default() };
        let (to_render, _) =
            time(Clock::Wall, || pool.run(|| render::run(&world, &camera, &params, monitor.job(), &mut |_| {})));
        build.push([exact, to_build]);
        trace.push([exact, to_render]);
        let peak = peak_memory().unwrap_or(0) as f64 / 1e6;
        table.row([
            format!("{exact}"),
            format!("{to_build:.3}"),
            format!("{to_render:.3}"),
            format!("{peak:.0}"),
            exponent(&trace),
        ]);
        if count == 10_000_000 {
            figure("peak.scene_10m_tris.mb", peak, "MB");
        }
    }
    table.print("triangles: the tessellated room, 160 x 120, 16 paths per pixel, 2 threads");
    let mut plot = Plot::new("time against triangles", "triangles", "seconds");
    plot.series.push(Series { name: "build".into(), points: build });
    plot.series.push(Series { name: "render".into(), points: trace });
    plot.write("scaling_triangles").expect("out/bench can be written to");
}

fn resolution(pool: &Pool) {
    let monitor = Monitor::default();
    let setting = scenes::demo_office().expect("the office is built in");
    let scene = Arc::new(setting.scene);
    let world = pool.run(|| World::build(scene, monitor.job())).expect("the office is valid");
    let mut table = Table::new(["pixels", "seconds", "ns per path", "peak MB", "exponent"]);
    let mut points = Vec::new();
    for width in [80, 320, 1280, 5120] {
        let (height, samples) = (width * 9 / 16, 4);
        let params = render::Params { width, height, samples, ..Default::default() };
        let (seconds, _) = time(Clock::Wall, || {
            pool.run(|| render::run(&world, &setting.camera, &params, monitor.job(), &mut |_| {}))
        });
        let pixels = (width * height) as f64;
        let per_path = seconds / pixels / f64::from(samples);
        points.push([pixels, per_path]);
        let peak = peak_memory().unwrap_or(0) as f64 / 1e6;
        table.row([
            format!("{pixels}"),
            format!("{seconds:.3}"),
            format!("{:.0}", per_path * 1e9),
            format!("{peak:.0}"),
            exponent(&points),
        ]);
    }
    table.print("resolution: the office, 4 paths per pixel, 2 threads");
}

/// Exponent of growth between the last two points.
fn exponent(points: &[[f64; 2]]) -> String {
    match points {
        [.., [x0, y0], [x1, y1]] => format!("{:.2}", (y1 / y0).ln() / (x1 / x0).ln()),
        _ => "-".into(),
    }
}
