//! Direction of strokes, on pictures whose strokes a program has drawn: the same program draws the target too, so the
//! right picture is known. Besides the demonstration's artists, there are pictures of streaks along a known field of
//! directions.
//!
//! - `angle`, `beyond_30`: median angle between the orientations (structure tensor) of picture and truth, in degrees,
//!   and share of the pixels with more than 30 degrees. They count the pixels of objects at which the truth is
//!   oriented, without those near silhouettes, because an artist draws silhouettes as lines. The truth itself has 0.
//!   Another drawing of the target by the same program, with its strokes at other places, shows what a picture can
//!   reach.
//! - `tone`: mean CIEDE2000 difference of the means over 13 x 13 pixels, on objects.
//!
//! Each picture is made by the guides of light alone, with the normals as one more guide, and as the library decides.
//! A decision is wrong if the normals would lower the median angle by more than [`GAIN`] but are off, or if they are on
//! without such a gain.
//!
//! There is no second picture of the drawn styles in the test data. There, strips of the artwork are painted anew from
//! the rest of it, and compared with the artist's own paint. The normals are computed from the outline of the ball.

use super::autocomplete::smoothed;
use super::demonstration::{SIZE, STYLES, guides_of, objects};
use super::fidelity::Orientation;
use super::{GUIDES, save};
use crate::harness::scenes::data;
use crate::harness::{Table, absent, figure, median};
use glam::{Vec2, Vec3};
use luxfer::demo::artwork::draw;
use luxfer::demo::{sphere_on_table, still_life};
use luxfer::exec::Pool;
use luxfer::guides::{Extras, Guides, Pair, pairs};
use luxfer::image::Image;
use luxfer::image::colour::{delta_e_2000, linear_to_lab, linear_to_srgb, luminance, srgb_to_linear};
use luxfer::image::io::{Encoding, load};
use luxfer::image::pyramid::resize;
use luxfer::job::Monitor;
use luxfer::rng::Rng;
use luxfer::stylize::{Directions, Guide, Input, NORMALS_WEIGHT, Output, Params, Range, directions, run};

/// A pixel of the truth is oriented if its coherence is at least this.
const ORIENTED: f64 = 0.5;
/// Minimum share of the pixels that must be oriented; without strokes, there is nothing to judge.
const MIN_SHARE: f64 = 0.05;
/// Width in pixels of the strip along silhouettes that does not count.
const STRIP: isize = 6;

/// Gain in degrees that the normals must bring.
const GAIN: f64 = 0.5;
/// Columns by which the guides of another drawing are wider, so that its strokes lie at other places.
const WIDER: usize = 8;

/// A direction of streaks: from the normal in camera axes, on an object or not, and the lightness of the direct light.
/// `None` makes grain without a direction.
type Field = fn(Vec3, bool, f32) -> Option<Vec2>;
const STREAKS: [(&str, Field); 4] = [
    ("rays", |n, object, _| Some(if object { Vec2::new(n.x, -n.y) } else { Vec2::new(0.9, 0.3) })),
    ("slanted", |_, _, _| Some(Vec2::new(0.7, -0.7))),
    ("by light", |_, _, lit| Some(Vec2::from_angle(2.5 * lit))),
    ("grain", |_, _, _| None),
];

/// What one program has drawn: the exemplar, the target, and the target once more.
struct Drawn {
    name: &'static str,
    artwork: Image,
    truth: Image,
    another: Image,
}

