//! Benchmark of segmentation: the time per megapixel; masks compared with GrabCut, a random forest and a support
//! vector machine with RBF kernel from equal strokes; calibration; and the paper's Figs. 5 (samples) and 6 (channels)
//! on rooms with exact masks. With the argument `masks`: only masks and calibration.

mod harness;

use glam::{DMat3, DVec2};
use harness::peer::Peer;
use harness::plot::Plot;
use harness::{Clock, Table, absent, figure, interleaved, median, time};
use luxfer::exec::Pool;
use luxfer::features::{self, CHANNELS, DepthKind, DepthMap, RoomView};
use luxfer::geometry::{FocalSource, Perspective};
use luxfer::image::Image;
use luxfer::image::io::{Encoding, load};
use luxfer::job::Monitor;
use luxfer::rectify;
use luxfer::rng::Rng;
use luxfer::segment::{self, Input, Params, Segmentation, Stroke, strokes};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const SIZE: [usize; 2] = [1152, 868];
const PEERS: [&str; 3] = ["grabcut", "rf", "svm"];
const ROUNDS: usize = 5;

/// A photo with strokes and its true mask.
struct Case {
    name: String,
    photo: Image,
    features: Arc<Image>,
    strokes: Vec<Stroke>,
    /// For a mask of lights: the strokes of the plane that contains the lights.
    plane: Option<Vec<Stroke>>,
    truth: Image,
}

fn main() {
    let pool = Pool::new(2).unwrap();
    let cases: Vec<Case> = pool.run(|| {
        let rooms = [1, 2].into_iter().flat_map(room);
        rooms.chain(photos()).collect()
    });
    let rooms: Vec<&Case> = cases.iter().filter(|c| c.plane.is_none()).collect();
    if std::env::args().any(|arg| arg == "masks") {
        masks(&pool, &cases, f64::NAN);
        return pool.run(|| calibration(&rooms));
    }
    if std::env::args().any(|arg| arg == "channels") {
        return pool.run(|| channels(&rooms));
    }
    let update = pool.run(|| timing(&cases[0]));
    masks(&pool, &cases, update);
    pool.run(|| refinement(&cases));
    pool.run(|| {
        calibration(&rooms);
        samples(&rooms);
        knobs(&rooms);
        channels(&rooms);
    });
}

fn segmented(case: &Case, params: &Params) -> Segmentation {
    let monitor = Monitor::default();
    let run = |strokes: &[Stroke], region: Option<&Image>, params: &Params| {
        segment::run(&Input { features: &case.features, strokes, region }, params, monitor.job()).unwrap()
    };
    match &case.plane {
        None => run(&case.strokes, None, params),
        Some(plane) => {
            let plane = run(plane, None, params);
            run(&case.strokes, Some(&plane.mask), &Params { channels: 0b111, ..params.clone() })
        }
    }
}

fn iou(a: &Image, b: &Image) -> f64 {
    let pairs = || a.data.iter().zip(&b.data).map(|(a, b)| (*a > 0.5, *b > 0.5));
    let both = pairs().filter(|(a, b)| *a && *b).count();
    both as f64 / pairs().filter(|(a, b)| *a || *b).count().max(1) as f64
}

/// Index of the lamps among the surfaces of a room, after its six faces.
const LAMP: usize = 6;

