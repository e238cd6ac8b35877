//! Benchmark of features: the time per megapixel; normals compared with Open3D on rooms with known normals and on
//! RGB-D pairs; the room layout from the lines of those pairs and from strokes. With the argument `knobs`: only the
//! error of normals against the window; with `layouts`: only the room layout.

mod harness;

use glam::{DMat3, DVec2, Vec3};
use harness::peer::Peer;
use harness::plot::Plot;
use harness::{Clock, Table, absent, figure, interleaved, median, time};
use luxfer::exec::Pool;
use luxfer::features::{self, DepthKind, DepthMap, Input, Params, PlaneStroke, RoomView};
use luxfer::geometry::{FocalSource, Perspective};
use luxfer::image::Image;
use luxfer::image::io::{Encoding, load};
use luxfer::job::Monitor;
use luxfer::rectify;
use luxfer::rng::Rng;
use luxfer::segment::{StrokeSet, strokes};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const SIZE: [usize; 2] = [1152, 868];
/// Numbers of neighbours for Open3D: its usual number, and a larger one. With noise, its accuracy rises with the
/// number, and so does its time.
const NEIGHBOURS: [usize; 2] = [30, 100];
const ROUNDS: usize = 5;
/// Half-widths in pixels of the windows in which normals are fitted.
const RADII: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];

/// A depth map with its camera and, if they are known, the true normals.
struct Case {
    name: String,
    photo: Image,
    depth: Image,
    camera: Perspective,
    truth: Option<Vec<Vec3>>,
    /// Strokes on one of the planes of the photo, and elsewhere.
    strokes: StrokeSet,
}

fn main() {
    let pool = Pool::new(2).unwrap();
    if std::env::args().any(|arg| arg == "layouts") {
        return pool.run(|| layouts(&pairs().iter().collect::<Vec<_>>()));
    }
    let rooms = [0.0, 0.002, 0.01].map(room);
    pool.run(|| knobs(&rooms));
    if std::env::args().any(|arg| arg == "knobs") {
        return;
    }
    pool.run(megapixel);
    let cases: Vec<Case> = rooms.into_iter().chain(pairs()).collect();
    if let Err(reason) = pool.run(|| normals(&cases)) {
        absent("normals.vs_open3d", &reason);
    }
    let pairs: Vec<&Case> = cases.iter().filter(|c| c.truth.is_none()).collect();
    pool.run(|| layouts(&pairs));
}

/// Compares the library's own depth with the measured depth, up to scale: depth from lines and strokes, from lines
/// alone, and from neither.
fn layouts(pairs: &[&Case]) {
    if pairs.is_empty() {
        return absent("features.layout.depth_error", "the RGB-D pairs are not there");
    }
    let head =
        ["pair", "depth from", "off by %, half", "within 25 %", "trusted half: off by %", "other half", "normals deg"];
    let mut table = Table::new(head);
    let mut errors = Vec::new();
    let mut means = [0.0; 3];
    let monitor = Monitor::default();
    for case in pairs {
        let camera = rectify::Params {
            focal: Some(case.camera.focal),
            principal: Some(case.camera.principal),
            ..Default::default()
        };
        let Ok(view) = rectify::find_view(&case.photo, &camera, monitor.job()) else { continue };
        let lines = RoomView { perspective: &view.perspective, segments: &view.segments, strokes: &[], layout: None };
        let painted = case.strokes.plane_strokes();
        let painted: Vec<_> = painted.map(|s| PlaneStroke { pixels: &s.pixels, positive: s.positive }).collect();
        let of = |depth, segments, strokes| {
            let room = Some(RoomView { segments, strokes, ..lines });
            let input = Input { photo: &case.photo, depth, room };
            features::run(&input, &Params::default(), monitor.job()).unwrap()
        };
        let map = DepthMap { image: &case.depth, kind: DepthKind::AlongZ };
        let measured = of(Some(map), &view.segments, &[]).image;
        let sources = [
            ("lines", &view.segments[..], &[][..]),
            ("lines and strokes", &view.segments, &painted),
            ("nothing seen", &[], &[]),
        ];
        for ((name, segments, strokes), mean) in sources.into_iter().zip(&mut means) {
            let found = of(None, segments, strokes);
            let (median_error, cells) = layout_row(case, &found, &measured);
            *mean += median_error / pairs.len() as f64;
            if name == "lines" {
                errors.push(median_error);
            }
            table.row([case.name.clone(), name.into()].into_iter().chain(cells).collect::<Vec<_>>());
        }
    }
    table.print("The room laid out from its lines and strokes, beside the measured depth, but for its scale");
    figure("features.layout.depth_error", median(&errors), "%");
    for (name, mean) in ["lines", "strokes", "nothing"].into_iter().zip(means) {
        figure(&format!("features.layout.mean_error.{name}"), mean, "%");
    }
}

