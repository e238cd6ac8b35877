//! Runs lighting transfers on real photographs with strokes, and prints their verdicts.

use super::corpus::{self, HELD, Source};
use super::hall::hall;
use super::outcome::Outcome;
use super::sheet::Sheets;
use super::tally::{Line, Tally};
use super::truth::{Photo, remove_strokes};
use crate::harness::{absent, figure, median};
use std::sync::Arc;

/// Runs the photos that are not set aside, or those whose names contain one of the words.
pub fn real(words: &[String]) {
    let Some(tally) = run("real", words, is_development, |_| {}) else { return };
    if words.is_empty() {
        tally.verdicts("real");
        tally.lights("lights");
        tally.stated_errors("real");
        let seconds = tally.values(|line| Some(line.seconds / line.megapixels));
        figure("photos.real.seconds", median(&seconds), "s per MP, median");
    }
}

/// Runs the quarter of the corpus that is set aside and never tuned on.
pub fn held() {
    if let Some(tally) = run("held", &[], |source| !is_development(source), |_| {}) {
        tally.verdicts("held");
        tally.lights("held.lights");
        tally.stated_errors("held");
    }
}

/// Runs the photos that are not set aside without any stroke, so that the library proposes plane and lamps.
pub fn without_strokes(words: &[String]) {
    let Some(tally) = run("nostrokes", words, is_development, remove_strokes) else { return };
    if words.is_empty() {
        tally.verdicts("nostrokes");
        tally.lights("nostrokes.lights");
    }
}

/// Whether a photo belongs to the part of the corpus that may be tuned on.
pub fn is_development(source: &Source) -> bool {
    !HELD.contains(&source.name.as_str())
}

/// Runs the photos that belong to a section, each after `prepare` has changed it.
fn run(section: &str, words: &[String], belongs: fn(&Source) -> bool, prepare: fn(&mut Photo)) -> Option<Tally> {
    let sources = corpus::sources().map_err(|reason| absent(&format!("photos.{section}.right"), &reason)).ok()?;
    let is_wanted = |source: &&Source| words.is_empty() || words.iter().any(|word| source.name.contains(word.as_str()));
    let scene = Arc::new(hall());
    let (mut sheets, mut tally) = (Sheets::new(section, !words.is_empty()), Tally::default());
    for source in sources.iter().filter(|source| belongs(source)).filter(is_wanted) {
        match corpus::load(source) {
            Ok(mut photo) => {
                prepare(&mut photo);
                let mut outcome = Outcome::of(&photo, &scene);
                outcome.render();
                let line = Line::of(&photo, &outcome);
                sheets.add(&photo, &outcome, &line.caption());
                line.warnings.iter().for_each(|warning| println!("# {}: {warning}", line.name));
                tally.lines.push(line);
            }
            Err(reason) => println!("# {} is absent: {reason}", source.name),
        }
    }
    sheets.save_last_rows();
    tally.table("Real photos; × is the factor from the true lamps to the texture's");
    Some(tally)
}