/// A generated room with lamps in its ceiling, whose walls have nearly the ceiling's colour. It gives two cases: one
/// with a stroke on every surface, and one with strokes only on the ceiling, its lamps and one wall.
fn room(seed: u64) -> [Case; 2] {
    let [width, height] = SIZE;
    let mut draw = Rng::new(seed, &[]);
    let mut between = |low: f64, high: f64| low + (high - low) * draw.next_f64();
    let axes = DMat3::from_rotation_y(between(-0.5, 0.5)) * DMat3::from_rotation_x(-between(0.1, 0.35));
    let principal = DVec2::new(width as f64, height as f64) / 2.0;
    let camera =
        Perspective { focal: between(600.0, 900.0), focal_source: FocalSource::Given, principal, bend: 0.0, axes };
    let faces = [(1, -1.3), (1, 1.3), (0, -2.2), (0, 2.4), (2, 5.0), (2, -2.0)];
    let paints =
        [[0.62, 0.6, 0.55], [0.2, 0.15, 0.1], [0.6, 0.57, 0.52], [0.45, 0.5, 0.48], [0.63, 0.6, 0.54], [0.5; 3]];
    let seen = |x: usize, y: usize| {
        let toward = camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let ray = axes.transpose() * toward;
        let hit = |&(axis, at): &(usize, f64)| at / ray[axis];
        let ahead = |t: f64| if t > 0.0 { t } else { f64::INFINITY };
        let (face, t) =
            faces.iter().map(|f| ahead(hit(f))).enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 1.0));
        let p = ray * t;
        let lamp = face == 0 && p.x.rem_euclid(1.2) < 0.3 && p.z.rem_euclid(1.0) < 0.6;
        (if lamp { LAMP } else { face }, p, toward.z * t)
    };
    let face_of: Vec<usize> = (0..width * height).map(|i| seen(i % width, i / width).0).collect();
    let depth = Image::from_fn(width, height, |x, y| [seen(x, y).2 as f32]).unwrap();
    let photo = Image::from_fn(width, height, |x, y| {
        let (face, p, _) = seen(x, y);
        let mut rng = Rng::new(seed, &[x as u64, y as u64]);
        if face == LAMP {
            return [1.0; 3];
        }
        // Illumination decreases towards the corners and along the room.
        let shade = 0.5 + 0.5 * (-(p.x * p.x + p.y * p.y) / 8.0 - (p.z - 2.0).powi(2) / 20.0).exp();
        std::array::from_fn(|c| ((paints[face][c] * shade) as f32 * (1.0 + 0.04 * rng.normal() as f32)).clamp(0.0, 1.0))
    });
    let photo = photo.unwrap();
    let room = RoomView { perspective: &camera, segments: &[], strokes: &[], layout: None };
    let map = DepthMap { image: &depth, kind: DepthKind::AlongZ };
    let input = features::Input { photo: &photo, depth: Some(map), room: Some(room) };
    let features = features::run(&input, &Default::default(), Monitor::default().job()).unwrap().image;
    let truth = Image::from_fn(width, height, |x, y| [f32::from(matches!(face_of[y * width + x], 0 | LAMP))]).unwrap();

    let set = |faces: &[(usize, u64)]| {
        let drawn = |&(face, turn): &(usize, u64)| {
            let line = longest_line(&face_of, face, Rng::new(seed, &[face as u64, turn, 7]))?;
            Some(Stroke::polyline(&line, 5.0, matches!(face, 0 | LAMP), width, height).unwrap())
        };
        faces.iter().filter_map(drawn).collect::<Vec<_>>()
    };
    let everywhere = set(&[(0, 0), (0, 1), (LAMP, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0)]);
    let sparse = set(&[(0, 0), (0, 1), (LAMP, 0), (4, 0)]);
    [("a stroke on every surface", everywhere), ("strokes on one wall only", sparse)].map(|(how, strokes)| Case {
        name: format!("room {seed}, {how}"),
        photo: photo.clone(),
        features: features.clone(),
        strokes,
        plane: None,
        truth: truth.clone(),
    })
}

/// The longest of several random lines that stay on one face; `face_of` holds the face of each pixel.
fn longest_line(face_of: &[usize], face: usize, mut rng: Rng) -> Option<[DVec2; 2]> {
    let [width, height] = SIZE;
    let mut pick = || DVec2::new(rng.next_f64() * width as f64, rng.next_f64() * height as f64);
    let on = |p: DVec2| face_of[(p.y as usize).min(height - 1) * width + (p.x as usize).min(width - 1)] == face;
    let mut best: Option<[DVec2; 2]> = None;
    for _ in 0..4000 {
        let [a, b] = [pick(), pick()];
        let longer = best.is_none_or(|[c, d]| a.distance(b) > c.distance(d));
        let length = a.distance(b);
        if longer && length < 350.0 && (0..=20).all(|k| on(a.lerp(b, f64::from(k) / 20.0))) {
            best = Some([a, b]);
        }
    }
    best
}

