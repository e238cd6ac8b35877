//! Tests the judges: perfect answers must be judged right, spoilt answers must not.

use super::hall::hall;
use super::judge::Verdict;
use super::made::{Made, TUNING, made};
use super::masks::Mask;
use super::outcome::{self, Outcome};
use super::tally::{Line, Tally};
use glam::DVec2;
use luxfer::image::Image;
use luxfer::scene::Scene;
use luxfer::segment::Segmentation;
use luxfer::transfer::{Results, Stage, Transfer};
use std::sync::Arc;

const PHOTOS: usize = 60;
/// Number of texels along the longer side of a perfect texture.
const TEXELS: f64 = 2048.0;
/// Size of the hall's ceiling in metres, and the distance in metres of the camera from the plane that the textures
/// assume.
const CEILING: DVec2 = DVec2::new(16.0, 12.0);
const DISTANCE: f64 = 1.2;

/// A way to spoil a perfect texture: its name, a factor for the size of the pattern, a factor for the size of the
/// lamps, and the share of the lamps that are left out.
type Spoilt = (&'static str, f64, f64, f64);
const SPOILT: [Spoilt; 5] = [
    ("perfect", 1.0, 1.0, 0.0),
    ("a fifth too large", 1.2, 1.0, 0.0),
    ("a fifth too small", 1.0 / 1.2, 1.0, 0.0),
    ("lamps a quarter too long and wide", 1.0, 1.25, 0.0),
    ("half of the lamps missing", 1.0, 1.0, 0.5),
];

/// Judges perfect and spoilt textures for the tuning photos, then the textures that the library makes from perfect
/// masks.
pub fn perfect(words: &[String]) {
    let count = words.first().and_then(|word| word.parse().ok()).unwrap_or(PHOTOS);
    let scene = Arc::new(hall());
    let mut tallies: Vec<Tally> = SPOILT.iter().map(|_| Tally::default()).collect();
    let mut given = Tally::default();
    for seed in TUNING..TUNING + count as u64 {
        let made = made(seed);
        for (tally, spoilt) in tallies.iter_mut().zip(&SPOILT) {
            let mut transfer = answered(&made, &scene);
            transfer.input.texture = Some(Arc::new(texture(&made, spoilt)));
            tally.lines.push(Line::of(&made.photo, &Outcome::from(transfer, Stage::Emission)));
        }
        let mut transfer = Transfer { input: outcome::input(&made.photo, &scene), ..Transfer::default() };
        let run = transfer.run(Stage::View, Stage::View, luxfer::job::Monitor::default().job(), |_| {});
        run.err().iter().for_each(|e| println!("# {}: {e}", made.photo.name));
        let view = transfer.results.view.take();
        let mut transfer = answered(&made, &scene);
        transfer.results.view = view;
        given.lines.push(Line::of(&made.photo, &Outcome::from(transfer, Stage::Unwarp)));
    }
    tallies[0].table("Perfect answers, judged; × is the factor from the true lamps to the texture's");
    for (tally, (name, ..)) in tallies.iter().zip(&SPOILT) {
        let right = tally.lines.iter().filter(|line| line.judgement.verdict == Verdict::Right).count();
        println!("{name}: {right} of {count} are right");
    }
    given.table("Textures from perfect masks");
    given.by_pattern();
    given.verdicts("masks_given");
}

/// A transfer whose masks are the true masks.
fn answered(made: &Made, scene: &Arc<Scene>) -> Transfer {
    let truth = &made.photo.truth;
    let mask = |mask: &Mask| {
        let data = mask.on.iter().map(|&on| f32::from(on)).collect();
        let image = Image { width: mask.width, height: mask.height, channels: 1, data };
        Some(Arc::new(Segmentation::from_confidence(&image).expect("a mask")))
    };
    let plane = truth.plane.as_ref().and_then(mask);
    let results = Results { plane, lights: mask(&truth.lights), ..Results::default() };
    Transfer { input: outcome::input(&made.photo, scene), results, ..Transfer::default() }
}

/// A texture for the hall's ceiling from the true lamps of a photo's room. The room's ceiling is repeated side by
/// side, with the pattern scaled and the lamps spoilt as asked for.
fn texture(made: &Made, (_, scale, lamps, missing): &Spoilt) -> Image {
    let room = &made.room;
    let unit = f64::from(made.shot.distance);
    let density = TEXELS / CEILING.x;
    let size = [TEXELS as usize, (CEILING.y * density) as usize];
    // Texels per metre of the photo's room.
    let zoom = density * DISTANCE / unit * scale;
    let mut mask = Mask::new(size[0], size[1]);
    let period = DVec2::new(room.size.x.into(), room.size.z.into());
    let foot = DVec2::new(made.shot.camera.position.x.into(), made.shot.camera.position.z.into());
    let count = (DVec2::new(size[0] as f64, size[1] as f64) / zoom / period).ceil().as_uvec2();
    let lit: Vec<_> = room.ceiling.fittings.iter().filter(|fitting| fitting.is_lit).collect();
    let kept = |i: usize| (i as f64 * (1.0 - missing)).floor() != ((i + 1) as f64 * (1.0 - missing)).floor();
    for copy in (0..count.y).flat_map(|j| (0..count.x).map(move |i| DVec2::new(i.into(), j.into()))) {
        for (_, fitting) in lit.iter().enumerate().filter(|(i, _)| kept(*i)) {
            // Place the lamp where the photo shows it on the ceiling.
            let grown = unit / (unit - f64::from(fitting.drop));
            let place = |p: DVec2| (foot + (fitting.centre.as_dvec2() + p - foot) * grown + copy * period) * zoom;
            let fill = |mask: &mut Mask, factor: f64| {
                let outline: Vec<DVec2> =
                    fitting.form.outline(0.0).iter().map(|p| place(p.as_dvec2() * factor * lamps)).collect();
                mask.fill(&outline);
            };
            match &fitting.form {
                super::forms::Form::Ring { outer, inner } => ring(
                    &mut mask,
                    place(DVec2::ZERO),
                    f64::from(*outer) * grown * lamps * zoom,
                    f64::from(*inner) * grown * lamps * zoom,
                ),
                _ => fill(&mut mask, 1.0),
            }
        }
    }
    Image::from_fn(size[0], size[1], |x, y| [f32::from(mask.on[y * size[0] + x]); 3]).expect("a texture")
}

fn ring(mask: &mut Mask, centre: DVec2, outer: f64, inner: f64) {
    let clip = |v: f64, end: usize| (v.max(0.0) as usize).min(end);
    for y in clip(centre.y - outer, mask.height)..clip(centre.y + outer + 1.0, mask.height) {
        for x in clip(centre.x - outer, mask.width)..clip(centre.x + outer + 1.0, mask.width) {
            let radius = DVec2::new(x as f64 + 0.5, y as f64 + 0.5).distance(centre);
            if (inner..outer).contains(&radius) {
                mask.on[y * mask.width + x] = true;
            }
        }
    }
}
