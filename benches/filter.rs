//! Benchmark of the noise filter: its error, and the truth of what it states.
//!
//! Interiors are rendered with few paths per pixel; the picture, its filtered version and that of Open Image Denoise
//! are compared with a reference of many paths. Squared errors are reduced by the variance of the reference. The error
//! is relative to the true pixel, or to a tenth of the image's mean where the pixel is darker. Arguments choose
//! scenes. Takes about seven minutes of processor time.

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
/// Paths per pixel of the pictures that are filtered.
const PATHS: [u32; 4] = [1, 4, 16, 64];
/// The error is relative to the true pixel, but at least to this share of the image's mean.
const MIN_RELATIVE: f64 = 0.1;

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let pool = Pool::new(2).expect("two threads");
    let settings: [(&str, fn() -> Result<Setting, Absent>); 6] = [
        ("demo", scenes::demo_room),
        ("office", scenes::demo_office),
        ("hall", lit_hall),
        ("cornell", scenes::cornell),
        ("kitchen", scenes::kitchen),
        ("apartment", scenes::apartment),
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
        "error stated / true",
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
         intervals",
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
    stated: Vec<f64>,
}

impl Tally {
    fn print(&self, no_oidn: Option<&str>) {
        let mean = |values: &[f64]| (values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp();
        for (i, paths) in PATHS.into_iter().enumerate() {
            figure(&format!("filter.gain.{paths}"), mean(&self.gains[i]), "x");
            match no_oidn {
                None => figure(&format!("filter.vs_oidn.{paths}"), mean(&self.vs_oidn[i]), "x"),
                Some(reason) => absent(&format!("filter.vs_oidn.{paths}"), reason),
            }
        }
        match no_oidn {
            None => figure("filter.vs_oidn", mean(&self.vs_oidn.concat()), "x"),
            Some(reason) => absent("filter.vs_oidn", reason),
        }
        figure("filter.coverage", self.covered.iter().sum::<f64>() / self.covered.len() as f64, "%");
        let worst = self.covered.iter().fold(95.0f64, |w, c| if (c - 95.0).abs() > (w - 95.0).abs() { *c } else { w });
        figure("filter.coverage.worst", worst, "%");
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
    for (i, samples) in PATHS.into_iter().enumerate() {
        let film = shoot(&world, &setting.camera, &Params { samples, preview: 1.0, ..size.clone() });
        let filtered = film.preview.as_ref().expect("a preview was asked for");
        let peers = peer.as_mut().map(|peer| ask(peer, &film));
        let errors = [Some(&film.beauty), Some(&filtered.image), peers.as_ref()]
            .map(|image| image.map(|image| [relative_error(image, &truth), median_error(image, &truth.beauty)]));
        let [Some(before), Some(after), oidn] = errors else { continue };
        tally.gains[i].push(before[0] / after[0]);
        tally.vs_oidn[i].extend(oidn.map(|oidn| oidn[0] / after[0]));
        let is_known = samples >= 4;
        let covered = covered(filtered, &truth);
        let stated = filtered.error / (error(&filtered.image, &truth, |_| 1.0) / mean(&truth.beauty));
        if is_known {
            tally.covered.push(covered);
            tally.stated.push(stated);
        }
        let number = |v: Option<f64>| v.map_or("-".into(), |v| format!("{v:.4}"));
        table.row([
            name.to_string(),
            samples.to_string(),
            number(Some(before[0])),
            number(Some(after[0])),
            number(oidn.map(|o| o[0])),
            number(Some(before[1])),
            number(Some(after[1])),
            number(oidn.map(|o| o[1])),
            if is_known { format!("{covered:.1} %") } else { "-".into() },
            if is_known { format!("{stated:.3}") } else { "-".into() },
        ]);
        save(
            &format!("filter_{name}_{samples}"),
            &[Some(&film.beauty), Some(&filtered.image), peers.as_ref(), Some(&truth.beauty)],
        );
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

/// Share of the values of pixels with noise whose interval contains the true value, in percent. The interval is widened
/// by that of the reference.
fn covered(filtered: &denoise::Output, truth: &Film) -> f64 {
    let (mut held, mut counted) = (0.0, 0.0);
    for (i, (&value, &t)) in filtered.image.data.iter().zip(&truth.beauty.data).enumerate() {
        let half_width = f64::from(filtered.interval.data[i]);
        let of_truth = f64::from(truth.variance.data[i]);
        if of_truth > 1e-10 * f64::from(t).powi(2) {
            counted += 1.0;
            held += f64::from(u8::from(f64::from(value - t).abs() <= half_width.hypot(1.96 * of_truth.sqrt())));
        }
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
