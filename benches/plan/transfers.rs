//! Plans the stages of relighting and rendering of whole transfers, and compares the predictions with the runs.

use super::harness::{Clock, scenes, time};
use super::outcomes::{Outcomes, error_of, mean};
use super::photos::{self, Photo};
use super::{Table, columns};
use luxfer::demo;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::plan::{self, Goal};
use luxfer::scene::Scene;
use luxfer::transfer::{Params, Results, Stage, Transfer};
use std::sync::Arc;

/// Ratio of the half-width of a 95 % confidence interval to the standard error.
const HALF_WIDTH: f64 = 2.04;

pub fn measure(all: &mut Outcomes) {
    let mut photos = photos::office(&[[480, 320]]);
    for (name, reduce) in [("yud_009", 1), ("alma_glassroom", 2)] {
        match photos::real(name, reduce) {
            Ok(photo) => photos.push(photo),
            Err(reason) => println!("# a photo is absent: {reason}"),
        }
    }
    let rooms = rooms();
    let heads = [
        "photo",
        "room",
        "goal",
        "s expected",
        "s",
        "ratio",
        "solution expected",
        "stated",
        "ratio",
        "error expected",
        "error",
        "ratio",
    ];
    let mut table = Table::new(heads);
    for (i, photo) in photos.iter().enumerate() {
        for (k, (room, scene)) in rooms.iter().enumerate() {
            // Combine every photo with every room; goals and sizes alternate.
            let width = [96, 144, 208][(i + k) % 3];
            let goal = [Goal::Seconds(1.5), Goal::Error(0.2), Goal::Seconds(3.0), Goal::Error(0.1)][(i + 2 * k) % 4];
            if let Err(reason) = outcome(photo, (room, scene), width, goal, all, &mut table) {
                println!("# {} in {room}: {reason}", photo.name);
            }
        }
    }
    table.print("the light of transfers: one thread, its own time");
}

/// The rooms to light: the demonstration room, the demonstration room at twice its length, and a kitchen without its
/// lamp.
fn rooms() -> Vec<(&'static str, Arc<Scene>)> {
    let room = demo::target_room().expect("a room");
    let mut hall = room.clone();
    for mesh in &mut hall.meshes {
        mesh.positions.iter_mut().for_each(|p| p.x *= 2.0);
        mesh.normals.clear();
    }
    hall.cameras[0].position.x *= 2.0;
    let mut rooms = vec![("room", Arc::new(room)), ("hall", Arc::new(hall))];
    match scenes::kitchen() {
        Ok(setting) => {
            let mut scene = setting.scene;
            scene.meshes.pop();
            scene.cameras = vec![setting.camera];
            rooms.push(("kitchen", Arc::new(scene)));
        }
        Err(reason) => println!("# a room is absent: {reason}"),
    }
    rooms
}

fn outcome(
    photo: &Photo,
    (room, scene): (&str, &Arc<Scene>),
    width: usize,
    goal: Goal,
    all: &mut Outcomes,
    table: &mut Table,
) -> Result<(), String> {
    let monitor = Monitor::default();
    let input = scenes::transfer_input(photo.image.clone(), photo.strokes.clone(), scene.clone());
    let mut transfer = Transfer { input, params: Params::default(), ..Transfer::default() };
    (transfer.params.render.width, transfer.params.render.height) = (width, width * 9 / 16);
    transfer.run(Stage::View, Stage::Emission, monitor.job(), |_| ()).map_err(|e| e.to_string())?;
    let plan = plan::lighting(&transfer, goal, &|| Clock::Thread.now(), monitor.job()).map_err(|e| e.to_string())?;

    transfer.params.relight = luxfer::relight::Params { time_budget_ms: 0, ..plan.relight.clone() };
    transfer.params.render = luxfer::render::Params { time_budget_ms: 0, ..plan.render.clone() };
    let (mut films, mut seconds, mut square): (Vec<Image>, _, _) = (Vec::new(), 0.0, 0.0);
    for seed in 0..4 {
        transfer.params.relight.seed = 11 + seed;
        transfer.params.render.seed = 21 + seed;
        // Solve several times, because the error that one solution states is itself uncertain by 13 %.
        seconds += run(&mut transfer, Stage::Relight)? / 4.0;
        square += transfer.results.solution.as_ref().map_or(f64::NAN, |s| s.error()).powi(2) / 4.0;
        if seed < 2 {
            seconds += run(&mut transfer, Stage::Render)? / 2.0;
            films.push(unit(&transfer.results));
        }
    }
    let squares = films[0].data.iter().map(|&v| f64::from(v).powi(2)).sum::<f64>() / films[0].data.len() as f64;
    let contrast = squares.sqrt() / mean(&films[0]);
    let error = error_of(&films[0], &films[1]).hypot(square.sqrt() / HALF_WIDTH * contrast);
    all.times.push(seconds / plan.whole.seconds);
    all.errors.push(error / plan.whole.error);
    let head = [photo.name.clone(), room.to_string(), format!("{goal:?} {width}")];
    let times = columns([plan.whole.seconds, seconds]);
    let cells = [times, columns([plan.solving.error, square.sqrt()]), columns([plan.whole.error, error])].concat();
    table.row(head.into_iter().chain(cells));
    Ok(())
}

/// Runs one stage of a transfer; returns its seconds.
fn run(transfer: &mut Transfer, stage: Stage) -> Result<f64, String> {
    let (seconds, result) = time(Clock::Thread, || transfer.run(stage, stage, Monitor::default().job(), |_| ()));
    result.map_err(|e| e.to_string())?;
    Ok(seconds)
}

/// The rendered picture with each channel divided by the solved scale of the emission. The difference of two such
/// pictures is the error of their paths alone, without the error of the solution.
fn unit(results: &Results) -> Image {
    let (film, solution) = (results.film.as_ref().expect("a film"), results.solution.as_ref().expect("a solution"));
    let mut image = film.beauty.clone();
    for pixel in image.data.chunks_exact_mut(3) {
        pixel.iter_mut().zip(solution.scale.to_array()).for_each(|(v, s)| *v /= s as f32);
    }
    image
}
