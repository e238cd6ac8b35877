//! Earlier methods of matching, for comparison, on the library's patches. They run from coarse to fine with the numbers
//! of iterations, the weights and the votes of the library's defaults, but without masks.

use super::{Pair, greedy, occurrence, uniform};
use crate::harness::judge::encoded;
use luxfer::image::Image;
use luxfer::image::colour::srgb_to_linear;
use luxfer::job::{Job, Monitor};
use luxfer::patch::{Domain, Field, Kernel, QuantisedImage, Quantiser, Search, VoteMode, halve, level_count, vote};
use luxfer::rng::hash;
use luxfer::stylize::Params;

/// Width of a patch in pixels.
pub const PATCH: usize = 5;

#[derive(Clone, Copy, PartialEq)]
pub enum Method {
    Uniform,
    /// The weight λ of the usage penalty.
    Occurrence(f64),
    Greedy,
}

/// The methods: name, file of the picture, and the method.
pub const METHODS: [(&str, &str, Method); 5] = [
    ("uniform (Jamriska 2015)", "stylit_uniform", Method::Uniform),
    ("occurrence, lambda 0.01", "stylit_occurrence_001", Method::Occurrence(0.01)),
    ("occurrence, lambda 0.1 (Kaspar 2015)", "stylit_occurrence_01", Method::Occurrence(0.1)),
    ("occurrence, lambda 1", "stylit_occurrence_1", Method::Occurrence(1.0)),
    ("greedy (Hertzmann 2001)", "stylit_greedy", Method::Greedy),
];

/// A pyramid level: the artwork, and all guides of each side in one image; encoded for display.
struct Level {
    style: Image,
    source: Image,
    target: Image,
}

impl Level {
    fn of(pair: &Pair) -> Self {
        let stack = |images: Vec<&Image>| {
            let mut out = Image::new(images[0].width, images[0].height, 3 * images.len()).expect("memory");
            for (i, pixel) in out.data.chunks_exact_mut(3 * images.len()).enumerate() {
                let values = images.iter().flat_map(|image| &image.data[3 * i..3 * i + 3]);
                pixel.iter_mut().zip(values).for_each(|(out, v)| *out = *v);
            }
            encoded(&out)
        };
        Self {
            style: encoded(&pair.artwork),
            source: stack(pair.guides.iter().map(|(source, _)| source).collect()),
            target: stack(pair.guides.iter().map(|(_, target)| target).collect()),
        }
    }

    fn halved(&self, job: Job) -> Self {
        let half = |image: &Image| halve(image, job).expect("nobody cancels");
        Self { style: half(&self.style), source: half(&self.source), target: half(&self.target) }
    }
}

/// The quantised images of a level.
pub struct Matcher<'a> {
    pub style: &'a Image,
    pub source: QuantisedImage,
    pub target: QuantisedImage,
    pub allowed: Domain,
    /// The quantisers of the artwork's colours.
    pub colours: Vec<Quantiser>,
    /// Squared difference, in quantised units, of two samples that differ by 1 and have weight 1.
    pub unit: f64,
    seed: u64,
}

impl<'a> Matcher<'a> {
    /// Quantises level `l`. `colour` is the weight of all colours together, and `guides` that of all guides.
    fn new(level: &'a Level, [colour, guides]: [f64; 2], l: usize, job: Job) -> Self {
        let count = level.source.channels;
        let mut weights = vec![colour / 3.0; 3];
        weights.extend(vec![guides / count as f64; count]);
        let mut colours = Quantiser::for_weights(&weights, PATCH);
        let others = colours.split_off(3);
        let quantised = |guides: &Image| {
            let mut out = QuantisedImage::new(guides.width, guides.height, weights.len()).expect("memory");
            out.fill(3, &others, guides, job).expect("nobody cancels");
            out
        };
        let (mut source, target) = (quantised(&level.source), quantised(&level.target));
        source.fill(0, &colours, &level.style, job).expect("nobody cancels");
        let allowed = every_patch(&source);
        let (unit, seed) = (Quantiser::unit(&weights, PATCH).powi(2), hash(1, &[l as u64]));
        Self { style: &level.style, source, target, allowed, colours, unit, seed }
    }