pub fn measure(pool: &Pool) {
    let [ball, still] = [sphere_on_table(), still_life()].map(|scene| guides_of(pool, scene.expect("a scene")));
    let head = ["exemplar", "artist", "picture", "angle", "beyond 30 %", "tone", "spread", "by light", "by normals"];
    let (mut table, mut wrong) = (Table::new(head), 0);
    for (scene, source, target) in [("ball", &ball, &still), ("still life", &still, &ball)] {
        let objects = objects(target);
        let inner = inside(&objects, target.normals.width as isize);
        let guides = pairs(source, target, Extras { normals: true, ..Extras::default() }).expect("guides of one kind");
        for drawn in drawn(source, target) {
            let judge = Judge { truth: &drawn.truth, objects: &objects, inner: &inner };
            let mut row = |picture: &str, judged: [f64; 3], found: Option<Directions>| {
                let found = found.map_or(["-"; 3].map(String::from), |d| {
                    [d.spread, d.by_light, d.by_normals].map(|angle| format!("{angle:.1}"))
                });
                table.row(
                    [vec![scene.into(), drawn.name.into(), picture.into()], cells(judged), found.to_vec()].concat(),
                );
                judged
            };
            save(&format!("directions_{scene}_{}_truth", drawn.name).replace(' ', "_"), &drawn.truth);
            row("perfect", judge.figures(&drawn.truth), None);
            row("another", judge.figures(&drawn.another), None);
            let alone = row("light", judge.figures(&paint(pool, &drawn.artwork, &guides, Normals::Off).image), None);
            let decided = paint(pool, &drawn.artwork, &guides, Normals::Decide);
            let on = decided.report.normals_weight > 0.0;
            save(&format!("directions_{scene}_{}", drawn.name).replace(' ', "_"), &decided.image);
            let decided = judge.figures(&decided.image);
            let name = if on { "decided: on" } else { "decided: off" };
            row(name, decided, Some(found(pool, &drawn.artwork, &guides)));
            let with = if on {
                decided
            } else {
                row("with normals", judge.figures(&paint(pool, &drawn.artwork, &guides, Normals::On).image), None)
            };
            wrong += usize::from(on != (alone[0] - with[0] > GAIN));
            if scene == "ball" && ["pen", "paint"].contains(&drawn.name) {
                for (name, values) in [("light", alone), ("decided", decided)] {
                    headline(&format!("stylit.directions.{}.{name}", drawn.name.replace(' ', "_")), values);
                }
            }
        }
    }
    table.print("direction of strokes, 600 x 456");
    figure("stylit.directions.wrong", wrong as f64, "sets");
    strips(pool);
}

fn headline(name: &str, [angle, beyond, tone]: [f64; 3]) {
    figure(&format!("{name}.angle"), angle, "degrees");
    figure(&format!("{name}.beyond_30"), beyond, "%");
    figure(&format!("{name}.tone"), tone, "dE2000");
}

fn cells([angle, beyond, tone]: [f64; 3]) -> Vec<String> {
    vec![format!("{angle:.1}"), format!("{beyond:.1}"), format!("{tone:.2}")]
}

fn drawn(source: &Guides, target: &Guides) -> Vec<Drawn> {
    let wider = wider(target);
    let narrow = |image: Image| {
        let width = target.normals.width;
        Image::from_fn(width, image.height, |x, y| image.rgb(x, y).to_array()).expect("the size of the target")
    };
    let scenes = [source, target, &wider];
    let draws = STYLES.into_iter().map(|(name, style)| (name, scenes.map(|g| draw(style, g).expect("an artwork"))));
    let streaks = STREAKS.into_iter().map(|(name, field)| (name, scenes.map(|g| streaked(g, field))));
    let all = draws.chain(streaks);
    all.map(|(name, [artwork, truth, another])| Drawn { name, artwork, truth, another: narrow(another) }).collect()
}

/// The guides with more columns at the right, which repeat the last one.
fn wider(guides: &Guides) -> Guides {
    let wider = |image: &Image| {
        let mut out = Image::new(image.width + WIDER, image.height, image.channels).expect("a small size");
        for y in 0..out.height {
            (0..out.width).for_each(|x| out.pixel_mut(x, y).copy_from_slice(image.pixel(x.min(image.width - 1), y)));
        }
        out
    };
    let Guides { light, normals, edges, materials, surfaces } = guides;
    let light = light.each_ref().map(wider);
    let surfaces = surfaces.clone();
    Guides { light, normals: wider(normals), edges: wider(edges), materials: wider(materials), surfaces }
}

