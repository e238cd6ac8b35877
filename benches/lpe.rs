//! Benchmark of light path expressions: their cost beside the main image, and the error of the sum of a complete set
//! of expressions.
//!
//! The five images of StyLit (section 3.2), sixteen expressions, and all AOVs are compared with the main image alone,
//! in turns on one thread, on a sphere on a table and on rooms. The pictures go to `out/bench/`.

mod harness;

use glam::{Vec2, Vec3};
use harness::scenes::{self, Absent, Setting};
use harness::{Clock, Table, absent, figure, interleaved};
use luxfer::exec::Pool;
use luxfer::image::{Image, io};
use luxfer::job::Monitor;
use luxfer::render::{self, Aov, Film, Outputs, Params, World};
use luxfer::scene::{Camera, Material, Mesh, Scene};
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;

/// The images of the StyLit paper, including the full image.
const FIVE: [(&str, &str); 5] =
    [("FULL", "L.*E"), ("LDE", "LDE"), ("LSE", "LSE"), ("LDDE", "L.*DDE"), ("LD12E", "LD{1,2}E")];
/// A complete set of expressions without overlap: every path matches exactly one.
const PARTS: [(&str, &str); 5] =
    [("LE", "LE"), ("LDE", "LDE"), ("LSE", "LSE"), ("LDDE", "L.*DDE"), ("rest", "L.*SDE|L.*.SE")];
const SIXTEEN: [(&str, &str); 16] = [
    ("a", "emission"),
    ("b", "background"),
    ("c", "diffuse_direct"),
    ("d", "diffuse_indirect"),
    ("e", "specular_direct"),
    ("f", "specular_indirect"),
    ("g", "transmission_direct"),
    ("h", "transmission_indirect"),
    ("i", "LDE"),
    ("j", "LSE"),
    ("k", "L.*DDE"),
    ("l", "LD{1,2}E"),
    ("m", "LS*DE"),
    ("n", "LS+DE"),
    ("o", "C.*S.*L"),
    ("p", "CD{3,}L"),
];
const ROUNDS: usize = 7;
const SAMPLES: u32 = 16;

fn main() {
    // One thread: the clock of this thread then measures all work.
    let pool = Pool::new(1).expect("a thread");
    let settings: [(&str, Result<Setting, Absent>); 4] = [
        ("table", Ok(sphere_on_table())),
        ("demo", scenes::demo_room()),
        ("cornell", scenes::cornell()),
        ("kitchen", scenes::kitchen()),
    ];
    let mut table = Table::new(["scene", "ms alone", "five", "sixteen", "all of surfaces", "sum error", "bits"]);
    let (mut worst_cost, mut worst_sum) = (f64::NEG_INFINITY, 0.0f64);
    for (name, setting) in settings {
        match setting {
            Ok(setting) => {
                let (cost, sum) = pool.run(|| measure(&setting, &mut table));
                worst_cost = worst_cost.max(cost);
                worst_sum = worst_sum.max(sum);
            }
            Err(reason) => absent(&format!("lpe.five.overhead.{name}"), &reason),
        }
    }
    table.print("Time beside that of the main image alone, in %; largest difference of a pixel's parts from the whole");
    figure("lpe.five.overhead", worst_cost, "%");
    figure("lpe.sum_error", worst_sum, "relative");
}

fn params(setting: &Setting, expressions: &[(&str, &str)], aovs: &[Aov]) -> Params {
    let mut outputs = Outputs { aovs: aovs.to_vec(), ..Outputs::default() };
    expressions.iter().for_each(|(name, text)| outputs.add(name, text).expect("an expression"));
    let [width, height] = setting.size.map(|side| side / 5);
    Params { width, height, samples: SAMPLES, outputs, ..Params::default() }
}

/// Returns the additional cost of five expressions in %, and the largest relative error of the sum of a complete set.
fn measure(setting: &Setting, table: &mut Table) -> (f64, f64) {
    let monitor = Monitor::default();
    let world = World::build(Arc::new(setting.scene.clone()), monitor.job()).expect("a world");
    let render =
        |params: &Params| render::run(&world, &setting.camera, params, monitor.job(), &mut |_| ()).expect("an image");
    let contenders = [
        params(setting, &[], &[]),
        params(setting, &FIVE, &[]),
        params(setting, &SIXTEEN, &[]),
        params(setting, &[], &Aov::ALL),
    ];
    let run = |i: usize| {
        black_box(render(&contenders[i]));
    };
    let times =
        interleaved(Clock::Thread, ROUNDS, &mut [&mut || run(0), &mut || run(1), &mut || run(2), &mut || run(3)]);
    let cost = |i: usize| 100.0 * (times.ratio(i, 0) - 1.0);
    let parts = render(&params(setting, &PARTS, &[]));
    let same = parts.beauty == render(&contenders[0]).beauty;
    let sum = sum_error(&parts);
    table.row([
        setting.name.to_string(),
        format!("{:.0}", 1e3 * times.median(0)),
        format!("{:+.1}", cost(1)),
        format!("{:+.1}", cost(2)),
        format!("{:+.1}", cost(3)),
        format!("{sum:.1e}"),
        if same { "same" } else { "DIFFERENT" }.to_string(),
    ]);
    let mut fine = params(setting, &FIVE, &Aov::ALL);
    (fine.width, fine.height, fine.samples) = (2 * fine.width, 2 * fine.height, 32);
    save(setting, &render(&fine));
    (cost(1), sum)
}

