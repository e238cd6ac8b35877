//! Benchmark of stylised sequences: six frames of the still life, in which the camera moves, the vase slides, or the
//! lamp moves. Arguments select sequences (`camera`, `object`, `light`); `most` paints with the final vote
//! `VoteMode::Majority` instead of the default.
//!
//! For each sequence, the bench prints these figures, and writes film strips to `out/bench/`:
//!
//! - `flicker`: the mean difference between a frame and the frame before, along the true motion, in levels of 255,
//!   where both frames show the point; of the sequence `object`, on the vase alone. `independent` is the figure for
//!   frames that are painted independently.
//! - `static`: `flicker` of a sequence whose motion takes objects for static, as motion from the cameras alone does.
//! - `uncovered`: on places that the vase has uncovered since the first frame, the difference to an independent frame,
//!   both averaged over 7 x 7 pixels, in levels; `two seeds` is the difference between two independent frames.
//! - `followed`: the share of the change of lightness since the first frame that the paint has followed after five
//!   frames. The change of the guides is the instrument of the regression, so that the randomness of paint cancels.

mod harness;

use glam::Vec3;
use harness::{Table, figure};
use luxfer::demo::{self, artwork};
use luxfer::exec::Pool;
use luxfer::guides::{self, Extras, Guides, Surfaces, motion, pairs};
use luxfer::image::Image;
use luxfer::image::colour::{linear_to_srgb, luminance};
use luxfer::image::io::encode_png;
use luxfer::job::Monitor;
use luxfer::patch::VoteMode;
use luxfer::render::World;
use luxfer::scene::Scene;
use luxfer::stylize::{self, Guide, Input, Output, Params, Range};
use std::path::Path;
use std::sync::Arc;

const WIDTH: usize = 240;
const HEIGHT: usize = 180;
const SAMPLES: u32 = 32;
const FRAMES: usize = 6;
/// Frame at which the share of the followed change is measured.
const FOLLOWED_AT: usize = 5;

struct Bench {
    pool: Pool,
    exemplar: Guides,
    artwork: Image,
    params: Params,
}

/// The frames of a sequence: guides, and the true motion since the frame before.
struct Frames {
    name: &'static str,
    guides: Vec<Guides>,
    motions: Vec<Image>,
}

fn main() {
    let mut chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let count = chosen.len();
    chosen.retain(|a| a != "most");
    let mut params = Params::default();
    if chosen.len() < count {
        params.final_vote = VoteMode::Majority;
    }
    let pool = Pool::new(2).expect("two threads");
    let exemplar = rendered(&pool, demo::sphere_on_table().expect("a scene"));
    let artwork = artwork::draw(artwork::Style::Paint, &exemplar).expect("an artwork");
    let bench = Bench { pool, exemplar, artwork, params };
    for (name, change) in SEQUENCES.iter().filter(|s| chosen.is_empty() || chosen.iter().any(|c| c == s.0)) {
        bench.measure(&Frames::new(name, *change, &bench.pool));
    }
}

/// Changes the still life for frame `t`.
type Change = fn(&mut Scene, f32);
const SEQUENCES: [(&str, Change); 3] = [
    ("camera", |scene, t| {
        let camera = &mut scene.cameras[0];
        camera.position += camera.forward.cross(camera.up) * 0.015 * t;
    }),
    ("object", |scene, t| shift(scene, "Vase", Vec3::X * -0.015 * t)),
    ("light", |scene, t| shift(scene, "Lamp", Vec3::X * -0.07 * t)),
];

fn shift(scene: &mut Scene, name: &str, by: Vec3) {
    let mesh = scene.meshes.iter_mut().find(|m| m.name == name).expect("an object of the still life");
    mesh.positions.iter_mut().for_each(|p| *p += by);
}

fn rendered(pool: &Pool, scene: Scene) -> Guides {
    let camera = scene.cameras[0].clone();
    let params = guides::Params { width: WIDTH, height: HEIGHT, samples: SAMPLES, ..guides::Params::default() };
    let monitor = Monitor::default();
    pool.run(|| {
        let world = World::build(Arc::new(scene), monitor.job())?;
        guides::run(&world, &camera, &params, monitor.job())
    })
    .expect("a valid scene")
}

impl Frames {
    fn new(name: &'static str, change: Change, pool: &Pool) -> Self {
        let frame = |t: usize| {
            let mut scene = demo::still_life().expect("a scene");
            change(&mut scene, t as f32);
            rendered(pool, scene)
        };
        let guides: Vec<Guides> = (0..FRAMES).map(frame).collect();
        let monitor = Monitor::default();
        let between = |pair: &[Guides]| {
            pool.run(|| motion(&pair[1].surfaces, &pair[0].surfaces, monitor.job())).expect("equal sizes").image
        };
        let motions = guides.windows(2).map(between).collect();
        Self { name, guides, motions }
    }

