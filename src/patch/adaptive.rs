//! A vote that blends where paint is smooth and keeps whole exemplar pixels where paint is rough.
//!
//! Where patches disagree, the mean of their pixels loses texture. The choice of one of their pixels instead leaves
//! steps along the seams: blocks in smooth paint, and staircases along silhouettes. This vote takes
//! `mean + t (choice - mean)`. The share t is such that the picture has as much fine detail as the exemplar.
//!
//! Fine detail is the power of the finest octave: the sum of squares, over a window, of the difference between an image
//! and its 3 × 3 binomial mean. Let M be this difference for the image of the means, and D for the image of (choice -
//! mean). The power of the blend is `Σ|M|² + 2t ΣM·D + t² Σ|D|²`. Equating it with the exemplar's power around the
//! sources of the chosen pixels gives a quadratic equation for t. Steps that the exemplar lacks make t smaller; texture
//! that the mean loses makes t greater. The window around a pixel holds all patches over the pixel, because these
//! patches form its mean.

use super::ballot::{Ballot, Candidate, common_offset};
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use std::ops::Range;

/// Size of the tiles that are voted on at once, in pixels.
const TILE: [usize; 2] = [128, 32];

/// Reconstructs each pixel of `out` for which `wanted` holds; pixels without a match keep their value.
pub(super) fn vote(out: &mut Image, ballot: &Ballot, job: Job, wanted: impl Fn(usize) -> bool + Sync) -> Result<()> {
    let (width, height, row_len) = (out.width, out.height, out.row_len());
    exec::for_runs(&mut out.data, TILE[1] * row_len, job, |first, rows| {
        let y = first / row_len;
        let y = y..(y + TILE[1]).min(height);
        for x in (0..width).step_by(TILE[0]) {
            let x = x..(x + TILE[0]).min(width);
            let is_wanted = y.clone().any(|y| x.clone().any(|x| wanted(y * width + x)));
            if is_wanted && job.check().is_ok() {
                let tile = VoteTile { ballot, size: [width, height], x, y: y.clone() };
                tile.paint(rows, &wanted);
            }
        }
    })?;
    // If the job was cancelled, some tiles are missing: return the error.
    job.check()
}

/// A rectangle of the picture, given by its columns `x` and rows `y`, that is voted on at once.
struct VoteTile<'a> {
    ballot: &'a Ballot<'a>,
    /// Size of the whole picture.
    size: [usize; 2],
    x: Range<usize>,
    y: Range<usize>,
}

/// The mean and the choice for each pixel of a rectangle of the picture.
struct Votes {
    x: Range<usize>,
    y: Range<usize>,
    channels: usize,
    mean: Vec<f32>,
    choice: Vec<f32>,
    /// Offset from the target pixel to the chosen exemplar pixel; `None` if no patch over the target pixel has a match.
    offset: Vec<Option<u32>>,
    /// Whether at least one pixel of the rectangle has more than one candidate.
    is_contested: bool,
}

/// Sums, over the pixels of a window, of products of fine details. The share of the choice follows from them.
#[derive(Clone, Copy, Default)]
struct Power {
    /// Power of the mean: `Σ|M|²`.
    mean: f64,
    /// Product of the fine details of the mean and of (choice - mean): `ΣM·D`.
    product: f64,
    /// Power of (choice - mean): `Σ|D|²`.
    difference: f64,
    /// Power of the exemplar's fine detail at the sources of the choice.
    exemplar: f64,
}

