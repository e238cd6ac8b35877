//! Benchmark of vanishing points: the accuracy of several methods on labelled sets of segments and on the pixels of
//! re-projected panoramas, and the error against time with fewer lines or pixels. The latter is measured also on
//! generated rooms, whose directions are known exactly.
//!
//! Arguments select sections: accuracy on given segments (`segments`) and on panoramas (`panoramas`); undone
//! distortions of lenses (`lenses`); time, and error against time (`curves`).

mod harness;
#[path = "../tests/truth/mod.rs"]
mod truth;

use glam::{DMat3, DVec2, DVec3, Quat};
use harness::plot::Plot;
use harness::{Clock, Table, absent, figure, interleaved, quantile, scenes, time};
use luxfer::demo::photo::{self, photograph};
use luxfer::exec::Pool;
use luxfer::geometry::{Radial, Segment};
use luxfer::image::io::{self, Encoding};
use luxfer::image::{Image, pyramid};
use luxfer::job::Monitor;
use luxfer::rectify::{self, Metric, Params, Search, vanishing};
use luxfer::scene::Camera;
use std::sync::Arc;
use truth::{GivenSet, Labelled, area, errors, given_set, labelled_photos};

/// Number of segments per image for the figure `vp.ms`, and number of images over which its median is taken.
const SEGMENTS: usize = 500;
const TIMED: usize = 25;
/// Factors by which the sides of photos are multiplied.
const SCALES: [f64; 6] = [0.15, 0.25, 0.4, 0.6, 0.8, 1.0];
/// Size of generated photos in pixels.
const SIZE: [usize; 2] = [900, 600];
/// Rotations of the generated cameras, to the left and up, in radians.
const TURNS: [[f32; 2]; 4] = [[0.0, 0.0], [0.3, 0.1], [-0.25, -0.15], [0.8, 0.0]];
/// Number of timed runs per photo.
const ROUNDS: usize = 3;

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let wants = |section: &str| chosen.is_empty() || chosen.iter().any(|c| c == section);
    let pool = Pool::new(2).unwrap();
    let sets = ["nyu_dev", "yud_dev"].map(given_set);
    if wants("segments") {
        pool.run(|| given_segments(&sets));
    }
    let photos = labelled_photos();
    if wants("panoramas") {
        pool.run(|| panoramas(&photos));
    }
    if wants("lenses") {
        pool.run(|| lenses(sets[1].as_ref(), &photos));
    }
    if wants("curves") {
        pool.run(|| curves(&sets, &photos));
    }
}

/// Measures times, and errors against time.
fn curves(sets: &[Option<GivenSet>; 2], photos: &[Labelled]) {
    time_segments(sets);
    plot_longest(sets);
    match photos {
        [] => absent("vp.megapixel.ms", "the panoramas are not there"),
        photos => {
            let mut plot =
                Plot::new("Vanishing points from pixels, photos reduced", "seconds", "median error, degrees");
            reductions(&mut plot, photos);
            plot.write("vp_pixels").unwrap();
            figure("vp.megapixel.ms", megapixel(photos), "ms");
        }
    }
    let mut plot = Plot::new("Vanishing points of generated rooms, reduced", "seconds", "median error, degrees");
    reductions(&mut plot, &rooms());
    plot.write("vp_rooms").unwrap();
}

