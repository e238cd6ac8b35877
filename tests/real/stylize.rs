//! Tests stylisation on ebsynth's StyLit example, at a quarter of its size: a painted ball is the exemplar, and a
//! rendered golem the target.

use crate::truth::data;
use luxfer::image::Image;
use luxfer::image::io::{Encoding, load};
use luxfer::image::pyramid::resize;
use luxfer::job::Monitor;
use luxfer::patch::VoteMode;
use luxfer::stylize::{Guide, Input, Output, Params, Range, run};

const SIZE: (usize, usize) = (300, 228);
const GUIDES: [&str; 4] = ["fullgi", "dirdif", "dirspc", "indirb"];

struct Pair {
    artwork: Image,
    guides: Vec<(Image, Image)>,
}

/// Loads exemplar and target; returns `None` without test data, and panics in CI.
fn pair() -> Option<Pair> {
    let folder = data("stylit/ebsynth_stylit")?;
    let read = |name: String| {
        let image = load(&folder.join(name), Encoding::Srgb).unwrap().to_rgb().unwrap();
        resize(&image, SIZE.0, SIZE.1, Monitor::default().job()).unwrap()
    };
    Some(Pair {
        artwork: read("source_style.png".into()),
        guides: GUIDES.iter().map(|g| (read(format!("source_{g}.png")), read(format!("target_{g}.png")))).collect(),
    })
}

fn stylise(pair: &Pair, params: &Params) -> Output {
    let guides: Vec<Guide> = (pair.guides.iter())
        .map(|(source, target)| Guide { name: "light", source, target, weight: 1.0, range: Range::Light })
        .collect();
    let input = Input::new(&pair.artwork, &guides);
    run(&input, params, Monitor::default().job()).unwrap()
}

/// Strength of the texture: mean squared Laplacian of the sRGB-encoded green channel.
fn texture(image: &Image) -> f64 {
    let green = |x: usize, y: usize| f64::from(luxfer::image::colour::linear_to_srgb(image.pixel(x, y)[1]));
    let mut sum = 0.0;
    for y in 1..image.height - 1 {
        for x in 1..image.width - 1 {
            let around = green(x - 1, y) + green(x + 1, y) + green(x, y - 1) + green(x, y + 1);
            sum += (around - 4.0 * green(x, y)).powi(2);
        }
    }
    sum / (image.width * image.height) as f64
}

#[test]
fn the_budget_beats_plain_em_on_usage_and_texture_at_like_energy() {
    let Some(pair) = pair() else { return };
    let budget = stylise(&pair, &Params::default());
    let nearest = stylise(
        &pair,
        &Params {
            coverage: 0.0,
            settle: 0,
            search_iterations: 3,
            vote: VoteMode::Plain,
            final_vote: VoteMode::Plain,
            ..Params::default()
        },
    );
    let energy = |o: &Output| *o.report.levels.last().unwrap().energy.last().unwrap();
    let (rich, poor) = (budget.report.usage, nearest.report.usage);
    assert!(rich.used > poor.used + 0.05 && rich.entropy > poor.entropy, "{rich:?} {poor:?}");
    assert!(energy(&budget) < 1.3 * energy(&nearest), "{} {}", energy(&budget), energy(&nearest));
    let (kept, washed) = (texture(&budget.image), texture(&nearest.image));
    assert!(kept > washed, "{kept} {washed} of {}", texture(&pair.artwork));
    // Every pass covers more pixels, and the picture follows the guides: their error is small.
    for passes in budget.report.levels.iter().flat_map(|l| &l.passes) {
        assert!(passes.windows(2).all(|w| w[1].coverage >= w[0].coverage));
        assert!(passes.last().unwrap().coverage > 0.9, "{passes:?}");
    }
    let guide = &budget.report.guide_error.data;
    let rms = (guide.iter().map(|v| f64::from(v * v)).sum::<f64>() / guide.len() as f64).sqrt();
    assert!(rms < 0.05, "{rms}");
}

#[test]
fn the_exemplars_own_guides_give_the_artwork_back() {
    let Some(mut pair) = pair() else { return };
    pair.guides.iter_mut().for_each(|(source, target)| *target = source.clone());
    let output = stylise(&pair, &Params::default());
    assert!(output.image == pair.artwork);
    assert_eq!(output.report.usage.max_uses, 1);
    assert_eq!(output.report.unblended_share, 1.0);
}