#[derive(Clone, Copy, PartialEq)]
enum Normals {
    Off,
    On,
    Decide,
}

fn guides_of_pairs(pairs: &[Pair]) -> (Vec<Guide<'_>>, Guide<'_>) {
    let guide = |p| {
        let Pair { name, source, target, is_light, .. }: &Pair = p;
        let (weight, range) = if *is_light { (1.0, Range::Light) } else { (NORMALS_WEIGHT, Range::Data) };
        Guide { name, source, target, weight, range }
    };
    let (lights, others): (Vec<Guide>, Vec<Guide>) = pairs.iter().map(guide).partition(|g| g.range == Range::Light);
    (lights, others[0])
}

fn paint(pool: &Pool, artwork: &Image, pairs: &[Pair], choice: Normals) -> Output {
    let (mut guides, normals) = guides_of_pairs(pairs);
    if choice == Normals::On {
        guides.push(normals);
    }
    let normals = (choice == Normals::Decide).then_some(normals);
    let input = Input { normals, ..Input::new(artwork, &guides) };
    pool.run(|| run(&input, &Params::default(), Monitor::default().job())).expect("valid input")
}

/// The directions on which the decision rests.
fn found(pool: &Pool, artwork: &Image, pairs: &[Pair]) -> Directions {
    let (guides, normals) = guides_of_pairs(pairs);
    let input = Input::new(artwork, &guides);
    pool.run(|| directions(&input, &normals, None, Monitor::default().job())).expect("valid input")
}

struct Judge<'a> {
    truth: &'a Image,
    /// Pixels of objects, and those that are not near a silhouette.
    objects: &'a [bool],
    inner: &'a [bool],
}

impl Judge<'_> {
    /// Median angle, share beyond 30 degrees in per cent, and tone.
    fn figures(&self, picture: &Image) -> [f64; 3] {
        let [own, right] = [picture, self.truth].map(Orientation::of);
        let oriented = (0..self.inner.len()).filter(|&i| self.inner[i] && right.coherence[i] >= ORIENTED);
        let errors: Vec<f64> = oriented.map(|i| own.error(&right, i)).collect();
        let counted = self.inner.iter().filter(|inner| **inner).count() as f64;
        let share = |count: usize| if errors.len() as f64 >= MIN_SHARE * counted { count as f64 } else { f64::NAN };
        let beyond = share(errors.iter().filter(|e| **e > 30.0).count()) / errors.len() as f64;
        let angle = if beyond.is_nan() { f64::NAN } else { median(&errors) };
        let [a, b] = [picture, self.truth].map(smoothed);
        let shown = (0..self.objects.len()).filter(|&i| self.objects[i]);
        let tones: Vec<f64> = shown.map(|i| delta_e_2000(linear_to_lab(a[i]), linear_to_lab(b[i]))).collect();
        [angle, 100.0 * beyond, tones.iter().sum::<f64>() / tones.len() as f64]
    }
}

/// The pixels of a mask that are farther than [`STRIP`] from its border.
fn inside(mask: &[bool], width: isize) -> Vec<bool> {
    let height = mask.len() as isize / width;
    let pass = |mask: &[bool], [dx, dy]: [isize; 2]| -> Vec<bool> {
        let at = |x: isize, y: isize| mask[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize];
        let all = |i: isize| (-STRIP..=STRIP).all(|k| at(i % width + k * dx, i / width + k * dy));
        (0..width * height).map(all).collect()
    };
    pass(&pass(mask, [1, 0]), [0, 1])
}

