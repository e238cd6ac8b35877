//! Matrix products. Sums for four rows by sixteen columns stay in registers while the code runs along the shared axis
//! in order.

use super::super::tensor::{Tensor, count};
use super::call::{Call, Settings};
use super::elementwise::Broadcast;
use crate::error::{Error, Result};
use crate::exec;
use crate::image::try_collect;
use crate::simd::widest;

const ROWS: usize = 4;
const LANES: usize = 16;
/// Length of a block along the shared axis, chosen so that the right matrix's block stays in the cache.
const DEPTH: usize = 256;

pub struct Gemm {
    alpha: f32,
    beta: f32,
    turns_left: bool,
    turns_right: bool,
}

impl Gemm {
    pub fn read(at: &Settings) -> Self {
        let is_set = |name: &str| at.integer(name, 0) != 0;
        let (turns_left, turns_right) = (is_set("transA"), is_set("transB"));
        Self { alpha: at.float("alpha", 1.0), beta: at.float("beta", 1.0), turns_left, turns_right }
    }

    /// Computes `α A B + β C`, where A, B and C are the three inputs. A and B are transposed first if the attributes
    /// say so. C is broadcast to the shape of `A B`; without C, its term is left out.
    pub fn run(&self, call: &Call) -> Result<Tensor> {
        let turned = |k: usize, turns: bool| {
            let tensor = call.input(k)?;
            if turns { transposed(tensor, call) } else { Ok(tensor.clone()) }
        };
        let (left, right) = (turned(0, self.turns_left)?, turned(1, self.turns_right)?);
        let [_, _]: [usize; 2] = left.shape_of()?;
        let [_, _]: [usize; 2] = right.shape_of()?;
        let mut product = product(&left, &right, call)?;
        let out_shape = product.shape.clone();
        if self.alpha != 1.0 {
            let scaled = try_collect(product.as_floats()?.iter().map(|v| self.alpha * v))?;
            product = Tensor::floats(out_shape.clone(), scaled);
        }
        let Some(bias) = call.optional(2) else { return Ok(product) };
        let broadcast = Broadcast::of(&[&product, bias])?;
        if broadcast.shape != out_shape {
            return Err(Error::format(format!(
                "C of shape {:?} does not fit a product of shape {out_shape:?}",
                bias.shape
            )));
        }
        let bias = broadcast.all(1, bias.as_floats()?, 0.0, call)?;
        let sum = try_collect(product.as_floats()?.iter().zip(bias).map(|(p, c)| p + self.beta * c))?;
        Ok(Tensor::floats(out_shape, sum))
    }
}

fn transposed(tensor: &Tensor, call: &Call) -> Result<Tensor> {
    let [rows, columns] = tensor.shape_of()?;
    let values = tensor.as_floats()?;
    let mut out = call.budget.zeros(&[columns, rows])?;
    exec::for_rows(&mut out, rows, call.job, |c, out| {
        out.iter_mut().enumerate().for_each(|(r, out)| *out = values[r * columns + c]);
    })?;
    Ok(Tensor::floats(vec![columns, rows], out))
}

/// Returns the product of two stacks of matrices, broadcast as in numpy.
pub fn run(call: &Call) -> Result<Tensor> {
    product(call.input(0)?, call.input(1)?, call)
}

