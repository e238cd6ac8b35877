//! Computes the footprints of a run of output pixels, for resampling through a homography and the distortion of a lens,
//! or through a map that is given on a grid: the position and extent of each pixel in the source.

use super::grid_map::{GridMap, NODES, weights};
use crate::geometry::Radial;
use crate::geometry::radial::magnification;
use glam::DVec2;

/// Number of neighbouring pixels of a row that are processed together.
pub const RUN: usize = 128;

/// Number of neighbouring pixels that share one footprint shape, which is computed at their middle. The shape changes
/// more slowly than the position.
const SHARED: usize = 8;

/// Bound of the derivatives of the map; larger derivatives occur only at the horizon. [rounding]
const MAX_DERIVATIVE: f32 = 1e8;

/// Source positions of a run of pixels, each with its footprint: the sheared rectangle with the same second moments as
/// the parallelogram that the pixel covers, widened to at least one source pixel in every direction.
pub struct Footprints {
    /// Whether the position lies inside the source and in front of the camera.
    pub is_seen: [bool; RUN],
    /// Position of the centre of each pixel in the source, in source pixels.
    pub x: [f64; RUN],
    pub y: [f64; RUN],
    /// Length, in source pixels, of the two sides parallel to x.
    pub width: [f32; RUN],
    /// Distance, in source pixels, between the two sides parallel to x.
    pub height: [f32; RUN],
    /// Distance by which the rows of the rectangle shift along x per source pixel along y.
    pub shear: [f32; RUN],
    /// The map takes a circle with a diameter of one output pixel to an ellipse in the source. This is the squared
    /// length of its major axis in source pixels, before the ellipse is widened to at least one pixel.
    pub squared_major_axis: [f32; RUN],
}

impl Footprints {
    pub const EMPTY: Self = Self {
        is_seen: [false; RUN],
        x: [0.0; RUN],
        y: [0.0; RUN],
        width: [1.0; RUN],
        height: [1.0; RUN],
        shear: [0.0; RUN],
        squared_major_axis: [1.0; RUN],
    };
}

/// The map from output pixels to the source image.
pub struct Map {
    /// The homography from output pixels to source pixels, column by column. If there is a lens, these are pixels of
    /// the image that an ideal lens would show.
    pub to_source: [f64; 9],
    /// Sign of the third homogeneous coordinate of points in front of the camera. The centre of the output image is
    /// assumed to be in front of the camera.
    pub front: f64,
    /// The distortion of the lens that took the source; `None` if it has none.
    pub lens: Option<Radial>,
    /// A map that is used instead of the homography and the lens.
    pub grid: Option<GridMap>,
    /// Size of the source in pixels.
    pub size: [f64; 2],
}

/// Computes the footprints of a run of pixels that begins at column `first` of a row.
#[inline(always)]
pub fn locate(map: &Map, row: usize, first: usize, to: &mut Footprints) {
    match (&map.grid, map.lens) {
        (Some(grid), _) => locate_on_grid(grid, map.size, row, first, to),
        (None, None) => locate_through(map, |x, y| (x, y), row, first, to),
        (None, Some(Radial { centre, bend })) => {
            let shown = |x: f64, y: f64| {
                let (x, y) = (x - centre.x, y - centre.y);
                let factor = magnification(bend * (x * x + y * y));
                (centre.x + x * factor, centre.y + y * factor)
            };
            locate_through(map, shown, row, first, to);
        }
    }
}

/// Computes the footprints for [`locate`]. `shown` maps the pixels of an ideal lens to the pixels of the source.
#[inline(always)]
fn locate_through(
    Map { to_source: map, front, lens, size, grid: _ }: &Map,
    shown: impl Fn(f64, f64) -> (f64, f64),
    row: usize,
    first: usize,
    to: &mut Footprints,
) {
    let y = row as f64 + 0.5;
    let (from_x, from_y, from_z) = (map[3] * y + map[6], map[4] * y + map[7], map[5] * y + map[8]);
    for i in 0..RUN {
        let x = first as f64 + (i as f64 + 0.5);
        let z = map[2] * x + from_z;
        let per_z = 1.0 / z;
        let (qx, qy) = shown((map[0] * x + from_x) * per_z, (map[1] * x + from_y) * per_z);
        let seen = (z * front > 0.0) & (qx >= 0.0) & (qy >= 0.0) & (qx <= size[0]) & (qy <= size[1]);
        to.is_seen[i] = seen;
        (to.x[i], to.y[i]) = if seen { (qx, qy) } else { (0.0, 0.0) };
    }

    let mut shapes = [[0.0f32; RUN / SHARED]; 4];
    for i in 0..RUN / SHARED {
        let x = first as f64 + (i * SHARED + SHARED / 2) as f64;
        let per_z = 1.0 / (map[2] * x + from_z);
        let (qx, qy) = ((map[0] * x + from_x) * per_z, (map[1] * x + from_y) * per_z);
        // Compute the Jacobian J and the squared axes of its ellipse, which are the eigenvalues of J Jᵀ.
        let part = |v: f64| ((v * per_z) as f32).max(-MAX_DERIVATIVE).min(MAX_DERIVATIVE);
        let (a, b) = (part(map[0] - qx * map[2]), part(map[3] - qx * map[5]));
        let (c, d) = (part(map[1] - qy * map[2]), part(map[4] - qy * map[5]));
        let ((a, b), (c, d)) = match lens {
            None => ((a, b), (c, d)),
            Some(lens) => through_lens(lens, shown(qx, qy), [a, b, c, d]),
        };
        set(&mut shapes, i, shape(a, b, c, d));
    }
    share(&shapes, to);
}

