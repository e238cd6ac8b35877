//! Half-painted pictures of which the library paints the rest. The demonstration's artists have painted the whole
//! picture, so the right answer is known.
//!
//! - `step`: the mean difference of neighbouring pixels on both sides of the border of the painted part, over that of
//!   neighbouring pixels a few pixels beside the border. Paint that joins has 1, as the whole picture of the artist.
//! - `most_used`: uses of the exemplar patch that is used most often, over those in an ordinary run, in which the ball
//!   is the exemplar of the still life.
//! - `tone`: mean CIEDE2000 difference to the artist's picture in the completed part, both averaged over 13 x 13
//!   pixels. It is large where the painted part lacks the light of the rest.

use super::demonstration::{Lights, SIZE, STYLES, guides_of};
use super::save;
use crate::harness::{Table, figure};
use glam::Vec3;
use luxfer::demo::artwork::draw;
use luxfer::demo::{sphere_on_table, still_life};
use luxfer::exec::Pool;
use luxfer::guides::Guides;
use luxfer::image::Image;
use luxfer::image::colour::{delta_e_2000, linear_to_lab, linear_to_srgb};
use luxfer::job::Monitor;
use luxfer::stylize::{Input, Output, Params, run};

/// A split: its name, and whether the artist has painted a place, given in shares of width and height.
type Split = (&'static str, fn(f32, f32) -> bool);
const SPLITS: [Split; 4] = [
    ("left", |x, _| x < 0.5),
    ("right", |x, _| x >= 0.5),
    ("diagonal", |x, y| x + 0.4 * y < 0.75),
    ("all but a disc", |x, y| (x - 0.55).powi(2) + 0.58 * (y - 0.6).powi(2) > 0.04),
];

/// Distances in pixels from the border at which neighbours count as beside it.
const BESIDE: std::ops::RangeInclusive<isize> = 3..=7;
/// Half the width of the windows over which tones are averaged.
const WINDOW: isize = 6;

pub fn measure(pool: &Pool) {
    let [ball, still] = [sphere_on_table(), still_life()].map(|scene| guides_of(pool, scene.expect("a scene")));
    let head = ["scene", "style", "painted", "picture", "at border", "beside", "step", "tone", "most used", "share"];
    let mut table = Table::new(head);
    let [mut steps, mut tones, mut uses] = [Vec::new(), Vec::new(), Vec::new()];
    for (style_name, style) in STYLES {
        let ordinary = paint(pool, &draw(style, &ball).expect("an artwork"), &ball, &still, None);
        let usual = f64::from(ordinary.report.usage.max_uses);
        for (scene_name, guides) in [("ball", &ball), ("still life", &still)] {
            let whole = draw(style, guides).expect("an artwork");
            for (split_name, split) in SPLITS {
                let painted = mask(split);
                let row = |name: &str, picture: &Image, used: Option<f64>| {
                    let judged = Judged::of(picture, &whole, &painted);
                    let name = [scene_name, style_name, split_name, name].map(String::from).to_vec();
                    (judged.step(), judged.tone, [name, judged.cells(), uses_cells(used, usual)].concat())
                };
                table.row(row("perfect", &whole, None).2);
                let output = paint(pool, &whole, guides, guides, Some(&painted));
                let used = f64::from(output.report.usage.max_uses);
                let (step, tone, cells) = row("completed", &output.image, Some(used));
                table.row(cells);
                steps.push(step);
                tones.push(tone);
                uses.push(used / usual);
                save(&format!("autocomplete_{style_name}_{scene_name}_{split_name}").replace(' ', "_"), &output.image);
            }
        }
        println!("# {style_name}: an ordinary run uses a patch at most {usual} times");
    }
    table.print("half-painted pictures, 600 x 456");
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    figure("stylit.autocomplete.step", mean(&steps), "x");
    figure("stylit.autocomplete.step.worst", steps.iter().fold(0.0, |a, b| a.max(*b)), "x");
    figure("stylit.autocomplete.most_used", uses.iter().fold(0.0, |a, b| a.max(*b)), "x");
    figure("stylit.autocomplete.tone", mean(&tones), "dE2000");
}

fn uses_cells(used: Option<f64>, usual: f64) -> Vec<String> {
    used.map_or(vec!["-".to_string(); 2], |used| vec![format!("{used:.0}"), format!("{:.1}", used / usual)])
}

/// One channel, 1 where the artist has painted.
fn mask(split: fn(f32, f32) -> bool) -> Image {
    let [width, height] = SIZE;
    let share = |v: usize, n: usize| (v as f32 + 0.5) / n as f32;
    Image::from_fn(width, height, |x, y| [f32::from(split(share(x, width), share(y, height)))]).expect("a small size")
}

/// Paints the target from an artwork; with a mask, the part of the artwork outside it.
fn paint(pool: &Pool, artwork: &Image, source: &Guides, target: &Guides, painted: Option<&Image>) -> Output {
    let lights = Lights::new(source, target);
    let guides = lights.guides();
    let opposite = painted.map(|mask| {
        let mut opposite = mask.clone();
        opposite.data.iter_mut().for_each(|v| *v = 1.0 - *v);
        opposite
    });
    let known = painted.map(|_| artwork);
    let input = Input { source_mask: painted, target_mask: opposite.as_ref(), known, ..Input::new(artwork, &guides) };
    pool.run(|| run(&input, &Params::default(), Monitor::default().job())).expect("valid input")
}

struct Judged {
    /// Mean difference of neighbouring pixels across the border and beside it, in levels of 255.
    across: f64,
    beside: f64,
    tone: f64,
}

impl Judged {
    fn of(picture: &Image, truth: &Image, painted: &Image) -> Self {
        let [across, beside] = differences(picture, painted);
        Self { across, beside, tone: tone(picture, truth, painted) }
    }

    fn step(&self) -> f64 {
        self.across / self.beside
    }

    fn cells(&self) -> Vec<String> {
        let levels = [self.across, self.beside].map(|v| format!("{v:.1}"));
        levels.into_iter().chain([format!("{:.2}", self.step()), format!("{:.2}", self.tone)]).collect()
    }
}

/// Mean differences of neighbouring pixels across the border and beside it.
fn differences(picture: &Image, painted: &Image) -> [f64; 2] {
    let (width, height) = (picture.width as isize, picture.height as isize);
    let inside = |[x, y]: [isize; 2]| (0..width).contains(&x) && (0..height).contains(&y);
    let is_painted = |[x, y]: [isize; 2]| painted.pixel(x as usize, y as usize)[0] > 0.5;
    let colour = |[x, y]: [isize; 2]| picture.rgb(x as usize, y as usize).map(|v| 255.0 * linear_to_srgb(v));
    let step = |a: [isize; 2], b: [isize; 2]| f64::from((colour(a) - colour(b)).abs().element_sum()) / 3.0;
    let [mut across, mut beside] = [(0.0, 0.0); 2];
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        for [dx, dy] in [[1, 0], [0, 1]] {
            let pair = |k: isize| ([x + k * dx, y + k * dy], [x + (k + 1) * dx, y + (k + 1) * dy]);
            let (a, b) = pair(0);
            if !inside(b) || is_painted(a) == is_painted(b) {
                continue;
            }
            across = (across.0 + step(a, b), across.1 + 1.0);
            for (c, d) in BESIDE.flat_map(|k| [pair(k), pair(-k)]).filter(|(c, d)| inside(*c) && inside(*d)) {
                beside = (beside.0 + step(c, d), beside.1 + 1.0);
            }
        }
    }
    [across, beside].map(|(sum, count)| sum / count)
}

