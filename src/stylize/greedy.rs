//! The algorithm of Hertzmann et al., "Image Analogies" (2001), for comparison: sets each pixel once, in scan order.

use super::level::Level;
use crate::error::Result;
use crate::image::Image;
use crate::job::Job;
use crate::patch::{Field, NONE, pack, unpack};

/// Coherence parameter κ. A coherent match is taken if its distance is less than (1 + κ / 2^l) times the distance of
/// the nearest match, where l is the pyramid level, 0 for the finest. The paper uses 2 to 25 for painted styles in
/// colour, and 0.5 to 5 for textures. [paper: Hertzmann et al. 2001, §3.2]
const COHERENCE: f64 = 5.0;

/// Paints the centre of every patch in scan order, from the patch's nearest match or from a coherent match, which
/// continues the match of a neighbour painted earlier. A coherent match is preferred if its distance is within the
/// tolerance of `COHERENCE`. `depth` is the pyramid level. Each pixel depends on the pixels before it, so the function
/// runs on one thread.
pub(super) fn run(level: &mut Level, field: &mut Field, picture: &mut Image, depth: usize, job: Job) -> Result<()> {
    let patch = level.problem.patch;
    let half = patch / 2;
    let tolerance = 1.0 + COHERENCE * 0.5f64.powi(depth as i32);
    let style = &level.problem.style;
    for y in 0..field.height {
        job.check()?;
        for x in 0..field.width {
            let i = y * field.width + x;
            if !level.wanted.contains_index(i) || field.at[i] == NONE {
                continue;
            }
            let search = level.forward();
            let (mut px, mut py) = unpack(field.at[i]);
            let nearest = search.distance(x, y, px, py, u32::MAX);
            let mut limit = (f64::from(nearest) * tolerance).min(f64::from(u32::MAX)) as u32;

            // Try to continue the matches of the neighbours painted so far: three in the row above and one to the
            // left.
            for (dx, dy) in [(-1isize, 0isize), (-1, -1), (0, -1), (1, -1)] {
                let (nx, ny) = (x as isize + dx, y as isize + dy);
                if nx < 0 || ny < 0 || nx as usize >= field.width {
                    continue;
                }
                let neighbour = field.at[ny as usize * field.width + nx as usize];
                let (sx, sy) = unpack(neighbour);
                let (cx, cy) = (sx as isize - dx, sy as isize - dy);
                if neighbour == NONE
                    || cx < 0
                    || cx as usize >= level.allowed.width
                    || cy as usize >= level.allowed.height
                    || !level.allowed.contains(cx as usize, cy as usize)
                {
                    continue;
                }
                let distance = search.distance(x, y, cx as usize, cy as usize, limit);
                if distance < limit {
                    (limit, px, py) = (distance, cx as usize, cy as usize);
                }
            }
            field.at[i] = pack(px, py);
            field.error[i] = search.distance(x, y, px, py, u32::MAX);
            let colour = style.pixel(px + half, py + half);
            picture.pixel_mut(x + half, y + half).copy_from_slice(colour);
            level.set_pixel(x + half, y + half, colour);
        }
        job.report((y + 1) as f64 / field.height as f64);
    }
    Ok(())
}
