//! Compression of guides to their principal components for the preview (StyLit, §3.4): rendered buffers are strongly
//! correlated, so a few components carry nearly all information.

use super::guides::Channels;
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use crate::maths;

/// Share of the variance to keep. [bench constants:paint]
const KEPT_VARIANCE: f64 = 0.995;
/// Maximum number of components: together with three colour channels, they fill the eight lanes of a SIMD register.
const MAX_COMPONENTS: usize = 5;

/// Replaces more than [`MAX_COMPONENTS`] channels by their first principal components; fewer channels stay as they are.
/// Each component is stretched to `[0, 1]` and weighted by the square of its former range, so that weighted distances
/// change only by the dropped components.
pub(super) fn compress(guides: &mut Channels, job: Job) -> Result<()> {
    let n = guides.weights.len();
    if n <= MAX_COMPONENTS {
        return Ok(());
    }
    let roots: Vec<f64> = guides.weights.iter().map(|w| w.sqrt()).collect();

    let (values, vectors) = symmetric_eigen(covariance(guides, &roots), n);
    let total: f64 = values.iter().sum();
    let mut kept = 0.0;
    let count = values.iter().take_while(|&&v| {
        let more = kept < KEPT_VARIANCE * total;
        kept += v;
        more
    });
    let count = count.count().clamp(1, MAX_COMPONENTS);
    let source = project(&guides.source, &vectors, &roots, count, job)?;
    let target = project(&guides.target, &vectors, &roots, count, job)?;
    (guides.source, guides.target) = (source, target);
    guides.weights = stretch(&mut guides.source, &mut guides.target);
    guides.is_light = Vec::new();
    Ok(())
}

/// Computes the covariance of the weighted channels over exemplar and target, from about 2¹⁶ pixels.
fn covariance(guides: &Channels, roots: &[f64]) -> Vec<f64> {
    let n = roots.len();
    let pixels = || guides.source.data.chunks_exact(n).chain(guides.target.data.chunks_exact(n));
    let step = (((guides.source.data.len() + guides.target.data.len()) / n) >> 16).max(1);
    let (mut mean, mut count) = (vec![0.0; n], 0.0);
    for p in pixels().step_by(step) {
        mean.iter_mut().zip(p).zip(roots).for_each(|((m, v), r)| *m += r * f64::from(*v));
        count += 1.0;
    }
    mean.iter_mut().for_each(|m| *m /= count);
    let mut covariance = vec![0.0; n * n];
    let mut centred = vec![0.0; n];
    for p in pixels().step_by(step) {
        for i in 0..n {
            centred[i] = roots[i] * f64::from(p[i]) - mean[i];
        }
        for i in 0..n {
            for j in 0..=i {
                covariance[i * n + j] += centred[i] * centred[j] / count;
            }
        }
    }
    for i in 0..n {
        for j in 0..i {
            covariance[j * n + i] = covariance[i * n + j];
        }
    }
    covariance
}

/// Projects the weighted channels of an image onto the first `count` components. `vectors` holds the components as
/// rows; `roots` holds the square roots of the channels' weights.
fn project(image: &Image, vectors: &[f64], roots: &[f64], count: usize, job: Job) -> Result<Image> {
    let n = roots.len();
    let mut out = Image::new(image.width, image.height, count)?;
    exec::for_rows(&mut out.data, image.width * count, job, |y, row| {
        for (o, p) in row.chunks_exact_mut(count).zip(image.row(y).chunks_exact(n)) {
            for (k, value) in o.iter_mut().enumerate() {
                let axis = &vectors[k * n..(k + 1) * n];
                let sum: f64 = p.iter().zip(axis).zip(roots).map(|((v, a), r)| a * r * f64::from(*v)).sum();
                *value = sum as f32;
            }
        }
    })?;
    Ok(out)
}

/// Stretches each component to `[0, 1]` over both images. Returns the weight of each component: the square of its range
/// before the stretch.
fn stretch(source: &mut Image, target: &mut Image) -> Vec<f64> {
    let count = source.channels;
    let mut weights = Vec::with_capacity(count);
    for k in 0..count {
        let all = source.data.iter().skip(k).step_by(count).chain(target.data.iter().skip(k).step_by(count));
        let (low, high) = all.fold((f32::MAX, f32::MIN), |(l, h), &v| (l.min(v), h.max(v)));
        let range = high - low;
        weights.push(maths::powi(f64::from(range), 2));
        let scale = if range > 0.0 { 1.0 / range } else { 0.0 };
        for image in [&mut *source, &mut *target] {
            image.data.iter_mut().skip(k).step_by(count).for_each(|v| *v = (*v - low) * scale);
        }
    }
    weights
}