impl VoteTile<'_> {
    /// Paints the wanted pixels; `rows` holds the full rows of the tile.
    fn paint(&self, rows: &mut [f32], wanted: impl Fn(usize) -> bool) {
        let width = self.size[0];
        // The window reaches over all patches that cover a pixel, and the binomial mean one pixel farther.
        let radius = self.ballot.patch - 1;
        let votes = Votes::new(self.ballot, self.wider(radius + 1));
        let shares = if votes.is_contested { self.shares(&votes, radius) } else { Vec::new() };
        let channels = votes.channels;
        for (y, row) in self.y.clone().zip(rows.chunks_exact_mut(width * channels)) {
            for x in self.x.clone().filter(|x| wanted(y * width + x)) {
                let i = votes.index(x, y);
                if votes.offset[i].is_none() {
                    continue;
                }
                let share = shares.get((y - self.y.start) * self.x.len() + x - self.x.start).copied().unwrap_or(1.0);
                let (mean, choice) = (votes.pixel(&votes.mean, i), votes.pixel(&votes.choice, i));
                for ((out, m), c) in row[x * channels..(x + 1) * channels].iter_mut().zip(mean).zip(choice) {
                    *out = if share == 1.0 { *c } else { m + share * (c - m) };
                }
            }
        }
    }

    /// Returns the rectangle that is wider by `margin` on each side, inside the picture.
    fn wider(&self, margin: usize) -> [Range<usize>; 2] {
        let wider = |r: &Range<usize>, size: usize| r.start.saturating_sub(margin)..(r.end + margin).min(size);
        [wider(&self.x, self.size[0]), wider(&self.y, self.size[1])]
    }

    /// Returns the share t of the choice in the blend for each pixel of the tile, row by row.
    fn shares(&self, votes: &Votes, radius: usize) -> Vec<f32> {
        let [columns, rows] = self.wider(radius);
        let near = |v: usize, of: &Range<usize>| v.saturating_sub(radius).max(of.start)..(v + radius + 1).min(of.end);
        // Sum over the windows, along x and then along y.
        let mut along_x = vec![Power::default(); self.x.len() * rows.len()];
        let mut row = Vec::with_capacity(columns.len());
        for (y, sums) in rows.clone().zip(along_x.chunks_exact_mut(self.x.len())) {
            row.clear();
            row.extend(columns.clone().map(|x| votes.power(self.ballot, [x, y], self.size)));
            for (x, sum) in self.x.clone().zip(sums) {
                near(x, &columns).for_each(|x| sum.add(&row[x - columns.start]));
            }
        }
        let at = |x: usize, y: usize| &along_x[(y - rows.start) * self.x.len() + x];
        let mut shares = Vec::with_capacity(self.x.len() * self.y.len());
        for y in self.y.clone() {
            for x in 0..self.x.len() {
                let mut sum = Power::default();
                near(y, &rows).for_each(|y| sum.add(at(x, y)));
                shares.push(sum.share());
            }
        }
        shares
    }
}

impl Votes {
    fn new(ballot: &Ballot, [x, y]: [Range<usize>; 2]) -> Self {
        let (count, channels) = (x.len() * y.len(), ballot.style.channels);
        let (mean, choice) = (vec![0.0; count * channels], vec![0.0; count * channels]);
        let mut votes = Self { x, y, channels, mean, choice, offset: vec![None; count], is_contested: false };
        let mut candidates: Vec<Candidate> = Vec::with_capacity(ballot.patch * ballot.patch);
        for (i, at) in votes.y.clone().flat_map(|y| votes.x.clone().map(move |x| [x, y])).enumerate() {
            let range = i * channels..(i + 1) * channels;
            let mean = &mut votes.mean[range.clone()];
            let mut is_agreed = true;
            let offset = common_offset(ballot.field, ballot.patch, at).or_else(|| {
                ballot.collect(&mut candidates, at, false);
                if candidates.len() > 1 {
                    (votes.is_contested, is_agreed) = (true, false);
                    ballot.mean(&candidates, at, mean);
                }
                ballot.choose(&candidates, at, mean, true)
            });
            votes.offset[i] = offset;
            if let Some(offset) = offset {
                let colour = ballot.colour(offset, at);
                votes.choice[range].copy_from_slice(colour);
                if is_agreed {
                    mean.copy_from_slice(colour);
                }
            }
        }
        votes
    }

    fn index(&self, x: usize, y: usize) -> usize {
        (y - self.y.start) * self.x.len() + x - self.x.start
    }

    /// Returns the channels of pixel `i` in `of`, which is `mean` or `choice`.
    fn pixel<'a>(&self, of: &'a [f32], i: usize) -> &'a [f32] {
        &of[i * self.channels..(i + 1) * self.channels]
    }

    /// Returns the power of fine detail in one pixel of a picture of the given size; zeros if a neighbour has no match.
    fn power(&self, ballot: &Ballot, [x, y]: [usize; 2], [width, height]: [usize; 2]) -> Power {
        let at = around([x, y], [width, height]).map(|(x, y)| self.index(x, y));
        let Some(offset) = self.offset[at[CENTRE]].filter(|_| at.iter().all(|&i| self.offset[i].is_some())) else {
            return Power::default();
        };
        let (style, (u, v)) = (ballot.style, Ballot::source(offset, [x, y]));
        let sources = around([u, v], [style.width, style.height]).map(|(u, v)| v * style.width + u);
        let mut power = Power::default();
        for c in 0..self.channels {
            let detail = |of: &[f32], at: &[usize; 9]| -> f64 {
                let mean: f32 = at.iter().zip(BINOMIAL).map(|(i, weight)| weight * of[i * self.channels + c]).sum();
                f64::from(of[at[CENTRE] * self.channels + c] - mean)
            };
            let (mean, choice, exemplar) =
                (detail(&self.mean, &at), detail(&self.choice, &at), detail(&style.data, &sources));
            let difference = choice - mean;
            power.add(&Power {
                mean: mean * mean,
                product: mean * difference,
                difference: difference * difference,
                exemplar: exemplar * exemplar,
            });
        }
        power
    }
}