    /// Whether a pixel of frame `t` shows the vase.
    fn shows_vase(&self, t: usize, i: usize) -> bool {
        let surfaces = &self.guides[t].surfaces;
        surfaces.points[i].is_some_and(|p| surfaces.shapes[p.mesh as usize].name == "Vase")
    }

    /// The motion that takes all objects for static.
    fn static_motion(&self, t: usize, pool: &Pool) -> Image {
        let (now, before) = (&self.guides[t].surfaces, &self.guides[t - 1].surfaces);
        let still = Surfaces { camera: before.camera.clone(), ..(**now).clone() };
        let monitor = Monitor::default();
        let mut image = pool.run(|| motion(now, &still, monitor.job())).expect("equal sizes").image;
        // Mark points that the frame before does not show at a similar depth, as motion by depth alone does.
        for (i, p) in image.data.chunks_exact_mut(2).enumerate().filter(|(_, p)| p[0].is_finite()) {
            let (x, y) = ((i % WIDTH) as f32 + 0.5 + p[0], (i / WIDTH) as f32 + 0.5 + p[1]);
            let there = y as usize * WIDTH + x as usize;
            if depth(now, i) > 1.02 * depth(before, there) {
                p.fill(f32::NAN);
            }
        }
        image
    }
}

fn depth(surfaces: &Surfaces, i: usize) -> f32 {
    let camera = &surfaces.camera;
    let triangle = surfaces.points[i].and_then(|p| Some((p, surfaces.shapes[p.mesh as usize].triangle(&p)?)));
    triangle.map_or(f32::INFINITY, |(p, triangle)| (p.on(triangle) - camera.position).dot(camera.forward))
}

impl Bench {
    fn paint(&self, target: &Guides, seed: u64, before: Option<(&Output, &Image)>) -> Output {
        let pairs = pairs(&self.exemplar, target, Extras::default()).expect("guides");
        let guides: Vec<Guide> = pairs
            .iter()
            .map(|p| Guide { name: p.name, source: &p.source, target: &p.target, weight: 1.0, range: Range::Light })
            .collect();
        let input = Input {
            previous: before.map(|b| &b.0.field),
            guide_record: before.map(|b| &b.0.guide_record),
            motion: before.map(|b| b.1),
            ..Input::new(&self.artwork, &guides)
        };
        let params = Params { seed, ..self.params.clone() };
        let monitor = Monitor::default();
        self.pool.run(|| stylize::run(&input, &params, monitor.job())).expect("valid input")
    }

    /// Paints a sequence; `motion` gives the motion of each frame but the first.
    fn sequence(&self, frames: &Frames, motion: impl Fn(usize) -> Image) -> Vec<Image> {
        let mut last = self.paint(&frames.guides[0], 1, None);
        let mut pictures = vec![last.image.clone()];
        for t in 1..FRAMES {
            last = self.paint(&frames.guides[t], t as u64 + 1, Some((&last, &motion(t))));
            pictures.push(last.image.clone());
        }
        pictures
    }

    fn measure(&self, frames: &Frames) {
        let name = frames.name;
        let painted = self.sequence(frames, |t| frames.motions[t - 1].clone());
        let fresh = |t: usize, seed: u64| self.paint(&frames.guides[t], seed + t as u64, None).image;
        let independent: Vec<Image> =
            std::iter::once(painted[0].clone()).chain((1..FRAMES).map(|t| fresh(t, 101))).collect();
        let mut table = Table::new(["figure", "value"]);
        let mut show = |what: &str, value: f64, unit: &str| {
            table.row([what.to_string(), format!("{value:.2} {unit}")]);
            figure(&format!("sequences.{name}.{}", what.replace(' ', "_")), value, unit);
        };
        show("flicker", flicker(&painted, frames), "levels");
        show("independent", flicker(&independent, frames), "levels");
        match name {
            "object" => {
                let still = self.sequence(frames, |t| frames.static_motion(t, &self.pool));
                show("static", flicker(&still, frames), "levels");
                let second = fresh(FRAMES - 1, 201);
                let places = uncovered(frames);
                show("uncovered", apart(&painted[FRAMES - 1], &independent[FRAMES - 1], &places), "levels");
                show("uncovered two seeds", apart(&second, &independent[FRAMES - 1], &places), "levels");
                strip("sequence_static", &still);
            }
            "light" => show("followed", followed(&painted, &independent, frames), "of 1"),
            _ => (),
        }
        table.print(&format!("{name}: {FRAMES} frames of {WIDTH} x {HEIGHT}"));
        strip(&format!("sequence_{name}"), &painted);
        strip(&format!("sequence_{name}_independent"), &independent);
    }
}

/// A pixel's colour as on a screen, in levels of 255.
fn levels(image: &Image, x: usize, y: usize) -> [f64; 3] {
    [0, 1, 2].map(|c| 255.0 * f64::from(linear_to_srgb(image.pixel(x, y)[c])))
}