/// Loads photos with true masks of their lights, with the strokes of the tests.
fn photos() -> Vec<Case> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let data = std::env::var_os("LUXFER_TEST_DATA").map_or_else(|| root.join("../shared/data"), PathBuf::from);
    let monitor = Monitor::default();
    let names = ["alma_corridor", "alma_glassroom", "alma_racks", "peabody_atrium"];
    let case = |name: &&str| {
        let photo = load(&data.join(format!("photos/{name}.jpg")), Encoding::Srgb).ok()?;
        let truth = load(&data.join(format!("photo_truth/masks/{name}_mask.png")), Encoding::Linear).ok()?;
        let text = std::fs::read_to_string(root.join(format!("tests/strokes/{name}.txt"))).ok()?;
        let set = strokes::parse(&text, photo.width, photo.height).ok()?;
        let view = rectify::find_view(&photo, &Default::default(), monitor.job()).ok()?;
        let room = RoomView { perspective: &view.perspective, segments: &view.segments, strokes: &[], layout: None };
        let input = features::Input { photo: &photo, depth: None, room: Some(room) };
        let features = features::run(&input, &Default::default(), monitor.job()).ok()?.image;
        Some(Case {
            name: format!("lights of {name}"),
            features,
            plane: Some(set.plane_examples()),
            strokes: set.lights,
            truth: truth.channel(0).ok()?,
            photo,
        })
    };
    names.iter().filter_map(case).collect()
}

/// Times three runs: with the strokes of the case, with one more stroke, and with more strokes over the same pixels.
/// Returns the milliseconds of the first.
fn timing(case: &Case) -> f64 {
    let [width, height] = SIZE;
    let line = [DVec2::new(100.0, 700.0), DVec2::new(300.0, 760.0)];
    let mut more = case.strokes.clone();
    more.push(Stroke::polyline(&line, 5.0, false, width, height).unwrap());
    // Split each stroke into many strokes that cover the same pixels.
    let pieces = |s: &Stroke| {
        s.pixels.chunks(s.pixels.len().div_ceil(20)).map(|p| Stroke { pixels: p.to_vec(), ..*s }).collect::<Vec<_>>()
    };
    let many: Vec<Stroke> = case.strokes.iter().flat_map(pieces).collect();
    let monitor = Monitor::default();
    let run = |strokes: &[Stroke]| {
        let input = Input { features: &case.features, strokes, region: None };
        segment::run(&input, &Params::default(), monitor.job()).unwrap();
    };
    let timings =
        interleaved(Clock::Wall, ROUNDS, &mut [&mut || run(&case.strokes), &mut || run(&more), &mut || run(&many)]);
    let mut table = Table::new(["1 megapixel, 10 channels, 2 threads", "ms"]);
    let names = [
        format!("{} strokes", case.strokes.len()),
        "one more (nothing is kept from the run before)".into(),
        format!("the same pixels in {} strokes", many.len()),
    ];
    for (i, name) in names.into_iter().enumerate() {
        table.row([name, format!("{:.1}", 1e3 * timings.median(i))]);
    }
    table.print("Training and inference");
    figure("segment.train_infer.ms", 1e3 * timings.median(0), "ms");
    figure("segment.update.ms", 1e3 * timings.median(1), "ms");
    1e3 * timings.median(0)
}

/// The process of the peers, and the folder of the files that are exchanged with it.
struct Exchange {
    folder: PathBuf,
    peer: Peer,
}

