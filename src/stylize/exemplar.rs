//! Doubts about the exemplar: places of similar guides that are painted differently.
//!
//! The exemplar is divided into blocks. Only blocks in which the guides are nearly constant are examined. If several
//! blocks have equal guides, a stylisation cannot distinguish their paint, so it mixes their paint. Two defects show in
//! the mean paint of the blocks:
//!
//! - A blemish, such as a stain: a block is unlike all blocks elsewhere with similar guides.
//! - Two paints for one light: of the blocks elsewhere with equal guides, a quarter or more differ clearly from the
//!   median paint of all of them.
//!
//! Both are measured in units of the medium's grain: the typical difference between the mean paint of a block and the
//! median paint of all blocks with equal guides.

use super::guides::SIMILAR;
use super::level::Problem;
use crate::error::Result;
use crate::exec;
use crate::image::try_with_capacity;
use crate::job::Job;
use crate::maths;

/// Number of blocks along the longer side of the exemplar, and the minimum side of a block in pixels.
const BLOCKS: usize = 48;
const MIN_SIDE: usize = 6;
/// The guides of two blocks are equal if they differ by at most this much, as a weighted root mean square of channels
/// in `[0, 1]`. Blocks within which the guides deviate from their mean by more are left out. [bench stylit:doubts]
const EQUAL: f32 = 0.03;
/// A block counts as elsewhere if it is more than this number of columns or rows of blocks away. A defect of a block
/// may extend over nearer blocks.
const NEAR: usize = 3;
/// Minimum number of blocks elsewhere with which a block is compared: blocks of equal guides for
/// [`Compared::spread`], blocks of similar guides for [`Compared::own`].
const MIN_OTHERS: usize = 16;
/// Minimum grain, in units of the display encoding (white = 1). Flat paint has less grain and would make any
/// difference look large. [bench stylit:doubts]
const MIN_GRAIN: f32 = 0.015;
/// The light of a block counts as painted in two ways if the upper quartile in [`Compared::spread`] is above this, in
/// grains. [bench stylit:doubts]
const TWO_PAINTS: f32 = 4.0;

/// Defects of the exemplar, with their places in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Doubts {
    /// The largest difference between a block and the blocks elsewhere with similar guides, in grains; and the centre
    /// of this block in pixels. The difference of a block is the 5 % quantile over the blocks with which it is
    /// compared.
    pub blemish: f64,
    pub blemish_at: Option<[usize; 2]>,
    /// Share of the blocks whose light has two paints, among the blocks with at least `MIN_OTHERS` blocks of equal
    /// guides elsewhere; and the centre of the block at which the paints differ most.
    pub ambiguous: f64,
    pub ambiguous_at: Option<[usize; 2]>,
}

/// The blocks of the exemplar within which the guides are nearly constant: they deviate from their mean by at most
/// [`EQUAL`].
struct Blocks {
    side: usize,
    /// Number of channels of the guides.
    channels: usize,
    /// Column and row of each block.
    at: Vec<[usize; 2]>,
    /// Means of the guides, each multiplied by the square root of its weight.
    guides: Vec<f32>,
    /// Mean paint; unused channels are 0.
    paint: Vec<[f32; 4]>,
}

/// A block compared with the blocks elsewhere.
#[derive(Clone, Copy, Default)]
struct Compared {
    /// The blocks elsewhere with equal guides have a median paint. `spread` is the median and the upper quartile of
    /// the differences of their paint from this median paint. `None` if there are too few of these blocks.
    spread: Option<[f32; 2]>,
    /// 5 % quantile of the differences between the block's paint and the paint of the blocks elsewhere with similar
    /// guides. It is large only if hardly any of the compared blocks has similar paint. 0 if there are too few blocks
    /// to compare.
    own: f32,
}

/// Looks for defects of the exemplar.
pub(super) fn examine(problem: &Problem, job: Job) -> Result<Doubts> {
    let blocks = Blocks::of(problem, job)?;
    let compared = exec::map(blocks.at.len(), job, |i| blocks.compare(i))?;
    let mut grains: Vec<f32> = compared.iter().filter_map(|c| c.spread).map(|[median, _]| median).collect();
    if grains.is_empty() {
        return Ok(Doubts::default());
    }
    let grain = quantile(&mut grains, 50).max(MIN_GRAIN);
    let quartile = |c: &Compared| c.spread.map_or(0.0, |[_, quartile]| quartile / grain);
    let worst = |measure: &dyn Fn(&Compared) -> f32| {
        let ranked = (0..compared.len()).rev().max_by(|&a, &b| measure(&compared[a]).total_cmp(&measure(&compared[b])));
        ranked.map(|i| (measure(&compared[i]), blocks.centre(i)))
    };
    let blemish = worst(&|c| c.own / grain);
    let split = compared.iter().filter(|c| quartile(c) > TWO_PAINTS).count();
    Ok(Doubts {
        blemish: blemish.map_or(0.0, |(grains, _)| f64::from(grains)),
        blemish_at: blemish.map(|(_, at)| at),
        ambiguous: split as f64 / grains.len() as f64,
        ambiguous_at: worst(&quartile).map(|(_, at)| at),
    })
}

