//! The autocorrelation of a masked image: its correlation with itself at every shift.

use crate::error::Result;
use crate::exec;
use crate::image::try_vec;
use crate::job::Job;
use crate::maths;

#[derive(Clone, Copy, Default)]
struct Complex {
    re: f64,
    im: f64,
}

impl std::ops::Mul for Complex {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self { re: self.re * o.re - self.im * o.im, im: self.re * o.im + self.im * o.re }
    }
}

/// Pearson's correlation of an image with its shifted copy, over the pixels that are valid in both, for every shift. It
/// is computed by three forward and two inverse Fourier transforms (Padfield 2012).
pub struct Autocorrelation {
    width: usize,
    height: usize,
    /// Sides of the zero-padded grid, powers of two.
    columns: usize,
    rows: usize,
    /// For every shift (x, y), the correlation and the number of overlapping valid pixels, at the position (x, y) of
    /// the padded grid. Negative coordinates wrap around.
    value: Vec<f32>,
    overlap: Vec<f32>,
}

impl Autocorrelation {
    /// Computes the autocorrelation. `values` must be 0 where `valid` is false.
    pub fn new(values: &[f32], valid: &[bool], width: usize, height: usize, job: Job) -> Result<Self> {
        let (columns, rows) = ((2 * width).next_power_of_two(), (2 * height).next_power_of_two());
        let spectrum = |signal: &dyn Fn(usize) -> (f64, f64)| -> Result<Vec<Complex>> {
            let mut grid = try_vec(columns * rows, Complex::default())?;
            for i in 0..width * height {
                let (re, im) = signal(i);
                grid[(i / width) * columns + i % width] = Complex { re, im };
            }
            transform(grid, columns, rows, job)
        };
        let v = spectrum(&|i| (if valid[i] { 1.0 } else { 0.0 }, 0.0))?;
        let m = spectrum(&|i| (f64::from(values[i]), 0.0))?;
        let s = spectrum(&|i| (maths::powi(f64::from(values[i]), 2), 0.0))?;

        // The signals are the validity v (1 or 0), the values m and their squares s; their transforms have the same
        // names. For signals a and b, write (a·b)(d) for the sum over all pixels p of a(p) b(p + d), where d is a
        // shift. By the correlation theorem, a·b is the inverse transform of conj(A) B, where A and B are the
        // transforms.
        //
        // These sums are real, so one complex transform gives two of them: v·v + i m·m, or m·v + i s·v. The sums m·v
        // and s·v take m and s at the first pixel p of each pair. Their values at the shift -d take m and s at the
        // second pixel, p + d.
        let cross = |a: &[Complex], b: &[Complex], c: &[Complex], d: &[Complex]| -> Result<Vec<Complex>> {
            let mut grid = try_vec(columns * rows, Complex::default())?;
            for (i, out) in grid.iter_mut().enumerate() {
                let ab = Complex { re: a[i].re, im: -a[i].im } * b[i];
                let cd = Complex { re: c[i].re, im: -c[i].im } * d[i];
                // Store the conjugate of ab + i cd. Only the forward transform is implemented: conjugating its input
                // and its output gives the inverse transform, apart from the factor `norm`.
                *out = Complex { re: ab.re - cd.im, im: -(ab.im + cd.re) };
            }
            transform(grid, columns, rows, job)
        };
        let products = cross(&v, &v, &m, &m)?;
        let moments = cross(&m, &v, &s, &v)?;

        let norm = 1.0 / (columns * rows) as f64;
        let mut value = try_vec(columns * rows, 0f32)?;
        let mut overlap = try_vec(columns * rows, 0f32)?;
        for i in 0..columns * rows {
            let (x, y) = (i % columns, i / columns);
            let opposite = ((rows - y) % rows) * columns + (columns - x) % columns;
            let n = products[i].re * norm;
            let (mm, m1, s1) = (-products[i].im * norm, moments[i].re * norm, -moments[i].im * norm);
            let (m2, s2) = (moments[opposite].re * norm, -moments[opposite].im * norm);
            if n < 0.5 {
                continue;
            }
            overlap[i] = n as f32;
            value[i] = coefficient(n, mm, [m1, s1], [m2, s2]);
        }
        Ok(Self { width, height, columns, rows, value, overlap })
    }

    fn index(&self, x: isize, y: isize) -> Option<usize> {
        let inside = x.unsigned_abs() < self.width && y.unsigned_abs() < self.height;
        inside.then(|| {
            y.rem_euclid(self.rows as isize) as usize * self.columns + x.rem_euclid(self.columns as isize) as usize
        })
    }

    /// The number of overlapping pixels at a shift.
    pub fn overlap(&self, x: isize, y: isize) -> f32 {
        self.index(x, y).map_or(0.0, |i| self.overlap[i])
    }

