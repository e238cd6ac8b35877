//! Renders in parts: rectangles of the image and ranges of its paths, for many machines to share.
//!
//! [`run`] sums a part, [`File`] keeps its sums, [`merge`] adds those of all parts up to the image. Path number n of a pixel
//! is the same in every part, so that the parts make the very paths that one render of the whole in a single part makes, and
//! the image is the same but for the rounding of sums in f64 (`film::sums`), whatever the parts and their order.
//!
//! Pixels next to a part whose block it cuts are traced with it, for what their paths find: parts at multiples of 8 pixels
//! cost nothing extra. Otherwise a part cannot know what others have found. So all have a fixed number of paths: no target, no time budget. And how long
//! paths are follows from a few paths ahead of the image (`film::prepass`), not from those of the passes before as in
//! [`super::run`]; both are unbiased, but the images of the two differ within their errors.
//!
//! `cover` tells whether the parts are all there, `identity` whether they are of one render.

mod cover;
mod file;
mod identity;

pub use file::File;

use super::film::{Canvas, Sums, TILE};
use super::{Film, Params, World, check_camera, preview};
use crate::error::{Error, Result, check_range};
use crate::job::Job;
use crate::render::layers::Layers;
use crate::scene::Camera;
use identity::Identity;
use std::fmt;
use std::path::Path;

/// A rectangle of the image, in pixels from the top-left corner, and a range of the paths of each of its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
    /// Number of the first path.
    pub first: u32,
    pub samples: u32,
}

impl Part {
    /// All of an image in one part.
    pub fn whole(params: &Params) -> Self {
        Self { x: 0, y: 0, width: params.width, height: params.height, first: 0, samples: params.samples }
    }

    /// Part number `index` of `columns` × `rows` rectangles and `ranges` ranges of paths of about the same size. Rectangles
    /// go on row by row, and all of a range come before the next.
    pub fn split(params: &Params, [columns, rows, ranges]: [u32; 3], index: u32) -> Result<Self> {
        params.check()?;
        check_range("columns", columns as usize, 1, params.width)?;
        check_range("rows", rows as usize, 1, params.height)?;
        check_range("ranges", ranges, 1, params.samples)?;
        let count = u64::from(columns) * u64::from(rows) * u64::from(ranges);
        check_range("index", u64::from(index), 0, count - 1)?;
        let rectangle = (u64::from(index) % (u64::from(columns) * u64::from(rows))) as u32;
        let range = (u64::from(index) / (u64::from(columns) * u64::from(rows))) as u32;
        let [x, right] = [0, 1].map(|end| bound(params.width, columns, rectangle % columns + end, TILE));
        let [y, bottom] = [0, 1].map(|end| bound(params.height, rows, rectangle / columns + end, TILE));
        let [first, last] = [0, 1].map(|end| bound(params.samples as usize, ranges, range + end, 1) as u32);
        Ok(Self { x, y, width: right - x, height: bottom - y, first, samples: last - first })
    }

    pub fn has(&self, [x, y]: [usize; 2]) -> bool {
        x.wrapping_sub(self.x) < self.width && y.wrapping_sub(self.y) < self.height
    }

    fn check(&self, params: &Params) -> Result<()> {
        let within = |start: usize, size: usize, whole: usize| size > 0 && start < whole && size <= whole - start;
        let paths = (self.first as usize, self.samples as usize, params.samples as usize);
        if within(self.x, self.width, params.width)
            && within(self.y, self.height, params.height)
            && within(paths.0, paths.1, paths.2)
        {
            return Ok(());
        }
        Err(Error::argument(format!(
            "the part is {self}; it must have pixels and paths, all of them of an image of {} x {} pixels with samples = {}",
            params.width, params.height, params.samples
        )))
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { x, y, width, height, first, samples } = self;
        let last = first.saturating_add(*samples).saturating_sub(1);
        write!(f, "paths {first} to {last} of the {width} x {height} pixels at ({x}, {y})")
    }
}

/// Where one of `count` pieces begins: at multiples of a unit, where that changes little.
fn bound(size: usize, count: u32, piece: u32, unit: usize) -> usize {
    let exact = (size as u64 * u64::from(piece) / u64::from(count)) as usize;
    if exact == size || size / (count as usize) < 4 * unit { exact } else { exact / unit * unit }
}

/// A part that has been rendered.
pub struct Rendered {
    sums: Sums,
    identity: Identity,
    /// The image of the part alone.
    pub film: Film,
}

/// Renders a part. To be called on the library's own pool.
///
/// # Errors
/// Parameters out of range, or that let the number of paths depend on what they find; a part that is none of the image's; a
/// camera that cannot see; no memory; cancelled.
pub fn run(world: &World, camera: &Camera, params: &Params, part: &Part, job: Job) -> Result<Rendered> {
    check(camera, params)?;
    part.check(params)?;
    let guided = preview::guided(params);
    let sums = Sums::trace(world, camera, &guided, part, job.part(0.0, 0.9))?;
    let identity = Identity::new(world.scene(), camera, &guided);
    let film = film(world, camera, params, &sums, job.part(0.9, 1.0))?;
    Ok(Rendered { sums, identity, film })
}

impl Rendered {
    /// Writes the sums into a file; an existing one is replaced only by a complete one.
    pub fn save(&self, path: &Path) -> Result<()> {
        file::save(path, &self.sums, &self.identity, &self.film.beauty)
    }
}

/// Adds parts up to an image; the order of the files does not matter. The scene, the camera and the parameters are those the
/// parts were made with. To be called on the library's own pool.
///
/// # Errors
/// Parts of another render, by what is different; parts that overlap; paths that are in no part, by which; files that cannot
/// be read; what [`run`] refuses.
pub fn merge(world: &World, camera: &Camera, params: &Params, files: &[File], job: Job) -> Result<Film> {
    check(camera, params)?;
    let guided = preview::guided(params);
    let identity = Identity::new(world.scene(), camera, &guided);
    let layers = Layers::new(world, camera, &guided.outputs, 0, 0)?;
    let mut sums = Sums::new(&Part::whole(params), layers.as_ref())?;
    for file in files {
        file.check(&identity, sums.width(), params)?;
    }
    // Summed in an order of their own, they give the same bits in whatever order they come.
    for (done, &index) in cover::order(files, params, job)?.iter().enumerate() {
        let from = done as f64 / files.len() as f64;
        job.report(0.9 * from);
        job.check()?;
        sums.join(&files[index].read(layers.as_ref())?, layers.as_ref(), job)?;
    }
    film(world, camera, params, &sums, job.part(0.9, 1.0))
}

/// The image of sums.
fn film(world: &World, camera: &Camera, params: &Params, sums: &Sums, job: Job) -> Result<Film> {
    let guided = preview::guided(params);
    let canvas = Canvas::of_sums(world, camera, &guided, sums, job.part(0.0, 0.2))?;
    let mut film = canvas.film(job.part(0.2, 0.6))?;
    preview::add_preview(&mut film, &canvas, params, job.part(0.6, 1.0))?;
    job.report(1.0);
    Ok(film)
}

fn check(camera: &Camera, params: &Params) -> Result<()> {
    params.check()?;
    check_camera(camera)?;
    let milliseconds = params.time_budget_ms as f32;
    for (name, value) in [
        ("target_error", params.target_error),
        ("relative_error", params.relative_error),
        ("pixel_error", params.pixel_error),
        ("time_budget_ms", milliseconds),
    ] {
        if value != 0.0 {
            return Err(Error::argument(format!(
                "{name} is {value}; it must be 0 in a part, whose paths are fixed: set samples to what is needed"
            )));
        }
    }
    Ok(())
}
