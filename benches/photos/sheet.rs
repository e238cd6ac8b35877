//! Contact sheets with a row of pictures for each photo, from its strokes to the hall in its light.

use super::letters;
use super::outcome::Outcome;
use super::truth::Photo;
use glam::Vec3;
use luxfer::image::{Image, io, pyramid};
use luxfer::job::Monitor;
use luxfer::segment::Stroke;
use std::path::PathBuf;

/// Widths in pixels of the panels, and their height. The panels show the photo with strokes, the masks, the unwarped
/// plane, the texture, and the lit hall.
const WIDTHS: [usize; 5] = [330, 330, 200, 300, 330];
const HEIGHT: usize = 220;
/// Number of rows on a sheet.
const ROWS: usize = 8;
const GAP: usize = 4;
const GROUND: Vec3 = Vec3::splat(0.02);
/// Exposure of the rendered hall: the factor from cd/m² to display values, 1 for the photo's white of 100 cd/m².
const EXPOSURE: f32 = 0.01;

/// Contact sheets that are being filled.
pub struct Sheets {
    name: String,
    rows: Vec<Image>,
    written: usize,
    /// Whether every panel is also saved at full size, for photos that were chosen one by one.
    keeps_panels: bool,
}

/// Names of the panels, for the files with panels at full size.
const PANELS: [&str; 5] = ["strokes", "masks", "unwarped", "texture", "hall"];

impl Sheets {
    /// Starts sheets that are saved as `out/bench/photos/<name>_<number>.png`.
    /// `keeps_panels` also saves every panel at full size, as `<name>_<photo>_<panel>.png`.
    pub fn new(name: &str, keeps_panels: bool) -> Self {
        Self { name: name.into(), rows: Vec::new(), written: 0, keeps_panels }
    }

    /// Adds the row of a photo, and saves the sheet when it is full.
    pub fn add(&mut self, photo: &Photo, outcome: &Outcome, caption: &str) {
        let results = outcome.results();
        let mut panels = vec![strokes(photo), masks(photo, outcome)];
        panels.push(results.unwarped.as_ref().map_or_else(empty_panel, |unwarped| unwarped.image.clone()));
        panels.push(results.emission.as_ref().map_or_else(empty_panel, |emission| emission.texture.clone()));
        panels.push(results.film.as_ref().map_or_else(empty_panel, |film| scaled(&film.beauty, EXPOSURE)));
        let mut row = blank(WIDTHS.iter().sum::<usize>() + GAP * WIDTHS.len(), HEIGHT + GAP);
        for (panel, what) in panels.iter().zip(PANELS).filter(|_| self.keeps_panels) {
            save(panel, &format!("{}_{}_{what}", self.name, photo.name));
        }
        let mut left = 0;
        for (panel, width) in panels.iter().zip(WIDTHS) {
            paste(&mut row, &fitted(panel, width, HEIGHT), [left, 0]);
            left += width + GAP;
        }
        letters::write(&mut row, caption, [4, HEIGHT - 16], 2, Vec3::new(1.0, 0.9, 0.1));
        self.rows.push(row);
        if self.rows.len() == ROWS {
            self.write();
        }
    }

    /// Saves the rows that are left.
    pub fn save_last_rows(mut self) {
        if !self.rows.is_empty() {
            self.write();
        }
    }

    fn write(&mut self) {
        let rows = std::mem::take(&mut self.rows);
        let mut sheet = blank(rows[0].width, rows.iter().map(|row| row.height).sum());
        let mut top = 0;
        for row in &rows {
            paste(&mut sheet, row, [0, top]);
            top += row.height;
        }
        save(&sheet, &format!("{}_{}", self.name, self.written));
        self.written += 1;
    }
}

/// Saves an image in `out/bench/photos/` and prints its path.
pub fn save(image: &Image, name: &str) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("out/bench/photos");
    let write = || -> Result<(), String> {
        std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        let bytes = io::encode_png(image, 1.0).map_err(|e| e.to_string())?;
        std::fs::write(folder.join(format!("{name}.png")), bytes).map_err(|e| e.to_string())
    };
    match write() {
        Ok(()) => println!("picture out/bench/photos/{name}.png"),
        Err(reason) => println!("# {name}.png was not written: {reason}"),
    }
}

/// Draws the strokes on the photo: plane green, not plane dark red, lights yellow, not lights blue.
pub fn strokes(photo: &Photo) -> Image {
    let mut image = (*photo.image).clone();
    let mut draw = |strokes: &[Stroke], positive: Vec3, negative: Vec3| {
        for stroke in strokes {
            let ink = if stroke.positive { positive } else { negative };
            stroke.pixels.iter().for_each(|&i| ink.write_to_slice(&mut image.data[3 * i as usize..]));
        }
    };
    draw(&photo.strokes.plane, Vec3::new(0.0, 0.8, 0.1), Vec3::new(0.5, 0.0, 0.0));
    draw(&photo.strokes.lights, Vec3::new(1.0, 0.8, 0.0), Vec3::new(0.0, 0.1, 1.0));
    image
}

/// Draws the masks on the photo: the plane is tinted green, lights are tinted yellow, true lamps are outlined in red.
fn masks(photo: &Photo, outcome: &Outcome) -> Image {
    let mut image = (*photo.image).clone();
    let mut tint = |mask: &Image, keep: f32, ink: Vec3| {
        for (pixel, _) in image.data.chunks_exact_mut(3).zip(&mask.data).filter(|(_, m)| **m > 0.5) {
            (Vec3::from_slice(pixel) * keep + ink).write_to_slice(pixel);
        }
    };
    if let Some(plane) = &outcome.results().plane {
        tint(&plane.mask, 0.4, Vec3::new(0.0, 0.15, 0.0));
    }
    if let Some(lights) = &outcome.results().lights {
        tint(&lights.mask, 0.1, Vec3::new(0.9, 0.7, 0.0));
    }
    // Make the outlines about one pixel of the panel wide.
    let lights = &photo.truth.lights;
    let (inner, outer) = (lights.dilated(1), lights.dilated(1 + (image.width / WIDTHS[1]).max(1) as u32));
    for (_, pixel) in image.data.chunks_exact_mut(3).enumerate().filter(|(i, _)| outer.on[*i] && !inner.on[*i]) {
        Vec3::new(1.0, 0.0, 0.05).write_to_slice(pixel);
    }
    image
}

fn empty_panel() -> Image {
    blank(64, 64)
}

fn blank(width: usize, height: usize) -> Image {
    Image::from_fn(width, height, |_, _| GROUND.to_array()).expect("an image")
}

fn scaled(image: &Image, factor: f32) -> Image {
    Image { data: image.data.iter().map(|v| v * factor).collect(), ..*image }
}

/// Resizes an image to the largest size that fits into a panel.
pub fn fitted(image: &Image, width: usize, height: usize) -> Image {
    let scale = (width as f64 / image.width as f64).min(height as f64 / image.height as f64);
    let side = |length: usize| ((length as f64 * scale).round() as usize).max(1);
    pyramid::resize(image, side(image.width), side(image.height), Monitor::default().job()).expect("a smaller image")
}

pub fn paste(onto: &mut Image, image: &Image, [left, top]: [usize; 2]) {
    for y in 0..image.height.min(onto.height.saturating_sub(top)) {
        let row = image.row(y);
        let at = ((top + y) * onto.width + left) * 3;
        onto.data[at..at + row.len()].copy_from_slice(row);
    }
}