/// Paints the light of a scene with streaks: white noise, smeared along a field of directions (line integral
/// convolution, Cabral and Leedom 1993).
fn streaked(guides: &Guides, field: Field) -> Image {
    const HALF: i32 = 12;
    let [full, direct, ..] = &guides.light;
    let exposure = luxfer::guides::exposure(full, full).expect("light");
    let (width, height) = (full.width, full.height);
    let materials = &guides.materials;
    let object: Vec<bool> =
        (0..width * height).map(|i| materials.pixel(i % width, i / width) != materials.pixel(0, 0)).collect();
    let shown = |image: &Image, i: usize| {
        linear_to_srgb((luminance(image.rgb(i % width, i / width)) * exposure).clamp(0.0, 1.0))
    };
    let along: Vec<Option<Vec2>> = (0..width * height)
        .map(|i| {
            let normal = Vec3::from_slice(guides.normals.pixel(i % width, i / width));
            field(normal, object[i], shown(direct, i)).map(|d| d.normalize_or(Vec2::X))
        })
        .collect();
    let clamp = |v: f32, n: usize| (v.max(0.0) as usize).min(n - 1);
    let index = |at: Vec2| clamp(at.y, height) * width + clamp(at.x, width);
    let noise = |i: usize| Rng::new(77, &[i as u64]).next_f32() - 0.5;
    let grain = |x: usize, y: usize| {
        let start = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        if along[index(start)].is_none() {
            return 1.6 * noise(index(start));
        }
        let (mut sum, mut count) = (noise(index(start)), 1.0f32);
        for way in [1.0, -1.0] {
            let (mut at, mut heading) = (start, along[index(start)].unwrap_or(Vec2::X) * way);
            for _ in 0..HALF {
                at += heading;
                let next = along[index(at)].unwrap_or(heading);
                heading = if next.dot(heading) < 0.0 { -next } else { next };
                (sum, count) = (sum + noise(index(at)), count + 1.0);
            }
        }
        1.6 * sum / count.sqrt()
    };
    let pixel = |x: usize, y: usize| {
        let i = y * width + x;
        let tone = (shown(full, i) * (1.0 + 0.35 * grain(x, y))).clamp(0.0, 1.0);
        let paint = if object[i] { Vec3::new(0.9, 0.55, 0.35) } else { Vec3::new(0.95, 0.92, 0.8) };
        (paint * tone).map(srgb_to_linear).to_array()
    };
    Image::from_fn(width, height, pixel).expect("the size of the light")
}

/// Artworks of the ball in the test data: name, and path.
const HAND_DRAWN: [(&str, &str); 6] = [
    ("crayon", "stylit/ebsynth_stylit/source_style.png"),
    ("crayon with pasted rectangles", "stylit/dcharata_extra_styles/source_style_1.png"),
    ("smooth", "stylit/dcharata_extra_styles/source_style_2.png"),
    ("charcoal", "stylit/dcharata_extra_styles/source_style_3.png"),
    ("charcoal, photographed", "stylit/dcharata_extra_styles/source_style_4.png"),
    ("brush", "stylit/dcharata_extra_styles/source_style_5.png"),
];
/// Centre and radius in pixels of their ball at the size of the demonstration's pictures, and the rows at which the
/// wall ends at the left and at the right border.
const CENTRE: Vec2 = Vec2::new(304.0, 247.5);
const RADIUS: f32 = 121.0;
const WALL: [f32; 2] = [253.5, 201.5];
/// Period and width in pixels of the strips that are painted anew.
const STRIPS: [usize; 2] = [72, 28];

