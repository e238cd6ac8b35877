//! Precision of intersections of rays with triangles: a bumpy sheet near the origin and 1 km away, in scene
//! coordinates.

use super::real::{Real, cross, dot, minus};
use super::{Study, Way, timed};
use luxfer::rng::Rng;

const SIDE: usize = 24;
const RAYS: usize = 512;

/// Number of triangles that are tested at once, as in the library's nodes and leaves.
const LANES: usize = 8;

/// Corners of the triangles, and origin and direction of each ray.
struct Setting {
    triangles: Vec<[[f64; 3]; 3]>,
    rays: Vec<[[f64; 3]; 2]>,
}

/// A block of triangles, indexed by corner, coordinate and triangle.
type Block<R> = [[[R; LANES]; 3]; 3];

fn blocks<R: Real>(triangles: &[[[f64; 3]; 3]]) -> Vec<Block<R>> {
    let block = |few: &[[[f64; 3]; 3]]| -> Block<R> {
        let value = |corner: usize, axis: usize, lane: usize| R::of(few[lane % few.len()][corner][axis]);
        std::array::from_fn(|corner| std::array::from_fn(|axis| std::array::from_fn(|lane| value(corner, axis, lane))))
    };
    triangles.chunks(LANES).map(block).collect()
}

/// Distances along the rays to their nearest hits (Möller and Trumbore 1997); infinity for a miss.
fn distances<R: Real>(blocks: &[Block<R>], rays: &[[[R; 3]; 2]]) -> Vec<R> {
    let (zero, one, infinite) = (R::ZERO, R::of(1.0), R::of(f64::INFINITY));
    let nearest = |&[origin, direction]: &[[R; 3]; 2]| {
        let mut nearest = [infinite; LANES];
        for [a, b, c] in blocks {
            for lane in 0..LANES {
                let corner = |p: &[[R; LANES]; 3]| [p[0][lane], p[1][lane], p[2][lane]];
                let (a, b, c) = (corner(a), corner(b), corner(c));
                let (e, f) = (minus(b, a), minus(c, a));
                let p = cross(direction, f);
                let inverse = one / dot(e, p);
                let s = minus(origin, a);
                let u = dot(s, p) * inverse;
                let q = cross(s, e);
                let v = dot(direction, q) * inverse;
                let t = dot(f, q) * inverse;
                let is_hit = (u >= zero) & (v >= zero) & (u + v <= one) & (t > zero) & (t < nearest[lane]);
                nearest[lane] = if is_hit { t } else { nearest[lane] };
            }
        }
        nearest.into_iter().fold(infinite, |a, b| if b < a { b } else { a })
    };
    rays.iter().map(nearest).collect()
}

fn setting(offset: f64) -> Setting {
    // Round the corners to f32, as a file stores them.
    let place = |x: usize, y: usize| {
        let height = 0.3 * (0.7 * x as f64).sin() * (0.9 * y as f64).cos();
        [x as f64 * 0.25, y as f64 * 0.25, height].map(|v| f64::from((v + offset) as f32))
    };
    let cells = (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE));
    let triangles = cells.flat_map(|(x, y)| {
        let [a, b, c, d] = [place(x, y), place(x + 1, y), place(x + 1, y + 1), place(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    let mut rng = Rng::new(2, &[]);
    let mut within = |low: f64, high: f64| low + (high - low) * rng.next_f64();
    let extent = SIDE as f64 * 0.25;
    let rays = (0..RAYS).map(|_| {
        let origin = [within(0.0, extent), within(0.0, extent), 3.0].map(|v| f64::from((v + offset) as f32));
        let [x, y] = [within(-0.4, 0.4), within(-0.4, 0.4)];
        let length = (x * x + y * y + 1.0).sqrt();
        [origin, [x, y, -1.0].map(|v| f64::from((v / length) as f32))]
    });
    Setting { triangles: triangles.collect(), rays: rays.collect() }
}

pub fn measure(study: &mut Study) {
    for (name, offset) in [("at the origin", 0.0), ("1 km off", 1000.0)] {
        let Setting { triangles, rays } = setting(offset);
        let (narrow, wide) = (blocks::<f32>(&triangles), blocks::<f64>(&triangles));
        let narrow_rays: Vec<_> = rays.iter().map(|ray| ray.map(|v| v.map(|c| c as f32))).collect();
        let (found, truth) = (distances(&narrow, &narrow_rays), distances(&wide, &rays));
        let both = found.iter().zip(&truth).filter(|(f, t)| f.is_finite() && t.is_finite());
        let error = both.map(|(&f, t)| (f64::from(f) - t).abs()).fold(0.0, f64::max);
        study.add(
            &format!("rendering: rays in a room {name}"),
            "metres along the ray, of those that hit in both",
            0,
            &mut [
                Way { name: "f32", bytes: 36, error, work: &mut timed(|| distances(&narrow, &narrow_rays)) },
                Way { name: "f64", bytes: 72, error: 0.0, work: &mut timed(|| distances(&wide, &rays)) },
            ],
        );
    }
}
