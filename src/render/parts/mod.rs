//! Renders in parts, for distribution to many machines. A part is a rectangle of the image, with a range of the paths
//! of each of its pixels.
//!
//! [`run`] computes the sums of a part, a [`File`] stores them, and [`merge`] adds up the sums of all parts to an
//! image. Path number n of a pixel is the same in every partition. The merged image therefore equals a render in one
//! part, for any partition and order, up to the rounding of f64 sums (`film::sums`).
//!
//! The pixels of a block (4 × 2 or 2 × 4 pixels, `film::block`) share secondary vertices. If the border of a part cuts
//! a block, rendering the part therefore also traces the pixels of the block outside the part. Borders at multiples of
//! 8 pixels cut no block.
//!
//! A part does not depend on the results of other parts. All parts therefore have a fixed number of paths, without
//! error targets or a time budget. Their weights for Russian roulette come from a prepass (`film::prepass`), whereas
//! [`super::run`] takes these weights from its previous passes. Both ways give unbiased images, but these images
//! differ by their noise.
//!
//! `cover` checks that the parts are complete; `identity` checks that they belong to one render.

mod cover;
mod file;
mod identity;

pub use super::film::Part;
pub use file::File;

use super::film::{Accumulator, Sums};
use super::output::Film;
use super::params::{Params, check_camera};
use super::preview;
use super::world::World;
use crate::error::{Error, Result};
use crate::job::Job;
use crate::render::layers::Layers;
use crate::scene::Camera;
use identity::Identity;
use std::path::Path;

/// The sums and the image of a rendered part.
pub struct Rendered {
    sums: Sums,
    identity: Identity,
    /// The image of the part alone.
    pub film: Film,
}

/// Renders a part of an image. Call it on the library's own thread pool.
///
/// # Errors
/// Parameters out of range; parameters that set an error target or a time budget; a part outside the image; a
/// degenerate camera; no memory; cancelled.
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
    /// Writes the sums of the part to a file. An existing file is replaced only when the new one is complete.
    pub fn save(&self, path: &Path) -> Result<()> {
        file::save(path, &self.sums, &self.identity, &self.film.beauty)
    }
}

/// Merges the files of all parts, in any order, into the image. The scene, the camera and the parameters must equal the
/// scene, camera and parameters of the parts. Call it on the library's own thread pool.
///
/// # Errors
/// Parts of another render (the message names the difference); overlapping parts; missing paths (the message names the
/// first hole); unreadable files; the errors of [`run`].
pub fn merge(world: &World, camera: &Camera, params: &Params, files: &[File], job: Job) -> Result<Film> {
    check(camera, params)?;
    let guided = preview::guided(params);
    let identity = Identity::new(world.scene(), camera, &guided);
    let layers = Layers::new(world, camera, &guided.outputs, 0, 0)?;
    let mut sums = Sums::new(&Part::whole(params), layers.as_ref())?;
    for file in files {
        file.check(&identity, sums.numbers_per_pixel(), params)?;
    }
    // Add up the parts in a fixed order, so that the order of the files does not change the image by a single bit.
    for (done, &index) in cover::order(files, params, job)?.iter().enumerate() {
        let from = done as f64 / files.len() as f64;
        job.report(0.9 * from);
        job.check()?;
        sums.join(&files[index].read(layers.as_ref())?, layers.as_ref(), job)?;
    }
    film(world, camera, params, &sums, job.part(0.9, 1.0))
}

/// Computes the film of a part, or of the merged parts, from the sums.
fn film(world: &World, camera: &Camera, params: &Params, sums: &Sums, job: Job) -> Result<Film> {
    let guided = preview::guided(params);
    let accumulator = Accumulator::of_sums(world, camera, &guided, sums, job.part(0.0, 0.2))?;
    let mut film = accumulator.film(job.part(0.2, 0.6))?;
    preview::add_preview(&mut film, &accumulator, params, job.part(0.6, 1.0))?;
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
