//! Benchmark of the noise filter: its error, and the truth of what it states.
//!
//! Interiors are rendered with few paths per pixel; the picture, its filtered version and that of Open Image Denoise
//! are compared with a reference of many paths. Squared errors are reduced by the variance of the reference. The error
//! is relative to the true pixel, or to a tenth of the image's mean where the pixel is darker. No constant of the
//! filter was chosen by the scenes `sponza` and `planes` ([`HELD_BACK`]): they show whether the stated intervals are
//! true elsewhere too. Arguments choose scenes. Takes about fifteen minutes of processor time.

#[path = "photos/hall.rs"]
mod hall;
mod harness;

use glam::{Vec2, Vec3};
use harness::peer::Peer;
use harness::scenes::{self, Absent, Setting};
use harness::{Clock, Table, absent, figure, median, time};
use luxfer::exec::Pool;
use luxfer::image::{Image, colour, io};
use luxfer::job::Monitor;
use luxfer::render::denoise::{self, Input};
use luxfer::render::{self, Aov, Film, Outputs, Params, World};
use luxfer::scene::Camera;
use std::hint::black_box;
use std::path::PathBuf;
use std::sync::Arc;

/// Paths per pixel of the reference images.
const REFERENCE: u32 = 512;
/// Paths per pixel of the pictures whose errors are compared.
const PATHS: [u32; 4] = [1, 4, 16, 64];
/// Paths per pixel of further pictures, of which only the stated errors and intervals are checked.
const STATED: [u32; 2] = [8, 256];
/// Scenes by which no constant of the filter was chosen.
const HELD_BACK: [&str; 2] = ["sponza", "planes"];
/// The error is relative to the true pixel, but at least to this share of the image's mean.
const MIN_RELATIVE: f64 = 0.1;

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let pool = Pool::new(2).expect("two threads");
    let settings: [(&str, fn() -> Result<Setting, Absent>); 8] = [
        ("demo", scenes::demo_room),
        ("office", scenes::demo_office),
        ("hall", lit_hall),
        ("cornell", scenes::cornell),
        ("kitchen", scenes::kitchen),
        ("apartment", scenes::apartment),
        ("sponza", scenes::sponza),
        ("planes", || Ok(scenes::planes("planes", 20_000))),
    ];
    let mut peer = Peer::start("oidn", "oidn.py");
    let mut table = Table::new([
        "scene",
        "paths",
        "unfiltered",
        "filtered",
        "oidn",
        "median pixel",
        "filtered",
        "oidn",
        "covered",
        "width",
        "error stated / true",
        "rms",
    ]);
    let mut tally = Tally::default();
    for (name, setting) in settings {
        if !chosen.is_empty() && !chosen.iter().any(|c| c == name) {
            continue;
        }
        match setting() {
            Ok(setting) => pool.run(|| scene(name, &setting, peer.as_mut().ok(), &mut table, &mut tally)),
            Err(reason) => absent(&format!("filter.gain.{name}"), &reason),
        }
    }
    table.print(
        "errors relative to the true pixels, root mean square and median; share of the true pixels in the stated 95 % \
         intervals, median width of these intervals relative to those of the unfiltered picture; root mean square of \
         the error in cd/m2, filtered over unfiltered",
    );
    tally.print(peer.err().as_deref());
    pool.run(seconds);
}

/// Ratios and shares over all scenes, by the number of paths.
#[derive(Default)]
struct Tally {
    gains: [Vec<f64>; PATHS.len()],
    vs_oidn: [Vec<f64>; PATHS.len()],
    covered: Vec<f64>,
    covered_held_back: Vec<f64>,
    widths: Vec<f64>,
    stated: Vec<f64>,
    rms: Vec<f64>,
}