    /// The search for the nearest exemplar patch of each target patch.
    pub fn search(&self) -> Search<'_> {
        Search {
            query: &self.target,
            base: &self.source,
            allowed: &self.allowed,
            patch: PATCH,
            kernel: Kernel::detect(),
            seed: self.seed,
        }
    }
}

/// All patches of an image.
pub fn every_patch(of: &QuantisedImage) -> Domain {
    Domain::new(of.width, of.height, PATCH, None, false).expect("an image as large as a patch")
}

/// Paints the target of `pair`; returns the picture in linear colour.
pub fn run(pair: &Pair, method: Method) -> Image {
    let monitor = Monitor::default();
    let (job, params) = (monitor.job(), Params::default());
    let mut levels = vec![Level::of(pair)];
    let (s, t) = (&levels[0].source, &levels[0].target);
    let shortest = s.width.min(s.height).min(t.width).min(t.height);
    for _ in 1..level_count(shortest, 5 * PATCH, params.levels) {
        levels.push(levels[levels.len() - 1].halved(job));
    }
    let mut field = by_guides_alone(&levels[levels.len() - 1], job);
    let mut picture = Image::new(1, 1, 3).expect("memory");
    for (l, level) in levels.iter().enumerate().rev() {
        let stronger = if l > 0 { params.coarse_guides } else { 1.0 };
        let mut matcher = Matcher::new(level, [1.0, f64::from(params.guide_weight * stronger)], l, job);
        if l + 1 < levels.len() {
            let (width, height) = (level.target.width + 1 - PATCH, level.target.height + 1 - PATCH);
            field = field.upsample(width, height, &matcher.allowed).expect("memory");
        }
        picture = Image::new(level.target.width, level.target.height, 3).expect("memory");
        paint(&mut picture, &field, level, VoteMode::Plain, job);
        iterate(&mut matcher, level, &mut field, &mut picture, (method, l), job);
    }
    picture.data.iter_mut().for_each(|v| *v = srgb_to_linear(*v));
    picture
}

/// Alternates matching and voting on level `l`.
fn iterate(
    matcher: &mut Matcher,
    level: &Level,
    field: &mut Field,
    picture: &mut Image,
    (method, l): (Method, usize),
    job: Job,
) {
    let params = Params::default();
    let iterations = match (method, l) {
        (Method::Greedy, _) => 1,
        (_, 0) => params.finest_iterations + params.polish,
        (_, 1) => params.iterations,
        _ => params.coarse_iterations,
    };
    for k in 0..iterations {
        matcher.target.fill(0, &matcher.colours, picture, job).expect("nobody cancels");
        matcher.search().rescore(field, job, |_| true).expect("nobody cancels");
        let is_last = l == 0 && k + 1 == iterations;
        match method {
            Method::Uniform => {
                uniform::rematch(matcher, field, k as u64, job);
                paint(picture, field, level, if is_last { params.final_vote } else { params.vote }, job);
            }
            Method::Occurrence(weight) => {
                occurrence::rematch(matcher, field, weight, k as u64);
                paint(picture, field, level, VoteMode::Plain, job);
            }
            Method::Greedy => greedy::rematch_and_paint(matcher, field, picture, l, job),
        }
    }
}

fn paint(picture: &mut Image, field: &Field, level: &Level, mode: VoteMode, job: Job) {
    vote(picture, field, &level.style, PATCH, mode, job, |_| true).expect("nobody cancels");
}

/// The nearest matches by the guides alone, among all exemplar patches of the coarsest level.
fn by_guides_alone(level: &Level, job: Job) -> Field {
    let matcher = Matcher::new(level, [0.0, 1.0], 0, job);
    let (width, height) = (level.target.width + 1 - PATCH, level.target.height + 1 - PATCH);
    let mut field = Field::proportional(width, height, &matcher.allowed).expect("memory");
    matcher.search().rescore(&mut field, job, |_| true).expect("nobody cancels");
    matcher.search().exhaustive(&mut field, job, |_| true).expect("nobody cancels");
    field
}
