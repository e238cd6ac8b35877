//! Small dense matrices: linear systems by Gaussian elimination with complete pivoting, and eigenvectors of symmetric
//! matrices.

use crate::maths;

/// Solves `a x = b` by elimination with complete pivoting. `None` if the matrix is singular to working precision.
pub fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> Option<[f64; N]> {
    let scale = a.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
    if !scale.is_finite() || scale == 0.0 {
        return None;
    }
    let mut order: [usize; N] = std::array::from_fn(|i| i);
    for k in 0..N {
        // Move the largest remaining entry to the diagonal.
        let (mut row, mut col) = (k, k);
        for r in k..N {
            for c in k..N {
                if a[r][c].abs() > a[row][col].abs() {
                    (row, col) = (r, c);
                }
            }
        }
        if a[row][col].abs() <= scale * f64::EPSILON * N as f64 {
            return None;
        }
        a.swap(k, row);
        b.swap(k, row);
        a.iter_mut().for_each(|r| r.swap(k, col));
        order.swap(k, col);
        // Eliminate the entries below the diagonal.
        for r in k + 1..N {
            let factor = a[r][k] / a[k][k];
            for c in k..N {
                a[r][c] -= factor * a[k][c];
            }
            b[r] -= factor * b[k];
        }
    }
    let mut x = [0.0; N];
    for k in (0..N).rev() {
        let sum: f64 = (k + 1..N).map(|c| a[k][c] * x[order[c]]).sum();
        x[order[k]] = (b[k] - sum) / a[k][k];
    }
    x.iter().all(|v| v.is_finite()).then_some(x)
}

/// Returns the eigenvalues of a symmetric matrix in ascending order, and a list of its unit eigenvectors in the same
/// order (cyclic Jacobi rotations).
pub fn symmetric_eigen<const N: usize>(mut a: [[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    let mut v: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
    for _ in 0..64 {
        let off: f64 = (0..N).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i][j] * a[i][j]).sum();
        let diagonal: f64 = (0..N).map(|i| a[i][i] * a[i][i]).sum();
        if off <= diagonal * 1e-32 || off == 0.0 || !off.is_finite() {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + maths::hypot(theta, 1.0));
                let t = if theta == 0.0 { 1.0 } else { t };
                let c = 1.0 / maths::hypot(t, 1.0);
                let s = t * c;
                for k in 0..N {
                    let (x, y) = (a[k][p], a[k][q]);
                    (a[k][p], a[k][q]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..N {
                    let (x, y) = (a[p][k], a[q][k]);
                    (a[p][k], a[q][k]) = (c * x - s * y, s * x + c * y);
                    let (x, y) = (v[k][p], v[k][q]);
                    (v[k][p], v[k][q]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
    }
    let mut order: [usize; N] = std::array::from_fn(|i| i);
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    (order.map(|i| a[i][i]), order.map(|i| std::array::from_fn(|k| v[k][i])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn random_systems_are_solved_and_singular_ones_refused() {
        let mut rng = Rng::new(3, &[]);
        for _ in 0..100 {
            let a: [[f64; 5]; 5] = std::array::from_fn(|_| std::array::from_fn(|_| rng.normal()));
            let x: [f64; 5] = std::array::from_fn(|_| rng.normal());
            let b = a.map(|r| r.iter().zip(&x).map(|(a, x)| a * x).sum());
            let got = solve(a, b).unwrap();
            assert!(got.iter().zip(&x).all(|(g, x)| (g - x).abs() < 1e-9));
        }
        assert!(solve([[1.0, 2.0], [2.0, 4.0]], [1.0, 1.0]).is_none());
        assert!(solve([[0.0; 2]; 2], [1.0, 1.0]).is_none());
        assert!(solve([[f64::NAN; 2]; 2], [1.0, 1.0]).is_none());
    }

    #[test]
    fn eigenvectors_diagonalise() {
        let mut rng = Rng::new(4, &[]);
        for _ in 0..100 {
            let m: [[f64; 4]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| rng.normal()));
            let a: [[f64; 4]; 4] = std::array::from_fn(|i| std::array::from_fn(|j| m[i][j] + m[j][i]));
            let (values, vectors) = symmetric_eigen(a);
            assert!(values.is_sorted());
            for (value, vector) in values.iter().zip(&vectors) {
                for i in 0..4 {
                    let av: f64 = (0..4).map(|j| a[i][j] * vector[j]).sum();
                    assert!((av - value * vector[i]).abs() < 1e-9);
                }
            }
        }
    }
}
