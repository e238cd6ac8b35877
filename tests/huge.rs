//! Tests line detection, features and segmentation on a photo of 100 megapixels, compared with one of 10 megapixels:
//! the results agree, the time per pixel hardly rises, and the peak memory stays within limits.
//!
//! Both photos are enlarged from one small drawing, whose pixels become squares of pixels. The test has a program of
//! its own, because it measures the peak memory of the process.

use glam::{DMat3, DVec2};
use luxfer::exec::Pool;
use luxfer::features::{self, RoomView};
use luxfer::geometry::{FocalSource, Perspective};
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::rectify::{self, View};
use luxfer::segment::{self, Input, Params, Segmentation, Stroke};
use std::time::Instant;

/// Width and height of the drawing in pixels; and the factors by which the photos of 10 and 100 megapixels are wider
/// and higher.
const SIZE: [usize; 2] = [480, 320];
const TIMES: [usize; 2] = [8, 26];

/// Maximum of the features' peak memory, in bytes per pixel: 4 for the photo, 40 for the features (the result), and 28
/// of working memory for the room layout.
const FEATURES: f64 = 4.0 + 40.0 + 28.0;
/// Maximum of the segmentation's peak memory, in bytes per pixel: 4 for the photo, 40 for the features, 12 for the
/// mask, the confidence and the unseen mask, and 8 of working memory.
const SEGMENTATION: f64 = 4.0 + 40.0 + 12.0 + 8.0;

/// Reads the memory figure `name` from a file of the system, in bytes; `None` if the system does not report it.
fn memory_figure(file: &str, name: &str) -> Option<f64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix(name))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()? * 1024.0)
}

/// Time and memory that a stage takes per pixel.
#[derive(Clone, Copy, Debug)]
struct Cost {
    nanoseconds: f64,
    /// Bytes per pixel at the peak.
    bytes: Option<f64>,
}

fn cost<T>(pixels: usize, work: impl FnOnce() -> T) -> (Cost, T) {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    let start = Instant::now();
    let value = work();
    let nanoseconds = start.elapsed().as_secs_f64() * 1e9 / pixels as f64;
    (Cost { nanoseconds, bytes: memory_figure("/proc/self/status", "VmHWM:").map(|b| b / pixels as f64) }, value)
}

/// Draws a box room whose faces have tiles with darker gaps.
fn drawing() -> Image {
    let [width, height] = SIZE;
    let axes = DMat3::from_rotation_y(0.4) * DMat3::from_rotation_x(-0.2);
    let principal = DVec2::new(width as f64, height as f64) / 2.0;
    let camera = Perspective { focal: 360.0, focal_source: FocalSource::Given, principal, bend: 0.0, axes };
    let faces = [(1, -1.2, 0.9), (1, 1.3, 0.25), (0, -2.1, 0.5), (0, 2.3, 0.6), (2, 4.2, 0.4)];
    const SUB: usize = 4;
    let seen = |p: DVec2| {
        let ray = axes.transpose() * camera.ray(p);
        let hits = faces.map(|(axis, at, paint)| (at / ray[axis], axis, paint));
        let ahead = hits.into_iter().filter(|h| h.0 > 0.0).min_by(|a, b| a.0.total_cmp(&b.0));
        ahead.map_or(0.0, |(t, axis, paint)| {
            let on = ray * t;
            let gap = |c: usize| c != axis && on[c].rem_euclid(0.7) < 0.07;
            if (0..3).any(gap) { 0.4 * paint } else { paint }
        })
    };
    let pixel = |x: usize, y: usize| {
        let sub = |k: usize| DVec2::new((k % SUB) as f64 + 0.5, (k / SUB) as f64 + 0.5) / SUB as f64;
        let corner = DVec2::new(x as f64, y as f64);
        [((0..SUB * SUB).map(|k| seen(corner + sub(k))).sum::<f64>() / (SUB * SUB) as f64) as f32]
    };
    Image::from_fn(width, height, pixel).unwrap()
}