    /// The correlation at a shift, in [-1, 1]; `None` if fewer than `min_overlap` pixels overlap.
    pub fn at(&self, x: isize, y: isize, min_overlap: f32) -> Option<f32> {
        self.index(x, y).filter(|&i| self.overlap[i] >= min_overlap).map(|i| self.value[i])
    }
}

/// The correlation coefficient of `n` pairs of values. `mm` is the sum of the products. `m1` and `s1` are the sum and
/// the sum of squares of the first values; `m2` and `s2` are the sums of the second values.
fn coefficient(n: f64, mm: f64, [m1, s1]: [f64; 2], [m2, s2]: [f64; 2]) -> f32 {
    let (var1, var2) = (s1 - m1 * m1 / n, s2 - m2 * m2 / n);
    let min_variance = 1e-9 * n;
    // The coefficient is undefined if the first or the second values are constant. Then take 1 if both are constant and
    // equal, and 0 otherwise.
    if var1 > min_variance && var2 > min_variance {
        ((mm - m1 * m2 / n) / (var1 * var2).sqrt()).clamp(-1.0, 1.0) as f32
    } else {
        f32::from(var1 <= min_variance && var2 <= min_variance && (m1 - m2).abs() < 1e-3 * n)
    }
}

/// Forward Fourier transform of a grid: transform the rows, transpose the grid, then do both again.
fn transform(mut grid: Vec<Complex>, columns: usize, rows: usize, job: Job) -> Result<Vec<Complex>> {
    // Report no progress, because the transforms take milliseconds.
    let silent = job.part(0.0, 0.0);
    for (width, height) in [(columns, rows), (rows, columns)] {
        let twiddles: Vec<Complex> = (0..width / 2)
            .map(|k| {
                let (im, re) = maths::sin_cos(-std::f64::consts::TAU * k as f64 / width as f64);
                Complex { re, im }
            })
            .collect();
        exec::for_rows(&mut grid, width, silent, |_, row| fft(row, &twiddles))?;
        let mut turned = try_vec(width * height, Complex::default())?;
        exec::for_rows(&mut turned, height, silent, |x, out| {
            out.iter_mut().enumerate().for_each(|(y, o)| *o = grid[y * width + x]);
        })?;
        grid = turned;
    }
    Ok(grid)
}

/// In-place radix-2 Fourier transform of a power-of-two length n (Cooley and Tukey 1965). `twiddles` holds
/// exp(-2π i k / n) for k < n / 2.
fn fft(data: &mut [Complex], twiddles: &[Complex]) {
    let n = data.len();
    let bits = n.trailing_zeros();
    if bits == 0 {
        return;
    }
    for i in 0..n {
        let j = i.reverse_bits() >> (usize::BITS - bits);
        if i < j {
            data.swap(i, j);
        }
    }
    let mut half = 1;
    while half < n {
        let step = n / (2 * half);
        for start in (0..n).step_by(2 * half) {
            for k in 0..half {
                let (a, b) = (data[start + k], data[start + k + half] * twiddles[k * step]);
                data[start + k] = Complex { re: a.re + b.re, im: a.im + b.im };
                data[start + k + half] = Complex { re: a.re - b.re, im: a.im - b.im };
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::rng::Rng;

    #[test]
    fn correlation_equals_the_sums_written_out() {
        let (w, h) = (13, 9);
        let mut rng = Rng::new(2, &[]);
        let valid: Vec<bool> = (0..w * h).map(|_| rng.next_f64() < 0.8).collect();
        let values: Vec<f32> = valid.iter().map(|&v| if v { rng.next_f32() } else { 0.0 }).collect();
        let all = Autocorrelation::new(&values, &valid, w, h, Monitor::default().job()).unwrap();
        for (dx, dy) in [(0isize, 0isize), (1, 0), (-3, 2), (5, -4), (-6, -6), (0, 7)] {
            let mut pairs = Vec::new();
            for i in 0..w * h {
                let (x, y) = ((i % w) as isize + dx, (i / w) as isize + dy);
                if x >= 0 && y >= 0 && x < w as isize && y < h as isize {
                    let j = y as usize * w + x as usize;
                    if valid[i] && valid[j] {
                        pairs.push((f64::from(values[i]), f64::from(values[j])));
                    }
                }
            }
            let n = pairs.len() as f64;
            let mean = pairs.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
            let sum = |f: &dyn Fn(f64, f64) -> f64| pairs.iter().map(|p| f(p.0 - mean.0, p.1 - mean.1)).sum::<f64>();
            let expected = sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt();
            let found = f64::from(all.at(dx, dy, 1.0).unwrap());
            assert!((found - expected).abs() < 1e-5, "{dx} {dy}: {found} {expected}");
            assert!(all.at(dx, dy, n as f32 + 1.0).is_none());
        }
    }
}
