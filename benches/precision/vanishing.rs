//! Precision of a vanishing point from many lines. It is the direction most nearly perpendicular to the normals of the
//! lines: the eigenvector of the smallest eigenvalue of a sum of outer products, found by inverse iteration.

use super::real::{Real, cross, dot};
use super::{Study, Way, timed};
use luxfer::rng::Rng;

const LINES: usize = 500;

fn normalised<R: Real>(v: [R; 3]) -> [R; 3] {
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

fn direction<R: Real>(normals: &[[R; 3]]) -> [R; 3] {
    let mut m = [[R::ZERO; 3]; 3];
    for n in normals {
        for (row, &a) in m.iter_mut().zip(n) {
            row.iter_mut().zip(n).for_each(|(cell, &b)| *cell += a * b);
        }
    }
    // Use the adjugate: it is the inverse up to scale, and exists for singular matrices too.
    let adjugate = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
    let mut v = normalised([R::of(0.3), R::of(-0.5), R::of(0.8)]);
    for _ in 0..8 {
        v = normalised(adjugate.map(|row| dot(row, v)));
    }
    v
}

pub fn measure(study: &mut Study) {
    let truth = normalised([0.2, -0.3, 0.9]);
    // Make short lines, as the frames of windows give: all normals are close to each other.
    let mut rng = Rng::new(3, &[]);
    let side = normalised(cross(truth, [0.0, 1.0, 0.0]));
    let up = cross(side, truth);
    let normals: Vec<[f64; 3]> = (0..LINES)
        .map(|_| {
            let angle = 0.02 * rng.normal();
            std::array::from_fn(|i| side[i] * angle.cos() + up[i] * angle.sin())
        })
        .collect();
    let narrow: Vec<[f32; 3]> = normals.iter().map(|n| n.map(|c| c as f32)).collect();
    let error = |found: [f64; 3]| {
        let sine = cross(found, truth);
        dot(sine, sine).sqrt().asin().to_degrees()
    };
    study.add(
        "rectification: the direction of 500 nearly parallel lines",
        "degrees",
        1,
        &mut [
            Way {
                name: "f32",
                bytes: 12,
                error: error(direction(&narrow).map(f64::from)),
                work: &mut timed(|| direction(&narrow)),
            },
            Way { name: "f64", bytes: 24, error: error(direction(&normals)), work: &mut timed(|| direction(&normals)) },
        ],
    );
}