/// Positive strokes on the ceiling and negative ones on the floor and the walls, on the drawing enlarged `times`
/// times.
fn strokes(times: usize) -> Vec<Stroke> {
    let [width, height] = SIZE.map(|v| v * times);
    let line = |positive: bool, a: [f64; 2], b: [f64; 2]| {
        let points = [a, b].map(|p| DVec2::from(p) * times as f64);
        Stroke::polyline(&points, 2.0 * times as f64, positive, width, height).unwrap()
    };
    vec![
        line(true, [150.0, 12.0], [330.0, 16.0]),
        line(true, [230.0, 25.0], [300.0, 40.0]),
        line(false, [200.0, 305.0], [330.0, 310.0]),
        line(false, [15.0, 120.0], [60.0, 200.0]),
        line(false, [460.0, 120.0], [440.0, 200.0]),
        line(false, [250.0, 170.0], [310.0, 180.0]),
    ]
}

struct Reading {
    costs: [Cost; 3],
    view: View,
    plane: Segmentation,
}

/// Enlarges the drawing `times` times in width and height, runs the three stages on it, and returns their results and
/// costs.
fn read(small: &Image, times: usize) -> Reading {
    let monitor = Monitor::default();
    let (width, height) = (small.width * times, small.height * times);
    let mut photo = Image::new(width, height, 1).unwrap();
    for (y, row) in photo.data.chunks_exact_mut(width).enumerate() {
        row.iter_mut().enumerate().for_each(|(x, out)| *out = small.pixel(x / times, y / times)[0]);
    }
    let strokes = strokes(times);
    let pixels = width * height;
    let (lines, view) = cost(pixels, || rectify::find_view(&photo, &Default::default(), monitor.job()).unwrap());
    let room = Some(RoomView { perspective: &view.perspective, segments: &view.segments, strokes: &[], layout: None });
    let input = features::Input { photo: &photo, depth: None, room };
    let (all, features) = cost(pixels, || features::run(&input, &Default::default(), monitor.job()).unwrap().image);
    let input = Input { features: &features, strokes: &strokes, region: None };
    let (mask, plane) = cost(pixels, || segment::run(&input, &Params::default(), monitor.job()).unwrap());
    Reading { costs: [lines, all, mask], view, plane }
}

#[test]
fn a_hundred_megapixels_are_read_as_ten_and_cost_no_more_each() {
    let needed = 1.2 * FEATURES * (SIZE[0] * SIZE[1] * TIMES[1] * TIMES[1]) as f64;
    if memory_figure("/proc/meminfo", "MemAvailable:").is_some_and(|free| free < needed) {
        eprintln!("skipped: {:.0} GB of memory are not free", needed / 1e9);
        return;
    }
    let small = drawing();
    let pool = Pool::new(2).unwrap();
    let [large, huge] = TIMES.map(|times| pool.run(|| read(&small, times)));
    for (name, (large, huge)) in ["lines", "features", "segmentation"].iter().zip(large.costs.iter().zip(&huge.costs)) {
        println!("{name}: {huge:.1?} of each pixel, {:.1} ns in a tenth of them", large.nanoseconds);
        // The factor allows for other work on the machine; quadratic growth would take ten times as long.
        assert!(huge.nanoseconds < 4.0 * large.nanoseconds, "{name}");
    }
    for (cost, bound) in huge.costs[1..].iter().zip([FEATURES, SEGMENTATION]) {
        assert!(cost.bytes.is_none_or(|bytes| bytes < bound), "{cost:?}, {bound}");
    }

    // Both photos give the same room axes and the same plane. Compare the masks at the centres of the squares that the
    // drawing's pixels have become.
    let [a, b] = [&large, &huge].map(|r| r.view.perspective.axes);
    for axis in 0..3 {
        assert!(a.col(axis).cross(b.col(axis)).length() < 0.005, "axis {axis}");
    }
    let mask = |reading: &Reading, times: usize| {
        let at = |i: usize| [i % SIZE[0], i / SIZE[0]].map(|v| v * times + times / 2);
        (0..SIZE[0] * SIZE[1]).map(|i| reading.plane.mask.pixel(at(i)[0], at(i)[1])[0] > 0.5).collect::<Vec<_>>()
    };
    let (large, huge) = (mask(&large, TIMES[0]), mask(&huge, TIMES[1]));
    let both = large.iter().zip(&huge).filter(|(a, b)| **a && **b).count();
    let either = large.iter().zip(&huge).filter(|(a, b)| **a || **b).count();
    assert!(both > 1000 && both as f64 > 0.98 * either as f64, "{both} of {either}");
}
