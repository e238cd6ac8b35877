//! The final votes: the fine detail that each leaves of the artwork, and the likeness of pictures to a known truth.
//!
//! Each set is matched once, and each vote paints its picture from these matches. Sets with a truth have an artwork
//! that a program makes from the guides, so that the same program makes the right picture of the target.
//! [`ASIDE`] lists sets that were not looked at while the votes were developed.

use super::demonstration::{guides_of, objects};
use super::fidelity::{Detail, Likeness};
use super::{Pair, save};
use crate::harness::scenes::data;
use crate::harness::{Table, absent, figure};
use glam::Vec3;
use luxfer::demo::artwork::{Style, draw};
use luxfer::demo::{sphere_on_table, still_life};
use luxfer::exec::Pool;
use luxfer::guides::{Extras, pairs};
use luxfer::image::Image;
use luxfer::image::colour::{linear_to_srgb, luminance, srgb_to_linear};
use luxfer::image::io::{Encoding, load};
use luxfer::job::Monitor;
use luxfer::patch::{VoteMode, vote};
use luxfer::stylize::{Guide, Input, Output, Params, Range, run};

/// Drawn styles of the pair in the test data: name, and path of the artwork.
const DRAWN: [(&str, &str); 4] = [
    ("crayon", "stylit/ebsynth_stylit/source_style.png"),
    ("smooth", "stylit/dcharata_extra_styles/source_style_2.png"),
    ("charcoal", "stylit/dcharata_extra_styles/source_style_3.png"),
    ("brush", "stylit/dcharata_extra_styles/source_style_5.png"),
];
const ASIDE: [(&str, &str); 2] = [
    ("dirty", "stylit/dcharata_extra_styles/source_style_1.png"),
    ("photographed", "stylit/dcharata_extra_styles/source_style_4.png"),
];

const VOTES: [(&str, VoteMode); 4] = [
    ("most", VoteMode::Majority),
    ("plain", VoteMode::Plain),
    ("weighted", VoteMode::Weighted),
    ("adaptive", VoteMode::Adaptive),
];

struct Set {
    name: &'static str,
    artwork: Image,
    guides: Vec<(Image, Image)>,
    /// The guide whose luminance sorts the pixels into bins.
    light: (Image, Image),
    truth: Option<Truth>,
}

struct Truth {
    picture: Image,
    /// The pixels of the objects.
    object: Vec<bool>,
}

/// Measures the votes on the drawn styles and on the sets with a truth.
pub fn compare(pair: &Pair, pool: &Pool) {
    let drawn = DRAWN.iter().filter_map(|style| drawn(pair, style));
    let sets = drawn.chain([rendered(pair)]).chain(std::iter::once_with(|| demonstrated(pool)).flatten());
    measure(sets, pool, "votes");
}

/// Measures the votes on the sets that were set aside.
pub fn compare_aside(pair: &Pair, pool: &Pool) {
    let drawn = ASIDE.iter().filter_map(|style| drawn(pair, style));
    measure(drawn.chain(by_numbers()), pool, "votes, sets that were set aside");
}

fn measure(sets: impl Iterator<Item = Set>, pool: &Pool, title: &str) {
    let head = ["set", "picture", "detail", "mean of bins", "SSIM", "on object", "dE2000", "whole %"];
    let mut table = Table::new(head);
    for set in sets {
        let name = set.name;
        let right = set.right();
        // The right picture, or without a truth the artwork itself, comes first: its detail must be 0.
        let first = set.truth.as_ref().map_or(&set.artwork, |truth| &truth.picture);
        let guide = if set.truth.is_some() { &set.light.1 } else { &set.light.0 };
        table.row(set.row(first, guide, &right, "perfect", None));
        let output = set.stylise(pool);
        for (vote, mode) in VOTES {
            let picture = set.voted(&output, mode, pool);
            table.row(set.row(&picture, &set.light.1, &right, vote, Some(whole(&output, mode))));
            save(&format!("vote_{name}_{vote}"), &picture);
        }
    }
    table.print(title);
}

/// The share of whole pixels, if the run itself ended with this vote.
fn whole(output: &Output, mode: VoteMode) -> f64 {
    if mode == Params::default().final_vote { output.report.unblended_share } else { f64::NAN }
}

impl Set {
    /// The detail that a picture should have.
    fn right(&self) -> Detail {
        match &self.truth {
            Some(truth) => Detail::of(&truth.picture, &self.light.1),
            None => Detail::of(&self.artwork, &self.light.0),
        }
    }

    fn stylise(&self, pool: &Pool) -> Output {
        let guide = |(source, target)| Guide { name: "guide", source, target, weight: 1.0, range: Range::Light };
        let guides: Vec<Guide> = self.guides.iter().map(|(source, target)| guide((source, target))).collect();
        let monitor = Monitor::default();
        pool.run(|| run(&Input::new(&self.artwork, &guides), &Params::default(), monitor.job())).expect("valid input")
    }

    /// Paints the final field by a vote.
    fn voted(&self, output: &Output, mode: VoteMode, pool: &Pool) -> Image {
        let mut style = self.artwork.clone();
        style.data.iter_mut().for_each(|v| *v = linear_to_srgb(*v));
        let (mut picture, monitor) = (output.image.clone(), Monitor::default());
        let paint = || vote(&mut picture, &output.field, &style, output.report.patch, mode, monitor.job(), |_| true);
        pool.run(paint).expect("nobody cancels");
        picture.data.iter_mut().for_each(|v| *v = srgb_to_linear(*v));
        picture
    }