fn methods() -> [(&'static str, Params); 4] {
    let segment = Params { search: Search::Successive, ..Params::default() };
    [
        ("Manhattan, then free (default)", Params::default()),
        ("successive, distance on segments", segment.clone()),
        ("successive, distance as printed", Params { metric: Metric::VisibleLine, ..segment }),
        ("default from Hough lines", Params { detector: rectify::LineDetector::Hough, ..Params::default() }),
    ]
}

fn given_segments(sets: &[Option<GivenSet>; 2]) {
    let mut table = Table::new(["set and method", "AUC@10", "AUC@5", "AUC@3", "median deg", "ms/image"]);
    let mut row = |name: &str, method: &str, set: &GivenSet, params: &Params| {
        let (seconds, angles) = time(Clock::Wall, || set.angles(params));
        let share = |limit: f64| format!("{:.1}", 100.0 * area(&angles, limit));
        let ms = seconds * 1e3 / set.images.len() as f64;
        let median = format!("{:.2}", quantile(&angles, 0.5));
        table.row([format!("{name}: {method}"), share(10.0), share(5.0), share(3.0), median, format!("{ms:.1}")]);
        100.0 * area(&angles, 10.0)
    };
    let mut headline = Vec::new();
    for (name, set) in ["nyu_dev", "yud_dev"].iter().zip(sets) {
        let Some(set) = set else {
            absent(&format!("vp.{name}.auc10"), "the labelled segments are not there");
            continue;
        };
        for (k, (method, params)) in methods()[..3].iter().enumerate() {
            let auc = row(name, method, set, params);
            if k == 0 {
                let labels = if *name == "yud_dev" { ".all_labels" } else { "" };
                headline.push((format!("vp.{name}{labels}.auc10"), auc));
            }
        }
        let known = Params {
            focal: Some(set.intrinsics.x_axis.x),
            principal: Some(set.intrinsics.z_axis.truncate()),
            ..Params::default()
        };
        row(name, "default, camera known", set, &known);
    }
    if let Some(set) = given_set("yud_dev") {
        // York Urban's own labels (Denis et al. 2008) are three directions per photo, and published figures refer to
        // these labels. A few photos have further directions in YUD+, some of them with only half a dozen lines.
        let auc = row("yud_dev", "default, its first three directions only", &set.first_three(), &Params::default());
        headline.push(("vp.yud_dev.auc10".into(), auc));
    }
    table.print("From given segments, focal length unknown");
    print_bounds(sets);
    headline.iter().for_each(|(name, auc)| figure(name, *auc, "%"));
}

/// Prints the lowest errors that the lines allow: errors of directions that are fitted to the labelled lines with a
/// known camera.
fn print_bounds(sets: &[Option<GivenSet>; 2]) {
    let mut bound = Table::new(["set and directions", "labels", "AUC@10", "AUC@5", "AUC@3", "median deg"]);
    for (name, set) in ["nyu_dev", "yud_dev"].iter().zip(sets).filter_map(|(n, s)| Some((n, s.as_ref()?))) {
        let bounds = set.from_labelled_lines();
        let angles = |from: usize, to: usize| {
            let mut all: Vec<f64> =
                bounds.iter().flat_map(|i| &i[from.min(i.len())..to.min(i.len())]).copied().collect();
            all.sort_by(f64::total_cmp);
            all
        };
        for (part, from, to) in [("all", 0, usize::MAX), ("first three", 0, 3), ("further ones", 3, usize::MAX)] {
            let angles = angles(from, to);
            let share = |limit: f64| format!("{:.1}", 100.0 * area(&angles, limit));
            let [count, median] = [angles.len().to_string(), format!("{:.2}", quantile(&angles, 0.5))];
            bound.row([format!("{name}: {part}"), count, share(10.0), share(5.0), share(3.0), median]);
        }
    }
    bound.print("Lower bound of the error: directions fitted to the lines labelled with them, the camera known");
}

/// Focal length of York Urban's camera in pixels, by its calibration.
const YORK_FOCAL: f64 = 674.858;
/// Radial distortions that are undone in York Urban's segments.
const UNDONE: [f64; 6] = [0.0, -0.01, -0.02, -0.03, -0.04, -0.05];
/// Development photos of the corpus that were cut out of panoramas, in which a distortion is measured although they
/// have none.
const CURVED: [&str; 6] = [
    "chester_dining",
    "civil_battens_a",
    "civil_battens_b",
    "dula_hotel_spots",
    "north2003_linear",
    "north2408_indirect",
];
const YORK: [&str; 8] = ["yud_008", "yud_009", "yud_034", "yud_037", "yud_047", "yud_049", "yud_059", "yud_076"];

/// Measures what undoing the distortion of the lens changes: on photos of York Urban, whose camera has barrel
/// distortion, and on views cut out of panoramas, which have none.
fn lenses(york: Option<&GivenSet>, panoramas: &[Labelled]) {
    let Some(set) = york else { return absent("vp.york.focal_error", "York Urban is not there") };
    undone_segments(set);
    let mut cases: Vec<LensCase> =
        panoramas.iter().map(|l| LensCase::new(&l.name, &l.photo, l.intrinsics.x_axis.x)).collect();
    cases.extend(CURVED.into_iter().filter_map(|name| LensCase::load("corpus", name)));
    cases.extend(YORK.into_iter().filter_map(|name| LensCase::load("photos", name)));
    let percent = |value: f64| format!("{:.1}", 100.0 * value);
    let header =
        ["photo", "measured, %", "errors", "focal error, %", "undone", "vanishing points' error, ratio", "by default"];
    let mut table = Table::new(header);
    for case in cases.iter().filter(|case| case.corner.abs() > case.error) {
        let [off, on, default] = case.focal_errors.map(percent);
        let errors = format!("{:.1}", case.corner.abs() / case.error);
        let ratio = format!("{:.2}", case.vanishing_ratio);
        table.row([case.name.clone(), percent(case.corner), errors, off, on, ratio, default]);
    }
    table
        .print("Distortions measured beyond one standard deviation, and the focal error before and after undoing them");
    let mut table = Table::new(["photos", "none undone", "every one undone", "by default", "changed by default"]);
    for (set, is_york) in [("York Urban", true), ("panoramas", false)] {
        let of = || cases.iter().filter(|case| case.name.starts_with("yud_") == is_york);
        let mean = |k: usize| percent(of().map(|case| case.focal_errors[k].abs()).sum::<f64>() / of().count() as f64);
        let changed = of().filter(|case| case.is_undone).count();
        table.row([set.to_string(), mean(0), mean(1), mean(2), format!("{changed} of {}", of().count())]);
    }
    table.print("Mean focal error, %");
}

/// Prints the accuracy on York Urban's given segments after distortions are undone in them. The labels of directions
/// are intersections of lines in the distorted photos; the calibrated focal length does not depend on them.
fn undone_segments(set: &GivenSet) {
    let mut table = Table::new(["undone, %", "AUC@10", "AUC@5", "median deg", "median focal error, %"]);
    let size = DVec2::new(set.width as f64, set.height as f64);
    for corner in UNDONE {
        let lens = Radial::new(corner, 0.5 * size, size).unwrap();
        let straight = |s: &Segment| Segment { a: lens.ideal(s.a), b: lens.ideal(s.b) };
        let images = set.images.iter().map(|(s, truth)| (s.iter().map(straight).collect(), truth.clone()));
        let undone = GivenSet { images: images.collect(), ..*set }.first_three();
        let angles = undone.angles(&Params::default());
        let focal = |segments: &Vec<Segment>| {
            let monitor = Monitor::default();
            let view = rectify::view_from_segments(segments, set.width, set.height, &Params::default(), monitor.job());
            view.map_or(f64::NAN, |view| (view.perspective.focal / YORK_FOCAL).ln().abs())
        };
        let focals: Vec<f64> = undone.images.iter().map(|(segments, _)| focal(segments)).collect();
        let [ten, five] = [10.0, 5.0].map(|limit| format!("{:.1}", 100.0 * area(&angles, limit)));
        let [median, focal] = [quantile(&angles, 0.5), 100.0 * quantile(&focals, 0.5)].map(|v| format!("{v:.2}"));
        table.row([format!("{:.0}", 100.0 * corner), ten, five, median, focal]);
    }
    table.print("York Urban's given segments, first three directions, after a distortion is undone");
}

/// A photo whose focal length is known, and the distortion measured in it.
struct LensCase {
    name: String,
    corner: f64,
    error: f64,
    /// Errors of the logarithm of the focal length: without correction, with the measured distortion undone, and by
    /// default.
    focal_errors: [f64; 3],
    /// Stated error of the vanishing points after the distortion is undone, divided by the one before.
    vanishing_ratio: f64,
    /// Whether the distortion is undone by default.
    is_undone: bool,
}

impl LensCase {
    fn load(folder: &str, name: &str) -> Option<Self> {
        let path = truth::data(folder)?.join(format!("{name}.jpg"));
        let focal = truth::read_json(&path.with_extension("json"))["fx"].as_f64().unwrap_or(YORK_FOCAL);
        Some(Self::new(name, &io::load(&path, Encoding::Srgb).ok()?.to_rgb().ok()?, focal))
    }

    fn new(name: &str, photo: &Image, focal: f64) -> Self {
        let view = |distortion: Option<f64>| {
            let params = Params { distortion, ..Params::default() };
            rectify::find_view(photo, &params, Monitor::default().job()).unwrap()
        };
        let off = view(Some(0.0));
        let [corner, error] = off.distortion.map_or([0.0, f64::INFINITY], |found| [found.corner, found.error]);
        let views = [off, view(Some(corner.clamp(-1.0, 0.2))), view(None)];
        let focal_errors = views.each_ref().map(|view| (view.perspective.focal / focal).ln());
        let stated = |view: &rectify::View| view.vanishing_points.iter().map(|v| v.error * v.error).sum::<f64>().sqrt();
        let vanishing_ratio = stated(&views[1]) / stated(&views[0]);
        Self { name: name.into(), corner, error, focal_errors, vanishing_ratio, is_undone: views[2].undone != 0.0 }
    }
}

/// Times the search for vanishing points on images with `SEGMENTS` segments.
fn time_segments(sets: &[Option<GivenSet>; 2]) {
    let Some(set) = &sets[0] else { return absent("vp.ms", "the labelled segments are not there") };
    let many: Vec<Vec<Segment>> =
        set.images.iter().filter(|(s, _)| s.len() >= SEGMENTS).take(TIMED).map(|(s, _)| longest(s, SEGMENTS)).collect();
    let monitor = Monitor::default();
    let one = |segments: &[Segment]| {
        let params = Params::default();
        let timings = interleaved(
            Clock::Wall,
            5,
            &mut [&mut || {
                let _ = vanishing::from_segments(segments, set.width, set.height, 3, &params, monitor.job());
            }],
        );
        1e3 * timings.median(0)
    };
    let ms: Vec<f64> = many.iter().map(|s| one(s)).collect();
    println!("\n{} segments: {:.1} to {:.1} ms", SEGMENTS, quantile(&ms, 0.0), quantile(&ms, 1.0));
    figure("vp.ms", quantile(&ms, 0.5), "ms");
}

/// Plots the error against time if only the longest segments are used.
fn plot_longest(sets: &[Option<GivenSet>; 2]) {
    let mut plot = Plot::new("Vanishing points from the longest segments", "seconds", "100 - AUC@10, %");
    for (name, set) in ["nyu_dev", "yud_dev"].iter().zip(sets).filter_map(|(n, s)| Some((n, s.as_ref()?))) {
        for (method, params) in &methods()[..2] {
            let points = [20, 50, 100, 200, 400, 1000].map(|most| {
                let images = set.images.iter().map(|(s, t)| (longest(s, most), t.clone())).collect();
                let part = GivenSet { images, ..*set };
                let (seconds, angles) = time(Clock::Wall, || part.angles(params));
                [seconds / part.images.len() as f64, 100.0 * (1.0 - area(&angles, 10.0))]
            });
            plot.add(&format!("{name}: {}", method.split(',').next().unwrap_or_default()), points);
        }
    }
    plot.write("vp_segments").unwrap();
}

/// The longest segments, at most `count`, in their original order.
fn longest(segments: &[Segment], count: usize) -> Vec<Segment> {
    let mut lengths: Vec<f64> = segments.iter().map(Segment::length).collect();
    lengths.sort_by(|a, b| b.total_cmp(a));
    let min_length = lengths.get(count).copied().unwrap_or(0.0);
    segments.iter().filter(|s| s.length() > min_length).copied().collect()
}

/// Finds the vanishing points of a photo. Returns the milliseconds, and for each true direction the error of the
/// nearest point and its stated error, in degrees.
fn found(photo: &Labelled, params: &Params) -> (f64, Vec<[f64; 2]>) {
    let monitor = Monitor::default();
    let (seconds, view) = time(Clock::Wall, || rectify::find_view(&photo.photo, params, monitor.job()));
    let points = view.map_or(Vec::new(), |v| v.vanishing_points.to_vec());
    let list = photo.directions.iter().map(|direction| {
        let each = points.iter().filter(|p| p.support > 0);
        each.map(|p| [errors(&[*direction], &[p.point], photo.intrinsics)[0], p.error.to_degrees()])
            .fold([90.0, f64::NAN], |a, b| if b[0] < a[0] { b } else { a })
    });
    (1e3 * seconds, list.collect())
}

fn panoramas(photos: &[Labelled]) {
    if photos.is_empty() {
        absent("vp.panorama.median_deg", "the panoramas are not there");
        absent("vp.panorama.failures", "the panoramas are not there");
        return;
    }
    let mut table =
        Table::new(["method", "median deg", "90 % below", "beyond 5 deg", "error / stated: half", "90 %", "ms"]);
    for (k, (method, params)) in methods().iter().enumerate() {
        let all: Vec<(f64, Vec<[f64; 2]>)> = photos.iter().map(|p| found(p, params)).collect();
        let flat: Vec<[f64; 2]> = all.iter().flat_map(|a| a.1.clone()).collect();
        let angles: Vec<f64> = flat.iter().map(|e| e[0]).collect();
        let shares: Vec<f64> = flat.iter().filter(|e| e[1] > 0.0).map(|e| e[0] / e[1]).collect();
        let failures = angles.iter().filter(|&&e| e > 5.0).count();
        let ms: Vec<f64> = all.iter().map(|a| a.0).collect();
        let text = |v: f64| format!("{v:.2}");
        table.row([
            (*method).into(),
            text(quantile(&angles, 0.5)),
            text(quantile(&angles, 0.9)),
            format!("{failures} of {}", angles.len()),
            text(quantile(&shares, 0.5)),
            text(quantile(&shares, 0.9)),
            format!("{:.0}", quantile(&ms, 0.5)),
        ]);
        if k == 0 {
            figure("vp.panorama.median_deg", quantile(&angles, 0.5), "degrees");
            figure("vp.panorama.failures", failures as f64, "count");
            figure("vp.panorama.of_stated", quantile(&shares, 0.9), "of the stated error, 90 % below");
        }
    }
    table.print("From pixels of re-projected panoramas, focal length unknown");
}

/// Milliseconds from the pixels of a photo of one megapixel to its vanishing points: the median over the photos of the
/// median of five runs.
fn megapixel(photos: &[Labelled]) -> f64 {
    let params = Params::default();
    let each = photos.iter().map(|photo| {
        let scale = (1e6 / (photo.photo.width * photo.photo.height) as f64).sqrt();
        let small = resized(photo, scale);
        let timings = interleaved(Clock::Wall, 5, &mut [&mut || drop(found(&small, &params))]);
        1e3 * timings.median(0)
    });
    let ms: Vec<f64> = each.collect();
    println!("one megapixel to vanishing points: {:.1} to {:.1} ms", quantile(&ms, 0.0), quantile(&ms, 1.0));
    quantile(&ms, 0.5)
}

/// Plots the error against time for photos reduced in size, by method.
fn reductions(plot: &mut Plot, photos: &[Labelled]) {
    for (method, params) in methods().iter().filter(|(_, params)| params.metric == Metric::Segment) {
        plot.add(method, SCALES.map(|scale| reduced(photos, params, scale)));
    }
}

/// Median seconds and median error on photos whose sides are multiplied by `scale`.
fn reduced(photos: &[Labelled], params: &Params, scale: f64) -> [f64; 2] {
    let (mut seconds, mut angles) = (Vec::new(), Vec::new());
    for photo in photos {
        let small = resized(photo, scale);
        let runs: Vec<_> = (0..ROUNDS).map(|_| found(&small, params)).collect();
        seconds.push(1e-3 * quantile(&runs.iter().map(|r| r.0).collect::<Vec<_>>(), 0.5));
        angles.extend(runs[0].1.iter().map(|e| e[0]));
    }
    [quantile(&seconds, 0.5), quantile(&angles, 0.5)]
}

/// Photos of the generated rooms. Everything except furniture is parallel to the axes of the world, so these axes are
/// the true directions.
fn rooms() -> Vec<Labelled> {
    let settings = [scenes::demo_office(), scenes::demo_room()].into_iter().flatten();
    settings
        .flat_map(|setting| {
            let scene = Arc::new(setting.scene);
            TURNS.map(|turn| {
                let camera = turned(&setting.camera, turn);
                let [width, height] = SIZE;
                let params = photo::Params { width, height, samples: 6, seed: 1 };
                let taken = photograph(scene.clone(), &camera, &params, Monitor::default().job());
                Labelled {
                    name: format!("{}, turned by {turn:?}", setting.name),
                    photo: taken.expect("a photo").0,
                    intrinsics: intrinsics(&camera),
                    directions: axes(&camera),
                }
            })
        })
        .collect()
}

fn turned(camera: &Camera, [left, up]: [f32; 2]) -> Camera {
    let right = camera.forward.cross(camera.up);
    let turn = Quat::from_rotation_y(left) * Quat::from_axis_angle(right, up);
    Camera { forward: turn * camera.forward, up: turn * camera.up, ..camera.clone() }
}

fn intrinsics(camera: &Camera) -> DMat3 {
    let [width, height] = SIZE.map(|side| side as f64);
    let focal = height / 2.0 / f64::from(camera.fov_y / 2.0).tan();
    DMat3::from_cols(DVec3::X * focal, DVec3::Y * focal, DVec3::new(width / 2.0, height / 2.0, 1.0))
}

/// The axes of the world in camera space (x right, y down, z forward).
fn axes(camera: &Camera) -> Vec<DVec3> {
    let [right, down, ahead] = [camera.forward.cross(camera.up), -camera.up, camera.forward].map(|v| v.as_dvec3());
    DVec3::AXES.map(|axis| DVec3::new(right.dot(axis), down.dot(axis), ahead.dot(axis)).normalize()).to_vec()
}

/// A photo with its sides scaled by `scale`.
fn resized(photo: &Labelled, scale: f64) -> Labelled {
    let [width, height] = [photo.photo.width, photo.photo.height].map(|side| (side as f64 * scale).round() as usize);
    let small = pyramid::resize(&photo.photo, width, height, Monitor::default().job()).unwrap();
    let k = DMat3::from_diagonal(DVec3::new(scale, scale, 1.0)) * photo.intrinsics;
    Labelled { name: photo.name.clone(), photo: small, intrinsics: k, directions: photo.directions.clone() }
}