impl Blocks {
    fn of(problem: &Problem, job: Job) -> Result<Self> {
        let style = &problem.style;
        let side = style.width.max(style.height).div_ceil(BLOCKS).max(MIN_SIDE);
        let (columns, rows) = (style.width / side, style.height / side);
        let roots: Vec<f32> = problem.guides.weights.iter().map(|w| w.sqrt() as f32).collect();
        let even = exec::map(columns * rows, job, |b| block([b % columns, b / columns], side, problem, &roots))?;
        let count = even.iter().flatten().count();
        let mut blocks = Self {
            side,
            channels: roots.len(),
            at: try_with_capacity(count)?,
            guides: try_with_capacity(count * roots.len())?,
            paint: try_with_capacity(count)?,
        };
        for (at, guides, paint) in even.into_iter().flatten() {
            blocks.at.push(at);
            blocks.guides.extend(guides);
            blocks.paint.push(paint);
        }
        Ok(blocks)
    }

    fn centre(&self, i: usize) -> [usize; 2] {
        self.at[i].map(|v| v * self.side + self.side / 2)
    }

    /// Compares a block with the blocks elsewhere that have similar guides.
    fn compare(&self, i: usize) -> Compared {
        let guides = |i: usize| &self.guides[i * self.channels..(i + 1) * self.channels];
        let elsewhere = (0..self.at.len()).filter(|&j| (0..2).any(|k| self.at[i][k].abs_diff(self.at[j][k]) > NEAR));
        let with_distance = elsewhere.map(|j| (j, squares(guides(i), guides(j))));
        let similar: Vec<(usize, f32)> = with_distance.filter(|(_, d)| *d <= SIMILAR * SIMILAR).collect();
        let paint = |&(j, _): &(usize, f32)| self.paint[j];
        let equal: Vec<[f32; 4]> = similar.iter().filter(|(_, d)| *d <= EQUAL * EQUAL).map(paint).collect();
        let mut compared = Compared::default();
        if similar.len() >= MIN_OTHERS {
            let mut to_own: Vec<f32> = similar.iter().map(|s| squares(&paint(s), &self.paint[i]).sqrt()).collect();
            compared.own = quantile(&mut to_own, 5);
        }
        if equal.len() >= MIN_OTHERS {
            let median = std::array::from_fn::<f32, 4, _>(|c| {
                let mut values: Vec<f32> = equal.iter().map(|paint| paint[c]).collect();
                quantile(&mut values, 50)
            });
            let mut to_median: Vec<f32> = equal.iter().map(|paint| squares(paint, &median).sqrt()).collect();
            compared.spread = Some([50, 75].map(|percent| quantile(&mut to_median, percent)));
        }
        compared
    }
}

/// Returns column and row, mean guides and mean paint of a block. `None` if the guides within the block deviate from
/// their mean by more than [`EQUAL`], or if the block contains a pixel that may not be used.
fn block(at: [usize; 2], side: usize, problem: &Problem, roots: &[f32]) -> Option<([usize; 2], Vec<f32>, [f32; 4])> {
    let (style, source) = (&problem.style, &problem.guides.source);
    let columns = at[0] * side..(at[0] + 1) * side;
    let pixels = || (at[1] * side..(at[1] + 1) * side).flat_map(|y| columns.clone().map(move |x| (x, y)));
    if problem.source_mask.as_ref().is_some_and(|mask| pixels().any(|(x, y)| !mask[y * style.width + x])) {
        return None;
    }
    let share = 1.0 / (side * side) as f32;
    let (mut guides, mut square, mut paint) = (vec![0.0; roots.len()], 0.0, [0.0; 4]);
    for (x, y) in pixels() {
        for ((mean, v), root) in guides.iter_mut().zip(source.pixel(x, y)).zip(roots) {
            *mean += share * v * root;
            square += share * maths::powi(v * root, 2);
        }
        paint.iter_mut().zip(style.pixel(x, y)).for_each(|(mean, v)| *mean += share * v);
    }
    let variance = square - guides.iter().map(|v| v * v).sum::<f32>();
    (variance <= EQUAL * EQUAL).then_some((at, guides, paint))
}

fn squares(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Returns a quantile of values in any order.
fn quantile(values: &mut [f32], percent: usize) -> f32 {
    let rank = (values.len() - 1) * percent / 100;
    *values.select_nth_unstable_by(rank, f32::total_cmp).1
}