/// Returns the eigenvalues of a symmetric matrix, largest first, and its unit eigenvectors as rows (cyclic Jacobi
/// rotations).
fn symmetric_eigen(mut m: Vec<f64>, n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut v: Vec<f64> = (0..n * n).map(|i| if i % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
    for _ in 0..30 {
        let off: f64 =
            (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| maths::powi(m[i * n + j], 2)).sum();
        let diagonal: f64 = (0..n).map(|i| maths::powi(m[i * n + i], 2)).sum();
        if off <= 1e-24 * diagonal {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                if m[p * n + q] == 0.0 {
                    continue;
                }
                // Compute the rotation that annihilates m[p][q].
                let theta = (m[q * n + q] - m[p * n + p]) / (2.0 * m[p * n + q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let t = if theta == 0.0 { 1.0 } else { t };
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..n {
                    let (a, b) = (m[k * n + p], m[k * n + q]);
                    (m[k * n + p], m[k * n + q]) = (c * a - s * b, s * a + c * b);
                }
                for k in 0..n {
                    let (a, b) = (m[p * n + k], m[q * n + k]);
                    (m[p * n + k], m[q * n + k]) = (c * a - s * b, s * a + c * b);
                    let (a, b) = (v[p * n + k], v[q * n + k]);
                    (v[p * n + k], v[q * n + k]) = (c * a - s * b, s * a + c * b);
                }
            }
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| m[b * n + b].total_cmp(&m[a * n + a]));
    let values = order.iter().map(|&i| m[i * n + i].max(0.0)).collect();
    let vectors = order.iter().flat_map(|&i| v[i * n..(i + 1) * n].to_vec()).collect();
    (values, vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    #[test]
    fn eigenvectors_are_orthonormal_and_rebuild_the_matrix() {
        let n = 6;
        let m: Vec<f64> =
            (0..n * n).map(|i| ((i / n * i % n + i % n * (i / n)) % 7) as f64 + f64::from(i % 7 == 0)).collect();
        let m: Vec<f64> = (0..n * n).map(|i| m[i] + m[i % n * n + i / n]).collect();
        // Add 100 to the diagonal, so that the matrix is positive definite.
        let m: Vec<f64> = m.iter().enumerate().map(|(i, v)| v + if i % (n + 1) == 0 { 100.0 } else { 0.0 }).collect();
        let (values, vectors) = symmetric_eigen(m.clone(), n);
        for i in 0..n {
            for j in 0..n {
                let dot: f64 = (0..n).map(|k| vectors[i * n + k] * vectors[j * n + k]).sum();
                assert!((dot - f64::from(i == j)).abs() < 1e-10);
                let rebuilt: f64 = (0..n).map(|k| values[k] * vectors[k * n + i] * vectors[k * n + j]).sum();
                assert!((rebuilt - m[i * n + j]).abs() < 1e-9);
            }
        }
        assert!(values.windows(2).all(|w| w[0] >= w[1]));
    }

    #[test]
    fn compressed_guides_keep_their_distances() {
        // Test images with nine channels, all of them combinations of two.
        let image = |seed: usize| {
            Image::from_fn(31, 17, |x, y| {
                let (a, b) = (((x * 7 + seed) % 31) as f32 / 31.0, ((y * 5 + seed) % 17) as f32 / 17.0);
                std::array::from_fn::<f32, 9, _>(|c| if c % 2 == 0 { a } else { 0.5 * a + 0.5 * b })
            })
            .unwrap()
        };
        let weights: Vec<f64> = (0..9).map(|c| (c + 1) as f64 / 45.0).collect();
        let (source, target) = (image(0), image(3));
        let distance = |a: &[f32], b: &[f32], w: &[f64]| -> f64 {
            a.iter().zip(b).zip(w).map(|((a, b), w)| w * f64::from(a - b).powi(2)).sum()
        };
        let mut guides = Channels {
            source: source.clone(),
            target: target.clone(),
            weights: weights.clone(),
            is_light: vec![true; 9],
            broken_source: Vec::new(),
            broken_target: Vec::new(),
        };
        compress(&mut guides, Monitor::default().job()).unwrap();
        assert_eq!(guides.weights.len(), 2);
        for i in 0..17 {
            let before = distance(source.pixel(i, i), target.pixel(30 - i, i), &weights);
            let after = distance(guides.source.pixel(i, i), guides.target.pixel(30 - i, i), &guides.weights);
            assert!((before - after).abs() < 1e-5, "{before} {after}");
        }
    }
}
