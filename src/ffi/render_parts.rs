//! Renderings in parts
//!
//! Renders an image on several machines. A part is a rectangle of the image and a range of its paths. Each machine
//! renders parts into files, and one machine merges the files. The result equals the image that one machine renders as
//! a single part, for any division into parts and any order, except for the rounding of sums in double precision. A
//! lost part can be rendered again; the new part equals the lost part to the bit. An image of luxfer_render_start has
//! equal expected values, but different noise.
//!
//! A part has a fixed number of paths: target_error, relative_error, pixel_error and time_budget_ms must be 0. All
//! parts and the merge must use the same scene, camera, layers and luxfer_render_params; the merge checks this.
//!
//! The files are OpenEXR: R, G, B show the part at its place in the image, and integer channels store its sums.

use super::guard::enter;
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::text;
use super::render::{luxfer_render, luxfer_render_params};
use super::status::luxfer_status;
use crate::error::Result;
use crate::image::io;
use crate::render::parts::{self, Part};
use crate::render::{Film, Params};
use std::ffi::c_char;
use std::path::{Path, PathBuf};

/// A part of a rendering. Fill it with luxfer_render_part_init, which sets it to the whole rendering, or with
/// luxfer_render_split.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_render_part {
    /// sizeof(luxfer_render_part), set by luxfer_render_part_init.
    pub struct_size: u32,
    /// Column of the first pixel; default 0.
    pub x: u32,
    /// Row of the first pixel, from the top; default 0.
    pub y: u32,
    /// Width in pixels; default 0: up to the right edge of the image.
    pub width: u32,
    /// Height in pixels; default 0: up to the bottom edge of the image.
    pub height: u32,
    /// Index of the first path of each pixel, from 0; default 0.
    pub first_sample: u32,
    /// Paths per pixel; default 0: all paths from first_sample up to luxfer_render_params.samples.
    pub samples: u32,
}

versioned!(luxfer_render_part, [28], {
    Self { struct_size: 28, x: 0, y: 0, width: 0, height: 0, first_sample: 0, samples: 0 }
});

impl luxfer_render_part {
    fn part(&self, params: &Params) -> Part {
        let (x, y, first) = (self.x as usize, self.y as usize, self.first_sample);
        Part {
            x,
            y,
            width: if self.width == 0 { params.width.saturating_sub(x) } else { self.width as usize },
            height: if self.height == 0 { params.height.saturating_sub(y) } else { self.height as usize },
            first,
            samples: if self.samples == 0 { params.samples.saturating_sub(first) } else { self.samples },
        }
    }
}

/// Gets one part of a rendering. The image is split into columns x rows rectangles, and the paths of each pixel are
/// split into a number of ranges; all parts have about equal size. index is less than columns * rows * ranges. It
/// numbers first the parts with the first range of paths, rectangle by rectangle and row by row, then the parts with
/// the second range, and so on. params may be NULL for the defaults. size is sizeof *part. Any thread.
/// LUXFER_INVALID_ARGUMENT if there is no such part, or if some parts would be empty because there are more columns,
/// rows or ranges than pixels or paths to split.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_split(
    render: *mut luxfer_render,
    params: *const luxfer_render_params,
    columns: u32,
    rows: u32,
    ranges: u32,
    index: u32,
    part: *mut luxfer_render_part,
    size: usize,
) -> luxfer_status {
    enter(render, |_| {
        let out = Report::new(part, size)?;
        let part = Part::split(&params::read(params)?.params()?, [columns, rows, ranges], index)?;
        out.set(luxfer_render_part {
            x: part.x as u32,
            y: part.y as u32,
            width: part.width as u32,
            height: part.height as u32,
            first_sample: part.first,
            samples: part.samples,
            ..luxfer_render_part::defaults()
        });
        Ok(())
    })
}

/// Starts a job that renders a part, or the whole image if part is NULL, and writes it into a file. path is UTF-8, and
/// an existing file is replaced only once the new one is complete. Afterwards the images of the rendering show this
/// part alone. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_NOT_FOUND if no camera is set
/// and the scene has no camera. The job may end with LUXFER_INVALID_ARGUMENT if a setting is out of range, if the
/// settings have an error target or a time budget, or if the part exceeds the image; LUXFER_IO if the file cannot be
/// written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_start_part(
    render: *mut luxfer_render,
    params: *const luxfer_render_params,
    part: *const luxfer_render_part,
    path: *const c_char,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(render, |stage| {
        let snapshot = stage.inputs().snapshot(params)?;
        let part = params::read(part)?.part(&snapshot.params);
        let path = PathBuf::from(text(path, "path")?);
        // Find out before the rendering, not after hours, whether the file can be written.
        io::Target::new(&path)?;
        stage.start(job, move |_, _, job| {
            let world = snapshot.world(job.part(0.0, 0.05))?;
            let rendered = parts::run(&world, &snapshot.camera, &snapshot.params, &part, job.part(0.05, 0.99))?;
            rendered.save(&path)?;
            Ok(rendered.film)
        })
    })
}

/// Adds a file that luxfer_render_start_part has written to the list of files to merge. path is UTF-8. The call reads
/// only the header of the file; the merge reads the pixels. Any thread.
/// LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is not a part of a rendering; LUXFER_INVALID_OPERATION
/// while a job runs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_add_part(render: *mut luxfer_render, path: *const c_char) -> luxfer_status {
    enter(render, |stage| {
        let file = parts::File::open(Path::new(text(path, "path")?))?;
        stage.change(|inputs| {
            inputs.parts.push(file);
            Ok(())
        })
    })
}

/// Empties the list of files to merge, which luxfer_render_add_part fills. The files stay on the disk. Any thread.
/// LUXFER_INVALID_OPERATION while a job runs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_clear_parts(render: *mut luxfer_render) -> luxfer_status {
    enter(render, |stage| {
        stage.change(|inputs| {
            inputs.parts.clear();
            Ok(())
        })
    })
}

/// Starts a job that merges the files of luxfer_render_add_part. Afterwards the merged images and layers can be read by
/// the functions that read the results of luxfer_render_start. params may be NULL for the defaults. The caller releases
/// *job. Any thread.
/// LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_NOT_FOUND if no camera is set
/// and the scene has no camera. The job may end with LUXFER_INVALID_ARGUMENT if a file belongs to another rendering or
/// another scene, if parts overlap, or if paths are missing: the message names the first gap; LUXFER_IO or
/// LUXFER_FORMAT if a file cannot be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_start_merge(
    render: *mut luxfer_render,
    params: *const luxfer_render_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(render, |stage| {
        let inputs = stage.inputs();
        let (snapshot, files) = (inputs.snapshot(params)?, inputs.parts);
        stage.start(job, move |_, _, job| -> Result<Film> {
            let world = snapshot.world(job.part(0.0, 0.1))?;
            parts::merge(&world, &snapshot.camera, &snapshot.params, &files, job.part(0.1, 1.0))
        })
    })
}
