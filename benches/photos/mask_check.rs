//! Compares only the masks of photos with their truth, with and without strokes: a quick look at a change of the
//! first stages.

use super::corpus;
use super::made::{TUNING, made};
use super::outcome::Outcome;
use super::real::is_development;
use super::tally::{Line, Tally};
use super::truth::{Photo, remove_strokes};

/// Default number of generated photos.
const GENERATED: u64 = 24;

/// Finds the masks of the development part of the real photos, and of the first photos of the tuning seeds.
pub fn mask_check(words: &[String]) {
    let count = words.first().and_then(|word| word.parse().ok()).unwrap_or(GENERATED);
    let sources = corpus::sources().unwrap_or_default();
    let real: Vec<Photo> = sources.iter().filter(|s| is_development(s)).filter_map(|s| corpus::load(s).ok()).collect();
    let generated: Vec<Photo> = (TUNING..TUNING + count).map(|seed| made(seed).photo).collect();
    for (name, photos) in [("real", real), ("tune", generated)] {
        for has_strokes in [true, false] {
            let mut tally = Tally::default();
            for photo in &photos {
                let mut photo = photo.clone();
                if !has_strokes {
                    remove_strokes(&mut photo);
                }
                tally.lines.push(Line::of(&photo, &Outcome::masks(&photo)));
            }
            let section = if has_strokes { name.to_string() } else { format!("{name}.nostrokes") };
            tally.masks(&section);
        }
    }
}
