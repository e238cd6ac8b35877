//! Benchmark of warping by homographies against OpenCV's `warpPerspective`: the time, and the difference from the
//! exact picture under magnification and under minification.
//!
//! Both get an image of three floats per pixel, equal result sizes and two threads. luxfer interpolates or averages as
//! needed; OpenCV's warp does not average (it treats `INTER_AREA` as linear). OpenCV's linear and cubic interpolation
//! are timed. The headline figure compares with the cubic one, which equals luxfer's result where nothing is minified.
//! The truth is the mean of a hundred points in each pixel. The filter has no settings; a curve of error against time,
//! with more pixels than needed and averaging, or with fewer pixels and enlarging, shows whether a setting would help.

mod harness;

use glam::{DMat3, DVec2, DVec3};
use harness::peer::Peer;
use harness::plot::Plot;
use harness::{Clock, Table, absent, figure, median, time};
use luxfer::exec::Pool;
use luxfer::geometry::Homography;
use luxfer::image::{Image, pyramid};
use luxfer::job::Monitor;
use luxfer::rectify::warp;
use std::path::{Path, PathBuf};

const SOURCE: [usize; 2] = [2048, 1536];
const OUT: [usize; 2] = [1024, 768];
const ROUNDS: usize = 7;
const INTERPOLATIONS: [&str; 2] = ["linear", "cubic"];

/// Limits in source pixels per result pixel, along a side: pixels above the first count as minified, pixels below the
/// second as magnified.
const MINIFIED: f64 = 1.5;
const MAGNIFIED: f64 = 1.0;

/// Sides of the computed result, relative to the sides of the wanted result.
const DENSITIES: [f64; 6] = [0.25, 0.5, 0.75, 1.0, 2.0, 3.0];

fn main() {
    let pool = Pool::new(2).unwrap();
    let identity = Homography(DMat3::IDENTITY);
    let source = Image::from_fn(SOURCE[0], SOURCE[1], |x, y| exact(&identity, x, y, 6)).unwrap();
    pool.run(|| densities(&source));
    if let Err(reason) = run(&pool, &source) {
        for name in ["warp.vs_opencv", "warp.busy_vs_opencv", "warp.minified.psnr_gain"] {
            absent(name, &reason);
        }
    }
}

/// Colour of the test picture at a point: a ceiling of square lamps, with thin gaps between its tiles.
fn picture(p: DVec2) -> [f32; 3] {
    let tile = DVec2::new(p.x.rem_euclid(36.0), p.y.rem_euclid(36.0));
    let is_lamp = tile.min_element() > 8.0 && tile.max_element() < 24.0;
    if is_lamp {
        [0.95, 0.9, 0.8]
    } else if tile.min_element() < 2.5 {
        [0.1; 3]
    } else {
        [0.4, 0.4, 0.42]
    }
}

/// Mean of the picture over pixel (x, y) of a warped image, from `sub` x `sub` points.
fn exact(to_picture: &Homography, x: usize, y: usize, sub: usize) -> [f32; 3] {
    let mut sum = [0.0f32; 3];
    for k in 0..sub * sub {
        let at = DVec2::new((k % sub) as f64 + 0.5, (k / sub) as f64 + 0.5) / sub as f64;
        let value = picture(to_picture.apply(DVec2::new(x as f64, y as f64) + at));
        sum.iter_mut().zip(value).for_each(|(s, v)| *s += v);
    }
    sum.map(|s| s / (sub * sub) as f32)
}