/// Bilinear value at a position in pixels.
fn sampled(encoded: &[[f64; 3]], x: f32, y: f32) -> [f64; 3] {
    let (x, y) = ((x - 0.5).clamp(0.0, WIDTH as f32 - 1.001), (y - 0.5).clamp(0.0, HEIGHT as f32 - 1.001));
    let (x0, y0, tx, ty) = (x as usize, y as usize, f64::from(x.fract()), f64::from(y.fract()));
    let at = |dx: usize, dy: usize| encoded[(y0 + dy) * WIDTH + x0 + dx];
    [0, 1, 2].map(|c| {
        let top = at(0, 0)[c] * (1.0 - tx) + at(1, 0)[c] * tx;
        let bottom = at(0, 1)[c] * (1.0 - tx) + at(1, 1)[c] * tx;
        top * (1.0 - ty) + bottom * ty
    })
}

fn flicker(pictures: &[Image], frames: &Frames) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for t in 1..pictures.len() {
        let before: Vec<[f64; 3]> =
            (0..WIDTH * HEIGHT).map(|i| levels(&pictures[t - 1], i % WIDTH, i / WIDTH)).collect();
        let counts = |i: usize| frames.name != "object" || frames.shows_vase(t, i);
        let motion = frames.motions[t - 1].data.chunks_exact(2).enumerate();
        for (i, p) in motion.filter(|(i, p)| p[0].is_finite() && counts(*i)) {
            let (x, y) = (i % WIDTH, i / WIDTH);
            let old = sampled(&before, x as f32 + 0.5 + p[0], y as f32 + 0.5 + p[1]);
            let new = levels(&pictures[t], x, y);
            sum += (0..3).map(|c| (new[c] - old[c]).abs()).sum::<f64>() / 3.0;
            count += 1.0;
        }
    }
    sum / count
}

/// The pixels that showed the vase in a frame, and show something else in the last frame.
fn uncovered(frames: &Frames) -> Vec<usize> {
    let was_vase = |i: &usize| (0..FRAMES - 1).any(|t| frames.shows_vase(t, *i));
    (0..WIDTH * HEIGHT).filter(|i| !frames.shows_vase(FRAMES - 1, *i)).filter(was_vase).collect()
}

/// Mean difference of two pictures, both averaged over 7 x 7 pixels.
fn apart(a: &Image, b: &Image, places: &[usize]) -> f64 {
    let mean = |image: &Image, i: usize| {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for y in y.saturating_sub(3)..(y + 4).min(HEIGHT) {
            for x in x.saturating_sub(3)..(x + 4).min(WIDTH) {
                let v = levels(image, x, y);
                (0..3).for_each(|c| sum[c] += v[c]);
                count += 1.0;
            }
        }
        sum.map(|v| v / count)
    };
    let differences = places.iter().map(|&i| {
        let (a, b) = (mean(a, i), mean(b, i));
        (0..3).map(|c| (a[c] - b[c]).abs()).sum::<f64>() / 3.0
    });
    differences.sum::<f64>() / places.len() as f64
}

fn followed(painted: &[Image], independent: &[Image], frames: &Frames) -> f64 {
    let exposure = guides::exposure(&frames.guides[0].light[0], &frames.guides[0].light[0]).expect("light");
    let lightness = |t: usize, i: usize| {
        let light = &frames.guides[t].light[0];
        f64::from(linear_to_srgb((luminance(light.rgb(i % WIDTH, i / WIDTH)) * exposure).min(1.0)))
    };
    let paint = |picture: &Image, i: usize| levels(picture, i % WIDTH, i / WIDTH).iter().sum::<f64>();
    let (mut ours, mut theirs) = (0.0, 0.0);
    for i in 0..WIDTH * HEIGHT {
        let change = lightness(FOLLOWED_AT, i) - lightness(0, i);
        ours += change * (paint(&painted[FOLLOWED_AT], i) - paint(&painted[0], i));
        theirs += change * (paint(&independent[FOLLOWED_AT], i) - paint(&painted[0], i));
    }
    ours / theirs
}

/// Writes the frames 0, 1, 3 and 5 side by side.
fn strip(name: &str, pictures: &[Image]) {
    let chosen = [0, 1, 3, FRAMES - 1];
    let image = Image::from_fn(WIDTH * chosen.len(), HEIGHT, |x, y| {
        let p = pictures[chosen[x / WIDTH]].pixel(x % WIDTH, y);
        [p[0], p[1], p[2]]
    })
    .expect("a small image");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("out/bench");
    std::fs::create_dir_all(&folder).expect("out/bench can be made");
    let png = encode_png(&image, 1.0).expect("three channels");
    std::fs::write(folder.join(name).with_extension("png"), png).expect("out/bench can be written");
    println!("picture out/bench/{name}.png");
}
