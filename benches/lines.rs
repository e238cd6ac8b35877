//! Benchmark of line detection against OpenCV's `LineSegmentDetector` (LSD), in turns: recall within a pixel on
//! drawings with known edges, the length of the lines that run to the true vanishing points of re-projected panoramas,
//! and time.

mod harness;
#[path = "../tests/truth/mod.rs"]
mod truth;

use glam::{DVec2, DVec3};
use harness::peer::Peer;
use harness::{Clock, Table, absent, figure, median, time};
use luxfer::exec::Pool;
use luxfer::geometry::Segment;
use luxfer::image::{Image, colour};
use luxfer::job::Monitor;
use luxfer::rectify::{Params, find_segments};
use luxfer::rng::Rng;
use std::path::{Path, PathBuf};
use truth::labelled_photos;

/// Width and height of a drawing in pixels: one megapixel.
const SIZE: [usize; 2] = [1152, 864];
/// Side in pixels of the cells of a drawing; each cell has a rectangle.
const CELL: usize = 96;
/// Contrasts of the drawings between rectangles and background, in grey levels of 255.
const STEPS: [f64; 4] = [15.0, 20.0, 30.0, 60.0];
/// Standard deviations of the noise of the drawings, in grey levels of 255.
const NOISES: [f64; 3] = [0.0, 3.0, 8.0];

/// Maximum distance in pixels of a found segment from its edge, and maximum angle between them in radians.
const MAX_DISTANCE: f64 = 1.0;
const TURNED: f64 = 0.09;

const ROUNDS: usize = 5;

/// Offset from OpenCV's coordinates, in which pixel centres are at whole numbers, to luxfer's, in which they are at
/// halves.
const HALF: DVec2 = DVec2::splat(0.5);

fn main() {
    let mut detectors = match Detectors::start() {
        Ok(detectors) => detectors,
        Err(reason) => {
            for name in ["recall.ours", "recall.lsd", "panorama.length_vs_lsd", "vs_lsd", "one_thread_vs_lsd"] {
                absent(&format!("lines.{name}"), &reason);
            }
            return;
        }
    };
    if let Err(reason) = drawings(&mut detectors).and_then(|()| panoramas(&mut detectors)) {
        absent("lines", &reason);
    }
}

/// The detectors: luxfer's with two threads and with one thread, and OpenCV's, which has one thread.
struct Detectors {
    pools: [Pool; 2],
    peer: Peer,
    folder: PathBuf,
}

/// Milliseconds of each round, for luxfer's detector with two threads, for luxfer's with one thread, and for OpenCV's;
/// and the segments that luxfer's and OpenCV's detector have found.
struct Found {
    ms: [Vec<f64>; 3],
    segments: [Vec<Segment>; 2],
}

impl Found {
    /// Median ratios between OpenCV's time and luxfer's, with two threads and with one thread.
    fn ratios(&self) -> [f64; 2] {
        [0, 1].map(|k| median(&self.ms[2].iter().zip(&self.ms[k]).map(|(t, o)| t / o).collect::<Vec<_>>()))
    }
}

impl Detectors {
    fn start() -> Result<Self, String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("out/bench/lines");
        std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        Ok(Self { pools: [2, 1].map(|n| Pool::new(n).unwrap()), peer: Peer::start("segment", "lsd.py")?, folder })
    }

    /// Detects the segments of an image with all detectors in turns; `grey` and `photo` hold the same image.
    fn run(&mut self, grey: &[u8], photo: &Image) -> Result<Found, String> {
        let [image, out] = ["image", "segments"].map(|name| self.folder.join(name));
        std::fs::write(&image, grey).map_err(|e| e.to_string())?;
        let job =
            serde_json::json!({ "image": image, "width": photo.width, "height": photo.height, "out": out }).to_string();
        let mut found = Found { ms: Default::default(), segments: Default::default() };
        let monitor = Monitor::default();
        for round in 0..=ROUNDS {
            for (pool, ms) in self.pools.iter().zip(&mut found.ms) {
                let detect = || find_segments(photo, &Params::default(), monitor.job()).unwrap();
                let (seconds, segments) = pool.run(|| time(Clock::Wall, detect));
                ms.push(1e3 * seconds);
                found.segments[0] = segments;
            }
            found.ms[2].push(1e3 * self.peer.ask(&job)?["seconds"].as_f64().ok_or("no time in the answer")?);
            if round == 0 {
                found.ms.iter_mut().for_each(Vec::clear);
            }
        }
        let numbers: Vec<f64> = std::fs::read(&out)
            .map_err(|e| e.to_string())?
            .chunks_exact(4)
            .map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])))
            .collect();
        let segment = |n: &[f64]| Segment { a: DVec2::new(n[0], n[1]) + HALF, b: DVec2::new(n[2], n[3]) + HALF };
        found.segments[1] = numbers.chunks_exact(4).map(segment).collect();
        Ok(found)
    }
}