fn product(left: &Tensor, right: &Tensor, call: &Call) -> Result<Tensor> {
    let wrong =
        || Error::format(format!("matrices of shapes {:?} and {:?} cannot be multiplied", left.shape, right.shape));
    // A vector on the left is a row; a vector on the right is a column.
    let (mut a, mut b) = (left.clone(), right.clone());
    if a.shape.len() == 1 {
        a.shape.insert(0, 1);
    }
    if b.shape.len() == 1 {
        b.shape.push(1);
    }
    let (stack_a, stack_b) =
        (a.shape.len().checked_sub(2).ok_or_else(wrong)?, b.shape.len().checked_sub(2).ok_or_else(wrong)?);
    let (rows, shared, columns) = (a.shape[stack_a], a.shape[stack_a + 1], b.shape[stack_b + 1]);
    if b.shape[stack_b] != shared || rows * shared == 0 || columns == 0 || a.is_empty() || b.is_empty() {
        return Err(wrong());
    }

    let (mut shape, [of_a, of_b]) = pairs(&a.shape[..stack_a], &b.shape[..stack_b], call)?;
    let stack = of_a.len();

    let (values_a, values_b) = (a.as_floats()?, b.as_floats()?);
    shape.extend([rows, columns]);
    count(&shape)?;
    // Process rows in groups of four. Pad the output of the last group to four rows, and cut the padding off
    // afterwards.
    let padded = rows.next_multiple_of(ROWS);
    let mut out = call.budget.zeros(&[stack, padded, columns])?;
    exec::for_rows(&mut out, ROWS * columns, call.job, |k, out| {
        if call.job.is_cancelled() {
            return;
        }
        let (m, first) = (k * ROWS / padded, k * ROWS % padded);
        let b = &values_b[of_b[m] as usize * shared * columns..][..shared * columns];
        let a = &values_a[(of_a[m] as usize * rows + first) * shared..][..ROWS.min(rows - first) * shared];
        let block = Block { a, b, shared, columns };
        if a.len() == ROWS * shared { four_rows(&block, out) } else { rest(&block, out) }
    })?;
    call.job.check()?;
    if padded != rows {
        for m in 0..stack {
            out.copy_within(m * padded * columns..(m * padded + rows) * columns, m * rows * columns);
        }
        out.truncate(stack * rows * columns);
    }
    if right.shape.len() == 1 {
        shape.pop();
    }
    if left.shape.len() == 1 {
        let axis = shape.len() - if right.shape.len() == 1 { 1 } else { 2 };
        shape.remove(axis);
    }
    Ok(Tensor::floats(shape, out))
}

/// Pairs the matrices of two stacks by broadcasting. Returns the shape of the resulting stack and, for each input
/// stack, the index of the matrix that goes into each product.
fn pairs(a: &[usize], b: &[usize], call: &Call) -> Result<(Vec<usize>, [Vec<i64>; 2])> {
    let numbered = |shape: &[usize]| -> Result<Tensor> {
        Ok(Tensor::integers(shape.to_vec(), (0..count(shape)? as i64).collect()))
    };
    let (numbers_a, numbers_b) = (numbered(a)?, numbered(b)?);
    let broadcast = Broadcast::of(&[&numbers_a, &numbers_b])?;
    let of_a = broadcast.all(0, numbers_a.as_integers()?, 0, call)?;
    let of_b = broadcast.all(1, numbers_b.as_integers()?, 0, call)?;
    let indices = if broadcast.shape.is_empty() { [vec![0], vec![0]] } else { [of_a, of_b] };
    Ok((broadcast.shape, indices))
}

/// Up to four rows of the left matrix, and the whole right matrix.
struct Block<'a> {
    a: &'a [f32],
    b: &'a [f32],
    shared: usize,
    columns: usize,
}

widest! {
    fn four_rows(block: &Block, out: &mut [f32]) {
        rows_of::<ROWS>(block, out);
    }
}

widest! {
    /// Processes the last rows, of which there are fewer than four.
    fn rest(block: &Block, out: &mut [f32]) {
        for (a, out) in block.a.chunks_exact(block.shared.max(1)).zip(out.chunks_exact_mut(block.columns)) {
            rows_of::<1>(&Block { a, ..*block }, out);
        }
    }
}

#[inline(always)]
fn rows_of<const N: usize>(block: &Block, out: &mut [f32]) {
    let Block { a, b, shared, columns } = *block;
    for depth in (0..shared).step_by(DEPTH) {
        let end = (depth + DEPTH).min(shared);
        for x in (0..columns).step_by(LANES) {
            let count = LANES.min(columns - x);
            let mut sum = [[0.0; LANES]; N];
            for n in 0..N {
                sum[n][..count].copy_from_slice(&out[n * columns + x..][..count]);
            }
            for k in depth..end {
                let mut line = [0.0; LANES];
                if count == LANES {
                    line.copy_from_slice(&b[k * columns + x..][..LANES]);
                } else {
                    line[..count].copy_from_slice(&b[k * columns + x..][..count]);
                }
                for n in 0..N {
                    let factor = a[n * shared + k];
                    for i in 0..LANES {
                        sum[n][i] += factor * line[i];
                    }
                }
            }
            for n in 0..N {
                out[n * columns + x..][..count].copy_from_slice(&sum[n][..count]);
            }
        }
    }
}