impl Tally {
    fn print(&self, no_oidn: Option<&str>) {
        let mean = |values: &[f64]| (values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp();
        let has_scenes = self.gains.iter().all(|gains| !gains.is_empty());
        for (i, paths) in PATHS.into_iter().enumerate().filter(|_| has_scenes) {
            figure(&format!("filter.gain.{paths}"), mean(&self.gains[i]), "x");
            match no_oidn {
                None => figure(&format!("filter.vs_oidn.{paths}"), mean(&self.vs_oidn[i]), "x"),
                Some(reason) => absent(&format!("filter.vs_oidn.{paths}"), reason),
            }
        }
        match no_oidn {
            None if !has_scenes => {}
            None => figure("filter.vs_oidn", mean(&self.vs_oidn.concat()), "x"),
            Some(reason) => absent("filter.vs_oidn", reason),
        }
        let arithmetic = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        for (name, covered) in
            [("filter.coverage", &self.covered), ("filter.coverage.held_back", &self.covered_held_back)]
        {
            if covered.is_empty() {
                continue;
            }
            figure(name, arithmetic(covered), "%");
            figure(&format!("{name}.lowest"), covered.iter().copied().fold(f64::INFINITY, f64::min), "%");
            figure(&format!("{name}.highest"), covered.iter().copied().fold(0.0, f64::max), "%");
        }
        figure("filter.interval_width", mean(&self.widths), "x");
        figure("filter.rms", mean(&self.rms), "x");
        figure("filter.rms.worst", self.rms.iter().copied().fold(0.0, f64::max), "x");
        figure("filter.error_stated_over_true", mean(&self.stated), "x");
    }
}

/// A hall under twelve lamps.
fn lit_hall() -> Result<Setting, Absent> {
    let mut scene = hall::hall();
    for i in 0..12u8 {
        let corner = Vec3::new(1.5 + 3.6 * f32::from(i % 4), 3.19, 1.5 + 3.8 * f32::from(i / 4));
        scenes::lamp(&mut scene, corner, Vec2::new(1.2, 0.6), 3000.0);
    }
    let camera = scene.cameras.first().cloned().ok_or("the hall has no camera")?;
    Ok(Setting { name: "hall", scene, camera, size: [640, 360] })
}

fn shoot(world: &World, camera: &Camera, params: &Params) -> Film {
    render::run(world, camera, params, Monitor::default().job(), &mut |_| ()).expect("a film")
}

/// Renders a scene with each number of paths, and adds its errors to the table.
fn scene(name: &str, setting: &Setting, mut peer: Option<&mut Peer>, table: &mut Table, tally: &mut Tally) {
    let world = World::build(Arc::new(setting.scene.clone()), Monitor::default().job()).expect("a valid scene");
    let outputs = Outputs { aovs: vec![Aov::Albedo, Aov::Normal], ..Outputs::default() };
    let size = Params { width: 192, height: 108, outputs, ..Params::default() };
    let truth = shoot(&world, &setting.camera, &Params { samples: REFERENCE, seed: 1 << 40, ..size.clone() });
    let held_back = HELD_BACK.contains(&name);
    for samples in PATHS.into_iter().chain(STATED) {
        let film = shoot(&world, &setting.camera, &Params { samples, preview: 1.0, ..size.clone() });
        let filtered = film.preview.as_ref().expect("a preview was asked for");
        let compared = PATHS.iter().position(|&paths| paths == samples).filter(|_| !held_back);
        let peers = compared.and_then(|_| peer.as_mut().map(|peer| ask(peer, &film)));
        let errors = [Some(&film.beauty), Some(&filtered.image), peers.as_ref()]
            .map(|image| image.map(|image| [relative_error(image, &truth), median_error(image, &truth.beauty)]));
        let [Some(before), Some(after), oidn] = errors else { continue };
        if let Some(i) = compared {
            tally.gains[i].push(before[0] / after[0]);
            tally.vs_oidn[i].extend(oidn.map(|oidn| oidn[0] / after[0]));
        }
        let stated = (samples >= 4).then(|| Stated::new(&film, &truth));
        if let Some(stated) = &stated {
            if held_back { &mut tally.covered_held_back } else { &mut tally.covered }.push(stated.covered);
            tally.widths.push(stated.width);
            tally.stated.push(stated.error);
            tally.rms.push(stated.rms);
        }
        let number = |v: Option<f64>| v.map_or("-".into(), |v| format!("{v:.4}"));
        let short = |v: fn(&Stated) -> f64| stated.as_ref().map_or("-".into(), |stated| format!("{:.3}", v(stated)));
        table.row([
            name.to_string(),
            samples.to_string(),
            number(Some(before[0])),
            number(Some(after[0])),
            number(oidn.map(|o| o[0])),
            number(Some(before[1])),
            number(Some(after[1])),
            number(oidn.map(|o| o[1])),
            stated.as_ref().map_or("-".into(), |stated| format!("{:.1} %", stated.covered)),
            short(|stated| stated.width),
            short(|stated| stated.error),
            short(|stated| stated.rms),
        ]);
        save(
            &format!("filter_{name}_{samples}"),
            &[Some(&film.beauty), Some(&filtered.image), peers.as_ref(), Some(&truth.beauty)],
        );
    }
}

/// The truth of what the filter states about a picture.
struct Stated {
    /// Share of the true pixels in the intervals, in percent.
    covered: f64,
    /// Median width of the intervals, relative to those of the unfiltered picture.
    width: f64,
    /// Stated error over the true error.
    error: f64,
    /// Root mean square error in cd/m², filtered over unfiltered.
    rms: f64,
}

impl Stated {
    fn new(film: &Film, truth: &Film) -> Self {
        let filtered = film.preview.as_ref().expect("a preview was asked for");
        let unfiltered = film.interval(Monitor::default().job()).expect("intervals");
        let widths = filtered.interval.data.iter().zip(&unfiltered.data).zip(noisy(truth));
        let widths = widths.filter(|((_, unfiltered), noisy)| *noisy && **unfiltered > 0.0);
        let [before, after] = [&film.beauty, &filtered.image].map(|image| error(image, truth, |_| 1.0));
        Self {
            covered: covered(filtered, truth),
            width: median(&widths.map(|((a, b), _)| f64::from(a / b)).collect::<Vec<f64>>()),
            error: filtered.error / (after / mean(&truth.beauty)),
            rms: after / before,
        }
    }
}

/// Filters a film with Open Image Denoise.
fn ask(peer: &mut Peer, film: &Film) -> Image {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("out/bench");
    std::fs::create_dir_all(&folder).expect("out/bench can be made");
    let [source, target] = ["oidn.in", "oidn.out"].map(|name| folder.join(name));
    let images = [&film.beauty, &film.layers[0].image, &film.layers[1].image];
    let bytes: Vec<u8> = images.iter().flat_map(|i| &i.data).flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(&source, bytes).expect("out/bench can be written to");
    let Image { width, height, .. } = film.beauty;
    peer.ask(&format!("{} {} {width} {height}", source.display(), target.display())).expect("an answer");
    let bytes = std::fs::read(&target).expect("a result");
    let data: Vec<f32> = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    Image::from_fn(width, height, |x, y| [0, 1, 2].map(|c| data[3 * (y * width + x) + c])).expect("an image")
}

fn mean(image: &Image) -> f64 {
    image.data.iter().map(|&v| f64::from(v)).sum::<f64>() / image.data.len() as f64
}

/// Root mean square over pixels and channels of the error, each divided by `unit` of the true value, without the part
/// that comes from the noise of the reference.
fn error(image: &Image, truth: &Film, unit: impl Fn(f64) -> f64) -> f64 {
    let values = image.data.iter().zip(&truth.beauty.data).zip(&truth.variance.data);
    let square =
        |((&a, &t), &v): ((&f32, &f32), &f32)| (f64::from(a - t).powi(2) - f64::from(v)) / unit(f64::from(t)).powi(2);
    (values.map(square).sum::<f64>() / image.data.len() as f64).max(0.0).sqrt()
}

fn relative_error(image: &Image, truth: &Film) -> f64 {
    let floor = MIN_RELATIVE * mean(&truth.beauty);
    error(image, truth, |t| t.hypot(floor))
}

/// Median over the pixels of the relative error of the luminance.
fn median_error(image: &Image, truth: &Image) -> f64 {
    let floor = 0.01 * mean(truth);
    let luminance = |p: &[f32]| f64::from(colour::luminance(Vec3::new(p[0], p[1], p[2])));
    let pixels = image.data.chunks_exact(3).zip(truth.data.chunks_exact(3));
    let errors = pixels.map(|(a, t)| (luminance(a) - luminance(t)).abs() / luminance(t).max(floor));
    median(&errors.collect::<Vec<f64>>())
}

/// Returns for each value of the reference whether it has noise. The values of lamps, for example, have none.
fn noisy(truth: &Film) -> impl Iterator<Item = bool> {
    truth.beauty.data.iter().zip(&truth.variance.data).map(|(&t, &v)| f64::from(v) > 1e-10 * f64::from(t).powi(2))
}

/// Share of the values of pixels with noise whose interval contains the true value, in percent. The interval is
/// widened by that of the reference.
fn covered(filtered: &denoise::Output, truth: &Film) -> f64 {
    let (mut held, mut counted) = (0.0, 0.0);
    for (i, _) in noisy(truth).enumerate().filter(|(_, noisy)| *noisy) {
        let half_width = f64::from(filtered.interval.data[i]).hypot(1.96 * f64::from(truth.variance.data[i]).sqrt());
        counted += 1.0;
        held += f64::from(u8::from(f64::from(filtered.image.data[i] - truth.beauty.data[i]).abs() <= half_width));
    }
    100.0 * held / f64::max(counted, 1.0)
}

/// Saves images in `out/bench`, one above the other, with four picture pixels for each pixel.
fn save(name: &str, images: &[Option<&Image>]) {
    let images: Vec<&Image> = images.iter().copied().flatten().collect();
    let last = images[images.len() - 1];
    let (width, height) = (last.width, last.height);
    let all = Image::from_fn(4 * width, 4 * images.len() * height, |x, y| {
        images[y / 4 / height].rgb(x / 4, y / 4 % height).to_array()
    });
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("out/bench");
    std::fs::create_dir_all(&folder).expect("out/bench can be made");
    let bytes = all.and_then(|image| io::encode_png(&image, (0.3 / mean(last)) as f32)).expect("a picture");
    std::fs::write(folder.join(format!("{name}.png")), bytes).expect("out/bench can be written to");
}

/// Measures the processor time of the filter for a picture of 640 x 360 pixels.
fn seconds() {
    let setting = scenes::demo_room().expect("a room");
    let world = World::build(Arc::new(setting.scene.clone()), Monitor::default().job()).expect("a valid scene");
    let outputs = Outputs { aovs: vec![Aov::Albedo, Aov::Normal, Aov::Position], ..Outputs::default() };
    let params = Params { width: 640, height: 360, samples: 4, outputs, ..Params::default() };
    let [film, other] = [1, 2].map(|seed| shoot(&world, &setting.camera, &Params { seed, ..params.clone() }));
    let [albedo, normal, position] = [0, 1, 2].map(|i| &film.layers[i].image);
    let (halves, variances) = ([&film.beauty, &other.beauty], [&film.variance, &other.variance]);
    let input = Input { halves, variances, albedo, normal, position };
    let run =
        || black_box(denoise::run(&input, &denoise::Params::default(), Monitor::default().job()).expect("a picture"));
    let times: Vec<f64> = (0..5).map(|_| time(Clock::Process, run).0).collect();
    figure("filter.seconds", median(&times), "CPU s");
}