/// Weights of the 3 × 3 binomial mean, and the index of its centre. [convention]
const BINOMIAL: [f32; 9] = [0.0625, 0.125, 0.0625, 0.125, 0.25, 0.125, 0.0625, 0.125, 0.0625];
const CENTRE: usize = 4;

/// Returns the positions of a pixel and its eight neighbours; at the border of the image, the border's pixels repeat.
fn around([x, y]: [usize; 2], [width, height]: [usize; 2]) -> [(usize, usize); 9] {
    let near = |v: usize, size: usize| [v.saturating_sub(1), v, (v + 1).min(size - 1)];
    let (columns, rows) = (near(x, width), near(y, height));
    std::array::from_fn(|i| (columns[i % 3], rows[i / 3]))
}

impl Power {
    fn add(&mut self, other: &Self) {
        self.mean += other.mean;
        self.product += other.product;
        self.difference += other.difference;
        self.exemplar += other.exemplar;
    }

    /// Returns the greatest share of the choice, in `[0, 1]`, for which the power of the blend is at most the
    /// exemplar's. If the blend has more power at every share, returns the share at which its power is smallest.
    fn share(&self) -> f32 {
        let surplus = self.mean - self.exemplar;
        let root = (self.product * self.product - self.difference * surplus).max(0.0).sqrt();
        // Where mean and choice have the same fine detail (D = 0), t does not change the detail: keep whole pixels.
        let share = if self.difference > 0.0 { (root - self.product) / self.difference } else { 1.0 };
        share.clamp(0.0, 1.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::patch::{Field, VoteMode, pack, vote};
    use crate::rng::Rng;

    const PATCH: usize = 5;

    /// Paints a picture of 60 x 40 pixels from two pieces of an exemplar that meet along a line. Left of the line, the
    /// pixel (x, y) shows the exemplar at (x, y + 20); right of it, at (x + 60, y).
    fn two_pieces(style: &Image, mode: VoteMode) -> Image {
        let (width, height) = (60 + 1 - PATCH, 40 + 1 - PATCH);
        let mut field = Field::new(width, height).unwrap();
        for i in 0..width * height {
            let (x, y) = (i % width, i / width);
            field.at[i] = if 3 * x > 2 * y + 60 { pack(x + 60, y) } else { pack(x, y + 20) };
            field.error[i] = 1;
        }
        let mut out = Image::new(60, 40, style.channels).unwrap();
        vote(&mut out, &field, style, PATCH, mode, Monitor::default().job(), |_| true).unwrap();
        out
    }

    /// Power of fine detail near the line where the pieces meet: mean square of the Laplacian.
    fn detail(image: &Image) -> f64 {
        let at = |x: usize, y: usize| f64::from(image.pixel(x, y)[0]);
        let is_near = |x: usize, y: usize| (3 * x as isize - 2 * y as isize - 66).abs() < 12;
        let inside = (1..image.height - 1).flat_map(|y| (1..image.width - 1).map(move |x| (x, y)));
        let laplacian = |(x, y)| at(x - 1, y) + at(x + 1, y) + at(x, y - 1) + at(x, y + 1) - 4.0 * at(x, y);
        let squares: Vec<f64> = inside.filter(|(x, y)| is_near(*x, *y)).map(|p| laplacian(p).powi(2)).collect();
        squares.iter().sum::<f64>() / squares.len() as f64
    }

    #[test]
    fn the_share_gives_the_blend_the_power_of_the_exemplar() {
        let mut rng = Rng::new(4, &[]);
        let mut exact = 0;
        for _ in 0..1000 {
            // Let the details M = (a, b) and D = (c, d) be vectors of two components, so that all products can occur.
            let [a, b, c, d, exemplar] = [(); 5].map(|()| f64::from(rng.next_f32()) * 2.0 - 1.0);
            let power = Power {
                mean: a * a + b * b,
                product: a * c + b * d,
                difference: c * c + d * d,
                exemplar: exemplar.abs(),
            };
            let surplus = |t: f64| (a + t * c).powi(2) + (b + t * d).powi(2) - power.exemplar;
            let share = f64::from(power.share());
            assert!((0.0..=1.0).contains(&share));
            exact += usize::from(surplus(share).abs() < 1e-6);
            let others = (0..=100).map(|k| f64::from(k) / 100.0);
            let least = others.clone().map(surplus).fold(f64::INFINITY, f64::min);
            assert!(surplus(share) < 1e-6 || surplus(share) < least + 1e-6, "{share}");
            assert!(others.filter(|&t| surplus(t) < 0.0).all(|t| t <= share + 1e-6), "{share}");
        }
        assert!(exact > 100, "{exact}");
        assert_eq!(Power::default().share(), 1.0);
    }

    #[test]
    fn smooth_paint_has_no_step_where_two_pieces_meet() {
        // Two ramps of equal slopes. At equal positions relative to their origins, (0, 20) and (60, 0), they differ by
        // 0.1. `two_pieces` places them side by side at such positions.
        let style = Image::from_fn(140, 60, |x, y| {
            let piece = if x < 60 { [x as f32, y as f32 - 20.0, 0.3] } else { [x as f32 - 60.0, y as f32, 0.4] };
            [piece[2] + 0.002 * piece[0] + 0.001 * piece[1]]
        })
        .unwrap();
        let step = |mode| {
            let image = two_pieces(&style, mode);
            let row = image.row(20);
            row.windows(2).map(|p| (p[1] - p[0]).abs()).fold(0.0, f32::max)
        };
        assert!(step(VoteMode::Majority) > 0.1);
        assert!(step(VoteMode::Adaptive) < 0.035, "{}", step(VoteMode::Adaptive));
        let fine = |mode| detail(&two_pieces(&style, mode));
        assert!(fine(VoteMode::Adaptive) < 0.1 * fine(VoteMode::Majority));
    }

    #[test]
    fn rough_paint_keeps_its_detail_where_two_pieces_meet() {
        let mut rng = Rng::new(7, &[]);
        let noise: Vec<f32> = (0..140 * 60).map(|_| 0.3 + 0.4 * rng.next_f32()).collect();
        let style = Image::from_fn(140, 60, |x, y| [noise[y * 140 + x]]).unwrap();
        let fine = |mode| detail(&two_pieces(&style, mode));
        // In noise, a seam between whole pixels is not visible as a step: the choice has as much detail as the
        // exemplar.
        let [choice, mean, adaptive] = [VoteMode::Majority, VoteMode::Weighted, VoteMode::Adaptive].map(fine);
        // The weighted mean of two independent pixels has on average about 0.6 times their detail. About half of the
        // pixels near the line are means of pixels from both pieces.
        assert!(mean < 0.85 * choice, "{mean} {choice}");
        assert!((adaptive / choice - 1.0).abs() < 0.1, "{adaptive} {choice}");
        // Where all patches agree on a pixel, the vote returns the style's colour exactly.
        let image = two_pieces(&style, VoteMode::Adaptive);
        assert_eq!(image.pixel(3, 3), style.pixel(3, 23));
        assert_eq!(image.pixel(55, 3), style.pixel(115, 3));
    }

    #[test]
    fn a_part_of_a_picture_equals_the_whole() {
        let mut rng = Rng::new(9, &[]);
        let style = Image::from_fn(300, 90, |x, y| [((x * y) as f32 * 0.01).sin() * 0.4 + 0.5; 3]).unwrap();
        let mut field = Field::new(200 + 1 - PATCH, 80 + 1 - PATCH).unwrap();
        field.at.iter_mut().for_each(|at| *at = pack(rng.below(290), rng.below(80)));
        field.error.iter_mut().for_each(|error| *error = rng.below(50) as u32);
        let paint = |wanted: &(dyn Fn(usize) -> bool + Sync)| {
            let mut out = Image::new(200, 80, 3).unwrap();
            vote(&mut out, &field, &style, PATCH, VoteMode::Adaptive, Monitor::default().job(), wanted).unwrap();
            out
        };
        let whole = paint(&|_| true);
        let inside = |i: usize| (120..140).contains(&(i % 200)) && (25..50).contains(&(i / 200));
        let part = paint(&inside);
        for i in 0..200 * 80 {
            let expected = if inside(i) { whole.pixel(i % 200, i / 200) } else { &[0.0; 3] };
            assert_eq!(part.pixel(i % 200, i / 200), expected);
        }
    }
}