/// Homographies from the result to the source: two planes seen at an angle, and one plane that is minified everywhere.
fn maps() -> [(&'static str, Homography); 3] {
    let [w, h] = OUT.map(|v| v as f64);
    let [sw, sh] = SOURCE.map(|v| v as f64);
    let from = [DVec2::ZERO, DVec2::new(w, 0.0), DVec2::new(w, h), DVec2::new(0.0, h)];
    let to = |top: f64, bottom: f64, low: f64| {
        let corner = |x: f64, y: f64| DVec2::new(sw / 2.0 + x / 2.0, y);
        [corner(-top, 8.0), corner(top, 8.0), corner(bottom, low), corner(-bottom, low)]
    };
    let map = |corners| Homography::from_corners(from, corners).unwrap();
    [
        ("magnified 1 to 4 times", map(to(1000.0, 260.0, 500.0))),
        ("from a half to twice the size", map(to(sw - 16.0, 512.0, sh - 8.0))),
        ("minified 2 to 4 times", Homography(DMat3::from_scale(DVec2::splat(4.0)).mul_mat3(&keystone(w, h)))),
    ]
}

/// Homography that shrinks a rectangle to half its size, and its lower side to a quarter.
fn keystone(w: f64, h: f64) -> DMat3 {
    let from = [DVec2::ZERO, DVec2::new(w, 0.0), DVec2::new(w, h), DVec2::new(0.0, h)];
    let size = DVec2::new(w, h) / 2.0;
    let to =
        [DVec2::ZERO, DVec2::new(size.x, 0.0), DVec2::new(0.75 * size.x, size.y), DVec2::new(0.25 * size.x, size.y)];
    Homography::from_corners(from, to).unwrap().0
}

/// Number of source pixels per result pixel at the point `p`, along a side.
fn minification(map: &Homography, p: DVec2) -> f64 {
    let at = |d: DVec2| map.apply(p + d);
    let [u, v] = [DVec2::X, DVec2::Y].map(|d| at(d / 2.0) - at(-d / 2.0));
    u.perp_dot(v).abs().sqrt()
}

/// Number of source pixels per result pixel, along a side; NaN for pixels whose neighbourhood leaves the source.
fn minifications(map: &Homography) -> Vec<f64> {
    let limit = DVec2::new(SOURCE[0] as f64, SOURCE[1] as f64) - 16.0;
    let inside = |p: DVec2| {
        let DVec3 { x, y, z } = map.apply_homogeneous(p);
        let q = DVec2::new(x, y) / z;
        q.min_element() > 16.0 && q.cmple(limit).all()
    };
    let place = |i: usize| DVec2::new((i % OUT[0]) as f64 + 0.5, (i / OUT[0]) as f64 + 0.5);
    let places = (0..OUT[0] * OUT[1]).map(place);
    places.map(|p| if inside(p) { minification(map, p) } else { f64::NAN }).collect()
}

/// The exact result of a warp.
fn truth(map: &Homography) -> Image {
    Image::from_fn(OUT[0], OUT[1], |x, y| exact(map, x, y, 10)).unwrap()
}

/// Measures error against time for several numbers of computed pixels.
fn densities(source: &Image) {
    let monitor = Monitor::default();
    let mut plot = Plot::new("Warping, 1024 x 768 from 2048 x 1536", "seconds", "root mean square error");
    let mut table = Table::new(["map", "pixels warped to, along a side", "seconds", "PSNR dB"]);
    for (name, map) in maps() {
        let (truth, admitted) = (truth(&map), minifications(&map).into_iter().map(f64::is_finite).collect::<Vec<_>>());
        let points = DENSITIES.map(|density| {
            let [width, height] = OUT.map(|side| (side as f64 * density) as usize);
            let dense = Homography(map.0 * DMat3::from_scale(DVec2::splat(1.0 / density)));
            let run = || {
                let warped = warp(source, &dense, width, height, monitor.job()).unwrap();
                let is_wanted = [width, height] == OUT;
                if is_wanted { warped } else { pyramid::resize(&warped, OUT[0], OUT[1], monitor.job()).unwrap() }
            };
            let runs: Vec<(f64, Image)> = (0..ROUNDS).map(|_| time(Clock::Wall, run)).collect();
            let seconds = median(&runs.iter().map(|r| r.0).collect::<Vec<_>>());
            let psnr = psnr(&runs[0].1.data, &truth.data, &admitted);
            table.row([name.to_string(), format!("{density}"), format!("{seconds:.4}"), format!("{psnr:.2}")]);
            [seconds, 10f64.powf(-psnr / 20.0)]
        });
        plot.add(&format!("{name}: more or fewer pixels"), points);
    }
    table.print("Warps to more or fewer pixels than are wanted, then averaged or enlarged");
    plot.write("warp_density").unwrap();
}

/// Peak signal-to-noise ratio in dB, over the pixels that the mask admits.
fn psnr(found: &[f32], truth: &[f32], admitted: &[bool]) -> f64 {
    let mut squares = (0.0, 0.0);
    for ((a, b), _) in found.chunks_exact(3).zip(truth.chunks_exact(3)).zip(admitted).filter(|p| *p.1) {
        squares.0 += a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
        squares.1 += 3.0;
    }
    -10.0 * (squares.0 / squares.1).log10()
}

fn write(path: &Path, image: &Image) -> Result<(), String> {
    std::fs::write(path, image.data.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
        .map_err(|e| e.to_string())
}

/// The peer's process (OpenCV), and the files through which it gets the source image and returns its results.
struct Exchange {
    peer: Peer,
    image: PathBuf,
    out: PathBuf,
}

impl Exchange {
    fn new(source: &Image) -> Result<Self, String> {
        let folder: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("out/bench");
        std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        let [image, out] = ["warp_image.bin", "warp_result.bin"].map(|name| folder.join(name));
        let peer = Peer::start("segment", "warp.py")?;
        write(&image, source)?;
        Ok(Self { peer, image, out })
    }

    /// Makes a request to warp the source image, as JSON.
    fn request(&self, map: &Homography, interpolation: &str) -> String {
        let half = DMat3::from_translation(DVec2::splat(0.5));
        let matrix = half.inverse() * map.0 * half;
        let rows: Vec<f64> = (0..9).map(|k| matrix.col(k % 3)[k / 3]).collect();
        serde_json::json!({
            "image": self.image, "width": SOURCE[0], "height": SOURCE[1], "map": rows, "out_width": OUT[0],
            "out_height": OUT[1], "interpolation": interpolation, "out": self.out,
        })
        .to_string()
    }

    /// Reads the result of the peer's latest warp.
    fn result(&self) -> Result<Vec<f32>, String> {
        let bytes = std::fs::read(&self.out).map_err(|e| e.to_string())?;
        let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        Ok(bytes.chunks_exact(4).map(float).collect())
    }
}

/// Measurements of one homography: of luxfer's warp, then of OpenCV's warp with each of `INTERPOLATIONS`.
#[derive(Default)]
struct Measured {
    /// Wall-clock seconds of each round.
    seconds: [Vec<f64>; 3],
    /// Processor seconds of each round.
    busy: [Vec<f64>; 3],
    found: [Vec<f32>; 3],
}

/// Times luxfer and OpenCV in turns; the first round is not counted.
fn measure(pool: &Pool, source: &Image, map: &Homography, exchange: &mut Exchange) -> Result<Measured, String> {
    let monitor = Monitor::default();
    let mut measured = Measured::default();
    let Measured { seconds, busy, found } = &mut measured;
    for round in 0..=ROUNDS {
        let warped = || warp(source, map, OUT[0], OUT[1], monitor.job()).unwrap();
        let (on_processors, (taken, warped)) = pool.run(|| time(Clock::Process, || time(Clock::Wall, warped)));
        seconds[0].push(taken);
        busy[0].push(on_processors);
        found[0] = warped.data;
        for (k, interpolation) in INTERPOLATIONS.iter().enumerate() {
            let request = exchange.request(map, interpolation);
            let answer = exchange.peer.ask(&request)?;
            for (name, to) in [("seconds", &mut *seconds), ("busy", &mut *busy)] {
                to[k + 1].push(answer[name].as_f64().ok_or("no time in the answer")?);
            }
            if round == 0 {
                found[k + 1] = exchange.result()?;
            }
        }
        if round == 0 {
            seconds.iter_mut().chain(&mut *busy).for_each(Vec::clear);
        }
    }
    Ok(measured)
}

fn run(pool: &Pool, source: &Image) -> Result<(), String> {
    let mut exchange = Exchange::new(source)?;
    let head = [
        "map and pixels",
        "ours dB",
        "linear dB",
        "cubic dB",
        "ours ms",
        "linear ms",
        "cubic ms",
        "ours busy ms",
        "linear busy ms",
        "cubic busy ms",
    ];
    let mut table = Table::new(head);
    let [mut ratios, mut busy_ratios] = [Vec::new(), Vec::new()];
    let mut gains = Vec::new();
    for (name, map) in maps() {
        let Measured { seconds, busy, found } = measure(pool, source, &map, &mut exchange)?;
        let (truth, sizes) = (truth(&map), minifications(&map));
        let ms = seconds.iter().chain(&busy).map(|s| format!("{:.1}", 1e3 * median(s))).collect::<Vec<_>>();
        for (kind, admits) in
            [("magnified", &(|s: f64| s < MAGNIFIED) as &dyn Fn(f64) -> bool), ("minified", &|s| s > MINIFIED)]
        {
            let admitted: Vec<bool> = sizes.iter().map(|&s| admits(s)).collect();
            if admitted.iter().filter(|&&a| a).count() < 1000 {
                continue;
            }
            let each = found.each_ref().map(|f| psnr(f, &truth.data, &admitted));
            if kind == "minified" {
                gains.push(each[0] - each[1].max(each[2]));
            }
            let mut cells = vec![format!("{name}: {kind}")];
            cells.extend(each.map(|v| format!("{v:.2}")));
            cells.extend(ms.clone());
            table.row(cells);
        }
        let ratio = |of: &[Vec<f64>; 3]| median(&of[2].iter().zip(&of[0]).map(|(t, o)| t / o).collect::<Vec<_>>());
        ratios.push(ratio(&seconds));
        busy_ratios.push(ratio(&busy));
    }
    table.print("Warps of three channels, and their PSNR beside the exact picture");
    for path in [exchange.image, exchange.out] {
        let _ = std::fs::remove_file(path);
    }
    println!("time of OpenCV's cubic over ours: {ratios:.2?}, of the processors {busy_ratios:.2?}");
    figure("warp.vs_opencv", median(&ratios), "x");
    figure("warp.busy_vs_opencv", median(&busy_ratios), "x");
    figure("warp.minified.psnr_gain", gains.iter().copied().fold(f64::INFINITY, f64::min), "dB");
    Ok(())
}
