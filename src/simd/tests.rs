//! Tests that the library's pipelines give equal results at every level that the processor supports.

use super::{Level, forced};
use crate::demo::{self, photo};
use crate::exec::Pool;
use crate::job::Monitor;
use crate::transfer::{Input, Results, STAGES, Stage, Transfer};
use std::sync::Arc;

widest! {
    fn scaled_sum(values: &[f32], factor: f32) -> f32 {
        values.iter().map(|v| v * factor).sum()
    }
}

/// Asserts that `work` gives identical results at every SIMD level. `work` returns pairs: the name of a result, and a
/// text that encodes every bit of it.
fn same_at_all_levels(work: impl Fn() -> Vec<(String, String)>) {
    let mut levels = forced::levels();
    let lowest = forced::at(levels.next().unwrap(), &work);
    for level in levels {
        for ((name, text), (_, expected)) in forced::at(level, &work).iter().zip(&lowest) {
            let differs = text.bytes().zip(expected.bytes()).position(|(a, b)| a != b);
            let around =
                |text: &str| text.chars().skip(differs.unwrap_or(0).saturating_sub(40)).take(80).collect::<String>();
            assert!(text == expected, "{name} at {level:?}: {} instead of {}", around(text), around(expected));
        }
    }
}

#[test]
fn a_level_can_be_forced_and_ends_with_the_work() {
    for level in forced::levels() {
        assert_eq!(forced::at(level, Level::widest), level);
        assert!(std::panic::catch_unwind(|| forced::at(level, || -> () { panic!("on purpose") })).is_err());
    }
    let widest = forced::levels().last().unwrap();
    assert_eq!(forced::at(widest, Level::widest), Level::of_processor());
    let values: Vec<f32> = (0..1000).map(|i| (i as f32).sin()).collect();
    same_at_all_levels(|| vec![("sum".into(), scaled_sum(&values, 0.1).to_string())]);
}

/// Renders a small photo of the demonstration's office. Returns the input of a lighting transfer from this photo to
/// the demonstration's room, and the height of the ceiling above the camera in metres.
fn input(pool: &Pool) -> (Input, f64) {
    let office = demo::exemplar_room().unwrap();
    let camera = office.scene.cameras[office.camera].clone();
    let size = photo::Params { width: 360, height: 240, samples: 8, seed: 3 };
    let scene = Arc::new(office.scene.clone());
    let (photo, _) = pool.run(|| photo::photograph(scene, &camera, &size, Monitor::default().job())).unwrap();
    let input = Input {
        photo: Some(Arc::new(photo)),
        strokes: demo::strokes(&office, size.width, size.height).unwrap(),
        scene: Some(Arc::new(demo::target_room().unwrap())),
        surface: "Ceiling".into(),
        ..Input::default()
    };
    (input, f64::from(office.ceiling_height - camera.position.y))
}

/// Runs all stages of the lighting transfer, each on the results of the previous stages. Every stage must give the same
/// results at every SIMD level.
#[test]
fn the_lighting_transfer_is_the_same_to_the_bit_at_every_level() {
    let pool = Pool::new(2).unwrap();
    let (input, plane_distance) = input(&pool);
    same_at_all_levels(|| {
        let mut transfer = Transfer { input: input.clone(), ..Transfer::default() };
        transfer.params.plane_distance = plane_distance;
        transfer.params.max_texels = 512;
        (transfer.params.relight.target_error, transfer.params.relight.paths) = (0.0, 1 << 12);
        let render = &mut transfer.params.render;
        (render.width, render.height, render.samples) = (32, 18, 8);
        pool.run(|| transfer.run(Stage::View, Stage::Render, Monitor::default().job(), |_| {})).unwrap();
        let Results { view, features, plane, lights, unwarped, emission, lit, target, solution, film, .. } =
            transfer.results;
        let made = [
            format!("{view:?}"),
            format!("{features:?}"),
            format!("{plane:?}"),
            format!("{lights:?}"),
            format!("{unwarped:?}"),
            format!("{emission:?}"),
            format!("{:?}", (target, solution)),
            format!("{:?}", (lit, film)),
        ];
        STAGES.iter().zip(made).map(|(stage, text)| (format!("{stage:?}"), text)).collect()
    });
}

#[cfg(feature = "stylize")]
#[test]
fn a_stylisation_is_the_same_to_the_bit_at_every_level() {
    use crate::image::Image;
    use crate::stylize::{Finder, Guide, Input, Params, Range, run};
    let ball = |size: usize, radius: f32| {
        let light = move |x: usize, y: usize| {
            let [dx, dy] = [x, y].map(|v| (v as f32 - 0.5 * size as f32) / radius);
            let up = (1.0 - dx * dx - dy * dy).max(0.0).sqrt();
            [(0.6 * up - 0.5 * dx - 0.6 * dy).clamp(0.05, 1.0), up, 0.3]
        };
        Image::from_fn(size, size, light).unwrap()
    };
    let (a, b) = (ball(56, 20.0), ball(72, 30.0));
    let artwork = Image::from_fn(a.width, a.height, |x, y| {
        let light = a.pixel(x, y)[0];
        [light, 0.7 * light + 0.02 * ((x + 2 * y) % 7) as f32, 0.4 + 0.03 * ((2 * x + 5 * y) % 9) as f32]
    })
    .unwrap();
    let pool = Pool::new(2).unwrap();
    same_at_all_levels(|| {
        let stylised = |finder| {
            let guides = [Guide { name: "light", source: &a, target: &b, weight: 1.0, range: Range::Light }];
            let params = Params { finder, levels: 2, iterations: 2, ..Params::default() };
            let output = run(&Input::new(&artwork, &guides), &params, Monitor::default().job()).unwrap();
            (format!("{finder:?}"), format!("{:?}", (output.image, output.field)))
        };
        pool.run(|| [Finder::PatchMatch, Finder::KdTree].map(stylised).to_vec())
    });
}