/// Computes the footprints for [`locate`] through a map that is given on a grid.
#[inline(always)]
fn locate_on_grid(grid: &GridMap, size: [f64; 2], row: usize, first: usize, to: &mut Footprints) {
    let on_row: [[DVec2; 2]; NODES] = std::array::from_fn(|node| grid.on_row(row as f64 + 0.5, node));
    let width = grid.width as f64;
    for i in 0..RUN {
        let (node, across) = weights((first as f64 + (i as f64 + 0.5)) / width);
        let mut at = DVec2::ZERO;
        for k in 0..4 {
            at += across.value[k] * on_row[node + k][0];
        }
        let seen = (at.x >= 0.0) & (at.y >= 0.0) & (at.x <= size[0]) & (at.y <= size[1]);
        to.is_seen[i] = seen;
        (to.x[i], to.y[i]) = if seen { (at.x, at.y) } else { (0.0, 0.0) };
    }
    let mut shapes = [[0.0f32; RUN / SHARED]; 4];
    for i in 0..RUN / SHARED {
        let (node, across) = weights((first as f64 + (i * SHARED + SHARED / 2) as f64) / width);
        let (mut by_x, mut by_y) = (DVec2::ZERO, DVec2::ZERO);
        for k in 0..4 {
            by_x += across.slope[k] / width * on_row[node + k][0];
            by_y += across.value[k] * on_row[node + k][1];
        }
        let part = |v: f64| (v as f32).max(-MAX_DERIVATIVE).min(MAX_DERIVATIVE);
        set(&mut shapes, i, shape(part(by_x.x), part(by_y.x), part(by_x.y), part(by_y.y)));
    }
    share(&shapes, to);
}

/// Returns width, height, shear and squared major axis of the footprint whose Jacobian has the rows `[a, b]` and
/// `[c, d]`.
#[inline(always)]
fn shape(a: f32, b: f32, c: f32, d: f32) -> [f32; 4] {
    let (xx, xy, yy, determinant) = (a * a + b * b, a * c + b * d, c * c + d * d, a * d - b * c);
    let half = 0.5 * (xx - yy);
    let radius = (half * half + xy * xy).sqrt();
    let squared_major_axis = 0.5 * (xx + yy) + radius;
    let squared_minor_axis = determinant * determinant / squared_major_axis.max(f32::MIN_POSITIVE);

    // Widen both axes to at least 1: scale J Jᵀ and add a multiple of the identity.
    let (high, low) = (squared_major_axis.max(1.0), squared_minor_axis.max(1.0));
    let scale = if squared_minor_axis >= 1.0 {
        1.0
    } else if squared_major_axis <= 1.0 {
        0.0
    } else {
        (high - low) / (2.0 * radius)
    };
    let added = if squared_minor_axis >= 1.0 { 0.0 } else { low - scale * squared_minor_axis };
    let yy = scale * yy + added;
    let height = yy.sqrt();
    [(high * low).sqrt() / height, height, scale * xy / yy, squared_major_axis]
}

#[inline(always)]
fn set(shapes: &mut [[f32; RUN / SHARED]; 4], i: usize, shape: [f32; 4]) {
    for k in 0..4 {
        shapes[k][i] = shape[k];
    }
}

/// Gives the shapes to the pixels that share them.
#[inline(always)]
fn share(shapes: &[[f32; RUN / SHARED]; 4], to: &mut Footprints) {
    for (shape, to) in shapes.iter().zip([&mut to.width, &mut to.height, &mut to.shear, &mut to.squared_major_axis]) {
        to.chunks_exact_mut(SHARED).zip(shape).for_each(|(to, value)| to.fill(*value));
    }
}

/// Returns the two rows of the Jacobian of the map from output pixels to source pixels, with the distortion of the
/// lens. `[a, b, c, d]` holds the two rows of the Jacobian of the map to the pixels of an ideal lens. `at` is the
/// source pixel at which the lens is differentiated.
#[inline(always)]
fn through_lens(lens: &Radial, at: (f64, f64), [a, b, c, d]: [f32; 4]) -> ((f32, f32), (f32, f32)) {
    let inverse = lens.derivative(DVec2::new(at.0, at.1)).inverse().as_mat2();
    let (x, y) = (inverse.x_axis, inverse.y_axis);
    let limit = |v: f32| v.max(-MAX_DERIVATIVE).min(MAX_DERIVATIVE);
    ((limit(x.x * a + y.x * c), limit(x.x * b + y.x * d)), (limit(x.y * a + y.y * c), limit(x.y * b + y.y * d)))
}

/// Returns the shortest side, the greatest width and the greatest height of the visible footprints; `None` if no
/// footprint is visible. All sides are non-negative, so their bit patterns compare as their values do, and integer
/// comparisons vectorise.
#[inline(always)]
pub fn extent(of: &Footprints) -> Option<[f32; 3]> {
    let (mut shortest, mut widest, mut highest) = (u32::MAX, 0, 0);
    for i in 0..RUN {
        let (width, height) = (of.width[i].to_bits(), of.height[i].to_bits());
        let seen = of.is_seen[i];
        shortest = shortest.min(if seen { width.min(height) } else { u32::MAX });
        widest = widest.max(if seen { width } else { 0 });
        highest = highest.max(if seen { height } else { 0 });
    }
    (widest > 0).then(|| [shortest, widest, highest].map(f32::from_bits))
}