/// Paints strips of the hand-drawn artworks anew, by the light alone and with the normals.
fn strips(pool: &Pool) {
    let read = |path: String| -> Result<Image, String> {
        let image = load(&data(&path)?, Encoding::Srgb).and_then(|i| i.to_rgb()).map_err(|e| e.to_string())?;
        resize(&image, SIZE[0], SIZE[1], Monitor::default().job()).map_err(|e| e.to_string())
    };
    let lights: Result<Vec<Image>, String> =
        GUIDES.iter().map(|name| read(format!("stylit/ebsynth_stylit/source_{name}.png"))).collect();
    let lights = match lights {
        Ok(lights) => lights,
        Err(reason) => return absent("stylit.directions.strips", &reason),
    };
    let normals = ball_normals();
    let pair = |name, image: &Image, is_light| Pair {
        name,
        source: image.clone(),
        target: image.clone(),
        is_light,
        is_extra: !is_light,
    };
    let lights = lights.iter().map(|image| pair("light", image, true));
    let pairs: Vec<Pair> = lights.chain([pair("normals", &normals, false)]).collect();
    let mut table =
        Table::new(["artwork", "picture", "angle", "beyond 30 %", "tone", "spread", "by light", "by normals"]);
    for (name, path) in HAND_DRAWN {
        let Ok(artwork) = read(path.to_string()) else { continue };
        let d = found(pool, &artwork, &pairs);
        let angles = [d.spread, d.by_light, d.by_normals].map(|angle| format!("{angle:.1}"));
        for choice in [Normals::Off, Normals::On] {
            let judged = strips_of(pool, &artwork, &pairs, choice);
            let on = choice == Normals::On;
            let picture = match (on, on == d.follow_shapes()) {
                (false, chosen) => {
                    if chosen {
                        "light, as decided"
                    } else {
                        "light"
                    }
                }
                (true, chosen) => {
                    if chosen {
                        "with normals, as decided"
                    } else {
                        "with normals"
                    }
                }
            };
            table.row([vec![name.to_string(), picture.to_string()], cells(judged), angles.to_vec()].concat());
        }
    }
    table.print("strips of hand-drawn artworks, painted anew, on the ball");
}

/// Mean figures of two seeds.
fn strips_of(pool: &Pool, artwork: &Image, pairs: &[Pair], choice: Normals) -> [f64; 3] {
    let [width, height] = SIZE;
    let is_strip = |x: usize| x % STRIPS[0] < STRIPS[1];
    let mask = |strip: f32| Image::from_fn(width, height, |x, _| [if is_strip(x) { strip } else { 1.0 - strip }]);
    let [strips, rest] = [1.0, 0.0].map(|strip| mask(strip).expect("a small size"));
    let on_ball = |i: usize| (Vec2::new((i % width) as f32, (i / width) as f32) - CENTRE).length() < 0.92 * RADIUS;
    let inner: Vec<bool> = (0..width * height).map(|i| is_strip(i % width) && on_ball(i)).collect();
    let (mut guides, normals) = guides_of_pairs(pairs);
    if choice == Normals::On {
        guides.push(normals);
    }
    let masks = Input { source_mask: Some(&rest), target_mask: Some(&strips), ..Input::new(artwork, &guides) };
    let input = Input { known: Some(artwork), ..masks };
    let judge = Judge { truth: artwork, objects: &inner, inner: &inner };
    let figures = [1, 2].map(|seed| {
        let params = Params { seed, ..Params::default() };
        judge.figures(&pool.run(|| run(&input, &params, Monitor::default().job())).expect("valid input").image)
    });
    std::array::from_fn(|k| figures.iter().map(|f| f[k]).sum::<f64>() / 2.0)
}

/// Normals of the ball, the table and the wall of the test data, from their outlines.
fn ball_normals() -> Image {
    let normal = |x: usize, y: usize| {
        let place = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let at = (place - CENTRE) / RADIUS;
        let end = WALL[0] + (WALL[1] - WALL[0]) * place.x / SIZE[0] as f32;
        let normal = match () {
            () if at.length() < 1.0 => at.extend((1.0 - at.length_squared()).sqrt()) * Vec3::new(1.0, -1.0, 1.0),
            () if place.y < end => Vec3::new(0.0, 0.05, 1.0),
            () => Vec3::new(0.05, 0.9, 0.43),
        };
        normal.normalize().to_array()
    };
    Image::from_fn(SIZE[0], SIZE[1], normal).expect("a small size")
}
