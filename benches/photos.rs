//! Laboratory for photos: measures how often a lighting transfer gets the lamps of a photo right, on real photographs
//! and on generated ones.
//!
//! `cargo bench --bench photos -- SECTION …`, or `make bench ONLY=photos:SECTION`:
//! - `real` runs the photos of the test data with their strokes, end to end with default settings, but not the quarter
//!   of the corpus that is set aside; `real:WORD` runs the photos whose name contains the word, and
//!   also saves their panels at full size. Contact sheets go to `out/bench/photos/`.
//! - `nostrokes` runs the photos of `real` without any stroke; `nostrokes:tune:COUNT` runs generated photos without
//!   any stroke.
//! - `made` runs 200 generated photos of the evaluation seeds; `made:40` runs the first 40 of them and prints no
//!   figures. Generated photos are kept under `target/photolab`, so that each is made only once.
//! - `tune` runs generated photos of the tuning seeds: `tune`, `tune:COUNT`, `tune:SEED`, `tune:FIRST:COUNT`.
//! - `masks` or `masks:COUNT` finds only the masks of the photos of `real` and of 24 (`COUNT`) tuning photos, with and
//!   without strokes, and compares them with the truth.
//! - `contact` makes a contact sheet of 40 tuning photos with their strokes, and one of their true lamps.
//! - `perfect` tests the judges: perfect answers must be judged right, spoilt answers must not. It also shows how well
//!   the library does with perfect masks.
//! - `export:FOLDER:COUNT:FIRST` writes photos of the learning seeds with their labels (see `photos/export.rs`).
//! - `held` runs the quarter of the corpus that is set aside: look at it only when all work is done, and never tune on
//!   it.
//!
//! # Verdicts
//! Verdicts are computed (`photos/judge.rs`); no list of opinions is read.
//! - *Precision* is the share of the mask of lights that lies on a true lamp or within 6 pixels of one. *Found* is the
//!   share of the true lamps at least 4 pixels wide of which half the pixels lie in the mask.
//! - The outline of a lamp that the corpus lists by hand is drawn where its luminance is half way between its
//!   surroundings and its own (`photos/outline.rs`). Where the corpus joins several lamps in one outline, the lamps are
//!   drawn anew (`photos/redrawn.txt`). A lamp that was measured in a ceiling seen straight on has the median size of
//!   the lamps of that ceiling.
//! - The *texture* is compared with the true lamps in their plane if the camera is known. Both are measured in units
//!   of the camera's distance from the plane, so that errors of the focal length and of the unwarping count too. The
//!   statistics are the median area of whole lamps, the median aspect ratio, the median distance to the nearest lamp,
//!   and the lit share of the plane. Lamps longer than six times their width are lines: for lines the width and the
//!   distance between neighbouring lines are compared instead. Where lamps were listed by hand, which lists
//!   windows and not their panes, lamps of the texture count as one if the gap between them is at most a fifth of the
//!   true lamps' shorter side and half of the gaps between true lamps. Lamps listed by hand in two sizes, at least 1.5
//!   times as large as each other, are two kinds: each lamp of the texture is then compared with the kind whose area is
//!   nearest.
//! - *Right*: precision above 0.8, found at least 90 %, and the texture's area and aspect within a factor of 1.25, its
//!   spacing within 1.1, its lit share within 1.35.
//! - *Usable*: precision above 0.5, found at least 70 %, and factors of 2, 1.6, 1.3 and 2.
//! - *Wrong*: everything else, also a run that ends in an error. *Wrong, unwarned*: wrong without an error and without
//!   a warning.
//! - A trap is a photo without a pattern of lamps. It is right if the run ends in an error or warns; otherwise it is
//!   judged like other photos.
//! - A photo whose lamps lie on no plane, or shine away from the camera, is right if the run ends in an error, or
//!   warns by `DIM_LAMPS`, `NO_PATTERN` or `OFF_PLANE` that its texture should not be used; otherwise it is judged like
//!   other photos.
//! - A photo whose true lamps are not known has no verdict; if only its camera is not known, the masks alone decide.

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
#[path = "photos/mask_check.rs"]
mod mask_check;
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
            "masks" => mask_check::mask_check(words),
            "contact" => generated::contact(words),
            "perfect" => perfect::perfect(words),
            "export" => export::export(words),
            other => println!("# there is no section {other}; see the head of benches/photos.rs"),
        },
    });
}