impl Exchange {
    fn start() -> Result<Self, String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("out/bench/segment");
        std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        Ok(Self { folder, peer: Peer::start("segment", "segment.py")? })
    }

    fn write(&self, name: &str, bytes: Vec<u8>) -> Result<PathBuf, String> {
        let path = self.folder.join(name);
        std::fs::write(&path, bytes).map_err(|e| e.to_string())?;
        Ok(path)
    }

    /// Runs one phase (plane or lights) in the peer; returns its seconds and the mask.
    fn phase(
        &mut self,
        case: &Case,
        method: &str,
        strokes: &[Stroke],
        region: Option<&Image>,
    ) -> Result<(f64, Image), String> {
        let (width, height) = (case.photo.width, case.photo.height);
        let mut painted = vec![0u8; width * height];
        for stroke in strokes {
            stroke.pixels.iter().for_each(|&p| painted[p as usize] = 1 + u8::from(stroke.positive));
        }
        let use_channels: Vec<usize> = (0..if region.is_some() { 3 } else { CHANNELS }).collect();
        let mut job = serde_json::json!({
            "method": method, "width": width, "height": height, "channels": CHANNELS, "use": use_channels,
            "strokes": self.write("strokes", painted)?, "out": self.folder.join("out"),
            "features": self.folder.join("features"), "photo": self.folder.join("photo"),
        });
        if let Some(region) = region {
            let bytes = region.data.iter().map(|&v| u8::from(v > 0.5)).collect();
            job["within"] = self.write("within", bytes)?.to_string_lossy().into_owned().into();
        }
        let seconds = self.peer.ask(&job.to_string())?["seconds"].as_f64().ok_or("no time in the answer")?;
        let out = std::fs::read(self.folder.join("out")).map_err(|e| e.to_string())?;
        let mask = Image::from_fn(width, height, |x, y| [f32::from(out[y * width + x])]);
        Ok((seconds, mask.map_err(|e| e.to_string())?))
    }

    /// Runs a case in the peer, in as many phases as our method has; returns the seconds and the mask.
    fn run(&mut self, case: &Case, method: &str) -> Result<(f64, Image), String> {
        let floats = case.features.data.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.write("features", floats)?;
        let encode = |v: f32| (255.0 * luxfer::image::colour::linear_to_srgb(v.clamp(0.0, 1.0))).round() as u8;
        let bgr = case.photo.data.chunks_exact(case.photo.channels).flat_map(|p| [p[2], p[1], p[0]].map(encode));
        self.write("photo", bgr.collect())?;
        let Some(plane) = &case.plane else { return self.phase(case, method, &case.strokes, None) };
        if method == "grabcut" {
            // GrabCut has no features that describe the plane, so strokes beside the plane count as negative strokes
            // for the lights.
            let others = plane.iter().filter(|s| !s.positive);
            let all: Vec<Stroke> = others.chain(&case.strokes).cloned().collect();
            return self.phase(case, method, &all, None);
        }
        let (first, plane) = self.phase(case, method, plane, None)?;
        let (second, mask) = self.phase(case, method, &case.strokes, Some(&plane))?;
        Ok((first + second, mask))
    }
}

