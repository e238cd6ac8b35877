//! Quality measures of a stylised picture, whatever program made it. They are computed from the pictures and the
//! guides alone, with a search at every offset of the exemplar.

use luxfer::image::Image;
use luxfer::image::colour::linear_to_srgb;
use luxfer::job::Monitor;
use luxfer::patch::{Domain, Field, Kernel, QuantisedImage, Quantiser, Search, SearchIteration};
use luxfer::rng::{Rng, hash};
use std::collections::HashSet;

/// Width in pixels of the patches that are judged.
const PATCH: usize = 5;
/// Number of patches that are compared with every patch of the exemplar, for the coherence.
const SAMPLES: usize = 300;

pub struct Judged {
    /// Energy (Eq. 3) of the picture, per patch and pixel, with channels in `[0, 1]`: colour has weight 1, all guides
    /// together 2. PatchMatch finds the nearest patches from a random start, with equal settings for every picture.
    pub energy: f64,
    /// Share in % of the picture's patches that also occur in the exemplar, compared at 8 bits per channel.
    pub verbatim: f64,
    /// Mean squared difference per channel, in squared 8-bit steps, between [`SAMPLES`] patches of the picture and the
    /// most similar patch of the exemplar at any offset; 0 for a copy.
    pub coherence: f64,
}

/// Judges `picture`, which was painted from `artwork` and `guides`, pairs of exemplar and target. All images are
/// linear.
pub fn judge(picture: &Image, artwork: &Image, guides: &[(Image, Image)]) -> Judged {
    Judged {
        energy: energy(picture, artwork, guides),
        verbatim: verbatim(picture, artwork),
        coherence: coherence(picture, artwork),
    }
}

/// Returns the image with display encoding, clamped to `[0, 1]`.
pub fn encoded(image: &Image) -> Image {
    let mut out = image.clone();
    out.data.iter_mut().for_each(|v| *v = linear_to_srgb(*v).clamp(0.0, 1.0));
    out
}

/// The domain in which all patches of an image may be matches.
fn everywhere(of: &QuantisedImage) -> Domain {
    Domain::new(of.width, of.height, PATCH, None, false).expect("an image as large as a patch")
}

/// The search for the nearest patches of `base` for the patches of `query`.
fn nearest<'a>(query: &'a QuantisedImage, base: &'a QuantisedImage, allowed: &'a Domain) -> Search<'a> {
    Search { query, base, allowed, patch: PATCH, kernel: Kernel::detect(), seed: 9 }
}

/// Computes [`Judged::energy`] only.
pub fn energy(picture: &Image, artwork: &Image, guides: &[(Image, Image)]) -> f64 {
    let monitor = Monitor::default();
    let each = 2.0 / (3 * guides.len()) as f64;
    let mut weights = vec![1.0 / 3.0; 3];
    weights.extend(vec![each; 3 * guides.len()]);
    let quantisers = Quantiser::for_weights(&weights, PATCH);
    let features = |colours: &Image, side: &dyn Fn(usize) -> Image| {
        let mut out = QuantisedImage::new(colours.width, colours.height, weights.len()).expect("memory");
        out.fill(0, &quantisers[..3], &encoded(colours), monitor.job()).expect("nobody cancels");
        for g in 0..guides.len() {
            let first = 3 + 3 * g;
            out.fill(first, &quantisers[first..first + 3], &encoded(&side(g)), monitor.job()).expect("nobody cancels");
        }
        out
    };
    let base = features(artwork, &|g| guides[g].0.clone());
    let query = features(picture, &|g| guides[g].1.clone());
    let allowed = everywhere(&base);
    let search = nearest(&query, &base, &allowed);
    let mut field = Field::new(query.width + 1 - PATCH, query.height + 1 - PATCH).expect("memory");
    for index in 0..10 {
        search
            .iterate(&mut field, SearchIteration { index, radius: 256, initial_samples: 8 }, monitor.job(), |_| true)
            .expect("nobody cancels");
    }
    let unit = Quantiser::unit(&weights, PATCH).powi(2) * (PATCH * PATCH) as f64;
    field.energy() / field.at.len() as f64 / unit
}

fn verbatim(picture: &Image, artwork: &Image) -> f64 {
    let patches = |image: &Image| {
        let bytes: Vec<u64> = encoded(image).data.iter().map(|v| (v * 255.0).round() as u64).collect();
        let width = image.width;
        let row = move |x: usize, y: usize| hash(1, &bytes[3 * (y * width + x)..][..3 * PATCH]);
        let rows: Vec<u64> = (0..image.height * (width + 1 - PATCH))
            .map(|i| row(i % (width + 1 - PATCH), i / (width + 1 - PATCH)))
            .collect();
        let columns = width + 1 - PATCH;
        (0..(image.height + 1 - PATCH) * columns)
            .map(|i| hash(2, &std::array::from_fn::<u64, PATCH, _>(|k| rows[i + k * columns])))
            .collect::<Vec<u64>>()
    };
    let known: HashSet<u64> = patches(artwork).into_iter().collect();
    let made = patches(picture);
    100.0 * made.iter().filter(|p| known.contains(p)).count() as f64 / made.len() as f64
}

fn coherence(picture: &Image, artwork: &Image) -> f64 {
    let monitor = Monitor::default();
    let weights = [1.0; 3];
    let quantisers = Quantiser::for_weights(&weights, PATCH);
    let features = |image: &Image| {
        let mut out = QuantisedImage::new(image.width, image.height, 3).expect("memory");
        out.fill(0, &quantisers, &encoded(image), monitor.job()).expect("nobody cancels");
        out
    };
    let (base, query) = (features(artwork), features(picture));
    let allowed = everywhere(&base);
    let search = nearest(&query, &base, &allowed);
    let mut field = Field::new(query.width + 1 - PATCH, query.height + 1 - PATCH).expect("memory");
    let mut rng = Rng::new(5, &[]);
    let mut chosen = vec![false; field.at.len()];
    (0..SAMPLES).for_each(|_| chosen[rng.below(field.at.len())] = true);
    // Start with good matches, so that most comparisons of the exhaustive search stop early.
    for index in 0..4 {
        search
            .iterate(&mut field, SearchIteration { index, radius: 512, initial_samples: 64 }, monitor.job(), |i| {
                chosen[i]
            })
            .expect("nobody cancels");
    }
    search.exhaustive(&mut field, monitor.job(), |i| chosen[i]).expect("nobody cancels");
    let count = chosen.iter().filter(|c| **c).count();
    let unit = Quantiser::unit(&weights, PATCH).powi(2);
    field.energy() / unit / (count * PATCH * PATCH * 3) as f64 * 255.0 * 255.0
}
