//! The photo laboratory: how often the light of a photo comes out right, on real photographs and on generated ones.
//!
//! `cargo bench --bench photos -- SECTION …`, or `make bench ONLY=photos:SECTION`:
//! - `real` runs the photos of the test data by their strokes, end to end with default settings, but for the quarter of the
//!   corpus that is set aside; `real:WORD` runs those whose name contains the word. Contact sheets go to `out/bench/photos/`.
//! - `nostrokes` runs the same photos without any stroke; `nostrokes:tune:COUNT` does so with generated photos.
//! - `made` runs 200 generated photos of the evaluation seeds; `made:40` the first 40 of them, without figures. Photos are
//!   kept under `target/photolab`, so that they are made once.
//! - `tune` runs generated photos of the tuning seeds: `tune`, `tune:COUNT`, `tune:SEED`, `tune:FIRST:COUNT`.
//! - `contact` makes a contact sheet of 40 tuning photos with their strokes and one of their truths.
//! - `perfect` puts the judges on trial: perfect answers must come out right, spoilt ones must not; and tells what the library
//!   makes of perfect masks.
//! - `export:FOLDER:COUNT:FIRST` writes photos of the learning seeds with their labels (`photos/export.rs` says how).
//! - `held` runs the quarter that is set aside: to be looked at when all is done, never tuned on.
//!
//! # Verdicts
//! They are computed (`photos/judge.rs`); no list of opinions is read.
//! - *Precision* is the share of the mask of lights that lies on a true lamp or within 6 pixels of one; *found* the share of the
//!   true lamps of at least 4 pixels across half of whose pixels lie in the mask.
//! - A lamp that the corpus lists by hand reaches as far as its luminance is above half way from its surroundings' to its own
//!   (`photos/outline.rs`); one that was measured in the ceiling seen straight on has the median size of that ceiling's lamps.
//! - The *texture* is held against the true lamps in their plane where the camera is known, both in units of the camera's
//!   distance from the plane, so that a wrong focal length or unwarping counts too: median area of the whole lamps, median
//!   aspect ratio, median distance to the nearest lamp, and lit share of the plane. Lamps longer than six times their width are
//!   lines: their width and their distance across are compared instead.
//! - *Right*: precision above 0.8, found at least 90 %, and the texture's area and aspect within a factor of 1.25, its spacing
//!   of 1.1, its lit share of 1.35.
//! - *Usable*: precision above 0.5, found at least 70 %, and factors of 2, 1.6, 1.3 and 2.
//! - *Wrong*: everything else, also a run that ends in an error. *Wrong, unwarned* where neither an error nor a warning says so.
//! - A trap, a photo that holds no pattern of lamps, is right where the run declines or warns, else judged as the others are.
//! - A photo whose lamps lie on no plane, or shine away from the camera, is right where the run ends in an error, or
//!   warns by `DIM_LAMPS` or `NO_PATTERN` that its texture is not to be used; else it is judged as the others are.
//! - Where nothing is known of a photo's lamps there is no verdict; where the camera is not known the masks alone decide.

#[path = "photos/camera.rs"]
mod camera;
#[path = "photos/ceiling.rs"]
mod ceiling;
#[path = "photos/corpus.rs"]
mod corpus;
#[path = "photos/dice.rs"]
mod dice;
#[path = "photos/export.rs"]
mod export;
#[path = "photos/exposure.rs"]
mod exposure;
#[path = "photos/forms.rs"]
mod forms;
#[path = "photos/furnish.rs"]
mod furnish;
#[path = "photos/generated.rs"]
mod generated;
#[path = "photos/hall.rs"]
mod hall;
mod harness;
#[path = "photos/hurried.rs"]
mod hurried;
#[path = "photos/judge.rs"]
mod judge;
#[path = "photos/letters.rs"]
mod letters;
#[path = "photos/made.rs"]
mod made;
#[path = "photos/masks.rs"]
mod masks;
#[path = "photos/outcome.rs"]
mod outcome;
#[path = "photos/outline.rs"]
mod outline;
#[path = "photos/perfect.rs"]
mod perfect;
#[path = "photos/real.rs"]
mod real;
#[path = "photos/room.rs"]
mod room;
#[path = "photos/shapes.rs"]
mod shapes;
#[path = "photos/sheet.rs"]
mod sheet;
#[path = "photos/tally.rs"]
mod tally;
#[path = "photos/truth.rs"]
mod truth;
#[path = "photos/viewpoint.rs"]
mod viewpoint;

use luxfer::exec::Pool;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let pool = Pool::new(2).expect("two threads");
    pool.run(|| match arguments.split_first() {
        None => {
            real::real(&[]);
            real::without_strokes(&[]);
            generated::evaluate(&[]);
        }
        Some((section, words)) => match section.as_str() {
            "real" => real::real(words),
            "nostrokes" => match words.split_first() {
                Some((first, rest)) if first == "tune" => generated::tune_without_strokes(rest),
                _ => real::without_strokes(words),
            },
            "held" => real::held(),
            "made" => generated::evaluate(words),
            "tune" => generated::tune(words),
            "contact" => generated::contact(words),
            "perfect" => perfect::perfect(words),
            "export" => export::export(words),
            other => println!("# there is no section {other}; see the head of benches/photos.rs"),
        },
    });
}