/// Mean difference of local means in the completed part.
fn tone(picture: &Image, truth: &Image, painted: &Image) -> f64 {
    let [a, b] = [picture, truth].map(smoothed);
    let completed = (0..painted.data.len()).filter(|&i| painted.data[i] <= 0.5);
    let lab = |image: &[Vec3], i: usize| linear_to_lab(image[i]);
    let (sum, count) = completed.fold((0.0, 0.0), |(s, n), i| (s + delta_e_2000(lab(&a, i), lab(&b, i)), n + 1.0));
    sum / count
}

/// Means over windows, in linear colour.
pub fn smoothed(image: &Image) -> Vec<Vec3> {
    let (width, height) = (image.width as isize, image.height as isize);
    let pass = |values: Vec<Vec3>, [dx, dy]: [isize; 2]| -> Vec<Vec3> {
        let at = |x: isize, y: isize| values[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize];
        let mean = |i: isize| {
            let sum: Vec3 = (-WINDOW..=WINDOW).map(|k| at(i % width + k * dx, i / width + k * dy)).sum();
            sum / (2 * WINDOW + 1) as f32
        };
        (0..width * height).map(mean).collect()
    };
    let pixels = image.data.chunks_exact(3).map(Vec3::from_slice).collect();
    pass(pass(pixels, [1, 0]), [0, 1])
}