/// Largest relative difference of a pixel between the main image and the sum of all layers.
fn sum_error(film: &Film) -> f64 {
    let errors = film.beauty.data.iter().enumerate().map(|(i, &whole)| {
        let sum: f64 = film.layers.iter().map(|layer| f64::from(layer.image.data[i])).sum();
        (sum - f64::from(whole)).abs() / f64::from(whole).max(f64::MIN_POSITIVE)
    });
    errors.fold(0.0, f64::max)
}

/// Saves the layers as pictures: layers of light at the exposure of the main image, AOVs scaled to their range.
fn save(setting: &Setting, film: &Film) {
    let exposure = 0.3 / mean(&film.beauty).max(1e-9);
    for layer in &film.layers {
        let (image, exposure) = match layer.name.as_str() {
            "Normal" | "GeometricNormal" => (shifted(&layer.image), 1.0),
            "Albedo" | "Alpha" => (layer.image.clone(), 1.0),
            _ if layer.expression.is_some() => (layer.image.clone(), exposure),
            _ => (layer.image.clone(), 0.3 / mean(&layer.image).max(1e-9)),
        };
        let path = format!("out/bench/lpe_{}_{}.png", setting.name, layer.name);
        let written = std::fs::create_dir_all("out/bench").map_err(|e| e.to_string()).and_then(|()| {
            let png = io::encode_png(&image, exposure).map_err(|e| e.to_string())?;
            io::write_file(Path::new(&path), &png).map_err(|e| e.to_string())
        });
        if let Err(reason) = written {
            println!("# {path} was not written: {reason}");
        }
    }
}

fn mean(image: &Image) -> f32 {
    let finite = image.data.iter().filter(|v| v.is_finite());
    finite.clone().sum::<f32>() / finite.count().max(1) as f32
}

fn shifted(image: &Image) -> Image {
    let data = image.data.iter().map(|v| 0.5 + 0.5 * v).collect();
    Image { data, ..*image }
}

/// The exemplar scene of StyLit: a glossy sphere on a table before a wall, and a lamp.
fn sphere_on_table() -> Setting {
    let mut scene = Scene::default();
    let paint =
        |name: &str, colour: Vec3, roughness: f32| Material { roughness, ior: 1.5, ..Material::diffuse(name, colour) };
    scene.materials.push(paint("Table", Vec3::new(0.75, 0.72, 0.68), 0.6));
    scene.materials.push(paint("Sphere", Vec3::new(0.7, 0.12, 0.08), 0.15));
    scene.meshes.push(scenes::sheet("Table", 0, 8, |s, t| Vec3::new(12.0 * t - 6.0, 0.0, 12.0 * s - 6.0)));
    scene.meshes.push(scenes::sheet("Wall", 0, 8, |s, t| Vec3::new(12.0 * s - 6.0, 8.0 * t, -5.0)));
    scene.meshes.push(Mesh { name: "Sphere".into(), material: 1, ..sphere(Vec3::Y, 1.0) });
    scenes::lamp(&mut scene, Vec3::new(-4.0, 6.0, -1.0), Vec2::new(2.5, 2.5), 400.0);
    let camera = Camera::look_at(Vec3::new(0.0, 3.0, 6.5), Vec3::new(0.0, 0.8, 0.0), 0.6);
    Setting { name: "table", scene, camera, size: [640, 480] }
}

fn sphere(centre: Vec3, radius: f32) -> Mesh {
    let around = |s: f32, t: f32| {
        let (sine, cosine) = (std::f32::consts::PI * t).sin_cos();
        let angle = std::f32::consts::TAU * s;
        Vec3::new(sine * angle.cos(), -cosine, -sine * angle.sin())
    };
    let mut mesh = scenes::sheet("", 0, 48, |s, t| centre + radius * around(s, t));
    mesh.normals = mesh.positions.iter().map(|p| (*p - centre) / radius).collect();
    mesh
}