impl Drop for Detectors {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Makes a drawing of rotated rectangles on grey, with a white margin on the right. Returns its grey levels and its
/// edges.
fn drawing(step: f64, noise: f64) -> (Vec<u8>, Vec<Segment>) {
    let [width, height] = SIZE;
    let mut rng = Rng::new(7, &[]);
    let mut between = |low: f64, high: f64| low + (high - low) * rng.next_f64();
    let white = width - width / 12;
    let mut shapes = Vec::new();
    for cell in 0..(white / CELL) * (height / CELL) {
        let corner = DVec2::new((cell % (white / CELL)) as f64, (cell / (white / CELL)) as f64) * CELL as f64;
        let turn = between(0.0, std::f64::consts::PI);
        let half = DVec2::new(between(10.0, 30.0), between(4.0, 30.0));
        let centre = corner + CELL as f64 / 2.0 + DVec2::new(between(-3.0, 3.0), between(-3.0, 3.0));
        let level = 120.0 + if between(0.0, 1.0) < 0.5 { -step } else { step };
        shapes.push((centre, DVec2::from_angle(turn), half, level));
    }
    let mut edges: Vec<Segment> = Vec::new();
    for &(centre, along, half, _) in &shapes {
        let corner = |x: f64, y: f64| centre + along * (x * half.x) + along.perp() * (y * half.y);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        edges.extend((0..4).map(|i| Segment { a: corners[i], b: corners[(i + 1) % 4] }));
    }
    let margin = |y: f64| DVec2::new(white as f64, y);
    edges.push(Segment { a: margin(0.0), b: margin(height as f64) });

    const SUB: usize = 8;
    let level = |p: DVec2| {
        if p.x >= white as f64 {
            return 255.0;
        }
        let cell = (p.x as usize / CELL).min(white / CELL - 1) + (p.y as usize / CELL) * (white / CELL);
        let (centre, along, half, level) = shapes[cell];
        let d = p - centre;
        let inside = along.dot(d).abs() < half.x && along.perp_dot(d).abs() < half.y;
        if inside { level } else { 120.0 }
    };
    let pixel = |i: usize| {
        let corner = DVec2::new((i % width) as f64, (i / width) as f64);
        let sub = |k: usize| DVec2::new((k % SUB) as f64 + 0.5, (k / SUB) as f64 + 0.5) / SUB as f64;
        let mean = (0..SUB * SUB).map(|k| level(corner + sub(k))).sum::<f64>() / (SUB * SUB) as f64;
        (mean + noise * Rng::new(8, &[i as u64]).normal()).round().clamp(0.0, 255.0) as u8
    };
    ((0..width * height).map(pixel).collect(), edges)
}

/// Share of the length of the segments `a` that lies along some segment of `b`.
fn covered(a: &[Segment], b: &[Segment]) -> f64 {
    let (mut hits, mut all) = (0usize, 0usize);
    for s in a {
        let direction = (s.b - s.a).normalize_or_zero();
        let reach = s.length() / 2.0;
        let near: Vec<&Segment> = (b.iter())
            .filter(|t| t.midpoint().distance(s.midpoint()) < reach + t.length() / 2.0 + MAX_DISTANCE)
            .filter(|t| direction.perp_dot((t.b - t.a).normalize_or_zero()).abs() < TURNED.sin())
            .collect();
        let points = (s.length().round() as usize).max(1);
        all += points;
        hits += (0..points)
            .map(|k| s.a.lerp(s.b, (k as f64 + 0.5) / points as f64))
            .filter(|&p| {
                near.iter().any(|t| {
                    let (along, d) = ((t.b - t.a).normalize_or_zero(), p - t.a);
                    along.perp_dot(d).abs() <= MAX_DISTANCE
                        && (-MAX_DISTANCE..=t.length() + MAX_DISTANCE).contains(&along.dot(d))
                })
            })
            .count();
    }
    hits as f64 / all.max(1) as f64
}

fn linear(grey: u8) -> f32 {
    colour::srgb_to_linear(f32::from(grey) / 255.0)
}

fn drawings(detectors: &mut Detectors) -> Result<(), String> {
    let mut table = Table::new(["step, noise", "recall", "LSD", "precision", "LSD", "ms", "one thread", "LSD"]);
    let mut recalls = [Vec::new(), Vec::new()];
    let mut ratios = [Vec::new(), Vec::new()];
    for (step, noise) in STEPS.iter().flat_map(|&s| NOISES.map(|n| (s, n))) {
        let (grey, edges) = drawing(step, noise);
        let photo = Image::from_fn(SIZE[0], SIZE[1], |x, y| [linear(grey[y * SIZE[0] + x]); 3]).unwrap();
        let found = detectors.run(&grey, &photo)?;
        let mut cells = vec![format!("{step}, {noise}")];
        for (k, recalls) in recalls.iter_mut().enumerate() {
            recalls.push(covered(&edges, &found.segments[k]));
            cells.push(format!("{:.3}", recalls[recalls.len() - 1]));
        }
        cells.extend(found.segments.iter().map(|s| format!("{:.3}", covered(s, &edges))));
        cells.extend(found.ms.iter().map(|ms| format!("{:.1}", median(ms))));
        table.row(cells);
        found.ratios().into_iter().zip(&mut ratios).for_each(|(r, all)| all.push(r));
    }
    table.print("Edges of drawings found within a pixel, by length; precision: segments within a pixel of an edge");
    for (name, recalls) in ["ours", "lsd"].iter().zip(&recalls) {
        figure(&format!("lines.recall.{name}"), 100.0 * recalls.iter().sum::<f64>() / recalls.len() as f64, "%");
    }
    figure("lines.drawings.vs_lsd", median(&ratios[0]), "x");
    Ok(())
}

fn panoramas(detectors: &mut Detectors) -> Result<(), String> {
    let photos = labelled_photos();
    if photos.is_empty() {
        ["panorama.length_vs_lsd", "vs_lsd", "one_thread_vs_lsd"]
            .iter()
            .for_each(|name| absent(&format!("lines.{name}"), "the panoramas are not there"));
        return Ok(());
    }
    let mut table = Table::new(["photo", "segments", "LSD", "to the points, px", "LSD", "ms", "one thread", "LSD"]);
    let mut lengths = Vec::new();
    let mut ratios = [Vec::new(), Vec::new()];
    for photo in &photos {
        let image = &photo.photo;
        let encoded = |x: usize, y: usize| {
            let [r, g, b] = image.rgb(x, y).to_array().map(|v| colour::linear_to_srgb(v.clamp(0.0, 1.0)));
            (255.0 * (0.299 * r + 0.587 * g + 0.114 * b)).round() as u8
        };
        let grey: Vec<u8> =
            (0..image.width * image.height).map(|i| encoded(i % image.width, i / image.width)).collect();
        let found = detectors.run(&grey, image)?;
        let points: Vec<DVec3> = photo.directions.iter().map(|&d| photo.intrinsics * d).collect();
        let length = [0, 1].map(|k| {
            let runs = |s: &&Segment| points.iter().any(|&p| end_distance(s, p) < MAX_DISTANCE);
            found.segments[k].iter().filter(runs).map(Segment::length).sum::<f64>()
        });
        lengths.push(length[0] / length[1]);
        let mut cells = vec![photo.name.clone()];
        cells.extend(found.segments.iter().map(|s| s.len().to_string()));
        cells.extend(length.iter().map(|l| format!("{l:.0}")));
        cells.extend(found.ms.iter().map(|ms| format!("{:.1}", median(ms))));
        table.row(cells);
        found.ratios().into_iter().zip(&mut ratios).for_each(|(r, all)| all.push(r));
    }
    table.print("Re-projected panoramas: length of the segments whose ends are within a pixel of a line to a true vanishing point");
    figure("lines.panorama.length_vs_lsd", median(&lengths), "x");
    figure("lines.vs_lsd", median(&ratios[0]), "x");
    figure("lines.one_thread_vs_lsd", median(&ratios[1]), "x");
    Ok(())
}

/// Distance in pixels of the ends of a segment from the line through its midpoint and a homogeneous point.
fn end_distance(s: &Segment, point: DVec3) -> f64 {
    let away = point.truncate() - s.midpoint() * point.z;
    (s.b - s.a).perp_dot(away.normalize_or_zero()).abs() / 2.0
}
