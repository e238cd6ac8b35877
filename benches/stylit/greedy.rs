//! The algorithm of Hertzmann et al., "Image Analogies" (2001): sets each pixel once, in scan order.

use super::earlier::{Matcher, PATCH};
use luxfer::image::Image;
use luxfer::job::Job;
use luxfer::patch::{Domain, Field, NONE, SearchIteration, pack, unpack};

/// Coherence parameter κ. A coherent match is taken if its distance is less than (1 + κ / 2^l) times the distance of
/// the nearest match, where l is the pyramid level, 0 for the finest. The paper uses 2 to 25 for painted styles in
/// colour, and 0.5 to 5 for textures. [paper: Hertzmann et al. 2001, §3.2]
const COHERENCE: f64 = 5.0;

/// Paints the centre of every patch in scan order, from the patch's nearest match or from a coherent match, which
/// continues the match of a neighbour painted earlier.
pub fn rematch_and_paint(matcher: &mut Matcher, field: &mut Field, picture: &mut Image, l: usize, job: Job) {
    let iteration = SearchIteration { index: 0, radius: 64, initial_samples: 4 };
    matcher.search().iterate(field, iteration, job, |_| true).expect("nobody cancels");
    let (half, style) = (PATCH / 2, matcher.style);
    for i in 0..field.at.len() {
        let (x, y) = (i % field.width, i / field.width);
        let search = matcher.search();
        let (px, py) = unpack(field.at[i]);
        let nearest = search.distance(x, y, px, py, u32::MAX);
        let mut limit = (f64::from(nearest) * (1.0 + COHERENCE * 0.5f64.powi(l as i32))) as u32;
        let mut best = (px, py);
        for (cx, cy) in continued(field, &matcher.allowed, x as isize, y as isize) {
            let distance = search.distance(x, y, cx, cy, limit);
            if distance < limit {
                (limit, best) = (distance, (cx, cy));
            }
        }
        field.at[i] = pack(best.0, best.1);
        field.error[i] = search.distance(x, y, best.0, best.1, u32::MAX);
        // Later patches are compared with this pixel.
        let colour = style.pixel(best.0 + half, best.1 + half);
        picture.pixel_mut(x + half, y + half).copy_from_slice(colour);
        let start = ((y + half) * matcher.target.width + x + half) * matcher.target.lanes;
        for ((out, q), v) in matcher.target.data[start..].iter_mut().zip(&matcher.colours).zip(colour) {
            *out = q.quantise(*v);
        }
    }
}

/// The positions that continue the matches of the neighbours painted so far: three in the row above, one to the left.
fn continued(field: &Field, allowed: &Domain, x: isize, y: isize) -> Vec<(usize, usize)> {
    let candidates = [(-1, 0), (-1, -1), (0, -1), (1, -1)].into_iter().filter_map(|(dx, dy)| {
        let (nx, ny) = (x + dx, y + dy);
        if nx < 0 || ny < 0 || nx as usize >= field.width {
            return None;
        }
        let at = field.at[ny as usize * field.width + nx as usize];
        let (sx, sy) = unpack(at);
        let (cx, cy) = ((sx as isize - dx) as usize, (sy as isize - dy) as usize);
        // A negative position has wrapped around.
        (at != NONE && cx < allowed.width && cy < allowed.height).then_some((cx, cy))
    });
    candidates.collect()
}
