//! The colours of clipped planes and of clipped lamps.

use crate::harness::{figure, median};
use glam::{DMat3, DVec2, Vec3};
use luxfer::emission::{self, Input};
use luxfer::geometry::Homography;
use luxfer::image::Image;
use luxfer::image::pyramid::blur;
use luxfer::job::Monitor;
use luxfer::relight::{Constraint, TargetColour, photo_colour};
use luxfer::rng::Rng;

const SIZE: [usize; 2] = [400, 300];
/// Shares of the plane's pixels whose strongest channel is clipped.
const CLIPPED: [f64; 6] = [0.0, 0.3, 0.6, 0.9, 0.97, 0.99];
/// Number of made-up planes.
const PLANES: u64 = 12;

/// Prints the error of the mean colour of planes, by the share of clipped pixels, and the share of channels that are
/// stated to be exact; then the error where lamps in the plane spread glare.
pub fn colour() {
    let (mut errors, mut exact, mut channels) = (Vec::new(), 0, 0);
    for seed in 0..PLANES {
        let plane = lit_plane(seed);
        let mut strongest: Vec<f32> = plane.data.chunks_exact(3).map(|p| Vec3::from_slice(p).max_element()).collect();
        strongest.sort_by(f32::total_cmp);
        for share in CLIPPED {
            let white = strongest[((1.0 - share) * (strongest.len() - 1) as f64) as usize];
            let found = target(&photograph(&plane, white, seed), &mask(|_, _| false));
            let truth = mean(&plane) / white;
            for c in 0..3 {
                channels += 1;
                if found.1[c] == Constraint::Exactly {
                    exact += 1;
                    errors.push(100.0 * f64::from((found.0[c] / truth[c] - 1.0).abs()));
                }
            }
        }
    }
    let rms = |errors: &[f64]| (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt();
    figure("constants.colour.clipped_error", rms(&errors), "%");
    figure("constants.colour.exact", 100.0 * f64::from(exact) / f64::from(channels), "% of the channels");
    let halos: Vec<f64> = (0..PLANES).map(halo).collect();
    figure("constants.colour.halo_error", rms(&halos), "%");
}

/// A plane of one paint under a warm lamp and cool light from the other side, with noise.
fn lit_plane(seed: u64) -> Image {
    let mut rng = Rng::new(71, &[seed]);
    let mut between = |low: f32, high: f32| low + (high - low) * rng.next_f32();
    let paint = Vec3::new(between(0.4, 0.9), between(0.4, 0.9), between(0.3, 0.9));
    let warm = Vec3::new(1.0, between(0.6, 0.9), between(0.3, 0.7)) * between(0.5, 2.0);
    let cool = Vec3::new(between(0.5, 0.9), between(0.7, 1.0), 1.0) * between(0.2, 1.0);
    let (at, reach) = (between(0.0, 1.0), between(0.2, 1.0));
    let image = Image::from_fn(SIZE[0], SIZE[1], |x, y| {
        let (u, v) = (x as f32 / SIZE[0] as f32, y as f32 / SIZE[1] as f32);
        let near = 1.0 / (1.0 + ((u - at).powi(2) + (v - 0.5).powi(2)) / (reach * reach));
        (paint * (warm * near + cool * (0.3 + 0.7 * u))).to_array()
    });
    image.expect("a plane")
}

/// A photo in which `white` is clipped, with noise.
fn photograph(image: &Image, white: f32, seed: u64) -> Image {
    let mut photo = image.clone();
    for (i, v) in photo.data.iter_mut().enumerate() {
        let noise = 0.01 * Rng::new(73, &[seed, i as u64]).normal() as f32;
        *v = (*v / white * (1.0 + noise)).clamp(0.0, 1.0);
    }
    photo
}

fn mean(image: &Image) -> Vec3 {
    image.data.chunks_exact(3).map(Vec3::from_slice).sum::<Vec3>() / (image.width * image.height) as f32
}

fn mask(is_in: impl Fn(usize, usize) -> bool) -> Image {
    Image::from_fn(SIZE[0], SIZE[1], |x, y| [f32::from(u8::from(is_in(x, y)))]).expect("a mask")
}

fn target(photo: &Image, lights: &Image) -> (Vec3, [Constraint; 3]) {
    let plane = mask(|_, _| true);
    let found = photo_colour(TargetColour::Surface, photo, &plane, lights, Monitor::default().job());
    found.map_or((Vec3::ZERO, [Constraint::AtLeast; 3]), |found| (found.colour, found.constraint))
}

/// Error in % of the colour of a plane with bright lamps, whose glare has a Gaussian core and a wider skirt.
fn halo(seed: u64) -> f64 {
    let plane = lit_plane(seed);
    let is_lamp = |x: usize, y: usize| x % 80 < 24 && y % 60 < 12;
    let bright = 4.0 * mean(&plane).max_element();
    let lit = Image::from_fn(SIZE[0], SIZE[1], |x, y| match is_lamp(x, y) {
        true => [bright; 3],
        false => plane.rgb(x, y).to_array(),
    });
    let (lit, job) = (lit.expect("a photo"), Monitor::default());
    let [core, skirt] = [1.2, 5.0].map(|sigma| blur(&lit, sigma, job.job()).expect("a blur"));
    let glaring = Image::from_fn(SIZE[0], SIZE[1], |x, y| (0.95 * core.rgb(x, y) + 0.05 * skirt.rgb(x, y)).to_array());
    let white = 1.5 * mean(&plane).max_element();
    let photo = photograph(&glaring.expect("a photo"), white, seed);
    let found = target(&photo, &mask(is_lamp)).0 * white;
    let beside: Vec<Vec3> = (0..SIZE[0] * SIZE[1])
        .filter(|i| !is_lamp(i % SIZE[0], i / SIZE[0]))
        .map(|i| plane.rgb(i % SIZE[0], i / SIZE[0]))
        .collect();
    let truth = beside.iter().sum::<Vec3>() / beside.len() as f32;
    100.0 * f64::from((found / truth - 1.0).abs().max_element())
}

/// Colours of lamps, relative to their strongest channel.
const LAMPS: [Vec3; 4] =
    [Vec3::new(1.0, 0.6, 0.2), Vec3::new(1.0, 0.85, 0.7), Vec3::new(0.7, 0.85, 1.0), Vec3::new(0.3, 1.0, 0.4)];

/// Prints the error of the colours of clipped lamps of several sizes, relative to their strongest channel.
pub fn rims() {
    let mut errors = Vec::new();
    for (k, colour) in LAMPS.into_iter().enumerate() {
        for radius in [1.5, 2.5, 4.0, 8.0] {
            for bright in [1.5, 4.0] {
                errors.push(100.0 * f64::from(rim_error(colour, radius, bright, k as u64)));
            }
        }
    }
    figure("constants.rims.error", errors.iter().sum::<f64>() / errors.len() as f64, "% of the strongest channel");
    figure("constants.rims.median", median(&errors), "% of the strongest channel");
}

/// Error of the colour of round lamps on a grey plane.
fn rim_error(colour: Vec3, radius: f64, bright: f32, seed: u64) -> f32 {
    let side = 240;
    let is_lit = |x: usize, y: usize| {
        let p = DVec2::new(x as f64 % 40.0 - 19.7, y as f64 % 40.0 - 20.2);
        p.length() < radius
    };
    let scene = Image::from_fn(side, side, |x, y| {
        let v = if is_lit(x, y) { colour * bright } else { Vec3::splat(0.05) };
        v.to_array()
    });
    let job = Monitor::default();
    let mut unwarped = blur(&scene.expect("lamps"), 1.0, job.job()).expect("a blur");
    for (i, v) in unwarped.data.iter_mut().enumerate() {
        *v = (*v + 0.01 * Rng::new(79, &[seed, i as u64]).normal() as f32).clamp(0.0, 1.0);
    }
    let light = Image::from_fn(side, side, |x, y| [f32::from(u8::from(is_lit(x, y)))]).expect("a mask");
    let valid = Image::from_fn(side, side, |_, _| [1.0]).expect("a mask");
    let input = Input {
        unwarped: &unwarped,
        light: &light,
        valid: &valid,
        photo: Some((&unwarped, Homography(DMat3::IDENTITY).into())),
    };
    let params = emission::Params { width: side, height: side, ..emission::Params::default() };
    let Ok(found) = emission::run(&input, &params, job.job()) else { return 1.0 };
    let lit = found.texture.data.chunks_exact(3).map(Vec3::from_slice).filter(|v| v.max_element() > 0.0);
    let sum = lit.fold(Vec3::ZERO, |a, b| a + b);
    (sum / sum.max_element().max(1e-9) - colour).abs().max_element()
}
