//! Cholesky factors of symmetric positive definite matrices of any size.

/// The lower triangular factor `L` of `L Lᵀ`.
pub struct Cholesky {
    size: usize,
    /// Row by row; entries above the diagonal are not used.
    lower: Vec<f64>,
}

impl Cholesky {
    /// Factorises a matrix, given row by row. `None` if it is not positive definite to working precision.
    pub fn new(size: usize, mut matrix: Vec<f64>) -> Option<Self> {
        for j in 0..size {
            let (head, tail) = matrix.split_at_mut((j + 1) * size);
            let pivot_row = &mut head[j * size..];
            let pivot = pivot_row[j] - pivot_row[..j].iter().map(|v| v * v).sum::<f64>();
            if !(pivot > pivot_row[j].abs() * f64::EPSILON && pivot.is_finite()) {
                return None;
            }
            let diagonal = pivot.sqrt();
            pivot_row[j] = diagonal;
            for row in tail.chunks_exact_mut(size) {
                row[j] = (row[j] - dot(&row[..j], &pivot_row[..j])) / diagonal;
            }
        }
        Some(Self { size, lower: matrix })
    }

    /// Returns `L⁻¹ b`.
    pub fn forward(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        for (i, row) in self.lower.chunks_exact(self.size).enumerate() {
            x[i] = (x[i] - dot(&row[..i], &x[..i])) / row[i];
        }
        x
    }

    /// Replaces several right sides `b` by `L⁻¹ b`. A row of `sides` holds one entry of each of them.
    pub fn forward_all(&self, sides: &mut [f64]) {
        let count = sides.len() / self.size;
        for (i, row) in self.lower.chunks_exact(self.size).enumerate() {
            let (solved, rest) = sides.split_at_mut(i * count);
            let entries = &mut rest[..count];
            for (l, earlier) in row.iter().zip(solved.chunks_exact(count)) {
                entries.iter_mut().zip(earlier).for_each(|(x, e)| *x -= l * e);
            }
            entries.iter_mut().for_each(|x| *x /= row[i]);
        }
    }

    /// Returns `L⁻ᵀ b`.
    pub fn backward(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        for i in (0..self.size).rev() {
            let row = &self.lower[i * self.size..];
            x[i] /= row[i];
            let value = x[i];
            x[..i].iter_mut().zip(row).for_each(|(x, l)| *x -= value * l);
        }
        x
    }

    /// Returns the solution of `L Lᵀ x = b`.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.backward(&self.forward(b))
    }

    /// Returns the diagonal of `L`; the product of its squares is the determinant of the matrix.
    pub fn diagonal(&self) -> impl Iterator<Item = f64> {
        self.lower.iter().step_by(self.size + 1).copied()
    }
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn systems_are_solved_and_indefinite_matrices_refused() {
        let mut rng = Rng::new(8, &[]);
        for size in [1, 2, 7, 30] {
            let root: Vec<f64> = (0..size * size).map(|_| rng.normal()).collect();
            let entry = |i: usize, j: usize| dot(&root[i * size..(i + 1) * size], &root[j * size..(j + 1) * size]);
            let matrix: Vec<f64> =
                (0..size * size).map(|k| entry(k / size, k % size) + f64::from(k / size == k % size)).collect();
            let x: Vec<f64> = (0..size).map(|_| rng.normal()).collect();
            let b: Vec<f64> = matrix.chunks_exact(size).map(|row| dot(row, &x)).collect();
            let factor = Cholesky::new(size, matrix).unwrap();
            let solved = factor.solve(&b);
            assert!(solved.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-9));
            assert_eq!(factor.diagonal().count(), size);
            let mut sides: Vec<f64> = b.iter().flat_map(|v| [*v, 2.0 * v]).collect();
            factor.forward_all(&mut sides);
            let one = factor.forward(&b);
            assert!(sides.chunks(2).zip(&one).all(|(s, v)| (s[0] - v).abs() < 1e-9 && (s[1] - 2.0 * v).abs() < 1e-9));
        }
        assert!(Cholesky::new(2, vec![1.0, 2.0, 2.0, 1.0]).is_none());
        assert!(Cholesky::new(1, vec![f64::NAN]).is_none());
    }
}
