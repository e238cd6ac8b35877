//! Runs lighting transfers on generated photographs with strokes, and prints their verdicts.

use super::hall::hall;
use super::made::{EVALUATION, TUNING, made, picture_of};
use super::outcome::Outcome;
use super::sheet::{self, Sheets};
use super::tally::{Line, Tally};
use super::truth::remove_strokes;
use crate::harness::{figure, median, quantile};
use luxfer::image::Image;
use luxfer::segment::strokes;
use std::sync::Arc;

/// Default number of photos, from which the figures are computed.
const PHOTOS: usize = 200;
/// Number of photos across and down a contact sheet, and the size of each in pixels.
const CONTACT: [usize; 2] = [5, 8];
const THUMBNAIL: [usize; 2] = [300, 225];
/// Minimum size in megapixels of a photo that counts for the time per megapixel.
const LARGE: f64 = 0.9;

/// Runs photos of the evaluation seeds and prints figures.
pub fn evaluate(words: &[String]) {
    let count = words.first().and_then(|word| word.parse().ok()).unwrap_or(PHOTOS);
    let (tally, ten) = run("made", EVALUATION, count);
    if count < PHOTOS {
        return;
    }
    tally.verdicts("made");
    tally.lights("made.lights");
    tally.stated_errors("made");
    let high = |values: Vec<f64>| 100.0 * quantile(&values, 0.95);
    let share = |v: f64| if v.is_finite() { v.abs().exp_m1() } else { 10.0 };
    let agreement = |of: fn(&super::judge::Agreement) -> Option<f64>| {
        high(tally.values(|line| of(line.judgement.agreement.as_ref()?)).into_iter().map(share).collect())
    };
    figure("photos.lamp_area", agreement(|a| a.area), "%, 95th percentile");
    figure("photos.lit_share", agreement(|a| a.lit), "%, 95th percentile");
    figure("photos.lattice", agreement(|a| a.lattice), "%, 95th percentile");
    figure("photos.strokes10.plane_iou", median(&ten.values(|line| line.judgement.plane_iou)), "median");
    figure("photos.strokes10.lights_iou", median(&ten.values(|line| line.judgement.lights_iou)), "median");
    let large = |line: &Line| (line.megapixels > LARGE).then(|| line.seconds / line.megapixels);
    figure("photos.seconds", median(&tally.values(large)), "s per MP, photos of 1 MP, median");
    let large = |line: &Line| (line.megapixels > LARGE).then(|| line.cpu_seconds / line.megapixels);
    figure("photos.cpu_seconds", median(&tally.values(large)), "CPU s per MP, photos of 1 MP, median");
}

/// Runs photos of the tuning seeds, or the photo of one seed; prints tables and makes contact sheets, but prints no
/// figures.
pub fn tune(words: &[String]) {
    let numbers: Vec<u64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [] => drop(run("tune", TUNING, 60)),
        [seed] if seed >= TUNING => drop(run("tune", seed, 1)),
        [count] => drop(run("tune", TUNING, count as usize)),
        [first, count, ..] => drop(run("tune", first, count as usize)),
    }
}

/// Runs the first photos of the tuning seeds without any stroke; prints tables, but no figures.
pub fn tune_without_strokes(words: &[String]) {
    let count = words.first().and_then(|word| word.parse().ok()).unwrap_or(60);
    let scene = Arc::new(hall());
    let (mut sheets, mut tally) = (Sheets::new("nostrokes_tune", false), Tally::default());
    for seed in TUNING..TUNING + count {
        let mut photo = made(seed).photo;
        remove_strokes(&mut photo);
        let outcome = Outcome::of(&photo, &scene);
        let line = Line::of(&photo, &outcome);
        if seed % 3 == 0 {
            sheets.add(&photo, &outcome, &line.caption());
        }
        tally.lines.push(line);
    }
    sheets.save_last_rows();
    tally.table("Generated photos without strokes; × is the factor from the true lamps to the texture's");
    tally.by_pattern();
}

/// Runs `count` photos, from the seed `first` on. Returns the verdicts with all strokes, and the verdicts on the masks
/// from ten strokes per photo.
fn run(section: &str, first: u64, count: usize) -> (Tally, Tally) {
    let scene = Arc::new(hall());
    let (mut sheets, mut tally, mut ten) = (Sheets::new(section, count == 1), Tally::default(), Tally::default());
    for seed in first..first + count as u64 {
        let mut made = made(seed);
        let mut outcome = Outcome::of(&made.photo, &scene);
        // Add only every fifth photo of a long run to the contact sheets.
        let is_shown = count <= 40 || seed % 5 == 0;
        if is_shown {
            outcome.render();
        }
        let line = Line::of(&made.photo, &outcome);
        if is_shown {
            sheets.add(&made.photo, &outcome, &line.caption());
        }
        tally.lines.push(line);
        let photo = &mut made.photo;
        photo.strokes = strokes::parse(&made.ten, photo.image.width, photo.image.height).expect("strokes");
        ten.lines.push(Line::of(photo, &Outcome::masks(photo)));
    }
    sheets.save_last_rows();
    tally.table("Generated photos by strokes; × is the factor from the true lamps to the texture's");
    tally.by_pattern();
    tally.distances(section);
    (tally, ten)
}

/// Makes a contact sheet of generated photos, and one of the classes of their pixels.
pub fn contact(words: &[String]) {
    let first = words.first().and_then(|word| word.parse().ok()).unwrap_or(TUNING);
    let [across, down] = CONTACT;
    let [width, height] = THUMBNAIL;
    let blank = || Image::from_fn(across * width, down * height, |_, _| [0.02; 3]).expect("a sheet");
    let (mut photos, mut truths) = (blank(), blank());
    let mut seconds: [Vec<f64>; 4] = Default::default();
    for i in 0..across * down {
        let made = made(first + i as u64);
        seconds.iter_mut().zip(made.seconds).for_each(|(all, own)| all.push(own));
        let at = [i % across * width, i / across * height];
        sheet::paste(&mut photos, &sheet::fitted(&sheet::strokes(&made.photo), width - 4, height - 4), at);
        let truth = picture_of(&made.classes, made.shot.width, made.shot.height);
        sheet::paste(&mut truths, &sheet::fitted(&truth, width - 4, height - 4), at);
    }
    let [room, light, camera, strokes] = seconds.map(|all| all.iter().sum::<f64>() / all.len() as f64);
    println!("CPU s a photo: room and view {room:.2}, light {light:.2}, camera {camera:.2}, strokes {strokes:.2}");
    sheet::save(&photos, "contact_photos");
    sheet::save(&truths, "contact_truths");
}