    /// The cells of a picture that a vote has painted, and its figures.
    fn row(&self, picture: &Image, guide: &Image, right: &Detail, vote: &str, whole: Option<f64>) -> Vec<String> {
        let name = self.name;
        let [pooled, mean] = Detail::of(picture, guide).over(right);
        figure(&format!("stylit.vote.{name}.{vote}.detail"), pooled, "log2");
        let mut row = vec![name.to_string(), vote.to_string(), format!("{pooled:+.2}"), format!("{mean:+.2}")];
        match &self.truth {
            Some(truth) => {
                let likeness = Likeness::of(picture, &truth.picture, &truth.object);
                figure(&format!("stylit.vote.{name}.{vote}.ssim"), likeness.ssim, "-");
                figure(&format!("stylit.vote.{name}.{vote}.on_object"), likeness.on_object, "-");
                let values = [likeness.ssim, likeness.on_object].map(|v| format!("{v:.3}"));
                row.extend(values.into_iter().chain([format!("{:.2}", likeness.delta_e)]));
            }
            None => row.extend(["-"; 3].map(String::from)),
        }
        row.push(whole.filter(|w| w.is_finite()).map_or("-".to_string(), |w| format!("{:.0}", 100.0 * w)));
        row
    }
}

/// A drawn style of the pair.
fn drawn(pair: &Pair, &(name, path): &(&'static str, &str)) -> Option<Set> {
    let artwork = data(path).and_then(|file| {
        load(&file, Encoding::Srgb).and_then(|image| image.to_rgb()).map_err(|error| error.to_string())
    });
    match artwork {
        Ok(artwork) => {
            Some(Set { name, artwork, guides: pair.guides.clone(), light: pair.guides[0].clone(), truth: None })
        }
        Err(reason) => {
            absent(&format!("stylit.vote.{name}.adaptive.detail"), &reason);
            None
        }
    }
}

/// The pair's picture of all light as the artwork, with its parts as guides.
fn rendered(pair: &Pair) -> Set {
    let (artwork, picture) = pair.guides[0].clone();
    // The golem is red, and the room white.
    let object = picture.data.chunks_exact(3).map(|p| linear_to_srgb(p[0]) - linear_to_srgb(p[1]) > 0.15).collect();
    Set {
        name: "rendered",
        artwork,
        guides: pair.guides[1..].to_vec(),
        light: pair.guides[0].clone(),
        truth: Some(Truth { picture, object }),
    }
}

/// The still life in the style of the sphere on a table, drawn by the demonstration's artists and by a gradient.
fn demonstrated(pool: &Pool) -> impl Iterator<Item = Set> {
    let [ball, target] = [sphere_on_table(), still_life()].map(|scene| guides_of(pool, scene.expect("a scene")));
    let object = objects(&target);
    let light: Vec<(Image, Image)> = pairs(&ball, &target, Extras::default())
        .expect("guides of one kind")
        .into_iter()
        .map(|pair| (pair.source, pair.target))
        .collect();
    let drawn = |style| [&ball, &target].map(|guides| draw(style, guides).expect("an artwork"));
    let toned = [&light[0].0, &light[0].1].map(tone);
    let made = [("painted", drawn(Style::Paint)), ("pen", drawn(Style::Pen)), ("toned", toned)];
    made.into_iter().map(move |(name, [artwork, picture])| Set {
        name,
        artwork,
        guides: light.clone(),
        light: light[0].clone(),
        truth: Some(Truth { picture, object: object.clone() }),
    })
}

/// Colours light by a gradient from a dark blue by a warm red to a pale yellow: a smooth medium without texture.
fn tone(light: &Image) -> Image {
    let ramp = [Vec3::new(0.05, 0.06, 0.2), Vec3::new(0.7, 0.25, 0.2), Vec3::new(1.0, 0.95, 0.75)];
    let colour = |x: usize, y: usize| {
        let shade = 2.0 * linear_to_srgb(luminance(light.rgb(x, y))).clamp(0.0, 1.0);
        let (from, to) = if shade < 1.0 { (ramp[0], ramp[1]) } else { (ramp[1], ramp[2]) };
        from.lerp(to, if shade < 1.0 { shade } else { shade - 1.0 }).map(srgb_to_linear).to_array()
    };
    Image::from_fn(light.width, light.height, colour).expect("the size of the light")
}

/// Texture by numbers: a photo with segments as the only guide.
fn by_numbers() -> Option<Set> {
    let read = |name: &str| -> Result<Image, String> {
        let file = data("stylit/ebsynth_texbynum")?.join(name);
        load(&file, Encoding::Srgb).and_then(|image| image.to_rgb()).map_err(|error| error.to_string())
    };
    let set = || -> Result<Set, String> {
        let light = (read("source_segment.png")?, read("target_segment.png")?);
        let artwork = read("source_photo.png")?;
        Ok(Set { name: "by_numbers", artwork, guides: vec![light.clone()], light, truth: None })
    };
    set().inspect_err(|reason| absent("stylit.vote.by_numbers.adaptive.detail", reason)).ok()
}
