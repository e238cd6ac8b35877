//! Checks that the parts of a render cover its image: each path of each pixel must belong to exactly one part.

use super::Part;
use super::file::File;
use crate::error::{Error, Result};
use crate::image::try_vec;
use crate::job::Job;
use crate::render::params::Params;

/// Checks that the parts cover the image. Returns the order in which to add up the parts: by their first path, then
/// from top to bottom, then from left to right.
pub fn order(files: &[File], params: &Params, job: Job) -> Result<Vec<usize>> {
    check_overlaps(files, job)?;
    check_holes(files, params, job)?;
    let mut order: Vec<usize> = (0..files.len()).collect();
    order.sort_by_key(|&i| (files[i].part.first, files[i].part.y, files[i].part.x));
    Ok(order)
}

/// Returns an error if two parts share a path of a pixel. Tests each pair of parts that share a row of pixels.
fn check_overlaps(files: &[File], job: Job) -> Result<()> {
    let mut by_row: Vec<&File> = files.iter().collect();
    by_row.sort_by_key(|f| f.part.y);
    for (i, a) in by_row.iter().enumerate() {
        job.check()?;
        let below = by_row[i + 1..].iter().take_while(|b| b.part.y < a.part.y + a.part.height);
        if let Some(b) = below.into_iter().find(|b| overlap(&a.part, &b.part)) {
            return Err(Error::argument(format!(
                "{} has {}, and {} has {}: they overlap; give each path once",
                a.name(),
                a.part,
                b.name(),
                b.part
            )));
        }
    }
    Ok(())
}

fn overlap(a: &Part, b: &Part) -> bool {
    let meet = |a: usize, a_size: usize, b: usize, b_size: usize| a < b + b_size && b < a + a_size;
    let paths = |p: &Part| (p.first as usize, p.samples as usize);
    meet(a.x, a.width, b.x, b.width)
        && meet(a.y, a.height, b.y, b.height)
        && meet(paths(a).0, paths(a).1, paths(b).0, paths(b).1)
}

/// Returns an error if a path of a pixel belongs to no part. As the parts do not overlap, it is enough to count the
/// paths that the parts hold for each pixel. A path is missing if this count is less than the requested number.
fn check_holes(files: &[File], params: &Params, job: Job) -> Result<()> {
    let (width, height) = (params.width, params.height);
    let mut counts = try_vec(width * height, 0u32)?;
    for Part { x, y, width: part_width, height: part_height, samples, .. } in files.iter().map(|f| f.part) {
        job.check()?;
        for row in counts.chunks_exact_mut(width).skip(y).take(part_height) {
            row[x..x + part_width].iter_mut().for_each(|count| *count += samples);
        }
    }
    let Some(hole) = counts.iter().position(|&count| count < params.samples) else { return Ok(()) };
    // Find the first range of paths that the pixel `hole` lacks. Then find how many pixels to its right, and how many
    // below it, lack the same range. These two numbers are the size of the rectangle in the message.
    let (x, y) = (hole % width, hole / width);
    let missing_at = |at: [usize; 2]| {
        let mut ranges: Vec<(u32, u32)> =
            files.iter().filter(|f| f.part.has(at)).map(|f| (f.part.first, f.part.first + f.part.samples)).collect();
        ranges.sort_unstable();
        ranges.push((params.samples, params.samples));
        let mut next = 0;
        for (first, end) in ranges {
            if next < first {
                return Some((next, first));
            }
            next = end;
        }
        None
    };
    let Some((first, end)) = missing_at([x, y]) else { return Ok(()) };
    let alike = |at: [usize; 2]| missing_at(at) == Some((first, end));
    let across = (x..width).take_while(|&x| alike([x, y])).count();
    let down = (y..height).take_while(|&y| alike([x, y])).count();
    let part = Part { x, y, width: across, height: down, first, samples: end - first };
    Err(Error::argument(format!("no part has {part}, among others: render what is missing and add its file")))
}
