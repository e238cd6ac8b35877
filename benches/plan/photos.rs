//! Photos with strokes, for plans of transfers.

use super::harness::scenes::{Absent, data, office_photo};
use luxfer::demo;
use luxfer::image::io::{self, Encoding};
use luxfer::image::{Image, pyramid};
use luxfer::job::Monitor;
use luxfer::segment::{StrokeSet, strokes};
use std::path::Path;
use std::sync::Arc;

#[derive(Clone)]
pub struct Photo {
    pub name: String,
    pub image: Arc<Image>,
    pub strokes: StrokeSet,
}

/// Photos of the generated office in the given sizes.
pub fn office(sizes: &[[usize; 2]]) -> Vec<Photo> {
    let monitor = Monitor::default();
    let room = demo::exemplar_room().expect("a room");
    let photo = office_photo(&demo::photo::Params { width: 900, height: 600, samples: 6, seed: 5 });
    let of = |&[width, height]: &[usize; 2]| Photo {
        name: format!("office {width}"),
        image: Arc::new(pyramid::resize(&photo, width, height, monitor.job()).expect("a photo")),
        strokes: demo::strokes(&room, width, height).expect("strokes"),
    };
    sizes.iter().map(of).collect()
}

/// A real photo with the strokes of the tests, reduced in size by the factor `reduce`.
pub fn real(name: &str, reduce: usize) -> Result<Photo, Absent> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = data(&format!("photos/{name}.jpg"))?;
    let image = io::load(&file, Encoding::Srgb).and_then(|i| i.to_rgb()).map_err(|e| e.to_string())?;
    let text = std::fs::read_to_string(root.join(format!("tests/strokes/{name}.txt"))).map_err(|e| e.to_string())?;
    let monitor = Monitor::default();
    let (width, height) = (image.width / reduce, image.height / reduce);
    let image = pyramid::resize(&image, width, height, monitor.job()).map_err(|e| e.to_string())?;
    let strokes = strokes::parse(&reduced(&text, reduce), width, height).map_err(|e| e.to_string())?;
    Ok(Photo { name: format!("{name} / {reduce}"), image: Arc::new(image), strokes })
}

/// Divides the strokes of a text by a factor; all numbers of its lines are lengths in pixels.
fn reduced(text: &str, reduce: usize) -> String {
    let word = |word: &str| word.parse::<f64>().map_or(word.to_string(), |n| (n / reduce as f64).to_string());
    let line = |line: &str| {
        let before_comment = line.split_once('#').map_or(line, |(before, _)| before);
        before_comment.split_whitespace().map(word).collect::<Vec<_>>().join(" ")
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}