/// Median error of the depth of a layout in %, and the cells of its table row.
fn layout_row(case: &Case, found: &features::Features, measured: &Image) -> (f64, [String; 5]) {
    // Invert Eq. 1: from screen depth to inverse depth.
    let Params { near, far, .. } = Params::default();
    let inverse = |i: usize| (1.0 - found.image.data[i * 10 + 3] * (far - near) / far) / near;
    let pixels = case.measured();
    let mut logs: Vec<f64> =
        pixels.iter().map(|&i| -f64::from(inverse(i).max(1e-6) * case.depth.data[i]).ln()).collect();
    let middle = median(&logs);
    logs.iter_mut().for_each(|l| *l = (*l - middle).abs());
    let trust = |i: usize| f64::from(found.depth_confidence.data[i]);
    let typical = median(&pixels.iter().map(|&i| trust(i)).collect::<Vec<_>>());
    let half = |trusted: bool| -> Vec<f64> {
        let of_half = pixels.iter().zip(&logs).filter(|p| (trust(*p.0) > typical) == trusted);
        of_half.map(|p| *p.1).collect()
    };
    // Without lines and strokes, all pixels have equal confidence and one half is empty.
    let percent = |values: &[f64]| match values.is_empty() {
        true => "-".into(),
        false => format!("{:.0}", 100.0 * (median(values).exp() - 1.0)),
    };
    let within = logs.iter().filter(|l| **l < 1.25f64.ln()).count() as f64 / logs.len() as f64;
    let angles: Vec<f64> = pixels
        .iter()
        .map(|&i| f64::from(normal(&found.image, i).angle_between(normal(measured, i)).to_degrees()))
        .collect();
    let cells = [
        percent(&logs),
        format!("{:.0} %", 100.0 * within),
        percent(&half(true)),
        percent(&half(false)),
        format!("{:.0}", median(&angles)),
    ];
    (100.0 * (median(&logs).exp() - 1.0), cells)
}

fn looking(focal: f64, principal: DVec2, axes: DMat3) -> Perspective {
    Perspective { focal, focal_source: FocalSource::Given, principal, bend: 0.0, axes }
}