fn masks(pool: &Pool, cases: &[Case], ours_ms: f64) {
    let mut exchange = Exchange::start();
    let mut table =
        Table::new(["case", "ours", "grabCut", "random forest", "SVM", "ms ours", "grabCut", "forest", "SVM"]);
    let mut all: [Vec<f64>; 4] = Default::default();
    let mut grabcut_ratio = Vec::new();
    for case in cases {
        let (seconds, ours) = pool.run(|| time(Clock::Wall, || segmented(case, &Params::default())));
        let mut found = vec![(seconds, iou(&ours.mask, &case.truth))];
        if let Ok(exchange) = &mut exchange {
            for method in PEERS {
                match exchange.run(case, method) {
                    Ok((seconds, mask)) => found.push((seconds, iou(&mask, &case.truth))),
                    Err(reason) => println!("# {method} on {}: {reason}", case.name),
                }
            }
        }
        found.iter().enumerate().for_each(|(k, f)| all[k].push(f.1));
        if let Some(grabcut) = found.get(1).filter(|_| case.plane.is_none()) {
            grabcut_ratio.push(grabcut.0 / seconds);
        }
        let mut cells = vec![case.name.clone()];
        cells.extend(found.iter().map(|f| format!("{:.4}", f.1)));
        cells.extend(found.iter().map(|f| format!("{:.0}", 1e3 * f.0)));
        // Print each row at once, because the peers take minutes.
        println!("# {}", cells.join("  "));
        table.row(cells);
    }
    table.print(&format!("Intersection over union, and time (ours {ours_ms:.0} ms in a row)"));
    if let Ok(exchange) = &exchange {
        let _ = std::fs::remove_dir_all(&exchange.folder);
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    figure("segment.iou.ours", mean(&all[0]), "-");
    for (k, name) in PEERS.iter().enumerate() {
        match &exchange {
            Ok(_) if all[k + 1].len() == cases.len() => figure(&format!("segment.iou.{name}"), mean(&all[k + 1]), "-"),
            Ok(_) => absent(&format!("segment.iou.{name}"), "the peer failed on a case"),
            Err(reason) => absent(&format!("segment.iou.{name}"), reason),
        }
    }
    match &exchange {
        Ok(_) => figure("segment.vs_grabcut", median(&grabcut_ratio), "x"),
        Err(reason) => absent("segment.vs_grabcut", reason),
    }
}

/// Share of wrong pixels among the pixels within four pixels of the true border.
fn border_error(mask: &Image, truth: &Image) -> f64 {
    let [width, height] = [truth.width, truth.height];
    let is_in = |x: usize, y: usize| truth.data[y * width + x] > 0.5;
    let border = Image::from_fn(width, height, |x, y| {
        let differs = |u: usize, v: usize| u < width && v < height && is_in(u, v) != is_in(x, y);
        [f32::from(differs(x + 1, y) || differs(x, y + 1))]
    });
    let near = luxfer::image::dilate(&border.unwrap(), 4.0, Monitor::default().job()).unwrap();
    let at: Vec<usize> = (0..width * height).filter(|&i| near.data[i] > 0.5).collect();
    let wrong = at.iter().filter(|&&i| (mask.data[i] > 0.5) != (truth.data[i] > 0.5)).count();
    wrong as f64 / at.len().max(1) as f64
}

/// Measures the edge-aware refinement for several radii and tolerances.
fn refinement(cases: &[Case]) {
    let mut table = Table::new(["radius", "tolerance", "IoU rooms", "photos", "border error % rooms", "photos", "ms"]);
    let kinds: [Vec<&Case>; 2] =
        [false, true].map(|photos| cases.iter().filter(|c| c.plane.is_some() == photos).collect());
    let mut plain = [[0.0; 3]; 2];
    let knobs = [
        (0, 8.0),
        (1, 8.0),
        (2, 4.0),
        (2, 8.0),
        (2, 16.0),
        (4, 2.0),
        (4, 4.0),
        (4, 8.0),
        (4, 16.0),
        (8, 8.0),
        (16, 8.0),
    ];
    for (radius, tolerance) in knobs {
        let params = Params { refine_radius: radius, refine_tolerance: tolerance, ..Params::default() };
        let of_kind = |cases: &[&Case]| {
            let found: Vec<(f64, f64, f64)> = cases
                .iter()
                .map(|case| {
                    let (seconds, found) = time(Clock::Wall, || segmented(case, &params));
                    (iou(&found.mask, &case.truth), border_error(&found.mask, &case.truth), seconds)
                })
                .collect();
            let mean = |of: fn(&(f64, f64, f64)) -> f64| found.iter().map(of).sum::<f64>() / found.len().max(1) as f64;
            [mean(|f| f.0), mean(|f| f.1), mean(|f| f.2)]
        };
        let [rooms, photos] = [of_kind(&kinds[0]), of_kind(&kinds[1])];
        if radius == 0 {
            plain = [rooms, photos];
        }
        let mut cells = vec![radius.to_string(), tolerance.to_string()];
        cells.extend([rooms[0], photos[0]].map(|v| format!("{v:.4}")));
        cells.extend([rooms[1], photos[1]].map(|v| format!("{:.2}", 100.0 * v)));
        cells.push(format!("{:.0}", 1e3 * rooms[2]));
        table.row(cells);
        if (radius, tolerance) == (4, 8.0) {
            figure("segment.refine.rooms.iou_gain", rooms[0] - plain[0][0], "-");
            figure("segment.refine.ms", 1e3 * (rooms[2] - plain[0][2]), "ms");
            if kinds[1].is_empty() {
                absent("segment.refine.photos.iou_gain", "the photos are not there");
            } else {
                figure("segment.refine.photos.iou_gain", photos[0] - plain[1][0], "-");
            }
        }
    }
    table.print("Edge-aware refinement");
}

/// Measures calibration: the share of positive pixels for each stated probability, over all rooms.
fn calibration(rooms: &[&Case]) {
    const BINS: usize = 10;
    let mut bins = [[0.0f64; 3]; BINS];
    for case in rooms {
        let found = segmented(case, &Params::default());
        for (&p, &t) in found.confidence.data.iter().zip(&case.truth.data) {
            let bin = &mut bins[((p * BINS as f32) as usize).min(BINS - 1)];
            *bin = [bin[0] + 1.0, bin[1] + f64::from(p), bin[2] + f64::from(t)];
        }
    }
    let total: f64 = bins.iter().map(|b| b[0]).sum();
    let mut table = Table::new(["stated", "observed", "pixels %"]);
    let mut plot = Plot::new("Reliability", "stated probability", "share that is positive");
    let used: Vec<[f64; 3]> = bins.into_iter().filter(|b| b[0] > 0.0).collect();
    for [n, stated, positive] in &used {
        table.row([stated / n, positive / n, 100.0 * n / total].map(|v| format!("{v:.3}")));
    }
    table.print("Reliability over all rooms");
    plot.add("observed", used.iter().map(|[n, stated, positive]| [stated / n, positive / n]));
    plot.add("ideal", [[0.01, 0.01], [1.0, 1.0]]);
    written(&plot, "segment_reliability");
    let error: f64 = used.iter().map(|[_, stated, positive]| (stated - positive).abs()).sum::<f64>() / total;
    figure("segment.calibration_error", error, "-");
}

fn written(plot: &Plot, name: &str) {
    if let Err(error) = plot.write(name) {
        println!("# no plot: {error}");
    }
}

/// Names of the two cases of each room, in their order.
const STROKES: [&str; 2] = ["every surface", "one wall only"];
const SAMPLES: [usize; 8] = [5, 10, 25, 100, 250, 1000, 5000, 25_000];

/// Median seconds and mean error (1 - IoU) over every second case, from case `half` on.
fn seconds_and_error(rooms: &[&Case], half: usize, params: &Params) -> [f64; 2] {
    let run = |case: &&Case| {
        let (seconds, found) = time(Clock::Wall, || segmented(case, params));
        (seconds, 1.0 - iou(&found.mask, &case.truth))
    };
    let runs: Vec<(f64, f64)> = rooms.iter().skip(half).step_by(2).map(run).collect();
    let error = runs.iter().map(|r| r.1).sum::<f64>() / runs.len() as f64;
    [median(&runs.iter().map(|r| r.0).collect::<Vec<_>>()), error]
}

/// Measures error and time against the number of samples, as in the paper's Fig. 5.
fn samples(rooms: &[&Case]) {
    let mut error = Plot::new("Samples of each class", "samples", "1 - IoU");
    let mut took = Plot::new("Time of training and inference", "samples", "ms");
    for (half, name) in STROKES.iter().enumerate() {
        let points = SAMPLES.map(|samples_per_class| {
            let params = Params { samples_per_class, ..Params::default() };
            (samples_per_class as f64, seconds_and_error(rooms, half, &params))
        });
        error.add(name, points.map(|(count, [_, error])| [count, error]));
        took.add(name, points.map(|(count, [seconds, _])| [count, 1e3 * seconds]));
    }
    let mut table = Table::new(["samples", "1 - IoU, every surface", "one wall only", "ms"]);
    for i in 0..SAMPLES.len() {
        let [e, f, t] = [&error.series[0], &error.series[1], &took.series[0]].map(|s| s.points[i]);
        table.row([e[0].to_string(), format!("{:.4}", e[1]), format!("{:.4}", f[1]), format!("{:.0}", t[1])]);
    }
    table.print("Samples (the paper's Fig. 5)");
    written(&error, "segment_samples");
    written(&took, "segment_samples_time");
}

/// Measures error against time for the number of samples per class, with selected channels and with all channels, and
/// for the windows of the refinement.
fn knobs(rooms: &[&Case]) {
    let mut plot = Plot::new("Segmentation of a megapixel", "seconds", "1 - IoU");
    let all = (1 << CHANNELS) - 1;
    for (half, strokes) in STROKES.iter().enumerate() {
        for (name, channels) in [("samples", 0), ("samples, all channels", all)] {
            let points = SAMPLES.map(|samples_per_class| {
                seconds_and_error(rooms, half, &Params { samples_per_class, channels, ..Params::default() })
            });
            plot.add(&format!("{strokes}: {name}"), points);
        }
        let points = [2, 4, 8, 16, 32]
            .map(|refine_radius| seconds_and_error(rooms, half, &Params { refine_radius, ..Params::default() }));
        plot.add(&format!("{strokes}: refined"), points);
    }
    written(&plot, "segment_knobs");
}

/// Measures the error for subsets of the channels, as in the paper's Fig. 6. The plot shows the subsets of the paper,
/// in which one kind of channels after the other is added.
fn channels(rooms: &[&Case]) {
    const COLOUR: u32 = 0b111;
    const DEPTH: u32 = 1 << 3;
    const POSITION: u32 = 0b111 << 4;
    const NORMAL: u32 = 0b111 << 7;
    let added = [COLOUR, COLOUR | DEPTH, COLOUR | DEPTH | POSITION, COLOUR | DEPTH | POSITION | NORMAL];
    let mut points = [[[f64::NAN; 2]; 4]; 2];
    let mut table = Table::new(["channels", "IoU, every surface", "one wall only"]);
    for (name, channels) in [
        ("colour", COLOUR),
        ("colour, depth", COLOUR | DEPTH),
        ("colour, position", COLOUR | POSITION),
        ("colour, normal", COLOUR | NORMAL),
        ("all but colour", DEPTH | POSITION | NORMAL),
        ("all but normal", COLOUR | DEPTH | POSITION),
        ("all", COLOUR | DEPTH | POSITION | NORMAL),
    ] {
        let params = Params { channels, ..Params::default() };
        let errors = [0, 1].map(|half| seconds_and_error(rooms, half, &params)[1]);
        if let Some(step) = added.iter().position(|subset| *subset == channels) {
            let count = f64::from(channels.count_ones());
            errors.iter().enumerate().for_each(|(half, error)| points[half][step] = [count, *error]);
        }
        table.row([name.to_string()].into_iter().chain(errors.map(|error| format!("{:.4}", 1.0 - error))));
    }
    table.print("Channels left out (the paper's Fig. 6)");
    let mut plot = Plot::new("Colour, then depth, position and normal", "channels", "1 - IoU");
    STROKES.iter().zip(points).for_each(|(name, points)| plot.add(name, points));
    written(&plot, "segment_channels");
}