/// A box-shaped room with a table in it, seen at an angle. The depth along z has noise whose relative size grows with
/// depth, as that of depth sensors.
fn room(noise: f64) -> Case {
    let [width, height] = SIZE;
    let axes = DMat3::from_rotation_y(0.4) * DMat3::from_rotation_x(-0.2);
    let camera = looking(900.0, DVec2::new(width as f64, height as f64) / 2.0, DMat3::IDENTITY);
    // Faces: the axis of the normal, the position on this axis, and the bounds on the other two axes.
    let all = [(-9.0, 9.0), (-9.0, 9.0)];
    let faces = [
        (0, -2.0, all),
        (0, 2.5, all),
        (1, -1.5, all),
        (1, 1.2, all),
        (2, 4.5, all),
        (1, 0.4, [(2.2, 3.4), (-0.8, 0.9)]),
        (2, 2.2, [(-0.8, 0.9), (0.4, 0.55)]),
    ];
    // Returns the depth and the normal of the surface at a pixel.
    let seen = |x: usize, y: usize| {
        let toward = camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let ray = axes.transpose() * toward;
        let mut nearest = (f64::INFINITY, 0);
        for (axis, at, [u, v]) in faces {
            let t = at / ray[axis];
            let (a, b) = (ray[(axis + 1) % 3] * t, ray[(axis + 2) % 3] * t);
            if t > 0.0 && t < nearest.0 && (u.0..u.1).contains(&a) && (v.0..v.1).contains(&b) {
                nearest = (t, axis);
            }
        }
        (nearest.0 * toward.z, (axes.col(nearest.1) * -ray[nearest.1].signum()).as_vec3())
    };
    let truth = (0..width * height).map(|i| seen(i % width, i / width).1).collect();
    let depth = Image::from_fn(width, height, |x, y| {
        let (z, _) = seen(x, y);
        let mut rng = Rng::new(1, &[x as u64, y as u64]);
        let [a, b] = [rng.next_f64().max(1e-12), rng.next_f64()];
        let normal = (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos();
        [(z * (1.0 + noise * normal * z / 4.0)) as f32]
    });
    let photo = Image::from_fn(width, height, |x, y| [((x * 7 + y * 13) % 64) as f32 / 64.0; 3]).unwrap();
    let name = format!("room, noise {:.1} % at 4 m", 100.0 * noise);
    Case { name, photo, depth: depth.unwrap(), camera, truth: Some(truth), strokes: StrokeSet::default() }
}

/// Loads the RGB-D pairs; empty if the data is missing.
fn pairs() -> Vec<Case> {
    let root = std::env::var_os("LUXFER_TEST_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from)
        .join("rgbd");
    let Ok(text) = std::fs::read(root.join("rgbd.json")) else { return Vec::new() };
    let about: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let k = |name: &str| about["K"][name].as_f64().unwrap();
    let camera = looking((k("fx") + k("fy")) / 2.0, DVec2::new(k("cx"), k("cy")), DMat3::IDENTITY);
    let case = |name: &str| {
        let photo = load(&root.join(format!("nyu_{name}_rgb.jpg")), Encoding::Srgb).unwrap();
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/strokes/nyu_{name}.txt"));
        let strokes = strokes::parse(&std::fs::read_to_string(file).unwrap(), photo.width, photo.height).unwrap();
        Case {
            name: format!("RGB-D pair {name}"),
            photo,
            strokes,
            depth: load(&root.join(format!("nyu_{name}_depth.png")), Encoding::Linear).unwrap().channel(0).unwrap(),
            camera,
            truth: None,
        }
    };
    ["00000", "00050", "00100"].map(case).into()
}

impl Case {
    fn features(&self, params: &Params) -> Arc<Image> {
        let room = RoomView { perspective: &self.camera, segments: &[], strokes: &[], layout: None };
        let depth = DepthMap { image: &self.depth, kind: DepthKind::AlongZ };
        let input = Input { photo: &self.photo, depth: Some(depth), room: Some(room) };
        features::run(&input, params, Monitor::default().job()).unwrap().image
    }

    /// Indices of the pixels with a measured depth.
    fn measured(&self) -> Vec<usize> {
        (0..self.depth.data.len()).filter(|&i| self.depth.data[i] > 0.0).collect()
    }

    /// Points of the measured pixels in camera space.
    fn cloud(&self) -> Vec<[f32; 3]> {
        let point = |i: usize| {
            let at = DVec2::new((i % self.depth.width) as f64 + 0.5, (i / self.depth.width) as f64 + 0.5);
            let ray = self.camera.ray(at);
            (ray * (f64::from(self.depth.data[i]) / ray.z)).as_vec3().to_array()
        };
        self.measured().into_iter().map(point).collect()
    }

    /// Angles in degrees between the normals and the true normals. Without true normals: angles between the normals of
    /// pixels eight pixels apart, which mostly show one surface; they indicate noise, but not errors that both normals
    /// share.
    fn angles(&self, normal_of: &dyn Fn(usize) -> Vec3) -> Vec<f64> {
        let angle = |a: Vec3, b: Vec3| f64::from(a.cross(b).length().atan2(a.dot(b).abs()).to_degrees());
        let measured = self.measured();
        match &self.truth {
            Some(truth) => measured.iter().map(|&i| angle(normal_of(i), truth[i])).collect(),
            None => measured
                .iter()
                .filter(|&&i| i % self.depth.width + 8 < self.depth.width && self.depth.data[i + 8] > 0.0)
                .map(|&i| angle(normal_of(i), normal_of(i + 8)))
                .collect(),
        }
    }
}

/// The normal of a pixel: the last three of its ten features.
fn normal(features: &Image, pixel: usize) -> Vec3 {
    Vec3::from_slice(&features.data[pixel * 10 + 7..pixel * 10 + 10])
}

/// Measures all features against the window of the normals. The cost is nearly constant, because sums are updated
/// along a row. Reports the mean angle, not the median, because wide windows affect only few pixels, near edges.
fn knobs(rooms: &[Case]) {
    let mut plot = Plot::new("Normals of a megapixel", "half-width of the window, pixels", "mean error, degrees");
    let mut table = Table::new(["half-width of the windows of normals", "ms, all features"]);
    let mut times = vec![Vec::new(); RADII.len()];
    for case in rooms {
        let mut points = Vec::new();
        for (normal_radius, times) in RADII.into_iter().zip(&mut times) {
            let params = Params { normal_radius, ..Params::default() };
            let runs: Vec<_> = (0..ROUNDS).map(|_| time(Clock::Wall, || case.features(&params))).collect();
            times.extend(runs.iter().map(|run| run.0));
            let angles = case.angles(&|i| normal(&runs[0].1, i));
            points.push([normal_radius as f64, angles.iter().sum::<f64>() / angles.len() as f64]);
        }
        plot.add(&case.name, points);
    }
    for (radius, times) in RADII.iter().zip(&times) {
        table.row([radius.to_string(), format!("{:.0}", 1e3 * median(times))]);
    }
    table.print("The time of a window");
    plot.write("features_normals").expect("out/bench can be written");
}

fn megapixel() {
    let case = room(0.002);
    let monitor = Monitor::default();
    let monitor = &monitor;
    let rooms = RoomView { perspective: &case.camera, segments: &[], strokes: &[], layout: None };
    let run = |input: Input| {
        let _ = features::run(&input, &Params::default(), monitor.job()).unwrap();
    };
    let depth = Some(DepthMap { image: &case.depth, kind: DepthKind::AlongZ });
    let timings = interleaved(
        Clock::Wall,
        ROUNDS,
        &mut [
            &mut || run(Input { photo: &case.photo, depth, room: Some(rooms) }),
            &mut || run(Input { photo: &case.photo, depth: None, room: Some(rooms) }),
            &mut || run(Input { photo: &case.photo, depth: None, room: None }),
        ],
    );
    let mut table = Table::new(["1 megapixel, 2 threads", "ms"]);
    for (i, name) in ["from a depth map", "from the room's layout", "without either"].iter().enumerate() {
        table.row([(*name).to_string(), format!("{:.1}", 1e3 * timings.median(i))]);
    }
    table.print("All ten channels");
    figure("features.megapixel.ms", 1e3 * timings.median(0), "ms");
}

fn normals(cases: &[Case]) -> Result<(), String> {
    let mut peer = Peer::start("open3d", "open3d_normals.py")?;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("out/bench");
    std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    let [points, answer] = ["open3d_points.bin", "open3d_normals.bin"].map(|name| folder.join(name));
    let mut table = Table::new(["case", "ours ms", "ours deg", "k = 30 ms", "k = 30 deg", "k = 100 ms", "k = 100 deg"]);
    let mut ratios = Vec::new();
    for case in cases {
        let bytes: Vec<u8> = case.cloud().iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        std::fs::write(&points, bytes).map_err(|e| e.to_string())?;
        let measured = case.measured();
        // Time the two in turns: all ten channels of luxfer, not only the normals, against the normals of Open3D.
        let (mut ours, mut theirs) = (Vec::new(), [Vec::new(), Vec::new()]);
        let mut errors = [0.0; 3];
        for round in 0..if case.truth.is_some() { ROUNDS } else { 1 } {
            let (seconds, image) = time(Clock::Wall, || case.features(&Params::default()));
            ours.push(seconds);
            if round == 0 {
                errors[0] = median(&case.angles(&|i| normal(&image, i)));
            }
            for (k, neighbours) in NEIGHBOURS.iter().enumerate() {
                if k > 0 && round > 0 {
                    continue;
                }
                let question = format!("{} {} {neighbours}", points.display(), answer.display());
                let seconds = peer.ask(&question)?["seconds"].as_f64().ok_or("no time in the answer")?;
                theirs[k].push(seconds);
                if round == 0 {
                    let mut of_pixel = vec![Vec3::Z; case.depth.data.len()];
                    let read = std::fs::read(&answer).map_err(|e| e.to_string())?;
                    for (bytes, &i) in read.chunks_exact(12).zip(&measured) {
                        of_pixel[i] = Vec3::from_array(std::array::from_fn(|c| {
                            f32::from_le_bytes(std::array::from_fn(|b| bytes[4 * c + b]))
                        }));
                    }
                    errors[k + 1] = median(&case.angles(&|i| of_pixel[i]));
                }
            }
        }
        if case.truth.is_some() {
            ratios.extend(theirs[0].iter().zip(&ours).map(|(a, b)| a / b));
        }
        let ms = |seconds: &[f64]| format!("{:.0}", 1e3 * median(seconds));
        let degrees = |k: usize| format!("{:.3}", errors[k]);
        table.row([case.name.clone(), ms(&ours), degrees(0), ms(&theirs[0]), degrees(1), ms(&theirs[1]), degrees(2)]);
    }
    table.print(
        "Normals (ours: with all other channels); degrees: median error, for pairs between normals 8 pixels apart",
    );
    for path in [points, answer] {
        let _ = std::fs::remove_file(path);
    }
    figure("normals.vs_open3d", median(&ratios), "x");
    Ok(())
}
